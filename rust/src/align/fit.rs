//! Laying faces of one map on those of another by least squares over the distances along the normals.

use numpy::ndarray::{ArrayView1, ArrayView2};
use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Least cosine between two paired faces' normals.
const FACING: f64 = 0.7;
/// Of a step along which no face tells anything.
const DAMPING: f64 = 1e-6;
/// A pose cannot be told from fewer pairs.
const LEAST: usize = 3;

/// The map that stays: which face is nearest to each cell, and each face's place and normal.
pub struct Ground<'a> {
    pub face_at: ArrayView2<'a, i32>,
    pub cell: f64,
    pub corner: [f64; 2],
    pub faces: ArrayView2<'a, f64>,
    pub normals: ArrayView2<'a, f64>,
}

/// The faces that move: places and normals.
pub struct Moving<'a> {
    pub faces: ArrayView2<'a, f64>,
    pub normals: ArrayView2<'a, f64>,
}

/// What came of a fit.
#[derive(Clone, Copy)]
pub struct Fitted {
    pub pose: [f64; 3],
    /// Normal equations of the last step, upper triangle by rows.
    pub matrix: [f64; 6],
    /// Mean of the squared distances, by weight.
    pub squares: f64,
    pub paired: usize,
}

/// Sums of one step.
#[derive(Default)]
struct Sums {
    matrix: [f64; 6],
    right: [f64; 3],
    weights: f64,
    squares: f64,
    paired: usize,
}

/// A step of Gauss and Newton for each reach, within which faces are paired.
pub fn fitted(ground: &Ground, moving: &Moving, guess: [f64; 3], reaches: &[f64]) -> Fitted {
    let mut found = Fitted { pose: guess, matrix: [0.0; 6], squares: 0.0, paired: 0 };
    for &reach in reaches {
        let sums = step(ground, moving, found.pose, reach);
        found.paired = sums.paired;
        if sums.paired < LEAST {
            break;
        }
        let change = solved(sums.matrix, sums.right);
        found.pose = [found.pose[0] + change[0], found.pose[1] + change[1], found.pose[2] + change[2]];
        found.matrix = sums.matrix;
        found.squares = sums.squares / sums.weights;
    }
    found
}

fn step(ground: &Ground, moving: &Moving, pose: [f64; 3], reach: f64) -> Sums {
    let (rows, cols) = ground.face_at.dim();
    let (sin, cos) = pose[2].sin_cos();
    let turned = |v: ArrayView1<f64>| [cos * v[0] - sin * v[1], sin * v[0] + cos * v[1]];
    let mut sums = Sums::default();
    for (point, normal) in moving.faces.rows().into_iter().zip(moving.normals.rows()) {
        let arm = turned(point);
        let place = [arm[0] + pose[0], arm[1] + pose[1]];
        let col = ((place[0] - ground.corner[0]) / ground.cell).floor();
        let row = ((place[1] - ground.corner[1]) / ground.cell).floor();
        if !(row >= 0.0 && col >= 0.0 && row < rows as f64 && col < cols as f64) {
            continue;
        }
        let face = ground.face_at[(row as usize, col as usize)] as usize;
        let n = [ground.normals[(face, 0)], ground.normals[(face, 1)]];
        let gap = [ground.faces[(face, 0)] - place[0], ground.faces[(face, 1)] - place[1]];
        let facing = turned(normal);
        if gap[0].hypot(gap[1]) > reach || n[0] * facing[0] + n[1] * facing[1] < FACING {
            continue;
        }
        let off = n[0] * gap[0] + n[1] * gap[1];
        let line = [n[0], n[1], n[1] * arm[0] - n[0] * arm[1]];
        let weight = (1.0 + (off / (reach / 2.0)).powi(2)).powi(-2);
        for (k, (i, j)) in [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)].into_iter().enumerate() {
            sums.matrix[k] += weight * line[i] * line[j];
        }
        for (right, part) in sums.right.iter_mut().zip(line) {
            *right += weight * off * part;
        }
        sums.weights += weight;
        sums.squares += weight * off * off;
        sums.paired += 1;
    }
    sums
}

/// The solution of three normal equations, damped by a share of their trace, by L D L'.
fn solved(matrix: [f64; 6], right: [f64; 3]) -> [f64; 3] {
    let [xx, xy, xa, yy, ya, aa] = matrix;
    let damping = DAMPING * (xx + yy + aa);
    let d0 = xx + damping;
    let (l10, l20) = (xy / d0, xa / d0);
    let d1 = yy + damping - l10 * xy;
    let l21 = (ya - l20 * xy) / d1;
    let d2 = aa + damping - l20 * xa - l21 * l21 * d1;
    let y1 = right[1] - l10 * right[0];
    let y2 = right[2] - l20 * right[0] - l21 * y1;
    let angle = y2 / d2;
    let y = y1 / d1 - l21 * angle;
    [right[0] / d0 - l10 * y - l20 * angle, y, angle]
}

type Places<'py> = PyReadonlyArray2<'py, f64>;

#[pyfunction]
pub fn align_fit<'py>(
    py: Python<'py>,
    grid: (PyReadonlyArray2<'py, i32>, f64, [f64; 2]),
    on: (Places<'py>, Places<'py>),
    moving: (Places<'py>, Places<'py>),
    guess: [f64; 3],
    reaches: PyReadonlyArray1<'py, f64>,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let pairs = [(on.0.as_array(), on.1.as_array()), (moving.0.as_array(), moving.1.as_array())];
    if pairs.iter().any(|(faces, normals)| faces.ncols() != 2 || faces.dim() != normals.dim()) {
        return Err(PyValueError::new_err("faces and their normals must both be (n, 2)"));
    }
    let [(faces, normals), (points, facing)] = pairs;
    let face_at = grid.0.as_array();
    if face_at.iter().any(|&face| face < 0 || face as usize >= faces.nrows()) {
        return Err(PyValueError::new_err("each cell must name one of the faces"));
    }
    let ground = Ground { face_at, cell: grid.1, corner: grid.2, faces, normals };
    let moving = Moving { faces: points, normals: facing };
    let reaches = reaches.as_slice()?;
    let found = py.detach(|| fitted(&ground, &moving, guess, reaches));
    let told = [found.pose.as_slice(), &found.matrix, &[found.squares, found.paired as f64]].concat();
    Ok(told.into_pyarray(py))
}
