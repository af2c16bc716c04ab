//! Projection of an element's Hessian, a small dense symmetric matrix, to a positive semidefinite
//! one.

use nalgebra::SMatrix;

/// Largest number of Jacobi sweeps; a handful suffice.
const MAX_SWEEPS: usize = 30;
/// Sum of squares below the diagonal, relative to that of all entries, at which the Jacobi sweeps
/// have converged: the square of ten roundings.
const OFF_DIAGONAL: f64 = 1e-30;
/// Least pivot, relative to the diagonal entry, that is clear of rounding.
const MIN_PIVOT: f64 = 1e-12;

/// Projection to positive semidefinite matrices: the treatment of the negative eigenvalues of an
/// element's Hessian.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PsdProjection {
    /// Keeps them: the true Hessian.
    None,
    /// Sets them to zero: the nearest positive semidefinite matrix.
    Clamp,
    /// Replaces them by their absolute value: steps away from saddles.
    Abs,
}

/// The matrix `h` with its negative eigenvalues treated as `projection` says.
pub(crate) fn project_to_psd<const N: usize>(
    h: &SMatrix<f64, N, N>,
    projection: PsdProjection,
) -> SMatrix<f64, N, N> {
    if projection == PsdProjection::None || is_positive_definite(h) {
        return *h;
    }
    let (values, vectors) = eigen(h);
    let mut out = SMatrix::zeros();
    for k in 0..N {
        let value = match projection {
            PsdProjection::Abs => values[k].abs(),
            _ => values[k].max(0.0),
        };
        if value != 0.0 {
            let v = vectors.column(k);
            out += v * v.transpose() * value;
        }
    }
    out
}

/// Eigenvalues and unit eigenvectors (columns) of a symmetric matrix, by cyclic Jacobi rotations:
/// accurate also for tiny eigenvalues, deterministic, no heap.
pub(crate) fn eigen<const N: usize>(h: &SMatrix<f64, N, N>) -> ([f64; N], SMatrix<f64, N, N>) {
    let mut a = *h;
    let mut v = SMatrix::<f64, N, N>::identity();
    for _ in 0..MAX_SWEEPS {
        let mut off = 0.0;
        for p in 0..N {
            for q in 0..p {
                off += a[(p, q)] * a[(p, q)];
            }
        }
        if off <= OFF_DIAGONAL * a.norm_squared() {
            break;
        }
        for p in 0..N {
            for q in p + 1..N {
                if a[(p, q)] == 0.0 {
                    continue;
                }
                let theta = (a[(q, q)] - a[(p, p)]) / (2.0 * a[(p, q)]);
                let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
                let c = 1.0 / (t * t + 1.0).sqrt();
                let s = t * c;
                for k in 0..N {
                    let (x, y) = (a[(k, p)], a[(k, q)]);
                    a[(k, p)] = c * x - s * y;
                    a[(k, q)] = s * x + c * y;
                }
                for k in 0..N {
                    let (x, y) = (a[(p, k)], a[(q, k)]);
                    a[(p, k)] = c * x - s * y;
                    a[(q, k)] = s * x + c * y;
                    let (x, y) = (v[(k, p)], v[(k, q)]);
                    v[(k, p)] = c * x - s * y;
                    v[(k, q)] = s * x + c * y;
                }
            }
        }
    }
    (std::array::from_fn(|k| a[(k, k)]), v)
}

/// True if `h` has a Cholesky factorisation with pivots clear of rounding ([`MIN_PIVOT`]).
fn is_positive_definite<const N: usize>(h: &SMatrix<f64, N, N>) -> bool {
    let mut l = *h;
    for j in 0..N {
        for k in 0..j {
            l[(j, j)] -= l[(j, k)] * l[(j, k)];
        }
        if l[(j, j)].is_nan() || l[(j, j)] <= MIN_PIVOT * h[(j, j)].abs() {
            return false;
        }
        let d = l[(j, j)].sqrt();
        l[(j, j)] = d;
        for i in j + 1..N {
            for k in 0..j {
                l[(i, j)] -= l[(i, k)] * l[(j, k)];
            }
            l[(i, j)] /= d;
        }
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Matrix3;

    #[test]
    fn eigenvectors_rebuild_the_matrix() {
        let h = Matrix3::new(2.0, -1.0, 0.5, -1.0, -3.0, 1e-3, 0.5, 1e-3, 1e-6);
        let (values, vectors) = eigen(&h);
        let rebuilt: Matrix3<f64> =
            vectors * Matrix3::from_diagonal(&values.into()) * vectors.transpose();
        assert!((rebuilt - h).norm() < 1e-14);
        assert!((vectors.transpose() * vectors - Matrix3::identity()).norm() < 1e-14);
    }

    #[test]
    fn negative_eigenvalues_are_projected_as_named() {
        let (c, s) = (0.6, 0.8);
        let rotate = Matrix3::new(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0);
        let with = |d: [f64; 3]| rotate * Matrix3::from_diagonal(&d.into()) * rotate.transpose();
        let h = with([4.0, -2.0, 1.0]);
        assert!((project_to_psd(&h, PsdProjection::Clamp) - with([4.0, 0.0, 1.0])).norm() < 1e-14);
        assert!((project_to_psd(&h, PsdProjection::Abs) - with([4.0, 2.0, 1.0])).norm() < 1e-14);
        assert_eq!(project_to_psd(&h, PsdProjection::None), h);
    }
}
