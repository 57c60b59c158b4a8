//! Errors of laws, fits and tables.

use std::fmt;

/// The quantity that an error is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum LawQuantity {
    /// Contact stiffness per area \[Pa/m\].
    Stiffness,
    /// Contact pressure \[Pa\].
    Pressure,
    /// Coefficient C of a power law \[Pa^(1-m)/m\].
    Coefficient,
    /// Exponent m of a power law \[-\].
    Exponent,
    /// Pressure at which the closure counts zero \[Pa\].
    ReferencePressure,
    /// Pressure above which the modified law is the power law \[Pa\].
    TransitionPressure,
    /// Slope dK/dp where the modified law meets the power law \[1/m\].
    TransitionSlope,
    /// Closure over which the pressure of the exponential law grows by a factor e \[m\].
    Length,
    /// Summits per area \[1/m2\].
    SummitDensity,
    /// Radius of summits \[m\].
    SummitRadius,
    /// Root mean square of heights \[m\].
    HeightRms,
    /// Contact modulus E* \[Pa\].
    ContactModulus,
    /// Hurst exponent of a self-affine surface \[-\].
    HurstExponent,
    /// Smallest wavevector of a rough surface \[1/m\].
    RollOff,
    /// Largest wavevector of a rough surface \[1/m\].
    CutOff,
    /// Gradient of a rough surface \[-\].
    Slope,
    /// Gap at the reference pressure \[m\].
    ReferenceGap,
    /// Closure of a table of pressures \[m\].
    Closure,
    /// Closure at which the hyperbolic law becomes rigid \[m\].
    ClosureLimit,
    /// Number of points of a table, of knots, or of data for a fit.
    Points,
    /// Spread of the logarithms of the pressures of a fit \[-\].
    PressureSpread,
    /// Pressure about which a law is tabulated \[Pa\].
    PressureState,
    /// Highest pressure of a tabulated law \[Pa\].
    PressureTop,
    /// Relative tolerance of a tabulated law \[-\].
    Tolerance,
    /// Cells of a tabulated law.
    Cells,
    /// Retardation time of a damped contact \[s\].
    RetardationTime,
    /// Loss ratio of a damped contact \[-\].
    LossRatio,
    /// Frequency at which a loss ratio is given \[Hz\].
    Frequency,
    /// Damping coefficient of a contact \[Pa s/m\].
    DampingCoefficient,
    /// Stiffness of a stuck friction element \[N/m\].
    SpringStiffness,
    /// Slip force of a friction element \[N\].
    SlipForce,
    /// Coefficient of friction \[-\].
    FrictionCoefficient,
    /// Rows of a pressure-overclosure table.
    Rows,
    /// Contacts in series.
    SeriesContacts,
    /// Compliance of the layers of a series \[m/Pa\].
    Compliance,
    /// Ratio of a contact's pressure increment to that of its series \[-\].
    PressureRatio,
    /// Pressure of a contact where that of its series is zero \[Pa\].
    PressureOffset,
}

impl fmt::Display for LawQuantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Stiffness => "stiffness [Pa/m]",
            Self::Pressure => "pressure [Pa]",
            Self::Coefficient => "coefficient [Pa^(1-m)/m]",
            Self::Exponent => "exponent",
            Self::ReferencePressure => "reference pressure [Pa]",
            Self::TransitionPressure => "transition pressure [Pa]",
            Self::TransitionSlope => "stiffness slope at the transition [1/m]",
            Self::Length => "length [m]",
            Self::SummitDensity => "summit density [1/m2]",
            Self::SummitRadius => "summit radius [m]",
            Self::HeightRms => "rms height [m]",
            Self::ContactModulus => "contact modulus [Pa]",
            Self::HurstExponent => "Hurst exponent",
            Self::RollOff => "roll-off wavevector [1/m]",
            Self::CutOff => "cut-off wavevector [1/m]",
            Self::Slope => "gradient of the surface",
            Self::ReferenceGap => "gap at the reference pressure [m]",
            Self::Closure => "closure [m]",
            Self::ClosureLimit => "closure limit [m]",
            Self::Points => "number of points",
            Self::PressureSpread => "spread of the log pressures",
            Self::PressureState => "pressure of the state [Pa]",
            Self::PressureTop => "top pressure [Pa]",
            Self::Tolerance => "tolerance",
            Self::Cells => "number of cells",
            Self::RetardationTime => "retardation time [s]",
            Self::LossRatio => "loss ratio",
            Self::Frequency => "frequency [Hz]",
            Self::DampingCoefficient => "damping coefficient [Pa s/m]",
            Self::SpringStiffness => "stiffness [N/m]",
            Self::SlipForce => "slip force [N]",
            Self::FrictionCoefficient => "coefficient of friction",
            Self::Rows => "number of rows",
            Self::SeriesContacts => "number of contacts in series",
            Self::Compliance => "compliance [m/Pa]",
            Self::PressureRatio => "pressure ratio",
            Self::PressureOffset => "pressure offset [Pa]",
        })
    }
}

