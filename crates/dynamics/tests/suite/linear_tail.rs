//! The rest of a ring-down in closed form, against all of its steps.

use std::sync::Arc;

use crate::support::{DISC, constant, every_law, modified, pulse, rig, rig_on, three_bodies};
use asperity_dynamics::{
    Batch, CaseResponse, Decimation, ModalModel, Sampling, Transient, TransientCase,
};
use asperity_mesh::{BodyDamping, ModeCount, Port, Stack, Support};
use asperity_structure::{Damping, LoadCase, PreloadedStructure, TimeFunction};

const DURATION: f64 = 0.12;

fn hit(stack: &Stack, damping: Damping, excitation: LoadCase, step: Option<f64>) -> TransientCase {
    let structure = PreloadedStructure::new(stack.clone(), damping).unwrap();
    let rig = ModalModel::of_stack(
        &structure,
        &ModeCount::PerBody(3).counts(structure.stack()).unwrap(),
        Port::TOP,
        &[Port::TOP],
    )
    .unwrap();
    TransientCase {
        model: Arc::new(rig),
        load: excitation,
        sensor: 0,
        duration: DURATION,
        step,
        tolerance: None,
    }
}

fn filter(factor: usize, length: usize) -> Arc<Decimation> {
    let tap = |l: usize| (0.2 * l as f64).cos() / length as f64;
    Arc::new(Decimation { factor, taps: (0..length).map(tap).collect(), ending: 900 })
}

fn respond(hit: &TransientCase, decimation: &Arc<Decimation>) -> CaseResponse {
    let mut records =
        Batch::default().run(std::slice::from_ref(hit), &|_, _| Arc::clone(decimation));
    records.swap_remove(0).unwrap()
}

/// Every step of the hit.
fn whole(hit: &TransientCase, record: &CaseResponse) -> Transient {
    let sampling = Sampling::new(hit.duration, 1.0 / record.step).unwrap();
    Batch::default().transient(hit, &sampling).unwrap()
}

/// Largest difference between a record and the filtered displacement of all steps, over its peak, or between its last
/// outputs and these steps, over theirs.
fn departure(record: &CaseResponse, all: &[f64]) -> f64 {
    let Decimation { factor, taps, ending } = &*record.decimation;
    let filtered = |j: usize| -> f64 {
        let past = taps.iter().enumerate().map(|(l, tap)| {
            let step = (j * factor).checked_sub(l).filter(|step| *step < record.steps);
            step.map_or(0.0, |step| tap * all[step])
        });
        past.sum()
    };
    let expected: Vec<f64> = (0..record.displacement.len()).map(filtered).collect();
    assert_eq!(record.ending.len(), *ending.min(&record.steps));
    let last = &all[record.steps - record.ending.len()..record.steps];
    let apart = |found: &[f64], exact: &[f64], among: &[f64]| {
        let peak = among.iter().fold(0.0_f64, |most, u| most.max(u.abs()));
        let pairs = found.iter().zip(exact);
        pairs.map(|(found, exact)| (found - exact).abs()).fold(0.0, f64::max) / peak
    };
    let filtered = apart(&record.displacement, &expected, &expected);
    filtered.max(apart(&record.ending, last, all))
}

/// A law that is straight: both are the same numbers but for rounding, for filters that are longer
/// and shorter than the factor, and at the end of a response that is still of 1e-6 of its amplitude.
#[test]
fn of_a_straight_law_it_is_exact() {
    let rigs = [
        hit(&rig(&constant()), Damping::Ratio(0.035), pulse(20.0), None),
        hit(&rig_on(&constant(), DISC), Damping::Ratio(0.03), pulse(20.0), Some(2e-5)),
    ];
    let [short, disc] = rigs;
    for hit in [TransientCase { duration: 0.07, ..short }, disc] {
        for (factor, length) in [(8, 96), (1, 1), (7, 3), (3, 200), (40, 96)] {
            let record = respond(&hit, &filter(factor, length));
            assert!(record.integrated_steps < record.steps * 4 / 5);
            let all = whole(&hit, &record);
            assert_eq!((record.step, record.steps), (all.step, all.steps));
            let off = departure(&record, &all.history.sensors[0].displacement);
            // Rounding: found 2e-14 at most.
            assert!(off < 1e-13, "{factor} {length}: {off:.1e}");
            let [found, exact] =
                [&record.contacts, &all.contacts].map(|contacts| contacts[0].stiffness_average);
            assert!((found / exact - 1.0).abs() < 1e-12);
        }
    }
}

