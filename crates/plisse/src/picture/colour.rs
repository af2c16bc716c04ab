//! Colours: the maps of the amplitude and phase panels, and sRGB to and from light.
//!
//! Light is linear RGB, 1 being white. It is what the sampler averages.

/// Colour of cloth in exported GLB files: a brick red (linear RGBA).
pub const CLOTH: [f32; 4] = [0.72, 0.38, 0.30, 1.0];

/// Linear red, green, blue.
pub(super) type Light = [f32; 3];

/// The light of an sRGB colour.
pub(super) fn light_from_srgb(colour: [u8; 3]) -> Light {
    colour.map(|c| linear(f32::from(c) / 255.0))
}

/// The nearest sRGB colour; light beyond white becomes white.
pub(super) fn srgb_from_light(light: Light) -> [u8; 3] {
    light.map(|l| {
        let l = l.clamp(0.0, 1.0);
        let encoded = if l <= 0.003_130_8 { 12.92 * l } else { 1.055 * l.powf(1.0 / 2.4) - 0.055 };
        (255.0 * encoded).round() as u8
    })
}

/// The light of the viridis map at `t`, 0 (dark violet) to 1 (yellow). A polynomial fit, off by at
/// most two of 255 steps at the ends.
pub(super) fn viridis(t: f32) -> Light {
    const COEFFICIENTS: [[f32; 3]; 7] = [
        [0.277_727_33, 0.005_407_344_5, 0.334_099_8],
        [0.105_093_04, 1.404_613_5, 1.384_590_1],
        [-0.330_861_83, 0.214_847_56, 0.095_095_16],
        [-4.634_230_6, -5.799_101, -19.332_441],
        [6.228_27, 14.179_934, 56.690_55],
        [4.776_385, -13.745_146, -65.353_03],
        [-5.435_456, 4.645_852_6, 26.312_435],
    ];
    let t = t.clamp(0.0, 1.0);
    std::array::from_fn(|k| {
        let encoded = COEFFICIENTS.iter().rev().fold(0.0, |sum, c| sum * t + c[k]);
        linear(encoded.clamp(0.0, 1.0))
    })
}

/// The light of a phase with this cosine and sine: a tilted circle in Oklab, light yellow at 0,
/// green at π/2, dark blue at π, red at 3π/2. Both lightness and hue go round once per wave, so
/// isolines show in grey as well. Shrinking both arguments fades to the circle's middle, a grey.
pub(super) fn cyclic(cos: f32, sin: f32) -> Light {
    const HUE: (f32, f32) = (-0.087, 0.996);
    let lightness = 0.645 + 0.275 * cos;
    let chroma = 0.145;
    let a = chroma * (HUE.0 * cos - HUE.1 * sin);
    let b = chroma * (HUE.1 * cos + HUE.0 * sin);
    let l = (lightness + 0.396_337_78 * a + 0.215_803_76 * b).powi(3);
    let m = (lightness - 0.105_561_346 * a - 0.063_854_17 * b).powi(3);
    let s = (lightness - 0.089_484_18 * a - 1.291_485_5 * b).powi(3);
    [
        (4.076_741_7 * l - 3.307_711_6 * m + 0.230_969_94 * s).clamp(0.0, 1.0),
        (-1.268_438 * l + 2.609_757_4 * m - 0.341_319_38 * s).clamp(0.0, 1.0),
        (-0.004_196_086_3 * l - 0.703_418_6 * m + 1.707_614_7 * s).clamp(0.0, 1.0),
    ]
}

fn linear(encoded: f32) -> f32 {
    if encoded <= 0.040_45 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn srgb_survives_light() {
        for c in 0..=255 {
            assert_eq!(srgb_from_light(light_from_srgb([c, 255 - c, c])), [c, 255 - c, c]);
        }
    }

    #[test]
    fn viridis_passes_through_its_known_colours() {
        for (t, expected) in [
            (0.0, [68, 1, 84]),
            (0.25, [59, 82, 139]),
            (0.5, [33, 145, 140]),
            (0.75, [94, 201, 98]),
            (1.0, [253, 231, 37]),
        ] {
            let got = srgb_from_light(viridis(t));
            for k in 0..3 {
                assert!(
                    i32::from(got[k]).abs_diff(expected[k]) <= 5,
                    "at {t}: {got:?}, not {expected:?}"
                );
            }
        }
    }

    #[test]
    fn a_crest_is_lighter_than_a_trough_and_the_flanks_differ_in_hue() {
        let grey = |c: Light| 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
        assert!(grey(cyclic(1.0, 0.0)) > 8.0 * grey(cyclic(-1.0, 0.0)));
        let (rising, falling) = (cyclic(0.0, 1.0), cyclic(0.0, -1.0));
        assert!(rising[1] > rising[0] && falling[0] > falling[1]);
    }
}
