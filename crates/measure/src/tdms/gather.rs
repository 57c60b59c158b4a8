//! Channels sampled together.
//!
//! A [`ChannelGroup`] has the channels of one group with the same number of samples, the same axis and
//! the same start to half a step. Groups are often tasks or hits with the same names of channels. A
//! [`TdmsRecord`] joins those that were sampled at the same time at one rate, as their start times say.

use std::collections::BTreeMap;

use crate::tdms_file::{TdmsFile, TdmsObject, TdmsPath, TdmsSelection};

use crate::heading::Heading;
use crate::notice::Notices;
use crate::tdms::waveform::{self, Waveform};
use crate::time_match::{TimeVectors, Vector, time_vectors};
use crate::{ByteStream, ChannelQuantity, FilePosition, MeasureError};

/// Most records of one group.
const MOST: usize = 64;

/// Channels sampled together.
#[derive(Debug)]
pub(crate) struct ChannelGroup {
    pub(crate) group: String,
    pub(crate) waveform: Waveform,
    pub(crate) samples: u64,
    /// Indices of the channels in the file.
    pub(crate) channels: Vec<usize>,
    pub(crate) selection: TdmsSelection,
}

/// Divides the channels of numbers of `file`, called `name`, into records.
pub(crate) fn gather<'a>(
    name: &str,
    file: &mut TdmsFile<Box<dyn ByteStream + 'a>>,
    notices: &mut Notices,
) -> Result<Vec<TdmsRecord>, MeasureError> {
    let mut records: Vec<ChannelGroup> = Vec::new();
    let mut of_group: BTreeMap<String, Vec<usize>> = BTreeMap::new();
    for id in 0..file.objects().len() {
        let object = &file.objects()[id];
        let TdmsPath::Channel(group, channel) = object.path() else { continue };
        let waveform = Waveform::of(name, object)?;
        let samples = object.samples();
        let reason = object.other_content().or(match samples {
            0 => Some("it has no samples"),
            1 if waveform.even.is_none() => Some("a single number without a time"),
            _ => None,
        });
        if let Some(reason) = reason {
            notices.left_out(channel, reason);
            continue;
        }
        let known = of_group.entry(group.clone()).or_default();
        let fits = |record: &ChannelGroup| {
            record.samples == samples && record.waveform.goes_with(&waveform)
        };
        let place = known.iter().copied().find(|place| fits(&records[*place]));
        let place = place.unwrap_or_else(|| {
            known.push(records.len());
            let (group, channels) = (group.clone(), Vec::new());
            let selection = TdmsSelection::default();
            records.push(ChannelGroup { group, waveform, samples, channels, selection });
            records.len() - 1
        });
        if known.len() > MOST {
            let found = format!("`scattered over {} rates, lengths or places`", known.len());
            let (start, expected) = (FilePosition::Offset(0), format!("at most {MOST} in a group"));
            return Err(MeasureError::malformed(
                name,
                start,
                "a group of channels",
                found,
                expected,
            ));
        }
        let record = &mut records[place];
        let selected = file.select(&mut record.selection, id);
        selected.map_err(|error| MeasureError::of_tdms(name, error))?;
        record.channels.push(id);
    }
    let mut divided = Vec::with_capacity(records.len());
    for record in records {
        divided.extend(divide_by_times(name, record, file, notices)?);
    }
    Ok(join(divided, file.objects()))
}

/// Channels that were sampled at the same time at one rate, perhaps with starts apart.
#[derive(Debug)]
pub(crate) struct TdmsRecord {
    /// Each with its start after the start of the first \[s\]; one at least.
    pub(crate) parts: Vec<(ChannelGroup, f64)>,
}

