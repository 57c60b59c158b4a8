//! Axis and unit of a channel from its properties.

use crate::tdms_file::{TdmsObject, TdmsProperty, TdmsTime};

use crate::error::excerpt;
use crate::heading::Heading;
use crate::{ChannelQuantity, ChannelUnit, FilePosition, MeasureError, Unit, unit};

/// The axis of a channel from its properties `wf_...`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Waveform {
    /// Start and step in SI; none without `wf_increment`.
    pub(crate) even: Option<(f64, f64)>,
    pub(crate) quantity: ChannelQuantity,
    /// Time of the first sample, less the start.
    pub(crate) time: Option<TdmsTime>,
}

impl Waveform {
    /// Reads the properties of a channel of `file`.
    pub(crate) fn of(file: &str, channel: &TdmsObject) -> Result<Self, MeasureError> {
        let (quantity, factor) = match text(channel, "wf_xunit_string").and_then(Unit::parse) {
            Some(unit) => (unit.quantity(), unit.factor()),
            None => match text(channel, "wf_xname").map(ChannelQuantity::of_name) {
                Some(ChannelQuantity::Frequency) => (ChannelQuantity::Frequency, 1.0),
                _ => (ChannelQuantity::Time, 1.0),
            },
        };
        let number = |name: &'static str, lowest: f64, expected: &str| {
            let Some(property) = channel.property(name) else { return Ok(0.0) };
            let found = property.number();
            let usable = |number: &f64| number.is_finite() && *number >= lowest;
            found.filter(usable).ok_or_else(|| {
                let found = found.map_or("no number".to_owned(), |number| number.to_string());
                let place = FilePosition::Offset(property.offset);
                MeasureError::malformed(file, place, name, excerpt(&found), expected)
            })
        };
        let step = number("wf_increment", 0.0, "a positive step")?;
        let start = number("wf_start_offset", f64::NEG_INFINITY, "a finite start")?;
        let time = channel.property("wf_start_time").and_then(TdmsProperty::time);
        // LabVIEW writes a step of zero for a channel without one.
        let even = (step > 0.0).then_some((start * factor, step * factor));
        Ok(Self { even, quantity, time })
    }

    /// True for the same sample times as `other`.
    pub(crate) fn goes_with(&self, other: &Self) -> bool {
        let apart = match (self.time, other.time) {
            (Some(one), Some(other)) => one.since(other).abs(),
            _ => 0.0,
        };
        let step = self.even.map_or(f64::INFINITY, |(_, step)| step);
        self.even == other.even && self.quantity == other.quantity && apart <= 0.5 * step
    }
}

/// True for a property used by records.
pub(crate) fn is_used(property: &str) -> bool {
    const NAMES: [&str; 8] = [
        "wf_increment",
        "wf_start_offset",
        "wf_start_time",
        "wf_xunit_string",
        "wf_xname",
        "unit_string",
        "NI_UnitDescription",
        "description",
    ];
    NAMES.contains(&property)
}

/// Name and unit of a channel: the unit from its properties, else from its name.
pub(crate) fn heading(name: &str, channel: &TdmsObject) -> Heading {
    let stated = ["unit_string", "NI_UnitDescription"].into_iter();
    let mut stated = stated.filter_map(|key| text(channel, key));
    match stated.find(|text| !unit::says_none(text)) {
        Some(text) => Heading { name: name.to_owned(), unit: ChannelUnit::of_text(text) },
        None => Heading::parse(name),
    }
}

/// A text property.
pub(crate) fn text<'o>(channel: &'o TdmsObject, name: &str) -> Option<&'o str> {
    channel.property(name).and_then(TdmsProperty::text)
}
