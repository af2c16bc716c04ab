//! Passes of remeshing: which edges are split, swapped and collapsed, and in which order.

use std::collections::VecDeque;

use super::collapse::Tolerances;
use super::patch::Patch;
use super::{RemeshOptions, RemeshReport, unfold};
use crate::mesh::Vec3;

/// Lengths over asked ones above which edges are split.
pub(super) const SPLIT: f64 = 4.0 / 3.0;
/// Lengths over asked ones below which edges are collapsed: half of 4/5, so that no half of a split
/// edge is.
pub(super) const COLLAPSE: f64 = 0.4;
/// Lengths over asked ones that no collapse makes: some way below where edges are split.
const LONGEST_MADE: f64 = 0.9 * SPLIT;
/// Growth (factor of length less 1) below which a vertex counts as one that does not grow.
const NO_GROWTH: f64 = 1e-9;
/// Largest slope of the asked length along the surface (m/m).
const GRADING: f64 = 0.5;
/// Largest number of swaps for each edge; a Delaunay mesh needs few.
const SWAPS: usize = 64;

/// Changes `patch` until nothing is left to change, or limits are met.
pub(super) fn run(patch: &mut Patch, options: &RemeshOptions) -> RemeshReport {
    let mut report = RemeshReport::default();
    let area: f64 = (0..patch.active.len())
        .filter(|&f| patch.active[f])
        .map(|f| patch.mesh.rest[f].area_m2)
        .sum();
    let budget = options.area_tolerance * area;
    while report.passes < options.most_passes {
        report.passes += 1;
        let before = report.changes();
        split_all(patch, options, &mut report);
        swap_all(patch, &mut report);
        collapse_all(patch, options, budget, &mut report);
        swap_all(patch, &mut report);
        if report.changes() == before {
            report.converged = true;
            break;
        }
    }
    report
}

/// `[V]` asked length (m) of edges at each corner of an active face; infinite elsewhere.
///
/// λ and growth give it. Where normals turn or growth changes along an edge, its ends ask for less;
/// no vertex asks for much more than its neighbours do, so that the mesh is graded. On the border
/// of the active faces the asked lengths are those of the edges.
pub(super) fn asked_lengths(patch: &Patch, options: &RemeshOptions) -> Vec<f64> {
    let growth = |v: usize| options.growth_channel.map(|c| patch.mesh.channels[c][v]);
    let base = |v: usize| {
        let fine = patch.mesh.channels[options.wavelength_channel][v] / options.edges_per_wave;
        if growth(v).is_some_and(|g| (g - 1.0).abs() <= NO_GROWTH) {
            options.longest_m
        } else {
            fine.min(options.longest_m)
        }
    };
    let mut asked = vec![f64::INFINITY; patch.around.len()];
    let mut normals = vec![None; patch.around.len()];
    let mut sides = Vec::new();
    // Lengths (m) of the longest sides at each vertex that may not change.
    let mut fixed = vec![0.0_f64; patch.around.len()];
    let all_active = !patch.active.contains(&false);
    for f in (0..patch.active.len()).filter(|&f| patch.active[f] && !patch.dead[f]) {
        let face = patch.mesh.faces[f];
        for k in 0..3 {
            let (a, b) = (face[k], face[(k + 1) % 3]);
            asked[a] = base(a);
            normals[a].get_or_insert_with(|| patch.normal(a));
            let length = unfold::side(&patch.mesh.rest[f], k);
            sides.push((a, b, length));
            if !all_active && patch.edge_faces(a, b).back.is_some_and(|(g, _)| !patch.active[g]) {
                fixed[a] = fixed[a].max(length);
                fixed[b] = fixed[b].max(length);
            }
        }
    }
    let bases = asked.clone();
    for &(a, b, length) in &sides {
        let (n, m): (Vec3, Vec3) = (normals[a].unwrap_or_default(), normals[b].unwrap_or_default());
        let angle = n.cross(&m).norm().atan2(n.dot(&m));
        let change = growth(a).zip(growth(b)).map_or(0.0, |(g, h)| (g - h).abs());
        // As long as the angle, or the change of growth, along it is the largest allowed.
        let steepness = (angle / options.normal_angle).max(change / options.growth_step);
        if steepness > 0.0 {
            for v in [a, b] {
                asked[v] = asked[v].min((length / steepness).max(options.finest_share * bases[v]));
            }
        }
    }
    for v in (0..fixed.len()).filter(|&v| fixed[v] > 0.0) {
        asked[v] = asked[v].min(fixed[v]);
    }
    spread(&sides, &mut asked);
    // The same from below, for finer edges would not fit onto what is fixed.
    let mut spared: Vec<f64> = fixed.iter().map(|length| -length).collect();
    spread(&sides, &mut spared);
    asked.iter().zip(&spared).map(|(&a, &s)| a.max(-s)).collect()
}

