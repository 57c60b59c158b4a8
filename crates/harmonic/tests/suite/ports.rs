//! Loads and sensors at any port: closed forms, reciprocity, component modes against exact bars.

use std::f64::consts::TAU;
use std::sync::Arc;

use asperity_dynamics::{Modal, Sampling};
use asperity_harmonic::{
    CondensedStack, ContactSystem, Continuation, Drive, HarmonicError, LawEvaluation, SineResponse,
    SteppedSineSolver, SystemPort,
};
use asperity_law::{Constant, ContactDamping, Friction};
use asperity_mesh::{
    Body, BodyDamping, ComponentModes, Interface, ModeCount, NormalMode, Port, PortPair,
    ResidualFlexibility, Stack, Support,
};
use asperity_structure::{Damping, LoadCase, PreloadedContact, PreloadedStructure, TimeFunction};
use num_complex::Complex64;

use crate::rigs::{AREA, Law, MASS, branch, power, preloaded, rig};

/// Numbers from a linear congruence.
struct Random(u64);

impl Random {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn below(&mut self, count: usize) -> usize {
        self.between(0.0, count as f64) as usize
    }

    /// One to four bars on contacts of `law`, on a rigid or a sprung support with or without a damper.
    fn stack(&mut self, law: &Law, damped: bool) -> Stack {
        let count = 1 + self.below(4);
        let bar = |random: &mut Self| {
            let (length, mass) = (random.between(0.03, 0.2), random.between(0.2, 1.6));
            Body::with_mass("bar", length, mass, 71e9, 2710.0).unwrap()
        };
        let bodies: Vec<Body> = (0..count).map(|_| bar(self)).collect();
        let contact = Interface::new("contact", AREA, Arc::clone(law)).unwrap();
        let support = if self.below(2) == 0 {
            Support::Rigid
        } else {
            let damping_ratio = if damped { self.between(0.0, 0.05) } else { 0.0 };
            let (stiffness, mass) = (self.between(1e8, 1e9), self.between(0.3, 3.0));
            Support::SpringMass { stiffness, mass, damping_ratio }
        };
        Stack::new(bodies, vec![contact; count], support, 9.81).unwrap()
    }

    /// A port that moves.
    fn port(&mut self, stack: &Stack) -> Port {
        let body = self.below(stack.bodies().len());
        let length = stack.bodies()[body].length();
        let sprung = *stack.support() != Support::Rigid;
        match self.below(8) {
            0 => Port::Mean { body },
            1 => Port::Base,
            2 if sprung => Port::Support,
            3 => Port::Point { body, position: 0.0 },
            4 => Port::Point { body, position: length },
            _ => Port::Point { body, position: self.between(0.0, length) },
        }
    }
}

fn constant(stiffness: f64) -> Law {
    Arc::new(Constant::new(stiffness).unwrap())
}

fn system(structure: &PreloadedStructure, load: Port, sensors: &[Port]) -> ContactSystem {
    let system = ContactSystem::of_structure(structure, LawEvaluation::Exact).unwrap();
    system.with_ports(load, sensors).unwrap()
}

fn reduced(structure: &PreloadedStructure, count: usize, ports: &[Port]) -> ContactSystem {
    let modes = structure.reduced(ModeCount::PerBody(count), ports).unwrap();
    let system = ContactSystem::of_structure(&modes, LawEvaluation::Exact).unwrap();
    system.with_ports(0, &(1..ports.len()).collect::<Vec<_>>()).unwrap()
}

fn response(system: &ContactSystem, harmonics: usize, drive: Drive) -> SineResponse {
    SteppedSineSolver::new(system, harmonics).sweep(&[drive]).remove(0).unwrap()
}

/// Displacement of each sensor per unit load, the contacts being linear.
fn receptances(system: &ContactSystem, frequency_hz: f64) -> Vec<Complex64> {
    let found = response(system, 1, Drive { frequency_hz, force: 1.0 });
    found.sensors.iter().map(|sensor| sensor.displacement(1)).collect()
}

