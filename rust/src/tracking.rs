//! Target tracking: what the candidates of a platform add to the team's information about Gaussian tracks.
//!
//! Information is sparse: targets in ascending order, and for each a block of `steps` symmetric 2x2 matrices.

mod cloud;
pub mod look;
pub mod small;
pub mod track;

use numpy::{
    IntoPyArray, PyArray1, PyArray2, PyArray3, PyArray4, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2,
    PyReadonlyArray3, PyUntypedArrayMethods,
};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use look::Sight;
use small::{Mat, Sym};
use track::{Measure, Track};

const NOBODY: usize = usize::MAX;

/// The tracks at the start of the horizon, each matrix 16 numbers a target.
#[derive(Clone, Copy)]
pub struct Tracks<'a> {
    pub covariances: &'a [f64],
    pub transitions: &'a [f64],
    pub noises: &'a [f64],
}

fn matrix(all: &[f64], t: usize) -> Mat {
    small::filled(|i, j| all[16 * t + 4 * i + j])
}

impl Tracks<'_> {
    fn count(&self) -> usize {
        self.covariances.len() / 16
    }

    fn get(&self, t: usize) -> Track {
        Track {
            covariance: matrix(self.covariances, t),
            transition: matrix(self.transitions, t),
            noise: matrix(self.noises, t),
        }
    }
}

/// Sparse information: `blocks` has `steps` matrices of 3 numbers for each of `targets`.
#[derive(Clone, Copy)]
pub struct Sparse<'a> {
    pub targets: &'a [i64],
    pub blocks: &'a [f64],
    pub steps: usize,
}

impl Sparse<'_> {
    fn at(&self, row: usize, step: usize) -> Sym {
        if row == NOBODY {
            return [0.0; 3];
        }
        let first = 3 * (row * self.steps + step);
        [self.blocks[first], self.blocks[first + 1], self.blocks[first + 2]]
    }

    /// Targets in range, and blocks of the right size.
    fn fits(&self, targets: usize) -> bool {
        self.blocks.len() == 3 * self.steps * self.targets.len()
            && self.targets.iter().all(|&t| t >= 0 && (t as usize) < targets)
    }
}

/// Gain over open loop of the others with each candidate, whose rows of `own` are `starts[c]..starts[c + 1]`.
pub fn values(tracks: Tracks, measure: Measure, others: Sparse, starts: &[i64], own: Sparse) -> Vec<f64> {
    let steps = others.steps;
    let mut row_of = vec![NOBODY; tracks.count()];
    let mut base = 0.0;
    for (row, &t) in others.targets.iter().enumerate() {
        row_of[t as usize] = row;
        let track = tracks.get(t as usize);
        let with = track.score(measure, (0..steps).map(|k| others.at(row, k)));
        base += with - track.score(measure, (0..steps).map(|_| [0.0; 3]));
    }
    let mut before = vec![f64::NAN; tracks.count()]; // score under the others alone, once a target
    let mut out = Vec::with_capacity(starts.len() - 1);
    for bounds in starts.windows(2) {
        let mut added = 0.0;
        for mine in bounds[0] as usize..bounds[1] as usize {
            let t = own.targets[mine] as usize;
            let track = tracks.get(t);
            let theirs = row_of[t];
            if before[t].is_nan() {
                before[t] = track.score(measure, (0..steps).map(|k| others.at(theirs, k)));
            }
            let both = (0..steps).map(|k| {
                let (a, b) = (others.at(theirs, k), own.at(mine, k));
                [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
            });
            added += track.score(measure, both) - before[t];
        }
        out.push(base + added);
    }
    out
}

fn measure_of(name: &str) -> PyResult<Measure> {
    match name {
        "trajectory" => Ok(Measure::Trajectory),
        "final-logdet" => Ok(Measure::FinalLogDet),
        "final-trace" => Ok(Measure::FinalTrace),
        _ => Err(PyValueError::new_err(format!("unknown measure {name:?}"))),
    }
}

type Matrices<'py> = PyReadonlyArray3<'py, f64>;

fn check(fits: bool, what: &str) -> PyResult<()> {
    if fits {
        Ok(())
    } else {
        Err(PyValueError::new_err(format!("{what} do not fit the tracks")))
    }
}

#[pyfunction(name = "track_values")]
fn py_track_values<'py>(
    py: Python<'py>,
    tracks: (Matrices<'py>, Matrices<'py>, Matrices<'py>),
    measure: &str,
    others: (PyReadonlyArray1<'py, i64>, Matrices<'py>),
    starts: PyReadonlyArray1<'py, i64>,
    own: (PyReadonlyArray1<'py, i64>, Matrices<'py>),
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let belief = Tracks {
        covariances: tracks.0.as_slice()?,
        transitions: tracks.1.as_slice()?,
        noises: tracks.2.as_slice()?,
    };
    let steps = others.1.shape()[1];
    let theirs = Sparse { targets: others.0.as_slice()?, blocks: others.1.as_slice()?, steps };
    let mine = Sparse { targets: own.0.as_slice()?, blocks: own.1.as_slice()?, steps };
    let starts = starts.as_slice()?;
    check(theirs.fits(belief.count()), "the others' blocks")?;
    check(mine.fits(belief.count()), "own blocks")?;
    let ordered = starts.first() == Some(&0) && starts.windows(2).all(|pair| pair[0] <= pair[1]);
    check(ordered && starts.last() == Some(&(mine.targets.len() as i64)), "starts")?;
    let measure = measure_of(measure)?;
    Ok(py.detach(|| values(belief, measure, theirs, starts, mine)).into_pyarray(py))
}

#[pyfunction(name = "track_gradient")]
fn py_track_gradient<'py>(
    py: Python<'py>,
    tracks: (Matrices<'py>, Matrices<'py>, Matrices<'py>),
    measure: &str,
    team: (PyReadonlyArray1<'py, i64>, Matrices<'py>),
) -> PyResult<Bound<'py, PyArray3<f64>>> {
    let belief = Tracks {
        covariances: tracks.0.as_slice()?,
        transitions: tracks.1.as_slice()?,
        noises: tracks.2.as_slice()?,
    };
    let [rows, steps] = [team.1.shape()[0], team.1.shape()[1]];
    let sparse = Sparse { targets: team.0.as_slice()?, blocks: team.1.as_slice()?, steps };
    check(sparse.fits(belief.count()), "the team's blocks")?;
    let measure = measure_of(measure)?;
    let mut out = vec![[0.0; 3]; rows * steps];
    if steps > 0 {
        for (row, slopes) in out.chunks_mut(steps).enumerate() {
            let infos: Vec<Sym> = (0..steps).map(|k| sparse.at(row, k)).collect();
            belief.get(sparse.targets[row] as usize).gradient(measure, &infos, slopes);
        }
    }
    out.into_flattened().into_pyarray(py).reshape([rows, steps, 3])
}

