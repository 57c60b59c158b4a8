//! One suite for all contact laws, over wide ranges of parameters and pressures.
//!
//! Pressures are 1 Pa to 1e9 Pa. The properties are in `suite.rs`, the laws in `families.rs`: samples of the
//! list of all kinds, and families of extreme parameters.

pub(crate) mod families;
mod suite;

use std::collections::HashSet;
use std::sync::Arc;

use asperity_law::{ContactLaw, InSeries, LawSpec, Laws, LawsInSeries, SeriesContact};
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

family!(power_below_one, power_below_one_referred, power_from_one_on, power_next_to_one, table,);

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

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, cases: 4 * ProptestConfig::default().cases, ..ProptestConfig::default() })]

    /// Samples of every kind conform and have no fault.
    #[test]
    fn every_kind((spec, law) in families::sample(), p in families::pressures()) {
        prop_assert_eq!(spec.faults().next(), None, "{:?}", spec);
        conform(&law, &p)?;
    }
}

/// A sample of every kind has about the stiffness asked for, and the key "kind" of its own.
#[test]
fn samples_are_as_stiff_as_asked_for() {
    let mut kinds = HashSet::new();
    for sample in LawSpec::SAMPLERS {
        let mut stream = families::Stream(vec![0.4; 24].into_iter());
        let spec = sample(&mut stream, 1e5, 1e12);
        let law = Laws::default().build(&spec.clone().into(), 1e5).unwrap();
        let ratio = law.stiffness(1e5) / 1e12;
        assert!((0.1..10.0).contains(&ratio), "{spec:?}: {ratio}");
        assert!(kinds.insert(serde_json::to_value(spec).unwrap()["kind"].clone()));
    }
    assert_eq!(kinds.len(), LawSpec::SAMPLERS.len());
}
