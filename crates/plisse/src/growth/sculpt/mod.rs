//! Painting folds: dabs of a brush, each followed by a solve of its surroundings alone (4.6 of
//! [Combaz & Neyret 2002]).
//!
//! A [`Sculpture`] owns a surface and the growth maps painted on it. A [`Dab`] changes the values
//! under the brush; then the film around it, up to [`SculptOptions::near`] wavelengths beyond,
//! takes a few Newton steps from its present pose. All vertices outside are constants of that small
//! problem: they keep their place to the bit, and their number costs nothing. After a stroke,
//! [`Sculpture::equilibrate`] brings the touched vertices, and [`SculptOptions::margin`]
//! wavelengths around them, to equilibrium.
//!
//! Contact with obstacles is as stiff as the piece that is solved is small, to a thousandth of its
//! stretching stiffness; weight is exact.

mod change;
mod dab;
mod region;

pub use change::Change;
pub use dab::{Dab, Paint, SurfacePoint};

use web_time::Instant;

use super::equilibrate::{
    FilmModel, LengthScales, StopCriteria, Subdomain, areas_and_imperfections,
};
use super::load_stepping::{GrowthOptions, StepReport};
use super::maps::GrowthAt;
use super::surface::GrowingSurface;
use crate::adjacency::Csr;
use crate::mesh::normals::try_vertex_normals;
use crate::mesh::reach::Reach;
use crate::mesh::{NONE, Topology, Vec3};
use crate::progress::{Observer, Silent};
use crate::rest::RestMetric;
use crate::{At, Error, Result};
use region::Region;

/// Options of a brush.
#[derive(Clone, Debug)]
pub struct SculptOptions {
    /// Distance beyond the brush within which the surface may move, in wavelengths.
    pub margin: f64,
    /// Distance beyond the brush within which it moves already with every dab, in wavelengths; at
    /// most [`SculptOptions::margin`].
    pub near: f64,
    /// Newton iterations after each dab.
    pub iterations: usize,
    /// Largest factor of length up to which a brush grows a place; its inverse is the least.
    pub growth_limit: f64,
}

impl Default for SculptOptions {
    fn default() -> Self {
        Self { margin: 1.25, near: 0.75, iterations: 2, growth_limit: 4.0 }
    }
}

/// Seconds that a dab took.
#[derive(Clone, Copy, Debug, Default)]
pub struct SculptSeconds {
    /// Finding the vertices under the brush and around it.
    pub search: f64,
    /// Painting, and cutting the piece out.
    pub cut: f64,
    /// Solving.
    pub solve: f64,
    /// All of it.
    pub total: f64,
}

/// Report on a dab, or on bringing the surface to equilibrium.
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
    /// Seconds of its parts.
    pub seconds: SculptSeconds,
}

/// A surface that is being painted.
#[derive(Clone, Debug)]
pub struct Sculpture {
    /// The surface; its point forces are sorted by vertex.
    surface: GrowingSurface,
    pose: Vec<Vec3>,
    options: GrowthOptions,
    brush: SculptOptions,
    /// `[V]` normals of the starting surface.
    normals: Vec<Vec3>,
    /// `[V]` its area (m²).
    area_m2: Vec<f64>,
    /// `[V]` imperfections of size 1 (no unit), drawn for the λ that it came with.
    rough: Vec<f64>,
    /// `[V]` faces around each vertex.
    around: Csr,
    scale: LengthScales,
    reach: Reach,
    /// `[V]` work array for numbering.
    number: Vec<usize>,
    /// Vertices that are not in equilibrium, ascending.
    disturbed: Vec<usize>,
}

/// The vertices around values that were painted.
struct Neighbourhood {
    /// Vertices with their distances (m), up to the margin.
    near: Vec<(usize, f64)>,
    /// Distance (m) up to which vertices move at once.
    follows_m: f64,
    /// Time at which the search began.
    begun: Instant,
    /// Seconds that it took.
    search_seconds: f64,
}

impl Neighbourhood {
    /// Vertices up to this distance (m), ascending.
    fn within(&self, distance_m: f64) -> Vec<usize> {
        let mut within: Vec<usize> =
            self.near.iter().filter(|near| near.1 <= distance_m).map(|near| near.0).collect();
        within.sort_unstable();
        within
    }
}

