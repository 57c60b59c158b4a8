//! A simulated hit, with defaults for everything but the force.

use asperity_dynamics::{DynamicsError, Integrator, Sampling, Transient};
use asperity_mesh::Port;
use asperity_signal::{FrequencyResponse, HarmonicOptions, ReceptanceFeatures, SignalError};
use asperity_structure::{LoadCase, PreloadedStructure, TimeFunction};

/// Simulation of the response of a structure to a load, from rest.
///
/// Defaults: 0.12 s at 200 kHz by the modal engine, which chooses its step and modes.
///
/// ```
/// use asperity::prelude::*;
///
/// let structure = StackBuilder::new()
///     .body(Body::with_mass("guide bar", 0.229, 1.61, 71e9, 2710.0)?)
///     .interface("guide-disc", 1.15e-4, Power::new(1.81e10, 0.35, 0.0)?)
///     .preloaded(Damping::Ratio(0.035))?;
/// let force = LoadCase::force(TimeFunction::HalfSine { duration: 1e-3 }, 5.0);
/// let hit = Simulation::new(force).duration(0.1).run(&structure)?;
/// assert!(hit.transient.energy.residual_relative() < 1e-3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Simulation {
    load: LoadCase,
    sensor: Port,
    duration: f64,
    sample_rate: f64,
    method: Integrator,
}

impl Simulation {
    /// The response to `load`, which must not be zero, read at the top.
    pub fn new(load: LoadCase) -> Self {
        let sensor = Port::TOP;
        Self { load, sensor, duration: 0.12, sample_rate: 2e5, method: Integrator::default() }
    }

    /// The response to the hit of a hammer: `peak (t/r)^2 exp(2 (1 - t/r))` \[N\] with a rise r of
    /// 0.34 ms.
    pub fn of_hit(peak: f64) -> Self {
        Self::new(LoadCase::force(TimeFunction::GammaPulse { rise: 0.34e-3 }, peak))
    }

    /// Sets the port at which the response is read.
    #[must_use]
    pub fn sensor(mut self, sensor: Port) -> Self {
        self.sensor = sensor;
        self
    }

    /// Sets the duration \[s\].
    #[must_use]
    pub fn duration(mut self, duration: f64) -> Self {
        self.duration = duration;
        self
    }

    /// Sets the sample rate of the response \[Hz\].
    #[must_use]
    pub fn sample_rate(mut self, sample_rate: f64) -> Self {
        self.sample_rate = sample_rate;
        self
    }

    /// Sets the integrator.
    #[must_use]
    pub fn method(mut self, method: impl Into<Integrator>) -> Self {
        self.method = method.into();
        self
    }

    /// Integrates the response of `structure`.
    ///
    /// # Errors
    /// [`HitError::NoForce`] for a load of zero; else [`HitError`]
    /// for a setting out of range, or when the integration or its analysis fails.
    pub fn run(&self, structure: &PreloadedStructure) -> Result<SimulatedHit, HitError> {
        if self.load.peak() == 0.0 {
            return Err(HitError::NoForce);
        }
        let sampling = Sampling::new(self.duration, self.sample_rate)?;
        let transient = self.method.integrate(structure, &self.load, &[self.sensor], &sampling)?;
        let (force, displacement) =
            (&transient.history.load, &transient.history.sensors[0].displacement);
        let response = FrequencyResponse::from_displacement(force, displacement, self.sample_rate)?;
        let features = structure
            .natural_frequency()
            .map(|natural| ReceptanceFeatures::of(&response, natural, &HarmonicOptions::default()));
        Ok(SimulatedHit { transient, response, features: features.unwrap_or_default() })
    }
}

/// Response to a hit.
#[derive(Debug, Clone, PartialEq)]
pub struct SimulatedHit {
    /// Samples, contact extremes and energy balance.
    pub transient: Transient,
    /// Receptance of the sensor at any frequency.
    pub response: FrequencyResponse,
    /// Fundamental, second harmonic and half-power crossings.
    pub features: ReceptanceFeatures,
}

impl SimulatedHit {
    /// Frequency of the fundamental \[Hz\]; none without a peak.
    pub fn fundamental_hz(&self) -> Option<f64> {
        self.features.harmonics.fundamental.map(|peak| peak.frequency_hz)
    }

    /// A2/A1: the ratio of the receptances at second harmonic and fundamental; none without both
    /// peaks.
    pub fn harmonic_ratio(&self) -> Option<f64> {
        self.features.harmonics.ratio()
    }

    /// Damping ratio from the half-power width of the fundamental. For a nonlinear response it
    /// also contains the change of frequency during the decay.
    pub fn half_power_damping(&self) -> Option<f64> {
        self.features.damping_ratio()
    }
}

/// Error of a [`Simulation`].
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum HitError {
    /// The excitation is none, or its force is zero at all times.
    #[error(
        "the excitation has no force; expected one with a peak other than zero, such as a gamma pulse of 9 N"
    )]
    NoForce,
    /// The settings are out of range, or the integration failed.
    #[error(transparent)]
    Dynamics(#[from] DynamicsError),
    /// The samples cannot be analysed, for example if the force begins after the simulated time.
    #[error(transparent)]
    Signal(#[from] SignalError),
}

#[cfg(test)]
mod tests {
    use crate::prelude::*;

    #[test]
    fn a_simulation_without_force_is_refused() {
        let structure = StackBuilder::new()
            .body(Body::new("bar", 0.2, 1e-3, 71e9, 2710.0).unwrap())
            .interface("bar-disc", 1e-4, Constant::new(8.5e11).unwrap())
            .preloaded(Damping::Ratio(0.02))
            .unwrap();
        for simulation in [Simulation::new(LoadCase::none()), Simulation::of_hit(0.0)] {
            let error = simulation.run(&structure).unwrap_err();
            assert!(matches!(error, HitError::NoForce), "{error}");
        }
    }
}
