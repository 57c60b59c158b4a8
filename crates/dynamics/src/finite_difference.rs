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
mod damped_contact;
mod guide;
mod ledger;
mod loads;
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

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_law::Constant;
    use asperity_mesh::{Body, Interface, Stack, Support};
    use asperity_structure::{BaseQuantity, Damping, TimeFunction};
    use std::f64::consts::{PI, TAU};
    use std::sync::Arc;

    /// Undamped bars of 0.2 m and 1e-4 m2, one on another, without gravity, on contacts of `stiffnesses`
    /// \[Pa/m\].
    fn bars(stiffnesses: &[f64], support: Support) -> PreloadedStructure {
        let body = |_| Body::new("bar", 0.2, 1e-4, 71e9, 2710.0).unwrap();
        let contact = |(i, stiffness): (usize, &f64)| {
            let law = Arc::new(Constant::new(*stiffness).unwrap());
            Interface::new(&format!("contact {i}"), 1e-4, law).unwrap()
        };
        let bodies = stiffnesses.iter().map(body).collect();
        let contacts = stiffnesses.iter().enumerate().map(contact).collect();
        let stack = Stack::new(bodies, contacts, support, 0.0).unwrap();
        PreloadedStructure::new(stack, Damping::Rate(0.0)).unwrap()
    }

    fn response(
        structure: &PreloadedStructure,
        cell: f64,
        load: &LoadCase,
        sensors: &[Port],
        sampling: &Sampling,
    ) -> Transient {
        let method = FiniteDifference { cell, ..FiniteDifference::default() };
        method.integrate(structure, load, sensors, sampling).unwrap()
    }

    /// Largest difference over the largest value.
    fn difference(found: &[f64], exact: &[f64]) -> f64 {
        assert_eq!(found.len(), exact.len());
        let scale = exact.iter().fold(0.0_f64, |most, x| x.abs().max(most));
        found.iter().zip(exact).fold(0.0_f64, |most, (a, b)| (a - b).abs().max(most)) / scale
    }

    /// Force and sensor may be exchanged: within a body and across contacts, at nodes, between nodes and
    /// at ends.
    #[test]
    fn exchange_of_force_and_sensor_leaves_the_response() {
        let support = Support::SpringMass { stiffness: 2e8, mass: 0.5, damping_ratio: 0.05 };
        let structure = bars(&[8.5e11, 3e11], support);
        let pulse = LoadCase::force(TimeFunction::GammaPulse { rise: 0.1e-3 }, 9.0);
        let sampling = Sampling::new(2e-3, 2e5).unwrap();
        let pairs = [((0, 0.0), (1, 1.0)), ((0, 0.3142), (0, 0.9)), ((0, 0.5), (1, 0.7321))];
        for pair in pairs {
            let place =
                |(body, fraction): (usize, f64)| Port::Point { body, position: 0.2 * fraction };
            let (x, y) = (place(pair.0), place(pair.1));
            let at = |loaded, read| {
                let run = response(&structure, 2e-3, &pulse.clone().at(loaded), &[read], &sampling);
                run.history.sensors[0].clone()
            };
            let (one, other) = (at(x, y), at(y, x));
            assert!(difference(&one.displacement, &other.displacement) < 1e-11, "{pair:?}");
            assert!(difference(&one.velocity, &other.velocity) < 1e-10, "{pair:?}");
            // Two differences of displacements over dt^2.
            assert!(difference(&one.acceleration, &other.acceleration) < 1e-8, "{pair:?}");
        }
    }

    /// Displacement, velocity and acceleration of an undamped oscillator of unit mass and angular
    /// frequency `w` at `t`, from rest, under `(1 - cos(o t)) / 2` from t = 0 on.
    fn lasting(w: f64, o: f64, t: f64) -> [f64; 3] {
        let push = 0.5 * (1.0 - (o * t).cos());
        if t <= 0.0 {
            return [0.0; 3];
        }
        if w == 0.0 {
            let displacement = 0.25 * t * t + 0.5 * ((o * t).cos() - 1.0) / (o * o);
            return [displacement, 0.5 * (t - (o * t).sin() / o), push];
        }
        let d = w * w - o * o;
        let place = (1.0 - (w * t).cos()) / (w * w) - ((o * t).cos() - (w * t).cos()) / d;
        let speed = (w * t).sin() / w + (o * (o * t).sin() - w * (w * t).sin()) / d;
        [0.5 * place, 0.5 * speed, push - 0.5 * w * w * place]
    }

    /// A bar that is all but free against the sum of its modes, under a haversine at one place and read at
    /// others: slope 2 in the cell.
    #[test]
    fn a_bar_driven_and_read_along_it_follows_the_sum_of_its_modes() {
        let structure = bars(&[1e-3], Support::Rigid);
        let body = &structure.stack().bodies()[0];
        let (length, mass) = (body.length(), body.density() * body.section() * body.length());
        let (peak, duration) = (5.0, 0.4e-3);
        let pulse = LoadCase::force(TimeFunction::Haversine { duration }, peak);
        // Thirds lie at the same part of a cell on all grids.
        let loaded: f64 = 1.0 / 3.0;
        let places = [0.0, 2.0 / 3.0, 0.5, 1.0];
        let port = |fraction: f64| Port::Point { body: 0, position: fraction * length };
        let sensors = places.map(port);
        let exact = |read: f64, t: f64| {
            let mut sum = [0.0; 3];
            for n in 0..400 {
                let k = PI * f64::from(n);
                let shapes = (k * loaded).cos() * (k * read).cos();
                let factor = if n == 0 { 1.0 } else { 2.0 } * shapes * peak / mass;
                let (w, o) = (k * body.wave_speed() / length, TAU / duration);
                // The haversine is a lasting one less that from its end on.
                let (on, off) = (lasting(w, o, t), lasting(w, o, t - duration));
                for i in 0..3 {
                    sum[i] += factor * (on[i] - off[i]);
                }
            }
            sum
        };
        // 1, 2 and 4 steps a sample, all at the Courant number 0.94.
        let sampling = Sampling::new(1e-3, 20.0 / 0.94 * body.wave_speed() / length).unwrap();
        let errors = [20.0, 40.0, 80.0].map(|cells| {
            let load = pulse.clone().at(port(loaded));
            let run = response(&structure, length / cells, &load, &sensors, &sampling);
            assert!(run.energy.residual_relative() < 1e-9);
            let mut errors = [0.0_f64; 3];
            for (&sensor, found) in places.iter().zip(&run.history.sensors) {
                let exact: Vec<_> = run.history.time.iter().map(|&t| exact(sensor, t)).collect();
                let column = |i: usize| exact.iter().map(|motion| motion[i]).collect::<Vec<_>>();
                let columns = [&found.displacement, &found.velocity, &found.acceleration];
                for (i, found) in columns.into_iter().enumerate() {
                    errors[i] = errors[i].max(difference(found, &column(i)));
                }
            }
            errors
        });
        let slopes = [0, 1].map(|n| (errors[n][0] / errors[n + 1][0]).log2());
        assert!(slopes.iter().all(|slope| (1.9..2.1).contains(slope)), "{errors:?}");
        // The curvature of the pulse jumps at its ends: derivatives have kinks, and lower orders.
        let [displacement, velocity, acceleration] = errors[2];
        assert!(displacement < 2e-7 && velocity < 2e-5 && acceleration < 3e-3, "{errors:?}");
    }

    /// One mass on a spring whose base moves, `x'' + w^2 x = -A sin(W t)`: the bar on a soft contact, and
    /// the bar with the mass of the support on a soft support.
    #[test]
    fn a_moving_base_drives_one_mass_on_a_spring() {
        let (amplitude, frequency) = (3.0, 40.0);
        let function = TimeFunction::Harmonic { frequency };
        let load = LoadCase::base_motion(BaseQuantity::Acceleration, function, amplitude).unwrap();
        let sampling = Sampling::new(0.05, 2e5).unwrap();
        let spring = 1e4;
        let support = Support::SpringMass { stiffness: spring, mass: 0.2, damping_ratio: 0.0 };
        let cases = [(bars(&[spring / 1e-4], Support::Rigid), 0.0), (bars(&[1e15], support), 0.2)];
        for (structure, more) in cases {
            let body = &structure.stack().bodies()[0];
            let mass = body.density() * body.section() * body.length() + more;
            let (w, o) = ((spring / mass).sqrt(), TAU * frequency);
            let run = response(&structure, 0.02, &load, &[Port::TOP], &sampling);
            let found = &run.history.sensors;
            let factor = -amplitude / (w * w - o * o);
            let exact = |of: &dyn Fn(f64) -> f64| -> Vec<f64> {
                run.history.time.iter().map(|&t| factor * of(t)).collect()
            };
            let displacement = exact(&|t| (o * t).sin() - o / w * (w * t).sin());
            let velocity = exact(&|t| o * ((o * t).cos() - (w * t).cos()));
            let off = difference(&found[0].displacement, &displacement);
            // Elasticity of the bar over the elasticity of the spring: 3e-4 of w^2.
            assert!(off < 1e-3, "{off}");
            assert!(difference(&found[0].velocity, &velocity) < 1e-3);
            assert!(run.energy.residual_relative() < 1e-6);
            assert!(run.energy.input > 0.0 && run.energy.stored() > 0.0);
        }
    }
}
