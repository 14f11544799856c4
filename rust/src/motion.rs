//! Local motion of disc robots: the distance to walls, and the choice of the next velocity.
//!
//! `steer` rolls out a small family of path followers (sideways offset, speed, look-ahead) and returns the first
//! command of the cheapest one. All costs are seconds, so that progress, turning and courtesy trade off openly.

mod remaining;

use numpy::{
    IntoPyArray, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyReadwriteArray2,
    PyUntypedArrayMethods,
};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use remaining::remaining;

/// Steps of a roll-out.
const STEPS: usize = 20;
/// The least clearance to other discs that is ever commanded [m].
const DISC_GUARD: f64 = 0.05;
/// Sideways offsets from the path [m], left positive; speeds as shares of the top speed.
const OFFSETS: [f64; 11] = [0.0, -0.1, 0.1, -0.2, 0.2, -0.35, 0.35, -0.5, 0.5, -0.7, 0.7];
const SPEEDS: [f64; 3] = [1.0, 0.6, 0.25];
/// Look-ahead along the path [m]: the first is the usual one, the second follows sharp corners.
const LOOKS: [f64; 2] = [0.4, 0.15];
/// Over this last stretch offsets fade, so that every follower ends at the path's end [m].
const FADE: f64 = 0.2;
/// Costs [s/m], [s], [s per step].
const COST_LATERAL: f64 = 0.4;
const COST_CHANGE: f64 = 0.2;
const COST_CLOSE: f64 = 0.5;
const COST_WRONG_SIDE: f64 = 0.2;
const COST_OUTSIDE: f64 = 0.3;
const COST_BACK: f64 = 0.5;
/// Full speed below this heading error, none above that one [rad].
const ALIGNED: f64 = 0.35;
const ASKEW: f64 = 1.3;
/// A command this near to the least conceivable cost is taken without looking further [s].
const SATISFIED: f64 = 0.1;
/// How far beyond the guard walls are looked for, to look less often [m].
const WALL_LOOK: f64 = 0.3;
/// Tolerance of "does not get worse" [m].
const SLACK: f64 = 1e-9;

/// A boolean grid, row 0 at the lowest y; a window of one that begins at the origin, false beside it.
#[derive(Clone, Copy)]
pub struct Grid<'a> {
    pub cells: &'a [bool],
    pub rows: usize,
    pub cols: usize,
    pub resolution: f64,
    pub first: (i64, i64), // row and column of the window's first cell
}

impl Grid<'_> {
    fn at(&self, x: f64, y: f64) -> bool {
        let (row, col) = ((y / self.resolution).floor() as i64, (x / self.resolution).floor() as i64);
        let (row, col) = ((row - self.first.0) as u64, (col - self.first.1) as u64); // negative ones get huge
        row < self.rows as u64
            && col < self.cols as u64
            && self.cells[row as usize * self.cols + col as usize]
    }
}

/// Distance [m] from a point to the nearest true cell's square, capped at `reach`; outside the grid is true.
pub fn clearance(solid: Grid, x: f64, y: f64, reach: f64) -> f64 {
    let r = solid.resolution;
    let (width, height) = (solid.cols as f64 * r, solid.rows as f64 * r);
    let border = x.min(y).min(width - x).min(height - y).max(0.0);
    let mut best = border.min(reach) * border.min(reach);
    let low = |v: f64| ((v - reach) / r).floor().max(0.0) as usize;
    let high = |v: f64, n: usize| (((v + reach) / r).floor() + 1.0).clamp(0.0, n as f64) as usize;
    for row in low(y)..high(y, solid.rows) {
        let dy = (row as f64 * r - y).max(y - (row + 1) as f64 * r).max(0.0);
        if dy * dy >= best {
            continue;
        }
        for col in low(x)..high(x, solid.cols) {
            if solid.cells[row * solid.cols + col] {
                let dx = (col as f64 * r - x).max(x - (col + 1) as f64 * r).max(0.0);
                best = best.min(dx * dx + dy * dy);
            }
        }
    }
    best.sqrt()
}

/// Clear the cells whose centre lies in a disc `x, y, r` [m].
pub fn block_discs(free: &mut [bool], cols: usize, resolution: f64, discs: &[f64]) {
    if cols == 0 {
        return;
    }
    let rows = free.len() / cols;
    let cells = |low: f64, high: f64, count: usize| {
        let first = (low / resolution - 0.5).floor().clamp(0.0, count as f64) as usize;
        first..((high / resolution + 0.5).ceil().clamp(first as f64, count as f64) as usize)
    };
    for disc in discs.chunks_exact(3) {
        let (x, y, r) = (disc[0], disc[1], disc[2]);
        for row in cells(y - r, y + r, rows) {
            let dy = (row as f64 + 0.5) * resolution - y;
            for col in cells(x - r, x + r, cols) {
                let dx = (col as f64 + 0.5) * resolution - x;
                free[row * cols + col] &= dx * dx + dy * dy >= r * r;
            }
        }
    }
}

