//! Errors of preloaded structures.

use asperity_mesh::MeshError;

/// A structure that has no rest, no damping or no modes.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StructureError {
    /// A number is out of its range.
    #[error("{quantity} is {value}; accepted: {accepted}")]
    Setting {
        /// The quantity, with its unit.
        quantity: &'static str,
        /// The value given.
        value: f64,
        /// The range accepted.
        accepted: &'static str,
    },
    /// Samples are no function of time.
    #[error("samples, row {row}: {quantity} is {value}; it must be {accepted}")]
    Samples {
        /// Row, counted from 0.
        row: usize,
        /// The quantity, with its unit.
        quantity: &'static str,
        /// The value given.
        value: f64,
        /// The values accepted.
        accepted: &'static str,
    },
    /// A place on a body that the stack does not have.
    #[error("no body is named \"{body}\"; accepted: {known}")]
    UnknownBody {
        /// The name.
        body: String,
        /// Names of the bodies.
        known: String,
    },
    /// A base cannot be displaced by a function whose velocity jumps.
    #[error(
        "the velocity of a base displaced by a half-sine jumps at its end; accepted for a displacement: gamma_pulse, haversine, harmonic, samples"
    )]
    BaseJump,
    /// The law of an interface cannot carry the static pressure there.
    #[error(
        "no static equilibrium: the law of interface \"{interface}\" cannot carry the static pressure of {pressure_pa} Pa"
    )]
    NoEquilibrium {
        /// Name of the interface.
        interface: String,
        /// Static pressure it would have to carry \[Pa\].
        pressure_pa: f64,
    },
    /// A damping ratio or a mode needs a natural frequency, and there is none.
    #[error(
        "a damping ratio needs a natural frequency, but the rig linearised at rest has none (interface \"{interface}\" has no stiffness at {pressure_pa} Pa); give the damping as a rate instead"
    )]
    NoFrequency {
        /// The interface without stiffness.
        interface: String,
        /// Its static pressure \[Pa\].
        pressure_pa: f64,
    },
    /// Component modes have not as many contact pairs as there are contacts.
    #[error("the component modes have {pairs} contact pairs; {contacts} contacts were given")]
    ContactCount {
        /// Contact pairs of the component modes.
        pairs: usize,
        /// Contacts given.
        contacts: usize,
    },
    /// A structure has not a guide for each of those in its modes.
    #[error("the component modes have {expected} guides; {given} were given")]
    GuideCount {
        /// Guides of the component modes.
        expected: usize,
        /// Guides given.
        given: usize,
    },
    /// A coefficient of friction is one of a contact that the structure does not have.
    #[error("guide \"{guide}\" names contact {contact}, counted from zero, of {contacts}")]
    GuideContact {
        /// Name of the guide.
        guide: String,
        /// The contact.
        contact: usize,
        /// Number of contacts.
        contacts: usize,
    },
    /// Loads act along a motion that neither stiffness nor contacts hold.
    #[error(
        "no static equilibrium: {:.2e} of the loads act along a motion that neither stiffness nor a contact holds; accepted: loads that balance each other along such motions, or a structure that is held there",
        share
    )]
    NotHeld {
        /// Part of the loads along the motion.
        share: f64,
    },
    /// The shape of a mode is beyond the precision of numbers: a body resonates next to contacts that
    /// hardly hold it.
    #[error(
        "the shape of the mode at {frequency_hz} Hz cannot be computed: its bodies resonate between contacts that hardly hold them"
    )]
    Shape {
        /// Natural frequency \[Hz\].
        frequency_hz: f64,
    },
    /// An eigenvalue computation did not converge.
    #[error("the eigenvalues of {size} coupled equations did not converge")]
    Eigenvalues {
        /// Number of equations.
        size: usize,
    },
    /// The mesh or its component modes cannot be built.
    #[error(transparent)]
    Mesh(#[from] MeshError),
}
