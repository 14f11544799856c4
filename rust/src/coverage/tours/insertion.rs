//! Greedy insertion: the stop that adds most, where it adds most, again and again.

use super::{EndPrice, Search, Stops, LAYERS};

impl Search<'_> {
    /// Insert the stop that adds most, where it adds most, until nothing adds or the tour is full.
    ///
    /// `tables` holds at least what each stop adds in every layer: that only shrinks as the tour grows,
    /// so a table is brought up to date only when its stop looks best.
    pub(super) fn insert_greedily(&mut self, tour: &mut Vec<usize>, tables: &mut [[f32; LAYERS]]) {
        while tour.len() < self.max_stops.min(self.gains.stops.len()) {
            let Some((stop, place)) = self.best_insertion(tour, tables) else { return };
            let before = self.score(tour);
            tour.insert(place, stop);
            if self.score(tour) <= before {
                tour.remove(place);
                return;
            }
        }
    }

    /// The stop that adds most to a tour, and where in it; None: none adds anything.
    pub(super) fn best_insertion(
        &mut self,
        tour: &[usize],
        tables: &mut [[f32; LAYERS]],
    ) -> Option<(usize, usize)> {
        let present = self.present(tour);
        let place = |stop: usize, table: &[f32; LAYERS]| match tour.contains(&stop) {
            true => (0.0, 0),
            false => present.best_place(stop, table),
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
            tables[stop] = self.gains.by_layer(stop);
            best[stop] = place(stop, &tables[stop]);
            exact[stop] = true;
        };
        self.gains.forget(tour);
        found
    }

    /// Look from all stops of a tour, in order.
    fn present<'t>(&mut self, tour: &'t [usize]) -> Present<'t>
    where
        Self: 't,
    {
        let stops = self.gains.stops;
        let arrivals: Vec<f32> = stops.arrivals(tour.iter().copied()).collect();
        let worths = tour
            .iter()
            .map(|&stop| {
                let worth = self.gains.by_layer(stop);
                self.gains.observe(stop);
                worth
            })
            .collect();
        Present { stops, tour, end: self.end(tour), arrivals, worths, held: self.held, price: self.price }
    }
}

/// A tour into which a stop is to be inserted.
struct Present<'a> {
    stops: Stops<'a>,
    tour: &'a [usize],
    arrivals: Vec<f32>,         // at its stops [s]
    worths: Vec<[f32; LAYERS]>, // what each stop adds in every layer, given the stops before it
    end: f32,                   // [s]
    held: usize,                // stops at its head that are left where they are
    price: EndPrice,
}

impl Present<'_> {
    /// Where a stop adds most, and how much: what it sees, less what it delays, and what it makes the end dearer.
    /// `table`: what it adds in every layer.
    fn best_place(&self, stop: usize, table: &[f32; LAYERS]) -> (f32, usize) {
        let (stops, tour, arrivals) = (&self.stops, self.tour, &self.arrivals);
        let mut best = (0.0_f32, 0);
        for place in self.held..=tour.len() {
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
                for (later, worth) in arrivals[place..].iter().zip(&self.worths[place..]) {
                    gain += worth[stops.layer(later + delay)] - worth[stops.layer(*later)];
                }
            }
            // A hair less for a later arrival: inside a layer the nearer stop comes first.
            gain *= 1.0 - 1e-4 * arrival.min(1e3) / 1e3;
            gain -= (self.price.of(end) - self.price.of(self.end)) as f32;
            if gain > best.0 {
                best = (gain, place);
            }
        }
        best
    }
}
