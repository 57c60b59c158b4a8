//! One transient run.

use asperity_figure::Figure;
use asperity_plot::MagnitudeAxis;
use asperity_scenario::AnyScenario;
use asperity_simulation::assemble::Interfaces;
use asperity_simulation::error::SimulationError;
use asperity_simulation::patches::{MeshMotion, simulate_patches};
use asperity_simulation::record::{frf_columns, history_columns};
use asperity_simulation::run::{Run, receptance, simulate_with_progress};
use asperity_simulation::warning::Warning;
use asperity_table::DataTable;
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde_json::{Value, json};

use crate::figure::PyFigure;
use crate::scenario::PyScenario;
use crate::{background, columns, exception, json};

/// Columns by their names, and the figure that the command draws of them.
type Drawn = (Vec<(String, Vec<f64>)>, Figure);

/// History, paths of the contacts, FRF of a run with force, summary, and cells and meshes of a structure with patches.
struct Found {
    summary: Value,
    warnings: Vec<(&'static str, String)>,
    history: Drawn,
    paths: Option<Figure>,
    frf: Option<Drawn>,
    cells: Option<DataTable>,
    cells_history: Option<Drawn>,
    motions: Vec<Moved>,
}

/// A mesh at instants of a run.
struct Moved {
    body: String,
    figure: Option<Figure>,
    /// Times \[s\].
    time: Vec<f64>,
    nodes: Vec<i64>,
    /// Places of the nodes \[m\], and their displacements by instants \[m\], three numbers each.
    places: Vec<f64>,
    displacements: Vec<f64>,
}

impl From<MeshMotion> for Moved {
    fn from(motion: MeshMotion) -> Self {
        let moved = |(_, displacements): (f64, &[[f64; 3]])| displacements.to_vec();
        Self {
            body: motion.body().to_owned(),
            figure: asperity_plot::mesh_motion(&motion),
            time: motion.instants().map(|(time, _)| time).collect(),
            nodes: motion.nodes().collect(),
            places: motion.places().into_flattened(),
            displacements: motion.instants().flat_map(moved).collect::<Vec<_>>().into_flattened(),
        }
    }
}

impl Found {
    fn new<S: Interfaces>(run: &Run<S>, summary: Value) -> Result<Self, SimulationError> {
        let columns = history_columns(run).into_iter();
        let columns = columns.map(|(name, values)| (name, values.into_owned())).collect();
        let frf = receptance(run, 0)?.zip(frf_columns(run)?).map(|(frf, columns)| {
            (columns, asperity_plot::frf(&frf, &run.summary, MagnitudeAxis::default()))
        });
        let warnings = in_words(&run.summary.warnings);
        Ok(Self {
            summary,
            warnings,
            history: (columns, asperity_plot::history(run)),
            paths: asperity_plot::pressure_closure(run),
            frf,
            cells: None,
            cells_history: None,
            motions: Vec::new(),
        })
    }
}

fn computed(
    scenario: &PyScenario,
    progress: &background::Progress,
) -> Result<Found, SimulationError> {
    let document = &scenario.document;
    let report = |fraction: f64| progress.report(fraction);
    match &scenario.scenario {
        AnyScenario::Bars(bars) => {
            let run = simulate_with_progress(document, bars, &report)?;
            Found::new(&run, json!(run.summary))
        }
        AnyScenario::Structure(structure) => {
            let run = simulate_patches(document, structure, &report)?;
            let found = Found::new(&run.run, json!(run.summary()))?;
            let motions = run.mesh_motions(structure, document.folder())?;
            let columns = run.cell_history_columns().into_iter();
            let columns = columns.map(|(name, values)| (name, values.to_vec())).collect();
            Ok(Found {
                cells: Some(run.cells_table()),
                cells_history: asperity_plot::cell_histories(&run).map(|figure| (columns, figure)),
                motions: motions.into_iter().map(Moved::from).collect(),
                ..found
            })
        }
    }
}

/// Dict of arrays, and figure.
type Shown<'py> = (Bound<'py, PyDict>, PyFigure);

/// Kinds of warnings and their texts.
pub(crate) fn in_words<'a>(
    warnings: impl IntoIterator<Item = &'a Warning>,
) -> Vec<(&'static str, String)> {
    warnings.into_iter().map(|warning| (warning.kind(), warning.to_string())).collect()
}

/// Name of a body, its mesh at instants as a dict of arrays, and the figure.
type ShownMesh<'py> = (String, Bound<'py, PyDict>, Option<PyFigure>);

/// Results of one run for Python: summary, history, FRF, cells, cells over time, meshes, paths of the contacts, and
/// warnings.
type Simulated<'py> = (
    Bound<'py, PyAny>,
    Shown<'py>,
    Option<Shown<'py>>,
    Option<Bound<'py, PyDict>>,
    Option<Shown<'py>>,
    Vec<ShownMesh<'py>>,
    Option<PyFigure>,
    Vec<(&'static str, String)>,
);

/// Summary as a dict, history and FRF as dicts of arrays with their figures, cells of a structure of matrices
/// as a dict of arrays, those over time with their figure, its meshes at instants, the figure of the paths of the contacts,
/// and the warnings.
#[pyfunction]
#[pyo3(signature = (scenario, progress))]
pub(crate) fn simulate<'py>(
    py: Python<'py>,
    scenario: &Bound<'py, PyAny>,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<Simulated<'py>> {
    let scenario = PyScenario::of(scenario, None)?;
    let outcome = background::run(py, progress, move |progress| computed(&scenario, progress))?;
    let Found { summary, warnings, history, paths, frf, cells, cells_history, motions } =
        outcome.map_err(|error| exception::of_study(py, &error))?;
    let shown = |(columns, figure): Drawn| -> PyResult<Shown<'py>> {
        Ok((columns::to_dict(py, columns)?, PyFigure::from(figure)))
    };
    let frf = frf.map(shown).transpose()?;
    let cells = cells.map(|table| columns::of_table(py, table)).transpose()?;
    let mesh = |moved: Moved| -> PyResult<ShownMesh<'py>> {
        let arrays = PyDict::new(py);
        let (instants, nodes) = (moved.time.len(), moved.nodes.len());
        arrays.set_item("time_s", PyArray1::from_vec(py, moved.time))?;
        arrays.set_item("node", PyArray1::from_vec(py, moved.nodes))?;
        let places = PyArray1::from_vec(py, moved.places);
        arrays.set_item("place_m", places.reshape([nodes, 3])?)?;
        let displacements = PyArray1::from_vec(py, moved.displacements);
        arrays.set_item("displacement_m", displacements.reshape([instants, nodes, 3])?)?;
        Ok((moved.body, arrays, moved.figure.map(PyFigure::from)))
    };
    let meshes = motions.into_iter().map(mesh).collect::<PyResult<_>>()?;
    Ok((
        json::to_python(py, &summary)?,
        shown(history)?,
        frf,
        cells,
        cells_history.map(shown).transpose()?,
        meshes,
        paths.map(PyFigure::from),
        warnings,
    ))
}
