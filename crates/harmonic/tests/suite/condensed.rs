//! Light bodies condensed into laws in series, against the single mass and against their inertia.

use std::sync::Arc;

use asperity_harmonic::{
    Branch, CondensedStack, ContactSystem, Continuation, FourierResolution, HarmonicError,
    HarmonicSettings, LawEvaluation, SpecialPointKind, Termination, trace,
};
use asperity_law::{Constant, ContactDamping, Power};
use asperity_mesh::{Body, Interface, Stack, Support};
use asperity_structure::{Damping, PreloadedStructure};

use crate::rigs::{AREA, MASS, branch, mass_on, power, preloaded, rate_on, reference_law, rig};

const FORCE: f64 = 0.55279;

fn sweep(force: f64) -> Continuation {
    Continuation::Frequency { force, from: 767.0, to: 1054.0 }
}

/// The paper's rig with another modulus of the guide and density of the sample.
fn column(modulus: f64, density: f64) -> Stack {
    let guide = Body::with_mass("guide", 0.229, MASS, modulus, 2710.0).unwrap();
    let sample = Body::new("sample", 0.015, AREA, 71e9, density).unwrap();
    let contact = |name| Interface::new(name, AREA, power()).unwrap();
    let contacts = vec![contact("upper"), contact("lower")];
    Stack::new(vec![guide, sample], contacts, Support::Rigid, 9.81).unwrap()
}

fn peak(branch: &Branch) -> (f64, f64) {
    assert_eq!(branch.termination, Termination::Reached);
    let peak = branch.peak().unwrap();
    (peak.frequency_hz(), peak.amplitude(1))
}

/// A stiff guide on a condensed sample is the single mass, with contact lost and without.
#[test]
fn a_condensed_sample_under_a_stiff_guide_is_the_law_of_the_single_mass() {
    let law = reference_law();
    let structure = preloaded(column(71e19, 1e-6), rate_on(&law));
    let condensed = CondensedStack::new(&structure, &[1], LawEvaluation::Exact).unwrap();
    let single = mass_on(&law, LawEvaluation::Exact);
    for (force, published, bound) in [(FORCE, 952.713, 1e-3), (3.0 * FORCE, 884.89, 3e-2)] {
        let found = peak(&branch(condensed.system(), sweep(force), (7, 128)));
        let exact = peak(&branch(&single, sweep(force), (7, 128)));
        assert!((found.0 / exact.0 - 1.0).abs() < 1e-8, "{found:?} {exact:?}");
        assert!((found.1 / exact.1 - 1.0).abs() < 1e-7, "{found:?} {exact:?}");
        assert!((found.0 - published).abs() < bound, "{found:?}");
    }
}

/// While contact holds, what is left out is of the first order of the sample's mass: half of a quarter
/// of it over that of the guide, 3.4e-4 in frequency on the paper's rig, as the sample moves by half.
#[test]
fn the_inertia_left_out_is_of_first_order() {
    let off = |density: f64| {
        let structure = preloaded(column(71e9, density), 416.0);
        let elastic = ContactSystem::of_structure(&structure, LawEvaluation::Exact).unwrap();
        let condensed = CondensedStack::new(&structure, &[1], LawEvaluation::Exact).unwrap();
        let of = |system: &ContactSystem| peak(&branch(system, sweep(FORCE), (9, 160)));
        let (with, without) = (of(&elastic), of(condensed.system()));
        ((without.0 / with.0 - 1.0).abs(), (without.1 / with.1 - 1.0).abs())
    };
    let (rig, half) = (off(2710.0), off(1355.0));
    assert!((rig.0 - 3.5e-4).abs() < 3e-5 && rig.1 < 5e-4, "{rig:?}");
    for slope in [(rig.0 / half.0).log2(), (rig.1 / half.1).log2()] {
        assert!((slope - 1.0).abs() < 0.05, "{slope}");
    }
}

