//! Time-layered coverage: footprints of viewpoints, sparse impacts and the best reply by tours.
//!
//! A sparse impact is two parallel slices: `keys`, strictly increasing, `cell * LAYERS + layer`, and
//! `misses`, the log-miss added from that layer on, in steps of 1/16 nat, saturating at 255 (certain).

use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;

pub const LAYERS: usize = 32;
const STEPS_PER_NAT: f64 = 16.0;
const FREE: u8 = 1;
const OCCUPIED: u8 = 2;

type Sparse = (Vec<u32>, Vec<u8>);
type PySparse<'py> = (Bound<'py, PyArray1<u32>>, Bound<'py, PyArray1<u8>>);

/// The miss probability of every log-miss, `miss[q] = exp(-q / 16)` and 0 when saturated.
fn miss_table() -> [f64; 256] {
    let mut table = [0.0; 256];
    for (q, miss) in table.iter_mut().enumerate().take(255) {
        *miss = (-(q as f64) / STEPS_PER_NAT).exp();
    }
    table
}

// ---------------------------------------------------------------------------------------------
// Viewpoints and footprints

/// True when the open segment between two cell centres crosses only free cells.
fn sees(classes: &[u8], cols: usize, from: usize, to: usize) -> bool {
    let (mut row, mut col) = ((from / cols) as i64, (from % cols) as i64);
    let (row_to, col_to) = ((to / cols) as i64, (to % cols) as i64);
    let (rows_left, cols_left) = ((row_to - row).abs(), (col_to - col).abs());
    let (row_step, col_step) = ((row_to - row).signum(), (col_to - col).signum());
    let mut error = cols_left - rows_left;
    for _ in 0..(rows_left + cols_left) {
        if error > 0 {
            col += col_step;
            error -= 2 * rows_left;
        } else {
            row += row_step;
            error += 2 * cols_left;
        }
        let cell = row as usize * cols + col as usize;
        if cell == to {
            return true;
        }
        if classes[cell] != FREE {
            return false;
        }
    }
    true
}

/// For each cluster: its representative (the member nearest the centroid) and the nearest reachable
/// cell, at most `reach` cells away, that sees it; -1 where there is none.
pub fn viewpoints(
    field: &[f32],
    classes: &[u8],
    rows: usize,
    cols: usize,
    cells: &[i64],
    starts: &[i64],
    reach: i64,
) -> (Vec<i64>, Vec<i64>) {
    let mut representatives = Vec::with_capacity(starts.len());
    let mut views = Vec::with_capacity(starts.len());
    for bounds in starts.windows(2) {
        let members = &cells[bounds[0] as usize..bounds[1] as usize];
        let representative = nearest_to_centroid(members, cols as i64);
        representatives.push(representative);
        views.push(view_of(field, classes, rows, cols, representative, reach));
    }
    (representatives, views)
}

fn nearest_to_centroid(members: &[i64], cols: i64) -> i64 {
    let n = members.len() as i64;
    let (row_sum, col_sum) = members.iter().fold((0, 0), |(r, c), &m| (r + m / cols, c + m % cols));
    *members
        .iter()
        .min_by_key(|&&m| {
            let (dr, dc) = (n * (m / cols) - row_sum, n * (m % cols) - col_sum);
            (dr * dr + dc * dc, m)
        })
        .expect("a cluster has members")
}

fn view_of(field: &[f32], classes: &[u8], rows: usize, cols: usize, target: i64, reach: i64) -> i64 {
    let (row, col) = (target / cols as i64, target % cols as i64);
    let mut best = (reach * reach + 1, -1_i64);
    for ring in 0..=reach {
        if ring * ring >= best.0 {
            break;
        }
        for r in (row - ring).max(0)..=(row + ring).min(rows as i64 - 1) {
            let on_edge = (r - row).abs() == ring;
            let step = if on_edge { 1 } else { (2 * ring).max(1) };
            let mut c = col - ring;
            while c <= col + ring {
                if c >= 0 && c < cols as i64 {
                    let cell = r * cols as i64 + c;
                    let distance = (r - row).pow(2) + (c - col).pow(2);
                    if distance < best.0
                        && field[cell as usize].is_finite()
                        && sees(classes, cols, cell as usize, target as usize)
                    {
                        best = (distance, cell);
                    }
                }
                c += step;
            }
        }
    }
    best.1
}

pub struct Sensor<'a> {
    pub range_cells: f64,
    pub view: f64,         // field of view [rad]
    pub table: &'a [f32],  // probability of seeing an unknown cell, by cells of depth
    pub by_distance: bool, // depth is the distance; otherwise the unknown length crossed before
    pub rays: usize,       // in a full turn
    pub floor: f32,        // a ray ends where a cell is seen less likely, and lower shares are left out
}

