//! Steps of a case's own, short where contact opens and closes: exact motions, waves, the equal steps of
//! the other kernel, energy.

use std::f64::consts::PI;
use std::sync::Arc;

use crate::contact_damping::closures;
use crate::damped_engines::{case, off};
use crate::support::half_spaces::{self, relative_norm, window};
use crate::support::{AREA, Law, damped, modified, power, pulse, rig, run_at, slope};
use asperity_dynamics::{
    Batch, CaseResponse, Decimation, DynamicsError, Modal, ParameterVariation, STENCIL, Sampling,
    Transient, TransientCase,
};
use asperity_law::{Constant, ContactDamping, Friction};
use asperity_mesh::{Body, Interface, Port, Stack, Support};
use asperity_structure::{Damping, LoadCase, PreloadedStructure, TimeFunction};

const MASS: f64 = 1.61;
const STIFFNESS: f64 = 8.5e11;
const GRAVITY: f64 = 9.81;

/// A pull of half a sine that takes the block off the ground \[N\], \[s\].
pub(crate) const PULL: f64 = 60.0;
pub(crate) const DURATION: f64 = 0.8e-3;

/// A block, rigid to rounding, on a unilateral spring.
pub(crate) fn block() -> Stack {
    let law: Law = Arc::new(Constant::unilateral(STIFFNESS).unwrap());
    let block = Body::with_mass("block", 0.05, MASS, 1e19, 2710.0).unwrap();
    let contact = Interface::new("ground", AREA, law).unwrap();
    Stack::new(vec![block], vec![contact], Support::Rigid, GRAVITY).unwrap()
}

/// Displacement of the block from rest and its velocity, `after` seconds of one regime from a state at
/// `time`: `m u'' = F(t) - k u` in contact, `F(t) + m g` apart. The force is `-PULL sin(pi t / DURATION)`
/// up to its end.
fn moved(time: f64, [u, v]: [f64; 2], after: f64, touches: bool) -> [f64; 2] {
    let spring = STIFFNESS * AREA / MASS;
    let (w, drive) = (spring.sqrt(), PI / DURATION);
    let amplitude = if time < DURATION { -PULL / MASS } else { 0.0 };
    let (phase, end) = (drive * time, drive * (time + after));
    if touches {
        let forced = amplitude / (spring - drive * drive);
        let (a, b) = (u - forced * phase.sin(), (v - forced * drive * phase.cos()) / w);
        let (sin, cos) = (w * after).sin_cos();
        let free = [a * cos + b * sin, w * (b * cos - a * sin)];
        return [free[0] + forced * end.sin(), free[1] + forced * drive * end.cos()];
    }
    let forced = -amplitude / (drive * drive);
    let (a, b) = (u - forced * phase.sin(), v - forced * drive * phase.cos());
    let fallen = [a + b * after + 0.5 * GRAVITY * after * after, b + GRAVITY * after];
    [fallen[0] + forced * end.sin(), fallen[1] + forced * drive * end.cos()]
}

/// Displacements at multiples of `interval`, and the time apart, by closed forms between events.
pub(crate) fn exact(interval: f64, count: usize) -> (Vec<f64>, f64) {
    let level = -MASS * GRAVITY / (STIFFNESS * AREA);
    let (mut state, mut apart, mut found) = ([0.0, 0.0], 0.0, vec![0.0]);
    for n in 1..=count {
        let (mut now, end) = ((n - 1) as f64 * interval, n as f64 * interval);
        while now < end {
            // The force ends at a regime's end; nothing turns twice in so short a time.
            let stop = if now < DURATION && end > DURATION { DURATION } else { end };
            let touches = state[0] > level || (state[0] == level && state[1] > 0.0);
            let is_past = |after: f64| {
                let [u, _] = moved(now, state, after, touches);
                if touches { u <= level } else { u >= level }
            };
            let mut after = stop - now;
            let crosses = is_past(after);
            if crosses {
                let (mut low, mut high) = (0.0, after);
                for _ in 0..60 {
                    let middle = 0.5 * (low + high);
                    if is_past(middle) { high = middle } else { low = middle }
                }
                after = high;
            }
            state = moved(now, state, after, touches);
            if crosses {
                state[0] = level;
            }
            apart += if touches { 0.0 } else { after };
            now = if crosses { now + after } else { stop };
        }
        found.push(state[0]);
    }
    found.pop();
    (found, apart)
}

