//! Sparse impacts: combining them, and what one adds to another.

use super::{Sparse, LAYERS, STEPS_PER_NAT};

/// The miss probability of every log-miss, `miss[q] = exp(-q / 16)` and 0 when saturated.
pub(super) fn miss_table() -> [f64; 256] {
    let mut table = [0.0; 256];
    for (q, miss) in table.iter_mut().enumerate().take(255) {
        *miss = (-(q as f64) / STEPS_PER_NAT).exp();
    }
    table
}

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
