//! Prefix codes: symbols that are frequent take few bits (Huffman's code in its canonical form).

use super::bits::{Reader, Writer};

/// No symbol takes more bits.
pub const LONGEST: usize = 12;
/// Stands in a table for the length of the only symbol of a code, which takes no bits.
const ONLY: u32 = LONGEST as u32 + 1;
/// Of symbols that do not occur, so many at most are told together.
const MOST_ABSENT: usize = 16;

/// How each symbol is written.
pub struct Code {
    words: Vec<(u32, u32)>, // bits, the first of them lowest, and how many
}

impl Code {
    /// The code for symbols of these frequencies, and its table into a stream.
    pub fn write(counts: &[u32], stream: &mut Writer) -> Code {
        let lengths = lengths(counts);
        let only = counts.iter().filter(|&&count| count > 0).count() == 1;
        let mut absent = 0;
        for (&length, &count) in lengths.iter().zip(counts) {
            if count == 0 {
                absent += 1;
                continue;
            }
            while absent > 0 {
                let told = absent.min(MOST_ABSENT);
                stream.put(0, 4);
                stream.put(told as u32 - 1, 4);
                absent -= told;
            }
            stream.put(if only { ONLY } else { length as u32 }, 4);
        }
        Code { words: words(&lengths) }
    }

    /// Write a symbol that occurs.
    #[inline]
    pub fn put(&self, symbol: usize, stream: &mut Writer) {
        let (word, bits) = self.words[symbol];
        stream.put(word, bits);
    }
}

/// How symbols are read.
pub struct Table {
    bits: u32,              // of the longest
    entries: Vec<(u8, u8)>, // symbol and its bits, by the bits that are ahead
}

impl Table {
    /// The table at the head of a stream, of a code over so many symbols; None: it is no code's.
    pub fn read(symbols: usize, stream: &mut Reader) -> Option<Table> {
        let mut lengths = vec![0; symbols];
        let (mut symbol, mut room) = (0, 1_u32 << LONGEST);
        while room > 0 {
            match stream.take(4) {
                0 => symbol += stream.take(4) as usize + 1,
                ONLY if room == 1 << LONGEST && symbol < symbols => {
                    return Some(Table { bits: 0, entries: vec![(symbol as u8, 0)] });
                }
                length if length < ONLY => {
                    *lengths.get_mut(symbol)? = length as usize;
                    room = room.checked_sub(1 << (LONGEST - length as usize))?;
                    symbol += 1;
                }
                _ => return None,
            }
            if symbol > symbols {
                return None;
            }
        }
        let bits = lengths.iter().copied().max().unwrap_or(0);
        let mut entries = vec![(0, 0); 1 << bits];
        for (symbol, (word, length)) in words(&lengths).into_iter().enumerate() {
            if length > 0 {
                for ahead in (word as usize..1 << bits).step_by(1 << length) {
                    entries[ahead] = (symbol as u8, length as u8);
                }
            }
        }
        Some(Table { bits: bits as u32, entries })
    }

    /// Read a symbol.
    #[inline]
    pub fn take(&self, stream: &mut Reader) -> usize {
        let (symbol, bits) = self.entries[stream.peek(self.bits) as usize];
        stream.skip(u32::from(bits));
        symbol as usize
    }
}

/// How many bits each symbol takes: 0 for those that do not occur, and for one that is alone.
fn lengths(counts: &[u32]) -> Vec<usize> {
    let mut weights = counts.to_vec();
    loop {
        let lengths = depths(&weights);
        if lengths.iter().all(|&length| length <= LONGEST) {
            return lengths;
        }
        for weight in &mut weights {
            *weight -= *weight / 2; // rarer ones matter more: the tree becomes flatter
        }
    }
}

/// How deep each symbol is in the tree that joins the two lightest again and again, the lowest symbol of equals.
fn depths(weights: &[u32]) -> Vec<usize> {
    let mut leaves: Vec<usize> = (0..weights.len()).filter(|&symbol| weights[symbol] > 0).collect();
    leaves.sort_by_key(|&symbol| weights[symbol]);
    let n = leaves.len();
    let mut heavy: Vec<u64> = leaves.iter().map(|&symbol| u64::from(weights[symbol])).collect();
    let mut parent = vec![0; (2 * n).saturating_sub(1)];
    let (mut leaf, mut inner) = (0, n);
    for node in n..(2 * n).saturating_sub(1) {
        let mut together = 0;
        for _ in 0..2 {
            let lighter = leaf < n && (inner >= node || heavy[leaf] <= heavy[inner]);
            let next = if lighter { &mut leaf } else { &mut inner };
            together += heavy[*next];
            parent[*next] = node;
            *next += 1;
        }
        heavy.push(together);
    }
    let mut depth = vec![0; parent.len()];
    for node in (0..parent.len().saturating_sub(1)).rev() {
        depth[node] = depth[parent[node]] + 1;
    }
    let mut depths = vec![0; weights.len()];
    for (&symbol, &deep) in leaves.iter().zip(&depth) {
        depths[symbol] = deep;
    }
    depths
}

/// The bits of each symbol, and how many: short ones first, equally long ones by symbol.
fn words(lengths: &[usize]) -> Vec<(u32, u32)> {
    let mut next = [0_u32; LONGEST + 1];
    for length in 1..=LONGEST {
        let shorter = lengths.iter().filter(|&&other| other + 1 == length && other > 0).count() as u32;
        next[length] = (next[length - 1] + shorter) << 1;
    }
    let word = |&length: &usize| match length {
        0 => (0, 0),
        _ => {
            let word = next[length];
            next[length] += 1;
            (word.reverse_bits() >> (32 - length), length as u32)
        }
    };
    lengths.iter().map(word).collect()
}
