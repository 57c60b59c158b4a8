//! The two integrators against each other: finite differences whose cells shrink tend to modal
//! steps, over bodies, laws, supports, excitations and dampings.

use std::sync::atomic::{AtomicBool, Ordering};

use crate::support::{AREA, DISC, Law, difference, every_law, power, pulse, rig, run_at};
use asperity_dynamics::{DynamicsError, FiniteDifference, Integrator, Modal, Sampling, Transient};
use asperity_mesh::{Body, Interface, Port, Stack, Support};
use asperity_structure::{Damping, LoadCase, PreloadedStructure, SampledFunction, TimeFunction};

struct Scenario {
    name: &'static str,
    stack: Stack,
    excitation: LoadCase,
    damping: Damping,
    duration: f64,
    /// True if some contact is lost.
    opens: bool,
}

fn law(name: &str) -> Law {
    every_law().into_iter().find(|(known, _)| *known == name).unwrap().1
}

/// The first bodies of a guide bar, a sample and a steel plate, on as many laws of
/// [`every_law`]; of one body only the bar.
fn stack(laws: &[&str], support: Support) -> Stack {
    let bodies = vec![
        Body::with_mass("guide bar", 0.229, 1.61, 71e9, 2710.0).unwrap(),
        Body::new("sample", 0.015, AREA, 71e9, 2710.0).unwrap(),
        Body::new("plate", 0.04, 5e-4, 210e9, 7800.0).unwrap(),
    ];
    let bodies = bodies.into_iter().take(laws.len()).collect();
    let contact = |name: &&str| Interface::new(name, AREA, law(name)).unwrap();
    Stack::new(bodies, laws.iter().map(contact).collect(), support, 9.81).unwrap()
}

/// A crooked record: two strokes and a pull.
fn record() -> LoadCase {
    let time = (0..=24).map(|n| 1e-4 * f64::from(n)).collect();
    let force = (0..=24).map(|n| {
        let s = f64::from(n) / 24.0;
        60.0 * s * (1.0 - s) * (0.3 + (19.0 * s).sin())
    });
    LoadCase::samples(&SampledFunction::new(time, force.collect()).unwrap())
}

