//! Painting folds: dabs of a brush, each followed by a solve of what lies around it, and of nothing
//! else (4.6 of [Combaz & Neyret 2002]).
//!
//! A [`Sculpture`] owns a surface and all that is painted on it. A [`Dab`] changes the values under
//! the brush; then the film around it, up to [`SculptOptions::near`] wavelengths beyond, takes a
//! few Newton steps from where it is. All outside are constants of that small problem: they keep
//! their place to the bit, and how many they are costs nothing. After a stroke,
//! [`Sculpture::settle`] brings all that was touched, and [`SculptOptions::margin`] wavelengths
//! around it, to rest.
//!
//! Contact with obstacles is as stiff as the piece that is solved is small, to a thousandth of its
//! stretching stiffness; weight is exact.

mod change;
mod dab;
mod region;

pub use change::Change;
pub use dab::{Dab, Paint, SurfacePoint};

use web_time::Instant;

use super::equilibrate::{Effort, Scale, Within, areas_and_imperfections, settle_part};
use super::expansion::{Expansion, GrowthTensor};
use super::load_stepping::{GrowthOptions, StepReport};
use super::maps::GrowthMaps;
use super::surface::Growing;
use crate::mesh::normals::try_vertex_normals;
use crate::mesh::reach::Reach;
use crate::mesh::{NONE, Topology, Vec3};
use crate::obstacle::Obstacle;
use crate::progress::{Observer, Silent};
use crate::rest::RestMetric;
use crate::shell::Loads;
use crate::{At, Error, Result};
use region::Region;

/// What is painted on one vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Painted {
    /// How it grows.
    pub growth: GrowthTensor,
    /// λ (m).
    pub wavelength_m: f64,
    /// Λ (m).
    pub coherence_m: f64,
    /// Offset that the surface prefers, in wavelengths.
    pub bias: f64,
    /// How much harder than out the surface goes in.
    pub stickiness: f64,
    /// Axes along which it stays where it is.
    pub frozen: [bool; 3],
}

/// The maps of vertices on which these values are painted, without bands.
fn maps_of<'a>(painted: impl Iterator<Item = &'a Painted> + Clone, hold: Vec<f64>) -> GrowthMaps {
    GrowthMaps {
        expansion: Expansion { vertices: painted.clone().map(|p| p.growth).collect() },
        wavelength_m: painted.clone().map(|p| p.wavelength_m).collect(),
        coherence_m: painted.clone().map(|p| p.coherence_m).collect(),
        bias: painted.clone().map(|p| p.bias).collect(),
        stickiness: painted.clone().map(|p| p.stickiness).collect(),
        frozen: painted.map(|p| p.frozen).collect(),
        hold,
        bands: Vec::new(),
    }
}

/// How a brush is followed.
#[derive(Clone, Debug)]
pub struct SculptOptions {
    /// How far beyond the brush the surface may move, in wavelengths.
    pub margin: f64,
    /// How far beyond the brush it moves already while the brush is followed, in wavelengths; at
    /// most [`SculptOptions::margin`].
    pub near: f64,
    /// Newton iterations after each dab.
    pub iterations: usize,
    /// Largest factor of length up to which a brush grows a place, and one over it the least.
    pub growth_limit: f64,
}

impl Default for SculptOptions {
    fn default() -> Self {
        Self { margin: 1.25, near: 0.75, iterations: 2, growth_limit: 4.0 }
    }
}

/// How a dab, or settling, went.
#[derive(Clone, Debug, Default)]
pub struct SculptReport {
    /// Vertices under the brush.
    pub touched: usize,
    /// Vertices that could move.
    pub active: usize,
    /// Vertices of the problem, with those around that stay.
    pub solved: usize,
    /// The solve; none if nothing could move.
    pub step: Option<StepReport>,
    /// Seconds: finding what is touched and around it, painting and cutting the piece out, solving,
    /// all together.
    pub seconds: [f64; 4],
}

