//! What every target asks of a reader, whatever the bytes are.
//!
//! It answers or refuses, whole and in blocks, with no more records than bytes.
//! Where nothing is decided by the first block, blocks put together are what
//! was read whole, bit by bit.

use std::io::Cursor;

use asperity_measure::{ReadOptions, Reader, Samples, read_bytes};

/// Whether what is read whole and in blocks must be the same.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Blocks {
    /// It must.
    Same,
    /// The first block decides on the columns, so it may not.
    Free,
}

/// Reads `bytes` whole and in blocks.
///
/// # Panics
/// If the two differ where they must not, or there is no end of records.
pub fn read(bytes: &[u8], blocks: Blocks) {
    let options = ReadOptions { sample_rate_hz: Some(1000.0), ..ReadOptions::default() };
    let whole = read_bytes(bytes, &options);
    let small = ReadOptions { block: 7, ..options };
    let Ok(mut reader) = Reader::from_stream("blocks", Cursor::new(bytes), &small) else {
        assert!(whole.is_err(), "blocks are refused, the whole is not");
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
        Err(_) => assert!(!ended, "the whole is refused, blocks are not"),
        Ok(whole) => {
            assert!(ended, "a block is refused, the whole is not");
            let channels = whole.records.iter().flat_map(|record| &record.channels);
            let expected: Vec<Vec<u64>> =
                channels.map(|channel| bits_of(&channel.samples).collect()).collect();
            assert!(joined == expected, "blocks are not what was read whole");
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
