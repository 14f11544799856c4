//! The forward filter of an undetected target, and what paths that share prefixes add to a team's search.

use std::rc::Rc;

use super::miss_table;
use super::spread::{Bounds, Grid, Patch, Stencil};

/// A forest of looks: node `n` happens one layer after `parents[n]` (-1: in layer 0), and comes after it.
pub struct Paths<'a> {
    pub parents: &'a [i64],
    pub starts: &'a [i64],
    pub cells: &'a [u32],
    pub misses: &'a [u8],
}

/// `d_k = sum_x q_k(x) (1 - m_k(x))`, `q_{k+1} = T (q_k m_k)`, `q_0 = T p`: mass first detected in each layer.
///
/// The target moves before the first `steps` layers only.
pub fn detected_mass(
    grid: Grid,
    mass: &[f64],
    stencil: &Stencil,
    steps: usize,
    layers: usize,
    impact: (&[u32], &[u8]),
) -> Vec<f64> {
    let miss = miss_table();
    let mut by_layer = vec![Vec::new(); layers];
    for (&key, &level) in impact.0.iter().zip(impact.1) {
        by_layer[key as usize % layers].push((key as usize / layers, level));
    }
    let mut present = Patch::whole(grid, mass);
    let mut detected = vec![0.0; layers];
    for (layer, entries) in by_layer.iter().enumerate() {
        if layer < steps {
            present = stencil.spread(grid, &present, grid.bounds());
        }
        for &(cell, level) in entries {
            detected[layer] += present.mass[cell] * (1.0 - miss[level as usize]);
            present.mass[cell] *= miss[level as usize];
        }
    }
    detected
}

/// `psi(others * path) - psi(others)` for the path that ends at each node, `psi = sum_k w_k d_k`.
///
/// A path earns, for the mass `a` that it is the first to detect, the layer's weight less what the others
/// would earn from that mass later. Its own depletion `D`, the density that the others alone would still find,
/// is carried along with it: `a = (q - D) (m - m_team)`, `D' = T (D m + a)`.
pub fn path_gains(
    grid: Grid,
    mass: &[f64],
    stencil: &Stencil,
    steps: usize,
    weights: &[f64],
    others: (&[u32], &[u8]),
    paths: &Paths,
) -> Vec<f64> {
    let nodes = paths.parents.len();
    let looks = Looks::new(grid, paths);
    let mut gains = vec![0.0; nodes];
    let Some(touched) = looks.bounds(|_| true) else { return gains };
    // Beyond this nothing can come from or go to a cell that a path looks at within the horizon.
    let reach = stencil.reach() * steps;
    let moving = looks.bounds(|node| looks.layers[node] < steps);
    let near = moving.map(|bounds| bounds.grown(reach, grid));
    let team = Team::new(grid, (touched.grown(reach, grid), near), mass, stencil, steps, weights, others);
    let mut children = vec![0_usize; nodes];
    looks.parents.iter().flatten().for_each(|&parent| children[parent] += 1);
    let mut depleted: Vec<Option<Patch>> = (0..nodes).map(|_| None).collect();
    let needs = looks.needs(grid, stencil.reach(), steps);
    let mut taken = Vec::new();
    for node in 0..nodes {
        let parent = looks.parents[node];
        let layer = looks.layers[node];
        let before = parent.and_then(|parent| depleted[parent].as_ref());
        let gain = team.look(layer, weights[layer], before, looks.runs(node), paths.misses, &mut taken);
        gains[node] = gain + parent.map_or(0.0, |parent| gains[parent]);
        if children[node] > 0 {
            let after = team.after(layer, before, looks.runs(node), &taken);
            let moves = layer + 1 < steps;
            depleted[node] = match after {
                Some(patch) if moves => {
                    let image = stencil.image(grid, patch.bounds);
                    needs[node].within(image).map(|bounds| stencil.spread(grid, &patch, bounds))
                }
                Some(patch) => needs[node].within(patch.bounds).map(|bounds| patch.cropped(bounds)),
                None => None,
            };
        }
        if let Some(parent) = parent {
            children[parent] -= 1;
            if children[parent] == 0 {
                depleted[parent] = None;
            }
        }
    }
    gains
}

/// Neighbouring cells in a row of the grid, entries `[from, to)` of a footprint.
struct Run {
    row: usize,
    col: usize,
    from: usize,
    to: usize,
}

/// The footprints of all nodes as runs, and the nodes' layers.
struct Looks {
    runs: Vec<Run>,
    starts: Vec<usize>,
    parents: Vec<Option<usize>>,
    layers: Vec<usize>,
}

