//! Results of a part for a state, and their figures.

use std::sync::atomic::AtomicBool;

use asperity_figure::Figure;
use asperity_plot::{self as plot, VisitedRange, steady_words};
use asperity_scenario::{AnyScenario, Document, LawRef, MethodSpec};
use asperity_simulation::assemble::{Assembly, Interfaces};
use asperity_simulation::error::SimulationError;
use asperity_simulation::laws::ScenarioLaws;
use asperity_simulation::output::file_name::distinct_file_names;
use asperity_simulation::patches::{assemble_patches, simulate_patches_unless};
use asperity_simulation::provenance::Provenance;
use asperity_simulation::record::{frf_columns, frf_csv, history_csv, law_csv};
use asperity_simulation::run::{Run, receptance, simulate_unless};
use asperity_simulation::static_state::StaticSummary;
use asperity_simulation::steady::{
    BodyModel, Shaken, Steady, SteadyProgress, SteadyRequest, SteadySummary, backbone_table,
    steady_table, steady_with_progress,
};
use asperity_simulation::summary::InterfaceSummary;
use asperity_simulation::sweep::{Sweep, SweepError, Variation, draft_sweep, sweep_unless};
use thiserror::Error;

use crate::measured::Measured;
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
    /// Names and texts of the tables, where they were asked for.
    pub(crate) tables: Vec<(String, String)>,
}

/// Additions to the computed figures.
#[derive(Clone, Copy)]
pub(crate) struct Beside<'a> {
    /// Measured hits, drawn with the computed ones.
    pub(crate) measured: Option<&'a Measured>,
    /// Views that are shown: the figures of a hit for others are not computed.
    pub(crate) views: &'a [View],
    /// True to have the tables.
    pub(crate) tables: bool,
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
    #[error("stopped")]
    Stopped,
}

/// Receives the share that is done.
pub(crate) type Progress<'a> = &'a (dyn Fn(f64) + Sync);

/// The page that waits for a part.
#[derive(Clone, Copy)]
pub(crate) struct Waiting<'a> {
    pub(crate) progress: Progress<'a>,
    /// Set once the part is not wanted any more.
    pub(crate) stop: &'a AtomicBool,
    /// Receives figures of a lower accuracy, before those of a slow part; none to have no such figures.
    pub(crate) draft: Option<&'a (dyn Fn(&Results) + Sync)>,
}

/// Computes a part.
pub(crate) fn compute(
    part: Part,
    state: &State,
    settings: &Settings,
    beside: Beside<'_>,
    waiting: Waiting<'_>,
) -> Result<Results, ComputationError> {
    if let Some(fault) = settings.fault() {
        return Err(ComputationError::Settings(fault));
    }
    match part {
        Part::Hit => hit(state, settings, beside, waiting),
        Part::Levels => levels(state, settings, beside, waiting),
        Part::Steady => steady(state, settings, beside, waiting.progress),
    }
}

/// One hit. Laws are drawn also where the hit fails.
fn hit(
    state: &State,
    settings: &Settings,
    beside: Beside<'_>,
    waiting: Waiting<'_>,
) -> Result<Results, ComputationError> {
    let document = &state.document;
    let mut results = Results::default();
    match &state.scenario {
        AnyScenario::Bars(scenario) => {
            let run = simulate_unless(document, scenario, waiting.stop, waiting.progress);
            let visited = run.as_ref().map_or(&[][..], |run| &run.summary.interfaces);
            results.add_laws(ScenarioLaws::of_bars(scenario)?, visited, beside)?;
            results.add(run.as_ref(), settings, beside)?;
        }
        AnyScenario::Structure(scenario) => {
            let found = simulate_patches_unless(document, scenario, waiting.stop, waiting.progress);
            let run = found.map(|found| found.run);
            if let Ok(run) = &run {
                let summary = &run.summary;
                let laws = ScenarioLaws::of_structure(scenario, &summary.at_rest);
                results.add_laws(laws, &summary.interfaces, beside)?;
            }
            results.add(run.as_ref(), settings, beside)?;
        }
    }
    Ok(results)
}