/// Footprints of viewpoints as CSR over planning cells of `factor x factor` cells: the expected share
/// of a planning cell's unknown cells that a scan from the viewpoint reveals.
#[allow(clippy::too_many_arguments)]
pub fn footprints(
    classes: &[u8],
    rows: usize,
    cols: usize,
    views: &[i64],
    facing: &[f64],
    sensor: &Sensor,
    factor: usize,
) -> (Vec<i64>, Vec<u32>, Vec<f32>) {
    let coarse_cols = cols.div_ceil(factor);
    let coarse_rows = rows.div_ceil(factor);
    let mut seen = vec![0.0_f32; rows * cols];
    let mut touched: Vec<usize> = Vec::new();
    let mut share = vec![0.0_f32; coarse_rows * coarse_cols];
    let mut coarse_touched: Vec<usize> = Vec::new();
    let (mut starts, mut cells, mut shares) = (vec![0_i64], Vec::new(), Vec::new());
    let room = room(classes, rows, cols);
    for (&view, &heading) in views.iter().zip(facing) {
        for ray in 0..sensor.rays {
            let turn = std::f64::consts::TAU * ((ray as f64 + 0.5) / sensor.rays as f64 - 0.5);
            if turn.abs() <= 0.5 * sensor.view {
                trace(classes, &room, rows, cols, view as usize, heading + turn, sensor, |cell, p| {
                    if seen[cell] == 0.0 {
                        touched.push(cell);
                    }
                    seen[cell] = seen[cell].max(p);
                });
            }
        }
        for cell in touched.drain(..) {
            let coarse = (cell / cols / factor) * coarse_cols + cell % cols / factor;
            if share[coarse] == 0.0 {
                coarse_touched.push(coarse);
            }
            share[coarse] += seen[cell];
            seen[cell] = 0.0;
        }
        coarse_touched.sort_unstable();
        for coarse in coarse_touched.drain(..) {
            let (r0, c0) = (coarse / coarse_cols * factor, coarse % coarse_cols * factor);
            let mut unknown = 0;
            for r in r0..(r0 + factor).min(rows) {
                for c in c0..(c0 + factor).min(cols) {
                    unknown += usize::from(classes[r * cols + c] == 0);
                }
            }
            let p = share[coarse] / unknown as f32;
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

/// Chebyshev distance [cells] from each free cell to the nearest that is not, outside included; at most 255.
fn room(classes: &[u8], rows: usize, cols: usize) -> Vec<u8> {
    // One cell of padding all round stands for the outside.
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
    let mut room = vec![0_u8; rows * cols];
    for row in (0..rows).rev() {
        let start = (row + 1) * wide + 1;
        for col in (0..cols).rev() {
            let at = start + col;
            let below = padded[at + wide - 1].min(padded[at + wide]).min(padded[at + wide + 1]);
            padded[at] = padded[at].min(below.min(padded[at + 1]).saturating_add(1));
            room[row * cols + col] = padded[at];
        }
    }
    room
}

/// Walk one ray from a cell's centre, reporting each unknown cell with its probability of being seen.
#[allow(clippy::too_many_arguments)]
fn trace(
    classes: &[u8],
    room: &[u8],
    rows: usize,
    cols: usize,
    from: usize,
    angle: f64,
    sensor: &Sensor,
    mut report: impl FnMut(usize, f32),
) {
    let (dx, dy) = (angle.cos(), angle.sin());
    let (mut row, mut col) = ((from / cols) as i64, (from % cols) as i64);
    let (row_step, col_step) = (if dy > 0.0 { 1 } else { -1 }, if dx > 0.0 { 1 } else { -1 });
    let (per_row, per_col) = (1.0 / dy.abs(), 1.0 / dx.abs());
    let (mut next_row, mut next_col) = (0.5 * per_row, 0.5 * per_col);
    let (mut travelled, mut unknown) = (0.0_f64, 0.0_f64);
    loop {
        let cell = row as usize * cols + col as usize;
        if room[cell] > 2 {
            // All cells this near are free: leap to the last crossing inside them.
            let more = f64::from(room[cell] - 2);
            let end = (next_row + more * per_row).min(next_col + more * per_col);
            if end >= sensor.range_cells {
                return;
            }
            let crossed_rows = ((end - next_row) / per_row + 1.0) as i64; // 0 if the first is beyond
            let crossed_cols = ((end - next_col) / per_col + 1.0) as i64; // 0 if the first is beyond
            row += row_step * crossed_rows;
            col += col_step * crossed_cols;
            next_row += crossed_rows as f64 * per_row;
            next_col += crossed_cols as f64 * per_col;
            travelled = end;
            continue;
        }
        let leave = next_row.min(next_col).min(sensor.range_cells);
        match classes[cell] {
            OCCUPIED => return,
            FREE => {}
            _ => {
                let depth = if sensor.by_distance { 0.5 * (travelled + leave) } else { unknown };
                let p = sensor.table[(depth as usize).min(sensor.table.len() - 1)];
                if p <= 0.0 || p < sensor.floor {
                    return; // deeper cells are seen less still
                }
                report(cell, p);
                unknown += leave - travelled;
            }
        }
        if leave >= sensor.range_cells {
            return;
        }
        travelled = leave;
        if next_row < next_col {
            row += row_step;
            next_row += per_row;
        } else {
            col += col_step;
            next_col += per_col;
        }
        if row < 0 || col < 0 || row >= rows as i64 || col >= cols as i64 {
            return;
        }
    }
}

// ---------------------------------------------------------------------------------------------
// Sparse impacts

/// `a * b`: log-misses add, saturating.  docs/theory.md (V20)
pub fn combine(a: (&[u32], &[u8]), b: (&[u32], &[u8])) -> Sparse {
    let mut keys = Vec::with_capacity(a.0.len() + b.0.len());
    let mut misses = Vec::with_capacity(a.0.len() + b.0.len());
    let (mut i, mut j) = (0, 0);
    while i < a.0.len() || j < b.0.len() {
        let key_a = a.0.get(i).copied().unwrap_or(u32::MAX);
        let key_b = b.0.get(j).copied().unwrap_or(u32::MAX);
        let mut miss = 0_u8;
        if key_a <= key_b {
            miss = a.1[i];
            i += 1;
        }
        if key_b <= key_a {
            miss = miss.saturating_add(b.1[j]);
            j += 1;
        }
        keys.push(key_a.min(key_b));
        misses.push(miss);
    }
    (keys, misses)
}

/// The value of one cell's log-misses, in units of its weight: `sum_b w_b (1 - prod_i m_i(b))`.
fn cell_value(entries: &[(usize, u8)], layer_weights: &[f64], miss: &[f64; 256]) -> f64 {
    let mut total = 0_u8;
    let mut value = 0.0;
    let mut next = 0;
    for (layer, weight) in layer_weights.iter().enumerate() {
        while next < entries.len() && entries[next].0 <= layer {
            total = total.saturating_add(entries[next].1);
            next += 1;
        }
        value += weight * (1.0 - miss[total as usize]);
    }
    value
}

fn entries_of(keys: &[u32], misses: &[u8], cell: u32, out: &mut Vec<(usize, u8)>) {
    let first = keys.partition_point(|&key| key / (LAYERS as u32) < cell);
    for (key, miss) in keys[first..].iter().zip(&misses[first..]) {
        if key / LAYERS as u32 != cell {
            break;
        }
        out.push(((key % LAYERS as u32) as usize, *miss));
    }
}

/// `value(others * own) - value(others)`, summed over the cells that `own` touches.
pub fn marginal(
    weights: &[f32],
    layer_weights: &[f64],
    others: (&[u32], &[u8]),
    own: (&[u32], &[u8]),
) -> f64 {
    let miss = miss_table();
    let (mut before, mut after) = (Vec::new(), Vec::new());
    let mut gain = 0.0;
    let mut at = 0;
    while at < own.0.len() {
        let cell = own.0[at] / LAYERS as u32;
        before.clear();
        entries_of(others.0, others.1, cell, &mut before);
        after.clear();
        after.extend_from_slice(&before);
        while at < own.0.len() && own.0[at] / LAYERS as u32 == cell {
            after.push(((own.0[at] % LAYERS as u32) as usize, own.1[at]));
            at += 1;
        }
        after.sort_unstable();
        let weight = f64::from(weights[cell as usize]);
        gain +=
            weight * (cell_value(&after, layer_weights, &miss) - cell_value(&before, layer_weights, &miss));
    }
    gain
}

// ---------------------------------------------------------------------------------------------
// Tours

/// What one platform knows of its stops, fixed for a round.
pub struct Stops<'a> {
    pub starts: &'a [i64],    // (K + 1) CSR bounds of each stop's footprint
    pub cells: &'a [u32],     // planning cells
    pub misses: &'a [u8],     // their log-miss
    pub first_leg: &'a [f32], // (K) seconds from here to each stop
    pub legs: &'a [f32],      // (K, K) seconds between stops
    pub edges: &'a [f64],     // (LAYERS) upper edge of each time layer [s]
}

impl Stops<'_> {
    fn layer(&self, arrival: f32) -> usize {
        self.edges.partition_point(|&edge| edge < f64::from(arrival)).min(LAYERS - 1)
    }

    fn len(&self) -> usize {
        self.first_leg.len()
    }

    fn leg(&self, from: Option<usize>, to: usize) -> f32 {
        match from {
            None => self.first_leg[to],
            Some(stop) => self.legs[stop * self.len() + to],
        }
    }

    /// The earliest arrival at each stop by way of any others, which may be earlier than going straight:
    /// legs between stops come from a coarser grid than the first leg (Dijkstra, dense).
    fn earliest(&self) -> Vec<f32> {
        let mut arrival = self.first_leg.to_vec();
        let mut open: Vec<usize> = (0..self.len()).collect();
        while let Some(at) = (0..open.len()).min_by(|&a, &b| arrival[open[a]].total_cmp(&arrival[open[b]])) {
            let from = open.swap_remove(at);
            for &to in &open {
                arrival[to] = arrival[to].min(arrival[from] + self.leg(Some(from), to));
            }
        }
        arrival
    }
}

/// The gains of one best reply. What a certain sighting of a cell in a layer would add to the rest of the
/// team's impact is `left[cell] * discounts[discount[cell]][layer]`, less as the platform's own tour sees it.
struct Tours<'a> {
    stops: Stops<'a>,
    local: Vec<u32>,               // the local cell of each footprint entry
    seen: [f32; 256],              // probability of being seen, by log-miss
    weight: Vec<f32>,              // (local cell) its worth
    left: Vec<f32>,                // (local cell) scratch: its worth times own miss so far
    discount: Vec<u32>,            // (local cell) row of `discounts`; 0 where the others see nothing
    discounts: Vec<[f32; LAYERS]>, // suffix sums of layer weights times others' miss
    max_stops: usize,
    held: usize,   // stops at the head of a tour that a search leaves where they are
    budget: usize, // footprint entries that a search may still visit to improve a tour
}

