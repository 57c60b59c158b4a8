//! Hits that equal steps take on once contacts hold, against steps of their own throughout.

use std::sync::Arc;

use crate::support::AREA;
use asperity_dynamics::{
    Batch, ContactExtremes, Decimation, EnergyLedger, History, Modal, Sampling, Transient,
};
use asperity_law::{ContactDamping, ContactLaw, ModifiedPower, Power};
use asperity_mesh::{Body, Interface, Port, Stack, Support};
use asperity_structure::{Damping, LoadCase, PreloadedStructure, TimeFunction};

/// A block on a sample, hit until its contacts open, with numbers drawn from a seed; contacts of every third are
/// not damped.
fn hit(seed: u64) -> (PreloadedStructure, LoadCase) {
    let mut state = seed;
    let mut draw = |low: f64, high: f64| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        low * (high / low).powf((state >> 11) as f64 / (1_u64 << 53) as f64)
    };
    let knots = [(0.0, 0.02e12), (0.025e6, 0.12e12), (0.078e6, 0.40e12), (0.14e6, 0.97e12)];
    let power: Arc<dyn ContactLaw> = Arc::new(Power::new(draw(1.2e10, 2.4e10), 0.35, 0.0).unwrap());
    let modified: Arc<dyn ContactLaw> =
        Arc::new(ModifiedPower::new(1.81e10, 0.35, 2e5, &knots).unwrap());
    let mut contact = |name: &str, law: &Arc<dyn ContactLaw>| {
        let contact = Interface::new(name, AREA, Arc::clone(law)).unwrap();
        let damping = ContactDamping::kelvin_voigt(draw(1e-6, 1e-5)).unwrap();
        if seed.is_multiple_of(3) { contact } else { contact.with_damping(damping) }
    };
    let upper = if seed.is_multiple_of(2) { &power } else { &modified };
    let contacts = vec![contact("upper", upper), contact("lower", &power)];
    let block = Body::with_mass("block", draw(0.1, 0.3), draw(0.8, 2.5), 71e9, 2710.0).unwrap();
    let sample = Body::new("sample", draw(0.01, 0.03), AREA, 71e9, 2710.0).unwrap();
    let stack = Stack::new(vec![block, sample], contacts, Support::Rigid, 9.81).unwrap();
    let structure = PreloadedStructure::new(stack, Damping::Ratio(draw(0.02, 0.05))).unwrap();
    let pulse = TimeFunction::GammaPulse { rise: draw(0.2e-3, 0.4e-3) };
    (structure, LoadCase::force(pulse, draw(80.0, 160.0)))
}

/// Norm of the difference of two columns over the norm of the changes of the second.
fn apart(found: &[f64], expected: &[f64]) -> f64 {
    assert_eq!(found.len(), expected.len());
    let norm = |numbers: &mut dyn Iterator<Item = f64>| numbers.map(|x| x * x).sum::<f64>();
    let difference = norm(&mut found.iter().zip(expected).map(|(a, b)| a - b));
    (difference / norm(&mut expected.iter().map(|x| x - expected[0]))).sqrt()
}

/// Largest jump of a column about the row `at`, by its third differences, over the largest elsewhere after the
/// first half of the rows before.
fn jump(column: &[f64], at: usize) -> f64 {
    let third = |k: usize| {
        let [a, b, c, d] = [0, 1, 2, 3].map(|shift| column[k + shift]);
        (d - 3.0 * c + 3.0 * b - a).abs()
    };
    let largest = |rows: std::ops::Range<usize>| rows.map(third).fold(0.0, f64::max);
    largest(at - 4..at + 4) / largest(at + 4..2 * at).max(largest(at / 2..at - 4))
}

/// Pairs of all columns of two histories.
fn columns<'a>(a: &'a History, b: &'a History) -> Vec<(&'a [f64], &'a [f64])> {
    let [ours, others] = [&a.sensors[0], &b.sensors[0]];
    let mut pairs: Vec<(&[f64], &[f64])> = vec![
        (&ours.acceleration, &others.acceleration),
        (&ours.displacement, &others.displacement),
        (&ours.velocity, &others.velocity),
    ];
    for (ours, others) in a.interfaces.iter().zip(&b.interfaces) {
        pairs.push((&ours.pressure, &others.pressure));
        pairs.push((&ours.closure, &others.closure));
        pairs.push((&ours.stiffness, &others.stiffness));
    }
    pairs
}

