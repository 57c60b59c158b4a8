//! Analyses of measured hits and of free decays.

use std::path::PathBuf;
use std::sync::LazyLock;

use asperity_experiment::{
    Analysis, AnalysisError, AnalysisOptions, ChannelSensor, DecayOptions, FrequencyBand,
    RejectedHit, ResponseChoice, RigFile, RigSettings, analyse_decay_sources, analyse_sources,
    parse_frf_form,
};
use asperity_measure::{Abscissa, Record, Samples};
use asperity_plot::{MagnitudeAxis, decay_figures, figures};
use asperity_scenario::{Diagnostic, Document, Fault, schema_of};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use serde_json::Value;

use crate::measurement::{Sources, read_options};
use crate::{background, columns, exception, figure, json};

/// Settings of a rig, from a file or a dict, with changes.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Settings<'py> {
    /// Path or dict.
    rig: Option<Bound<'py, PyAny>>,
    /// Values by the keys of a rig's settings, which win over it.
    changes: Bound<'py, PyDict>,
    sample_rate_hz: Option<f64>,
    names: Vec<String>,
    units: Vec<String>,
    sample_axis: Option<String>,
    /// Sensors, such as `hammer=2.25mV/N`, which win over those of the rig.
    sensitivity: Vec<String>,
}

impl Settings<'_> {
    /// The options that the settings give.
    ///
    /// # Errors
    /// ScenarioError with all faults of the settings; OSError for a file that cannot be read.
    fn options(self, py: Python<'_>) -> PyResult<AnalysisOptions> {
        static SCHEMA: LazyLock<Value> = LazyLock::new(schema_of::<RigSettings>);
        let (document, file) = match &self.rig {
            None => (Document::parse(r#"{"schema": "asperity/rig/1"}"#, "settings"), None),
            Some(rig) if rig.is_instance_of::<PyDict>() => {
                (Document::parse(&json::text_of(rig)?, "rig"), None)
            }
            Some(rig) => {
                let path: PathBuf = rig.extract()?;
                (Document::read(&path), Some(path))
            }
        };
        let document = document.map_err(|error| exception::of_document(py, &error))?;
        let rig = file
            .map(|path| RigFile { file: path.display().to_string(), sha256: document.sha256() });
        let changes: Value =
            serde_json::from_str(&json::text_of(self.changes.as_any())?).unwrap_or_default();
        let mut value = document.value().clone();
        // Anything else is a fault of the check that follows.
        if let (Some(settings), Value::Object(changes)) = (value.as_object_mut(), changes) {
            settings.extend(changes);
        }
        let document = Document::parse(&value.to_string(), document.path())
            .map_err(|error| exception::of_document(py, &error))?;
        let settings: RigSettings = document
            .checked(&SCHEMA, Vec::new())
            .map_err(|invalid| exception::of_invalid(py, &invalid))?;
        let mut options = settings.options().map_err(|faults| {
            let diagnostics = faults.into_iter().map(|fault| {
                let pointer = fault.pointer.parse().unwrap_or_default();
                Diagnostic::new(&pointer, Fault::NotAccepted(fault.found), fault.accepted)
            });
            exception::of_invalid(py, &document.with_spans(diagnostics.collect()))
        })?;
        options.rig = rig;
        let axis = self.sample_axis.as_deref();
        options.reading =
            read_options(self.sample_rate_hz, self.names, self.units, axis, &options.reading)?;
        let sensors: Result<Vec<ChannelSensor>, _> =
            self.sensitivity.iter().map(|text| text.parse()).collect();
        let mut sensors = sensors.map_err(|error| exception::of_analysis(&error))?;
        // The first sensor of a channel counts.
        sensors.append(&mut options.sensitivities);
        options.sensitivities = sensors;
        Ok(options)
    }
}

/// Results of each response, modes, and functions as complex columns.
#[pyfunction]
#[pyo3(signature = (sources, settings, hits, rejected, form, frfs, progress))]
#[expect(clippy::too_many_arguments, reason = "keywords of the Python function")]
pub(crate) fn analyse<'py>(
    py: Python<'py>,
    sources: Sources<'py>,
    settings: Settings<'py>,
    hits: &str,
    rejected: Vec<usize>,
    form: &str,
    frfs: bool,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let sources = sources.into_sources()?;
    let mut options = settings.options(py)?;
    options.hits = hits.parse().map_err(|error| exception::of_analysis(&error))?;
    options.rejected = rejected.into_iter().map(RejectedHit::Number).collect();
    options.form = parse_frf_form(form).map_err(|error| exception::of_analysis(&error))?;
    options.keep_frfs = frfs;
    let analysis = background::run(py, progress, move |progress| {
        let passes = 2 * sources.len();
        analyse_sources(&sources, &options, &|done| progress.report(done as f64 / passes as f64))
    })?;
    let analysis = analysis.map_err(|error| exception::of_analysis(&error))?;
    to_dict(py, &analysis)
}