/// A bar on a spring, loaded at x and read at y: with `R = E A m kappa`,
/// `cos(kappa x<) (R cos(kappa (L - x>)) + K sin(kappa (L - x>))) / (R (K cos(th) - R sin(th)))`. The mean
/// is `(1 - K u(L) / F) / (-m s)` for `s = w^2 - i w h`, from the balance of the whole bar.
#[test]
fn a_bar_on_a_spring_loaded_at_x_and_read_at_y_has_its_closed_form() {
    let (law, h, time) = (constant(8.5e11), 90.0, 2e-7);
    let contact = Interface::new("contact", AREA, law).unwrap();
    let guide = Body::with_mass("guide bar", 0.229, MASS, 71e9, 2710.0).unwrap();
    for damping in [BodyDamping::NONE, BodyDamping::kelvin_voigt(time).unwrap()] {
        let body = guide.clone().with_damping(damping);
        let length = body.length();
        let bodies = vec![body.clone()];
        let stack = Stack::new(bodies, vec![contact.clone()], Support::Rigid, 9.81).unwrap();
        let structure = preloaded(stack, h);
        let places = [0.0, 0.01, 0.5 * length, 0.17, length];
        for x in places {
            let at = |position| Port::Point { body: 0, position };
            let mut sensors = places.map(at).to_vec();
            sensors.push(Port::Mean { body: 0 });
            let system = system(&structure, at(x), &sensors);
            for frequency in [3.0, 900.0, 7000.0, 11_180.0, 52_000.0] {
                let w = TAU * frequency;
                let s = Complex64::new(w * w, -w * h);
                let m = Complex64::new(1.0, damping.loss(w));
                let kappa = (s / m).sqrt() / body.wave_speed();
                let (r, k, th) = (m * kappa * body.axial_rigidity(), AREA * 8.5e11, kappa * length);
                let exact = |y: f64| {
                    let below = kappa * (length - x.max(y));
                    let scale = r * (k * th.cos() - r * th.sin());
                    (kappa * x.min(y)).cos() * (r * below.cos() + k * below.sin()) / scale
                };
                let found = receptances(&system, frequency);
                let mut expected = places.map(exact).to_vec();
                expected.push((Complex64::ONE - k * exact(length)) / (-body.mass() * s));
                let scale = expected.iter().map(|u| u.norm()).fold(0.0, f64::max);
                for (found, expected) in found.iter().zip(&expected) {
                    let off = (found - expected).norm();
                    assert!(off < 1e-9 * scale, "{frequency} Hz, {x}: {found} {expected}");
                }
            }
        }
    }
}

/// The load and the sensor change places on random linear structures, exact and in component modes.
#[test]
fn load_and_sensor_may_change_places() {
    let mut random = Random(11);
    for _ in 0..20 {
        let law = constant(random.between(2e11, 9e11));
        let stack = random.stack(&law, true);
        let damping = BodyDamping::loss_factor(random.between(0.0, 0.02)).unwrap();
        let structure = preloaded(stack.with_body_damping(damping), random.between(0.0, 500.0));
        let [a, b] = [(); 2].map(|()| random.port(structure.stack()));
        let frequency = random.between(0.2, 8.0) * structure.natural_frequency().unwrap();
        let there = receptances(&system(&structure, a, &[b]), frequency)[0];
        let back = receptances(&system(&structure, b, &[a]), frequency)[0];
        assert!((there - back).norm() < 1e-9 * there.norm(), "{a:?} {b:?}: {there} {back}");
        let there = receptances(&reduced(&structure, 3, &[a, b]), frequency)[0];
        let back = receptances(&reduced(&structure, 3, &[b, a]), frequency)[0];
        assert!((there - back).norm() < 1e-9 * there.norm(), "{a:?} {b:?}: {there} {back}");
    }
}

/// Motion in space of the sensors per acceleration of the base.
fn transmitted(system: &ContactSystem, frequency_hz: f64) -> Vec<Complex64> {
    let force = 0.7;
    let found = response(system, 1, Drive { frequency_hz, force });
    let of = |sensor: asperity_harmonic::PortMotion| sensor.absolute(force).acceleration(1) / force;
    found.sensors.into_iter().map(of).collect()
}

