//! Steady responses with loss of contact: condensed bodies, and motions that are not periodic.

use asperity_harmonic::{PeriodicResponse, SpecialPointKind};
use asperity_scenario::Document;
use asperity_simulation::assemble::Assembly;
use asperity_simulation::error::SimulationError;
use asperity_simulation::steady::{
    BodyModel, Condensation, CondensationReason, SteadyMotion, SteadyRequest, SweepDirection,
    TimeCheck, TimeSweepRequest, steady, time_sweeps,
};
use asperity_simulation::warning::Warning;

const RIG: &str =
    concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/scenarios/nouira2020-modified.json");

/// The paper's rig with the power law on both contacts.
fn rig() -> Assembly {
    let mut document = Document::read(RIG).unwrap();
    for interface in 0..2 {
        document.set(&format!("/interfaces/{interface}/law"), "pl").unwrap();
    }
    Assembly::new(&document.scenario().unwrap(), document.folder()).unwrap()
}

fn request(force: f64, bodies: BodyModel) -> SteadyRequest {
    SteadyRequest {
        amplitudes: vec![force],
        from_hz: 1054.0,
        to_hz: 700.0,
        harmonics: None,
        backbone: false,
        verify: false,
        bodies,
        time_sweep: None,
    }
}

/// Departure of an amplitude \[m\] from the nearest of the branch at a frequency \[Hz\], by chords between
/// its points.
fn distance(branch: &[PeriodicResponse], frequency_hz: f64, amplitude_m: f64) -> f64 {
    let crossings = branch.windows(2).filter_map(|pair| {
        let [a, b] = [0, 1].map(|n| (pair[n].frequency_hz(), pair[n].amplitude(1)));
        let share = (frequency_hz - a.0) / (b.0 - a.0);
        (0.0..=1.0).contains(&share).then_some(a.1 + share * (b.1 - a.1))
    });
    crossings.map(|amplitude| (amplitude_m / amplitude - 1.0).abs()).fold(f64::INFINITY, f64::min)
}

/// By default the sample keeps its inertia where contact holds, and is condensed where it is lost; the state of a whole rig
/// is known then only in the first.
#[test]
fn bodies_are_condensed_where_contact_is_lost() {
    let assembly = rig();
    for (force, lost) in [(0.5, false), (2.0, true)] {
        let found = steady(&assembly, &request(force, BodyModel::Auto)).unwrap();
        let level = &found.levels[0];
        let branch = level.outcome.as_ref().unwrap();
        assert!(branch.is_complete() && branch.peak().is_some(), "{force} N");
        assert_eq!(branch.of_kind(SpecialPointKind::Fold).count(), if lost { 2 } else { 0 });
        let ranges = level.pressures(&branch.points[0]);
        assert_eq!(ranges.len(), 2);
        let own = TimeCheck::from_own_state(&assembly, &branch.points[0]);
        assert_eq!(own.map(|own| own.relative_difference < 1e-3), (!lost).then_some(true));
        let Some(Condensation { light, reason }) = &level.condensed else {
            assert!(!lost);
            continue;
        };
        let CondensationReason::ContactLost { from_hz } = *reason else { panic!("{reason:?}") };
        assert!(lost && from_hz > 900.0 && from_hz < 1054.0, "{from_hz}");
        assert_eq!(light.bodies()[0].name, "sample");
        assert!((30e3..45e3).contains(&light.bodies()[0].frequency_hz));
    }
}

/// Time integration of the whole rig at 2 N rattles; its mean fundamental is that of the condensed
/// branch within 0.8 %.
#[test]
fn a_rattling_sample_is_named_and_its_mean_is_that_of_the_condensed_branch() {
    let request = SteadyRequest { verify: true, ..request(2.0, BodyModel::Auto) };
    let found = steady(&rig(), &request).unwrap();
    let check = found.levels[0].check.unwrap();
    assert_eq!(check.motion, SteadyMotion::NonPeriodic, "{check:?}");
    assert!(!check.settled && check.scatter > 1e-4, "{check:?}");
    assert!(check.relative_difference < 8e-3, "{check:?}");
}

