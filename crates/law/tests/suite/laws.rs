//! Laws by name and laws in series, from their document forms.

use asperity_law::{
    ConstantSpec, ContactLaw, InSeriesSpec, LawError, LawRef, LawSpec, Laws, PowerSpec,
};

#[test]
fn nested_layers_in_series_are_one_layer() {
    let power = LawSpec::from(PowerSpec { coefficient: 1.81e10, exponent: 0.35 });
    let in_series = |law: LawSpec, stiffness| LawSpec::with_layer(law.into(), stiffness);
    let nested = [4e12, 4e12, 2e12].into_iter().fold(power.clone(), in_series);
    let built = |law: LawSpec| format!("{:?}", Laws::default().build(&law.into(), 1e5).unwrap());
    assert_eq!(built(nested), built(in_series(power, 1e12)));
}

/// Closures add at one pressure, whatever the nesting; two equal laws are half as stiff.
#[test]
fn laws_in_series_add_their_closures() {
    let power = LawSpec::from(PowerSpec { coefficient: 1.81e10, exponent: 0.35 });
    let constant = LawSpec::from(ConstantSpec { stiffness_pa_per_m: 8e11, unilateral: true });
    let in_place = |law: &LawSpec| LawRef::from(law.clone());
    let series = |laws: &[&LawSpec], stiffness_pa_per_m: Option<f64>| {
        let laws = laws.iter().map(|law| in_place(law)).collect();
        LawSpec::InSeries(InSeriesSpec { law: None, laws, stiffness_pa_per_m })
    };
    let built = |law: &LawSpec| Laws::default().build(&in_place(law), 1e5).unwrap();
    let both = built(&series(&[&power, &constant], Some(4e12)));
    let twice = built(&series(&[&power, &power], None));
    let inner = series(&[&power, &constant], Some(8e12));
    let nested = built(&series(&[&inner, &power], Some(8e12)));
    let [one, other] = [built(&power), built(&constant)];
    for pressure in [1e3, 1e5, 3e6] {
        let closure = one.closure(pressure) + other.closure(pressure) + pressure / 4e12;
        assert!((both.closure(pressure) / closure - 1.0).abs() < 1e-12);
        let stiffness = twice.stiffness(pressure);
        assert!((stiffness / one.stiffness(pressure) - 0.5).abs() < 1e-12);
        let closure = closure + one.closure(pressure);
        assert!((nested.closure(pressure) / closure - 1.0).abs() < 1e-12);
    }
}

/// A law that refers to itself is refused without validation too.
#[test]
fn endless_series_are_refused() {
    let named = || LawRef::Named("a".to_owned());
    let law = |laws| LawSpec::InSeries(InSeriesSpec { law: None, laws, stiffness_pa_per_m: None });
    let laws = Laws::from_iter([("a".to_owned(), law(vec![named(), named()]))]);
    let error = laws.build(&named(), 1e5).unwrap_err();
    assert_eq!(error, LawError::CyclicLaw(vec!["a".to_owned(), "a".to_owned()]));
    let error = laws.build(&law(vec![]).into(), 1e5).unwrap_err();
    assert!(matches!(error, LawError::Below { .. }), "{error}");
    let power = LawSpec::from(PowerSpec { coefficient: 1.81e10, exponent: 0.35 });
    let deep = (0..9).fold(power, |law, _| LawSpec::with_layer(law.into(), 1e12));
    let error = laws.build(&deep.into(), 1e5).unwrap_err();
    assert_eq!(error, LawError::SeriesTooDeep { most: 8 });
}

/// Laws keep the order of the document, and the last of a repeated name.
#[test]
fn laws_are_read_in_order() {
    let text = r#"{"b": {"kind": "exponential", "length_m": 1e-6},
                   "a": {"kind": "constant", "stiffness_pa_per_m": 8e11},
                   "b": {"kind": "exponential", "length_m": 2e-6}}"#;
    let laws: Laws = serde_json::from_str(text).unwrap();
    assert_eq!(laws.names().collect::<Vec<_>>(), ["b", "a"]);
    let text = serde_json::to_string(&laws).unwrap();
    assert!(text.starts_with(r#"{"b":{"kind":"exponential","length_m":2e-6},"a""#), "{text}");
    for wrong in [
        r#"{"a": {"kind": "exponential"}}"#,
        r#"{"a": {"kind": "exponential", "length_m": 1e-6, "width_m": 1}}"#,
        "[]",
    ] {
        assert!(serde_json::from_str::<Laws>(wrong).is_err(), "{wrong}");
    }
}
