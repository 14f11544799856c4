//! Searches that look at no more of the grid than they have to: a window about their ends, grown as need be.

use super::metres;
use super::path::path_to;
use super::search::{allowed_moves, connections, Search, UNREACHED};

/// Cells around the ends that a search looks at first, and how many times as many next.
const MARGIN: usize = 48;
const MORE: usize = 4;

/// Lengths from a cell in a window of the grid: those up to the farthest cell that was asked for, or to all.
struct Patch {
    top: usize,
    left: usize,
    cols: usize,
    open: Vec<u8>,
    field: Vec<f32>, // [m], infinite beyond
}

impl Patch {
    fn local(&self, cell: usize, cols: usize) -> usize {
        (cell / cols - self.top) * self.cols + cell % cols - self.left
    }
}

/// Path lengths [m] from the source to each of `targets`, infinity where unreachable.
pub fn lengths_to(open: &[u8], cols: usize, source: usize, targets: &[usize], resolution: f64) -> Vec<f32> {
    let patch = search_near(open, cols, source, targets, resolution);
    targets.iter().map(|&cell| patch.field[patch.local(cell, cols)]).collect()
}

/// The cells of a shortest path from the source to the target; empty if unreachable.
pub fn shortest_path(open: &[u8], cols: usize, source: usize, target: usize, resolution: f64) -> Vec<i64> {
    let patch = search_near(open, cols, source, &[target], resolution);
    let path = path_to(&patch.field, &patch.open, patch.cols, patch.local(target, cols));
    let global = |cell: i64| {
        let (row, col) = (cell as usize / patch.cols + patch.top, cell as usize % patch.cols + patch.left);
        (row * cols + col) as i64
    };
    path.into_iter().map(global).collect()
}

/// Search in ever larger windows until no path that matters can leave the window.
fn search_near(open: &[u8], cols: usize, source: usize, targets: &[usize], resolution: f64) -> Patch {
    let rows = open.len() / cols;
    let mut margin = MARGIN;
    loop {
        let span = |at: fn(usize, usize) -> usize, size: usize| {
            let places = || targets.iter().chain([&source]).map(|&cell| at(cell, cols));
            let (low, high) = (places().min().unwrap_or(0), places().max().unwrap_or(0));
            (low.saturating_sub(margin), (high + margin + 1).min(size))
        };
        let (top, bottom) = span(|cell, cols| cell / cols, rows);
        let (left, right) = span(|cell, cols| cell % cols, cols);
        let lines = (top..bottom).flat_map(|row| &open[row * cols + left..row * cols + right]);
        let mut patch =
            Patch { top, left, cols: right - left, open: lines.copied().collect(), field: Vec::new() };
        let moves = allowed_moves(&patch.open, patch.cols);
        let mut search = Search::new(&moves, patch.cols);
        let from = patch.local(source, cols);
        let ends = targets.iter().map(|&cell| patch.local(cell, cols)).filter(|&cell| patch.open[cell] != 0);
        let left_over = search.want(ends);
        let last = match left_over {
            0 => 0,
            _ => search.run(&connections(&patch.open, patch.cols, from), UNREACHED - 1, left_over),
        };
        let inner_edges = [top > 0, bottom < rows, left > 0, right < cols];
        if !leaves(&search.cost, patch.cols, last, inner_edges) {
            patch.field = metres(&search.cost, from, last, resolution);
            return patch;
        }
        margin *= MORE;
    }
}

/// Whether a path of at most this cost comes to an edge of a window beyond which there is more of the grid.
fn leaves(cost: &[u32], cols: usize, last: u32, [top, bottom, left, right]: [bool; 4]) -> bool {
    let reached = |&cell: &u32| cell <= last;
    let lines = [(top, 0), (bottom, cost.len() - cols)];
    let columns = [(left, 0), (right, cols - 1)];
    lines.iter().any(|&(inner, start)| inner && cost[start..start + cols].iter().any(reached))
        || columns.iter().any(|&(inner, col)| inner && cost.iter().skip(col).step_by(cols).any(reached))
}
