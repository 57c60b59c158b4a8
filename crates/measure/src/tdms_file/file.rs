//! An open file: its objects, and the samples of its channels.

use std::collections::BTreeMap;
use std::io::{Read, Seek};

use crate::tdms_file::byte_reader::ByteReader;
use crate::tdms_file::chunk_group::ChunkGroup;
use crate::tdms_file::index::TdmsIndex;
use crate::tdms_file::scale::Scales;
use crate::tdms_file::{TdmsError, TdmsObject, TdmsPath};

/// Most passes over the file, and most chunk groups of a selection.
const MOST: u64 = 64;

/// Buffers of the stream and of interleaved rows.
const BUFFERS: u64 = 1 << 17;

/// Options of reading.
#[derive(Debug, Clone, Copy)]
pub struct TdmsOptions {
    /// Most bytes of memory per byte of the file, for metadata and selected samples; one MiB is
    /// always allowed.
    pub expansion: u64,
    /// True for the names of properties to keep; properties of scales are always kept.
    pub keep: fn(&str) -> bool,
}

impl Default for TdmsOptions {
    /// Ten bytes per byte of the file, and all properties.
    fn default() -> Self {
        Self { expansion: 10, keep: |_| true }
    }
}

/// A TDMS file with its metadata in memory.
#[derive(Debug)]
pub struct TdmsFile<R> {
    bytes: ByteReader<R>,
    objects: Vec<TdmsObject>,
    by_path: BTreeMap<String, usize>,
    cut_off: Option<u64>,
    /// Scales of groups and of the file, by path, each read once.
    inherited: BTreeMap<String, Option<Scales>>,
    /// Bytes read for all selections.
    passes: u64,
}

/// Channels read together, in order of their selection, and their next sample.
#[derive(Debug, Default)]
pub struct TdmsSelection {
    channels: Vec<SelectedChannel>,
    chunk_groups: Vec<ChunkGroup>,
}

#[derive(Debug)]
struct SelectedChannel {
    scales: Scales,
    /// Samples not yet read.
    remaining: u64,
}

impl<R: Read + Seek> TdmsFile<R> {
    /// Reads the metadata of all segments of `stream`, such as a `File` or a `Cursor` over bytes.
    ///
    /// # Errors
    /// [`TdmsError`] for errors of the stream, content that violates the format, metadata beyond
    /// the memory allowed, and raw data of NI-DAQmx.
    pub fn open(stream: R, options: &TdmsOptions) -> Result<Self, TdmsError> {
        let mut bytes = ByteReader::new(stream, options.expansion)?;
        bytes.reserve(BUFFERS, 0, "the buffers")?;
        let index = TdmsIndex::read(&mut bytes, options.keep)?;
        let TdmsIndex { objects, by_path, cut_off, .. } = index;
        Ok(Self { bytes, objects, by_path, cut_off, inherited: BTreeMap::new(), passes: 0 })
    }

    /// The objects, in the order of their first appearance.
    pub fn objects(&self) -> &[TdmsObject] {
        &self.objects
    }

    /// Index of the object of a path, such as `/'group'/'channel'` with each `'` in a name doubled.
    pub fn find(&self, path: &str) -> Option<usize> {
        self.by_path.get(path).copied()
    }

    /// Start of a segment that was not closed by its writer; its complete samples are read.
    pub fn cut_off(&self) -> Option<u64> {
        self.cut_off
    }

    /// Accounts for `bytes` of memory of the caller within the limit of the options.
    ///
    /// # Errors
    /// [`TdmsError::TooLarge`].
    pub fn reserve(&mut self, bytes: u64, quantity: &'static str) -> Result<(), TdmsError> {
        self.bytes.reserve(bytes, 0, quantity)
    }

