//! Gaussian Markov random fields on a grid: banded Cholesky factors, parts of the inverse, what ways gain.
//!
//! A symmetric matrix of half bandwidth `b` is kept as its lower rows: entry (i, j) with i - b <= j <= i is
//! number j - i + b of row i; what would lie left of the first column is 0.

use numpy::{IntoPyArray, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Sparse rows: row r has the columns `columns[starts[r]..starts[r + 1]]`, with `weights`.
#[derive(Clone, Copy)]
pub struct Rows<'a> {
    pub starts: &'a [i64],
    pub columns: &'a [i64],
    pub weights: &'a [f64],
}

impl Rows<'_> {
    fn count(&self) -> usize {
        self.starts.len().saturating_sub(1)
    }

    fn row(&self, r: usize) -> impl Iterator<Item = (usize, f64)> + Clone + '_ {
        let (from, to) = (self.starts[r] as usize, self.starts[r + 1] as usize);
        let columns = self.columns[from..to].iter().map(|&c| c as usize);
        columns.zip(self.weights[from..to].iter().copied())
    }

    fn fits(&self, n: usize) -> bool {
        let whole = self.starts.first() == Some(&0)
            && self.starts.windows(2).all(|w| w[0] <= w[1])
            && self.starts.last().is_some_and(|&end| end as usize == self.columns.len());
        whole
            && self.weights.len() == self.columns.len()
            && self.columns.iter().all(|&c| c >= 0 && (c as usize) < n)
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 8];
    let (left, right) = (a.chunks_exact(8), b.chunks_exact(8));
    let tail: f64 = left.remainder().iter().zip(right.remainder()).map(|(x, y)| x * y).sum();
    for (x, y) in left.zip(right) {
        for k in 0..8 {
            sums[k] += x[k] * y[k];
        }
    }
    sums.iter().sum::<f64>() + tail
}

/// Add `W' diag(information) W` to a band; false: an entry lies outside it.
pub fn add_information(band: &mut [f64], width: usize, rows: Rows<'_>, information: &[f64]) -> bool {
    for (r, &y) in information.iter().enumerate() {
        for (i, a) in rows.row(r) {
            for (j, b) in rows.row(r).filter(|&(j, _)| j <= i) {
                if i - j > width {
                    return false;
                }
                band[i * (width + 1) + width - (i - j)] += y * a * b;
            }
        }
    }
    true
}

/// `A = L L'` in place; returns `ln det A`, None where A is not positive definite.
pub fn factorise(band: &mut [f64], width: usize) -> Option<f64> {
    let (size, mut log_det) = (width + 1, 0.0);
    for i in 0..band.len() / size {
        let (above, here) = band.split_at_mut(i * size);
        let here = &mut here[..size];
        for j in i.saturating_sub(width)..i {
            let lead = width - (i - j); // of column j in row i
            let other = &above[j * size..(j + 1) * size];
            let sum = dot(&here[..lead], &other[i - j..width]);
            here[lead] = (here[lead] - sum) / other[width];
        }
        let pivot = here[width] - dot(&here[..width], &here[..width]);
        if pivot.is_nan() || pivot <= 0.0 {
            return None;
        }
        here[width] = pivot.sqrt();
        log_det += pivot.ln();
    }
    Some(log_det)
}

/// `H A^-1 H'`, (m, m), of sparse rows H: `V' V` with `L V = H'`.
pub fn covariance(factor: &[f64], width: usize, rows: Rows<'_>) -> Vec<f64> {
    let (size, m) = (width + 1, rows.count());
    let n = factor.len() / size;
    let mut half = vec![0.0; n * m];
    let mut first = n;
    for r in 0..m {
        for (i, weight) in rows.row(r) {
            half[i * m + r] += weight;
            first = first.min(i);
        }
    }
    let mut out = vec![0.0; m * m];
    for i in first..n {
        let (above, here) = half.split_at_mut(i * m);
        let here = &mut here[..m];
        let line = &factor[i * size..(i + 1) * size];
        for j in first.max(i.saturating_sub(width))..i {
            let by = line[width - (i - j)];
            for (value, other) in here.iter_mut().zip(&above[j * m..(j + 1) * m]) {
                *value -= by * other;
            }
        }
        here.iter_mut().for_each(|value| *value /= line[width]);
        for (r, &a) in here.iter().enumerate().filter(|&(_, &a)| a != 0.0) {
            for (value, b) in out[r * m..(r + 1) * m].iter_mut().zip(here.iter()) {
                *value += a * b;
            }
        }
    }
    out
}

