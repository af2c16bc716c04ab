//! Rigid bands: sets of vertices that move as rigid bodies.
//!
//! A band is an affine body (Lan et al. 2022, *Affine AffineBody Dynamics*): with p the place of a
//! vertex about the band's centre, over the band's size, all its displacements are D·p + t, with
//! twelve unknowns in place of three for each vertex. D is linear in them, so that energies that
//! are quadratic in the displacements stay quadratic. The energy K·‖FᵀF − I‖² with F = I +
//! D·(unit/size) and a large K keeps F close to a rotation; in the end it is replaced by the
//! nearest one.

use nalgebra::SMatrix;

use super::maps::GrowthAt;
use crate::linalg::IndexBlocks;
use crate::linalg::psd_projection::project_to_psd;
use crate::linalg::sparse::SymmetricPattern;
use crate::linalg::{Problem, PsdProjection};
use crate::mesh::{Mat3, NONE, Vec3};
use crate::{Error, Result};

/// Stiffness K of a band over that of a sheet of its area (no unit): large enough to keep it rigid.
const STIFFNESS_RATIO: f64 = 1e4;
/// Unknowns of a band: D row by row, then t.
const UNKNOWNS: usize = 12;

/// A set of vertices that move together, with an affine map as its unknowns.
#[derive(Clone, Debug)]
pub(super) struct AffineBody {
    vertices: Vec<usize>,
    /// Mean of the starting places (m).
    centre: Vec3,
    /// Largest distance (m) from it.
    size_m: f64,
    /// K, in units of energy.
    stiffness: f64,
    /// Its first unknown.
    first: usize,
}

impl AffineBody {
    /// Unknowns of the nearest rigid motion of the band to `pose` (`[V]`, m), in units of
    /// `length_m`.
    fn fit(&self, start: &[Vec3], pose: &[Vec3], length_m: f64) -> [f64; UNKNOWNS] {
        let mean =
            self.vertices.iter().map(|&v| pose[v]).sum::<Vec3>() / self.vertices.len() as f64;
        let turned: Mat3 = self
            .vertices
            .iter()
            .map(|&v| (pose[v] - mean) * (start[v] - self.centre).transpose())
            .sum();
        let rotation = nearest_rotation(&turned);
        let change = (rotation - Mat3::identity()) * (self.size_m / length_m);
        let shift = (mean - self.centre) / length_m;
        std::array::from_fn(|u| if u < 9 { change[(u / 3, u % 3)] } else { shift[u - 9] })
    }

    /// F = I + D·(unit/size).
    fn deformation(&self, x: &[f64], length_m: f64) -> Mat3 {
        Mat3::identity()
            + Mat3::from_fn(|i, j| x[self.first + 3 * i + j]) * (length_m / self.size_m)
    }

    /// K‖FᵀF − I‖².
    fn energy(&self, x: &[f64], length_m: f64) -> f64 {
        let f = self.deformation(x, length_m);
        self.stiffness * (f.transpose() * f - Mat3::identity()).norm_squared()
    }

    /// Its gradient in the entries of F, row by row.
    fn gradient(&self, x: &[f64], length_m: f64) -> Mat3 {
        let f = self.deformation(x, length_m);
        f * (f.transpose() * f - Mat3::identity()) * (4.0 * self.stiffness)
    }

    /// Its Hessian in the entries of F, row by row.
    fn hessian(&self, x: &[f64], length_m: f64) -> SMatrix<f64, 9, 9> {
        let f = self.deformation(x, length_m);
        let (excess, spread) = (f.transpose() * f - Mat3::identity(), f * f.transpose());
        SMatrix::from_fn(|m, n| {
            let ((i, k), (j, l)) = ((m / 3, m % 3), (n / 3, n % 3));
            let own = if i == j { excess[(k, l)] } else { 0.0 };
            let side = if k == l { spread[(i, j)] } else { 0.0 };
            4.0 * self.stiffness * (own + side + f[(i, l)] * f[(j, k)])
        })
    }
}

/// The rotation nearest to `m`, which may have any rank.
fn nearest_rotation(m: &Mat3) -> Mat3 {
    let svd = m.svd(true, true);
    let (Some(u), Some(v)) = (svd.u, svd.v_t) else { return Mat3::identity() };
    // The least singular direction, the last, is turned over where the product would mirror.
    let mirror = Mat3::from_diagonal(&Vec3::new(1.0, 1.0, (u * v).determinant().signum()));
    u * mirror * v
}

