//! A page and its answers, whatever carries them: the server, or the kernel of a notebook.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use asperity_identify::IdentificationError;
use asperity_scenario::{Document, DocumentError, InvalidDocument};
use asperity_simulation::output::file_name::file_name;
use thiserror::Error;

use crate::jobs::{Job, Jobs};
use crate::measured::Measured;
use crate::message::{Answer, ComputeRequest, KeepRequest, MOST_BYTES, PulseRequest, StateRequest};
use crate::page;
use crate::session::{Session, Sink};
use crate::state::Base;

/// Options of the live page.
#[derive(Debug, Clone, Default)]
#[non_exhaustive]
pub struct ExploreOptions {
    /// Port of the loopback address; a free one without. A page in a notebook has none.
    pub port: Option<u16>,
    /// Folder for what is kept, which is made when something is; `out/` and the name of the scenario's file
    /// with `-explore` without.
    pub out: Option<PathBuf>,
    /// An `analysis.json` whose hits are shown beside the computed ones.
    pub data: Option<PathBuf>,
    /// True if the file of the data does not outlive the page: a problem that is written has it beside it.
    pub data_is_temporary: bool,
    /// Changes that the document has already, as `--set` takes them: commands that the page copies repeat
    /// them.
    pub set: Vec<String>,
}

/// A page that cannot be shown.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ExploreError {
    /// The scenario cannot be read.
    #[error(transparent)]
    Document(#[from] DocumentError),
    /// The scenario is not valid.
    #[error(transparent)]
    Invalid(#[from] InvalidDocument),
    /// The measured hits cannot be read.
    #[error(transparent)]
    Data(Box<IdentificationError>),
    /// The address cannot be listened at.
    #[error(
        "127.0.0.1:{port} cannot be listened at: {source}; accepted: a port that no other program uses, or none for any"
    )]
    Port {
        /// Port.
        port: u16,
        /// Cause.
        source: std::io::Error,
    },
    /// The system gives no random numbers, or no thread.
    #[error("the page cannot be served: {0}")]
    System(std::io::Error),
}

/// A part of an answer to a request.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Reply {
    /// Status as in HTTP, before all lines: 200; 400 for a request that is not understood, 404 for a place that is
    /// not there, 413 for one that is too long, 503 once the page is closed.
    Status(u16),
    /// A line, JSON.
    Line(String),
}

/// The page of one scenario without a server: requests of the page and their answers.
#[derive(Debug)]
pub struct Explorer {
    pub(crate) session: Session,
    pub(crate) jobs: Jobs,
}

impl Explorer {
    /// The page of a document.
    ///
    /// # Errors
    /// [`ExploreError`] for a scenario that is not valid, or data that cannot be read.
    pub fn new(document: Document, options: &ExploreOptions) -> Result<Self, ExploreError> {
        document.any_scenario()?;
        let is_temporary = options.data_is_temporary;
        let read = |path: &Path| Measured::read(path, is_temporary);
        let measured = options.data.as_deref().map(read).transpose();
        let measured = measured.map_err(|error| ExploreError::Data(Box::new(error)))?;
        let out = options.out.clone().unwrap_or_else(|| usual_folder(document.path()));
        let session = Session::new(Base::new(document), out, measured, options.set.clone());
        Ok(Self { session, jobs: Jobs::default() })
    }

    /// The page as one text of HTML with style, fonts and scripts in it, for a frame within another page. Its requests are
    /// messages to that page, `{asperity: {id, place, body}}` or `{asperity: {id, stop: true}}`; the answers are messages to the
    /// frame, `{asperity: {id, status}}`, `{asperity: {id, line}}` for each line, and `{asperity: {id, end: true}}`.
    pub fn framed_page() -> String {
        page::framed()
    }

    /// Answers a request of the page at a place: `state`, `pulse`, `compute` or `keep`, with its JSON. Returns once the answer
    /// is complete; a newer request of the same page ends an older computation of the same part. `send` returns false
    /// once the answer is not waited for any more.
    pub fn answer(&self, place: &str, body: &[u8], send: &(dyn Fn(Reply) -> bool + Sync)) {
        if body.len() > MOST_BYTES {
            let fault = format!("{} bytes; accepted: at most {MOST_BYTES}", body.len());
            return refuse(413, &fault, send);
        }
        match place {
            "state" => match parsed(body, StateRequest::fault) {
                Ok(request) => whole(self.session.describe(&request), send),
                Err(fault) => refuse(400, &fault, send),
            },
            "pulse" => match parsed(body, PulseRequest::fault) {
                Ok(request) => whole(self.session.pulse(&request).to_string(), send),
                Err(fault) => refuse(400, &fault, send),
            },
            "keep" => match parsed(body, KeepRequest::fault) {
                Ok(request) => whole(self.session.keep(&request).to_string(), send),
                Err(fault) => refuse(400, &fault, send),
            },
            "compute" => match parsed(body, ComputeRequest::fault) {
                Ok(request) => match self.jobs.begin(&request.tab, request.part) {
                    Some(job) => {
                        send(Reply::Status(200));
                        let turn = Arc::clone(&job.turn);
                        let _turn = turn.blocking_lock_owned();
                        let line = |line: Vec<u8>| {
                            send(Reply::Line(String::from_utf8_lossy(&line).into_owned()))
                        };
                        self.compute(&request, &job, Instant::now(), &line);
                    }
                    None => refuse(503, "the page has been closed", send),
                },
                Err(fault) => refuse(400, &fault, send),
            },
            _ => refuse(404, "there is no such place", send),
        }
    }

    /// The scenario as the page shows it now: the one it was made of, with the changes of the newest valid state.
    pub fn document(&self) -> Document {
        self.session.left()
    }

    /// Ends the computations under way, and begins no other.
    pub fn close(&self) {
        self.jobs.close();
    }

    /// Computes a part whose turn it is, and ends the answer.
    pub(crate) fn compute(
        &self,
        request: &ComputeRequest,
        job: &Job,
        begun: Instant,
        sender: &(dyn Fn(Vec<u8>) -> bool + Sync),
    ) {
        let sink = Sink { sender, stop: &job.stop };
        self.session.compute(request, &sink);
        let seconds = begun.elapsed().as_secs_f64();
        sink.send(&if sink.is_stopped() { Answer::Superseded } else { Answer::Done { seconds } });
    }
}

/// The request in a body, or its fault.
pub(crate) fn parsed<T: serde::de::DeserializeOwned>(
    body: &[u8],
    fault: impl Fn(&T) -> Option<String>,
) -> Result<T, String> {
    let request = serde_json::from_slice(body).map_err(|error| error.to_string())?;
    fault(&request).map_or(Ok(request), Err)
}

/// An answer that refuses a request, with the reason in its `error`.
pub(crate) fn refusal(reason: &str) -> String {
    serde_json::json!({ "error": reason }).to_string()
}

fn refuse(status: u16, reason: &str, send: &(dyn Fn(Reply) -> bool + Sync)) {
    if send(Reply::Status(status)) {
        send(Reply::Line(refusal(reason)));
    }
}

fn whole(text: String, send: &(dyn Fn(Reply) -> bool + Sync)) {
    if send(Reply::Status(200)) {
        send(Reply::Line(text));
    }
}

fn usual_folder(scenario: &Path) -> PathBuf {
    let stem = scenario.file_stem().unwrap_or(scenario.as_os_str()).to_string_lossy();
    PathBuf::from("out").join(file_name(&format!("{stem}-explore")))
}
