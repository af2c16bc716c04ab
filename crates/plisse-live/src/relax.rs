//! Stage "Relax" (5.2): aligns the phases of neighbouring plane waves.
//!
//! [`relax`] is the paper's gradient descent (eq. 6), one round from one buffer to another. It
//! departs from the paper in two points: weights use the amplitude's share of W/4, and a vertex
//! whose wrinkles are invisible follows its neighbours at once, so that wrinkles that appear are
//! already aligned. [`propagate_phases`] is ours: it gives phases to wrinkles that have just
//! appeared by walking outwards from the visible ones, so that descent starts near the best answer.
//! From random phases it would end in bifurcations.

use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::f32::consts::{PI, TAU};

use rayon::prelude::*;

use crate::crush::PlaneWaves;
use crate::weld::WeldedMesh;
use crate::{CHUNK, Vec3, wrap};

/// Share of the largest amplitude below which wrinkles count as invisible (flat to 0.1 %).
pub const VISIBLE: f32 = 0.05;

/// True (`[U]`) for the vertices whose wrinkles are visible.
pub fn visible(waves: &PlaneWaves) -> Vec<bool> {
    waves.strength.iter().map(|&s| s >= VISIBLE).collect()
}

/// The data that couple the phases of neighbours. They stay fixed while phases relax.
#[derive(Clone, Copy, Debug)]
pub struct PhaseCoupling<'a> {
    /// The mesh, for its neighbours.
    pub mesh: &'a WeldedMesh,
    /// `[U]` posed positions (m).
    pub positions: &'a [Vec3],
    /// The plane waves.
    pub waves: &'a PlaneWaves,
}

/// Weight of a neighbour with this strength: clamp(4h − 0.2, 0, 1), h being the share of W/4
/// (section 5.2).
pub fn weight(strength: f32) -> f32 {
    (4.0 * strength - 0.2).clamp(0.0, 1.0)
}

/// Phase error e in [−½, ½) waves at the middle of the edge from `v` to `n`, for `phase` (`[U]`,
/// rad). The wave of n is turned to the direction of v's.
pub fn phase_error(coupling: &PhaseCoupling<'_>, phase: &[f32], v: usize, n: usize) -> f32 {
    let (positions, waves) = (coupling.positions, coupling.waves);
    let half = 0.5 * (positions[n] - positions[v]);
    let sign = if waves.wave[n].dot(&waves.wave[v]) < 0.0 { -1.0 } else { 1.0 };
    let own = waves.wave[v].dot(&half) + phase[v];
    let other = sign * (phase[n] - waves.wave[n].dot(&half));
    let cycles = (other - own) / TAU;
    cycles - (cycles + 0.5).floor()
}

/// One round of eq. 6: reads `phase` (`[U]`, rad) and writes `next`.
///
/// `rate` is ε/(2π²): with 1, a vertex goes all the way to the mean that its neighbours ask for
/// (the paper's ε is 2π²·rate). It is at most ½, beyond which rounds oscillate. A visible vertex
/// moves by no more than π·rate a round, so ¼ and one round a frame never jump more than π/4.
pub fn relax(coupling: &PhaseCoupling<'_>, rate: f32, phase: &[f32], next: &mut [f32]) {
    let (mesh, waves) = (coupling.mesh, coupling.waves);
    next.par_iter_mut().enumerate().with_min_len(CHUNK).for_each(|(v, next)| {
        let around = mesh.around(v);
        let (mut pull, mut weights) = (0.0, 0.0);
        for &n in around {
            let n = n as usize;
            let w = weight(waves.strength[n]);
            if w > 0.0 {
                pull += w * phase_error(coupling, phase, v, n);
                weights += w;
            }
        }
        let step = if weights == 0.0 {
            0.0
        } else if waves.strength[v] < VISIBLE {
            TAU * pull / weights
        } else {
            rate * TAU * pull / around.len() as f32
        };
        *next = wrap(phase[v] + step);
    });
}

/// `rounds` of [`relax`] in place, with two buffers.
pub fn relax_rounds(coupling: &PhaseCoupling<'_>, rate: f32, rounds: usize, phase: &mut Vec<f32>) {
    let mut next = vec![0.0; phase.len()];
    for _ in 0..rounds {
        relax(coupling, rate, phase, &mut next);
        std::mem::swap(phase, &mut next);
    }
}

