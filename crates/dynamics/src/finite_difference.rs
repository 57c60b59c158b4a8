//! The paper's explicit scheme with implicit contact, Eqs. (2) to (5).
//!
//! Interior nodes follow Eq. (4),
//!
//! ```text
//! w+ = (2 (1 - a1) + a2)/(1 + a2) w + a1/(1 + a2) (w_left + w_right) - 1/(1 + a2) w-
//! a1 = (c dt / dx)^2,  a2 = h dt
//! ```
//!
//! with `w` the displacement from static equilibrium, so that gravity drops
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
//! | `support` | the step of a spring-mass support |
//! | `ledger` | the energy balance of the discrete motion |
//! | `march` | the loop over time |
#![allow(
    clippy::inline_always,
    reason = "what the march calls must be compiled with it, for the vector instructions chosen"
)]

mod bar;
mod contact;
mod lanes;
mod ledger;
mod march;
mod support;

use asperity_mesh::{Grid, Stack};

use crate::{DynamicsError, Equilibrium, Excitation, InstructionSet, Sampling, Transient};
use march::March;

/// Which closure the implicit contact pressure answers to (Eq. 5).
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
    /// The response of `stack`, from rest at `equilibrium`, to `excitation`.
    ///
    /// `rate` is the mass-proportional damping h \[1/s\]. The step is the longest
    /// that keeps the Courant number and divides the output interval. `progress`
    /// hears the fraction done now and then.
    ///
    /// # Errors
    /// [`DynamicsError::Mesh`] for a grid or Courant number out of range,
    /// [`DynamicsError::Setting`] for damping or excitation out of range or an
    /// instruction set that the machine lacks, [`DynamicsError::Law`] when a law
    /// cannot be tabulated, [`DynamicsError::Unstable`] when the numbers overflow.
    pub fn integrate(
        &self,
        stack: &Stack,
        equilibrium: &Equilibrium,
        rate: f64,
        excitation: &Excitation,
        sampling: &Sampling,
        progress: &(dyn Fn(f64) + Sync),
    ) -> Result<Transient, DynamicsError> {
        excitation.check()?;
        if !(rate.is_finite() && rate >= 0.0) {
            let quantity = "damping rate [1/s]";
            let accepted = "finite and not negative";
            return Err(DynamicsError::Setting { quantity, value: rate, accepted });
        }
        let grid = Grid::new(stack, self.cell)?;
        let (step, stride) = grid.step_within(sampling.interval(), self.courant)?;
        let arch = self.instructions.arch().ok_or(DynamicsError::Setting {
            quantity: "instruction set",
            value: f64::NAN,
            accepted: "one that this machine has",
        })?;
        tracing::debug!(nodes = grid.nodes(), step, stride, set = ?self.instructions, "march");
        arch.dispatch(March {
            stack,
            equilibrium,
            grid: &grid,
            form: self.contact,
            rate,
            excitation,
            samples: sampling.samples(),
            stride,
            step,
            progress,
        })
    }
}