/// Lowers `values` (`[V]`, m) until no slope along the `sides` (ends, length in m) exceeds
/// [`GRADING`].
fn spread(sides: &[(usize, usize, f64)], values: &mut [f64]) {
    let mut done = false;
    while !done {
        done = true;
        for &(a, b, length) in sides {
            for (v, w) in [(a, b), (b, a)] {
                let most = values[v] + GRADING * length;
                // Rounding alone is not worth another round.
                if values[w] > most + 1e-12 * length {
                    values[w] = most;
                    done = false;
                }
            }
        }
    }
}

/// Length (m) over the asked one of an edge whose ends ask for `a` and `b` (m).
pub(super) fn ratio(asked: &[f64], a: usize, b: usize, length: f64) -> f64 {
    2.0 * length / (asked[a] + asked[b])
}

/// Edges that may change, with length over asked length.
fn rated(patch: &Patch, asked: &[f64]) -> Vec<(f64, [usize; 2])> {
    let rate =
        |[a, b]: [usize; 2]| (ratio(asked, a, b, patch.length(&patch.edge_faces(a, b))), [a, b]);
    patch.free_edges().into_iter().map(rate).collect()
}

/// Splits edges that are too long, the worst first.
fn split_all(patch: &mut Patch, options: &RemeshOptions, report: &mut RemeshReport) {
    let mut long = rated(patch, &asked_lengths(patch, options));
    long.retain(|&(ratio, _)| ratio > SPLIT);
    long.sort_by(|x, y| y.0.total_cmp(&x.0).then(x.1.cmp(&y.1)));
    for (_, [a, b]) in long {
        if patch.living >= options.most_vertices {
            report.limited = true;
            return;
        }
        report.splits += usize::from(patch.split(a, b).is_some());
    }
}

/// Swaps until all free edges are Delaunay at rest.
fn swap_all(patch: &mut Patch, report: &mut RemeshReport) {
    let mut waiting: VecDeque<[usize; 2]> = patch.free_edges().into();
    let mut left = SWAPS * waiting.len();
    while let Some([a, b]) = waiting.pop_front() {
        if left == 0 || !patch.wants_swap(a, b) {
            continue;
        }
        if let Some([c, d]) = patch.swap(a, b) {
            left -= 1;
            report.swaps += 1;
            waiting.extend([[a, c], [a, d], [b, c], [b, d]]);
        }
    }
}

/// Collapses edges that are too short, the worst first.
fn collapse_all(
    patch: &mut Patch,
    options: &RemeshOptions,
    budget_m2: f64,
    report: &mut RemeshReport,
) {
    let asked = asked_lengths(patch, options);
    let mut short = rated(patch, &asked);
    short.retain(|&(ratio, _)| ratio < COLLAPSE);
    short.sort_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
    for (_, [a, b]) in short {
        let faces = patch.edge_faces(a, b);
        if faces.iter().count() == 0 || ratio(&asked, a, b, patch.length(&faces)) >= COLLAPSE {
            continue;
        }
        // Younger vertices go first.
        for (v, u) in [(a.max(b), a.min(b)), (a.min(b), a.max(b))] {
            let tolerances = Tolerances {
                flatness: options.flatness,
                area_m2: budget_m2 - report.area_spent_m2,
            };
            let fits =
                |_: &Patch, w: usize, length: f64| ratio(&asked, u, w, length) < LONGEST_MADE;
            if let Some(change) = patch.collapse(v, u, tolerances, fits) {
                report.collapses += 1;
                report.area_change_m2 += change;
                report.area_spent_m2 += change.abs();
                break;
            }
        }
    }
}
