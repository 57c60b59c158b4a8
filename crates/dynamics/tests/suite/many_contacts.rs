//! Steps with many contacts: against the vector kernel on the same modes, a closed form of a block that
//! leaves its spring, and a patch whose cells open one after the other.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use crate::support::half_spaces::relative_norm;
use crate::support::{DISC, damped, every_law, pulse, rig, slope, three_bodies};
use crate::variable_steps::{DURATION, PULL, block, exact};
use asperity_dynamics::{
    Batch, DynamicsError, ManyContacts, ModalModel, Sampling, Transient, TransientCase,
};
use asperity_law::{ContactDamping, ContactLaw, Power};
use asperity_mesh::{ComponentModes, NormalMode, Port, PortPair, ResidualFlexibility, Stack};
use asperity_structure::{
    Damping, LoadCase, PreloadedStructure, TimeFunction, UnloadedContact, contacts_at_rest,
};

fn reduced(stack: &Stack, modes: usize) -> Arc<PreloadedStructure<ComponentModes>> {
    let structure = PreloadedStructure::new(stack.clone(), Damping::Rate(352.0)).unwrap();
    let counts = vec![modes; stack.bodies().len()];
    Arc::new(structure.reduced_to(&counts, &[Port::TOP]).unwrap())
}

/// The response by short equal steps of the vector kernel.
fn by_the_vector_kernel(
    structure: &PreloadedStructure<ComponentModes>,
    peak: f64,
    sampling: &Sampling,
) -> Transient {
    let case = TransientCase {
        model: Arc::new(ModalModel::new(structure.clone(), 0, &[0]).unwrap()),
        load: pulse(peak),
        sensor: 0,
        duration: sampling.interval() * sampling.samples() as f64,
        step: Some(2.5e-7),
        tolerance: None,
    };
    Batch::default().transient(&case, sampling).unwrap()
}

/// Every law, contact held and lost, against the kernel. Steps are of second order; light bodies that leave their
/// contacts and fall back need the shortest.
#[test]
fn bars_move_as_by_the_vector_kernel() {
    let sampling = Sampling::new(4e-3, 2e5).unwrap();
    for (name, law) in every_law() {
        for stack in [rig(&law), three_bodies(DISC)] {
            for peak in [9.0, 60.0] {
                let structure = reduced(&stack, 6);
                let system = ManyContacts::new(Arc::clone(&structure), 0, vec![0]).unwrap();
                let found = system.integrate(&pulse(peak), &sampling, 64).unwrap();
                let expected = by_the_vector_kernel(&structure, peak, &sampling);
                let pairs = found.history.interfaces.iter().zip(&expected.history.interfaces);
                for (own, other) in pairs {
                    let off = relative_norm(&own.closure, &other.closure);
                    let lost = expected.contacts.iter().any(|one| one.lost > 0.0);
                    let bound = if lost { 1.5e-2 } else { 3e-4 };
                    assert!(off < bound, "{name} {peak} N: closure {off:e}");
                }
                let [own, other] =
                    [&found, &expected].map(|run| &run.history.sensors[0].displacement);
                let off = relative_norm(own, other);
                assert!(off < 1e-3, "{name} {peak} N: displacement {off:e}");
                for (own, other) in found.contacts.iter().zip(&expected.contacts) {
                    let scale = other.pressure_max;
                    assert!((own.pressure_max - other.pressure_max).abs() < 3e-3 * scale, "{name}");
                    assert!(
                        (own.lost - other.lost).abs() < 2e-5,
                        "{name} {} {}",
                        own.lost,
                        other.lost
                    );
                }
                assert!(found.energy.residual_relative() < 2e-3, "{name} {:?}", found.energy);
            }
        }
    }
}

