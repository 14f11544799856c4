//! Sparse impacts: combining them, and what one adds to another.

use super::worth::Worth;
use super::{Sparse, LAYERS, STEPS_PER_NAT};

/// The miss probability of every log-miss, `miss[q] = exp(-q / 16)` and 0 when saturated.
pub(super) fn miss_table() -> [f64; 256] {
    let mut table = [0.0; 256];
    for (q, miss) in table.iter_mut().enumerate().take(255) {
        *miss = (-(q as f64) / STEPS_PER_NAT).exp();
    }
    table
}

/// `a * b`: log-misses add, saturating; within a cell of so many layers nothing is left after certainty.
/// docs/mapping.md (V20)
///
/// Of each of them this has to hold already.
pub fn combine(a: (&[u32], &[u8]), b: (&[u32], &[u8]), layers: u32) -> Sparse {
    let mut keys = Vec::with_capacity(a.0.len() + b.0.len());
    let mut misses = Vec::with_capacity(a.0.len() + b.0.len());
    let mut take = |from: (&[u32], &[u8]), first: usize, end: usize| {
        keys.extend_from_slice(&from.0[first..end]);
        misses.extend_from_slice(&from.1[first..end]);
    };
    let (mut i, mut j) = (0, 0);
    let mut cell: Sparse = (Vec::new(), Vec::new());
    while i < a.0.len() && j < b.0.len() {
        let (cell_a, cell_b) = (a.0[i] / layers, b.0[j] / layers);
        if cell_a < cell_b {
            let end = i + before(&a.0[i..], cell_b * layers);
            take(a, i, end);
            i = end;
        } else if cell_b < cell_a {
            let end = j + before(&b.0[j..], cell_a * layers);
            take(b, j, end);
            j = end;
        } else {
            let last = (cell_a * layers).saturating_add(layers - 1);
            let (end_a, end_b) = (i + up_to(&a.0[i..], last), j + up_to(&b.0[j..], last));
            cell.0.clear();
            cell.1.clear();
            combine_cell((&a.0[i..end_a], &a.1[i..end_a]), (&b.0[j..end_b], &b.1[j..end_b]), &mut cell);
            take((&cell.0, &cell.1), 0, cell.0.len());
            (i, j) = (end_a, end_b);
        }
    }
    take(a, i, a.0.len());
    take(b, j, b.0.len());
    (keys, misses)
}

/// How many keys at the head are below a bound that the first of them is below.
fn before(keys: &[u32], bound: u32) -> usize {
    let mut most = 1;
    while most < keys.len() && keys[most] < bound {
        most = 2 * most + 1;
    }
    let least = most / 2;
    least + keys[least..most.min(keys.len())].partition_point(|&key| key < bound)
}

/// How many keys at the head are no greater than a key; they are few.
fn up_to(keys: &[u32], last: u32) -> usize {
    keys.iter().position(|&key| key > last).unwrap_or(keys.len())
}

/// The same for the entries of one cell.
fn combine_cell(a: (&[u32], &[u8]), b: (&[u32], &[u8]), cell: &mut Sparse) {
    let (mut i, mut j, mut so_far) = (0, 0, 0_u8);
    while (i < a.0.len() || j < b.0.len()) && so_far < u8::MAX {
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
        let more = miss.min(u8::MAX - so_far);
        so_far += more;
        cell.0.push(key_a.min(key_b));
        cell.1.push(more);
    }
}

/// What a certain sighting is worth by layer, in units of its cell's weight: suffix sums of the layers' weights.
fn worths(layer_weights: &[f64]) -> [f64; LAYERS] {
    let mut worths = [0.0; LAYERS];
    let mut sum = 0.0;
    for layer in (0..LAYERS).rev() {
        sum += layer_weights[layer];
        worths[layer] = sum;
    }
    worths
}

/// `value(others * own) - value(others)`, summed over the cells that `own` touches.
///
/// A cell's value is `sum_b w_b (1 - m(b))`, summed by parts: each entry adds the fall of the miss
/// probability at its layer times what a sighting there is worth.
pub fn marginal(
    worth: &Worth,
    layer_weights: &[f64],
    others: (&[u32], &[u8]),
    own: (&[u32], &[u8]),
    miss: &[f64; 256],
) -> f64 {
    let worths = worths(layer_weights);
    let cell_of = |key: u32| key / LAYERS as u32;
    let mut gain = 0.0;
    let (mut i, mut j) = (0, 0);
    while j < own.0.len() {
        let cell = cell_of(own.0[j]);
        i += others.0[i..].partition_point(|&key| cell_of(key) < cell);
        let weight = f64::from(worth.of(cell));
        let (mut alone, mut together) = (0_u8, 0_u8);
        let mut value = 0.0;
        loop {
            let theirs = others.0.get(i).filter(|&&key| cell_of(key) == cell);
            let mine = own.0.get(j).filter(|&&key| cell_of(key) == cell);
            let Some(&key) = theirs.into_iter().chain(mine).min() else { break };
            let before = miss[alone as usize] - miss[together as usize];
            if theirs == Some(&key) {
                alone = alone.saturating_add(others.1[i]);
                together = together.saturating_add(others.1[i]);
                i += 1;
            }
            if mine == Some(&key) {
                together = together.saturating_add(own.1[j]);
                j += 1;
            }
            let after = miss[alone as usize] - miss[together as usize];
            value += (after - before) * worths[key as usize % LAYERS];
        }
        gain += weight * value;
    }
    gain
}
