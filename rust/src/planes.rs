//! A mask as bits, along its rows and along its columns, so that runs are found a word at a time.

const WORD: usize = 64;

/// The bits of parallel lines of cells.
pub struct Lines {
    words: Vec<u64>,
    words_a_line: usize,
    pub count: usize,
    pub length: usize,
}

impl Lines {
    /// The first cell of a line in `from..=to` that is set, or, with `clear`, that is not.
    #[inline]
    pub fn first(&self, line: usize, from: usize, to: usize, clear: bool) -> Option<usize> {
        let words = self.line(line);
        let mut at = from / WORD;
        let mut keep = u64::MAX << (from % WORD);
        while at <= to / WORD {
            let word = (words[at] ^ u64::from(clear).wrapping_neg()) & keep;
            if word != 0 {
                let found = at * WORD + word.trailing_zeros() as usize;
                return (found <= to).then_some(found);
            }
            keep = u64::MAX;
            at += 1;
        }
        None
    }

    /// The last cell of a line in `from..=to` that is set, or, with `clear`, that is not.
    #[inline]
    pub fn last(&self, line: usize, from: usize, to: usize, clear: bool) -> Option<usize> {
        let words = self.line(line);
        let mut at = to / WORD;
        let mut keep = u64::MAX >> (WORD - 1 - to % WORD);
        loop {
            let word = (words[at] ^ u64::from(clear).wrapping_neg()) & keep;
            if word != 0 {
                let found = at * WORD + WORD - 1 - word.leading_zeros() as usize;
                return (found >= from).then_some(found);
            }
            if at <= from / WORD {
                return None;
            }
            keep = u64::MAX;
            at -= 1;
        }
    }

    #[inline]
    pub fn holds(&self, line: usize, at: usize) -> bool {
        self.line(line)[at / WORD] >> (at % WORD) & 1 != 0
    }

    #[inline]
    fn line(&self, line: usize) -> &[u64] {
        &self.words[line * self.words_a_line..(line + 1) * self.words_a_line]
    }
}

/// A mask by rows and by columns.
pub struct Planes {
    pub rows: Lines,
    pub cols: Lines,
}

impl Planes {
    /// The cells of a grid for which `is_set` holds.
    pub fn of<T: Copy>(cells: &[T], rows: usize, cols: usize, is_set: impl Fn(T) -> bool) -> Self {
        let (words_a_row, words_a_col) = (cols.div_ceil(WORD), rows.div_ceil(WORD));
        let mut by_row = Vec::with_capacity(rows * words_a_row);
        let mut by_col = vec![0; cols * words_a_col];
        let mut block = vec![0_u64; cols];
        for row in 0..rows {
            let line = &cells[row * cols..(row + 1) * cols];
            for (word, &cell) in block.iter_mut().zip(line) {
                *word |= u64::from(is_set(cell)) << (row % WORD);
            }
            let bit = |word: u64, (i, &cell): (usize, &T)| word | u64::from(is_set(cell)) << i;
            by_row.extend(line.chunks(WORD).map(|chunk| chunk.iter().enumerate().fold(0, bit)));
            if row % WORD == WORD - 1 || row + 1 == rows {
                for (col, word) in block.iter_mut().enumerate() {
                    by_col[col * words_a_col + row / WORD] = std::mem::take(word);
                }
            }
        }
        Planes {
            rows: Lines { words: by_row, words_a_line: words_a_row, count: rows, length: cols },
            cols: Lines { words: by_col, words_a_line: words_a_col, count: cols, length: rows },
        }
    }
}

/// Side of the squares that are counted together [cells].
const BLOCK: usize = 16;

/// How many set cells there are above and left of any corner of blocks, so that a box is looked at in one step.
pub struct Presence {
    sums: Vec<u32>, // (block rows + 1, block columns + 1)
    wide: usize,
}

impl Presence {
    pub fn of(lines: &Lines) -> Self {
        let wide = lines.length.div_ceil(BLOCK) + 1;
        let mut sums = vec![0; wide];
        for first in (0..lines.count).step_by(BLOCK) {
            let mut counts = vec![0; wide];
            for line in first..(first + BLOCK).min(lines.count) {
                for (at, count) in counts[1..].iter_mut().enumerate() {
                    let word = lines.line(line)[at * BLOCK / WORD];
                    *count += (word >> (at * BLOCK % WORD) & ((1 << BLOCK) - 1)).count_ones();
                }
            }
            let mut so_far = 0;
            for count in counts {
                so_far += count;
                sums.push(so_far + sums[sums.len() - wide]);
            }
        }
        Presence { sums, wide }
    }

    /// Whether any cell of a box may be set; its ends are included and lie in the grid.
    #[inline]
    pub fn any(&self, rows: (usize, usize), cols: (usize, usize)) -> bool {
        let sum = |row: usize, col: usize| self.sums[row * self.wide + col];
        let (top, bottom, left, right) =
            (rows.0 / BLOCK, rows.1 / BLOCK + 1, cols.0 / BLOCK, cols.1 / BLOCK + 1);
        sum(bottom, right) + sum(top, left) != sum(top, right) + sum(bottom, left)
    }
}