/// A block that is pulled off its spring and falls back again and again: of second order.
#[test]
fn a_block_that_leaves_its_spring_moves_as_in_closed_form() {
    let force = LoadCase::force(TimeFunction::HalfSine { duration: DURATION }, -PULL);
    let (duration, rate) = (0.02, 2e4);
    let (expected, apart) = exact(1.0 / rate, (duration * rate) as usize);
    let structure = PreloadedStructure::new(block(), Damping::Rate(0.0)).unwrap();
    let structure = Arc::new(structure.reduced_to(&[1], &[Port::TOP]).unwrap());
    let system = ManyContacts::new(structure, 0, vec![0]).unwrap();
    let sampling = Sampling::new(duration, rate).unwrap();
    let (mut sizes, mut errors, mut of_time) = (Vec::new(), Vec::new(), Vec::new());
    for parts in [8, 16, 32, 64, 128] {
        let found = system.integrate(&force, &sampling, parts).unwrap();
        sizes.push(found.step);
        errors.push(relative_norm(&found.history.sensors[0].displacement, &expected));
        of_time.push((found.contacts[0].lost - apart).abs() / apart);
    }
    let order = slope(&sizes, &errors);
    assert!(order > 1.8, "{order}: {errors:?} {of_time:?}");
    assert!(errors[4] < 1e-3 && of_time[4] < 1e-3, "{errors:?} {of_time:?}");
}

/// A rigid block of 2 kg on a row of `count` cells that hold it under a load off its centre, the outer
/// ones apart at first.
fn patch(count: usize, damping: Option<ContactDamping>) -> ManyContacts {
    let (mass, length): (f64, f64) = (2.0, 0.1);
    let inertia = mass * length * length / 12.0;
    let place = |i: usize| length * ((i as f64 + 0.5) / count as f64 - 0.5);
    let at = |x: f64| (mass.sqrt().recip(), x / inertia.sqrt());
    let mut places: Vec<f64> = (0..count).map(place).collect();
    places.push(0.01);
    let mode = |turn: bool| {
        let part = |&x: &f64| if turn { at(x).1 } else { at(x).0 };
        NormalMode::rigid(places.iter().map(part).collect())
    };
    let pairs = (0..count).map(PortPair::on_ground).collect();
    let residual = ResidualFlexibility::zero(count + 1);
    let modes =
        ComponentModes::new(vec![mode(false), mode(true)], residual, pairs, vec![]).unwrap();
    let law: Arc<dyn ContactLaw> = Arc::new(Power::new(1e8, 0.5, 0.0).unwrap());
    let contact = |i: usize| UnloadedContact {
        name: format!("{i}"),
        area: 1e-3 / count as f64,
        law: Arc::clone(&law),
        gap: 1e-5 * (2.0 * place(i) / length).powi(2),
        damping,
    };
    let contacts: Vec<UnloadedContact> = (0..count).map(contact).collect();
    let at_rest = contacts_at_rest(&modes, &contacts, &[(count, 60.0)]).unwrap();
    assert!(at_rest.iter().any(|one| one.gap() > 0.0), "all closed");
    let structure = PreloadedStructure::of_components(modes, at_rest, Damping::Rate(40.0)).unwrap();
    ManyContacts::new(Arc::new(structure), count, vec![count]).unwrap()
}

/// Two cells under one end of a spring of 100 N/m with a block on its other end: they take up a slow force at their end
/// between them. Without contact forces that end moves by 1e5 times as much as the cells close, so that the equations of the
/// contacts are solved to rounding alone.
#[test]
fn stiff_contacts_of_a_soft_structure_take_up_the_load() {
    let (flexibility, force) = (1e-2, 0.02);
    let local = |a: usize, b: usize| if a == b && a < 2 { 1e-12 } else { 0.0 };
    let row = |a: usize| (0..3).map(|b| flexibility + local(a, b)).collect();
    let residual = ResidualFlexibility::from_rows(&[row(0), row(1), row(2)]).unwrap();
    let pairs = [0, 1].map(PortPair::on_ground).to_vec();
    let block = NormalMode::rigid(vec![1.0; 3]);
    let modes = ComponentModes::new(vec![block], residual, pairs, vec![]).unwrap();
    let law: Arc<dyn ContactLaw> = Arc::new(Power::new(1e9, 0.5, 0.0).unwrap());
    let contact = |i: usize| UnloadedContact {
        name: format!("{i}"),
        area: 1e-4,
        law: Arc::clone(&law),
        gap: 0.0,
        damping: None,
    };
    let at_rest = contacts_at_rest(&modes, &[0, 1].map(contact), &[(2, 100.0)]).unwrap();
    let stiffness = at_rest[0].stiffness() * at_rest[0].area();
    let structure = PreloadedStructure::of_components(modes, at_rest, Damping::Rate(0.0)).unwrap();
    let system = ManyContacts::new(Arc::new(structure), 2, vec![2]).unwrap();
    let load = TimeFunction::Harmonic { frequency: 150.0 };
    let sampling = Sampling::new(0.0185, 1e4).unwrap();
    let found = system.integrate(&LoadCase::force(load, force), &sampling, 4).unwrap();
    for cell in &found.history.interfaces {
        let half = 0.5 * force / stiffness;
        let of_load = |load: &f64| 0.5 * load / stiffness;
        let pairs = cell.closure.iter().zip(found.history.load.iter().map(of_load));
        let off = pairs.map(|(closure, own)| (closure - cell.closure[0] - own).abs());
        let off = off.fold(0.0, f64::max);
        assert!(off < 1e-3 * half, "{off:e} of {half:e}");
    }
}