/// Bounds the time of a reply where footprints are vast; in an office it is never used up.
const BUDGET: usize = 150_000;

impl<'a> Tours<'a> {
    fn new(
        stops: Stops<'a>,
        weights: &[f32],
        layer_weights: &[f64],
        others: (&[u32], &[u8]),
        max_stops: usize,
    ) -> Self {
        let miss = miss_table();
        let first = stops.cells.iter().min().copied().unwrap_or(0);
        let last = stops.cells.iter().max().copied().unwrap_or(0);
        let mut numbers = vec![0_u32; (last - first) as usize + 1]; // local number of a cell, from 1; 0: none
        let mut weight: Vec<f32> = Vec::new();
        let mut local = Vec::with_capacity(stops.cells.len());
        for &cell in stops.cells {
            let number = &mut numbers[(cell - first) as usize];
            if *number == 0 {
                weight.push(weights[cell as usize]);
                *number = weight.len() as u32;
            }
            local.push(*number - 1);
        }
        let mut discount = vec![0_u32; weight.len()];
        let mut discounts = vec![suffix_sums(layer_weights, &[0; LAYERS], &miss)];
        let mut at = others.0.partition_point(|&key| key / (LAYERS as u32) < first);
        while at < others.0.len() && others.0[at] / LAYERS as u32 <= last {
            let cell = others.0[at] / LAYERS as u32;
            let mut added = [0_u8; LAYERS];
            while at < others.0.len() && others.0[at] / LAYERS as u32 == cell {
                added[(others.0[at] % LAYERS as u32) as usize] = others.1[at];
                at += 1;
            }
            let number = numbers[(cell - first) as usize];
            if number > 0 {
                discount[number as usize - 1] = discounts.len() as u32;
                discounts.push(suffix_sums(layer_weights, &added, &miss));
            }
        }
        let seen = miss.map(|miss| (1.0 - miss) as f32);
        let left = weight.clone();
        Tours { stops, local, seen, weight, left, discount, discounts, max_stops, held: 0, budget: 0 }
    }

