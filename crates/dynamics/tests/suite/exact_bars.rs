//! Bars driven and read along them, and on a moving base, against closed forms; reciprocity.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use crate::support::difference;
use asperity_dynamics::{FiniteDifference, Integrator, Modal, Sampling, Transient};
use asperity_law::Constant;
use asperity_mesh::{Body, Interface, Port, Stack, Support};
use asperity_structure::{BaseQuantity, Damping, LoadCase, PreloadedStructure, TimeFunction};

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

/// Force and sensor may be exchanged: within a body and across contacts, at nodes, between nodes and
/// at ends. By finite differences to rounding; by modal steps to their own error, which falls with the fourth power of
/// the step for displacements and with the second for velocities and accelerations.
#[test]
fn exchange_of_force_and_sensor_leaves_the_response() {
    let support = Support::SpringMass { stiffness: 2e8, mass: 0.5, damping_ratio: 0.05 };
    let structure = bars(&[8.5e11, 3e11], support);
    let pulse = LoadCase::force(TimeFunction::GammaPulse { rise: 0.1e-3 }, 9.0);
    let sampling = Sampling::new(2e-3, 2e5).unwrap();
    let pairs = [((0, 0.0), (1, 1.0)), ((0, 0.3142), (0, 0.9)), ((0, 0.5), (1, 0.7321))];
    let exchanged = |integrator: &Integrator, pair: ((usize, f64), (usize, f64))| {
        let place = |(body, fraction): (usize, f64)| Port::Point { body, position: 0.2 * fraction };
        let (x, y) = (place(pair.0), place(pair.1));
        let at = |loaded, read| {
            let load = pulse.clone().at(loaded);
            let run = integrator.integrate(&structure, &load, &[read], &sampling).unwrap();
            run.history.sensors[0].clone()
        };
        let (one, other) = (at(x, y), at(y, x));
        [
            difference(&one.displacement, &other.displacement),
            difference(&one.velocity, &other.velocity),
            difference(&one.acceleration, &other.acceleration),
        ]
    };
    let differences = FiniteDifference { cell: 2e-3, ..FiniteDifference::default() }.into();
    let modes = |step: f64| Modal { step: Some(step), ..Modal::default() }.into();
    for pair in pairs {
        // Accelerations are two differences of displacements over dt^2.
        let found = exchanged(&differences, pair);
        assert!(found.iter().zip([1e-11, 1e-10, 1e-8]).all(|(a, b)| *a < b), "{pair:?} {found:?}");
        let [coarse, fine] = [1e-6, 0.5e-6].map(|step| exchanged(&modes(step), pair));
        assert!(fine[0] < 2e-10, "{pair:?} {fine:?}");
        for (i, order) in [4.0, 2.0, 2.0].into_iter().enumerate() {
            let slope = (coarse[i] / fine[i]).log2();
            assert!((slope - order).abs() < 0.1, "{pair:?} {coarse:?} {fine:?}");
        }
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
