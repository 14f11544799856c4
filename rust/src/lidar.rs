//! Lidar on a grid: simulate a scan, fuse it into log-odds, and count what it saw of the unknown.

use numpy::{
    IntoPyArray, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyReadwriteArray2,
    PyUntypedArrayMethods,
};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Shape and cell side [m] of a row-major grid whose lower-left corner is the origin.
#[derive(Clone, Copy)]
pub struct Lattice {
    pub rows: usize,
    pub cols: usize,
    pub resolution: f64,
}

impl Lattice {
    /// Flat index of a cell, or `None` outside the grid.
    #[inline]
    fn flat(&self, row: i64, col: i64) -> Option<usize> {
        // A negative index wraps to a huge one, so two comparisons are enough.
        let inside = (row as u64) < self.rows as u64 && (col as u64) < self.cols as u64;
        inside.then(|| row as usize * self.cols + col as usize)
    }
}

/// The cells that a ray crosses, in order (Amanatides & Woo, 1987); `entry` and `exit` in metres along it.
struct Walk {
    row: i64,
    col: i64,
    entry: f64,
    row_step: i64,
    col_step: i64,
    row_exit: f64,
    col_exit: f64,
    row_delta: f64,
    col_delta: f64,
}

/// Step, metres to the first crossing and metres between crossings along one axis.
fn axis(position: f64, cell: f64, direction: f64, resolution: f64) -> (i64, f64, f64) {
    if direction > 0.0 {
        (1, (cell + 1.0 - position) * resolution / direction, resolution / direction)
    } else if direction < 0.0 {
        (-1, (cell - position) * resolution / direction, -resolution / direction)
    } else {
        (0, f64::INFINITY, f64::INFINITY)
    }
}

impl Walk {
    fn new(resolution: f64, x: f64, y: f64, angle: f64) -> Self {
        let (sin, cos) = angle.sin_cos();
        let (px, py) = (x / resolution, y / resolution);
        let (col_step, col_exit, col_delta) = axis(px, px.floor(), cos, resolution);
        let (row_step, row_exit, row_delta) = axis(py, py.floor(), sin, resolution);
        Walk {
            row: py.floor() as i64,
            col: px.floor() as i64,
            entry: 0.0,
            row_step,
            col_step,
            row_exit,
            col_exit,
            row_delta,
            col_delta,
        }
    }

    #[inline]
    fn exit(&self) -> f64 {
        self.row_exit.min(self.col_exit)
    }

    #[inline]
    fn advance(&mut self) {
        // Selects, not branches: which axis comes next is as good as random to the processor.
        let sideways = self.col_exit <= self.row_exit;
        self.entry = self.exit();
        self.col += if sideways { self.col_step } else { 0 };
        self.row += if sideways { 0 } else { self.row_step };
        self.col_exit += if sideways { self.col_delta } else { 0.0 };
        self.row_exit += if sideways { 0.0 } else { self.row_delta };
    }
}

/// Range to the nearest disc surface that the ray meets; discs that hold the sensor do not count.
fn disc_range(discs: &[[f64; 3]], x: f64, y: f64, angle: f64) -> f64 {
    let (sin, cos) = angle.sin_cos();
    let mut nearest = f64::INFINITY;
    for &[disc_x, disc_y, radius] in discs {
        let (dx, dy) = (disc_x - x, disc_y - y);
        let outside = dx * dx + dy * dy - radius * radius;
        let along = dx * cos + dy * sin;
        let under_root = along * along - outside;
        if outside > 0.0 && along > 0.0 && under_root >= 0.0 {
            nearest = nearest.min(along - under_root.sqrt());
        }
    }
    nearest
}

/// Range to the face of the first solid cell within `limit`, else infinity; outside the grid is solid.
fn wall_range(solid: &[u8], lattice: Lattice, x: f64, y: f64, angle: f64, limit: f64) -> f64 {
    let mut walk = Walk::new(lattice.resolution, x, y, angle);
    while walk.entry <= limit {
        match lattice.flat(walk.row, walk.col) {
            Some(cell) if solid[cell] == 0 => walk.advance(),
            _ => return walk.entry,
        }
    }
    f64::INFINITY
}

