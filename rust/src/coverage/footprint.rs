//! What a scan from a viewpoint would reveal.

use super::{FREE, OCCUPIED, UNKNOWN};

pub struct Sensor<'a> {
    pub range_cells: f64,
    pub view: f64,         // field of view [rad]
    pub table: &'a [f32],  // probability of seeing an unknown cell: a row a berth, by cells of depth
    pub depths: usize,     // of a row
    pub by_distance: bool, // depth is the distance; otherwise the unknown length crossed before
    pub rays: usize,       // in a full turn
    pub floor: f32,        // a ray ends where a cell is seen less likely, and lower shares are left out
}

/// Footprints of viewpoints as CSR over planning cells of `factor x factor` cells: the expected share
/// of a planning cell's unknown cells that a scan from the viewpoint reveals.
pub fn footprints(
    classes: &[u8],
    berths: &[u8],
    rows: usize,
    cols: usize,
    views: &[i64],
    facing: &[f64],
    sensor: &Sensor,
    factor: usize,
) -> (Vec<i64>, Vec<u32>, Vec<f32>) {
    let coarse_cols = cols.div_ceil(factor);
    let coarse_rows = rows.div_ceil(factor);
    let ground = Ground::of(classes, rows, cols);
    let mut seen = vec![0.0_f32; ground.codes.len()];
    let mut touched: Vec<u32> = Vec::new();
    let mut share = vec![0.0_f32; coarse_rows * coarse_cols];
    let mut coarse_touched: Vec<usize> = Vec::new();
    let mut unknown = vec![0_u32; coarse_rows * coarse_cols]; // cells, once it was needed
    let (mut starts, mut cells, mut shares) = (vec![0_i64], Vec::new(), Vec::new());
    for (&view, &heading) in views.iter().zip(facing) {
        for ray in 0..sensor.rays {
            let turn = std::f64::consts::TAU * ((ray as f64 + 0.5) / sensor.rays as f64 - 0.5);
            if turn.abs() <= 0.5 * sensor.view {
                ground.trace(view as usize, heading + turn, sensor, berths, |at, p| {
                    let best = &mut seen[at];
                    if *best == 0.0 {
                        touched.push(at as u32);
                    }
                    *best = larger(*best, p);
                });
            }
        }
        for at in touched.drain(..) {
            let (row, col) = (at / ground.wide as u32 - 1, at % ground.wide as u32 - 1);
            let coarse = (row / factor as u32) as usize * coarse_cols + (col / factor as u32) as usize;
            if share[coarse] == 0.0 {
                coarse_touched.push(coarse);
            }
            share[coarse] += seen[at as usize];
            seen[at as usize] = 0.0;
        }
        coarse_touched.sort_unstable();
        for coarse in coarse_touched.drain(..) {
            if unknown[coarse] == 0 {
                unknown[coarse] = unknown_in(classes, rows, cols, coarse, coarse_cols, factor);
            }
            let p = share[coarse] / unknown[coarse] as f32;
            share[coarse] = 0.0;
            if p >= sensor.floor {
                cells.push(coarse as u32);
                shares.push(p.min(1.0));
            }
        }
        starts.push(cells.len() as i64);
    }
    (starts, cells, shares)
}

/// Unknown cells of a planning cell.
fn unknown_in(
    classes: &[u8],
    rows: usize,
    cols: usize,
    coarse: usize,
    coarse_cols: usize,
    factor: usize,
) -> u32 {
    let (r0, c0) = (coarse / coarse_cols * factor, coarse % coarse_cols * factor);
    let lines =
        (r0..(r0 + factor).min(rows)).map(|r| &classes[r * cols + c0..r * cols + (c0 + factor).min(cols)]);
    lines.flatten().map(|&class| u32::from(class == UNKNOWN)).sum()
}

/// What a ray meets: the grid with a cell of padding all round, which stops it.
struct Ground {
    codes: Vec<u8>,
    cols: usize, // of the grid without padding
    wide: usize, // cells of a padded row
}

const DARK: u8 = 0; // unknown
const WALL: u8 = 1;
/// Of a free cell with others all round at least: one more for each further ring of free cells about it.
const ROOMY: u8 = 3;

