//! Load cases: a function of time, its amplitude, and where it acts.

use std::sync::Arc;

use asperity_mesh::Port;

use crate::time_function::Order;
use crate::{SampledFunction, StructureError, TimeFunction};

/// The motion of a base that is given over time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BaseQuantity {
    /// Acceleration \[m/s2\].
    Acceleration,
    /// Velocity \[m/s\].
    Velocity,
    /// Displacement \[m\].
    Displacement,
}

/// A load on a structure from `t = 0` on: a force at a port, or the motion of the base.
///
/// ```text
/// force at port b:      f_b(t) = F s(t)
/// motion of the base:   u = u_base + w,   f(t) = -m u_base''(t) on every mass m
/// ```
///
/// with the time function `s` of unit amplitude and the amplitude F. Displacements `w` are relative to
/// the base; so are the velocities on which mass-proportional damping and guides act. At `t = 0` the
/// structure rests relative to the base: a base that has a velocity then has moved with it, and with
/// the structure, before. Positive forces and motions point down.
///
/// ```
/// use asperity_mesh::Port;
/// use asperity_structure::{LoadCase, TimeFunction};
///
/// let pulse = TimeFunction::GammaPulse { rise: 0.34e-3 };
/// let hit = LoadCase::force(pulse, 32.0).at(Port::Point { body: 0, position: 0.1 });
/// assert_eq!(hit.value(0.34e-3), 32.0);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct LoadCase {
    function: TimeFunction,
    /// Derivative of the function that acts.
    order: Order,
    base: Option<BaseMotion>,
    amplitude: f64,
    port: Port,
}

/// Given quantity of the motion of the base, and the uniform motion that its acceleration does not
/// contain, per amplitude: displacement and velocity at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
struct BaseMotion {
    quantity: BaseQuantity,
    displacement: f64,
    velocity: f64,
    from: f64,
}

impl LoadCase {
    /// No load.
    pub fn none() -> Self {
        Self::force(TimeFunction::Zero, 0.0)
    }

    /// A force of `amplitude` \[N\] on the upper end of the first body.
    pub fn force(function: TimeFunction, amplitude: f64) -> Self {
        let (order, port) = (Order::Value, Port::TOP);
        Self { function, order, base: None, amplitude, port }
    }

    /// Samples of a force \[N\] on the upper end of the first body; the amplitude is their largest
    /// magnitude.
    pub fn samples(samples: &SampledFunction) -> Self {
        let (unit, peak) = samples.normalised();
        Self::force(TimeFunction::Samples(Arc::new(unit)), peak)
    }

    /// The same load at `port`, which a motion of the base does not have.
    #[must_use]
    pub fn at(self, port: Port) -> Self {
        if self.base.is_some() { self } else { Self { port, ..self } }
    }

    /// A motion of the base: `amplitude` times `function`.
    ///
    /// Samples of a velocity are linear between them, samples of a displacement lie on a natural cubic
    /// spline; outside them the base moves on uniformly.
    ///
    /// # Errors
    /// [`StructureError::BaseJump`] for a displacement by half-sine, whose velocity jumps at its end.
    pub fn base_motion(
        quantity: BaseQuantity,
        function: TimeFunction,
        amplitude: f64,
    ) -> Result<Self, StructureError> {
        let mut base = BaseMotion { quantity, displacement: 0.0, velocity: 0.0, from: 0.0 };
        let order = match (&function, quantity) {
            (TimeFunction::HalfSine { .. }, BaseQuantity::Displacement) => {
                return Err(StructureError::BaseJump);
            }
            (TimeFunction::Samples(_), _) | (_, BaseQuantity::Acceleration) => Order::Value,
            (_, BaseQuantity::Velocity) => Order::Derivative,
            (_, BaseQuantity::Displacement) => Order::SecondDerivative,
        };
        let function = match (&function, quantity) {
            (TimeFunction::Samples(samples), BaseQuantity::Velocity) => {
                (base.from, base.velocity) = samples.first();
                TimeFunction::Samples(Arc::new(samples.derivative()))
            }
            (TimeFunction::Samples(samples), BaseQuantity::Displacement) => {
                (base.from, base.displacement) = samples.first();
                let (acceleration, velocity) = samples.spline();
                base.velocity = velocity;
                TimeFunction::Samples(Arc::new(acceleration))
            }
            _ => function,
        };
        Ok(Self { function, order, base: Some(base), amplitude, port: Port::Base })
    }

