//! Tiles of one grid as they lie in another frame: each cell takes what the source has under its middle.

use numpy::{IntoPyArray, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

const SIDE: i64 = 32;
const CELLS: usize = (SIDE * SIDE) as usize;
const UNIT_BITS: u32 = 24;

/// A grid of tiles: cells a side, its lower left corner and its cell [um].
#[derive(Clone, Copy)]
pub struct Ground {
    pub rows: i64,
    pub cols: i64,
    pub corner: (i64, i64),
    pub cell: i64,
}

/// Where the source's frame lies in the target's: [um], and cosine and sine [2^-24].
#[derive(Clone, Copy)]
pub struct Motion {
    pub shift: (i64, i64),
    pub cosine: (i64, i64),
}

/// The cells of the wanted tiles; `ids` ascend, and each has its 1024 cells in `blocks`.
pub fn render(ids: &[i64], blocks: &[u8], wanted: &[i64], ground: Ground, motion: Motion) -> Vec<u8> {
    let across = (ground.cols + SIDE - 1) / SIDE;
    let mut out = vec![0; wanted.len() * CELLS];
    let mut held = (-1, None); // the source tile that was looked up last
    for (tile, cells) in wanted.iter().zip(out.chunks_exact_mut(CELLS)) {
        let (top, left) = (tile / across * SIDE, tile % across * SIDE);
        for (at, cell) in cells.iter_mut().enumerate() {
            let (row, col) = (top + at as i64 / SIDE, left + at as i64 % SIDE);
            if row >= ground.rows || col >= ground.cols {
                continue;
            }
            let Some((row, col)) = under(row, col, ground, motion) else { continue };
            let id = row / SIDE * across + col / SIDE;
            if held.0 != id {
                held = (id, ids.binary_search(&id).ok());
            }
            if let Some(number) = held.1 {
                *cell = blocks[number * CELLS + (row % SIDE * SIDE + col % SIDE) as usize];
            }
        }
    }
    out
}

/// Row and column of the source under the middle of a cell of the target; `None` beside the grid.
///
/// Lengths are halves of a micrometre, since the middle of a cell lies between two.
fn under(row: i64, col: i64, ground: Ground, motion: Motion) -> Option<(i64, i64)> {
    let (left, low) = (2 * ground.corner.0, 2 * ground.corner.1);
    let x = left + (2 * col + 1) * ground.cell - 2 * motion.shift.0;
    let y = low + (2 * row + 1) * ground.cell - 2 * motion.shift.1;
    let (cos, sin) = motion.cosine;
    let u = (cos * x + sin * y) >> UNIT_BITS;
    let v = (cos * y - sin * x) >> UNIT_BITS;
    let (row, col) = ((v - low).div_euclid(2 * ground.cell), (u - left).div_euclid(2 * ground.cell));
    (0 <= row && row < ground.rows && 0 <= col && col < ground.cols).then_some((row, col))
}

#[pyfunction(name = "render_tiles")]
fn py_render<'py>(
    py: Python<'py>,
    source: (PyReadonlyArray1<'py, i64>, PyReadonlyArray2<'py, u8>),
    wanted: PyReadonlyArray1<'py, i64>,
    ground: (i64, i64, i64, i64, i64),
    motion: (i64, i64, i64, i64),
) -> PyResult<Bound<'py, PyArray2<u8>>> {
    let (ids, blocks) = (source.0.as_slice()?, source.1.as_slice()?);
    if blocks.len() != ids.len() * CELLS {
        return Err(PyValueError::new_err("every tile has 1024 cells"));
    }
    let (rows, cols, left, low, cell) = ground;
    let ground = Ground { rows, cols, corner: (left, low), cell };
    let motion = Motion { shift: (motion.0, motion.1), cosine: (motion.2, motion.3) };
    let wanted = wanted.as_slice()?;
    py.detach(|| render(ids, blocks, wanted, ground, motion)).into_pyarray(py).reshape([wanted.len(), CELLS])
}

pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(py_render, m)?)?;
    Ok(())
}