impl Results {
    /// Adds the laws, with the pressures visited by a run.
    fn add_laws(
        &mut self,
        laws: ScenarioLaws,
        visited: &[InterfaceSummary],
        beside: Beside<'_>,
    ) -> Result<(), SimulationError> {
        if beside.tables {
            let tables = laws.tables()?;
            let names = distinct_file_names(tables.iter().map(|law| law.name.as_str()));
            let named = names.iter().zip(&tables);
            let named = named.map(|(name, law)| (format!("law-{name}.csv"), law_csv(law)));
            self.tables.extend(named);
        }
        if beside.views.contains(&View::Law) {
            let figure = laws_visited(laws, visited).map_err(|error| error.to_string());
            self.figures.push((View::Law, figure));
        }
        Ok(())
    }

    /// Adds the figures and words of a run, or its error.
    fn add<S: Interfaces>(
        &mut self,
        run: Result<&Run<S>, &SimulationError>,
        settings: &Settings,
        beside: Beside<'_>,
    ) -> Result<(), SimulationError> {
        let run = match run {
            Ok(run) => run,
            Err(error) => {
                self.error = Some(error.to_string());
                return Ok(());
            }
        };
        let notes = run.summary.warnings.iter().map(|warning| format!("note: {warning}"));
        let words: Vec<String> = [plot::run_words(&run.summary)].into_iter().chain(notes).collect();
        self.words = words.join("\n");
        for &view in beside.views {
            let (figure, reason) = match view {
                View::Frf => (response(run, settings, beside)?, "there is no load"),
                View::History => (Some(plot::history(run)), "there is no motion"),
                View::PressureClosure => (plot::pressure_closure(run), "there is no contact"),
                View::Law | View::Levels | View::Steady => continue,
            };
            self.figures.push((view, figure.ok_or_else(|| reason.to_owned())));
        }
        if beside.tables {
            self.tables.push(("history.csv".to_owned(), history_csv(run)));
            let columns = frf_columns(run)?.map(|columns| frf_csv(&columns));
            self.tables.extend(columns.map(|text| ("frf.csv".to_owned(), text)));
        }
        Ok(())
    }
}

/// The receptance of a run, beside the measured one; none without a load.
fn response<S: Interfaces>(
    run: &Run<S>,
    settings: &Settings,
    beside: Beside<'_>,
) -> Result<Option<Figure>, SimulationError> {
    let axis = settings.magnitude.into();
    let drawn = receptance(run, 0)?.map(|frf| {
        let highest = frf.frequency_hz.last().copied().unwrap_or_default();
        let figure = plot::frf(&frf, &run.summary, axis);
        match beside.measured.and_then(|measured| measured.frf(highest, axis)) {
            Some(measured) => figure.with(&measured),
            None => figure,
        }
    });
    Ok(drawn)
}

/// The laws, with the pressures visited by a run.
fn laws_visited(
    mut named: ScenarioLaws,
    visited: &[InterfaceSummary],
) -> Result<Figure, SimulationError> {
    // Laws that are written in place are drawn under the names of their interfaces.
    for contact in &mut named.contacts {
        if let LawRef::InPlace(law) = &contact.law {
            named.laws.insert(contact.interface.clone(), (**law).clone());
            contact.law = LawRef::Named(contact.interface.clone());
        }
    }
    let mut ranges: Vec<VisitedRange> = Vec::new();
    for (contact, found) in named.contacts.iter().zip(visited) {
        let (low, high) = (found.pressure_min_pa, found.pressure_max_pa);
        let law = contact.law.name();
        match ranges.iter_mut().find(|range| range.law == law) {
            Some(range) => (range.low, range.high) = (range.low.min(low), range.high.max(high)),
            None => ranges.push(VisitedRange { law: law.to_owned(), low, high }),
        }
    }
    Ok(plot::laws_visited(&named.tables()?, &ranges))
}

