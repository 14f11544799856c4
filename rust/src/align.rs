//! Where a grid of walls and free ground may lie on another: one correlation over all shifts for every angle.
//!
//! The worth of laying B onto A is a bilinear form of four masks, `a WW - b (WF + FW) + c FF` with the overlaps of
//! walls and free cells; all shifts of it come from one product of spectra. The base angles lie within a quarter
//! turn: B is laid anew for each, and A's spectra turned by 0 to 3 quarters serve the other three.

use numpy::ndarray::{Array3, ArrayView2};
use numpy::{IntoPyArray, PyArray2, PyArray3, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use rustfft::num_complex::Complex32;

pub mod fit;
mod fourier;

use fourier::Plane;

/// What a wall on a wall, a wall on free ground, and free ground on free ground count.
#[derive(Clone, Copy)]
pub struct Weights {
    pub walls: f32,
    pub clash: f32,
    pub free: f32,
}

/// The highest worths over all shifts of B, apart from each other by a spacing.
#[derive(Clone, Copy)]
pub struct Wanted {
    pub peaks: usize,
    pub spacing: usize,
}

/// A worth, and the row and column of A where B's middle lies.
pub type Peak = (f32, usize, usize);

/// The spectra of A, turned by a number of quarters, that B's walls and B's free ground are multiplied by.
struct Partner {
    walls: Vec<Complex32>,
    free: Vec<Complex32>,
}

/// Peaks for B turned by each angle and by a quarter, a half and three quarters more: 4 lists an angle.
pub fn peaks(
    size: usize,
    a: (&[f32], &[f32]),
    b: (ArrayView2<f64>, ArrayView2<f64>),
    angles: &[f64],
    weights: Weights,
    wanted: Wanted,
) -> Vec<Vec<Peak>> {
    let mut plane = Plane::new(size);
    let partners: Vec<Partner> = (0..4).map(|turn| partner(&mut plane, a, turn, weights)).collect();
    let mut found = Vec::with_capacity(4 * angles.len());
    for &angle in angles {
        let laid = laid(size, b, angle);
        let (walls, free) = plane.both_spectra(laid);
        for (pair, first) in partners.chunks_exact(2).zip([0, 2]) {
            let of = |partner: &Partner, k: usize| partner.walls[k] * walls[k] + partner.free[k] * free[k];
            let both = (0..size * size).map(|k| of(&pair[0], k) + Complex32::i() * of(&pair[1], k)).collect();
            let worths = plane.back(both);
            let scale = 1.0 / (size * size) as f32;
            let parts: [Vec<f32>; 2] = [
                worths.iter().map(|worth| worth.re * scale).collect(),
                worths.iter().map(|worth| worth.im * scale).collect(),
            ];
            for (turn, part) in parts.iter().enumerate() {
                let of_turned = highest(size, part, wanted);
                found.push(
                    of_turned
                        .into_iter()
                        .map(|(worth, row, col)| {
                            let (row, col) = turned(size, row, col, first + turn);
                            (worth, row, col)
                        })
                        .collect(),
                );
            }
        }
    }
    found
}

/// A cell of the torus after so many quarter turns about cell (0, 0), counter-clockwise with rows upwards.
fn turned(size: usize, row: usize, col: usize, quarters: usize) -> (usize, usize) {
    let minus = |k: usize| (size - k) % size;
    match quarters {
        0 => (row, col),
        1 => (col, minus(row)),
        2 => (minus(row), minus(col)),
        _ => (minus(col), row),
    }
}

fn partner(plane: &mut Plane, a: (&[f32], &[f32]), quarters: usize, weights: Weights) -> Partner {
    let size = plane.size;
    let mut both = Vec::with_capacity(size * size);
    for row in 0..size {
        for col in 0..size {
            let (r, c) = turned(size, row, col, quarters);
            both.push(Complex32::new(a.0[r * size + c], a.1[r * size + c]));
        }
    }
    let (walls, free) = plane.both_spectra(both);
    let blend = |x: f32, y: f32| walls.iter().zip(&free).map(|(w, f)| w * x + f * y).collect();
    Partner { walls: blend(weights.walls, -weights.clash), free: blend(-weights.clash, weights.free) }
}

/// B's walls and free ground, real and imaginary part, turned about its middle and reflected in cell (0, 0).
fn laid(size: usize, b: (ArrayView2<f64>, ArrayView2<f64>), angle: f64) -> Vec<Complex32> {
    let (sin, cos) = angle.sin_cos();
    let at = |x: f64, y: f64| {
        let wrapped = |v: f64| (-(v + 0.5).floor() as i64).rem_euclid(size as i64) as usize;
        wrapped(sin * x + cos * y) * size + wrapped(cos * x - sin * y)
    };
    let mut cells = vec![Complex32::new(0.0, 0.0); size * size];
    for point in b.1.rows() {
        cells[at(point[0], point[1])].im = 1.0;
    }
    for point in b.0.rows() {
        cells[at(point[0], point[1])] = Complex32::new(1.0, 0.0);
    }
    cells
}

/// The highest cells that are more than a spacing apart in rows or columns; of equal ones the first.
fn highest(size: usize, worths: &[f32], wanted: Wanted) -> Vec<Peak> {
    let block = wanted.spacing.max(1);
    let mut tops: Vec<Peak> = Vec::new();
    for top in (0..size).step_by(block) {
        let mut best = vec![(f32::NEG_INFINITY, 0, 0); size.div_ceil(block)];
        for row in top..(top + block).min(size) {
            let line = &worths[row * size..(row + 1) * size];
            for (peak, (number, part)) in best.iter_mut().zip(line.chunks(block).enumerate()) {
                for (k, &worth) in part.iter().enumerate() {
                    if worth > peak.0 {
                        *peak = (worth, row, number * block + k);
                    }
                }
            }
        }
        tops.extend(best);
    }
    tops.sort_by(|p, q| q.0.total_cmp(&p.0).then(p.1.cmp(&q.1)).then(p.2.cmp(&q.2)));
    let apart = |p: usize, q: usize| {
        let gap = p.abs_diff(q);
        gap.min(size - gap) > wanted.spacing
    };
    let mut kept: Vec<Peak> = Vec::with_capacity(wanted.peaks);
    for (worth, row, col) in tops {
        if kept.len() == wanted.peaks {
            break;
        }
        if kept.iter().all(|&(_, r, c)| apart(r, row) || apart(c, col)) {
            kept.push((worth, row, col));
        }
    }
    kept
}

/// What a point means that falls near a face which looks elsewhere, and near one that looks as it does.
const ELSE: u8 = 3;
const SAME: u8 = 1;
/// Directions are in 1/256 of a turn; so far two that look alike may differ.
const ALIKE: u8 = 43;

/// Walls of one map: where they are [cells], and which way they look.
pub struct Faces<'a> {
    pub points: ArrayView2<'a, f64>,
    pub looks: &'a [u8],
}

