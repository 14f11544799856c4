//! The transition of a target's density: a separable stencil; at the grid's borders mass is reflected or lost.

#[derive(Clone, Copy)]
pub struct Grid {
    pub rows: usize,
    pub cols: usize,
}

/// Rows and columns `[start, end)` of the grid.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Bounds {
    pub rows: (usize, usize),
    pub cols: (usize, usize),
}

/// Mass on a part of the grid, zero elsewhere.
pub struct Patch {
    pub bounds: Bounds,
    pub mass: Vec<f64>,
}

/// Mass moves from `i` to `i + first + t` with probability `taps[t]`, rows and columns independently.
pub struct Stencil<'a> {
    pub first: (i64, i64),
    pub row_taps: &'a [f64],
    pub col_taps: &'a [f64],
    /// What moves beyond the grid is gone; otherwise it is reflected at the border.
    pub leaves: bool,
}

/// `length` neighbours that all move by the same amount with the same probability.
struct Run {
    from: usize,
    to: usize,
    length: usize,
    tap: f64,
}

impl Grid {
    pub fn bounds(&self) -> Bounds {
        Bounds { rows: (0, self.rows), cols: (0, self.cols) }
    }
}

impl Bounds {
    pub fn width(&self) -> usize {
        self.cols.1 - self.cols.0
    }

    pub fn size(&self) -> usize {
        (self.rows.1 - self.rows.0) * self.width()
    }

    /// The index inside, if the cell is inside.
    pub fn index(&self, row: usize, col: usize) -> Option<usize> {
        let inside = (self.rows.0..self.rows.1).contains(&row) && (self.cols.0..self.cols.1).contains(&col);
        inside.then(|| (row - self.rows.0) * self.width() + col - self.cols.0)
    }

    pub fn union(&self, other: &Bounds) -> Bounds {
        let join = |a: (usize, usize), b: (usize, usize)| (a.0.min(b.0), a.1.max(b.1));
        Bounds { rows: join(self.rows, other.rows), cols: join(self.cols, other.cols) }
    }

    pub fn intersection(&self, other: &Bounds) -> Option<Bounds> {
        let meet = |a: (usize, usize), b: (usize, usize)| (a.0.max(b.0), a.1.min(b.1));
        let both = Bounds { rows: meet(self.rows, other.rows), cols: meet(self.cols, other.cols) };
        (both.rows.0 < both.rows.1 && both.cols.0 < both.cols.1).then_some(both)
    }

    pub fn grown(&self, by: usize, grid: Grid) -> Bounds {
        let grow = |side: (usize, usize), n: usize| (side.0.saturating_sub(by), (side.1 + by).min(n));
        Bounds { rows: grow(self.rows, grid.rows), cols: grow(self.cols, grid.cols) }
    }
}

impl Patch {
    pub fn whole(grid: Grid, mass: &[f64]) -> Patch {
        Patch { bounds: grid.bounds(), mass: mass.to_vec() }
    }

    /// What a density on the whole grid has inside bounds.
    pub fn cut(grid: Grid, mass: &[f64], bounds: Bounds) -> Patch {
        let rows = (bounds.rows.0..bounds.rows.1).map(|row| row * grid.cols);
        let mass = rows.flat_map(|row| &mass[row + bounds.cols.0..row + bounds.cols.1]).copied().collect();
        Patch { bounds, mass }
    }

    /// The part inside bounds that lie in the patch.
    pub fn cropped(&self, bounds: Bounds) -> Patch {
        let length = bounds.width();
        let parts =
            (bounds.rows.0..bounds.rows.1).filter_map(|row| self.row_part(row, bounds.cols.0, length));
        Patch { bounds, mass: parts.flat_map(|(_, part)| part).copied().collect() }
    }

    /// The part of a row from `col` on, `length` long, that is in the patch, and where in it that starts.
    pub fn row_part(&self, row: usize, col: usize, length: usize) -> Option<(usize, &[f64])> {
        let Bounds { rows, cols } = self.bounds;
        let (from, to) = (col.max(cols.0), (col + length).min(cols.1));
        if row < rows.0 || row >= rows.1 || from >= to {
            return None;
        }
        let start = (row - rows.0) * self.bounds.width();
        Some((from - col, &self.mass[start + from - cols.0..start + to - cols.0]))
    }

    pub fn empty(bounds: Bounds) -> Patch {
        Patch { bounds, mass: vec![0.0; bounds.size()] }
    }
}

