//! How wide a berth each cell gives what is known to be occupied.

use super::OCCUPIED;

/// Chebyshev distance of each cell from the nearest occupied one, in steps of so many cells, from 0 for those beside
/// it up to `most`, which holds beyond.
pub fn berths(classes: &[u8], rows: usize, cols: usize, step: usize, most: u8) -> Vec<u8> {
    let wide = cols + 2;
    let far = most as usize * step + 1; // cells away, from which on it is `most`
    let mut away = vec![far; (rows + 2) * wide]; // in a cell of padding
    for row in 0..rows {
        for col in 0..cols {
            let at = (row + 1) * wide + col + 1;
            let above = away[at - wide - 1].min(away[at - wide]).min(away[at - wide + 1]);
            let before = above.min(away[at - 1]) + 1;
            away[at] = if classes[row * cols + col] == OCCUPIED { 0 } else { before.min(far) };
        }
    }
    let mut berths = vec![0; rows * cols];
    for row in (0..rows).rev() {
        for col in (0..cols).rev() {
            let at = (row + 1) * wide + col + 1;
            let below = away[at + wide - 1].min(away[at + wide]).min(away[at + wide + 1]);
            away[at] = away[at].min(below.min(away[at + 1]) + 1);
            berths[row * cols + col] = (away[at].saturating_sub(1) / step) as u8;
        }
    }
    berths
}
