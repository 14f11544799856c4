//! The best reply by tours: greedy insertion and 2-opt against the rest of the team.

use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

use super::impact::miss_table;
use super::worth::Worth;
use super::LAYERS;

/// What one platform knows of its stops, fixed for a round.
#[derive(Clone, Copy)]
pub struct Stops<'a> {
    pub starts: &'a [i64],    // (K + 1) CSR bounds of each stop's footprint
    pub cells: &'a [u32],     // (C) planning cells in any footprint, ascending
    pub local: &'a [u32],     // where among them each entry's is
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

/// The cells that occur, ascending, and where among them each is.
pub fn number_cells(cells: &[u32]) -> (Vec<u32>, Vec<u32>) {
    let (Some(&first), Some(&last)) = (cells.iter().min(), cells.iter().max()) else {
        return (Vec::new(), Vec::new());
    };
    let mut numbers = vec![0_u32; (last - first) as usize + 1];
    for &cell in cells {
        numbers[(cell - first) as usize] = 1;
    }
    let mut distinct = Vec::new();
    for (number, cell) in numbers.iter_mut().zip(first..=last) {
        if *number > 0 {
            *number = distinct.len() as u32;
            distinct.push(cell);
        }
    }
    let local = cells.iter().map(|&cell| numbers[(cell - first) as usize]).collect();
    (distinct, local)
}

/// The gains of one best reply. What a certain sighting of a cell in a layer would add to the rest of the
/// team's impact is `left[cell] * discounts[discount[cell]][layer]`, less as the platform's own tour sees it.
struct Tours<'a> {
    stops: Stops<'a>,
    seen: [f32; 256],              // probability of being seen, by log-miss
    weight: Vec<f32>,              // (local cell) its worth
    left: Vec<f32>,                // (local cell) scratch: its worth times own miss so far
    discount: Vec<u32>,            // (local cell) row of `discounts`; 0 where the others see nothing
    discounts: Vec<[f32; LAYERS]>, // suffix sums of layer weights times others' miss, each pattern once
    sums: Vec<f32>,                // (row of `discounts`) scratch: zeros
    rows: Vec<u32>,                // scratch: rows in use
    max_stops: usize,
    price: EndPrice,
    stay: f32,     // when a tour without stops ends, for its price [s]
    held: usize,   // stops at the head of a tour that a search leaves where they are
    budget: usize, // shared footprint entries that a search may still visit to improve a tour
}

/// What the end of a tour costs: `linear t + quadratic t^2 / 2`; one that ends after an hour costs no more.
#[derive(Clone, Copy)]
pub struct EndPrice {
    pub linear: f64,    // a second
    pub quadratic: f64, // a second^2
}

impl EndPrice {
    pub const FREE: Self = Self { linear: 0.0, quadratic: 0.0 };

    fn of(self, end: f32) -> f64 {
        let t = f64::from(end).min(3600.0);
        (self.linear + 0.5 * self.quadratic * t) * t
    }
}

/// Bounds the time of a reply where footprints are vast; in an office it is never used up.
const BUDGET: usize = 75_000;
/// No sum over a footprint is larger by another order of its terms.
const OVER: f32 = 1.001;

impl<'a> Tours<'a> {
    fn new(
        stops: Stops<'a>,
        worth: &Worth,
        layer_weights: &[f64],
        others: (&[u32], &[u8]),
        max_stops: usize,
        price: EndPrice,
    ) -> Self {
        let miss = miss_table();
        let weight: Vec<f32> = stops.cells.iter().map(|&cell| worth.of(cell)).collect();
        let mut discount = vec![0_u32; weight.len()];
        let mut discounts = vec![suffix_sums(layer_weights, &[0; LAYERS], &miss)];
        let mut rows: HashMap<[u8; LAYERS], u32, BuildHasherDefault<Mixer>> = HashMap::default();
        rows.insert([0; LAYERS], 0);
        let (mut last, mut row) = ([0_u8; LAYERS], 0); // neighbours are mostly seen alike
        let cell_of = |key: u32| key / LAYERS as u32;
        let mut at = 0;
        for (discount, &cell) in discount.iter_mut().zip(stops.cells) {
            while at < others.0.len() && cell_of(others.0[at]) < cell {
                at += 1;
            }
            let mut added = [0_u8; LAYERS];
            while at < others.0.len() && cell_of(others.0[at]) == cell {
                added[(others.0[at] % LAYERS as u32) as usize] = others.1[at];
                at += 1;
            }
            if added != last {
                last = added;
                row = *rows.entry(added).or_insert_with(|| {
                    discounts.push(suffix_sums(layer_weights, &added, &miss));
                    discounts.len() as u32 - 1
                });
            }
            *discount = row;
        }
        let seen = miss.map(|miss| (1.0 - miss) as f32);
        let (left, sums, rows) = (weight.clone(), vec![0.0; discounts.len()], Vec::new());
        let reached = stops.first_leg.iter().copied().filter(|leg| leg.is_finite());
        let stay = reached.fold(0.0, f32::max);
        let (held, budget) = (0, 0);
        Tours {
            stops,
            seen,
            weight,
            left,
            discount,
            discounts,
            sums,
            rows,
            max_stops,
            price,
            stay,
            held,
            budget,
        }
    }