type Numbers = (f64, f64, f64, f64, f64);

fn sight_of((range, bearing, place, min_range, stride): Numbers) -> Sight {
    Sight { range, bearing, place, min_range, stride }
}

type Lines<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray3<f64>>, Bound<'py, PyArray2<f64>>);

#[pyfunction(name = "track_lines")]
fn py_track_lines<'py>(
    py: Python<'py>,
    sight: Numbers,
    offsets: PyReadonlyArray2<'py, f64>,
    covariances: PyReadonlyArray2<'py, f64>,
) -> PyResult<Lines<'py>> {
    let count = offsets.shape()[0];
    check(offsets.shape() == [count, 2] && covariances.shape() == [count, 3], "offsets and covariances")?;
    let (sight, at, spread) = (sight_of(sight), offsets.as_slice()?, covariances.as_slice()?);
    let (mut info, mut gain, mut expected) =
        (Vec::with_capacity(3 * count), Vec::with_capacity(6 * count), Vec::with_capacity(3 * count));
    for (x, p) in at.chunks_exact(2).zip(spread.chunks_exact(3)) {
        let line = sight.line([x[0], x[1]], [p[0], p[1], p[2]]);
        info.extend(line.information);
        gain.extend(line.gain.as_flattened());
        expected.extend(line.expected);
    }
    Ok((
        info.into_pyarray(py).reshape([count, 3])?,
        gain.into_pyarray(py).reshape([count, 2, 3])?,
        expected.into_pyarray(py).reshape([count, 3])?,
    ))
}

#[pyfunction(name = "track_foreseen")]
fn py_track_foreseen<'py>(
    py: Python<'py>,
    sight: Numbers,
    view: (f64, f64),
    poses: Matrices<'py>,
    points: Matrices<'py>,
    covariances: Matrices<'py>,
) -> PyResult<Bound<'py, PyArray4<f64>>> {
    let ([paths, steps], targets) = ([poses.shape()[0], poses.shape()[1]], points.shape()[0]);
    let fits = poses.shape()[2] == 3
        && points.shape() == [targets, steps, 2]
        && covariances.shape() == [targets, steps, 3];
    check(fits, "poses, points and covariances")?;
    let (sight, from, to, spread) =
        (sight_of(sight), poses.as_slice()?, points.as_slice()?, covariances.as_slice()?);
    let mut out = Vec::with_capacity(3 * paths * targets * steps);
    if steps > 0 {
        for path in from.chunks_exact(3 * steps) {
            for (x, p) in to.chunks_exact(2 * steps).zip(spread.chunks_exact(3 * steps)) {
                for k in 0..steps {
                    let offset = [x[2 * k] - path[3 * k], x[2 * k + 1] - path[3 * k + 1]];
                    let covariance = [p[3 * k], p[3 * k + 1], p[3 * k + 2]];
                    out.extend(sight.foreseen(offset, path[3 * k + 2], covariance, view.0, view.1));
                }
            }
        }
    }
    out.into_pyarray(py).reshape([paths, targets, steps, 3])
}

pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(py_track_values, m)?)?;
    m.add_function(wrap_pyfunction!(py_track_gradient, m)?)?;
    m.add_function(wrap_pyfunction!(py_track_lines, m)?)?;
    m.add_function(wrap_pyfunction!(py_track_foreseen, m)?)?;
    Ok(())
}
