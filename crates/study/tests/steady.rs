//! Steady responses with loss of contact: condensed bodies, and motions that are not periodic.

#![allow(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

use asperity_harmonic::SpecialPointKind;
use asperity_scenario::Document;
use asperity_study::assemble::Assembly;
use asperity_study::error::StudyError;
use asperity_study::steady::{
    BodyModel, Condensation, CondensationReason, SteadyMotion, SteadyRequest, steady,
};

/// The paper's rig with the power law on both contacts.
fn rig() -> Assembly {
    let path =
        concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/scenarios/nouira2020-modified.json");
    let mut document = Document::read(path).unwrap();
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
    }
}

/// By default the sample keeps its inertia where contact holds, and is condensed where it is lost.
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

/// On request bodies are condensed without loss as well; one that is not far above the range is not.
#[test]
fn requests_are_honoured_or_refused() {
    let found = steady(&rig(), &request(0.5, BodyModel::Condensed)).unwrap();
    let reason = found.levels[0].condensed.as_ref().unwrap().reason;
    assert_eq!(reason, CondensationReason::Requested);
    let high = SteadyRequest { to_hz: 4000.0, ..request(0.5, BodyModel::Condensed) };
    let error = steady(&rig(), &high).unwrap_err();
    assert!(matches!(error, StudyError::NothingToCondense { .. }), "{error}");
    assert!(error.is_wrong_request());
    for part in ["sample at 3", "at least 40000.0 Hz"] {
        assert!(error.to_string().contains(part), "{error}");
    }
    let elastic = steady(&rig(), &request(0.5, BodyModel::Elastic)).unwrap();
    assert!(elastic.levels[0].condensed.is_none());
}
