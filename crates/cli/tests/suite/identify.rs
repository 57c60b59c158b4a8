//! The contract of `asperity identify`: its files, and their content.

use std::path::Path;

use asperity_figure::svg_to_png;
use serde_json::{Value, json};

use crate::{answer, asperity};

const COEFFICIENT: f64 = 1.81e10;
const EXPONENT: f64 = 0.35;

/// The rig of the fixtures with a power law, watched for 20 ms.
pub(crate) fn rig() -> Value {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../fixtures/scenarios/nouira2020-modified.json");
    let mut rig: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    rig["laws"] =
        json!({"pl": {"kind": "power", "coefficient": COEFFICIENT, "exponent": EXPONENT}});
    for interface in rig["interfaces"].as_array_mut().unwrap() {
        interface["law"] = json!("pl");
    }
    rig["method"] = json!("modal");
    rig["duration_s"] = json!(0.02);
    rig["output_rate_hz"] = json!(20_000);
    rig
}

/// Runs the problem and checks every file of it: pictures that can be drawn, and a page that says
/// what the answer says and asks for nothing else.
fn identified(problem: &Value, pictures: &[&str]) -> Value {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("problem.json"), problem.to_string()).unwrap();
    let found = answer(folder.path(), &["identify", "problem.json", "--json", "--out", "found"]);
    let out = folder.path().join("found");
    let mut expected: Vec<String> = pictures.iter().map(|name| format!("{name}.svg")).collect();
    expected.extend(
        ["data.csv", "draws.json", "identification.json", "law.csv", "law.json", "posterior.csv"]
            .map(str::to_owned),
    );
    expected.extend(["report.html", "scenario.json"].map(str::to_owned));
    expected.sort();
    assert_eq!(crate::files(&out), expected);

    let read = |name: &str| std::fs::read_to_string(out.join(name)).unwrap();
    let page = read("report.html");
    for name in pictures {
        let svg = read(&format!("{name}.svg"));
        // A picture that is no XML cannot be drawn.
        assert!(svg_to_png(&svg, 2.0).is_ok(), "{name}");
        // What cannot be drawn is named in red.
        for refusal in ["has no finite point", "cannot span", "abscissae and"] {
            assert!(!svg.contains(refusal), "{name}: {refusal}");
        }
        assert!(page.contains(&format!("id=\"{name}\"")), "{name}");
    }
    for word in found["words"].as_array().unwrap() {
        let word = word.as_str().unwrap().replace('"', "&quot;").replace('\'', "&#39;");
        assert!(page.contains(&word), "{word}");
    }
    for fetched in ["<link", "<script src", "src=\"http", "url(http", "fetch(", "import("] {
        assert!(!page.contains(fetched), "{fetched}");
    }
    predicts(&out);
    let hash = found["provenance"]["problem_sha256"].as_str().unwrap();
    assert_eq!(hash.len(), 64);
    assert!(page.contains(hash));
    found
}

/// A study runs the identified scenario with draws of the posterior.
fn predicts(found: &Path) {
    let study = json!({
        "schema": "asperity/study/1", "scenario": "scenario.json",
        "draws": {"file": "draws.json"}, "design": {"kind": "sobol", "rows": 4},
    });
    std::fs::write(found.join("study.json"), study.to_string()).unwrap();
    let output = crate::asperity(found, &["study", "study.json", "--out", "predicted"]);
    assert!(output.status.success(), "{}", crate::text(&output.stderr));
    let table = std::fs::read_to_string(found.join("predicted/study.csv")).unwrap();
    let mut rows = table.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let header = rows.next().unwrap();
    let place = |name: &str| header.iter().position(|column| *column == name).unwrap();
    let (draw, frequency) = (place("draw"), place("fundamental.frequency_hz"));
    let rows: Vec<_> = rows.collect();
    assert_eq!(rows.len(), 4);
    for row in rows {
        assert!(row[draw].parse::<f64>().unwrap() >= 1.0, "{row:?}");
        assert!(row[frequency].parse::<f64>().unwrap() > 100.0, "{row:?}");
    }
}

fn estimate(found: &Value, name: &str) -> f64 {
    let all = found["estimates"].as_array().unwrap();
    all.iter().find(|one| one["name"] == name).unwrap()["value"].as_f64().unwrap()
}

/// A problem that is solved at once: points of the law of `rig`.
pub(crate) fn quick_problem(rig: &Value) -> Value {
    let pressures: [f64; 5] = [3e4, 6e4, 1e5, 2e5, 4e5];
    let points: Vec<[f64; 2]> =
        pressures.iter().map(|p| [*p, COEFFICIENT * p.powf(EXPONENT)]).collect();
    json!({
        "schema": "asperity/identify/1",
        "title": "A power law & its \"points\"",
        "scenario": rig,
        "unknowns": [
            {"kind": "scalar", "pointer": "/laws/pl/coefficient", "bounds": [1e9, 1e11], "start": 1e10},
            {"kind": "scalar", "pointer": "/laws/pl/exponent", "bounds": [0.1, 0.8], "start": 0.5},
        ],
        "data": [{"kind": "stiffness", "law": "pl", "points": points, "spread": {"relative": 0.05}}],
        "starts": 1,
        "draws": 100,
    })
}

/// Stiffnesses of a power law give its numbers again: noise-free, so to the search's tolerance.
#[test]
fn a_law_is_found_from_its_points() {
    let found = identified(
        &quick_problem(&rig()),
        &["comparison", "law", "pairs", "profiles", "residuals"],
    );
    assert!((estimate(&found, "/laws/pl/exponent") - EXPONENT).abs() < 1e-4);
    assert!((estimate(&found, "/laws/pl/coefficient") / COEFFICIENT - 1.0).abs() < 1e-3);
}

