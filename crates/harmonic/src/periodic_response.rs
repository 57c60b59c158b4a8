//! One periodic response and its observables.

use std::f64::consts::TAU;

use asperity_structure::PreloadedContact;
use num_complex::Complex64;

use crate::PortMotion;
use crate::balance::{Balance, Conditions};
use crate::fourier::value_at;

/// Distance from the unit circle beyond which a multiplier counts as unstable: rounding of the
/// undamped.
const MARGIN: f64 = 1e-9;

/// Truncation up to which the harmonics of a response suffice.
const RESOLVED: f64 = 2e-3;

/// Extremes of the pressure at one interface over a period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PressureRange {
    /// Lowest pressure \[Pa\].
    pub lowest: f64,
    /// Highest pressure \[Pa\].
    pub highest: f64,
    /// Loss of contact within the period: the pressure of a law that separates is zero, at a contact that is
    /// closed at rest.
    pub contact_lost: bool,
}

/// A periodic motion `x(t) = X_0 + Re sum_k X_k exp(i k w t)` under the load `F cos(w t)`.
#[derive(Debug, Clone, PartialEq)]
pub struct PeriodicResponse {
    /// Angular frequency w \[rad/s\].
    pub angular_frequency: f64,
    /// Amplitude F of the load, of a force \[N\] or of the acceleration of the base \[m/s2\]; zero for a
    /// mode.
    pub force: f64,
    /// Anti-damping rate xi \[1/s\] that a mode needs; zero for a driven response.
    pub anti_damping: f64,
    /// Mean displacement of the load's port from rest \[m\], positive down.
    pub mean_displacement: f64,
    /// Complex amplitudes of the displacement of the load's port, harmonics 1 to H \[m\].
    pub displacement: Vec<Complex64>,
    /// Motions of the sensors.
    pub sensors: Vec<PortMotion>,
    /// Closure increments from rest: per interface the mean, then cosine and sine coefficient of
    /// each harmonic \[m\].
    pub closures: Vec<f64>,
    /// Extremes of the pressure at each interface.
    pub pressures: Vec<PressureRange>,
    /// Largest closure harmonic estimated to be missing, over the largest kept.
    pub truncation: f64,
    /// Modal mass of the fundamental, referred to the load's port \[kg\]: `|u^T M u| / |U_1|^2`
    /// over the structure.
    pub modal_mass: f64,
    /// Newton iterations it took.
    pub iterations: usize,
    /// Floquet multipliers, largest first, if stability was computed.
    pub multipliers: Option<Vec<Complex64>>,
}

impl PeriodicResponse {
    /// Frequency \[Hz\].
    pub fn frequency_hz(&self) -> f64 {
        self.angular_frequency / TAU
    }

    /// Number of harmonics H.
    pub fn harmonics(&self) -> usize {
        self.displacement.len()
    }

    /// Amplitude of harmonic k >= 1 of the displacement of the load's port \[m\]; zero beyond H.
    pub fn amplitude(&self, k: usize) -> f64 {
        k.checked_sub(1).and_then(|i| self.displacement.get(i)).map_or(0.0, |u| u.norm())
    }

    /// Phase of the fundamental of the displacement of the load's port relative to the load \[rad\]:
    /// zero at low frequency, -pi/2 at phase resonance.
    pub fn phase(&self) -> f64 {
        self.displacement.first().map_or(0.0, |u| u.arg())
    }

    /// Ratio `u2/u1` of the displacements of the load's port: second harmonic over fundamental.
    pub fn displacement_ratio(&self) -> f64 {
        self.amplitude(2) / self.amplitude(1)
    }

    /// Complex amplitude of harmonic k >= 1 of the displacement at a sensor \[m\]; NaN for a sensor that the
    /// system does not have.
    pub fn at_sensor(&self, sensor: usize, k: usize) -> Complex64 {
        let motion = self.sensors.get(sensor);
        motion.map_or(Complex64::new(f64::NAN, f64::NAN), |motion| motion.displacement(k))
    }

    /// Damping ratio of a mode, `xi / (2 w)`; zero for a driven response.
    pub fn damping_ratio(&self) -> f64 {
        self.anti_damping / (2.0 * self.angular_frequency)
    }

