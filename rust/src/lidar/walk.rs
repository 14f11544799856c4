//! The cells that a ray crosses, and where along it.

use super::tiled::SIDE;

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
    pub fn flat(&self, row: i64, col: i64) -> Option<usize> {
        // A negative index wraps to a huge one, so two comparisons are enough.
        let inside = (row as u64) < self.rows as u64 && (col as u64) < self.cols as u64;
        inside.then(|| row as usize * self.cols + col as usize)
    }

    /// Number of the tile that holds a cell.
    pub fn tile(&self, row: usize, col: usize) -> usize {
        row / SIDE * self.across() + col / SIDE
    }

    /// Tiles in a row of tiles.
    pub fn across(&self) -> usize {
        self.cols.div_ceil(SIDE)
    }
}

/// The cells that a ray crosses, in order (Amanatides & Woo, 1987); `entry` and `exit` in metres along it.
pub struct Walk {
    pub row: i64,
    pub col: i64,
    pub entry: f64,
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
    pub fn new(resolution: f64, x: f64, y: f64, angle: f64) -> Self {
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
    pub fn exit(&self) -> f64 {
        self.row_exit.min(self.col_exit)
    }

    #[inline]
    pub fn advance(&mut self) {
        // Selects, not branches: which axis comes next is as good as random to the processor.
        let sideways = self.col_exit <= self.row_exit;
        self.entry = self.exit();
        self.col += if sideways { self.col_step } else { 0 };
        self.row += if sideways { 0 } else { self.row_step };
        self.col_exit += if sideways { self.col_delta } else { 0.0 };
        self.row_exit += if sideways { 0.0 } else { self.row_delta };
    }
}
