//! The paper's rig from the fixtures, and its runs, each computed once.

use std::collections::HashMap;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};

use anyhow::{Context, Result, anyhow};
use asperity_scenario::{Document, Scenario};
use asperity_study::assemble::Assembly;
use asperity_study::run::{Run, simulate};
use asperity_study::summary::Summary;
use indicatif::ProgressBar;
use rayon::prelude::*;

/// Force levels of a sweep: every newton from the paper's least to its largest.
const LEVELS: std::ops::RangeInclusive<u32> = 9..=32;

/// The force levels of a sweep in N.
pub(crate) fn levels() -> Vec<f64> {
    LEVELS.map(f64::from).collect()
}

/// Every second of [`levels`] and the last: for the figures with many sweeps.
pub(crate) fn few_levels() -> Vec<f64> {
    LEVELS.filter(|n| n % 2 == 1 || n == LEVELS.end()).map(f64::from).collect()
}

/// A scenario with its changes, checked.
pub(crate) struct Case {
    pub(crate) document: Document,
    pub(crate) scenario: Scenario,
}

impl Case {
    /// The objects that compute.
    pub(crate) fn assembly(&self) -> Result<Assembly> {
        Ok(Assembly::new(&self.scenario, self.document.folder())?)
    }
}

/// The three laws that the paper compares, by their name in the scenario.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Law {
    /// The power law, "PL".
    Power,
    /// The modified power law, "Modified PL".
    Modified,
    /// The constant stiffness of 8.5e11 Pa/m.
    Constant,
}

impl Law {
    /// Name in the scenario.
    pub(crate) fn key(self) -> &'static str {
        match self {
            Self::Power => "pl",
            Self::Modified => "modified",
            Self::Constant => "constant",
        }
    }
}

/// The rig, and the runs made with it so far.
pub(crate) struct Rig {
    base: Document,
    quick: bool,
    runs: Mutex<HashMap<String, Arc<Run>>>,
    summaries: Mutex<HashMap<String, Arc<Summary>>>,
    bar: ProgressBar,
}

impl Rig {
    /// Reads the rig from the scenarios' folder; `quick` coarsens its grid, and
    /// `bar` shows how many runs of a sweep are done.
    pub(crate) fn load(scenarios: &Path, quick: bool, bar: ProgressBar) -> Result<Self> {
        let path = scenarios.join("nouira2020-modified.json");
        let base = Document::read(&path).context("reading the paper's rig")?;
        Ok(Self { base, quick, runs: Mutex::default(), summaries: Mutex::default(), bar })
    }

    /// SHA-256 of the rig's scenario.
    pub(crate) fn sha256(&self) -> String {
        self.base.sha256()
    }

    /// The rig with `changes`, pairs of JSON pointer and value.
    pub(crate) fn with(&self, changes: &[(&str, String)]) -> Result<Case> {
        let mut document = self.base.clone();
        if self.quick {
            document.set("/method/cell_m", "0.004")?;
        }
        for (pointer, value) in changes {
            document.set(pointer, value)?;
        }
        let scenario = document.scenario()?;
        Ok(Case { document, scenario })
    }

    /// The rig with `law` at both contacts, struck with `peak` in N.
    pub(crate) fn struck(&self, law: Law, peak: f64) -> Result<Case> {
        let law = law.key().to_owned();
        self.with(&[
            ("/interfaces/0/law", law.clone()),
            ("/interfaces/1/law", law),
            ("/excitation/peak_n", peak.to_string()),
        ])
    }

    /// The run of a case, kept with its whole history; the same case is run once.
    pub(crate) fn run(&self, case: &Case) -> Result<Arc<Run>> {
        let key = case.document.sha256();
        if let Some(done) = locked(&self.runs)?.get(&key) {
            return Ok(Arc::clone(done));
        }
        let run = Arc::new(simulate(&case.document, &case.scenario)?);
        locked(&self.summaries)?.insert(key.clone(), Arc::new(run.summary.clone()));
        locked(&self.runs)?.insert(key, Arc::clone(&run));
        Ok(run)
    }

    /// The summaries of the cases, in their order, over all threads. The same
    /// case is run once, and of its history nothing is kept.
    pub(crate) fn summaries(&self, cases: &[Case]) -> Result<Vec<Arc<Summary>>> {
        self.each(cases, |case| {
            let key = case.document.sha256();
            if let Some(done) = locked(&self.summaries)?.get(&key) {
                return Ok(Arc::clone(done));
            }
            let summary = Arc::new(simulate(&case.document, &case.scenario)?.summary);
            locked(&self.summaries)?.insert(key, Arc::clone(&summary));
            Ok(summary)
        })
    }

    /// Results of `of` for the runs of the cases, in their order, over all threads. Each history is
    /// dropped as soon as `of` returns.
    pub(crate) fn observe<T: Send>(
        &self,
        cases: &[Case],
        of: impl Fn(&Case, &Run) -> Result<T> + Sync,
    ) -> Result<Vec<T>> {
        self.each(cases, |case| {
            let key = case.document.sha256();
            let run = simulate(&case.document, &case.scenario)?;
            locked(&self.summaries)?.insert(key, Arc::new(run.summary.clone()));
            of(case, &run)
        })
    }

    /// The summaries of `law` struck with each of [`levels`].
    pub(crate) fn sweep(&self, law: Law) -> Result<Vec<Arc<Summary>>> {
        let cases: Result<Vec<Case>> =
            levels().into_iter().map(|peak| self.struck(law, peak)).collect();
        self.summaries(&cases?)
    }

    fn each<T: Send>(
        &self,
        cases: &[Case],
        of: impl Fn(&Case) -> Result<T> + Sync,
    ) -> Result<Vec<T>> {
        let done = AtomicUsize::new(0);
        let results = cases
            .par_iter()
            .map(|case| {
                let result = of(case);
                let number = done.fetch_add(1, Ordering::Relaxed) + 1;
                self.bar.set_message(format!("run {number} of {}", cases.len()));
                result
            })
            .collect();
        self.bar.set_message("");
        results
    }
}

fn locked<T>(shared: &Mutex<T>) -> Result<std::sync::MutexGuard<'_, T>> {
    shared.lock().map_err(|_| anyhow!("a run panicked"))
}
