//! Lines of sight between cell centres, exact in integers: a segment is clear if it touches no blocked square.

use numpy::{
    IntoPyArray, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2,
    PyUntypedArrayMethods,
};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::planes::Planes;
use crate::shadow::{Corners, Shadows};

/// Tell whether all cells are clear that the segment between two cell centres touches, its end cells excepted.
///
/// A segment through a corner touches both cells beside it.
#[inline]
pub fn segment_clear(cols: usize, from: usize, to: usize, clear: impl Fn(usize) -> bool) -> bool {
    let (from_row, from_col) = ((from / cols) as i64, (from % cols) as i64);
    let (to_row, to_col) = ((to / cols) as i64, (to % cols) as i64);
    let (height, width) = ((to_row - from_row).abs(), (to_col - from_col).abs());
    let row_step = (to_row - from_row).signum() * cols as i64;
    let col_step = (to_col - from_col).signum();
    let mut cell = from as i64;
    // Crossing number i of columns lies at (2i + 1) / (2 width) of the segment; compare cross-multiplied.
    let (mut next_col, mut next_row) = (height, width);
    while cell != to as i64 {
        if next_col < next_row {
            cell += col_step;
            next_col += 2 * height;
        } else if next_row < next_col {
            cell += row_step;
            next_row += 2 * width;
        } else {
            if !clear((cell + col_step) as usize) || !clear((cell + row_step) as usize) {
                return false;
            }
            cell += col_step + row_step;
            next_col += 2 * height;
            next_row += 2 * width;
        }
        if cell != to as i64 && !clear(cell as usize) {
            return false;
        }
    }
    true
}

/// Mark the cells within `levels` 4-connected free steps of a pose; a segment of that many steps sees no further.
fn near_poses(solid: &[u8], poses: &[u8], cols: usize, levels: usize) -> Vec<u8> {
    let mut near: Vec<u8> = solid.iter().zip(poses).map(|(&s, &p)| u8::from(s == 0 && p != 0)).collect();
    let mut wave: Vec<usize> = (0..near.len()).filter(|&cell| near[cell] != 0).collect();
    for _ in 0..levels {
        let mut next = Vec::new();
        for &cell in &wave {
            let col = cell % cols;
            let mut reach = |other: usize| {
                if solid[other] == 0 && near[other] == 0 {
                    near[other] = 1;
                    next.push(other);
                }
            };
            if col > 0 {
                reach(cell - 1);
            }
            if col + 1 < cols {
                reach(cell + 1);
            }
            if cell >= cols {
                reach(cell - cols);
            }
            if cell + cols < solid.len() {
                reach(cell + cols);
            }
        }
        if next.is_empty() {
            break;
        }
        wave = next;
    }
    near
}

/// Mark the cells, not solid, that some pose cell sees within the range.
///
/// A cell is mostly seen by a pose that sees a cell beside it; else it looks for one ring by ring.
pub fn visible_cells(solid: &[u8], poses: &[u8], rows: usize, cols: usize, range_cells: f64) -> Vec<u8> {
    let range = range_cells.min((rows + cols) as f64); // no segment in the grid is longer
    let range_squared = (range * range) as i64;
    let mut seen = near_poses(solid, poses, cols, (range * std::f64::consts::SQRT_2).ceil() as usize);
    let walls = Planes::of(solid, rows, cols, |s| s != 0);
    let in_free: Vec<bool> = solid.iter().zip(poses).map(|(&s, &p)| s == 0 && p != 0).collect();
    let goals = Planes::of(&in_free, rows, cols, |pose| pose);
    let mut shadows = Shadows::new(&walls, &goals, range as i64, Corners::Both);
    let sees = |pose: usize, cell: usize| {
        let down = (pose / cols).abs_diff(cell / cols) as i64;
        let across = (pose % cols).abs_diff(cell % cols) as i64;
        down * down + across * across <= range_squared && segment_clear(cols, cell, pose, |c| solid[c] == 0)
    };
    let mut seen_from = vec![usize::MAX; seen.len()]; // a pose that sees the cell
    for cell in (0..seen.len()).filter(|&cell| in_free[cell]) {
        seen_from[cell] = cell;
    }
    for cell in 0..seen.len() {
        if seen[cell] != 0 && !in_free[cell] {
            let beside = [1, cols, cols + 1, cols - 1].into_iter().filter_map(|back| cell.checked_sub(back));
            let mut known = beside.map(|other| seen_from[other]).filter(|&pose| pose < usize::MAX);
            let pose = known.find(|&pose| sees(pose, cell));
            let pose = pose.or_else(|| first_pose(&mut shadows, cell, cols, range_squared));
            seen[cell] = u8::from(pose.is_some());
            seen_from[cell] = pose.unwrap_or(usize::MAX);
        }
    }
    seen
}

/// A pose that a cell sees, among the nearest.
fn first_pose(shadows: &mut Shadows, cell: usize, cols: usize, range_squared: i64) -> Option<usize> {
    shadows.begin(cell / cols, cell % cols);
    let mut found = None;
    for ring in 1..=range_squared.isqrt() {
        let widest = (range_squared - ring * ring).isqrt();
        let any_open = shadows.advance(ring, widest, |_, pose| found = Some(pose));
        if found.is_some() || !any_open {
            break;
        }
    }
    found
}

/// A flat cell index, checked against the grid's size.
pub fn checked_cell(cell: i64, size: usize) -> PyResult<usize> {
    usize::try_from(cell)
        .ok()
        .filter(|&cell| cell < size)
        .ok_or_else(|| PyValueError::new_err(format!("cell {cell} is outside a grid of {size} cells")))
}

#[pyfunction(name = "visible_cells")]
fn py_visible_cells<'py>(
    py: Python<'py>,
    solid: PyReadonlyArray2<'py, u8>,
    poses: PyReadonlyArray2<'py, u8>,
    range_cells: f64,
) -> PyResult<Bound<'py, PyArray2<u8>>> {
    let [rows, cols] = [solid.shape()[0], solid.shape()[1]];
    if solid.shape() != poses.shape() || range_cells.is_nan() || range_cells < 0.0 {
        return Err(PyValueError::new_err(format!(
            "solid and poses must have one shape and range_cells be >= 0; got {:?}, {:?} and {range_cells}",
            solid.shape(),
            poses.shape()
        )));
    }
    let (solid, poses) = (solid.as_slice()?, poses.as_slice()?);
    let seen = py.detach(|| visible_cells(solid, poses, rows, cols, range_cells));
    seen.into_pyarray(py).reshape([rows, cols])
}

#[pyfunction(name = "line_of_sight")]
fn py_line_of_sight<'py>(
    py: Python<'py>,
    blocked: PyReadonlyArray2<'py, u8>,
    from_cell: i64,
    to_cells: PyReadonlyArray1<'py, i64>,
) -> PyResult<Bound<'py, PyArray1<bool>>> {
    let cols = blocked.shape()[1];
    let blocked = blocked.as_slice()?;
    let from = checked_cell(from_cell, blocked.len())?;
    let sight = |&to: &i64| -> PyResult<bool> {
        let to = checked_cell(to, blocked.len())?;
        Ok(segment_clear(cols, from, to, |cell| blocked[cell] == 0))
    };
    let sights: Vec<bool> = to_cells.as_slice()?.iter().map(sight).collect::<PyResult<_>>()?;
    Ok(sights.into_pyarray(py))
}

pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(py_visible_cells, m)?)?;
    m.add_function(wrap_pyfunction!(py_line_of_sight, m)?)?;
    Ok(())
}
