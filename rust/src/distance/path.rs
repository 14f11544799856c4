//! Paths: down a distance field, then straightened.

use super::search::{CONNECTION, MOVES};
use crate::visibility::segment_clear;

/// The neighbour to which the field falls most steeply, if it falls to any.
fn downhill(field: &[f32], open: &[u8], cols: usize, cell: usize) -> Option<usize> {
    let rows = (open.len() / cols) as i64;
    let (row, col) = ((cell / cols) as i64, (cell % cols) as i64);
    let mut best = (0.0, None);
    for (d, (row_step, col_step)) in MOVES.into_iter().enumerate() {
        let (r, c) = (row + row_step, col + col_step);
        if r < 0 || r >= rows || c < 0 || c >= cols as i64 {
            continue;
        }
        let at = |r: i64, c: i64| (r * cols as i64 + c) as usize;
        let next = at(r, c);
        let passable = open[next] != 0 && (d % 2 == 0 || (open[at(row, c)] != 0 && open[at(r, col)] != 0));
        let length = if d % 2 == 1 { std::f64::consts::SQRT_2 } else { 1.0 };
        let slope = (f64::from(field[cell]) - f64::from(field[next])) / length;
        if passable && slope > best.0 {
            best = (slope, Some(next));
        }
    }
    best.1
}

/// The field's source beside a cell where no neighbour is lower: a source that is itself not traversable.
fn nearby_source(field: &[f32], cols: usize, cell: usize) -> Option<usize> {
    let rows = (field.len() / cols) as i64;
    let (row, col) = ((cell / cols) as i64, (cell % cols) as i64);
    let rows = (row - CONNECTION).max(0)..=(row + CONNECTION).min(rows - 1);
    let mut cells = rows.flat_map(|r| {
        ((col - CONNECTION).max(0)..=(col + CONNECTION).min(cols as i64 - 1))
            .map(move |c| (r * cols as i64 + c) as usize)
    });
    cells.find(|&other| field[other] == 0.0)
}

/// The path from the field's source to the target, by steepest descent from the target; empty if unreachable.
pub fn path_to(field: &[f32], open: &[u8], cols: usize, target: usize) -> Vec<i64> {
    if !field[target].is_finite() {
        return Vec::new();
    }
    let mut path = vec![target as i64];
    let mut cell = target;
    while field[cell] > 0.0 {
        let next = downhill(field, open, cols, cell).or_else(|| nearby_source(field, cols, cell));
        let Some(next) = next else { return Vec::new() };
        path.push(next as i64);
        cell = next;
    }
    path.reverse();
    path
}

/// Drop the cells of a path that straight lines over traversable cells make needless; keeps its ends.
pub fn shortcut(open: &[u8], cols: usize, path: &[usize]) -> Vec<i64> {
    let clear = |from: usize, to: usize| {
        open[from] != 0 && open[to] != 0 && segment_clear(cols, from, to, |cell| open[cell] != 0)
    };
    let mut kept: Vec<i64> = path.first().map(|&cell| cell as i64).into_iter().collect();
    let mut anchor = 0;
    for i in 2..path.len() {
        if !clear(path[anchor], path[i]) {
            anchor = i - 1;
            kept.push(path[anchor] as i64);
        }
    }
    kept.extend(path.get(1..).and_then(<[usize]>::last).map(|&cell| cell as i64));
    kept
}
