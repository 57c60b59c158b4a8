//! Derivatives of a run's answers with respect to numbers of its scenario.
//!
//! The response is differentiated exactly through every step of the modal integrator
//! ([`Batch::sensitivity`]), and the answers exactly from the response; only what is known in
//! closed form (equilibrium, modes, the numbers of a step) is differenced. The step, and the
//! modes that are kept, are those of the scenario.

mod observables;
mod varied;

use asperity_dynamics::{Batch, DynamicsError, Integrator};
use asperity_signal::SignalError;
use serde::Serialize;
use thiserror::Error;

use crate::assemble::Assembly;
use crate::error::StudyError;
use crate::run::rest_state;
use asperity_scenario::{Document, InvalidDocument, SetError};
use varied::Varied;

pub use observables::Table;
pub use varied::{rig_with, with_laws_of};

/// A number of a scenario, and its value there.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Parameter {
    /// JSON Pointer.
    pub pointer: String,
    /// Value, in the unit that its key names.
    pub value: f64,
}

/// The answers of a run and their derivatives.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Sensitivities {
    /// What the answers are differentiated with respect to.
    pub parameters: Vec<Parameter>,
    /// Names of the answers, as in [`Summary::scalars`](crate::summary::Summary::scalars).
    pub columns: Vec<String>,
    /// The answers; none where there is no such peak.
    ///
    /// They are those of the samples at the steps, found with the exact laws: a summary's, but for
    /// the tables' tolerance and another sampling rate, about 1e-5.
    pub values: Vec<Option<f64>>,
    /// Row per answer, column per parameter: derivative, in the answer's unit over the parameter's.
    pub jacobian: Vec<Vec<Option<f64>>>,
    /// Step \[s\].
    pub step_s: f64,
    /// Number of steps.
    pub steps: usize,
}

/// Why a run has no derivatives.
#[derive(Debug, Error)]
pub enum SensitivityError {
    /// The scenario is not valid.
    #[error(transparent)]
    Invalid(#[from] InvalidDocument),
    /// A parameter cannot be set.
    #[error(transparent)]
    Set(#[from] SetError),
    /// A pointer leads to no number.
    #[error(
        "{pointer} is no number of the scenario; expected a pointer such as /excitation/peak_n"
    )]
    NotANumber {
        /// The pointer.
        pointer: String,
    },
    /// A number that says how to compute or sample, not what moves.
    #[error("{pointer} is a setting of the computation; expected a number of the rig or its force")]
    Setting {
        /// The pointer.
        pointer: String,
    },
    /// A parameter of zero has no scale to be varied by.
    #[error("{pointer} is zero, which leaves no scale to vary it by; expected another value")]
    Zero {
        /// The pointer.
        pointer: String,
    },
    /// A parameter is so near a limit that a neighbour is not valid.
    #[error("{pointer} cannot be varied to {value}: {source}")]
    AtLimit {
        /// The pointer.
        pointer: String,
        /// The neighbour.
        value: f64,
        /// What is wrong with it.
        source: Box<InvalidDocument>,
    },
    /// The scenario asks for another integrator.
    #[error("method \"{method}\" has no derivatives; expected \"modal\"")]
    Method {
        /// The method.
        method: &'static str,
    },
    /// The run fails.
    #[error(transparent)]
    Study(#[from] StudyError),
}

impl From<DynamicsError> for SensitivityError {
    fn from(error: DynamicsError) -> Self {
        Self::Study(error.into())
    }
}

impl From<SignalError> for SensitivityError {
    fn from(error: SignalError) -> Self {
        Self::Study(error.into())
    }
}

/// The answers of the run that `document` describes, and their derivatives with respect to the
/// numbers at `pointers`.
///
/// Answers are the state at rest, the fundamental and its damping ratio by half power, the second
/// harmonic and their ratio, and the extremes and stiffnesses at each interface. Times without
/// contact are counts of steps, energies are not differentiated, nor is the decrement.
///
/// # Errors
/// [`SensitivityError`]: for a scenario that is not valid or not modal, a pointer that leads to no
/// number that can be varied, or a run that fails.
pub fn sensitivities(
    document: &Document,
    pointers: &[&str],
) -> Result<Sensitivities, SensitivityError> {
    let scenario = document.scenario()?;
    let assembly = Assembly::new(&scenario, document.folder())?;
    let Integrator::Modal(method) = assembly.method else {
        return Err(SensitivityError::Method { method: assembly.method.name() });
    };
    let at_rest = rest_state(&assembly);
    let base = varied::base(&assembly, &method, at_rest.natural_frequency_hz)?;
    let mut all = Vec::with_capacity(pointers.len());
    for pointer in pointers {
        all.push(Varied::new(document, pointer, &base)?);
    }
    let (variations, rests): (Vec<_>, Vec<_>) =
        all.into_iter().map(|varied| (varied.variation, (varied.parameter, varied.rests))).unzip();
    let batch = Batch { instructions: method.instructions };
    let found = batch.sensitivity(&base.hit, &variations)?;

    let mut table = observables::Table::default();
    let steps: Vec<f64> = variations.iter().map(|variation| variation.step).collect();
    let four: Vec<_> = rests.iter().map(|(_, rests)| rests).collect();
    table.rest(&at_rest, &four, &steps);
    table.peaks(&found, at_rest.natural_frequency_hz)?;
    let names: Vec<&str> =
        at_rest.interfaces.iter().map(|interface| interface.name.as_str()).collect();
    table.contacts(&found, &names);
    Ok(Sensitivities {
        parameters: rests.into_iter().map(|(parameter, _)| parameter).collect(),
        columns: table.columns,
        values: table.values,
        jacobian: table.jacobian,
        step_s: found.step,
        steps: found.values.displacement.len() - 1,
    })
}
