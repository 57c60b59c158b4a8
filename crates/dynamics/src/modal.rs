//! Exact modal steps with implicit contact, many cases side by side.
//!
//! Between its contacts a structure is linear: a few modes and the residual flexibility of the
//! others ([`ComponentModes`](asperity_mesh::ComponentModes)). Over a step each mode moves exactly
//! under a force that is a polynomial through the pressures at steps, so that only the pressures
//! at the end of the step are unknown,
//!
//! ```text
//! x_i + sum_j B_ij p_j(x_j) = x*_i,
//! ```
//!
//! with x* the closures without them. Light bodies between stiff contacts see the mean force of
//! the step, which is stable for any contact stiffness; the others the quartic through five
//! pressures, which is of fifth order. The integrator works with modes only, whatever structure they
//! are from.
//!
//! | module | holds |
//! |---|---|
//! | `assembly` | a structure in modes, tabulated and stepped once for many cases |
//! | `law_point` | laws at successive closures |
//! | `law_tables` | tables of laws, shared by all models with the same law |
//! | `damped_table` | the law of a damped contact in one step, as tables |
//! | `oscillator` | the exact step of one mode under a polynomial force |
//! | `row_modes` | modes in the closures of contacts and guides, the load and the sensors |
//! | `step_model` | all numbers of a step that do not depend on the load |
//! | `load_steps` | the load, step by step |
//! | `transient_case` | one case and its response |
//! | `periodic_start` | a case that goes on from a motion with the period of its load |
//! | `prepared_case` | one case, prepared for one step length |
//! | `step_size` | the choice of the step |
//! | `fast_modes` | the error by modes that a step does not show |
//! | `batch` | many cases, tried again where a step or a table was too short |
//! | `recorded_response` | one case with its history |
//! | `variable_steps` | one case at steps of its own, short where contact opens and closes |
//! | `step_coefficients` | all numbers of such a step that do not depend on the load |
//! | `dense_output` | the motion between steps |
//! | `energy` | the energy balance |
//! | `decimation` | the filter of the output |
//! | `linear_tail` | the rest of a ring-down, where the laws are straight |
//! | `ring_down` | the step from which a ring-down is linear |
//! | `linear_system` | the small linear equations of the contacts |
//! | `increasing_root` | a bracketed root, for contacts solved one by one |
//! | `many_contacts` | structures with up to a thousand contacts, open at rest too |
//! | `simd` | cases in the lanes of vectors |
//! | `sensitivity` | derivatives of a case with respect to parameters |
#![allow(
    clippy::inline_always,
    reason = "kernels must be compiled with their caller, for the vector instructions chosen"
)]

mod assembly;
mod batch;
mod damped_table;
mod decimation;
mod dense_output;
mod energy;
mod fast_modes;
mod increasing_root;
mod lane_start;
mod law_point;
mod law_tables;
mod linear_system;
mod linear_tail;
mod load_steps;
mod many_contacts;
mod oscillator;
mod periodic_start;
mod prepared_case;
mod recorded_response;
mod ring_down;
mod row_modes;
mod sensitivity;
mod simd;
mod step_coefficients;
mod step_model;
mod step_size;
mod transient_case;
mod variable_steps;

use std::f64::consts::TAU;
use std::sync::Arc;

use asperity_mesh::{ModeCount, Port};
use asperity_structure::{LoadCase, PreloadedStructure};

use crate::error::check_damping;
use crate::{DynamicsError, InstructionSet, Sampling, Transient};

pub use assembly::ModalModel;
pub use batch::Batch;
pub use decimation::Decimation;
pub use many_contacts::{ContactsResponse, ContactsState, MOST_CONTACTS, ManyContacts};
pub use periodic_start::PeriodicMotion;
pub use sensitivity::{ContactMeasures, ParameterVariation, Sensitivity, StepHistory};
pub use step_size::COARSE_RESIDUAL;
pub use transient_case::{CaseResponse, TransientCase};

/// Frequencies of interest over the lowest natural one: the top of the window in which the second
/// harmonic is searched.
const BAND: f64 = 3.22;

/// Radians of the load's time scale up to which modes follow it: a gamma pulse has a tenth of
/// its spectrum there.
const LOAD_BAND: f64 = 4.0;