/// Transmissibility of a mass on a damped contact, `(k + i w c) / (k - w^2 m + i w c)`, as a mode and as a
/// rigid bar; and of that bar on a damped support, two masses on damped springs.
#[test]
fn a_moving_base_transmits_as_in_closed_form() {
    let (k, time) = (8.5e11 * AREA, 3e-6);
    let damping = ContactDamping::kelvin_voigt(time).unwrap();
    let contact = PreloadedContact::new("contact", AREA, constant(8.5e11), 1.37e5).unwrap();
    let contact = contact.with_damping(Some(damping));
    // The base, and the mass.
    let mode = NormalMode::rigid(vec![-MASS.sqrt(), MASS.sqrt().recip()]);
    let (none, pairs) = (ResidualFlexibility::zero(2), vec![PortPair::on_ground(1)]);
    let modes = ComponentModes::new(vec![mode], none, pairs, vec![]).unwrap();
    let mass = PreloadedStructure::of_components(modes, vec![contact], Damping::Rate(0.0)).unwrap();
    let mass = ContactSystem::of_structure(&mass, LawEvaluation::Exact).unwrap();
    let mass = mass.with_ports(0, &[1]).unwrap();

    let bar = |support| {
        let body = Body::with_mass("block", 0.05, MASS, 71e25, 2710.0).unwrap();
        let contact = Interface::new("contact", AREA, constant(8.5e11)).unwrap();
        let contact = contact.with_damping(damping);
        let structure =
            preloaded(Stack::new(vec![body], vec![contact], support, 9.81).unwrap(), 0.0);
        let sensors = [Port::TOP, Port::Mean { body: 0 }, Port::Support];
        system(&structure, Port::Base, &sensors)
    };
    let (below, disc) = (3e8, 2.5);
    let support = Support::SpringMass { stiffness: below, mass: disc, damping_ratio: 0.03 };
    let damper = support.damping();
    let (on_rigid, on_sprung) = (bar(Support::Rigid), bar(support));
    for frequency in [50.0, 700.0, 1155.0, 1160.0, 1900.0, 6000.0] {
        let w = TAU * frequency;
        let spring = Complex64::new(k, w * k * time);
        let exact = spring / (spring - w * w * MASS);
        let near = |found: Complex64, exact: Complex64| {
            assert!((found / exact - 1.0).norm() < 1e-9, "{frequency}: {found} {exact}");
        };
        near(transmitted(&mass, frequency)[0], exact);
        let found = transmitted(&on_rigid, frequency);
        near(found[0], exact);
        near(found[1], exact);
        near(found[2], Complex64::ONE);
        // The support moves by `Z z_0 / (Z - w^2 disc + carried)`, and the bar by `exact` of it.
        let base = Complex64::new(below, w * damper);
        let carried = -w * w * MASS * exact;
        let expected = base / (base - w * w * disc + carried);
        let found = transmitted(&on_sprung, frequency);
        near(found[2], expected);
        near(found[0], expected * exact);
    }
}

/// Component modes with many modes are the exact bars between random ports, ratios of modes included.
#[test]
fn many_modes_are_the_exact_bars_at_random_ports() {
    let mut random = Random(5);
    for number in 0..20 {
        let ratios = number % 2 == 0;
        let law = constant(random.between(2e11, 9e11));
        let stack = random.stack(&law, !ratios);
        let structure = preloaded(stack, random.between(50.0, 500.0));
        let structure = if ratios {
            structure.with_modal_damping(&[0.03, 0.01], 0.02).unwrap()
        } else {
            structure
        };
        let ports: Vec<Port> = (0..5).map(|_| random.port(structure.stack())).collect();
        let exact = system(&structure, ports[0], &ports[1..]);
        let modes = reduced(&structure, 150, &ports);
        let natural = structure.natural_frequency().unwrap();
        for frequency in [0.3, 0.99, 2.0, 4.0].map(|share| share * natural) {
            let expected = receptances(&exact, frequency);
            let found = receptances(&modes, frequency);
            for (port, (found, expected)) in ports[1..].iter().zip(found.iter().zip(&expected)) {
                let off = (found - expected).norm() / expected.norm();
                assert!(off < 1e-6, "{number}, {frequency} Hz: {:?} {port:?} {off:.1e}", ports[0]);
            }
        }
    }
}

