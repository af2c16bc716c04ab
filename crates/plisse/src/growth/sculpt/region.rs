//! A piece of the surface that is solved alone: active vertices, and around them as much as their
//! energy terms reach.

use std::sync::Arc;

use super::Sculpture;
use crate::growth::maps::GrowthMaps;
use crate::growth::surface::GrowingSurface;
use crate::mesh::{NONE, Topology, Vec3};
use crate::rest::RestMetric;
use crate::shell::Loads;
use crate::{At, Result};

/// The piece, with numbers of its own.
pub(super) struct Region {
    /// `[v]` number of each vertex in the whole, ascending.
    pub(super) vertices: Vec<usize>,
    /// The piece as a surface.
    pub(super) surface: GrowingSurface,
    /// `[v]` true for vertices that are not active: they stay at their pose.
    pub(super) fixed: Vec<bool>,
    /// `[v]` the pose (m).
    pub(super) pose: Vec<Vec3>,
    /// `[v]` normals of the starting surface, as in the whole.
    pub(super) normals: Vec<Vec3>,
}

impl Region {
    /// The piece around the `active` vertices of `whole`. A row of bending reaches one ring of
    /// faces around its vertex, and the rows that touch an active vertex are its own and its
    /// neighbours'; so faces around both make all of these terms exact.
    ///
    /// `number` (`[V]`, all [`NONE`]) is a work array; it is left as it was.
    pub(super) fn new(whole: &Sculpture, active: &[usize], number: &mut [usize]) -> Result<Self> {
        let all = &whole.surface.topology.faces;
        let grow = |inner: &[usize], number: &mut [usize]| {
            let mut outer: Vec<usize> = Vec::new();
            for v in inner.iter().flat_map(|&v| &whole.around[v]).flat_map(|&f| all[f]) {
                if number[v] == NONE {
                    number[v] = 0;
                    outer.push(v);
                }
            }
            outer
        };
        let inner = grow(active, number);
        let outer = grow(&inner, number);
        let mut chosen: Vec<usize> =
            inner.iter().flat_map(|&v| whole.around[v].iter().copied()).collect();
        chosen.sort_unstable();
        chosen.dedup();
        let mut vertices = [inner, outer].concat();
        vertices.sort_unstable();
        for (n, &v) in vertices.iter().enumerate() {
            number[v] = n;
        }
        let mut fixed = vec![true; vertices.len()];
        active.iter().for_each(|&v| fixed[number[v]] = false);
        let faces = chosen.iter().map(|&f| all[f].map(|v| number[v])).collect();
        let mut loads = Loads { forces_newton: Vec::new(), ..whole.surface.loads };
        for &v in &vertices {
            let forces = &whole.surface.loads.forces_newton;
            let begin = forces.partition_point(|force| force.0 < v);
            let here = forces[begin..].iter().take_while(|force| force.0 == v);
            loads.forces_newton.extend(here.map(|force| (number[v], force.1)));
        }
        for &v in &vertices {
            number[v] = NONE;
        }
        let of = |list: &[Vec3]| vertices.iter().map(|&v| list[v]).collect::<Vec<_>>();
        let at = vertices.iter().map(|&v| whole.surface.maps.vertices[v]).collect();
        let rest = chosen.iter().map(|&f| whole.surface.rest.faces[f]).collect();
        Ok(Self {
            surface: GrowingSurface {
                topology: Topology::new(vertices.len(), faces).at("sculpture")?,
                rest: RestMetric { faces: rest },
                start: of(&whole.surface.start),
                places: of(&whole.surface.places),
                maps: GrowthMaps { vertices: at, bands: Vec::new() },
                loads,
                obstacles: Arc::clone(&whole.surface.obstacles),
                contact_thickness_m: whole.surface.contact_thickness_m,
                self_contact: whole.surface.self_contact,
            },
            fixed,
            pose: of(&whole.pose),
            normals: of(&whole.normals),
            vertices,
        })
    }

    /// `[v]` part of a list of the whole (`[V]`).
    pub(super) fn part_of(&self, list: &[f64]) -> Vec<f64> {
        self.vertices.iter().map(|&v| list[v]).collect()
    }
}