/// Largest differences of energies over the input, and of extremes, means and times without contact.
fn measures_apart(
    found: (&[ContactExtremes], &EnergyLedger),
    whole: &Transient,
    natural: f64,
) -> [f64; 2] {
    let energies =
        |one: &EnergyLedger| [one.input, one.dissipated, one.contact_dissipated, one.stored()];
    let pairs = energies(found.1).into_iter().zip(energies(&whole.energy));
    let energy = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / whole.energy.input;
    let of_contacts = found.0.iter().zip(&whole.contacts).map(|(a, b)| {
        let lost = (a.lost - b.lost).abs() * natural;
        let least = (a.pressure_min - b.pressure_min).abs() / b.pressure_max;
        let largest = (a.pressure_max / b.pressure_max - 1.0).abs();
        let mean = (a.stiffness_average / b.stiffness_average - 1.0).abs();
        lost.max(least).max(largest).max(mean)
    });
    [energy, of_contacts.fold(0.0, f64::max)]
}

/// Hard hits on random rigs: what equal steps take on goes on as at steps of its own throughout, the more closely
/// the shorter the steps, with its history or without, and its samples are smooth where it goes over.
#[test]
fn the_rest_at_equal_steps_goes_on_as_at_steps_of_their_own() {
    let (mut left, mut failures) = (0, Vec::new());
    // Parts of a longest step; largest differences of accelerations, other samples, energies, and contacts.
    // At the longer steps the two follow undamped fast modes differently; at still longer ones rig 9 has an opening more
    // or less.
    let finenesses = [(8.0, [1e-2, 5e-4, 2e-5, 1e-4]), (16.0, [1e-3, 2e-5, 1e-6, 5e-6])];
    for (seed, (parts, most)) in (1..=9).flat_map(|seed| finenesses.map(|one| (seed, one))) {
        let (structure, load) = hit(seed);
        let natural = structure.natural_frequency().unwrap();
        let base = 0.01 / natural / parts;
        // Several base steps in a sampling interval, one, and several intervals in an equal step.
        let interval = base * [0.45, 1.0, 2.5][(seed / 3) as usize % 3];
        let sampling = Sampling::new(40.0 / natural, 1.0 / interval).unwrap();
        let (step, tolerance) = (Some(base), Some(1e-5 / f64::powi(parts, 4)));
        let method = Modal { step, tolerance, modes_per_body: Some(6), ..Modal::default() };
        let case = method.case(&structure, &load, &[Port::TOP], &sampling).unwrap();
        let batch = Batch::default();
        let whole = batch.transient_at_own_steps(&case, &sampling).unwrap();
        let found = batch.transient(&case, &sampling).unwrap();
        assert!(whole.contacts.iter().any(|contact| contact.lost > 0.0), "{seed}");
        // The load at steps of its own is the quadratic of each step, which ends at its value.
        assert!(apart(&found.history.time, &whole.history.time) < 1e-14);
        assert!(apart(&found.history.load, &whole.history.load) < 1e-12);
        let pairs = columns(&found.history, &whole.history);
        let changed = |(a, b): (&f64, &f64)| a != b;
        let first = pairs[1].0.iter().zip(pairs[1].1).position(changed);
        let Some(first) = first else { continue };
        left += 1;
        let jumps = pairs.iter().map(|(ours, _)| jump(ours, first)).fold(0.0, f64::max);
        let [accelerations, others] = [&pairs[..1], &pairs[1..]]
            .map(|pairs| pairs.iter().map(|(a, b)| apart(a, b)).fold(0.0, f64::max));
        let all = |_: usize, _: f64| Decimation::every_step();
        let alone = batch.run(&[case], &all).into_iter().next().unwrap().unwrap();
        let [a, b] = [(&found.contacts, &found.energy), (&alone.contacts, &alone.energy)]
            .map(|(contacts, energy)| measures_apart((contacts, energy), &whole, natural));
        let found = [accelerations, others, a[0].max(b[0]), a[1].max(b[1])];
        if !found.iter().zip(most).all(|(found, most)| *found < most) || jumps > 2.0 {
            failures.push(format!("{seed} {parts} {found:?} {jumps}"));
        }
    }
    assert!(left >= 14, "{left}");
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// A light bar on a block that is struck or shaken, its contact stiff and the one below soft, with numbers drawn from a seed:
/// modes of the bar ring with little energy, and move its contact.
fn light_bar(seed: u64) -> (PreloadedStructure, LoadCase) {
    let mut state = seed;
    let mut draw = |low: f64, high: f64| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        low * (high / low).powf((state >> 11) as f64 / (1_u64 << 53) as f64)
    };
    let contact = |name: &str, area: f64, coefficient: f64| {
        let law: Arc<dyn ContactLaw> = Arc::new(Power::new(coefficient, 0.4, 0.0).unwrap());
        Interface::new(name, area, law).unwrap()
    };
    let stiff = contact("stiff", 1e-5, draw(5e10, 5e11));
    let soft = contact("soft", 1e-4, draw(1e9, 3e9));
    let bar = Body::with_mass("bar", draw(0.1, 0.4), draw(0.01, 0.03), 370e9, 3900.0).unwrap();
    let block = Body::with_mass("block", 0.1, draw(0.5, 2.0), 50e9, 2650.0).unwrap();
    let stack = Stack::new(vec![bar, block], vec![stiff, soft], Support::Rigid, 9.81).unwrap();
    let structure = PreloadedStructure::new(stack, Damping::Ratio(draw(0.003, 0.01))).unwrap();
    let function = if seed.is_multiple_of(2) {
        TimeFunction::Harmonic { frequency: draw(100.0, 500.0) }
    } else {
        TimeFunction::HalfSine { duration: draw(0.5e-3, 2e-3) }
    };
    let load = LoadCase::force(function, draw(0.003, 0.03));
    (structure, load.at(Port::Point { body: 1, position: 0.06 }))
}

