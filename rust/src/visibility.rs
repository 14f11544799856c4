//! Lines of sight between cell centres, exact in integers: a segment is clear if it touches no blocked square.

use numpy::{
    IntoPyArray, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2,
    PyUntypedArrayMethods,
};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

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

/// Solid and pose cells of a grid, and how far a pose sees.
struct Scene<'a> {
    solid: &'a [u8],
    poses: &'a [u8],
    rows: i64,
    cols: i64,
    range_squared: f64,
}

/// One octant seen from a cell: `(outward, sideways)` steps of `(row, col)`.
type Octant = [(i64, i64); 2];

const OCTANTS: [Octant; 8] = [
    [(1, 0), (0, 1)],
    [(1, 0), (0, -1)],
    [(-1, 0), (0, 1)],
    [(-1, 0), (0, -1)],
    [(0, 1), (1, 0)],
    [(0, 1), (-1, 0)],
    [(0, -1), (1, 0)],
    [(0, -1), (-1, 0)],
];

impl Scene<'_> {
    /// Flat index of the cell `out` steps outward and `side` steps sideways, or `None` if it blocks the view.
    #[inline]
    fn clear_cell(&self, row: i64, col: i64, octant: &Octant, out: i64, side: i64) -> Option<usize> {
        let row = row + out * octant[0].0 + side * octant[1].0;
        let col = col + out * octant[0].1 + side * octant[1].1;
        if row < 0 || row >= self.rows || col < 0 || col >= self.cols {
            return None;
        }
        let cell = (row * self.cols + col) as usize;
        (self.solid[cell] == 0).then_some(cell)
    }

    /// Scan one line of an octant through its open slopes: tell whether it shows a pose, else keep what stays open.
    ///
    /// The square at `(out, side)` stops exactly the slopes from `(side - 1/2) / (out + 1/2)` to
    /// `(side + 1/2) / (out - 1/2)`, ends included. Quotients of small integers compare exactly in f64.
    fn line_shows_pose(
        &self,
        (row, col): (i64, i64),
        octant: &Octant,
        out: i64,
        open: &[(f64, f64)],
        still_open: &mut Vec<(f64, f64)>,
    ) -> bool {
        let distance = out as f64;
        for &(mut low, high) in open {
            let first = (low * (distance - 0.5) - 0.5).floor().max(0.0) as i64;
            let last = ((high * (distance + 0.5) + 0.5).ceil() as i64).min(out + 1);
            for side in first..=last {
                if let Some(cell) = self.clear_cell(row, col, octant, out, side) {
                    let slope = side as f64 / distance;
                    let in_view = side <= out && low < slope && slope < high;
                    if in_view
                        && self.poses[cell] != 0
                        && ((out * out + side * side) as f64) <= self.range_squared
                    {
                        return true;
                    }
                } else {
                    let stops_from = (side as f64 - 0.5) / (distance + 0.5);
                    if stops_from > low {
                        still_open.push((low, stops_from.min(high)));
                    }
                    low = low.max((side as f64 + 0.5) / (distance - 0.5));
                    if low >= high {
                        break;
                    }
                }
            }
            if low < high {
                still_open.push((low, high));
            }
        }
        false
    }

    /// Tell whether some pose sees the cell, by casting shadows ring by ring so that a near pose ends the search.
    fn sees_pose(&self, cell: usize, open: &mut [Vec<(f64, f64)>; 8], spare: &mut Vec<(f64, f64)>) -> bool {
        let at = (cell as i64 / self.cols, cell as i64 % self.cols);
        for (octant, slopes) in OCTANTS.iter().zip(open.iter_mut()) {
            // The neighbour beside the cell stops the diagonal alone, at the corner they share.
            let beside = self.clear_cell(at.0, at.1, octant, 0, 1);
            slopes.clear();
            slopes.push((-1.0, if beside.is_some() { 2.0 } else { 1.0 }));
        }
        for out in 1..=self.range_squared.sqrt() as i64 {
            let mut any_open = false;
            for (octant, slopes) in OCTANTS.iter().zip(open.iter_mut()) {
                if slopes.is_empty() {
                    continue;
                }
                spare.clear();
                if self.line_shows_pose(at, octant, out, slopes, spare) {
                    return true;
                }
                std::mem::swap(slopes, spare);
                any_open |= !slopes.is_empty();
            }
            if !any_open {
                return false;
            }
        }
        false
    }
}

/// Mark the cells, not solid, that some pose cell sees within the range.
pub fn visible_cells(solid: &[u8], poses: &[u8], rows: usize, cols: usize, range_cells: f64) -> Vec<u8> {
    let range = range_cells.min((rows + cols) as f64); // no segment in the grid is longer
    let scene = Scene { solid, poses, rows: rows as i64, cols: cols as i64, range_squared: range * range };
    let mut seen = near_poses(solid, poses, cols, (range * std::f64::consts::SQRT_2).ceil() as usize);
    let mut open: [Vec<(f64, f64)>; 8] = Default::default();
    let mut spare = Vec::new();
    for cell in 0..seen.len() {
        if seen[cell] != 0 && poses[cell] == 0 {
            seen[cell] = u8::from(scene.sees_pose(cell, &mut open, &mut spare));
        }
    }
    seen
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
    let seen = visible_cells(solid.as_slice()?, poses.as_slice()?, rows, cols, range_cells);
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