/// Simulated hits give the law's coefficient and the damping again, and every figure that hits
/// have; the receptance of one of them has its own.
#[test]
fn a_law_is_found_from_hits() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("rig.json"), rig().to_string()).unwrap();
    let hits = [4.0, 8.0, 12.0].map(|force| {
        let level = format!("/excitation/peak_n={force}");
        let out = format!("{force}");
        let asked = ["simulate", "rig.json", "--json", "--set", &level, "--out", &out];
        let summary = answer(folder.path(), &asked);
        let of = |key: &str, part: f64| {
            let value = summary["fundamental"][key].as_f64().unwrap();
            json!({"value": value, "standard_deviation": part * value})
        };
        json!({"force_peak_n": force, "features": {
            "fundamental.frequency_hz": of("frequency_hz", 1e-3),
            "fundamental.receptance_m_per_n": of("receptance_m_per_n", 1e-2),
        }})
    });
    let found = identified(
        &json!({
            "schema": "asperity/identify/1",
            "scenario": rig(),
            "unknowns": [
                {"kind": "scalar", "pointer": "/laws/pl/coefficient", "bounds": [1e10, 3e10], "start": 2e10},
                {"kind": "scalar", "pointer": "/damping/ratio", "bounds": [0.02, 0.06], "start": 0.03},
            ],
            "data": [
                {"kind": "hits", "hits": hits},
                {"kind": "frf", "file": folder.path().join("8/frf.csv"), "hit": {"force_peak_n": 8},
                 "band_hz": [600, 1200], "spread": {"relative": 0.02}, "points": 12},
            ],
            "starts": 1,
            "draws": 100,
            "design": {"force_peak_n": [4, 12], "set": [{}, {"/bodies/0/mass_kg": 3.2}]},
        }),
        &[
            "comparison",
            "design",
            "features",
            "law",
            "pairs",
            "profiles",
            "receptance",
            "residuals",
        ],
    );
    assert!((estimate(&found, "/laws/pl/coefficient") / COEFFICIENT - 1.0).abs() < 1e-3);
    assert!((estimate(&found, "/damping/ratio") / 0.035 - 1.0).abs() < 1e-3);
}

/// A wrong problem ends with status 2, its place on standard error, and no folder.
#[test]
fn bad_problems_are_refused_with_their_place() {
    let folder = tempfile::tempdir().unwrap();
    let number = json!({"value": 850.0, "standard_deviation": 1.0});
    let good = json!({
        "schema": "asperity/identify/1",
        "scenario": rig(),
        "unknowns": [{"kind": "scalar", "pointer": "/damping/ratio", "bounds": [0.01, 0.1]}],
        "data": [{"kind": "hits", "hits": [
            {"force_peak_n": 9, "features": {"fundamental.frequency_hz": number}}]}],
    });
    let cases = [
        ("/data", json!([]), "/data"),
        ("/unknowns/0/pointer", json!("/damping/rate"), "/damping/rate"),
        ("/unknowns/0/bounds", json!([0.05, 0.1]), "outside its bounds"),
        ("/data/0/kind", json!("hit"), "did you mean \"hits\"?"),
        ("/scenario/bodies/0/mass_kg", json!(-1.0), "/scenario/bodies/0/mass_kg"),
    ];
    for (pointer, value, expected) in cases {
        let mut problem = good.clone();
        *problem.pointer_mut(pointer).unwrap() = value;
        std::fs::write(folder.path().join("problem.json"), problem.to_string()).unwrap();
        let output = asperity(folder.path(), &["identify", "problem.json", "--out", "found"]);
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{pointer}: {said}");
        assert!(said.contains(expected), "{expected} is not in: {said}");
        assert!(!folder.path().join("found").exists(), "{pointer}");
    }
}

/// A run that is stopped leaves the finished result of the folder as it is.
#[cfg(unix)]
#[test]
fn a_stopped_run_keeps_the_finished_result() {
    use std::process::{Command, Stdio};
    let folder = tempfile::tempdir().unwrap();
    let store = |problem: &Value| {
        std::fs::write(folder.path().join("problem.json"), problem.to_string()).unwrap();
    };
    let mut problem = quick_problem(&rig());
    store(&problem);
    answer(folder.path(), &["identify", "problem.json", "--json", "--out", "found"]);
    let finished = crate::files(&folder.path().join("found"));
    assert!(finished.len() > 10);
    // Long enough to be stopped.
    problem["draws"] = json!(20_000);
    problem["starts"] = json!(64);
    problem["data"][0] = json!({"kind": "hits", "hits": [{"force_peak_n": 10.0, "features": {
        "fundamental.frequency_hz": {"value": 850.0, "standard_deviation": 0.1}}}]});
    store(&problem);
    let mut child = Command::new(env!("CARGO_BIN_EXE_asperity"))
        .args(["identify", "problem.json", "--out", "found", "--threads", "1"])
        .current_dir(folder.path())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let lock = folder.path().join(".found.asperity");
    while !lock.exists() && child.try_wait().unwrap().is_none() {
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    let id = rustix::process::Pid::from_child(&child);
    let _ = rustix::process::kill_process(id, rustix::process::Signal::INT);
    let out = child.wait_with_output().unwrap();
    let message = crate::text(&out.stderr);
    assert!(!out.status.success(), "{message}");
    assert_eq!(crate::files(&folder.path().join("found")), finished, "{message}");
    let beside = folder.path().join("found-stopped");
    assert_eq!(beside.exists(), message.contains("found-stopped"), "{message}");
}
