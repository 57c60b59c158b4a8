//! One measured signal with its axis and its unit.

use num_complex::Complex64;

use crate::notice::{Notice, Notices};
use crate::{ChannelQuantity, MeasureError, SensorSensitivity, Unit, rate};

/// One signal of a record.
#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    /// Name in the file, or one made from its position.
    pub name: String,
    /// Quantity, from the unit, else from the file, else from the name.
    pub quantity: ChannelQuantity,
    /// Unit of the samples.
    pub unit: ChannelUnit,
    /// Axis of the samples.
    pub abscissa: Abscissa,
    /// The samples, in `unit`.
    pub samples: Samples,
    /// Further information from the file.
    pub origin: Origin,
}

/// The unit of samples, if the file gives a known one.
#[derive(Debug, Clone, PartialEq)]
pub enum ChannelUnit {
    /// Known.
    Known(Unit),
    /// The file gives none.
    Missing,
    /// The file gives this unknown one.
    Unrecognised(String),
}

impl ChannelUnit {
    /// The unit of a text.
    pub fn of_text(text: &str) -> Self {
        match Unit::parse(text) {
            Some(unit) => Self::Known(unit),
            None if crate::unit::says_none(text) => Self::Missing,
            None => Self::Unrecognised(text.trim().to_owned()),
        }
    }

    /// The SI unit of a quantity; missing if the quantity is unknown.
    pub(crate) fn si(quantity: ChannelQuantity) -> Self {
        Unit::si(quantity).map_or(Self::Missing, Self::Known)
    }

    /// The unit, if known.
    pub fn known(&self) -> Option<Unit> {
        if let Self::Known(unit) = self { Some(*unit) } else { None }
    }

    /// The symbol, the unknown text, or nothing.
    pub fn text(&self) -> &str {
        match self {
            Self::Known(unit) => unit.symbol(),
            Self::Missing => "",
            Self::Unrecognised(text) => text,
        }
    }
}

/// The axis of samples, in SI: seconds for time, hertz for frequency.
#[derive(Debug, Clone, PartialEq)]
pub enum Abscissa {
    /// `start + n * step`.
    Even {
        /// Abscissa of the first sample.
        start: f64,
        /// Spacing of samples.
        step: f64,
        /// Quantity of the abscissa.
        quantity: ChannelQuantity,
    },
    /// One abscissa for each sample.
    Uneven {
        /// The abscissae.
        values: Vec<f64>,
        /// Quantity of the abscissa.
        quantity: ChannelQuantity,
    },
}

impl Abscissa {
    /// An even time axis from `start` seconds at `rate` hertz.
    pub fn even_time(start: f64, rate: f64) -> Self {
        Self::Even { start, step: 1.0 / rate, quantity: ChannelQuantity::Time }
    }

    /// The axis of measured times (seconds): even, with a whole rate where there is one, if the times
    /// are so within their rounding.
    ///
    /// - `relative_rounding`: of the times, such as [`f64::EPSILON`], or [`f32::EPSILON`] of times
    ///   that were in single precision.
    ///
    /// ```
    /// use asperity_measure::Abscissa;
    /// let times = (0..100).map(|n| f64::from(n) / 51_200.0).collect();
    /// assert_eq!(Abscissa::of_times(times, f64::EPSILON).sample_rate_hz(), Some(51_200.0));
    /// ```
    pub fn of_times(values: Vec<f64>, relative_rounding: f64) -> Self {
        let largest = values.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
        let quantity = ChannelQuantity::Time;
        let rounding = |_| relative_rounding * largest;
        match rate::even_axis(&values, rounding, &mut Notices::default()) {
            Some((start, step)) => Self::Even { start, step, quantity },
            None => Self::Uneven { values, quantity },
        }
    }

    /// The times of a block from sample `from` of an axis that is even in the first block; uneven with a
    /// notice if the block does not continue it to within `tolerance(expected)`.
    pub(crate) fn continued(
        (start, step): (f64, f64),
        from: u64,
        values: Vec<f64>,
        tolerance: impl Fn(f64) -> f64,
        notices: &mut Notices,
    ) -> Self {
        let (start, quantity) = (start + from as f64 * step, ChannelQuantity::Time);
        if rate::is_even(&values, (start, step), |_, expected| tolerance(expected)) {
            return Self::Even { start, step, quantity };
        }
        notices.add(Notice::UnevenBlock { sample: from });
        Self::Uneven { values, quantity }
    }

    /// Quantity: time, frequency, or another.
    pub fn quantity(&self) -> ChannelQuantity {
        match self {
            Self::Even { quantity, .. } | Self::Uneven { quantity, .. } => *quantity,
        }
    }