/// Every law, several dampings and hits: within the bound, and extremes and averages with it.
#[test]
fn of_every_law_it_is_within_its_bound() {
    let decimation = filter(8, 96);
    let (mut closed, mut count) = (0, 0);
    for (name, law) in every_law() {
        for ratio in [0.01, 0.035, 0.1] {
            for peak in [0.5, 9.0, 32.0] {
                let hit = hit(&rig(&law), Damping::Ratio(ratio), pulse(peak), None);
                let record = respond(&hit, &decimation);
                count += 1;
                let all = whole(&hit, &record);
                if record.integrated_steps == record.steps {
                    assert_eq!(record.contacts, all.contacts);
                    continue;
                }
                closed += 1;
                let off = departure(&record, &all.history.sensors[0].displacement);
                assert!(off < 1e-6, "{name}, {ratio}, {peak} N: {off:.1e}");
                for (found, exact) in record.contacts.iter().zip(&all.contacts) {
                    assert_eq!(found.pressure_min, exact.pressure_min);
                    assert_eq!(found.pressure_max, exact.pressure_max);
                    assert_eq!(found.lost, exact.lost);
                    // In the table a tangent is less exact than the pressure.
                    let average = found.stiffness_average / exact.stiffness_average - 1.0;
                    assert!(average.abs() < 1e-5, "{name}, {ratio}, {peak} N: {average:.1e}");
                }
                assert!(record.energy.residual_relative() < 5e-4);
            }
        }
    }
    // The share that the book states of the paper's rig.
    let paper = hit(&rig(&modified()), Damping::Ratio(0.035), pulse(32.0), None);
    let record = respond(&paper, &decimation);
    assert_eq!(record.integrated_steps, (7 * record.steps).div_ceil(16));
    // All but those of little damping and those that bounce to the end.
    assert!(closed > count / 2, "{closed} of {count}");
}

/// Damping of a body besides, and several bodies.
#[test]
fn structures_with_damped_bodies_end_in_it_too() {
    let decimation = filter(5, 64);
    let kelvin = BodyDamping::kelvin_voigt(2e-7).unwrap();
    let stack = rig_on(&modified(), DISC);
    let bodies = stack.bodies().iter().map(|body| body.clone().with_damping(kelvin));
    let contacts = stack.interfaces().to_vec();
    let damped = Stack::new(bodies.collect(), contacts, *stack.support(), stack.gravity()).unwrap();
    for stack in [three_bodies(Support::Rigid), damped] {
        let hit = hit(&stack, Damping::Ratio(0.05), pulse(4.0), None);
        let record = respond(&hit, &decimation);
        assert!(record.integrated_steps < record.steps, "{}", record.steps);
        let off = departure(&record, &whole(&hit, &record).history.sensors[0].displacement);
        assert!(off < 1e-6, "{off:.1e}");
    }
}

/// Hits with too little damping, that bounce for long or are driven for ever, have no such rest.
#[test]
fn other_responses_are_integrated_to_their_end() {
    let decimation = filter(8, 96);
    let sine = LoadCase::force(TimeFunction::Harmonic { frequency: 700.0 }, 1.0);
    let hits = [
        hit(&rig(&modified()), Damping::Ratio(0.001), pulse(9.0), None),
        hit(&rig(&modified()), Damping::Ratio(0.015), pulse(2000.0), None),
        hit(&rig(&modified()), Damping::Ratio(0.035), sine, None),
    ];
    for hit in hits {
        let record = respond(&hit, &decimation);
        assert_eq!(record.integrated_steps, record.steps);
        assert_eq!(record.contacts, whole(&hit, &record).contacts);
    }
    // The step makes an oscillation of the sample grow at this damping: found by the energy of all steps,
    // and the step is halved.
    let constant = TransientCase {
        duration: 0.4,
        ..hit(&rig(&constant()), Damping::Ratio(0.01), pulse(9.0), None)
    };
    let record = respond(&constant, &decimation);
    assert!(record.step < 1e-5 && record.energy.residual_relative() < 5e-4, "{record:?}");
}
