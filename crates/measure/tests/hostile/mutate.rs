//! Mutations from a seed.

/// Mutations that parsers are sensitive to, by Marsaglia's xorshift64.
pub(crate) struct Mutator(u64);

const WORDS: [&[u8]; 16] = [
    b"    -1\n",
    b"-1",
    b"\n",
    b"\r\n",
    b"99999999999",
    b"-2147483648",
    b"1e308",
    b"nan",
    b",",
    b"\t",
    b"\xff\xff\xff\xff",
    b"\0\0\0\0",
    b"\x80",
    b"    58b     1     2          11  1000000000\n",
    b"***End_of_Header***\n",
    b"(1000000000000, 2)",
];

impl Mutator {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed | 1)
    }

    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    /// A number below `limit`; zero for zero.
    pub(crate) fn below(&mut self, limit: usize) -> usize {
        (self.next() % limit.max(1) as u64) as usize
    }

    /// `seed` with one to four mutations, some with pieces of `other`.
    pub(crate) fn mutated(&mut self, seed: &[u8], other: &[u8]) -> Vec<u8> {
        let mut bytes = seed.to_vec();
        for _ in 0..=self.below(4) {
            // Every other mutation is near the start, in the header.
            let reach = if self.below(2) == 0 { bytes.len().min(400) } else { bytes.len() };
            let at = self.below(reach);
            match self.below(7) {
                0 if !bytes.is_empty() => bytes[at] ^= 1 << self.below(8),
                1 if !bytes.is_empty() => bytes[at] = self.next() as u8,
                2 => {
                    let end = (at + 1 + self.below(64)).min(bytes.len());
                    bytes.drain(at.min(end)..end);
                }
                3 => {
                    let from = self.below(other.len());
                    let to = (from + 1 + self.below(200)).min(other.len());
                    bytes.splice(at..at, other[from..to].iter().copied());
                }
                4 => {
                    let word = WORDS[self.below(WORDS.len())];
                    let end = (at + word.len()).min(bytes.len());
                    bytes.splice(at..end, word.iter().copied());
                }
                5 => {
                    let word = WORDS[self.below(WORDS.len())];
                    bytes.splice(at..at, word.iter().copied());
                }
                _ => {
                    // Another digit: wrong counts and lengths.
                    let digits: Vec<usize> =
                        (0..reach).filter(|&i| bytes[i].is_ascii_digit()).collect();
                    if !digits.is_empty() {
                        let digit = digits[self.below(digits.len())];
                        bytes[digit] = b'0' + self.below(10) as u8;
                    }
                }
            }
        }
        bytes
    }
}
