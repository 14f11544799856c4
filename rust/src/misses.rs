//! Sparse log-misses as bytes and back: places layer by layer as gaps, log-misses apart.
//!
//! A place is `layer * cells + cell`; gaps start anew with each of `runs` equal parts of all places. The bytes are
//! the number of entries in each run (`<u4`), all gaps in a byte each, all log-misses, and the gaps of 255 and
//! more once again (`<u4`).

use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

const OUTSIDE: &str = "impact has a cell outside the map or an empty entry";
/// Gaps from here on have four bytes of their own.
const WIDE: u64 = 255;
/// Keys are sorted by so many bits at a time.
const DIGIT: u32 = 11;

/// Cells, layers and runs of a grid.
#[derive(Clone, Copy)]
pub struct Places {
    pub cells: u64,
    pub layers: u64,
    pub runs: u64,
}

impl Places {
    /// The places of a run.
    fn of_a_run(&self) -> u64 {
        self.cells * self.layers / self.runs
    }
}

/// The bytes of an impact; an error for a key that is no cell and layer of the grid.
pub fn pack(places: Places, keys: &[u32], misses: &[u8]) -> Result<Vec<u8>, &'static str> {
    let (run_length, layers) = (places.of_a_run(), places.layers as usize);
    if keys.iter().any(|&key| u64::from(key) / places.layers >= places.cells) {
        return Err(OUTSIDE);
    }
    let mut starts = vec![0_usize; layers + 1];
    for &key in keys {
        starts[key as usize % layers + 1] += 1;
    }
    for layer in 0..layers {
        starts[layer + 1] += starts[layer];
    }
    let mut by_place = vec![(0_u64, 0_u8); keys.len()];
    for (&key, &miss) in keys.iter().zip(misses) {
        let (cell, layer) = (u64::from(key) / places.layers, key as usize % layers);
        by_place[starts[layer]] = (layer as u64 * places.cells + cell, miss);
        starts[layer] += 1;
    }
    let mut counts = vec![0_u32; places.runs as usize];
    let (mut gaps, mut wide) = (Vec::with_capacity(keys.len()), Vec::new());
    let mut last = 0;
    for &(place, _) in &by_place {
        let (run, within) = (place / run_length.max(1), place % run_length.max(1));
        let count = counts.get_mut(run as usize).ok_or(OUTSIDE)?;
        let gap = if *count == 0 { within } else { within - last };
        if gap >= WIDE {
            wide.extend((gap as u32).to_le_bytes());
        }
        gaps.push(gap.min(WIDE) as u8);
        (*count, last) = (*count + 1, within);
    }
    let mut bytes: Vec<u8> = counts.iter().flat_map(|count| count.to_le_bytes()).collect();
    bytes.extend(gaps);
    bytes.extend(by_place.iter().map(|&(_, miss)| miss));
    bytes.extend(wide);
    Ok(bytes)
}

/// The keys, ascending, and log-misses of an impact of these bytes; an error says what is wrong with them.
pub fn unpack(places: Places, bytes: &[u8]) -> Result<(Vec<u32>, Vec<u8>), &'static str> {
    let head = 4 * places.runs as usize;
    if bytes.len() < head {
        return Err("impact is cut short or too large");
    }
    let number = |four: &[u8]| u64::from(u32::from_le_bytes([four[0], four[1], four[2], four[3]]));
    let (counts, rest) = bytes.split_at(head);
    let total: u64 = counts.chunks_exact(4).map(number).sum();
    if (rest.len() as u64) < 2 * total {
        return Err("impact has fewer entries than it declares");
    }
    let (gaps, rest) = rest.split_at(total as usize);
    let (misses, wide) = rest.split_at(total as usize);
    if wide.len() != 4 * gaps.iter().filter(|&&gap| u64::from(gap) == WIDE).count() {
        return Err("impact has the wrong number of wide gaps");
    }
    let run_length = places.of_a_run();
    let (mut wide, mut at) = (wide.chunks_exact(4).map(number), 0);
    let mut entries = Vec::with_capacity(gaps.len());
    let mut twice = false;
    for (run, count) in counts.chunks_exact(4).map(number).enumerate() {
        let mut within = 0;
        for first in (0..count).map(|k| k == 0) {
            let gap = match u64::from(gaps[at]) {
                WIDE => wide.next().unwrap_or(WIDE),
                gap => gap,
            };
            within += gap;
            if within >= run_length || misses[at] == 0 {
                return Err(OUTSIDE);
            }
            twice |= gap == 0 && !first;
            let place = run as u64 * run_length + within;
            let key = place % places.cells * places.layers + place / places.cells;
            entries.push((key as u32, misses[at]));
            at += 1;
        }
    }
    if twice {
        return Err("impact has the same cell and layer twice");
    }
    Ok(sorted(entries).into_iter().unzip())
}

/// Entries by ascending key: a radix sort.
fn sorted(mut entries: Vec<(u32, u8)>) -> Vec<(u32, u8)> {
    let most = entries.iter().map(|&(key, _)| key).max().unwrap_or(0);
    let mut other = entries.clone();
    let mut shift = 0;
    while shift < 32 && most >> shift > 0 {
        let digit = |key: u32| (key >> shift) as usize & ((1 << DIGIT) - 1);
        let mut starts = [0_usize; (1 << DIGIT) + 1];
        for &(key, _) in &entries {
            starts[digit(key) + 1] += 1;
        }
        for k in 0..1 << DIGIT {
            starts[k + 1] += starts[k];
        }
        for &(key, miss) in &entries {
            let place = &mut starts[digit(key)];
            other[*place] = (key, miss);
            *place += 1;
        }
        std::mem::swap(&mut entries, &mut other);
        shift += DIGIT;
    }
    entries
}

fn places_of(cells: u64, layers: u64, runs: u64) -> PyResult<Places> {
    if layers == 0 || runs == 0 || cells.checked_mul(layers).is_none_or(|all| all > 1 << 32) {
        return Err(PyValueError::new_err("a grid has layers and runs, and at most 2^32 places"));
    }
    Ok(Places { cells, layers, runs })
}

#[pyfunction(name = "pack_misses")]
fn py_pack<'py>(
    py: Python<'py>,
    keys: PyReadonlyArray1<'py, u32>,
    misses: PyReadonlyArray1<'py, u8>,
    cells: u64,
    layers: u64,
    runs: u64,
) -> PyResult<Bound<'py, PyBytes>> {
    let (places, keys, misses) = (places_of(cells, layers, runs)?, keys.as_slice()?, misses.as_slice()?);
    let bytes = py.detach(|| pack(places, keys, misses)).map_err(PyValueError::new_err)?;
    Ok(PyBytes::new(py, &bytes))
}

type PyMisses<'py> = (Bound<'py, PyArray1<u32>>, Bound<'py, PyArray1<u8>>);

#[pyfunction(name = "unpack_misses")]
fn py_unpack<'py>(
    py: Python<'py>,
    bytes: &[u8],
    cells: u64,
    layers: u64,
    runs: u64,
) -> PyResult<PyMisses<'py>> {
    let places = places_of(cells, layers, runs)?;
    let (keys, misses) = py.detach(|| unpack(places, bytes)).map_err(PyValueError::new_err)?;
    Ok((keys.into_pyarray(py), misses.into_pyarray(py)))
}

pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(py_pack, m)?)?;
    m.add_function(wrap_pyfunction!(py_unpack, m)?)?;
    Ok(())
}
