//! The kinds of problems a scenario can have.

use std::fmt;

use serde_json::Value;
use thiserror::Error;

use super::words::{brief, count, joined, number, rounded};
use crate::samples::SamplesError;

/// What is wrong with a value of a scenario.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum Problem {
    /// A key that has no meaning there.
    #[error("unknown key")]
    UnknownKey,
    /// A key written more than once in one object.
    #[error("the key is written more than once in this object")]
    RepeatedKey,
    /// A key that must be there and is not.
    #[error("missing key {}", brief(key))]
    MissingKey {
        /// The key.
        key: String,
    },
    /// A value of another type or another word than those accepted.
    #[error("found {found}")]
    NotAccepted {
        /// What is there.
        found: Found,
    },
    /// A kind that does not exist.
    #[error("there is no kind {}", brief(kind))]
    UnknownKind {
        /// The kind.
        kind: String,
    },
    /// A number outside its bound.
    #[error("{} is out of range: it must be {bound}", number(*value))]
    OutOfBounds {
        /// The number.
        value: f64,
        /// The bound it breaks.
        bound: Bound,
    },
    /// A text without a character.
    #[error("the text is empty")]
    EmptyText,
    /// An array with too few or too many items.
    #[error("the array has {}", count(*items, "item", "items"))]
    WrongLength {
        /// Number of items.
        items: usize,
    },
    /// Keys of which exactly one must be given, and none is.
    #[error("neither {} is given", joined(keys, "nor"))]
    NoneGiven {
        /// The keys.
        keys: Vec<String>,
    },
    /// Keys of which exactly one must be given, and several are.
    #[error("{} are given together", joined(keys, "and"))]
    SeveralGiven {
        /// The keys given.
        keys: Vec<String>,
    },
    /// Not one interface below each body.
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
    /// A name that another one of its family has.
    #[error("the name {} is already that of {first}", brief(name))]
    RepeatedName {
        /// The name.
        name: String,
        /// Pointer to what had it first.
        first: String,
    },
    /// A name that cannot head a column or name a file.
    #[error("the name {} {fault}", brief(name))]
    UnusableName {
        /// The name.
        name: String,
        /// What is wrong with it.
        fault: NameFault,
    },
    /// A law that is not in "laws".
    #[error("there is no law named {}", brief(name))]
    UnknownLaw {
        /// The name.
        name: String,
    },
    /// A law in series that ends up in itself.
    #[error("the law is in series with itself: {}", chain.join(" -> "))]
    CyclicLaw {
        /// The names from the law back to itself.
        chain: Vec<String>,
    },
    /// Laws in series nested too deep.
    #[error("more than {most} laws are in series inside one another")]
    LawTooDeep {
        /// Deepest nesting accepted.
        most: usize,
    },
    /// A column of numbers that must increase and does not.
    #[error("{} does not increase: {} follows {}", quantity, number(*value), number(*previous))]
    NotIncreasing {
        /// What the numbers are.
        quantity: &'static str,
        /// The number before.
        previous: f64,
        /// The number that is not above it.
        value: f64,
    },
    /// The knots of a modified power law do not start at zero pressure.
    #[error("the first knot is at {} Pa", number(*pressure_pa))]
    FirstKnot {
        /// Its pressure in Pa.
        pressure_pa: f64,
    },
    /// A knot of a modified power law beyond its transition.
    #[error("the knot at {} Pa is not below transition_pa, {} Pa", number(*pressure_pa), number(*transition_pa))]
    KnotBeyondTransition {
        /// Pressure of the knot in Pa.
        pressure_pa: f64,
        /// Transition pressure in Pa.
        transition_pa: f64,
    },
    /// A knot of a modified power law at least as stiff as the power law at the transition.
    #[error(
        "the last knot's stiffness {} Pa/m is not below the power law's at the transition, {} Pa/m",
        rounded(*stiffness_pa_per_m), rounded(*transition_stiffness_pa_per_m)
    )]
    KnotTooStiff {
        /// Stiffness of the knot in Pa/m.
        stiffness_pa_per_m: f64,
        /// Stiffness `C p^m` at the transition in Pa/m.
        transition_stiffness_pa_per_m: f64,
    },
    /// A number computed from the scenario is zero or too large to be stored.
    #[error("{quantity} comes out as {}", number(*value))]
    Degenerate {
        /// What is computed.
        quantity: &'static str,
        /// What comes out.
        value: f64,
    },
    /// Too few samples for a spectrum.
    #[error("duration_s times output_rate_hz gives {} samples", rounded(*samples))]
    TooFewSamples {
        /// Number of samples.
        samples: f64,
    },
    /// More samples than can be held.
    #[error(
        "duration_s times output_rate_hz gives {} samples, about {} GB",
        rounded(*samples), rounded(*gigabytes)
    )]
    TooManySamples {
        /// Number of samples.
        samples: f64,
        /// Memory of the history in GB.
        gigabytes: f64,
    },
    /// More finite-difference cells than can be held.
    #[error("length_m / cell_m gives {} cells in the body", rounded(*cells))]
    TooManyCells {
        /// Number of cells.
        cells: f64,
    },
    /// More time steps than can be waited for.
    #[error("the run would take {} time steps of {} s", rounded(*steps), rounded(*step_s))]
    TooManySteps {
        /// Number of steps.
        steps: f64,
        /// Length of a step in s.
        step_s: f64,
    },
    /// The document fits the schema but not the types the schema is made from:
    /// a defect of this program.
    #[error("the document cannot be read although it fits the schema: {reason}")]
    SchemaGap {
        /// What the deserialiser reports.
        reason: String,
    },
    /// A file of force samples that cannot be used.
    #[error("{}: {source}", brief(file))]
    Samples {
        /// The file, as the scenario names it.
        file: String,
        /// What is wrong with it.
        source: SamplesError,
    },
}