/// Against the explicit classical method of fourth order on the same equations, without and with damping of the
/// contacts.
#[test]
fn cells_open_and_close_as_by_an_explicit_method() {
    let kelvin_voigt = ContactDamping::kelvin_voigt(2e-5).unwrap();
    let power = ContactDamping::power(4e6, 1e5, 0.8).unwrap();
    for damping in [None, Some(kelvin_voigt), Some(power)] {
        against_the_explicit_method(damping);
    }
}

fn against_the_explicit_method(damping: Option<ContactDamping>) {
    let count = 60;
    let system = patch(count, damping);
    let hit = LoadCase::force(TimeFunction::Haversine { duration: 1e-3 }, -150.0);
    let sampling = Sampling::new(5e-3, 1e5).unwrap();
    let structure = system.structure();
    let modes = structure.component_modes().modes();
    let acceleration = |time: f64, q: [f64; 2], v: [f64; 2]| {
        let mut force = [0, 1].map(|m| modes[m].ports[count] * hit.value(time) - 40.0 * v[m]);
        for (i, contact) in structure.contacts().iter().enumerate() {
            let x = modes[0].ports[i] * q[0] + modes[1].ports[i] * q[1];
            let rate = modes[0].ports[i] * v[0] + modes[1].ports[i] * v[1];
            let pressure = contact.pressure_at(x);
            let stiffness = contact.law().stiffness(pressure);
            let damper = damping.filter(|_| pressure > 0.0);
            let damper = damper.map_or(0.0, |damping| damping.coefficient(pressure, stiffness));
            let traction = (pressure + damper * rate).max(0.0);
            let carried = contact.area() * (traction - contact.pressure());
            for m in 0..2 {
                force[m] -= modes[m].ports[i] * carried;
            }
        }
        force
    };
    let fine = 40;
    let h = 1e-5 / f64::from(fine);
    let (mut q, mut v, mut expected) = ([0.0; 2], [0.0; 2], vec![0.0]);
    for n in 0..(sampling.samples() - 1) * fine as usize {
        let time = n as f64 * h;
        let (mut dq, mut dv) = ([0.0; 2], [0.0; 2]);
        let (mut kq, mut kv) = ([0.0; 2], [0.0; 2]);
        for (share, weight) in [(0.0, 1.0), (0.5, 2.0), (0.5, 2.0), (1.0, 1.0)] {
            let at = [0, 1].map(|m| q[m] + share * h * kq[m]);
            let speed = [0, 1].map(|m| v[m] + share * h * kv[m]);
            kv = acceleration(time + share * h, at, speed);
            kq = speed;
            for m in 0..2 {
                dq[m] += weight * kq[m] * h / 6.0;
                dv[m] += weight * kv[m] * h / 6.0;
            }
        }
        for m in 0..2 {
            q[m] += dq[m];
            v[m] += dv[m];
        }
        if (n + 1) % fine as usize == 0 {
            expected.push(modes[0].ports[count] * q[0] + modes[1].ports[count] * q[1]);
        }
    }
    let errors: Vec<f64> = [2, 4, 8, 16]
        .iter()
        .map(|&parts| {
            let found = system.integrate(&hit, &sampling, parts).unwrap();
            let lost = found.contacts.iter().filter(|one| one.lost > 0.0).count();
            assert!(lost > 10 && found.contacts.iter().any(|one| one.lost < 5e-3));
            let energy = found.energy;
            assert!(parts < 16 || energy.residual_relative() < 1e-3, "{damping:?} {energy:?}");
            relative_norm(&found.history.sensors[0].displacement, &expected)
        })
        .collect();
    let order = slope(&[0.5, 0.25, 0.125, 0.0625], &errors);
    assert!(order > 1.8 && errors[3] < 1e-4, "{damping:?} {order}: {errors:?}");
}

