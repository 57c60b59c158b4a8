//! Accepted scenarios: the fixtures, and changes of single values.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use asperity_scenario::{
    ContactScheme, Damping, DampingSpec, Document, DocumentError, ExcitationSpec,
    FiniteDifferenceSpec, LawRef, LawSpec, MethodSpec, ModalDampingSpec, ModalSpec, RayleighSpec,
    Scenario, SectionSpec, SupportSpec, SyntaxFault, check_schema, scenario_schema, validate,
};
use proptest::prelude::*;
use serde_json::{Value, json};

const FOLDER: &str = "../../fixtures/scenarios";

fn fixtures() -> Vec<PathBuf> {
    let entries = fs::read_dir(FOLDER).unwrap();
    let files = entries.map(|entry| entry.unwrap().path());
    let mut fixtures: Vec<PathBuf> =
        files.filter(|path| path.extension().is_some_and(|kind| kind == "json")).collect();
    fixtures.sort();
    fixtures
}

fn rig() -> Document {
    Document::read(format!("{FOLDER}/nouira2020-modified.json")).unwrap()
}

#[test]
fn every_fixture_is_accepted_and_round_trips() {
    let validator = jsonschema::draft202012::new(scenario_schema()).unwrap();
    let fixtures = fixtures();
    assert!(fixtures.len() >= 7);
    for path in fixtures {
        let document = Document::read(&path).unwrap();
        assert!(validator.is_valid(document.value()), "{}", path.display());
        let scenario = document.scenario().unwrap_or_else(|invalid| panic!("{invalid}"));
        assert_eq!(validate(&scenario, document.folder()), []);
        let written = serde_json::to_value(&scenario).unwrap();
        assert!(validator.is_valid(&written), "{written}");
        let again: Scenario = serde_json::from_value(written).unwrap();
        assert_eq!(again, scenario);
    }
}

#[test]
fn the_papers_rig_reads_as_written() {
    let scenario = rig().scenario().unwrap();
    assert_eq!(scenario.bodies[0].section, SectionSpec::MassKg(1.61));
    assert_eq!(scenario.bodies[1].section, SectionSpec::AreaM2(1.15e-4));
    assert_eq!(
        scenario.laws.names().collect::<Vec<_>>(),
        ["modified", "pl", "constant", "measured"]
    );
    assert!(matches!(
        scenario.laws.resolve(&scenario.interfaces[0].law),
        Some(LawSpec::ModifiedPower(law)) if law.knots.len() == 4
    ));
    assert_eq!(scenario.damping, DampingSpec::MassProportional(Damping::Ratio(0.035)));
}

#[test]
fn omitted_values_take_their_defaults() {
    let text = r#"{"schema": "asperity/scenario/1", "duration_s": 0.1,
        "bodies": [{"name": "b", "length_m": 0.1, "area_m2": 1e-4, "youngs_modulus_pa": 71e9, "density_kg_per_m3": 2710}],
        "interfaces": [{"name": "i", "area_m2": 1e-4, "law": {"kind": "constant", "stiffness_pa_per_m": 1e12}}],
        "damping": {"kind": "mass_proportional", "rate_per_s": 0}}"#;
    let document = Document::parse(text, "inline.json").unwrap();
    let scenario = document.scenario().unwrap();
    assert_eq!(scenario.gravity_m_per_s2, 9.81);
    assert_eq!(scenario.support, SupportSpec::Rigid);
    assert_eq!(scenario.excitation, ExcitationSpec::None);
    assert_eq!(scenario.output_rate_hz, 200_000.0);
    assert_eq!(scenario.method, MethodSpec::Modal(ModalSpec::default()));
    assert!(scenario.laws.is_empty());
    assert!(matches!(&scenario.interfaces[0].law, LawRef::InPlace(law)
        if matches!(&**law, LawSpec::Constant(law) if !law.unilateral)));
    // A byte order mark changes nothing.
    let marked = Document::parse(&format!("\u{feff}{text}"), "inline.json").unwrap();
    assert_eq!(marked.sha256(), document.sha256());
}

