//! All closed one-forms on the wrinkled part of a mesh: ω = dφ + Σₖ cₖHₖ.
//!
//! The phase's differential must be closed on every face that carries wrinkles, but need not be
//! exact: around a wrinkle-free hole the phase may gain a number cₖ. Hₖ are integer-valued closed
//! forms, one for each independent loop: take a spanning tree of the vertices (Hₖ = 0 on it) and a
//! spanning tree of the faces, rooted outside, that avoids the first; edges in neither are the
//! generators. Hₖ is 1 on its generator, 0 on the other generators, and closedness gives the rest
//! from the leaves of the face tree. The loop of generator k runs along it and back through the
//! vertex tree, so the phase gains exactly cₖ around it.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use crate::mesh::{NONE, Topology};

/// A basis of the closed one-forms on the faces that are not wrinkle-free.
#[derive(Clone, Debug)]
pub struct ClosedForms {
    /// `[b₁][…]` the edges on which each Hₖ is not zero, ascending, with its value from lower to
    /// higher vertex.
    pub generators: Vec<Vec<(usize, i32)>>,
    /// `[E][…]` generators that are not zero on each edge, ascending, with the value there.
    pub on_edge: Vec<Vec<(usize, i32)>>,
    /// `[b₁]` number of edges of each generator's loop.
    pub loop_lengths: Vec<usize>,
    /// `[E]` true for edges of a wrinkled face.
    pub wrinkled_edge: Vec<bool>,
    /// `[V]` connected component of each vertex, counted from 0; [`NONE`] for vertices of no
    /// wrinkled face.
    pub component: Vec<usize>,
    /// `[components]` the lowest vertex of each component.
    pub roots: Vec<usize>,
}

impl ClosedForms {
    /// The basis for `topology` without the faces marked in `wrinkle_free` (`[F]`).
    pub fn new(topology: &Topology, wrinkle_free: &[bool]) -> Self {
        let edge_faces: Vec<[usize; 2]> = topology
            .edge_faces
            .iter()
            .map(|&[f, g]| match (wrinkle_free[f], g == NONE || wrinkle_free[g]) {
                (false, false) => [f, g],
                (false, true) => [f, NONE],
                (true, false) => [g, NONE],
                (true, true) => [NONE, NONE],
            })
            .collect();
        let wrinkled_edge: Vec<bool> = edge_faces.iter().map(|faces| faces[0] != NONE).collect();

        let tree = VertexForest::new(topology, &wrinkled_edge);
        let cotree = FaceForest::new(topology, wrinkle_free, &edge_faces, &tree.edges);
        let mut in_face_tree = vec![false; topology.edge_count()];
        for &e in cotree.parent_edge.iter().filter(|&&e| e != NONE) {
            in_face_tree[e] = true;
        }

        let mut generators = Vec::new();
        let mut loop_lengths = Vec::new();
        for e in (0..topology.edge_count())
            .filter(|&e| wrinkled_edge[e] && !tree.edges[e] && !in_face_tree[e])
        {
            generators.push(cotree.extend(topology, &edge_faces, e));
            loop_lengths.push(tree.loop_length(topology.edges[e]));
        }
        let mut on_edge = vec![Vec::new(); topology.edge_count()];
        for (k, generator) in generators.iter().enumerate() {
            for &(e, value) in generator {
                on_edge[e].push((k, value));
            }
        }
        let VertexForest { component, roots, .. } = tree;
        Self { generators, on_edge, loop_lengths, wrinkled_edge, component, roots }
    }

    /// Σₖ cₖHₖ on edge `e`, from lower to higher vertex.
    pub fn on(&self, e: usize, coefficients: &[f64]) -> f64 {
        self.on_edge[e].iter().map(|&(k, value)| coefficients[k] * f64::from(value)).sum()
    }
}

