//! What a look says of a position that is known as a Gaussian: the best line through the measurement.
//!
//! In the frame along the line of sight to the mean and across it. docs/tracking.md (V34)

use super::cloud::{direction, excess, Cloud};
use super::small::Sym;

const AGAIN: f64 = 4.0; // looks in which an error of the line comes back, for each distance moved
const MOST_AGAIN: f64 = 300.0;
const NARROWEST: f64 = 1e-7; // of the distance: a narrower Gaussian is a point to the last digits
const DEPENDENT: f64 = 1e-14; // share of a statistic's variance that the others leave, to count

/// What a sensor measures, with which standard deviations; 0: not at all.
#[derive(Clone, Copy)]
pub struct Sight {
    pub range: f64,
    pub bearing: f64,
    pub place: f64,
    /// Nearer than this a bearing says no more across than from here.
    pub min_range: f64,
    /// How far the sensor moves between looks.
    pub stride: f64,
}

/// Statistics of a measurement as a line `H x` in the position, with noise R.
pub struct Line {
    /// `H' R^-1 H` as xx, xy, yy.
    pub information: Sym,
    /// `H' R^-1`, by rows.
    pub gain: [[f64; 3]; 2],
    /// The statistics' means.
    pub expected: [f64; 3],
}

/// The line of statistics with rows H along and across the line of sight, `noise` R and means.
///
/// By elimination: `H' R^-1 H` is a sum of squares, so that it is semi-definite to the last digits. A
/// statistic that the ones before it leave no variance is left out.
fn weighed<const N: usize>(sight: [f64; 2], h: [[f64; 2]; N], noise: [[f64; N]; N], mean: [f64; N]) -> Line {
    let (mut l, mut used) = ([[0.0; N]; N], [true; N]);
    for i in 0..N {
        for j in 0..=i {
            let rest = noise[i][j] - (0..j).map(|m| l[i][m] * l[j][m]).sum::<f64>();
            if i == j {
                used[i] = rest > DEPENDENT * noise[i][i];
                l[i][i] = rest.max(f64::MIN_POSITIVE).sqrt();
            } else {
                l[i][j] = if used[j] { rest / l[j][j] } else { 0.0 };
            }
        }
    }
    let h =
        h.map(|[along, across]| [sight[0] * along - sight[1] * across, sight[1] * along + sight[0] * across]);
    let mut half = [[0.0; N]; 2]; // of H, by columns
    let mut line = Line { information: [0.0; 3], gain: [[0.0; 3]; 2], expected: [0.0; 3] };
    for axis in 0..2 {
        for i in (0..N).filter(|&i| used[i]) {
            let rest = h[i][axis] - (0..i).map(|m| l[i][m] * half[axis][m]).sum::<f64>();
            half[axis][i] = rest / l[i][i];
        }
        for i in (0..N).rev().filter(|&i| used[i]) {
            let rest = half[axis][i] - (i + 1..N).map(|m| l[m][i] * line.gain[axis][m]).sum::<f64>();
            line.gain[axis][i] = rest / l[i][i];
        }
    }
    let by = |i: usize, j: usize| (0..N).map(|n| half[i][n] * half[j][n]).sum::<f64>();
    line.information = [by(0, 0), by(0, 1), by(1, 1)];
    line.expected[..N].copy_from_slice(&mean);
    line
}

impl Sight {
    /// Most information in any direction, of a target whose place is known.
    pub fn most(&self) -> f64 {
        let inverse = |sigma: f64| if sigma > 0.0 { 1.0 / (sigma * sigma) } else { 0.0 };
        inverse(self.range).max(inverse(self.place)).max(inverse(self.min_range * self.bearing))
    }

    /// The line for a target in a direction at a distance, with variances along it, between and across.
    fn at(&self, sight: [f64; 2], distance: f64, covariance: Sym) -> (Line, Cloud) {
        let cloud = Cloud::new(distance, covariance, NARROWEST * distance.max(self.min_range));
        let square = distance * distance + covariance[0] + covariance[2];
        let again = (AGAIN * (square.sqrt() / self.stride).max(1.0)).min(MOST_AGAIN);
        let mut line = if self.place > 0.0 {
            let noise = self.place * self.place;
            weighed(sight, [[1.0, 0.0], [0.0, 1.0]], [[noise, 0.0], [0.0, noise]], [distance, 0.0])
        } else if self.bearing > 0.0 {
            self.turning(sight, &cloud, distance, covariance, square, again)
        } else {
            let (mean, slope, left) = cloud.regress(|at| [excess(at)]);
            let noise = self.range * self.range + again * left[0][0];
            weighed(sight, [[1.0 + slope[0][0], slope[0][1]]], [[noise]], [distance + mean[0]])
        };
        let [xx, xy, yy] = line.information;
        let largest = 0.5 * (xx + yy) + (0.5 * (xx - yy)).hypot(xy);
        let share = (self.most() / largest).min(1.0);
        line.information = line.information.map(|value| share * value);
        line.gain = line.gain.map(|row| row.map(|value| share * value));
        (line, cloud)
    }

