//! Channels sampled together.
//!
//! A record has the channels of one group with the same number of samples, the same axis and the
//! same start to half a step. Groups are often tasks or hits with the same names of channels.

use std::collections::BTreeMap;

use crate::tdms_file::{TdmsFile, TdmsPath, TdmsSelection};

use crate::notice::Notices;
use crate::tdms::waveform::Waveform;
use crate::{ByteStream, FilePosition, MeasureError};

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
) -> Result<Vec<ChannelGroup>, MeasureError> {
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
    Ok(records)
}
