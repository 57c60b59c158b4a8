//! The single-mass reference case, on which four published tools agree, and three times its force.

use asperity_harmonic::{
    ContactSystem, Continuation, Floquet, FourierResolution, HarmonicSettings, LawEvaluation,
    SpecialPointKind, Termination, trace,
};
use asperity_mesh::{Body, Interface, Stack, Support};

use crate::integration::{Motion, state_of};
use crate::rigs::{AREA, MASS, branch, mass_on, power, preloaded, rate_on, reference_law};

const FORCE: f64 = 0.55279;

fn sweep(force: f64) -> Continuation {
    Continuation::Frequency { force, from: 767.0, to: 1054.0 }
}

/// Published to six digits.
#[test]
fn the_peak_is_the_published_one() {
    let law = reference_law();
    for evaluation in [LawEvaluation::Exact, LawEvaluation::default()] {
        let found = branch(&mass_on(&law, evaluation), sweep(FORCE), (7, 128));
        assert_eq!(found.termination, Termination::Reached);
        let peak = found.of_kind(SpecialPointKind::Peak).next().unwrap();
        assert!((peak.frequency_hz() - 952.71).abs() < 5e-3, "{}", peak.frequency_hz());
        assert!((peak.amplitude(1) / 1.35887e-7 - 1.0).abs() < 5e-6, "{}", peak.amplitude(1));
        assert!(
            (peak.displacement_ratio() - 0.01344).abs() < 5e-6,
            "{}",
            peak.displacement_ratio()
        );
        assert!(!peak.contact_lost());
    }
}

/// The table's tolerance of 1e-8 of the static pressure, against the law itself.
#[test]
fn the_table_changes_amplitudes_by_its_tolerance() {
    let law = reference_law();
    let of = |evaluation| branch(&mass_on(&law, evaluation), sweep(FORCE), (7, 128));
    let (exact, table) = (of(LawEvaluation::Exact), of(LawEvaluation::default()));
    let ratio = exact.highest().unwrap().amplitude(1) / table.highest().unwrap().amplitude(1);
    assert!((ratio - 1.0).abs() < 1e-7, "{ratio}");
}

/// Direct integration, at the published frequency; decays of 0.8 a period leave 1e-19 after 200.
#[test]
fn the_peak_is_that_of_direct_integration() {
    let law = reference_law();
    let continuation = Continuation::Frequency { force: FORCE, from: 952.43, to: 960.0 };
    let found = branch(&mass_on(&law, LawEvaluation::Exact), continuation, (7, 128));
    let motion = Motion { law: &law, rate: rate_on(&law), force: FORCE, frequency: 952.43 };
    let settled = motion.settled([0.0, 0.0], 200, 3);
    assert!((settled[0] / 1.35882e-7 - 1.0).abs() < 5e-5, "{}", settled[0]);
    for (k, integrated) in (1..).zip(settled) {
        let ratio = found.points[0].amplitude(k) / integrated;
        // Seven harmonics leave 1e-10 of the fundamental; the third is 1e-4 of it.
        assert!((ratio - 1.0).abs() < 1e-5, "harmonic {k}: {ratio}");
    }
}

/// At three times the force contact is lost, and between two folds there are two stable responses
/// and an unstable one at each frequency.
#[test]
fn three_times_the_force_loses_contact_and_folds() {
    let law = reference_law();
    let system = mass_on(&law, LawEvaluation::Exact);
    let settings = HarmonicSettings {
        resolution: FourierResolution::Automatic { tolerance: 1e-7, most: 60 },
        stability: Some(Floquet::default()),
        ..HarmonicSettings::default()
    };
    let found = trace(&system, &sweep(3.0 * FORCE), &settings).unwrap();
    assert!(found.is_complete() && found.truncation() < 1e-7, "{:.1e}", found.truncation());
    let folds: Vec<_> = found.special.iter().filter(|s| s.kind == SpecialPointKind::Fold).collect();
    assert_eq!(found.special.len(), 3, "two folds and a peak");
    assert_eq!(folds.len(), 2);
    for fold in &folds {
        let multipliers = fold.response.multipliers.as_ref().unwrap();
        // The disturbance's integration across loss of contact, of order 1.5, leaves 1.2e-4.
        assert!((multipliers[0].re - 1.0).abs() < 3e-4, "{multipliers:?}");
    }
    // Stable, unstable between the folds, stable.
    for (number, point) in found.points.iter().enumerate() {
        let between = number > folds[0].after && number <= folds[1].after;
        assert_eq!(point.stable(), Some(!between), "point {number}");
    }
    assert!(found.highest().unwrap().contact_lost());

    // Time integration started on each of the three.
    let upper = folds[0].response.frequency_hz();
    let lower = folds[1].response.frequency_hz();
    let frequency = 0.5 * (lower + upper);
    let nearest = |range: std::ops::Range<usize>| {
        let off = |i: &usize| (found.points[*i].frequency_hz() - frequency).abs();
        &found.points[range.min_by(|a, b| off(a).total_cmp(&off(b))).unwrap()]
    };
    let motion = |at: &asperity_harmonic::PeriodicResponse| Motion {
        law: &law,
        rate: rate_on(&law),
        force: 3.0 * FORCE,
        frequency: at.frequency_hz(),
    };
    let (first, second) = (folds[0].after + 1, folds[1].after + 1);
    let (low, middle, high) =
        (nearest(0..first), nearest(first..second), nearest(second..found.points.len()));
    assert!(low.amplitude(1) < middle.amplitude(1) && middle.amplitude(1) < high.amplitude(1));
    for stable in [low, high] {
        // From states a little off; 300 periods forget them.
        let [u, v] = state_of(stable);
        let settled = motion(stable).settled([1.02 * u, 0.98 * v], 300, 2);
        for (k, integrated) in (1..).zip(settled) {
            let ratio = stable.amplitude(k) / integrated;
            assert!((ratio - 1.0).abs() < 1e-5, "harmonic {k}: {ratio}");
        }
    }
    // On the unstable one the motion stays for a period, and then leaves for a stable one.
    let [u, v] = state_of(middle);
    let after = motion(middle).period([u, v], |_| ());
    assert!((after[0] - u).abs() < 1e-4 * middle.amplitude(1));
    let settled = motion(middle).settled([1.001 * u, v], 400, 1)[0];
    assert!((settled / middle.amplitude(1) - 1.0).abs() > 0.05, "{settled}");
}

