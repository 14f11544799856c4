//! Fuse a scan whose pose is uncertain: returns spread over a band, free space that ends before it.

use std::f64::consts::{FRAC_PI_2, TAU};

use super::fuse::{Gains, Marks, MISS};
use super::tiled::Tiled;
use super::walk::{Lattice, Walk};
use super::Scan;

/// How uncertain each beam's return is.
#[derive(Clone, Copy)]
pub struct Blur<'a> {
    /// Half width of the band in which each return may lie [m].
    pub margins: &'a [f64],
}

impl Blur<'_> {
    /// Evidence of a return for each cell of its band: what it has in all, spread over the cells across it.
    fn gain(&self, b: usize, hit: i32, resolution: f64) -> i32 {
        let across = (2.0 * self.margins[b] / resolution).max(1.0);
        ((f64::from(hit) / across + 0.5).floor() as i32).max(1)
    }
}

/// A return with its band, and the bearings whose rays the band or its shadow may touch.
struct Return {
    bearing: f64, // in 0..tau
    near: f64,    // metres along the ray at which its band begins
    margin: f64,
    half_angle: f64,
}

/// Metres along a ray between which it is within another return's margin of what lies behind that return.
struct Shadow {
    from: f64,
    to: f64,
}

fn returns(scan: Scan, blur: Blur, nudge: f64) -> Vec<Return> {
    let hits = (0..scan.angles.len()).filter(|&b| scan.hits[b] && blur.margins[b] > 0.0);
    hits.map(|b| {
        let (margin, near) = (blur.margins[b], scan.reach(b, nudge) - blur.margins[b]);
        let half_angle = if near > margin { (margin / near).asin() } else { FRAC_PI_2 };
        Return { bearing: scan.angles[b].rem_euclid(TAU), near, margin, half_angle }
    })
    .collect()
}

fn shadows(returns: &[Return], angle: f64, found: &mut Vec<Shadow>) {
    let bearing = angle.rem_euclid(TAU);
    found.clear();
    for other in returns {
        let apart = (bearing - other.bearing).abs();
        let apart = apart.min(TAU - apart);
        if apart < other.half_angle {
            found.push(Shadow { from: other.near, to: other.margin / apart.sin() });
        }
    }
}

/// Mark as free the cells of a ray whose middle is farther than the margin from every return and its shadow.
fn trace_free(marks: &mut Marks, scan: Scan, b: usize, resolution: f64, limit: f64, shadows: &[Shadow]) {
    let mut walk = Walk::new(resolution, scan.x, scan.y, scan.angles[b]);
    let mut entered = false;
    while walk.entry <= limit {
        let (row, col, exit) = (walk.row, walk.col, walk.exit());
        let middle = 0.5 * (walk.entry + exit);
        walk.advance();
        if !marks.covers(row, col) {
            if entered {
                return; // the grid is convex: a ray that left it does not come back
            }
            continue;
        }
        entered = true;
        let last = exit > limit && !scan.hits[b]; // where a ray without a return ends
        let shaded = shadows.iter().any(|shadow| middle > shadow.from && middle < shadow.to);
        if (middle <= limit || last) && !shaded {
            marks.put(row, col, MISS);
        }
    }
}

/// Mark the cell of a return, and those whose centre is within its margin.
fn stamp(marks: &mut Marks, scan: Scan, b: usize, resolution: f64, reach: f64, margin: f64, mark: u16) {
    let (sin, cos) = scan.angles[b].sin_cos();
    let (x, y) = ((scan.x + reach * cos) / resolution, (scan.y + reach * sin) / resolution);
    let radius = margin / resolution;
    let cells = |centre: f64| (centre - radius - 0.5).ceil() as i64..=(centre + radius - 0.5).floor() as i64;
    for row in cells(y) {
        for col in cells(x) {
            let (up, right) = (row as f64 + 0.5 - y, col as f64 + 0.5 - x);
            if up * up + right * right <= radius * radius {
                marks.put(row, col, mark);
            }
        }
    }
    marks.put(y.floor() as i64, x.floor() as i64, mark);
}

/// Fuse one scan from an uncertain pose; return the sorted cells whose class changed, or missing tiles.
///
/// A cell that was known stays known: evidence that cancels leaves it at the last step's side of 0.
pub fn integrate_blurred_scan(
    log_odds: &mut Tiled<&mut [i8]>,
    lattice: Lattice,
    scan: Scan,
    blur: Blur,
    gains: Gains,
    nudge: f64,
) -> Result<Vec<i64>, Vec<i64>> {
    let widest = blur.margins.iter().copied().fold(0.0, f64::max);
    let mut marks = Marks::around(scan, lattice, nudge, widest);
    let (returns, mut found) = (returns(scan, blur, nudge), Vec::new());
    for b in 0..scan.angles.len() {
        shadows(&returns, scan.angles[b], &mut found);
        let reach = scan.reach(b, nudge);
        let limit = if scan.hits[b] { reach - blur.margins[b] } else { reach };
        trace_free(&mut marks, scan, b, lattice.resolution, limit, &found);
        if scan.hits[b] {
            let mark = MISS + blur.gain(b, gains.hit, lattice.resolution) as u16;
            stamp(&mut marks, scan, b, lattice.resolution, reach, blur.margins[b], mark);
        }
    }
    marks.set_sensor(scan, lattice.resolution);
    marks.apply(log_odds, lattice, |mark, old| {
        let step = if mark == MISS { -gains.miss } else { i32::from(mark - MISS) };
        let new = (old + step).clamp(-gains.clamp, gains.clamp);
        if new == 0 {
            step.signum()
        } else {
            new
        }
    })
}
