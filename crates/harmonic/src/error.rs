//! What can be wrong with a request for periodic responses.

use asperity_law::LawError;

/// Why a periodic response or a branch of them cannot be computed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
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
    /// A range to follow has no length.
    #[error(
        "the {quantity} goes from {from} to {to}; give two different values that are positive and finite"
    )]
    EmptyRange {
        /// What was to be varied, with its unit.
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
    /// A law cannot carry its static pressure, or has no stiffness there.
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
        /// What the law says.
        source: LawError,
    },
    /// A part of the structure moves freely and no contact holds it.
    #[error(
        "{free} rigid motions of the structure meet only {held} independent closures; each must be held by a contact"
    )]
    Floating {
        /// Number of rigid motions.
        free: usize,
        /// Number of them that the contacts hold.
        held: usize,
    },
    /// No periodic response was found where the branch should start.
    #[error(
        "no periodic response found at {frequency_hz} Hz and {force_n} N (relative residual {residual:.1e}); start at a lower force or further from resonance, or allow more harmonics"
    )]
    NoStart {
        /// Frequency \[Hz\].
        frequency_hz: f64,
        /// Force amplitude \[N\].
        force_n: f64,
        /// Residual left, relative to the motion; NaN if the numbers overflowed.
        residual: f64,
    },
    /// The response at the start of the branch would press an interface beyond what its law allows.
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
