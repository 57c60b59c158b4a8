//! A folder of scenarios in which an engine was once wrong, with their truths.
//!
//! `truths.json` holds the true observables of each scenario by its file stem, determined by
//! refined runs of both engines.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::{Context, Result, ensure};
use asperity_figure::report::{Report, TableCell};
use asperity_scenario::Document;
use rayon::prelude::*;

use super::Judged;
use super::judgement::{Case, TrueValue};

/// File of the truths.
const TRUTHS: &str = "truths.json";

/// True observables of scenarios by file stem.
type Truths = BTreeMap<String, Vec<TrueValue>>;

/// Judges the default answers of both engines to the scenarios of `folder` by the stored truths.
///
/// # Errors
/// For a folder that cannot be read, a scenario that is not valid, or one without a truth.
pub(super) fn judge(folder: &Path) -> Result<Vec<Judged>> {
    let truths = stored(folder)?;
    let judge_one = |(name, path): (String, PathBuf)| {
        let started = Instant::now();
        let truth = truths.get(&name).with_context(|| format!("no truth of \"{name}\""))?;
        let document = Document::read(&path)?;
        let scenario = document.scenario()?;
        let judgement = Case { document: &document, scenario: &scenario }.judge_by(truth);
        let seconds = started.elapsed().as_secs_f64();
        Ok(Judged { name, judgement, steady: Vec::new(), stated: None, seconds })
    };
    scenarios(folder)?.into_par_iter().map(judge_one).collect()
}

/// Determines the truths that `folder` does not hold yet by refined runs, and stores all of them,
/// with a table of them in `README.md`.
///
/// # Errors
/// For a folder that cannot be read or written, or a scenario that is not valid.
pub(super) fn bless(folder: &Path) -> Result<()> {
    let known = if folder.join(TRUTHS).exists() { stored(folder)? } else { Truths::default() };
    let scenarios = scenarios(folder)?;
    let bar = super::progress(scenarios.len() as u64);
    let truth = |(name, path): (String, PathBuf)| {
        let document = Document::read(&path)?;
        let scenario = document.scenario()?;
        let case = Case { document: &document, scenario: &scenario };
        let truth = known.get(&name).cloned().unwrap_or_else(|| case.truth());
        bar.inc(1);
        Ok((name, (scenario.title.unwrap_or_default(), truth)))
    };
    let found = scenarios.into_par_iter().map(truth).collect::<Result<BTreeMap<_, _>>>()?;
    bar.finish_and_clear();
    crate::reproduce::write(&folder.join("README.md"), readme(&found).as_bytes())?;
    let truths: Truths = found.into_iter().map(|(name, (_, truth))| (name, truth)).collect();
    let mut text = serde_json::to_string_pretty(&truths)?;
    text.push('\n');
    crate::reproduce::write(&folder.join(TRUTHS), text.as_bytes())
}

/// The stored truths of a folder.
fn stored(folder: &Path) -> Result<Truths> {
    let path = folder.join(TRUTHS);
    let text = std::fs::read_to_string(&path)
        .with_context(|| format!("reading {}; --bless writes it", path.display()))?;
    serde_json::from_str(&text).with_context(|| format!("reading {}", path.display()))
}

/// Titles and truths as Markdown tables.
fn readme(found: &BTreeMap<String, (String, Vec<TrueValue>)>) -> String {
    let mut report = Report::new("Random scenarios in which an engine was wrong").intro(
        "Each observable is the mean of a modal run and of one by finite differences, both refined \
         until they agree; the uncertainty is half their difference, in tolerances of the campaign. \
         An observable without a truth differs between all refined runs: the response is chaotic. \
         The mean stiffness of i0 in random-089 converges in first order at equal steps: its truth is the \
         mean of their limit from steps of 50 and 25 ns, and of modal steps of their own. \
         The contacts of seed20261302-78 amplify differences some hundred times: cells down to 0.06 mm do \
         not converge, and say so; its truths are the mean of modal runs with steps of their own and of \
         0.5 to 0.1 us with 4 to 64 modes, which agree within 4e-5. \
         The mean stiffness of contact 0 in seed20261306-69 converges in first order at equal steps too: \
         its truth is the mean of modal steps of their own to 1e-6 and of cells of 0.0625 mm. \
         A2/A1 of seed20261311-144 is that of modal runs to 1e-4 and 1e-5, which agree within 2e-6, and the \
         limit of cells of 2 and 1 mm. \
         A new case is a scenario in this folder; the task campaign with the options cases and bless \
         adds its truth here and in truths.json.",
    );
    for (name, (title, truths)) in found {
        let row = |truth: &TrueValue| {
            let value = match (truth.known, truth.observable.value) {
                (false, _) => "no truth".to_owned(),
                (true, None) => "none".to_owned(),
                (true, Some(value)) => format!("{value:.6e}"),
            };
            let uncertainty = if truth.known { truth.uncertainty } else { f64::NAN };
            let observable = truth.observable.name.as_str();
            vec![observable.into(), TableCell::Number(value), uncertainty.into()]
        };
        report = report
            .section(format!("{name}: {title}"))
            .table(["observable", "truth", "uncertainty"], truths.iter().map(row));
    }
    report.to_markdown(ToOwned::to_owned)
}

/// File stems and paths of the scenarios of a folder, by name.
fn scenarios(folder: &Path) -> Result<Vec<(String, PathBuf)>> {
    let entries =
        std::fs::read_dir(folder).with_context(|| format!("reading {}", folder.display()))?;
    let mut found = Vec::new();
    for entry in entries {
        let path = entry?.path();
        let is_scenario = path.extension().is_some_and(|extension| extension == "json")
            && path.file_name().is_some_and(|name| name != TRUTHS);
        if let (true, Some(stem)) = (is_scenario, path.file_stem()) {
            found.push((stem.to_string_lossy().into_owned(), path));
        }
    }
    ensure!(!found.is_empty(), "the folder {} holds no scenarios", folder.display());
    found.sort();
    Ok(found)
}
