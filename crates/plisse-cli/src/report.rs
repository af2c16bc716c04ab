//! report.json and the short table on the terminal: the same figures.

use plisse::Sheet;
use plisse::field::{EnergyTerms, FieldReport, Wavelengths, WrinkleField};
use plisse::linalg::Ending;
use plisse::scene::Measured;
use plisse::shell::{BaseReport, ReferenceReport};
use serde::Serialize;

/// Results of a run. Field names carry the units.
#[derive(Serialize)]
pub(crate) struct Report {
    pub(crate) plisse: &'static str,
    pub(crate) title: String,
    /// Published results, in the words of the scene.
    pub(crate) paper: Option<String>,
    pub(crate) vertices: usize,
    pub(crate) faces: usize,
    pub(crate) wrinkle_free_faces: usize,
    /// Independent loops around which the phase may gain whole turns.
    pub(crate) generators: usize,
    /// Whole turns around each, the largest first.
    pub(crate) periods: Vec<i64>,
    /// Turns of least energy before rounding, in the same order.
    pub(crate) periods_before_rounding: Vec<f64>,
    /// True if the integers are proven to be the nearest.
    pub(crate) rounding_exact: bool,
    pub(crate) iterations: usize,
    pub(crate) ending: &'static str,
    /// Of the wrinkled faces, without the constant bending of the base surface.
    pub(crate) energy_joule: f64,
    pub(crate) energy_terms: EnergyTerms,
    pub(crate) wrinkle_free_energy_joule: f64,
    /// Largest component: J/m for amplitudes, J/rad for phases.
    pub(crate) projected_gradient: f64,
    pub(crate) amplitude_m: AmplitudeSummary,
    /// Over wrinkled faces whose amplitude is at least 1 % of the largest; null where nothing
    /// wrinkles.
    pub(crate) wavelength_m: Option<Wavelengths>,
    pub(crate) base: Option<BaseSummary>,
    pub(crate) surface: SurfaceSummary,
    pub(crate) measures: Vec<Measured>,
    pub(crate) notes: Vec<String>,
    pub(crate) seconds: Seconds,
}

#[derive(Serialize)]
pub(crate) struct AmplitudeSummary {
    pub(crate) max: f64,
    pub(crate) mean: f64,
}

#[derive(Serialize)]
pub(crate) struct BaseSummary {
    pub(crate) iterations: usize,
    pub(crate) ending: &'static str,
    pub(crate) energy_joule: f64,
    pub(crate) gradient_newton: f64,
    pub(crate) slack_faces: usize,
    pub(crate) mixed_faces: usize,
    pub(crate) taut_faces: usize,
    pub(crate) collapsed_faces: Vec<usize>,
    pub(crate) inverted_faces: Vec<usize>,
}

#[derive(Serialize)]
pub(crate) struct SurfaceSummary {
    pub(crate) levels: usize,
    pub(crate) vertices: usize,
    pub(crate) faces: usize,
}

#[derive(Serialize)]
pub(crate) struct Seconds {
    pub(crate) base: f64,
    pub(crate) field: f64,
    pub(crate) phase: f64,
    /// Subdividing, displacing, drawing and writing.
    pub(crate) surface: f64,
    pub(crate) total: f64,
}

impl Report {
    pub(crate) fn new(
        title: &str,
        sheet: &Sheet,
        field: &WrinkleField,
        found: &FieldReport,
    ) -> Self {
        let count = field.amplitude_m.len().max(1) as f64;
        let max = field.largest_amplitude_m();
        Self {
            plisse: env!("CARGO_PKG_VERSION"),
            title: title.to_owned(),
            paper: None,
            vertices: sheet.topology.vertex_count,
            faces: sheet.topology.face_count(),
            wrinkle_free_faces: field.wrinkle_free.iter().filter(|f| **f).count(),
            generators: found.periods.len(),
            periods: found.periods.iter().map(|p| p.turns).collect(),
            periods_before_rounding: found.periods.iter().map(|p| p.before_rounding).collect(),
            rounding_exact: found.rounding_exact,
            iterations: found.iterations,
            ending: ending_name(found.ending),
            energy_joule: found.energy_joule,
            energy_terms: found.energy_terms,
            wrinkle_free_energy_joule: found.wrinkle_free_energy_joule,
            projected_gradient: found.projected_gradient,
            amplitude_m: AmplitudeSummary {
                max,
                mean: field.amplitude_m.iter().sum::<f64>() / count,
            },
            wavelength_m: field.wavelengths(sheet),
            base: None,
            surface: SurfaceSummary { levels: 0, vertices: 0, faces: 0 },
            measures: Vec::new(),
            notes: Vec::new(),
            seconds: Seconds {
                base: 0.0,
                field: found.field_seconds,
                phase: found.phase_seconds,
                surface: 0.0,
                total: 0.0,
            },
        }
    }

