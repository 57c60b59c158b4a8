//! Numbers and pictures are those of the libraries for the same scenario.

use std::path::Path;

use asperity_explore::ExploreOptions;
use asperity_plot as plot;
use asperity_scenario::Document;
use asperity_simulation::assemble::Assembly;
use asperity_simulation::provenance::Provenance;
use asperity_simulation::run::{Run, simulate};
use asperity_simulation::static_state::StaticSummary;
use asperity_simulation::steady::{BodyModel, SteadyRequest, SteadySummary, steady};
use serde_json::{Value, json};

use crate::client::{Page, block, changed, line, read, request};

fn run_of(document: &Document) -> Run {
    simulate(document, &document.scenario().unwrap()).unwrap()
}

/// Words without the time of the computation.
fn timeless(words: &str) -> Vec<&str> {
    words.lines().filter(|line| !line.starts_with("run ")).collect()
}

#[test]
fn numbers_of_a_hit_are_the_commands() {
    let page = Page::new();
    for peak in ["2", "5", "14"] {
        let change = json!([["/excitation/peak_n", peak.parse::<f64>().unwrap()]]);
        let lines = page.compute("hit", &["law", "frf", "history"], &change);
        let run = run_of(&changed("/excitation/peak_n", peak));
        let words = line(&lines, "words")["text"].as_str().unwrap();
        assert_eq!(timeless(words), timeless(&plot::run_words(&run.summary)));
        let drawn: Vec<&Value> = lines.iter().filter(|line| line["answer"] == "picture").collect();
        assert_eq!(drawn.len(), 3);
        let f1 = run.summary.fundamental.unwrap().frequency_hz;
        let frf = drawn.iter().find(|line| line["view"] == "frf").unwrap();
        assert!(frf["svg"].as_str().unwrap().contains(&format!("{f1:.1} Hz")));
    }
}

#[test]
fn numbers_of_steady_responses_are_the_commands() {
    let page = Page::new();
    let settings = json!({ "amplitudes": [0.2, 0.5], "from_hz": 1200, "to_hz": 1900 });
    let lines = page.compute_with("steady", &["steady"], &json!([]), &settings);
    let document = Document::read(block()).unwrap();
    let scenario = document.scenario().unwrap();
    let assembly = Assembly::new(&scenario, document.folder()).unwrap();
    let request = SteadyRequest {
        amplitudes: vec![0.2, 0.5],
        from_hz: 1200.0,
        to_hz: 1900.0,
        harmonics: None,
        backbone: false,
        verify: false,
        bodies: BodyModel::Auto,
        time_sweep: None,
    };
    let found = steady(&assembly, &request).unwrap();
    let provenance = Provenance::of_scenario(&document, &scenario).unwrap();
    let at_rest = StaticSummary::of(&assembly);
    let summary = SteadySummary::new(scenario.title, at_rest, &found, provenance);
    let words = plot::steady_words::branches(&summary);
    assert_eq!(line(&lines, "words")["text"], words);
    assert!(line(&lines, "picture")["svg"].as_str().unwrap().contains("Amplitude"));
}

#[test]
fn a_view_that_is_not_shown_is_not_drawn() {
    let page = Page::new();
    let lines = page.compute("hit", &["law"], &json!([]));
    let drawn: Vec<&Value> = lines.iter().filter(|line| line["answer"] == "picture").collect();
    assert!(drawn.len() == 1 && drawn[0]["view"] == "law");
    assert_eq!(lines.last().unwrap()["answer"], "done");
}

#[test]
fn a_pinned_state_is_drawn_in_grey() {
    let page = Page::new();
    let mut asked = request("t", "hit", &["frf"], &json!([]), &json!({}));
    let alone = page.post("compute", &asked).lines();
    asked["pinned"] = json!([["/excitation/peak_n", 14]]);
    let both = page.post("compute", &asked).lines();
    let curves = |lines: &[Value]| {
        let data: Value =
            serde_json::from_str(line(lines, "picture")["data"].as_str().unwrap()).unwrap();
        data["panels"][0]["series"].as_array().unwrap().clone()
    };
    let (alone, both) = (curves(&alone), curves(&both));
    assert_eq!(both.len(), alone.len() + 1);
    assert_eq!(both[0]["name"], "pinned");
    assert_ne!(both[0]["color"], both[1]["color"]);
    assert_eq!(both[1]["color"], alone[0]["color"]);
}