    /// The same load with another amplitude.
    #[must_use]
    pub fn with_amplitude(&self, amplitude: f64) -> Self {
        Self { amplitude, ..self.clone() }
    }

    /// Amplitude: of a force \[N\], or of the motion of the base in its own unit.
    pub fn amplitude(&self) -> f64 {
        self.amplitude
    }

    /// Frequency \[Hz\] of a load that is a sine over time; none for other loads.
    pub fn frequency(&self) -> Option<f64> {
        match (&self.function, self.order) {
            (&TimeFunction::Harmonic { frequency }, Order::Value) => Some(frequency),
            _ => None,
        }
    }

    /// Port that the load acts on; [`Port::Base`] for a motion of the base.
    pub fn port(&self) -> Port {
        self.port
    }

    /// The motion of the base that is given; none for a force.
    pub fn base(&self) -> Option<BaseQuantity> {
        self.base.as_ref().map(|base| base.quantity)
    }

    /// True for the same load but for the amplitude.
    pub fn is_like(&self, other: &Self) -> bool {
        (&self.function, self.order, self.port) == (&other.function, other.order, other.port)
    }

    /// Force \[N\] or base acceleration \[m/s2\] per amplitude at `time` \[s\].
    pub fn unit_value(&self, time: f64) -> f64 {
        self.function.at(self.order, time)
    }

    /// Force \[N\] or base acceleration \[m/s2\] at `time` \[s\].
    pub fn value(&self, time: f64) -> f64 {
        self.amplitude * self.unit_value(time)
    }

    /// Displacement \[m\], velocity \[m/s\] and acceleration \[m/s2\] of the base at `time` \[s\]; zero
    /// for a force.
    pub fn base_at(&self, time: f64) -> [f64; 3] {
        let Some(base) = &self.base else { return [0.0; 3] };
        let (past, integral) = (time - base.from, self.order.integral());
        [
            base.displacement + base.velocity * past + self.function.at(integral.integral(), time),
            base.velocity + self.function.at(integral, time),
            self.function.at(self.order, time),
        ]
        .map(|value| self.amplitude * value)
    }

    /// Time \[s\] after which the load is zero for good; infinite for a lasting one.
    pub fn ends_at(&self) -> f64 {
        self.function.ends_at()
    }

    /// Time in which the load changes \[s\]; infinite for no load.
    pub fn time_scale(&self) -> f64 {
        self.function.time_scale()
    }

    /// Largest magnitude of the force \[N\] or the base acceleration \[m/s2\].
    pub fn peak(&self) -> f64 {
        self.amplitude.abs() * self.function.peak(self.order)
    }

