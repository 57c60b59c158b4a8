//! Rayleigh damping that two damping ratios determine.

use super::Node;
use crate::damping::{RatioAtFrequency, RayleighSpec};
use crate::diagnostic::Diagnostic;
use crate::fault::Fault;

/// Checks the damping of the bodies.
pub(super) fn check(root: &Node<'_>, found: &mut Vec<Diagnostic>) {
    let Some(damping) = root.get("damping") else { return };
    if damping.text("kind") != Some("rayleigh") {
        return;
    }
    let ratios = damping.items("ratios");
    let of = |node: &Node<'_>| {
        let (frequency_hz, ratio) = (node.number("frequency_hz")?, node.number("ratio")?);
        Some(RatioAtFrequency { frequency_hz, ratio })
    };
    let [first, second] = ratios.as_slice() else { return };
    let at = damping.at.child("ratios");
    if let Some(rate) = damping.get("rate_per_s") {
        let fault = Fault::SeveralGiven(vec!["rate_per_s".to_owned(), "ratios".to_owned()]);
        found.push(Diagnostic::new(&rate.at, fault, "ratios alone, or rate_per_s and time_s"));
    }
    let (Some(first), Some(second)) = (of(first), of(second)) else { return };
    let (rate, time) = RayleighSpec::Ratios([first, second]).coefficients();
    let accepted = "two different frequencies, the ratio at the higher over that at the lower between the quotient of the lower and the higher frequency and its inverse";
    if first.frequency_hz == second.frequency_hz {
        let fault = Fault::EqualFrequencies(first.frequency_hz);
        found.push(Diagnostic::new(&at, fault, accepted));
        return;
    }
    for (quantity, value) in [("rate_per_s", rate), ("time_s", time)] {
        if !(value.is_finite() && value >= 0.0) {
            let fault = Fault::NegativeDamping { quantity, value };
            found.push(Diagnostic::new(&at, fault, accepted));
            return;
        }
    }
}
