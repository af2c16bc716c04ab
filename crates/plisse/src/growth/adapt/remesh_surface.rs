//! A growing surface with everything it carries, from mesh to mesh.

use crate::growth::expansion::{Expansion, GrowthTensor};
use crate::growth::maps::GrowthMaps;
use crate::growth::surface::Growing;
use crate::mesh::crossing::crossing_pairs;
use crate::mesh::normals::try_vertex_normals;
use crate::mesh::{Topology, Vec2, Vec3};
use crate::obstacle::Obstacle;
use crate::remesh::{MidpointPlacement, RemeshOptions, RemeshReport, SurfaceMesh, remesh};
use crate::rest::RestMetric;
use crate::shell::Loads;
use crate::{At, Result};

/// Channels of a sheet: λ, largest factor, Λ, bias, stickiness, hold, three of the place, six of ln
/// τ. One for each band follows.
const CHANNELS: usize = 15;
/// Where the place and ln τ begin among them.
const PLACE: usize = 6;
const LOGARITHM: usize = 9;

/// What [`Growing`] borrows, owned: its mesh changes as it grows.
#[derive(Clone, Debug)]
pub struct Surface<'a> {
    /// Connectivity.
    pub topology: Topology,
    /// `[F]` rest metric before growth.
    pub rest: RestMetric,
    /// `[V]` the starting surface (m).
    pub start: Vec<Vec3>,
    /// `[V]` the pose (m).
    pub pose: Vec<Vec3>,
    /// `[V]` places (m) from which imperfections are drawn.
    pub places: Vec<Vec3>,
    /// How each vertex grows, and folds while it does.
    pub maps: GrowthMaps,
    /// `[F][3]` texture places.
    pub uvs: Option<Vec<[Vec2; 3]>>,
    /// What pushes.
    pub loads: Loads,
    /// Bodies that no vertex enters.
    pub obstacles: &'a [Obstacle],
    /// Distance (m) from an obstacle within which it pushes back.
    pub contact_thickness_m: f64,
    /// Whether folds keep from passing through each other.
    pub self_contact: bool,
}

impl<'a> Surface<'a> {
    /// The surface of `growing` where it starts, with texture places (`[F][3]`) or none.
    pub fn new(growing: &Growing<'a>, uvs: Option<Vec<[Vec2; 3]>>) -> Self {
        Self {
            topology: growing.topology.clone(),
            rest: growing.rest.clone(),
            start: growing.start.to_vec(),
            pose: growing.start.to_vec(),
            places: growing.places.clone(),
            maps: growing.maps.clone(),
            uvs,
            loads: growing.loads.clone(),
            obstacles: growing.obstacles,
            contact_thickness_m: growing.contact_thickness_m,
            self_contact: growing.self_contact,
        }
    }

