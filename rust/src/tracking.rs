//! Target tracking: what the candidates of a platform add to the team's information about Gaussian tracks.
//!
//! Information is sparse: targets in ascending order, and for each a block of `steps` symmetric 2x2 matrices.

pub mod small;
pub mod track;

use numpy::{
    IntoPyArray, PyArray1, PyArray3, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray3,
    PyUntypedArrayMethods,
};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

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

pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(py_track_values, m)?)?;
    m.add_function(wrap_pyfunction!(py_track_gradient, m)?)?;
    Ok(())
}