/// The channels of each time channel, of those with several.
fn divide_by_times<'a>(
    name: &str,
    record: ChannelGroup,
    file: &mut TdmsFile<Box<dyn ByteStream + 'a>>,
    notices: &mut Notices,
) -> Result<Vec<ChannelGroup>, MeasureError> {
    let headings: Vec<Heading> =
        record.channels.iter().map(|id| heading_of(&file.objects()[*id])).collect();
    let is_time = |slot: usize| headings[slot].quantity() == ChannelQuantity::Time;
    let times: Vec<usize> = (0..headings.len()).filter(|slot| is_time(*slot)).collect();
    if record.waveform.even.is_some() || times.len() < 2 || times.len() == headings.len() {
        return Ok(vec![record]);
    }
    let length = usize::try_from(record.samples).unwrap_or(usize::MAX);
    let mut vectors = Vec::with_capacity(headings.len());
    for (slot, heading) in headings.iter().enumerate() {
        // The times are not read yet: only names and places say.
        let times: Option<&[f64]> = is_time(slot).then_some(&[]);
        vectors.push(Vector { name: &heading.name, length, times });
    }
    let mut of = |slots: Vec<usize>| {
        let mut selection = TdmsSelection::default();
        let mut channels = Vec::with_capacity(slots.len());
        for slot in slots {
            let selected = file.select(&mut selection, record.channels[slot]);
            selected.map_err(|error| MeasureError::of_tdms(name, error))?;
            channels.push(record.channels[slot]);
        }
        let (group, waveform, samples) = (record.group.clone(), record.waveform, record.samples);
        Ok(ChannelGroup { group, waveform, samples, channels, selection })
    };
    match time_vectors(name, &vectors)? {
        TimeVectors::OfEach(time_of) => {
            let own =
                |time: &usize| (0..time_of.len()).filter(|at| time_of[*at] == *time).collect();
            times.iter().map(own).map(of).collect()
        }
        TimeVectors::First(others) => {
            for other in &others {
                let name = headings[*other].name.as_str();
                notices.left_out(name, "a second time of the same samples");
            }
            Ok(vec![of((0..headings.len()).filter(|slot| !others.contains(slot)).collect())?])
        }
    }
}

fn heading_of(object: &TdmsObject) -> Heading {
    waveform::heading(channel_name(object), object)
}

fn channel_name(object: &TdmsObject) -> &str {
    if let TdmsPath::Channel(_, name) = object.path() { name } else { "" }
}

/// Records of the groups that overlap in time.
///
/// Channels in different groups of the file remain apart where they share a quantity: they may be hits.
fn join(groups: Vec<ChannelGroup>, objects: &[TdmsObject]) -> Vec<TdmsRecord> {
    let mut records: Vec<TdmsRecord> = Vec::new();
    for group in groups {
        let fits = |record: &TdmsRecord| {
            record.parts.iter().all(|(part, _)| part.overlaps(&group, objects))
        };
        let Some(record) = records.iter_mut().find(|record| fits(record)) else {
            records.push(TdmsRecord { parts: vec![(group, 0.0)] });
            continue;
        };
        let first = record.parts[0].0.waveform.time;
        let after = first.zip(group.waveform.time).map_or(0.0, |(first, own)| own.since(first));
        record.parts.push((group, after));
    }
    records
}

impl ChannelGroup {
    /// True for channels of other names and the same rate in a time that overlaps.
    fn overlaps(&self, other: &Self, objects: &[TdmsObject]) -> bool {
        let names = |group: &Self| -> Vec<&str> {
            group.channels.iter().map(|id| channel_name(&objects[*id])).collect()
        };
        let (own, others) = (names(self), names(other));
        let quantities = |group: &Self| -> Vec<ChannelQuantity> {
            let headings = group.channels.iter().map(|id| heading_of(&objects[*id]));
            headings.map(|heading| heading.quantity()).collect()
        };
        let apart = || {
            let own = quantities(self);
            quantities(other).iter().all(|quantity| !own.contains(quantity))
        };
        if own.iter().any(|name| others.contains(name)) || self.group != other.group && !apart() {
            return false;
        }
        let (Some((start, step)), Some((other_start, other_step))) =
            (self.waveform.even, other.waveform.even)
        else {
            // Channels with times of their own, of one group.
            let untimed = self.waveform.even.is_none() && other.waveform.even.is_none();
            return untimed
                && self.group == other.group
                && own.len().min(others.len()) == 2
                && times_name(self, objects) != times_name(other, objects);
        };
        let (Some(time), Some(other_time)) = (self.waveform.time, other.waveform.time) else {
            return false;
        };
        let begin = other_time.since(time) + other_start - start;
        let ends = (self.samples as f64 * step, begin + other.samples as f64 * step);
        step == other_step
            && self.waveform.quantity == other.waveform.quantity
            && begin < ends.0
            && ends.1 > 0.0
    }
}

/// Name of the time channel of a group.
fn times_name<'o>(group: &ChannelGroup, objects: &'o [TdmsObject]) -> Option<&'o str> {
    let mut times = group.channels.iter().map(|id| &objects[*id]);
    let time = times.find(|object| heading_of(object).quantity() == ChannelQuantity::Time);
    time.map(channel_name)
}