/// The diagonal of `A^-1`, by Takahashi's recurrence within the band, from the last row up.
pub fn variances(factor: &[f64], width: usize) -> Vec<f64> {
    let (size, span) = (width + 1, 2 * width + 1);
    let n = factor.len() / size;
    let mut inverse = vec![0.0; n * span]; // entry (i, j) is number j - i + width of row i
    let mut row = vec![0.0; size];
    for i in (0..n).rev() {
        let (last, pivot) = ((i + width).min(n - 1), factor[i * size + width]);
        row.iter_mut().for_each(|value| *value = 0.0); // of entries (i, i + 1 + k)
        for k in i + 1..=last {
            let by = factor[k * size + width - (k - i)] / pivot;
            let from = i + 1 + width - k;
            let other = &inverse[k * span + from..k * span + from + last - i];
            for (value, z) in row.iter_mut().zip(other) {
                *value -= by * z;
            }
        }
        let mut own = 1.0 / (pivot * pivot);
        for k in i + 1..=last {
            let value = row[k - i - 1];
            own -= factor[k * size + width - (k - i)] / pivot * value;
            inverse[i * span + width + k - i] = value;
            inverse[k * span + width - (k - i)] = value;
        }
        inverse[i * span + width] = own;
    }
    (0..n).map(|i| inverse[i * span + width]).collect()
}

/// `1/2 ln det(I + R C R)` for every way: its places among C's (m, m), and the diagonal of R there.
pub fn gains(covariance: &[f64], m: usize, ways: Rows<'_>) -> Vec<f64> {
    let mut inner = Vec::new();
    (0..ways.count())
        .map(|way| {
            let places: Vec<_> = ways.row(way).collect();
            let k = places.len();
            if k == 0 {
                return 0.0;
            }
            inner.clear();
            inner.resize(k * k, 0.0);
            for (row, &(i, a)) in places.iter().enumerate() {
                for (column, &(j, b)) in places[..=row].iter().enumerate() {
                    inner[row * k + k - 1 - (row - column)] = a * b * covariance[i * m + j];
                }
                inner[row * k + k - 1] += 1.0;
            }
            factorise(&mut inner, k - 1).map_or(f64::NAN, |log_det| 0.5 * log_det)
        })
        .collect()
}

fn slices<'a>(
    starts: &'a PyReadonlyArray1<'_, i64>,
    columns: &'a PyReadonlyArray1<'_, i64>,
    weights: &'a PyReadonlyArray1<'_, f64>,
    n: usize,
) -> PyResult<Rows<'a>> {
    let rows =
        Rows { starts: starts.as_slice()?, columns: columns.as_slice()?, weights: weights.as_slice()? };
    if rows.fits(n) {
        Ok(rows)
    } else {
        Err(PyValueError::new_err("rows do not fit the matrix"))
    }
}

