//! Peaks where the force is too weak.

use asperity_scenario::Document;
use asperity_simulation::run::simulate;
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
