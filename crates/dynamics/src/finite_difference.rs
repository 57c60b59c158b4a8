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
//! `d* - b p` with `d*` the closure without the pressure, which is one
//! monotone scalar equation per interface. See [`ContactForm`] for its two forms.
//!
//! | module | holds |
//! |---|---|
//! | `bar` | the nodes of one body, and Eq. (4) over them |
//! | `loads` | forces along the bodies, a motion of the base, and sensors |
//! | `contact` | the implicit contact step |
//! | `contact_table` | the law of a contact in tables |
//! | `damped_contact` | the same with viscous damping |
//! | `guide` | friction of a body in its guide |
//! | `support` | the step of a spring-mass support |
//! | `ledger` | the energy balance of the discrete motion |
//! | `time_loop` | the loop over time |
#![allow(
    clippy::inline_always,
    reason = "loops over nodes must be compiled with the loop over time, for its vector instructions"
)]
mod bar;
mod contact;
mod contact_table;
mod damped_contact;
mod guide;
mod ledger;
mod loads;
mod stiffness_sum;
mod support;
mod time_loop;

use std::sync::atomic::AtomicBool;

use asperity_mesh::{Grid, Port};
use asperity_structure::{LoadCase, PreloadedStructure};
use pulp::Arch;

use crate::error::{balanced, check_damping};
use crate::run_bounds::{RunOutline, check_finite_differences, check_history};
use crate::{DynamicsError, Sampling, Transient};
pub use contact::ContactForm;
use loads::{Loads, Place};
use time_loop::TimeLoop;

/// Settings of the finite-difference integrator.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FiniteDifference {
    /// Cell length dx \[m\]: each body has the whole number of cells next to its length over this one.
    pub cell: f64,
    /// Largest Courant number `c dt / dx`, between 0 and 1 (Eq. 3).
    pub courant: f64,
    /// Form of the contact step.
    pub contact: ContactForm,
}

impl Default for FiniteDifference {
    /// 1 mm cells, Courant number 0.95, centred contact.
    fn default() -> Self {
        Self { cell: 1e-3, courant: 0.95, contact: ContactForm::Centred }
    }
}

impl FiniteDifference {
    /// The response of `structure`, from rest, to `load`, read at `sensors`.
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
    /// let response = grid.integrate(&structure, &pulse, &[Port::TOP], &Sampling::new(0.01, 2e5)?)?;
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
    /// [`DynamicsError::Setting`] for a load out of range, [`DynamicsError::PortOfGrid`] for a port that is no
    /// point of a body, [`DynamicsError::Law`] when a law
    /// cannot be tabulated, [`DynamicsError::Unstable`] when the numbers overflow,
    /// [`DynamicsError::Coarse`] when the energy balance does not close to 2e-2.
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
    /// ends within 64 samples.
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
        load.check()?;
        let bodies = structure.stack().bodies();
        let place = |port: &Port| Place::of(port.check(structure.stack())?, bodies);
        let sensors = sensors.iter().map(place).collect::<Result<Vec<_>, DynamicsError>>()?;
        let loads = match load.port() {
            Port::Base => Loads { forces: Vec::new(), base_acceleration: Some(load) },
            port => Loads { forces: vec![(place(&port)?, load)], base_acceleration: None },
        };
        let (grid, step, stride) = self.grid(structure, sampling)?;
        tracing::debug!(nodes = grid.nodes(), step, stride, "march");
        let time_loop = TimeLoop {
            structure,
            grid: &grid,
            form: self.contact,
            loads: &loads,
            sensors: &sensors,
            samples: sampling.samples(),
            stride,
            step,
            stop,
            progress,
        };
        let transient = Arch::new().dispatch(time_loop)?;
        balanced(transient.energy.residual_relative(), transient.step, "cell")?;
        Ok(transient)
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
