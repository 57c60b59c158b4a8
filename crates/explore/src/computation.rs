//! Results of a part for a state, and their figures.

use asperity_figure::Figure;
use asperity_plot::{self as plot, VisitedRange, steady_words};
use asperity_scenario::{AnyScenario, Document, LawRef, Scenario};
use asperity_simulation::assemble::Assembly;
use asperity_simulation::error::SimulationError;
use asperity_simulation::laws::tabulate;
use asperity_simulation::patches::{assemble_patches, simulate_patches};
use asperity_simulation::provenance::Provenance;
use asperity_simulation::run::{Run, receptance, simulate_with_progress};
use asperity_simulation::static_state::StaticSummary;
use asperity_simulation::steady::{
    BodyModel, Shaken, Steady, SteadyRequest, SteadySummary, steady_with_progress,
};
use asperity_simulation::summary::InterfaceSummary;
use asperity_simulation::sweep::{SweepError, Variation, sweep_with_progress};
use thiserror::Error;

use crate::message::{Part, View};
use crate::settings::{Settings, amplitude_pointer};
use crate::state::State;

/// Figures and words of a part.
#[derive(Debug, Default)]
pub(crate) struct Results {
    /// A figure, or the reason why there is none.
    pub(crate) figures: Vec<(View, Result<Figure, String>)>,
    /// The numbers, as the command prints them.
    pub(crate) words: String,
    /// Error that left a part of the figures out.
    pub(crate) error: Option<String>,
}