    /// As [`crate::growth::grow`] takes it.
    pub fn growing(&self) -> Growing<'_> {
        Growing {
            topology: &self.topology,
            rest: &self.rest,
            start: &self.start,
            places: self.places.clone(),
            maps: self.maps.clone(),
            loads: self.loads.clone(),
            obstacles: self.obstacles,
            contact_thickness_m: self.contact_thickness_m,
            self_contact: self.self_contact,
        }
    }

    /// Remeshes all of it. Vertices that stay keep all they carry to the bit; of new ones, ln τ is
    /// the mean of the ends of the edge they were made on. A point force whose vertex goes acts on
    /// the one nearest to it at the start. If nothing is to be changed, nothing is.
    ///
    /// Where folds must not pass through each other and would on the new mesh, new vertices are
    /// laid into the middle of their edges; if that does not help, the mesh stays.
    ///
    /// # Errors
    /// As [`remesh`].
    pub(super) fn remesh(&mut self, options: &RemeshOptions) -> Result<RemeshReport> {
        let growth = &self.maps.expansion.vertices;
        let mut channels = vec![
            self.maps.wavelength_m.clone(),
            growth.iter().map(|g| g.principal().0[0].max(1.0)).collect(),
        ];
        channels.extend([
            self.maps.coherence_m.clone(),
            self.maps.bias.clone(),
            self.maps.stickiness.clone(),
            self.maps.hold.clone(),
        ]);
        channels.extend((0..3).map(|axis| self.places.iter().map(|p| p[axis]).collect()));
        let logarithms: Vec<[f64; 6]> = growth.iter().map(GrowthTensor::logarithm).collect();
        channels.extend((0..6).map(|k| logarithms.iter().map(|log| log[k]).collect()));
        debug_assert_eq!(channels.len(), CHANNELS);
        channels.extend(self.maps.bands.iter().map(|band| {
            let mut inside = vec![0.0; self.start.len()];
            band.iter().for_each(|&v| inside[v] = 1.0);
            inside
        }));
        let sheet = SurfaceMesh {
            faces: self.topology.faces.clone(),
            rest: self.rest.faces.clone(),
            positions: self.pose.clone(),
            start: self.start.clone(),
            channels,
            frozen: self.maps.frozen.clone(),
            uvs: self.uvs.clone(),
        };
        let active = vec![true; sheet.faces.len()];
        let flat = RemeshOptions { midpoints: MidpointPlacement::Flat, ..options.clone() };
        let crosses = |sheet: &SurfaceMesh| {
            self.self_contact && !crossing_pairs(&sheet.faces, &sheet.positions).is_empty()
        };
        let mut remeshed = remesh(sheet.clone(), &active, options)?;
        if crosses(&remeshed.sheet) {
            remeshed = remesh(sheet, &active, &flat)?;
            if crosses(&remeshed.sheet) {
                return Ok(RemeshReport::default());
            }
        }
        let report = remeshed.report;
        if report.splits + report.swaps + report.collapses == 0 {
            return Ok(report);
        }
        let sheet = remeshed.sheet;
        let topology = Topology::new(sheet.positions.len(), sheet.faces).at("remeshing")?;
        let normals = try_vertex_normals(&topology, &sheet.start).at("growth")?;
        let c = &sheet.channels;
        let made = |v: usize| {
            GrowthTensor::from_logarithm(&normals[v], std::array::from_fn(|k| c[LOGARITHM + k][v]))
        };
        let mut vertices: Vec<GrowthTensor> = (0..normals.len()).map(made).collect();
        for (old, new) in remeshed.maps.vertices.iter().enumerate() {
            if let Some(new) = *new {
                vertices[new] = self.maps.expansion.vertices[old];
            }
        }
        let nearest = |p: &Vec3| {
            let square = |v: &usize| (sheet.start[*v] - p).norm_squared();
            (0..sheet.start.len())
                .min_by(|a, b| square(a).total_cmp(&square(b)))
                .unwrap_or_default()
        };
        for (v, _) in &mut self.loads.forces_newton {
            *v = remeshed.maps.vertices[*v].unwrap_or_else(|| nearest(&self.start[*v]));
        }
        self.places = (0..normals.len())
            .map(|v| Vec3::new(c[PLACE][v], c[PLACE + 1][v], c[PLACE + 2][v]))
            .collect();
        self.maps.expansion = Expansion { vertices };
        // A new vertex belongs to a band if all it lies between does.
        let belongs =
            |b: usize| (0..c[0].len()).filter(|&v| c[CHANNELS + b][v] > 1.0 - 1e-9).collect();
        self.maps.bands = (0..self.maps.bands.len()).map(belongs).collect();
        let mut channels = sheet.channels.into_iter();
        let mut next = || channels.next().unwrap_or_default();
        (self.maps.wavelength_m, _) = (next(), next());
        (self.maps.coherence_m, self.maps.bias, self.maps.stickiness, self.maps.hold) =
            (next(), next(), next(), next());
        self.topology = topology;
        self.rest = RestMetric { faces: sheet.rest };
        (self.pose, self.start, self.maps.frozen, self.uvs) =
            (sheet.positions, sheet.start, sheet.frozen, sheet.uvs);
        Ok(report)
    }
}
