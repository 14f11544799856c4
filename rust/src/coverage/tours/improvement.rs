//! Better orders of a tour's stops: moves of one stop, and 2-opt.

use super::{sooner_first, Search, LAYERS};

/// Rounds of moves and turns, at most.
const ROUNDS: usize = 4;
/// A tour is better that is so by more than this share.
const HARDLY: f64 = 1e-9;

/// A stop of a tour that is being improved.
struct Part {
    stop: usize,
    most: [f32; LAYERS],     // what it adds, by layer, before any other stop of the tour
    alone: [f32; LAYERS],    // what it adds, by layer, over cells that no other stop of the tour sees
    shared: Vec<(u32, f32)>, // the other cells of its footprint (local), and how surely it sees them
}

impl Search<'_> {
    /// Move a stop or reverse a stretch as long as that helps and the budget lasts.
    pub(super) fn improve(&mut self, tour: &mut [usize]) {
        let parts = self.parts(tour);
        let mut order: Vec<usize> = (0..parts.len()).collect();
        let mut best = self.score_of(&parts, &order, f64::NEG_INFINITY);
        for _ in 0..ROUNDS {
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

    /// Take the other order, if it is better; return the score of the one that is left.
    fn keep_better(&mut self, parts: &[Part], order: &mut Vec<usize>, other: Vec<usize>, best: f64) -> f64 {
        if self.budget == 0 {
            return best;
        }
        let better = best + HARDLY * best.abs();
        let score = self.score_of(parts, &other, better);
        if score > better {
            *order = other;
            return score;
        }
        best
    }

    /// Take the stops of a tour apart: in any order, cells that only one stop sees add what they add.
    fn parts(&mut self, tour: &[usize]) -> Vec<Part> {
        let stops = self.gains.stops;
        let mut visits = vec![0_u8; stops.cells.len()];
        for entry in tour.iter().flat_map(|&stop| stops.entries(stop)) {
            visits[stops.local[entry] as usize] += 1;
        }
        let part = |&stop: &usize| {
            let (alone, shared): (Vec<usize>, Vec<usize>) =
                stops.entries(stop).partition(|&entry| visits[stops.local[entry] as usize] == 1);
            let shared =
                shared.into_iter().map(|entry| (stops.local[entry], self.gains.seen(entry))).collect();
            let most = self.gains.by_layer(stop);
            Part { stop, most, alone: self.gains.sum_by_layer(alone.into_iter()), shared }
        };
        tour.iter().map(part).collect()
    }

    /// The score of the parts in this order; any smaller number if that is not above `floor`.
    fn score_of(&mut self, parts: &[Part], order: &[usize], floor: f64) -> f64 {
        let (stops, mut end) = (self.gains.stops, 0.0);
        let mut layers = Vec::with_capacity(order.len());
        for arrival in stops.arrivals(order.iter().map(|&k| parts[k].stop)) {
            if !arrival.is_finite() {
                return f64::NEG_INFINITY;
            }
            layers.push(stops.layer(arrival));
            end = arrival;
        }
        let most = |place: usize| f64::from(parts[order[place]].most[layers[place]]);
        let mut value: f64 = (0..order.len()).map(most).sum();
        let (mut done, price) = (0, self.price.of(end));
        while done < order.len() && sooner_first(value, end) - price > floor {
            let (part, layer) = (&parts[order[done]], layers[done]);
            let mut sum = part.alone[layer];
            for &(cell, seen) in &part.shared {
                sum += self.gains.take(cell, seen, layer);
            }
            self.budget = self.budget.saturating_sub(part.shared.len());
            value += f64::from(sum) - most(done);
            done += 1;
        }
        for &(cell, _) in order[..done].iter().flat_map(|&k| &parts[k].shared) {
            self.gains.forget_cell(cell);
        }
        sooner_first(value, end) - price
    }
}