/// A block that is pulled off its spring and falls back again and again: the displacement and the time
/// without contact tend to the closed form, of second order in the mean step or better.
#[test]
fn a_block_that_leaves_its_spring_moves_as_in_closed_form() {
    let force = LoadCase::force(TimeFunction::HalfSine { duration: DURATION }, -PULL);
    let (duration, rate) = (0.02, 2e4);
    let (expected, apart) = exact(1.0 / rate, (duration * rate) as usize);
    assert!(apart > 0.1 * duration && apart < 0.9 * duration);
    let (mut sizes, mut errors, mut of_time) = (Vec::new(), Vec::new(), Vec::new());
    for tolerance in [1e-4, 1e-5, 1e-6, 1e-7] {
        let method = Modal {
            step: Some(5e-5),
            modes_per_body: Some(1),
            tolerance: Some(tolerance),
            ..Modal::default()
        };
        let found = run_at(&block(), &method, 0.0, &force, (duration, rate));
        sizes.push(1.0 / found.steps as f64);
        errors.push(relative_norm(&found.history.sensors[0].displacement, &expected));
        of_time.push((found.contacts[0].lost - apart).abs() / apart);
    }
    let order = slope(&sizes, &errors);
    assert!(order > 1.9, "{order}: {errors:?} {sizes:?} {of_time:?}");
    assert!(errors[3] < 3e-5 && of_time[3] < 1e-7, "{errors:?} {of_time:?}");
}

/// `modes` of each body, at steps of their own of at most `step` \[s\].
fn variable(tolerance: f64, step: Option<f64>, modes: usize) -> Modal {
    let (tolerance, modes_per_body) = (Some(tolerance), Some(modes));
    Modal { step, modes_per_body, tolerance, ..Modal::default() }
}

/// While contact holds the tolerance falls with the sixth power of the mean step, and the response tends to the one at
/// the least tolerance.
#[test]
fn a_smooth_response_takes_steps_of_sixth_order() {
    let run = |tolerance: f64| {
        run_at(&rig(&power()), &variable(tolerance, Some(5e-6), 1), 0.0, &pulse(9.0), (4e-3, 1e4))
    };
    let tolerances: Vec<f64> = (0..8).map(|k| 4e-5 / 4.0_f64.powi(k)).collect();
    let found: Vec<Transient> = tolerances.iter().copied().map(run).collect();
    let exact = run(1e-10);
    assert!(exact.contacts.iter().all(|contact| contact.lost == 0.0));
    let sizes: Vec<f64> = found.iter().map(|one| 1.0 / one.steps as f64).collect();
    let order = slope(&sizes, &tolerances);
    let off = |found: &Transient| {
        let displacements = [found, &exact].map(|one| &one.history.sensors[0].displacement);
        relative_norm(displacements[0], displacements[1])
    };
    let errors = [&found[0], &found[7]].map(off);
    assert!(order > 5.0, "{order}: {sizes:?}");
    assert!(errors[1] < 1e-8 && errors[1] < 1e-2 * errors[0], "{errors:?}");
}

/// Waves across an interface that opens and closes, damped and not, against its own equation by the
/// classical method of fourth order.
#[test]
fn waves_across_an_interface_that_opens_follow_its_own_equation() {
    let p0 = 1.4e5;
    let unilateral: Law = Arc::new(Constant::unilateral(STIFFNESS).unwrap());
    let none = ContactDamping::kelvin_voigt(0.0).unwrap();
    let viscous = ContactDamping::kelvin_voigt(4e-6).unwrap();
    let by_pressure = ContactDamping::power(4e-6 * STIFFNESS, p0, 1.5).unwrap();
    for (name, law) in [("power", power()), ("modified", modified()), ("unilateral", unilateral)] {
        for damping in [none, viscous, by_pressure] {
            let stack = damped(&half_spaces::stack(&law, p0), damping);
            let d0 = law.closure(p0);
            let peak = -3.0 * p0;
            let errors = [(1e-4, 150), (1e-7, 300)].map(|(tolerance, modes)| {
                let method = variable(tolerance, None, modes);
                let (pulse, duration) = (half_spaces::pulse(peak), 3.0 * half_spaces::delay());
                let found = run_at(&stack, &method, 0.0, &pulse, (duration, 5e6));
                assert!(found.contacts[0].lost > 0.3 * half_spaces::PULSE, "{name}");
                let (times, samples) = window(&found);
                let expected = closures(&law, damping, peak, &times);
                let closure: Vec<f64> = samples.closure.iter().map(|c| c - d0).collect();
                relative_norm(&closure, &expected)
            });
            assert!(errors[1] < 3e-5, "{name} {damping:?}: {errors:?}");
        }
    }
}