/// Pressures of a stiff contact under a light body, over their range, as at steps of their own throughout: what rings there
/// has little energy, but not little pressure.
#[test]
fn pressures_of_a_stiff_contact_go_on_at_equal_steps() {
    let (mut left, mut failures) = (0, Vec::new());
    for seed in 1..=12 {
        let (structure, load) = light_bar(seed);
        let natural = structure.natural_frequency().unwrap();
        let (base, tolerance) = (0.01 / natural, 2.5e-7);
        let sampling = Sampling::new(60.0 / natural, 1.0 / base).unwrap();
        let (step, tolerance) = (Some(base), Some(tolerance));
        let method = Modal { step, tolerance, modes_per_body: Some(16), ..Modal::default() };
        let case = method.case(&structure, &load, &[Port::TOP], &sampling).unwrap();
        let batch = Batch::default();
        let whole = batch.transient_at_own_steps(&case, &sampling).unwrap();
        // Short of where equal steps begin, and beyond it.
        let ending = if seed % 2 == 0 { 500 } else { 5500 };
        let all = |_: usize, _: f64| Arc::new(Decimation { factor: 1, taps: [1.0].into(), ending });
        let found = batch.run(&[case], &all).into_iter().next().unwrap().unwrap();
        assert_eq!(found.ending, found.displacement[found.steps - ending..]);
        left += usize::from(found.integrated_steps != whole.steps);
        let pairs = found.contacts.iter().zip(&whole.contacts);
        let off = pairs.map(|(a, b)| {
            let [least, largest] =
                [a.pressure_min - b.pressure_min, a.pressure_max - b.pressure_max];
            least.abs().max(largest.abs()) / (b.pressure_max - b.pressure_min)
        });
        let off = off.fold(0.0, f64::max);
        if off > 3e-4 {
            failures.push(format!("{seed}: {off:.1e}"));
        }
    }
    assert!(left >= 4, "{left}");
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}