/// Share of a body's inertia that the modes left out may lack in the band.
const NEGLECTED: f64 = 1e-3;

/// Settings of the modal integrator.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Modal {
    /// Step \[s\], at most 1 over the lowest natural angular frequency; none to have it chosen
    /// from that frequency and the load, and halved until the energy balance closes to 5e-4.
    pub step: Option<f64>,
    /// Modes of each body, the rigid one included; none to have them chosen from the error bound
    /// of [`ModeCount::Bound`].
    pub modes_per_body: Option<usize>,
    /// Error of a contact traction within a step, over its largest so far, of runs at
    /// [steps of their own](Batch#steps-of-their-own), short where contact opens and closes; none for
    /// equal steps. `step` is then the longest.
    pub tolerance: Option<f64>,
    /// Vector instructions to run on.
    pub instructions: InstructionSet,
}

impl Default for Modal {
    /// Step and modes chosen, the machine's widest vectors.
    fn default() -> Self {
        let instructions = InstructionSet::detected();
        Self { step: None, modes_per_body: None, tolerance: None, instructions }
    }
}

impl Modal {
    /// Modes of each body kept for `load` on a stack whose lowest natural frequency is `natural`
    /// \[Hz\].
    pub fn mode_count(&self, natural: Option<f64>, load: &LoadCase) -> ModeCount {
        match self.modes_per_body {
            Some(modes) => ModeCount::PerBody(modes),
            None => ModeCount::Bound {
                angular_frequency: (BAND * TAU * natural.unwrap_or(0.0))
                    .max(LOAD_BAND / load.time_scale()),
                tolerance: NEGLECTED,
            },
        }
    }

    /// The response of `structure`, from rest, to `load`, read at `sensors`.
    ///
    /// Samples need not fall on steps: between steps the modes move exactly, and
    /// the closures follow a cubic. A run takes some milliseconds.
    ///
    /// ```
    /// use asperity_dynamics::{Modal, Sampling};
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
    /// let pulse = LoadCase::force(TimeFunction::GammaPulse { rise: 0.34e-3 }, 9.0);
    /// let sampling = Sampling::new(0.02, 2e5)?;
    /// let response = Modal::default().integrate(&structure, &pulse, &[Port::TOP], &sampling)?;
    /// assert!(response.energy.residual_relative() < 5e-4);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// [`DynamicsError::Structure`] for a count of modes out of range,
    /// [`DynamicsError::LossFactor`] for a body with a loss factor, [`DynamicsError::ModalDamping`] for
    /// ratios of modes, [`DynamicsError::Setting`]
    /// for a step or load out of range, more than 16 interfaces, or an instruction set
    /// that the machine lacks, [`DynamicsError::Law`] when a law cannot be tabulated,
    /// [`DynamicsError::Unstable`] when the numbers overflow or pressures leave every table,
    /// [`DynamicsError::Coarse`] when the energy balance does not close.
    pub fn integrate(
        &self,
        structure: &PreloadedStructure,
        load: &LoadCase,
        sensors: &[Port],
        sampling: &Sampling,
    ) -> Result<Transient, DynamicsError> {
        let case = self.case(structure, load, sensors, sampling)?;
        Batch { instructions: self.instructions }.transient(&case, sampling)
    }

    /// The case that [`integrate`](Self::integrate) carries out.
    ///
    /// # Errors
    /// As [`integrate`](Self::integrate), where they show before the first step.
    pub fn case(
        &self,
        structure: &PreloadedStructure,
        load: &LoadCase,
        sensors: &[Port],
        sampling: &Sampling,
    ) -> Result<TransientCase, DynamicsError> {
        load.check()?;
        check_damping(structure)?;
        let modes = self.mode_count(structure.natural_frequency(), load);
        let counts = modes.counts(structure.stack())?;
        let rig = Arc::new(ModalModel::of_stack(structure, &counts, load.port(), sensors)?);
        let duration = sampling.samples() as f64 * sampling.interval();
        Ok(TransientCase {
            model: rig,
            load: load.clone(),
            sensor: 0,
            duration,
            step: self.step,
            tolerance: self.tolerance,
        })
    }
}
