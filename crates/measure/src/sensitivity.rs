//! Sensitivities of sensors.

use crate::{ChannelQuantity, MeasureError, Unit};

/// The sensitivity of a sensor, `output = output_per_si * input`.
///
/// ```
/// use asperity_measure::{ChannelQuantity, SensorSensitivity};
/// let hammer: SensorSensitivity = "2.25 mV/N".parse()?;
/// assert_eq!(hammer.measures(), ChannelQuantity::Force);
/// let accelerometer: SensorSensitivity = "100 mV/g".parse()?;
/// assert!((accelerometer.output_per_si() - 0.1 / 9.80665).abs() < 1e-15);
/// # Ok::<(), asperity_measure::MeasureError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SensorSensitivity {
    output: ChannelQuantity,
    measures: ChannelQuantity,
    output_per_si: f64,
}

impl SensorSensitivity {
    /// Quantity of the output: [`ChannelQuantity::Voltage`], or [`ChannelQuantity::FullScale`]
    /// for a sensor calibrated with its converter (`0.02 FS/N`).
    pub fn output(&self) -> ChannelQuantity {
        self.output
    }

    /// Measured quantity.
    pub fn measures(&self) -> ChannelQuantity {
        self.measures
    }

    /// Output in SI (V) per SI unit of the measured quantity.
    pub fn output_per_si(&self) -> f64 {
        self.output_per_si
    }
}

impl std::str::FromStr for SensorSensitivity {
    type Err = MeasureError;

    /// Reads `100 mV/g`, `2.25 mV/N`, `10 mV/(m/s^2)`, `0.05 FS/N`.
    ///
    /// # Errors
    /// [`MeasureError::NotUnderstood`] for other texts, and for a
    /// sensitivity that is zero or not finite.
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        parse(text).ok_or_else(|| MeasureError::NotUnderstood {
            quantity: "sensitivity",
            text: text.to_owned(),
            example: "100 mV/g",
        })
    }
}

fn parse(text: &str) -> Option<SensorSensitivity> {
    let (output, input) = text.split_once('/')?;
    let output = output.trim();
    let unit_start = output.rfind(|c: char| c.is_ascii_digit() || c == '.')? + 1;
    let value: f64 = output[..unit_start].trim().parse().ok()?;
    let output_unit = Unit::parse(&output[unit_start..])?;
    let input_unit = Unit::parse(input)?;
    let measures = input_unit.quantity();
    let physical = !matches!(
        measures,
        ChannelQuantity::Voltage | ChannelQuantity::FullScale | ChannelQuantity::Time
    );
    let electric =
        matches!(output_unit.quantity(), ChannelQuantity::Voltage | ChannelQuantity::FullScale);
    let output_per_si = value * output_unit.factor() / input_unit.factor();
    let usable = output_per_si.is_finite() && output_per_si != 0.0;
    (physical && electric && usable).then_some(SensorSensitivity {
        output: output_unit.quantity(),
        measures,
        output_per_si,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sensitivities_as_written_on_calibration_sheets() {
        for (text, measures, per_si) in [
            ("100 mV/g", ChannelQuantity::Acceleration, 0.1 / 9.80665),
            ("2.25 mV/N", ChannelQuantity::Force, 2.25e-3),
            ("10 mV/(m/s^2)", ChannelQuantity::Acceleration, 0.01),
            ("10mV/m/s²", ChannelQuantity::Acceleration, 0.01),
            ("11.2 mV/lbf", ChannelQuantity::Force, 11.2e-3 / 4.448_221_615_260_5),
            ("-5e-2 V/Pa", ChannelQuantity::Pressure, -0.05),
            ("0.02 FS/N", ChannelQuantity::Force, 0.02),
        ] {
            let read: SensorSensitivity = text.parse().unwrap();
            assert_eq!(read.measures(), measures, "{text}");
            assert!((read.output_per_si() / per_si - 1.0).abs() < 1e-12, "{text}");
        }
    }

    #[test]
    fn invalid_sensitivities_are_rejected() {
        for text in
            ["", "/", "100", "mV/g", "100 mV", "0 mV/g", "inf V/N", "5 pC/N", "1 N/V", "1 V/V"]
        {
            assert!(text.parse::<SensorSensitivity>().is_err(), "{text}");
        }
    }
}