/// Random stacks on power laws, with friction in guides in every other one: means and two harmonics
/// of random sensors under a load at a random port.
#[test]
fn nonlinear_responses_at_random_ports_are_those_of_component_modes() {
    let mut random = Random(3);
    for number in 0..30 {
        let mut stack = random.stack(&power(), true);
        if number % 2 == 0 {
            let friction = Friction::slip_force(random.between(5e6, 2e7), 0.1).unwrap();
            let mut bodies = stack.bodies().to_vec();
            let place = random.below(bodies.len());
            bodies[place] = bodies[place].clone().with_friction(friction);
            let contacts = stack.interfaces().to_vec();
            stack = Stack::new(bodies, contacts, *stack.support(), 9.81).unwrap();
        }
        let structure = preloaded(stack, 300.0);
        let ports: Vec<Port> = (0..4).map(|_| random.port(structure.stack())).collect();
        let weight: f64 = structure.stack().bodies().iter().map(|body| 9.81 * body.mass()).sum();
        let force = if ports[0] == Port::Base { 0.6 } else { 0.06 * weight };
        let frequency_hz = 0.93 * structure.natural_frequency().unwrap();
        let drive = Drive { frequency_hz, force };
        let [exact, modes] =
            [system(&structure, ports[0], &ports[1..]), reduced(&structure, 60, &ports)]
                .map(|system| response(&system, 7, drive).sensors);
        for (port, (exact, modes)) in ports[1..].iter().zip(exact.iter().zip(&modes)) {
            let scale = exact.displacement(1).norm();
            let off = [
                (exact.displacement(1) - modes.displacement(1)).norm(),
                (exact.displacement(2) - modes.displacement(2)).norm(),
                (exact.mean - modes.mean).abs(),
            ];
            let most = off.into_iter().fold(0.0, f64::max);
            assert!(most < 1e-7 * scale, "{number}: {:?} {port:?} {off:?} of {scale:e}", ports[0]);
            let harmonic = exact.displacement(2).norm();
            assert!(harmonic > 1e-4 * scale, "{number} {port:?}: {harmonic:e} of {scale:e}");
        }
    }
}

/// Without ports the load and the one sensor are at the top; the branch of a load there is the same.
/// Random structures on power laws under forces and base accelerations at random places against the
/// modal engine in time: fundamental and second harmonic of displacement at random sensors.
#[test]
fn steady_responses_at_random_places_meet_the_integration_in_time() {
    let mut random = Random(41);
    for number in 0..40 {
        let structure = preloaded(random.stack(&power(), true), 0.0);
        let natural = structure.natural_frequency().unwrap();
        let rate = 2.0 * 0.06 * TAU * natural;
        let structure = preloaded(structure.stack().clone(), rate);
        let point = |random: &mut Random| {
            let body = random.below(structure.stack().bodies().len());
            let length = structure.stack().bodies()[body].length();
            Port::Point { body, position: random.between(0.0, length) }
        };
        let load = if number % 3 == 0 { Port::Base } else { point(&mut random) };
        let sensors = [point(&mut random), point(&mut random)];
        let masses = structure.stack().bodies().iter().map(Body::mass);
        let mass = masses.sum::<f64>();
        let frequency_hz = random.between(0.6, 1.3) * natural;
        let weight = 0.01 * random.between(0.3, 1.0) * mass * 9.81;
        let amplitude = if load == Port::Base { weight / mass } else { weight };
        let system = system(&structure, load, &sensors);
        let found = response(&system, 7, Drive { frequency_hz, force: amplitude });
        // 80 periods leave exp(-2 pi 0.06 80 / 1.3) of the transient; the last is evaluated.
        let (periods, samples) = (120_usize, 64_usize);
        let sampling =
            Sampling::new(periods as f64 / frequency_hz, samples as f64 * frequency_hz).unwrap();
        let function = TimeFunction::Harmonic { frequency: frequency_hz };
        let shaker = LoadCase::force(function, amplitude).at(load);
        let step = Some(1.0 / (256.0 * frequency_hz.max(natural)));
        let modal = Modal { step, modes_per_body: Some(12), ..Modal::default() };
        let run = modal.integrate(&structure, &shaker, &sensors, &sampling).unwrap();
        for (steady, moved) in found.sensors.iter().zip(&run.history.sensors) {
            let last = &moved.displacement[(periods - 1) * samples..];
            for (k, tolerance) in [(1, 2e-3), (2, 2e-2)] {
                let sum: Complex64 = last
                    .iter()
                    .enumerate()
                    .map(|(n, u)| {
                        let phase = -TAU * k as f64 * n as f64 / samples as f64;
                        2.0 / samples as f64 * u * Complex64::from_polar(1.0, phase)
                    })
                    .sum();
                let (amplitude, scale) =
                    (steady.displacement(k).norm(), steady.displacement(1).norm());
                let off = (sum.norm() - amplitude).abs();
                let name = format!("{number}, {load:?}, harmonic {k}");
                assert!(
                    off < tolerance * amplitude + 1e-5 * scale,
                    "{name}: {amplitude:e} {:e}",
                    sum.norm()
                );
            }
        }
    }
}