/// Ranges of one scan: the nearer of wall and disc on each beam, infinity beyond `max_range`.
pub fn cast_rays(
    solid: &[u8],
    lattice: Lattice,
    x: f64,
    y: f64,
    angles: &[f64],
    max_range: f64,
    discs: &[[f64; 3]],
) -> Vec<f64> {
    let beam = |&angle: &f64| {
        let disc = disc_range(discs, x, y, angle);
        let wall = wall_range(solid, lattice, x, y, angle, max_range.min(disc));
        let range = wall.min(disc);
        if range <= max_range { range } else { f64::INFINITY }
    };
    angles.iter().map(beam).collect()
}

/// One scan's measured beams: world angle, range [m], and whether the range ends at an obstacle.
#[derive(Clone, Copy)]
pub struct Scan<'a> {
    pub x: f64,
    pub y: f64,
    pub angles: &'a [f64],
    pub ranges: &'a [f64],
    pub hits: &'a [bool],
}

impl Scan<'_> {
    /// Metres along beam `b` to its endpoint: `nudge` beyond the range where it hit, to be inside the obstacle.
    fn reach(&self, b: usize, nudge: f64) -> f64 {
        if self.hits[b] { self.ranges[b] + nudge } else { self.ranges[b] }
    }
}

const MISS: u8 = 1;
const HIT: u8 = 2;

/// What one scan says of each cell that it touched: the part of the grid in its reach, and the touched cells.
struct Marks {
    first_row: i64,
    first_col: i64,
    rows: usize,
    cols: usize,
    marks: Vec<u8>,
    touched: Vec<u32>,
}

impl Marks {
    fn around(scan: Scan, lattice: Lattice, nudge: f64) -> Self {
        let reach = (0..scan.angles.len()).map(|b| scan.reach(b, nudge)).fold(0.0, f64::max);
        let clip = |position: f64, size: usize| {
            let low = ((position - reach) / lattice.resolution).floor() - 1.0;
            let high = ((position + reach) / lattice.resolution).floor() + 2.0;
            (low.clamp(0.0, size as f64) as usize, high.clamp(0.0, size as f64) as usize)
        };
        let (first_row, last_row) = clip(scan.y, lattice.rows);
        let (first_col, last_col) = clip(scan.x, lattice.cols);
        let (rows, cols) = (last_row - first_row, last_col - first_col);
        Marks {
            first_row: first_row as i64,
            first_col: first_col as i64,
            rows,
            cols,
            marks: vec![0; rows * cols],
            touched: Vec::new(),
        }
    }

    /// Record a mark, the stronger one where a cell gets several; false outside the grid.
    #[inline]
    fn put(&mut self, row: i64, col: i64, mark: u8) -> bool {
        let (row, col) = ((row - self.first_row) as u64, (col - self.first_col) as u64);
        if row >= self.rows as u64 || col >= self.cols as u64 {
            return false;
        }
        let cell = row as usize * self.cols + col as usize;
        let old = self.marks[cell];
        if old == 0 {
            self.touched.push(cell as u32);
        }
        self.marks[cell] = old.max(mark);
        true
    }

    fn trace(&mut self, scan: Scan, b: usize, resolution: f64, nudge: f64) {
        let reach = scan.reach(b, nudge);
        let mut walk = Walk::new(resolution, scan.x, scan.y, scan.angles[b]);
        let mut entered = false;
        while walk.exit() <= reach {
            let inside = self.put(walk.row, walk.col, MISS);
            if entered && !inside {
                return; // the grid is convex: a ray that left it does not come back
            }
            entered |= inside;
            walk.advance();
        }
        self.put(walk.row, walk.col, if scan.hits[b] { HIT } else { MISS });
    }

    fn set_miss(&mut self, row: i64, col: i64) {
        if self.put(row, col, MISS) {
            let cell = (row - self.first_row) as usize * self.cols + (col - self.first_col) as usize;
            self.marks[cell] = MISS;
        }
    }
}

/// Steps of the log-odds, and the value they saturate at.
#[derive(Clone, Copy)]
pub struct Gains {
    pub hit: i32,
    pub miss: i32,
    pub clamp: i32,
}