/// How many faces fall on each of four labels of a grid under each transform; outside counts as label 0.
///
/// A transform is x, y [cells] and an angle: it turns a face about the origin and then moves it. Label 1 counts
/// only for faces that look as the grid's nearest face does, and is 3 for others.
pub fn counts(
    grid: (ArrayView2<u8>, ArrayView2<u8>),
    faces: &Faces,
    transforms: ArrayView2<f64>,
) -> Vec<[i64; 4]> {
    let (labels, looks) = grid;
    let (rows, cols) = labels.dim();
    let of = |transform: numpy::ndarray::ArrayView1<f64>| {
        let (sin, cos) = transform[2].sin_cos();
        let turn = (transform[2] * 128.0 / std::f64::consts::PI).round() as i64 as u8;
        let mut count = [0; 4];
        for (point, &look) in faces.points.rows().into_iter().zip(faces.looks) {
            let col = (cos * point[0] - sin * point[1] + transform[0]).floor();
            let row = (sin * point[0] + cos * point[1] + transform[1]).floor();
            let inside = row >= 0.0 && col >= 0.0 && row < rows as f64 && col < cols as f64;
            let label = if inside {
                let cell = (row as usize, col as usize);
                let aside = looks[cell].wrapping_sub(look.wrapping_add(turn));
                let alike = aside.min(aside.wrapping_neg()) <= ALIKE;
                if labels[cell] == SAME && !alike {
                    ELSE
                } else {
                    labels[cell] & 3
                }
            } else {
                0
            };
            count[usize::from(label)] += 1;
        }
        count
    };
    transforms.rows().into_iter().map(of).collect()
}

