//! Dataset 164, the file's system of units, and the unit of a channel.

use crate::notice::Notices;
use crate::source::Source;
use crate::uff::fields::real;
use crate::uff::header::{AxisHeader, FRF, FunctionHeader};
use crate::{ChannelQuantity, ChannelUnit, FrfUnits, MeasureError, Notice, Unit};

/// Factors from SI to the units of the file, `file = factor * SI`.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct System {
    length: f64,
    force: f64,
}

impl System {
    /// Reads the text of dataset 164 after its first line: the factors of
    /// length, force and temperature, and the offset of temperature.
    pub(crate) fn parse(
        source: &Source<'_>,
        place: crate::FilePosition,
        factors: &str,
    ) -> Result<Self, MeasureError> {
        let mut numbers = factors.split_ascii_whitespace();
        let mut factor = |quantity| {
            let field = numbers.next().unwrap_or_default();
            real(field)
                .filter(|value| value.is_finite() && *value > 0.0)
                .ok_or_else(|| source.malformed(place, quantity, field, "a positive factor"))
        };
        Ok(Self { length: factor("the length factor")?, force: factor("the force factor")? })
    }

    /// SI value of the unit of a `quantity` of length and force.
    fn in_si(&self, quantity: ChannelQuantity) -> Option<f64> {
        match quantity {
            ChannelQuantity::Force => Some(1.0 / self.force),
            ChannelQuantity::Acceleration
            | ChannelQuantity::Velocity
            | ChannelQuantity::Displacement => Some(1.0 / self.length),
            ChannelQuantity::Pressure => Some(self.length * self.length / self.force),
            _ => None,
        }
    }
}

/// Units of a frequency response function, from its labels, else from the file's system.
pub(crate) fn frf_units(header: &FunctionHeader, system: Option<&System>) -> Option<FrfUnits> {
    let known = |axis: &AxisHeader| {
        let stated = axis.quantity();
        if crate::unit::says_none(&axis.unit) {
            return system?.in_si(stated).map(|factor| Unit::of_factor(stated, factor));
        }
        let unit = Unit::parse(&axis.unit)?;
        (stated == ChannelQuantity::Unknown || stated == unit.quantity()).then_some(unit)
    };
    let (response, excitation) = (known(&header.ordinate)?, known(&header.denominator)?);
    (header.function == FRF).then_some(FrfUnits { response, excitation })
}

/// The unit of a channel, from its label, else from the file's system.
pub(crate) fn unit_of(
    header: &FunctionHeader,
    system: Option<&System>,
    name: &str,
    notices: &mut Notices,
) -> (ChannelUnit, ChannelQuantity) {
    let stated = header.ordinate.quantity();
    let label = &header.ordinate.unit;
    if !header.denominator.unit.is_empty() {
        // A ratio, such as a frequency response in g/N, has no quantity.
        let ratio = format!("{label}/{}", header.denominator.unit);
        return (ChannelUnit::of_text(&ratio), ChannelQuantity::Unknown);
    }
    let unit = ChannelUnit::of_text(label);
    match (&unit, system) {
        (ChannelUnit::Known(known), Some(system)) => {
            let channel_factor = known.factor();
            if let Some(file_factor) = system.in_si(known.quantity())
                && (file_factor / channel_factor - 1.0).abs() > 1e-3
            {
                let channel = name.to_owned();
                notices.add(Notice::UnitsDisagree { channel, channel_factor, file_factor });
            }
        }
        (ChannelUnit::Missing, Some(system)) => {
            if let Some(factor) = system.in_si(stated) {
                let channel = name.to_owned();
                notices.add(Notice::UnitOfFile { channel, quantity: stated, factor });
                return (ChannelUnit::Known(Unit::of_factor(stated, factor)), stated);
            }
        }
        _ => {}
    }
    (unit, stated)
}