/// Mean of |e| (waves, 0 to ½) over all edges whose ends are both visible; 0 without any. Random
/// phases give about ¼.
pub fn mean_phase_error(coupling: &PhaseCoupling<'_>, phase: &[f32]) -> f32 {
    let strength = &coupling.waves.strength;
    let (mut sum, mut count) = (0.0f64, 0usize);
    for v in 0..phase.len() {
        for &n in coupling.mesh.around(v).iter().filter(|&&n| n as usize > v) {
            if strength[v] >= VISIBLE && strength[n as usize] >= VISIBLE {
                sum += f64::from(phase_error(coupling, phase, v, n as usize).abs());
                count += 1;
            }
        }
    }
    (sum / count.max(1) as f64) as f32
}
/// Uniform phases in [−π, π) (`[U]`, rad) from `seed`, as the paper starts.
pub fn random_phases(count: usize, seed: u64) -> Vec<f32> {
    (0..count as u64)
        .map(|v| {
            // SplitMix64 of (seed, v): the same on every machine and in any order.
            let mut z = seed
                .wrapping_mul(0xD134_2543_DE82_EF95)
                .wrapping_add((v + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15));
            z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
            z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
            (((z ^ (z >> 31)) >> 40) as f32 / (1u64 << 24) as f32 - 0.5) * 2.0 * PI
        })
        .collect()
}

/// An edge along which a phase may be handed on. The edge with the clearest wrinkles comes first.
struct Handover {
    clarity: f32,
    from: u32,
    to: u32,
}

impl PartialEq for Handover {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}
impl Eq for Handover {}
impl PartialOrd for Handover {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Handover {
    fn cmp(&self, other: &Self) -> Ordering {
        self.clarity
            .total_cmp(&other.clarity)
            .then(other.to.cmp(&self.to))
            .then(other.from.cmp(&self.from))
    }
}

/// Phases (`[U]`, rad) propagated over the mesh, to vertices that have none yet.
///
/// They come from the vertices in `fixed` (`[U]`, or empty: none); in a piece without any, from its
/// strongest vertex. They go outwards along the clearest edges: each vertex takes the phase at
/// which its wave meets its predecessor's in the middle of their edge. `start` (`[U]`) holds the
/// fixed phases, and those with which pieces begin.
pub fn propagate_phases(coupling: &PhaseCoupling<'_>, start: &[f32], fixed: &[bool]) -> Vec<f32> {
    let PhaseCoupling { mesh, waves, .. } = *coupling;
    let count = mesh.count();
    let is_fixed = |v: usize| fixed.get(v).copied().unwrap_or(false);
    let mut seeds: Vec<usize> = (0..count).collect();
    let by_strength =
        |a: &usize, b: &usize| waves.strength[*b].total_cmp(&waves.strength[*a]).then(a.cmp(b));
    seeds.sort_by(|a, b| is_fixed(*b).cmp(&is_fixed(*a)).then(by_strength(a, b)));
    let mut phase = start.to_vec();
    let mut known: Vec<bool> = (0..count).map(is_fixed).collect();
    let mut queue = BinaryHeap::new();
    let push_around = |v: usize, known: &[bool], queue: &mut BinaryHeap<Handover>| {
        for &n in mesh.around(v).iter().filter(|&&n| !known[n as usize]) {
            let (a, b) = (&waves.wave[v], &waves.wave[n as usize]);
            let parallel = a.dot(b).abs() / (a.norm() * b.norm()).max(1e-30);
            let strength = waves.strength[v].min(waves.strength[n as usize]);
            queue.push(Handover { clarity: parallel * weight(strength), from: v as u32, to: n });
        }
    };
    // All fixed vertices begin together; then one seed for each piece that they do not reach.
    let (begin, others) = seeds.split_at(known.iter().filter(|&&k| k).count());
    begin.iter().for_each(|&v| push_around(v, &known, &mut queue));
    for next in std::iter::once(None).chain(others.iter().map(Some)) {
        if let Some(&seed) = next.filter(|&&seed| !known[seed]) {
            known[seed] = true;
            push_around(seed, &known, &mut queue);
        }
        while let Some(Handover { from, to, .. }) = queue.pop() {
            let (from, to) = (from as usize, to as usize);
            if !std::mem::replace(&mut known[to], true) {
                phase[to] = wrap(phase[to] + TAU * phase_error(coupling, &phase, to, from));
                push_around(to, &known, &mut queue);
            }
        }
    }
    phase
}
