//! Where to look at a frontier from.

use std::collections::BinaryHeap;

use super::FREE;
use crate::planes::Planes;
use crate::shadow::{Corners, Shadows};

/// Members of a cluster that are tried for a viewpoint.
const TRIES: usize = 4;

/// Where a robot can drive.
pub struct Ground<'a> {
    pub field: &'a [f32], // path length from the robot [m], infinite where it cannot stand
    pub source: usize,    // the robot's own cell
    pub resolution: f64,  // [m]
}

/// The clusters that can be looked at, in their order, and from where.
#[derive(Default)]
pub struct Views {
    pub clusters: Vec<i64>,
    pub targets: Vec<i64>, // of those tried, the member nearest the centroid that can be seen
    pub views: Vec<i64>,   // the nearest reachable cell that sees it
    pub horizon: f64,      // no view is missing to which the way is shorter [m]
    pub cut_short: bool,   // the work was done before nobody farther could matter
}

/// The clusters seen from reachable cells at most `reach` cells away: the `most` to whose views the way is shortest.
///
/// The nearest are worked out first, and no more once nobody farther can matter or the `work`, counted in pieces
/// of lines looked at, is done.
pub fn viewpoints(
    ground: &Ground,
    classes: &[u8],
    cols: usize,
    cells: &[i64],
    starts: &[i64],
    reach: i64,
    most: usize,
    work: u64,
) -> Views {
    let rows = classes.len() / cols.max(1);
    let blocked = Planes::of(classes, rows, cols, |class| class != FREE);
    let reachable = Planes::of(ground.field, rows, cols, f32::is_finite);
    let mut shadows = Shadows::new(&blocked, &reachable, reach, Corners::RowsFirst);
    let mut found: BinaryHeap<(u32, usize, usize, usize)> = BinaryHeap::new(); // leg, cluster, target, view
    let (mut horizon, mut cut_short) = (f64::INFINITY, false);
    for (squared, cluster) in nearest_first(ground.source, cols, cells, starts) {
        let at_least = ground.resolution * ((squared as f64).sqrt() - reach as f64 - 1.0);
        let worst =
            found.peek().filter(|_| found.len() == most).map(|&(leg, ..)| f64::from(f32::from_bits(leg)));
        let needless = worst.is_some_and(|worst| at_least > worst);
        if needless || shadows.work >= work {
            horizon = horizon.min(at_least.max(0.0));
            cut_short = !needless;
            break;
        }
        let members = spread(&cells[starts[cluster] as usize..starts[cluster + 1] as usize], cols as i64);
        let seen = members.into_iter().find_map(|target| {
            let view = nearest_view(&mut shadows, &reachable, cols, target as usize, reach)?;
            Some((ground.field[view].to_bits(), cluster, target as usize, view))
            // bits sort as lengths do
        });
        found.extend(seen);
        if found.len() > most {
            let dropped = found.pop().map_or(0, |(leg, ..)| leg);
            horizon = horizon.min(f64::from(f32::from_bits(dropped)));
        }
    }
    let mut found = found.into_vec();
    found.sort_unstable_by_key(|&(_, cluster, ..)| cluster);
    Views {
        clusters: found.iter().map(|&(_, cluster, ..)| cluster as i64).collect(),
        targets: found.iter().map(|&(_, _, target, _)| target as i64).collect(),
        views: found.iter().map(|&(.., view)| view as i64).collect(),
        horizon,
        cut_short,
    }
}

/// The clusters by the squared distance of their nearest member from the source [cells].
fn nearest_first(source: usize, cols: usize, cells: &[i64], starts: &[i64]) -> Vec<(i64, usize)> {
    let (row, col) = ((source / cols.max(1)) as i64, (source % cols.max(1)) as i64);
    let squared = |&cell: &i64| (cell / cols as i64 - row).pow(2) + (cell % cols as i64 - col).pow(2);
    let nearest = |bounds: &[i64]| cells[bounds[0] as usize..bounds[1] as usize].iter().map(squared).min();
    let mut order: Vec<_> = starts.windows(2).filter_map(nearest).zip(0..).collect();
    order.sort_unstable();
    order
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