/// A part that cannot be computed.
#[derive(Debug, Error)]
pub(crate) enum ComputationError {
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    #[error(transparent)]
    Sweep(#[from] SweepError),
    #[error("{0}")]
    Settings(String),
}

/// Receives the share that is done.
pub(crate) type Progress<'a> = &'a (dyn Fn(f64) + Sync);

/// Computes a part.
pub(crate) fn compute(
    part: Part,
    state: &State,
    settings: &Settings,
    progress: Progress<'_>,
) -> Result<Results, ComputationError> {
    if let Some(fault) = settings.fault() {
        return Err(ComputationError::Settings(fault));
    }
    match part {
        Part::Hit => Ok(hit(state, settings, progress)),
        Part::Levels => levels(&state.document, &settings.filled(state)?, progress),
        Part::Steady => steady(state, &settings.filled(state)?, progress),
    }
}

/// One hit. Laws are drawn also where the hit fails.
fn hit(state: &State, settings: &Settings, progress: Progress<'_>) -> Results {
    let document = &state.document;
    match &state.scenario {
        AnyScenario::Bars(scenario) => {
            let run = simulate_with_progress(document, scenario, progress);
            let interfaces = run.as_ref().map_or(&[][..], |run| &run.summary.interfaces);
            let laws = laws(scenario, interfaces).map_err(|error| error.to_string());
            let mut results = Results { figures: vec![(View::Law, laws)], ..Results::default() };
            results.add(run.as_ref(), settings);
            results
        }
        AnyScenario::Structure(scenario) => {
            let found = simulate_patches(document, scenario, progress);
            let reason =
                "laws of structures of matrices are not drawn here; `asperity law` takes bars";
            let laws = Err(reason.to_owned());
            let mut results = Results { figures: vec![(View::Law, laws)], ..Results::default() };
            results.add(found.as_ref().map(|found| &found.run), settings);
            results
        }
    }
}

impl Results {
    /// Adds the figures and words of a run, or its error.
    fn add<S>(&mut self, run: Result<&Run<S>, &SimulationError>, settings: &Settings) {
        let run = match run {
            Ok(run) => run,
            Err(error) => {
                self.error = Some(error.to_string());
                return;
            }
        };
        let notes = run.summary.warnings.iter().map(|warning| format!("note: {warning}"));
        let words: Vec<String> = [plot::run_words(&run.summary)].into_iter().chain(notes).collect();
        self.words = words.join("\n");
        let frf = match receptance(run, 0) {
            Ok(Some(frf)) => Ok(plot::frf(&frf, &run.summary, settings.magnitude.into())),
            Ok(None) => Err("there is no load".to_owned()),
            Err(error) => Err(error.to_string()),
        };
        self.figures.push((View::Frf, frf));
        self.figures.push((View::History, Ok(plot::history(run))));
    }
}

/// The laws, with the pressures visited by a run.
fn laws(scenario: &Scenario, visited: &[InterfaceSummary]) -> Result<Figure, SimulationError> {
    // Laws that are written in place are drawn under the names of their interfaces.
    let mut named = scenario.clone();
    for interface in &mut named.interfaces {
        if let LawRef::InPlace(law) = &interface.law {
            named.laws.insert(interface.name.clone(), (**law).clone());
            interface.law = LawRef::Named(interface.name.clone());
        }
    }
    let mut ranges: Vec<VisitedRange> = Vec::new();
    for (interface, found) in named.interfaces.iter().zip(visited) {
        let (low, high) = (found.pressure_min_pa, found.pressure_max_pa);
        let law = interface.law.name();
        match ranges.iter_mut().find(|range| range.law == law) {
            Some(range) => (range.low, range.high) = (range.low.min(low), range.high.max(high)),
            None => ranges.push(VisitedRange { law: law.to_owned(), low, high }),
        }
    }
    Ok(plot::laws_visited(&tabulate(&named)?, &ranges))
}

/// Hits of several forces.
fn levels(
    document: &Document,
    settings: &Settings,
    progress: Progress<'_>,
) -> Result<Results, ComputationError> {
    let variation = match level_variation(document, settings) {
        Ok(variation) => Variation::parse(&variation).map_err(SweepError::from)?,
        Err(reason) => {
            let figures = vec![(View::Levels, Err(reason))];
            return Ok(Results { figures, ..Results::default() });
        }
    };
    let done = |done: usize, of: usize| progress(done as f64 / of as f64);
    let sweep = sweep_with_progress(document, &[variation], &done)?;
    let failed = sweep.failed().map(|(run, error)| format!("run {}: {error}", run + 1)).next();
    let figure = plot::sweep(&sweep);
    let figure = figure.ok_or_else(|| failed.clone().unwrap_or_else(|| "nothing to draw".into()));
    let words = format!("{} runs\n", sweep.runs.len());
    Ok(Results { figures: vec![(View::Levels, figure)], words, error: failed })
}

/// The variation of the levels, as `--vary` takes it.
pub(crate) fn level_variation(document: &Document, settings: &Settings) -> Result<String, String> {
    let pointer = amplitude_pointer(document.value())
        .ok_or("the excitation has no amplitude; choose a kind of force")?;
    let (Some(from), Some(to), Some(count)) =
        (settings.level_from, settings.level_to, settings.levels)
    else {
        return Err("the levels are not known".to_owned());
    };
    Ok(format!("{pointer}={from}:{to}:{count}"))
}

/// Steady responses.
fn steady(
    state: &State,
    settings: &Settings,
    progress: Progress<'_>,
) -> Result<Results, ComputationError> {
    let document = &state.document;
    let (Some(amplitudes), Some(from_hz), Some(to_hz)) =
        (settings.amplitudes.clone(), settings.from_hz, settings.to_hz)
    else {
        return Err(ComputationError::Settings("the range is not known".to_owned()));
    };
    let request = SteadyRequest {
        amplitudes,
        from_hz,
        to_hz,
        harmonics: None,
        backbone: settings.backbone,
        verify: false,
        bodies: BodyModel::Auto,
        time_sweep: None,
    };
    let (found, at_rest, title, provenance) = match &state.scenario {
        AnyScenario::Bars(scenario) => {
            let assembly = Assembly::new(scenario, document.folder())?;
            let found = branches(&assembly, &request, progress)?;
            let provenance = Provenance::of_scenario(document, scenario)?;
            (found, StaticSummary::of(&assembly), scenario.title.clone(), provenance)
        }
        AnyScenario::Structure(scenario) => {
            let assembly = assemble_patches(scenario, document.folder())?;
            let found = branches(&assembly, &request, progress)?;
            let provenance = Provenance::of_structure(document, scenario)?;
            (found, assembly.structure.at_rest(), scenario.title.clone(), provenance)
        }
    };
    let failed = found.levels.iter().find_map(|level| {
        let error = level.outcome.as_ref().err()?;
        Some(format!("{} {}: {error}", level.force_n, found.unit()))
    });
    let figure = plot::steady(&found);
    let figure = figure.ok_or_else(|| failed.clone().unwrap_or_else(|| "nothing to draw".into()));
    let summary = SteadySummary::new(title, at_rest, &found, provenance);
    let words = steady_words::branches(&summary);
    Ok(Results { figures: vec![(View::Steady, figure)], words, error: failed })
}

fn branches<S: Shaken>(
    assembly: &Assembly<S>,
    request: &SteadyRequest,
    progress: Progress<'_>,
) -> Result<Steady, SimulationError> {
    let done = std::sync::atomic::AtomicUsize::new(0);
    let of = request.amplitudes.len() as f64;
    steady_with_progress(assembly, request, &|| {
        let done = done.fetch_add(1, std::sync::atomic::Ordering::Relaxed) + 1;
        progress(done as f64 / of);
    })
}
