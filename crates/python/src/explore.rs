//! The live page of a scenario: in a notebook, or served to a browser.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use asperity_explore::{ExploreError, ExploreOptions, Explorer, Reply, Server};
use asperity_scenario::Document;
use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;

use crate::background::{self, Watched};
use crate::exception;
use crate::scenario::PyScenario;

/// The page of a scenario; `asperity.explore` shows it.
#[pyclass(name = "LivePage", module = "asperity._asperity", frozen)]
#[derive(Debug)]
pub(crate) struct PyLivePage(Arc<Explorer>);

/// A server under way.
struct Serving(Arc<AtomicBool>);

impl Watched for Serving {
    fn fraction(&self) -> f64 {
        0.0
    }

    fn stop(&self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

fn raised(py: Python<'_>, error: &ExploreError) -> PyErr {
    match error {
        ExploreError::Document(source) => exception::of_document(py, source),
        ExploreError::Invalid(source) => exception::of_invalid(py, source),
        ExploreError::Data(source) => exception::of_identification(py, source),
        other => PyOSError::new_err(other.to_string()),
    }
}

#[pymethods]
impl PyLivePage {
    #[new]
    #[pyo3(signature = (scenario, data, out, temporary=false))]
    fn new(
        scenario: &Bound<'_, PyAny>,
        data: Option<PathBuf>,
        out: Option<PathBuf>,
        temporary: bool,
    ) -> PyResult<Self> {
        let document = PyScenario::of(scenario, None)?.document;
        let mut options = ExploreOptions::default();
        (options.data, options.data_is_temporary, options.out) = (data, temporary, out);
        let py = scenario.py();
        let explorer = py.detach(|| Explorer::new(document, &options));
        Ok(Self(Arc::new(explorer.map_err(|error| raised(py, &error))?)))
    }

    /// The page as one HTML text, for a frame.
    #[staticmethod]
    fn page() -> String {
        Explorer::framed_page()
    }

    /// Answers a request of the page: calls `send` with the status, then with each line; it returns False once the answer
    /// is not waited for any more. An exception of `send` ends the answer, and is raised here.
    fn answer(&self, py: Python<'_>, place: &str, body: &str, send: Py<PyAny>) -> PyResult<()> {
        let failure = std::sync::Mutex::new(None);
        let told = |reply: Reply| {
            Python::attach(|py| {
                let answered = match reply {
                    Reply::Status(status) => send.call1(py, (status,)),
                    Reply::Line(line) => send.call1(py, (line,)),
                };
                match answered.and_then(|wanted| wanted.is_truthy(py)) {
                    Ok(wanted) => wanted,
                    Err(error) => {
                        *failure.lock().unwrap_or_else(std::sync::PoisonError::into_inner) =
                            Some(error);
                        false
                    }
                }
            })
        };
        py.detach(|| self.0.answer(place, body.as_bytes(), &told));
        let failure = failure.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
        failure.map_or(Ok(()), Err)
    }

    /// Serves the page at a port of the loopback address, or at any, until Ctrl-C; calls `announce` with its address.
    fn serve(
        &self,
        py: Python<'_>,
        port: Option<u16>,
        announce: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        let server = Server::new(Arc::clone(&self.0), port).map_err(|error| raised(py, &error))?;
        announce.call1((server.url(),))?;
        let serving = Arc::new(Serving(Arc::new(AtomicBool::new(false))));
        let served = background::run_watched(py, None, serving, |serving| server.run(&serving.0))?;
        served.map_err(|error| raised(py, &error))
    }

    /// The scenario as the page shows it.
    fn scenario(&self, py: Python<'_>) -> PyResult<PyScenario> {
        let document: Document = self.0.document();
        PyScenario::checked(py, document)
    }

    /// Ends the computations under way.
    fn close(&self) {
        self.0.close();
    }
}
