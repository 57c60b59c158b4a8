//! Kinds of faults of a scenario.

use std::fmt;

use asperity_law::LawError;
use thiserror::Error;

use crate::load_samples::SamplesError;
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
    #[error("missing key {}", brief(.0))]
    MissingKey(String),
    /// Value of another type, or another word, than those accepted; in words.
    #[error("found {0}")]
    NotAccepted(String),
    /// Kind that does not exist.
    #[error("unknown kind {}", brief(.0))]
    UnknownKind(String),
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
    #[error("the array has {}", count(*.0, "item", "items"))]
    WrongLength(usize),
    /// Keys of which exactly one is required, and none is given.
    #[error("neither {} is given", joined(.0, "nor"))]
    NoneGiven(Vec<String>),
    /// Keys of which exactly one is required, and several are given.
    #[error("{} are given together", joined(.0, "and"))]
    SeveralGiven(Vec<String>),
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
        /// Fault of the name, in words.
        fault: String,
    },
    /// More laws than are accepted.
    #[error("there are {0} laws")]
    TooManyLaws(usize),
    /// Reference to a body that does not exist.
    #[error("there is no body named {}", brief(.0))]
    UnknownBody(String),
    /// Place that is not on its body.
    #[error("position_m is {}, beyond the length of the body, {} m", number(*position_m), number(*length_m))]
    BeyondBody {
        /// Distance from the upper end in m.
        position_m: f64,
        /// Length of the body in m.
        length_m: f64,
    },
    /// Base that is displaced by a function whose velocity jumps.
    #[error("the velocity of a base displaced by a half-sine jumps at its end")]
    BaseJump,
    /// Reference to a law that is not in "laws".
    #[error("there is no law named {}", brief(.0))]
    UnknownLaw(String),
    /// Law that cannot be built.
    #[error(transparent)]
    Law(LawError),
    /// Damping ratios that no damping of their kind has.
    #[error("the ratios would need {quantity} = {}", four_digits(*value))]
    NegativeDamping {
        /// Coefficient that would be negative or infinite.
        quantity: &'static str,
        /// Its value.
        value: f64,
    },
    /// Two damping ratios of one frequency.
    #[error("both ratios are given at {} Hz", four_digits(*.0))]
    EqualFrequencies(f64),
    /// Quantity derived from the scenario that is zero or exceeds the range of numbers.
    #[error("{quantity} evaluates to {}", number(*value))]
    Degenerate {
        /// Quantity.
        quantity: &'static str,
        /// Its value.
        value: f64,
    },
    /// Too few output samples for a spectrum.
    #[error("duration_s times output_rate_hz gives {} samples", four_digits(*.0))]
    TooFewSamples(f64),
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
    #[error("length_m / cell_m gives {} cells in the body", four_digits(*.0))]
    TooManyCells(f64),
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
    #[error("the document cannot be read although it fits the schema: {0}")]
    SchemaGap(String),
    /// Time of a point that is not after the time before.
    #[error("the time {} s does not come after {} s", number(*time_s), number(*previous_s))]
    TimeNotIncreasing {
        /// Time \[s\].
        time_s: f64,
        /// Time of the point before \[s\].
        previous_s: f64,
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
