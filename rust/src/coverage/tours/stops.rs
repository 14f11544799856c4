//! What one platform knows of its stops, fixed for a round: footprints and legs.

use std::ops::Range;

use super::LAYERS;

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
    pub(super) fn len(&self) -> usize {
        self.first_leg.len()
    }

    /// The entries of a stop's footprint.
    pub(super) fn entries(&self, stop: usize) -> Range<usize> {
        self.starts[stop] as usize..self.starts[stop + 1] as usize
    }

    /// The time layer of an arrival [s].
    pub(super) fn layer(&self, arrival: f32) -> usize {
        self.edges.partition_point(|&edge| edge < f64::from(arrival)).min(LAYERS - 1)
    }

    /// Seconds to a stop; `from`: another, or none: from here.
    pub(super) fn leg(&self, from: Option<usize>, to: usize) -> f32 {
        match from {
            None => self.first_leg[to],
            Some(stop) => self.legs[stop * self.len() + to],
        }
    }

    /// When a tour arrives at each of its stops [s].
    pub(super) fn arrivals<'t>(
        &'t self,
        tour: impl Iterator<Item = usize> + 't,
    ) -> impl Iterator<Item = f32> + 't {
        let (mut now, mut from) = (0.0, None);
        tour.map(move |stop| {
            now += self.leg(from.replace(stop), stop);
            now
        })
    }

    /// The earliest arrival at each stop by way of any others, which may be earlier than going straight:
    /// legs between stops come from a coarser grid than the first leg (Dijkstra, dense).
    pub(super) fn earliest(&self) -> Vec<f32> {
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
