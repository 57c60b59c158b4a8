//! Steady responses and linearised modes.

use asperity_scenario::AnyScenario;
use asperity_simulation::assemble::Assembly;
use asperity_simulation::error::SimulationError;
use asperity_simulation::modes::{ModesSummary, linearised_modes};
use asperity_simulation::patches::{assemble_patches, patch_modes, steady_cells};
use asperity_simulation::provenance::Provenance;
use asperity_simulation::record::modes_columns;
use asperity_simulation::static_state::StaticSummary;
use asperity_simulation::steady::{
    BodyModel, Shaken, Steady, SteadyProgress, SteadyRequest, SteadySummary, SweepDirection,
    TimeSweepRequest, backbone_table, steady_table, steady_time_table, steady_with_progress,
};
use asperity_simulation::sweep::on_threads;
use asperity_structure::PreloadedContact;
use asperity_table::DataTable;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use std::sync::atomic::{AtomicUsize, Ordering};

use crate::figure::PyFigure;
use crate::scenario::PyScenario;
use crate::simulate::in_words;
use crate::{background, columns, exception, json};

/// Results of steady responses: summary, points, backbones, stepped sines, cells of a structure of matrices, figure.
struct Found {
    summary: SteadySummary,
    points: DataTable,
    backbones: Option<DataTable>,
    time_sweeps: Option<DataTable>,
    cells: Option<DataTable>,
    figure: Option<asperity_figure::Figure>,
    warnings: Vec<(&'static str, String)>,
}

/// Parameters of a request, as Python gives them.
#[derive(Debug, FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Asked {
    amplitudes_n: Vec<f64>,
    from_hz: f64,
    to_hz: f64,
    harmonics: Option<usize>,
    backbone: bool,
    verify: bool,
    bodies: String,
    time_sweep: Option<String>,
    time_sweep_points: usize,
}

impl Asked {
    fn request(self) -> PyResult<SteadyRequest> {
        let unknown = |name: &str, found: &str, accepted: &str| {
            PyValueError::new_err(format!("{name} is {found:?}; accepted: {accepted}"))
        };
        let bodies = match self.bodies.as_str() {
            "auto" => BodyModel::Auto,
            "elastic" => BodyModel::Elastic,
            "condensed" => BodyModel::Condensed,
            other => return Err(unknown("bodies", other, "auto, elastic, condensed")),
        };
        let direction = match self.time_sweep.as_deref() {
            None => None,
            Some("up") => Some(SweepDirection::Up),
            Some("down") => Some(SweepDirection::Down),
            Some("both") => Some(SweepDirection::Both),
            Some(other) => return Err(unknown("time_sweep", other, "up, down, both")),
        };
        Ok(SteadyRequest {
            amplitudes: self.amplitudes_n,
            from_hz: self.from_hz,
            to_hz: self.to_hz,
            harmonics: self.harmonics,
            backbone: self.backbone,
            verify: self.verify,
            bodies,
            time_sweep: direction.map(|direction| TimeSweepRequest {
                direction,
                frequencies: self.time_sweep_points,
            }),
        })
    }
}

fn computed(
    scenario: &PyScenario,
    request: &SteadyRequest,
    progress: &background::Progress,
) -> Result<Found, SimulationError> {
    let document = &scenario.document;
    match &scenario.scenario {
        AnyScenario::Bars(bars) => {
            let assembly = Assembly::new(bars, document.folder())?;
            let provenance = Provenance::of_scenario(document, bars)?;
            let own = (bars.title.clone(), StaticSummary::of(&assembly), provenance);
            Ok(followed(&assembly, request, own, progress)?.0)
        }
        AnyScenario::Structure(structure) => {
            let assembly = assemble_patches(structure, document.folder())?;
            let provenance = Provenance::of_structure(document, structure)?;
            let own = (structure.title.clone(), assembly.structure.at_rest(), provenance);
            let (found, steady) = followed(&assembly, request, own, progress)?;
            let cells = Some(steady_cells(&assembly.structure, &steady));
            Ok(Found { cells, ..found })
        }
    }
}