    fn entries(&self, stop: usize) -> std::ops::Range<usize> {
        self.stops.starts[stop] as usize..self.stops.starts[stop + 1] as usize
    }

    fn seen(&self, entry: usize) -> f32 {
        self.seen[self.stops.misses[entry] as usize]
    }

    /// What a stop adds in every layer, given the platform's own misses so far.
    fn by_layer(&self, stop: usize) -> [f32; LAYERS] {
        let mut sums = [0.0_f32; LAYERS];
        let mut alone = 0.0;
        for entry in self.entries(stop) {
            let cell = self.local[entry] as usize;
            let p = self.seen(entry) * self.left[cell];
            match self.discount[cell] {
                0 => alone += p,
                row => {
                    for (sum, discount) in sums.iter_mut().zip(&self.discounts[row as usize]) {
                        *sum += p * discount;
                    }
                }
            }
        }
        for (sum, discount) in sums.iter_mut().zip(&self.discounts[0]) {
            *sum += alone * discount;
        }
        sums
    }

    fn in_layer(&self, stop: usize, layer: usize) -> f32 {
        self.entries(stop)
            .map(|entry| {
                let cell = self.local[entry] as usize;
                self.seen(entry) * self.left[cell] * self.discounts[self.discount[cell] as usize][layer]
            })
            .sum()
    }

