//! Combing: turn each face's compression direction, a line without a head, so that neighbours
//! agree.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use crate::mesh::{Topology, Vec3};

/// `[F]` +1 or −1 for each face: multiplied by it, `directions` (`[F]`, vectors in the faces'
/// planes of the pose `positions`) agree with their neighbours' as well as a tree allows that joins
/// the surest pairs first. Faces with `skip` set stay +1 and join nothing.
///
/// Two faces are compared after unfolding them along their edge. How sure a pair is: |cosine| times
/// the smaller length.
pub fn comb(
    topology: &Topology,
    positions: &[Vec3],
    directions: &[Vec3],
    skip: &[bool],
) -> Vec<f64> {
    let mut sign = vec![0.0; topology.face_count()];
    let mut heap = BinaryHeap::new();
    // Start where compression is strongest, so that the surest faces decide.
    let mut seeds: Vec<usize> = (0..topology.face_count()).filter(|&f| !skip[f]).collect();
    seeds.sort_by(|&f, &g| directions[g].norm().total_cmp(&directions[f].norm()).then(f.cmp(&g)));
    for seed in seeds {
        if sign[seed] != 0.0 {
            continue;
        }
        sign[seed] = 1.0;
        let mut last = seed;
        loop {
            for k in 0..3 {
                if let Some(g) = topology.neighbour(last, k).filter(|&g| !skip[g] && sign[g] == 0.0)
                {
                    let agreement = unfolded_dot(
                        topology,
                        positions,
                        directions,
                        last,
                        g,
                        topology.face_edges[last][k],
                    );
                    let lengths = directions[last].norm() * directions[g].norm();
                    let cosine = if lengths > 0.0 { agreement / lengths } else { 0.0 };
                    let sureness = cosine.abs() * directions[last].norm().min(directions[g].norm());
                    heap.push(Pair {
                        sureness,
                        face: g,
                        sign: sign[last] * if agreement < 0.0 { -1.0 } else { 1.0 },
                    });
                }
            }
            let next = loop {
                match heap.pop() {
                    Some(pair) if sign[pair.face] == 0.0 => break Some(pair),
                    Some(_) => {}
                    None => break None,
                }
            };
            let Some(pair) = next else { break };
            sign[pair.face] = pair.sign;
            last = pair.face;
        }
    }
    sign.iter().map(|&s| if s == 0.0 { 1.0 } else { s }).collect()
}

struct Pair {
    sureness: f64,
    face: usize,
    sign: f64,
}

impl Ord for Pair {
    fn cmp(&self, other: &Self) -> Ordering {
        self.sureness
            .total_cmp(&other.sureness)
            .then(other.face.cmp(&self.face))
            .then(self.sign.total_cmp(&other.sign))
    }
}
impl PartialOrd for Pair {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl PartialEq for Pair {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}
impl Eq for Pair {}

/// Dot product of two faces' directions after unfolding the faces along their common edge `e`.
fn unfolded_dot(
    topology: &Topology,
    positions: &[Vec3],
    directions: &[Vec3],
    f: usize,
    g: usize,
    e: usize,
) -> f64 {
    let along = (positions[topology.edges[e][1]] - positions[topology.edges[e][0]])
        .try_normalize(0.0)
        .unwrap_or_else(Vec3::zeros);
    let normal = |f: usize| {
        let [i, j, k] = topology.faces[f];
        (positions[j] - positions[i])
            .cross(&(positions[k] - positions[i]))
            .try_normalize(0.0)
            .unwrap_or_else(Vec3::zeros)
    };
    let across = |f: usize| normal(f).cross(&along);
    directions[f].dot(&along) * directions[g].dot(&along)
        + directions[f].dot(&across(f)) * directions[g].dot(&across(g))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scrambled_signs_are_combed_straight() {
        // A bent strip with one direction across it, signs scrambled.
        let n = 30;
        let faces: Vec<_> = (0..n)
            .map(|i| if i % 2 == 0 { [i, i + 1, i + 2] } else { [i + 1, i, i + 2] })
            .collect();
        let topology = Topology::new(n + 2, faces).unwrap();
        let positions: Vec<Vec3> = (0..n + 2)
            .map(|i| {
                let angle = 0.2 * i as f64;
                Vec3::new(angle.cos(), angle.sin(), if i % 2 == 0 { 0.0 } else { 0.3 })
            })
            .collect();
        let scrambled = |f: usize| if (f * 7919) % 5 < 2 { -1.0 } else { 1.0 };
        let directions: Vec<Vec3> = (0..n).map(|f| Vec3::z() * scrambled(f)).collect();
        let sign = comb(&topology, &positions, &directions, &vec![false; n]);
        let first = sign[0] * scrambled(0);
        assert!((0..n).all(|f| sign[f] * scrambled(f) == first));
    }
}
