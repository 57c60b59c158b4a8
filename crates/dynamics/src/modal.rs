//! Exact modal steps with implicit contact, many hits side by side.
//!
//! Between its contacts a structure is linear: a few modes and the flexibility of the rest
//! ([`ComponentModes`](asperity_mesh::ComponentModes)). Over a step each oscillator moves exactly
//! under a course of force that is a polynomial through the pressures at steps, so that only the
//! pressures at the end of the step are unknown,
//!
//! ```text
//! x_i + sum_j B_ij p_j(x_j) = x*_i,
//! ```
//!
//! x* being the closures without them. Light bodies between stiff contacts see the mean force of
//! the step, which is stable however stiff the contacts are; the others the parabola through
//! three pressures, which is third order. Nothing here knows bars, or finite elements.
//!
//! | module | holds |
//! |---|---|
//! | `oscillator` | the exact step of one oscillator under a polynomial course of force |
//! | `drive` | the drive force as steps see it |
//! | `model` | all numbers of a step that do not depend on the drive |
//! | `rig` | a structure with its contacts, tabulated and stepped once for many hits |
//! | `lane`, `block` | one hit; hits side by side in the lanes of vectors |
//! | `rows` | looking up a table row per lane, by instruction set |
//! | `kernel` | one step of every lane |
//! | `alone` | lanes that Newton's method does not settle |
//! | `tally`, `thin` | extremes; fewer samples than steps |
//! | `march` | blocks from rest to the end |
//! | `energy` | the energy balance |
//! | `step_size` | how long a step is |
//! | `batch` | many hits, tried again where a step or a table was too short |
//! | `dense` | the motion between steps |
//! | `tangent` | derivatives of a hit with respect to what it depends on |
#![allow(
    clippy::inline_always,
    reason = "what the march calls must be compiled with it, for the vector instructions chosen"
)]

mod alone;
mod batch;
mod block;
mod dense;
mod drive;
mod energy;
mod kernel;
mod lane;
mod march;
mod model;
mod oscillator;
mod rig;
mod rows;
mod step_size;
mod tally;
mod tangent;
mod thin;

use std::f64::consts::TAU;
use std::sync::Arc;

use asperity_mesh::ModeCount;
use asperity_structure::PreloadedStructure;

use crate::{DynamicsError, Excitation, InstructionSet, Sampling, Transient};

pub use batch::{Batch, Hit, HitRecord};
pub use rig::ModalRig;
pub use tangent::{ContactMeasures, Course, Sensitivity, Variation};
pub use thin::Thinning;

/// Frequencies of interest over the lowest natural one: the top of the window in which the second
/// harmonic is looked for.
const BAND: f64 = 3.22;

/// Radians of the drive's time scale up to which modes follow it: a gamma pulse has a tenth of
/// its spectrum there.
const DRIVE_BAND: f64 = 4.0;

/// Share of a body's inertia that the modes left out may lack in the band.
const NEGLECTED: f64 = 1e-3;

/// Settings of the modal integrator.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Modal {
    /// Step \[s\], at most 0.2 over the lowest natural angular frequency; none to have it chosen
    /// from that frequency and the drive, and halved until the energy balance closes to 5e-4.
    pub step: Option<f64>,
    /// Modes of each body, the rigid one included; none to have them chosen from the error bound
    /// of [`ModeCount::Bound`].
    pub modes_per_body: Option<usize>,
    /// Vector instructions to run on.
    pub instructions: InstructionSet,
}

impl Default for Modal {
    /// Step and modes chosen, the machine's widest vectors.
    fn default() -> Self {
        Self { step: None, modes_per_body: None, instructions: InstructionSet::detected() }
    }
}

impl Modal {
    /// How many modes of each body are kept for `excitation` on a stack whose lowest natural
    /// frequency is `natural` \[Hz\].
    pub fn mode_count(&self, natural: Option<f64>, excitation: &Excitation) -> ModeCount {
        match self.modes_per_body {
            Some(modes) => ModeCount::PerBody(modes),
            None => ModeCount::Bound {
                angular_frequency: (BAND * TAU * natural.unwrap_or(0.0))
                    .max(DRIVE_BAND / excitation.time_scale()),
                tolerance: NEGLECTED,
            },
        }
    }

    /// The response of `structure`, from rest, to `excitation`.
    ///
    /// Samples need not fall on steps: between them the motion is that of the modes, and the
    /// closures a cubic. A run takes some milliseconds.
    ///
    /// # Errors
    /// [`DynamicsError::Structure`] for a count of modes out of range, [`DynamicsError::Setting`]
    /// for a step or excitation out of range, more than 16 interfaces, or an instruction set
    /// that the machine lacks, [`DynamicsError::Law`] when a law cannot be tabulated,
    /// [`DynamicsError::Unstable`] when the numbers overflow or pressures leave every table,
    /// [`DynamicsError::Coarse`] when the energy balance does not close.
    pub fn integrate(
        &self,
        structure: &PreloadedStructure,
        excitation: &Excitation,
        sampling: &Sampling,
    ) -> Result<Transient, DynamicsError> {
        let hit = self.hit(structure, excitation, sampling)?;
        Batch { instructions: self.instructions }.transient(&hit, sampling)
    }

    /// The hit that [`integrate`](Self::integrate) carries out.
    ///
    /// # Errors
    /// Those of [`integrate`](Self::integrate) that show before the first step.
    pub fn hit(
        &self,
        structure: &PreloadedStructure,
        excitation: &Excitation,
        sampling: &Sampling,
    ) -> Result<Hit, DynamicsError> {
        excitation.check()?;
        let modes = self.mode_count(structure.natural_frequency(), excitation);
        let rig = Arc::new(ModalRig::new(structure.reduced(modes)?)?);
        let duration = sampling.samples() as f64 * sampling.interval();
        Ok(Hit { rig, excitation: excitation.clone(), duration, step: self.step })
    }
}
