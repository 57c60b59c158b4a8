//! The choice of time integrator.

use std::sync::atomic::AtomicBool;

use asperity_mesh::Port;
use asperity_structure::{LoadCase, PreloadedStructure};

use crate::run_bounds::{RunOutline, check_history};
use crate::{Batch, DynamicsError, FiniteDifference, InstructionSet, Modal, Sampling, Transient};

/// A time integrator with its settings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Integrator {
    /// The paper's explicit scheme.
    FiniteDifference(FiniteDifference),
    /// Exact modal steps.
    Modal(Modal),
}

impl Default for Integrator {
    /// Modal steps, step and modes chosen.
    fn default() -> Self {
        Self::Modal(Modal::default())
    }
}

impl From<FiniteDifference> for Integrator {
    fn from(method: FiniteDifference) -> Self {
        Self::FiniteDifference(method)
    }
}

impl From<Modal> for Integrator {
    fn from(method: Modal) -> Self {
        Self::Modal(method)
    }
}

impl Integrator {
    /// Unknowns, step and steps that [`integrate`](Self::integrate) takes.
    ///
    /// # Errors
    /// [`DynamicsError::Mesh`], [`DynamicsError::Setting`] and [`DynamicsError::TooLarge`] as
    /// [`integrate`](Self::integrate).
    pub fn outline(
        &self,
        structure: &PreloadedStructure,
        load: &LoadCase,
        sampling: &Sampling,
    ) -> Result<RunOutline, DynamicsError> {
        match self {
            Self::FiniteDifference(method) => method.outline(structure, sampling),
            Self::Modal(method) => {
                let case = method.case(structure, load, &[], sampling)?;
                let (step, steps) = case.first_step()?;
                check_history(sampling.samples(), structure.contacts().len(), step)?;
                Ok(RunOutline { unknowns: case.model.structure().modes().len(), step, steps })
            }
        }
    }

    /// Its name in scenarios and summaries.
    pub fn name(&self) -> &'static str {
        match self {
            Self::FiniteDifference(_) => "finite_difference",
            Self::Modal(_) => "modal",
        }
    }

    /// Vector instructions it runs on.
    pub fn instructions(&self) -> InstructionSet {
        match self {
            Self::FiniteDifference(_) => InstructionSet::detected(),
            Self::Modal(method) => method.instructions,
        }
    }

    /// The response of `structure`, from rest, to `load`, read at `sensors`.
    ///
    /// # Errors
    /// As [`FiniteDifference::integrate`] and [`Modal::integrate`], and [`DynamicsError::TooLarge`]
    /// for a run beyond the [bounds](crate::run_bounds).
    pub fn integrate(
        &self,
        structure: &PreloadedStructure,
        load: &LoadCase,
        sensors: &[Port],
        sampling: &Sampling,
    ) -> Result<Transient, DynamicsError> {
        let never = AtomicBool::new(false);
        self.integrate_unless(structure, load, sensors, sampling, &never, &|_| ())
    }

    /// [`integrate`](Self::integrate), with the fraction done reported to `progress`; once `stop` is set, the run
    /// ends within some steps, by finite differences within 64 samples.
    ///
    /// # Errors
    /// As [`integrate`](Self::integrate), and [`DynamicsError::Stopped`].
    pub fn integrate_unless(
        &self,
        structure: &PreloadedStructure,
        load: &LoadCase,
        sensors: &[Port],
        sampling: &Sampling,
        stop: &AtomicBool,
        progress: &(dyn Fn(f64) + Sync),
    ) -> Result<Transient, DynamicsError> {
        match self {
            Self::FiniteDifference(method) => {
                method.integrate_unless(structure, load, sensors, sampling, stop, progress)
            }
            Self::Modal(method) => {
                let (samples, interval) = (sampling.samples(), sampling.interval());
                check_history(samples, structure.contacts().len(), interval)?;
                let case = method.case(structure, load, sensors, sampling)?;
                let batch = Batch { instructions: method.instructions };
                let transient = batch.transient_unless(&case, sampling, stop)?;
                progress(1.0);
                Ok(transient)
            }
        }
    }
}
