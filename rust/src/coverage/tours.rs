//! The best reply by tours: greedy insertion and 2-opt against the rest of the team.

use super::impact::miss_table;
use super::LAYERS;

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