/// Errors of laws, fits and tables.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LawError {
    /// The value is NaN or infinite.
    #[error("{quantity} is {}; it must be finite", number(*value))]
    NotFinite {
        /// The quantity.
        quantity: LawQuantity,
        /// Its value.
        value: f64,
    },
    /// The value does not exceed its limit.
    #[error("{quantity} is {}; it must be greater than {}", number(*value), number(*limit))]
    NotAbove {
        /// The quantity.
        quantity: LawQuantity,
        /// Its value.
        value: f64,
        /// The value it must exceed.
        limit: f64,
    },
    /// The value is below its limit.
    #[error("{quantity} is {}; it must be at least {}", number(*value), number(*limit))]
    Below {
        /// The quantity.
        quantity: LawQuantity,
        /// Its value.
        value: f64,
        /// The least value allowed.
        limit: f64,
    },
    /// The value is above its limit.
    #[error("{quantity} is {}; it must be at most {}", number(*value), number(*limit))]
    Above {
        /// The quantity.
        quantity: LawQuantity,
        /// Its value.
        value: f64,
        /// The greatest value allowed.
        limit: f64,
    },
    /// The value is not below its limit.
    #[error("{quantity} is {}; it must be less than {}", number(*value), number(*limit))]
    NotBelow {
        /// The quantity.
        quantity: LawQuantity,
        /// Its value.
        value: f64,
        /// The value it must not reach.
        limit: f64,
    },
    /// A quantity of several parameters is zero or exceeds the range of numbers.
    #[error("{quantity} evaluates to {}", number(*value))]
    Degenerate {
        /// The quantity.
        quantity: &'static str,
        /// Its value.
        value: f64,
    },
    /// A key that the others call for is not given.
    #[error("missing key \"{0}\"")]
    MissingKey(&'static str),
    /// No law has this name.
    #[error("the scenario has no law \"{name}\"; expected one of: {known}")]
    UnknownLaw {
        /// The name.
        name: String,
        /// Names of the laws there are.
        known: String,
    },
    /// A law in series refers back to itself, along these names.
    #[error("the law is in series with itself: {}", .0.join(" -> "))]
    CyclicLaw(Vec<String>),
    /// Laws in series are nested too deep.
    #[error("laws in series are nested more than {most} deep")]
    SeriesTooDeep {
        /// Most levels.
        most: usize,
    },
    /// Too many laws are in series.
    #[error("more than {most} laws are in series")]
    TooManyInSeries {
        /// Most laws.
        most: usize,
    },
    /// A sequence that must increase strictly does not.
    #[error(
        "{quantity} is {} at index {index}; it must be greater than {}, the one before it",
        number(*value), number(*limit)
    )]
    NotIncreasing {
        /// The quantity.
        quantity: LawQuantity,
        /// Its place in the sequence, from zero.
        index: usize,
        /// Its value.
        value: f64,
        /// The value before it.
        limit: f64,
    },
    /// The greatest number of cells does not reach the tolerance.
    #[error(
        "the estimated error is {value} Pa with {cells} cells; the tolerance asks for {limit} Pa"
    )]
    Unresolved {
        /// Cells of the last attempt: at most
        /// [`CompiledLaw::MAX_CELLS`](crate::CompiledLaw::MAX_CELLS), fewer if even these would not
        /// reach the tolerance at fourth order; 0 if no table of so few cells covers the range.
        cells: usize,
        /// Error estimate found \[Pa\], or a part of it; infinite without a table.
        value: f64,
        /// Largest error allowed \[Pa\].
        limit: f64,
    },
}

/// A number in its shortest form, with an exponent outside 1e-3 to 1e6.
fn number(value: f64) -> String {
    if value == 0.0 || (1e-3..1e6).contains(&value.abs()) || !value.is_finite() {
        format!("{value}")
    } else {
        format!("{value:e}")
    }
}

/// `value` if it is finite.
pub(crate) fn finite(quantity: LawQuantity, value: f64) -> Result<f64, LawError> {
    if value.is_finite() { Ok(value) } else { Err(LawError::NotFinite { quantity, value }) }
}

/// `value` if it is finite and greater than `limit`.
pub(crate) fn above(quantity: LawQuantity, value: f64, limit: f64) -> Result<f64, LawError> {
    if finite(quantity, value)? > limit {
        Ok(value)
    } else {
        Err(LawError::NotAbove { quantity, value, limit })
    }
}

/// `value` if it is finite and at least `limit`.
pub(crate) fn at_least(quantity: LawQuantity, value: f64, limit: f64) -> Result<f64, LawError> {
    if finite(quantity, value)? >= limit {
        Ok(value)
    } else {
        Err(LawError::Below { quantity, value, limit })
    }
}

/// `value` if it is finite and at most `limit`.
pub(crate) fn at_most(quantity: LawQuantity, value: f64, limit: f64) -> Result<f64, LawError> {
    if finite(quantity, value)? <= limit {
        Ok(value)
    } else {
        Err(LawError::Above { quantity, value, limit })
    }
}

/// `value` if it is finite and less than `limit`.
pub(crate) fn below(quantity: LawQuantity, value: f64, limit: f64) -> Result<f64, LawError> {
    if finite(quantity, value)? < limit {
        Ok(value)
    } else {
        Err(LawError::NotBelow { quantity, value, limit })
    }
}

/// `value` if it is finite and not zero.
pub(crate) fn regular(quantity: &'static str, value: f64) -> Result<f64, LawError> {
    if value.is_finite() && value != 0.0 {
        Ok(value)
    } else {
        Err(LawError::Degenerate { quantity, value })
    }
}

/// The value at `index` of a sequence if it is finite and greater than the one before it.
pub(crate) fn rising(
    quantity: LawQuantity,
    index: usize,
    value: f64,
    before: Option<f64>,
) -> Result<f64, LawError> {
    match before {
        Some(limit) if finite(quantity, value)? <= limit => {
            Err(LawError::NotIncreasing { quantity, index, value, limit })
        }
        _ => finite(quantity, value),
    }
}

/// Checks that finite `values` increase strictly.
pub(crate) fn increasing(
    quantity: LawQuantity,
    values: impl Iterator<Item = f64>,
) -> Result<(), LawError> {
    let mut before = None;
    for (index, value) in values.enumerate() {
        before = Some(rising(quantity, index, value, before)?);
    }
    Ok(())
}