/// The branch with the condensed sample, which loses contact at every cycle, is that of the elastic bodies
/// in time, whose sample rattles: within 0.8 % from 1000 Hz down to the lower fold.
#[test]
fn the_condensed_branch_is_that_of_time_integration() {
    let assembly = rig();
    let found = steady(&assembly, &request(2.0, BodyModel::Auto)).unwrap();
    let branch = found.levels[0].outcome.as_ref().unwrap();
    assert!(found.levels[0].condensed.is_some());
    let request = TimeSweepRequest { direction: SweepDirection::Down, frequencies: 19 };
    let sweeps = time_sweeps(&assembly, &[2.0], (1000.0, 820.0), request).unwrap();
    let points = sweeps[0].outcome.as_ref().unwrap();
    for point in points {
        // What is not settled wanders about its mean by 1e-3.
        let off = distance(&branch.points, point.frequency_hz, point.amplitude_1_m);
        assert!(off < 8e-3, "{} Hz: {off:.1e}", point.frequency_hz);
    }
    assert!(points.last().unwrap().amplitude_1_m > 5.5e-7);
}

/// On request bodies are condensed without loss as well; one that is not far above the range is not.
#[test]
fn requests_are_honoured_or_refused() {
    let found = steady(&rig(), &request(0.5, BodyModel::Condensed)).unwrap();
    let reason = found.levels[0].condensed.as_ref().unwrap().reason;
    assert_eq!(reason, CondensationReason::Requested);
    let high = SteadyRequest { to_hz: 4000.0, ..request(0.5, BodyModel::Condensed) };
    let error = steady(&rig(), &high).unwrap_err();
    assert!(matches!(error, SimulationError::NothingToCondense { .. }), "{error}");
    assert!(error.is_wrong_request());
    for part in ["sample at 3", "at least 40000.0 Hz"] {
        assert!(error.to_string().contains(part), "{error}");
    }
    let elastic = steady(&rig(), &request(0.5, BodyModel::Elastic)).unwrap();
    assert!(elastic.levels[0].condensed.is_none());
}

/// A stepped sine in both directions at a force with folds and no loss of contact: every settled point is
/// that of the branch, and each jump lies within a frequency step of its fold.
#[test]
fn a_stepped_sine_follows_the_branch_and_jumps_at_its_folds() {
    let document = Document::read(RIG).unwrap();
    let assembly = Assembly::new(&document.scenario().unwrap(), document.folder()).unwrap();
    let range = SteadyRequest { from_hz: 860.0, to_hz: 760.0, ..request(1.0, BodyModel::Elastic) };
    let found = steady(&assembly, &range).unwrap();
    let branch = found.levels[0].outcome.as_ref().unwrap();
    let folds: Vec<f64> =
        branch.of_kind(SpecialPointKind::Fold).map(PeriodicResponse::frequency_hz).collect();
    assert_eq!(folds.len(), 2);
    let request = TimeSweepRequest { direction: SweepDirection::Both, frequencies: 101 };
    let sweeps = time_sweeps(&assembly, &[1.0], (range.from_hz, range.to_hz), request).unwrap();
    let spacing = 1.0;
    // Falling, the motion stays on the upper part down to the lower fold; rising, on the lower part.
    for (sweep, fold) in sweeps.iter().zip([folds[0].max(folds[1]), folds[0].min(folds[1])]) {
        let jumps = sweep.jumps();
        assert_eq!(jumps.len(), 1, "{} {jumps:?} {folds:?}", sweep.direction());
        let (low, high) = (jumps[0][0].min(jumps[0][1]), jumps[0][0].max(jumps[0][1]));
        assert!(low <= fold + spacing && high >= fold - spacing, "{low} {high} {fold}");
        let points = sweep.outcome.as_ref().unwrap();
        assert!(points.iter().filter(|point| !point.settled).count() <= 2);
        for point in points.iter().filter(|point| point.settled) {
            let off = distance(&branch.points, point.frequency_hz, point.amplitude_1_m);
            // Chords between the points of the branch, and motions settled to 1e-3.
            let near = (point.frequency_hz - fold).abs() < 2.0 * spacing;
            assert!(off < 1e-2 || near, "{} Hz: {off:.1e}", point.frequency_hz);
        }
    }
}

