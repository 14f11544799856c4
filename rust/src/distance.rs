//! Shortest 8-connected paths between traversable cells, without cutting corners.
//!
//! A straight step costs 29 and a diagonal one 41: 41/29 is 0.03 % under the square root of two. With integer
//! costs the queue is a ring of buckets (Dial), and searches from either end agree exactly.

use numpy::{
    IntoPyArray, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods,
};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::visibility::{checked_cell, segment_clear};

const STRAIGHT: u32 = 29;
const DIAGONAL: u32 = 41;
const UNREACHED: u32 = u32::MAX;

/// Cells: how far from the nearest traversable cells a place that is not traversable still connects to them.
const CONNECTION: i64 = 3;

/// Buckets of the queue: a power of two above the dearest step or connection, `29 * 3`.
const RING: usize = 128;

/// Row and column steps of the eight moves, counter-clockwise from +x; the odd ones are diagonal.
const MOVES: [(i64, i64); 8] = [(0, 1), (1, 1), (1, 0), (1, -1), (0, -1), (-1, -1), (-1, 0), (-1, 1)];

/// Stands for "no move": where a search starts.
const START: u8 = 8;

/// Moves allowed from each cell, a bit each: to a traversable cell and, diagonally, past two traversable ones.
fn allowed_moves(open: &[u8], cols: usize) -> Vec<u8> {
    let rows = open.len() / cols;
    let mut moves = vec![0u8; open.len()];
    let mut padded = [vec![0u8; cols + 2], vec![0u8; cols + 2], vec![0u8; cols + 2]];
    let load = |row: usize, line: &mut Vec<u8>| match row < rows {
        true => line[1..=cols].iter_mut().zip(&open[row * cols..]).for_each(|(a, &b)| *a = u8::from(b != 0)),
        false => line.fill(0),
    };
    load(0, &mut padded[2]);
    for row in 0..rows {
        padded.rotate_left(1);
        load(row + 1, &mut padded[2]);
        let [south, here, north] = &padded;
        let out = &mut moves[row * cols..(row + 1) * cols];
        let (sw, s, se) = (&south[..cols], &south[1..=cols], &south[2..cols + 2]);
        let (w, o, e) = (&here[..cols], &here[1..=cols], &here[2..cols + 2]);
        let (nw, n, ne) = (&north[..cols], &north[1..=cols], &north[2..cols + 2]);
        for i in 0..cols {
            let straight = e[i] | n[i] << 2 | w[i] << 4 | s[i] << 6;
            let ahead = (ne[i] & n[i] & e[i]) << 1 | (nw[i] & n[i] & w[i]) << 3;
            let behind = (sw[i] & s[i] & w[i]) << 5 | (se[i] & s[i] & e[i]) << 7;
            out[i] = (straight | ahead | behind) & o[i].wrapping_neg();
        }
    }
    moves
}

/// Moves worth making after arriving by `arrived`: those that no other path from the cell before makes as well.
///
/// Diagonal steps come first among equals (canonical ordering), so a straight run only goes on, and turns where
/// an obstacle beside the cell before kept that cell from moving diagonally itself.
#[inline]
fn worthwhile(arrived: u8, before: impl Fn() -> u8) -> u8 {
    let d = u32::from(arrived);
    if arrived == START {
        0xff
    } else if d % 2 == 1 {
        0b0000_0111u8.rotate_left(d - 1)
    } else {
        let lacks = !before().rotate_right(d);
        let left = (lacks >> 1 & 1) * 0b0000_0110;
        let right = (lacks >> 7 & 1) * 0b1100_0000;
        (1 | left | right).rotate_left(d)
    }
}

/// A reusable search: its buffers outlive a run, and only the cells that a run touched are reset.
struct Search<'a> {
    moves: &'a [u8],
    steps: [i64; 8],
    cost: Vec<u32>,
    arrived: Vec<u8>,
    wanted: Vec<bool>,
    names: Vec<usize>,
    touched: Vec<u32>,
    ring: Box<[Vec<u32>; RING]>,
    queued: usize,
}

impl<'a> Search<'a> {
    fn new(moves: &'a [u8], cols: usize) -> Self {
        Search {
            moves,
            steps: MOVES.map(|(row, col)| row * cols as i64 + col),
            cost: vec![UNREACHED; moves.len()],
            arrived: vec![START; moves.len()],
            wanted: vec![false; moves.len()],
            names: Vec::new(),
            touched: Vec::new(),
            ring: Box::new([const { Vec::new() }; RING]),
            queued: 0,
        }
    }

