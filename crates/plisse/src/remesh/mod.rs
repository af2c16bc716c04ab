//! Adaptive remeshing (4.2 of [Combaz & Neyret 2002]): edges are split, swapped and collapsed until
//! they are as long as folds ask for.
//!
//! All of it happens at rest. A surface has its lengths from the rest metric of its faces; a split
//! halves a face, a swap unfolds two faces into a plane and cuts them along the other diagonal:
//! neither changes a length or an area anywhere. Taking a vertex out changes them only if the rest
//! metric is curved there, and is refused where that is too much ([`RemeshOptions::flatness`],
//! [`RemeshOptions::area_tolerance`]).
//!
//! New vertices lie in the middle of edges, unless [`MidpointPlacement`] says otherwise, and those
//! taken out are drawn onto neighbours, so whatever is linear over the surface stays so. Seams of
//! the texture, frozen regions and the boundary keep their course.

mod collapse;
mod driver;
mod patch;
mod split;
mod swap;
#[cfg(test)]
mod tests;
mod unfold;

use patch::Patch;

use crate::mesh::{Topology, Vec2, Vec3};
use crate::rest::RestFace;
use crate::{At, Error, Result};

/// A surface and all it carries through remeshing.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceMesh {
    /// `[F][3]` vertices of each face.
    pub faces: Vec<[usize; 3]>,
    /// `[F]` rest metric.
    pub rest: Vec<RestFace>,
    /// `[V]` the pose (m).
    pub positions: Vec<Vec3>,
    /// `[V]` the starting surface (m).
    pub start: Vec<Vec3>,
    /// `[channels][V]` numbers of any unit that run linearly over faces.
    pub channels: Vec<Vec<f64>>,
    /// `[V]` axes along which each vertex is frozen. Such a vertex is never taken out.
    pub frozen: Vec<[bool; 3]>,
    /// `[F][3]` texture places. Where they differ across an edge, that is a seam.
    pub uvs: Option<Vec<[Vec2; 3]>>,
}

/// Options of remeshing: the asked lengths of edges, and limits.
#[derive(Clone, Debug, PartialEq)]
pub struct RemeshOptions {
    /// Channel of the wavelength λ (m).
    pub wavelength_channel: usize,
    /// Channel of the growth (factor of length); where it is 1, edges may be
    /// [`RemeshOptions::longest_m`] long. Without it, every place grows.
    pub growth_channel: Option<usize>,
    /// Edges to a wavelength: where it grows, edges should be λ over this long, at rest.
    pub edges_per_wave: f64,
    /// Length (m, at rest) of edges where nothing grows; nowhere are they asked to be longer.
    pub longest_m: f64,
    /// Angle (rad) between the normals at an edge's ends above which it should be shorter.
    pub normal_angle: f64,
    /// Change of growth along an edge above which it should be shorter.
    pub growth_step: f64,
    /// Lower limit of the length that angle and change of growth ask for, as a share of that by λ.
    pub finest_share: f64,
    /// Most (rad) by which the angles around a vertex that is taken out may differ from 2π, at
    /// rest.
    pub flatness: f64,
    /// Most rest area, as a share of the active one, that may be lost or won (both counted) by
    /// taking vertices out. At 0 none is: even where it is flat, rounding costs some.
    pub area_tolerance: f64,
    /// No vertex is added beyond this many.
    pub most_vertices: usize,
    /// No more passes than this.
    pub most_passes: usize,
    /// Placement of new vertices.
    pub midpoints: MidpointPlacement,
}

/// Placement of a new vertex on an edge. Rest lengths and all channels are linear along edges in
/// either case.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MidpointPlacement {
    /// Into the middle of its edge, in the pose and at the start.
    Flat,
    /// At the start into the middle; in the pose to where folds curve, by the normals at the edge's
    /// ends, beyond what the start does.
    Folds,
    /// To where the surface curves, in the pose and at the start.
    Start,
}