impl Sculpture {
    /// The surface in the pose `pose` (`[V]`, m): its starting surface, or the one it has grown to.
    /// Frozen axes stay where they are in that pose.
    ///
    /// # Errors
    /// As [`GrowingSurface::check`]; [`Error::Value`] if it has bands; [`Error::Mesh`] if the pose
    /// has another number of vertices.
    pub fn new(
        mut surface: GrowingSurface,
        pose: Vec<Vec3>,
        options: GrowthOptions,
        brush: SculptOptions,
    ) -> Result<Self> {
        surface.check()?;
        if !surface.maps.bands.is_empty() {
            return Err(Error::value(
                "growth.band",
                "a brush does not move bands as one; freeze them, or grow the whole",
            ));
        }
        let n = surface.start.len();
        if pose.len() != n {
            return Err(Error::mesh(
                "sculpture",
                format!(
                    "the pose has {} vertices and the surface {n}; give the surface's",
                    pose.len()
                ),
            ));
        }
        let metric =
            RestMetric::from_shape(&surface.start, &surface.topology.faces).at("sculpture")?;
        let (area_m2, rough) = areas_and_imperfections(&surface, &metric, options.seed)?;
        surface.loads.forces_newton.sort_by_key(|force| force.0);
        Ok(Self {
            normals: try_vertex_normals(&surface.topology, &surface.start).at("growth")?,
            area_m2,
            rough,
            around: surface.topology.vertex_faces(),
            scale: LengthScales::new(&surface),
            surface,
            pose,
            options,
            brush,
            reach: Reach::new(n),
            number: vec![NONE; n],
            disturbed: Vec::new(),
        })
    }

    /// The surface with the values painted on it.
    pub fn surface(&self) -> &GrowingSurface {
        &self.surface
    }

    /// Connectivity.
    pub fn topology(&self) -> &Topology {
        &self.surface.topology
    }

    /// `[V]` the starting surface (m).
    pub fn start(&self) -> &[Vec3] {
        &self.surface.start
    }

    /// `[V]` the present pose (m).
    pub fn pose(&self) -> &[Vec3] {
        &self.pose
    }

    /// `[V]` the values painted on it.
    pub fn values(&self) -> &[GrowthAt] {
        &self.surface.maps.vertices
    }

    /// True unless a stroke left something to bring to equilibrium.
    pub fn is_at_rest(&self) -> bool {
        self.disturbed.is_empty()
    }

    /// Touches the surface with a brush and moves its surroundings. Returns the values that were
    /// overwritten, to [`Sculpture::restore`] them.
    ///
    /// Small factors (up to 1.1) give the pattern time to choose itself, as the load steps of
    /// [`super::grow`] do.
    ///
    /// # Errors
    /// [`Error::Value`] for a brush that is none, or a painted value out of range; [`Error::Mesh`]
    /// if grown sides make no triangle. The sculpture then is as before, to the bit.
    pub fn dab(&mut self, dab: &Dab) -> Result<(Change, SculptReport)> {
        let begun = Instant::now();
        dab.check(self.topology().face_count())?;
        let (faces, around, start) =
            (&self.surface.topology.faces, &self.around, &self.surface.start);
        let values = &mut self.surface.maps.vertices;
        let corners = faces[dab.spot.face];
        let [a, b, c] = corners.map(|v| values[v].wavelength_m);
        let mut margin = a.max(b).max(c);
        if let Paint::Wavelength(to) = dab.paint {
            margin = margin.max(to).min(2.0 * margin);
        }
        let origin: Vec3 = (0..3).map(|k| start[corners[k]] * dab.spot.weights[k]).sum();
        let near = self.reach.from(
            corners,
            &origin,
            |v| around[v].iter().map(|&f| faces[f]),
            |v| start[v],
            dab.radius_m + self.brush.margin * margin,
        );
        let search_seconds = begun.elapsed().as_secs_f64();
        let mut overwritten: Vec<(usize, GrowthAt)> = Vec::new();
        for &(v, distance) in &near {
            let (strength, old) = (dab.strength(distance), values[v]);
            if strength > 0.0 {
                values[v] = dab.paint.apply(&old, strength, &self.brush);
                overwritten.push((v, old));
            }
        }
        overwritten.sort_unstable_by_key(|entry| entry.0);
        let follows_m = dab.radius_m + self.follow_distance() * margin;
        let around = Neighbourhood { near, follows_m, begun, search_seconds };
        self.move_surroundings(overwritten, &around)
    }

    /// Gives each of these vertices (ascending) other values, and moves their surroundings, as
    /// [`Sculpture::dab`] does.
    ///
    /// # Errors
    /// As [`Sculpture::dab`]; [`Error::Value`] for vertices that are not there or not ascending.
    pub fn paint(&mut self, values: &[(usize, GrowthAt)]) -> Result<(Change, SculptReport)> {
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
        let (faces, around, start) =
            (&self.surface.topology.faces, &self.around, &self.surface.start);
        let painted = &mut self.surface.maps.vertices;
        let widest = |most: f64, (v, to): &(usize, GrowthAt)| {
            most.max(painted[*v].wavelength_m).max(to.wavelength_m)
        };
        let wavelength_m = values.iter().fold(0.0, widest);
        let near = self.reach.around_all(
            values.iter().map(|entry| entry.0),
            |v| around[v].iter().map(|&f| faces[f]),
            |v| start[v],
            self.brush.margin * wavelength_m,
        );
        let search_seconds = begun.elapsed().as_secs_f64();
        let overwritten =
            values.iter().map(|&(v, to)| (v, std::mem::replace(&mut painted[v], to))).collect();
        let follows_m = self.follow_distance() * wavelength_m;
        let around = Neighbourhood { near, follows_m, begun, search_seconds };
        self.move_surroundings(overwritten, &around)
    }

