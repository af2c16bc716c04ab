//! Subjects by formula, for the tests of pictures.

use super::{Camera, Image, Paint, PanelView, Subject, draw};
use crate::mesh::{Up, Vec3};
use std::f64::consts::TAU;

/// A grid over the unit square, mapped to space.
pub(super) struct Grid {
    pub(super) positions: Vec<Vec3>,
    pub(super) faces: Vec<[usize; 3]>,
    /// `[V][2]` where in the unit square each vertex lies.
    pub(super) square: Vec<[f64; 2]>,
}

/// A grid of `m` by `n` cells.
pub(super) fn grid(m: usize, n: usize, map: impl Fn(f64, f64) -> Vec3) -> Grid {
    let square: Vec<_> = (0..=n)
        .flat_map(|j| (0..=m).map(move |i| [i as f64 / m as f64, j as f64 / n as f64]))
        .collect();
    let mut faces = Vec::new();
    for j in 0..n {
        for i in 0..m {
            let a = j * (m + 1) + i;
            let (b, c, d) = (a + 1, a + m + 1, a + m + 2);
            faces.extend(if (i + j) % 2 == 0 {
                [[a, b, d], [a, d, c]]
            } else {
                [[a, b, c], [b, d, c]]
            });
        }
    }
    Grid { positions: square.iter().map(|&[u, v]| map(u, v)).collect(), faces, square }
}

impl Grid {
    pub(super) fn subject(&self) -> Subject<'_> {
        Subject { positions: &self.positions, faces: &self.faces }
    }

    fn values(&self, f: impl Fn(f64, f64) -> f64) -> Vec<f64> {
        self.square.iter().map(|&[u, v]| f(u, v)).collect()
    }

    fn corners(&self, f: impl Fn(f64, f64) -> f64) -> Vec<[f64; 3]> {
        self.faces
            .iter()
            .map(|face| face.map(|v| f(self.square[v][0], self.square[v][1])))
            .collect()
    }
}

/// The four panels of a base shape `base(u, v, w)` (m; `w` is the height over it) with waves.
fn four(
    coarse: (usize, usize),
    fine: (usize, usize),
    base: impl Fn(f64, f64, f64) -> Vec3,
    amplitude: impl Fn(f64, f64) -> f64,
    phase: impl Fn(f64, f64) -> f64,
    look: impl Fn(&[Vec3]) -> Camera,
    size: (usize, usize),
) -> Image {
    let plain = grid(coarse.0, coarse.1, |u, v| base(u, v, 0.0));
    let wrinkled = grid(fine.0, fine.1, |u, v| base(u, v, amplitude(u, v) * phase(u, v).cos()));
    let millimetres = plain.values(|u, v| 1e3 * amplitude(u, v));
    let corners = plain.corners(phase);
    let tension: Vec<bool> =
        plain.faces.iter().map(|f| f.iter().all(|&v| millimetres[v] < 1e-9)).collect();
    let corners: Vec<_> =
        corners.into_iter().zip(tension).map(|(c, t)| if t { [f64::NAN; 3] } else { c }).collect();
    let maximum = millimetres.iter().fold(0f64, |m, &a| m.max(a));
    let panels = [
        PanelView {
            title: "Base surface",
            subject: plain.subject(),
            paint: Paint::Plain { colour: [196, 204, 214], wireframe: true },
        },
        PanelView {
            title: "Amplitude",
            subject: plain.subject(),
            paint: Paint::Scalar { values: &millimetres, maximum, unit: "mm" },
        },
        PanelView {
            title: "Phase",
            subject: plain.subject(),
            paint: Paint::Phase { corners: &corners },
        },
        PanelView {
            title: "Wrinkled surface",
            subject: wrinkled.subject(),
            paint: Paint::Plain { colour: [150, 178, 206], wireframe: false },
        },
    ];
    draw(&panels, &look(&plain.positions), size)
}

pub(super) fn cylinder(fine: (usize, usize), size: (usize, usize)) -> Image {
    four(
        (48, 12),
        fine,
        |u, v, w| Vec3::new((0.1 + w) * (TAU * u).cos(), (0.1 + w) * (TAU * u).sin(), 0.2 * v),
        |_, v| (1.5e-3 * (TAU / 2.0 * v).sin() - 0.1e-3).max(0.0),
        |u, _| 46.0 * TAU * u,
        |p| Camera::automatic(p, Up::Z),
        size,
    )
}