/// The branches of an assembled scenario with this title, rest and provenance.
fn followed<S: Shaken>(
    assembly: &Assembly<S>,
    request: &SteadyRequest,
    (title, at_rest, provenance): (Option<String>, StaticSummary, Provenance),
    progress: &background::Progress,
) -> Result<(Found, Steady), SimulationError> {
    let (finished, levels) = (AtomicUsize::new(0), request.amplitudes.len());
    let found = steady_with_progress(assembly, request, &|ended| {
        let ended = usize::from(ended == SteadyProgress::Level);
        let done = finished.fetch_add(ended, Ordering::Relaxed) + ended;
        progress.report(done as f64 / levels as f64);
    })?;
    let names: Vec<&str> =
        assembly.structure.interfaces().iter().map(PreloadedContact::name).collect();
    let results = Found {
        points: steady_table(&found, &names),
        backbones: found
            .backbones
            .as_ref()
            .map(|backbones| backbone_table(backbones, found.is_base_motion)),
        time_sweeps: request.time_sweep.map(|_| steady_time_table(&found)),
        cells: None,
        figure: asperity_plot::steady(&found),
        warnings: in_words(found.parts().flat_map(|level| &level.warnings)),
        summary: SteadySummary::new(title, at_rest, &found, provenance),
    };
    Ok((results, found))
}

/// Summary, columns of the branches, of the backbones, of the stepped sines and of the cells, figure, and warnings.
#[pyfunction]
#[pyo3(signature = (scenario, asked, threads, progress))]
#[expect(clippy::type_complexity, reason = "a tuple of dicts")]
pub(crate) fn steady<'py>(
    py: Python<'py>,
    scenario: &Bound<'py, PyAny>,
    asked: Asked,
    threads: Option<usize>,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<(
    Bound<'py, PyAny>,
    Bound<'py, PyDict>,
    Option<Bound<'py, PyDict>>,
    Option<Bound<'py, PyDict>>,
    Option<Bound<'py, PyDict>>,
    Option<PyFigure>,
    Vec<(&'static str, String)>,
)> {
    let scenario = PyScenario::of(scenario, None)?;
    let request = asked.request()?;
    let work = move |progress: &background::Progress| {
        on_threads(threads, || computed(&scenario, &request, progress))
    };
    let found = background::run(py, progress, work)?
        .ok_or_else(|| exception::no_threads(threads))?
        .map_err(|error| exception::of_study(py, &error))?;
    let table = |table: Option<DataTable>| table.map(|one| columns::of_table(py, one)).transpose();
    Ok((
        json::to_python(py, &found.summary)?,
        columns::of_table(py, found.points)?,
        table(found.backbones)?,
        table(found.time_sweeps)?,
        table(found.cells)?,
        found.figure.map(PyFigure::from),
        found.warnings,
    ))
}

/// Summary and columns of the shapes of modes, and figure; without shapes of structures of matrices.
#[pyfunction]
#[pyo3(signature = (scenario, count))]
pub(crate) fn modes<'py>(
    py: Python<'py>,
    scenario: &Bound<'py, PyAny>,
    count: usize,
) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyDict>, Option<PyFigure>)> {
    let PyScenario { document, scenario } = PyScenario::of(scenario, None)?;
    let work = move |_: &background::Progress| match &scenario {
        AnyScenario::Bars(bars) => {
            let assembly = Assembly::new(bars, document.folder())?;
            let found = linearised_modes(&assembly, count)?;
            let provenance = Provenance::of_scenario(&document, bars)?;
            Ok((ModesSummary::new(bars, &assembly, &found, provenance), Some(found)))
        }
        AnyScenario::Structure(structure) => {
            let assembly = assemble_patches(structure, document.folder())?;
            let found = patch_modes(&assembly, count)?;
            let provenance = Provenance::of_structure(&document, structure)?;
            Ok((found.summary(structure.title.clone(), &assembly, provenance), None))
        }
    };
    let outcome: Result<_, SimulationError> = background::run(py, None, work)?;
    let (summary, found) = outcome.map_err(|error| exception::of_study(py, &error))?;
    let shapes = found.as_ref().map_or_else(Vec::new, modes_columns).into_iter();
    let shapes = shapes.map(|(name, values)| (name, values.to_vec()));
    let figure = found.as_ref().map(|found| PyFigure::from(asperity_plot::modes(found)));
    Ok((json::to_python(py, &summary)?, columns::to_dict(py, shapes)?, figure))
}
