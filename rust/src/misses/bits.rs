//! Numbers as bits in a row, the lowest first.

/// Bits written so far.
#[derive(Default)]
pub struct Writer {
    bytes: Vec<u8>,
    held: u64, // not yet among the bytes
    count: u32,
}

impl Writer {
    /// Write a number of at most 32 bits.
    #[inline]
    pub fn put(&mut self, number: u32, bits: u32) {
        self.held |= u64::from(number) << self.count;
        self.count += bits;
        if self.count >= 32 {
            self.bytes.extend((self.held as u32).to_le_bytes());
            self.held >>= 32;
            self.count -= 32;
        }
    }

    /// All bytes; what is left of the last is 0.
    pub fn finish(mut self) -> Vec<u8> {
        let rest = self.count.div_ceil(8) as usize;
        self.bytes.extend(&self.held.to_le_bytes()[..rest]);
        self.bytes
    }
}

/// Bits that are left to read; beyond the end they are 0.
pub struct Reader<'a> {
    bytes: &'a [u8],
    next: usize, // byte
    held: u64,
    count: u32,
}

impl<'a> Reader<'a> {
    pub fn new(bytes: &'a [u8]) -> Self {
        Reader { bytes, next: 0, held: 0, count: 0 }
    }

    /// The next bits, at most 32, which stay unread.
    #[inline]
    pub fn peek(&mut self, bits: u32) -> u32 {
        if self.count < bits {
            self.fill();
        }
        (self.held & ((1 << bits) - 1)) as u32
    }

    /// Read bits that have been peeked at.
    #[inline]
    pub fn skip(&mut self, bits: u32) {
        self.held >>= bits;
        self.count -= bits;
    }

    /// Read a number of at most 32 bits.
    #[inline]
    pub fn take(&mut self, bits: u32) -> u32 {
        let number = self.peek(bits);
        self.skip(bits);
        number
    }

    fn fill(&mut self) {
        let four = match self.bytes.get(self.next..self.next + 4) {
            Some(four) => u32::from_le_bytes([four[0], four[1], four[2], four[3]]),
            None => {
                let mut four = [0; 4];
                let rest = self.bytes.get(self.next..).unwrap_or(&[]);
                four[..rest.len()].copy_from_slice(rest);
                u32::from_le_bytes(four)
            }
        };
        self.held |= u64::from(four) << self.count;
        self.next += 4;
        self.count += 32;
    }

    /// Whether all has been read and no more: what is left is less than a byte, of zeros.
    pub fn at_end(&self) -> bool {
        let read = 8 * self.next - self.count as usize;
        self.held == 0 && read.div_ceil(8) == self.bytes.len()
    }

    /// Whether more has been read than there is.
    #[inline]
    pub fn past_end(&self) -> bool {
        8 * self.next > self.count as usize + 8 * self.bytes.len()
    }
}
