//! The paper's explicit scheme with implicit contact, Eqs. (2) to (5).
//!
//! Interior nodes follow Eq. (4),
//!
//! ```text
//! w+ = (2 (1 - a1) + a2)/(1 + a2) w + a1/(1 + a2) (w_left + w_right) - 1/(1 + a2) w-
//! a1 = (c dt / dx)^2,  a2 = h dt
//! ```
//!
//! to which a body with the retardation time b adds `(b / dt) a1/(1 + a2)` times the second difference
//! along the bar of `w - w-`, with `w` the displacement from static equilibrium, so that gravity drops
//! out. End nodes carry half a cell's mass; a free end is then Eq. (4) with
//! the outer neighbour the mirror image of the inner one, plus the force on
//! the end. At a contact the force is implicit (Eq. 5): the new closure is
//! `d* - b p` with `d*` what it would be without the pressure, which is one
//! monotone scalar equation per interface. See [`ContactForm`] for its two forms.
//!
//! | module | holds |
//! |---|---|
//! | `bar` | one body's nodes in vector lanes, and the sweep of Eq. (4) over them |
//! | `lanes` | storage aligned to cache lines |
//! | `contact` | the implicit contact step |
//! | `damped_contact` | the same with viscous damping |
//! | `guide` | friction of a body in its guide |
//! | `support` | the step of a spring-mass support |
//! | `ledger` | the energy balance of the discrete motion |
//! | `time_loop` | the loop over time |
#![allow(
    clippy::inline_always,
    reason = "what the march calls must be compiled with it, for the vector instructions chosen"
)]

mod bar;
mod contact;
mod damped_contact;
mod guide;
mod lanes;
mod ledger;
mod support;
mod time_loop;

use asperity_mesh::Grid;
use asperity_structure::PreloadedStructure;

use crate::error::{balanced, check_damping};
use crate::run_bounds::{check_finite_differences, check_history};
use crate::{DynamicsError, InstructionSet, RunOutline, Sampling, Transient};
use asperity_mesh::Port;
use asperity_structure::LoadCase;
use time_loop::TimeLoop;

/// Closure at which the implicit contact pressure is taken (Eq. 5).
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum ContactForm {
    /// The mean of the new and the previous-but-one closure: no first-order
    /// numerical loss, and none at all for a linear law.
    #[default]
    Centred,
    /// The new closure, the plain reading of the paper; it damps the
    /// fundamental by about `w0^2 dt`.
    NewLevel,
}

/// Settings of the finite-difference integrator.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FiniteDifference {
    /// Cell length dx asked for \[m\].
    pub cell: f64,
    /// Largest Courant number `c dt / dx`, between 0 and 1 (Eq. 3).
    pub courant: f64,
    /// Form of the contact step.
    pub contact: ContactForm,
    /// Vector instructions to run on.
    pub instructions: InstructionSet,
}

impl Default for FiniteDifference {
    /// 1 mm cells, Courant number 0.95, centred contact, the machine's widest vectors.
    fn default() -> Self {
        Self {
            cell: 1e-3,
            courant: 0.95,
            contact: ContactForm::Centred,
            instructions: InstructionSet::detected(),
        }
    }
}