impl RemeshOptions {
    /// Eight edges to a wavelength (channel 0) where channel 1 is not 1, `longest_m` (m) elsewhere.
    pub fn new(longest_m: f64) -> Self {
        Self {
            wavelength_channel: 0,
            growth_channel: Some(1),
            edges_per_wave: 8.0,
            longest_m,
            normal_angle: 0.5,
            growth_step: 0.25,
            finest_share: 0.5,
            flatness: 0.05,
            area_tolerance: 1e-3,
            most_vertices: 200_000,
            most_passes: 40,
            midpoints: MidpointPlacement::Flat,
        }
    }
}

/// New numbers of old vertices and faces. Those that are untouched keep their numbers, except that
/// the last ones fill holes if the surface ends up with fewer.
#[derive(Clone, Debug, PartialEq)]
pub struct IndexMaps {
    /// `[old V]` new number of each vertex; none if it was taken out. Vertices that are left never
    /// change.
    pub vertices: Vec<Option<usize>>,
    /// `[old F]` new number of each face; none if it was taken out.
    pub faces: Vec<Option<usize>>,
    /// `[F]` true for faces, by their new number, that have other corners than before, or are new.
    pub changed: Vec<bool>,
}

/// Report on remeshing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RemeshReport {
    /// Edges split.
    pub splits: usize,
    /// Edges swapped.
    pub swaps: usize,
    /// Edges collapsed.
    pub collapses: usize,
    /// Passes, the last of which changed nothing if [`RemeshReport::converged`].
    pub passes: usize,
    /// True if another call with the same options would change nothing (but for collapses for which
    /// no area was left).
    pub converged: bool,
    /// True if edges stayed too long for want of vertices.
    pub limited: bool,
    /// Change (m²) of the total rest area, but for rounding.
    pub area_change_m2: f64,
    /// Sum (m²) of the sizes of all changes of rest area.
    pub area_spent_m2: f64,
}

impl RemeshReport {
    fn changes(&self) -> usize {
        self.splits + self.swaps + self.collapses
    }
}

/// A remeshed surface.
#[derive(Clone, Debug, PartialEq)]
pub struct RemeshOutcome {
    /// The surface.
    pub mesh: SurfaceMesh,
    /// New numbers of vertices and faces.
    pub maps: IndexMaps,
    /// Report.
    pub report: RemeshReport,
}

/// Splits, swaps and collapses edges of `mesh` until they are as long as `options` ask for. Faces
/// that are not `active` (`[F]`), their corners and their sides stay as they are to the bit.
///
/// An edge is split if it is longer than 4/3 of what is asked for and collapsed if shorter than
/// 2/5; between these, nothing happens. The result does not depend on anything but the arguments.
///
/// # Errors
/// [`Error::Mesh`] for a surface that is no manifold where it is active, or whose parts do not fit
/// together; [`Error::Value`] for options out of range.
pub fn remesh(
    mesh: SurfaceMesh,
    active: &[bool],
    options: &RemeshOptions,
) -> Result<RemeshOutcome> {
    check(&mesh, active)?;
    check_options(&mesh, options)?;
    let (vertices, faces) = (mesh.positions.len(), mesh.faces.len());
    let mut patch = Patch::new(mesh, active);
    patch.midpoints = options.midpoints;
    // The whole connectivity takes longer than a small change; it is looked at only to say what is
    // wrong.
    if !patch.is_sound() {
        Topology::new(vertices, patch.mesh.faces).at("remeshing")?;
        return Err(Error::mesh(
            "remeshing",
            "the surface is no manifold; split it where more than two faces meet",
        ));
    }
    let report = driver::run(&mut patch, options);
    let (mesh, maps) = patch.finish(vertices, faces);
    Ok(RemeshOutcome { mesh, maps, report })
}

