//! Many hits side by side: the response to each is that of the hit by itself.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::support::{DISC, difference, every_law, power, pulse, rig, rig_on};
use crate::support::{single_body, three_bodies};
use asperity_dynamics::{
    Batch, CaseResponse, Decimation, DynamicsError, InstructionSet, ModalModel, Sampling,
    TransientCase,
};
use asperity_mesh::{ModeCount, Port, Stack};
use asperity_structure::{Damping, LoadCase, PreloadedStructure, TimeFunction};

type Outcome = Result<CaseResponse, DynamicsError>;

fn modal(stack: &Stack, damping: Damping, modes: usize) -> Arc<ModalModel> {
    let structure = PreloadedStructure::new(stack.clone(), damping).unwrap();
    Arc::new(
        ModalModel::of_stack(
            &structure,
            &ModeCount::PerBody(modes).counts(structure.stack()).unwrap(),
            Port::TOP,
            &[Port::TOP],
        )
        .unwrap(),
    )
}

/// Filters of equal length and unequal taps.
fn filter(number: usize) -> Arc<Decimation> {
    let taps = (0..9).map(|tap| ((number % 3 * 9 + tap) as f64).cos() / 9.0).collect();
    Arc::new(Decimation { factor: 1 + number % 2, taps, ending: 0 })
}

/// Forty-two hits, hardly two of one kind; kinds mixed.
fn hits() -> Vec<TransientCase> {
    let mut rigs = Vec::new();
    for (n, (_, law)) in every_law().into_iter().enumerate() {
        let stack = if n % 2 == 0 { rig(&law) } else { rig_on(&law, DISC) };
        rigs.push(modal(&stack, Damping::Ratio(0.01 * n as f64), 1 + n % 4));
    }
    for gravity in [2.0, 9.81, 30.0] {
        rigs.push(modal(&single_body(&power(), gravity), Damping::Rate(100.0), 2));
    }
    rigs.push(modal(&three_bodies(DISC), Damping::Ratio(0.02), 2));
    let mut hits = Vec::new();
    for n in 0..42_usize {
        let peak = 2.0 + (7 * n % 31) as f64;
        let excitation = match n % 4 {
            0 => pulse(peak),
            1 => LoadCase::force(TimeFunction::HalfSine { duration: 1e-3 }, peak),
            2 => LoadCase::force(TimeFunction::Haversine { duration: 0.7e-3 }, -0.2 * peak),
            _ => LoadCase::force(TimeFunction::Harmonic { frequency: 300.0 + peak }, 0.1 * peak),
        };
        hits.push(TransientCase {
            model: Arc::clone(&rigs[5 * n % rigs.len()]),
            load: excitation,
            sensor: 0,
            duration: [3e-3, 2e-3, 4.5e-3][n / 2 % 3],
            step: [None, Some(2.5e-6), Some(2e-6), None][n / 3 % 4],
            tolerance: None,
        });
    }
    hits
}

/// The outcomes of the hits of `numbers`, each with its own filter.
fn outcomes(
    hits: &[TransientCase],
    numbers: &[usize],
    instructions: InstructionSet,
) -> Vec<Outcome> {
    let chosen: Vec<TransientCase> = numbers.iter().map(|&n| hits[n].clone()).collect();
    Batch { instructions }.run(&chosen, &|place, _| filter(numbers[place]))
}

/// A permutation of `0..count` without a pattern, for each `seed` another.
fn shuffled(count: usize, seed: u64) -> Vec<usize> {
    let mut state = seed;
    let mut numbers: Vec<usize> = (0..count).collect();
    for last in (1..count).rev() {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        numbers.swap(last, (state >> 33) as usize % (last + 1));
    }
    numbers
}

/// To the last bit: lanes, neighbours, order and number of hits have no part in an outcome.
#[test]
fn a_hit_does_not_know_its_neighbours() {
    let hits = hits();
    let every: Vec<usize> = (0..hits.len()).collect();
    for instructions in InstructionSet::available() {
        let reference = outcomes(&hits, &every, instructions);
        assert!(reference.iter().all(Result::is_ok), "{reference:?}");
        let mut orders: Vec<Vec<usize>> = (1..=6).map(|seed| shuffled(hits.len(), seed)).collect();
        orders.push(every.iter().rev().copied().collect());
        orders.push(shuffled(hits.len(), 7)[..19].to_vec());
        orders.extend(every.iter().map(|&n| vec![n]));
        // One kind twenty times over, with its neighbours of other forces.
        orders.push((0..20).map(|k| if k % 3 == 0 { 8 } else { k }).collect());
        for numbers in orders {
            for (&n, outcome) in numbers.iter().zip(outcomes(&hits, &numbers, instructions)) {
                assert!(outcome == reference[n], "{instructions:?}: hit {n} among {numbers:?}");
            }
        }
    }
}

/// Hits of one model side by side, each read at a sensor of its own, are those hits alone: lanes that share the constants
/// of a model do not share a sensor.
#[test]
fn hits_of_one_model_have_their_own_sensors() {
    let structure = PreloadedStructure::new(rig(&power()), Damping::Ratio(0.035)).unwrap();
    let counts = ModeCount::PerBody(3).counts(structure.stack()).unwrap();
    let sensors = [0.0, 0.1, 0.2].map(|position| Port::Point { body: 0, position });
    let model = Arc::new(ModalModel::of_stack(&structure, &counts, Port::TOP, &sensors).unwrap());
    let hit = |n: usize| TransientCase {
        model: Arc::clone(&model),
        load: pulse(4.0 + (n / 3) as f64),
        sensor: n % 3,
        duration: 3e-3,
        step: Some(1e-5),
        tolerance: None,
    };
    let hits: Vec<TransientCase> = (0..30).map(hit).collect();
    let every: Vec<usize> = (0..hits.len()).collect();
    for instructions in InstructionSet::available() {
        let together = outcomes(&hits, &every, instructions);
        for (n, found) in together.iter().enumerate() {
            let alone = outcomes(&hits, &[n], instructions).remove(0);
            assert!(*found == alone, "{instructions:?}: hit {n}");
        }
        let [top, foot] = [0, 2].map(|n| together[n].as_ref().unwrap());
        assert!(difference(&top.displacement, &foot.displacement) > 1e-3);
    }
}

