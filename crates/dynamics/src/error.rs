//! Errors of the time integrators.

use asperity_law::LawError;
use asperity_mesh::MeshError;
use asperity_structure::{PreloadedStructure, StructureError};

use crate::InstructionSet;

/// An error of a time integration: its place, the value found and the values accepted.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DynamicsError {
    /// A setting of the computation is out of its range.
    #[error("{quantity} is {value}; accepted: {accepted}")]
    Setting {
        /// The setting, with its unit.
        quantity: &'static str,
        /// The value given.
        value: f64,
        /// The range accepted.
        accepted: &'static str,
    },
    /// A load acts on another port than the model was made for.
    #[error("the load acts on another port than the model is loaded at")]
    LoadPort,
    /// A port of the finite-difference grid that is neither a point of a body nor the base.
    #[error(
        "finite differences take loads and sensors at points of bodies, and a motion of the base; the modal engine takes other ports"
    )]
    PortOfGrid,
    /// A sensor that a model does not have.
    #[error("sensor {sensor} does not exist; the model has {sensors}, counted from 0")]
    NoSensor {
        /// The sensor.
        sensor: usize,
        /// Number of sensors.
        sensors: usize,
    },
    /// A run would take more time or memory than is accepted.
    #[error(
        "the run would take {count:.3e} {unit}, with steps of {step_s:.3e} s; at most {limit:.0e} are accepted"
    )]
    TooLarge {
        /// The count that is too large.
        count: f64,
        /// The thing counted.
        unit: &'static str,
        /// Largest count accepted.
        limit: f64,
        /// Step \[s\].
        step_s: f64,
    },
    /// The machine does not have the vector instructions asked for.
    #[error("this machine has no {set:?} instructions; it has {:?}", InstructionSet::available())]
    InstructionSet {
        /// The instructions asked for.
        set: InstructionSet,
    },
    /// The numbers grew beyond all bounds.
    #[error(
        "the integration became unstable at {time_s:.6e} s, first seen at interface \"{interface}\"; use a smaller step or cell"
    )]
    Unstable {
        /// Time at which it was noticed \[s\].
        time_s: f64,
        /// The interface with the first value that is not finite.
        interface: String,
    },
    /// The run was stopped.
    #[error("the run was stopped after {steps} steps")]
    Stopped {
        /// Steps taken before.
        steps: usize,
    },
    /// The energy balance does not close: the step is too long for what happens.
    #[error(
        "the energy balance is off by {residual:.1e} of the energy at a step of {step_s:.3e} s; accepted: {limit}; use a smaller {smaller}"
    )]
    Coarse {
        /// Energy residual over the work done.
        residual: f64,
        /// Step \[s\].
        step_s: f64,
        /// Largest residual accepted.
        limit: f64,
        /// The setting that makes it smaller.
        smaller: &'static str,
    },
    /// A varied case has no derivative with respect to what was varied.
    #[error("parameter {parameter}: {quantity} is {value}; accepted: {accepted}")]
    Variation {
        /// Number of the parameter, from 0.
        parameter: usize,
        /// The quantity without derivative, with its unit.
        quantity: &'static str,
        /// Its value.
        value: f64,
        /// The values accepted.
        accepted: &'static str,
    },
    /// The grid cannot be built.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// The structure has no rest, damping or modes.
    #[error(transparent)]
    Structure(#[from] StructureError),
    /// A body has a loss factor, which is defined for harmonic vibration only.
    #[error(
        "body \"{body}\" has a loss factor, which only steady responses and linearised modes have; accepted in time: mass-proportional or Rayleigh damping"
    )]
    LossFactor {
        /// Name of the body.
        body: String,
    },
    /// Linearised modes have damping ratios of their own, which integration in time does not take.
    #[error(
        "{modes} linearised modes have damping ratios of their own, which only steady responses and linearised modes have; accepted in time: mass-proportional or Rayleigh damping (Rayleigh with the ratios at two frequencies has those of two modes)"
    )]
    ModalDamping {
        /// Number of modes with a ratio.
        modes: usize,
    },
    /// Contacts of patches have no damping, but for springs, and no friction in time.
    #[error(
        "\"{element}\" dissipates; accepted with many contacts: contacts without damping and friction, springs with dampers, and damping of the bodies"
    )]
    Dissipative {
        /// Name of the contact or guide.
        element: String,
    },
    /// A contact is open at rest, which the vector kernel does not take.
    #[error(
        "contact \"{contact}\" is open at rest; accepted by this engine: contacts that are closed at rest"
    )]
    OpenAtRest {
        /// Name of the contact.
        contact: String,
    },
    /// A contact law cannot be prepared for the integration.
    #[error("interface \"{interface}\": {source}")]
    Law {
        /// Name of the interface.
        interface: String,
        /// The error of the law.
        source: LawError,
    },
}

/// Energy residual above which a response is refused, by either integrator.
const REFUSED_RESIDUAL: f64 = 2e-2;

/// Refuses a response whose energy balance does not close, at a step \[s\]; one of NaN too.
pub(crate) fn balanced(
    residual: f64,
    step_s: f64,
    smaller: &'static str,
) -> Result<(), DynamicsError> {
    if residual <= REFUSED_RESIDUAL {
        return Ok(());
    }
    Err(DynamicsError::Coarse { residual, step_s, limit: REFUSED_RESIDUAL, smaller })
}

/// Refuses a structure with a body that has a loss factor, or with damping ratios of modes.
pub(crate) fn check_damping(structure: &PreloadedStructure) -> Result<(), DynamicsError> {
    check_modal_damping(structure)?;
    let mut bodies = structure.stack().bodies().iter();
    match bodies.find(|body| body.damping().retardation_time().is_none()) {
        Some(body) => Err(DynamicsError::LossFactor { body: body.name().to_owned() }),
        None => Ok(()),
    }
}

/// Refuses a structure with damping ratios of modes.
pub(crate) fn check_modal_damping<M>(
    structure: &PreloadedStructure<M>,
) -> Result<(), DynamicsError> {
    match structure.damped_modes().len() {
        0 => Ok(()),
        modes => Err(DynamicsError::ModalDamping { modes }),
    }
}

/// `value` if it is positive and finite.
pub(crate) fn positive(quantity: &'static str, value: f64) -> Result<f64, DynamicsError> {
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err(DynamicsError::Setting { quantity, value, accepted: "positive and finite" })
    }
}
