//! Fuse one scan into integer log-odds.

use super::tiled::Tiled;
use super::walk::{Lattice, Walk};
use super::Scan;

pub const MISS: u16 = 1;
const HIT: u16 = 2;

/// What one scan says of each cell that it touched: the part of the grid in its reach, and the touched cells.
pub struct Marks {
    first_row: i64,
    first_col: i64,
    rows: usize,
    cols: usize,
    marks: Vec<u16>,
    touched: Vec<u32>,
}

impl Marks {
    /// Nothing yet, in the part of the grid within the scan's reach and `more` metres.
    pub fn around(scan: Scan, lattice: Lattice, nudge: f64, more: f64) -> Self {
        let reach = (0..scan.angles.len()).map(|b| scan.reach(b, nudge)).fold(0.0, f64::max) + more;
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

    /// Tell whether a cell is in the part of the grid.
    #[inline]
    pub fn covers(&self, row: i64, col: i64) -> bool {
        ((row - self.first_row) as u64) < self.rows as u64
            && ((col - self.first_col) as u64) < self.cols as u64
    }

    /// Record a mark, the stronger one where a cell gets several; false outside the grid.
    #[inline]
    pub fn put(&mut self, row: i64, col: i64, mark: u16) -> bool {
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

    /// The sensor stands in a free cell, whatever the beams say.
    pub fn set_sensor(&mut self, scan: Scan, resolution: f64) {
        if scan.angles.is_empty() {
            return;
        }
        let cell = |position: f64| (position / resolution).floor() as i64;
        let (row, col) = (cell(scan.y), cell(scan.x));
        if self.put(row, col, MISS) {
            let cell = (row - self.first_row) as usize * self.cols + (col - self.first_col) as usize;
            self.marks[cell] = MISS;
        }
    }

    /// The tiles that hold touched cells and have no cells yet, increasing.
    pub fn missing(&self, lattice: Lattice, log_odds: &Tiled<&mut [i8]>) -> Vec<i64> {
        let mut tiles: Vec<i64> = self
            .touched
            .iter()
            .map(|&local| self.cell(local))
            .filter(|&(row, col)| log_odds.at(row, col).is_none())
            .map(|(row, col)| lattice.tile(row, col) as i64)
            .collect();
        tiles.sort_unstable();
        tiles.dedup();
        tiles
    }

    /// Row and column in the whole grid.
    fn cell(&self, local: u32) -> (usize, usize) {
        let (row, col) = (local as usize / self.cols, local as usize % self.cols);
        (row + self.first_row as usize, col + self.first_col as usize)
    }

    /// Turn each touched cell's old log-odds into new ones; return the sorted cells whose class changed.
    ///
    /// Or, with nothing changed, the tiles that are missing.
    #[inline]
    pub fn apply(
        &self,
        log_odds: &mut Tiled<&mut [i8]>,
        lattice: Lattice,
        new: impl Fn(u16, i32) -> i32,
    ) -> Result<Vec<i64>, Vec<i64>> {
        let missing = self.missing(lattice, log_odds);
        if !missing.is_empty() {
            return Err(missing);
        }
        let mut changed = Vec::new();
        for &local in &self.touched {
            let (row, col) = self.cell(local);
            let Some(at) = log_odds.at(row, col) else { continue };
            let cell = &mut log_odds.blocks[at];
            let old = *cell;
            *cell = new(self.marks[local as usize], i32::from(old)) as i8;
            if cell.signum() != old.signum() {
                changed.push((row * lattice.cols + col) as i64);
            }
        }
        changed.sort_unstable();
        Ok(changed)
    }
}

/// Steps of the log-odds, and the value they saturate at.
#[derive(Clone, Copy)]
pub struct Gains {
    pub hit: i32,
    pub miss: i32,
    pub clamp: i32,
}

/// Fuse one scan into integer log-odds; return the sorted cells whose class (sign) changed, or missing tiles.
pub fn integrate_scan(
    log_odds: &mut Tiled<&mut [i8]>,
    lattice: Lattice,
    scan: Scan,
    gains: Gains,
    nudge: f64,
) -> Result<Vec<i64>, Vec<i64>> {
    let mut marks = Marks::around(scan, lattice, nudge, 0.0);
    for b in 0..scan.angles.len() {
        marks.trace(scan, b, lattice.resolution, nudge);
    }
    marks.set_sensor(scan, lattice.resolution);
    marks.apply(log_odds, lattice, |mark, old| {
        let step = if mark == HIT { gains.hit } else { -gains.miss };
        (old + step).clamp(-gains.clamp, gains.clamp)
    })
}
