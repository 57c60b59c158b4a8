//! Derivatives of the observables of a run with respect to parameters of its scenario.
//!
//! The response is differentiated exactly through every step of the modal integrator
//! ([`Batch::sensitivity`]), and the observables exactly from the response; only closed forms
//! (equilibrium, modes, the coefficients of a step) are differenced. Step and modes are those of
//! the scenario.

mod derivative_table;
mod varied;

use std::sync::Arc;

use asperity_dynamics::{Batch, DynamicsError};
use asperity_scenario::{Document, InvalidDocument, SetError};
use asperity_signal::SignalError;
use serde::Serialize;
use thiserror::Error;

use crate::error::SimulationError;
use crate::error_control::{ErrorControl, RunRequest};
use crate::parameter::{ParameterError, ScenarioParameter};
use crate::prepared_scenario::PreparedScenario;
use crate::warning::Warning;
use varied::Varied;

pub use derivative_table::{DerivativeTable, StaticStencil};
pub use varied::with_laws_of;

/// The observables of a run and their derivatives.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Sensitivities {
    /// The parameters.
    pub parameters: Vec<ScenarioParameter>,
    /// Names of the observables, as in the columns of a sweep.
    pub columns: Vec<String>,
    /// The observables; none where there is no such peak.
    ///
    /// They are those of the samples at the steps, with the exact laws: a summary's to about 1e-5,
    /// the difference being the tolerance of tables and the sample rate.
    pub values: Vec<Option<f64>>,
    /// Row per observable, column per parameter: derivative, in the observable's unit over the
    /// parameter's.
    pub jacobian: Vec<Vec<Option<f64>>>,
    /// Warnings about the response.
    pub warnings: Vec<Warning>,
    /// Step \[s\].
    pub step_s: f64,
    /// Number of steps.
    pub steps: usize,
}

/// A run without derivatives.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum SensitivityError {
    /// The scenario is not valid.
    #[error(transparent)]
    Invalid(#[from] InvalidDocument),
    /// A parameter cannot be set.
    #[error(transparent)]
    Set(#[from] SetError),
    /// A pointer leads to no parameter.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// A parameter of zero has no scale to vary it by.
    #[error("`{0}` is zero, which gives no scale to vary it by; expected another value")]
    Zero(String),
    /// A parameter is so near a limit that a neighbour is not valid.
    #[error("`{pointer}` cannot be varied to {value}: {source}")]
    AtLimit {
        /// The pointer.
        pointer: String,
        /// The neighbour.
        value: f64,
        /// The faults of the scenario there.
        source: Box<InvalidDocument>,
    },
    /// The scenario asks for another integrator.
    #[error("method \"{0}\" has no derivatives; expected \"modal\"")]
    Method(&'static str),
    /// The run fails.
    #[error(transparent)]
    Study(#[from] SimulationError),
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

/// The observables of the run that `document` describes, and their derivatives with respect to the
/// parameters at `pointers`.
///
/// Rows are the quantities with [a derivative](crate::quantity::Quantity::has_derivative): the
/// state at rest, both harmonics, the half-power damping ratio, and extremes and stiffnesses of
/// each interface.
///
/// # Errors
/// [`SensitivityError`] for a scenario that is not valid or not modal, a pointer that leads to no
/// parameter, or a run that fails.
///
/// ```
/// # use asperity_scenario::Document;
/// # use asperity_simulation::sensitivity::sensitivities;
/// let document = Document::read("examples/block.json")?;
/// let found = sensitivities(&document, &["/laws/rough/coefficient"])?;
/// // f0 grows with the square root of the stiffness (less for the flexibility of the body).
/// let relative = found.jacobian[0][0].unwrap() * 1.8e10 / found.values[0].unwrap();
/// assert!((0.45..0.5).contains(&relative), "{relative}");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn sensitivities(
    document: &Document,
    pointers: &[&str],
) -> Result<Sensitivities, SensitivityError> {
    let _stage = tracing::info_span!("differentiate").entered();
    let scenario = document.scenario()?;
    let prepared = Arc::new(PreparedScenario::new(&scenario, document.folder())?);
    let Some(method) = prepared.modal() else {
        return Err(SensitivityError::Method(prepared.assembly.method.name()));
    };
    let batch = Batch { instructions: method.instructions };
    let chosen = ErrorControl::new(batch).run_one(&RunRequest {
        prepared: Arc::clone(&prepared),
        load: prepared.assembly.load.clone(),
        sensor: 0,
        duration: None,
        near: None,
    })?;
    let (base, counts) = (chosen.case, chosen.counts);
    let mut all = Vec::with_capacity(pointers.len());
    for pointer in pointers {
        all.push(Varied::new(document, pointer, &base, &counts)?);
    }
    let (variations, others): (Vec<_>, Vec<_>) =
        all.into_iter().map(|one| (one.variation, (one.parameter, one.at_rest))).unzip();
    let found = batch.sensitivity(&base, &variations)?;
    let pairs = variations.iter().zip(&others);
    let stencils: Vec<StaticStencil<'_>> =
        pairs.map(|(variation, (_, at_rest))| (at_rest.each_ref(), variation.step)).collect();
    let table = DerivativeTable::new(&prepared, &found, &stencils)?;
    let interfaces: Vec<&str> =
        prepared.at_rest.interfaces.iter().map(|interface| interface.name.as_str()).collect();
    Ok(Sensitivities {
        parameters: others.into_iter().map(|(parameter, _)| parameter).collect(),
        columns: table.observables.iter().map(|one| one.name(&interfaces)).collect(),
        values: table.values,
        jacobian: table.jacobian,
        warnings: table.warnings,
        step_s: found.step,
        steps: found.values.displacement.len() - 1,
    })
}
