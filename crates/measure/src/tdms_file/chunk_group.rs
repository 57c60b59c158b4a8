//! Channels with samples in common chunks, read in one pass.

use std::io::{Read, Seek};

use crate::tdms_file::byte_reader::ByteReader;
use crate::tdms_file::extent::Extent;
use crate::tdms_file::{TdmsError, TdmsObject};

/// Most bytes of interleaved rows in memory, or one row.
const PIECE: u64 = 1 << 16;

/// Channels with samples in common chunks, and the next sample.
#[derive(Debug, Default)]
pub(crate) struct ChunkGroup {
    /// Index of each in its record, and its object.
    members: Vec<(usize, usize)>,
    extent: usize,
    chunk: u64,
    value: u64,
}

impl ChunkGroup {
    /// A group of one channel.
    pub(crate) fn of(slot: usize, object: usize) -> Self {
        Self { members: vec![(slot, object)], ..Self::default() }
    }

    /// Adds a channel if its samples are in the same chunks: the increase of the cost.
    pub(crate) fn join(
        &mut self,
        slot: usize,
        object: usize,
        objects: &[TdmsObject],
    ) -> Option<u64> {
        let &(_, first) = self.members.first()?;
        let (one, other) = (&objects[first].extents, &objects[object].extents);
        if one.len() != other.len() || !one.iter().zip(other).all(|(a, b)| a.lies_with(b)) {
            return None;
        }
        let before = self.cost(objects);
        self.members.push((slot, object));
        Some(self.cost(objects).saturating_sub(before))
    }

    /// Most bytes of one pass.
    pub(crate) fn cost(&self, objects: &[TdmsObject]) -> u64 {
        let Some(&(_, first)) = self.members.first() else { return 0 };
        let channels = self.members.len() as u64;
        let (mut cost, mut end) = (0_u64, 0);
        for extent in &objects[first].extents {
            let span = extent.chunks * extent.stride;
            // Small gaps are read, large ones skipped: then each channel of each chunk fills a
            // buffer.
            let alone = (extent.values.saturating_mul(8) + PIECE).saturating_mul(channels);
            let gap = extent.base.saturating_sub(end).min(PIECE);
            let within =
                if extent.row > 0 { span } else { span.min(alone.saturating_mul(extent.chunks)) };
            cost = cost.saturating_add(gap).saturating_add(within);
            end = extent.base + span;
        }
        cost
    }

    /// Appends the next `count` samples of every member to its column.
    pub(crate) fn read(
        &mut self,
        bytes: &mut ByteReader<impl Read + Seek>,
        objects: &[TdmsObject],
        count: u64,
        columns: &mut [Vec<f64>],
    ) -> Result<(), TdmsError> {
        let mut left = count;
        while left > 0 {
            let first = self.members.first().map(|(_, object)| &objects[*object]);
            let Some(shape) = first.and_then(|first| first.extents.get(self.extent)) else { break };
            let now = left.min(shape.values - self.value);
            if shape.row > 0 {
                self.read_rows(bytes, objects, now, columns)?;
            } else {
                for &(slot, object) in &self.members {
                    let extent = &objects[object].extents[self.extent];
                    bytes.seek_to(extent.position(self.chunk, self.value))?;
                    let column = &mut columns[slot];
                    bytes.numbers((extent.number, extent.endian), now, column, "the samples")?;
                }
            }
            left -= now;
            self.value += now;
            if self.value == shape.values {
                (self.value, self.chunk) = (0, self.chunk + 1);
            }
            if self.chunk == shape.chunks {
                (self.chunk, self.extent) = (0, self.extent + 1);
            }
        }
        Ok(())
    }

    fn read_rows(
        &self,
        bytes: &mut ByteReader<impl Read + Seek>,
        objects: &[TdmsObject],
        rows: u64,
        columns: &mut [Vec<f64>],
    ) -> Result<(), TdmsError> {
        let extent_of = |object: usize| &objects[object].extents[self.extent];
        let Some(&(_, first)) = self.members.first() else { return Ok(()) };
        let (shape, row) = (extent_of(first), extent_of(first).row);
        let per_piece = (PIECE / row).max(1).min(rows);
        bytes.seek_to(shape.position(self.chunk, self.value) - shape.column)?;
        let mut piece = vec![0; (per_piece * row) as usize];
        let mut left = rows;
        while left > 0 {
            let now = left.min(per_piece);
            let piece = &mut piece[..(now * row) as usize];
            bytes.read_exact(piece, "the samples")?;
            for &(slot, object) in &self.members {
                let Extent { column, number, endian, .. } = *extent_of(object);
                let range = column as usize..(column + number.size()) as usize;
                for row in piece.chunks_exact(row as usize) {
                    number.decode(endian, &row[range.clone()], &mut columns[slot]);
                }
            }
            left -= now;
        }
        Ok(())
    }
}