/// The sets differ in fused rounding only, which bounces magnify: found 7e-12 at most.
#[test]
fn every_instruction_set_gives_the_same_records() {
    let hits = hits();
    let every: Vec<usize> = (0..hits.len()).collect();
    let sets = InstructionSet::available();
    let reference = outcomes(&hits, &every, sets[0]);
    for &set in &sets[1..] {
        for (n, pair) in outcomes(&hits, &every, set).into_iter().zip(&reference).enumerate() {
            let (Ok(found), Ok(expected)) = pair else { panic!("{pair:?}") };
            let mut offs = vec![difference(&found.displacement, &expected.displacement)];
            for (a, b) in found.contacts.iter().zip(&expected.contacts) {
                offs.push((a.stiffness_average / b.stiffness_average - 1.0).abs());
                offs.push((a.pressure_max / b.pressure_max - 1.0).abs());
                offs.push((a.pressure_min - b.pressure_min).abs() / b.pressure_max);
            }
            offs.push((found.energy.input / expected.energy.input - 1.0).abs());
            offs.push(
                (found.energy.dissipated - expected.energy.dissipated).abs() / found.energy.input,
            );
            assert!(offs.iter().all(|off| *off < 1e-9), "{set:?}, hit {n}: {offs:?}");
            assert_eq!((found.step, found.steps), (expected.step, expected.steps));
        }
    }
}

/// Too coarse a step, forces beyond all bounds and beyond all tables, settings out of range:
/// each hit has its own error, and the others are what they are without it.
#[test]
fn a_failing_hit_changes_no_other() {
    let hits = hits();
    let thrown = modal(&rig(&every_law()[1].1), Damping::Ratio(0.035), 2);
    let bad = |load, duration, step| TransientCase {
        model: Arc::clone(&thrown),
        load,
        sensor: 0,
        duration,
        step,
        tolerance: None,
    };
    let fails = [
        bad(pulse(32.0), 3e-3, Some(5e-5)),
        bad(pulse(1e300), 3e-3, Some(5e-6)),
        bad(pulse(1e306), 3e-3, None),
        bad(pulse(f64::NAN), 3e-3, None),
        bad(pulse(20.0), f64::NAN, None),
        bad(pulse(20.0), 3e-3, Some(-1.0)),
        bad(pulse(20.0), 3e-3, Some(1e-13)),
    ];
    let none = Decimation::every_step();
    for instructions in InstructionSet::available() {
        let run =
            |hits: &[TransientCase]| Batch { instructions }.run(hits, &|_, _| Arc::clone(&none));
        let alone = run(&hits);
        let mut mixed: Vec<TransientCase> = Vec::new();
        for (n, hit) in hits.iter().enumerate() {
            mixed.push(hit.clone());
            mixed.push(fails[n % fails.len()].clone());
        }
        let together = run(&mixed);
        for (n, pair) in together.chunks(2).enumerate() {
            assert!(pair[0] == alone[n], "{instructions:?}: hit {n}");
            let error = pair[1].as_ref().unwrap_err();
            match n % fails.len() {
                0 => assert!(matches!(error, DynamicsError::Coarse { .. }), "{error:?}"),
                // Beyond all tables: any error.
                1 | 2 => {}
                6 => assert!(matches!(error, DynamicsError::TooLarge { .. }), "{error:?}"),
                3 => assert!(matches!(error, DynamicsError::Structure(_)), "{error:?}"),
                _ => assert!(matches!(error, DynamicsError::Setting { .. }), "{error:?}"),
            }
        }
    }
}

/// A run that is stopped ends within some steps, at equal steps and at steps of its own; the filter of a case is
/// asked for before its first step, and stops the run here.
#[test]
fn a_stopped_run_ends_within_some_steps() {
    let model = modal(&single_body(&power(), 9.81), Damping::Rate(100.0), 2);
    let case = |tolerance: Option<f64>| TransientCase {
        model: Arc::clone(&model),
        load: pulse(20.0),
        sensor: 0,
        duration: 1.0,
        step: Some(1e-6),
        tolerance,
    };
    let all_steps = Arc::new(Decimation { factor: 1000, taps: Arc::new([1.0]), ending: 0 });
    for tolerance in [None, Some(1e-5)] {
        let stop = AtomicBool::new(false);
        let decimation = |_: usize, _: f64| {
            stop.store(true, Ordering::Relaxed);
            Arc::clone(&all_steps)
        };
        let found = Batch::default().run_unless(&[case(tolerance)], &decimation, &stop);
        let Err(DynamicsError::Stopped { steps }) = &found[0] else { panic!("{found:?}") };
        assert!(*steps <= 32, "{steps} of a million");
        let sampling = Sampling::new(1.0, 1e4).unwrap();
        let found = Batch::default().transient_unless(&case(tolerance), &sampling, &stop);
        assert!(matches!(found, Err(DynamicsError::Stopped { steps: ..=32 })), "{found:?}");
    }
}
