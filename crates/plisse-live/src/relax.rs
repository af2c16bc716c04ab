//! Stage "Relax" (5.2): aligns the phases of neighbouring plane waves.
//!
//! [`relax`] is the paper's gradient descent (eq. 6), one round from one buffer to another. Its only departures: weights use the
//! amplitude's share of W/4, and a vertex whose wrinkles nobody sees follows its neighbours at
//! once, so that wrinkles that appear are already aligned. [`spread`] is ours: it gives phases to
//! wrinkles that nobody has seen yet, by walking outwards from those there are, so that descent
//! starts near the best answer instead of at random, where it gets caught in bifurcations.

use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::f32::consts::{PI, TAU};

use rayon::prelude::*;

use crate::crush::Crushed;
use crate::unify::Unified;
use crate::{CHUNK, Vec3, wrap};

/// Share of the largest amplitude below which wrinkles are taken as invisible (flat to 0.1 %).
pub const VISIBLE: f32 = 0.05;

/// Weight of a neighbour with this strength: clamp(4h − 0.2, 0, 1), h being the share of W/4
/// (section 5.2).
pub fn weight(strength: f32) -> f32 {
    (4.0 * strength - 0.2).clamp(0.0, 1.0)
}

/// Phase error e in [−½, ½) waves at the middle of the edge from `v` to `n`, and the sign that
/// aligns n's wave with v's.
pub fn mismatch(crushed: &Crushed, positions: &[Vec3], phase: &[f32], v: usize, n: usize) -> f32 {
    let half = 0.5 * (positions[n] - positions[v]);
    let sign = if crushed.wave[n].dot(&crushed.wave[v]) < 0.0 { -1.0 } else { 1.0 };
    let own = crushed.wave[v].dot(&half) + phase[v];
    let other = sign * (phase[n] - crushed.wave[n].dot(&half));
    let waves = (other - own) / TAU;
    waves - (waves + 0.5).floor()
}

/// One round of eq. 6: reads `phase` (`[U]`, rad) and writes `next`. `rate` is ε/(2π²): with 1, a
/// vertex goes all the way to the mean that its neighbours ask for (the paper's ε is 2π²·rate). At
/// most ½: beyond, rounds oscillate. A visible vertex moves by no more than π·rate a round, so ¼
/// and one round a frame never jump more than π/4.
pub fn relax(
    unified: &Unified,
    positions: &[Vec3],
    crushed: &Crushed,
    rate: f32,
    phase: &[f32],
    next: &mut [f32],
) {
    next.par_iter_mut().enumerate().with_min_len(CHUNK).for_each(|(v, next)| {
        let around = unified.around(v);
        let (mut pull, mut weights) = (0.0, 0.0);
        for &n in around {
            let n = n as usize;
            let w = weight(crushed.strength[n]);
            if w > 0.0 {
                pull += w * mismatch(crushed, positions, phase, v, n);
                weights += w;
            }
        }
        let step = if weights == 0.0 {
            0.0
        } else if crushed.strength[v] < VISIBLE {
            TAU * pull / weights
        } else {
            rate * TAU * pull / around.len() as f32
        };
        *next = wrap(phase[v] + step);
    });
}

/// `rounds` of [`relax`] in place, with two buffers.
pub fn relax_rounds(
    unified: &Unified,
    positions: &[Vec3],
    crushed: &Crushed,
    rate: f32,
    rounds: usize,
    phase: &mut Vec<f32>,
) {
    let mut next = vec![0.0; phase.len()];
    for _ in 0..rounds {
        relax(unified, positions, crushed, rate, phase, &mut next);
        std::mem::swap(phase, &mut next);
    }
}

/// Mean of |e| (waves, 0 to ½) over all edges whose ends are both visible; 0 without any. Random
/// phases give about ¼.
pub fn mean_phase_error(
    unified: &Unified,
    positions: &[Vec3],
    crushed: &Crushed,
    phase: &[f32],
) -> f32 {
    let (mut sum, mut count) = (0.0f64, 0usize);
    for v in 0..phase.len() {
        for &n in unified.around(v).iter().filter(|&&n| n as usize > v) {
            if crushed.strength[v] >= VISIBLE && crushed.strength[n as usize] >= VISIBLE {
                sum += f64::from(mismatch(crushed, positions, phase, v, n as usize).abs());
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

/// An edge that waits to hand a phase from `from` to `to`; the one with the clearest wrinkles
/// first.
struct Step {
    clarity: f32,
    from: u32,
    to: u32,
}

impl PartialEq for Step {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}
impl Eq for Step {}
impl PartialOrd for Step {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Step {
    fn cmp(&self, other: &Self) -> Ordering {
        self.clarity
            .total_cmp(&other.clarity)
            .then(other.to.cmp(&self.to))
            .then(other.from.cmp(&self.from))
    }
}

/// Phases (`[U]`, rad) for vertices that have none yet: from those in `fixed` (`[U]`, or empty:
/// none), and from the strongest vertex of each piece without any, outwards along the clearest
/// edges. Each vertex takes the phase at which its wave meets its predecessor's in the middle of
/// their edge. `start` (`[U]`) holds the fixed phases, and those with which pieces begin.
pub fn spread(
    unified: &Unified,
    positions: &[Vec3],
    crushed: &Crushed,
    start: &[f32],
    fixed: &[bool],
) -> Vec<f32> {
    let count = unified.count();
    let is_fixed = |v: usize| fixed.get(v).copied().unwrap_or(false);
    let mut seeds: Vec<usize> = (0..count).collect();
    let by_strength =
        |a: &usize, b: &usize| crushed.strength[*b].total_cmp(&crushed.strength[*a]).then(a.cmp(b));
    seeds.sort_by(|a, b| is_fixed(*b).cmp(&is_fixed(*a)).then(by_strength(a, b)));
    let mut phase = start.to_vec();
    let mut known: Vec<bool> = (0..count).map(is_fixed).collect();
    let mut queue = BinaryHeap::new();
    let push_around = |v: usize, known: &[bool], queue: &mut BinaryHeap<Step>| {
        for &n in unified.around(v).iter().filter(|&&n| !known[n as usize]) {
            let (a, b) = (&crushed.wave[v], &crushed.wave[n as usize]);
            let parallel = a.dot(b).abs() / (a.norm() * b.norm()).max(1e-30);
            let strength = crushed.strength[v].min(crushed.strength[n as usize]);
            queue.push(Step { clarity: parallel * weight(strength), from: v as u32, to: n });
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
        while let Some(Step { from, to, .. }) = queue.pop() {
            let (from, to) = (from as usize, to as usize);
            if !std::mem::replace(&mut known[to], true) {
                phase[to] = wrap(phase[to] + TAU * mismatch(crushed, positions, &phase, to, from));
                push_around(to, &known, &mut queue);
            }
        }
    }
    phase
}
