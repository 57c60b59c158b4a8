//! Stability with friction: multipliers against differences of the integrated motion, the limit of an
//! element that sticks, and modes left out.

use std::f64::consts::TAU;
use std::sync::Arc;

use asperity_harmonic::{
    ContactSystem, Continuation, Floquet, FourierResolution, HarmonicSettings, LawEvaluation,
    PeriodicResponse, RigidMass, SpecialPointKind, trace,
};
use asperity_law::{Constant, Friction};
use asperity_mesh::{ComponentModes, NormalMode, PortPair, ResidualFlexibility};
use asperity_structure::{Damping, Guide, PreloadedContact, PreloadedStructure};
use faer::Mat;
use num_complex::Complex64;

use crate::rigs::{AREA, Law, MASS, PRESSURE, power, rate_on, reference_law};

const RATE: f64 = 200.0;

fn contact(law: &Law, friction: Option<Friction>) -> PreloadedContact {
    let contact = PreloadedContact::new("contact", AREA, Arc::clone(law), PRESSURE).unwrap();
    contact.with_friction(friction)
}

/// A rigid bar on a contact with `friction` across it.
fn mass_on(law: &Law, friction: Option<Friction>) -> ContactSystem {
    damped_mass_on(law, friction, RATE)
}

fn damped_mass_on(law: &Law, friction: Option<Friction>, rate: f64) -> ContactSystem {
    let mass = Arc::new(RigidMass::new(MASS, rate).unwrap());
    ContactSystem::new(mass, vec![contact(law, friction)], LawEvaluation::Exact).unwrap()
}

/// A rigid bar on a contact, in a guide with `friction`.
fn mass_in_guide(law: &Law, friction: Friction) -> ContactSystem {
    let mode = NormalMode::rigid(vec![MASS.sqrt().recip()]);
    of_modes(vec![mode], ResidualFlexibility::zero(1), vec![0], law, friction)
}

/// Modes loaded at port 0, with a contact at their last port and `guides`: friction is in the guides or
/// else across the contact.
fn of_modes(
    modes: Vec<NormalMode>,
    residual: ResidualFlexibility,
    guides: Vec<usize>,
    law: &Law,
    friction: Friction,
) -> ContactSystem {
    let own = guides.is_empty().then_some(friction);
    let pairs = vec![PortPair::on_ground(modes[0].ports.len() - 1)];
    let modes = ComponentModes::new(modes, residual, pairs, guides).unwrap();
    let guides = modes.guides().iter().map(|_| Guide::new("bar", friction, 0)).collect();
    let contacts = vec![contact(law, own)];
    let structure = PreloadedStructure::of_components(modes, contacts, Damping::Rate(RATE));
    let structure = structure.unwrap().with_guides(guides).unwrap();
    ContactSystem::of_structure(&structure, LawEvaluation::Exact).unwrap()
}

/// The response at a frequency \[Hz\] and a force \[N\], with its multipliers.
fn response(system: &ContactSystem, frequency: f64, force: f64) -> PeriodicResponse {
    let settings = HarmonicSettings {
        resolution: FourierResolution::Fixed { harmonics: 30, samples: 2048 },
        stability: Some(Floquet::default()),
        ..HarmonicSettings::default()
    };
    // Few points: stability is computed at each of them.
    let short = Continuation::Frequency { force, from: frequency, to: 1.0001 * frequency };
    let branch = trace(system, &short, &settings).unwrap();
    branch.points.first().unwrap().clone()
}

/// The bar on its contact by the classical method of fourth order, with the element's force as a clamp
/// over each step.
struct Mass<'a> {
    contact: PreloadedContact,
    friction: &'a Friction,
    w: f64,
    force: f64,
}

