//! Rayleigh damping that two damping ratios determine.

use asperity_structure::{RatioAtFrequency, RayleighFault, RayleighSpec};
use serde::Deserialize;

use super::node::Node;
use crate::diagnostic::Diagnostic;
use crate::fault::Fault;

/// Checks the damping of the bodies.
pub(super) fn check(root: &Node<'_>, found: &mut Vec<Diagnostic>) {
    let Some(damping) = root.get("damping") else { return };
    if damping.text("kind") != Some("rayleigh") || damping.items("ratios").len() != 2 {
        return;
    }
    let Some(ratios) = damping.get("ratios") else { return };
    if let Some(rate) = damping.get("rate_per_s") {
        let fault = Fault::SeveralGiven(vec!["rate_per_s".to_owned(), "ratios".to_owned()]);
        found.push(Diagnostic::new(&rate.at, fault, "ratios alone, or rate_per_s and time_s"));
    }
    let Ok(pair) = <[RatioAtFrequency; 2]>::deserialize(ratios.value) else { return };
    if let Some(fault) = RayleighSpec::Ratios(pair).fault() {
        let fault = match fault {
            RayleighFault::EqualFrequencies(frequency) => Fault::EqualFrequencies(frequency),
            RayleighFault::Negative { quantity, value } => {
                Fault::NegativeDamping { quantity, value }
            }
        };
        found.push(Diagnostic::new(&ratios.at, fault, RayleighFault::ACCEPTED));
    }
}
