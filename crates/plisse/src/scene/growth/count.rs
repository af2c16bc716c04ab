//! Folds counted in windows of panels, and what was reached there.

use serde::Serialize;

use super::build::BuiltGrowth;
use super::windows::{POINTS, SIZES};
use crate::Result;
use crate::mesh::{Vec2, Vec3};
use crate::relief::{RealisedGrowth, Window, offsets_m, realised_growth};
use crate::rest::RestMetric;

/// Growth (factor of length) from which on a face counts as one that grows.
const GROWS: f64 = 1.001;

/// Folds and growth in one window. Field names carry the units.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FoldCount {
    /// Name of the window.
    pub name: String,
    /// λ asked for (m), mean over the window.
    pub asked_wavelength_m: f64,
    /// Spacing of the folds on the starting surface (m), by the peak of their spectrum; none where
    /// nothing folds.
    pub wavelength_m: Option<f64>,
    /// Folds across the window.
    pub folds: Option<f64>,
    /// Width of the peak at half its height, over its place.
    pub peak_width: Option<f64>,
    /// Share of the window where crests run within 10° of perpendicular to the growth.
    pub crests_within_10_deg: f64,
    /// Length over which crests run straight (m): at it half of the correlation is left.
    pub correlation_m: Option<f64>,
    /// Root of the mean square offset (m).
    pub roughness_m: f64,
    /// Length reached along the growth, over the one asked for.
    pub length_reached: f64,
    /// Area reached, over the one asked for.
    pub area_reached: f64,
}

impl BuiltGrowth {
    /// Counts the folds of `pose` (`[V]`, m), of which the metric `asked` was asked.
    ///
    /// # Errors
    /// [`Error::Mesh`](crate::Error::Mesh) if the starting surface has no normal somewhere.
    pub fn count(&self, pose: &[Vec3], asked: &RestMetric) -> Result<Vec<FoldCount>> {
        let topology = &self.built.sheet.topology;
        let offset = offsets_m(topology, &self.built.start, pose)?;
        let along = self.along();
        let mut counted = Vec::new();
        for place in &self.windows {
            let Window { low, high } = place.window;
            let inside = |p: &Vec2| (0..2).all(|axis| (low[axis]..=high[axis]).contains(&p[axis]));
            let mut within = vec![false; topology.face_count()];
            place
                .faces
                .iter()
                .filter(|(_, corners)| corners.iter().all(inside))
                .for_each(|&(f, _)| within[f] = true);
            let faces: Vec<usize> = (0..within.len()).filter(|&f| within[f]).collect();
            let waves = faces
                .iter()
                .flat_map(|&f| topology.faces[f])
                .map(|v| self.maps.vertices[v].wavelength_m);
            let asked_wavelength_m = waves.sum::<f64>() / (3 * faces.len()).max(1) as f64;
            let extent = (high - low).x;
            let points = (POINTS.0 * extent / asked_wavelength_m).clamp(SIZES[0], SIZES[1]);
            let corners = place
                .faces
                .iter()
                .map(|&(f, corners)| (corners, topology.faces[f].map(|v| offset[v])));
            let relief = place.relief(corners, points as usize)?;
            let folds = relief.folds();
            let got = realised_growth(topology, &self.built.start, asked, pose, |f| {
                within[f].then(|| along[f])
            });
            counted.push(FoldCount {
                name: place.name.clone(),
                asked_wavelength_m,
                wavelength_m: folds.map(|f| f.wavelength_m),
                folds: folds.map(|f| extent / f.wavelength_m),
                peak_width: folds.map(|f| f.width),
                crests_within_10_deg: relief
                    .crests_within(10_f64.to_radians(), 0.5 * asked_wavelength_m),
                correlation_m: relief.correlation_m(),
                roughness_m: relief.roughness_m(),
                length_reached: got.length,
                area_reached: got.area,
            });
        }
        Ok(counted)
    }

    /// The share of the growth in `asked` that the faces reached which grow and touch nothing
    /// frozen; `None` if there is no such face.
    pub fn reached(&self, pose: &[Vec3], asked: &RestMetric) -> Option<RealisedGrowth> {
        let mut banded = vec![false; pose.len()];
        self.maps.bands.iter().flatten().for_each(|&v| banded[v] = true);
        let free = |v: usize| self.maps.vertices[v].frozen == [false; 3] && !banded[v];
        let counts = |f: usize| {
            let face = self.built.sheet.topology.faces[f];
            face.into_iter().all(free)
                && face.into_iter().any(|v| self.maps.vertices[v].growth.principal().0[0] > GROWS)
        };
        let (topology, along) = (&self.built.sheet.topology, self.along());
        let any = (0..topology.face_count()).any(counts);
        let of_face = |f: usize| counts(f).then(|| along[f]);
        any.then(|| realised_growth(topology, &self.built.start, asked, pose, of_face))
    }

    /// `[F]` the direction along which the corner that grows most does.
    fn along(&self) -> Vec<Vec3> {
        let of = |face: &[usize; 3]| {
            let corners = face.map(|v| self.maps.vertices[v].growth.principal());
            let most =
                (0..3).max_by(|&a, &b| corners[a].0[0].total_cmp(&corners[b].0[0])).unwrap_or(0);
            corners[most].1[0]
        };
        self.built.sheet.topology.faces.iter().map(of).collect()
    }
}