/// A problem whose bands move as affine bodies: its unknowns y give those of the inner one, x =
/// S·y.
pub(super) struct RigidBands<P> {
    inner: P,
    bodies: Vec<AffineBody>,
    length_m: f64,
    /// `[inner size]` number of each free unknown in y, or [`NONE`] for one of a body.
    free: Vec<usize>,
    /// `[inner size]` for an unknown of a body: the body, the axis, and the weights of D's row and
    /// of t.
    carried: Vec<Option<(usize, usize, [f64; 4])>>,
    free_size: usize,
    pattern: SymmetricPattern,
    /// Contributions of inner to outer Hessian values: both slots and a factor.
    scatter: Vec<(u32, u32, f64)>,
    inner_x: Vec<f64>,
    inner_gradient: Vec<f64>,
    inner_values: Vec<f64>,
    x: Vec<f64>,
}

/// Checks the vertices of bands.
///
/// # Errors
/// [`Error::Value`] naming the band that is empty, or the vertex that is also frozen or in another
/// band.
pub(super) fn check_bands(bands: &[Vec<usize>], vertices: &[GrowthAt]) -> Result<()> {
    let mut band_of = vec![NONE; vertices.len()];
    for (b, band) in bands.iter().enumerate() {
        let place = format!("growth.band[{b}]");
        if band.is_empty() {
            return Err(Error::value(place, "it holds no vertex; let it reach over some"));
        }
        for &v in band {
            if v >= vertices.len() {
                return Err(Error::value(
                    place,
                    format!("it names vertex {v} of {}; name those there are", vertices.len()),
                ));
            }
            if vertices[v].frozen.contains(&true) {
                return Err(Error::value(
                    place,
                    format!("vertex {v} is frozen and in the band; let it be one of them"),
                ));
            }
            if band_of[v] != NONE {
                let message = format!(
                    "vertex {v} is in band {} too; let bands keep apart, or make them one",
                    band_of[v]
                );
                return Err(Error::value(place, message));
            }
            band_of[v] = b;
        }
    }
    Ok(())
}

/// The affine bodies of `bands` that start at `start` (`[V]`, m); `area_m2` (`[V]`) is each
/// vertex's area, `length_m` the unit of the unknowns.
pub(super) fn affine_bodies(
    bands: &[Vec<usize>],
    start: &[Vec3],
    area_m2: &[f64],
    length_m: f64,
) -> Vec<AffineBody> {
    let of_band = |band: &Vec<usize>| {
        let centre = band.iter().map(|&v| start[v]).sum::<Vec3>() / band.len() as f64;
        let size_m = band
            .iter()
            .map(|&v| (start[v] - centre).norm())
            .fold(0.0, f64::max)
            .max(f64::MIN_POSITIVE.sqrt());
        let area: f64 = band.iter().map(|&v| area_m2[v]).sum();
        let stiffness = STIFFNESS_RATIO * area / (length_m * length_m);
        AffineBody { vertices: band.clone(), centre, size_m, stiffness, first: 0 }
    };
    bands.iter().map(of_band).collect()
}

impl<P: Problem> RigidBands<P> {
    /// `inner` with its `bodies` held together; `unknown` (`[V][3]`) are its unknowns,
    /// displacements in units of `length_m` from `start` (`[V]`, m).
    pub(super) fn new(
        inner: P,
        mut bodies: Vec<AffineBody>,
        unknown: &[[usize; 3]],
        start: &[Vec3],
        length_m: f64,
    ) -> Self {
        let inner_pattern = inner.pattern();
        let size = inner_pattern.size();
        let mut carried = vec![None; size];
        for (b, body) in bodies.iter().enumerate() {
            for &v in &body.vertices {
                let p = (start[v] - body.centre) / body.size_m;
                for axis in 0..3 {
                    carried[unknown[v][axis]] = Some((b, axis, [p.x, p.y, p.z, 1.0]));
                }
            }
        }
        let mut free_size = 0;
        let free = carried
            .iter()
            .map(|carried| {
                if carried.is_some() {
                    return NONE;
                }
                free_size += 1;
                free_size - 1
            })
            .collect();
        for (b, body) in bodies.iter_mut().enumerate() {
            body.first = free_size + UNKNOWNS * b;
        }
        let mut problem = Self {
            inner,
            bodies,
            length_m,
            free,
            carried,
            free_size,
            pattern: SymmetricPattern::empty(),
            scatter: Vec::new(),
            inner_x: vec![0.0; size],
            inner_gradient: vec![0.0; size],
            inner_values: Vec::new(),
            x: Vec::new(),
        };
        problem.build_pattern(&inner_pattern);
        problem
    }

