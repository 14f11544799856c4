//! Fuse one scan into integer log-odds.

use super::walk::{Lattice, Walk};
use super::Scan;

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
pub fn integrate_scan(
    log_odds: &mut [i8],
    lattice: Lattice,
    scan: Scan,
    gains: Gains,
    nudge: f64,
) -> Vec<i64> {
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
