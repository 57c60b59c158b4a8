//! Both integrations against each other and against exact results, on random motions.

use std::sync::Arc;

use asperity_law::{ContactDamping, Power};
use asperity_mesh::{Body, Interface, Stack, Support};
use asperity_structure::{Damping, PreloadedContact, PreloadedStructure};
use faer::Mat;
use num_complex::Complex64;

use super::eigenvalues;
use super::period::{Period, largest};
use super::runge_kutta::{PLACES, RungeKutta};
use super::splitting::{self, Splitting};
use super::variational_equation::VariationalEquation;
use crate::many_contacts_tests::{Block, responses};
use crate::{ContactSystem, Floquet, LawEvaluation};

/// A structure of one to three bodies with a motion of three harmonics.
struct Case {
    system: ContactSystem,
    variation: VariationalEquation,
    springs: Vec<f64>,
    closures: Vec<f64>,
    rate: f64,
    w: f64,
}

/// Numbers in [0, 1) from a linear congruence.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }
}

impl Case {
    fn random(seed: u64, elastic_modes: usize) -> Self {
        let mut random = Random(seed);
        let (area, count) = (1.15e-4, 1 + (seed % 3) as usize);
        let law = Arc::new(Power::new(random.between(1e10, 3e10), 0.35, 0.0).unwrap());
        let mut bodies = Vec::new();
        for _ in 0..count {
            let (length, mass) = (random.between(0.05, 0.25), random.between(0.1, 2.0));
            bodies.push(Body::with_mass("bar", length, mass, 71e9, 2710.0).unwrap());
        }
        let contact = |_: &Body| Interface::new("contact", area, law.clone()).unwrap();
        let contacts = bodies.iter().map(contact).collect();
        let stack = Stack::new(bodies, contacts, Support::Rigid, 9.81).unwrap();
        Self::of(stack, elastic_modes, &mut random)
    }

    /// A stack with a motion of three harmonics.
    fn of(stack: Stack, elastic_modes: usize, random: &mut Random) -> Self {
        let count = stack.bodies().len();
        let rate = random.between(0.0, 800.0);
        let structure = PreloadedStructure::new(stack, Damping::Rate(rate)).unwrap();
        let system = ContactSystem::of_structure(&structure, LawEvaluation::Exact).unwrap();
        let springs: Vec<f64> = system.contacts().iter().map(PreloadedContact::spring).collect();
        let modes = system.linear().lowest_modes(count + elastic_modes).unwrap();
        let variation = VariationalEquation::new(&modes, rate, &springs);
        let mut closures = Vec::new();
        for contact in system.contacts() {
            // Contacts stay closed: the amplitudes add up to less than the closure at rest, p0 / K
            // at least.
            let most = contact.pressure() / contact.stiffness();
            closures.push(random.between(0.0, 0.1) * most);
            for k in 1..=3 {
                let size = 0.3 * most / f64::from(k * k);
                closures.extend([random.between(-size, size), random.between(-size, size)]);
            }
        }
        let w = random.between(0.4, 1.6) * structure.natural_frequency().unwrap();
        Self { system, variation, springs, closures, rate, w: w * std::f64::consts::TAU }
    }

    fn splitting(&mut self, steps: usize) -> Mat<f64> {
        let mut splitting = Splitting::new(&mut self.variation, &self.springs).unwrap();
        let mut period = Period::new(&splitting::PLACES);
        period.sample(&self.system, &self.closures, self.w, steps);
        assert!(!period.contact_lost());
        period.condense(&mut self.variation);
        splitting.monodromy(&period, self.w)
    }

    fn runge_kutta(&mut self, steps: usize) -> Mat<f64> {
        self.by_runge_kutta(Period::new(&PLACES), steps)
    }

    fn by_runge_kutta(&mut self, mut period: Period, steps: usize) -> Mat<f64> {
        period.sample(&self.system, &self.closures, self.w, steps);
        period.condense(&mut self.variation);
        RungeKutta::default().monodromy(&self.variation, &period, self.w)
    }

    /// Steps that the splitting takes.
    fn steps(&mut self) -> usize {
        let mut period = Period::new(&PLACES);
        period.sample(&self.system, &self.closures, self.w, 64);
        let fastest = self.variation.highest_frequency(largest(&period.stiffest_of_each()));
        Splitting::steps(fastest, self.w, false).unwrap()
    }
}

/// Largest distance of a multiplier from the nearest of the others.
fn distance(multipliers: &[Complex64], others: &[Complex64]) -> f64 {
    let nearest =
        |x: &Complex64| others.iter().map(|y| (x - y).norm()).fold(f64::INFINITY, f64::min);
    multipliers.iter().map(nearest).fold(0.0, f64::max)
}

/// A light cap on a soft contact over a heavy body on a stiff one: the highest frequency is far below that of the cap on the
/// stiff contact, and in steps for it the method damps the fastest mode by less than the 1e-3 a period that it allows.
#[test]
fn contacts_of_unequal_stiffness_take_the_steps_of_their_own_modes() {
    for seed in 0..12 {
        let mut random = Random(seed);
        let bodies = vec![
            Body::with_mass("cap", 0.01, random.between(1e-3, 3e-3), 71e9, 2710.0).unwrap(),
            Body::with_mass("block", 0.1, random.between(1.0, 4.0), 71e9, 2710.0).unwrap(),
        ];
        let contact = |coefficient| {
            let law = Power::new(coefficient, 0.35, 0.0).unwrap();
            Interface::new("contact", 1.15e-4, Arc::new(law)).unwrap()
        };
        let contacts = vec![contact(random.between(1e7, 1e8)), contact(random.between(1e12, 3e12))];
        let stack = Stack::new(bodies, contacts, Support::Rigid, 9.81).unwrap();
        let mut case = Case::of(stack, 0, &mut random);

        let mut period = Period::new(&PLACES);
        let conditions = (&case.closures[..], case.w);
        period.resolve(&case.system, &mut case.variation, conditions, RungeKutta::steps).unwrap();
        let bound = case.variation.highest_frequency(largest(&period.stiffest_of_each()));
        let most = RungeKutta::steps(bound, case.w, false).unwrap_or(usize::MAX);
        let steps = period.steps();
        assert!(4 * steps < most, "seed {seed}: {steps} and {most} steps");
        let found = eigenvalues(&case.runge_kutta(steps));
        let off = distance(&found, &eigenvalues(&case.runge_kutta(8 * steps)));
        assert!(off < 1e-3, "seed {seed}: {off:.1e}");
    }
}

