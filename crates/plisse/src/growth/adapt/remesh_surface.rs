//! A grown surface and its remeshing, with everything that it carries.

use crate::growth::expansion::GrowthTensor;
use crate::growth::maps::{GrowthAt, SCALAR_MAPS};
use crate::growth::surface::GrowingSurface;
use crate::mesh::crossing::crossing_pairs;
use crate::mesh::normals::try_vertex_normals;
use crate::mesh::{Topology, Vec2, Vec3};
use crate::remesh::{
    MidpointPlacement, RemeshOptions, RemeshOutcome, RemeshReport, SurfaceMesh, remesh,
};
use crate::rest::RestMetric;
use crate::{At, Result};

/// Channel of λ: the first of the scalar maps, which come first.
pub(super) const WAVELENGTH: usize = 0;
/// Channel of the largest factor of length.
pub(super) const GROWTH: usize = SCALAR_MAPS.len();
/// First of the three channels of the place from which imperfections are drawn.
const PLACE: usize = GROWTH + 1;
/// First of the six channels of ln τ.
const LOGARITHM: usize = PLACE + 3;
/// First of the channels of bands: 1 for each of a band's vertices, 0 for all others.
const BAND: usize = LOGARITHM + 6;

/// A growing surface in its pose.
#[derive(Clone, Debug)]
pub struct GrownSurface {
    /// The surface.
    pub surface: GrowingSurface,
    /// `[V]` the pose (m).
    pub pose: Vec<Vec3>,
    /// `[F][3]` texture places.
    pub uvs: Option<Vec<[Vec2; 3]>>,
}

impl GrownSurface {
    /// The surface where it starts, with texture places (`[F][3]`) or none.
    pub fn new(surface: GrowingSurface, uvs: Option<Vec<[Vec2; 3]>>) -> Self {
        Self { pose: surface.start.clone(), surface, uvs }
    }

    /// Remeshes all of it. Vertices that stay keep all they carry to the bit; of new ones, ln τ is
    /// the mean of the ends of the edge they were made on. A point force whose vertex goes acts on
    /// the one nearest to it at the start. If nothing is to be changed, nothing is.
    ///
    /// If folds must not pass through each other and would on the new mesh, new vertices are placed
    /// in the middle of their edges; if that does not help, the mesh stays.
    ///
    /// # Errors
    /// As [`remesh`].
    pub(super) fn remesh(&mut self, options: &RemeshOptions) -> Result<RemeshReport> {
        let mesh = self.carried_mesh();
        let active = vec![true; mesh.faces.len()];
        let flat = RemeshOptions { midpoints: MidpointPlacement::Flat, ..options.clone() };
        let crosses = |mesh: &SurfaceMesh| {
            self.surface.self_contact && !crossing_pairs(&mesh.faces, &mesh.positions).is_empty()
        };
        let mut remeshed = remesh(mesh.clone(), &active, options)?;
        if crosses(&remeshed.mesh) {
            remeshed = remesh(mesh, &active, &flat)?;
            if crosses(&remeshed.mesh) {
                return Ok(RemeshReport::default());
            }
        }
        let report = remeshed.report.clone();
        if report.splits + report.swaps + report.collapses > 0 {
            self.replace_mesh(remeshed)?;
        }
        Ok(report)
    }

    /// The mesh with everything that the surface carries.
    fn carried_mesh(&self) -> SurfaceMesh {
        let surface = &self.surface;
        let at = &surface.maps.vertices;
        let mut channels: Vec<Vec<f64>> =
            SCALAR_MAPS.iter().map(|map| at.iter().map(|at| map.get(at)).collect()).collect();
        channels.push(at.iter().map(|at| at.growth.principal().0[0].max(1.0)).collect());
        channels.extend((0..3).map(|axis| surface.places.iter().map(|p| p[axis]).collect()));
        let logarithms: Vec<[f64; 6]> = at.iter().map(|at| at.growth.logarithm()).collect();
        channels.extend((0..6).map(|k| logarithms.iter().map(|log| log[k]).collect()));
        debug_assert_eq!(channels.len(), BAND);
        channels.extend(surface.maps.bands.iter().map(|band| {
            let mut inside = vec![0.0; surface.start.len()];
            band.iter().for_each(|&v| inside[v] = 1.0);
            inside
        }));
        SurfaceMesh {
            faces: surface.topology.faces.clone(),
            rest: surface.rest.faces.clone(),
            positions: self.pose.clone(),
            start: surface.start.clone(),
            channels,
            frozen: at.iter().map(|at| at.frozen).collect(),
            uvs: self.uvs.clone(),
        }
    }

    /// Replaces the mesh and everything that it carries.
    fn replace_mesh(&mut self, remeshed: RemeshOutcome) -> Result<()> {
        let (mesh, old_vertices) = (remeshed.mesh, &remeshed.maps.vertices);
        let surface = &mut self.surface;
        let topology = Topology::new(mesh.positions.len(), mesh.faces).at("remeshing")?;
        let normals = try_vertex_normals(&topology, &mesh.start).at("growth")?;
        let c = &mesh.channels;
        let at = |v: usize| {
            let logarithm = std::array::from_fn(|k| c[LOGARITHM + k][v]);
            let growth = GrowthTensor::from_logarithm(&normals[v], logarithm);
            let mut at = GrowthAt::new(growth, c[WAVELENGTH][v]);
            SCALAR_MAPS.iter().zip(c).for_each(|(map, channel)| map.set(&mut at, channel[v]));
            GrowthAt { frozen: mesh.frozen[v], ..at }
        };
        let mut vertices: Vec<GrowthAt> = (0..normals.len()).map(at).collect();
        for (old, new) in old_vertices.iter().enumerate() {
            if let Some(new) = *new {
                vertices[new].growth = surface.maps.vertices[old].growth;
            }
        }
        let nearest = |p: &Vec3| {
            let square = |v: &usize| (mesh.start[*v] - p).norm_squared();
            (0..mesh.start.len()).min_by(|a, b| square(a).total_cmp(&square(b))).unwrap_or_default()
        };
        for (v, _) in &mut surface.loads.forces_newton {
            *v = old_vertices[*v].unwrap_or_else(|| nearest(&surface.start[*v]));
        }
        surface.places = (0..normals.len())
            .map(|v| Vec3::new(c[PLACE][v], c[PLACE + 1][v], c[PLACE + 2][v]))
            .collect();
        // A new vertex belongs to a band if all vertices that it lies between do.
        let belongs = |b: usize| {
            (0..vertices.len()).filter(|&v| c[BAND + b][v] > 1.0 - 1e-9).collect::<Vec<_>>()
        };
        surface.maps.bands = (0..surface.maps.bands.len()).map(belongs).collect();
        surface.maps.vertices = vertices;
        surface.topology = topology;
        surface.rest = RestMetric { faces: mesh.rest };
        surface.start = mesh.start;
        (self.pose, self.uvs) = (mesh.positions, mesh.uvs);
        Ok(())
    }
}
