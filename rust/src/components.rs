//! The connected parts of a grid.

use numpy::{IntoPyArray, PyArray2, PyArrayMethods, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;

const NOWHERE: i64 = -1;

/// 4-connected parts, numbered from 0 by their smallest flat index; -1 elsewhere.
pub fn components(cells: &[bool], cols: usize) -> Vec<i64> {
    let mut labels = vec![NOWHERE; cells.len()];
    let mut open = Vec::new();
    let mut parts = 0;
    for first in 0..cells.len() {
        if !cells[first] || labels[first] != NOWHERE {
            continue;
        }
        labels[first] = parts;
        open.push(first);
        while let Some(at) = open.pop() {
            let col = at % cols;
            let beside = [
                (at >= cols).then(|| at - cols),
                (at + cols < cells.len()).then_some(at + cols),
                (col > 0).then(|| at - 1),
                (col + 1 < cols).then_some(at + 1),
            ];
            for next in beside.into_iter().flatten() {
                if cells[next] && labels[next] == NOWHERE {
                    labels[next] = parts;
                    open.push(next);
                }
            }
        }
        parts += 1;
    }
    labels
}

#[pyfunction(name = "components")]
fn py_components<'py>(
    py: Python<'py>,
    cells: PyReadonlyArray2<'py, bool>,
) -> PyResult<Bound<'py, PyArray2<i64>>> {
    let shape = [cells.shape()[0], cells.shape()[1]];
    let cells = cells.as_slice()?;
    py.detach(|| components(cells, shape[1])).into_pyarray(py).reshape(shape)
}

pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(py_components, m)?)?;
    Ok(())
}
