//! Tractions over closures of contacts, against the energy ledger of the integrator.

use asperity_scenario::Document;
use asperity_simulation::contact_path::contact_paths;
use asperity_simulation::run::{Run, simulate};

/// The block under a hit, with an output rate and an interface of more keys.
fn run_of(interface: &[(&str, &str)], rate_hz: f64) -> Run {
    let mut document = Document::read("examples/block.json").unwrap();
    for (key, value) in interface {
        document.set(&format!("/interfaces/0/{key}"), value).unwrap();
    }
    document.set("/output_rate_hz", &rate_hz.to_string()).unwrap();
    simulate(&document, &document.scenario().unwrap()).unwrap()
}

/// Work \[J\] of the tractions of the contact above rest over its area: a closed path, since the motion has decayed.
fn work(run: &Run) -> f64 {
    let paths = contact_paths(run);
    let [path] = &paths[..] else { panic!("one contact") };
    let (_, rest) = path.at_rest();
    let steps = path.closure.windows(2).zip(path.traction.windows(2));
    let work: f64 = steps.map(|(d, s)| (0.5 * (s[0] + s[1]) - rest) * (d[1] - d[0])).sum();
    1e-4 * work
}

/// The loop of a damped contact encloses its viscous loss; the difference falls with the square of the
/// output interval.
#[test]
fn the_loop_of_a_damped_contact_encloses_its_loss() {
    for damping in [
        r#"{"kind": "kelvin_voigt", "time_s": 1e-5}"#,
        r#"{"kind": "power", "coefficient_pa_s_per_m": 1e7, "reference_pa": 1e5, "exponent": 0.5}"#,
    ] {
        let error = |rate_hz: f64| {
            let run = run_of(&[("damping", damping)], rate_hz);
            work(&run) / run.transient.energy.contact_dissipated - 1.0
        };
        let errors = [50e3, 100e3, 200e3].map(error);
        let falls = |pair: &[f64]| (3.0..6.0).contains(&(pair[0] / pair[1]));
        assert!(errors[2].abs() < 1e-3 && errors.windows(2).all(falls), "{damping}: {errors:?}");
    }
}

/// So does the loop of friction across the closure.
#[test]
fn the_loop_of_friction_encloses_its_loss() {
    let friction = r#"{"stiffness_n_per_m": 1e9, "slip_force_n": 0.5}"#;
    let error = |rate_hz: f64| {
        let run = run_of(&[("friction", friction)], rate_hz);
        work(&run) / run.transient.energy.friction_dissipated - 1.0
    };
    // The element and the law stay strained at the end, by 1e-4 of the loss.
    let errors = [200e3, 800e3].map(error);
    assert!(errors[0].abs() < 2e-3 && errors[1].abs() < 3e-4, "{errors:?}");
}

#[test]
fn the_path_of_an_elastic_contact_is_its_law() {
    let run = run_of(&[], 50e3);
    let paths = contact_paths(&run);
    assert!(!paths[0].is_dissipative());
    for (closure, pressure) in paths[0].closure.iter().zip(&*paths[0].traction) {
        assert!((paths[0].law(*closure) - pressure).abs() < 1e-9 * 1e6, "{closure}");
    }
}
