//! Forces of samples, from a file and from points of the document.

use asperity_scenario::Document;
use asperity_simulation::run::{Run, simulate};
use serde_json::json;

fn run_of(document: &Document) -> Run {
    simulate(document, &document.scenario().unwrap()).unwrap()
}

/// A force from points is the force from a file of the same rows, rescaled, reversed or as it is; and a densely sampled
/// haversine is the haversine.
#[test]
fn points_are_the_rows_of_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let text = std::fs::read_to_string("examples/block.json").unwrap();
    let (peak, duration) = (7.0, 1e-3);
    let at = |n: usize| {
        let time = n as f64 * duration / 400.0;
        (time, peak * (std::f64::consts::PI * time / duration).sin().powi(2))
    };
    let points: Vec<(f64, f64)> = (0..=400).map(at).collect();
    let header = std::iter::once("time_s,force_n".to_owned());
    let rows = points.iter().map(|(time, force)| format!("{time},{force}"));
    let table: Vec<String> = header.chain(rows).collect();
    std::fs::write(folder.path().join("force.csv"), table.join("\n")).unwrap();
    let run = |excitation: serde_json::Value| {
        let mut document = Document::parse(&text, folder.path().join("block.json")).unwrap();
        document.set("/excitation", &excitation.to_string()).unwrap();
        run_of(&document)
    };
    for peak_n in [None, Some(-3.0)] {
        let mut of_file = json!({ "kind": "samples", "file": "force.csv" });
        let mut of_points = json!({ "kind": "samples", "points": points });
        if let Some(peak_n) = peak_n {
            of_file["peak_n"] = json!(peak_n);
            of_points["peak_n"] = json!(peak_n);
        }
        let (of_file, of_points) = (run(of_file), run(of_points));
        let [of_rows, found] = [&of_file, &of_points]
            .map(|run| run.transient.history.sensors[0].displacement.as_slice());
        let largest = of_rows.iter().fold(0.0, |most: f64, u| most.max(u.abs()));
        let differs = of_rows.iter().zip(found).any(|(a, b)| (a - b).abs() > 1e-9 * largest);
        assert!(largest > 0.0 && !differs, "{peak_n:?}");
        for run in [&of_file, &of_points] {
            assert_eq!(run.assembly.load.value(0.5 * duration), peak_n.unwrap_or(peak));
        }
    }
    let of_points = run(json!({ "kind": "samples", "points": points }));
    let exact = run(json!({ "kind": "haversine", "peak_n": peak, "duration_s": duration }));
    let [f1, f1_exact] =
        [&of_points, &exact].map(|run| run.summary.fundamental.unwrap().frequency_hz);
    assert!((f1 / f1_exact - 1.0).abs() < 1e-4, "{f1} and {f1_exact}");
}