/// Fuse one scan into integer log-odds; return the sorted cells whose class (sign) changed.
pub fn integrate_scan(log_odds: &mut [i8], lattice: Lattice, scan: Scan, gains: Gains, nudge: f64) -> Vec<i64> {
    let mut marks = Marks::around(scan, lattice, nudge);
    for b in 0..scan.angles.len() {
        marks.trace(scan, b, lattice.resolution, nudge);
    }
    if !scan.angles.is_empty() {
        let cell = |position: f64| (position / lattice.resolution).floor() as i64;
        marks.set_miss(cell(scan.y), cell(scan.x)); // the sensor stands there
    }
    let mut changed = Vec::new();
    for &local in &marks.touched {
        let (row, col) = (local as usize / marks.cols, local as usize % marks.cols);
        let cell = (row + marks.first_row as usize) * lattice.cols + col + marks.first_col as usize;
        let step = if marks.marks[local as usize] == HIT { gains.hit } else { -gains.miss };
        let old = log_odds[cell];
        let new = (i32::from(old) + step).clamp(-gains.clamp, gains.clamp) as i8;
        log_odds[cell] = new;
        if new.signum() != old.signum() {
            changed.push(cell as i64);
        }
    }
    changed.sort_unstable();
    changed
}

/// Bins of the measured sensor model.
#[derive(Clone, Copy)]
pub struct Bins {
    pub max_range: f64,
    pub width: f64,
}

impl Bins {
    pub fn count(&self) -> usize {
        (self.max_range / self.width).ceil() as usize
    }

    fn index(&self, length: f64) -> usize {
        ((length / self.width) as usize).min(self.count() - 1)
    }
}

/// Count, by distance and by unknown length before it, the unknown cells one scan tried and saw (paper, Fig. 3).
///
/// Returns the rows tried by distance, seen by distance, tried by unknown length, seen by unknown length.
pub fn count_sightings(
    log_odds: &[i8],
    lattice: Lattice,
    scan: Scan,
    bins: Bins,
    stride: usize,
    nudge: f64,
) -> Vec<i64> {
    let size = bins.count();
    let mut counts = vec![0; 4 * size];
    for b in (0..scan.angles.len()).step_by(stride) {
        let reach = scan.reach(b, nudge);
        let mut walk = Walk::new(lattice.resolution, scan.x, scan.y, scan.angles[b]);
        let mut unknown = 0.0; // metres of unknown cells crossed so far
        while walk.entry < bins.max_range {
            let Some(cell) = lattice.flat(walk.row, walk.col) else { break };
            if log_odds[cell] > 0 {
                break;
            }
            if log_odds[cell] == 0 {
                let exit = walk.exit().min(bins.max_range);
                let by_distance = bins.index(0.5 * (walk.entry + exit));
                let by_unknown = bins.index(unknown);
                let seen = i64::from(walk.entry < reach || (scan.hits[b] && walk.entry == reach));
                counts[by_distance] += 1;
                counts[size + by_distance] += seen;
                counts[2 * size + by_unknown] += 1;
                counts[3 * size + by_unknown] += seen;
                unknown += exit - walk.entry;
            }
            walk.advance();
        }
    }
    counts
}

fn lattice_of<T: numpy::Element>(grid: &Bound<'_, PyArray2<T>>, resolution: f64) -> PyResult<Lattice> {
    if !(resolution > 0.0 && resolution.is_finite()) {
        return Err(PyValueError::new_err(format!("resolution must be > 0 m; got {resolution}")));
    }
    if !grid.is_c_contiguous() {
        return Err(PyValueError::new_err("the grid must be C-contiguous, [row, col]"));
    }
    Ok(Lattice { rows: grid.shape()[0], cols: grid.shape()[1], resolution })
}

fn check_finite(name: &str, values: &[f64]) -> PyResult<()> {
    match values.iter().find(|v| !v.is_finite()) {
        Some(v) => Err(PyValueError::new_err(format!("{name} must be finite; got {v}"))),
        None => Ok(()),
    }
}

fn scan_of<'a>(x: f64, y: f64, angles: &'a [f64], ranges: &'a [f64], hits: &'a [bool]) -> PyResult<Scan<'a>> {
    if angles.len() != ranges.len() || angles.len() != hits.len() {
        return Err(PyValueError::new_err(format!(
            "angles, ranges and hits must be equally long; got {}, {} and {}",
            angles.len(),
            ranges.len(),
            hits.len()
        )));
    }
    check_finite("the sensor's position", &[x, y])?;
    check_finite("angles", angles)?;
    check_finite("ranges", ranges)?;
    Ok(Scan { x, y, angles, ranges, hits })
}