impl Ground {
    fn of(classes: &[u8], rows: usize, cols: usize) -> Ground {
        let wide = cols + 2;
        let mut codes = room(classes, rows, cols);
        for row in 0..rows {
            for (class, code) in
                classes[row * cols..(row + 1) * cols].iter().zip(&mut codes[(row + 1) * wide + 1..])
            {
                *code = match *class {
                    FREE => code.saturating_add(1),
                    OCCUPIED => WALL,
                    _ => DARK,
                };
            }
        }
        for row in 0..rows + 2 {
            (codes[row * wide], codes[(row + 1) * wide - 1]) = (WALL, WALL);
        }
        let last = codes.len() - wide;
        codes[..wide].fill(WALL);
        codes[last..].fill(WALL);
        Ground { codes, cols, wide }
    }

    /// Walk one ray from a cell's centre, reporting each unknown cell (padded) with its probability of being seen.
    fn trace(
        &self,
        from: usize,
        angle: f64,
        sensor: &Sensor,
        berths: &[u8],
        mut report: impl FnMut(usize, f32),
    ) {
        let (dx, dy) = (angle.cos(), angle.sin());
        let mut at = (from / self.cols + 1) * self.wide + from % self.cols + 1;
        let wide = self.wide as isize;
        let (row_step, col_step) = (if dy > 0.0 { wide } else { -wide }, if dx > 0.0 { 1 } else { -1 });
        let (per_row, per_col) = (1.0 / dy.abs(), 1.0 / dx.abs());
        let (mut next_row, mut next_col) = (0.5 * per_row, 0.5 * per_col);
        let (mut travelled, mut unknown) = (0.0_f64, 0.0_f64);
        let (mut berth, mut outside) = (sensor.table.len() / sensor.depths - 1, true);
        loop {
            let code = self.codes[at];
            if code > ROOMY {
                // All cells this near are free: leap to the last crossing inside them.
                let more = f64::from(code - ROOMY);
                let end = smaller(next_row + more * per_row, next_col + more * per_col);
                if end >= sensor.range_cells {
                    return;
                }
                let crossed_rows = ((end - next_row) / per_row + 1.0) as isize; // 0 if the first is beyond
                let crossed_cols = ((end - next_col) / per_col + 1.0) as isize; // 0 if the first is beyond
                at = at.wrapping_add_signed(row_step * crossed_rows + col_step * crossed_cols);
                next_row += crossed_rows as f64 * per_row;
                next_col += crossed_cols as f64 * per_col;
                travelled = end;
                outside = true;
                continue;
            }
            if code == WALL {
                return;
            }
            let leave = smaller(smaller(next_row, next_col), sensor.range_cells);
            if code == DARK {
                let depth = if sensor.by_distance { 0.5 * (travelled + leave) } else { unknown };
                if outside {
                    let cell = (at / self.wide - 1) * self.cols + at % self.wide - 1;
                    berth = berth.min(berths[cell] as usize);
                }
                let p = sensor.table[berth * sensor.depths + (depth as usize).min(sensor.depths - 1)];
                if p <= 0.0 || p < sensor.floor {
                    return; // what lies deeper is hardly seen either
                }
                report(at, p);
                unknown += leave - travelled;
            }
            outside = code != DARK;
            if leave >= sensor.range_cells {
                return;
            }
            travelled = leave;
            if next_row < next_col {
                at = at.wrapping_add_signed(row_step);
                next_row += per_row;
            } else {
                at = at.wrapping_add_signed(col_step);
                next_col += per_col;
            }
        }
    }
}

/// Chebyshev distance [cells] from each free cell to the nearest that is not, outside included; at most 255. In a
/// grid with a cell of padding all round, which stands for the outside.
fn room(classes: &[u8], rows: usize, cols: usize) -> Vec<u8> {
    let wide = cols + 2;
    let mut padded = vec![0_u8; (rows + 2) * wide];
    for row in 0..rows {
        let start = (row + 1) * wide + 1;
        for col in 0..cols {
            if classes[row * cols + col] == FREE {
                let at = start + col;
                let above = padded[at - wide - 1].min(padded[at - wide]).min(padded[at - wide + 1]);
                padded[at] = above.min(padded[at - 1]).saturating_add(1);
            }
        }
    }
    for row in (0..rows).rev() {
        let start = (row + 1) * wide + 1;
        for col in (0..cols).rev() {
            let at = start + col;
            let below = padded[at + wide - 1].min(padded[at + wide]).min(padded[at + wide + 1]);
            padded[at] = padded[at].min(below.min(padded[at + 1]).saturating_add(1));
        }
    }
    padded
}

/// ``f64::min`` and ``f32::max`` of numbers, without a thought for what is none.
#[inline]
fn smaller(a: f64, b: f64) -> f64 {
    if a < b {
        a
    } else {
        b
    }
}

#[inline]
fn larger(a: f32, b: f32) -> f32 {
    if a > b {
        a
    } else {
        b
    }
}
