//! Study files: what they mean, and what is refused in which words.

use asperity_scenario::Document;
use asperity_simulation::row_simulator::RowSimulator;
use asperity_study::StudyError;
use serde_json::{Value, json};

use crate::support::{plan, study};

fn refused(change: impl FnOnce(&mut Value)) -> String {
    let mut study = study(&json!({"kind": "sobol", "rows": 8}), 4);
    change(&mut study);
    match plan(&study).unwrap_err() {
        StudyError::Invalid(invalid) => {
            let faults = invalid.diagnostics.iter();
            faults.map(ToString::to_string).collect::<Vec<_>>().join("\n")
        }
        other => other.to_string(),
    }
}

#[test]
fn inputs_follow_their_distributions() {
    let plan = plan(&study(&json!({"kind": "grid", "levels": [3, 4]}), 5)).unwrap();
    assert_eq!(plan.rows(), 12);
    assert_eq!(plan.names(), ["/excitation/peak_n", "case"]);
    let rows = plan.values(0..12).unwrap();
    assert_eq!(rows[0], [json!(4.0), json!("a, b")]);
    assert_eq!(rows[3], [json!(4.0), json!("=c")]);
    assert_eq!(rows[11], [json!(12.0), json!("=c")]);
    assert_eq!(rows.iter().filter(|row| row[1] == "=c").count(), 3);
}

#[test]
fn posterior_draws_keep_their_dependence_and_weights() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = std::fs::read("../simulation/examples/block.json").unwrap();
    std::fs::write(folder.path().join("block.json"), scenario).unwrap();
    let draws = "weight,force,title,other\n0.25,3,7,x\n0.75,5,9,y\n0,1,1,z\n";
    std::fs::write(folder.path().join("posterior.csv"), draws).unwrap();
    let text = json!({
        "schema": "asperity/study/1",
        "scenario": "block.json",
        "draws": {"file": "posterior.csv",
                  "columns": {"/excitation/peak_n": "force", "/title": "title"}},
        "design": {"kind": "sobol", "rows": 64}
    });
    let of = |text: &Value| {
        let path = folder.path().join("study.json");
        asperity_study::StudyPlan::of(Document::parse(&text.to_string(), path).unwrap())
    };
    let plan = of(&text).unwrap();
    let rows = plan.values(0..64).unwrap();
    assert_eq!(rows.iter().filter(|row| **row == [json!(3.0), json!(7.0)]).count(), 16);
    assert_eq!(rows.iter().filter(|row| **row == [json!(5.0), json!(9.0)]).count(), 48);
    let mut other = text.clone();
    other["draws"]["columns"]["/title"] = json!("name");
    let fault = of(&other).unwrap_err().to_string();
    assert!(
        fault.contains("the column \"name\"; accepted: weight, force, title, other"),
        "{fault}"
    );
    other["draws"]["columns"]["/title"] = json!("other");
    let fault = of(&other).unwrap_err().to_string();
    assert_eq!(fault, "/draws: `x` in row 1 is not a number");
}