/// Name, laws, support, excitation, damping, and whether a contact is lost.
type Case = (&'static str, &'static [&'static str], Support, LoadCase, Damping, bool);

fn scenarios() -> Vec<Scenario> {
    const RIGID: Support = Support::Rigid;
    let ratio = Damping::Ratio(0.035);
    let half = |peak| LoadCase::force(TimeFunction::HalfSine { duration: 0.8e-3 }, peak);
    let haversine = |peak, duration| LoadCase::force(TimeFunction::Haversine { duration }, peak);
    let harmonic =
        |amplitude, frequency| LoadCase::force(TimeFunction::Harmonic { frequency }, amplitude);
    let none = Damping::Rate(0.0);
    let cases: Vec<Case> = vec![
        ("one, thrown", &["unilateral constant"], RIGID, pulse(60.0), ratio, true),
        ("one, disc", &["hyperbolic"], DISC, half(12.0), ratio, false),
        ("one, pulled", &["exponential"], RIGID, half(-20.0), Damping::Rate(200.0), false),
        ("linear", &["constant", "constant"], RIGID, haversine(20.0, 4e-4), none, false),
        ("power 0.35", &["power, m = 0.35"; 2], RIGID, pulse(32.0), ratio, true),
        ("power 1", &["power, m = 1"; 2], RIGID, haversine(20.0, 1e-3), none, false),
        ("power 1.5", &["power, m = 1.5"; 2], DISC, pulse(10.0), ratio, false),
        ("modified", &["modified"; 2], DISC, pulse(32.0), Damping::Rate(500.0), false),
        ("modified, thrown", &["modified"; 2], RIGID, pulse(120.0), ratio, true),
        ("exponential", &["exponential"; 2], RIGID, harmonic(6.0, 700.0), ratio, false),
        ("table", &["table"; 2], RIGID, record(), ratio, false),
        ("in series", &["in series"; 2], RIGID, haversine(60.0, 1e-4), ratio, false),
        ("impact", &["hyperbolic"; 2], DISC, haversine(40.0, 6e-5), none, false),
        ("mixed", &["modified", "in series"], DISC, harmonic(4.0, 450.0), none, false),
        ("pulled off", &["power, m = 0.35", "table"], RIGID, half(-14.0), ratio, true),
        ("three", &["modified", "table", "power, m = 0.35"], RIGID, pulse(8.0), ratio, false),
        ("three, disc", &["exponential", "hyperbolic", "modified"], DISC, record(), ratio, false),
        (
            "three, thrown",
            &["unilateral constant", "in series", "power, m = 1"],
            RIGID,
            pulse(50.0),
            Damping::Rate(300.0),
            true,
        ),
    ];
    let scenario = |(name, laws, support, excitation, damping, opens)| Scenario {
        name,
        stack: stack(laws, support),
        excitation,
        damping,
        // Bodies that bounce forget their past within some milliseconds.
        duration: if opens { 2.5e-3 } else { 5e-3 },
        opens,
    };
    cases.into_iter().map(scenario).collect()
}

impl Scenario {
    fn run(&self, method: &(impl Into<asperity_dynamics::Integrator> + Copy)) -> Transient {
        let structure = PreloadedStructure::new(self.stack.clone(), self.damping).unwrap();
        let rate = structure.damping_rate();
        run_at(&self.stack, method, rate, &self.excitation, (self.duration, 2e5))
    }
}

/// Largest differences of displacement, pressures and closures, each over the largest motion
/// of its kind, and of the lowest and highest pressures over the swing of pressure.
fn differences(found: &Transient, expected: &Transient) -> [f64; 4] {
    let gained = |column: &[f64]| column.iter().map(|x| x - column[0]).collect::<Vec<_>>();
    let mut offs = [0.0_f64; 4];
    let mut raise = |k: usize, off: f64| offs[k] = if off > offs[k] { off } else { offs[k] };
    raise(
        0,
        difference(
            &found.history.sensors[0].displacement,
            &expected.history.sensors[0].displacement,
        ),
    );
    let pairs = found.history.interfaces.iter().zip(&expected.history.interfaces);
    for (a, b) in pairs {
        raise(1, difference(&gained(&a.pressure), &gained(&b.pressure)));
        raise(2, difference(&gained(&a.closure), &gained(&b.closure)));
    }
    for (a, b) in found.contacts.iter().zip(&expected.contacts) {
        let swing = b.pressure_max - b.pressure_min;
        raise(3, (a.pressure_max - b.pressure_max).abs() / swing);
        raise(3, (a.pressure_min - b.pressure_min).abs() / swing);
    }
    offs
}

/// Bounds of the differences at 0.5 mm and of the default step, in the order of `differences`.
///
/// Without loss of contact, found at most: finite differences 1.7e-4 of the displacement and 3e-4
/// of pressures and closures (they are of first order by the one-sided damping of Eq. 2), under an
/// impact of 60 us 1.2e-3; the default step 5e-4, and 4e-3 of pressures and closures, under pulses
/// of 0.1 ms and less 1e-2 to 4e-2: what it rings the sample at lies beyond its band. Bounces
/// magnify every difference that came before them: 1.3e-4 and 7e-4; 3.2e-3 and 9e-2.
const SMOOTH: [[f64; 4]; 2] = [[3e-4, 2e-3, 2e-3, 2e-4], [1e-3, 5e-2, 5e-2, 5e-3]];
const BOUNCING: [[f64; 4]; 2] = [[1e-3, 1e-2, 1e-2, 1e-3], [1e-2, 1e-1, 1e-1, 1e-2]];

/// Difference below which the tables of the laws show, held to 1e-6 of the static pressure, and not the grid.
const TABLES: f64 = 1e-6;

#[test]
fn finite_differences_tend_to_modal_steps() {
    let mut failures = Vec::new();
    for scenario in scenarios() {
        let fine = Modal { step: Some(2e-7), modes_per_body: Some(30), ..Modal::default() };
        let fine = scenario.run(&fine);
        let of = |cell: f64| {
            let found = scenario.run(&FiniteDifference { cell, ..FiniteDifference::default() });
            differences(&found, &fine)
        };
        let [coarse, finest] = [of(4e-3), of(0.5e-3)];
        let default = scenario.run(&Modal::default());
        let off = differences(&default, &fine);
        let lost: f64 = fine.contacts.iter().map(|contact| contact.lost).sum();
        assert_eq!(lost > 0.0, scenario.opens, "{}", scenario.name);
        let [finest_bound, default_bound] = if scenario.opens { BOUNCING } else { SMOOTH };
        for k in 0..4 {
            let shrinks = finest[k] < 0.7 * coarse[k] || coarse[k].max(finest[k]) < TABLES;
            if !(shrinks && finest[k] < finest_bound[k] && off[k] < default_bound[k]) {
                failures.push((scenario.name, k, coarse[k], finest[k], off[k]));
            }
        }
    }
    assert!(failures.is_empty(), "{failures:#?}");
}

/// A run whose flag is set at the first report of its progress ends before the second.
#[test]
fn finite_differences_stop_within_some_samples() {
    let stack = rig(&power());
    let structure = PreloadedStructure::new(stack, Damping::Ratio(0.035)).unwrap();
    let sampling = Sampling::new(1.0, 2e5).unwrap();
    let stop = AtomicBool::new(false);
    let method = Integrator::from(FiniteDifference::default());
    let stride = method.outline(&structure, &pulse(20.0), &sampling).unwrap().steps / 200_000;
    let at_once = |_: f64| stop.store(true, Ordering::Relaxed);
    let found =
        method.integrate_unless(&structure, &pulse(20.0), &[Port::TOP], &sampling, &stop, &at_once);
    let Err(DynamicsError::Stopped { steps }) = found else { panic!("{found:?}") };
    assert_eq!(steps, 64 * stride);
}
