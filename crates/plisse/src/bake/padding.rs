//! Growing islands into the empty texels around them.

use rayon::prelude::*;

use super::maps::{Baked, Coverage};

/// Grows all islands of `baked` by `texels`: each new texel has the mean of those around it that
/// there were before.
pub(super) fn pad(baked: &mut Baked, texels: usize) {
    let n = baked.size;
    for _ in 0..texels {
        let rows: Vec<Vec<(usize, f32, [f32; 3])>> =
            (0..n).into_par_iter().map(|y| grown(baked, y)).collect();
        if rows.iter().all(Vec::is_empty) {
            return;
        }
        for (at, height_m, normal) in rows.into_iter().flatten() {
            baked.height_m[at] = height_m;
            baked.normal[at] = normal;
            baked.coverage[at] = Coverage::Padded;
        }
    }
}

/// Texels of row `y` that have something beside them, with their new values.
fn grown(baked: &Baked, y: usize) -> Vec<(usize, f32, [f32; 3])> {
    let n = baked.size;
    let mut list = Vec::new();
    for x in (0..n).filter(|x| baked.coverage[y * n + x] == Coverage::None) {
        let (mut count, mut height_m, mut sum) = (0, 0.0, [0.0; 3]);
        for j in y.saturating_sub(1)..(y + 2).min(n) {
            for i in x.saturating_sub(1)..(x + 2).min(n) {
                let from = j * n + i;
                if baked.coverage[from] != Coverage::None {
                    count += 1;
                    height_m += baked.height_m[from];
                    (0..3).for_each(|k| sum[k] += baked.normal[from][k]);
                }
            }
        }
        if count > 0 {
            let length = sum.iter().map(|x| x * x).sum::<f32>().sqrt();
            let normal = if length > 1e-6 { sum.map(|x| x / length) } else { [0.0, 0.0, 1.0] };
            list.push((y * n + x, height_m / count as f32, normal));
        }
    }
    list
}
