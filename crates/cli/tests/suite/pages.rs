//! Pages: figures with the points that their script zooms and reads out.

use std::path::Path;
use std::process::Command;

use serde_json::Value;

use crate::{asperity, fixture, number, text};

/// The data of each figure of a page that can be zoomed.
fn figures(page: &Path) -> Vec<Value> {
    let html = std::fs::read_to_string(page).unwrap();
    assert!(!html.contains("src=\"http") && !html.contains("href=\"http"), "self-contained");
    let parts = html.split("<script type=\"application/json\" class=\"panels\">").skip(1);
    let data = parts.map(|part| part.split_once("</script>").unwrap().0);
    data.map(|data| serde_json::from_str(data).unwrap()).collect()
}

/// The value at a place of an axis of a panel, as the script computes it.
fn value(panel: &Value, axis: &str, place: f64) -> f64 {
    let frame = |side: usize| number(panel, &format!("/frame/{side}"));
    let (start, end) = if axis == "xAxis" { (frame(0), frame(2)) } else { (frame(3), frame(1)) };
    let (low, high) =
        (number(panel, &format!("/{axis}/low")), number(panel, &format!("/{axis}/high")));
    let part = (place - start) / (end - start);
    if panel[axis]["log"].as_bool().unwrap() {
        low * (high / low).powf(part)
    } else {
        low + part * (high - low)
    }
}

/// Columns of a CSV file without quotes, by their names.
fn columns(path: &Path, names: [&str; 2]) -> Vec<[f64; 2]> {
    let csv = std::fs::read_to_string(path).unwrap();
    let mut lines = csv.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let at = names.map(|name| header.iter().position(|column| *column == name).unwrap());
    let cells = lines.map(|line| line.split(',').collect::<Vec<_>>());
    cells.map(|cells| at.map(|column| cells[column].parse().unwrap())).collect()
}

#[test]
fn the_points_of_a_steady_page_are_those_of_its_table() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = fixture("scenarios/nouira2020-modified.json").display().to_string();
    let run =
        ["steady", &scenario, "--out", "out", "--amplitude", "1", "--from", "820", "--to", "900"];
    let output = asperity(folder.path(), &run);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let out = folder.path().join("out");
    let figures = figures(&out.join("report.html"));
    assert_eq!(figures.len(), 1);
    let panel = &figures[0]["panels"][0];
    assert_eq!(panel["xAxis"]["label"], "Frequency");
    let drawn: Vec<f64> = panel["series"]
        .as_array()
        .unwrap()
        .iter()
        .flat_map(|series| series["runs"].as_array().unwrap())
        .flat_map(|run| run.as_array().unwrap())
        .map(|number| number.as_f64().unwrap())
        .collect();
    let table = columns(&out.join("steady.csv"), ["frequency_hz", "amplitude_1_m"]);
    assert!(table.len() > 10);
    for [frequency, amplitude] in table {
        let near = drawn.chunks(2).any(|point| {
            let x = value(panel, "xAxis", point[0]);
            let y = value(panel, "yAxis", point[1]);
            (x / frequency - 1.0).abs() < 1e-5 && (y / (1e6 * amplitude) - 1.0).abs() < 1e-4
        });
        assert!(near, "{frequency} Hz, {amplitude} m is not drawn");
    }
}

#[test]
fn the_page_of_an_analysis_holds_all_figures_and_hits() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = fixture("scenarios/nouira2020-modified.json").display().to_string();
    let simulate = ["simulate", &scenario, "--out", "hit", "--record", "npz"];
    assert!(asperity(folder.path(), &simulate).status.success());
    let response = ["--response", "acceleration"];
    let run = [&["analyse", "hit/record.npz", "--out", "out", "--band", "600:1000"], &response[..]];
    let run = run.concat();
    let output = asperity(folder.path(), &run);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let page = folder.path().join("out/report.html");
    let figures = figures(&page);
    let titles: Vec<&str> = figures.iter().filter_map(|figure| figure["title"].as_str()).collect();
    for title in ["Features against force", "Frequency response functions", "Hits over time"] {
        assert!(titles.contains(&title), "{titles:?}");
    }
    let functions = figures.iter().find(|f| f["title"] == "Frequency response functions").unwrap();
    // The band is shaded in every panel, at the frequencies given.
    for panel in functions["panels"].as_array().unwrap() {
        let ends =
            [0, 1].map(|end| value(panel, "xAxis", number(&panel["shades"], &format!("/0/{end}"))));
        assert!((ends[0] - 600.0).abs() < 0.1 && (ends[1] - 1000.0).abs() < 0.1, "{ends:?}");
    }
    let html = std::fs::read_to_string(&page).unwrap();
    assert!(html.contains("band of the fundamental") && html.contains("600.0 to 1000.0 Hz, given"));
}

#[test]
fn a_browser_runs_the_script_of_a_page() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = fixture("scenarios/nouira2020-modified.json").display().to_string();
    let run = ["steady", &scenario, "--amplitude", "1", "--from", "860", "--to", "900"];
    let output = asperity(folder.path(), &[&run[..], &["--out", "out"]].concat());
    assert!(output.status.success(), "{}", text(&output.stderr));
    let page = folder.path().join("out/report.html");
    let browser = Command::new("timeout")
        .args(["60", "chromium", "--headless", "--no-sandbox", "--disable-gpu", "--dump-dom"])
        .arg(format!("--user-data-dir={}", folder.path().join("profile").display()))
        .arg(format!("file://{}", page.display()))
        .output();
    let shown =
        browser.ok().filter(|shown| shown.status.success()).map(|shown| text(&shown.stdout));
    let Some(shown) = shown.filter(|shown| shown.contains("</html>")) else {
        eprintln!("skipped: chromium is not installed or does not run");
        return;
    };
    // The script ends by adding the frame of a zoom to each figure, after a clip for each panel.
    assert!(!std::fs::read_to_string(&page).unwrap().contains("<clipPath"));
    let panels = figures(&page)[0]["panels"].as_array().unwrap().len();
    assert_eq!(shown.matches("<clipPath").count(), panels);
    assert!(shown.contains("class=\"tip\"") && shown.contains("visibility=\"hidden\""));
}
