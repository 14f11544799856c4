//! Algebra of symmetric 4x4 covariances and 2x2 position information.

pub type Mat = [[f64; 4]; 4];
/// A symmetric 2x2 matrix: xx, xy, yy.
pub type Sym = [f64; 3];

pub const ZERO: Mat = [[0.0; 4]; 4];
/// Where the entries on and above the diagonal are.
const UPPER: [(usize, usize); 10] =
    [(0, 0), (0, 1), (0, 2), (0, 3), (1, 1), (1, 2), (1, 3), (2, 2), (2, 3), (3, 3)];

/// The matrix with these entries.
pub fn filled(entry: impl Fn(usize, usize) -> f64) -> Mat {
    let mut out = ZERO;
    for (i, row) in out.iter_mut().enumerate() {
        for (j, value) in row.iter_mut().enumerate() {
            *value = entry(i, j);
        }
    }
    out
}

/// The symmetric matrix with these entries on and above the diagonal.
pub fn mirrored(entry: impl Fn(usize, usize) -> f64) -> Mat {
    let mut out = ZERO;
    for (i, j) in UPPER {
        out[i][j] = entry(i, j);
        out[j][i] = out[i][j];
    }
    out
}

/// `a s a'` for a symmetric `s`.
pub fn congruent(a: &Mat, s: &Mat) -> Mat {
    let left = filled(|i, j| (0..4).map(|m| a[i][m] * s[m][j]).sum());
    mirrored(|i, j| (0..4).map(|m| left[i][m] * a[j][m]).sum())
}

pub fn transposed(a: &Mat) -> Mat {
    filled(|i, j| a[j][i])
}

/// Cholesky factor of a positive definite matrix; NaN where it is not.
fn factor(p: &Mat) -> Mat {
    let mut l = ZERO;
    for i in 0..4 {
        for j in 0..=i {
            let rest = p[i][j] - (0..j).map(|m| l[i][m] * l[j][m]).sum::<f64>();
            l[i][j] = if i == j { rest.sqrt() } else { rest / l[j][j] };
        }
    }
    l
}

pub fn log_det(p: &Mat) -> f64 {
    let l = factor(p);
    2.0 * (0..4).map(|i| l[i][i].ln()).sum::<f64>()
}

/// Inverse of a positive definite matrix.
pub fn inverse(p: &Mat) -> Mat {
    let l = factor(p);
    let mut inv = ZERO; // of the factor
    for j in 0..4 {
        inv[j][j] = 1.0 / l[j][j];
        for i in j + 1..4 {
            inv[i][j] = -(j..i).map(|m| l[i][m] * inv[m][j]).sum::<f64>() / l[i][i];
        }
    }
    mirrored(|i, j| (j..4).map(|m| inv[m][i] * inv[m][j]).sum())
}
