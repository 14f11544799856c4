//! A Gaussian position as points, and functions of it as lines through them.

use super::small::Sym;

/// Gauss-Hermite nodes and weights of a standard normal, 4 an axis.
const NODES: [(f64, f64); 4] = [
    (-2.334_414_218_338_977, 0.045_875_854_768_068_5),
    (-0.741_963_784_302_725_8, 0.454_124_145_231_931_45),
    (0.741_963_784_302_725_8, 0.454_124_145_231_931_45),
    (2.334_414_218_338_977, 0.045_875_854_768_068_5),
];

/// A Gaussian's points along and across the line of sight: place, weight and standard normal coordinates.
pub struct Cloud {
    pub points: [([f64; 2], f64, [f64; 2]); 16],
    lower: [f64; 3],
}

impl Cloud {
    /// About a mean at a distance, with variances along, between and across.
    pub fn new(distance: f64, covariance: Sym, narrowest: f64) -> Self {
        let [along, between, across] = covariance;
        let a = along.max(narrowest * narrowest).sqrt();
        let b = between / a;
        let c = (across - b * b).max(narrowest * narrowest).sqrt();
        let mut points = [([0.0; 2], 0.0, [0.0; 2]); 16];
        for (i, &(u, wu)) in NODES.iter().enumerate() {
            for (j, &(v, wv)) in NODES.iter().enumerate() {
                points[4 * i + j] = ([distance + a * u, b * u + c * v], wu * wv, [u, v]);
            }
        }
        Cloud { points, lower: [a, b, c] }
    }

    /// Means, regression on the position and covariance of what it leaves, of N functions of the position.
    pub fn regress<const N: usize>(
        &self,
        f: impl Fn([f64; 2]) -> [f64; N],
    ) -> ([f64; N], [[f64; 2]; N], [[f64; N]; N]) {
        let values = self.points.map(|(at, _, _)| f(at));
        let (mut mean, mut slope, mut left) = ([0.0; N], [[0.0; 2]; N], [[0.0; N]; N]);
        for ((_, weight, xi), value) in self.points.iter().zip(&values) {
            for n in 0..N {
                mean[n] += weight * value[n];
                slope[n][0] += weight * value[n] * xi[0];
                slope[n][1] += weight * value[n] * xi[1];
            }
        }
        for ((_, weight, xi), value) in self.points.iter().zip(&values) {
            let off: [f64; N] =
                std::array::from_fn(|n| value[n] - mean[n] - slope[n][0] * xi[0] - slope[n][1] * xi[1]);
            for i in 0..N {
                for j in 0..N {
                    left[i][j] += weight * off[i] * off[j];
                }
            }
        }
        let [a, b, c] = self.lower;
        for row in &mut slope {
            row[1] /= c;
            row[0] = (row[0] - row[1] * b) / a;
        }
        (mean, slope, left)
    }
}

/// The range beyond the distance along, `|x| - x`, without loss of digits.
pub fn excess([x, y]: [f64; 2]) -> f64 {
    let r = x.hypot(y);
    if x > 0.0 {
        y * y / (r + x)
    } else {
        r - x
    }
}

/// Cosine less 1, and sine, of the direction.
pub fn direction([x, y]: [f64; 2]) -> [f64; 2] {
    let r = x.hypot(y);
    if r == 0.0 {
        [0.0, 0.0]
    } else {
        [-excess([x, y]) / r, y / r]
    }
}
