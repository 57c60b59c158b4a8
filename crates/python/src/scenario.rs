//! The class `Scenario`.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};

use asperity_scenario::{AnyScenario, Document};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyDict, PyMapping, PyString};

use crate::{exception, json};

/// A valid scenario: one computation as a document.
///
/// Parameters
/// ----------
/// source : str, os.PathLike, dict or Scenario
///     Path of a JSON file, JSON text (which starts with ``{``), or the document as a dict.
/// folder : str or os.PathLike, optional
///     Folder that relative file names in a text or a dict start from; the current one by default.
///
/// Raises
/// ------
/// TypeError
///     If `source` is none of these.
/// ScenarioError
///     With all faults of the document.
/// OSError
///     If the file cannot be read.
///
/// Examples
/// --------
/// >>> scenario = Scenario("rig.json")                         # doctest: +SKIP
/// >>> stronger = scenario.with_({"/excitation/peak_n": 20})   # doctest: +SKIP
#[pyclass(name = "Scenario", module = "asperity", frozen)]
#[derive(Debug, Clone)]
pub(crate) struct PyScenario {
    pub(crate) document: Document,
    pub(crate) scenario: AnyScenario,
}

impl PyScenario {
    /// The checked scenario of `document`.
    pub(crate) fn checked(py: Python<'_>, document: Document) -> PyResult<Self> {
        let scenario = py
            .detach(|| document.any_scenario())
            .map_err(|invalid| exception::of_invalid(py, &invalid))?;
        Ok(Self { document, scenario })
    }

    /// The scenario of anything that the constructor accepts.
    pub(crate) fn of(source: &Bound<'_, PyAny>, folder: Option<PathBuf>) -> PyResult<Self> {
        if let Ok(scenario) = source.cast::<Self>() {
            return Ok(scenario.get().clone());
        }
        let accepted = "a path, JSON text, a dict or a Scenario";
        Self::checked(source.py(), json::document_of(source, folder, "scenario", accepted)?)
    }
}

/// Calls a function of a module of the package with the scenario and a value before the options.
fn call<'py>(
    (module, function): (&str, &str),
    arguments: impl pyo3::call::PyCallArgs<'py>,
    options: Bound<'py, PyDict>,
) -> PyResult<Bound<'py, PyAny>> {
    options.py().import(module)?.getattr(function)?.call(arguments, Some(&options))
}

#[pymethods]
impl PyScenario {
    #[new]
    #[pyo3(signature = (source, *, folder = None))]
    fn new(source: &Bound<'_, PyAny>, folder: Option<PathBuf>) -> PyResult<Self> {
        Self::of(source, folder)
    }

    /// The same scenario with other values.
    ///
    /// Parameters
    /// ----------
    /// values : mapping
    ///     Values by JSON Pointer (RFC 6901), such as ``{"/excitation/peak_n": 20}``. They are set
    ///     in their order, and the whole is checked then.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     If the values are no mapping, a pointer is not a str, or a value cannot be in a document.
    /// ScenarioError
    ///     If a pointer leads nowhere, or the result is not valid.
    fn with_(&self, values: &Bound<'_, PyAny>) -> PyResult<Self> {
        let py = values.py();
        let Ok(values) = values.cast::<PyMapping>() else {
            return Err(PyTypeError::new_err(format!(
                "the values cannot be of the type {}; accepted: a mapping of JSON Pointers to values",
                values.get_type().name()?
            )));
        };
        let mut document = self.document.clone();
        for item in values.items()? {
            let (pointer, value): (Bound<'_, PyAny>, Bound<'_, PyAny>) = item.extract()?;
            let pointer = pointer.cast::<PyString>().map_err(|_| {
                PyTypeError::new_err("the keys of the values are JSON Pointers, as str")
            })?;
            let (pointer, text) = (pointer.to_cow()?, json::text_of(&value)?);
            document
                .set(&pointer, &text)
                .map_err(|error| exception::of_set(py, error.to_string(), &error))?;
        }
        Self::checked(py, document)
    }