    /// The problem inside.
    pub(super) fn inner(&self) -> &P {
        &self.inner
    }

    fn size(&self) -> usize {
        self.free_size + UNKNOWNS * self.bodies.len()
    }

    /// Unknowns and weights that make up the inner unknown `i`.
    fn combination(&self, i: usize) -> ([(usize, f64); 4], usize) {
        match self.carried[i] {
            None => ([(self.free[i], 1.0); 4], 1),
            Some((b, axis, weights)) => {
                let first = self.bodies[b].first;
                (
                    std::array::from_fn(|k| {
                        (first + if k < 3 { 3 * axis + k } else { 9 + axis }, weights[k])
                    }),
                    4,
                )
            }
        }
    }

    /// Builds the outer pattern, and the contributions of inner values to it. Free unknowns keep
    /// their order; those of bodies come last.
    fn build_pattern(&mut self, inner: &SymmetricPattern) {
        let size = self.size();
        let mut lists: Vec<Vec<usize>> = vec![Vec::new(); size];
        let each = |visit: &mut dyn FnMut(usize, usize, usize, f64)| {
            for column in 0..inner.size() {
                let (own, own_count) = self.combination(column);
                for slot in inner.columns[column]..inner.columns[column + 1] {
                    let row = inner.rows[slot];
                    let (other, other_count) = self.combination(row);
                    for (m, &(u, a)) in own[..own_count].iter().enumerate() {
                        for (n, &(w, b)) in other[..other_count].iter().enumerate() {
                            if row != column {
                                visit(slot, u, w, if u == w { 2.0 * a * b } else { a * b });
                            } else if n <= m {
                                visit(slot, u, w, a * b);
                            }
                        }
                    }
                }
            }
        };
        let mut last = vec![NONE; size];
        each(&mut |_, u, w, _| {
            let (low, high) = (u.min(w), u.max(w));
            // Most repeats come one after the other.
            if last[low] != high {
                lists[low].push(high);
                last[low] = high;
            }
        });
        for body in &self.bodies {
            for u in 0..UNKNOWNS {
                lists[body.first + u].extend((u..UNKNOWNS).map(|w| body.first + w));
            }
        }
        let pattern = SymmetricPattern::from_columns(lists);
        let mut scatter = Vec::with_capacity(inner.entry_count());
        each(&mut |slot, u, w, factor| {
            scatter.push((slot as u32, pattern.slot(u, w) as u32, factor))
        });
        (self.pattern, self.scatter) = (pattern, scatter);
        self.inner_values.resize(inner.entry_count(), 0.0);
    }

    /// Sets the inner unknowns to x = S·`y`.
    fn set_state(&mut self, y: &[f64]) {
        let mut x = std::mem::take(&mut self.inner_x);
        self.expand(y, &mut x);
        self.inner_x = x;
        self.x.clear();
        self.x.extend_from_slice(y);
    }

    fn expand(&self, y: &[f64], x: &mut [f64]) {
        for (i, x) in x.iter_mut().enumerate() {
            let (parts, count) = self.combination(i);
            *x = parts[..count].iter().map(|&(u, weight)| weight * y[u]).sum();
        }
    }

    fn rigidity(&self, y: &[f64]) -> f64 {
        self.bodies.iter().map(|body| body.energy(y, self.length_m)).sum()
    }

    /// y of the inner unknowns `x` of `pose` (`[V]`, m), bands as the nearest rigid motion.
    pub(super) fn pack(&self, x: &[f64], start: &[Vec3], pose: &[Vec3]) -> Vec<f64> {
        let mut y = vec![0.0; self.size()];
        for (i, &u) in self.free.iter().enumerate().filter(|(_, u)| **u != NONE) {
            y[u] = x[i];
        }
        for body in &self.bodies {
            y[body.first..body.first + UNKNOWNS].copy_from_slice(&body.fit(
                start,
                pose,
                self.length_m,
            ));
        }
        y
    }