/// A polyline with its arc length at each vertex.
#[derive(Clone, Copy)]
pub struct Path<'a> {
    pub xy: &'a [f64],
    pub arc: &'a [f64],
}

impl Path<'_> {
    fn length(&self) -> f64 {
        self.arc[self.arc.len() - 1]
    }

    fn segment(&self, s: f64) -> usize {
        let after = self.arc.partition_point(|&a| a <= s);
        after.clamp(1, self.arc.len() - 1) - 1
    }

    /// Point and unit direction at arc length `s`: `(x, y, tx, ty)`.
    fn at(&self, s: f64) -> (f64, f64, f64, f64) {
        let i = self.segment(s);
        let span = self.arc[i + 1] - self.arc[i];
        let (x, y) = (self.xy[2 * i], self.xy[2 * i + 1]);
        let (tx, ty) = ((self.xy[2 * i + 2] - x) / span, (self.xy[2 * i + 3] - y) / span);
        let along = (s - self.arc[i]).clamp(0.0, span);
        (x + along * tx, y + along * ty, tx, ty)
    }

    /// Arc length of the point nearest to `(x, y)` among arc lengths `from..=to`, and its distance.
    fn project(&self, x: f64, y: f64, from: f64, to: f64) -> (f64, f64) {
        let (from, to) = (from.max(0.0), to.min(self.length()));
        let mut best = (from, f64::INFINITY);
        for i in self.segment(from)..self.arc.len() - 1 {
            if self.arc[i] > to {
                break;
            }
            let span = self.arc[i + 1] - self.arc[i];
            let (ax, ay) = (self.xy[2 * i], self.xy[2 * i + 1]);
            let (tx, ty) = ((self.xy[2 * i + 2] - ax) / span, (self.xy[2 * i + 3] - ay) / span);
            let along = ((x - ax) * tx + (y - ay) * ty)
                .clamp((from - self.arc[i]).max(0.0), (to - self.arc[i]).min(span));
            let (dx, dy) = (x - ax - along * tx, y - ay - along * ty);
            let distance = norm(dx, dy);
            if distance < best.1 {
                best = (self.arc[i] + along, distance);
            }
        }
        best
    }
}

/// One robot's limits: radius [m], top speed [m/s], top turn rate [rad/s], control period [s], and
/// the least clearance to walls that is ever commanded [m].
#[derive(Clone, Copy)]
pub struct Limits {
    pub radius: f64,
    pub speed: f64,
    pub turn_rate: f64,
    pub period: f64,
    pub guard: f64,
}

/// A follower of the path: `offset` [m] to its left, `speed` [m/s], `look` [m] ahead.
#[derive(Clone, Copy)]
struct Follower {
    offset: f64,
    speed: f64,
    look: f64,
}

/// What a robot steers by.
#[derive(Clone, Copy)]
pub struct Scene<'a> {
    pub solid: Grid<'a>,
    pub traversable: Grid<'a>,
    pub path: Path<'a>,
    /// Rows `x, y, vx, vy, radius, courtesy`: the others, and the gap one would rather keep to them [m].
    pub others: &'a [f64],
    pub limits: Limits,
    /// How fast it has just turned on the spot [rad/s]; 0 if it moved.
    pub turning: f64,
}

#[derive(Clone, Copy)]
pub struct Command {
    pub speed: f64,
    pub turn: f64,
    pub arc: f64,
    pub offset: f64,
    pub cost: f64,
}

fn norm(x: f64, y: f64) -> f64 {
    (x * x + y * y).sqrt()
}

fn wrap(angle: f64) -> f64 {
    angle.sin().atan2(angle.cos())
}

