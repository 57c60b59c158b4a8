//! Files of a state: scenario, figures, tables, and a problem for `identify`.

use std::io;
use std::path::{Path, PathBuf};

use asperity_figure::{Figure, FigureError};
use asperity_scenario::{AnyScenario, LawRef};
use asperity_simulation::output::write_file;
use serde_json::{Value, json};

use crate::computation::Results;
use crate::measured::Measured;
use crate::message::View;
use crate::state::State;

/// Pixels a millimetre of a figure as PNG: 300 dpi, as the command's.
const PIXELS_PER_MM: f64 = 300.0 / 25.4;

/// Bounds of an unknown number of a law over its value, and the deviation of the force's gain.
const BOUNDS: f64 = 30.0;
const GAIN: f64 = 0.05;

/// Files with their contents.
pub(crate) type Files = Vec<(String, Vec<u8>)>;

/// The figure in its formats, as the command draws it.
pub(crate) fn figure_files(view: View, figure: &Figure) -> Result<Files, FigureError> {
    figure.check()?;
    let named = |ending: &str| format!("{}.{ending}", view.stem());
    Ok(vec![
        (named("svg"), figure.to_svg().into_bytes()),
        (named("pdf"), figure.to_pdf()?),
        (named("png"), figure.to_png(PIXELS_PER_MM)?),
    ])
}

/// Scenario, figures and tables of a state.
pub(crate) fn state_files(
    state: &State,
    results: &[Results],
    views: &[View],
) -> Result<Files, FigureError> {
    let mut files =
        vec![("scenario.json".to_owned(), pretty(&state.document.with_absolute_files()))];
    for results in results {
        for (view, figure) in &results.figures {
            if let (true, Ok(figure)) = (views.contains(view), figure) {
                files.extend(figure_files(*view, figure)?);
            }
        }
        let tables = results.tables.iter();
        files.extend(tables.map(|(name, text)| (name.clone(), text.clone().into_bytes())));
    }
    Ok(files)
}

/// The state as a problem of `asperity identify`: the laws of the interfaces and the gain of the force from the
/// measured hits.
pub(crate) fn problem_files(state: &State, measured: &Measured) -> Result<Files, String> {
    let laws: Vec<(&str, &LawRef)> = match &state.scenario {
        AnyScenario::Bars(bars) => {
            bars.interfaces.iter().map(|one| (&*one.name, &one.law)).collect()
        }
        AnyScenario::Structure(structure) => {
            structure.interfaces.iter().map(|one| (&*one.name, &one.law)).collect()
        }
    };
    let mut unknowns: Vec<Value> = Vec::new();
    let mut known = Vec::new();
    for (interface, law) in laws {
        let LawRef::Named(name) = law else {
            return Err(format!("the law of {interface} has no name; name it in \"laws\""));
        };
        if !known.contains(&name) {
            known.push(name);
            unknowns.extend(unknowns_of(name, state.document.value()));
        }
    }
    unknowns.push(json!({ "kind": "gain", "channel": "force",
                          "prior": { "value": 1, "relative": GAIN } }));
    let absolute = |path: &Path| std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let mut files =
        vec![("scenario.json".to_owned(), pretty(&state.document.with_absolute_files()))];
    let data = if measured.is_temporary {
        let read = std::fs::read(&measured.path);
        let analysis =
            read.map_err(|error| format!("{} cannot be read: {error}", measured.path.display()))?;
        files.push(("analysis.json".to_owned(), analysis));
        // Records are named from here.
        let records = absolute(Path::new("."));
        json!({ "kind": "analysis", "file": "analysis.json", "records": records.display().to_string() })
    } else {
        let file = absolute(&measured.path);
        json!({ "kind": "analysis", "file": file.display().to_string() })
    };
    let problem = json!({
        "schema": "asperity/identify/1",
        "scenario": "scenario.json",
        "unknowns": unknowns,
        "data": [data],
    });
    files.push(("problem.json".to_owned(), pretty(&problem)));
    Ok(files)
}

/// The numbers of a law as unknowns.
fn unknowns_of(name: &str, document: &Value) -> Vec<Value> {
    let Some(law) = document.get("laws").and_then(|laws| laws.get(name)) else { return Vec::new() };
    if law.get("knots").or_else(|| law.get("points")).is_some() {
        return vec![json!({ "kind": "monotone_law", "law": name })];
    }
    let place = name.replace('~', "~0").replace('/', "~1");
    let numbers = law.as_object().into_iter().flatten();
    let unknown = |(key, value): (&String, &Value)| {
        let value = value.as_f64().filter(|value| *value > 0.0)?;
        let bounds = [value / BOUNDS, value * BOUNDS].map(crate::settings::rounded);
        let pointer = format!("/laws/{place}/{key}");
        Some(json!({ "kind": "scalar", "pointer": pointer, "bounds": bounds }))
    };
    numbers.filter_map(unknown).collect()
}

fn pretty(value: &Value) -> Vec<u8> {
    format!("{value:#}\n").into_bytes()
}

/// Names of files that are in a folder already.
pub(crate) fn existing(folder: &Path, files: &Files) -> Vec<String> {
    let names = files.iter().map(|(name, _)| name);
    names.filter(|name| std::fs::symlink_metadata(folder.join(name)).is_ok()).cloned().collect()
}

/// Writes the files; each appears complete or not at all.
pub(crate) fn write(folder: &Path, files: &Files) -> Result<(), (PathBuf, io::Error)> {
    std::fs::create_dir_all(folder).map_err(|error| (folder.to_owned(), error))?;
    for (name, contents) in files {
        let place = folder.join(name);
        let unfinished = folder.join(format!(".{name}.unfinished"));
        let written =
            write_file(&unfinished, contents).and_then(|()| std::fs::rename(&unfinished, &place));
        if let Err(error) = written {
            // What is left of it is no result.
            let _ = std::fs::remove_file(&unfinished);
            return Err((place, error));
        }
    }
    Ok(())
}