impl Looks {
    fn new(grid: Grid, paths: &Paths) -> Looks {
        let mut looks = Looks { runs: Vec::new(), starts: vec![0], parents: Vec::new(), layers: Vec::new() };
        for (node, &parent) in paths.parents.iter().enumerate() {
            looks.parents.push(usize::try_from(parent).ok());
            looks.layers.push(looks.parents[node].map_or(0, |parent| looks.layers[parent] + 1));
            let (mut from, end) = (paths.starts[node] as usize, paths.starts[node + 1] as usize);
            while from < end {
                let (row, col) =
                    (paths.cells[from] as usize / grid.cols, paths.cells[from] as usize % grid.cols);
                let most = end.min(from + grid.cols - col);
                let neighbours = paths.cells[from..most].windows(2).take_while(|pair| pair[1] == pair[0] + 1);
                let to = from + 1 + neighbours.count();
                looks.runs.push(Run { row, col, from, to });
                from = to;
            }
            looks.starts.push(looks.runs.len());
        }
        looks
    }

    fn runs(&self, node: usize) -> &[Run] {
        &self.runs[self.starts[node]..self.starts[node + 1]]
    }

    fn needs(&self, grid: Grid, reach: usize, steps: usize) -> Vec<Need> {
        let mut needs = vec![Need::default(); self.layers.len()];
        for node in (0..self.layers.len()).rev() {
            let Some(parent) = self.parents[node] else { continue };
            let grow = if self.layers[node] + 1 < steps { reach } else { 0 };
            let own = needs[node].clone();
            let need = &mut needs[parent];
            if let Some(bounds) = bounds_of(self.runs(node)) {
                need.add(bounds, self.layers[node] >= steps);
            }
            own.moving.iter().for_each(|bounds| need.add(bounds.grown(grow, grid), false));
            own.standing.iter().for_each(|bounds| need.add(bounds.grown(grow, grid), true));
        }
        needs
    }

    fn bounds(&self, of: impl Fn(usize) -> bool) -> Option<Bounds> {
        let nodes = (0..self.layers.len()).filter(|&node| of(node));
        nodes.filter_map(|node| bounds_of(self.runs(node))).reduce(|all, node| all.union(&node))
    }
}

/// Where the children of a node, and theirs, need to know what was depleted.
#[derive(Clone, Default)]
struct Need {
    moving: Option<Bounds>,
    standing: Vec<Bounds>, // of layers in which the target stays: apart, for they may be far off
}

impl Need {
    fn within(&self, image: Bounds) -> Option<Bounds> {
        let parts = self.moving.iter().chain(&self.standing);
        parts.filter_map(|bounds| bounds.intersection(&image)).reduce(|all, part| all.union(&part))
    }

    fn add(&mut self, bounds: Bounds, stands: bool) {
        if !stands {
            self.moving = Some(self.moving.map_or(bounds, |all| all.union(&bounds)));
        } else if !self.standing.contains(&bounds) {
            self.standing.push(bounds);
        }
    }
}

fn bounds_of(runs: &[Run]) -> Option<Bounds> {
    runs.iter()
        .map(|run| Bounds { rows: (run.row, run.row + 1), cols: (run.col, run.col + run.to - run.from) })
        .reduce(|all, run| all.union(&run))
}

/// The rest of the team alone, layer by layer.
struct Team {
    miss: [f64; 256],
    bounds: Bounds,
    levels: Vec<Option<Vec<u8>>>, // log-misses inside bounds; None: nobody looks
    present: Vec<Rc<Vec<f64>>>,   // q_k inside bounds, undetected before the looks of layer k
    worth: Vec<Option<Patch>>,    // of a unit of mass after the looks of layer k; None: nothing
}

impl Team {
    /// Follow the others inside `bounds`, and what they will earn in `near`, while the target moves.
    fn new(
        grid: Grid,
        (bounds, near): (Bounds, Option<Bounds>),
        mass: &[f64],
        stencil: &Stencil,
        steps: usize,
        weights: &[f64],
        others: (&[u32], &[u8]),
    ) -> Team {
        let miss = miss_table();
        let levels = levels_inside(grid, bounds, weights.len(), others);
        let mut left = Patch::cut(grid, mass, bounds);
        let mut present = Vec::with_capacity(weights.len());
        for (layer, theirs) in levels.iter().enumerate() {
            if layer < steps {
                left = stencil.spread(grid, &left, bounds);
            }
            let changed = layer < steps || layer == 0 || levels[layer - 1].is_some();
            present.push(match present.last() {
                Some(before) if !changed => Rc::clone(before),
                _ => Rc::new(left.mass.clone()),
            });
            if let Some(theirs) = theirs {
                left.mass.iter_mut().zip(theirs).for_each(|(value, &level)| *value *= miss[level as usize]);
            }
        }
        let mut team = Team { miss, bounds, levels, present, worth: Vec::new() };
        team.worth = team.worth_later(grid, near, stencil, steps, weights);
        team
    }