#[test]
fn ports_not_given_are_at_the_top() {
    let structure = preloaded(rig(&power(), Support::Rigid), 400.0);
    let plain = ContactSystem::of_structure(&structure, LawEvaluation::Exact).unwrap();
    let given = system(&structure, Port::TOP, &[Port::Mean { body: 0 }, Port::TOP]);
    let sweep = Continuation::Frequency { force: 0.5, from: 850.0, to: 1000.0 };
    let [plain, given] = [plain, given].map(|system| branch(&system, sweep, (5, 64)));
    assert_eq!(plain.points.len(), given.points.len());
    for (a, b) in plain.points.iter().zip(&given.points) {
        assert_eq!(a.displacement, b.displacement);
        assert_eq!(a.sensors.len(), 1);
        for (sensor, k) in [(&a.sensors[0], 1), (&b.sensors[1], 1), (&b.sensors[1], 5)] {
            let expected = a.displacement[k - 1];
            assert!((sensor.displacement(k) - expected).norm() < 1e-12 * a.amplitude(1));
            assert!((sensor.mean - a.mean_displacement).abs() < 1e-12 * a.amplitude(1));
        }
        let (sensor, w) = (&a.sensors[0], a.angular_frequency);
        let turn = Complex64::new(0.0, 2.0 * w);
        assert_eq!(sensor.velocity(2), sensor.displacement(2) * turn);
        assert!((sensor.acceleration(2) / (sensor.velocity(2) * turn) - 1.0).norm() < 1e-14);
        assert_eq!(sensor.displacement(6), Complex64::ZERO);
    }
}

/// A load on the support of a condensed rig is one on that of the whole rig, to the inertia left out.
#[test]
fn ports_of_a_condensed_stack_are_those_of_the_whole_stack() {
    let disc = Support::SpringMass { stiffness: 4e8, mass: 12.0, damping_ratio: 0.02 };
    let guide = Body::with_mass("guide bar", 0.229, MASS, 71e9, 2710.0).unwrap();
    let sample = Body::new("sample", 0.015, AREA, 71e9, 27.1).unwrap();
    let foot = Body::with_mass("foot", 0.1, 0.7, 71e9, 2710.0).unwrap();
    let contact = Interface::new("contact", AREA, power()).unwrap();
    let stack = Stack::new(vec![guide, sample, foot], vec![contact; 3], disc, 9.81).unwrap();
    let structure = preloaded(stack, 400.0);
    let ports = [Port::Support, Port::Point { body: 2, position: 0.03 }, Port::Mean { body: 0 }];
    let condensed = CondensedStack::new(&structure, &[1], LawEvaluation::Exact).unwrap();
    let refused = condensed.clone().with_ports(Port::Mean { body: 1 }, &[]).unwrap_err();
    assert_eq!(refused, HarmonicError::NotCondensable { body: 1 });
    let condensed = condensed.with_ports(ports[0], &ports[1..]).unwrap();
    let whole = system(&structure, ports[0], &ports[1..]);
    let drive = Drive { frequency_hz: 500.0, force: 2.0 };
    let [a, b] = [&whole, condensed.system()].map(|system| response(system, 5, drive).sensors);
    for (a, b) in a.iter().zip(&b) {
        let off = (a.displacement(1) / b.displacement(1) - 1.0).norm();
        assert!(off < 1e-4, "{off:.1e}");
    }
}

#[test]
fn ports_that_do_not_exist_are_errors() {
    let structure = preloaded(rig(&power(), Support::Rigid), 400.0);
    let bars = ContactSystem::of_structure(&structure, LawEvaluation::Exact).unwrap();
    let error = bars.clone().with_ports(Port::Mean { body: 2 }, &[]).unwrap_err();
    assert!(matches!(error, HarmonicError::Structure(_)), "{error}");
    let error = bars.with_ports(0, &[]).unwrap_err();
    assert_eq!(error, HarmonicError::ForeignPort { port: SystemPort::Number(0) });
    let modes = structure.reduced(ModeCount::PerBody(2), &[Port::TOP]).unwrap();
    let modes = ContactSystem::of_structure(&modes, LawEvaluation::Exact).unwrap();
    let error = modes.clone().with_ports(0, &[4]).unwrap_err();
    assert!(matches!(error, HarmonicError::Structure(_)), "{error}");
    let error = modes.with_ports(Port::TOP, &[]).unwrap_err();
    assert!(matches!(error, HarmonicError::ForeignPort { .. }), "{error}");
}