/// The error of the matrix falls with the fourth power of the step, in as many modes as bodies: with
/// faster ones it is at rounding before.
#[test]
fn splitting_is_of_fourth_order() {
    for seed in 0..12 {
        let mut case = Case::random(seed, 0);
        let fastest = case.variation.highest_frequency(case.springs.iter().sum());
        let steps = (6.0 * fastest / case.w).ceil().max(12.0) as usize;
        let fine = case.splitting(64 * steps);
        let mut error = |factor: usize| (case.splitting(factor * steps) - &fine).norm_l2();
        let slope = (error(4) / error(8)).log2();
        assert!((3.7..4.3).contains(&slope), "seed {seed}: {slope}");
    }
}

/// Multipliers at the steps chosen, and at twice as many, against the classical method at steps of
/// 0.01 rad of the fastest mode.
#[test]
fn splitting_agrees_with_fine_steps_of_runge_kutta() {
    for seed in 0..12 {
        let mut case = Case::random(seed, 2);
        let steps = case.steps();
        let classical = eigenvalues(&case.runge_kutta(240 * steps));
        let [off, finer] = [1, 2]
            .map(|factor| distance(&eigenvalues(&case.splitting(factor * steps)), &classical));
        assert!(off < 1e-4 && finer < 1e-6, "seed {seed}: {off:.1e}, {finer:.1e}");
    }
}

/// Liouville: the determinant is exp(-integral of the trace), for any number of steps.
#[test]
fn volumes_shrink_by_the_damping() {
    for seed in 0..20 {
        let mut case = Case::random(seed, 2);
        let modes = case.variation.modes.len() as f64;
        let exact = (-modes * case.rate * std::f64::consts::TAU / case.w).exp();
        for steps in [case.steps(), 3] {
            let ratio = case.splitting(steps).determinant() / exact;
            assert!((ratio - 1.0).abs() < 1e-10, "seed {seed}, {steps} steps: {ratio}");
        }
    }
}

/// Contacts in the coordinates of the modes are the contacts of the pairs: with dampers, damped static modes, modes with a
/// damping of their own, and contacts that are open for a part of the period.
#[test]
fn contacts_of_modes_are_those_of_pairs() {
    for seed in 0..24 {
        let mut case = Case::random(seed, 2 + (seed % 4) as usize);
        if seed % 2 == 1 {
            // A large motion opens contacts.
            case.closures.iter_mut().for_each(|value| *value *= 8.0);
        }
        if seed % 3 == 0 {
            let count = case.variation.modes.len();
            for mode in &mut case.variation.modes[count / 2..] {
                mode.damping_rate *= 30.0;
            }
            case.variation.leave_out_last();
        }
        let apart = case.runge_kutta(400);
        let modal = case.by_runge_kutta(Period::modal(&PLACES, &case.variation), 400);
        let off = (&apart - &modal).norm_max() / apart.norm_max();
        assert!(off < 1e-10, "seed {seed}: {off:.1e}");
    }
}

/// Multipliers by matrices interpolated between nodes of the period, against those sampled at every stage of fine steps:
/// cells open and close within the period, with damped static modes, and with dampers.
#[test]
fn interpolated_contacts_have_the_multipliers_of_those_sampled() {
    let damping = Some(ContactDamping::kelvin_voigt(2e-6).unwrap());
    let rough = Block {
        cells: [6, 4],
        elastic: 8,
        roughness: 1.5,
        damping: None,
        retardation: 1e-6,
        rate: 100.0,
    };
    for block in [Block { damping, ..rough }, Block { retardation: 0.0, ..rough }, rough] {
        let system = block.system();
        let branch = responses(&block, 8.0, Some(Floquet::default()));
        let springs: Vec<f64> = system.contacts().iter().map(PreloadedContact::spring).collect();
        let modes = system.linear().lowest_modes(Floquet::default().modes).unwrap();
        let rate = system.linear().mass_damping();
        let mut variation = VariationalEquation::new(&modes, rate, &springs);
        let mut lost = 0;
        for point in branch.points.iter().step_by(branch.points.len() / 8) {
            let w = point.angular_frequency;
            let mut period = Period::modal(&PLACES, &variation);
            period.sample(&system, &point.closures, w, 3000);
            period.condense(&mut variation);
            let exact = RungeKutta::default().monodromy(&variation, &period, w);
            let off = distance(point.multipliers.as_ref().unwrap(), &eigenvalues(&exact));
            assert!(off < 1e-4, "{} Hz: {off:.1e}", point.frequency_hz());
            lost += usize::from(point.contact_lost());
        }
        assert!(lost > 2, "{lost}");
    }
}

/// A support with its own damper has modes of two rates: no splitting.
#[test]
fn unequal_damping_is_left_to_runge_kutta() {
    let mut case = Case::random(1, 2);
    case.variation.modes[0].damping_rate *= 1.1;
    assert!(Splitting::new(&mut case.variation, &case.springs).is_none());
}