#[pyfunction]
fn field_factor<'py>(
    py: Python<'py>,
    band: PyReadonlyArray2<'py, f64>,
    starts: PyReadonlyArray1<'py, i64>,
    columns: PyReadonlyArray1<'py, i64>,
    weights: PyReadonlyArray1<'py, f64>,
    information: PyReadonlyArray1<'py, f64>,
) -> PyResult<(Bound<'py, PyArray2<f64>>, f64)> {
    let (shape, information) = (band.as_array().dim(), information.as_slice()?);
    let rows = slices(&starts, &columns, &weights, shape.0)?;
    if shape.1 == 0 || rows.count() != information.len() {
        return Err(PyValueError::new_err("a row each, and a band"));
    }
    let (mut factor, width) = (band.as_slice()?.to_vec(), shape.1 - 1);
    if !py.detach(|| add_information(&mut factor, width, rows, information)) {
        return Err(PyValueError::new_err("a row reaches beyond the band"));
    }
    let log_det = py
        .detach(|| factorise(&mut factor, width))
        .ok_or_else(|| PyValueError::new_err("the matrix is not positive definite"))?;
    Ok((factor.into_pyarray(py).reshape([shape.0, shape.1])?, log_det))
}

#[pyfunction]
fn field_covariance<'py>(
    py: Python<'py>,
    factor: PyReadonlyArray2<'py, f64>,
    starts: PyReadonlyArray1<'py, i64>,
    columns: PyReadonlyArray1<'py, i64>,
    weights: PyReadonlyArray1<'py, f64>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let (n, size) = factor.as_array().dim();
    let rows = slices(&starts, &columns, &weights, n)?;
    if size == 0 {
        return Err(PyValueError::new_err("a band has a diagonal"));
    }
    let (m, factor) = (rows.count(), factor.as_slice()?);
    py.detach(|| covariance(factor, size - 1, rows)).into_pyarray(py).reshape([m, m])
}

#[pyfunction]
fn field_variances<'py>(
    py: Python<'py>,
    factor: PyReadonlyArray2<'py, f64>,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let size = factor.as_array().dim().1;
    if size == 0 {
        return Err(PyValueError::new_err("a band has a diagonal"));
    }
    let factor = factor.as_slice()?;
    Ok(py.detach(|| variances(factor, size - 1)).into_pyarray(py))
}

#[pyfunction]
fn field_gains<'py>(
    py: Python<'py>,
    covariance: PyReadonlyArray2<'py, f64>,
    starts: PyReadonlyArray1<'py, i64>,
    places: PyReadonlyArray1<'py, i64>,
    roots: PyReadonlyArray1<'py, f64>,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let (m, columns) = covariance.as_array().dim();
    let ways = slices(&starts, &places, &roots, m)?;
    if columns != m {
        return Err(PyValueError::new_err("a covariance is square"));
    }
    let covariance = covariance.as_slice()?;
    Ok(py.detach(|| gains(covariance, m, ways)).into_pyarray(py))
}

pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(field_factor, m)?)?;
    m.add_function(wrap_pyfunction!(field_covariance, m)?)?;
    m.add_function(wrap_pyfunction!(field_gains, m)?)?;
    m.add_function(wrap_pyfunction!(field_variances, m)?)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tridiagonal_matrix_has_the_known_determinant_and_inverse() {
        // 2 on the diagonal, -1 beside it, n = 3: determinant 4, inverse's first entry 3/4
        let mut band = vec![0.0, 2.0, -1.0, 2.0, -1.0, 2.0];
        let log_det = factorise(&mut band, 1).unwrap();
        assert!((log_det - 4.0f64.ln()).abs() < 1e-12);
        let rows = Rows { starts: &[0, 1, 2], columns: &[0, 2], weights: &[1.0, 1.0] };
        let found = covariance(&band, 1, rows);
        for (value, wanted) in found.iter().zip([0.75, 0.25, 0.25, 0.75]) {
            assert!((value - wanted).abs() < 1e-12);
        }
        for (value, wanted) in variances(&band, 1).iter().zip([0.75, 1.0, 0.75]) {
            assert!((value - wanted).abs() < 1e-12);
        }
    }

    #[test]
    fn a_matrix_that_is_not_positive_definite_has_no_factor() {
        assert!(factorise(&mut [0.0, 1.0, 2.0, 1.0], 1).is_none());
    }
}
