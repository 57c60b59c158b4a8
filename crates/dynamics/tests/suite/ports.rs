//! Loads and sensors away from the top, and a moving base.

use std::f64::consts::TAU;
use std::sync::Arc;

use asperity_dynamics::{FiniteDifference, Integrator, Modal, Sampling, Transient};
use asperity_law::{Constant, ContactLaw, Power};
use asperity_mesh::{Body, Interface, Port, Stack, Support};
use asperity_structure::{
    BaseQuantity, Damping, LoadCase, PreloadedStructure, SampledFunction, TimeFunction,
};

use crate::support::{AREA, difference, slope};

/// Numbers between 0 and 1 from a sequence of its own.
struct Sequence(u64);

impl Sequence {
    fn next(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }

    /// A point, often an end, of one of the bodies.
    fn port(&mut self, stack: &Stack) -> Port {
        let body = (self.next() * stack.bodies().len() as f64) as usize;
        let length = stack.bodies()[body].length();
        let position = match self.next() {
            part if part < 0.2 => 0.0,
            part if part < 0.4 => length,
            _ => length * self.between(0.05, 0.95),
        };
        Port::Point { body, position }
    }
}

/// One to three bars on linear or power laws, on a rigid or a compliant support.
fn random_structure(draw: &mut Sequence, linear: bool) -> PreloadedStructure {
    let count = 1 + (3.0 * draw.next()) as usize;
    let bodies: Vec<Body> = (0..count)
        .map(|i| {
            let (length, section) = (draw.between(0.05, 0.3), draw.between(2e-4, 2e-3));
            Body::new(&format!("body {i}"), length, section, 71e9, 2710.0).unwrap()
        })
        .collect();
    let contact = |i: usize, draw: &mut Sequence| {
        let stiffness = 10.0_f64.powf(draw.between(11.2, 12.3));
        let law: Arc<dyn ContactLaw> = if linear {
            Arc::new(Constant::new(stiffness).unwrap())
        } else {
            Arc::new(Power::new(stiffness / 100.0, 0.4, 0.0).unwrap())
        };
        Interface::new(&format!("contact {i}"), AREA, law).unwrap()
    };
    let contacts = (0..count).map(|i| contact(i, draw)).collect();
    let support = if draw.next() < 0.5 {
        Support::Rigid
    } else {
        let (stiffness, mass) = (draw.between(5e7, 3e8), draw.between(0.3, 3.0));
        Support::SpringMass { stiffness, mass, damping_ratio: draw.between(0.0, 0.1) }
    };
    let stack = Stack::new(bodies, contacts, support, 9.81).unwrap();
    PreloadedStructure::new(stack, Damping::Ratio(draw.between(0.02, 0.06))).unwrap()
}

/// A pulse about as long as a period of the lowest mode, of a part of the weight.
fn pulse(draw: &mut Sequence, structure: &PreloadedStructure) -> LoadCase {
    let period = 1.0 / structure.natural_frequency().unwrap();
    let weight: f64 = structure.stack().bodies().iter().map(|body| body.mass() * 9.81).sum();
    let rise = period * draw.between(0.2, 0.4);
    LoadCase::force(TimeFunction::GammaPulse { rise }, weight * draw.between(0.02, 0.3))
}

fn run(
    method: &Integrator,
    structure: &PreloadedStructure,
    load: &LoadCase,
    sensors: &[Port],
) -> Transient {
    let period = 1.0 / structure.natural_frequency().unwrap();
    let sampling = Sampling::new(6.0 * period, 200.0 / period).unwrap();
    method.integrate(structure, load, sensors, &sampling).unwrap()
}

/// On linear contacts load and sensor may be exchanged, by either integrator.
#[test]
fn exchange_of_load_and_sensor_leaves_the_response() {
    let mut draw = Sequence(7);
    for number in 0..12 {
        let structure = random_structure(&mut draw, true);
        let load = pulse(&mut draw, &structure);
        let [x, y] = [draw.port(structure.stack()), draw.port(structure.stack())];
        let step = Some(0.001 / structure.natural_frequency().unwrap());
        let modal = Modal { step, modes_per_body: Some(6), ..Modal::default() };
        // The modal engine interpolates loads and contact forces in different ways within a step.
        for (method, most) in
            [(Integrator::from(modal), 1e-7), (FiniteDifference::default().into(), 1e-9)]
        {
            let at = |from: Port, to: Port| run(&method, &structure, &load.clone().at(from), &[to]);
            let [one, other] = [at(x, y), at(y, x)];
            let moved = |run: &Transient| run.history.sensors[0].displacement.clone();
            let off = difference(&moved(&one), &moved(&other));
            assert!(off < most, "{number}, {}: {off:e}", method.name());
        }
    }
}

