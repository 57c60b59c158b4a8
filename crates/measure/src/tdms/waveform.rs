//! Axis and unit of a channel from its properties.

use crate::heading::Heading;
use crate::source::Source;
use crate::tdms::property::Timestamp;
use crate::tdms::property::{Properties, Property};
use crate::{ChannelQuantity, ChannelUnit, MeasureError, Unit, unit};

/// The axis of a channel from its properties `wf_...`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Waveform {
    /// Start and step in SI; none without `wf_increment`.
    pub(crate) even: Option<(f64, f64)>,
    pub(crate) quantity: ChannelQuantity,
    /// Time of the first sample, less the start.
    pub(crate) time: Option<Timestamp>,
}

impl Waveform {
    /// Reads the properties of a channel.
    pub(crate) fn of(source: &Source<'_>, properties: &Properties) -> Result<Self, MeasureError> {
        let unit = text(properties, "wf_xunit_string").and_then(Unit::parse);
        let (quantity, factor) = match unit {
            Some(unit) => (unit.quantity(), unit.factor()),
            None => {
                match ChannelQuantity::of_name(text(properties, "wf_xname").unwrap_or_default()) {
                    ChannelQuantity::Frequency => (ChannelQuantity::Frequency, 1.0),
                    _ => (ChannelQuantity::Time, 1.0),
                }
            }
        };
        let number = |name: &'static str, positive: bool| {
            let Some(property) = properties.get(name) else { return Ok(0.0) };
            let found = property.number();
            let usable = |number: &f64| number.is_finite() && !(positive && *number < 0.0);
            found.filter(usable).ok_or_else(|| {
                let found = found.map_or("no number".to_owned(), |number| number.to_string());
                let expected = if positive { "a positive step" } else { "a finite start" };
                source.malformed(property.place, name, &found, expected)
            })
        };
        let (step, start) = (number("wf_increment", true)?, number("wf_start_offset", false)?);
        let time = match properties.get("wf_start_time").map(|property| &property.value) {
            Some(crate::tdms::property::PropertyValue::Time(time)) => Some(*time),
            _ => None,
        };
        // LabVIEW writes a step of zero for a channel without one.
        let even = (step > 0.0).then_some((start * factor, step * factor));
        Ok(Self { even, quantity, time })
    }

    /// True for the same sample times as those of `other`.
    pub(crate) fn goes_with(&self, other: &Self) -> bool {
        let apart = match (self.time, other.time) {
            (Some(one), Some(other)) => one.since(other).abs(),
            _ => 0.0,
        };
        let step = self.even.map_or(f64::INFINITY, |(_, step)| step);
        self.even == other.even && self.quantity == other.quantity && apart <= 0.5 * step
    }
}

/// Name and unit of a channel: the unit from its properties, else from its name.
pub(crate) fn heading(name: &str, properties: &Properties) -> Heading {
    let stated = ["unit_string", "NI_UnitDescription"].into_iter();
    let mut stated = stated.filter_map(|key| text(properties, key));
    match stated.find(|text| !unit::says_none(text)) {
        Some(text) => Heading { name: name.to_owned(), unit: ChannelUnit::of_text(text) },
        None => Heading::parse(name),
    }
}

/// A text property.
pub(crate) fn text<'p>(properties: &'p Properties, name: &str) -> Option<&'p str> {
    properties.get(name).and_then(Property::text)
}
