//! Channels sampled together.
//!
//! A record has the channels of one group with the same number of samples, the same axis and the
//! same start to half a step. Groups are often tasks or hits with the same names of channels.

use std::collections::BTreeMap;

use crate::decoding::Budget;
use crate::notice::Notices;
use crate::source::Source;
use crate::tdms::axis;
use crate::tdms::chunk_group::ChunkGroup;
use crate::tdms::object::ObjectPath;
use crate::tdms::object::TdmsObject;
use crate::tdms::property::Properties;
use crate::tdms::scale::Scales;
use crate::tdms::waveform::Waveform;
use crate::{FilePosition, MeasureError, Notice};

/// Most records of one group, and chunk groups of a record.
const MOST: usize = 64;

/// A channel of a record.
#[derive(Debug)]
pub(crate) struct Member {
    pub(crate) object: usize,
    pub(crate) scales: Scales,
}

/// Channels sampled together.
#[derive(Debug)]
pub(crate) struct ChannelGroup {
    pub(crate) group: String,
    pub(crate) waveform: Waveform,
    pub(crate) samples: u64,
    pub(crate) members: Vec<Member>,
    pub(crate) chunk_groups: Vec<ChunkGroup>,
}

/// Divides the channels of numbers into records.
pub(crate) fn gather(
    source: &Source<'_>,
    objects: &[TdmsObject],
    budget: &mut Budget,
    notices: &mut Notices,
) -> Result<Vec<ChannelGroup>, MeasureError> {
    let mut records: Vec<ChannelGroup> = Vec::new();
    let mut of_group: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    let mut above = InheritedScales::of(objects);
    let start = FilePosition::Offset(0);
    for (id, object) in objects.iter().enumerate() {
        let ObjectPath::Channel(group, name) = &object.path else { continue };
        let waveform = Waveform::of(source, &object.properties)?;
        let reason = object.other.or(match object.samples {
            0 => Some("it has no samples"),
            1 if waveform.even.is_none() => Some("a single number without a time"),
            _ => None,
        });
        if let Some(reason) = reason {
            notices.add(Notice::ArrayLeftOut { array: name.clone(), reason });
            continue;
        }
        let scales = match Scales::of(source, &object.properties)? {
            Some(scales) => scales,
            None => above.scales(source, group)?,
        };
        let held = 512 + 16 * scales.len() as u64 + 4 * name.len() as u64;
        budget.take(object.samples.saturating_mul(8).saturating_add(held), start, "the samples")?;

        let known = of_group.entry(group).or_default();
        let fits = |record: &ChannelGroup| {
            record.samples == object.samples && record.waveform.goes_with(&waveform)
        };
        let place = known.iter().copied().find(|place| fits(&records[*place]));
        let place = place.unwrap_or_else(|| {
            known.push(records.len());
            let (group, samples) = (group.clone(), object.samples);
            let (members, chunk_groups) = (Vec::new(), Vec::new());
            records.push(ChannelGroup { group, waveform, samples, members, chunk_groups });
            records.len() - 1
        });
        let (known, record) = (known.len(), &mut records[place]);
        let slot = record.members.len();
        if !record.chunk_groups.iter_mut().any(|chunk_group| chunk_group.join(slot, id, objects)) {
            record.chunk_groups.push(ChunkGroup::of(slot, id));
        }
        record.members.push(Member { object: id, scales });
        let most = known.max(record.chunk_groups.len());
        if most > MOST {
            let found = format!("scattered over {most} rates, lengths or places");
            let expected = format!("at most {MOST} in a group");
            return Err(source.malformed(start, "a group of channels", &found, expected));
        }
    }
    // Uneven times are kept for every channel.
    for record in records.iter().filter(|record| axis::times_of(record, objects).is_some()) {
        let times = record.samples.saturating_mul(8 * record.members.len() as u64);
        budget.take(times, start, "the times")?;
    }
    // Each record reads all chunks that it shares.
    let passes = records.iter().flat_map(|record| &record.chunk_groups);
    let cost = passes.map(|chunk_group| chunk_group.cost(objects)).fold(0, u64::saturating_add);
    let limit = (source.len() + (1 << 20)).saturating_mul(MOST as u64);
    if cost > limit {
        let expected = format!("at most {MOST} passes over the file");
        let found = "scattered: they take more to read";
        return Err(source.malformed(start, "the layout of the channels", found, expected));
    }
    Ok(records)
}

/// Scales of groups and of the file, for channels without, each read once.
struct InheritedScales<'o> {
    file: Option<&'o Properties>,
    groups: BTreeMap<&'o str, &'o Properties>,
    of_file: Option<Scales>,
    of_groups: BTreeMap<&'o str, Scales>,
}

impl<'o> InheritedScales<'o> {
    fn of(objects: &'o [TdmsObject]) -> Self {
        let (mut file, mut groups) = (None, BTreeMap::new());
        for object in objects {
            match &object.path {
                ObjectPath::File => file = Some(&object.properties),
                ObjectPath::Group(name) => {
                    groups.insert(name.as_str(), &object.properties);
                }
                ObjectPath::Channel(..) => {}
            }
        }
        Self { file, groups, of_file: None, of_groups: BTreeMap::new() }
    }

    /// The scales of a group, else of the file.
    fn scales(&mut self, source: &Source<'_>, group: &'o str) -> Result<Scales, MeasureError> {
        if let Some(known) = self.of_groups.get(group) {
            return Ok(known.clone());
        }
        let read = |properties: Option<&&Properties>| match properties {
            Some(properties) => Scales::of(source, properties),
            None => Ok(None),
        };
        let scales = match (read(self.groups.get(group))?, &self.of_file) {
            (Some(scales), _) => scales,
            (None, Some(known)) => known.clone(),
            (None, None) => {
                let scales = read(self.file.as_ref())?.unwrap_or_default();
                self.of_file.insert(scales).clone()
            }
        };
        self.of_groups.insert(group, scales.clone());
        Ok(scales)
    }
}