/// Hits of several forces, first as a draft.
fn levels(
    state: &State,
    settings: &Settings,
    beside: Beside<'_>,
    waiting: Waiting<'_>,
) -> Result<Results, ComputationError> {
    let document = &state.document;
    let variation = match level_variation(document, settings) {
        Ok(variation) => Variation::parse(&variation).map_err(SweepError::from)?,
        Err(reason) => {
            let figures = vec![(View::Levels, Err(reason))];
            return Ok(Results { figures, ..Results::default() });
        }
    };
    let pointer = variation.pointer.clone();
    let run = |document: &Document, variation: Variation| {
        let done = |done: usize, of: usize| (waiting.progress)(done as f64 / of as f64);
        sweep_unless(document, &[variation], waiting.stop, &done)?.ok_or(ComputationError::Stopped)
    };
    let measured = beside.measured;
    let drawn = |sweep: &Sweep| {
        let failed = sweep.failed().map(|(run, error)| format!("run {}: {error}", run + 1)).next();
        let figure = plot::sweep(sweep);
        let figure =
            figure.ok_or_else(|| failed.clone().unwrap_or_else(|| "nothing to draw".into()));
        let figure = figure.map(|figure| match measured {
            Some(measured) => figure.with(&measured.levels(&pointer)),
            None => figure,
        });
        (figure, failed)
    };
    if let Some(send) = waiting.draft.filter(|_| is_drafted(state)) {
        let variations = std::slice::from_ref(&variation);
        let sweep = draft_sweep(document, variations, waiting.stop)?;
        let (figure, failed) = drawn(&sweep.ok_or(ComputationError::Stopped)?);
        let words =
            "a draft, without estimated errors; the runs of the command follow\n".to_owned();
        let figures = vec![(View::Levels, figure)];
        send(&Results { figures, words, error: failed, tables: Vec::new() });
    }
    let sweep = run(document, variation)?;
    let (mut figure, failed) = drawn(&sweep);
    let mut words = format!("{} runs\n", sweep.runs.len());
    if let Some(measured) = measured {
        let runs = measured.runs(document, Some(&pointer));
        let of = |some: &Option<(Document, Variation)>| {
            some.clone().map(|(document, variation)| run(&document, variation)).transpose()
        };
        let (own, scaled) = (of(&runs.measured)?, of(&runs.scaled)?);
        let computed = runs.computed(own, scaled);
        figure = figure.map(|figure| figure.with(&measured.computed_levels(&pointer, &computed)));
        words.push_str(&measured.words(&computed));
    }
    let table = beside.tables.then(|| ("levels.csv".to_owned(), sweep.csv()));
    let tables = table.into_iter().collect();
    Ok(Results { figures: vec![(View::Levels, figure)], words, error: failed, tables })
}

/// True if a draft saves time: the errors of modal responses take most of it.
fn is_drafted(state: &State) -> bool {
    let AnyScenario::Bars(scenario) = &state.scenario else { return false };
    matches!(scenario.method, MethodSpec::Modal(_))
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
    beside: Beside<'_>,
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
    let (found, at_rest, names, title, provenance) = match &state.scenario {
        AnyScenario::Bars(scenario) => {
            let assembly = Assembly::new(scenario, document.folder())?;
            let found = branches(&assembly, &request, progress)?;
            let provenance = Provenance::of_scenario(document, scenario)?;
            let at_rest = StaticSummary::of(&assembly);
            (found, at_rest, names(&assembly.structure), scenario.title.clone(), provenance)
        }
        AnyScenario::Structure(scenario) => {
            let assembly = assemble_patches(scenario, document.folder())?;
            let found = branches(&assembly, &request, progress)?;
            let provenance = Provenance::of_structure(document, scenario)?;
            let at_rest = assembly.structure.at_rest();
            (found, at_rest, names(&assembly.structure), scenario.title.clone(), provenance)
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
    let mut tables = Vec::new();
    if beside.tables {
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        tables.push(("steady.csv".to_owned(), steady_table(&found, &names).to_csv()));
        let backbones = found.backbones.as_ref();
        let table = backbones.map(|one| backbone_table(one, found.is_base_motion).to_csv());
        tables.extend(table.map(|text| ("backbone.csv".to_owned(), text)));
    }
    Ok(Results { figures: vec![(View::Steady, figure)], words, error: failed, tables })
}

/// Names of the interfaces.
fn names(structure: &impl Interfaces) -> Vec<String> {
    structure.interfaces().iter().map(|contact| contact.name().to_owned()).collect()
}

fn branches<S: Shaken>(
    assembly: &Assembly<S>,
    request: &SteadyRequest,
    progress: Progress<'_>,
) -> Result<Steady, SimulationError> {
    let done = std::sync::atomic::AtomicUsize::new(0);
    let of = request.amplitudes.len() as f64;
    steady_with_progress(assembly, request, &|ended| {
        let ended = usize::from(ended == SteadyProgress::Level);
        let done = done.fetch_add(ended, std::sync::atomic::Ordering::Relaxed) + ended;
        progress(done as f64 / of);
    })
}