/// A surface that is being painted.
#[derive(Clone, Debug)]
pub struct Sculpture {
    topology: Topology,
    rest: RestMetric,
    start: Vec<Vec3>,
    places: Vec<Vec3>,
    painted: Vec<Painted>,
    pose: Vec<Vec3>,
    loads: Loads,
    /// Point forces (N), by vertex.
    forces: Vec<(usize, Vec3)>,
    obstacles: Vec<Obstacle>,
    contact_thickness_m: f64,
    self_contact: bool,
    /// `[V]` how much of the foundation there is.
    hold: Vec<f64>,
    options: GrowthOptions,
    brush: SculptOptions,
    /// `[V]` normals of the starting surface.
    normals: Vec<Vec3>,
    /// `[V]` its area (m²).
    area_m2: Vec<f64>,
    /// `[V]` imperfections of size 1 (no unit), drawn for the λ that it came with.
    rough: Vec<f64>,
    /// `[V]` faces around each vertex.
    around: Vec<Vec<usize>>,
    scale: Scale,
    reach: Reach,
    /// `[V]` room to count in.
    number: Vec<usize>,
    /// Vertices that are not settled, ascending.
    awake: Vec<usize>,
}

impl Sculpture {
    /// The surface of `growing` in the pose `pose` (`[V]`, m): its starting surface, or what it has
    /// grown to. Frozen axes stay where they are in that pose.
    ///
    /// # Errors
    /// As [`Growing::check`]; [`Error::Value`] if it has bands; [`Error::Mesh`] if the pose has
    /// another number of vertices.
    pub fn new(
        growing: &Growing<'_>,
        pose: Vec<Vec3>,
        options: GrowthOptions,
        brush: SculptOptions,
    ) -> Result<Self> {
        growing.check()?;
        if !growing.maps.bands.is_empty() {
            return Err(Error::value(
                "growth.band",
                "a brush does not move bands as one; freeze them, or grow the whole",
            ));
        }
        let n = growing.start.len();
        if pose.len() != n {
            return Err(Error::mesh(
                "sculpture",
                format!(
                    "the pose has {} vertices and the surface {n}; give the surface's",
                    pose.len()
                ),
            ));
        }
        let surface =
            RestMetric::from_shape(growing.start, &growing.topology.faces).at("sculpture")?;
        let (area_m2, rough) = areas_and_imperfections(growing, &surface, options.seed)?;
        let mut loads = growing.loads.clone();
        let mut forces = std::mem::take(&mut loads.forces_newton);
        forces.sort_by_key(|force| force.0);
        let painted = |v: usize| Painted {
            growth: growing.maps.expansion.vertices[v],
            wavelength_m: growing.maps.wavelength_m[v],
            coherence_m: growing.maps.coherence_m[v],
            bias: growing.maps.bias[v],
            stickiness: growing.maps.stickiness[v],
            frozen: growing.maps.frozen[v],
        };
        Ok(Self {
            painted: (0..n).map(painted).collect(),
            normals: try_vertex_normals(growing.topology, growing.start).at("growth")?,
            area_m2,
            rough,
            around: growing.topology.vertex_faces(),
            scale: Scale::of(growing),
            topology: growing.topology.clone(),
            rest: growing.rest.clone(),
            start: growing.start.to_vec(),
            places: growing.places.clone(),
            pose,
            loads,
            forces,
            obstacles: growing.obstacles.to_vec(),
            contact_thickness_m: growing.contact_thickness_m,
            self_contact: growing.self_contact,
            hold: growing.maps.hold.clone(),
            options,
            brush,
            reach: Reach::new(n),
            number: vec![NONE; n],
            awake: Vec::new(),
        })
    }

    /// Connectivity.
    pub fn topology(&self) -> &Topology {
        &self.topology
    }

    /// `[V]` the starting surface (m).
    pub fn start(&self) -> &[Vec3] {
        &self.start
    }

    /// `[V]` where the surface is now (m).
    pub fn pose(&self) -> &[Vec3] {
        &self.pose
    }

    /// `[V]` what is painted on it.
    pub fn painted(&self) -> &[Painted] {
        &self.painted
    }

    /// Whether a stroke left anything to settle.
    pub fn is_settled(&self) -> bool {
        self.awake.is_empty()
    }