    fn reset(&mut self) {
        for cells in self.ring.iter_mut().chain([&mut self.touched]) {
            for cell in cells.drain(..) {
                self.cost[cell as usize] = UNREACHED;
            }
        }
        self.queued = 0;
    }

    #[inline]
    fn improve(&mut self, cell: usize, cost: u32, arrived: u8) {
        if cost < self.cost[cell] {
            self.cost[cell] = cost;
            self.arrived[cell] = arrived;
            self.ring[cost as usize % RING].push(cell as u32);
            self.queued += 1;
        }
    }

    #[inline]
    fn expand(&mut self, cell: usize, level: u32) {
        let arrived = self.arrived[cell];
        let before = || self.moves[(cell as i64 - self.steps[arrived as usize]) as usize];
        let mut moves = self.moves[cell] & worthwhile(arrived, before);
        while moves != 0 {
            let d = moves.trailing_zeros() as usize;
            moves &= moves - 1;
            let step = if d % 2 == 1 { DIAGONAL } else { STRAIGHT };
            self.improve((cell as i64 + self.steps[d]) as usize, level + step, d as u8);
        }
    }

    /// Run from the seeds `(cell, cost)`, up to `limit` or until `left` wanted cells are settled.
    ///
    /// Returns the highest cost at which what is known is final.
    fn run(&mut self, seeds: &[(usize, u32)], limit: u32, mut left: usize) -> u32 {
        self.reset();
        for &(cell, cost) in seeds {
            self.improve(cell, cost, START);
        }
        let mut level = 0;
        while self.queued > 0 && level <= limit {
            let mut bucket = std::mem::take(&mut self.ring[level as usize % RING]);
            self.queued -= bucket.len();
            self.touched.extend_from_slice(&bucket);
            for &cell in &bucket {
                let cell = cell as usize;
                if self.cost[cell] != level {
                    continue; // a cheaper path came after this entry
                }
                if self.wanted[cell] {
                    left -= 1;
                    if left == 0 {
                        return level;
                    }
                }
                self.expand(cell, level);
            }
            bucket.clear();
            self.ring[level as usize % RING] = bucket;
            level += 1;
        }
        if self.queued > 0 { limit } else { UNREACHED - 1 }
    }

    /// Name the cells to settle before the next run may stop early; returns how many they are.
    fn want(&mut self, cells: impl Iterator<Item = usize>) -> usize {
        for cell in self.names.drain(..) {
            self.wanted[cell] = false;
        }
        for cell in cells {
            if !self.wanted[cell] {
                self.wanted[cell] = true;
                self.names.push(cell);
            }
        }
        self.names.len()
    }
}

/// How a cell joins the traversable ones: itself, or by straight lines to those within three cells of it.
fn connections(open: &[u8], cols: usize, cell: usize) -> Vec<(usize, u32)> {
    if open[cell] != 0 {
        return vec![(cell, 0)];
    }
    let (rows, cols) = ((open.len() / cols) as i64, cols as i64);
    let (row, col) = (cell as i64 / cols, cell as i64 % cols);
    let mut found = Vec::new();
    for r in (row - CONNECTION).max(0)..=(row + CONNECTION).min(rows - 1) {
        for c in (col - CONNECTION).max(0)..=(col + CONNECTION).min(cols - 1) {
            let squared = (r - row).pow(2) + (c - col).pow(2);
            if squared <= CONNECTION * CONNECTION && open[(r * cols + c) as usize] != 0 {
                let cost = (f64::from(STRAIGHT) * (squared as f64).sqrt()).round() as u32;
                found.push(((r * cols + c) as usize, cost));
            }
        }
    }
    found
}

