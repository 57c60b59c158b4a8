//! Kinds of faults of a scenario.

use std::fmt;

use serde_json::Value;
use thiserror::Error;

use crate::force_samples::SamplesError;
use crate::wording::{brief, count, four_digits, joined, number};

/// Fault of a value in a scenario.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum Fault {
    /// Key without a meaning in its object.
    #[error("unknown key")]
    UnknownKey,
    /// Key written more than once in one object.
    #[error("the key is written more than once in this object")]
    RepeatedKey,
    /// Required key that is not given.
    #[error("missing key {}", brief(key))]
    MissingKey {
        /// Key.
        key: String,
    },
    /// Value of another type, or another word, than those accepted.
    #[error("found {found}")]
    NotAccepted {
        /// Value found.
        found: FoundValue,
    },
    /// Kind that does not exist.
    #[error("unknown kind {}", brief(kind))]
    UnknownKind {
        /// Kind.
        kind: String,
    },
    /// Number outside its bound.
    #[error("{} is out of range: it must be {bound}", number(*value))]
    OutOfBounds {
        /// Number.
        value: f64,
        /// Bound that it violates.
        bound: Bound,
    },
    /// String without a character.
    #[error("the string is empty")]
    EmptyText,
    /// Array with too few or too many items.
    #[error("the array has {}", count(*items, "item", "items"))]
    WrongLength {
        /// Number of items.
        items: usize,
    },
    /// Keys of which exactly one is required, and none is given.
    #[error("neither {} is given", joined(keys, "nor"))]
    NoneGiven {
        /// Keys.
        keys: Vec<String>,
    },
    /// Keys of which exactly one is required, and several are given.
    #[error("{} are given together", joined(keys, "and"))]
    SeveralGiven {
        /// Keys given.
        keys: Vec<String>,
    },
    /// Number of interfaces that differs from the number of bodies.
    #[error(
        "{} for {}",
        count(*interfaces, "interface", "interfaces"),
        count(*bodies, "body", "bodies")
    )]
    InterfaceCount {
        /// Number of interfaces.
        interfaces: usize,
        /// Number of bodies.
        bodies: usize,
    },
    /// Name used twice among bodies, interfaces or laws.
    #[error("the name {} is already used by {first}", brief(name))]
    RepeatedName {
        /// Name.
        name: String,
        /// Pointer to its first use.
        first: String,
    },
    /// Name that cannot head a column or name a file.
    #[error("the name {} {fault}", brief(name))]
    UnusableName {
        /// Name.
        name: String,
        /// Fault of the name.
        fault: NameFault,
    },
    /// Reference to a law that is not in "laws".
    #[error("there is no law named {}", brief(name))]
    UnknownLaw {
        /// Name.
        name: String,
    },
    /// Law in series that refers back to itself.
    #[error("the law is in series with itself: {}", chain.join(" -> "))]
    CyclicLaw {
        /// Names from the law back to itself.
        chain: Vec<String>,
    },
    /// Laws in series nested too deep.
    #[error("laws in series are nested more than {max} deep")]
    LawTooDeep {
        /// Deepest accepted nesting.
        max: usize,
    },
    /// Column of numbers that does not increase.
    #[error("{} does not increase: {} follows {}", quantity, number(*value), number(*previous))]
    NotIncreasing {
        /// Quantity of the numbers.
        quantity: &'static str,
        /// Number before.
        previous: f64,
        /// Number that is not above it.
        value: f64,
    },
    /// First knot of a modified power law at a pressure other than zero.
    #[error("the first knot is at {} Pa", number(*pressure_pa))]
    FirstKnot {
        /// Pressure of the knot in Pa.
        pressure_pa: f64,
    },
    /// Knot of a modified power law beyond its transition.
    #[error("the knot at {} Pa is not below transition_pa, {} Pa", number(*pressure_pa), number(*transition_pa))]
    KnotBeyondTransition {
        /// Pressure of the knot in Pa.
        pressure_pa: f64,
        /// Transition pressure in Pa.
        transition_pa: f64,
    },
    /// Knot of a modified power law at least as stiff as the power law at the transition.
    #[error(
        "the last knot's stiffness {} Pa/m is not below the power law's at the transition, {} Pa/m",
        four_digits(*stiffness_pa_per_m), four_digits(*transition_stiffness_pa_per_m)
    )]
    KnotTooStiff {
        /// Stiffness of the knot in Pa/m.
        stiffness_pa_per_m: f64,
        /// Stiffness `C p^m` at the transition in Pa/m.
        transition_stiffness_pa_per_m: f64,
    },
    /// Quantity derived from the scenario that is zero or exceeds the range of numbers.
    #[error("{quantity} evaluates to {}", number(*value))]
    Degenerate {
        /// Quantity.
        quantity: &'static str,
        /// Its value.
        value: f64,
    },
    /// Too few output samples for a spectrum.
    #[error("duration_s times output_rate_hz gives {} samples", four_digits(*samples))]
    TooFewSamples {
        /// Number of samples.
        samples: f64,
    },
    /// More output samples than can be held in memory.
    #[error(
        "duration_s times output_rate_hz gives {} samples, about {} GB",
        four_digits(*samples), four_digits(*gigabytes)
    )]
    TooManySamples {
        /// Number of samples.
        samples: f64,
        /// Memory of the time history in GB.
        gigabytes: f64,
    },
    /// More finite-difference cells than can be held in memory.
    #[error("length_m / cell_m gives {} cells in the body", four_digits(*cells))]
    TooManyCells {
        /// Number of cells.
        cells: f64,
    },
    /// More time steps than can be computed.
    #[error("the run would take {} time steps of {} s", four_digits(*steps), four_digits(*step_s))]
    TooManySteps {
        /// Number of steps.
        steps: f64,
        /// Step in s.
        step_s: f64,
    },
    /// Document that fits the schema but not the types it is generated from: a defect of this
    /// program.
    #[error("the document cannot be read although it fits the schema: {reason}")]
    SchemaGap {
        /// Message of the deserialiser.
        reason: String,
    },
    /// File of force samples that cannot be used.
    #[error("{}: {source}", brief(file))]
    Samples {
        /// File, as named in the scenario.
        file: String,
        /// Cause.
        source: SamplesError,
    },
}

