//! Shadows cast from a cell, octant by octant and line by line: what stays open, and what can be seen there.
//!
//! A square `out` cells outward and `side` cells sideways hides the slopes `side / out` from
//! `(side - 1/2) / (out + 1/2)` to `(side + 1/2) / (out - 1/2)`. Quotients of small integers compare exactly in f64.

use crate::planes::{Lines, Planes, Presence};

/// Less than half of what can lie between two slopes, and far more than an f64 is off.
const HAIR: f64 = 1e-10;

/// What a line of sight touches that goes through the corner between four squares.
#[derive(Clone, Copy, PartialEq)]
pub enum Corners {
    /// Both squares beside it.
    Both,
    /// The one that a walk towards the cell which casts the shadows enters by changing its row.
    RowsFirst,
}

/// One octant: along which lines it is seen, and in which directions it goes outward and sideways.
struct Octant {
    by_rows: bool,
    outward: i64,
    forward: bool,
}

const OCTANTS: [Octant; 8] = [
    Octant { by_rows: true, outward: 1, forward: true },
    Octant { by_rows: true, outward: 1, forward: false },
    Octant { by_rows: true, outward: -1, forward: true },
    Octant { by_rows: true, outward: -1, forward: false },
    Octant { by_rows: false, outward: 1, forward: true },
    Octant { by_rows: false, outward: 1, forward: false },
    Octant { by_rows: false, outward: -1, forward: true },
    Octant { by_rows: false, outward: -1, forward: false },
];

/// A line of an octant, its cells counted sideways from the middle.
#[derive(Clone, Copy)]
struct Line<'a> {
    lines: &'a Lines,
    line: usize,
    middle: usize,
    forward: bool,
    inside: i64, // cells before the grid's edge
}

impl Line<'_> {
    /// The first cell in `from..=to` that is set, or, with `clear`, that is not; none beyond the grid's edge.
    #[inline]
    fn first(&self, from: i64, to: i64, clear: bool) -> Option<i64> {
        let to = to.min(self.inside - 1);
        if from > to {
            return None;
        }
        let (from, to) = (from as usize, to as usize);
        if self.forward {
            let found = self.lines.first(self.line, self.middle + from, self.middle + to, clear);
            found.map(|cell| (cell - self.middle) as i64)
        } else {
            let found = self.lines.last(self.line, self.middle - to, self.middle - from, clear);
            found.map(|cell| (self.middle - cell) as i64)
        }
    }

    /// The first run of set cells in `from..=to`: its first and its last; beyond the grid's edge all is set.
    #[inline]
    fn run(&self, from: i64, to: i64) -> Option<(i64, i64)> {
        let edge = self.inside.max(from);
        let start = self.first(from, to, false).unwrap_or(edge);
        (start <= to).then(|| (start, self.first(start, to, true).map_or(to, |clear| clear - 1)))
    }
}

/// What can be seen from a cell, ring by ring.
pub struct Shadows<'a> {
    blocked: &'a Planes,
    goals: &'a Planes,
    present: Presence,
    range: i64,
    corners: Corners,
    at: (usize, usize),
    open: [Vec<(f64, f64)>; 8], // slopes between which nothing stands so far, ends not included
    spare: Vec<(f64, f64)>,
    /// Pieces of lines looked at so far.
    pub work: u64,
}

impl<'a> Shadows<'a> {
    /// Shadows of `blocked` cells, cast to find `goals` at most so many lines away.
    pub fn new(blocked: &'a Planes, goals: &'a Planes, range: i64, corners: Corners) -> Self {
        let (present, at, open, spare) = (Presence::of(&goals.rows), (0, 0), Default::default(), Vec::new());
        Shadows { blocked, goals, present, range, corners, at, open, spare, work: 0 }
    }

    /// Begin at a cell, blocked or not, with nothing in the way.
    pub fn begin(&mut self, row: usize, col: usize) {
        self.at = (row, col);
        for (octant, number) in OCTANTS.iter().zip(0..) {
            let diagonal = match self.corners {
                // The square beside the cell stops the diagonal alone, at the corner they share.
                Corners::Both => {
                    self.line(octant, self.blocked, 0).is_some_and(|line| line.run(1, 1).is_none())
                }
                Corners::RowsFirst => !octant.by_rows,
            };
            let slopes = (-1.0, if diagonal { 1.0 + 2.0 * HAIR } else { 1.0 });
            self.open[number].clear();
            if self.promises(octant, 0, slopes) {
                self.open[number].push(slopes);
            }
        }
    }

    /// Look at the lines `out` cells away, up to `widest` cells sideways: `show` each piece's nearest goal cell.
    ///
    /// Returns whether anything is open beyond.
    pub fn advance(&mut self, out: i64, widest: i64, mut show: impl FnMut(i64, usize)) -> bool {
        let mut any_open = false;
        for (octant, number) in OCTANTS.iter().zip(0..) {
            if self.open[number].is_empty() {
                continue;
            }
            let (open, mut still_open) =
                (std::mem::take(&mut self.open[number]), std::mem::take(&mut self.spare));
            still_open.clear();
            if let Some(blocked) = self.line(octant, self.blocked, out) {
                let goals = Line { lines: self.lines(octant, self.goals), ..blocked };
                self.work += open.len() as u64;
                for &slopes in &open {
                    if let Some(side) = self.goal(&blocked, &goals, octant, out, widest, slopes) {
                        show(side, self.cell(octant, out, side));
                    }
                    self.cast(&blocked, octant, out, slopes, &mut still_open);
                }
            }
            any_open |= !still_open.is_empty();
            (self.open[number], self.spare) = (still_open, open);
        }
        any_open
    }