#[test]
fn measured_samples_are_found_in_the_folder_of_the_scenario() {
    let document = Document::read(format!("{FOLDER}/measured-hammer.json")).unwrap();
    let ExcitationSpec::Samples { file: Some(file), peak_n, .. } =
        document.scenario().unwrap().excitation
    else {
        panic!("the fixture is excited by samples");
    };
    let samples =
        asperity_scenario::LoadSamples::read(&document.folder().join(file), "force_n").unwrap();
    assert!(samples.peak() > 15.0 && samples.time_s.len() > 300);
    let rescaled = samples.rescaled(peak_n.unwrap()).unwrap();
    assert!((rescaled.peak() - 20.0).abs() < 1e-12);
}

#[test]
fn set_changes_adds_and_appends() {
    let mut document = rig();
    let unchanged = document.sha256();
    document.set("/excitation/peak_n", "20").unwrap();
    document.set("/title", "NaN is a title").unwrap();
    document.set("/interfaces/0/law", "pl").unwrap();
    document.set("/laws/soft", r#"{"kind": "exponential", "length_m": 1e-6}"#).unwrap();
    document.set("/laws/measured/points/-", "[2e6, 3e12]").unwrap();
    let scenario = document.scenario().unwrap();
    assert!(matches!(scenario.excitation, ExcitationSpec::GammaPulse { peak_n: 20.0, .. }));
    assert_eq!(scenario.title.as_deref(), Some("NaN is a title"));
    assert_eq!(scenario.interfaces[0].law, LawRef::Named("pl".to_owned()));
    assert!(
        matches!(scenario.laws.get("measured"), Some(LawSpec::Table(law)) if law.points.len() == 5)
    );
    assert_eq!(scenario.laws.len(), 5);
    assert_ne!(document.sha256(), unchanged);
}

#[test]
fn values_inside_a_default_can_be_set() {
    let mut document = Document::read(format!("{FOLDER}/three-body.json")).unwrap();
    document.set("/method/cell_m", "0.0005").unwrap();
    document.set("/support", r#"{"kind": "rigid"}"#).unwrap();
    let MethodSpec::FiniteDifference(settings) = document.scenario().unwrap().method else {
        panic!("the scenario asks for finite differences");
    };
    assert_eq!((settings.cell_m, settings.courant), (0.0005, 0.95));
    let mut value = document.value().clone();
    value.as_object_mut().unwrap().remove("method");
    let mut document = Document::parse(&value.to_string(), "three-body.json").unwrap();
    document.set("/method/step_s", "1e-5").unwrap();
    let expected = MethodSpec::Modal(ModalSpec { step_s: Some(1e-5), ..ModalSpec::default() });
    assert_eq!(document.scenario().unwrap().method, expected);
    document.set("/method", "finite_difference").unwrap();
    document.set("/method/contact", "new_level").unwrap();
    let expected = FiniteDifferenceSpec { contact: ContactScheme::NewLevel, ..Default::default() };
    assert_eq!(document.scenario().unwrap().method, MethodSpec::FiniteDifference(expected));
}

#[test]
fn a_value_that_was_set_has_no_place_in_the_text() {
    let mut document = rig();
    document.set("/method/courant", "1.2").unwrap();
    document.set("/bodies/0/length_m", "2 m").unwrap();
    let diagnostics = document.scenario().unwrap_err().diagnostics;
    assert_eq!(diagnostics.len(), 2);
    assert!(diagnostics.iter().all(|found| found.span.is_none()));
}

#[test]
fn errors_of_set_name_the_existing_keys() {
    let cases = [
        ("excitation/peak_n", "1"),
        ("excitation.peak_n", "1"),
        ("", "1"),
        ("/exitation/peak_n", "1"),
        ("/bodies/2/length_m", "1"),
        ("/bodies/sample/length_m", "1"),
        ("/bodies/01/length_m", "1"),
        ("/interfaces/2", "1"),
        ("/duration_s/x", "1"),
        ("/laws/a~b", "1"),
        ("/bodies/0", "{\"name\": }"),
        ("/bodies/0", "{\"name\": \"a\", \"name\": \"b\"}"),
        ("/a/b/c", "1"),
    ];
    let untouched = rig();
    let mut shown = String::new();
    for (pointer, value) in cases {
        let mut document = untouched.clone();
        let error = document.set(pointer, value).unwrap_err();
        assert_eq!(document.value(), untouched.value());
        writeln!(shown, "--set '{pointer}={value}'\n    {error}").unwrap();
    }
    insta::assert_snapshot!(shown);
}

#[test]
fn the_hash_does_not_depend_on_the_order_of_keys_or_on_white_space() {
    let one = Document::parse(r#"{"b": [1, {"d": 2, "c": 3}], "a": "x"}"#, "one").unwrap();
    let two = Document::parse("{\"a\":\"x\",\n\"b\":[1,{\"c\":3,\"d\":2}]}", "two").unwrap();
    assert_eq!(one.sha256(), two.sha256());
    // printf '%s' '{"a":"x","b":[1,{"c":3,"d":2}]}' | sha256sum
    assert_eq!(one.sha256(), "4bc2f0faf907fa5fdaedde9cbf7002e3cbf041208b96a4ab4ce6693fbf4bea67");
    assert_eq!(one.folder(), Path::new("."));
}

#[test]
fn a_scenario_changed_in_code_is_checked_too() {
    let document = rig();
    let mut scenario = document.scenario().unwrap();
    scenario.interfaces[1].law = LawRef::Named("pll".to_owned());
    let found = validate(&scenario, document.folder());
    assert_eq!(found.len(), 1);
    assert_eq!(found[0].pointer, "/interfaces/1/law");
    scenario.duration_s = f64::NAN;
    let found = validate(&scenario, document.folder());
    assert_eq!(found[0].pointer, "/duration_s");
}

/// Every value of a document, by its pointer.
fn pointers(value: &Value, at: &str, all: &mut Vec<String>) {
    all.push(at.to_owned());
    match value {
        Value::Object(object) => {
            for (key, inner) in object {
                pointers(inner, &format!("{at}/{key}"), all);
            }
        }
        Value::Array(items) => {
            for (index, inner) in items.iter().enumerate() {
                pointers(inner, &format!("{at}/{index}"), all);
            }
        }
        _ => {}
    }
}

/// Replacements that meet every branch of the schema.
fn replacement() -> impl Strategy<Value = Value> {
    let words = [
        "",
        "0.5",
        "rigid",
        "none",
        "finite_difference",
        "new_level",
        "asperity/scenario/1",
        "modified",
        "kind",
    ];
    let kinds = [
        "rigid",
        "spring_mass",
        "constant",
        "power",
        "table",
        "in_series",
        "mass_proportional",
        "gamma_pulse",
        "harmonic",
        "finite_difference",
        "hyperbolic",
        "nothing",
    ];
    let keys =
        ["ratio", "peak_n", "stiffness_pa_per_m", "points", "law", "courant", "mass_kg", "extra"];
    let leaf = prop_oneof![
        Just(Value::Null),
        any::<bool>().prop_map(Value::from),
        prop::sample::select(vec![
            json!(0),
            json!(-1),
            json!(1),
            json!(0.5),
            json!(0.0),
            json!(1e300),
            json!(2e9)
        ]),
        prop::sample::select(words.to_vec()).prop_map(Value::from),
    ];
    leaf.prop_recursive(3, 12, 4, move |inner| {
        let entries =
            prop::collection::vec((prop::sample::select(keys.to_vec()), inner.clone()), 0..3);
        let kind = prop::option::of(prop::sample::select(kinds.to_vec()));
        prop_oneof![
            prop::collection::vec(inner, 0..4).prop_map(Value::from),
            (kind, entries).prop_map(|(kind, entries)| {
                let tag = kind.map(|kind| ("kind".to_owned(), Value::from(kind)));
                let entries = entries.into_iter().map(|(key, value)| (key.to_owned(), value));
                Value::Object(tag.into_iter().chain(entries).collect())
            }),
        ]
    })
}

/// One change of a document: replace, remove or add.
fn change(document: &mut Value, place: prop::sample::Index, action: u8, new: Value) {
    let mut all = Vec::new();
    pointers(document, "", &mut all);
    let pointer = place.get(&all).clone();
    let (parent, last) = pointer.rsplit_once('/').unwrap_or(("", ""));
    match (action, document.pointer(&pointer).cloned()) {
        (0, Some(Value::Object(mut object))) => {
            object.insert("law".to_owned(), new);
            *document.pointer_mut(&pointer).unwrap() = object.into();
        }
        (0, Some(Value::Array(mut items))) => {
            items.push(new);
            *document.pointer_mut(&pointer).unwrap() = items.into();
        }
        (1, _) if !pointer.is_empty() => match document.pointer_mut(parent).unwrap() {
            Value::Object(object) => drop(object.remove(last)),
            Value::Array(items) => drop(items.remove(last.parse().unwrap())),
            _ => {}
        },
        _ => *document.pointer_mut(&pointer).unwrap() = new,
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 3000, failure_persistence: None, ..ProptestConfig::default() })]

    /// An independent validator accepts the same documents, and accepted documents deserialise.
    #[test]
    fn the_schema_check_agrees_with_an_independent_validator(
        fixture in any::<prop::sample::Index>(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), 0..3_u8, replacement()), 1..4),
    ) {
        static VALIDATOR: LazyLock<jsonschema::Validator> =
            LazyLock::new(|| jsonschema::draft202012::new(scenario_schema()).unwrap());
        let mut document = Document::read(fixture.get(&fixtures())).unwrap().value().clone();
        for (place, action, new) in changes {
            change(&mut document, place, action, new);
        }
        let found = check_schema(scenario_schema(), &document);
        prop_assert_eq!(found.is_empty(), VALIDATOR.is_valid(&document), "{:?}\n{}", found, document);
        if found.is_empty() {
            let scenario = serde_json::from_value::<Scenario>(document.clone());
            prop_assert!(scenario.is_ok(), "{:?}\n{}", scenario, document);
        }
        // The conditions between values are checked on malformed values too.
        let parsed = Document::parse(&document.to_string(), "mutated.json").unwrap();
        let _ = parsed.scenario();
    }

    /// The scanner and the parser accept the same texts, except for deep nesting.
    #[test]
    fn the_scanner_and_the_parser_agree(
        place in any::<prop::sample::Index>(),
        length in 0..3_usize,
        inserted in r#"[\[\]{},:"\\a1.eE+\-/ntu'#é\n\t ]{0,3}"#,
    ) {
        let text = rig().text().to_owned();
        let characters: Vec<char> = text.chars().collect();
        let start = place.index(characters.len());
        let end = (start + length).min(characters.len());
        let mutated: String = characters[..start].iter().copied().chain(inserted.chars()).chain(characters[end..].iter().copied()).collect();
        let parsed = serde_json::from_str::<Value>(&mutated);
        match Document::parse(&mutated, "mutated.json") {
            Ok(_) => prop_assert!(parsed.is_ok(), "{:?}\n{}", parsed, mutated),
            Err(DocumentError::Syntax { source, .. }) => {
                prop_assert!(parsed.is_err(), "{}\n{}", source, mutated);
                prop_assert!(mutated.get(source.span.clone()).is_some());
                let too_deep = matches!(source.fault, SyntaxFault::TooDeep { .. });
                prop_assert!(!too_deep);
            }
            Err(other) => prop_assert!(false, "{}\n{}", other, mutated),
        }
    }
}