impl FiniteDifference {
    /// The response of `structure`, from rest, to `excitation`.
    ///
    /// The step is the longest that keeps the Courant number and divides the output interval. Internal
    /// damping of the bodies makes it shorter: with a retardation time b long against dx/c it is that
    /// number times `(dx / c)^2 / (2 b)`, and the modal integrator is faster by as much.
    ///
    /// ```
    /// use asperity_dynamics::{FiniteDifference, Sampling};
    /// use asperity_mesh::Port;
    /// use asperity_structure::{LoadCase, TimeFunction};
    /// # use std::sync::Arc;
    /// # use asperity_law::Constant;
    /// # use asperity_mesh::{Body, Interface, Stack, Support};
    /// # use asperity_structure::{Damping, PreloadedStructure};
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// # let guide = Body::with_mass("guide", 0.229, 1.61, 71e9, 2710.0)?;
    /// # let contact = Interface::new("guide-disc", 1.15e-4, Arc::new(Constant::new(4.25e11)?))?;
    /// # let stack = Stack::new(vec![guide], vec![contact], Support::Rigid, 9.81)?;
    /// # let structure = PreloadedStructure::new(stack, Damping::Ratio(0.035))?;
    /// let grid = FiniteDifference { cell: 5e-3, ..FiniteDifference::default() };
    /// let pulse = LoadCase::force(TimeFunction::GammaPulse { rise: 0.34e-3 }, 9.0);
    /// let response = grid.integrate(&structure, &pulse, &Sampling::new(0.01, 2e5)?)?;
    /// assert!(response.energy.residual_relative() < 1e-2);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// [`DynamicsError::Mesh`] for a grid or Courant number out of range,
    /// [`DynamicsError::LossFactor`] for a body with a loss factor, [`DynamicsError::ModalDamping`] for
    /// ratios of modes,
    /// [`DynamicsError::TooLarge`] for a run beyond the [bounds](crate::run_bounds),
    /// [`DynamicsError::Setting`] for an excitation out of range or an instruction set that the
    /// machine lacks, [`DynamicsError::Law`] when a law cannot be tabulated,
    /// [`DynamicsError::Unstable`] when the numbers overflow, [`DynamicsError::Coarse`] when the
    /// energy balance does not close to 2e-2.
    pub fn integrate(
        &self,
        structure: &PreloadedStructure,
        load: &LoadCase,
        sensors: &[Port],
        sampling: &Sampling,
    ) -> Result<Transient, DynamicsError> {
        self.integrate_with_progress(structure, load, sensors, sampling, &|_| ())
    }

    /// [`integrate`](Self::integrate), with the fraction done reported to `progress`.
    ///
    /// # Errors
    /// Those of [`integrate`](Self::integrate).
    pub fn integrate_with_progress(
        &self,
        structure: &PreloadedStructure,
        load: &LoadCase,
        sensors: &[Port],
        sampling: &Sampling,
        progress: &(dyn Fn(f64) + Sync),
    ) -> Result<Transient, DynamicsError> {
        load.check()?;
        let _ = sensors;
        let (grid, step, stride) = self.grid(structure, sampling)?;
        let arch = self
            .instructions
            .arch()
            .ok_or(DynamicsError::InstructionSet { set: self.instructions })?;
        tracing::debug!(nodes = grid.nodes(), step, stride, set = ?self.instructions, "march");
        let response: Result<Transient, DynamicsError> = arch.dispatch(TimeLoop {
            structure,
            grid: &grid,
            form: self.contact,
            load,
            samples: sampling.samples(),
            stride,
            step,
            progress,
        });
        let response = response?;
        balanced(response.energy.residual_relative(), response.step, "cell")?;
        Ok(response)
    }

    /// Nodes, step and steps that [`integrate`](Self::integrate) takes.
    ///
    /// # Errors
    /// [`DynamicsError::Mesh`] and [`DynamicsError::TooLarge`] as [`integrate`](Self::integrate).
    pub fn outline(
        &self,
        structure: &PreloadedStructure,
        sampling: &Sampling,
    ) -> Result<RunOutline, DynamicsError> {
        let (grid, step, stride) = self.grid(structure, sampling)?;
        Ok(RunOutline { unknowns: grid.nodes(), step, steps: stride * sampling.samples() })
    }

    /// The grid, the step \[s\] and the number of steps a sample of a run within the bounds.
    fn grid(
        &self,
        structure: &PreloadedStructure,
        sampling: &Sampling,
    ) -> Result<(Grid, f64, usize), DynamicsError> {
        check_damping(structure)?;
        let grid = Grid::new(structure.stack(), self.cell)?;
        let (step, stride) = grid.step_within(sampling.interval(), self.courant)?;
        check_finite_differences(grid.nodes(), (step, stride), sampling.samples())?;
        check_history(sampling.samples(), structure.contacts().len(), step)?;
        Ok((grid, step, stride))
    }
}
