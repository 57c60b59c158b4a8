//! One suite for all contact laws, over wide ranges of parameters and pressures.
//!
//! Pressures are 1 Pa to 1e9 Pa. The properties are in `suite.rs`, the families
//! of laws in `families.rs`.

mod families;
mod suite;

use std::sync::Arc;

use asperity_law::{ContactLaw, InSeries, LawsInSeries, SeriesContact};
use proptest::prelude::*;

use suite::conform;

/// One test per family, with random laws and pressures.
macro_rules! family {
    ($($name:ident),* $(,)?) => {
        proptest! {
            #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]
            $(
                #[test]
                fn $name(law in families::$name(), p in families::pressures()) {
                    conform(&law, &p)?;
                }
            )*
        }
    };
}

family!(
    constant,
    constant_unilateral,
    power_below_one,
    power_below_one_referred,
    power_from_one_on,
    power_next_to_one,
    exponential,
    hyperbolic,
    table,
    modified_power,
);

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn in_series(
        inner in families::any(),
        layer in families::log_uniform(1e8, 1e17),
        p in families::pressures(),
    ) {
        conform(&InSeries::new(inner, layer).unwrap(), &p)?;
    }

    #[test]
    fn in_series_twice(
        inner in families::any(),
        layers in [families::log_uniform(1e8, 1e17), families::log_uniform(1e8, 1e17)],
        p in families::pressures(),
    ) {
        let once: Arc<dyn ContactLaw> = Arc::new(InSeries::new(inner, layers[0]).unwrap());
        conform(&InSeries::new(once, layers[1]).unwrap(), &p)?;
    }

    #[test]
    fn laws_in_series(
        laws in [families::any(), families::any()],
        ratio in families::log_uniform(0.1, 10.0),
        weight in prop_oneof![Just(0.0), families::log_uniform(1.0, 1e6)],
        compliance in prop_oneof![Just(0.0), families::log_uniform(1e-17, 1e-8)],
        p in families::pressures(),
    ) {
        let [upper, lower] = laws;
        let carries_tension = |law: &families::AnyLaw| law.domain().is_bilateral();
        // The pressure of the series is that of the contact lost first.
        let lost_first = carries_tension(&lower) || !carries_tension(&upper);
        let (first, second) = if lost_first { (upper, lower) } else { (lower, upper) };
        let second = SeriesContact { law: second, pressure_ratio: ratio, pressure_offset: weight };
        let contacts = vec![SeriesContact::new(first), second];
        conform(&LawsInSeries::new(contacts, compliance).unwrap(), &p)?;
    }
}

// Every stiffness of these is an integral: fewer cases.
proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, cases: 24, ..ProptestConfig::default() })]

    #[test]
    fn greenwood_williamson(law in families::greenwood_williamson(), p in families::pressures()) {
        conform(&law, &p)?;
    }

    #[test]
    fn persson(law in families::persson(), p in families::pressures()) {
        conform(&law, &p)?;
    }

    #[test]
    fn rough_surfaces_in_series(
        inner in families::rough_surface(),
        layer in families::log_uniform(1e8, 1e17),
        p in families::pressures(),
    ) {
        conform(&InSeries::new(inner, layer).unwrap(), &p)?;
    }
}
