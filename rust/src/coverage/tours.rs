//! The best reply by tours: greedy insertion and 2-opt against the rest of the team.

mod gains;
mod improvement;
mod insertion;
mod price;
mod stops;

pub use price::EndPrice;
pub use stops::{number_cells, Stops};

use super::worth::Worth;
use super::LAYERS;
use gains::Gains;

/// One platform's choice of a tour against the others' impact.
#[derive(Clone, Copy)]
pub struct TourProblem<'a> {
    pub stops: Stops<'a>,
    pub worth: Worth<'a>,
    pub layer_weights: &'a [f64],      // (LAYERS)
    pub others: (&'a [u32], &'a [u8]), // sparse impact
    pub price: EndPrice,
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
    problem: TourProblem,
    current: &[i64],
    max_stops: usize,
    (stickiness, margin): (f64, f64),
) -> Reply {
    let mut search = Search::new(problem, max_stops);
    let current: Vec<usize> = current.iter().map(|&stop| stop as usize).collect();
    let current_gain = search.net(&current);
    let mut alone: Vec<_> = search.gains.ceilings().iter().map(|gain| [gain * OVER; LAYERS]).collect();
    let mut best = search.run(Vec::new(), 0, &mut alone);
    if !current.is_empty() {
        let kept = search.run(current, 1, &mut alone);
        let (shown, price) = search.shown_and_price(&kept);
        if search.score(&best) <= shown * (1.0 + stickiness) - price + margin {
            best = kept;
        }
    }
    let gain = search.net(&best);
    Reply { tour: best.iter().map(|&stop| stop as i64).collect(), gain, current_gain }
}

/// No tour adds more than this to the team's impact: its best stops, each as early as can be, no overlap.
/// docs/mapping.md (V26)
pub fn most_any_tour_adds(problem: TourProblem, max_stops: usize) -> f64 {
    let mut gains = Gains::new(&problem).ceilings();
    gains.sort_unstable_by(|a, b| b.total_cmp(a));
    gains.iter().take(max_stops).map(|&gain| f64::from(gain)).sum()
}

/// Bounds the time of a reply where footprints are vast; in an office it is never used up.
const BUDGET: usize = 75_000;
/// No sum over a footprint is larger by another order of its terms.
const OVER: f32 = 1.001;

/// A search for a tour.
struct Search<'a> {
    gains: Gains<'a>,
    price: EndPrice,
    stay: f32, // when a tour without stops ends, for its price [s]: to stay costs what the farthest stop does
    max_stops: usize,
    held: usize,   // stops at the head of the tour that are left where they are
    budget: usize, // shared footprint entries that may still be visited to improve the tour
}

impl<'a> Search<'a> {
    fn new(problem: TourProblem<'a>, max_stops: usize) -> Self {
        let reached = problem.stops.first_leg.iter().copied().filter(|leg| leg.is_finite());
        let stay = reached.fold(0.0, f32::max);
        Search { gains: Gains::new(&problem), price: problem.price, stay, max_stops, held: 0, budget: 0 }
    }

    /// Complete and improve a tour, leaving its first `held` stops in place.
    ///
    /// `alone` holds at least what each stop adds in every layer before any other; where a search that starts from
    /// nothing looks more closely, the next search has the exact figure.
    fn run(&mut self, mut tour: Vec<usize>, held: usize, alone: &mut [[f32; LAYERS]]) -> Vec<usize> {
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

    /// When a tour ends [s].
    fn end(&self, tour: &[usize]) -> f32 {
        self.gains.stops.arrivals(tour.iter().copied()).last().unwrap_or(self.stay)
    }

    /// The exact marginal value of a tour, less its price.
    fn net(&mut self, tour: &[usize]) -> f64 {
        self.gains.value(tour) - self.price.of(self.end(tour))
    }

    /// What a search goes by: as `net`, with ties broken.
    fn score(&mut self, tour: &[usize]) -> f64 {
        let (shown, price) = self.shown_and_price(tour);
        shown - price
    }

    fn shown_and_price(&mut self, tour: &[usize]) -> (f64, f64) {
        let end = self.end(tour);
        (sooner_first(self.gains.value(tour), end), self.price.of(end))
    }
}

/// Value with ties inside a time layer broken towards the tour that ends [s] sooner.
fn sooner_first(value: f64, end: f32) -> f64 {
    value * (1.0 - 1e-4 * f64::from(end.min(1e3)) / 1e3)
}
