//! Search for a target on a grid: how its density moves, what looks detect, what a path adds to a team.
//!
//! A sparse impact is as in `coverage`: `keys`, strictly increasing, `cell * layers + layer`, and `misses`,
//! log-misses in steps of 1/16 nat; here the last step, 255, is read as what it says, `exp(-255/16)`.

pub mod footprint;
pub mod paths;
pub mod spread;

use numpy::{
    IntoPyArray, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyReadonlyArray3,
};
use pyo3::prelude::*;

use footprint::{footprints, Detector};
use paths::{detected_mass, path_gains, Paths};
use spread::{Grid, Patch, Stencil};

const STEPS_PER_NAT: f64 = 16.0;

/// The miss probability of every log-miss.
fn miss_table() -> [f64; 256] {
    std::array::from_fn(|level| (-(level as f64) / STEPS_PER_NAT).exp())
}

#[pyfunction(name = "propagate")]
fn py_propagate<'py>(
    py: Python<'py>,
    mass: PyReadonlyArray2<'py, f64>,
    first: (i64, i64),
    row_taps: PyReadonlyArray1<'py, f64>,
    col_taps: PyReadonlyArray1<'py, f64>,
    leaves: bool,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let [rows, cols] = [mass.as_array().nrows(), mass.as_array().ncols()];
    let stencil = Stencil { first, row_taps: row_taps.as_slice()?, col_taps: col_taps.as_slice()?, leaves };
    let grid = Grid { rows, cols };
    let moved = stencil.spread(grid, &Patch::whole(grid, mass.as_slice()?), grid.bounds());
    moved.mass.into_pyarray(py).reshape([rows, cols])
}

type PyFootprints<'py> = (Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<u32>>, Bound<'py, PyArray1<f64>>);

#[pyfunction(name = "look_footprints")]
fn py_footprints<'py>(
    py: Python<'py>,
    shape: (usize, usize),
    resolution: f64,
    poses: PyReadonlyArray3<'py, f64>,
    table: PyReadonlyArray1<'py, f64>,
    range: f64,
    view: f64,
    samples: usize,
) -> PyResult<PyFootprints<'py>> {
    let looks = poses.as_array().shape()[1];
    let detector = Detector { table: table.as_slice()?, range, view };
    let grid = Grid { rows: shape.0, cols: shape.1 };
    let (starts, cells, shares) = footprints(grid, resolution, poses.as_slice()?, looks, &detector, samples);
    Ok((starts.into_pyarray(py), cells.into_pyarray(py), shares.into_pyarray(py)))
}

#[pyfunction(name = "detected_mass")]
fn py_detected_mass<'py>(
    py: Python<'py>,
    mass: PyReadonlyArray2<'py, f64>,
    first: (i64, i64),
    row_taps: PyReadonlyArray1<'py, f64>,
    col_taps: PyReadonlyArray1<'py, f64>,
    leaves: bool,
    steps: usize,
    layers: usize,
    keys: PyReadonlyArray1<'py, u32>,
    misses: PyReadonlyArray1<'py, u8>,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let grid = Grid { rows: mass.as_array().nrows(), cols: mass.as_array().ncols() };
    let stencil = Stencil { first, row_taps: row_taps.as_slice()?, col_taps: col_taps.as_slice()?, leaves };
    let impact = (keys.as_slice()?, misses.as_slice()?);
    let mass = mass.as_slice()?;
    Ok(py.detach(|| detected_mass(grid, mass, &stencil, steps, layers, impact)).into_pyarray(py))
}

#[pyfunction(name = "path_gains")]
fn py_path_gains<'py>(
    py: Python<'py>,
    mass: PyReadonlyArray2<'py, f64>,
    first: (i64, i64),
    row_taps: PyReadonlyArray1<'py, f64>,
    col_taps: PyReadonlyArray1<'py, f64>,
    leaves: bool,
    steps: usize,
    weights: PyReadonlyArray1<'py, f64>,
    others_keys: PyReadonlyArray1<'py, u32>,
    others_misses: PyReadonlyArray1<'py, u8>,
    parents: PyReadonlyArray1<'py, i64>,
    starts: PyReadonlyArray1<'py, i64>,
    cells: PyReadonlyArray1<'py, u32>,
    misses: PyReadonlyArray1<'py, u8>,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let grid = Grid { rows: mass.as_array().nrows(), cols: mass.as_array().ncols() };
    let stencil = Stencil { first, row_taps: row_taps.as_slice()?, col_taps: col_taps.as_slice()?, leaves };
    let paths = Paths {
        parents: parents.as_slice()?,
        starts: starts.as_slice()?,
        cells: cells.as_slice()?,
        misses: misses.as_slice()?,
    };
    let others = (others_keys.as_slice()?, others_misses.as_slice()?);
    let (mass, weights) = (mass.as_slice()?, weights.as_slice()?);
    Ok(py.detach(|| path_gains(grid, mass, &stencil, steps, weights, others, &paths)).into_pyarray(py))
}

pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(py_propagate, m)?)?;
    m.add_function(wrap_pyfunction!(py_footprints, m)?)?;
    m.add_function(wrap_pyfunction!(py_detected_mass, m)?)?;
    m.add_function(wrap_pyfunction!(py_path_gains, m)?)?;
    Ok(())
}