    /// The whole as [`super::grow`] takes it.
    pub fn growing(&self) -> Growing<'_> {
        Growing {
            topology: &self.topology,
            rest: &self.rest,
            start: &self.start,
            places: self.places.clone(),
            maps: maps_of(self.painted.iter(), self.hold.clone()),
            loads: Loads { forces_newton: self.forces.clone(), ..self.loads.clone() },
            obstacles: &self.obstacles,
            contact_thickness_m: self.contact_thickness_m,
            self_contact: self.self_contact,
        }
    }

    /// Touches the surface with a brush and lets what lies around follow. Returns what was
    /// overwritten, to [`Sculpture::restore`] it.
    ///
    /// Small factors (up to 1.1) give the pattern time to choose itself, as the steps of
    /// [`super::grow`] do.
    ///
    /// # Errors
    /// [`Error::Value`] for a brush that is none, or a painted value out of range; [`Error::Mesh`] if grown sides make no triangle. The
    /// sculpture then is as before, to the bit.
    pub fn dab(&mut self, dab: &Dab) -> Result<(Change, SculptReport)> {
        let begun = Instant::now();
        dab.check(self.topology.face_count())?;
        let [a, b, c] = self.topology.faces[dab.spot.face].map(|v| self.painted[v].wavelength_m);
        let mut margin = a.max(b).max(c);
        if let Paint::Wavelength(to) = dab.paint {
            margin = margin.max(to).min(2.0 * margin);
        }
        let (faces, around, start) = (&self.topology.faces, &self.around, &self.start);
        let corners = faces[dab.spot.face];
        let origin: Vec3 = (0..3).map(|k| start[corners[k]] * dab.spot.weights[k]).sum();
        let near = self.reach.from(
            corners,
            &origin,
            |v| around[v].iter().map(|&f| faces[f]),
            |v| start[v],
            dab.radius_m + self.brush.margin * margin,
        );
        let found = begun.elapsed().as_secs_f64();
        let follows_m = dab.radius_m + self.follows() * margin;
        let mut painted: Vec<(usize, Painted)> = Vec::new();
        for &(v, distance) in &near {
            let (strength, old) = (dab.strength(distance), self.painted[v]);
            if strength > 0.0 {
                self.painted[v] = old.under(&dab.paint, strength, &self.brush);
                painted.push((v, old));
            }
        }
        painted.sort_unstable_by_key(|entry| entry.0);
        self.follow_painted(painted, near, follows_m, begun, found)
    }

    /// Gives each of these vertices (ascending) other values, and lets what lies around follow, as
    /// [`Sculpture::dab`] does.
    ///
    /// # Errors
    /// As [`Sculpture::dab`]; [`Error::Value`] for vertices that are not there or not ascending.
    pub fn paint(&mut self, values: &[(usize, Painted)]) -> Result<(Change, SculptReport)> {
        let begun = Instant::now();
        let ascending = values.windows(2).all(|pair| pair[0].0 < pair[1].0);
        if !ascending || values.last().is_some_and(|last| last.0 >= self.pose.len()) {
            return Err(Error::value(
                "paint",
                format!(
                    "the vertices are none of the {}, or not sorted; give each once, ascending",
                    self.pose.len()
                ),
            ));
        }
        if values.is_empty() {
            return Ok((Change::default(), SculptReport::default()));
        }
        let widest = |most: f64, (v, to): &(usize, Painted)| {
            most.max(self.painted[*v].wavelength_m).max(to.wavelength_m)
        };
        let wavelength_m = values.iter().fold(0.0, widest);
        let (margin, follows_m) = (self.brush.margin * wavelength_m, self.follows() * wavelength_m);
        let (faces, around, start) = (&self.topology.faces, &self.around, &self.start);
        let seeds = values.iter().map(|entry| entry.0);
        let near = self.reach.around_all(
            seeds,
            |v| around[v].iter().map(|&f| faces[f]),
            |v| start[v],
            margin,
        );
        let found = begun.elapsed().as_secs_f64();
        let painted = values
            .iter()
            .map(|&(v, to)| (v, std::mem::replace(&mut self.painted[v], to)))
            .collect();
        self.follow_painted(painted, near, follows_m, begun, found)
    }

    /// How far beyond the brush the surface follows it, in wavelengths.
    fn follows(&self) -> f64 {
        self.brush.near.min(self.brush.margin)
    }

    /// Lets the vertices `near` what was painted follow that are at most `follows_m` (m) away, and
    /// wakes all of them; `painted` holds what was there before (ascending).
    fn follow_painted(
        &mut self,
        painted: Vec<(usize, Painted)>,
        near: Vec<(usize, f64)>,
        follows_m: f64,
        begun: Instant,
        found: f64,
    ) -> Result<(Change, SculptReport)> {
        let ascending = |within_m: f64| {
            let mut within: Vec<usize> =
                near.iter().filter(|near| near.1 <= within_m).map(|near| near.0).collect();
            within.sort_unstable();
            within
        };
        let active = ascending(follows_m);
        let effort =
            Effort { iteration_limit: self.brush.iterations, tolerance: self.options.tolerance };
        let (moved, mut report) = match self.follow(&active, effort, &Silent) {
            Ok(followed) => followed,
            Err(error) => {
                painted.iter().for_each(|&(v, old)| self.painted[v] = old);
                return Err(error);
            }
        };
        report.touched = painted.len();
        report.seconds[0] = found;
        let woken: Vec<usize> = ascending(f64::INFINITY)
            .into_iter()
            .filter(|v| self.awake.binary_search(v).is_err())
            .collect();
        self.wake(&woken);
        report.seconds[3] = begun.elapsed().as_secs_f64();
        Ok((Change { poses: moved, painted, woken, calmed: Vec::new() }, report))
    }

    /// Brings all that dabs have touched since the last call to rest. If the observer cancels, or
    /// the limit of iterations comes first, it is not at rest yet and another call goes on.
    ///
    /// # Errors
    /// [`Error::Numeric`] if there is no finite energy; the sculpture then is as before.
    pub fn settle(&mut self, observer: &dyn Observer) -> Result<(Change, SculptReport)> {
        let begun = Instant::now();
        if self.awake.is_empty() {
            return Ok((Change::default(), SculptReport::default()));
        }
        let active = std::mem::take(&mut self.awake);
        let followed = self.follow(&active, Effort::exact(&self.options), observer);
        self.awake = active;
        let (poses, mut report) = followed?;
        let resting =
            report.step.as_ref().is_none_or(|step| step.residual <= self.options.tolerance);
        let calmed = if resting { std::mem::take(&mut self.awake) } else { Vec::new() };
        report.seconds[3] = begun.elapsed().as_secs_f64();
        Ok((Change { poses, calmed, ..Change::default() }, report))
    }

    /// Undoes `change`, which must be the last that was not undone, to the bit. Returns what
    /// restores it again.
    pub fn restore(&mut self, change: Change) -> Change {
        let Change { mut poses, mut painted, woken, calmed } = change;
        poses.iter_mut().for_each(|(v, pose)| std::mem::swap(pose, &mut self.pose[*v]));
        painted.iter_mut().for_each(|(v, value)| std::mem::swap(value, &mut self.painted[*v]));
        self.awake.retain(|v| woken.binary_search(v).is_err());
        self.wake(&calmed);
        Change { poses, painted, woken: calmed, calmed: woken }
    }

    /// Adds `vertices` (ascending, none of them awake) to those that are.
    fn wake(&mut self, vertices: &[usize]) {
        self.awake.extend_from_slice(vertices);
        self.awake.sort_unstable();
    }

    /// Solves for the `active` (ascending) vertices and returns the old poses (m) of those that
    /// moved.
    fn follow(
        &mut self,
        active: &[usize],
        effort: Effort,
        observer: &dyn Observer,
    ) -> Result<(Vec<(usize, Vec3)>, SculptReport)> {
        let begun = Instant::now();
        let mut number = std::mem::take(&mut self.number);
        let region = Region::new(self, active, &mut number);
        self.number = number;
        let region = region?;
        let mut report = SculptReport {
            active: active.len(),
            solved: region.vertices.len(),
            ..SculptReport::default()
        };
        let cut = begun.elapsed().as_secs_f64();
        let mut pose = region.pose.clone();
        if active.iter().any(|&v| self.painted[v].frozen != [true; 3]) {
            let growing = region.growing(self);
            growing.check_painted()?;
            let within = Within {
                still: &region.still,
                pose: &region.pose,
                normals: &region.normals,
                area_m2: &region.of(&self.area_m2),
                rough: &region.of(&self.rough),
                scale: self.scale,
            };
            let step = settle_part(
                &growing,
                1.0,
                effort,
                &self.options,
                Some(&within),
                &mut pose,
                observer,
            )?;
            if step.iterations == 0 {
                // Unknowns are scaled; what did not move keeps its bits.
                pose.clone_from(&region.pose);
            }
            report.step = Some(step);
        }
        let mut moved = Vec::new();
        for (n, &v) in region.vertices.iter().enumerate() {
            if pose[n] != self.pose[v] {
                moved.push((v, std::mem::replace(&mut self.pose[v], pose[n])));
            }
        }
        report.seconds = [0.0, cut, begun.elapsed().as_secs_f64() - cut, 0.0];
        Ok((moved, report))
    }
}