    /// For each stop and layer, at least what a visit adds: what it adds alone and as early as can be.
    fn ceilings(&self) -> Vec<[f32; LAYERS]> {
        let earliest = self.stops.earliest();
        let most = |(stop, arrival): (usize, &f32)| match arrival.is_finite() {
            true => [self.in_layer(stop, self.stops.layer(*arrival)); LAYERS],
            false => [0.0; LAYERS],
        };
        earliest.iter().enumerate().map(most).collect()
    }

    fn observe(&mut self, stop: usize) {
        for entry in self.entries(stop) {
            self.left[self.local[entry] as usize] *= 1.0 - self.seen(entry);
        }
    }

    fn forget(&mut self, tour: &[usize]) {
        for &stop in tour {
            for entry in self.entries(stop) {
                let cell = self.local[entry] as usize;
                self.left[cell] = self.weight[cell];
            }
        }
    }

    /// The exact marginal value of a tour against the rest of the team, and when it ends [s].
    fn value(&mut self, tour: &[usize]) -> (f64, f32) {
        let (mut value, mut now, mut from) = (0.0_f64, 0.0_f32, None);
        for &stop in tour {
            now += self.stops.leg(from, stop);
            if !now.is_finite() {
                value = f64::NEG_INFINITY;
                break;
            }
            let layer = self.stops.layer(now);
            let mut sum = 0.0_f32;
            for entry in self.entries(stop) {
                let cell = self.local[entry] as usize;
                let p = self.seen(entry) * self.left[cell];
                sum += p * self.discounts[self.discount[cell] as usize][layer];
                self.left[cell] -= p;
            }
            value += f64::from(sum);
            from = Some(stop);
        }
        self.forget(tour);
        (value, now)
    }

    fn size(&self, tour: &[usize]) -> usize {
        tour.iter().map(|&stop| self.entries(stop).len()).sum()
    }

    /// Value with ties inside a time layer broken towards the shorter tour.
    fn score(&mut self, tour: &[usize]) -> f64 {
        let (value, end) = self.value(tour);
        value * (1.0 - 1e-4 * f64::from(end.min(1e3)) / 1e3)
    }

    /// Complete and improve a tour, leaving its first `held` stops in place.
    fn search(&mut self, mut tour: Vec<usize>, held: usize, ceilings: &[[f32; LAYERS]]) -> Vec<usize> {
        (self.held, self.budget) = (held, BUDGET);
        let mut tables = ceilings.to_vec();
        self.insert_greedily(&mut tour, &mut tables);
        self.improve(&mut tour);
        self.insert_greedily(&mut tour, &mut tables);
        tour
    }

    /// Insert the stop that adds most, where it adds most, until nothing adds or the tour is full.
    ///
    /// `tables` holds at least what each stop adds in every layer: that only shrinks as the tour grows,
    /// so a table is brought up to date only when its stop looks best.
    fn insert_greedily(&mut self, tour: &mut Vec<usize>, tables: &mut [[f32; LAYERS]]) {
        while tour.len() < self.max_stops.min(self.stops.len()) {
            let Some((stop, place)) = self.best_insertion(tour, tables) else { return };
            let before = self.score(tour);
            tour.insert(place, stop);
            if self.score(tour) <= before {
                tour.remove(place);
                return;
            }
        }
    }