/// Length of every edge of `mesh` at rest over the length that `options` ask for, edges as in
/// [`Topology::edges`]. Edges that may change end up between 2/5 and 4/3, nearly all.
///
/// # Errors
/// As [`remesh`].
pub fn edge_ratios(mesh: &SurfaceMesh, options: &RemeshOptions) -> Result<Vec<f64>> {
    check(mesh, &vec![true; mesh.faces.len()])?;
    check_options(mesh, options)?;
    let topology = Topology::new(mesh.positions.len(), mesh.faces.clone()).at("remeshing")?;
    let patch = Patch::new(mesh.clone(), &vec![true; mesh.faces.len()]);
    let asked = driver::asked_lengths(&patch, options);
    let ratio =
        |&[a, b]: &[usize; 2]| driver::ratio(&asked, a, b, patch.length(&patch.edge_faces(a, b)));
    Ok(topology.edges.iter().map(ratio).collect())
}

fn check(mesh: &SurfaceMesh, active: &[bool]) -> Result<()> {
    let (n, m) = (mesh.positions.len(), mesh.faces.len());
    if let Some(f) = mesh.faces.iter().position(|face| face.iter().any(|&v| v >= n)) {
        return Err(Error::mesh(
            "remeshing",
            format!("face {f} names a vertex that is not there, of {n}; correct the index"),
        ));
    }
    let per_vertex = mesh.start.len() == n
        && mesh.frozen.len() == n
        && mesh.channels.iter().all(|c| c.len() == n);
    let per_face = mesh.rest.len() == m
        && active.len() == m
        && mesh.uvs.as_ref().is_none_or(|uvs| uvs.len() == m);
    if !(per_vertex && per_face) {
        return Err(Error::mesh(
            "remeshing",
            format!(
                "the lists of what {n} vertices and {m} faces carry differ in length; give one \
                 entry each"
            ),
        ));
    }
    if let Some(v) = (0..n).find(|&v| {
        [&mesh.positions[v], &mesh.start[v]].iter().any(|p| p.iter().any(|x| !x.is_finite()))
    }) {
        return Err(Error::mesh(
            "remeshing",
            format!("the place of vertex {v} is not a number; give finite coordinates"),
        ));
    }
    if let Some(f) = mesh
        .rest
        .iter()
        .position(|f| !(f.area_m2 > 0.0 && f.inverse_root.iter().all(|x| x.is_finite())))
    {
        return Err(Error::mesh(
            "remeshing",
            format!("face {f} has no area at rest; remove the face or move its corners apart"),
        ));
    }
    Ok(())
}

fn check_options(mesh: &SurfaceMesh, options: &RemeshOptions) -> Result<()> {
    let positive = [
        ("edges_per_wave", options.edges_per_wave),
        ("longest_m", options.longest_m),
        ("normal_angle", options.normal_angle),
        ("growth_step", options.growth_step),
        ("finest_share", options.finest_share),
    ];
    for (name, value) in positive {
        if !(value > 0.0 && value.is_finite()) {
            return Err(Error::value(
                format!("remesh.{name}"),
                format!("{value} is no length, angle or share; give a number above 0"),
            ));
        }
    }
    for (name, value) in
        [("flatness", options.flatness), ("area_tolerance", options.area_tolerance)]
    {
        if value.is_nan() || value < 0.0 {
            return Err(Error::value(
                format!("remesh.{name}"),
                format!("{value} is no tolerance; give 0 or more"),
            ));
        }
    }
    if options.finest_share > 1.0 {
        return Err(Error::value(
            "remesh.finest_share",
            format!("{} is above 1; give a share, above 0 and at most 1", options.finest_share),
        ));
    }
    let channel = |name: &str, c: usize, least: f64| {
        let Some(values) = mesh.channels.get(c) else {
            return Err(Error::value(
                name,
                format!(
                    "there is no channel {c} but only {}; correct the number",
                    mesh.channels.len()
                ),
            ));
        };
        match values.iter().position(|&x| !(x > least && x.is_finite())) {
            Some(v) => Err(Error::value(
                name,
                format!(
                    "the value {} at vertex {v} cannot be used; give a finite number above {least}",
                    values[v]
                ),
            )),
            None => Ok(()),
        }
    };
    channel("remesh.wavelength", options.wavelength_channel, 0.0)?;
    options.growth_channel.map_or(Ok(()), |c| channel("remesh.growth", c, 0.0))
}