    /// `V_k = T' ((1 - m) w + m V)` of layer k + 1: what the others earn later from a unit of mass.
    fn worth_later(
        &self,
        grid: Grid,
        near: Option<Bounds>,
        stencil: &Stencil,
        steps: usize,
        weights: &[f64],
    ) -> Vec<Option<Patch>> {
        let mut worth: Vec<Option<Patch>> = weights.iter().map(|_| None).collect();
        for layer in (0..weights.len() - 1).rev() {
            let moves = layer + 1 < steps;
            let Some(inside) = (if moves { near } else { Some(self.bounds) }) else { continue };
            let mut next = match (&worth[layer + 1], &self.levels[layer + 1]) {
                (None, None) => continue,
                (Some(later), _) => later.cropped(inside),
                (None, Some(_)) => Patch::empty(inside),
            };
            if let Some(levels) = &self.levels[layer + 1] {
                for (i, values) in next.mass.chunks_exact_mut(inside.width()).enumerate() {
                    let theirs = &levels[self.at(inside.rows.0 + i, inside.cols.0)..];
                    for (value, &level) in values.iter_mut().zip(theirs) {
                        let miss = self.miss[level as usize];
                        *value = (1.0 - miss) * weights[layer + 1] + miss * *value;
                    }
                }
            }
            worth[layer] = Some(if moves { stencil.expect(grid, &next) } else { next });
        }
        worth
    }

    /// What a footprint gains in a layer; leaves the mass that it takes from each cell in `taken`.
    fn look(
        &self,
        layer: usize,
        weight: f64,
        before: Option<&Patch>,
        runs: &[Run],
        misses: &[u8],
        taken: &mut Vec<f64>,
    ) -> f64 {
        taken.clear();
        let mut gain = 0.0;
        for run in runs {
            let (length, start) = (run.to - run.from, taken.len());
            let at = self.at(run.row, run.col)..self.at(run.row, run.col) + length;
            taken.extend_from_slice(&self.present[layer][at.clone()]);
            let taken = &mut taken[start..];
            if let Some((first, own)) = before.and_then(|patch| patch.row_part(run.row, run.col, length)) {
                taken[first..].iter_mut().zip(own).for_each(|(mass, own)| *mass -= own);
            }
            let own = &misses[run.from..run.to];
            match &self.levels[layer] {
                None => {
                    taken.iter_mut().zip(own).for_each(|(mass, &own)| *mass *= 1.0 - self.miss[own as usize])
                }
                Some(levels) => {
                    for ((mass, &own), &theirs) in taken.iter_mut().zip(own).zip(&levels[at]) {
                        let team = theirs.saturating_add(own);
                        *mass *= self.miss[theirs as usize] - self.miss[team as usize];
                    }
                }
            }
            gain += weight * taken.iter().sum::<f64>();
            if let Some(later) = &self.worth[layer] {
                if let Some((first, worth)) = later.row_part(run.row, run.col, length) {
                    gain -= taken[first..].iter().zip(worth).map(|(mass, worth)| mass * worth).sum::<f64>();
                }
            }
        }
        gain
    }

    /// The path's depletion after the looks of a layer; `None`: nothing was taken so far.
    fn after(&self, layer: usize, before: Option<&Patch>, runs: &[Run], taken: &[f64]) -> Option<Patch> {
        let touched = match (bounds_of(runs), before) {
            (Some(bounds), Some(patch)) => bounds.union(&patch.bounds),
            (Some(bounds), None) => bounds,
            (None, patch) => patch?.bounds,
        };
        let mut after = Patch::empty(touched);
        let place = |row: usize, col: usize| (row - touched.rows.0) * touched.width() + col - touched.cols.0;
        if let Some(patch) = before {
            for (i, values) in patch.mass.chunks_exact(patch.bounds.width()).enumerate() {
                let (row, col) = (patch.bounds.rows.0 + i, patch.bounds.cols.0);
                let sums = &mut after.mass[place(row, col)..][..values.len()];
                sums.copy_from_slice(values);
                if let Some(levels) = &self.levels[layer] {
                    let theirs = &levels[self.at(row, col)..];
                    sums.iter_mut().zip(theirs).for_each(|(sum, &level)| *sum *= self.miss[level as usize]);
                }
            }
        }
        let mut rest = taken;
        for run in runs {
            let (taken, later) = rest.split_at(run.to - run.from);
            after.mass[place(run.row, run.col)..].iter_mut().zip(taken).for_each(|(sum, mass)| *sum += mass);
            rest = later;
        }
        Some(after)
    }

    fn at(&self, row: usize, col: usize) -> usize {
        (row - self.bounds.rows.0) * self.bounds.width() + col - self.bounds.cols.0
    }
}

fn levels_inside(grid: Grid, bounds: Bounds, layers: usize, impact: (&[u32], &[u8])) -> Vec<Option<Vec<u8>>> {
    let mut levels: Vec<Option<Vec<u8>>> = vec![None; layers];
    for (&key, &level) in impact.0.iter().zip(impact.1) {
        let (cell, layer) = (key as usize / layers, key as usize % layers);
        if let Some(at) = bounds.index(cell / grid.cols, cell % grid.cols) {
            levels[layer].get_or_insert_with(|| vec![0; bounds.size()])[at] = level;
        }
    }
    levels
}
