//! What the planning cells of a grid are worth: those of a window one by one, those beyond it alike.

/// Cells beyond the window are all worth the same, but for those in the last row and the last column of the grid.
#[derive(Clone, Copy)]
pub struct Worth<'a> {
    pub window: &'a [f32],
    pub window_shape: (usize, usize),
    pub first: (usize, usize), // row and column of the window's first cell
    pub shape: (usize, usize), // of the grid
    pub beyond: [f32; 4],      // inside, in the last column, in the last row, in both
}

impl Worth<'_> {
    /// The worth of a flat cell of the grid.
    #[inline]
    pub fn of(&self, cell: u32) -> f32 {
        let (row, col) = (cell as usize / self.shape.1, cell as usize % self.shape.1);
        let (down, along) = (row.wrapping_sub(self.first.0), col.wrapping_sub(self.first.1));
        if down < self.window_shape.0 && along < self.window_shape.1 {
            return self.window[down * self.window_shape.1 + along];
        }
        self.beyond[2 * usize::from(row + 1 == self.shape.0) + usize::from(col + 1 == self.shape.1)]
    }
}
