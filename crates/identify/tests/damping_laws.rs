//! Numbers of damping as parameters of an identification.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a test fails by panicking")]
#![allow(missing_docs, unreachable_pub, dead_code, reason = "the twin is shared with other tests")]

#[path = "support/losses.rs"]
mod losses;
#[path = "support/twin.rs"]
mod twin;

use asperity_identify::identify;
use losses::{KINDS, Observed};
use serde_json::json;
use twin::{Sensors, Truth};

const SCENARIO: &str = "../../fixtures/scenarios/nouira2020-modified.json";

/// Retardation time of the contacts \[s\].
const TIME_S: f64 = 6e-6;

/// Hits by finite differences on a rig with damped contacts, identification by the modal engine: the
/// retardation time of both contacts is found within its band, and its derivatives are exact. Damping
/// of the bodies instead explains the data less well.
#[test]
fn the_retardation_time_of_contacts_is_identified() {
    let damping = json!({"kind": "kelvin_voigt", "time_s": TIME_S}).to_string();
    let changes = [
        ("/output_rate_hz", "50000"),
        ("/duration_s", "0.06"),
        ("/damping/ratio", "0.01"),
        ("/interfaces/0/damping", damping.as_str()),
        ("/interfaces/1/damping", damping.as_str()),
    ];
    let twin = Truth::new(SCENARIO, &[9.0, 20.0, 32.0], &changes);
    let sensors =
        Sensors { signal_to_noise_db: 50.0, force_gain: 1.0, response_gain: 1.0, seed: 11 };
    let unknowns = json!([
        {"kind": "scalar", "pointer": "/interfaces/0/damping/time_s",
         "also": ["/interfaces/1/damping/time_s"], "bounds": [1e-7, 1e-4], "start": 2e-6},
    ]);
    let none = json!({"kind": "kelvin_voigt", "time_s": 0.0});
    let more = json!({
        "draws": 100,
        "starts": 1,
        "compare": [{
            "name": "damped bodies",
            "set": {"/interfaces/0/damping": none, "/interfaces/1/damping": none},
            "unknowns": [{"kind": "scalar", "pointer": "/damping/ratio", "bounds": [1e-3, 0.2]}],
        }],
    });
    let found = identify(&twin.problem(&twin.measured(&sensors), &unknowns, &more)).unwrap();
    let time = &found.estimates()[0];
    let [low, high] = time.posterior_interval;
    assert!((low..=high).contains(&TIME_S) && high < 1.1 * low, "{time:?}");
    assert!(found.linearisation.exact);
    let off = found.linearisation.derivative_difference.unwrap();
    assert!(off < 1e-3, "{off}");
    assert!(found.explains() && found.has_converged(), "{:?}", found.conclusions());
    let comparison = found.comparison.as_ref().unwrap();
    assert_eq!(comparison.best, 0, "{:?}", found.conclusions());
    assert_eq!(comparison.candidates[0].name, "the problem's scenario");
    assert_eq!(comparison.candidates[1].name, "damped bodies");
}

/// Hits with each kind of loss, 40 dB of noise, compared by frequency and damping along their decays: the
/// right kind is the best and the others are rejected. (The example `damping_kinds` counts more.)
#[test]
fn the_kind_of_loss_is_decided_by_backbones() {
    for kind in KINDS {
        let (truth, size) = losses::truth(kind, 1);
        let measured = losses::comparison(&truth, Observed::Backbones, 1);
        let found = identify(&measured.problem).unwrap();
        let comparison = found.comparison.as_ref().unwrap();
        let best = KINDS[comparison.best];
        let others = comparison.candidates.iter().enumerate().filter(|(i, _)| *i != comparison.best);
        println!("{kind} {size}: best {best}");
        for candidate in &comparison.candidates {
            println!(
                "  {} {:?} chi2 {:.1}/{} point {:?}",
                candidate.name,
                candidate.assessment,
                candidate.goodness.chi_square,
                candidate.goodness.degrees_of_freedom,
                candidate.fit.point
            );
        }
        assert_eq!(best, kind, "{:?}", found.conclusions());
        assert!(others.into_iter().all(|(_, one)| one.assessment.is_rejected()), "{kind}");
    }
}

/// The coefficient of friction beside an unknown damping ratio of the bodies: within its band, by exact
/// derivatives.
#[test]
fn the_coefficient_of_friction_is_identified() {
    let (truth, size) = losses::truth("friction", 3);
    let found = identify(&losses::friction(&truth, Observed::All, 3).problem).unwrap();
    let mu = &found.estimates()[0];
    let [low, high] = mu.posterior_interval;
    println!("{size} {mu:?} {:?}", found.linearisation.derivative_difference);
    assert!((low..=high).contains(&(0.003 * size)) && high < 1.2 * low, "{size}: {mu:?}");
    assert!(found.linearisation.exact);
    let off = found.linearisation.derivative_difference.unwrap();
    assert!(off < 0.02, "{off}");
    assert!(found.explains() && found.has_converged(), "{:?}", found.conclusions());
}
