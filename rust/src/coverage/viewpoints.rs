//! Where to look at a frontier from.

use super::FREE;
use crate::planes::Planes;
use crate::shadow::{Corners, Shadows};

/// Members of a cluster that are tried for a viewpoint.
const TRIES: usize = 4;

/// For each cluster: its representative, the member nearest the centroid of those tried that can be seen,
/// and the nearest reachable cell, at most `reach` cells away, that sees it; -1 where there is none.
pub fn viewpoints(
    field: &[f32],
    classes: &[u8],
    rows: usize,
    cols: usize,
    cells: &[i64],
    starts: &[i64],
    reach: i64,
) -> (Vec<i64>, Vec<i64>) {
    let blocked = Planes::of(classes, rows, cols, |class| class != FREE);
    let reachable = Planes::of(field, rows, cols, f32::is_finite);
    let mut shadows = Shadows::new(&blocked, &reachable, reach, Corners::RowsFirst);
    let mut representatives = Vec::with_capacity(starts.len());
    let mut views = Vec::with_capacity(starts.len());
    for bounds in starts.windows(2) {
        let members = spread(&cells[bounds[0] as usize..bounds[1] as usize], cols as i64);
        let seen = members.iter().find_map(|&member| {
            let view = nearest_view(&mut shadows, &reachable, cols, member as usize, reach);
            view.map(|view| (member, view as i64))
        });
        let (representative, view) = seen.unwrap_or((members[0], -1));
        representatives.push(representative);
        views.push(view);
    }
    (representatives, views)
}

/// The member of a cluster nearest its centroid, then those farthest from all before, so that one of them is
/// seen if the cluster is.
fn spread(members: &[i64], cols: i64) -> Vec<i64> {
    let n = members.len() as i64;
    let (row_sum, col_sum) = members.iter().fold((0, 0), |(r, c), &m| (r + m / cols, c + m % cols));
    let from_centroid = |&&m: &&i64| {
        let (dr, dc) = (n * (m / cols) - row_sum, n * (m % cols) - col_sum);
        (dr * dr + dc * dc, m)
    };
    let mut chosen = vec![*members.iter().min_by_key(from_centroid).expect("a cluster has members")];
    while chosen.len() < TRIES.min(members.len()) {
        let apart = |m: i64| {
            let squared = |&k: &i64| (k / cols - m / cols).pow(2) + (k % cols - m % cols).pow(2);
            chosen.iter().map(squared).min()
        };
        chosen.push(*members.iter().max_by_key(|&&m| (apart(m), -m)).expect("a cluster has members"));
    }
    chosen
}

/// The reachable cell nearest the target that sees it, at most `reach` cells away: of those as near, the one in
/// the nearest ring about the target, then the first.
fn nearest_view(
    shadows: &mut Shadows,
    reachable: &Planes,
    cols: usize,
    target: usize,
    reach: i64,
) -> Option<usize> {
    let (row, col) = (target / cols, target % cols);
    if reachable.rows.holds(row, col) {
        return Some(target);
    }
    shadows.begin(row, col);
    let mut best = (reach * reach + 1, usize::MAX); // squared distance, cell
    for ring in 1.. {
        let nearer = best.0 - 1 - ring * ring; // squared, of the steps sideways to anything better
        let any_open = nearer >= 0
            && shadows.advance(ring, nearer.isqrt(), |side, cell| {
                best = best.min((ring * ring + side * side, cell));
            });
        if !any_open {
            break;
        }
    }
    (best.1 < usize::MAX).then_some(best.1)
}
