//! One measured signal with its axis and its unit.

use num_complex::Complex64;

use crate::{ChannelQuantity, MeasureError, SensorSensitivity, Unit};

/// One signal of a record.
#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    /// Its name in the file, or one made from its place there.
    pub name: String,
    /// What it measures, by its unit, else by what the file says of it, else by its name.
    pub quantity: ChannelQuantity,
    /// The unit of its samples, known or not.
    pub unit: ChannelUnit,
    /// Where the samples lie.
    pub abscissa: Abscissa,
    /// The samples, in `unit`.
    pub samples: Samples,
    /// What else the file says.
    pub origin: Origin,
}

/// The unit of a channel's samples: known, or for the caller to resolve.
#[derive(Debug, Clone, PartialEq)]
pub enum ChannelUnit {
    /// Known.
    Known(Unit),
    /// The file says none.
    Missing,
    /// The file says this, which is not understood.
    Unrecognised(String),
}

impl ChannelUnit {
    /// The unit that `text` names, or the explicit state of not knowing.
    pub fn of_text(text: &str) -> Self {
        match Unit::parse(text) {
            Some(unit) => Self::Known(unit),
            None if crate::unit::says_none(text) => Self::Missing,
            None => Self::Unrecognised(text.trim().to_owned()),
        }
    }

    /// The unit, if known.
    pub fn known(&self) -> Option<Unit> {
        if let Self::Known(unit) = self { Some(*unit) } else { None }
    }

    /// As written: the symbol, the text that was not understood, or nothing.
    pub fn text(&self) -> &str {
        match self {
            Self::Known(unit) => unit.symbol(),
            Self::Missing => "",
            Self::Unrecognised(text) => text,
        }
    }
}

/// Where samples lie, in SI: seconds for time, hertz for frequency.
#[derive(Debug, Clone, PartialEq)]
pub enum Abscissa {
    /// `start + n * step`.
    Even {
        /// Abscissa of the first sample.
        start: f64,
        /// Distance of two samples.
        step: f64,
        /// What the abscissa is.
        quantity: ChannelQuantity,
    },
    /// One abscissa for each sample.
    Uneven {
        /// The abscissae.
        values: Vec<f64>,
        /// What the abscissa is.
        quantity: ChannelQuantity,
    },
}

impl Abscissa {
    /// An even time axis from `start` seconds at `rate` hertz.
    pub fn even_time(start: f64, rate: f64) -> Self {
        Self::Even { start, step: 1.0 / rate, quantity: ChannelQuantity::Time }
    }

    /// What it is: time, frequency, or another.
    pub fn quantity(&self) -> ChannelQuantity {
        match self {
            Self::Even { quantity, .. } | Self::Uneven { quantity, .. } => *quantity,
        }
    }

    /// Samples per second; none for an uneven axis or one that is not time.
    pub fn sample_rate_hz(&self) -> Option<f64> {
        match self {
            Self::Even { step, quantity: ChannelQuantity::Time, .. } => {
                Some(crate::rate::of_step(*step))
            }
            _ => None,
        }
    }

    /// Abscissa of sample `index`; none beyond an uneven axis.
    pub fn at(&self, index: usize) -> Option<f64> {
        match self {
            Self::Even { start, step, .. } => Some(start + index as f64 * step),
            Self::Uneven { values, .. } => values.get(index).copied(),
        }
    }
}

/// Sampled values.
#[derive(Debug, Clone, PartialEq)]
pub enum Samples {
    /// Real samples.
    Real(Vec<f64>),
    /// Complex samples, such as those of a spectrum.
    Complex(Vec<Complex64>),
}

impl Samples {
    /// Number of samples.
    pub fn len(&self) -> usize {
        match self {
            Self::Real(values) => values.len(),
            Self::Complex(values) => values.len(),
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The samples, if they are real.
    pub fn real(&self) -> Option<&[f64]> {
        if let Self::Real(values) = self { Some(values) } else { None }
    }

    fn scale(&mut self, factor: f64) {
        match self {
            Self::Real(values) => values.iter_mut().for_each(|value| *value *= factor),
            Self::Complex(values) => values.iter_mut().for_each(|value| *value *= factor),
        }
    }
}

/// What a file says of a channel beyond its samples; all of it optional.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Origin {
    /// Free text that came with it.
    pub description: String,
    /// When it was measured, as written.
    pub date: String,
    /// Where the response was taken.
    pub response: Option<DegreeOfFreedom>,
    /// Where the excitation acted.
    pub reference: Option<DegreeOfFreedom>,
}

/// A node of a test and a direction there.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct DegreeOfFreedom {
    /// Name of the part; may be empty.
    pub entity: String,
    /// Number of the node.
    pub node: i64,
    /// 0 scalar, 1 to 3 along x, y, z, 4 to 6 about them, negative backwards.
    pub direction: i64,
}

impl Channel {
    /// Samples per second; none for an uneven axis or one that is not time.
    pub fn sample_rate_hz(&self) -> Option<f64> {
        self.abscissa.sample_rate_hz()
    }

    /// Gives the channel the unit that `text` names, for a file that says none
    /// or a wrong one; the samples stay.
    ///
    /// # Errors
    /// [`MeasureError::NotUnderstood`].
    pub fn set_unit(&mut self, text: &str) -> Result<(), MeasureError> {
        let unit = Unit::parse(text).ok_or_else(|| MeasureError::NotUnderstood {
            quantity: "unit",
            text: text.to_owned(),
            example: "m/s^2",
        })?;
        self.quantity = unit.quantity();
        self.unit = ChannelUnit::Known(unit);
        Ok(())
    }

    /// Converts the samples to the SI unit of their quantity.
    ///
    /// # Errors
    /// [`MeasureError::UnknownUnit`] while the unit is missing or not understood.
    pub fn to_si(&mut self) -> Result<(), MeasureError> {
        let unit = self.unit.known().ok_or_else(|| MeasureError::UnknownUnit {
            channel: self.name.clone(),
            text: self.unit.text().to_owned(),
        })?;
        if unit.factor() != 1.0 {
            self.samples.scale(unit.factor());
            self.unit = Unit::si(unit.quantity()).map_or(ChannelUnit::Missing, ChannelUnit::Known);
        }
        self.quantity = unit.quantity();
        Ok(())
    }

    /// From a sensor's output to what it measures, in SI.
    ///
    /// # Errors
    /// [`MeasureError::UnknownUnit`] while the unit is missing or not understood,
    /// [`MeasureError::QuantityMismatch`] where the samples are not what the
    /// sensor gives, such as a channel in newtons.
    pub fn calibrate(&mut self, sensitivity: &SensorSensitivity) -> Result<(), MeasureError> {
        if let Some(unit) = self.unit.known()
            && unit.quantity() != sensitivity.output()
        {
            return Err(MeasureError::QuantityMismatch {
                channel: self.name.clone(),
                found: unit.quantity(),
                expected: sensitivity.output(),
            });
        }
        self.to_si()?;
        self.samples.scale(1.0 / sensitivity.output_per_si());
        self.quantity = sensitivity.measures();
        self.unit = Unit::si(self.quantity).map_or(ChannelUnit::Missing, ChannelUnit::Known);
        Ok(())
    }
}