    fn entries(&self, stop: usize) -> std::ops::Range<usize> {
        self.stops.starts[stop] as usize..self.stops.starts[stop + 1] as usize
    }

    fn seen(&self, entry: usize) -> f32 {
        self.seen[self.stops.misses[entry] as usize]
    }

    /// What a stop adds in every layer, given the platform's own misses so far.
    fn by_layer(&mut self, stop: usize) -> [f32; LAYERS] {
        self.sum_by_layer(self.entries(stop))
    }

    /// What some footprint entries add in every layer, given the platform's own misses so far.
    fn sum_by_layer(&mut self, entries: impl Iterator<Item = usize>) -> [f32; LAYERS] {
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

    fn in_layer(&self, stop: usize, layer: usize) -> f32 {
        self.entries(stop)
            .map(|entry| {
                let cell = self.stops.local[entry] as usize;
                self.seen(entry) * self.left[cell] * self.discounts[self.discount[cell] as usize][layer]
            })
            .sum()
    }

    /// For each stop, at least what a visit adds: what it adds alone and as early as can be.
    fn ceilings(&self) -> Vec<f32> {
        let most = |(stop, &arrival): (usize, &f32)| match arrival.is_finite() {
            true => self.in_layer(stop, self.stops.layer(arrival)),
            false => 0.0,
        };
        self.stops.earliest().iter().enumerate().map(most).collect()
    }

    fn observe(&mut self, stop: usize) {
        for entry in self.entries(stop) {
            self.left[self.stops.local[entry] as usize] *= 1.0 - self.seen(entry);
        }
    }

    fn forget(&mut self, tour: &[usize]) {
        for &stop in tour {
            for entry in self.entries(stop) {
                let cell = self.stops.local[entry] as usize;
                self.left[cell] = self.weight[cell];
            }
        }
    }

    /// The exact marginal value of a tour against the rest of the team, and when it ends [s], for its price: to stay
    /// costs what the farthest stop does.
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
                let cell = self.stops.local[entry] as usize;
                let p = self.seen(entry) * self.left[cell];
                sum += p * self.discounts[self.discount[cell] as usize][layer];
                self.left[cell] -= p;
            }
            value += f64::from(sum);
            from = Some(stop);
        }
        self.forget(tour);
        (value, if tour.is_empty() { self.stay } else { now })
    }

    fn score(&mut self, tour: &[usize]) -> f64 {
        let (value, end) = self.value(tour);
        score(value, end) - self.price.of(end)
    }

    /// The exact marginal value of a tour, less its price.
    fn net(&mut self, tour: &[usize]) -> f64 {
        let (value, end) = self.value(tour);
        value - self.price.of(end)
    }

    /// Complete and improve a tour, leaving its first `held` stops in place.
    ///
    /// `alone` holds at least what each stop adds in every layer before any other; where a search that starts from
    /// nothing looks more closely, the next search has the exact figure.
    fn search(&mut self, mut tour: Vec<usize>, held: usize, alone: &mut [[f32; LAYERS]]) -> Vec<usize> {
        (self.held, self.budget) = (held, BUDGET);
        if tour.is_empty() {
            self.best_insertion(&tour, alone);
        }
        let mut tables = alone.to_vec();
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
        let (stops, held, price) = (self.stops, self.held, self.price);
        let end = arrivals.last().copied().unwrap_or(self.stay);
        let place = |stop: usize, table: &[f32; LAYERS]| match tour.contains(&stop) {
            true => (0.0, 0),
            false => {
                let dearer = |other: f32| (price.of(other) - price.of(end)) as f32;
                best_place(&stops, stop, table, tour, held, &arrivals, &present, dearer)
            }
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
    fn improve(&mut self, tour: &mut [usize]) {
        let parts = self.parts(tour);
        let mut order: Vec<usize> = (0..parts.len()).collect();
        let mut best = self.score_of(&parts, &order, f64::NEG_INFINITY);
        for _ in 0..4 {
            let before = best;
            for i in self.held..order.len() {
                for j in self.held..order.len() {
                    if i == j {
                        continue;
                    }
                    let mut moved = order.clone();
                    let stop = moved.remove(i);
                    moved.insert(j, stop);
                    best = self.keep_better(&parts, &mut order, moved, best);
                    if i + 1 < j {
                        let mut turned = order.clone();
                        turned[i..=j].reverse();
                        best = self.keep_better(&parts, &mut order, turned, best);
                    }
                }
            }
            if best <= before {
                break;
            }
        }
        for (place, k) in order.into_iter().enumerate() {
            tour[place] = parts[k].stop;
        }
    }

    /// Take the stops of a tour apart: in any order, cells that only one stop sees add what they add.
    fn parts(&mut self, tour: &[usize]) -> Vec<Part> {
        let mut visits = vec![0_u8; self.weight.len()];
        for entry in tour.iter().flat_map(|&stop| self.entries(stop)) {
            visits[self.stops.local[entry] as usize] += 1;
        }
        let part = |&stop: &usize| {
            let (alone, shared): (Vec<usize>, Vec<usize>) =
                self.entries(stop).partition(|&entry| visits[self.stops.local[entry] as usize] == 1);
            let shared =
                shared.into_iter().map(|entry| (self.stops.local[entry], self.seen(entry))).collect();
            let most = self.by_layer(stop);
            Part { stop, most, alone: self.sum_by_layer(alone.into_iter()), shared }
        };
        tour.iter().map(part).collect()
    }

    /// The score of the parts in this order; any smaller number if that is not above `floor`.
    fn score_of(&mut self, parts: &[Part], order: &[usize], floor: f64) -> f64 {
        let (mut now, mut from) = (0.0_f32, None);
        let mut layers = Vec::with_capacity(order.len());
        for part in order.iter().map(|&k| &parts[k]) {
            now += self.stops.leg(from, part.stop);
            if !now.is_finite() {
                return f64::NEG_INFINITY;
            }
            layers.push(self.stops.layer(now));
            from = Some(part.stop);
        }
        let most = |place: usize| f64::from(parts[order[place]].most[layers[place]]);
        let mut value: f64 = (0..order.len()).map(most).sum();
        let (mut done, price) = (0, self.price.of(now));
        while done < order.len() && score(value, now) - price > floor {
            let (part, layer) = (&parts[order[done]], layers[done]);
            let mut sum = part.alone[layer];
            for &(cell, seen) in &part.shared {
                let p = seen * self.left[cell as usize];
                sum += p * self.discounts[self.discount[cell as usize] as usize][layer];
                self.left[cell as usize] -= p;
            }
            self.budget = self.budget.saturating_sub(part.shared.len());
            value += f64::from(sum) - most(done);
            done += 1;
        }
        for &(cell, _) in order[..done].iter().flat_map(|&k| &parts[k].shared) {
            self.left[cell as usize] = self.weight[cell as usize];
        }
        score(value, now) - price
    }

    fn keep_better(&mut self, parts: &[Part], order: &mut Vec<usize>, other: Vec<usize>, best: f64) -> f64 {
        if self.budget == 0 {
            return best;
        }
        let better = best + 1e-9 * best.abs();
        let score = self.score_of(parts, &other, better);
        if score > better {
            *order = other;
            return score;
        }
        best
    }

    /// An upper bound on any tour's marginal value: its best stops, each as early as can be, no overlap.
    fn relaxed(&self) -> f64 {
        let mut gains = self.ceilings();
        gains.sort_unstable_by(|a, b| b.total_cmp(a));
        gains.iter().take(self.max_stops).map(|&g| f64::from(g)).sum()
    }
}

/// A stop of a tour that is being improved.
struct Part {
    stop: usize,
    most: [f32; LAYERS],     // what it adds, by layer, before any other stop of the tour
    alone: [f32; LAYERS],    // what it adds, by layer, over cells that no other stop of the tour sees
    shared: Vec<(u32, f32)>, // the other cells of its footprint (local), and how surely it sees them
}

/// Value with ties inside a time layer broken towards the tour that ends [s] sooner.
fn score(value: f64, end: f32) -> f64 {
    value * (1.0 - 1e-4 * f64::from(end.min(1e3)) / 1e3)
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
/// `dearer`: how much dearer the tour becomes by an end [s].
fn best_place(
    stops: &Stops,
    stop: usize,
    table: &[f32; LAYERS],
    tour: &[usize],
    held: usize,
    arrivals: &[f32],
    present: &[[f32; LAYERS]],
    dearer: impl Fn(f32) -> f32,
) -> (f32, usize) {
    let mut best = (0.0_f32, 0);
    for place in held..=tour.len() {
        let from = place.checked_sub(1).map(|i| tour[i]);
        let start = place.checked_sub(1).map_or(0.0, |i| arrivals[i]);
        let arrival = start + stops.leg(from, stop);
        if !arrival.is_finite() {
            continue;
        }
        let (mut gain, mut end) = (table[stops.layer(arrival)], arrival);
        if gain <= 0.0 {
            continue; // cheap as it may be to go there
        }
        if let Some(&next) = tour.get(place) {
            let delay = arrival + stops.leg(Some(stop), next) - arrivals[place];
            if !delay.is_finite() {
                continue;
            }
            end = arrivals[tour.len() - 1] + delay;
            for (later, worth) in arrivals[place..].iter().zip(&present[place..]) {
                gain += worth[stops.layer(later + delay)] - worth[stops.layer(*later)];
            }
        }
        // A hair less for a later arrival: inside a layer the nearer stop comes first.
        gain *= 1.0 - 1e-4 * arrival.min(1e3) / 1e3;
        gain -= dearer(end);
        if gain > best.0 {
            best = (gain, place);
        }
    }
    best
}

pub struct Reply {
    pub tour: Vec<i64>,
    pub gain: f64,         // marginal value of `tour`, less its price
    pub current_gain: f64, // of the current tour
}

/// The best tour found against the rest of the team, by greedy insertion and 2-opt.
///
/// One search starts from nothing, another from the current tour and leaves its first stop in place: the
/// robot is on its way there, so to turn away must pay by the share `stickiness` of what it shows, and by `margin`.
pub fn best_tour(
    stops: Stops,
    worth: &Worth,
    layer_weights: &[f64],
    others: (&[u32], &[u8]),
    current: &[i64],
    max_stops: usize,
    (stickiness, margin): (f64, f64),
    price: EndPrice,
) -> Reply {
    let mut tours = Tours::new(stops, worth, layer_weights, others, max_stops, price);
    let current: Vec<usize> = current.iter().map(|&stop| stop as usize).collect();
    let current_gain = tours.net(&current);
    let mut alone: Vec<_> = tours.ceilings().iter().map(|gain| [gain * OVER; LAYERS]).collect();
    let mut best = tours.search(Vec::new(), 0, &mut alone);
    if !current.is_empty() {
        let kept = tours.search(current, 1, &mut alone);
        let (shown, end) = tours.value(&kept);
        if tours.score(&best) <= score(shown, end) * (1.0 + stickiness) - price.of(end) + margin {
            best = kept;
        }
    }
    let gain = tours.net(&best);
    Reply { tour: best.iter().map(|&stop| stop as i64).collect(), gain, current_gain }
}

/// No tour adds more than this to the team's impact.  docs/mapping.md (V26)
pub fn most_any_tour_adds(
    stops: Stops,
    worth: &Worth,
    layer_weights: &[f64],
    team: (&[u32], &[u8]),
    max_stops: usize,
) -> f64 {
    Tours::new(stops, worth, layer_weights, team, max_stops, EndPrice::FREE).relaxed()
}
