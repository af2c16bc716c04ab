//! Points scattered at random inside closed outlines: no two closer than a spacing, and no room
//! left for one more (maximal Poisson-disk sampling, by the shrinking cells of [Ebeida et al. 2012,
//! "A Simple Algorithm for Maximal Poisson-Disk Sampling in High Dimensions"]).
//!
//! The sampling is maximal because pairwise distances of at least `r` and no empty circle wider
//! than `r` bound the smallest angle of the Delaunay triangulation by 30 degrees, with nothing
//! regular about it. Gaps narrower than 1/5000 of the spacing stay open.

use super::Vec2;
use crate::random::Random;

/// Number of times that the cells in which there may be room are quartered.
const LEVELS: u32 = 12;

/// Points inside `pieces` (closed loops of segments; a point with an odd number of loops around it
/// is inside), at least `spacing` from each other and from every piece's first end, and at least
/// `off_pieces` from every piece. The same arguments give the same points in the same order.
/// Lengths in the unit of `pieces`.
pub(super) fn scatter(pieces: &[[Vec2; 2]], spacing: f64, off_pieces: f64, seed: u64) -> Vec<Vec2> {
    let Some(&[first, _]) = pieces.first() else { return Vec::new() };
    let (lower, upper) =
        pieces.iter().fold((first, first), |(l, u), p| (l.inf(&p[0]), u.sup(&p[0])));
    let fence = Fence::new(pieces, off_pieces, lower.y, upper.y);
    let mut random = Random(seed);
    let mut cell = spacing / 2f64.sqrt();
    let mut samples = Samples::new(lower, upper, cell, spacing);
    for piece in pieces {
        samples.push(piece[0]);
    }

    let may_have_room = |samples: &Samples, at: [u64; 2], cell: f64| {
        let half = 0.5 * cell;
        let centre = lower + Vec2::new((at[0] as f64 + 0.5) * cell, (at[1] as f64 + 0.5) * cell);
        fence.clearance(centre) > off_pieces - half * 2f64.sqrt() && !samples.cover(centre, half)
    };
    let mut open: Vec<[u64; 2]> = Vec::new();
    for iy in 0..samples.rows as u64 {
        open.extend(
            (0..samples.columns as u64)
                .map(|ix| [ix, iy])
                .filter(|&at| may_have_room(&samples, at, cell)),
        );
    }
    for _ in 0..LEVELS {
        for _ in 0..open.len() {
            let i = random.below(open.len());
            let at = open[i];
            let p = lower
                + Vec2::new(
                    (at[0] as f64 + random.unit()) * cell,
                    (at[1] as f64 + random.unit()) * cell,
                );
            if samples.leave_room(p) && fence.clearance(p) >= off_pieces {
                samples.push(p);
                open.swap_remove(i);
                if open.is_empty() {
                    break;
                }
            }
        }
        cell *= 0.5;
        let quarters = open.iter().flat_map(|&[x, y]| {
            [[2 * x, 2 * y], [2 * x + 1, 2 * y], [2 * x, 2 * y + 1], [2 * x + 1, 2 * y + 1]]
        });
        open = quarters.filter(|&at| may_have_room(&samples, at, cell)).collect();
    }
    samples.points.split_off(pieces.len())
}

/// The outline, cut into horizontal strips so that a query looks at few pieces.
struct Fence<'a> {
    pieces: &'a [[Vec2; 2]],
    /// Distances are only wanted up to this one; also the height of a strip.
    reach: f64,
    lower_y: f64,
    /// `[strips]` the pieces within `reach` of each strip.
    strips: Vec<Vec<u32>>,
}

impl<'a> Fence<'a> {
    fn new(pieces: &'a [[Vec2; 2]], reach: f64, lower_y: f64, upper_y: f64) -> Self {
        let mut fence = Self {
            pieces,
            reach,
            lower_y,
            strips: vec![Vec::new(); ((upper_y - lower_y) / reach) as usize + 1],
        };
        for (i, [a, b]) in pieces.iter().enumerate() {
            for strip in fence.strip(a.y.min(b.y) - reach)..=fence.strip(a.y.max(b.y) + reach) {
                fence.strips[strip].push(i as u32);
            }
        }
        fence
    }

    fn strip(&self, y: f64) -> usize {
        (((y - self.lower_y) / self.reach).max(0.0) as usize).min(self.strips.len() - 1)
    }