    /// Sample rate \[Hz\]; none for an uneven axis or one that is not time.
    pub fn sample_rate_hz(&self) -> Option<f64> {
        match self {
            Self::Even { step, quantity: ChannelQuantity::Time, .. } => Some(rate::of_step(*step)),
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
    /// Complex samples, such as a spectrum.
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

    /// True without samples.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The samples, if they are real.
    pub fn real(&self) -> Option<&[f64]> {
        if let Self::Real(values) = self { Some(values) } else { None }
    }

    /// Samples of real numbers, or of pairs of real and imaginary parts.
    pub(crate) fn of_parts(parts: Vec<f64>, complex: bool) -> Self {
        if !complex {
            return Self::Real(parts);
        }
        let pairs = parts.chunks_exact(2);
        Self::Complex(pairs.map(|pair| Complex64::new(pair[0], pair[1])).collect())
    }

    fn scale(&mut self, factor: f64) {
        match self {
            Self::Real(values) => scale(values, factor),
            Self::Complex(values) => values.iter_mut().for_each(|value| *value *= factor),
        }
    }
}

/// Multiplies `values` by `factor`.
pub(crate) fn scale(values: &mut [f64], factor: f64) {
    for value in values {
        *value *= factor;
    }
}

/// Optional information on a channel.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Origin {
    /// Free text.
    pub description: String,
    /// Date of the measurement, as written.
    pub date: String,
    /// Degree of freedom of the response.
    pub response: Option<DegreeOfFreedom>,
    /// Degree of freedom of the excitation.
    pub reference: Option<DegreeOfFreedom>,
    /// Units of the response and of the excitation, for a frequency response function.
    pub frf: Option<FrfUnits>,
    /// True if the file calls the samples a coherence.
    pub is_coherence: bool,
}

/// Units of a frequency response function: response over excitation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrfUnits {
    /// Unit of the response.
    pub response: Unit,
    /// Unit of the excitation.
    pub excitation: Unit,
}

impl FrfUnits {
    /// SI units of two quantities; `None` for one without a unit.
    pub fn si(response: ChannelQuantity, excitation: ChannelQuantity) -> Option<Self> {
        Some(Self { response: Unit::si(response)?, excitation: Unit::si(excitation)? })
    }

    /// The units of a quotient such as `m/s^2/N`; `None` for other texts.
    pub fn parse(text: &str) -> Option<Self> {
        let (response, excitation) = text.trim().rsplit_once('/')?;
        Some(Self { response: Unit::parse(response)?, excitation: Unit::parse(excitation)? })
    }

    /// Text of the quotient, such as `m/s^2/N`.
    pub fn text(&self) -> String {
        format!("{}/{}", self.response.symbol(), self.excitation.symbol())
    }
}

/// A node and a direction.
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
    /// Sample rate \[Hz\]; none for an uneven axis or one that is not time.
    pub fn sample_rate_hz(&self) -> Option<f64> {
        self.abscissa.sample_rate_hz()
    }

    /// Sets the unit without changing the samples, for a file with a missing or wrong unit.
    ///
    /// # Errors
    /// [`MeasureError::NotUnderstood`].
    pub fn set_unit(&mut self, text: &str) -> Result<(), MeasureError> {
        let unit = Unit::require(text)?;
        self.quantity = unit.quantity();
        self.unit = ChannelUnit::Known(unit);
        Ok(())
    }

    /// Converts the samples to the SI unit of their quantity.
    ///
    /// # Errors
    /// [`MeasureError::UnknownUnit`] for a missing or unknown unit.
    pub fn to_si(&mut self) -> Result<(), MeasureError> {
        let unit = self.unit.known().ok_or_else(|| MeasureError::UnknownUnit {
            channel: self.name.clone(),
            text: self.unit.text().to_owned(),
        })?;
        if unit.factor() != 1.0 {
            self.samples.scale(unit.factor());
            self.unit = ChannelUnit::si(unit.quantity());
        }
        self.quantity = unit.quantity();
        Ok(())
    }

    /// Converts the output of a sensor to its measured quantity, in SI.
    ///
    /// # Errors
    /// [`MeasureError::UnknownUnit`] for a missing or unknown unit,
    /// [`MeasureError::QuantityMismatch`] for samples that are not an output of the
    /// sensor, such as a channel in newtons.
    ///
    /// ```
    /// use asperity_measure::read_bytes;
    ///
    /// let mut measured = read_bytes(b"time_s,hammer [V]\n0,0\n0.1,0.5\n0.2,0\n", &Default::default())?;
    /// let hammer = &mut measured.records[0].channels[0];
    /// hammer.calibrate(&"2.5 mV/N".parse()?)?;
    /// assert_eq!(hammer.samples.real(), Some(&[0.0, 200.0, 0.0][..]));
    /// # Ok::<(), asperity_measure::MeasureError>(())
    /// ```
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
        self.unit = ChannelUnit::si(self.quantity);
        Ok(())
    }
}
