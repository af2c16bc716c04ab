//! Folds counted in windows of panels, and what was reached there.

use std::f64::consts::TAU;

use serde::Serialize;

use super::BuiltGrowth;
use super::schema::{CountTable, PanelAxis};
use crate::Result;
use crate::mesh::{Vec2, Vec3};
use crate::relief::{RealisedGrowth, Relief, Window, offsets_m, realised_growth};
use crate::rest::RestMetric;
use crate::scene::laid::Laid;
use crate::scene::schema::{PanelTable, Shape};

/// Points of the window to a wavelength along the growth, and rows across.
const POINTS: (f64, usize) = (24.0, 41);
/// Fewest and most points along the growth.
const SIZES: [f64; 2] = [64.0, 1200.0];
/// Growth (factor of length) from which on a face counts as one that grows.
const GROWS: f64 = 1.001;

/// A window as wide as a panel goes around, within this part, has no rims.
const WHOLE: f64 = 1e-6;
/// Half the height of the belt in which the folds of a sphere are counted, over its radius.
const BELT: f64 = 0.3;

/// A window, on a chart whose first length (m) runs across the folds.
#[derive(Clone, Debug)]
pub(super) struct Place {
    name: String,
    window: Window,
    /// Whether it goes around something.
    around: bool,
    /// Whether the panel is closed.
    closed: bool,
    /// Faces, their corners in the chart.
    faces: Vec<(usize, [Vec2; 3])>,
}

impl Place {
    fn relief(
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

/// What stands in one window. Field names carry the units.
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
    /// How far crests run straight (m): where half of the correlation is left.
    pub correlation_m: Option<f64>,
    /// Root of the mean square offset (m).
    pub roughness_m: f64,
    /// Length reached along the growth, over the one asked for.
    pub length_reached: f64,
    /// Area reached, over the one asked for.
    pub area_reached: f64,
}

/// The windows of the scene.
pub(super) fn places(counts: &[CountTable], extents: &[Extent], laid: &Laid) -> Result<Vec<Place>> {
    let mut places = Vec::new();
    for (i, count) in counts.iter().enumerate() {
        let Some(n) = laid.panels.iter().position(|panel| panel.name == count.panel) else {
            continue;
        };
        let (panel, [periods, low, high]) = (&laid.panels[n], extents[n]);
        let corners = |f: usize| laid.panel_corners(f);
        let place = match (
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
                Place { name: count.name.clone(), window, around, closed: periods.is_some(), faces }
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
                Place { name: count.name.clone(), window, around: true, closed: false, faces }
            }
            _ => continue,
        };
        // That the window lies on the panel is found before anything has grown.
        let flat = place.faces.iter().map(|&(_, corners)| (corners, [0.0; 3]));
        place
            .relief(flat, SIZES[0] as usize)
            .map_err(|error| error.about(format!("growth.count[{i}]")))?;
        places.push(place);
    }
    Ok(places)
}

impl BuiltGrowth {
    /// Counts the folds of `pose` (`[V]`, m), of which the metric `asked` was asked.
    ///
    /// # Errors
    /// [`Error::Mesh`](crate::Error::Mesh) if the starting surface has no normal somewhere.
    pub fn count(&self, pose: &[Vec3], asked: &RestMetric) -> Result<Vec<FoldCount>> {
        let topology = &self.built.topology;
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
            let waves =
                faces.iter().flat_map(|&f| topology.faces[f]).map(|v| self.maps.wavelength_m[v]);
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

    /// What the faces that grow and touch nothing frozen reached of what `asked` asks; `None` if
    /// there is no such face.
    pub fn reached(&self, pose: &[Vec3], asked: &RestMetric) -> Option<RealisedGrowth> {
        let mut banded = vec![false; pose.len()];
        self.maps.bands.iter().flatten().for_each(|&v| banded[v] = true);
        let free = |v: usize| self.maps.frozen[v] == [false; 3] && !banded[v];
        let counts = |f: usize| {
            let face = self.built.topology.faces[f];
            face.into_iter().all(free)
                && face
                    .into_iter()
                    .any(|v| self.maps.expansion.vertices[v].principal().0[0] > GROWS)
        };
        let (topology, along) = (&self.built.topology, self.along());
        let any = (0..topology.face_count()).any(counts);
        let of_face = |f: usize| counts(f).then(|| along[f]);
        any.then(|| realised_growth(topology, &self.built.start, asked, pose, of_face))
    }

    /// `[F]` the direction along which the corner that grows most does.
    fn along(&self) -> Vec<Vec3> {
        let of = |face: &[usize; 3]| {
            let corners = face.map(|v| self.maps.expansion.vertices[v].principal());
            let most =
                (0..3).max_by(|&a, &b| corners[a].0[0].total_cmp(&corners[b].0[0])).unwrap_or(0);
            corners[most].1[0]
        };
        self.built.topology.faces.iter().map(of).collect()
    }
}