/// Damped contacts against the kernel, contact held and lost.
#[test]
fn damped_bars_move_as_by_the_vector_kernel() {
    let sampling = Sampling::new(4e-3, 2e5).unwrap();
    let dampings = [
        ContactDamping::kelvin_voigt(4e-6).unwrap(),
        ContactDamping::power(3.4e6, 1.4e5, 0.0).unwrap(),
        ContactDamping::power(3.4e6, 1.4e5, 1.5).unwrap(),
    ];
    let laws = every_law();
    let chosen = ["unilateral constant", "power, m = 0.35", "exponential", "hyperbolic"];
    for (name, law) in laws.iter().filter(|(name, _)| chosen.contains(name)) {
        for damping in dampings {
            for peak in [9.0, 60.0] {
                let structure = reduced(&damped(&rig(law), damping), 6);
                let system = ManyContacts::new(Arc::clone(&structure), 0, vec![0]).unwrap();
                let found = system.integrate(&pulse(peak), &sampling, 64).unwrap();
                let expected = by_the_vector_kernel(&structure, peak, &sampling);
                let name = format!("{name} {damping:?} {peak} N");
                let lost = expected.contacts.iter().any(|one| one.lost > 0.0);
                let [own, other] =
                    [&found, &expected].map(|run| &run.history.sensors[0].displacement);
                let off = relative_norm(own, other);
                assert!(off < if lost { 3e-4 } else { 5e-6 }, "{name}: displacement {off:e}");
                let pairs = found.history.interfaces.iter().zip(&expected.history.interfaces);
                for (own, other) in pairs {
                    let off = relative_norm(&own.pressure, &other.pressure);
                    assert!(off < if lost { 5e-3 } else { 5e-6 }, "{name}: pressure {off:e}");
                }
                for (own, other) in found.contacts.iter().zip(&expected.contacts) {
                    assert!((own.pressure_max / other.pressure_max - 1.0).abs() < 1e-5, "{name}");
                    assert!((own.lost - other.lost).abs() < 2e-5, "{name}");
                }
                let loss = found.energy.dissipated / expected.energy.dissipated - 1.0;
                assert!(loss.abs() < 3e-4, "{name}: loss {loss:e}");
                assert!(found.energy.residual_relative() < 1e-6, "{name} {:?}", found.energy);
            }
        }
    }
}

/// The vector kernel does not take contacts that are open at rest, and says so.
#[test]
fn open_contacts_are_refused_by_the_vector_kernel() {
    let system = patch(8, None);
    let error = ModalModel::new(system.structure().clone(), 8, &[8]).unwrap_err();
    assert!(matches!(error, DynamicsError::OpenAtRest { .. }), "{error}");
}

/// A run that is stopped ends before its next sample.
#[test]
fn a_stopped_run_takes_no_steps() {
    let system = ManyContacts::new(reduced(&rig(&every_law()[0].1), 4), 0, vec![0]).unwrap();
    let sampling = Sampling::new(4e-3, 2e5).unwrap();
    let found = system.integrate_unless(&pulse(9.0), &sampling, 4, &AtomicBool::new(true));
    assert!(matches!(found, Err(DynamicsError::Stopped { steps: 0 })), "{found:?}");
}