impl Scene<'_> {
    /// Velocity of a follower at a pose: `(speed, turn, heading error)`.
    fn follow(&self, f: Follower, pose: (f64, f64, f64), s: f64) -> (f64, f64, f64) {
        let total = self.path.length();
        let ahead = (s + f.look).min(total);
        let (px, py, tx, ty) = self.path.at(ahead);
        let offset = f.offset * ((total - ahead) / FADE).min(1.0);
        let (dx, dy) = (px - offset * ty - pose.0, py + offset * tx - pose.1);
        let distance = norm(dx, dy);
        if distance < 1e-6 {
            return (0.0, 0.0, 0.0);
        }
        let error = wrap(dy.atan2(dx) - pose.2);
        let l = self.limits;
        let turn = (error / l.period).clamp(-l.turn_rate, l.turn_rate);
        let aligned = ((error.cos() - ASKEW.cos()) / (ALIGNED.cos() - ASKEW.cos())).clamp(0.0, 1.0);
        let stop = if ahead >= total { distance / l.period } else { f64::INFINITY };
        ((f.speed * aligned).min(stop), turn, error)
    }

    /// Least gap to another disc at time `t` from a point, and whether the step keeps the guard (or does not close in).
    fn gap(&self, from: (f64, f64), to: (f64, f64), step: usize) -> (bool, f64, f64) {
        let (mut free, mut close, mut wrong) = (true, 0.0f64, 0.0f64);
        let t = step as f64 * self.limits.period;
        for o in self.others.chunks_exact(6) {
            let reach = self.limits.radius + o[4];
            let gap = |p: (f64, f64), t: f64| norm(p.0 - o[0] - t * o[2], p.1 - o[1] - t * o[3]) - reach;
            // The first step is judged against where the other is: it may stay there.
            let (before, after) = if step == 1 {
                (gap(from, 0.0), gap(to, 0.0))
            } else {
                (gap(from, t - self.limits.period), gap(to, t))
            };
            if after < DISC_GUARD && after < before + SLACK {
                free = false;
            }
            let near = ((o[5] - after) / o[5]).max(0.0);
            if near > close {
                close = near;
                let (mx, my) = (to.0 - from.0, to.1 - from.1);
                let (rx, ry) = (o[0] + t * o[2] - to.0, o[1] + t * o[3] - to.1);
                let head_on = mx * o[2] + my * o[3] < -0.5 * norm(mx, my) * norm(o[2], o[3]);
                wrong = if head_on && mx * ry - my * rx < 0.0 { 1.0 } else { 0.0 };
            }
        }
        (free, close, wrong)
    }

    /// Roll a follower out and price it [s]; infinity as soon as it must cost more than `enough`.
    fn price(&self, f: Follower, start: (f64, f64, f64), s: f64, last_offset: f64, enough: f64) -> Command {
        let l = self.limits;
        let (mut x, mut y, mut heading, mut s) = (start.0, start.1, start.2, s);
        let mut command = Command { speed: 0.0, turn: 0.0, arc: s, offset: f.offset, cost: 0.0 };
        let (mut close, mut wrong) = (0.0f64, 0.0f64);
        let mut was_outside = !self.traversable.at(x, y);
        let (mut outside, mut error) = (0usize, 0.0);
        let keep = l.radius + l.guard;
        // A lower bound of the clearance, exact where it matters: moving by d takes at most d away.
        let mut wall = clearance(self.solid, x, y, keep + WALL_LOOK);
        let mut fixed = COST_CHANGE * (f.offset - last_offset).abs();
        for step in 1..=STEPS {
            let (v, w, e) = self.follow(f, (x, y, heading), s);
            let middle = heading + 0.5 * w * l.period;
            let (nx, ny) = (x + v * l.period * middle.cos(), y + v * l.period * middle.sin());
            error = e;
            if step == 1 {
                command.turn = w;
                if w.abs() >= l.turn_rate && w * self.turning < 0.0 {
                    fixed += COST_BACK;
                }
            }
            let is_outside = !self.traversable.at(nx, ny);
            let (free, near, side) = self.gap((x, y), (nx, ny), step);
            let mut go = free && (was_outside || !is_outside);
            if go && wall - v * l.period < keep {
                let next = clearance(self.solid, nx, ny, keep + WALL_LOOK);
                go = next >= wall.min(keep) - SLACK;
                wall = if go { next } else { wall };
            } else if go {
                wall -= v * l.period;
            }
            heading += w * l.period;
            if go {
                if near > close {
                    (close, wrong) = (near, side);
                }
                was_outside = is_outside;
                (x, y) = (nx, ny);
                s = self.path.project(x, y, s - 0.1, s + 0.5).0;
            }
            outside += usize::from(was_outside);
            if step == 1 && go {
                command.speed = v;
                command.arc = s;
            }
            let left = (STEPS - step) as f64 * l.period * f.speed;
            let least = (self.path.length() - s - left).max(0.0) / l.speed
                + COST_CLOSE * close
                + COST_OUTSIDE * outside as f64;
            if fixed + least > enough + SLACK {
                command.cost = f64::INFINITY;
                return command;
            }
        }
        let (arc, lateral) = self.path.project(x, y, s - 0.1, s + 0.5);
        command.cost = (self.path.length() - arc) / l.speed
            + error.abs() / l.turn_rate
            + COST_LATERAL * lateral
            + fixed
            + COST_CLOSE * close
            + COST_WRONG_SIDE * wrong
            + COST_OUTSIDE * outside as f64;
        command
    }
}

