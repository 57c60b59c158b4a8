//! The paper's rig from the fixtures, and its runs, each computed once.

use std::collections::HashMap;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard};

use anyhow::{Context, Result, anyhow, bail, ensure};
use asperity_dynamics::Integrator;
use asperity_identify::{Identification, IdentificationProblem, identify};
use asperity_law::ContactLaw;
use asperity_mesh::Grid;
use asperity_scenario::{Document, LawRef, LawSpec, Scenario};
use asperity_signal::FrequencyResponse;
use asperity_simulation::assemble::Assembly;
use asperity_simulation::run::{Run, simulate};
use asperity_simulation::summary::Summary;
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
    /// The scenario of `document`, if it is valid.
    pub(crate) fn new(document: Document) -> Result<Self> {
        let scenario = document.scenario()?;
        Ok(Self { document, scenario })
    }

    /// The objects that compute.
    pub(crate) fn assembly(&self) -> Result<Assembly> {
        Ok(Assembly::new(&self.scenario, self.document.folder())?)
    }

    /// A law of the scenario at a contact under `pressure` in Pa.
    pub(crate) fn law(&self, law: Law, pressure: f64) -> Result<Arc<dyn ContactLaw>> {
        Ok(self.scenario.laws.build(&LawRef::Named(law.key().to_owned()), pressure)?)
    }

    /// Pressures and stiffnesses of Table 3.
    pub(crate) fn table_3(&self) -> Result<Vec<(f64, f64)>> {
        let Some(LawSpec::Table(table)) = self.scenario.laws.get("measured") else {
            bail!("the scenario has no table of measurements named \"measured\"");
        };
        Ok(table.points.iter().map(|&[p, k]| (p, k)).collect())
    }

    /// The finite-difference grid.
    pub(crate) fn grid(&self) -> Result<Grid> {
        let assembly = self.assembly()?;
        let Integrator::FiniteDifference(method) = assembly.method else {
            bail!("the figure shows the grid of finite differences");
        };
        Ok(Grid::new(assembly.structure.stack(), method.cell)?)
    }

    /// The two lowest natural frequencies at rest, in Hz.
    pub(crate) fn natural_frequencies(&self) -> Result<[f64; 2]> {
        let found = self.assembly()?.structure.modes(2)?;
        ensure!(found.len() == 2, "the rig has fewer than two modes");
        Ok([found[0].frequency_hz, found[1].frequency_hz])
    }
}

/// The response of a run at any frequency.
pub(crate) fn response(run: &Run) -> Result<FrequencyResponse> {
    let (history, rate) = (&run.transient.history, run.assembly.sampling.rate());
    Ok(FrequencyResponse::from_displacement(&history.load, &history.sensors[0].displacement, rate)?)
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
    summaries: Mutex<HashMap<String, Arc<Summary>>>,
    identified: Mutex<Option<Arc<Identification>>>,
    bar: ProgressBar,
}

impl Rig {
    /// Reads the rig from the scenarios' folder; `quick` coarsens its grid, and
    /// `bar` shows how many runs of a sweep are done.
    pub(crate) fn load(scenarios: &Path, quick: bool, bar: ProgressBar) -> Result<Self> {
        let path = scenarios.join("nouira2020-modified.json");
        let base = Document::read(&path).context("reading the paper's rig")?;
        let (summaries, identified) = (Mutex::default(), Mutex::default());
        Ok(Self { base, quick, summaries, identified, bar })
    }

    /// True for a first look, with a coarse grid and small designs.
    pub(crate) fn is_quick(&self) -> bool {
        self.quick
    }

    /// The law and the pulse identified from the numbers that the text states, found once.
    pub(crate) fn identified(&self) -> Result<Arc<Identification>> {
        let mut kept = self.identified.lock().map_err(|_| anyhow!("an identification panicked"))?;
        if let Some(known) = kept.as_ref() {
            return Ok(Arc::clone(known));
        }
        let fixtures = crate::workspace::workspace_root().join("fixtures");
        let problem = IdentificationProblem::read(fixtures.join("paper/identify.json"))?;
        let found = identify(&problem)?;
        ensure!(found.has_converged() && found.explains(), "{}", found.conclusions().join(" "));
        Ok(Arc::clone(kept.insert(Arc::new(found))))
    }

    /// The stored scenario of that law and pulse.
    pub(crate) fn identified_scenario() -> Result<Document> {
        let place = "fixtures/scenarios/nouira2020-identified.json";
        Ok(Document::read(crate::workspace::workspace_root().join(place))?)
    }

    /// SHA-256 of the rig's scenario.
    pub(crate) fn sha256(&self) -> String {
        self.base.sha256()
    }

    /// The rig with `law` at both contacts and `changes`, pairs of JSON pointer and value.
    pub(crate) fn with(&self, law: Law, changes: &[(&str, String)]) -> Result<Case> {
        let mut document = self.base.clone();
        if self.quick {
            document.set("/method/cell_m", "0.004")?;
        }
        let contacts = ["/interfaces/0/law", "/interfaces/1/law"];
        for (pointer, value) in
            contacts.map(|contact| (contact, law.key().to_owned())).iter().chain(changes)
        {
            document.set(pointer, value)?;
        }
        Case::new(document)
    }

    /// The rig with `law` at both contacts, struck with `peak` in N.
    pub(crate) fn struck(&self, law: Law, peak: f64) -> Result<Case> {
        self.with(law, &[("/excitation/peak_n", peak.to_string())])
    }

    /// The rig with `law` at both contacts, struck with each of `peaks` in N.
    pub(crate) fn struck_with(&self, law: Law, peaks: &[f64]) -> Result<Vec<Case>> {
        peaks.iter().map(|&peak| self.struck(law, peak)).collect()
    }

    /// The run of a case.
    pub(crate) fn run(&self, case: &Case) -> Result<Run> {
        let run = simulate(&case.document, &case.scenario)?;
        self.locked()?.insert(case.document.sha256(), Arc::new(run.summary.clone()));
        Ok(run)
    }

    /// The summaries of the cases, in their order, over all threads. The same
    /// case is run once, and of its history nothing is kept.
    pub(crate) fn summaries(&self, cases: &[Case]) -> Result<Vec<Arc<Summary>>> {
        self.each(cases, |case| {
            let key = case.document.sha256();
            if let Some(done) = self.locked()?.get(&key) {
                return Ok(Arc::clone(done));
            }
            Ok(Arc::new(self.run(case)?.summary))
        })
    }

    /// Results of `of` for the runs of the cases, in their order, over all threads. Each history is
    /// dropped as soon as `of` returns.
    pub(crate) fn observe<T: Send>(
        &self,
        cases: &[Case],
        of: impl Fn(&Case, &Run) -> Result<T> + Sync,
    ) -> Result<Vec<T>> {
        self.each(cases, |case| of(case, &self.run(case)?))
    }

    /// The summaries of `law` struck with each of [`levels`].
    pub(crate) fn sweep(&self, law: Law) -> Result<Vec<Arc<Summary>>> {
        self.summaries(&self.struck_with(law, &levels())?)
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

    fn locked(&self) -> Result<MutexGuard<'_, HashMap<String, Arc<Summary>>>> {
        self.summaries.lock().map_err(|_| anyhow!("a run panicked"))
    }
}
