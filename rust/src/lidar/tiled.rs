//! A grid kept by tiles of 32 x 32 cells: where a tile's cells are, and all cells.

use std::ops::Deref;

pub const SIDE: usize = 32;
const CELLS: usize = SIDE * SIDE;

/// `slots` says for each tile where its cells are in `blocks`; slot 0 is the blank tile, which holds zeros.
pub struct Tiled<'a, B> {
    pub slots: &'a [i32],
    pub across: usize, // tiles in a row of tiles
    pub blocks: B,
}

impl<B: Deref<Target = [i8]>> Tiled<'_, B> {
    /// Index of a cell of the grid in `blocks`, or `None` if its tile has no cells.
    #[inline]
    pub fn at(&self, row: usize, col: usize) -> Option<usize> {
        let slot = self.slots[row / SIDE * self.across + col / SIDE] as usize;
        (slot > 0).then(|| slot * CELLS + row % SIDE * SIDE + col % SIDE)
    }

    /// A cell of the grid; 0 if its tile has no cells.
    #[inline]
    pub fn get(&self, row: usize, col: usize) -> i8 {
        self.at(row, col).map_or(0, |at| self.blocks[at])
    }
}