    /// That of a sensor with a bearing: of its direction, or with a range of the place that both say.
    fn turning(
        &self,
        sight: [f64; 2],
        cloud: &Cloud,
        distance: f64,
        p: Sym,
        square: f64,
        again: f64,
    ) -> Line {
        let v = self.bearing * self.bearing;
        let (all, turned) = (v.sinh(), -(-v).exp_m1());
        let least = 2.0 * (0.5 * v).sinh().powi(2); // all - turned
        let near = (self.min_range * self.min_range / square).max(1.0);
        let (mut cs, mut ss) = (0.0, 0.0); // E cos sin, E sin^2
        for (at, weight, _) in &cloud.points {
            let [cosine, sine] = direction(*at);
            cs += weight * (1.0 + cosine) * sine;
            ss += weight * sine * sine;
        }
        if self.range <= 0.0 {
            let (mean, slope, left) = cloud.regress(direction);
            let mut noise = left.map(|row| row.map(|value| again * value));
            noise[0][0] += near * (least + turned * ss);
            noise[0][1] -= near * turned * cs;
            noise[1][0] -= near * turned * cs;
            noise[1][1] += near * (all - turned * ss);
            return weighed(sight, slope, noise, [1.0 + mean[0], mean[1]]);
        }
        let (mean, slope, left) = cloud.regress(|at| {
            let [cosine, sine] = direction(at);
            [excess(at), cosine, sine]
        });
        let r = self.range * self.range;
        let xx = near * (least * square + turned * p[2]) + r * (all + (1.0 - turned) * (1.0 - ss));
        let xy = -near * turned * p[1] + r * (1.0 - turned) * cs;
        let yy = near * (all * square - turned * p[2]) + r * (all + (1.0 - turned) * ss);
        let (rx, ry) = (r * (1.0 + mean[1]), r * mean[2]);
        let rr = r + again * left[0][0];
        weighed(
            sight,
            [[1.0, 0.0], [0.0, 1.0], [1.0 + slope[0][0], slope[0][1]]],
            [[xx, xy, rx], [xy, yy, ry], [rx, ry, rr]],
            [distance, 0.0, distance + mean[0]],
        )
    }

    /// The line in the axes of the offset (x, y) and its covariance.
    pub fn line(&self, offset: [f64; 2], covariance: Sym) -> Line {
        let (distance, sight) = polar(offset);
        self.at(sight, distance, turned(covariance, sight)).0
    }

    /// Information about what is in view, times the share of the Gaussian that is; 0 where the mean is not.
    pub fn foreseen(&self, offset: [f64; 2], heading: f64, covariance: Sym, range: f64, half: f64) -> Sym {
        let (distance, sight) = polar(offset);
        let (s, c) = heading.sin_cos();
        let (along, across) = (c * sight[0] + s * sight[1], c * sight[1] - s * sight[0]);
        let all_round = half >= std::f64::consts::PI;
        let edge = half.cos();
        let sees = |[x, y]: [f64; 2]| {
            let r = x.hypot(y);
            r <= range && (all_round || x * along - y * across >= edge * r)
        };
        if !sees([distance, 0.0]) {
            return [0.0; 3];
        }
        let (line, cloud) = self.at(sight, distance, turned(covariance, sight));
        let share: f64 =
            cloud.points.iter().filter(|(at, _, _)| sees(*at)).map(|(_, weight, _)| weight).sum();
        line.information.map(|value| share.min(1.0) * value)
    }
}

/// Length and direction of an offset.
fn polar([x, y]: [f64; 2]) -> (f64, [f64; 2]) {
    let r = x.hypot(y);
    (r, if r > 0.0 { [x / r, y / r] } else { [1.0, 0.0] })
}

/// A symmetric matrix in axes turned by the angle of these cosine and sine.
fn turned([xx, xy, yy]: Sym, [c, s]: [f64; 2]) -> Sym {
    [
        c * c * xx + 2.0 * c * s * xy + s * s * yy,
        c * s * (yy - xx) + (c * c - s * s) * xy,
        s * s * xx - 2.0 * c * s * xy + c * c * yy,
    ]
}
