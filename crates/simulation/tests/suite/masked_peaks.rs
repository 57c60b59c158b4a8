//! Maxima that are no peaks, or hardly are: the force is too weak, or ripples of the record's end are about as high.

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
