//! Random rigs with wrong models: what would explain their data better.

use crate::twin::is_long;
use crate::wrong_models::Rig;
use asperity_identify::{Usability, identify};

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

/// Right models whose first search ends far from the data: one in a minimum that the posterior leaves, one with a free law at
/// the tolerance of searches near the data.
#[test]
fn right_models_reach_their_data() {
    if !is_long() {
        return;
    }
    for number in [11, 12] {
        let found = identify(&Rig::new(20_261_129, number).problem(true).fast()).unwrap();
        assert!(found.explains(), "{number}: {:?}", found.goodness);
        assert_ne!(found.judgement().usability, Usability::No, "{:?}", found.judgement());
    }
}
