//! Properties of every reader for arbitrary bytes.
//!
//! A reader returns a result or an error, whole and in blocks, with no more records than bytes.
//! Unless the first block determines the columns, joined blocks are equal to
//! the whole, bit by bit.

use std::io::Cursor;

use asperity_measure::{ReadOptions, Reader, Samples, read_bytes};

/// Relation of blocks to the whole.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Blocks {
    /// Joined blocks are equal to the whole.
    Same,
    /// The first block determines the columns, so they may differ.
    Free,
}

/// Reads `bytes` whole and in blocks.
///
/// # Panics
/// If the two differ although they must not, or if there are more records than bytes.
pub fn read(bytes: &[u8], blocks: Blocks) {
    let options = ReadOptions { sample_rate_hz: Some(1000.0), ..ReadOptions::default() };
    let whole = read_bytes(bytes, &options);
    let small = ReadOptions { block: 7, ..options };
    let Ok(mut reader) = Reader::from_stream("blocks", Cursor::new(bytes), &small) else {
        assert!(whole.is_err(), "blocks are rejected, the whole is not");
        return;
    };
    let (mut count, mut joined): (usize, Vec<Vec<u64>>) = (0, Vec::new());
    let ended = loop {
        match reader.next_record() {
            Ok(None) => break true,
            Err(_) => break false,
            Ok(Some(record)) => {
                count += 1;
                assert!(count <= bytes.len() + 1, "more records than bytes");
                if !record.continues {
                    joined.extend(vec![Vec::new(); record.channels.len()]);
                }
                let first = joined.len() - record.channels.len();
                for (bits, channel) in joined[first..].iter_mut().zip(&record.channels) {
                    bits.extend(bits_of(&channel.samples));
                }
            }
        }
    };
    if blocks == Blocks::Free {
        return;
    }
    match whole {
        Err(_) => assert!(!ended, "the whole is rejected, blocks are not"),
        Ok(whole) => {
            assert!(ended, "a block is rejected, the whole is not");
            let channels = whole.records.iter().flat_map(|record| &record.channels);
            let expected: Vec<Vec<u64>> =
                channels.map(|channel| bits_of(&channel.samples).collect()).collect();
            assert!(joined == expected, "blocks differ from the whole");
        }
    }
}

fn bits_of(samples: &Samples) -> impl Iterator<Item = u64> {
    let (real, complex) = match samples {
        Samples::Real(values) => (values.as_slice(), [].as_slice()),
        Samples::Complex(values) => ([].as_slice(), values.as_slice()),
    };
    let parts = complex.iter().flat_map(|value| [value.re.to_bits(), value.im.to_bits()]);
    real.iter().map(|value| value.to_bits()).chain(parts)
}
