//! Structures whose steady responses are sought.

use std::ops::Range;

use asperity_harmonic::{ContactSystem, LawEvaluation, PeriodicResponse};
use asperity_structure::PreloadedStructure;

use super::bodies::{BodyModel, LightBodies};
use super::check::TimeCheck;
use super::motion::{IntegratedMotion, motions};
use super::time_sweep::{TimeSweep, TimeSweepRequest, time_sweeps};
use crate::assemble::{Assembly, Interfaces};
use crate::error::SimulationError;

/// A structure that a shaker drives: its equations, and its response by time integration as a check of them.
pub trait Shaken: Interfaces + Sync + Sized {
    /// The structure and its contacts, with the load and the sensors at their ports.
    ///
    /// # Errors
    /// [`SimulationError::Harmonic`] for a structure that cannot be balanced.
    fn contact_system(
        assembly: &Assembly<Self>,
        evaluation: LawEvaluation,
    ) -> Result<ContactSystem, SimulationError>;

    /// Bodies that may be condensed where contact is lost in the band that ends at `highest` \[Hz\]; none by
    /// default.
    ///
    /// # Errors
    /// [`SimulationError::NothingToCondense`] where there is no such body and one was asked for.
    fn light_bodies(
        _assembly: &Assembly<Self>,
        _highest: f64,
        _model: BodyModel,
        _evaluation: LawEvaluation,
    ) -> Result<Option<LightBodies>, SimulationError> {
        Ok(None)
    }

    /// The contacts of each interface; none where each interface is one contact.
    fn cells(&self) -> Vec<Range<usize>> {
        Vec::new()
    }

    /// Lowest natural frequency at rest \[Hz\].
    fn natural_frequency_hz(&self) -> Option<f64>;

    /// A response of a branch by time integration from rest.
    ///
    /// # Errors
    /// [`SimulationError::Dynamics`] of the integration.
    fn time_check(
        assembly: &Assembly<Self>,
        response: &PeriodicResponse,
    ) -> Result<TimeCheck, SimulationError>;

    /// A response of a branch by time integration from its own state; not integrated by default.
    fn from_own_state(
        _assembly: &Assembly<Self>,
        _response: &PeriodicResponse,
    ) -> Option<TimeCheck> {
        None
    }

    /// Motions by time integration under a force of this amplitude \[N\] in some ranges of frequency \[Hz\]; not
    /// looked for by default.
    fn motions(
        _assembly: &Assembly<Self>,
        _amplitude: f64,
        _ranges: &[[f64; 2]],
    ) -> Vec<IntegratedMotion> {
        Vec::new()
    }

    /// Stepped sines by time integration over the frequencies `range` \[Hz\] at some force amplitudes \[N\].
    ///
    /// # Errors
    /// [`SimulationError::Dynamics`] for a request out of range.
    fn time_sweeps(
        assembly: &Assembly<Self>,
        amplitudes: &[f64],
        range: (f64, f64),
        request: TimeSweepRequest,
    ) -> Result<Vec<TimeSweep>, SimulationError>;
}

impl Shaken for PreloadedStructure {
    fn contact_system(
        assembly: &Assembly,
        evaluation: LawEvaluation,
    ) -> Result<ContactSystem, SimulationError> {
        let system = ContactSystem::of_structure(&assembly.structure, evaluation)?;
        Ok(system.with_ports(assembly.load.port(), &assembly.sensor_ports())?)
    }

    fn light_bodies(
        assembly: &Assembly,
        highest: f64,
        model: BodyModel,
        evaluation: LawEvaluation,
    ) -> Result<Option<LightBodies>, SimulationError> {
        LightBodies::of(assembly, highest, model, evaluation)
    }

    fn natural_frequency_hz(&self) -> Option<f64> {
        self.natural_frequency()
    }

    fn time_check(
        assembly: &Assembly,
        response: &PeriodicResponse,
    ) -> Result<TimeCheck, SimulationError> {
        Ok(TimeCheck::of(assembly, response)?)
    }

    fn from_own_state(assembly: &Assembly, response: &PeriodicResponse) -> Option<TimeCheck> {
        TimeCheck::from_own_state(assembly, response)
    }

    fn motions(assembly: &Assembly, amplitude: f64, ranges: &[[f64; 2]]) -> Vec<IntegratedMotion> {
        motions(assembly, amplitude, ranges)
    }

    fn time_sweeps(
        assembly: &Assembly,
        amplitudes: &[f64],
        range: (f64, f64),
        request: TimeSweepRequest,
    ) -> Result<Vec<TimeSweep>, SimulationError> {
        Ok(time_sweeps(assembly, amplitudes, range, request)?)
    }
}