    /// The table for the terminal, one figure a line.
    pub(crate) fn table(&self) -> String {
        let mut table = format!("{}\n", self.title);
        let mut row = |name: &str, value: String| table += &format!("  {name:<24} {value}\n");
        if let Some(paper) = &self.paper {
            row("published", paper.clone());
        }
        row(
            "mesh",
            format!(
                "{} vertices, {} faces, {} of them wrinkle-free",
                self.vertices, self.faces, self.wrinkle_free_faces
            ),
        );
        if let Some(base) = &self.base {
            row(
                "base",
                format!(
                    "{} iterations, {}, {:.6e} J",
                    base.iterations, base.ending, base.energy_joule
                ),
            );
        }
        row(
            "field",
            format!(
                "{} iterations, {}, {:.6e} J, projected gradient {:.1e}",
                self.iterations, self.ending, self.energy_joule, self.projected_gradient
            ),
        );
        row(
            "amplitude",
            format!("max {:.4e} m, mean {:.4e} m", self.amplitude_m.max, self.amplitude_m.mean),
        );
        match &self.wavelength_m {
            Some(w) => row(
                "wavelength",
                format!("min {:.4e} m, median {:.4e} m, max {:.4e} m", w.min, w.median, w.max),
            ),
            None => row("wavelength", "nothing wrinkles".to_owned()),
        }
        if !self.periods.is_empty() {
            let mut text: Vec<String> =
                self.periods.iter().take(8).map(ToString::to_string).collect();
            if self.periods.len() > 8 {
                text.push(format!("… ({} loops)", self.periods.len()));
            }
            row(
                "waves around loops",
                format!(
                    "{} ({:.2} before rounding)",
                    text.join(", "),
                    self.periods_before_rounding[0]
                ),
            );
        }
        for measured in &self.measures {
            row(&measured.name, measured_row(measured));
        }
        row(
            "surface",
            format!(
                "{} levels, {} vertices, {} faces",
                self.surface.levels, self.surface.vertices, self.surface.faces
            ),
        );
        let s = &self.seconds;
        row(
            "seconds",
            format!(
                "base {:.3}, field {:.3}, phase {:.3}, surface {:.3}, total {:.3}",
                s.base, s.field, s.phase, s.surface, s.total
            ),
        );
        for note in &self.notes {
            table += &format!("  note: {note}\n");
        }
        table
    }
}

/// A measured number beside the published one.
pub(crate) fn measured_row(measured: &Measured) -> String {
    let unit = if measured.unit.is_empty() { String::new() } else { format!(" {}", measured.unit) };
    let mut text = format!("{:.4}{unit}", Plain(measured.value));
    if let Some(published) = measured.published {
        text += &format!(", published {}{unit}", Plain(published));
        if let Some(source) = &measured.source {
            text += &format!(" ({source})");
        }
    }
    text
}

/// A number without needless digits: small ones in scientific notation.
struct Plain(f64);

impl std::fmt::Display for Plain {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let v = self.0;
        if v == 0.0 || (1e-2..1e6).contains(&v.abs()) {
            write!(f, "{}", (v * 100.0).round() / 100.0)
        } else {
            write!(f, "{v:.3e}")
        }
    }
}

/// A few words for the end of a reference shell's solve.
pub(crate) fn shell_ending(report: &ReferenceReport) -> &'static str {
    if report.is_stuck() { "stuck" } else { ending_name(report.ending) }
}

/// A few words for the end of a minimisation.
pub(crate) fn ending_name(ending: Ending) -> &'static str {
    ending.name()
}

impl From<&BaseReport> for BaseSummary {
    fn from(base: &BaseReport) -> Self {
        Self {
            iterations: base.iterations,
            ending: ending_name(base.ending),
            energy_joule: base.energy_joule,
            gradient_newton: base.gradient_newton,
            slack_faces: base.states[0],
            mixed_faces: base.states[1],
            taut_faces: base.states[2],
            collapsed_faces: base.collapsed_faces.clone(),
            inverted_faces: base.inverted_faces.clone(),
        }
    }
}