    /// The goal cell nearest the middle of a line that is seen between two slopes.
    #[inline]
    fn goal(
        &self,
        blocked: &Line,
        goals: &Line,
        octant: &Octant,
        out: i64,
        widest: i64,
        (low, high): (f64, f64),
    ) -> Option<i64> {
        let distance = out as f64;
        let (mut from, to) = ((low * distance) as i64, (high * distance) as i64);
        let side = loop {
            let side = goals.first(from.max(0), to.min(out).min(widest), false)?;
            let slope = side as f64 / distance;
            if slope >= high {
                return None;
            } else if slope > low {
                break side;
            }
            from = side + 1;
        };
        // Of the squares beside it in its line one can hide a cell, on the diagonal: at the corner before it.
        let hidden =
            side == out && self.top(octant, out, out - 1) >= 1.0 && blocked.run(out - 1, out - 1).is_some();
        (!hidden).then_some(side)
    }

    /// Add what stays open, between two slopes, beyond a line.
    #[inline]
    fn cast(
        &self,
        line: &Line,
        octant: &Octant,
        out: i64,
        (mut low, high): (f64, f64),
        still_open: &mut Vec<(f64, f64)>,
    ) {
        let distance = out as f64;
        let mut side = ((low * (distance - 0.5) - 0.5) as i64).max(0);
        let last = ((high * (distance + 0.5) + 0.5) as i64).min(out + 1);
        let mut cut = false;
        while let Some((first, end)) = line.run(side, last) {
            cut = true;
            let bottom = self.bottom(octant, out, first).min(high);
            if bottom - low > 2.0 * HAIR && self.promises(octant, out, (low, bottom)) {
                still_open.push((low, bottom));
            }
            low = low.max(self.top(octant, out, end));
            side = end + 1;
            if low >= high {
                return;
            }
        }
        if !cut || high - low > 2.0 * HAIR && self.promises(octant, out, (low, high)) {
            still_open.push((low, high));
        }
    }

    /// Whether there may be goals between two slopes beyond a line.
    #[inline]
    fn promises(&self, octant: &Octant, out: i64, (low, high): (f64, f64)) -> bool {
        let span = |middle: usize, forward: bool, near: i64, far: i64, cells: usize| {
            let middle = middle as i64;
            let (from, to) =
                if forward { (middle + near, middle + far) } else { (middle - far, middle - near) };
            let (from, to) = (from.max(0), to.min(cells as i64 - 1));
            (from <= to).then_some((from as usize, to as usize))
        };
        let lines = self.lines(octant, self.goals);
        let (across, middle) = if octant.by_rows { self.at } else { (self.at.1, self.at.0) };
        let (near, far) = ((low * (out + 1) as f64) as i64, (high * self.range as f64) as i64 + 1);
        let outward = span(across, octant.outward > 0, out + 1, self.range, lines.count);
        let sideways = span(middle, octant.forward, near.max(0), far, lines.length);
        let (Some(outward), Some(sideways)) = (outward, sideways) else { return false };
        if octant.by_rows {
            self.present.any(outward, sideways)
        } else {
            self.present.any(sideways, outward)
        }
    }

    /// Where the slopes that a square hides begin.
    #[inline]
    fn bottom(&self, octant: &Octant, out: i64, side: i64) -> f64 {
        let spares_the_end = self.corners == Corners::RowsFirst && !octant.by_rows;
        (side as f64 - 0.5) / (out as f64 + 0.5) + if spares_the_end { HAIR } else { 0.0 }
    }

    /// Where the slopes that a square hides end.
    #[inline]
    fn top(&self, octant: &Octant, out: i64, side: i64) -> f64 {
        let spares_the_end = self.corners == Corners::RowsFirst && octant.by_rows;
        (side as f64 + 0.5) / (out as f64 - 0.5) - if spares_the_end { HAIR } else { 0.0 }
    }

    #[inline]
    fn lines<'b>(&self, octant: &Octant, planes: &'b Planes) -> &'b Lines {
        if octant.by_rows {
            &planes.rows
        } else {
            &planes.cols
        }
    }

    /// The line `out` cells away, if it lies in the grid.
    #[inline]
    fn line<'b>(&self, octant: &Octant, planes: &'b Planes, out: i64) -> Option<Line<'b>> {
        let lines = self.lines(octant, planes);
        let (across, middle) = if octant.by_rows { self.at } else { (self.at.1, self.at.0) };
        let line =
            usize::try_from(across as i64 + out * octant.outward).ok().filter(|&line| line < lines.count)?;
        let inside = if octant.forward { lines.length - middle } else { middle + 1 };
        Some(Line { lines, line, middle, forward: octant.forward, inside: inside as i64 })
    }

    /// Flat index of the cell `out` cells outward and `side` cells sideways.
    fn cell(&self, octant: &Octant, out: i64, side: i64) -> usize {
        let (outward, sideways) = (out * octant.outward, if octant.forward { side } else { -side });
        let (row, col) = if octant.by_rows { (outward, sideways) } else { (sideways, outward) };
        (self.at.0 as i64 + row) as usize * self.blocked.rows.length + (self.at.1 as i64 + col) as usize
    }
}