/// Bound that a number violates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Bound {
    /// Greater than this.
    Above(f64),
    /// At least this.
    AtLeast(f64),
    /// Less than this.
    Below(f64),
    /// At most this.
    AtMost(f64),
}

impl Bound {
    /// True where `value` satisfies the bound.
    pub fn holds(self, value: f64) -> bool {
        match self {
            Self::Above(limit) => value > limit,
            Self::AtLeast(limit) => value >= limit,
            Self::Below(limit) => value < limit,
            Self::AtMost(limit) => value <= limit,
        }
    }
}

impl fmt::Display for Bound {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Above(limit) => write!(f, "greater than {}", number(*limit)),
            Self::AtLeast(limit) => write!(f, "at least {}", number(*limit)),
            Self::Below(limit) => write!(f, "less than {}", number(*limit)),
            Self::AtMost(limit) => write!(f, "at most {}", number(*limit)),
        }
    }
}

/// Value found instead of an accepted one.
#[derive(Debug, Clone, PartialEq)]
pub enum FoundValue {
    /// `null`.
    Null,
    /// `true` or `false`.
    Bool(bool),
    /// Number.
    Number(f64),
    /// String.
    Text(String),
    /// Array.
    Array,
    /// Object.
    Object,
}

impl From<&Value> for FoundValue {
    fn from(value: &Value) -> Self {
        match value {
            Value::Null => Self::Null,
            Value::Bool(truth) => Self::Bool(*truth),
            Value::Number(number) => Self::Number(number.as_f64().unwrap_or(f64::NAN)),
            Value::String(text) => Self::Text(text.clone()),
            Value::Array(_) => Self::Array,
            Value::Object(_) => Self::Object,
        }
    }
}

impl fmt::Display for FoundValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Null => f.write_str("null"),
            Self::Bool(truth) => write!(f, "{truth}"),
            Self::Number(value) => write!(f, "the number {}", number(*value)),
            Self::Text(text) => write!(f, "the string {}", brief(text)),
            Self::Array => f.write_str("an array"),
            Self::Object => f.write_str("an object"),
        }
    }
}

/// Fault of a name that cannot head a column or name a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NameFault {
    /// Character that is not accepted.
    Character(char),
    /// Space or dot at the start or the end.
    Edge,
    /// More than this many bytes.
    Long(usize),
}

impl fmt::Display for NameFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Character(character) => write!(f, "contains the character {character:?}"),
            Self::Edge => f.write_str("starts or ends with a space or a dot"),
            Self::Long(max) => write!(f, "is longer than {max} bytes"),
        }
    }
}
