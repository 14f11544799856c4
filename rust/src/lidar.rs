//! Lidar on a grid: simulate a scan, fuse it into log-odds, and count what it saw of the unknown.

use std::ops::Deref;

use numpy::{
    IntoPyArray, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyReadwriteArray2,
    PyUntypedArrayMethods,
};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

mod blur;
mod fuse;
mod tiled;
mod walk;

pub use blur::{integrate_blurred_scan, Blur};
pub use fuse::{integrate_scan, Gains};
use tiled::{Tiled, SIDE};
pub use walk::Lattice;
use walk::Walk;

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
        if range <= max_range {
            range
        } else {
            f64::INFINITY
        }
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
        if self.hits[b] {
            self.ranges[b] + nudge
        } else {
            self.ranges[b]
        }
    }
}

/// Bins of the measured sensor model.
#[derive(Clone, Copy)]
pub struct Bins {
    pub max_range: f64,
    pub width: f64,
    pub berths: usize, // of where a beam enters the unknown, to tell apart ...
    pub step: usize,   // ... by so many cells
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
/// Returns the rows tried and seen by distance, then of each berth tried and seen by unknown length.
pub fn count_sightings(
    log_odds: &Tiled<&[i8]>,
    lattice: Lattice,
    scan: Scan,
    bins: Bins,
    stride: usize,
    nudge: f64,
) -> Vec<i64> {
    let size = bins.count();
    let mut counts = vec![0; (2 + 2 * bins.berths) * size];
    for b in (0..scan.angles.len()).step_by(stride) {
        let reach = scan.reach(b, nudge);
        let mut walk = Walk::new(lattice.resolution, scan.x, scan.y, scan.angles[b]);
        let mut unknown = 0.0; // metres of unknown cells crossed so far
        let (mut berth, mut outside) = (bins.berths - 1, true);
        while walk.entry < bins.max_range {
            if lattice.flat(walk.row, walk.col).is_none() {
                break;
            }
            let known = log_odds.get(walk.row as usize, walk.col as usize);
            if known > 0 {
                break;
            }
            if known == 0 {
                if outside {
                    berth = berth.min(berth_of(log_odds, lattice, walk.row, walk.col, bins));
                }
                let exit = walk.exit().min(bins.max_range);
                let by_distance = bins.index(0.5 * (walk.entry + exit));
                let by_unknown = bins.index(unknown);
                let seen = i64::from(walk.entry < reach || (scan.hits[b] && walk.entry == reach));
                counts[by_distance] += 1;
                counts[size + by_distance] += seen;
                counts[(2 + 2 * berth) * size + by_unknown] += 1;
                counts[(3 + 2 * berth) * size + by_unknown] += seen;
                unknown += exit - walk.entry;
            }
            outside = known != 0;
            walk.advance();
        }
    }
    counts
}

/// How wide a berth a cell gives what is occupied, as `coverage::berths` has it.
fn berth_of(log_odds: &Tiled<&[i8]>, lattice: Lattice, row: i64, col: i64, bins: Bins) -> usize {
    let most = (bins.berths - 1) * bins.step;
    let occupied =
        |row: i64, col: i64| lattice.flat(row, col).is_some() && log_odds.get(row as usize, col as usize) > 0;
    for away in 1..=most as i64 {
        let on_ring = (-away..=away).any(|k| {
            occupied(row - away, col + k)
                || occupied(row + away, col + k)
                || occupied(row + k, col - away)
                || occupied(row + k, col + away)
        });
        if on_ring {
            return (away as usize - 1) / bins.step;
        }
    }
    bins.berths - 1
}

fn lattice_of<T: numpy::Element>(grid: &Bound<'_, PyArray2<T>>, resolution: f64) -> PyResult<Lattice> {
    if !grid.is_c_contiguous() {
        return Err(PyValueError::new_err("the grid must be C-contiguous, [row, col]"));
    }
    checked_lattice((grid.shape()[0], grid.shape()[1]), resolution)
}

fn checked_lattice((rows, cols): (usize, usize), resolution: f64) -> PyResult<Lattice> {
    if !(resolution > 0.0 && resolution.is_finite()) {
        return Err(PyValueError::new_err(format!("resolution must be > 0 m; got {resolution}")));
    }
    Ok(Lattice { rows, cols, resolution })
}

/// The grid of these cells; checked, so that no access to a tile of it can fail.
fn tiled_of<'a, B: Deref<Target = [i8]>>(
    slots: &'a [i32],
    blocks: B,
    lattice: Lattice,
) -> PyResult<Tiled<'a, B>> {
    let (tiles, held) = (lattice.rows.div_ceil(SIDE) * lattice.across(), blocks.len() / (SIDE * SIDE));
    if slots.len() != tiles || slots.iter().any(|&slot| slot < 0 || slot as usize >= held) {
        return Err(PyValueError::new_err("the slots are not those of the grid's tiles"));
    }
    Ok(Tiled { slots, across: lattice.across(), blocks })
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

