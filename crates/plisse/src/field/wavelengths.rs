//! The wavelengths of what wrinkles visibly.

use serde::Serialize;

use super::WrinkleField;
use crate::sheet::Sheet;

/// Mean amplitude of a face, relative to the largest of all vertices, from which it counts as
/// visibly wrinkled.
const VISIBLE: f64 = 0.01;

/// Wavelengths (m) of the visibly wrinkled faces of a field.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Wavelengths {
    /// The smallest.
    pub min: f64,
    /// The median.
    pub median: f64,
    /// The largest.
    pub max: f64,
}

impl WrinkleField {
    /// Largest amplitude (m); 0 where nothing wrinkles.
    pub fn largest_amplitude_m(&self) -> f64 {
        self.amplitude_m.iter().copied().fold(0.0, f64::max)
    }

    /// Wavelengths of the wrinkled faces whose amplitude is at least 1 % of the largest; `None`
    /// where nothing wrinkles.
    pub fn wavelengths(&self, sheet: &Sheet) -> Option<Wavelengths> {
        let topology = &sheet.topology;
        let largest = self.largest_amplitude_m();
        let visible = |f: &usize| {
            let mean = topology.faces[*f].iter().map(|&v| self.amplitude_m[v]).sum::<f64>() / 3.0;
            !self.wrinkle_free[*f] && largest > 0.0 && mean >= VISIBLE * largest
        };
        let lengths = (0..topology.face_count())
            .filter(visible)
            .map(|f| std::f64::consts::TAU / self.frequency(sheet, f).norm());
        let mut list: Vec<f64> = lengths.filter(|w| w.is_finite()).collect();
        list.sort_by(f64::total_cmp);
        Some(Wavelengths { min: *list.first()?, median: list[list.len() / 2], max: *list.last()? })
    }
}