/// Draws that change the scenario, as `draws.json` of an identification: each run has the numbers of a
/// run of the changed scenario, but for the estimate of their error, which is from a structure near it.
#[test]
fn draws_of_laws_change_the_scenario() {
    let folder = tempfile::tempdir().unwrap();
    let scenario: Value =
        serde_json::from_slice(&std::fs::read("../simulation/examples/block.json").unwrap())
            .unwrap();
    std::fs::write(folder.path().join("block.json"), scenario.to_string()).unwrap();
    let name = scenario["laws"].as_object().unwrap().keys().next().unwrap();
    let law = format!("/laws/{name}");
    let table = |factor: f64| {
        let point = |p: f64| json!([p, factor * 1e10 * p.sqrt()]);
        let points = [1e3, 1e4, 1e5, 1e6].map(point);
        json!({"kind": "table", "points": points})
    };
    let draws = json!({"schema": "asperity/draws/1", "pointers": [&law, "/damping/ratio"],
        "weights": [1.0, 3.0], "draws": [[table(1.0), 0.02], [table(1.2), 0.03]]});
    let write = |draws: &Value| {
        std::fs::write(folder.path().join("draws.json"), draws.to_string()).unwrap();
    };
    let text = json!({
        "schema": "asperity/study/1", "scenario": "block.json",
        "inputs": [{"pointer": "/excitation/peak_n",
                    "distribution": {"kind": "uniform", "lower": 2, "upper": 14}}],
        "draws": {"file": "draws.json"},
        "design": {"kind": "sobol", "rows": 8}
    });
    let of = |text: &Value| {
        let path = folder.path().join("study.json");
        asperity_study::StudyPlan::of(Document::parse(&text.to_string(), path).unwrap())
    };
    write(&draws);
    let plan = of(&text).unwrap();
    assert_eq!(plan.names(), ["/excitation/peak_n", "draw"]);
    assert_eq!(plan.coordinates(), ["/excitation/peak_n", "draws"]);
    let rows = plan.values(0..8).unwrap();
    let simulator = plan.simulator().unwrap();
    let found = simulator.run(&plan.model_rows(&rows));
    let mut counts = [0; 2];
    for (row, found) in rows.iter().zip(found) {
        let draw = row[1].as_f64().unwrap() as usize - 1;
        counts[draw] += 1;
        let mut changed = scenario.clone();
        changed["excitation"]["peak_n"] = row[0].clone();
        changed["laws"][name] = draws["draws"][draw][0].clone();
        changed["damping"]["ratio"] = draws["draws"][draw][1].clone();
        let document = Document::parse(&changed.to_string(), "block.json").unwrap();
        let alone = RowSimulator::new(document, Vec::new()).unwrap();
        let bits = |values: &[f64]| {
            let named = simulator.columns().iter().zip(values);
            let own = named.filter(|(name, _)| *name != "accuracy.estimated_error");
            own.map(|(_, value)| value.to_bits()).collect::<Vec<_>>()
        };
        let expected = alone.run(&[Vec::new()]).remove(0).unwrap();
        assert_eq!(bits(&found.unwrap().values), bits(&expected.values));
    }
    assert_eq!(counts, [2, 6]);

    assert_eq!(plan.warning(), None);
    for (usability, warned) in [("no", true), ("with_care", false), ("yes", false)] {
        let mut judged = draws.clone();
        let reasons = json!([{"kind": "misfit", "use": usability, "words": "chi-square is 9.",
                              "numbers": {}}]);
        judged["judgement"] = json!({"use": usability, "reasons": reasons});
        write(&judged);
        let plan = of(&text).unwrap();
        assert_eq!(plan.warning().is_some(), warned, "{usability}");
        assert!(plan.warning().is_none_or(|warning| warning.ends_with("chi-square is 9.")));
    }
    let mut other = text.clone();
    other["draws"]["columns"] = json!({"/title": "title"});
    let fault = of(&other).unwrap_err().to_string();
    assert!(fault.contains("`columns` beside a JSON file"), "{fault}");
    let mut short = draws.clone();
    short["draws"][1] = json!([1]);
    write(&short);
    let fault = of(&text).unwrap_err().to_string();
    assert!(fault.contains("draw 2 has 1 values; accepted: 2, one a pointer"), "{fault}");
    let mut foreign = draws.clone();
    foreign["schema"] = json!("asperity/draws/9");
    write(&foreign);
    let fault = of(&text).unwrap_err().to_string();
    assert!(fault.contains("accepted: \"asperity/draws/1\""), "{fault}");
    let mut lost = draws;
    lost["pointers"][0] = json!("/laws/none");
    write(&lost);
    let fault = of(&text).unwrap_err().to_string();
    assert!(fault.contains("/laws/none: the scenario has no such value"), "{fault}");
}

#[test]
fn faults_are_named_with_their_place() {
    let cases: [(&str, String); 9] = [
        (
            "/inputs/0/distribution/kind",
            refused(|study| {
                study["inputs"][0]["distribution"] = json!({"kind": "gauss"});
            }),
        ),
        ("unknown key", refused(|study| study["seeds"] = json!(1)).to_lowercase()),
        (
            "/inputs/0/distribution: the upper end minus the lower one of a uniform distribution is -1",
            refused(|study| study["inputs"][0]["distribution"]["upper"] = json!(1)),
        ),
        (
            "/inputs/1/distribution: the number of weights is 1; accepted: 2 to 2",
            refused(|study| study["inputs"][1]["distribution"]["weights"] = json!([1])),
        ),
        (
            "/title: two inputs set this value",
            refused(|study| study["inputs"][0]["also"] = json!(["/title"])),
        ),
        (
            "/damping/rato: the scenario has no such value",
            refused(|study| study["inputs"][0]["pointer"] = json!("/damping/rato")),
        ),
        (
            "/design/levels: 1 numbers; expected 2, one an input",
            refused(|study| study["design"] = json!({"kind": "grid", "levels": [3]})),
        ),
        (
            "/correlation/matrix: the correlation matrix is 2 in row 1",
            refused(|study| study["correlation"] = json!({"matrix": [[2]]})),
        ),
        (
            "/design: Sobol indices are defined for independent inputs",
            refused(|study| {
                study["correlation"] = json!({"matrix": [[1, 0.5], [0.5, 1]]});
                study["design"] = json!({"kind": "saltelli", "base_rows": 8});
            }),
        ),
    ];
    for (words, found) in cases {
        assert!(found.contains(words), "`{found}` lacks `{words}`");
    }
}