    /// x of `y`.
    pub(super) fn unpack(&self, y: &[f64]) -> Vec<f64> {
        let mut x = vec![0.0; self.free.len()];
        self.expand(y, &mut x);
        x
    }

    /// Puts the bands of `pose` (`[V]`, m) where the nearest rigid motion has them.
    pub(super) fn straighten(&self, start: &[Vec3], pose: &mut [Vec3]) {
        for body in &self.bodies {
            let fit = body.fit(start, pose, self.length_m);
            let turn = Mat3::identity()
                + Mat3::from_fn(|i, j| fit[3 * i + j]) * (self.length_m / body.size_m);
            let shift = Vec3::new(fit[9], fit[10], fit[11]) * self.length_m;
            for &v in &body.vertices {
                pose[v] = body.centre + shift + turn * (start[v] - body.centre);
            }
        }
    }
}

impl<P: Problem> Problem for RigidBands<P> {
    fn pattern(&self) -> SymmetricPattern {
        self.pattern.clone()
    }

    fn lower_bounds(&self) -> Vec<f64> {
        vec![f64::NEG_INFINITY; self.size()]
    }

    fn index_blocks(&self) -> Option<IndexBlocks> {
        let inner = self.inner.index_blocks()?;
        // Vertices are free or carried as wholes; bodies come last.
        let body = |group: &Vec<usize>| self.carried[group[0]].map(|(b, ..)| b);
        let free = inner.members.iter().filter(|group| body(group).is_none());
        let mut members: Vec<Vec<usize>> =
            free.map(|group| group.iter().map(|&i| self.free[i]).collect()).collect();
        let (first, mut next) = (members.len(), 0);
        members
            .extend(self.bodies.iter().map(|body| (body.first..body.first + UNKNOWNS).collect()));
        let number: Vec<usize> = inner
            .members
            .iter()
            .map(|group| match body(group) {
                Some(b) => first + b,
                None => {
                    next += 1;
                    next - 1
                }
            })
            .collect();
        let mut lists: Vec<Vec<usize>> = (0..members.len()).map(|group| vec![group]).collect();
        for (column, &u) in number.iter().enumerate() {
            for &row in
                &inner.graph.rows[inner.graph.columns[column]..inner.graph.columns[column + 1]]
            {
                lists[u.min(number[row])].push(u.max(number[row]));
            }
        }
        Some(IndexBlocks { graph: SymmetricPattern::from_columns(lists), members })
    }

    fn energy(&mut self, y: &[f64]) -> f64 {
        self.set_state(y);
        self.inner.energy(&self.inner_x) + self.rigidity(y)
    }

    fn value_and_gradient(&mut self, y: &[f64], gradient: &mut [f64]) -> f64 {
        self.set_state(y);
        let energy = self.inner.value_and_gradient(&self.inner_x, &mut self.inner_gradient);
        gradient.fill(0.0);
        for (i, slope) in self.inner_gradient.iter().enumerate() {
            let (parts, count) = self.combination(i);
            parts[..count].iter().for_each(|&(u, weight)| gradient[u] += weight * slope);
        }
        for body in &self.bodies {
            let slope = body.gradient(y, self.length_m) * (self.length_m / body.size_m);
            (0..9).for_each(|u| gradient[body.first + u] += slope[(u / 3, u % 3)]);
        }
        energy + self.rigidity(y)
    }

    fn max_step_size(&mut self, _: &[f64], direction: &[f64]) -> f64 {
        let mut moved = vec![0.0; self.free.len()];
        self.expand(direction, &mut moved);
        self.inner.max_step_size(&self.inner_x, &moved)
    }

    fn new_sparsity(&mut self) -> Option<SymmetricPattern> {
        let inner = self.inner.new_sparsity()?;
        self.build_pattern(&inner);
        Some(self.pattern.clone())
    }