impl Stencil<'_> {
    /// How far mass moves in one step at most [cells].
    pub fn reach(&self) -> usize {
        let far = |first: i64, taps: usize| first.abs().max((first + taps as i64 - 1).abs());
        far(self.first.0, self.row_taps.len()).max(far(self.first.1, self.col_taps.len())) as usize
    }

    fn stays(&self) -> bool {
        self.first == (0, 0) && self.row_taps == [1.0] && self.col_taps == [1.0]
    }

    /// The smallest bounds that hold all that moves out of these.
    pub fn image(&self, grid: Grid, from: Bounds) -> Bounds {
        Bounds {
            rows: self.image_along(from.rows, self.first.0, self.row_taps.len(), grid.rows),
            cols: self.image_along(from.cols, self.first.1, self.col_taps.len(), grid.cols),
        }
    }

    /// `T p`: where the mass of a patch goes, as far as that is in `into`.
    pub fn spread(&self, grid: Grid, patch: &Patch, into: Bounds) -> Patch {
        let from = patch.bounds;
        if self.stays() && into == from {
            return Patch { bounds: from, mass: patch.mass.clone() };
        }
        let row_runs = self.runs(from.rows, into.rows, self.first.0, self.row_taps, grid.rows);
        let col_runs = self.runs(from.cols, into.cols, self.first.1, self.col_taps, grid.cols);
        let middle = along_rows(&patch.mass, from.width(), &row_runs, into.rows.1 - into.rows.0);
        Patch { bounds: into, mass: along_cols(&middle, from.width(), &col_runs, into.width()) }
    }

    /// `T' v`: the mean over where the mass goes of a function on a patch, taken as zero outside.
    pub fn expect(&self, grid: Grid, patch: &Patch) -> Patch {
        let bounds = patch.bounds;
        if self.stays() {
            return Patch { bounds, mass: patch.mass.clone() };
        }
        let back = |mut list: Vec<Run>| {
            list.iter_mut().for_each(|run| std::mem::swap(&mut run.from, &mut run.to));
            list
        };
        let row_runs = back(self.runs(bounds.rows, bounds.rows, self.first.0, self.row_taps, grid.rows));
        let col_runs = back(self.runs(bounds.cols, bounds.cols, self.first.1, self.col_taps, grid.cols));
        let middle = along_rows(&patch.mass, bounds.width(), &row_runs, bounds.rows.1 - bounds.rows.0);
        Patch { bounds, mass: along_cols(&middle, bounds.width(), &col_runs, bounds.width()) }
    }

    /// Where an index beyond `[0, n)` is: reflected, as by a mirror between cells, or nowhere.
    fn landed(&self, index: i64, n: usize) -> Option<usize> {
        if (0..n as i64).contains(&index) {
            return Some(index as usize);
        }
        let n = n as i64;
        let wrapped = index.rem_euclid(2 * n);
        (!self.leaves).then(|| wrapped.min(2 * n - 1 - wrapped) as usize)
    }

    /// The smallest range that holds all that moves out of `[from.0, from.1)`; empty if it is all gone.
    fn image_along(&self, from: (usize, usize), first: i64, taps: usize, n: usize) -> (usize, usize) {
        let targets = from.0 as i64 + first..from.1 as i64 + first + taps as i64 - 1;
        let landed = || targets.clone().filter_map(|index| self.landed(index, n));
        (landed().min().unwrap_or(0), landed().max().map_or(0, |last| last + 1))
    }

    /// All moves from one range into another, indices relative to the ranges, neighbours together.
    fn runs(
        &self,
        from: (usize, usize),
        into: (usize, usize),
        first: i64,
        taps: &[f64],
        n: usize,
    ) -> Vec<Run> {
        let mut list: Vec<Run> = Vec::new();
        for (t, &tap) in taps.iter().enumerate() {
            let begin = list.len();
            for index in from.0..from.1 {
                let Some(target) = self.landed(index as i64 + first + t as i64, n) else { continue };
                if target < into.0 || target >= into.1 {
                    continue;
                }
                let (source, target) = (index - from.0, target - into.0);
                match list[begin..].last_mut() {
                    Some(run) if run.from + run.length == source && run.to + run.length == target => {
                        run.length += 1;
                    }
                    _ => list.push(Run { from: source, to: target, length: 1, tap }),
                }
            }
        }
        list
    }
}

fn along_rows(mass: &[f64], width: usize, runs: &[Run], rows: usize) -> Vec<f64> {
    let mut moved = vec![0.0; rows * width];
    if width == 0 {
        return moved;
    }
    for (row, to) in moved.chunks_exact_mut(width).enumerate() {
        for run in runs.iter().filter(|run| (run.to..run.to + run.length).contains(&row)) {
            let from = (run.from + row - run.to) * width;
            add(to, &mass[from..from + width], run.tap);
        }
    }
    moved
}

fn along_cols(mass: &[f64], width: usize, runs: &[Run], cols: usize) -> Vec<f64> {
    let mut moved = vec![0.0; mass.len() / width.max(1) * cols];
    if cols == 0 || width == 0 {
        return moved;
    }
    for (to, from) in moved.chunks_exact_mut(cols).zip(mass.chunks_exact(width)) {
        for run in runs {
            add(&mut to[run.to..run.to + run.length], &from[run.from..run.from + run.length], run.tap);
        }
    }
    moved
}

fn add(to: &mut [f64], from: &[f64], tap: f64) {
    for (sum, value) in to.iter_mut().zip(from) {
        *sum += tap * value;
    }
}