    /// Distance from `p` to the nearest piece, at most `reach`; negative outside.
    fn clearance(&self, p: Vec2) -> f64 {
        let mut squared = self.reach * self.reach;
        let mut inside = false;
        for &i in &self.strips[self.strip(p.y)] {
            let [a, b] = self.pieces[i as usize];
            let along = b - a;
            let t = ((p - a).dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
            squared = squared.min((p - a - along * t).norm_squared());
            if (a.y > p.y) != (b.y > p.y) && p.x < a.x + along.x * (p.y - a.y) / along.y {
                inside = !inside;
            }
        }
        if inside { squared.sqrt() } else { -squared.sqrt() }
    }
}

/// The points so far, in linked lists per cell of a grid whose cells are `spacing`/√2 wide.
struct Samples {
    points: Vec<Vec2>,
    lower: Vec2,
    cell: f64,
    spacing: f64,
    columns: usize,
    rows: usize,
    /// `[rows][columns]` the newest point in each cell.
    newest: Vec<u32>,
    /// `[points]` the next older point in the same cell.
    older: Vec<u32>,
}

impl Samples {
    fn new(lower: Vec2, upper: Vec2, cell: f64, spacing: f64) -> Self {
        let columns = ((upper.x - lower.x) / cell) as usize + 1;
        let rows = ((upper.y - lower.y) / cell) as usize + 1;
        Self {
            points: Vec::new(),
            lower,
            cell,
            spacing,
            columns,
            rows,
            newest: vec![u32::MAX; columns * rows],
            older: Vec::new(),
        }
    }

    fn cell_of(&self, p: Vec2) -> [usize; 2] {
        let q = (p - self.lower) / self.cell;
        [(q.x.max(0.0) as usize).min(self.columns - 1), (q.y.max(0.0) as usize).min(self.rows - 1)]
    }

    fn push(&mut self, p: Vec2) {
        let [ix, iy] = self.cell_of(p);
        let head = &mut self.newest[iy * self.columns + ix];
        self.older.push(*head);
        *head = self.points.len() as u32;
        self.points.push(p);
    }

    /// True if `test` holds for a point in the 25 cells around `p`: all points within `spacing` of
    /// `p` are among them.
    fn any_near(&self, p: Vec2, test: impl Fn(Vec2) -> bool) -> bool {
        let [ix, iy] = self.cell_of(p);
        for y in iy.saturating_sub(2)..=(iy + 2).min(self.rows - 1) {
            for x in ix.saturating_sub(2)..=(ix + 2).min(self.columns - 1) {
                let mut i = self.newest[y * self.columns + x];
                while i != u32::MAX {
                    if test(self.points[i as usize]) {
                        return true;
                    }
                    i = self.older[i as usize];
                }
            }
        }
        false
    }

    /// True if `p` is at least the spacing from every point.
    fn leave_room(&self, p: Vec2) -> bool {
        !self.any_near(p, |q| (p - q).norm_squared() < self.spacing * self.spacing)
    }

    /// True if one point's disk covers the whole square of half width `half` around `centre`.
    fn cover(&self, centre: Vec2, half: f64) -> bool {
        self.any_near(centre, |q| {
            ((centre - q).abs() + Vec2::new(half, half)).norm_squared()
                < self.spacing * self.spacing
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(width: f64) -> Vec<[Vec2; 2]> {
        let n = width as usize;
        let corners = [
            Vec2::new(0.0, 0.0),
            Vec2::new(width, 0.0),
            Vec2::new(width, width),
            Vec2::new(0.0, width),
        ];
        let at = |side: usize, k: usize| {
            corners[side].lerp(&corners[(side + 1) % 4], k as f64 / n as f64)
        };
        (0..4).flat_map(|side| (0..n).map(move |k| [at(side, k), at(side, k + 1)])).collect()
    }

    #[test]
    fn points_keep_their_distances_and_leave_no_gap() {
        let (width, spacing, off) = (12.0, 0.8, 0.5);
        let points = scatter(&square(width), spacing, off, 3);
        let inside = |p: &Vec2| p.x.min(p.y).min(width - p.x).min(width - p.y) >= off - 1e-12;
        assert!(points.iter().all(inside));
        let pieces = square(width);
        let all: Vec<Vec2> = pieces.iter().map(|p| p[0]).chain(points.iter().copied()).collect();
        for (i, p) in all.iter().enumerate().skip(pieces.len()) {
            assert!(all[..i].iter().all(|q| (p - q).norm() >= spacing));
        }
        let mut random = Random(99);
        for _ in 0..20_000 {
            let p = Vec2::new(random.unit(), random.unit()) * width;
            assert!(
                !inside(&p) || all.iter().any(|q| (p - q).norm() < 1.001 * spacing),
                "room left at {p}"
            );
        }
    }

    #[test]
    fn the_seed_decides() {
        let points = |seed| scatter(&square(9.0), 0.8, 0.5, seed);
        assert_eq!(points(1), points(1));
        assert_ne!(points(1), points(2));
    }
}
