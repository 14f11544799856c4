//! Sparse log-misses as bytes and back: runs of equal ones, layer by layer, under prefix codes.
//!
//! A place is `layer * cells + cell`. A run is places in a row, of one layer, with one log-miss; it is told by the gap before it, its
//! length less one, and the log-miss. Gaps and lengths are told by how many bits they have, and those below the
//! highest. The bits: the number of runs (32), the tables of the three codes, and run by run the three.

mod bits;
mod code;

use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use bits::{Reader, Writer};
use code::{Code, Table};

const OUTSIDE: &str = "impact has a cell outside the map or an empty entry";
const CUT: &str = "impact is cut short or too large";
/// Bits that a gap or a length can have, none included.
const SIZES: usize = 33;
const MISSES: usize = 256;

/// Cells and layers of a grid, and how many entries an impact can have.
#[derive(Clone, Copy)]
pub struct Places {
    pub cells: u64,
    pub layers: u64,
    pub most: u64,
}

impl Places {
    fn count(&self) -> u64 {
        self.cells * self.layers
    }
}

/// Places in a row with one log-miss.
struct Run {
    gap: u32,  // places since the run before
    more: u32, // places beside the first
    miss: u8,
}

/// The bytes of an impact; an error for a key that is no cell and layer of the grid.
pub fn pack(places: Places, keys: &[u32], misses: &[u8]) -> Result<Vec<u8>, &'static str> {
    let runs = runs_of(places, keys, misses)?;
    let mut counts = ([0; SIZES], [0; SIZES], [0; MISSES]);
    for run in &runs {
        counts.0[size(run.gap) as usize] += 1;
        counts.1[size(run.more) as usize] += 1;
        counts.2[run.miss as usize] += 1;
    }
    let mut stream = Writer::default();
    stream.put(runs.len() as u32, 32);
    if runs.is_empty() {
        return Ok(stream.finish());
    }
    let gaps = Code::write(&counts.0, &mut stream);
    let lengths = Code::write(&counts.1, &mut stream);
    let levels = Code::write(&counts.2, &mut stream);
    for run in &runs {
        put_number(&gaps, run.gap, &mut stream);
        put_number(&lengths, run.more, &mut stream);
        levels.put(run.miss as usize, &mut stream);
    }
    Ok(stream.finish())
}

/// The keys, ascending, and log-misses of an impact of these bytes; an error says what is wrong with them.
pub fn unpack(places: Places, bytes: &[u8]) -> Result<(Vec<u32>, Vec<u8>), &'static str> {
    let mut stream = Reader::new(bytes);
    let runs = stream.take(32);
    if stream.past_end() {
        return Err(CUT);
    }
    let mut found = Vec::new();
    if runs > 0 {
        let mut table = |symbols| Table::read(symbols, &mut stream).ok_or_else(|| fault(&stream));
        let (gaps, lengths, levels) = (table(SIZES)?, table(SIZES)?, table(MISSES)?);
        let (mut layer, mut cell, mut total) = (0, 0, 0);
        for _ in 0..runs {
            cell += u64::from(take_number(&gaps, &mut stream));
            let mut length = u64::from(take_number(&lengths, &mut stream)) + 1;
            let miss = levels.take(&mut stream) as u8;
            total += length;
            if stream.past_end() || total > places.most {
                return Err(CUT);
            }
            if layer * places.cells + cell + length > places.count() || miss == 0 {
                return Err(OUTSIDE);
            }
            while length > 0 {
                if cell >= places.cells {
                    (layer, cell) = (layer + cell / places.cells, cell % places.cells);
                }
                let here = length.min(places.cells - cell);
                found.push((layer as u32, cell as u32, (cell + here) as u32 - 1, miss));
                (cell, length) = (cell + here, length - here);
            }
        }
    }
    if !stream.at_end() {
        return Err(CUT);
    }
    Ok(by_key(places.layers, &found))
}

/// What is wrong with a stream whose table is none.
fn fault(stream: &Reader) -> &'static str {
    match stream.past_end() {
        true => CUT,
        false => "impact has a table of no code",
    }
}

