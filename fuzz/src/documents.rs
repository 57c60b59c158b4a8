//! Properties of the readers of documents for any text.

use asperity_identify::IdentificationProblem;
use asperity_scenario::{Document, LoadSamples, Scenario};
use asperity_simulation::sweep::Variation;

/// Scenario that values are set in.
pub(crate) const BASE: &str = include_str!("../../fixtures/scenarios/three-body.json");

/// Longest range of `--vary` that is expanded, a matter of memory.
const LONGEST_RANGE: f64 = 1e4;

/// Largest relative error of the numbers of a range.
const ROUNDING: f64 = 1e-9;

/// A text is a valid scenario, which its own serialisation gives again, or its faults lie in it.
///
/// # Panics
/// If that does not hold.
pub fn scenario(text: &str) {
    match Document::parse(text, "fuzz.json") {
        Ok(document) => drop(checked(&document)),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}

/// The scenario of a document, if it is valid.
fn checked(document: &Document) -> Option<Scenario> {
    match document.scenario() {
        Ok(scenario) => {
            let text = serde_json::to_string(&scenario).expect("a scenario is JSON");
            let again = Document::parse(&text, "fuzz.json").expect("its JSON is read");
            assert_eq!(again.scenario().expect("it is valid again"), scenario);
            Some(scenario)
        }
        Err(invalid) => {
            assert!(!invalid.diagnostics.is_empty(), "a refusal without a fault");
            for diagnostic in &invalid.diagnostics {
                assert!(!diagnostic.fault.to_string().is_empty());
                if let Some(span) = &diagnostic.span {
                    let text = document.text();
                    assert!(text.get(span.clone()).is_some(), "a place outside the text");
                }
            }
            assert!(!invalid.to_string().is_empty());
            None
        }
    }
}

/// `POINTER=VALUE` changes a scenario that is still checked, or is refused.
///
/// # Panics
/// If a value is set and the document cannot be checked, or a refusal has no words.
pub fn set(text: &str) {
    let Some((pointer, value)) = text.split_once('=') else { return };
    let mut document = Document::parse(BASE, "fuzz.json").expect("the fixture is read");
    match document.set(pointer, value) {
        Ok(()) => drop(checked(&document)),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}

/// `POINTER=start:stop:count` gives `count` finite numbers from start to stop, and every value can
/// be set or is refused.
///
/// # Panics
/// If the numbers are others.
pub fn vary(text: &str) {
    let count: Option<f64> = text.rsplit(':').next().and_then(|count| count.trim().parse().ok());
    if count.is_some_and(|count| count > LONGEST_RANGE) {
        return;
    }
    let variation = match Variation::parse(text) {
        Ok(variation) => variation,
        Err(error) => return assert!(!error.to_string().is_empty()),
    };
    assert!(!variation.values.is_empty());
    let (_, values) = text.split_once('=').expect("a variation has a pointer");
    let parts: Vec<Option<f64>> = values.split(':').map(|part| part.trim().parse().ok()).collect();
    if let [Some(start), Some(stop), Some(count)] = parts[..]
        && !values.contains(',')
    {
        assert_eq!(variation.values.len() as f64, count);
        let numbers: Vec<f64> =
            variation.values.iter().map(|value| value.parse().expect("a number")).collect();
        let size = start.abs().max(stop.abs());
        let within = |value: &f64| {
            *value >= start.min(stop) - ROUNDING * size
                && *value <= start.max(stop) + ROUNDING * size
        };
        assert!(numbers.iter().all(within), "a value outside {start} to {stop}");
        assert_eq!(numbers[0], start);
        assert!(numbers.len() == 1 || numbers[numbers.len() - 1] == stop);
    }
    let mut document = Document::parse(BASE, "fuzz.json").expect("the fixture is read");
    for value in variation.values.iter().take(3) {
        if document.set(&variation.pointer, value).is_ok() {
            checked(&document);
        }
    }
}

/// A text is an identification problem, or is refused with words.
///
/// # Panics
/// If a refusal has no words.
pub fn problem(text: &str) {
    let Ok(document) = Document::parse(text, "fuzz.json") else { return };
    if let Err(error) = IdentificationProblem::of(document) {
        assert!(!error.to_string().is_empty());
    }
}

/// Bytes are samples of a force of increasing finite times, or are refused with words.
///
/// # Panics
/// If they are others.
pub fn load_samples(bytes: &[u8]) {
    match LoadSamples::from_csv(bytes, "force_n") {
        Ok(samples) => {
            assert_eq!(samples.time_s.len(), samples.values.len());
            assert!(samples.time_s.is_sorted_by(|one, next| one < next));
            let all = samples.time_s.iter().chain(&samples.values);
            assert!(all.copied().all(f64::is_finite));
            if let Ok(rescaled) = samples.rescaled(3.0) {
                assert_eq!(rescaled.peak().abs(), 3.0);
            }
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}
