//! Errors of periodic responses.

use asperity_law::LawError;
use asperity_structure::StructureError;

use crate::SystemPort;

/// A periodic response or a branch of them cannot be computed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum HarmonicError {
    /// A setting is out of its range.
    #[error("{quantity} is {value}; accepted: {accepted}")]
    Setting {
        /// The setting, with its unit.
        quantity: &'static str,
        /// The value given.
        value: f64,
        /// The range accepted.
        accepted: &'static str,
    },
    /// The range of a continuation has no length.
    #[error(
        "the {quantity} goes from {from} to {to}; give two different values that are positive and finite"
    )]
    EmptyRange {
        /// The parameter, with its unit.
        quantity: &'static str,
        /// Start of the range.
        from: f64,
        /// End of the range.
        to: f64,
    },
    /// The linear structure has not as many interfaces as there are contacts.
    #[error("the linear structure has {interfaces} interfaces; {contacts} contacts were given")]
    ContactCount {
        /// Interfaces of the linear structure.
        interfaces: usize,
        /// Contacts given.
        contacts: usize,
    },
    /// A law has no stiffness at its static pressure.
    #[error(
        "interface \"{interface}\" has the stiffness {stiffness_pa_per_m} Pa/m at its static pressure of {pressure_pa} Pa; a periodic response needs one that is positive and finite"
    )]
    NoStiffness {
        /// Name of the interface.
        interface: String,
        /// Static pressure \[Pa\].
        pressure_pa: f64,
        /// Stiffness found there \[Pa/m\].
        stiffness_pa_per_m: f64,
    },
    /// A law cannot be tabulated.
    #[error("interface \"{interface}\": {source}")]
    Law {
        /// Name of the interface.
        interface: String,
        /// The error of the law.
        source: LawError,
    },
    /// The structure at rest or its component modes cannot be computed.
    #[error(transparent)]
    Structure(#[from] StructureError),
    /// A port is one of another kind of system.
    #[error(
        "{port:?} is no port of this system; accepted: ports of the stack for elastic bars, numbers of ports for component modes and a rigid mass"
    )]
    ForeignPort {
        /// The port.
        port: SystemPort,
    },
    /// A body has inertia that cannot be left out.
    #[error(
        "body {body}, counted from the top from zero, cannot be condensed; accepted: bodies between two contacts of equal damping proportional to the stiffness, or of none, without a load or sensor"
    )]
    NotCondensable {
        /// Place of the body, from the top.
        body: usize,
    },
    /// The linearised structure has no response at the start of the branch.
    #[error(
        "the linearised structure has no finite response at {frequency_hz} Hz; start at another frequency"
    )]
    NoLinearResponse {
        /// Frequency \[Hz\].
        frequency_hz: f64,
    },
    /// No periodic response was found at the start of the branch.
    #[error(
        "no periodic response found at {frequency_hz} Hz and {force_n} N (relative residual {residual:.1e}); start further from resonance, at another force (a lower one, or a higher one where this moves contacts by rounding errors only), or allow more harmonics"
    )]
    NoStart {
        /// Frequency \[Hz\].
        frequency_hz: f64,
        /// Force amplitude \[N\].
        force_n: f64,
        /// Residual left, relative to the motion; infinite if the numbers overflowed.
        residual: f64,
    },
    /// The response at the start of the branch closes an interface beyond the limit of its law.
    #[error(
        "at {frequency_hz} Hz and {force_n} N interface \"{interface}\" would close by {closure_m:.3e} m from rest, where its law gives no finite pressure; lower the force"
    )]
    BeyondLaw {
        /// Name of the interface.
        interface: String,
        /// Closure increment from rest \[m\].
        closure_m: f64,
        /// Frequency \[Hz\].
        frequency_hz: f64,
        /// Force amplitude \[N\].
        force_n: f64,
    },
}

/// `value` if it is positive and finite.
pub(crate) fn positive(quantity: &'static str, value: f64) -> Result<f64, HarmonicError> {
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err(HarmonicError::Setting { quantity, value, accepted: "positive and finite" })
    }
}

/// `value` if it is finite and not negative.
pub(crate) fn not_negative(quantity: &'static str, value: f64) -> Result<f64, HarmonicError> {
    if value.is_finite() && value >= 0.0 {
        Ok(value)
    } else {
        Err(HarmonicError::Setting { quantity, value, accepted: "finite and not negative" })
    }
}