/// Spanning forest of the wrinkled vertices, breadth first.
struct VertexForest {
    /// `[V]` connected component; [`NONE`] outside.
    component: Vec<usize>,
    /// `[V]` edges between a vertex and its root.
    depth: Vec<usize>,
    /// `[V]` next vertex towards the root; [`NONE`] for roots.
    parent: Vec<usize>,
    /// `[E]` true for edges of the forest.
    edges: Vec<bool>,
    /// `[components]` roots.
    roots: Vec<usize>,
}

impl VertexForest {
    fn new(topology: &Topology, wrinkled_edge: &[bool]) -> Self {
        let mut around: Vec<Vec<(usize, usize)>> = vec![Vec::new(); topology.vertex_count];
        for (e, &[i, j]) in topology.edges.iter().enumerate() {
            if wrinkled_edge[e] {
                around[i].push((j, e));
                around[j].push((i, e));
            }
        }
        let mut forest = Self {
            component: vec![NONE; topology.vertex_count],
            depth: vec![0; topology.vertex_count],
            parent: vec![NONE; topology.vertex_count],
            edges: vec![false; topology.edge_count()],
            roots: Vec::new(),
        };
        let mut queue = VecDeque::new();
        for root in 0..topology.vertex_count {
            if forest.component[root] != NONE || around[root].is_empty() {
                continue;
            }
            let component = forest.roots.len();
            forest.component[root] = component;
            queue.push_back(root);
            while let Some(v) = queue.pop_front() {
                for &(u, e) in &around[v] {
                    if forest.component[u] == NONE {
                        forest.component[u] = component;
                        forest.depth[u] = forest.depth[v] + 1;
                        forest.parent[u] = v;
                        forest.edges[e] = true;
                        queue.push_back(u);
                    }
                }
            }
            forest.roots.push(root);
        }
        forest
    }

    /// Number of edges of the loop that an edge between `i` and `j` closes.
    fn loop_length(&self, [mut i, mut j]: [usize; 2]) -> usize {
        let mut length = 1;
        while i != j {
            if self.depth[i] < self.depth[j] {
                std::mem::swap(&mut i, &mut j);
            }
            i = self.parent[i];
            length += 1;
        }
        length
    }
}

/// Spanning forest of the wrinkled faces that crosses no edge of the vertices' forest: from outside
/// first, then from one face of each closed part.
struct FaceForest {
    /// `[F]` edge towards the root; [`NONE`] for roots that are not on the boundary.
    parent_edge: Vec<usize>,
    /// `[F]` position in the order in which faces were reached; [`NONE`] for wrinkle-free ones.
    order: Vec<usize>,
}

impl FaceForest {
    fn new(
        topology: &Topology,
        wrinkle_free: &[bool],
        edge_faces: &[[usize; 2]],
        in_tree: &[bool],
    ) -> Self {
        let mut parent_edge = vec![NONE; topology.face_count()];
        let mut order = vec![NONE; topology.face_count()];
        let mut queue = VecDeque::new();
        let mut reached = 0;
        for e in 0..topology.edge_count() {
            let [f, g] = edge_faces[e];
            if f != NONE && g == NONE && !in_tree[e] && order[f] == NONE {
                parent_edge[f] = e;
                order[f] = reached;
                reached += 1;
                queue.push_back(f);
            }
        }
        for start in 0..topology.face_count() {
            while let Some(f) = queue.pop_front() {
                for k in 0..3 {
                    let e = topology.face_edges[f][k];
                    let [a, b] = edge_faces[e];
                    let g = if a == f { b } else { a };
                    if g != NONE && !in_tree[e] && order[g] == NONE {
                        parent_edge[g] = e;
                        order[g] = reached;
                        reached += 1;
                        queue.push_back(g);
                    }
                }
            }
            if !wrinkle_free[start] && order[start] == NONE {
                order[start] = reached;
                reached += 1;
                queue.push_back(start);
            }
        }
        Self { parent_edge, order }
    }

