//! The material of a thin sheet: isotropic St. Venant–Kirchhoff, plane stress.

use crate::error::SetupError;
use crate::mesh::Mat2;
use crate::{Error, Result};

/// Constants of an isotropic thin sheet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Young's modulus Y (Pa), > 0.
    pub young_pa: f64,
    /// Poisson's ratio ν (no unit), −1 < ν ≤ 0.5.
    pub poisson: f64,
    /// Thickness h (m), > 0.
    pub thickness_m: f64,
}

impl Material {
    /// A checked material.
    ///
    /// ```
    /// use plisse::Material;
    ///
    /// // Young's modulus (Pa), Poisson's ratio, thickness (m).
    /// let cloth = Material::new(1e5, 0.3, 5e-4)?;
    /// assert!(Material::new(1e5, 0.7, 5e-4).is_err());
    /// # Ok::<(), plisse::Error>(())
    /// ```
    ///
    /// Ranges: 1e-3 Pa ≤ Y ≤ 1e15 Pa, −1 < ν ≤ 0.5, 1e-9 m ≤ h ≤ 10 m, wide of any
    /// cloth or film.
    ///
    /// # Errors
    /// [`Error::Value`] if a constant is not finite or out of its range.
    pub fn new(young_pa: f64, poisson: f64, thickness_m: f64) -> Result<Self> {
        if !(1e-3..=1e15).contains(&young_pa) {
            let message = format!(
                "Young's modulus is {young_pa} Pa; give a number above 0, from 1e-3 to 1e15 (1e5 \
                 for cloth, 1e9 for plastic)"
            );
            return Err(Error::value("young", message));
        }
        if !(poisson > -1.0 && poisson <= 0.5) {
            return Err(Error::value(
                "poisson",
                format!("Poisson's ratio is {poisson}; give a number above -1 and at most 0.5"),
            ));
        }
        if !(1e-9..=10.0).contains(&thickness_m) {
            let message = format!(
                "the thickness is {thickness_m} m; give a number above 0, from 1e-9 to 10 (1e-4 is \
                 a tenth of a millimetre)"
            );
            return Err(Error::value("thickness", message));
        }
        Ok(Self { young_pa, poisson, thickness_m })
    }

    /// Holds the thickness against a surface of `area_m2` (m²).
    ///
    /// # Errors
    /// [`SetupError::NotThin`] if the surface is no thin sheet: thicker than a square of its area
    /// is wide.
    pub fn check_thin(&self, area_m2: f64) -> Result<()> {
        let width = area_m2.sqrt();
        if self.thickness_m > width {
            let (thickness_m, width_m) = (self.thickness_m, width);
            return Err(SetupError::NotThin { thickness_m, width_m }.into());
        }
        Ok(())
    }

    /// First Lamé constant for plane stress, α = Yν/(1−ν²) (Pa); eq. 33 of [Chen 2021].
    pub fn alpha(&self) -> f64 {
        self.young_pa * self.poisson / (1.0 - self.poisson * self.poisson)
    }

    /// Second Lamé constant, β = Y/(2(1+ν)) (Pa); eq. 33 of [Chen 2021].
    pub fn beta(&self) -> f64 {
        self.young_pa / (2.0 * (1.0 + self.poisson))
    }

    /// ‖M‖²_SV = α/2·tr²M + β·tr(M²) (Pa) of a symmetric `m` in an orthonormal rest frame; eq. 4 of
    /// [Chen 2021].
    pub fn norm_squared(&self, m: &Mat2) -> f64 {
        let trace = m.trace();
        self.alpha() / 2.0 * trace * trace + self.beta() * (m * m).trace()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uniaxial_stress_costs_half_young() {
        // A strip pulled along x narrows by ν: the norm of diag(1, −ν) is Y/2.
        for poisson in [-0.5, 0.0, 0.3, 0.5] {
            let m = Material::new(2e6, poisson, 1e-3).unwrap();
            let norm = m.norm_squared(&Mat2::new(1.0, 0.0, 0.0, -poisson));
            assert!((norm - 1e6).abs() < 1e-6, "{poisson}: {norm}");
        }
    }

    #[test]
    fn absurd_constants_are_refused() {
        for (y, n, h) in [
            (0.0, 0.3, 1.0),
            (f64::NAN, 0.3, 1.0),
            (1.0, 0.51, 1.0),
            (1.0, -1.0, 1.0),
            (1.0, f64::NAN, 1.0),
            (1.0, 0.3, -1.0),
            (1e308, 0.3, 1.0),
            (1.0, 0.3, 1e-200),
        ] {
            assert!(Material::new(y, n, h).is_err(), "{y} {n} {h}");
        }
        let thick = Material::new(1e6, 0.3, 0.5).unwrap();
        assert!(thick.check_thin(1.0).is_ok() && thick.check_thin(0.2).is_err());
    }
}
