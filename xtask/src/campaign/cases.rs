//! A folder of scenarios in which an engine was once wrong, with their truths.
//!
//! `truths.json` holds the true observables of each scenario by its file stem, determined by
//! refined runs of both engines.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::{Context, Result, ensure};
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
    let path = folder.join(TRUTHS);
    let text = std::fs::read_to_string(&path)
        .with_context(|| format!("reading {}; --bless writes it", path.display()))?;
    let truths: Truths =
        serde_json::from_str(&text).with_context(|| format!("reading {}", path.display()))?;
    let judge_one = |(name, path): (String, PathBuf)| {
        let started = Instant::now();
        let truth = truths.get(&name).with_context(|| format!("no truth of \"{name}\""))?;
        let document = Document::read(&path)?;
        let scenario = document.scenario()?;
        let judgement = Case { document: &document, scenario: &scenario }.judge_by(truth);
        let seconds = started.elapsed().as_secs_f64();
        Ok(Judged { name, judgement, steady: Vec::new(), seconds })
    };
    scenarios(folder)?.into_par_iter().map(judge_one).collect()
}

/// Determines the truths of the scenarios of `folder` by refined runs, and stores them.
///
/// # Errors
/// For a folder that cannot be read or written, or a scenario that is not valid.
pub(super) fn bless(folder: &Path) -> Result<()> {
    let scenarios = scenarios(folder)?;
    let bar = super::progress(scenarios.len() as u64);
    let truth = |(name, path): (String, PathBuf)| {
        let document = Document::read(&path)?;
        let scenario = document.scenario()?;
        let truth = Case { document: &document, scenario: &scenario }.truth();
        bar.inc(1);
        Ok((name, truth))
    };
    let truths = scenarios.into_par_iter().map(truth).collect::<Result<Truths>>()?;
    bar.finish_and_clear();
    let mut text = serde_json::to_string_pretty(&truths)?;
    text.push('\n');
    crate::reproduce::write(&folder.join(TRUTHS), text.as_bytes())
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
