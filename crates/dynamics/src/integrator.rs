//! Either integrator behind one face.

use asperity_mesh::{Grid, Stack};

use crate::{
    DynamicsError, Equilibrium, Excitation, FiniteDifference, InstructionSet, Modal, Sampling,
    Transient,
};

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

/// What a run will take.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outline {
    /// Nodes of the grid, or modes.
    pub unknowns: usize,
    /// Step \[s\]; one that was chosen may still be halved for the sake of the energy balance.
    pub step: f64,
    /// Number of steps.
    pub steps: usize,
}

impl Integrator {
    /// What [`integrate`](Self::integrate) will take.
    ///
    /// # Errors
    /// [`DynamicsError::Mesh`] and [`DynamicsError::Setting`] as [`integrate`](Self::integrate).
    pub fn outline(
        &self,
        stack: &Stack,
        equilibrium: &Equilibrium,
        rate: f64,
        excitation: &Excitation,
        sampling: &Sampling,
    ) -> Result<Outline, DynamicsError> {
        match self {
            Self::FiniteDifference(method) => {
                let grid = Grid::new(stack, method.cell)?;
                let (step, stride) = grid.step_within(sampling.interval(), method.courant)?;
                Ok(Outline { unknowns: grid.nodes(), step, steps: stride * sampling.samples() })
            }
            Self::Modal(method) => {
                let hit = method.hit(stack, equilibrium, rate, excitation, sampling)?;
                let (step, steps) = hit.first_step()?;
                Ok(Outline { unknowns: hit.rig.structure().oscillators().len(), step, steps })
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
            Self::FiniteDifference(method) => method.instructions,
            Self::Modal(method) => method.instructions,
        }
    }

    /// The response of `stack`, from rest at `equilibrium`, to `excitation`; `rate` is the
    /// mass-proportional damping h \[1/s\]. `progress` hears the fraction done now and then.
    ///
    /// # Errors
    /// As [`FiniteDifference::integrate`] and [`Modal::integrate`].
    pub fn integrate(
        &self,
        stack: &Stack,
        equilibrium: &Equilibrium,
        rate: f64,
        excitation: &Excitation,
        sampling: &Sampling,
        progress: &(dyn Fn(f64) + Sync),
    ) -> Result<Transient, DynamicsError> {
        match self {
            Self::FiniteDifference(method) => {
                method.integrate(stack, equilibrium, rate, excitation, sampling, progress)
            }
            Self::Modal(method) => {
                method.integrate(stack, equilibrium, rate, excitation, sampling, progress)
            }
        }
    }
}