    /// The closed form that is 1 on `generator`, 0 on all other edges outside the forest: only
    /// faces between the generator and its root are touched.
    fn extend(
        &self,
        topology: &Topology,
        edge_faces: &[[usize; 2]],
        generator: usize,
    ) -> Vec<(usize, i32)> {
        let Self { parent_edge, order } = self;
        let mut value = BTreeMap::from([(generator, 1)]);
        let mut todo: BTreeSet<(usize, usize)> =
            edge_faces[generator].iter().filter(|&&f| f != NONE).map(|&f| (order[f], f)).collect();
        while let Some((_, f)) = todo.pop_last() {
            let up = parent_edge[f];
            if up == NONE {
                continue;
            }
            let (mut sum, mut up_sign) = (0, 1);
            for k in 0..3 {
                let e = topology.face_edges[f][k];
                let sign = topology.side_sign(f, k) as i32;
                if e == up {
                    up_sign = sign;
                } else {
                    sum += sign * value.get(&e).copied().unwrap_or(0);
                }
            }
            if sum != 0 {
                value.insert(up, -up_sign * sum);
                let [a, b] = edge_faces[up];
                let g = if a == f { b } else { a };
                if g != NONE {
                    todo.insert((order[g], g));
                }
            }
        }
        value.into_iter().filter(|&(_, v)| v != 0).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An `n × m` grid of squares, each cut in two, closed around in x and/or y if asked.
    fn grid(n: usize, m: usize, around_x: bool, around_y: bool) -> Topology {
        let (columns, rows) = (if around_x { n } else { n + 1 }, if around_y { m } else { m + 1 });
        let at = |i: usize, j: usize| (j % rows) * columns + i % columns;
        let mut faces = Vec::new();
        for j in 0..m {
            for i in 0..n {
                faces.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
                faces.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
            }
        }
        Topology::new(columns * rows, faces).unwrap()
    }

    fn assert_closed(t: &Topology, free: &[bool], forms: &ClosedForms) {
        for f in (0..t.face_count()).filter(|&f| !free[f]) {
            for k in 0..forms.generators.len() {
                let mut unit = vec![0.0; forms.generators.len()];
                unit[k] = 1.0;
                let sum: f64 =
                    (0..3).map(|s| t.side_sign(f, s) * forms.on(t.face_edges[f][s], &unit)).sum();
                assert_eq!(sum, 0.0, "face {f} generator {k}");
            }
        }
    }

    #[test]
    fn there_are_as_many_generators_as_independent_loops() {
        let loops = |t: &Topology, free: &[bool]| {
            let forms = ClosedForms::new(t, free);
            assert_closed(t, free, &forms);
            forms.generators.len()
        };
        let square = grid(6, 6, false, false);
        assert_eq!(loops(&square, &[false; 72]), 0);
        // Two separate holes, each of one square.
        let mut holes = vec![false; 72];
        for f in [2 * 7, 2 * 7 + 1, 2 * 22, 2 * 22 + 1] {
            holes[f] = true;
        }
        assert_eq!(loops(&square, &holes), 2);
        assert_eq!(loops(&grid(8, 5, true, false), &[false; 80]), 1);
        assert_eq!(loops(&grid(8, 5, true, true), &[false; 80]), 2);
    }

    #[test]
    fn the_phase_gains_the_coefficient_around_a_cylinder() {
        let t = grid(8, 5, true, false);
        let forms = ClosedForms::new(&t, &[false; 80]);
        // Walk once around the lower ring: vertices 0, 1, …, 7, 0.
        let mut gain = 0.0;
        for i in 0..8 {
            let (a, b) = (i, (i + 1) % 8);
            let e = t.edges.binary_search(&[a.min(b), a.max(b)]).unwrap();
            gain += if a < b { 1.0 } else { -1.0 } * forms.on(e, &[1.0]);
        }
        assert_eq!(gain.abs(), 1.0);
    }
}