    fn best_insertion(&mut self, tour: &[usize], tables: &mut [[f32; LAYERS]]) -> Option<(usize, usize)> {
        // What each stop of the tour is worth in every layer, given the stops before it.
        let mut arrivals = Vec::with_capacity(tour.len());
        let mut present = Vec::with_capacity(tour.len());
        let (mut now, mut from) = (0.0, None);
        for &stop in tour {
            now += self.stops.leg(from, stop);
            arrivals.push(now);
            present.push(self.by_layer(stop));
            self.observe(stop);
            from = Some(stop);
        }
        let place = |stop: usize, table: &[f32; LAYERS]| match tour.contains(&stop) {
            true => (0.0, 0),
            false => best_place(&self.stops, stop, table, tour, self.held, &arrivals, &present),
        };
        let mut best: Vec<(f32, usize)> =
            tables.iter().enumerate().map(|(stop, table)| place(stop, table)).collect();
        let mut exact = vec![false; best.len()];
        let found = loop {
            let by_gain = |a: &usize, b: &usize| best[*a].0.total_cmp(&best[*b].0).then(b.cmp(a));
            let stop = (0..best.len()).max_by(by_gain)?;
            if best[stop].0 <= 0.0 {
                break None;
            }
            if exact[stop] {
                break Some((stop, best[stop].1));
            }
            tables[stop] = self.by_layer(stop);
            best[stop] = place(stop, &tables[stop]);
            exact[stop] = true;
        };
        self.forget(tour);
        found
    }

    /// Move a stop or reverse a stretch as long as that helps and the budget lasts.
    fn improve(&mut self, tour: &mut Vec<usize>) {
        let mut best = self.score(tour);
        for _ in 0..4 {
            let before = best;
            for i in self.held..tour.len() {
                for j in self.held..tour.len() {
                    if i == j {
                        continue;
                    }
                    let mut moved = tour.clone();
                    let stop = moved.remove(i);
                    moved.insert(j, stop);
                    best = self.keep_better(tour, moved, best);
                    if i + 1 < j {
                        let mut turned = tour.clone();
                        turned[i..=j].reverse();
                        best = self.keep_better(tour, turned, best);
                    }
                }
            }
            if best <= before {
                break;
            }
        }
    }

    fn keep_better(&mut self, tour: &mut Vec<usize>, other: Vec<usize>, best: f64) -> f64 {
        let Some(budget) = self.budget.checked_sub(self.size(&other)) else { return best };
        self.budget = budget;
        let score = self.score(&other);
        if score > best * (1.0 + 1e-9) {
            *tour = other;
            return score;
        }
        best
    }

    /// An upper bound on any tour's marginal value: its best stops, each as early as can be, no overlap.
    fn relaxed(&self) -> f64 {
        let mut gains: Vec<f32> = self.ceilings().iter().map(|layers| layers[0]).collect();
        gains.sort_unstable_by(|a, b| b.total_cmp(a));
        gains.iter().take(self.max_stops).map(|&g| f64::from(g)).sum()
    }
}

/// For every layer, the sum over it and all later ones of its weight times the others' miss.
fn suffix_sums(layer_weights: &[f64], added: &[u8; LAYERS], miss: &[f64; 256]) -> [f32; LAYERS] {
    let mut products = [0.0; LAYERS];
    let mut total = 0_u8;
    for layer in 0..LAYERS {
        total = total.saturating_add(added[layer]);
        products[layer] = layer_weights[layer] * miss[total as usize];
    }
    let mut sum = 0.0;
    let mut sums = [0.0_f32; LAYERS];
    for layer in (0..LAYERS).rev() {
        sum += products[layer];
        sums[layer] = sum as f32;
    }
    sums
}

/// Where in a tour a stop adds most, and how much: what it sees, less what it delays.
fn best_place(
    stops: &Stops,
    stop: usize,
    table: &[f32; LAYERS],
    tour: &[usize],
    held: usize,
    arrivals: &[f32],
    present: &[[f32; LAYERS]],
) -> (f32, usize) {
    let mut best = (0.0_f32, 0);
    for place in held..=tour.len() {
        let from = place.checked_sub(1).map(|i| tour[i]);
        let start = place.checked_sub(1).map_or(0.0, |i| arrivals[i]);
        let arrival = start + stops.leg(from, stop);
        if !arrival.is_finite() {
            continue;
        }
        let mut gain = table[stops.layer(arrival)];
        if let Some(&next) = tour.get(place) {
            let delay = arrival + stops.leg(Some(stop), next) - arrivals[place];
            if !delay.is_finite() {
                continue;
            }
            for (later, worth) in arrivals[place..].iter().zip(&present[place..]) {
                gain += worth[stops.layer(later + delay)] - worth[stops.layer(*later)];
            }
        }
        // A hair less for a later arrival: inside a layer the nearer stop comes first.
        gain *= 1.0 - 1e-4 * arrival.min(1e3) / 1e3;
        if gain > best.0 {
            best = (gain, place);
        }
    }
    best
}