/// Steps of their own and short equal steps agree on random rigs with damped contacts, every other one hit
/// three times as hard, and the balance of energy closes.
#[test]
fn steps_of_their_own_agree_with_short_equal_steps() {
    let (mut failures, mut opened, mut close) = (Vec::new(), 0, 0);
    for seed in 1..=40 {
        let mut case = case(seed);
        if seed % 2 == 0 {
            case.force = case.force.with_amplitude(3.0 * case.force.amplitude());
        }
        let of_equal_steps = Modal { tolerance: None, ..variable(1.0, Some(1e-7), 12) };
        let equal = case.run(of_equal_steps);
        // Where contact holds, the rest is at equal steps of this length.
        let found = case.run(variable(1e-7, Some(1e-6), 12));
        let opens = equal.contacts.iter().any(|contact| contact.lost > 0.0);
        opened += usize::from(opens);
        let apart = off(&found, &equal);
        close += usize::from(apart < 1e-4);
        let [own, other] =
            [&found, &equal].map(|run| run.energy.contact_dissipated / run.energy.input);
        let residual = found.energy.residual_relative();
        // Where faces meet the traction jumps, and equal steps are of first order. A light body on strong
        // dampers, of which its fast modes relax within a step, is off by up to 2e-3 of the loss.
        let bound = if opens { 4e-3 } else { 1e-3 };
        if !(apart < bound && residual < 2e-3 && (own - other).abs() < 3e-3) {
            failures.push(format!("{apart:.1e} {own} {other} {residual:.1e} {}", case.name));
        }
    }
    assert!(opened >= 8 && close >= 24, "{opened} open, {close} close");
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// Undamped bodies that bounce keep their energy, and lose none to modes that longer steps do not show.
#[test]
fn undamped_bodies_that_bounce_keep_their_energy() {
    let unilateral: Law = Arc::new(Constant::unilateral(1e12).unwrap());
    for law in [power(), modified(), unilateral] {
        let residuals = [1e-4, 1e-6].map(|tolerance| {
            let found =
                run_at(&rig(&law), &variable(tolerance, None, 10), 0.0, &pulse(60.0), (0.01, 1e5));
            assert!(found.contacts.iter().any(|contact| contact.lost > 1e-4));
            found.energy.residual_relative()
        });
        assert!(residuals[0] < 1e-3 && residuals[1] < 3e-5, "{residuals:?}");
    }
}

/// A case at steps of its own has the same response among others as alone, bit for bit.
#[test]
fn responses_at_steps_of_their_own_do_not_depend_on_other_cases() {
    let structure = PreloadedStructure::new(rig(&power()), Damping::Ratio(0.035)).unwrap();
    let sampling = Sampling::new(0.01, 2e5).unwrap();
    let case = |peak: f64, tolerance: Option<f64>| {
        let method = Modal { tolerance, ..variable(1e-5, None, 4) };
        method.case(&structure, &pulse(peak), &[Port::TOP], &sampling).unwrap()
    };
    let cases = [
        case(20.0, None),
        case(32.0, Some(1e-5)),
        case(32.0, None),
        case(40.0, Some(1e-6)),
        case(32.0, Some(1e-5)),
    ];
    let all_steps = Arc::new(Decimation { factor: 1, taps: Arc::new([1.0]), ending: 40 });
    let run = |cases: &[TransientCase]| {
        let found = Batch::default().run(cases, &|_, _| Arc::clone(&all_steps));
        let displacement = |one: CaseResponse| {
            assert_eq!(one.ending, one.displacement[one.steps - 40..]);
            one.displacement
        };
        found.into_iter().map(|one| displacement(one.unwrap())).collect::<Vec<_>>()
    };
    let together = run(&cases);
    for (case, found) in cases.iter().zip(&together) {
        assert_eq!(&run(std::slice::from_ref(case))[0], found);
    }
    assert_ne!(together[1], together[3]);
}

/// A case at steps of its own is differentiated at equal steps of a sixteenth.
#[test]
fn derivatives_are_of_short_equal_steps() {
    let structure = PreloadedStructure::new(rig(&power()), Damping::Ratio(0.035)).unwrap();
    let sampling = Sampling::new(4e-3, 2e5).unwrap();
    let case = |peak: f64, method: Modal| {
        method.case(&structure, &pulse(peak), &[Port::TOP], &sampling).unwrap()
    };
    let step = 1e-3;
    let derivative = |method: Modal| {
        let cases = STENCIL.map(|place| case(32.0 + place * step, method));
        let variation = ParameterVariation { cases, step };
        let found = Batch::default().sensitivity(&case(32.0, method), &[variation]).unwrap();
        assert!(found.values.contacts[0].pressure_min == 0.0);
        found.derivatives[0].displacement.clone()
    };
    let own = variable(1e-6, Some(1e-5), 4);
    let equal = Modal { step: Some(1e-5 / 16.0), tolerance: None, ..own };
    assert_eq!(derivative(own), derivative(equal));
}

/// Friction, and a tolerance that is none, are refused by name.
#[test]
fn cases_without_steps_of_their_own_are_refused() {
    let friction = Friction::slip_force(1e8, 2.0).unwrap();
    let smooth = rig(&power());
    let bodies = smooth.bodies().to_vec();
    let contacts = smooth.interfaces().iter().map(|one| one.clone().with_friction(friction));
    let rubbing = Stack::new(bodies, contacts.collect(), Support::Rigid, GRAVITY).unwrap();
    for (stack, tolerance) in [(rubbing, 1e-5), (rig(&power()), 0.0), (rig(&power()), f64::NAN)] {
        let structure = PreloadedStructure::new(stack, Damping::Ratio(0.035)).unwrap();
        let sampling = Sampling::new(0.01, 2e5).unwrap();
        let method = variable(tolerance, None, 4);
        let error =
            method.integrate(&structure, &pulse(32.0), &[Port::TOP], &sampling).unwrap_err();
        assert!(
            matches!(error, DynamicsError::Setting { quantity: "tolerance of steps", .. }),
            "{error}"
        );
    }
}