/// The bound a number breaks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Bound {
    /// It must be greater than this.
    Above(f64),
    /// It must be at least this.
    AtLeast(f64),
    /// It must be less than this.
    Below(f64),
    /// It must be at most this.
    AtMost(f64),
}

impl Bound {
    /// Whether `value` keeps the bound.
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

/// What is found where something else is accepted.
#[derive(Debug, Clone, PartialEq)]
pub enum Found {
    /// `null`.
    Null,
    /// `true` or `false`.
    Truth(bool),
    /// A number.
    Number(f64),
    /// A text.
    Text(String),
    /// An array.
    Array,
    /// An object.
    Object,
}

impl Found {
    /// What `value` is.
    pub fn of(value: &Value) -> Self {
        match value {
            Value::Null => Self::Null,
            Value::Bool(truth) => Self::Truth(*truth),
            Value::Number(number) => Self::Number(number.as_f64().unwrap_or(f64::NAN)),
            Value::String(text) => Self::Text(text.clone()),
            Value::Array(_) => Self::Array,
            Value::Object(_) => Self::Object,
        }
    }
}

impl fmt::Display for Found {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Null => f.write_str("null"),
            Self::Truth(truth) => write!(f, "{truth}"),
            Self::Number(value) => write!(f, "the number {}", number(*value)),
            Self::Text(text) => write!(f, "the text {}", brief(text)),
            Self::Array => f.write_str("an array"),
            Self::Object => f.write_str("an object"),
        }
    }
}

/// Why a name cannot head a column or name a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NameFault {
    /// It holds this character.
    Character(char),
    /// It starts or ends with a space or a dot.
    Edge,
    /// It is longer than this many bytes.
    Long(usize),
}

impl fmt::Display for NameFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Character(character) => write!(f, "holds the character {character:?}"),
            Self::Edge => f.write_str("starts or ends with a space or a dot"),
            Self::Long(most) => write!(f, "is longer than {most} bytes"),
        }
    }
}