/// Both integrators on random structures with random places: forces at points, and motions of the base.
/// Displacements, velocities and pressures approach each other with the square of the cell.
#[test]
fn both_engines_agree_at_random_places() {
    let mut draw = Sequence(11);
    for number in 0..40 {
        let structure = random_structure(&mut draw, number % 4 == 0);
        let force = pulse(&mut draw, &structure);
        let load = if number % 3 == 0 {
            let rise = force.time_scale();
            let function = TimeFunction::GammaPulse { rise };
            let amplitude = draw.between(0.5, 2.0);
            LoadCase::base_motion(BaseQuantity::Acceleration, function, amplitude).unwrap()
        } else {
            force.at(draw.port(structure.stack()))
        };
        let sensors = [draw.port(structure.stack()), draw.port(structure.stack())];
        let period = 1.0 / structure.natural_frequency().unwrap();
        let modal =
            Modal { step: Some(1e-3 * period), modes_per_body: Some(40), ..Modal::default() };
        let exact = run(&modal.into(), &structure, &load, &sensors);
        let cells = [2e-3, 1e-3];
        let errors = cells.map(|cell| {
            let grid = FiniteDifference { cell, ..FiniteDifference::default() };
            let found = run(&grid.into(), &structure, &load, &sensors);
            let pairs = found.history.sensors.iter().zip(&exact.history.sensors);
            let moved = pairs.map(|(a, b)| {
                let velocity = difference(&a.velocity, &b.velocity);
                difference(&a.displacement, &b.displacement).max(velocity)
            });
            let pairs = found.history.interfaces.iter().zip(&exact.history.interfaces);
            let pressed = pairs.map(|(a, b)| difference(&a.pressure, &b.pressure));
            moved.chain(pressed).fold(0.0, f64::max)
        });
        let order = slope(&cells, &errors);
        let name = format!("{number}: {:?} {sensors:?}: {errors:?}, order {order}", load.port());
        assert!(errors[1] < 1e-2, "{name}");
        // The damping of the scheme is of first order in its step.
        assert!(errors[1] < 1e-3 || order > 0.7, "{name}");
    }
}

/// One mass on a spring under a moving base, however its motion is given: the closed form of
/// `x'' + h x' + w^2 x = -a(t)` in the steady state, relative and absolute.
#[test]
fn the_transmissibility_of_one_mass_is_its_closed_form() {
    let bar = Body::new("mass", 0.02, 5e-3, 1e13, 7800.0).unwrap();
    let (mass, spring) = (bar.mass(), 4e5);
    let law = Arc::new(Constant::new(spring / AREA).unwrap());
    let contact = Interface::new("spring", AREA, law).unwrap();
    let stack = Stack::new(vec![bar], vec![contact], Support::Rigid, 0.0).unwrap();
    let w = f64::sqrt(spring / mass);
    let rate = 0.2 * w;
    let structure = PreloadedStructure::new(stack, Damping::Rate(rate)).unwrap();
    for ratio in [0.3, 0.9, 1.0, 2.5] {
        let frequency = ratio * w / TAU;
        let o = TAU * frequency;
        let periods = 60.0;
        let sampling = Sampling::new(periods / frequency, 400.0 * frequency).unwrap();
        let acceleration = 3.0;
        let given = [
            (BaseQuantity::Acceleration, acceleration),
            (BaseQuantity::Velocity, acceleration / o),
            (BaseQuantity::Displacement, acceleration / (o * o)),
        ];
        for (quantity, amplitude) in given {
            let function = TimeFunction::Harmonic { frequency };
            let load = LoadCase::base_motion(quantity, function, amplitude).unwrap();
            let modal = Modal { step: Some(0.0025 / frequency), ..Modal::default() };
            let run = modal.integrate(&structure, &load, &[Port::TOP], &sampling).unwrap();
            let history = &run.history;
            // Complex amplitudes over the last period, from sums with sine and cosine.
            let from = history.time.len() - 400;
            let amplitude_of = |value: &dyn Fn(usize) -> f64| -> [f64; 2] {
                let mut sums = [0.0; 2];
                for n in from..history.time.len() {
                    let phase = o * history.time[n];
                    sums[0] += value(n) * phase.cos() / 200.0;
                    sums[1] -= value(n) * phase.sin() / 200.0;
                }
                sums
            };
            let divide = |[a, b]: [f64; 2], [c, d]: [f64; 2]| {
                let square = c * c + d * d;
                [(a * c + b * d) / square, (b * c - a * d) / square]
            };
            let base = amplitude_of(&|n| load.base_at(history.time[n])[2]);
            let relative = amplitude_of(&|n| history.sensors[0].displacement[n]);
            let absolute = amplitude_of(&|n| {
                history.sensors[0].acceleration[n] + load.base_at(history.time[n])[2]
            });
            let stiff = [w * w - o * o, rate * o];
            let expected = divide([-1.0, 0.0], stiff);
            let found = divide(relative, base);
            let size = expected[0].hypot(expected[1]);
            let off = (found[0] - expected[0]).hypot(found[1] - expected[1]) / size;
            assert!(off < 2e-5, "{quantity:?} at {ratio}: {off:e}");
            // `(w^2 + i h o) / (w^2 - o^2 + i h o)`
            let expected = divide([w * w, rate * o], stiff);
            let found = divide(absolute, base);
            let size = expected[0].hypot(expected[1]);
            let off = (found[0] - expected[0]).hypot(found[1] - expected[1]) / size;
            assert!(off < 1e-4, "absolute, {quantity:?} at {ratio}: {off:e}");
        }
    }
}