#[test]
fn faults_name_their_values() {
    let page = Page::new();
    let lines = page.compute("hit", &["frf"], &json!([["/bodies/0/length_m", -1]]));
    assert_eq!(line(&lines, "faults")["faults"][0]["pointer"], "/bodies/0/length_m");
    let state = page.post("state", &json!({ "changes": [["/bodies/0/length_m", -1]] }));
    let state: Value = serde_json::from_str(&state.body).unwrap();
    assert_eq!(state["faults"][0]["pointer"], "/bodies/0/length_m");
    assert!(!state["groups"].as_array().unwrap().is_empty(), "the value can be mended");
}

#[test]
fn a_scenario_without_a_force_says_what_is_missing() {
    let page = Page::new();
    let changes = json!([["/excitation", { "kind": "none" }]]);
    let lines = page.compute("levels", &["levels"], &changes);
    assert!(line(&lines, "absent")["reason"].as_str().unwrap().contains("excitation"));
}

/// Two pages of one scenario do not stop each other.
#[test]
fn pages_are_independent() {
    let page = Page::new();
    let path = format!("{}compute", page.path);
    let open = |tab: &str, peak: f64| {
        let changes = json!([["/excitation/peak_n", peak]]);
        let asked = request(tab, "hit", &["frf"], &changes, &json!({})).to_string();
        page.open("POST", &path, &page.own_head(), asked.as_bytes())
    };
    let both = [("a", 3.0), ("b", 9.0)].map(|(tab, peak)| (peak, open(tab, peak)));
    for (peak, stream) in both {
        let lines = read(stream).lines();
        let run = run_of(&changed("/excitation/peak_n", &peak.to_string()));
        let words = line(&lines, "words")["text"].as_str().unwrap();
        assert_eq!(timeless(words), timeless(&plot::run_words(&run.summary)), "{peak}");
        assert_eq!(lines.last().unwrap()["answer"], "done");
    }
}

/// Of many inputs in a row the last has its answer, and it is right; the others are right or superseded.
#[test]
fn the_newest_input_is_answered() {
    let page = Page::new();
    let path = format!("{}compute", page.path);
    let mut random: u64 = 1;
    let streams: Vec<_> = (0..60)
        .map(|_| {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            let peak = 1.0 + (random >> 40) as f64 / f64::from(1 << 24) * 12.0;
            let changes = json!([["/excitation/peak_n", peak]]);
            let asked = request("tab", "hit", &["frf"], &changes, &json!({})).to_string();
            (peak, page.open("POST", &path, &page.own_head(), asked.as_bytes()))
        })
        .collect();
    let mut ends = Vec::new();
    for (peak, stream) in streams {
        let lines = read(stream).lines();
        let end = lines.last().unwrap()["answer"].as_str().unwrap().to_owned();
        if end == "done" {
            let run = run_of(&changed("/excitation/peak_n", &peak.to_string()));
            let words = line(&lines, "words")["text"].as_str().unwrap();
            assert_eq!(timeless(words), timeless(&plot::run_words(&run.summary)), "{peak}");
        }
        ends.push(end);
    }
    assert!(ends.iter().all(|end| end == "done" || end == "superseded"), "{ends:?}");
    assert!(ends.iter().any(|end| end == "done"));
}

/// Runs of some minutes give way to the next input: by finite differences, at equal steps, and force levels at steps
/// of their own.
#[test]
fn a_newer_input_stops_a_long_run() {
    let page = Page::new();
    let path = format!("{}compute", page.path);
    let slow = |method: Value| json!([["/duration_s", 7], ["/method", method]]);
    for (part, view, changes) in [
        ("hit", "frf", slow(json!({ "kind": "finite_difference", "cell_m": 1e-4 }))),
        ("hit", "frf", slow(json!({ "kind": "modal", "step_s": 2e-7 }))),
        (
            "levels",
            "levels",
            json!([["/duration_s", 7], ["/excitation/peak_n", 60], ["/laws/rough/exponent", 0.5]]),
        ),
    ] {
        let settings = json!({ "level_from": 30, "level_to": 90, "levels": 200 });
        let asked = request("tab", part, &[view], &changes, &settings).to_string();
        let first = page.open("POST", &path, &page.own_head(), asked.as_bytes());
        // The first has begun once its answer begins.
        assert_eq!(first.peek(&mut [0]).unwrap(), 1);
        let settings = json!({ "levels": 2 });
        let lines = page.compute_with(part, &[view], &json!([]), &settings);
        assert_eq!(lines.last().unwrap()["answer"], "done");
        assert_eq!(read(first).lines().last().unwrap()["answer"], "superseded", "{changes}");
    }
}