    /// Mass-normalised modal amplitude, `sqrt(modal mass) |U_1|` \[kg^1/2 m\].
    pub fn modal_amplitude(&self) -> f64 {
        self.modal_mass.sqrt() * self.amplitude(1)
    }

    /// True if contact is lost at any interface.
    pub fn contact_lost(&self) -> bool {
        self.pressures.iter().any(|range| range.contact_lost)
    }

    /// True if the harmonics suffice: the truncation is at most 2e-3. By experience responses with impacts beyond it
    /// depart from time integration, which leaves some that their multipliers call stable.
    pub fn is_resolved(&self) -> bool {
        self.truncation <= RESOLVED
    }

    /// True if small disturbances decay: all multipliers lie within the unit circle. `None` if
    /// stability was not computed.
    pub fn stable(&self) -> Option<bool> {
        self.unstable_multipliers().map(|count| count == 0)
    }

    /// Number of multipliers outside the unit circle.
    pub fn unstable_multipliers(&self) -> Option<usize> {
        let multipliers = self.multipliers.as_ref()?;
        // A multiplier that could not be computed, NaN, counts as unstable.
        let within = |multiplier: &&Complex64| multiplier.norm() <= 1.0 + MARGIN;
        Some(multipliers.len() - multipliers.iter().filter(within).count())
    }

    /// Displacement of the load's port from rest \[m\] at a phase `w t` \[rad\].
    pub fn displacement_at(&self, phase: f64) -> f64 {
        let turning = (1..).map(f64::from).zip(&self.displacement);
        let moving: f64 =
            turning.map(|(k, u)| u.re * (k * phase).cos() - u.im * (k * phase).sin()).sum();
        self.mean_displacement + moving
    }

    /// Closure increment from rest of an interface \[m\] at a phase `w t` \[rad\], and its first two
    /// derivatives with respect to the phase.
    pub fn closure_at(&self, interface: usize, phase: f64) -> [f64; 3] {
        let terms = 2 * self.harmonics() + 1;
        value_at(&self.closures[interface * terms..(interface + 1) * terms], phase)
    }

    /// The response whose balance was evaluated last.
    pub(crate) fn of(balance: &Balance<'_>, x: &[f64], at: &Conditions, iterations: usize) -> Self {
        let mut motions = balance.motions(x, at).into_iter();
        let (mean_displacement, displacement) =
            motions.next().map(|load| (load.mean, load.harmonics)).unwrap_or_default();
        let mut response = Self {
            angular_frequency: at.angular_frequency,
            force: at.force,
            anti_damping: at.anti_damping,
            mean_displacement,
            displacement,
            sensors: motions.collect(),
            closures: x.to_vec(),
            pressures: Vec::new(),
            truncation: balance.truncation(x),
            modal_mass: f64::NAN,
            iterations,
            multipliers: None,
        };
        response.modal_mass = balance.modal_mass(at, response.displacement[0].norm());
        response.pressures = (0..balance.system().contacts().len())
            .map(|i| {
                response.pressure_range(&balance.system().contacts()[i], i, balance.closures(i))
            })
            .collect();
        response
    }

    /// Pressure is monotone in closure: its extremes are those of the closure, found at the
    /// samples and polished by Newton's method on the series.
    fn pressure_range(
        &self,
        contact: &PreloadedContact,
        interface: usize,
        samples: &[f64],
    ) -> PressureRange {
        let spacing = TAU / samples.len() as f64;
        let extreme = |sign: f64| {
            let best =
                samples.iter().enumerate().max_by(|a, b| (sign * a.1).total_cmp(&(sign * b.1)));
            let (number, &sampled) = best.unwrap_or((0, &f64::NAN));
            let start = spacing * number as f64;
            let (mut phase, mut polished) = (start, sampled);
            for _ in 0..3 {
                let [value, slope, bend] = self.closure_at(interface, phase);
                polished = value;
                let step = slope / bend;
                if step.is_finite() {
                    phase = (phase - step).clamp(start - spacing, start + spacing);
                }
            }
            if sign * polished > sign * sampled { polished } else { sampled }
        };
        let (lowest, highest) = (extreme(-1.0), extreme(1.0));
        let pressure = contact.pressure_at(lowest);
        PressureRange {
            lowest: pressure,
            highest: contact.pressure_at(highest),
            contact_lost: contact.gap() == 0.0
                && contact.law().domain().separates()
                && pressure <= 0.0,
        }
    }
}
