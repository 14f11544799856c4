//! Dijkstra's algorithm on the grid: canonical moves, and a ring of buckets for its queue.
//!
//! A straight step costs 12 and a diagonal one 17: 17/12 is 0.17 % over the square root of two. With integer
//! costs the queue is a ring of buckets (Dial), and searches from either end agree exactly.

pub const STRAIGHT: u32 = 12;
const DIAGONAL: u32 = 17;
pub const UNREACHED: u32 = u32::MAX;

/// Cells: how far from the nearest traversable cells a place that is not traversable still connects to them.
pub const CONNECTION: i64 = 3;

/// Buckets of the queue: a power of two above the dearest step or connection, `12 * 3`.
const RING: usize = 64;

/// Row and column steps of the eight moves, counter-clockwise from +x; the odd ones are diagonal.
pub const MOVES: [(i64, i64); 8] = [(0, 1), (1, 1), (1, 0), (1, -1), (0, -1), (-1, -1), (-1, 0), (-1, 1)];

/// Stands for "no move": where a search starts.
const START: u8 = 8;

/// Moves allowed from each cell, a bit each: to a traversable cell and, diagonally, past two traversable ones.
pub fn allowed_moves(open: &[u8], cols: usize) -> Vec<u8> {
    let rows = open.len() / cols;
    let mut moves = vec![0u8; open.len()];
    let mut padded = [vec![0u8; cols + 2], vec![0u8; cols + 2], vec![0u8; cols + 2]];
    let load = |row: usize, line: &mut Vec<u8>| match row < rows {
        true => line[1..=cols].iter_mut().zip(&open[row * cols..]).for_each(|(a, &b)| *a = u8::from(b != 0)),
        false => line.fill(0),
    };
    load(0, &mut padded[2]);
    for row in 0..rows {
        padded.rotate_left(1);
        load(row + 1, &mut padded[2]);
        let [south, here, north] = &padded;
        let out = &mut moves[row * cols..(row + 1) * cols];
        let (sw, s, se) = (&south[..cols], &south[1..=cols], &south[2..cols + 2]);
        let (w, o, e) = (&here[..cols], &here[1..=cols], &here[2..cols + 2]);
        let (nw, n, ne) = (&north[..cols], &north[1..=cols], &north[2..cols + 2]);
        for i in 0..cols {
            let straight = e[i] | n[i] << 2 | w[i] << 4 | s[i] << 6;
            let ahead = (ne[i] & n[i] & e[i]) << 1 | (nw[i] & n[i] & w[i]) << 3;
            let behind = (sw[i] & s[i] & w[i]) << 5 | (se[i] & s[i] & e[i]) << 7;
            out[i] = (straight | ahead | behind) & o[i].wrapping_neg();
        }
    }
    moves
}

/// Moves worth making after arriving by `arrived`: those that no other path from the cell before makes as well.
///
/// Diagonal steps come first among equals (canonical ordering), so a straight run only goes on, and turns where
/// an obstacle beside the cell before kept that cell from moving diagonally itself.
///
/// No shortest length is lost: a straight move left out is strictly longer than another path to its end, and a
/// diagonal one as long as a path whose last move is straight, and therefore kept.
#[inline]
fn worthwhile(arrived: u8, before: impl Fn() -> u8) -> u8 {
    let d = u32::from(arrived);
    if arrived == START {
        0xff
    } else if d % 2 == 1 {
        0b0000_0111u8.rotate_left(d - 1)
    } else {
        let lacks = !before().rotate_right(d);
        let left = (lacks >> 1 & 1) * 0b0000_0110;
        let right = (lacks >> 7 & 1) * 0b1100_0000;
        (1 | left | right).rotate_left(d)
    }
}

/// A reusable search: its buffers outlive a run, and only the cells that a run touched are reset.
pub struct Search<'a> {
    moves: &'a [u8],
    steps: [i64; 8],
    pub cost: Vec<u32>,
    arrived: Vec<u8>,
    wanted: Vec<bool>,
    names: Vec<usize>,
    touched: Vec<u32>,
    ring: Box<[Vec<u32>; RING]>,
    queued: usize,
}