/// A stiff guide on a nearly massless sample is the single mass: its peaks at both forces, contact
/// lost at the greater.
#[test]
fn a_light_sample_under_a_stiff_guide_gives_the_peaks_of_the_single_mass() {
    let law = reference_law();
    let single = mass_on(&law, LawEvaluation::Exact);
    for density in [1.0, 1e-3] {
        let guide = Body::with_mass("guide", 0.229, MASS, 71e15, 2710.0).unwrap();
        let sample = Body::new("sample", 0.015, AREA, 71e9, density).unwrap();
        let contact = |name| Interface::new(name, AREA, power()).unwrap();
        let contacts = vec![contact("upper"), contact("lower")];
        let stack = Stack::new(vec![guide, sample], contacts, Support::Rigid, 9.81).unwrap();
        let structure = preloaded(stack, rate_on(&law));
        let system = ContactSystem::of_structure(&structure, LawEvaluation::Exact).unwrap();
        // With contact lost, the two contacts share a closure differently in few harmonics.
        for (force, published, bounds) in
            [(FORCE, 952.713, [1e-4, 1e-3]), (3.0 * FORCE, 884.89, [5e-3, 3e-2])]
        {
            let found = branch(&system, sweep(force), (7, 128));
            assert_eq!(found.termination, Termination::Reached);
            let peak = found.of_kind(SpecialPointKind::Peak).next().unwrap().frequency_hz();
            let reference = branch(&single, sweep(force), (7, 128));
            let reference = reference.highest().unwrap().frequency_hz();
            let off = [reference, published].map(|other| (peak - other).abs());
            assert!(off[0] < bounds[0] && off[1] < bounds[1], "{density} kg/m3: {peak}, {off:?}");
        }
    }
}

/// A fold over frequency at a fixed force is a fold over force at that fixed frequency: the same
/// equations with another parameter.
#[test]
fn folds_over_frequency_are_folds_over_force() {
    let system = mass_on(&reference_law(), LawEvaluation::Exact);
    let resolution = (15, 256);
    let over_frequency = branch(&system, sweep(3.0 * FORCE), resolution);
    let folds: Vec<_> = over_frequency.of_kind(SpecialPointKind::Fold).collect();
    assert_eq!(folds.len(), 2);
    for fold in folds {
        let continuation =
            Continuation::Force { frequency: fold.frequency_hz(), from: 0.1, to: 3.0 };
        let over_force = branch(&system, continuation, resolution);
        assert_eq!(over_force.termination, Termination::Reached);
        let found: Vec<_> = over_force.of_kind(SpecialPointKind::Fold).collect();
        assert_eq!(found.len(), 2);
        let off = |response: &&asperity_harmonic::PeriodicResponse| {
            (response.amplitude(1) / fold.amplitude(1) - 1.0).abs()
        };
        let same = found.iter().copied().min_by(|a, b| off(a).total_cmp(&off(b))).unwrap();
        // Forces are stationary at a fold, amplitudes are not.
        assert!((same.force / (3.0 * FORCE) - 1.0).abs() < 1e-10, "{}", same.force);
        assert!(off(&same) < 1e-6, "{:.1e}", off(&same));
    }
}