fn to_dict<'py>(py: Python<'py>, analysis: &Analysis) -> PyResult<Bound<'py, PyDict>> {
    let responses = PyList::empty(py);
    for response in &analysis.responses {
        let dict = PyDict::new(py);
        dict.set_item("name", response.name())?;
        dict.set_item("report", json::to_python(py, &response.report)?)?;
        dict.set_item("hits", columns::of_table(py, response.hits_table())?)?;
        dict.set_item("frf", columns::of_table(py, response.frf_table())?)?;
        dict.set_item("backbone", columns::of_table(py, response.backbone_table())?)?;
        let drawn = figures(response, MagnitudeAxis::default());
        dict.set_item("figures", figure::by_name(py, drawn)?)?;
        responses.append(dict)?;
    }
    let dict = PyDict::new(py);
    dict.set_item("responses", responses)?;
    dict.set_item("modes", columns::of_table(py, analysis.modes_table())?)?;
    dict.set_item("frfs", functions(py, analysis.frf_record(false))?)?;
    Ok(dict)
}

/// Frequencies and complex columns of a record over frequency.
fn functions(py: Python<'_>, record: Record) -> PyResult<Bound<'_, PyDict>> {
    let dict = PyDict::new(py);
    for channel in record.channels {
        let Samples::Complex(values) = channel.samples else { continue };
        if let (0, Abscissa::Even { start, step, .. }) = (dict.len(), channel.abscissa) {
            let lines = (0..values.len()).map(|line| start + line as f64 * step);
            dict.set_item("frequency_hz", PyArray1::from_iter(py, lines))?;
        }
        dict.set_item(channel.name, PyArray1::from_vec(py, values))?;
    }
    Ok(dict)
}

/// Results of `decay` for Python.
type DecayResults<'py> =
    (Bound<'py, PyAny>, Bound<'py, PyDict>, Bound<'py, PyDict>, Bound<'py, PyDict>);

/// Report, decays, backbones and figures.
#[pyfunction]
#[pyo3(signature = (sources, settings, bands_hz, progress))]
pub(crate) fn decay<'py>(
    py: Python<'py>,
    sources: Sources<'py>,
    settings: Settings<'py>,
    bands_hz: Vec<[f64; 2]>,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<DecayResults<'py>> {
    let sources = sources.into_sources()?;
    let rig = settings.options(py)?;
    let band = |[low, high]: &[f64; 2]| format!("{low}:{high}").parse();
    let bands: Result<Vec<FrequencyBand>, AnalysisError> = bands_hz.iter().map(band).collect();
    let bands = bands.map_err(|error| exception::of_analysis(&error))?;
    let options = DecayOptions {
        reading: rig.reading,
        sensitivities: rig.sensitivities,
        responses: match rig.responses {
            ResponseChoice::Channels(channels) => channels,
            _ => Vec::new(),
        },
        bands_hz: if bands.is_empty() { rig.band_hz.into_iter().collect() } else { bands },
        rig: rig.rig,
    };
    let analysis = background::run(py, progress, move |progress| {
        let all = sources.len() as f64;
        analyse_decay_sources(&sources, &options, &|done| progress.report(done as f64 / all))
    })?;
    let analysis = analysis.map_err(|error| exception::of_analysis(&error))?;
    let drawn = figure::by_name(py, decay_figures(&analysis))?;
    let tables = [analysis.decays_table(), analysis.backbone_table()];
    let [decays, backbone] = tables.map(|table| columns::of_table(py, table));
    Ok((json::to_python(py, &analysis.report)?, decays?, backbone?, drawn))
}
