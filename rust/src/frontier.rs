//! Where a robot may stand, and where the known free space meets the unknown.

use numpy::{IntoPyArray, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

const UNKNOWN: u8 = 0;
const FREE: u8 = 1;
const OCCUPIED: u8 = 2;

/// Marks looked at together when searching for the few that are set.
const STRIDE: usize = 16;

/// Mark, in one row, the centres with a 4-neighbour of class `neighbour`.
///
/// Plain passes over slices and no branch, so that each compiles to vector instructions.
#[inline]
fn mark_row(rows: [&[u8]; 3], is_centre: impl Fn(u8) -> bool, neighbour: u8, marks: &mut [u8]) {
    let [below, row, above] = rows;
    for ((mark, &b), &a) in marks.iter_mut().zip(below).zip(above) {
        *mark = u8::from(b == neighbour) | u8::from(a == neighbour);
    }
    for (mark, &left) in marks.iter_mut().skip(1).zip(row) {
        *mark |= u8::from(left == neighbour);
    }
    for (mark, &right) in marks.iter_mut().zip(&row[1..]) {
        *mark |= u8::from(right == neighbour);
    }
    for (mark, &centre) in marks.iter_mut().zip(row) {
        *mark &= u8::from(is_centre(centre));
    }
}

/// Call `visit(row, col)` for each centre with a 4-neighbour of class `neighbour`, in flat order.
fn for_each_border_cell(
    classes: &[u8],
    cols: usize,
    is_centre: impl Fn(u8) -> bool,
    neighbour: u8,
    mut visit: impl FnMut(usize, usize),
) {
    let outside = vec![OCCUPIED; cols];
    let mut marks = vec![0; cols];
    let rows = classes.len() / cols;
    let row_at = |r: usize| {
        if r < rows {
            &classes[r * cols..(r + 1) * cols]
        } else {
            &outside[..]
        }
    };
    for r in 0..rows {
        mark_row([row_at(r.wrapping_sub(1)), row_at(r), row_at(r + 1)], &is_centre, neighbour, &mut marks);
        for (k, chunk) in marks.chunks(STRIDE).enumerate() {
            if chunk.iter().fold(0, |any, &mark| any | mark) != 0 {
                let marked = (0..chunk.len()).filter(|&i| chunk[i] != 0);
                marked.for_each(|i| visit(r, STRIDE * k + i));
            }
        }
    }
}

/// Columns that a non-free cell blocks on either side, by rows away: cells nearer than the radius to its square.
fn stamp_widths(radius_cells: f64) -> Vec<usize> {
    let gap = |cells: usize| (cells as f64 - 0.5).max(0.0).powi(2);
    let limit = radius_cells * radius_cells - 1e-9; // 0.35 / 0.1 is not quite 3.5
    let rows = (0..).take_while(|&dr| gap(dr) < limit);
    rows.map(|dr| (0..).take_while(|&dc| gap(dr) + gap(dc) < limit).count() - 1).collect()
}

/// Mark the free cells whose centre is at least the radius away from every square that is not free.
pub fn traversable(classes: &[u8], rows: usize, cols: usize, radius_cells: f64) -> Vec<u8> {
    let mut open: Vec<u8> = classes.iter().map(|&class| u8::from(class == FREE)).collect();
    let widths = stamp_widths(radius_cells);
    let Some(&margin) = widths.first() else {
        return open;
    };
    let mut block = |row: usize, from: usize, to: usize| {
        for (dr, &width) in widths.iter().enumerate() {
            let (first, last) = (from.saturating_sub(width), (to + width).min(cols - 1));
            if row >= dr {
                open[(row - dr) * cols + first..=(row - dr) * cols + last].fill(0);
            }
            if row + dr < rows {
                open[(row + dr) * cols + first..=(row + dr) * cols + last].fill(0);
            }
        }
    };
    // Only a non-free cell beside a free one can be nearest to a free cell; runs of them are stamped at once.
    let mut run: Option<(usize, usize, usize)> = None;
    for_each_border_cell(
        classes,
        cols,
        |class| class != FREE,
        FREE,
        |row, col| {
            run = match run {
                Some((r, from, to)) if r == row && to + 1 == col => Some((r, from, col)),
                Some((r, from, to)) => {
                    block(r, from, to);
                    Some((row, col, col))
                }
                None => Some((row, col, col)),
            };
        },
    );
    if let Some((row, from, to)) = run {
        block(row, from, to);
    }
    block_border(&mut open, rows, cols, margin);
    open
}

/// Clear the cells within `margin` cells of the grid's border.
fn block_border(open: &mut [u8], rows: usize, cols: usize, margin: usize) {
    for (row, cells) in open.chunks_exact_mut(cols).enumerate() {
        if row < margin || row + margin >= rows {
            cells.fill(0);
        } else {
            cells[..margin.min(cols)].fill(0);
            cells[cols.saturating_sub(margin)..].fill(0);
        }
    }
}

/// Disjoint sets over `0..n` whose representative is the smallest member.
struct Sets(Vec<u32>);

impl Sets {
    fn find(&mut self, mut i: u32) -> u32 {
        while self.0[i as usize] != i {
            let up = self.0[self.0[i as usize] as usize];
            self.0[i as usize] = up;
            i = up;
        }
        i
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.find(a as u32), self.find(b as u32));
        self.0[a.max(b) as usize] = a.min(b);
    }
}