/// Stepped sines on random stable branches: two bodies, forces up to half of those that lose contact.
#[test]
fn stepped_sines_agree_with_harmonic_balance_on_random_rigs() {
    let mut state = 1_u64;
    let mut random = |low: f64, high: f64| {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    for _ in 0..4 {
        let mut document = Document::read(RIG).unwrap();
        for (pointer, value) in [
            ("/bodies/0/mass_kg", random(0.8, 3.0)),
            ("/bodies/0/length_m", random(0.1, 0.3)),
            ("/bodies/1/length_m", random(0.01, 0.05)),
            ("/damping/ratio", random(0.02, 0.06)),
            ("/laws/pl/exponent", random(0.3, 0.4)),
        ] {
            document.set(pointer, &value.to_string()).unwrap();
        }
        for interface in 0..2 {
            document.set(&format!("/interfaces/{interface}/law"), "pl").unwrap();
        }
        let assembly = Assembly::new(&document.scenario().unwrap(), document.folder()).unwrap();
        let natural = assembly.structure.natural_frequency().unwrap();
        let weight = assembly.structure.contacts()[0].pressure() * 1.15e-4;
        let force = random(0.2, 0.5) * 2.0 * assembly.structure.damping_rate() * weight
            / (2.0 * std::f64::consts::TAU * natural);
        let (from_hz, to_hz) = (0.85 * natural, 1.05 * natural);
        let range = SteadyRequest { from_hz, to_hz, ..request(force, BodyModel::Elastic) };
        let found = steady(&assembly, &range).unwrap();
        let branch = found.levels[0].outcome.as_ref().unwrap();
        assert!(branch.is_complete() && branch.of_kind(SpecialPointKind::Fold).count() == 0);
        let peak = branch.peak().unwrap();
        let request = TimeSweepRequest { direction: SweepDirection::Up, frequencies: 3 };
        let around = (peak.frequency_hz() - 5.0, peak.frequency_hz() + 5.0);
        let sweeps = time_sweeps(&assembly, &[force], around, request).unwrap();
        let point = sweeps[0].outcome.as_ref().unwrap()[1];
        let ratio = point.amplitude_1_m / peak.amplitude(1);
        assert!(point.settled && (ratio - 1.0).abs() < 2e-3, "{ratio} {point:?}");
        let second = point.amplitude_2_m / peak.amplitude(2);
        assert!((second - 1.0).abs() < 1e-2, "{second}");
        assert!((point.phase_1_rad - peak.phase()).abs() < 5e-3, "{point:?} {}", peak.phase());
    }
}

/// A cap of 0.2 kg on a block on a soft contact. The block's frequency on its contacts is far above the range
/// by the stiff one alone, on which it moves with the cap.
fn cap_on_block(block_kg: f64) -> Assembly {
    let body = |name: &str, length_m: f64, mass_kg: f64| {
        serde_json::json!({"name": name, "length_m": length_m, "mass_kg": mass_kg,
            "youngs_modulus_pa": 2e11, "density_kg_per_m3": 7850})
    };
    let scenario = serde_json::json!({
        "schema": "asperity/scenario/1",
        "bodies": [body("cap", 0.02, 0.2), body("block", 0.05, block_kg)],
        "interfaces": [
            {"name": "stiff", "area_m2": 1e-3,
                "law": {"kind": "constant", "stiffness_pa_per_m": 2e13}},
            {"name": "soft", "area_m2": 1e-4,
                "law": {"kind": "power", "coefficient": 2e9, "exponent": 0.4}}],
        "damping": {"kind": "mass_proportional", "ratio": 0.02},
        "duration_s": 0.1
    });
    let document = Document::parse(&scenario.to_string(), "cap.json").unwrap();
    Assembly::new(&document.scenario().unwrap(), document.folder()).unwrap()
}

/// A heavy body keeps its inertia where contact is lost, and the branch agrees with time integration; a body
/// with little of the kinetic energy is condensed.
#[test]
fn a_heavy_body_on_a_stiff_contact_keeps_its_inertia() {
    let request = SteadyRequest {
        from_hz: 216.0,
        to_hz: 648.0,
        verify: true,
        ..request(6.0, BodyModel::Auto)
    };
    let found = steady(&cap_on_block(5.0), &request).unwrap();
    let level = &found.levels[0];
    let branch = level.outcome.as_ref().unwrap();
    assert!(level.condensed.is_none() && branch.is_complete());
    assert!(branch.points.iter().any(PeriodicResponse::contact_lost));
    let peak = branch.peak().unwrap();
    assert!((peak.frequency_hz() - 297.9).abs() < 0.2, "{}", peak.frequency_hz());
    assert!((peak.amplitude(1) / 4.99e-6 - 1.0).abs() < 5e-3, "{}", peak.amplitude(1));
    let check = level.check.unwrap();
    assert!(check.relative_difference < 1e-2 && level.warnings.is_empty(), "{check:?}");

    let light = cap_on_block(1e-3);
    let condensed =
        SteadyRequest { bodies: BodyModel::Condensed, from_hz: 800.0, to_hz: 2200.0, ..request };
    let found = steady(&light, &condensed).unwrap();
    let light = found.levels[0].condensed.as_ref().unwrap().light.bodies()[0].clone();
    assert!(light.name == "block" && (4e-3..8e-3).contains(&light.inertia_share), "{light:?}");
}

/// A branch of one harmonic differs from time integration as much as from a branch of twelve, and warnings name
/// that and the harmonic.
#[test]
fn a_branch_that_time_integration_does_not_confirm_has_a_warning() {
    let (from_hz, to_hz) = (216.0, 648.0);
    let request = request(3.0, BodyModel::Auto);
    let request = SteadyRequest { harmonics: Some(1), verify: true, from_hz, to_hz, ..request };
    let found = steady(&cap_on_block(5.0), &request).unwrap();
    let level = &found.levels[0];
    let [
        Warning::Unresolved { harmonics: 1, .. },
        Warning::IntegrationDiffers { frequency_hz, relative_difference },
    ] = level.warnings[..]
    else {
        panic!("{:?}", level.warnings)
    };
    let check = level.check.unwrap();
    assert_eq!(check.frequency_hz, frequency_hz);
    let own = distance(&level.outcome.as_ref().unwrap().points, frequency_hz, check.amplitude_1_m);
    assert!(own < 1e-3, "{own}");
    let many = SteadyRequest { harmonics: Some(12), verify: false, ..request };
    let many = steady(&cap_on_block(5.0), &many).unwrap();
    let points = &many.levels[0].outcome.as_ref().unwrap().points;
    let off = distance(points, frequency_hz, check.amplitude_1_m);
    assert!((relative_difference - off).abs() < 5e-3, "{relative_difference} {off}");
    assert!(relative_difference > 0.02);
}

/// A stack of bars on contacts: length \[m\], mass \[kg\] and Young's modulus \[Pa\]; area \[m2\], and coefficient
/// and exponent of a power law, or stiffness \[Pa/m\] of a contact that only pushes.
fn stack(bodies: &[(f64, f64, f64)], faces: &[(f64, f64, Option<f64>)], ratio: f64) -> Assembly {
    let body = |(n, &(length_m, mass_kg, youngs)): (usize, &(f64, f64, f64))| {
        serde_json::json!({"name": format!("bar {n}"), "length_m": length_m, "mass_kg": mass_kg,
            "youngs_modulus_pa": youngs, "density_kg_per_m3": 7850})
    };
    let face = |(n, &(area_m2, number, exponent)): (usize, &(f64, f64, Option<f64>))| {
        let law = match exponent {
            Some(exponent) => {
                serde_json::json!({"kind": "power", "coefficient": number, "exponent": exponent})
            }
            None => serde_json::json!({"kind": "constant", "stiffness_pa_per_m": number,
                "unilateral": true}),
        };
        serde_json::json!({"name": format!("face {n}"), "area_m2": area_m2, "law": law})
    };
    let scenario = serde_json::json!({
        "schema": "asperity/scenario/1",
        "bodies": bodies.iter().enumerate().map(body).collect::<Vec<_>>(),
        "interfaces": faces.iter().enumerate().map(face).collect::<Vec<_>>(),
        "damping": {"kind": "mass_proportional", "ratio": ratio},
        "duration_s": 0.1
    });
    let document = Document::parse(&scenario.to_string(), "stack.json").unwrap();
    Assembly::new(&document.scenario().unwrap(), document.folder()).unwrap()
}

/// The largest stable response of stacks that lose contact is kept by time integration from its own state: two methods
/// that share the modes alone.
#[test]
fn the_largest_stable_response_is_kept_by_time_integration() {
    let one = |area, number, exponent| vec![(area, number, exponent)];
    for (bodies, faces, ratio, force) in [
        (vec![(0.0359, 0.5395, 2e11)], one(1.603e-4, 1.43e13, None), 0.0237, 0.512),
        (vec![(0.0185, 0.2806, 7.1e10)], one(5.819e-4, 6.39e9, Some(0.5547)), 0.0378, 0.577),
        (vec![(0.149, 1.336, 7.1e10)], one(2.431e-4, 3.16e9, Some(0.511)), 0.0315, 1.708),
        (
            vec![(0.0172, 0.05723, 7.1e10), (0.1949, 1.842, 2e11), (0.1554, 5.829, 2e11)],
            vec![
                (1.026e-4, 3.0743e9, Some(0.38476)),
                (1.356e-4, 5.4616e9, Some(0.48415)),
                (6.151e-4, 1.0813e13, None),
            ],
            0.0323,
            0.1027,
        ),
        (
            vec![(0.1315, 0.2422, 2e11), (0.0237, 0.2256, 7.1e10)],
            vec![(2.358e-4, 1.399e10, Some(0.33562)), (1.17e-4, 1.9098e9, Some(0.31375))],
            0.0201,
            0.6517,
        ),
    ] {
        let assembly = stack(&bodies, &faces, ratio);
        let natural = assembly.structure.natural_frequency().unwrap();
        let (from_hz, to_hz) = (0.25 * natural, 1.5 * natural);
        let request = SteadyRequest { from_hz, to_hz, ..request(force, BodyModel::Elastic) };
        let found = steady(&assembly, &request).unwrap();
        let level = &found.levels[0];
        let kept = level.from_own_state.unwrap();
        assert_eq!(kept.motion, SteadyMotion::Periodic, "{bodies:?}: {kept:?}");
        assert!(kept.relative_difference < 2e-3 && kept.settled, "{bodies:?}: {kept:?}");
        let left = |one: &&Warning| matches!(one, Warning::NotKept { .. });
        assert_eq!(level.warnings.iter().find(left), None, "{bodies:?}");
    }
}

/// Integration from rest settles on another motion, whose amplitude is a sixth lower, and from the state of the response stays
/// there: both exist, which is another warning than a branch that may be wrong.
#[test]
fn a_response_beside_another_motion_is_not_said_to_be_wrong() {
    // Aluminium: modulus over density is what matters beside the mass.
    let bodies = [(0.08531, 1.69, 2e11), (0.07612, 0.6473, 71e9 * 7850.0 / 2700.0)];
    let faces = [(3.416e-4, 1.084e9, Some(0.5982)), (7.658e-4, 1.173e9, Some(0.3171))];
    let request = request(5.27, BodyModel::Elastic);
    let request = SteadyRequest { verify: true, from_hz: 481.5, to_hz: 480.8, ..request };
    let found = steady(&stack(&bodies, &faces, 0.01211), &request).unwrap();
    let level = &found.levels[0];
    let [Warning::AnotherMotion { frequency_hz, relative_difference }] = level.warnings[..] else {
        panic!("{:?}", level.warnings)
    };
    let check = level.check.unwrap();
    assert!(check.frequency_hz == frequency_hz && check.relative_difference == relative_difference);
    assert!((0.1..0.4).contains(&relative_difference), "{check:?}");
    let text = level.warnings[0].to_string();
    assert!(text.contains("both exist") && level.warnings[0].kind() == "another_motion", "{text}");
}

/// Thirty harmonics call a response stable that sixty call unstable: time integration from it scatters, and the
/// answer says so.
#[test]
fn a_response_that_time_integration_leaves_has_a_warning() {
    let faces = [(3.956e-4, 8.5542e12, None), (1.024e-4, 1.7907e10, Some(0.4127))];
    let assembly = stack(&[(0.0436, 0.3576, 2e11), (0.1226, 0.2105, 7.1e10)], &faces, 0.02399);
    let level = |harmonics: usize| {
        let range =
            SteadyRequest { from_hz: 1921.8, to_hz: 1919.8, ..request(0.6374, BodyModel::Elastic) };
        let request = SteadyRequest { harmonics: Some(harmonics), ..range };
        steady(&assembly, &request).unwrap().levels.remove(0)
    };
    let few = level(30);
    let own = few.from_own_state.unwrap();
    assert_eq!(own.motion, SteadyMotion::NonPeriodic, "{own:?}");
    assert!(own.scatter > 0.01 && own.relative_difference < 0.01, "{own:?}");
    assert!(few.warnings.iter().any(|one| one.kind() == "not_kept"), "{:?}", few.warnings);
    assert_eq!(few.outcome.unwrap().highest_stable().unwrap().frequency_hz(), own.frequency_hz);
    let many = level(60);
    assert_eq!(many.outcome.unwrap().highest_stable(), None);
    assert_eq!(many.from_own_state, None);
}