/// At 2 N contact is lost, and the branch with the sample's inertia ends there where it is to. Without
/// it the branch completes with two folds.
#[test]
fn a_branch_with_loss_of_contact_completes() {
    let structure =
        PreloadedStructure::new(rig(&power(), Support::Rigid), Damping::Ratio(0.035)).unwrap();
    let settings = HarmonicSettings {
        resolution: FourierResolution::Automatic { tolerance: 1e-4, most: 30 },
        ..HarmonicSettings::default()
    };
    let range = Continuation::Frequency { force: 2.0, from: 1054.0, to: 700.0 };
    let elastic = ContactSystem::of_structure(&structure, LawEvaluation::default()).unwrap();
    let until_lost = HarmonicSettings { until_contact_lost: true, ..settings };
    let found = trace(&elastic, &range, &until_lost).unwrap();
    assert_eq!(found.termination, Termination::ContactLost);
    let lost: Vec<usize> =
        (0..found.points.len()).filter(|&point| found.points[point].contact_lost()).collect();
    assert_eq!(lost, [found.points.len() - 1]);

    let condensed = CondensedStack::new(&structure, &[1], LawEvaluation::default()).unwrap();
    let found = trace(condensed.system(), &range, &settings).unwrap();
    let (frequency, amplitude) = peak(&found);
    // From 5 to 50 harmonics, and with four times the samples, the same within 2e-7.
    assert!((frequency - 815.4316).abs() < 1e-3, "{frequency}");
    assert!((amplitude / 5.70426e-7 - 1.0).abs() < 1e-5, "{amplitude}");
    assert_eq!(found.of_kind(SpecialPointKind::Fold).count(), 2);
    assert!(found.points.len() < 200, "{} points", found.points.len());
    // The lower contact carries the sample as well.
    let sample = 2710.0 * 0.015 * 9.81;
    for point in &found.points {
        let [upper, lower] = condensed.pressures(point)[..] else { panic!() };
        assert_eq!(
            (upper.lowest, upper.highest),
            (point.pressures[0].lowest, point.pressures[0].highest)
        );
        assert!((lower.lowest - upper.lowest - sample).abs() < 1e-6);
        assert!((lower.highest - upper.highest - sample).abs() < 1e-6);
        assert_eq!((upper.contact_lost, lower.contact_lost), (point.contact_lost(), false));
    }
    let three = Continuation::Frequency { force: 3.0, from: 1054.0, to: 600.0 };
    assert!(trace(condensed.system(), &three, &settings).unwrap().is_complete());
}

/// A second program, for contacts that carry the guide's weight alone: 1191 points at steps of 0.02 in
/// its scaled variables are highest at 815.333 Hz and 5.70523e-7 m.
#[test]
fn the_peak_with_loss_of_contact_is_that_of_a_second_program() {
    let rate = 2.0 * 0.035 * std::f64::consts::TAU * 946.86;
    let structure = preloaded(column(71e9, 1e-6), rate);
    let condensed = CondensedStack::new(&structure, &[1], LawEvaluation::Exact).unwrap();
    let range = Continuation::Frequency { force: 2.0, from: 700.0, to: 1054.0 };
    let found = branch(condensed.system(), range, (15, 240));
    let (frequency, amplitude) = peak(&found);
    assert!((frequency - 815.33).abs() < 0.1, "{frequency}");
    assert!((amplitude / 5.70523e-7 - 1.0).abs() < 2e-5, "{amplitude}");
    assert_eq!(found.of_kind(SpecialPointKind::Fold).count(), 2);
}

/// Two neighbours of four bodies, on contacts of different areas: the linear response at low
/// frequencies is that of the elastic stack, with an error of the second order of the frequency.
#[test]
fn neighbours_on_different_areas_are_springs_in_series() {
    let bar = |length, mass| Body::with_mass("bar", length, mass, 71e9, 2710.0).unwrap();
    let law = |k| Arc::new(Constant::new(k).unwrap());
    let contact = |area, k| Interface::new("contact", area, law(k)).unwrap();
    let bodies = vec![bar(0.2, 2.0), bar(0.01, 0.004), bar(0.02, 0.01), bar(0.1, 1.0)];
    let areas = [1e-4, 2e-4, 1.5e-4, 3e-4];
    let contacts = areas.into_iter().zip([8e11, 6e11, 9e11, 5e11]);
    let contacts = contacts.map(|(area, k)| contact(area, k)).collect();
    let stack = Stack::new(bodies, contacts, Support::Rigid, 9.81).unwrap();
    let structure = preloaded(stack, 0.0);
    let elastic = ContactSystem::of_structure(&structure, LawEvaluation::Exact).unwrap();
    let condensed = CondensedStack::new(&structure, &[1, 2], LawEvaluation::Exact).unwrap();
    let contacts = condensed.system().contacts();
    assert_eq!(contacts.len(), 2);
    let springs = structure.contacts()[..3].iter().map(|contact| 1.0 / contact.spring());
    let bars = structure.stack().bodies()[1..3].iter().map(|b| b.length() / b.axial_rigidity());
    let soft = springs.sum::<f64>() + bars.sum::<f64>();
    assert!((contacts[0].spring() * soft - 1.0).abs() < 1e-12);
    let off = |hz: f64| {
        let of = |system| asperity_harmonic::linear_receptance(system, hz);
        (of(condensed.system()) / of(&elastic) - 1.0).norm()
    };
    let slope = (off(40.0) / off(20.0)).log2();
    assert!((slope - 2.0).abs() < 0.1 && off(40.0) < 1e-4, "{slope}, {:.1e}", off(40.0));
}