    /// Simulate the response to the force, as the function `simulate` does.
    ///
    /// Parameters
    /// ----------
    /// progress : callable, optional
    ///     Called with the fraction done, 0 to 1.
    ///
    /// Returns
    /// -------
    /// Simulation
    ///     Observables, time history and receptance.
    #[pyo3(signature = (*, progress = None))]
    fn simulate<'py>(
        slf: &Bound<'py, Self>,
        progress: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let options = [("progress", progress)].into_py_dict(slf.py())?;
        call(("asperity._simulate", "simulate"), (slf,), options)
    }

    /// Simulate many runs, as the function `sweep` does.
    ///
    /// Parameters
    /// ----------
    /// vary, rows : mapping
    ///     Values by JSON Pointer: all combinations, or row by row.
    /// threads : int, optional
    ///     Number of threads; all cores by default.
    /// progress : callable, optional
    ///     Called with the fraction done, 0 to 1.
    ///
    /// Returns
    /// -------
    /// Sweep
    ///     A table of a row per run.
    #[pyo3(signature = (vary = None, *, rows = None, threads = None, progress = None))]
    fn sweep<'py>(
        slf: &Bound<'py, Self>,
        vary: Option<Bound<'py, PyAny>>,
        rows: Option<Bound<'py, PyAny>>,
        threads: Option<Bound<'py, PyAny>>,
        progress: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let options = [("rows", rows), ("threads", threads), ("progress", progress)];
        call(("asperity._sweep", "sweep"), (slf, vary), options.into_py_dict(slf.py())?)
    }

    /// Run the scenario over a design of its inputs, as the function `study` does.
    ///
    /// Parameters
    /// ----------
    /// study : mapping
    ///     The study without its ``scenario``, which is this one: ``inputs`` or ``draws``, ``design`` and
    ///     the settings; ``schema`` may be left out.
    /// folder : str or os.PathLike, optional
    ///     Folder that relative file names in the study and in the scenario start from; that of the
    ///     scenario by default.
    /// out, resume, level, probabilities, exceed, threads, progress
    ///     As for the function `study`.
    ///
    /// Returns
    /// -------
    /// Study
    ///     A table of a row per run, with quantiles, exceedance probabilities and Sobol indices.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     If the study is not a mapping.
    /// ValueError
    ///     If it has a scenario of its own.
    #[pyo3(signature = (study, *, folder = None, out = None, resume = false, level = 0.95,
        probabilities = vec![0.05, 0.25, 0.5, 0.75, 0.95], exceed = None, threads = None, progress = None))]
    #[allow(clippy::too_many_arguments, reason = "the options of the function")]
    fn study<'py>(
        slf: &Bound<'py, Self>,
        study: Bound<'py, PyAny>,
        folder: Option<Bound<'py, PyAny>>,
        out: Option<Bound<'py, PyAny>>,
        resume: bool,
        level: f64,
        probabilities: Vec<f64>,
        exceed: Option<Bound<'py, PyAny>>,
        threads: Option<Bound<'py, PyAny>>,
        progress: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let options =
            [("folder", folder), ("out", out), ("threads", threads), ("progress", progress)];
        let options = options.into_py_dict(slf.py())?;
        options.set_item("resume", resume)?;
        options.set_item("level", level)?;
        options.set_item("probabilities", probabilities)?;
        if let Some(exceed) = exceed {
            options.set_item("exceed", exceed)?;
        }
        call(("asperity._study", "study_of"), (slf, study), options)
    }

    /// Follow branches of steady responses, as the function `steady` does.
    ///
    /// Parameters
    /// ----------
    /// amplitudes_n : float or array_like
    ///     Amplitudes of the force in N, or of the acceleration of a moving base in m/s2.
    /// from_hz, to_hz : float
    ///     Range of frequencies in Hz.
    /// harmonics, backbone, verify, bodies, time_sweep, time_sweep_points, threads, progress
    ///     As for the function `steady`.
    ///
    /// Returns
    /// -------
    /// SteadyResponses
    ///     Branches, backbones and stepped sines as tables.
    #[pyo3(signature = (amplitudes_n, from_hz, to_hz, *, harmonics = None, backbone = false, verify = false,
        bodies = "auto", time_sweep = None, time_sweep_points = 201, threads = None, progress = None))]
    #[allow(clippy::too_many_arguments, reason = "the options of the function")]
    fn steady<'py>(
        slf: &Bound<'py, Self>,
        amplitudes_n: Bound<'py, PyAny>,
        from_hz: Bound<'py, PyAny>,
        to_hz: Bound<'py, PyAny>,
        harmonics: Option<Bound<'py, PyAny>>,
        backbone: bool,
        verify: bool,
        bodies: &str,
        time_sweep: Option<Bound<'py, PyAny>>,
        time_sweep_points: i64,
        threads: Option<Bound<'py, PyAny>>,
        progress: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let options = [
            ("harmonics", harmonics),
            ("time_sweep", time_sweep),
            ("threads", threads),
            ("progress", progress),
        ];
        let options = options.into_py_dict(slf.py())?;
        options.set_item("backbone", backbone)?;
        options.set_item("verify", verify)?;
        options.set_item("bodies", bodies)?;
        options.set_item("time_sweep_points", time_sweep_points)?;
        call(("asperity._steady", "steady"), (slf, amplitudes_n, from_hz, to_hz), options)
    }

    /// Compute natural frequencies, damping ratios and mode shapes, as the function `modes` does.
    ///
    /// Parameters
    /// ----------
    /// count : int
    ///     Number of modes, 1 to 1000; a structure may have fewer.
    ///
    /// Returns
    /// -------
    /// Modes
    ///     Frequencies in Hz, damping ratios and shapes.
    #[pyo3(signature = (count = 4))]
    fn modes<'py>(slf: &Bound<'py, Self>, count: i64) -> PyResult<Bound<'py, PyAny>> {
        let options = [("count", count)].into_py_dict(slf.py())?;
        call(("asperity._steady", "modes"), (slf,), options)
    }

    /// Identify a contact law, or any numbers of this scenario, as the function `identify` does.
    ///
    /// Parameters
    /// ----------
    /// problem : mapping
    ///     The problem without its ``scenario``, which is this one: ``unknowns``, ``data`` and the
    ///     settings; ``schema`` may be left out.
    /// folder : str or os.PathLike, optional
    ///     Folder that relative file names in the problem and in the scenario start from; that of the
    ///     scenario by default.
    /// progress : callable, optional
    ///     Called with the estimated fraction done, 0 to 1.
    /// fast : bool, optional
    ///     Leave out profiles, the comparison with other laws and the explanations of a misfit.
    ///
    /// Returns
    /// -------
    /// Identification
    ///     The law with its band, the fit of the data, and draws from the posterior.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     If the problem is not a mapping.
    /// ValueError
    ///     If it has a scenario of its own.
    #[pyo3(signature = (problem, *, folder = None, progress = None, fast = false))]
    fn identify<'py>(
        slf: &Bound<'py, Self>,
        problem: Bound<'py, PyAny>,
        folder: Option<Bound<'py, PyAny>>,
        progress: Option<Bound<'py, PyAny>>,
        fast: bool,
    ) -> PyResult<Bound<'py, PyAny>> {
        let options = [("folder", folder), ("progress", progress)].into_py_dict(slf.py())?;
        options.set_item("fast", fast)?;
        call(("asperity._identify", "identify_in"), (slf, problem), options)
    }

    /// Write the document to a file, as JSON that the command reads.
    ///
    /// Relative file names in the document are rewritten, so that they lead to the same files from there.
    ///
    /// Parameters
    /// ----------
    /// path : str or os.PathLike
    ///     File to write; it appears complete or not at all.
    /// overwrite : bool
    ///     Replace an existing file.
    ///
    /// Raises
    /// ------
    /// FileExistsError
    ///     If the file exists and is not to be replaced.
    /// OSError
    ///     If the file cannot be written.
    #[pyo3(signature = (path, *, overwrite = false))]
    fn save(slf: &Bound<'_, Self>, path: Bound<'_, PyAny>, overwrite: bool) -> PyResult<()> {
        let options = [("overwrite", overwrite)].into_py_dict(slf.py())?;
        call(("asperity._json", "save"), (slf, path), options).map(drop)
    }

    /// Folder that relative file names in the document start from.
    #[getter]
    fn folder(&self) -> &Path {
        self.document.folder()
    }

    /// The document as a dict, without the defaults.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        json::to_python(py, self.document.value())
    }

    /// Title, or None.
    #[getter]
    fn title(&self) -> Option<&str> {
        self.scenario.title()
    }

    /// SHA-256 of the document, as results state it.
    #[getter]
    fn sha256(&self) -> String {
        self.document.sha256()
    }

    fn __repr__(&self) -> String {
        let names = |count: usize, noun: &str| {
            format!("{count} {noun}{}", if count == 1 { "y" } else { "ies" })
        };
        let title = self.scenario.title().unwrap_or("untitled");
        let (bodies, contacts) = self.scenario.size();
        let bodies = names(bodies, "bod");
        format!(
            "<asperity.Scenario {title:?}: {bodies}, {contacts} interface{}>",
            match contacts {
                1 => "",
                _ => "s",
            }
        )
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other.cast::<Self>().is_ok_and(|other| other.get().sha256() == self.sha256())
    }

    /// Equal documents have equal hashes, in any order of their keys.
    fn __hash__(&self) -> u64 {
        let mut hasher = DefaultHasher::new();
        self.sha256().hash(&mut hasher);
        hasher.finish()
    }

    /// Pickles and copies are made from the document and its folder.
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, (String, PathBuf))> {
        let restore = slf.py().import("asperity._asperity")?.getattr("restore_scenario")?;
        let document = &slf.get().document;
        Ok((restore, (document.value().to_string(), document.path().to_owned())))
    }
}

/// The scenario of a text whose file has this path.
#[pyfunction]
pub(crate) fn restore_scenario(py: Python<'_>, text: &str, path: PathBuf) -> PyResult<PyScenario> {
    let document = Document::parse(text, path);
    PyScenario::checked(py, document.map_err(|error| exception::of_document(py, &error))?)
}
