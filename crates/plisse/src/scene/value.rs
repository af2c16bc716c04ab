//! Checks of single values of a scene file.

use std::path::Path;

use crate::mesh::Vec3;
use crate::{Error, Result};

/// Longest length and largest coordinate (m): the square of a longer one is of no use.
const FARTHEST_M: f64 = 1e9;

/// An angle in degrees.
pub(super) fn angle(field: &str, angle_deg: f64) -> Result<()> {
    if angle_deg.is_nan() || angle_deg.abs() > 1e6 {
        return Err(Error::value(
            field,
            format!("{angle_deg} is no usable angle; give degrees between -1e6 and 1e6"),
        ));
    }
    Ok(())
}

/// Unit vector along `axis`.
pub(super) fn direction(field: &str, axis: [f64; 3]) -> Result<Vec3> {
    in_reach(field, &axis)?;
    let axis = Vec3::from(axis);
    axis.try_normalize(1e-100).ok_or_else(|| {
        Error::value(field, "the axis has no length; give a direction such as [0.0, 0.0, 1.0]")
    })
}

pub(super) fn not_blank(field: &str, text: &str) -> Result<()> {
    if text.trim().is_empty() {
        Err(Error::value(field, "this is empty; write a name"))
    } else {
        Ok(())
    }
}

pub(super) fn positive(field: &str, value: f64) -> Result<f64> {
    if value > 0.0 && value <= FARTHEST_M {
        Ok(value)
    } else {
        Err(Error::value(
            field,
            format!(
                "{value} is no usable length; give a number of metres above 0 and at most \
                 {FARTHEST_M:e}"
            ),
        ))
    }
}

pub(super) fn in_reach(field: &str, values: &[f64]) -> Result<()> {
    match values.iter().find(|value| value.is_nan() || value.abs() > FARTHEST_M) {
        None => Ok(()),
        Some(value) => Err(Error::value(
            field,
            format!("{value} is no usable number; give finite ones of at most {FARTHEST_M:e}"),
        )),
    }
}

pub(super) fn within(field: &str, value: Option<usize>, low: usize, high: usize) -> Result<()> {
    match value {
        Some(value) if !(low..=high).contains(&value) => Err(Error::value(
            field,
            format!("{value} is out of range; give a whole number from {low} to {high}"),
        )),
        _ => Ok(()),
    }
}

/// Refuses a path of blanks.
pub(super) fn not_blank_path(field: &str, path: &Path) -> Result<()> {
    if path.to_string_lossy().trim().is_empty() {
        Err(Error::value(field, "this is empty; write the path of an OBJ file"))
    } else {
        Ok(())
    }
}
