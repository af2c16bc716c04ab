//! A piece of the surface that is solved alone: active vertices, and around them as much as their
//! energy terms reach.

use super::{Sculpture, maps_of};
use crate::growth::surface::Growing;
use crate::mesh::{NONE, Topology, Vec3};
use crate::rest::RestMetric;
use crate::shell::Loads;
use crate::{At, Result};

/// The piece, with numbers of its own.
pub(super) struct Region {
    /// `[v]` number of each vertex in the whole, ascending.
    pub(super) vertices: Vec<usize>,
    topology: Topology,
    rest: RestMetric,
    start: Vec<Vec3>,
    /// `[v]` whether it is not active: it stays at its pose.
    pub(super) still: Vec<bool>,
    /// `[v]` the pose (m).
    pub(super) pose: Vec<Vec3>,
    /// `[v]` normals of the starting surface, as in the whole.
    pub(super) normals: Vec<Vec3>,
    loads: Loads,
}

impl Region {
    /// The piece around the `active` vertices of `whole`. A row of bending reaches one ring of
    /// faces around its vertex, and the rows that touch an active vertex are its own and its
    /// neighbours'; so faces around both make all of these terms exact.
    ///
    /// `number` (`[V]`, all [`NONE`]) is room to count in; it is left as it was.
    pub(super) fn new(whole: &Sculpture, active: &[usize], number: &mut [usize]) -> Result<Self> {
        let all = &whole.topology.faces;
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
        let mut still = vec![true; vertices.len()];
        active.iter().for_each(|&v| still[number[v]] = false);
        let faces = chosen.iter().map(|&f| all[f].map(|v| number[v])).collect();
        let mut loads = Loads { forces_newton: Vec::new(), ..whole.loads };
        for &v in &vertices {
            let begin = whole.forces.partition_point(|force| force.0 < v);
            let here = whole.forces[begin..].iter().take_while(|force| force.0 == v);
            loads.forces_newton.extend(here.map(|force| (number[v], force.1)));
        }
        for &v in &vertices {
            number[v] = NONE;
        }
        let of = |list: &[Vec3]| vertices.iter().map(|&v| list[v]).collect::<Vec<_>>();
        Ok(Self {
            topology: Topology::new(vertices.len(), faces).at("sculpture")?,
            rest: RestMetric { faces: chosen.iter().map(|&f| whole.rest.faces[f]).collect() },
            start: of(&whole.start),
            still,
            pose: of(&whole.pose),
            normals: of(&whole.normals),
            loads,
            vertices,
        })
    }

    /// `[v]` what a list of the whole (`[V]`) has there.
    pub(super) fn of(&self, list: &[f64]) -> Vec<f64> {
        self.vertices.iter().map(|&v| list[v]).collect()
    }

    /// What is to be solved there.
    pub(super) fn growing<'a>(&'a self, whole: &'a Sculpture) -> Growing<'a> {
        let painted = self.vertices.iter().map(|&v| &whole.painted[v]);
        Growing {
            topology: &self.topology,
            rest: &self.rest,
            start: &self.start,
            places: self.vertices.iter().map(|&v| whole.places[v]).collect(),
            maps: maps_of(painted, self.of(&whole.hold)),
            loads: self.loads.clone(),
            obstacles: &whole.obstacles,
            contact_thickness_m: whole.contact_thickness_m,
            self_contact: whole.self_contact,
        }
    }
}
