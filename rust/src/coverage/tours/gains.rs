//! What looks from stops add to the rest of the team's impact, by when they are taken.

use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

use super::super::impact::miss_table;
use super::{Stops, TourProblem, LAYERS};

/// What a certain sighting of a cell in a layer would add is `left[cell] * discounts[discount[cell]][layer]`; `left`
/// falls as the platform's own tour sees the cell.
pub(super) struct Gains<'a> {
    pub stops: Stops<'a>,
    seen: [f32; 256],              // probability of being seen, by log-miss
    weight: Vec<f32>,              // (local cell) its worth
    left: Vec<f32>,                // (local cell) scratch: its worth times own miss so far
    discount: Vec<u32>,            // (local cell) row of `discounts`; 0 where the others see nothing
    discounts: Vec<[f32; LAYERS]>, // suffix sums of layer weights times others' miss, each pattern once
    sums: Vec<f32>,                // (row of `discounts`) scratch: zeros
    rows: Vec<u32>,                // scratch: rows in use
}

impl<'a> Gains<'a> {
    pub fn new(problem: &TourProblem<'a>) -> Self {
        let miss = miss_table();
        let weight: Vec<f32> = problem.stops.cells.iter().map(|&cell| problem.worth.of(cell)).collect();
        let (discount, discounts) = discounts_of(problem, &miss);
        Gains {
            stops: problem.stops,
            seen: miss.map(|miss| (1.0 - miss) as f32),
            left: weight.clone(),
            weight,
            discount,
            sums: vec![0.0; discounts.len()],
            discounts,
            rows: Vec::new(),
        }
    }

    /// How likely a look shows the cell of a footprint entry.
    pub fn seen(&self, entry: usize) -> f32 {
        self.seen[self.stops.misses[entry] as usize]
    }

    /// What a stop adds in every layer, given the platform's own misses so far.
    pub fn by_layer(&mut self, stop: usize) -> [f32; LAYERS] {
        self.sum_by_layer(self.stops.entries(stop))
    }

    /// What some footprint entries add in every layer, given the platform's own misses so far.
    pub fn sum_by_layer(&mut self, entries: impl Iterator<Item = usize>) -> [f32; LAYERS] {
        self.rows.clear();
        for entry in entries {
            let cell = self.stops.local[entry] as usize;
            let row = self.discount[cell];
            let sum = &mut self.sums[row as usize];
            if *sum == 0.0 {
                self.rows.push(row);
            }
            *sum += self.seen[self.stops.misses[entry] as usize] * self.left[cell];
        }
        let mut by_layer = [0.0_f32; LAYERS];
        for &row in &self.rows {
            let sum = std::mem::take(&mut self.sums[row as usize]);
            for (total, discount) in by_layer.iter_mut().zip(&self.discounts[row as usize]) {
                *total += sum * discount;
            }
        }
        by_layer
    }

    /// For each stop, at least what a visit adds: what it adds alone and as early as can be.
    pub fn ceilings(&self) -> Vec<f32> {
        let most = |(stop, &arrival): (usize, &f32)| match arrival.is_finite() {
            true => self.in_layer(stop, self.stops.layer(arrival)),
            false => 0.0,
        };
        self.stops.earliest().iter().enumerate().map(most).collect()
    }

    fn in_layer(&self, stop: usize, layer: usize) -> f32 {
        let of_entry = |entry: usize| {
            let cell = self.stops.local[entry] as usize;
            self.seen(entry) * self.left[cell] * self.discounts[self.discount[cell] as usize][layer]
        };
        self.stops.entries(stop).map(of_entry).sum()
    }

    /// The exact marginal value of a tour against the rest of the team.
    pub fn value(&mut self, tour: &[usize]) -> f64 {
        let (mut value, stops) = (0.0_f64, self.stops);
        for (&stop, arrival) in tour.iter().zip(stops.arrivals(tour.iter().copied())) {
            if !arrival.is_finite() {
                value = f64::NEG_INFINITY;
                break;
            }
            let (mut sum, layer) = (0.0_f32, stops.layer(arrival));
            for entry in stops.entries(stop) {
                sum += self.take(stops.local[entry], self.seen(entry), layer);
            }
            value += f64::from(sum);
        }
        self.forget(tour);
        value
    }

    /// See a cell in a layer, and return what that adds.
    pub fn take(&mut self, cell: u32, seen: f32, layer: usize) -> f32 {
        let cell = cell as usize;
        let part = seen * self.left[cell];
        self.left[cell] -= part;
        part * self.discounts[self.discount[cell] as usize][layer]
    }

    /// Look from a stop.
    pub fn observe(&mut self, stop: usize) {
        for entry in self.stops.entries(stop) {
            self.left[self.stops.local[entry] as usize] *= 1.0 - self.seen(entry);
        }
    }

    /// Forget what looks from the stops of a tour have shown.
    pub fn forget(&mut self, tour: &[usize]) {
        for &stop in tour {
            for entry in self.stops.entries(stop) {
                self.forget_cell(self.stops.local[entry]);
            }
        }
    }

    pub fn forget_cell(&mut self, cell: u32) {
        self.left[cell as usize] = self.weight[cell as usize];
    }
}

/// Of each cell in any footprint the row of its discounts, and the rows: each pattern of the others' misses once.
fn discounts_of(problem: &TourProblem, miss: &[f64; 256]) -> (Vec<u32>, Vec<[f32; LAYERS]>) {
    let (keys, misses) = problem.others;
    let mut discounts = vec![suffix_sums(problem.layer_weights, &[0; LAYERS], miss)];
    let mut rows: HashMap<[u8; LAYERS], u32, BuildHasherDefault<Mixer>> = HashMap::default();
    rows.insert([0; LAYERS], 0);
    let (mut last, mut row) = ([0_u8; LAYERS], 0); // neighbours are mostly seen alike
    let cell_of = |key: u32| key / LAYERS as u32;
    let mut at = 0;
    let row_of = |&cell: &u32| {
        while at < keys.len() && cell_of(keys[at]) < cell {
            at += 1;
        }
        let mut added = [0_u8; LAYERS];
        while at < keys.len() && cell_of(keys[at]) == cell {
            added[(keys[at] % LAYERS as u32) as usize] = misses[at];
            at += 1;
        }
        if added != last {
            last = added;
            row = *rows.entry(added).or_insert_with(|| {
                discounts.push(suffix_sums(problem.layer_weights, &added, miss));
                discounts.len() as u32 - 1
            });
        }
        row
    };
    (problem.stops.cells.iter().map(row_of).collect(), discounts)
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

/// Hashes a few bytes, fast; nobody chooses them to collide who could not do worse by lying.
#[derive(Default)]
struct Mixer(u64);

impl Hasher for Mixer {
    fn write(&mut self, bytes: &[u8]) {
        for word in bytes.chunks(8) {
            let mut part = [0; 8];
            part[..word.len()].copy_from_slice(word);
            self.0 = (self.0.rotate_left(5) ^ u64::from_le_bytes(part)).wrapping_mul(0x517c_c1b7_2722_0a95);
        }
    }

    fn finish(&self) -> u64 {
        self.0
    }
}
