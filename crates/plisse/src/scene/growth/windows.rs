//! Windows of panels in which folds are counted.

use std::f64::consts::TAU;

use crate::Result;
use crate::mesh::Vec2;
use crate::relief::{Relief, Window};
use crate::scene::placed::PlacedSurface;
use crate::scene::schema::{CountTable, PanelAxis, PanelTable, Shape};

/// Points of the window to a wavelength along the growth, and rows across.
pub(super) const POINTS: (f64, usize) = (24.0, 41);
/// Fewest and most points along the growth.
pub(super) const SIZES: [f64; 2] = [64.0, 1200.0];
/// A window as wide as a panel goes around, within this part, has no rims.
const WHOLE: f64 = 1e-6;
/// Half the height of the belt in which the folds of a sphere are counted, over its radius.
const BELT: f64 = 0.3;

/// A window, on a chart whose first length (m) runs across the folds.
#[derive(Clone, Debug)]
pub(super) struct CountWindow {
    pub(super) name: String,
    pub(super) window: Window,
    /// True if the window goes around something.
    pub(super) around: bool,
    /// True if the panel is closed.
    pub(super) closed: bool,
    /// Faces, their corners in the chart.
    pub(super) faces: Vec<(usize, [Vec2; 3])>,
}

impl CountWindow {
    pub(super) fn relief(
        &self,
        faces: impl Iterator<Item = ([Vec2; 3], [f64; 3])>,
        points: usize,
    ) -> Result<Relief> {
        let size = [points, POINTS.1];
        let sampled = if self.around { Relief::around } else { Relief::from_corners };
        Ok(Relief { steep: self.closed, ..sampled(faces, &self.window, size)? })
    }
}

/// After how much (m) a panel's coordinates begin again, and the window that is meant if none is
/// given; nothing for flat panels.
pub(super) type Extent = [Option<[f64; 2]>; 3];

/// The extent of a panel.
pub(super) fn extent(panel: &PanelTable) -> Extent {
    let (radius, tube) =
        (panel.radius_m.unwrap_or_default(), panel.tube_radius_m.unwrap_or_default());
    let round = TAU * radius;
    match panel.shape {
        // A belt along the equator, where spacings are those of the chart.
        Shape::Sphere => [
            Some([round, f64::INFINITY]),
            Some([0.0, -BELT * radius]),
            Some([round, BELT * radius]),
        ],
        Shape::Torus => [Some([round, TAU * tube]), Some([0.0, 0.0]), Some([round, TAU * tube])],
        _ => [None; 3],
    }
}

/// The windows of the scene.
pub(super) fn windows(
    counts: &[CountTable],
    extents: &[Extent],
    placed: &PlacedSurface,
) -> Result<Vec<CountWindow>> {
    let mut windows = Vec::new();
    for (i, count) in counts.iter().enumerate() {
        let Some(n) = placed.panels.iter().position(|panel| panel.name == count.panel) else {
            continue;
        };
        let (panel, [periods, low, high]) = (&placed.panels[n], extents[n]);
        let corners = |f: usize| placed.panel_corners(f);
        let window = match (
            count.low_m.or(low),
            count.high_m.or(high),
            count.centre_m,
            count.radius_m,
            count.width_m,
        ) {
            (Some(low), Some(high), None, ..) => {
                let turned = count.along == Some(PanelAxis::Y);
                let chart = |p: Vec2| if turned { Vec2::new(p.y, p.x) } else { p };
                let window = Window { low: chart(low.into()), high: chart(high.into()) };
                let periods = periods.map(|p| chart(p.into()));
                let around = periods
                    .is_some_and(|p| ((window.high - window.low).x / p.x - 1.0).abs() < WHOLE);
                // Once for each turn by which a closed panel comes again.
                let turns = |axis: usize| {
                    if periods.is_some_and(|p| p[axis].is_finite()) { -1..=1 } else { 0..=0 }
                };
                let shifts: Vec<Vec2> = turns(1)
                    .flat_map(|j| turns(0).map(move |i| Vec2::new(f64::from(i), f64::from(j))))
                    .collect();
                let mut faces = Vec::with_capacity(shifts.len() * panel.faces.len());
                for f in panel.faces.clone() {
                    for turn in &shifts {
                        let by = Vec2::from_fn(|axis, _| {
                            if turn[axis] == 0.0 {
                                0.0
                            } else {
                                turn[axis] * periods.map_or(0.0, |p| p[axis])
                            }
                        });
                        faces.push((f, corners(f).map(|p| chart(p) + by)));
                    }
                }
                CountWindow {
                    name: count.name.clone(),
                    window,
                    around,
                    closed: periods.is_some(),
                    faces,
                }
            }
            (_, _, Some(centre), Some(radius), Some(width)) => {
                let round = TAU * radius;
                let window = Window {
                    low: Vec2::new(0.0, radius - 0.5 * width),
                    high: Vec2::new(round, radius + 0.5 * width),
                };
                let mut faces = Vec::new();
                for f in panel.faces.clone() {
                    let polar = corners(f)
                        .map(|p| p - Vec2::from(centre))
                        .map(|d| Vec2::new(d.y.atan2(d.x) * radius, d.norm()));
                    // Each face in one piece, and again one turn further on.
                    let whole = polar.map(|p| {
                        Vec2::new(p.x - round * ((p.x - polar[0].x) / round).round(), p.y)
                    });
                    for turn in [0.0, 1.0] {
                        faces.push((f, whole.map(|p| Vec2::new(p.x + turn * round, p.y))));
                    }
                }
                CountWindow { name: count.name.clone(), window, around: true, closed: false, faces }
            }
            _ => continue,
        };
        // That the window lies on the panel is found before anything has grown.
        let flat = window.faces.iter().map(|&(_, corners)| (corners, [0.0; 3]));
        window
            .relief(flat, SIZES[0] as usize)
            .map_err(|error| error.about(format!("growth.count[{i}]")))?;
        windows.push(window);
    }
    Ok(windows)
}
