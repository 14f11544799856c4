//! Shortest 8-connected paths between traversable cells, without cutting corners.

use numpy::{
    IntoPyArray, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2,
    PyUntypedArrayMethods,
};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::visibility::checked_cell;

mod near;
mod path;
mod search;

pub use near::{lengths_to, shortest_path};
pub use path::{path_to, shortcut};
use search::{allowed_moves, connections, Search, STRAIGHT, UNREACHED};

/// Path lengths [m] from the source to every cell, infinity where unreachable.
pub fn distance_field(open: &[u8], cols: usize, source: usize, resolution: f64) -> Vec<f32> {
    let moves = allowed_moves(open, cols);
    let mut search = Search::new(&moves, cols);
    let last = search.run(&connections(open, cols, source), UNREACHED - 1, 0);
    metres(&search.cost, source, last, resolution)
}

/// Costs up to `last` as lengths [m], others as infinity.
fn metres(cost: &[u32], source: usize, last: u32, resolution: f64) -> Vec<f32> {
    let metres = resolution / f64::from(STRAIGHT);
    let length = |&cost: &u32| {
        if cost <= last {
            (f64::from(cost) * metres) as f32
        } else {
            f32::INFINITY
        }
    };
    let mut field: Vec<f32> = cost.iter().map(length).collect();
    field[source] = 0.0;
    field
}

/// Path lengths [m] between every two of `cells`, row by row; infinity beyond `limit_m` or where unreachable.
pub fn distance_matrix(open: &[u8], cols: usize, cells: &[usize], resolution: f64, limit_m: f64) -> Vec<f32> {
    let moves = allowed_moves(open, cols);
    let mut search = Search::new(&moves, cols);
    let metres = resolution / f64::from(STRAIGHT);
    let limit = (limit_m / metres + 1e-6).clamp(0.0, f64::from(UNREACHED - 1)) as u32;
    let doors: Vec<Vec<(usize, u32)>> = cells.iter().map(|&cell| connections(open, cols, cell)).collect();
    let size = cells.len();
    let mut matrix = vec![f32::INFINITY; size * size];
    for i in 0..size {
        let left = search.want(doors[i + 1..].iter().flatten().map(|&(cell, _)| cell));
        let last = if left == 0 { 0 } else { search.run(&doors[i], limit, left) };
        matrix[i * size + i] = 0.0;
        for j in i + 1..size {
            let settled = doors[j].iter().filter(|&&(cell, _)| search.cost[cell] <= last);
            let cost = settled.map(|&(cell, extra)| search.cost[cell] + extra).min();
            let length = match cost {
                _ if cells[i] == cells[j] => 0.0,
                Some(cost) if cost <= limit => (f64::from(cost) * metres) as f32,
                _ => f32::INFINITY,
            };
            matrix[i * size + j] = length;
            matrix[j * size + i] = length;
        }
    }
    matrix
}

fn checked_cells(cells: &PyReadonlyArray1<'_, i64>, size: usize) -> PyResult<Vec<usize>> {
    cells.as_slice()?.iter().map(|&cell| checked_cell(cell, size)).collect()
}

fn check_resolution(resolution: f64) -> PyResult<()> {
    match resolution > 0.0 && resolution.is_finite() {
        true => Ok(()),
        false => Err(PyValueError::new_err(format!("resolution must be > 0 m; got {resolution}"))),
    }
}

#[pyfunction(name = "distance_field")]
fn py_distance_field<'py>(
    py: Python<'py>,
    traversable: PyReadonlyArray2<'py, u8>,
    source: i64,
    resolution: f64,
) -> PyResult<Bound<'py, PyArray2<f32>>> {
    let [rows, cols] = [traversable.shape()[0], traversable.shape()[1]];
    check_resolution(resolution)?;
    let source = checked_cell(source, rows * cols)?;
    let open = traversable.as_slice()?;
    let field = py.detach(|| distance_field(open, cols, source, resolution));
    field.into_pyarray(py).reshape([rows, cols])
}