#[pyfunction(name = "cast_rays")]
#[allow(clippy::too_many_arguments)]
fn py_cast_rays<'py>(
    py: Python<'py>,
    solid: PyReadonlyArray2<'py, u8>,
    resolution: f64,
    x: f64,
    y: f64,
    angles: PyReadonlyArray1<'py, f64>,
    max_range: f64,
    discs: PyReadonlyArray2<'py, f64>,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let lattice = lattice_of(&solid, resolution)?;
    if discs.shape()[1] != 3 {
        return Err(PyValueError::new_err(format!("discs must be (D, 3); got {:?}", discs.shape())));
    }
    let angles = angles.as_slice()?;
    check_finite("the sensor's position", &[x, y])?;
    check_finite("angles", angles)?;
    let discs: Vec<[f64; 3]> = discs.as_slice()?.chunks_exact(3).map(|d| [d[0], d[1], d[2]]).collect();
    Ok(cast_rays(solid.as_slice()?, lattice, x, y, angles, max_range, &discs).into_pyarray(py))
}

#[pyfunction(name = "integrate_scan")]
#[allow(clippy::too_many_arguments)]
fn py_integrate_scan<'py>(
    py: Python<'py>,
    mut log_odds: PyReadwriteArray2<'py, i8>,
    resolution: f64,
    x: f64,
    y: f64,
    angles: PyReadonlyArray1<'py, f64>,
    ranges: PyReadonlyArray1<'py, f64>,
    hits: PyReadonlyArray1<'py, bool>,
    gain_hit: i32,
    gain_miss: i32,
    clamp: i32,
    nudge: f64,
) -> PyResult<Bound<'py, PyArray1<i64>>> {
    let lattice = lattice_of(&log_odds, resolution)?;
    let scan = scan_of(x, y, angles.as_slice()?, ranges.as_slice()?, hits.as_slice()?)?;
    if !(1..=127).contains(&clamp) || !(0..=1000).contains(&gain_hit) || !(0..=1000).contains(&gain_miss) {
        return Err(PyValueError::new_err(format!(
            "clamp must be in 1..127 and gains in 0..1000; got {clamp}, {gain_hit}, {gain_miss}"
        )));
    }
    let gains = Gains { hit: gain_hit, miss: gain_miss, clamp };
    Ok(integrate_scan(log_odds.as_slice_mut()?, lattice, scan, gains, nudge).into_pyarray(py))
}

#[pyfunction(name = "count_sightings")]
#[allow(clippy::too_many_arguments)]
fn py_count_sightings<'py>(
    py: Python<'py>,
    log_odds: PyReadonlyArray2<'py, i8>,
    resolution: f64,
    x: f64,
    y: f64,
    angles: PyReadonlyArray1<'py, f64>,
    ranges: PyReadonlyArray1<'py, f64>,
    hits: PyReadonlyArray1<'py, bool>,
    max_range: f64,
    bin_m: f64,
    stride: usize,
    nudge: f64,
) -> PyResult<Bound<'py, PyArray2<i64>>> {
    let lattice = lattice_of(&log_odds, resolution)?;
    let scan = scan_of(x, y, angles.as_slice()?, ranges.as_slice()?, hits.as_slice()?)?;
    if !(max_range > 0.0 && max_range.is_finite() && bin_m > 0.0 && stride > 0) {
        return Err(PyValueError::new_err(format!(
            "max_range, bin_m and stride must be > 0; got {max_range}, {bin_m}, {stride}"
        )));
    }
    let bins = Bins { max_range, width: bin_m };
    let counts = count_sightings(log_odds.as_slice()?, lattice, scan, bins, stride, nudge);
    counts.into_pyarray(py).reshape([4, bins.count()])
}

pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(py_cast_rays, m)?)?;
    m.add_function(wrap_pyfunction!(py_integrate_scan, m)?)?;
    m.add_function(wrap_pyfunction!(py_count_sightings, m)?)?;
    Ok(())
}