/// Path lengths [m] from the source to every cell, infinity where unreachable (or past an early stop).
pub fn distance_field(open: &[u8], cols: usize, source: usize, resolution: f64, stop_at: Option<&[usize]>) -> Vec<f32> {
    let moves = allowed_moves(open, cols);
    let mut search = Search::new(&moves, cols);
    let left = search.want(stop_at.unwrap_or(&[]).iter().copied().filter(|&cell| open[cell] != 0));
    let last = match stop_at {
        Some(_) if left == 0 => 0,
        _ => search.run(&connections(open, cols, source), UNREACHED - 1, left),
    };
    let metres = resolution / f64::from(STRAIGHT);
    let length = |&cost: &u32| if cost <= last { (f64::from(cost) * metres) as f32 } else { f32::INFINITY };
    let mut field: Vec<f32> = search.cost.iter().map(length).collect();
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

/// The neighbour to which the field falls most steeply, if it falls to any.
fn downhill(field: &[f32], open: &[u8], cols: usize, cell: usize) -> Option<usize> {
    let rows = (open.len() / cols) as i64;
    let (row, col) = ((cell / cols) as i64, (cell % cols) as i64);
    let mut best = (0.0, None);
    for (d, (row_step, col_step)) in MOVES.into_iter().enumerate() {
        let (r, c) = (row + row_step, col + col_step);
        if r < 0 || r >= rows || c < 0 || c >= cols as i64 {
            continue;
        }
        let at = |r: i64, c: i64| (r * cols as i64 + c) as usize;
        let next = at(r, c);
        let passable = open[next] != 0 && (d % 2 == 0 || (open[at(row, c)] != 0 && open[at(r, col)] != 0));
        let length = if d % 2 == 1 { std::f64::consts::SQRT_2 } else { 1.0 };
        let slope = (f64::from(field[cell]) - f64::from(field[next])) / length;
        if passable && slope > best.0 {
            best = (slope, Some(next));
        }
    }
    best.1
}

/// The field's source beside a cell where no neighbour is lower: a source that is itself not traversable.
fn nearby_source(field: &[f32], cols: usize, cell: usize) -> Option<usize> {
    let rows = (field.len() / cols) as i64;
    let (row, col) = ((cell / cols) as i64, (cell % cols) as i64);
    let rows = (row - CONNECTION).max(0)..=(row + CONNECTION).min(rows - 1);
    let mut cells = rows.flat_map(|r| {
        ((col - CONNECTION).max(0)..=(col + CONNECTION).min(cols as i64 - 1)).map(move |c| (r * cols as i64 + c) as usize)
    });
    cells.find(|&other| field[other] == 0.0)
}

/// The path from the field's source to the target, by steepest descent from the target; empty if unreachable.
pub fn path_to(field: &[f32], open: &[u8], cols: usize, target: usize) -> Vec<i64> {
    if !field[target].is_finite() {
        return Vec::new();
    }
    let mut path = vec![target as i64];
    let mut cell = target;
    while field[cell] > 0.0 {
        let next = downhill(field, open, cols, cell).or_else(|| nearby_source(field, cols, cell));
        let Some(next) = next else { return Vec::new() };
        path.push(next as i64);
        cell = next;
    }
    path.reverse();
    path
}

/// Drop the cells of a path that straight lines over traversable cells make needless; keeps its ends.
pub fn shortcut(open: &[u8], cols: usize, path: &[usize]) -> Vec<i64> {
    let clear = |from: usize, to: usize| {
        open[from] != 0 && open[to] != 0 && segment_clear(cols, from, to, |cell| open[cell] != 0)
    };
    let mut kept: Vec<i64> = path.first().map(|&cell| cell as i64).into_iter().collect();
    let mut anchor = 0;
    for i in 2..path.len() {
        if !clear(path[anchor], path[i]) {
            anchor = i - 1;
            kept.push(path[anchor] as i64);
        }
    }
    kept.extend(path.get(1..).and_then(<[usize]>::last).map(|&cell| cell as i64));
    kept
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
    stop_at: Option<PyReadonlyArray1<'py, i64>>,
) -> PyResult<Bound<'py, PyArray2<f32>>> {
    let [rows, cols] = [traversable.shape()[0], traversable.shape()[1]];
    check_resolution(resolution)?;
    let source = checked_cell(source, rows * cols)?;
    let stop_at = stop_at.map(|cells| checked_cells(&cells, rows * cols)).transpose()?;
    let field = distance_field(traversable.as_slice()?, cols, source, resolution, stop_at.as_deref());
    field.into_pyarray(py).reshape([rows, cols])
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
    let matrix = if cells.is_empty() {
        Vec::new()
    } else {
        distance_matrix(traversable.as_slice()?, cols, &cells, resolution, limit_m)
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
    m.add_function(wrap_pyfunction!(py_distance_matrix, m)?)?;
    m.add_function(wrap_pyfunction!(py_path_to, m)?)?;
    m.add_function(wrap_pyfunction!(py_shortcut, m)?)?;
    Ok(())
}