    /// Checks that every parameter is in its range.
    ///
    /// # Errors
    /// [`StructureError::Setting`] for an amplitude that is not finite, or a time or frequency that is
    /// not positive and finite.
    pub fn check(&self) -> Result<(), StructureError> {
        if !self.amplitude.is_finite() {
            let (quantity, accepted) = ("amplitude of the load", "finite");
            return Err(StructureError::Setting { quantity, value: self.amplitude, accepted });
        }
        self.function.check()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::SteppedSine;

    fn functions() -> Vec<TimeFunction> {
        let time: Vec<f64> =
            (0..9).map(|n| 1e-4 * f64::from(n) + 1e-6 * f64::from(n * n)).collect();
        let value = time.iter().map(|t| (4e3 * t).sin() + 0.3).collect();
        let samples = SampledFunction::new(time, value).unwrap();
        vec![
            TimeFunction::GammaPulse { rise: 2e-4 },
            TimeFunction::HalfSine { duration: 7e-4 },
            TimeFunction::Haversine { duration: 7e-4 },
            TimeFunction::Harmonic { frequency: 700.0 },
            TimeFunction::Samples(Arc::new(samples)),
            TimeFunction::SteppedSine(SteppedSine::new(&[(800.0, 4)]).unwrap()),
        ]
    }

    /// However it is given, velocity and acceleration are the derivatives of the displacement, and the
    /// given quantity is the function.
    #[test]
    fn the_motion_of_a_base_is_one_motion() {
        let quantities =
            [BaseQuantity::Displacement, BaseQuantity::Velocity, BaseQuantity::Acceleration];
        for function in functions() {
            for (place, quantity) in quantities.into_iter().enumerate() {
                let Ok(load) = LoadCase::base_motion(quantity, function.clone(), -2.0) else {
                    assert!(matches!(function, TimeFunction::HalfSine { .. }));
                    continue;
                };
                for n in 1..40 {
                    let (time, h) = (1.37e-5 * f64::from(n), 1e-9);
                    let [at, before, after] = [0.0, -h, h].map(|shift| load.base_at(time + shift));
                    for order in 0..2 {
                        let slope = (after[order] - before[order]) / (2.0 * h);
                        let size = at[order].abs() / h * 1e-15 + at[order + 1].abs() * 1e-5 + 1e-3;
                        assert!((slope - at[order + 1]).abs() < size, "{function:?} {quantity:?}");
                    }
                    assert_eq!(at[2], load.value(time));
                    let on_spline = place == 0 && matches!(function, TimeFunction::Samples(_));
                    if !on_spline {
                        let given = -2.0 * function.value(time);
                        assert!((at[place] - given).abs() < 1e-12 * (1.0 + given.abs()));
                    }
                }
            }
        }
    }

    /// A spline passes through its samples, and is the sine to fourth order away from its ends.
    #[test]
    fn a_sampled_displacement_lies_on_a_spline() {
        let error = |n: u32| {
            let time: Vec<f64> = (0..=n).map(|i| f64::from(i) / f64::from(n)).collect();
            let value: Vec<f64> = time.iter().map(|t| (7.0 * t).sin()).collect();
            let samples = SampledFunction::new(time.clone(), value.clone()).unwrap();
            let function = TimeFunction::Samples(Arc::new(samples));
            let load = LoadCase::base_motion(BaseQuantity::Displacement, function, 1.0).unwrap();
            for (t, v) in time.iter().zip(&value) {
                assert!((load.base_at(*t)[0] - v).abs() < 1e-12);
            }
            let middle = 0.5 + 0.5 / f64::from(n);
            (load.base_at(middle)[0] - (7.0 * middle).sin()).abs()
        };
        let (coarse, fine) = (error(40), error(80));
        assert!(((coarse / fine).log2() - 4.0).abs() < 0.3, "{coarse:e} {fine:e}");
    }

    #[test]
    fn a_record_of_a_force_is_a_unit_function_times_its_peak() {
        let samples = SampledFunction::new(vec![0.0, 1.0, 3.0], vec![0.0, 4.0, -2.0]).unwrap();
        let load = LoadCase::samples(&samples);
        assert_eq!((load.amplitude(), load.unit_value(1.0)), (4.0, 1.0));
        let doubled = SampledFunction::new(vec![0.0, 1.0, 3.0], vec![0.0, 8.0, -4.0]).unwrap();
        assert!(load.is_like(&LoadCase::samples(&doubled)));
        for (time, force) in [(-0.1, 0.0), (0.5, 2.0), (2.0, 1.0), (3.0, -2.0), (3.1, 0.0)] {
            assert_eq!(load.value(time), force);
        }
    }
}