/// Rayleigh damping as coefficients and as two ratios, which its coefficients have; and a loss factor.
#[test]
fn body_damping_is_read_and_written_in_every_form() {
    let read = |damping: &str| {
        let mut document = rig();
        document.set("/damping", damping).unwrap();
        let scenario = document.scenario();
        if let Ok(scenario) = &scenario {
            let written = serde_json::to_value(scenario).unwrap();
            assert_eq!(serde_json::from_value::<Scenario>(written).unwrap(), *scenario);
        }
        scenario.map(|scenario| scenario.damping)
    };
    let coefficients = |rate_per_s, time_s| {
        DampingSpec::Rayleigh(RayleighSpec::Coefficients { rate_per_s, time_s })
    };
    let found = read(r#"{"kind": "rayleigh", "rate_per_s": 20, "time_s": 2e-6}"#).unwrap();
    assert_eq!(found, coefficients(20.0, 2e-6));
    let found = read(r#"{"kind": "rayleigh", "time_s": 2e-6}"#).unwrap();
    assert_eq!(found, coefficients(0.0, 2e-6));
    let found = read(r#"{"kind": "loss_factor", "loss_factor": 0.02}"#).unwrap();
    assert_eq!(found, DampingSpec::LossFactor(0.02));
    let modal = |ratios: &[f64], other_ratio| {
        DampingSpec::Modal(ModalDampingSpec { ratios: ratios.to_vec(), other_ratio })
    };
    let found = read(r#"{"kind": "modal", "ratios": [0.03, 0.01], "other_ratio": 0.02}"#).unwrap();
    assert_eq!(found, modal(&[0.03, 0.01], Some(0.02)));
    let found = read(r#"{"kind": "modal", "ratios": [0.03]}"#).unwrap();
    assert_eq!(found, modal(&[0.03], None));
    for refused in [r#"{"kind": "modal", "ratios": []}"#, r#"{"kind": "modal", "ratios": [-0.1]}"#]
    {
        let error = read(refused).unwrap_err().to_string();
        assert!(error.contains("/damping/ratios"), "{error}");
    }
    for [[f1, zeta1], [f2, zeta2]] in [
        [[800.0, 0.02], [11_000.0, 0.03]],
        [[11_000.0, 0.03], [800.0, 0.02]],
        [[800.0, 0.02], [1600.0, 0.01]],
        [[700.0, 0.007], [2100.0, 0.021]],
    ] {
        let text = format!(
            r#"{{"kind": "rayleigh", "ratios": [{{"frequency_hz": {f1}, "ratio": {zeta1}}}, {{"frequency_hz": {f2}, "ratio": {zeta2}}}]}}"#
        );
        let DampingSpec::Rayleigh(rayleigh) = read(&text).unwrap() else { panic!("{text}") };
        let (a, b) = rayleigh.coefficients();
        assert!(a >= 0.0 && b >= 0.0);
        for (f, zeta) in [(f1, zeta1), (f2, zeta2)] {
            let w = std::f64::consts::TAU * f;
            assert!((0.5 * a / w + 0.5 * b * w - zeta).abs() < 1e-12 * zeta, "{text}");
        }
    }
    let place = |damping: &str| match read(damping) {
        Err(invalid) => format!("{invalid}"),
        Ok(found) => panic!("{found:?}"),
    };
    let refused = place(
        r#"{"kind": "rayleigh", "ratios": [{"frequency_hz": 800, "ratio": 0.02}, {"frequency_hz": 1600, "ratio": 0.005}]}"#,
    );
    assert!(refused.contains("/damping/ratios") && refused.contains("time_s = -"), "{refused}");
    let refused = place(
        r#"{"kind": "rayleigh", "ratios": [{"frequency_hz": 800, "ratio": 0.02}, {"frequency_hz": 800, "ratio": 0.02}]}"#,
    );
    assert!(refused.contains("/damping/ratios"), "{refused}");
    let refused = place(
        r#"{"kind": "rayleigh", "rate_per_s": 2, "ratios": [{"frequency_hz": 800, "ratio": 0.02}, {"frequency_hz": 1600, "ratio": 0.02}]}"#,
    );
    assert!(refused.contains("/damping/rate_per_s"), "{refused}");
    for bad in [
        r#"{"kind": "rayleigh"}"#,
        r#"{"kind": "rayleigh", "rate_per_s": 2}"#,
        r#"{"kind": "rayleigh", "time_s": -1e-6}"#,
        r#"{"kind": "loss_factor"}"#,
    ] {
        assert!(place(bad).contains("/damping"), "{bad}");
    }
}

/// One law with a layer, and any number of laws with or without one; what is neither is refused at its
/// place.
#[test]
fn laws_in_series_are_read_in_both_forms() {
    let read = |laws: &[(&str, &str)]| {
        let mut document = rig();
        for (pointer, law) in laws {
            document.set(pointer, law).unwrap();
        }
        document.scenario()
    };
    let both = r#"{"kind": "in_series", "laws": ["pl", {"kind": "constant", "stiffness_pa_per_m": 1e12}]}"#;
    let scenario = read(&[("/laws/modified", both)]).unwrap();
    let law = scenario.laws.get("modified").unwrap();
    assert_eq!(law.inner_laws().count(), 2);
    let written = serde_json::to_value(&scenario).unwrap();
    assert_eq!(serde_json::from_value::<Scenario>(written).unwrap(), scenario);
    let layered = r#"{"kind": "in_series", "law": "pl", "stiffness_pa_per_m": 1e12}"#;
    let scenario = read(&[("/laws/modified", layered)]).unwrap();
    let named = LawRef::Named("pl".to_owned());
    assert_eq!(scenario.laws.get("modified"), Some(&LawSpec::with_layer(named, 1e12)));
    let many = vec!["\"pl\""; 101].join(", ");
    let many = format!(r#"{{"kind": "in_series", "laws": [{many}]}}"#);
    for (law, place, words) in [
        (r#"{"kind": "in_series", "law": "pl"}"#, "/laws/modified", "stiffness_pa_per_m"),
        (r#"{"kind": "in_series", "laws": ["pl"]}"#, "/laws/modified/laws", "item"),
        (r#"{"kind": "in_series", "stiffness_pa_per_m": 1e12}"#, "/laws/modified", "neither"),
        (r#"{"kind": "in_series", "laws": ["pl", "none"]}"#, "/laws/modified/laws/1", "none"),
        (r#"{"kind": "in_series", "laws": ["pl", "modified"]}"#, "/laws/modified/laws", "itself"),
        (&many, "/laws/modified", "more than 100 laws"),
    ] {
        let error = read(&[("/laws/modified", law)]).unwrap_err().to_string();
        assert!(error.contains(place) && error.contains(words), "{law}: {error}");
    }
}

/// Points of a force: their number, their times and a force that can be rescaled are checked, in their places.
#[test]
fn points_of_a_force_are_checked() {
    let pointers = |excitation: &str| {
        let mut document = Document::read(format!("{FOLDER}/measured-hammer.json")).unwrap();
        document.set("/excitation", excitation).unwrap();
        let found = document.scenario().err().map(|invalid| invalid.diagnostics);
        found.into_iter().flatten().map(|one| one.pointer).collect::<Vec<_>>()
    };
    let samples = |points: &str| pointers(&format!(r#"{{"kind": "samples", {points}}}"#));
    assert!(samples(r#""points": [[0, 0], [1e-3, 8], [2e-3, 0]], "peak_n": 20"#).is_empty());
    assert_eq!(samples(r#""points": [[0, 0], [1e-3, 8], [1e-3, 0]]"#), ["/excitation/points/2/0"]);
    assert_eq!(samples(r#""points": [[0, 0]]"#), ["/excitation/points"]);
    assert_eq!(samples(r#""points": [[0, 0], [1e-3]]"#), ["/excitation/points/1"]);
    assert_eq!(samples(r#""points": [[0, 0], [1, 0]], "peak_n": 2"#), ["/excitation/peak_n"]);
    let many: Vec<String> = (0..10_001).map(|n| format!("[{n}, 1]")).collect();
    assert_eq!(samples(&format!(r#""points": [{}]"#, many.join(","))), ["/excitation/points"]);
    assert_eq!(samples(r#""peak_n": 2"#), ["/excitation"]);
    let both = r#""points": [[0, 0], [1, 1]], "file": "samples/hammer.csv""#;
    assert_eq!(samples(both), ["/excitation"]);
}