    /// Distance beyond the brush within which the surface follows it, in wavelengths.
    fn follow_distance(&self) -> f64 {
        self.brush.near.min(self.brush.margin)
    }

    /// Moves the vertices `around` values that were painted, and marks all of them as disturbed;
    /// `overwritten` holds the values that were there before (ascending).
    fn move_surroundings(
        &mut self,
        overwritten: Vec<(usize, GrowthAt)>,
        around: &Neighbourhood,
    ) -> Result<(Change, SculptReport)> {
        let active = around.within(around.follows_m);
        let criteria = StopCriteria {
            iteration_limit: self.brush.iterations,
            tolerance: self.options.tolerance,
        };
        let (moved, mut report) = match self.solve(&active, criteria, &Silent) {
            Ok(solved) => solved,
            Err(error) => {
                let values = &mut self.surface.maps.vertices;
                overwritten.iter().for_each(|&(v, old)| values[v] = old);
                return Err(error);
            }
        };
        report.touched = overwritten.len();
        report.seconds.search = around.search_seconds;
        let disturbed: Vec<usize> = around
            .within(f64::INFINITY)
            .into_iter()
            .filter(|v| self.disturbed.binary_search(v).is_err())
            .collect();
        self.disturb(&disturbed);
        report.seconds.total = around.begun.elapsed().as_secs_f64();
        let change =
            Change { poses: moved, values: overwritten, disturbed, equilibrated: Vec::new() };
        Ok((change, report))
    }

    /// Brings all vertices that dabs have touched since the last call to equilibrium. If the
    /// observer cancels, or the limit of iterations comes first, another call goes on.
    ///
    /// # Errors
    /// [`Error::Numeric`] if there is no finite energy; the sculpture then is as before.
    pub fn equilibrate(&mut self, observer: &dyn Observer) -> Result<(Change, SculptReport)> {
        let begun = Instant::now();
        if self.disturbed.is_empty() {
            return Ok((Change::default(), SculptReport::default()));
        }
        let active = std::mem::take(&mut self.disturbed);
        let solved = self.solve(&active, StopCriteria::full(&self.options), observer);
        self.disturbed = active;
        let (poses, mut report) = solved?;
        let resting =
            report.step.as_ref().is_none_or(|step| step.residual <= self.options.tolerance);
        let equilibrated = if resting { std::mem::take(&mut self.disturbed) } else { Vec::new() };
        report.seconds.total = begun.elapsed().as_secs_f64();
        Ok((Change { poses, equilibrated, ..Change::default() }, report))
    }

    /// Undoes `change`, which must be the last that was not undone, to the bit. Returns the change
    /// that restores it again.
    pub fn restore(&mut self, change: Change) -> Change {
        let Change { mut poses, mut values, disturbed, equilibrated } = change;
        poses.iter_mut().for_each(|(v, pose)| std::mem::swap(pose, &mut self.pose[*v]));
        let painted = &mut self.surface.maps.vertices;
        values.iter_mut().for_each(|(v, value)| std::mem::swap(value, &mut painted[*v]));
        self.disturbed.retain(|v| disturbed.binary_search(v).is_err());
        self.disturb(&equilibrated);
        Change { poses, values, disturbed: equilibrated, equilibrated: disturbed }
    }

    /// Adds `vertices` (ascending, none of them disturbed) to the disturbed ones.
    fn disturb(&mut self, vertices: &[usize]) {
        self.disturbed.extend_from_slice(vertices);
        self.disturbed.sort_unstable();
    }

    /// Solves for the `active` (ascending) vertices and returns the old poses (m) of those that
    /// moved.
    fn solve(
        &mut self,
        active: &[usize],
        criteria: StopCriteria,
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
        if active.iter().any(|&v| self.values()[v].frozen != [true; 3]) {
            region.surface.check_resolution()?;
            let within = Subdomain {
                fixed: &region.fixed,
                pose: &region.pose,
                normals: &region.normals,
                area_m2: &region.part_of(&self.area_m2),
                rough: &region.part_of(&self.rough),
                scale: self.scale,
            };
            let step = FilmModel::new(&region.surface, &self.options, Some(&within))?
                .equilibrate_part(1.0, criteria, &mut pose, observer)?;
            if step.iterations == 0 {
                // Unknowns are scaled; a pose that did not move keeps its bits.
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
        report.seconds.cut = cut;
        report.seconds.solve = begun.elapsed().as_secs_f64() - cut;
        Ok((moved, report))
    }
}