fn gains_of(hit: i32, miss: i32, clamp: i32) -> PyResult<Gains> {
    if !(1..=127).contains(&clamp) || !(0..=1000).contains(&hit) || !(0..=1000).contains(&miss) {
        return Err(PyValueError::new_err(format!(
            "clamp must be in 1..127 and gains in 0..1000; got {clamp}, {hit}, {miss}"
        )));
    }
    Ok(Gains { hit, miss, clamp })
}

#[pyfunction(name = "cast_rays")]
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

/// Whether the scan was fused, and the cells whose class changed; or if it was not, the missing tiles.
type PyFused<'py> = (bool, Bound<'py, PyArray1<i64>>);

fn fused(py: Python<'_>, outcome: Result<Vec<i64>, Vec<i64>>) -> PyResult<PyFused<'_>> {
    Ok(match outcome {
        Ok(changed) => (true, changed.into_pyarray(py)),
        Err(missing) => (false, missing.into_pyarray(py)),
    })
}

#[pyfunction(name = "integrate_scan")]
fn py_integrate_scan<'py>(
    py: Python<'py>,
    grid: (PyReadonlyArray1<'py, i32>, PyReadwriteArray2<'py, i8>, (usize, usize)),
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
) -> PyResult<PyFused<'py>> {
    let (slots, mut blocks, shape) = grid;
    let lattice = checked_lattice(shape, resolution)?;
    let mut log_odds = tiled_of(slots.as_slice()?, blocks.as_slice_mut()?, lattice)?;
    let scan = scan_of(x, y, angles.as_slice()?, ranges.as_slice()?, hits.as_slice()?)?;
    let gains = gains_of(gain_hit, gain_miss, clamp)?;
    fused(py, integrate_scan(&mut log_odds, lattice, scan, gains, nudge))
}

#[pyfunction(name = "integrate_blurred_scan")]
fn py_integrate_blurred_scan<'py>(
    py: Python<'py>,
    grid: (PyReadonlyArray1<'py, i32>, PyReadwriteArray2<'py, i8>, (usize, usize)),
    resolution: f64,
    x: f64,
    y: f64,
    angles: PyReadonlyArray1<'py, f64>,
    ranges: PyReadonlyArray1<'py, f64>,
    hits: PyReadonlyArray1<'py, bool>,
    margins: PyReadonlyArray1<'py, f64>,
    gain_hit: i32,
    gain_miss: i32,
    clamp: i32,
    nudge: f64,
) -> PyResult<PyFused<'py>> {
    let (slots, mut blocks, shape) = grid;
    let lattice = checked_lattice(shape, resolution)?;
    let mut log_odds = tiled_of(slots.as_slice()?, blocks.as_slice_mut()?, lattice)?;
    let scan = scan_of(x, y, angles.as_slice()?, ranges.as_slice()?, hits.as_slice()?)?;
    let gains = gains_of(gain_hit, gain_miss, clamp)?;
    let margins = margins.as_slice()?;
    let fits = |margin: &f64| (0.0..=100.0).contains(margin);
    if margins.len() != scan.angles.len() || !margins.iter().all(fits) {
        return Err(PyValueError::new_err(format!(
            "margins must be as many as beams ({}), each 0 to 100 m; got {margins:?}",
            scan.angles.len()
        )));
    }
    let blur = Blur { margins };
    fused(py, integrate_blurred_scan(&mut log_odds, lattice, scan, blur, gains, nudge))
}

#[pyfunction(name = "count_sightings")]
fn py_count_sightings<'py>(
    py: Python<'py>,
    grid: (PyReadonlyArray1<'py, i32>, PyReadonlyArray2<'py, i8>, (usize, usize)),
    resolution: f64,
    x: f64,
    y: f64,
    angles: PyReadonlyArray1<'py, f64>,
    ranges: PyReadonlyArray1<'py, f64>,
    hits: PyReadonlyArray1<'py, bool>,
    max_range: f64,
    bin_m: f64,
    berths: usize,
    step: usize,
    stride: usize,
    nudge: f64,
) -> PyResult<Bound<'py, PyArray2<i64>>> {
    let (slots, blocks, shape) = grid;
    let lattice = checked_lattice(shape, resolution)?;
    let log_odds = tiled_of(slots.as_slice()?, blocks.as_slice()?, lattice)?;
    let scan = scan_of(x, y, angles.as_slice()?, ranges.as_slice()?, hits.as_slice()?)?;
    if !(max_range > 0.0 && max_range.is_finite() && bin_m > 0.0 && berths > 0 && step > 0 && stride > 0) {
        return Err(PyValueError::new_err(format!(
            "max_range, bin_m, berths, step and stride must be > 0; got {max_range}, {bin_m}, {berths}, {step}, {stride}"
        )));
    }
    let bins = Bins { max_range, width: bin_m, berths, step };
    let counts = count_sightings(&log_odds, lattice, scan, bins, stride, nudge);
    counts.into_pyarray(py).reshape([2 + 2 * berths, bins.count()])
}

pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(py_cast_rays, m)?)?;
    m.add_function(wrap_pyfunction!(py_integrate_scan, m)?)?;
    m.add_function(wrap_pyfunction!(py_integrate_blurred_scan, m)?)?;
    m.add_function(wrap_pyfunction!(py_count_sightings, m)?)?;
    Ok(())
}