/// The command whose roll-out costs least, or the first that is within `SATISFIED` of the least conceivable.
pub fn steer(scene: Scene, pose: (f64, f64, f64), s: f64, last_offset: f64) -> Command {
    let (s, _) = scene.path.project(pose.0, pose.1, s - 0.5, s + 1.0);
    let l = scene.limits;
    let conceivable = (scene.path.length() - s - STEPS as f64 * l.period * l.speed).max(0.0) / l.speed;
    let stay = Follower { offset: last_offset, speed: 0.0, look: LOOKS[0] };
    let mut best = scene.price(stay, pose, s, last_offset, f64::INFINITY);
    for share in SPEEDS {
        for look in LOOKS {
            for offset in OFFSETS {
                if best.cost <= conceivable + SATISFIED {
                    return best;
                }
                let f = Follower { offset, speed: share * l.speed, look };
                let command = scene.price(f, pose, s, last_offset, best.cost);
                if command.cost < best.cost - SLACK {
                    best = command;
                }
            }
        }
    }
    best
}

fn grid<'a>(array: &'a PyReadonlyArray2<bool>, resolution: f64) -> PyResult<Grid<'a>> {
    let (rows, cols) = (array.shape()[0], array.shape()[1]);
    Ok(Grid { cells: array.as_slice()?, rows, cols, resolution, first: (0, 0) })
}

#[pyfunction(name = "clearance")]
fn py_clearance(solid: PyReadonlyArray2<bool>, resolution: f64, x: f64, y: f64, reach: f64) -> PyResult<f64> {
    Ok(clearance(grid(&solid, resolution)?, x, y, reach))
}

#[pyfunction(name = "block_discs")]
fn py_block_discs(
    mut free: PyReadwriteArray2<bool>,
    resolution: f64,
    discs: PyReadonlyArray2<f64>,
) -> PyResult<()> {
    let cols = free.shape()[1];
    block_discs(free.as_slice_mut()?, cols, resolution, discs.as_slice()?);
    Ok(())
}

#[pyfunction(name = "steer")]
fn py_steer(
    solid: PyReadonlyArray2<bool>,
    traversable: PyReadonlyArray2<bool>,
    first: (i64, i64),
    resolution: f64,
    pose: (f64, f64, f64),
    path: PyReadonlyArray2<f64>,
    arc: PyReadonlyArray1<f64>,
    progress: (f64, f64, f64),
    others: PyReadonlyArray2<f64>,
    limits: (f64, f64, f64, f64, f64),
) -> PyResult<(f64, f64, f64, f64, f64)> {
    let (radius, speed, turn_rate, period, guard) = limits;
    let scene = Scene {
        solid: grid(&solid, resolution)?,
        traversable: Grid { first, ..grid(&traversable, resolution)? },
        path: Path { xy: path.as_slice()?, arc: arc.as_slice()? },
        others: others.as_slice()?,
        limits: Limits { radius, speed, turn_rate, period, guard },
        turning: progress.2,
    };
    let c = steer(scene, pose, progress.0, progress.1);
    Ok((c.speed, c.turn, c.arc, c.offset, c.cost))
}

#[pyfunction(name = "remaining")]
fn py_remaining<'py>(
    py: Python<'py>,
    path: PyReadonlyArray2<'py, f64>,
    here: (f64, f64),
    length: f64,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    if path.shape()[0] < 2 || path.shape()[1] != 2 {
        return Err(PyValueError::new_err(format!("a path has 2 points or more; got {:?}", path.shape())));
    }
    let path: Vec<(f64, f64)> = path.as_slice()?.chunks_exact(2).map(|point| (point[0], point[1])).collect();
    let rest: Vec<f64> = remaining(&path, here, length).into_iter().flat_map(|(x, y)| [x, y]).collect();
    let points = rest.len() / 2;
    rest.into_pyarray(py).reshape([points, 2])
}

pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(py_clearance, m)?)?;
    m.add_function(wrap_pyfunction!(py_block_discs, m)?)?;
    m.add_function(wrap_pyfunction!(py_steer, m)?)?;
    m.add_function(wrap_pyfunction!(py_remaining, m)?)?;
    Ok(())
}