    fn hessian(&mut self, projection: PsdProjection, values: &mut [f64]) {
        self.inner.hessian(projection, &mut self.inner_values);
        values.fill(0.0);
        for &(from, to, factor) in &self.scatter {
            values[to as usize] += factor * self.inner_values[from as usize];
        }
        for body in &self.bodies {
            let scale = (self.length_m / body.size_m).powi(2);
            let hessian = project_to_psd(&body.hessian(&self.x, self.length_m), projection) * scale;
            for m in 0..9 {
                for n in 0..=m {
                    values[self.pattern.slot(body.first + m, body.first + n)] += hessian[(m, n)];
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::growth::expansion::GrowthTensor;
    use crate::linalg::derivative_check::check_problem;
    use crate::linalg::newton::{Options, minimise};
    use crate::mesh::Mat2;
    use crate::progress::Silent;
    use crate::random::Random;

    /// Springs without rest length between all vertices, and one to a place for each, of unlike
    /// strength.
    struct Springs {
        places: Vec<Vec3>,
        here: Vec<f64>,
    }

    impl Problem for Springs {
        fn pattern(&self) -> SymmetricPattern {
            let all: Vec<usize> = (0..self.here.len()).collect();
            SymmetricPattern::from_elements(all.len(), [&all[..]].into_iter())
        }
        fn lower_bounds(&self) -> Vec<f64> {
            vec![f64::NEG_INFINITY; self.here.len()]
        }
        fn index_blocks(&self) -> Option<IndexBlocks> {
            let vertices: Vec<usize> = (0..self.here.len() / 3).collect();
            let graph =
                SymmetricPattern::from_elements(vertices.len(), [&vertices[..]].into_iter());
            Some(IndexBlocks {
                graph,
                members: vertices.iter().map(|v| vec![3 * v, 3 * v + 1, 3 * v + 2]).collect(),
            })
        }
        fn energy(&mut self, x: &[f64]) -> f64 {
            self.value_and_gradient(x, &mut vec![0.0; x.len()])
        }
        fn value_and_gradient(&mut self, x: &[f64], gradient: &mut [f64]) -> f64 {
            let mut energy = 0.0;
            gradient.fill(0.0);
            for i in 0..x.len() {
                let strength = 1.0 + (i / 3) as f64;
                let off = x[i] - self.places[i / 3][i % 3];
                energy += 0.5 * strength * off * off + 0.25 * off.powi(4);
                gradient[i] += strength * off + off.powi(3);
                for j in (i % 3..i).step_by(3) {
                    energy += 0.1 * (x[i] - x[j]).powi(2);
                    gradient[i] += 0.2 * (x[i] - x[j]);
                    gradient[j] -= 0.2 * (x[i] - x[j]);
                }
            }
            self.here.copy_from_slice(x);
            energy
        }
        fn hessian(&mut self, _: PsdProjection, values: &mut [f64]) {
            let pattern = self.pattern();
            values.fill(0.0);
            let n = self.here.len();
            for i in 0..n {
                let off = self.here[i] - self.places[i / 3][i % 3];
                values[pattern.slot(i, i)] += 1.0 + (i / 3) as f64 + 3.0 * off * off;
                for j in (i % 3..i).step_by(3) {
                    values[pattern.slot(i, i)] += 0.2;
                    values[pattern.slot(j, j)] += 0.2;
                    values[pattern.slot(i, j)] -= 0.2;
                }
            }
        }
    }

    fn some(n: usize) -> (RigidBands<Springs>, Vec<Vec3>) {
        let mut random = Random(2);
        let mut place = || Vec3::new(random.unit(), random.unit(), random.unit());
        let (start, places): (Vec<Vec3>, Vec<Vec3>) = (0..n).map(|_| (place(), place())).unzip();
        let unknown: Vec<[usize; 3]> = (0..n).map(|v| [3 * v, 3 * v + 1, 3 * v + 2]).collect();
        let bands = [vec![1, 4, 5, 7], vec![0, 3, 8]];
        (
            RigidBands::new(
                Springs { places, here: vec![0.0; 3 * n] },
                affine_bodies(&bands, &start, &vec![1e-4; n], 1.5),
                &unknown,
                &start,
                1.5,
            ),
            start,
        )
    }

    #[test]
    fn groups_hold_every_unknown_and_are_coupled_where_theirs_are() {
        let (banded, _) = some(10);
        let IndexBlocks { graph, members } = banded.index_blocks().unwrap();
        assert_eq!(members.iter().map(Vec::len).collect::<Vec<_>>(), [3, 3, 3, UNKNOWNS, UNKNOWNS]);
        let mut of = vec![NONE; banded.size()];
        members
            .iter()
            .enumerate()
            .for_each(|(group, members)| members.iter().for_each(|&i| of[i] = group));
        for column in 0..banded.size() {
            for &row in &banded.pattern.rows
                [banded.pattern.columns[column]..banded.pattern.columns[column + 1]]
            {
                assert!(graph.find(of[row], of[column]).is_some(), "{row} {column}");
            }
        }
    }

    #[test]
    fn derivatives_agree_with_differences() {
        let (mut banded, _) = some(10);
        let mut random = Random(5);
        let y: Vec<f64> = (0..banded.size()).map(|_| random.unit() - 0.5).collect();
        assert_eq!(y.len(), 3 * 3 + 2 * UNKNOWNS);
        check_problem(&mut banded, &y, 0.1);
    }

    #[test]
    fn bands_keep_their_shape() {
        let (mut banded, start) = some(10);
        let begin = banded.pack(&vec![0.0; 30], &start, &start);
        assert!(begin.iter().all(|y| y.abs() < 1e-14));
        let options = Options {
            iteration_limit: 200,
            tolerance: 1e-9,
            ridge: 0.0,
            stay_in_basin: true,
            ..Options::new("test", 1.0)
        };
        let outcome = minimise(&mut banded, &begin, &options, &Silent).unwrap();
        let x = banded.unpack(&outcome.x);
        let mut pose: Vec<Vec3> = start
            .iter()
            .enumerate()
            .map(|(v, p)| p + Vec3::new(x[3 * v], x[3 * v + 1], x[3 * v + 2]) * 1.5)
            .collect();
        let bands = [[1, 4, 5, 7].to_vec(), [0, 3, 8].to_vec()];
        let stretch = |pose: &[Vec3]| -> f64 {
            let pairs = bands
                .iter()
                .flat_map(|band| band.iter().flat_map(move |&u| band.iter().map(move |&v| (u, v))));
            pairs
                .map(|(u, v)| ((pose[u] - pose[v]).norm() - (start[u] - start[v]).norm()).abs())
                .fold(0.0, f64::max)
        };
        let (soft, moved) = (stretch(&pose), (pose[4] - start[4]).norm());
        assert!(soft < 0.2 && moved > 0.05, "{soft:e} {moved}");
        let before = pose.clone();
        banded.straighten(&start, &mut pose);
        assert!(stretch(&pose) < 1e-13);
        let by = pose.iter().zip(&before).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
        assert!(by < 2.0 * soft, "{by:e}");
    }

    #[test]
    fn the_nearest_rotation_of_anything_is_one() {
        let turn = nalgebra::Rotation3::new(Vec3::new(0.3, -0.5, 0.9)).into_inner();
        let flat = Mat3::from_diagonal(&Vec3::new(2.0, 1.0, 0.0));
        assert!((nearest_rotation(&(turn * flat)) - turn).norm() < 1e-13);
        let mirrored = nearest_rotation(&Mat3::from_diagonal(&Vec3::new(3.0, 2.0, -1e-3)));
        assert!((mirrored - Mat3::identity()).norm() < 1e-13);
        let line = nearest_rotation(&Mat3::from_diagonal(&Vec3::new(1.0, 0.0, 0.0)));
        assert!(
            (line * line.transpose() - Mat3::identity()).norm() < 1e-13 && line.determinant() > 0.0
        );
    }

    #[test]
    fn bands_that_cannot_be_are_named() {
        let growth = GrowthTensor { along: Vec3::x(), across: Vec3::y(), form: Mat2::identity() };
        let free = vec![GrowthAt::new(growth, 1.0); 4];
        assert!(check_bands(&[vec![0, 1], vec![2]], &free).is_ok());
        let mut frozen = free.clone();
        frozen[1].frozen[2] = true;
        for (bands, frozen, word) in [
            (vec![vec![]], &free, "no vertex"),
            (vec![vec![0, 9]], &free, "vertex 9"),
            (vec![vec![0], vec![1, 0]], &free, "band 0 too"),
            (vec![vec![1]], &frozen, "frozen"),
        ] {
            let error = check_bands(&bands, frozen).unwrap_err().to_string();
            assert!(error.contains(word), "{error}");
        }
    }
}
