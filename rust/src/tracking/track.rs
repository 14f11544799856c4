//! One Gaussian track over a horizon: what a sequence of position information is worth, and its gradient.

use super::small::{congruent, filled, inverse, log_det, mirrored, transposed, Mat, Sym, ZERO};

/// What is asked of the tracks at the end of the horizon.
#[derive(Clone, Copy, PartialEq)]
pub enum Measure {
    /// Entropy taken off the whole trajectory: `sum_k 1/2 ln det(I + P_{k|k-1} I_k)`.
    Trajectory,
    /// Entropy of the last state, negative and up to a constant.
    FinalLogDet,
    /// Position variance of the last state, negative.
    FinalTrace,
}

/// A target's covariance at the start and its motion in one step: `P' = F P F' + Q`.
pub struct Track {
    pub covariance: Mat,
    pub transition: Mat,
    pub noise: Mat,
}

/// What position information does to a predicted covariance.
struct Update {
    posterior: Mat,
    /// `I^-1 + A` inverted, as `(1 + I A)^-1 I`: what the prediction loses is this, seen through `P H'`.
    loss: Sym,
    /// `det(1 + A I) - 1`.
    growth: f64,
}

/// `(P^-1 + H' I H)^-1` in closed form: sums of positive terms in the position block, so that neither weak
/// nor strong nor rank-one information loses digits.
fn update(p: &Mat, info: Sym) -> Update {
    let [jxx, jxy, jyy] = info;
    let (axx, axy, ayy) = (p[0][0], p[0][1], p[1][1]);
    let (det_a, det_j) = (axx * ayy - axy * axy, jxx * jyy - jxy * jxy);
    let growth = axx * jxx + 2.0 * axy * jxy + ayy * jyy + det_a * det_j;
    let det = 1.0 + growth;
    let loss = [(jxx + det_j * ayy) / det, (jxy - det_j * axy) / det, (jyy + det_j * axx) / det];
    let inflow = [
        [(1.0 + axy * jxy + ayy * jyy) / det, -(axx * jxy + axy * jyy) / det],
        [-(axy * jxx + ayy * jxy) / det, (1.0 + axx * jxx + axy * jxy) / det],
    ]; // (1 + A I)^-1
    let posterior = mirrored(|i, j| match (i, j) {
        (0, 0) => (axx + det_a * jyy) / det,
        (0, 1) => (axy - det_a * jxy) / det,
        (1, 1) => (ayy + det_a * jxx) / det,
        (0 | 1, _) => inflow[i][0] * p[0][j] + inflow[i][1] * p[1][j],
        _ => p[i][j] - between(&p[i], loss, &p[j]),
    });
    Update { posterior, loss, growth }
}

/// `a' m b` over the position part of two rows.
fn between(a: &[f64; 4], m: Sym, b: &[f64; 4]) -> f64 {
    a[0] * (m[0] * b[0] + m[1] * b[1]) + a[1] * (m[1] * b[0] + m[2] * b[1])
}

impl Track {
    fn predict(&self, p: &Mat) -> Mat {
        let moved = congruent(&self.transition, p);
        mirrored(|i, j| moved[i][j] + self.noise[i][j])
    }

    /// The measure after this information at each step; gains are differences of it.
    pub fn score(&self, measure: Measure, steps: impl Iterator<Item = Sym>) -> f64 {
        let mut p = self.covariance;
        let mut sum = 0.0;
        for info in steps {
            let step = update(&self.predict(&p), info);
            sum += 0.5 * step.growth.ln_1p();
            p = step.posterior;
        }
        match measure {
            Measure::Trajectory => sum,
            Measure::FinalLogDet => -0.5 * log_det(&p),
            Measure::FinalTrace => -(p[0][0] + p[1][1]),
        }
    }

    /// Derivative of `score` by each entry of the information, one pass forward and one back.
    pub fn gradient(&self, measure: Measure, infos: &[Sym], out: &mut [Sym]) {
        let mut p = self.covariance;
        let mut steps = Vec::with_capacity(infos.len());
        for &info in infos {
            let prior = self.predict(&p);
            let step = update(&prior, info);
            p = step.posterior;
            steps.push((prior, step));
        }
        let own = if measure == Measure::Trajectory { 0.5 } else { 0.0 };
        let mut later = match measure {
            Measure::Trajectory => ZERO,
            Measure::FinalLogDet => inverse(&p).map(|row| row.map(|value| -0.5 * value)),
            Measure::FinalTrace => filled(|i, j| if i == j && i < 2 { -1.0 } else { 0.0 }),
        }; // by the posterior covariance
        let back = transposed(&self.transition);
        for ((prior, step), slope) in steps.iter().zip(out).rev() {
            let q = &step.posterior;
            let seen = congruent(q, &later);
            let by = |i: usize, j: usize| own * q[i][j] - seen[i][j];
            *slope = [by(0, 0), 2.0 * by(0, 1), by(1, 1)];
            // P_k = keep P_{k|k-1}, keep = 1 - P_{k|k-1} H' loss H
            let m = step.loss;
            let keep = filled(|i, j| {
                let unit = if i == j { 1.0 } else { 0.0 };
                match j {
                    0 => unit - (prior[i][0] * m[0] + prior[i][1] * m[1]),
                    1 => unit - (prior[i][0] * m[1] + prior[i][1] * m[2]),
                    _ => unit,
                }
            });
            let mut by_prior = congruent(&transposed(&keep), &later);
            for (i, j, value) in [(0, 0, m[0]), (0, 1, m[1]), (1, 0, m[1]), (1, 1, m[2])] {
                by_prior[i][j] += own * value;
            }
            later = congruent(&back, &by_prior);
        }
    }
}