/// A sampled displacement of the base acts as the function that it was sampled from.
#[test]
fn a_sampled_displacement_acts_as_its_function() {
    let mut draw = Sequence(23);
    let structure = random_structure(&mut draw, false);
    let period = 1.0 / structure.natural_frequency().unwrap();
    let sine = TimeFunction::Harmonic { frequency: 0.7 / period };
    let amplitude = 2e-7;
    let sensor = [Port::TOP];
    let step = Some(1e-3 * period);
    let modal = Modal { step, modes_per_body: Some(6), ..Modal::default() }.into();
    let of = |function: TimeFunction, amplitude: f64| {
        let load = LoadCase::base_motion(BaseQuantity::Displacement, function, amplitude).unwrap();
        run(&modal, &structure, &load, &sensor).history.sensors[0].displacement.clone()
    };
    let exact = of(sine.clone(), amplitude);
    let intervals = [period / 20.0, period / 40.0];
    let errors = intervals.map(|interval| {
        let count = (7.0 * period / interval) as u32;
        let time: Vec<f64> = (0..count).map(|n| interval * f64::from(n)).collect();
        let value = time.iter().map(|&t| sine.value(t)).collect();
        let samples = SampledFunction::new(time, value).unwrap();
        difference(&of(TimeFunction::Samples(samples.into()), amplitude), &exact)
    });
    let order = slope(&intervals, &errors);
    assert!(errors[1] < 2e-3 && order > 1.8, "{errors:?}, order {order}");
}

/// A load at another port than the model's, and a sensor that there is not, are errors.
#[test]
fn ports_that_a_model_does_not_have_are_errors() {
    use asperity_dynamics::{Batch, DynamicsError, ModalModel, TransientCase};
    let mut draw = Sequence(3);
    let structure = random_structure(&mut draw, true);
    let counts = vec![2; structure.stack().bodies().len()];
    let model = ModalModel::of_stack(&structure, &counts, Port::TOP, &[Port::TOP]).unwrap();
    let model = Arc::new(model);
    let lower = Port::Point { body: 0, position: structure.stack().bodies()[0].length() };
    let hit = |port: Port, sensor: usize| TransientCase {
        model: Arc::clone(&model),
        load: LoadCase::force(TimeFunction::HalfSine { duration: 1e-3 }, 1.0).at(port),
        sensor,
        duration: 1e-3,
        step: None,
        tolerance: None,
    };
    let sampling = Sampling::new(1e-3, 1e5).unwrap();
    let of = |port, sensor| Batch::default().transient(&hit(port, sensor), &sampling).map(|_| ());
    assert_eq!(of(Port::TOP, 0), Ok(()));
    assert_eq!(of(lower, 0), Err(DynamicsError::LoadPort));
    assert_eq!(of(Port::TOP, 1), Err(DynamicsError::NoSensor { sensor: 1, sensors: 1 }));
    let beyond = Port::Point { body: 0, position: 99.0 };
    assert!(ModalModel::of_stack(&structure, &counts, beyond, &[]).is_err());
    let grid = FiniteDifference::default();
    let mean = LoadCase::none().at(Port::Mean { body: 0 });
    let refused = grid.integrate(&structure, &mean, &[], &sampling).unwrap_err();
    assert_eq!(refused, DynamicsError::PortOfGrid);
}