/// The runs of an impact, by place.
fn runs_of(places: Places, keys: &[u32], misses: &[u8]) -> Result<Vec<Run>, &'static str> {
    let layers = places.layers as u32;
    let mut by_layer = vec![Vec::<(u32, u32, u8)>::new(); layers as usize]; // first cell, end, log-miss
    let (mut cell, mut first) = (0, 0); // of the entry before, and the first key of that cell
    for (&key, &miss) in keys.iter().zip(misses) {
        if key.wrapping_sub(first) >= layers {
            cell = key / layers;
            first = cell * layers;
        }
        if u64::from(cell) >= places.cells {
            return Err(OUTSIDE);
        }
        let layer = &mut by_layer[(key - first) as usize];
        match layer.last_mut() {
            Some((_, end, same)) if *end == cell && *same == miss => *end += 1,
            _ => layer.push((cell, cell + 1, miss)),
        }
    }
    let mut runs = Vec::with_capacity(by_layer.iter().map(Vec::len).sum());
    let mut last = 0; // place after the run before
    for (layer, part) in by_layer.iter().enumerate() {
        let start = layer as u64 * places.cells;
        for &(first, end, miss) in part {
            runs.push(Run { gap: (start + u64::from(first) - last) as u32, more: end - first - 1, miss });
            last = start + u64::from(end);
        }
    }
    Ok(runs)
}

/// How many bits a number has.
fn size(number: u32) -> u32 {
    u32::BITS - number.leading_zeros()
}

fn put_number(code: &Code, number: u32, stream: &mut Writer) {
    let size = size(number);
    code.put(size as usize, stream);
    if size > 1 {
        stream.put(number - (1 << (size - 1)), size - 1);
    }
}

fn take_number(table: &Table, stream: &mut Reader) -> u32 {
    match table.take(stream) as u32 {
        0 => 0,
        size => (1 << (size - 1)) + stream.take(size - 1),
    }
}

/// Keys, ascending, and log-misses of runs that are given by layer, first and last cell.
fn by_key(layers: u64, runs: &[(u32, u32, u32, u8)]) -> (Vec<u32>, Vec<u8>) {
    let lowest = runs.iter().map(|run| run.1).min().unwrap_or(0);
    let highest = runs.iter().map(|run| run.2).max().unwrap_or(0);
    // How many more entries each cell has than the one before; then where its next entry goes.
    let mut next = vec![0_u32; (highest - lowest) as usize + 2];
    for &(_, first, last, _) in runs {
        let at = &mut next[(first - lowest) as usize];
        *at = at.wrapping_add(1);
        let at = &mut next[(last - lowest) as usize + 1];
        *at = at.wrapping_sub(1);
    }
    let (mut here, mut total) = (0_u32, 0_u32);
    for next in &mut next {
        here = here.wrapping_add(*next);
        *next = total;
        total += here;
    }
    let (mut keys, mut misses) = (vec![0; total as usize], vec![0; total as usize]);
    for &(layer, first, last, miss) in runs {
        for (cell, next) in (first..=last).zip(&mut next[(first - lowest) as usize..]) {
            keys[*next as usize] = cell * layers as u32 + layer;
            misses[*next as usize] = miss;
            *next += 1;
        }
    }
    (keys, misses)
}

fn places_of(cells: u64, layers: u64, most: u64) -> PyResult<Places> {
    if cells == 0 || layers == 0 || cells.checked_mul(layers).is_none_or(|all| all > 1 << 32) {
        return Err(PyValueError::new_err("a grid has cells and layers, and at most 2^32 places"));
    }
    Ok(Places { cells, layers, most })
}

#[pyfunction(name = "pack_misses")]
fn py_pack<'py>(
    py: Python<'py>,
    keys: PyReadonlyArray1<'py, u32>,
    misses: PyReadonlyArray1<'py, u8>,
    cells: u64,
    layers: u64,
) -> PyResult<Bound<'py, PyBytes>> {
    let (places, keys, misses) = (places_of(cells, layers, u64::MAX)?, keys.as_slice()?, misses.as_slice()?);
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
    most: u64,
) -> PyResult<PyMisses<'py>> {
    let places = places_of(cells, layers, most)?;
    let (keys, misses) = py.detach(|| unpack(places, bytes)).map_err(PyValueError::new_err)?;
    Ok((keys.into_pyarray(py), misses.into_pyarray(py)))
}

pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(py_pack, m)?)?;
    m.add_function(wrap_pyfunction!(py_unpack, m)?)?;
    Ok(())
}
