//! The result of a time integration.

use crate::DynamicsError;
use crate::error::positive;

/// Times at which the response is recorded: `n / rate` for every `0 <= n / rate < duration`.
///
/// ```
/// use asperity_dynamics::Sampling;
///
/// let sampling = Sampling::new(0.12, 2e5)?;
/// assert_eq!(sampling.samples(), 24_000);
/// # Ok::<(), asperity_dynamics::DynamicsError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sampling {
    duration: f64,
    rate: f64,
}

/// Most samples a response may have: 2e8 samples of four columns are 6.4 GB.
const MOST_SAMPLES: f64 = 2e8;

impl Sampling {
    /// Sampling over `duration` \[s\] at `rate` \[Hz\].
    ///
    /// # Errors
    /// [`DynamicsError::Setting`] unless both are positive and finite and give
    /// at least one and at most 2e8 samples.
    pub fn new(duration: f64, rate: f64) -> Result<Self, DynamicsError> {
        positive("duration [s]", duration)?;
        positive("output rate [Hz]", rate)?;
        let samples = duration * rate;
        if !(0.5..=MOST_SAMPLES).contains(&samples) {
            return Err(DynamicsError::Setting {
                quantity: "number of samples, duration times output rate",
                value: samples,
                accepted: "1 to 2e8",
            });
        }
        Ok(Self { duration, rate })
    }

    /// Number of samples.
    pub fn samples(&self) -> usize {
        (self.duration * self.rate).round() as usize
    }

    /// Sampling rate \[Hz\].
    pub fn rate(&self) -> f64 {
        self.rate
    }

    /// Time between samples \[s\].
    pub fn interval(&self) -> f64 {
        1.0 / self.rate
    }

    /// The same samples with `parts` for each of them.
    #[must_use]
    pub fn divided(&self, parts: usize) -> Self {
        let duration = self.samples() as f64 / self.rate;
        Self { duration, rate: parts.max(1) as f64 * self.rate }
    }
}

/// A response: its samples, the extremes at each contact, and its energy balance.
#[derive(Debug, Clone, PartialEq)]
pub struct Transient {
    /// Integration step \[s\].
    pub step: f64,
    /// Number of steps taken.
    pub steps: usize,
    /// Samples at the output rate.
    pub history: History,
    /// Extremes and averages at each interface over all steps, from the top down.
    pub contacts: Vec<ContactExtremes>,
    /// The energy balance of the whole run.
    pub energy: EnergyLedger,
}

/// Samples of a response at equal intervals from `t = 0` on, one vector per quantity.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct History {
    /// Time \[s\].
    pub time: Vec<f64>,
    /// Force \[N\], or acceleration of the base \[m/s2\].
    pub load: Vec<f64>,
    /// Motion of each sensor from static equilibrium, relative to the base.
    pub sensors: Vec<SensorHistory>,
    /// Contact quantities, from the top down.
    pub interfaces: Vec<InterfaceHistory>,
}

/// Samples of one sensor.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SensorHistory {
    /// Displacement \[m\].
    pub displacement: Vec<f64>,
    /// Velocity \[m/s\].
    pub velocity: Vec<f64>,
    /// Acceleration \[m/s2\].
    pub acceleration: Vec<f64>,
}

/// Samples of one interface.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct InterfaceHistory {
    /// Contact pressure \[Pa\]; zero while contact is lost.
    pub pressure: Vec<f64>,
    /// Closure \[m\], counted from the law's reference pressure.
    pub closure: Vec<f64>,
    /// Contact stiffness per area \[Pa/m\]; zero while contact is lost.
    pub stiffness: Vec<f64>,
}

impl History {
    /// No samples yet, with room for `samples` of them.
    pub(crate) fn with_capacity(samples: usize, sensors: usize, interfaces: usize) -> Self {
        let column = || Vec::with_capacity(samples);
        let sensor =
            || SensorHistory { displacement: column(), velocity: column(), acceleration: column() };
        let interface =
            || InterfaceHistory { pressure: column(), closure: column(), stiffness: column() };
        Self {
            time: column(),
            load: column(),
            sensors: (0..sensors).map(|_| sensor()).collect(),
            interfaces: (0..interfaces).map(|_| interface()).collect(),
        }
    }

    /// Every sample at a multiple of `parts`, as of a response at [divided](Sampling::divided) samples.
    #[must_use]
    pub fn every(self, parts: usize) -> Self {
        let of_sensor = |one: SensorHistory| SensorHistory {
            displacement: every(one.displacement, parts),
            velocity: every(one.velocity, parts),
            acceleration: every(one.acceleration, parts),
        };
        let interfaces = self.interfaces.into_iter().map(|one| one.every(parts));
        Self {
            time: every(self.time, parts),
            load: every(self.load, parts),
            sensors: self.sensors.into_iter().map(of_sensor).collect(),
            interfaces: interfaces.collect(),
        }
    }
}

fn every(column: Vec<f64>, parts: usize) -> Vec<f64> {
    if parts <= 1 { column } else { column.into_iter().step_by(parts).collect() }
}