#[pyfunction(name = "lengths_to")]
fn py_lengths_to<'py>(
    py: Python<'py>,
    traversable: PyReadonlyArray2<'py, u8>,
    source: i64,
    targets: PyReadonlyArray1<'py, i64>,
    resolution: f64,
) -> PyResult<Bound<'py, PyArray1<f32>>> {
    let [rows, cols] = [traversable.shape()[0], traversable.shape()[1]];
    check_resolution(resolution)?;
    let source = checked_cell(source, rows * cols)?;
    let targets = checked_cells(&targets, rows * cols)?;
    let open = traversable.as_slice()?;
    Ok(py.detach(|| lengths_to(open, cols, source, &targets, resolution)).into_pyarray(py))
}

#[pyfunction(name = "shortest_path")]
fn py_shortest_path<'py>(
    py: Python<'py>,
    traversable: PyReadonlyArray2<'py, u8>,
    source: i64,
    target: i64,
    resolution: f64,
) -> PyResult<Bound<'py, PyArray1<i64>>> {
    let [rows, cols] = [traversable.shape()[0], traversable.shape()[1]];
    check_resolution(resolution)?;
    let (source, target) = (checked_cell(source, rows * cols)?, checked_cell(target, rows * cols)?);
    let open = traversable.as_slice()?;
    Ok(py.detach(|| shortest_path(open, cols, source, target, resolution)).into_pyarray(py))
}

#[pyfunction(name = "distance_matrix")]
fn py_distance_matrix<'py>(
    py: Python<'py>,
    traversable: PyReadonlyArray2<'py, u8>,
    cells: PyReadonlyArray1<'py, i64>,
    resolution: f64,
    limit_m: f64,
) -> PyResult<Bound<'py, PyArray2<f32>>> {
    let [rows, cols] = [traversable.shape()[0], traversable.shape()[1]];
    check_resolution(resolution)?;
    if limit_m.is_nan() || limit_m < 0.0 {
        return Err(PyValueError::new_err(format!("limit_m must be >= 0 m; got {limit_m}")));
    }
    let cells = checked_cells(&cells, rows * cols)?;
    let open = traversable.as_slice()?;
    let matrix = if cells.is_empty() {
        Vec::new()
    } else {
        py.detach(|| distance_matrix(open, cols, &cells, resolution, limit_m))
    };
    matrix.into_pyarray(py).reshape([cells.len(), cells.len()])
}

#[pyfunction(name = "path_to")]
fn py_path_to<'py>(
    py: Python<'py>,
    field: PyReadonlyArray2<'py, f32>,
    traversable: PyReadonlyArray2<'py, u8>,
    target: i64,
) -> PyResult<Bound<'py, PyArray1<i64>>> {
    let [rows, cols] = [traversable.shape()[0], traversable.shape()[1]];
    if field.shape() != traversable.shape() {
        return Err(PyValueError::new_err(format!(
            "field and traversable must have one shape; got {:?} and {:?}",
            field.shape(),
            traversable.shape()
        )));
    }
    let target = checked_cell(target, rows * cols)?;
    Ok(path_to(field.as_slice()?, traversable.as_slice()?, cols, target).into_pyarray(py))
}

#[pyfunction(name = "shortcut")]
fn py_shortcut<'py>(
    py: Python<'py>,
    traversable: PyReadonlyArray2<'py, u8>,
    path: PyReadonlyArray1<'py, i64>,
) -> PyResult<Bound<'py, PyArray1<i64>>> {
    let [rows, cols] = [traversable.shape()[0], traversable.shape()[1]];
    let path = checked_cells(&path, rows * cols)?;
    Ok(shortcut(traversable.as_slice()?, cols, &path).into_pyarray(py))
}

pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(py_distance_field, m)?)?;
    m.add_function(wrap_pyfunction!(py_lengths_to, m)?)?;
    m.add_function(wrap_pyfunction!(py_shortest_path, m)?)?;
    m.add_function(wrap_pyfunction!(py_distance_matrix, m)?)?;
    m.add_function(wrap_pyfunction!(py_path_to, m)?)?;
    m.add_function(wrap_pyfunction!(py_shortcut, m)?)?;
    Ok(())
}
