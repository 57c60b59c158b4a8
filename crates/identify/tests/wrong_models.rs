//! Random rigs with wrong models: what would explain their data better.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a test fails by panicking")]
#![allow(missing_docs, unreachable_pub, dead_code, reason = "the rigs are shared with the example")]

#[path = "support/laws.rs"]
mod laws;
#[path = "support/twin.rs"]
mod twin;
#[path = "support/wrong_models.rs"]
mod wrong_models;

use asperity_identify::{Usability, identify};
use wrong_models::Rig;

/// Contacts dissipate, and the model has damping of the bodies alone: the law is void, and contact damping is the
/// first explanation, with most of the excess of chi-square.
#[test]
fn contact_damping_that_the_model_lacks_is_the_first_explanation() {
    let found = identify(&Rig::new(1, 0).problem(false)).unwrap();
    assert_eq!(found.judgement().usability, Usability::No);
    let first = &found.explanations[0];
    assert!(first.cause.starts_with("contact damping of"), "{:?}", found.explanations);
    let goodness = &found.goodness;
    let excess = goodness.chi_square - goodness.degrees_of_freedom as f64;
    let left = first.chi_square.unwrap() - goodness.degrees_of_freedom as f64;
    assert!(left < 0.2 * excess, "{:?}", found.explanations);
}