pub struct Reply {
    pub tour: Vec<i64>,
    pub gain: f64,         // marginal value of `tour`
    pub current_gain: f64, // marginal value of the current tour
}

/// The best tour found against the rest of the team, by greedy insertion and 2-opt.
///
/// One search starts from nothing, another from the current tour and leaves its first stop in place: the
/// robot is on its way there, so to turn away must pay by the share `stickiness`.
#[allow(clippy::too_many_arguments)]
pub fn best_tour(
    stops: Stops,
    weights: &[f32],
    layer_weights: &[f64],
    others: (&[u32], &[u8]),
    current: &[i64],
    max_stops: usize,
    stickiness: f64,
) -> Reply {
    let mut tours = Tours::new(stops, weights, layer_weights, others, max_stops);
    let current: Vec<usize> = current.iter().map(|&stop| stop as usize).collect();
    let current_gain = tours.value(&current).0;
    let ceilings = tours.ceilings();
    let mut best = tours.search(Vec::new(), 0, &ceilings);
    if !current.is_empty() {
        let kept = tours.search(current, 1, &ceilings);
        if tours.score(&best) <= tours.score(&kept) * (1.0 + stickiness) {
            best = kept;
        }
    }
    let gain = tours.value(&best).0;
    Reply { tour: best.iter().map(|&stop| stop as i64).collect(), gain, current_gain }
}

/// No tour adds more than this to the team's impact.  docs/theory.md (V26)
pub fn most_any_tour_adds(
    stops: Stops,
    weights: &[f32],
    layer_weights: &[f64],
    team: (&[u32], &[u8]),
    max_stops: usize,
) -> f64 {
    Tours::new(stops, weights, layer_weights, team, max_stops).relaxed()
}

// ---------------------------------------------------------------------------------------------
// Python

#[pyfunction(name = "viewpoints")]
fn py_viewpoints<'py>(
    py: Python<'py>,
    field: PyReadonlyArray2<'py, f32>,
    classes: PyReadonlyArray2<'py, u8>,
    cells: PyReadonlyArray1<'py, i64>,
    starts: PyReadonlyArray1<'py, i64>,
    reach: i64,
) -> PyResult<(Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<i64>>)> {
    let [rows, cols] = [classes.as_array().nrows(), classes.as_array().ncols()];
    let (representatives, views) = viewpoints(
        field.as_slice()?,
        classes.as_slice()?,
        rows,
        cols,
        cells.as_slice()?,
        starts.as_slice()?,
        reach,
    );
    Ok((representatives.into_pyarray(py), views.into_pyarray(py)))
}

type PyFootprints<'py> = (Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<u32>>, Bound<'py, PyArray1<f32>>);

#[pyfunction(name = "footprints")]
#[allow(clippy::too_many_arguments)]
fn py_footprints<'py>(
    py: Python<'py>,
    classes: PyReadonlyArray2<'py, u8>,
    views: PyReadonlyArray1<'py, i64>,
    facing: PyReadonlyArray1<'py, f64>,
    range_cells: f64,
    view: f64,
    table: PyReadonlyArray1<'py, f32>,
    by_distance: bool,
    rays: usize,
    factor: usize,
    floor: f32,
) -> PyResult<PyFootprints<'py>> {
    let [rows, cols] = [classes.as_array().nrows(), classes.as_array().ncols()];
    let sensor = Sensor { range_cells, view, table: table.as_slice()?, by_distance, rays, floor };
    let (starts, cells, shares) =
        footprints(classes.as_slice()?, rows, cols, views.as_slice()?, facing.as_slice()?, &sensor, factor);
    Ok((starts.into_pyarray(py), cells.into_pyarray(py), shares.into_pyarray(py)))
}

#[pyfunction(name = "combine")]
fn py_combine<'py>(
    py: Python<'py>,
    keys_a: PyReadonlyArray1<'py, u32>,
    misses_a: PyReadonlyArray1<'py, u8>,
    keys_b: PyReadonlyArray1<'py, u32>,
    misses_b: PyReadonlyArray1<'py, u8>,
) -> PyResult<PySparse<'py>> {
    let (keys, misses) =
        combine((keys_a.as_slice()?, misses_a.as_slice()?), (keys_b.as_slice()?, misses_b.as_slice()?));
    Ok((keys.into_pyarray(py), misses.into_pyarray(py)))
}