impl<'a> Search<'a> {
    pub fn new(moves: &'a [u8], cols: usize) -> Self {
        Search {
            moves,
            steps: MOVES.map(|(row, col)| row * cols as i64 + col),
            cost: vec![UNREACHED; moves.len()],
            arrived: vec![START; moves.len()],
            wanted: vec![false; moves.len()],
            names: Vec::new(),
            touched: Vec::new(),
            ring: Box::new([const { Vec::new() }; RING]),
            queued: 0,
        }
    }

    fn reset(&mut self) {
        for cells in self.ring.iter_mut().chain([&mut self.touched]) {
            for cell in cells.drain(..) {
                self.cost[cell as usize] = UNREACHED;
            }
        }
        self.queued = 0;
    }

    #[inline]
    fn improve(&mut self, cell: usize, cost: u32, arrived: u8) {
        if cost < self.cost[cell] {
            self.cost[cell] = cost;
            self.arrived[cell] = arrived;
            self.ring[cost as usize % RING].push(cell as u32);
            self.queued += 1;
        }
    }

    #[inline]
    fn expand(&mut self, cell: usize, level: u32) {
        let arrived = self.arrived[cell];
        let before = || self.moves[(cell as i64 - self.steps[arrived as usize]) as usize];
        let mut moves = self.moves[cell] & worthwhile(arrived, before);
        while moves != 0 {
            let d = moves.trailing_zeros() as usize;
            moves &= moves - 1;
            let step = if d % 2 == 1 { DIAGONAL } else { STRAIGHT };
            self.improve((cell as i64 + self.steps[d]) as usize, level + step, d as u8);
        }
    }

    /// Run from the seeds `(cell, cost)`, up to `limit` or until `left` wanted cells are settled.
    ///
    /// Returns the highest cost at which what is known is final.
    pub fn run(&mut self, seeds: &[(usize, u32)], limit: u32, mut left: usize) -> u32 {
        self.reset();
        for &(cell, cost) in seeds {
            self.improve(cell, cost, START);
        }
        let mut level = 0;
        while self.queued > 0 && level <= limit {
            let mut bucket = std::mem::take(&mut self.ring[level as usize % RING]);
            self.queued -= bucket.len();
            self.touched.extend_from_slice(&bucket);
            for &cell in &bucket {
                let cell = cell as usize;
                if self.cost[cell] != level {
                    continue; // a cheaper path came after this entry
                }
                if self.wanted[cell] {
                    left -= 1;
                    if left == 0 {
                        return level;
                    }
                }
                self.expand(cell, level);
            }
            bucket.clear();
            self.ring[level as usize % RING] = bucket;
            level += 1;
        }
        if self.queued > 0 {
            limit
        } else {
            UNREACHED - 1
        }
    }

    /// Name the cells to settle before the next run may stop early; returns how many they are.
    pub fn want(&mut self, cells: impl Iterator<Item = usize>) -> usize {
        for cell in self.names.drain(..) {
            self.wanted[cell] = false;
        }
        for cell in cells {
            if !self.wanted[cell] {
                self.wanted[cell] = true;
                self.names.push(cell);
            }
        }
        self.names.len()
    }
}

/// How a cell joins the traversable ones: itself, or by straight lines to those within three cells of it.
pub fn connections(open: &[u8], cols: usize, cell: usize) -> Vec<(usize, u32)> {
    if open[cell] != 0 {
        return vec![(cell, 0)];
    }
    let (rows, cols) = ((open.len() / cols) as i64, cols as i64);
    let (row, col) = (cell as i64 / cols, cell as i64 % cols);
    let mut found = Vec::new();
    for r in (row - CONNECTION).max(0)..=(row + CONNECTION).min(rows - 1) {
        for c in (col - CONNECTION).max(0)..=(col + CONNECTION).min(cols - 1) {
            let squared = (r - row).pow(2) + (c - col).pow(2);
            if squared <= CONNECTION * CONNECTION && open[(r * cols + c) as usize] != 0 {
                let cost = (f64::from(STRAIGHT) * (squared as f64).sqrt()).round() as u32;
                found.push(((r * cols + c) as usize, cost));
            }
        }
    }
    found
}
