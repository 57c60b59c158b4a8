//! The eleven lines before the numbers of a function.

use crate::notice::Notices;
use crate::rate;
use crate::source::{Source, decode_text};
use crate::uff::fields::{columns, integer, numbers, real, text};
use crate::{ChannelQuantity, DegreeOfFreedom, MeasureError, Notice, Unit};

/// The header of dataset 58.
#[derive(Debug)]
pub(crate) struct FunctionHeader {
    pub(crate) name: String,
    pub(crate) description: String,
    pub(crate) date: String,
    /// 1 time response, 2 and 3 spectra, 4 frequency response, ...
    pub(crate) function: i64,
    pub(crate) response: Option<DegreeOfFreedom>,
    pub(crate) reference: Option<DegreeOfFreedom>,
    pub(crate) double: bool,
    pub(crate) complex: bool,
    pub(crate) points: u64,
    pub(crate) even: bool,
    pub(crate) start: f64,
    pub(crate) step: f64,
    pub(crate) step_uncertainty: f64,
    pub(crate) abscissa: AxisHeader,
    pub(crate) ordinate: AxisHeader,
    pub(crate) denominator: AxisHeader,
}

/// One of the axes of a function.
#[derive(Debug)]
pub(crate) struct AxisHeader {
    /// Specific data type: 12 acceleration, 13 force, 17 time, ...
    pub(crate) kind: i64,
    pub(crate) unit: String,
}

/// Function type of a frequency response function.
pub(crate) const FRF: i64 = 4;

/// Function type of a coherence.
pub(crate) const COHERENCE: i64 = 6;

/// Specific data types with their quantity and label; the first of a quantity is written.
pub(crate) const SPECIFIC_TYPES: [(i64, ChannelQuantity, &str); 11] = [
    (15, ChannelQuantity::Pressure, "Pressure"),
    (2, ChannelQuantity::Pressure, "Stress"),
    (21, ChannelQuantity::Pressure, "Sound pressure"),
    (3, ChannelQuantity::Strain, "Strain"),
    (8, ChannelQuantity::Displacement, "Displacement"),
    (13, ChannelQuantity::Force, "Force"),
    (9, ChannelQuantity::Force, "Reaction force"),
    (11, ChannelQuantity::Velocity, "Velocity"),
    (12, ChannelQuantity::Acceleration, "Acceleration"),
    (17, ChannelQuantity::Time, "Time"),
    (18, ChannelQuantity::Frequency, "Frequency"),
];

impl AxisHeader {
    /// The quantity of the specific data type.
    pub(crate) fn quantity(&self) -> ChannelQuantity {
        let known = SPECIFIC_TYPES.iter().find(|(kind, _, _)| *kind == self.kind);
        known.map_or(ChannelQuantity::Unknown, |(_, quantity, _)| *quantity)
    }
}

impl FunctionHeader {
    /// Reads the header from the line after the number of the dataset.
    pub(crate) fn read(
        source: &mut Source<'_>,
        notices: &mut Notices,
    ) -> Result<Self, MeasureError> {
        let name = text(&next_line(source, notices)?);
        let description = text(&next_line(source, notices)?);
        let date = text(&next_line(source, notices)?);
        next_line(source, notices)?;
        next_line(source, notices)?;

        let nodes = next_line(source, notices)?;
        let freedom = |entity: usize| {
            let (node, direction) =
                (columns(&nodes, entity + 10, 10), columns(&nodes, entity + 20, 4));
            Some(DegreeOfFreedom {
                entity: text(columns(&nodes, entity, 10)),
                node: integer(node)?,
                direction: integer(direction)?,
            })
        };
        let function = integer(columns(&nodes, 0, 5)).unwrap_or(0);
        let (response, reference) = (freedom(31), freedom(56));

        // Positions in binary files are given in bytes.
        let place = source.place();
        let layout = next_line(source, notices)?;
        let cut = numbers(&layout, &[10, 10, 10, 13, 13, 13]);
        let field = |index: usize| cut.get(index).copied().unwrap_or_default();
        let wrong = |quantity, index: usize, expected: &str| {
            source.malformed(place, quantity, field(index), expected)
        };
        let kind = integer(field(0));
        let (double, complex) = match kind {
            Some(2) => (false, false),
            Some(4) => (true, false),
            Some(5) => (false, true),
            Some(6) => (true, true),
            _ => return Err(wrong("the ordinate data type", 0, "2, 4, 5 or 6")),
        };
        let points = integer(field(1)).and_then(|points| u64::try_from(points).ok());
        let points = points.ok_or_else(|| wrong("the number of points", 1, "a count"))?;
        let even = match integer(field(2)) {
            Some(0) => false,
            Some(1) => true,
            _ => return Err(wrong("the abscissa spacing", 2, "0 (uneven) or 1 (even)")),
        };
        let axis_number = |index: usize, quantity| {
            let value = if field(index).is_empty() { Some(0.0) } else { real(field(index)) };
            value
                .filter(|value| value.is_finite())
                .ok_or_else(|| wrong(quantity, index, "a finite number"))
        };
        let start = axis_number(3, "the abscissa minimum")?;
        let step = axis_number(4, "the abscissa increment")?;
        if even && step < 0.0 {
            return Err(wrong("the abscissa increment", 4, "zero or a positive number"));
        }
        let step_uncertainty = rate::uncertainty_of_printed_step(field(4));

        let mut axis = || {
            let line = next_line(source, notices)?;
            Ok(AxisHeader {
                kind: integer(columns(&line, 0, 10)).unwrap_or(0),
                unit: text(columns(&line, 47, 20)),
            })
        };
        let (abscissa, ordinate, denominator) = (axis()?, axis()?, axis()?);
        axis()?;
        Ok(Self {
            name,
            description,
            date,
            function,
            response,
            reference,
            double,
            complex,
            points,
            even,
            start,
            step,
            step_uncertainty,
            abscissa,
            ordinate,
            denominator,
        })
    }

    /// Values of one point, with its abscissa if the axis is uneven.
    pub(crate) fn values_per_point(&self) -> u64 {
        1 + u64::from(self.complex) + u64::from(!self.even)
    }

    /// Name of the channel: the first line, the response, or its number.
    pub(crate) fn channel_name(&self, index: usize) -> String {
        if !self.name.is_empty() {
            return self.name.clone();
        }
        let entity = self.response.as_ref().map_or("", |response| response.entity.as_str());
        if entity.is_empty() { format!("channel {}", index + 1) } else { entity.to_owned() }
    }

    /// Quantity of the abscissa, and the SI value of its unit.
    pub(crate) fn abscissa_unit(&self) -> (ChannelQuantity, f64) {
        let unit = Unit::parse(&self.abscissa.unit);
        let stated = self.abscissa.quantity();
        match unit {
            Some(unit) if stated == ChannelQuantity::Unknown || stated == unit.quantity() => {
                (unit.quantity(), unit.factor())
            }
            // The axis of a time response is time even if it is not named.
            None if stated == ChannelQuantity::Unknown && self.function == 1 => {
                (ChannelQuantity::Time, 1.0)
            }
            _ => (stated, 1.0),
        }
    }
}

/// The next line, which is required.
fn next_line(source: &mut Source<'_>, notices: &mut Notices) -> Result<String, MeasureError> {
    let (place, mut bytes) = (source.place(), Vec::new());
    if !source.read_line(&mut bytes)? {
        return Err(source.malformed(place, "the header", "cut off", "11 lines of dataset 58"));
    }
    let (line, latin1) = decode_text(&bytes);
    if latin1 {
        notices.add(Notice::Latin1 { place });
    }
    Ok(line.into_owned())
}