/// Force levels are drawn at once, and again as the command draws them.
#[test]
fn levels_come_as_a_draft_first() {
    let page = Page::new();
    let settings = json!({ "level_from": 2, "level_to": 40, "levels": 5 });
    let lines = page.compute_with("levels", &["levels"], &json!([]), &settings);
    let pictures: Vec<&Value> = lines.iter().filter(|line| line["answer"] == "picture").collect();
    let drafts: Vec<&Value> = pictures.iter().map(|picture| &picture["draft"]).collect();
    assert_eq!(drafts, [true, false]);
    let words: Vec<&str> = lines.iter().filter_map(|line| line["text"].as_str()).collect();
    assert!(words[0].contains("a draft") && words[1] == "5 runs\n", "{words:?}");
    let points = |picture: &Value| -> Vec<f64> {
        let data: Value = serde_json::from_str(picture["data"].as_str().unwrap()).unwrap();
        let marks = data["panels"][0]["series"][0]["marks"].as_array().unwrap().clone();
        marks.iter().map(|mark| mark.as_f64().unwrap()).collect()
    };
    let [draft, last] = [points(pictures[0]), points(pictures[1])];
    assert_eq!(draft.len(), last.len());
    assert!(draft.iter().zip(&last).all(|(a, b)| (a - b).abs() < 2.0), "{draft:?} {last:?}");
    // Scenarios by finite differences, whose errors take no runs of their own, have no draft.
    let changes = json!([["/method", { "kind": "finite_difference", "cell_m": 2e-2 }]]);
    let lines = page.compute_with("levels", &["levels"], &changes, &json!({ "levels": 2 }));
    assert_eq!(lines.iter().filter(|line| line["answer"] == "picture").count(), 1);
}

/// The path of a contact is drawn with its law and the state at rest; a damped contact has a loop.
#[test]
fn paths_of_contacts_are_drawn() {
    let page = Page::new();
    let names = |changes: &Value| {
        let lines = page.compute("hit", &["pressure_closure"], changes);
        let data = line(&lines, "picture")["data"].as_str().unwrap().to_owned();
        let data: Value = serde_json::from_str(&data).unwrap();
        let series = data["panels"][0]["series"].as_array().unwrap().clone();
        let runs = series[0]["runs"][0].as_array().unwrap().clone();
        let names = series.iter().map(|one| one["name"].as_str().unwrap().to_owned());
        (names.collect::<Vec<_>>(), runs)
    };
    let (series, elastic) = names(&json!([]));
    assert_eq!(series, ["path", "law", "at rest"]);
    let damped = json!([["/interfaces/0/damping", { "kind": "kelvin_voigt", "time_s": 3e-5 }]]);
    assert_ne!(names(&damped).1, elastic);
}

/// So does a branch of steady responses that folds for minutes.
#[test]
fn a_newer_input_stops_a_long_branch() {
    let stack = r#"{"schema": "asperity/scenario/1",
        "bodies": [{"name": "upper", "length_m": 0.1, "mass_kg": 2, "youngs_modulus_pa": 2e11, "density_kg_per_m3": 7850},
                   {"name": "middle", "length_m": 0.05, "mass_kg": 1, "youngs_modulus_pa": 71e9, "density_kg_per_m3": 2700},
                   {"name": "lower", "length_m": 0.1, "mass_kg": 3, "youngs_modulus_pa": 2e11, "density_kg_per_m3": 7850}],
        "interfaces": [
            {"name": "a", "area_m2": 4e-4, "law": {"kind": "constant", "stiffness_pa_per_m": 1e12, "unilateral": true}},
            {"name": "b", "area_m2": 4e-4, "law": {"kind": "constant", "stiffness_pa_per_m": 8e12, "unilateral": true}},
            {"name": "c", "area_m2": 4e-4, "law": {"kind": "constant", "stiffness_pa_per_m": 3e12, "unilateral": true}}],
        "damping": {"kind": "mass_proportional", "ratio": 0.01}, "duration_s": 0.1}"#;
    let document = Document::parse(stack, Path::new("stack.json")).unwrap();
    let page = Page::of_document(document, &ExploreOptions::default());
    let path = format!("{}compute", page.path);
    let settings =
        |amplitude: f64| json!({ "amplitudes": [amplitude], "from_hz": 200, "to_hz": 1800 });
    let asked = request("tab", "steady", &["steady"], &json!([]), &settings(20.0)).to_string();
    let first = page.open("POST", &path, &page.own_head(), asked.as_bytes());
    assert_eq!(page.get("").status, 200);
    let lines = page.compute_with("steady", &["steady"], &json!([]), &settings(1e-3));
    assert_eq!(lines.last().unwrap()["answer"], "done");
    assert_eq!(read(first).lines().last().unwrap()["answer"], "superseded");
}
