//! What looks along a path detect in each cell.

use super::spread::Grid;

pub struct Detector<'a> {
    /// Probability of detection in equal steps of the squared distance, up to the range.
    pub table: &'a [f64],
    pub range: f64,
    pub view: f64,
}

type Sparse = (Vec<i64>, Vec<u32>, Vec<f64>);

/// For each row of `looks` poses: the cells and the probability that at least one look detects a target there.
///
/// The target is anywhere in the cell: the mean over `samples * samples` points.
pub fn footprints(
    grid: Grid,
    resolution: f64,
    poses: &[f64],
    looks: usize,
    detector: &Detector,
    samples: usize,
) -> Sparse {
    let (mut starts, mut cells, mut shares) = (vec![0], Vec::new(), Vec::new());
    let miss: Vec<f64> = detector.table.iter().map(|chance| 1.0 - chance).collect();
    let spacing = resolution / samples as f64;
    for looks in poses.chunks_exact((3 * looks).max(1)) {
        let (rows, cols) = window(grid, resolution, looks, detector.range);
        let mut points = Points::new(rows, cols, samples, spacing);
        for pose in looks.chunks_exact(3) {
            points.look(pose, detector, &miss);
        }
        for row in rows.0..rows.1 {
            for col in cols.0..cols.1 {
                let share = points.detected(row - rows.0, col - cols.0, samples);
                if share > 0.0 {
                    cells.push((row * grid.cols + col) as u32);
                    shares.push(share);
                }
            }
        }
        starts.push(cells.len() as i64);
    }
    (starts, cells, shares)
}

/// The probability of having missed a target at each of the points that stand for the cells of a window.
struct Points {
    first: (usize, usize), // row and column of points, counted from the grid's corner
    rows: usize,
    cols: usize,
    spacing: f64,
    missed: Vec<f64>,
}

impl Points {
    fn new(rows: (usize, usize), cols: (usize, usize), samples: usize, spacing: f64) -> Points {
        let (height, width) = ((rows.1 - rows.0) * samples, (cols.1 - cols.0) * samples);
        let first = (rows.0 * samples, cols.0 * samples);
        Points { first, rows: height, cols: width, spacing, missed: vec![1.0; height * width] }
    }

    fn look(&mut self, pose: &[f64], detector: &Detector, miss: &[f64]) {
        let square = detector.range * detector.range;
        let scale = miss.len() as f64 / square;
        let all_round = detector.view >= std::f64::consts::TAU;
        let (facing, cos_half_view) = ((pose[2].cos(), pose[2].sin()), (detector.view / 2.0).cos());
        let near = |y: f64| (y / self.spacing - self.first.0 as f64).clamp(0.0, self.rows as f64);
        let rows = near(pose[1] - detector.range - self.spacing).floor() as usize
            ..near(pose[1] + detector.range + self.spacing).ceil() as usize;
        for row in rows {
            let dy = ((self.first.0 + row) as f64 + 0.5) * self.spacing - pose[1];
            let half_chord = (square - dy * dy).max(0.0).sqrt();
            // A point more on each side: the exact test is below.
            let place = |x: f64| (x / self.spacing - self.first.1 as f64).clamp(0.0, self.cols as f64);
            let from = place(pose[0] - half_chord - 1.5 * self.spacing).floor() as usize;
            let to = place(pose[0] + half_chord + 1.5 * self.spacing).ceil() as usize;
            let missed = &mut self.missed[row * self.cols..][from..to];
            for (i, missed) in missed.iter_mut().enumerate() {
                let dx = ((self.first.1 + from + i) as f64 + 0.5) * self.spacing - pose[0];
                let away = dx * dx + dy * dy;
                let ahead = || dx * facing.0 + dy * facing.1 >= cos_half_view * away.sqrt();
                if away <= square && (all_round || ahead()) {
                    *missed *= miss[((away * scale) as i32 as usize).min(miss.len() - 1)];
                }
            }
        }
    }

    fn detected(&self, row: usize, col: usize, samples: usize) -> f64 {
        let rows = self.missed[row * samples * self.cols..].chunks_exact(self.cols).take(samples);
        let missed: f64 = rows.map(|row| row[col * samples..][..samples].iter().sum::<f64>()).sum();
        1.0 - missed / (samples * samples) as f64
    }
}

/// The rows and columns within range of any look.
fn window(grid: Grid, resolution: f64, looks: &[f64], range: f64) -> ((usize, usize), (usize, usize)) {
    let span = |axis: usize, n: usize| {
        let places = looks.iter().skip(axis).step_by(3);
        let (low, high) = places.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), place| {
            (low.min(place - range), high.max(place + range))
        });
        let clip = |edge: f64| edge.clamp(0.0, n as f64) as usize;
        (clip((low / resolution).floor()), clip((high / resolution).ceil()))
    };
    (span(1, grid.rows), span(0, grid.cols))
}