impl Mass<'_> {
    /// State (closure, velocity, force of the element) after whole periods of so many steps.
    fn after(&self, mut state: [f64; 3], periods: usize, steps: usize) -> [f64; 3] {
        let step = TAU / (self.w * steps as f64);
        for _ in 0..periods {
            for number in 0..steps {
                let begin = state;
                let element = |x: f64| {
                    let carried = AREA * self.contact.pressure_at(x);
                    let limit = self.friction.limit(carried);
                    self.friction.force(begin[2], x - begin[0], limit)
                };
                let slope = |share: f64, x: f64, v: f64| {
                    let angle = TAU * (number as f64 + share) / steps as f64;
                    let carried = AREA * (self.contact.pressure_at(x) - PRESSURE);
                    (v, (self.force * angle.cos() - carried - element(x)) / MASS - RATE * v)
                };
                let (x, v) = (state[0], state[1]);
                let a = slope(0.0, x, v);
                let b = slope(0.5, x + 0.5 * step * a.0, v + 0.5 * step * a.1);
                let c = slope(0.5, x + 0.5 * step * b.0, v + 0.5 * step * b.1);
                let d = slope(1.0, x + step * c.0, v + step * c.1);
                let mean =
                    |a: f64, b: f64, c: f64, d: f64| step * (a + 2.0 * b + 2.0 * c + d) / 6.0;
                let end = x + mean(a.0, b.0, c.0, d.0);
                state = [end, v + mean(a.1, b.1, c.1, d.1), element(end)];
            }
        }
        state
    }
}

fn largest_first(mut multipliers: Vec<Complex64>) -> Vec<Complex64> {
    multipliers.sort_by(|a, b| (b.norm(), b.im).partial_cmp(&(a.norm(), a.im)).unwrap());
    multipliers
}

/// Multipliers of a bar with friction across its contact or in its guide, slipping at a slip force or at
/// a share of the contact's force, against differences of the period's map of (closure, velocity,
/// element's force).
#[test]
fn multipliers_are_those_of_the_map_of_a_period() {
    let linear: Law = Arc::new(Constant::new(7e11).unwrap());
    let slip = Friction::slip_force(2e7, 0.4).unwrap();
    let share = Friction::coefficient(2e7, 0.01).unwrap();
    let cases = [
        ("slip force, linear", mass_on(&linear, Some(slip)), &linear, slip, 1100.0),
        ("slip force", mass_on(&power(), Some(slip)), &power(), slip, 1200.0),
        ("share across the contact", mass_on(&power(), Some(share)), &power(), share, 1200.0),
        ("share in the guide", mass_in_guide(&power(), share), &power(), share, 1200.0),
    ];
    for (name, system, law, friction, frequency) in cases {
        let force = 4.0;
        let found = response(&system, frequency, force);
        let w = found.angular_frequency;
        let mass = Mass { contact: contact(law, None), friction: &friction, w, force };
        let [x, slope, _] = found.closure_at(0, 0.0);
        let start = mass.after([x, w * slope, 0.0], 250, 2000);
        assert!((start[0] / found.amplitude(1) - x / found.amplitude(1)).abs() < 1e-4, "{name}");
        let steps = 20_000;
        let start = mass.after(start, 20, steps);
        let sizes = [found.amplitude(1), w * found.amplitude(1), 0.4];
        let shift = 1e-5;
        let map = Mat::from_fn(3, 3, |row, column| {
            let moved = |sign: f64| {
                let mut state = start;
                state[column] += sign * shift * sizes[column];
                mass.after(state, 1, steps)[row]
            };
            (moved(1.0) - moved(-1.0)) / (2.0 * shift * sizes[row])
        });
        let expected = largest_first(map.eigenvalues().unwrap());
        let multipliers = largest_first(found.multipliers.clone().unwrap());
        assert_eq!(multipliers.len(), 3, "{name}");
        for (a, b) in multipliers.iter().zip(&expected) {
            assert!((a - b).norm() < 1e-3, "{name}: {multipliers:?} {expected:?}");
        }
        // The element slips in each period: what its slider was is forgotten.
        assert!(multipliers[2].norm() < 1e-9, "{name}: {multipliers:?}");
        // Friction matters: without it both lie on the circle of radius exp(-h T / 2).
        let circle = (-0.5 * RATE * TAU / w).exp();
        assert!((multipliers[0].norm() / circle - 1.0).abs() > 1e-2, "{name}: {multipliers:?}");
    }
}