    /// Adds the channel of index `object` to a selection of this file.
    ///
    /// Interleaved channels of one selection are read in one pass. Channels may differ in length.
    ///
    /// # Errors
    /// [`TdmsError::NotNumeric`] for another object; [`TdmsError::Malformed`] for a scale that is
    /// neither linear nor polynomial, and for channels so scattered that all selections take more
    /// than 64 passes over the file; [`TdmsError::TooLarge`] for samples of all selections beyond
    /// the memory allowed.
    pub fn select(
        &mut self,
        selection: &mut TdmsSelection,
        object: usize,
    ) -> Result<(), TdmsError> {
        let (samples, name_length) = match self.objects.get(object) {
            Some(TdmsObject {
                path: TdmsPath::Channel(_, name), other_content, samples, ..
            }) if other_content.is_none() => (*samples, name.len() as u64),
            _ => return Err(TdmsError::NotNumeric { object, objects: self.objects.len() }),
        };
        let scales = self.scales(object)?;
        let held = 512 + 16 * scales.len() as u64 + 4 * name_length;
        self.bytes.reserve(samples.saturating_mul(8).saturating_add(held), 0, "the samples")?;
        let slot = selection.channels.len();
        selection.channels.push(SelectedChannel { scales, remaining: samples });
        let chunk_groups = &mut selection.chunk_groups;
        let mut joined = chunk_groups.iter_mut();
        let joined = joined.find_map(|group| group.join(slot, object, &self.objects));
        let added = joined.unwrap_or_else(|| {
            let chunk_group = ChunkGroup::of(slot, object);
            let cost = chunk_group.cost(&self.objects);
            chunk_groups.push(chunk_group);
            cost
        });
        if chunk_groups.len() as u64 > MOST {
            let found = format!("scattered over {} places", chunk_groups.len());
            let expected = format!("at most {MOST} in a group");
            return Err(TdmsError::malformed(0, "a group of channels", &found, expected));
        }
        self.passes = self.passes.saturating_add(added);
        if self.passes > (self.bytes.len() + (1 << 20)).saturating_mul(MOST) {
            let (found, quantity) =
                ("scattered: they take more to read", "the layout of the channels");
            let expected = format!("at most {MOST} passes over the file");
            return Err(TdmsError::malformed(0, quantity, found, expected));
        }
        Ok(())
    }

    /// The next `count` samples of each channel of a selection, scaled; fewer at its end.
    ///
    /// # Errors
    /// [`TdmsError::Io`].
    ///
    /// # Panics
    /// For a selection of another file.
    pub fn read(
        &mut self,
        selection: &mut TdmsSelection,
        count: u64,
    ) -> Result<Vec<Vec<f64>>, TdmsError> {
        let channels = &mut selection.channels;
        let capacity = |channel: &SelectedChannel| count.min(channel.remaining) as usize;
        let mut columns: Vec<Vec<f64>> =
            channels.iter().map(|channel| Vec::with_capacity(capacity(channel))).collect();
        for chunk_group in &mut selection.chunk_groups {
            chunk_group.read(&mut self.bytes, &self.objects, count, &mut columns)?;
        }
        for (channel, column) in channels.iter_mut().zip(&mut columns) {
            channel.remaining = channel.remaining.saturating_sub(column.len() as u64);
            channel.scales.apply(column);
        }
        Ok(columns)
    }

    /// All samples of the channel of index `object`, scaled. Their memory is not accounted for
    /// after the call.
    ///
    /// # Errors
    /// As [`TdmsFile::select`] and [`TdmsFile::read`].
    pub fn samples(&mut self, object: usize) -> Result<Vec<f64>, TdmsError> {
        let (reserved, passes) = (self.bytes.reserved, self.passes);
        let mut selection = TdmsSelection::default();
        let columns = match self.select(&mut selection, object) {
            Ok(()) => self.read(&mut selection, u64::MAX),
            Err(error) => Err(error),
        };
        (self.bytes.reserved, self.passes) = (reserved, passes);
        Ok(columns?.pop().unwrap_or_default())
    }

    /// The scales of a channel, else of its group, else of the file.
    fn scales(&mut self, channel: usize) -> Result<Scales, TdmsError> {
        let TdmsObject { path, properties, .. } = &self.objects[channel];
        if let Some(own) = Scales::of(properties)? {
            return Ok(own);
        }
        let TdmsPath::Channel(group, _) = path else { return Ok(Scales::default()) };
        for path in [format!("/'{}'", group.replace('\'', "''")), "/".to_owned()] {
            let Some(&object) = self.by_path.get(&path) else { continue };
            if !self.inherited.contains_key(&path) {
                let scales = Scales::of(&self.objects[object].properties)?;
                self.inherited.insert(path.clone(), scales);
            }
            if let Some(Some(scales)) = self.inherited.get(&path) {
                return Ok(scales.clone());
            }
        }
        Ok(Scales::default())
    }
}
