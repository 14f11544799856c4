//! Time-layered coverage: footprints of viewpoints, sparse impacts and the best reply by tours.
//!
//! A sparse impact is two parallel slices: `keys`, strictly increasing, `cell * LAYERS + layer`, and
//! `misses`, the log-miss added from that layer on, in steps of 1/16 nat, saturating at 255 (certain).

pub mod berth;
pub mod footprint;
pub mod impact;
pub mod tours;
pub mod viewpoints;
pub mod worth;

use numpy::{IntoPyArray, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use berth::berths;
use footprint::{footprints, Sensor};
use impact::{combine, marginal, miss_table};
use tours::{best_tour, most_any_tour_adds, number_cells, EndPrice, Stops, TourProblem};
use viewpoints::{viewpoints, Ground};
use worth::Worth;

use crate::visibility::checked_cell;

pub const LAYERS: usize = 32;
const STEPS_PER_NAT: f64 = 16.0;
const UNKNOWN: u8 = 0;
const FREE: u8 = 1;
const OCCUPIED: u8 = 2;

type Sparse = (Vec<u32>, Vec<u8>);
type PySparse<'py> = (Bound<'py, PyArray1<u32>>, Bound<'py, PyArray1<u8>>);

type PyViews<'py> =
    (Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<i64>>, f64, bool);

#[pyfunction(name = "viewpoints")]
fn py_viewpoints<'py>(
    py: Python<'py>,
    field: PyReadonlyArray2<'py, f32>,
    source: i64,
    resolution: f64,
    classes: PyReadonlyArray2<'py, u8>,
    cells: PyReadonlyArray1<'py, i64>,
    starts: PyReadonlyArray1<'py, i64>,
    reach: i64,
    most: usize,
    work: u64,
) -> PyResult<PyViews<'py>> {
    let (field, classes_flat) = (field.as_slice()?, classes.as_slice()?);
    let ground = Ground { field, source: checked_cell(source, field.len())?, resolution };
    let cols = classes.as_array().ncols();
    let (cells, starts) = (cells.as_slice()?, starts.as_slice()?);
    let found = py.detach(|| viewpoints(&ground, classes_flat, cols, cells, starts, reach, most, work));
    Ok((
        found.clusters.into_pyarray(py),
        found.targets.into_pyarray(py),
        found.views.into_pyarray(py),
        found.horizon,
        found.cut_short,
    ))
}

#[pyfunction(name = "berths")]
fn py_berths<'py>(
    py: Python<'py>,
    classes: PyReadonlyArray2<'py, u8>,
    step: usize,
    most: u8,
) -> PyResult<Bound<'py, PyArray2<u8>>> {
    let [rows, cols] = [classes.as_array().nrows(), classes.as_array().ncols()];
    let classes = classes.as_slice()?;
    py.detach(|| berths(classes, rows, cols, step.max(1), most)).into_pyarray(py).reshape([rows, cols])
}

type PyFootprints<'py> = (Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<u32>>, Bound<'py, PyArray1<f32>>);

#[pyfunction(name = "footprints")]
fn py_footprints<'py>(
    py: Python<'py>,
    classes: PyReadonlyArray2<'py, u8>,
    berths: PyReadonlyArray2<'py, u8>,
    views: PyReadonlyArray1<'py, i64>,
    facing: PyReadonlyArray1<'py, f64>,
    range_cells: f64,
    view: f64,
    table: PyReadonlyArray2<'py, f32>,
    by_distance: bool,
    rays: usize,
    factor: usize,
    floor: f32,
) -> PyResult<PyFootprints<'py>> {
    let [rows, cols] = [classes.as_array().nrows(), classes.as_array().ncols()];
    let depths = table.as_array().ncols();
    let sensor = Sensor { range_cells, view, table: table.as_slice()?, depths, by_distance, rays, floor };
    let (classes, berths) = (classes.as_slice()?, berths.as_slice()?);
    let (views, facing) = (views.as_slice()?, facing.as_slice()?);
    let (starts, cells, shares) =
        py.detach(|| footprints(classes, berths, rows, cols, views, facing, &sensor, factor));
    Ok((starts.into_pyarray(py), cells.into_pyarray(py), shares.into_pyarray(py)))
}

#[pyfunction(name = "combine")]
fn py_combine<'py>(
    py: Python<'py>,
    keys_a: PyReadonlyArray1<'py, u32>,
    misses_a: PyReadonlyArray1<'py, u8>,
    keys_b: PyReadonlyArray1<'py, u32>,
    misses_b: PyReadonlyArray1<'py, u8>,
    layers: u32,
) -> PyResult<PySparse<'py>> {
    let (a, b) = ((keys_a.as_slice()?, misses_a.as_slice()?), (keys_b.as_slice()?, misses_b.as_slice()?));
    let (keys, misses) = py.detach(|| combine(a, b, layers.max(1)));
    Ok((keys.into_pyarray(py), misses.into_pyarray(py)))
}

type PyWorth<'py> = (PyReadonlyArray2<'py, f32>, (usize, usize), (usize, usize), [f32; 4]);

fn worth_of<'a>((weights, first, shape, beyond): &'a PyWorth<'_>) -> PyResult<Worth<'a>> {
    let (rows, cols) = weights.as_array().dim();
    if shape.1 == 0 {
        return Err(PyValueError::new_err("a grid has columns"));
    }
    Ok(Worth {
        window: weights.as_slice()?,
        window_shape: (rows, cols),
        first: *first,
        shape: *shape,
        beyond: *beyond,
    })
}

