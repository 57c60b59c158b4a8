//! Peaks under a weak force and of a record that ends early: maxima that are none, or hardly are, and peaks that are widened.

use asperity_scenario::Document;
use asperity_simulation::run::simulate;
use asperity_simulation::warning::Warning;
use serde_json::json;

/// A half-sine has no force at 1.5 over its duration. With that at the fundamental a response has no peak, and names
/// the maximum there.
#[test]
fn a_fundamental_at_a_zero_of_the_force_is_named() {
    let text = std::fs::read_to_string("examples/block.json").unwrap();
    let run = |duration: f64| {
        let mut document = Document::parse(&text, "examples/block.json").unwrap();
        let pulse = json!({ "kind": "half_sine", "peak_n": 0.01, "duration_s": duration });
        document.set("/excitation", &pulse.to_string()).unwrap();
        simulate(&document, &document.scenario().unwrap()).unwrap().summary
    };
    let excited = run(1e-4);
    let fundamental = excited.fundamental.unwrap().frequency_hz;
    assert!(excited.masked_hz.is_empty(), "{:?}", excited.masked_hz);
    let masked = run(1.5 / fundamental);
    assert!(masked.fundamental.is_none(), "{:?}", masked.fundamental);
    let named = masked.masked_hz.iter().any(|hz| (hz / fundamental - 1.0).abs() < 0.02);
    assert!(named, "{fundamental}: {:?}", masked.masked_hz);
}

/// A maximum hardly higher than the ripples of a record that ends while it rings: both engines say that it is not certain
/// whether it is a peak; of the record half as long again neither does.
#[test]
fn a_maximum_that_is_hardly_a_peak_is_a_warning() {
    for method in ["modal", "finite_difference"] {
        let run = |longer: f64| {
            let mut document =
                Document::read("../../fixtures/cases/seed20261304-979.json").unwrap();
            document.set("/method/kind", method).unwrap();
            let duration = document.scenario().unwrap().duration_s;
            document.set("/duration_s", &(longer * duration).to_string()).unwrap();
            simulate(&document, &document.scenario().unwrap()).unwrap().summary
        };
        let is_marginal = |longer: f64| {
            let of_peak = |warning: &Warning| matches!(warning, Warning::MarginalPeak { .. });
            run(longer).warnings.iter().any(of_peak)
        };
        assert!(is_marginal(1.0), "{method}");
        assert!(!is_marginal(1.5), "{method}");
    }
}

/// A ripple on the flank of a pole where the force vanishes, whose minimum on that side is beyond the pole and is none of it: f1 of a modal
/// response, which finite differences do not have. A warning says that it may be none.
#[test]
fn a_ripple_on_the_flank_of_a_pole_is_a_warning() {
    let document = Document::read("../../fixtures/cases/seed20261322-940.json").unwrap();
    let summary = simulate(&document, &document.scenario().unwrap()).unwrap().summary;
    let f1 = summary.fundamental.unwrap().frequency_hz;
    let of_f1 = |warning: &Warning| matches!(warning, Warning::MarginalPeak { frequency_hz, .. } if (frequency_hz - f1).abs() < 1.0);
    let is_right = (f1 - 50.81).abs() < 0.1;
    assert!(is_right || summary.warnings.iter().any(of_f1), "{f1}: {:?}", summary.warnings);
}

/// A structure whose largest motion is beside a zero of the force: f1 is a ripple or another maximum, and both engines name
/// the frequency of the motion. Of one whose resonance is beside such a zero, and found, neither does.
#[test]
fn a_resonance_that_a_weak_force_hides_is_named() {
    for (case, hidden) in [("seed20261312-949", Some(95.0)), ("seed20261315-310", None)] {
        for method in ["modal", "finite_difference"] {
            let mut document = Document::read(format!("../../fixtures/cases/{case}.json")).unwrap();
            document.set("/method/kind", method).unwrap();
            let summary = simulate(&document, &document.scenario().unwrap()).unwrap().summary;
            let named = summary.warnings.iter().find_map(|warning| match warning {
                Warning::HiddenResonance { frequency_hz } => Some(*frequency_hz),
                _ => None,
            });
            let is_right = match (named, hidden) {
                (Some(named), Some(hidden)) => f64::abs(named - hidden) < 1.0,
                (named, hidden) => named == hidden,
            };
            assert!(is_right, "{case} {method}: {named:?}, {hidden:?}");
        }
    }
}

/// A record that ends while a twentieth of the decay remains: both engines say so, and that it widens the peak; of the whole decay
/// neither does.
#[test]
fn a_record_that_ends_early_is_a_warning() {
    for method in ["modal", "finite_difference"] {
        let run = |duration: f64| {
            let mut document = Document::read("examples/block.json").unwrap();
            document.set("/method", method).unwrap();
            document.set("/duration_s", &duration.to_string()).unwrap();
            let summary = simulate(&document, &document.scenario().unwrap()).unwrap().summary;
            let remaining = summary.warnings.iter().find_map(|warning| match warning {
                Warning::NotDecayed { remaining } => Some(*remaining),
                _ => None,
            });
            let first = summary.fundamental.unwrap();
            (first.damping_ratio.unwrap() / first.damping_ratio_decrement.unwrap(), remaining)
        };
        let (over, remaining) = run(0.05);
        assert!(over < 1.05 && remaining.is_none(), "{method}: {over} {remaining:?}");
        let (over, remaining) = run(0.015);
        assert!(
            over > 1.1 && remaining.is_some_and(|remaining| (0.05..0.2).contains(&remaining)),
            "{method}: {over} {remaining:?}"
        );
    }
}