/// An element that never slips is a spring, and has no multiplier.
#[test]
fn a_stuck_element_is_a_spring() {
    let (stiffness, k) = (7e11, 2e7);
    let linear: Law = Arc::new(Constant::new(stiffness).unwrap());
    let stiffer: Law = Arc::new(Constant::new(stiffness + k / AREA).unwrap());
    let stuck = Friction::slip_force(k, 1e3).unwrap();
    let expected = response(&mass_on(&stiffer, None), 1100.0, 1.0);
    for system in [mass_on(&linear, Some(stuck)), mass_in_guide(&linear, stuck)] {
        let found = response(&system, 1100.0, 1.0);
        assert!((found.amplitude(1) / expected.amplitude(1) - 1.0).abs() < 1e-9);
        let multipliers = largest_first(found.multipliers.unwrap());
        let expected = largest_first(expected.multipliers.clone().unwrap());
        assert_eq!(multipliers.len(), 2);
        for (a, b) in multipliers.iter().zip(&expected) {
            assert!((a - b).norm() < 1e-7, "{a} {b}");
        }
    }
}

/// Modes left out as a flexibility against the same as a fast mode, under friction that slips at a share
/// of the contact's force.
#[test]
fn left_out_modes_are_in_series_with_friction() {
    let law = power();
    let shape = MASS.sqrt().recip();
    let friction = Friction::coefficient(2e7, 0.01).unwrap();
    let (flexibility, fast) = (4e-9_f64, 3e5);
    // Ports: the bar, which is loaded and guided, and the contact.
    for guided in [false, true] {
        let rigid = NormalMode::rigid(vec![shape, shape]);
        let elastic = NormalMode::elastic(fast, vec![0.0, fast * flexibility.sqrt()]);
        let none = ResidualFlexibility::zero(2);
        let mut residual = none.clone();
        residual.add(&elastic);
        let guides = if guided { vec![0] } else { vec![] };
        let [kept, left_out] =
            [(vec![rigid.clone(), elastic], none), (vec![rigid], residual)].map(|(modes, left)| {
                let system = of_modes(modes, left, guides.clone(), &law, friction);
                largest_first(response(&system, 1050.0, 4.0).multipliers.unwrap())
            });
        // Of the fast mode's own pair there is nothing in the other.
        let circle = (-0.5 * RATE / 1050.0).exp();
        for multiplier in left_out.iter().filter(|multiplier| multiplier.norm() > 1e-9) {
            let nearest = kept.iter().map(|other| (other - multiplier).norm());
            let nearest = nearest.fold(f64::INFINITY, f64::min);
            assert!(nearest < 2e-3, "guided {guided}: {nearest:.1e}, {kept:?} {left_out:?}");
            assert!((multiplier.norm() / circle - 1.0).abs() > 5e-3, "{left_out:?}");
        }
    }
}

/// Folds of a branch that loses contact, with friction: a multiplier passes one there, and the part
/// between them is unstable.
#[test]
fn a_branch_with_friction_is_unstable_between_its_folds() {
    let friction = Friction::slip_force(1e6, 0.02).unwrap();
    let law = reference_law();
    let system = damped_mass_on(&law, Some(friction), rate_on(&law));
    let settings = HarmonicSettings {
        resolution: FourierResolution::Fixed { harmonics: 7, samples: 512 },
        stability: Some(Floquet::default()),
        ..HarmonicSettings::default()
    };
    let falling = Continuation::Frequency { force: 1.8, from: 1000.0, to: 750.0 };
    let branch = trace(&system, &falling, &settings).unwrap();
    assert!(branch.is_complete(), "{:?}", branch.termination);
    let folds: Vec<_> =
        branch.special.iter().filter(|point| point.kind == SpecialPointKind::Fold).collect();
    assert_eq!(folds.len(), 2, "{:?}", branch.special);
    for fold in &folds {
        let largest = fold.response.multipliers.as_ref().unwrap()[0];
        assert!((largest - 1.0).norm() < 2e-2, "{largest}");
    }
    let between = folds[0].after + 1..=folds[1].after;
    for (number, point) in branch.points.iter().enumerate() {
        // Next to a fold few harmonics leave the multiplier on either side of one.
        if folds.iter().any(|fold| number.abs_diff(fold.after) <= 1) {
            continue;
        }
        assert_eq!(point.stable(), Some(!between.contains(&number)), "point {number}");
    }
    assert!(between.count() > 5);
    // Slipping elements have a multiplier of zero, that of the slider.
    assert!(branch.points.iter().any(|point| point.multipliers.as_ref().unwrap().len() == 3));
}