#[pyfunction(name = "marginals")]
fn py_marginals<'py>(
    py: Python<'py>,
    worth: PyWorth<'py>,
    layer_weights: PyReadonlyArray1<'py, f64>,
    others_keys: PyReadonlyArray1<'py, u32>,
    others_misses: PyReadonlyArray1<'py, u8>,
    starts: PyReadonlyArray1<'py, i64>,
    keys: PyReadonlyArray1<'py, u32>,
    misses: PyReadonlyArray1<'py, u8>,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let others = (others_keys.as_slice()?, others_misses.as_slice()?);
    let (keys, misses) = (keys.as_slice()?, misses.as_slice()?);
    let (worth, layer_weights, miss) = (worth_of(&worth)?, layer_weights.as_slice()?, miss_table());
    let starts = starts.as_slice()?;
    let gain = |bounds: &[i64]| {
        let own = bounds[0] as usize..bounds[1] as usize;
        marginal(&worth, layer_weights, others, (&keys[own.clone()], &misses[own]), &miss)
    };
    let gains: Vec<f64> = py.detach(|| starts.windows(2).map(gain).collect());
    Ok(gains.into_pyarray(py))
}

type PyNumbers<'py> = (Bound<'py, PyArray1<u32>>, Bound<'py, PyArray1<u32>>);

#[pyfunction(name = "number_cells")]
fn py_number_cells<'py>(py: Python<'py>, cells: PyReadonlyArray1<'py, u32>) -> PyResult<PyNumbers<'py>> {
    let (distinct, local) = number_cells(cells.as_slice()?);
    Ok((distinct.into_pyarray(py), local.into_pyarray(py)))
}

/// Footprints (starts, cells, local, misses), first leg, legs, edges.
type PyStops<'py> = (
    PyReadonlyArray1<'py, i64>,
    (PyReadonlyArray1<'py, u32>, PyReadonlyArray1<'py, u32>),
    PyReadonlyArray1<'py, u8>,
    PyReadonlyArray1<'py, f32>,
    PyReadonlyArray2<'py, f32>,
    PyReadonlyArray1<'py, f64>,
);
/// Worth, layer weights, the others' keys and misses, stops, linear and quadratic end price.
type PyTourProblem<'py> = (
    PyWorth<'py>,
    PyReadonlyArray1<'py, f64>,
    (PyReadonlyArray1<'py, u32>, PyReadonlyArray1<'py, u8>),
    PyStops<'py>,
    (f64, f64),
);

fn stops_of<'a>(
    (starts, (cells, local), misses, first_leg, legs, edges): &'a PyStops<'_>,
) -> PyResult<Stops<'a>> {
    Ok(Stops {
        starts: starts.as_slice()?,
        cells: cells.as_slice()?,
        local: local.as_slice()?,
        misses: misses.as_slice()?,
        first_leg: first_leg.as_slice()?,
        legs: legs.as_slice()?,
        edges: edges.as_slice()?,
    })
}

fn problem_of<'a>(
    (worth, layer_weights, (keys, misses), stops, (linear, quadratic)): &'a PyTourProblem<'_>,
) -> PyResult<TourProblem<'a>> {
    Ok(TourProblem {
        stops: stops_of(stops)?,
        worth: worth_of(worth)?,
        layer_weights: layer_weights.as_slice()?,
        others: (keys.as_slice()?, misses.as_slice()?),
        price: EndPrice { linear: *linear, quadratic: *quadratic },
    })
}

type PyReply<'py> = (Bound<'py, PyArray1<i64>>, f64, f64);

#[pyfunction(name = "best_tour")]
fn py_best_tour<'py>(
    py: Python<'py>,
    problem: PyTourProblem<'py>,
    current: PyReadonlyArray1<'py, i64>,
    max_stops: usize,
    turning: (f64, f64),
) -> PyResult<PyReply<'py>> {
    let (problem, current) = (problem_of(&problem)?, current.as_slice()?);
    let reply = py.detach(|| best_tour(problem, current, max_stops, turning));
    Ok((reply.tour.into_pyarray(py), reply.gain, reply.current_gain))
}

#[pyfunction(name = "most_any_tour_adds")]
fn py_most_any_tour_adds(py: Python<'_>, problem: PyTourProblem<'_>, max_stops: usize) -> PyResult<f64> {
    let problem = problem_of(&problem)?;
    Ok(py.detach(|| most_any_tour_adds(problem, max_stops)))
}

pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add("LAYERS", LAYERS)?;
    m.add_function(wrap_pyfunction!(py_viewpoints, m)?)?;
    m.add_function(wrap_pyfunction!(py_berths, m)?)?;
    m.add_function(wrap_pyfunction!(py_footprints, m)?)?;
    m.add_function(wrap_pyfunction!(py_combine, m)?)?;
    m.add_function(wrap_pyfunction!(py_marginals, m)?)?;
    m.add_function(wrap_pyfunction!(py_number_cells, m)?)?;
    m.add_function(wrap_pyfunction!(py_best_tour, m)?)?;
    m.add_function(wrap_pyfunction!(py_most_any_tour_adds, m)?)?;
    Ok(())
}