/// The top body is driven, and bodies between contacts of other damping keep their inertia.
#[test]
fn bodies_that_cannot_be_condensed_are_refused() {
    let evaluation = LawEvaluation::Exact;
    let structure = preloaded(column(71e9, 2710.0), 416.0);
    assert_eq!(CondensedStack::candidates(&structure), [1]);
    for body in [0, 2] {
        let error = CondensedStack::new(&structure, &[body], evaluation).unwrap_err();
        assert_eq!(error, HarmonicError::NotCondensable { body });
        assert!(CondensedStack::body_frequency(&structure, body).is_nan());
    }
    let damped = |damping: [Option<ContactDamping>; 2]| {
        let stack = column(71e9, 2710.0);
        let contacts = stack.interfaces().iter().zip(damping).map(|(contact, damping)| {
            damping.map_or(contact.clone(), |damping| contact.clone().with_damping(damping))
        });
        let (bodies, contacts) = (stack.bodies().to_vec(), contacts.collect());
        let stack = Stack::new(bodies, contacts, Support::Rigid, 9.81).unwrap();
        CondensedStack::candidates(&preloaded(stack, 416.0))
    };
    let viscous = |time| Some(ContactDamping::kelvin_voigt(time).unwrap());
    let own = Some(ContactDamping::power(1e6, 1e5, 0.5).unwrap());
    assert_eq!(damped([viscous(4e-6), viscous(4e-6)]), [1]);
    for unlike in [[viscous(4e-6), viscous(5e-6)], [viscous(4e-6), None], [own, own]] {
        assert!(damped(unlike).is_empty(), "{unlike:?}");
    }
}

/// A heavy bar on a unilateral spring, and another on it by a power law, both lost within the period: the branch
/// is whole, and its folds are those of the structure, the same for 8 harmonics and for 12.
#[test]
fn folds_of_two_bars_that_come_apart_do_not_depend_on_the_samples() {
    let upper = Arc::new(Power::new(1.79e10, 0.492, 0.0).unwrap());
    let lower = Arc::new(Constant::unilateral(4.6e12).unwrap());
    let bar = |length, mass| Body::with_mass("bar", length, mass, 2e11, 2700.0).unwrap();
    let contacts = vec![
        Interface::new("upper", 8e-4, upper).unwrap(),
        Interface::new("lower", 1.52e-4, lower).unwrap(),
    ];
    let bars = vec![bar(0.0875, 1.197), bar(0.1636, 4.971)];
    let stack = Stack::new(bars, contacts, Support::Rigid, 9.81).unwrap();
    let structure = PreloadedStructure::new(stack, Damping::Rate(395.0)).unwrap();
    let system = ContactSystem::of_structure(&structure, LawEvaluation::default()).unwrap();
    let range = Continuation::Frequency { force: 3.78, from: 415.0, to: 2490.0 };
    let folds = |harmonics: usize| {
        let resolution = FourierResolution::Fixed { harmonics, samples: 16 * harmonics };
        let settings = HarmonicSettings { resolution, ..HarmonicSettings::default() };
        let branch = trace(&system, &range, &settings).unwrap();
        assert!(branch.is_complete(), "{harmonics}: {:?}", branch.termination);
        assert!(branch.points.iter().any(|point| point.pressures.iter().all(|p| p.contact_lost)));
        assert!(branch.points.len() < 1500, "{harmonics}: {} points", branch.points.len());
        branch.of_kind(SpecialPointKind::Fold).count()
    };
    assert_eq!(folds(8), folds(12));
}