impl SensorHistory {
    pub(crate) fn push(&mut self, [displacement, velocity, acceleration]: [f64; 3]) {
        self.displacement.push(displacement);
        self.velocity.push(velocity);
        self.acceleration.push(acceleration);
    }
}

impl InterfaceHistory {
    /// As [`History::every`].
    #[must_use]
    pub fn every(self, parts: usize) -> Self {
        Self {
            pressure: every(self.pressure, parts),
            closure: every(self.closure, parts),
            stiffness: every(self.stiffness, parts),
        }
    }

    pub(crate) fn push(&mut self, (pressure, closure, stiffness): (f64, f64, f64)) {
        self.pressure.push(pressure);
        self.closure.push(closure);
        self.stiffness.push(stiffness);
    }
}

/// Extremes and averages at one interface over the integration steps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactExtremes {
    /// Lowest pressure \[Pa\].
    pub pressure_min: f64,
    /// Highest pressure \[Pa\].
    pub pressure_max: f64,
    /// Time during which contact was lost \[s\].
    pub lost: f64,
    /// Time average of the stiffness per area (Eq. 8) \[Pa/m\],
    ///
    /// ```text
    /// K_avr = (1/T) sum |K_c(t_n)| dt,   t_n = 0, dt, ..., T - dt
    /// ```
    ///
    /// with K = 0 while contact is lost. The modal integrator evaluates the stiffness at every
    /// step, finite differences at least at every thirty-second; each value is weighted with the
    /// steps up to the next.
    pub stiffness_average: f64,
}

/// The energy balance of a run, about static equilibrium.
///
/// `input = dissipated + stored + numerical_loss + residual`. Stored energy is
/// counted from static equilibrium, so it holds the elastic energies of the bars and of the
/// contacts, and the work of the weight, in one positive number:
/// `sum S (E(d) - E(d0) - p0 (d - d0)) + w k w / 2`, plus the kinetic energy.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct EnergyLedger {
    /// Work of the load, relative to the base \[J\].
    pub input: f64,
    /// Loss in bodies, support, contacts and friction elements \[J\].
    pub dissipated: f64,
    /// The viscous part of it in the contacts \[J\].
    pub contact_dissipated: f64,
    /// The part of it by friction \[J\].
    pub friction_dissipated: f64,
    /// Kinetic energy at the end \[J\].
    pub kinetic: f64,
    /// Elastic energy of bodies, support and friction elements at the end \[J\].
    pub elastic: f64,
    /// Excess energy of the contacts at the end \[J\].
    pub contact: f64,
    /// Loss of the contact scheme itself \[J\]: zero but for the `new_level` form.
    pub numerical_loss: f64,
}

impl EnergyLedger {
    /// Kinetic, elastic and contact energy at the end \[J\].
    pub fn stored(&self) -> f64 {
        self.kinetic + self.elastic + self.contact
    }

    /// Input less loss and stored energy \[J\].
    pub fn residual(&self) -> f64 {
        self.input - self.dissipated - self.stored() - self.numerical_loss
    }

    /// The residual over the larger of the input and all it became; zero if nothing moved.
    pub fn residual_relative(&self) -> f64 {
        let became = self.dissipated.abs() + self.stored().abs() + self.numerical_loss.abs();
        let scale = self.input.abs().max(became);
        if scale > 0.0 { self.residual().abs() / scale } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_fill_the_half_open_duration() {
        assert_eq!(Sampling::new(0.12, 2e5).unwrap().samples(), 24_000);
        for (duration, rate) in [(0.0, 1.0), (1.0, -1.0), (f64::NAN, 1.0), (1e9, 1e9), (1e-9, 1.0)]
        {
            assert!(Sampling::new(duration, rate).is_err());
        }
    }

    #[test]
    fn divided_samples_contain_the_samples() {
        let sampling = Sampling::new(0.010_03, 1e4).unwrap();
        let divided = sampling.divided(7);
        assert_eq!(divided.samples(), 700);
        assert_eq!(divided.rate(), 7e4);
        let column = |one: Sampling| (0..one.samples()).map(move |n| n as f64 * one.interval());
        let interface =
            InterfaceHistory { pressure: vec![5.0; 700], ..InterfaceHistory::default() };
        let sensor = SensorHistory { velocity: vec![4.0; 700], ..SensorHistory::default() };
        let history = History {
            time: column(divided).collect(),
            load: vec![3.0; 700],
            sensors: vec![sensor],
            interfaces: vec![interface],
        };
        let found = history.every(7);
        let pairs = found.time.iter().zip(column(sampling));
        assert!(found.time.len() == 100 && pairs.into_iter().all(|(a, b)| (a - b).abs() < 1e-15));
        let counts = [&found.load, &found.sensors[0].velocity, &found.interfaces[0].pressure];
        assert_eq!(counts.map(Vec::len), [100; 3]);
    }

    #[test]
    fn the_residual_is_relative_to_the_work_done() {
        let ledger =
            EnergyLedger { input: 2.0, dissipated: 1.5, kinetic: 0.4, ..EnergyLedger::default() };
        assert!((ledger.residual_relative() - 0.05).abs() < 1e-15);
        assert_eq!(EnergyLedger::default().residual_relative(), 0.0);
    }
}