type Points<'py> = PyReadonlyArray2<'py, f64>;
type Mask<'py> = PyReadonlyArray2<'py, f32>;

#[pyfunction]
fn align_peaks<'py>(
    py: Python<'py>,
    a: (Mask<'py>, Mask<'py>),
    b: (Points<'py>, Points<'py>),
    angles: PyReadonlyArray1<'py, f64>,
    weights: (f32, f32, f32),
    wanted: (usize, usize),
) -> PyResult<Bound<'py, PyArray3<f64>>> {
    let size = a.0.as_array().nrows();
    if a.0.as_array().dim() != (size, size) || a.1.as_array().dim() != (size, size) || size == 0 {
        return Err(PyValueError::new_err("both masks of A must be squares of one size"));
    }
    if b.0.as_array().ncols() != 2 || b.1.as_array().ncols() != 2 {
        return Err(PyValueError::new_err("points must be (n, 2)"));
    }
    let masks = (a.0.as_slice()?, a.1.as_slice()?);
    let weights = Weights { walls: weights.0, clash: weights.1, free: weights.2 };
    let wanted = Wanted { peaks: wanted.0, spacing: wanted.1 };
    let (walls, free, angles) = (b.0.as_array(), b.1.as_array(), angles.as_slice()?);
    let found = py.detach(|| peaks(size, masks, (walls, free), angles, weights, wanted));
    let mut table = Array3::from_elem((found.len(), wanted.peaks, 3), f64::NEG_INFINITY);
    for (number, list) in found.iter().enumerate() {
        for (place, &(worth, row, col)) in list.iter().enumerate() {
            for (k, value) in [f64::from(worth), row as f64, col as f64].into_iter().enumerate() {
                table[(number, place, k)] = value;
            }
        }
    }
    Ok(table.into_pyarray(py))
}

#[pyfunction]
fn align_counts<'py>(
    py: Python<'py>,
    grid: (PyReadonlyArray2<'py, u8>, PyReadonlyArray2<'py, u8>),
    faces: (Points<'py>, PyReadonlyArray1<'py, u8>),
    transforms: Points<'py>,
) -> PyResult<Bound<'py, PyArray2<i64>>> {
    let (labels, looks) = (grid.0.as_array(), grid.1.as_array());
    let faces = Faces { points: faces.0.as_array(), looks: faces.1.as_slice()? };
    let transforms = transforms.as_array();
    if labels.dim() != looks.dim() {
        return Err(PyValueError::new_err("labels and looks must have one shape"));
    }
    if faces.points.dim() != (faces.looks.len(), 2) || transforms.ncols() != 3 {
        return Err(PyValueError::new_err("faces must be (n, 2) with n looks, and transforms (t, 3)"));
    }
    let found = py.detach(|| counts((labels, looks), &faces, transforms));
    let flat = found.iter().flatten().copied().collect::<Vec<i64>>();
    let shaped = numpy::ndarray::Array2::from_shape_vec((found.len(), 4), flat);
    Ok(shaped.map_err(|error| PyValueError::new_err(error.to_string()))?.into_pyarray(py))
}

pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(align_peaks, m)?)?;
    m.add_function(wrap_pyfunction!(align_counts, m)?)?;
    m.add_function(wrap_pyfunction!(fit::align_fit, m)?)
}