#[pyfunction(name = "marginals")]
fn py_marginals<'py>(
    py: Python<'py>,
    weights: PyReadonlyArray1<'py, f32>,
    layer_weights: PyReadonlyArray1<'py, f64>,
    others_keys: PyReadonlyArray1<'py, u32>,
    others_misses: PyReadonlyArray1<'py, u8>,
    starts: PyReadonlyArray1<'py, i64>,
    keys: PyReadonlyArray1<'py, u32>,
    misses: PyReadonlyArray1<'py, u8>,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let others = (others_keys.as_slice()?, others_misses.as_slice()?);
    let (keys, misses) = (keys.as_slice()?, misses.as_slice()?);
    let (weights, layer_weights) = (weights.as_slice()?, layer_weights.as_slice()?);
    let gains: Vec<f64> = starts
        .as_slice()?
        .windows(2)
        .map(|bounds| {
            let own = bounds[0] as usize..bounds[1] as usize;
            marginal(weights, layer_weights, others, (&keys[own.clone()], &misses[own]))
        })
        .collect();
    Ok(gains.into_pyarray(py))
}

type PyReply<'py> = (Bound<'py, PyArray1<i64>>, f64, f64);

#[pyfunction(name = "best_tour")]
#[allow(clippy::too_many_arguments)]
fn py_best_tour<'py>(
    py: Python<'py>,
    weights: PyReadonlyArray1<'py, f32>,
    layer_weights: PyReadonlyArray1<'py, f64>,
    edges: PyReadonlyArray1<'py, f64>,
    others_keys: PyReadonlyArray1<'py, u32>,
    others_misses: PyReadonlyArray1<'py, u8>,
    starts: PyReadonlyArray1<'py, i64>,
    cells: PyReadonlyArray1<'py, u32>,
    misses: PyReadonlyArray1<'py, u8>,
    first_leg: PyReadonlyArray1<'py, f32>,
    legs: PyReadonlyArray2<'py, f32>,
    current: PyReadonlyArray1<'py, i64>,
    max_stops: usize,
    stickiness: f64,
) -> PyResult<PyReply<'py>> {
    let stops = Stops {
        starts: starts.as_slice()?,
        cells: cells.as_slice()?,
        misses: misses.as_slice()?,
        first_leg: first_leg.as_slice()?,
        legs: legs.as_slice()?,
        edges: edges.as_slice()?,
    };
    let reply = best_tour(
        stops,
        weights.as_slice()?,
        layer_weights.as_slice()?,
        (others_keys.as_slice()?, others_misses.as_slice()?),
        current.as_slice()?,
        max_stops,
        stickiness,
    );
    Ok((reply.tour.into_pyarray(py), reply.gain, reply.current_gain))
}

#[pyfunction(name = "most_any_tour_adds")]
#[allow(clippy::too_many_arguments)]
fn py_most_any_tour_adds(
    weights: PyReadonlyArray1<'_, f32>,
    layer_weights: PyReadonlyArray1<'_, f64>,
    edges: PyReadonlyArray1<'_, f64>,
    team_keys: PyReadonlyArray1<'_, u32>,
    team_misses: PyReadonlyArray1<'_, u8>,
    starts: PyReadonlyArray1<'_, i64>,
    cells: PyReadonlyArray1<'_, u32>,
    misses: PyReadonlyArray1<'_, u8>,
    first_leg: PyReadonlyArray1<'_, f32>,
    legs: PyReadonlyArray2<'_, f32>,
    max_stops: usize,
) -> PyResult<f64> {
    let stops = Stops {
        starts: starts.as_slice()?,
        cells: cells.as_slice()?,
        misses: misses.as_slice()?,
        first_leg: first_leg.as_slice()?,
        legs: legs.as_slice()?,
        edges: edges.as_slice()?,
    };
    Ok(most_any_tour_adds(
        stops,
        weights.as_slice()?,
        layer_weights.as_slice()?,
        (team_keys.as_slice()?, team_misses.as_slice()?),
        max_stops,
    ))
}

pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add("LAYERS", LAYERS)?;
    m.add_function(wrap_pyfunction!(py_viewpoints, m)?)?;
    m.add_function(wrap_pyfunction!(py_footprints, m)?)?;
    m.add_function(wrap_pyfunction!(py_combine, m)?)?;
    m.add_function(wrap_pyfunction!(py_marginals, m)?)?;
    m.add_function(wrap_pyfunction!(py_best_tour, m)?)?;
    m.add_function(wrap_pyfunction!(py_most_any_tour_adds, m)?)?;
    Ok(())
}
