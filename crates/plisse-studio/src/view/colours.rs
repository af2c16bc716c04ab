//! Colour scales, as textures: a number is a texture coordinate, so that the renderer needs nothing
//! else.

use plisse_live::Vec2;
use plisse_live::texture::Texture;

/// Number of colours of a scale.
const ENTRIES: usize = 256;
/// Width and height of the wireframe's texture (texels).
const WIRE_SIZE: usize = 256;
/// Width of the lines in it (texels).
const WIRE_WIDTH: f32 = 4.0;

/// A colour scale, or another texture of the renderer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Scale {
    /// The model's own colours.
    Base,
    /// From zero (pale) to the largest number (dark red).
    Heat,
    /// From shorter (blue) by way of equal (white) to longer (red).
    Diverging,
    /// Periodic.
    Phase,
    /// The lines of a mesh.
    Wire,
}

impl Scale {
    /// All, in the order of the renderer's textures.
    pub const ALL: [Self; 5] = [Self::Base, Self::Heat, Self::Diverging, Self::Phase, Self::Wire];

    /// Colour (sRGB) at `t`, 0 to 1.
    pub fn at(self, t: f32) -> [u8; 3] {
        let stops: &[[u8; 3]] = match self {
            Self::Heat => {
                &[[244, 241, 232], [247, 203, 126], [231, 126, 67], [178, 43, 56], [92, 12, 56]]
            }
            Self::Diverging => {
                &[[22, 62, 138], [84, 144, 206], [243, 243, 241], [224, 122, 92], [142, 22, 44]]
            }
            Self::Phase => &[
                [46, 74, 150],
                [120, 170, 200],
                [246, 236, 206],
                [226, 140, 84],
                [150, 60, 88],
                [46, 74, 150],
            ],
            Self::Base | Self::Wire => &[[214, 176, 158], [214, 176, 158]],
        };
        let at = if t.is_finite() { t.clamp(0.0, 1.0) } else { 0.0 } * (stops.len() - 1) as f32;
        let i = (at as usize).min(stops.len() - 2);
        let share = at - i as f32;
        std::array::from_fn(|c| {
            (f32::from(stops[i][c])
                + (f32::from(stops[i + 1][c]) - f32::from(stops[i][c])) * share
                + 0.5) as u8
        })
    }

    /// Its texture; `base` is the model's own.
    pub fn texture(self, base: &Texture) -> Texture {
        let opaque = |[r, g, b]: [u8; 3]| [r, g, b, 255];
        match self {
            Self::Base => base.clone(),
            Self::Wire => wire(),
            _ => Texture {
                width: ENTRIES,
                height: 1,
                rgba: (0..ENTRIES)
                    .map(|i| opaque(self.at(i as f32 / (ENTRIES - 1) as f32)))
                    .collect(),
            },
        }
    }

    /// Texture coordinates of the number `t`, 0 to 1 (a phase may be any number of turns).
    pub fn uv(self, t: f32) -> Vec2 {
        let t = if t.is_finite() { t } else { 0.0 };
        let half = 0.5 / ENTRIES as f32;
        Vec2::new(
            if self == Self::Phase { t } else { t.clamp(0.0, 1.0) * (1.0 - 2.0 * half) + half },
            0.5,
        )
    }
}

/// Texture coordinates of a face's corners on the wireframe's texture.
pub fn wire_uvs() -> [Vec2; 3] {
    [Vec2::new(0.0, 0.0), Vec2::new(1.0, 0.0), Vec2::new(0.0, 1.0)]
}

/// A triangle with dark sides; the other half of the square is its mirror image, which is not seen.
fn wire() -> Texture {
    let (size, width) = (WIRE_SIZE, WIRE_WIDTH);
    let colour = |i: usize| {
        let (x, y) = ((i % size) as f32 + 0.5, (i / size) as f32 + 0.5);
        let diagonal = (x + y - size as f32).abs() / std::f32::consts::SQRT_2;
        let near = x.min(y).min(diagonal).min(size as f32 - x).min(size as f32 - y);
        let share = (near - 0.5 * width + 0.5).clamp(0.0, 1.0);
        let mix = |dark: f32, light: f32| (dark + (light - dark) * share) as u8;
        [mix(38.0, 222.0), mix(48.0, 214.0), mix(66.0, 204.0), 255]
    };
    Texture { width: size, height: size, rgba: (0..size * size).map(colour).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_finds_its_colour() {
        for scale in [Scale::Heat, Scale::Diverging] {
            let texture = scale.texture(&Texture::plain([0; 3]));
            for t in [0.0, 0.25, 0.5, 1.0] {
                let found = texture.at(&scale.uv(t)).map(plisse_live::shade::to_srgb);
                let wanted = scale.at(t);
                assert!(
                    (0..3).all(|c| found[c].abs_diff(wanted[c]) <= 2),
                    "{scale:?} {t}: {found:?} {wanted:?}"
                );
            }
            // Numbers beyond the scale take its ends.
            assert_eq!(scale.uv(7.0), scale.uv(1.0));
        }
        assert_eq!(Scale::Phase.at(0.0), Scale::Phase.at(1.0));
    }
}
