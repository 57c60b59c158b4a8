//! Positions of the samples of a channel.

use crate::tdms_file::data_type::{Endian, NumberType};

/// Equally spaced chunks of samples in a segment or in equal consecutive segments.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Extent {
    /// Start of the first chunk.
    pub(crate) base: u64,
    /// Start of the channel in a chunk, or in a row of interleaved samples.
    pub(crate) column: u64,
    /// Bytes of a row of interleaved samples; zero for contiguous channels.
    pub(crate) row: u64,
    /// Bytes from one chunk to the next.
    pub(crate) stride: u64,
    pub(crate) chunks: u64,
    /// Samples of the channel in a chunk, at least one.
    pub(crate) values: u64,
    pub(crate) number: NumberType,
    pub(crate) endian: Endian,
}

impl Extent {
    /// Position of sample `value` of chunk `chunk`.
    pub(crate) fn position(&self, chunk: u64, value: u64) -> u64 {
        let step = if self.row > 0 { self.row } else { self.number.size() };
        self.base + chunk * self.stride + self.column + value * step
    }

    /// True for samples in the same chunks as `other`.
    pub(crate) fn lies_with(&self, other: &Self) -> bool {
        let shape =
            |extent: &Self| (extent.base, extent.row, extent.stride, extent.chunks, extent.values);
        shape(self) == shape(other)
    }

    /// Appends the chunks of `next` if they continue at the same spacing.
    pub(crate) fn carry_on(&mut self, next: &Self) -> bool {
        let kind = |extent: &Self| {
            (extent.column, extent.row, extent.values, extent.number, extent.endian)
        };
        let gap = next.base.saturating_sub(self.base);
        let stride = if self.chunks == 1 { gap } else { self.stride };
        let even = (next.chunks == 1 || next.stride == stride) && stride * self.chunks == gap;
        if kind(self) != kind(next) || !even {
            return false;
        }
        self.stride = stride;
        self.chunks += next.chunks;
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tdms_file::data_type::DataType;

    fn extent(base: u64, stride: u64, chunks: u64) -> Extent {
        let Some(DataType::Number(number)) = DataType::of_code(10) else { panic!("a double") };
        let endian = Endian::Little;
        Extent { base, column: 0, row: 0, stride, chunks, values: 2, number, endian }
    }

    #[test]
    fn like_segments_become_one_run() {
        let mut run = extent(100, 16, 1);
        assert!(run.carry_on(&extent(144, 16, 1)) && run.carry_on(&extent(188, 16, 1)));
        assert_eq!((run.stride, run.chunks), (44, 3));
        assert_eq!(run.position(2, 1), 196);
        assert!(!run.carry_on(&extent(233, 16, 1)), "a byte too far");
        assert!(!run.carry_on(&extent(232, 16, 2)), "two chunks at another distance");
        assert!(!run.carry_on(&Extent { values: 3, ..extent(232, 16, 1) }));
        let mut chunks = extent(100, 16, 3);
        assert!(!chunks.carry_on(&extent(176, 16, 3)), "a lead-in lies between");
        assert!(chunks.carry_on(&extent(148, 16, 3)));
        assert_eq!(chunks.chunks, 6);
    }
}
