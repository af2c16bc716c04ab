//! The field solve against answers that others found: the published amplitudes of the paper's
//! inflated disk, and energies, amplitudes and turns of disk and twisted cylinder measured with an
//! independent trial solver.
//!
//! The data is not part of the project; it lies in `shared/data` beside the clone
//! (`../../../shared/data` from this crate), on the machines of the project and in CI. Without it
//! these tests compare nothing: each says so on the error stream (nextest hides that for passing
//! tests; `--success-output immediate` shows it) and returns. With `PLISSE_NEED_DATA` set, as CI
//! should, missing data fails.

mod sheets;

use std::path::{Path, PathBuf};

use plisse::field::{FieldOptions, Period, WrinkleFreeRule};
use plisse::io::{clamp_file, obj};
use plisse::linalg::Ending;

use sheets::{Sheet, mylar};

/// The folder `name` of the data; `None`, with a note, where there is none.
fn data(name: &str) -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data").join(name);
    if folder.is_dir() {
        return Some(folder);
    }
    assert!(std::env::var_os("PLISSE_NEED_DATA").is_none(), "no folder {}", folder.display());
    eprintln!("NOT RUN: there is no folder {}; nothing was compared", folder.display());
    None
}

fn load(folder: &Path) -> Sheet {
    let rest = obj::read(&folder.join("rest.obj")).unwrap();
    let pose = obj::read(&folder.join("pose.obj")).unwrap();
    assert_eq!(rest.faces.len(), pose.faces.len());
    Sheet::new(rest.positions, rest.faces, pose.faces, pose.positions)
}

fn options() -> FieldOptions {
    FieldOptions { rule: WrinkleFreeRule::Published, curvature_rings: 5, ..FieldOptions::default() }
}

fn assert_near(name: &str, found: f64, wanted: f64, relative: f64) {
    let off = (found / wanted - 1.0).abs();
    note(name, found, off);
    assert!(
        off < relative,
        "{name} is {found:e}, {off:.1e} from {wanted:e}; at most {relative:e} is allowed"
    );
}

fn note(name: &str, found: f64, off: f64) {
    eprintln!("{name}: {found:.9e}, {off:.1e} off");
}

fn largest(values: &[f64]) -> f64 {
    values.iter().copied().fold(0.0, f64::max)
}

#[test]
fn the_disk_has_the_published_amplitudes() {
    let Some(folder) = data("tfw-disk") else { return };
    let sheet = load(&folder);
    let solved = sheet.solve(&mylar(), &options());
    let (field, report) = (&solved.field, &solved.report);
    assert!(matches!(report.ending, Ending::Converged | Ending::RoundOff), "{:?}", report.ending);
    assert!(report.projected_gradient < 1e-8, "{:e}", report.projected_gradient);
    assert_near("energy", report.energy_joule, 1.973_936_388e-2, 2e-3);
    assert_near("wrinkle-free energy", report.wrinkle_free_energy_joule, 6.553_213e-3, 1e-6);
    assert_near("largest amplitude", largest(&field.amplitude_m), 1.054_432e-3, 1e-2);
    assert_eq!(report.periods[0].turns, 85, "{:?}", report.periods);

    let text = std::fs::read_to_string(folder.join("amplitude.txt")).unwrap();
    let published: Vec<f64> = text.split_whitespace().map(|w| w.parse().unwrap()).collect();
    assert_eq!(published.len(), field.amplitude_m.len());
    let (mut difference, mut size) = (0.0, 0.0);
    for (found, wanted) in field.amplitude_m.iter().zip(&published) {
        difference += (found - wanted).powi(2);
        size += wanted * wanted;
    }
    let off = (difference / size).sqrt();
    note("amplitudes", largest(&published), off);
    assert!(off < 1e-2, "amplitudes are {off:.1e} off the published ones (root mean square)");
}

#[test]
fn the_cylinder_has_47_waves() {
    let Some(folder) = data("cylinder-688") else { return };
    let mut sheet = load(&folder);
    for v in clamp_file::read_clamped_vertices(&folder.join("clamp.dat"), sheet.held.len()).unwrap()
    {
        sheet.held[v] = true;
    }
    let solved = sheet.solve(&mylar(), &options());
    let report = &solved.report;
    assert!(report.projected_gradient < 1e-8, "{:e}", report.projected_gradient);
    assert_near("energy", report.energy_joule, 8.035_659_9e-1, 1e-3);
    assert_near("largest amplitude", largest(&solved.field.amplitude_m), 1.4623e-2, 1e-2);
    let Period { turns, before_rounding, .. } = report.periods[0];
    note("turns before rounding", before_rounding, before_rounding / 46.57 - 1.0);
    assert!((before_rounding - 46.57).abs() < 0.3, "{before_rounding}");
    assert_eq!(turns, 47);
}
