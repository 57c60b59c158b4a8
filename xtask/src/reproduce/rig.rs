//! The paper's rig from the fixtures, and its runs, each computed once.

use std::collections::HashMap;
use std::path::Path;
use std::sync::{Arc, Mutex};

use anyhow::{Context, Result, anyhow};
use asperity_study::assemble::Assembly;
use asperity_study::document::Document;
use asperity_study::run::{Run, simulate};
use asperity_study::scenario::Scenario;

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
}

impl Rig {
    /// Reads the rig from the scenarios' folder; `quick` coarsens its grid.
    pub(crate) fn load(scenarios: &Path, quick: bool) -> Result<Self> {
        let path = scenarios.join("nouira2020-modified.json");
        let base = Document::read(&path).context("reading the paper's rig")?;
        Ok(Self { base, quick, runs: Mutex::default() })
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

    /// The run of a case; the same case is run once.
    pub(crate) fn run(&self, case: &Case) -> Result<Arc<Run>> {
        let key = case.document.sha256();
        let locked = || self.runs.lock().map_err(|_| anyhow!("a run panicked"));
        if let Some(done) = locked()?.get(&key) {
            return Ok(Arc::clone(done));
        }
        let run = Arc::new(simulate(&case.document, &case.scenario, &|_| ())?);
        locked()?.insert(key, Arc::clone(&run));
        Ok(run)
    }
}