/// Group cells, listed as `(row, col)` in flat order, into 8-connected clusters in order of their first cell.
fn cluster(cells: &[(u32, u32)]) -> Vec<Vec<(u32, u32)>> {
    let mut sets = Sets((0..cells.len() as u32).collect());
    let mut below = 0; // the first cell of the row below that may touch the current one
    for (i, &(row, col)) in cells.iter().enumerate() {
        if i > 0 && cells[i - 1] == (row, col.wrapping_sub(1)) {
            sets.join(i - 1, i);
        }
        while (cells[below].0 + 1, cells[below].1 + 1) < (row, col) {
            below += 1;
        }
        let mut k = below;
        while cells[k].0 + 1 == row && cells[k].1 <= col + 1 {
            sets.join(k, i);
            k += 1;
        }
    }
    let mut slots = vec![usize::MAX; cells.len()];
    let mut clusters: Vec<Vec<(u32, u32)>> = Vec::new();
    for (i, &cell) in cells.iter().enumerate() {
        let root = sets.find(i as u32) as usize;
        if root == i {
            slots[i] = clusters.len();
            clusters.push(Vec::new());
        }
        clusters[slots[root]].push(cell);
    }
    clusters
}

/// Bisect a cluster at the median of its longer side until no side of its bounding box exceeds `max_extent`.
fn split(mut cells: Vec<(u32, u32)>, max_extent: u32, parts: &mut Vec<Vec<(u32, u32)>>) {
    let side = |axis: fn(&(u32, u32)) -> u32| {
        let (low, high) = cells.iter().map(axis).fold((u32::MAX, 0), |(l, h), v| (l.min(v), h.max(v)));
        high - low + 1
    };
    let (height, width) = (side(|c| c.0), side(|c| c.1));
    if height.max(width) <= max_extent {
        cells.sort_unstable();
        parts.push(cells);
        return;
    }
    let half = cells.len() / 2;
    if height >= width {
        cells.select_nth_unstable(half);
    } else {
        cells.select_nth_unstable_by_key(half, |&(row, col)| (col, row));
    }
    let upper = cells.split_off(half);
    split(cells, max_extent, parts);
    split(upper, max_extent, parts);
}

/// Find the frontier cells (free, with an unknown 4-neighbour) in clusters: their cells, and where each starts.
pub fn find_frontiers(
    classes: &[u8],
    cols: usize,
    min_cells: usize,
    max_extent: u32,
) -> (Vec<i64>, Vec<i64>) {
    let mut cells = Vec::new();
    for_each_border_cell(
        classes,
        cols,
        |class| class == FREE,
        UNKNOWN,
        |row, col| {
            cells.push((row as u32, col as u32));
        },
    );
    let mut parts = Vec::new();
    for found in cluster(&cells) {
        if found.len() >= min_cells {
            split(found, max_extent, &mut parts);
        }
    }
    parts.sort_unstable_by_key(|part| part[0]);
    let flat = |&(row, col): &(u32, u32)| i64::from(row) * cols as i64 + i64::from(col);
    let mut starts = vec![0];
    let mut flats = Vec::with_capacity(cells.len());
    for part in &parts {
        flats.extend(part.iter().map(flat));
        starts.push(flats.len() as i64);
    }
    (flats, starts)
}

#[pyfunction(name = "traversable")]
fn py_traversable<'py>(
    py: Python<'py>,
    classes: PyReadonlyArray2<'py, u8>,
    radius_m: f64,
    resolution: f64,
) -> PyResult<Bound<'py, PyArray2<u8>>> {
    if !(resolution > 0.0 && radius_m >= 0.0 && (radius_m / resolution).is_finite()) {
        return Err(PyValueError::new_err(format!(
            "radius_m must be >= 0 and resolution > 0; got {radius_m} and {resolution}"
        )));
    }
    let [rows, cols] = [classes.shape()[0], classes.shape()[1]];
    if rows * cols == 0 {
        return Vec::new().into_pyarray(py).reshape([rows, cols]);
    }
    let radius_cells = (radius_m / resolution).min((rows + cols) as f64);
    let classes = classes.as_slice()?;
    py.detach(|| traversable(classes, rows, cols, radius_cells)).into_pyarray(py).reshape([rows, cols])
}

#[pyfunction(name = "find_frontiers")]
fn py_find_frontiers<'py>(
    py: Python<'py>,
    classes: PyReadonlyArray2<'py, u8>,
    min_cells: usize,
    max_extent_cells: u32,
) -> PyResult<(Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<i64>>)> {
    if max_extent_cells == 0 {
        return Err(PyValueError::new_err("max_extent_cells must be >= 1; got 0"));
    }
    let (cols, classes) = (classes.shape()[1], classes.as_slice()?);
    let (cells, starts) = match cols {
        0 => (Vec::new(), vec![0]),
        _ => py.detach(|| find_frontiers(classes, cols, min_cells, max_extent_cells)),
    };
    Ok((cells.into_pyarray(py), starts.into_pyarray(py)))
}

pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(py_traversable, m)?)?;
    m.add_function(wrap_pyfunction!(py_find_frontiers, m)?)?;
    Ok(())
}
