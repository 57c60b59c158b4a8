//! Answers to the requests of the page: what can be changed, and the pictures of a part.

use std::collections::VecDeque;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::time::{Duration, Instant};

use asperity_figure::Figure;
use asperity_scenario::Document;
use asperity_simulation::static_state::StaticSummary;
use serde_json::{Value, json};

use crate::commands::commands;
use crate::computation::{Beside, ComputationError, Results, Waiting, compute};
use crate::controls::groups;
use crate::keep::{Files, existing, problem_files, state_files, write};
use crate::measured::Measured;
use crate::message::{
    Answer, ComputeRequest, KeepRequest, Part, PulseRequest, StateRequest, View, ViewSize,
};
use crate::settings::Settings;
use crate::state::{Base, Change, Fault, State};

/// Pinned results that are kept: of the parts of two pages.
const MOST_KEPT: usize = 6;

/// Least time between two reports of progress.
const BETWEEN_REPORTS: Duration = Duration::from_millis(100);

/// The scenario of the page and its results.
#[derive(Debug)]
pub(crate) struct Session {
    base: Base,
    out: PathBuf,
    measured: Option<Measured>,
    /// Changes that the scenario was opened with.
    given: Vec<String>,
    /// Settings that the scenario of the file gives, and a structure of matrices at rest: they stay while numbers move.
    usual: OnceLock<(Settings, Option<StaticSummary>)>,
    /// Results of pinned states, the newest last.
    kept: Mutex<VecDeque<(Key, Arc<Results>)>>,
    /// Changes of the newest valid state.
    left: Mutex<Vec<Change>>,
}

/// A part of a state with its settings, and the views that it is computed for.
#[derive(Debug, Clone, PartialEq)]
struct Key {
    part: Part,
    settings: Settings,
    changes: Vec<Change>,
    views: Vec<View>,
}

/// Takes the lines of an answer.
pub(crate) struct Sink<'a> {
    pub(crate) sender: &'a (dyn Fn(Vec<u8>) -> bool + Sync),
    pub(crate) stop: &'a AtomicBool,
}

impl Sink<'_> {
    pub(crate) fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// Sends a line; a page that has gone stops the computation.
    pub(crate) fn send(&self, answer: &Answer) {
        let mut line = serde_json::to_vec(answer).unwrap_or_default();
        line.push(b'\n');
        if !(self.sender)(line) {
            self.stop.store(true, Ordering::Relaxed);
        }
    }
}

impl Session {
    pub(crate) fn new(
        base: Base,
        out: PathBuf,
        measured: Option<Measured>,
        given: Vec<String>,
    ) -> Self {
        let (kept, left) = (Mutex::default(), Mutex::default());
        Self { base, out, measured, given, usual: OnceLock::new(), kept, left }
    }

    fn usual(&self) -> &(Settings, Option<StaticSummary>) {
        self.usual.get_or_init(|| {
            let state = self.base.state(&[]).ok();
            state.map(|state| Settings::usual(&state, self.measured.as_ref())).unwrap_or_default()
        })
    }

    /// The controls of a state, its faults, and its settings, as JSON.
    pub(crate) fn describe(&self, request: &StateRequest) -> String {
        let faults = self.base.state(&request.changes).err().unwrap_or_default();
        if faults.is_empty() {
            let mut left = self.left.lock().unwrap_or_else(PoisonError::into_inner);
            left.clone_from(&request.changes);
        }
        let changed = self.base.changed(&request.changes);
        let changed = changed.as_ref().unwrap_or(&self.base.document);
        let groups =
            groups(self.base.schema(), changed, &self.base.document, self.usual().1.as_ref());
        let settings = request.settings.filled(&self.usual().0);
        let views = View::ALL.map(|view| {
            json!({ "view": view, "title": view.title(), "part": view.part(), "stem": view.stem() })
        });
        json!({
            "commands": commands(changed, &self.given, &request.changes, &settings),
            "title": self.base.document.value().get("title"),
            "file": self.base.document.path().display().to_string(),
            "version": env!("CARGO_PKG_VERSION"),
            "views": views,
            "groups": groups,
            "faults": faults,
            "settings": settings,
            "out": self.out.display().to_string(),
            "hits": self.measured.as_ref().map(Measured::described),
            "driven": self.driven(changed),
        })
        .to_string()
    }

    /// The hit whose measured force excites a document.
    fn driven(&self, document: &Document) -> Option<usize> {
        self.measured.as_ref()?.hit_of(document.value().get("excitation")?)
    }

    /// The measured force of a hit as an excitation of a state, as JSON.
    pub(crate) fn pulse(&self, request: &PulseRequest) -> Value {
        let document = self.base.changed(&request.changes).ok();
        let present = document.as_ref().and_then(|document| document.value().get("excitation"));
        let present = present.unwrap_or(&Value::Null);
        let found = self.measured.as_ref().map(|hits| hits.excitation(request.hit, present));
        match found.flatten() {
            Some(excitation) => json!({ "excitation": excitation }),
            None => {
                json!({ "error": "the hit has no measured force; accepted: a hit whose record was found" })
            }
        }
    }

    /// The document with the changes of the newest valid state.
    pub(crate) fn left(&self) -> Document {
        let left = self.left.lock().unwrap_or_else(PoisonError::into_inner);
        self.base.changed(&left).unwrap_or_else(|_| self.base.document.clone())
    }

    /// Computes a part and sends its pictures and numbers.
    pub(crate) fn compute(&self, request: &ComputeRequest, sink: &Sink<'_>) {
        if sink.is_stopped() {
            return;
        }
        let views = request.views.iter().map(|place| place.view);
        let key = Key {
            part: request.part,
            settings: request.settings.clone(),
            changes: request.changes.clone(),
            views: views.filter(|view| view.part() == request.part).collect(),
        };
        let pinned = request.pinned.as_ref().and_then(|pinned| {
            self.kept_results(Key { changes: pinned.clone(), ..key.clone() }, sink)
        });
        let draw = |results: &Results, draft: bool| {
            for place in request.views.iter().filter(|place| place.view.part() == request.part) {
                if sink.is_stopped() {
                    return;
                }
                sink.send(&picture(*place, results, pinned.as_deref(), draft));
            }
            sink.send(&Answer::Words { text: results.words.clone() });
        };
        let draft = |results: &Results| draw(results, true);
        let results = match self.results(&key, sink, Some(&draft)) {
            Ok(results) => results,
            Err(Failed::Faults(faults)) => return sink.send(&Answer::Faults { faults }),
            Err(Failed::Error(text)) => return sink.send(&Answer::Error { text }),
            Err(Failed::Stopped) => return,
        };
        draw(&results, false);
        if let Some(text) = results.error {
            sink.send(&Answer::Error { text });
        }
    }

    fn results(
        &self,
        Key { part, settings, changes, views }: &Key,
        sink: &Sink<'_>,
        draft: Option<&(dyn Fn(&Results) + Sync)>,
    ) -> Result<Results, Failed> {
        let state = self.base.state(changes).map_err(Failed::Faults)?;
        let last = Mutex::new(Instant::now());
        let progress = |done: f64| {
            if sink.is_stopped() {
                resume_unwind(Box::new(Stopped));
            }
            let mut last = last.lock().unwrap_or_else(PoisonError::into_inner);
            if last.elapsed() >= BETWEEN_REPORTS {
                *last = Instant::now();
                sink.send(&Answer::Progress { done });
            }
        };
        let beside = Beside { measured: self.measured.as_ref(), views, tables: false };
        let settings = settings.filled(&self.usual().0);
        let waiting = Waiting { progress: &progress, stop: sink.stop, draft };
        let found = Self::caught(|| compute(*part, &state, &settings, beside, waiting));
        if sink.is_stopped() { Err(Failed::Stopped) } else { found }
    }

    /// The results of some work, which a stop ends by unwinding from its report of progress, where the work does not
    /// look at the flag itself. A defect of an engine ends its request alone.
    fn caught(work: impl FnOnce() -> Result<Results, ComputationError>) -> Result<Results, Failed> {
        match catch_unwind(AssertUnwindSafe(work)) {
            Ok(results) => results.map_err(|error| Failed::Error(error.to_string())),
            Err(reason) if reason.is::<Stopped>() => Err(Failed::Stopped),
            Err(_) => Err(Failed::Error(DEFECT.to_owned())),
        }
    }

    /// Writes the files of a state, or tells which would be replaced, as JSON.
    pub(crate) fn keep(&self, request: &KeepRequest) -> Value {
        let state = match self.base.state(&request.changes) {
            Ok(state) => state,
            Err(faults) => return json!({ "error": faults.first().map(|fault| &fault.text) }),
        };
        let files = match (&self.measured, request.problem) {
            (Some(measured), true) => problem_files(&state, measured),
            (None, true) => Err("there are no measured hits; give them with --data".to_owned()),
            (_, false) => self.files(&state, request),
        };
        let files = match files {
            Ok(files) => files,
            Err(error) => return json!({ "error": error }),
        };
        let existing = existing(&self.out, &files);
        if !existing.is_empty() && !request.overwrite {
            return json!({ "existing": existing, "folder": self.out.display().to_string() });
        }
        match write(&self.out, &files) {
            Ok(()) => {
                let names: Vec<&String> = files.iter().map(|(name, _)| name).collect();
                json!({ "written": names, "folder": self.out.display().to_string() })
            }
            Err((path, error)) => {
                json!({ "error": format!("{} cannot be written: {error}", path.display()) })
            }
        }
    }

    /// Scenario, figures and tables of the views.
    fn files(&self, state: &State, request: &KeepRequest) -> Result<Files, String> {
        let mut parts: Vec<Part> = request.views.iter().map(|view| view.part()).collect();
        parts.sort_unstable();
        parts.dedup();
        let (measured, views) = (self.measured.as_ref(), &request.views[..]);
        let beside = Beside { measured, views, tables: true };
        let settings = request.settings.filled(&self.usual().0);
        let never = AtomicBool::new(false);
        let waiting = Waiting { progress: &|_| (), stop: &never, draft: None };
        let results = parts
            .into_iter()
            .map(|part| Self::caught(|| compute(part, state, &settings, beside, waiting)));
        let results: Vec<Results> = results.collect::<Result<_, _>>().map_err(Failed::text)?;
        state_files(state, &results, &request.views).map_err(|error| error.to_string())
    }

    /// The results of a pinned state, which are computed once; none for a state that has none.
    fn kept_results(&self, key: Key, sink: &Sink<'_>) -> Option<Arc<Results>> {
        let kept = || self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, results)) = kept().iter().find(|(known, _)| *known == key) {
            return Some(Arc::clone(results));
        }
        let results = Arc::new(self.results(&key, sink, None).ok()?);
        let mut kept = kept();
        if kept.len() >= MOST_KEPT {
            kept.pop_front();
        }
        kept.push_back((key, Arc::clone(&results)));
        Some(results)
    }
}

/// A part without results.
enum Failed {
    Faults(Vec<Fault>),
    Error(String),
    Stopped,
}

impl Failed {
    fn text(self) -> String {
        match self {
            Self::Faults(faults) => {
                faults.into_iter().map(|fault| fault.text).collect::<Vec<_>>().join("\n")
            }
            Self::Error(text) => text,
            Self::Stopped => "stopped".to_owned(),
        }
    }
}

/// Unwound from a computation whose result is not wanted any more.
struct Stopped;

/// Error of a computation that panicked.
pub(crate) const DEFECT: &str = "a defect of this program ended the request";

/// The picture of a view, laid out for its place on the page.
fn picture(place: ViewSize, results: &Results, pinned: Option<&Results>, draft: bool) -> Answer {
    let of = |results: &Results| {
        let found = results.figures.iter().find(|(view, _)| *view == place.view);
        found.map(|(_, figure)| figure.clone())
    };
    let view = place.view;
    match of(results) {
        Some(Ok(figure)) => {
            let columns = (COLUMNS_PER_PIXEL * width_of(place)) as usize;
            let figure = match pinned.and_then(of) {
                Some(Ok(earlier)) => figure.over(&earlier, "pinned"),
                _ => figure,
            };
            let drawn = laid_out(figure, place).to_interactive(columns);
            Answer::Picture { view, svg: drawn.svg, data: drawn.data, draft }
        }
        Some(Err(reason)) => Answer::Absent { view, reason },
        None => Answer::Absent { view, reason: "there is no result".to_owned() },
    }
}

/// Columns of points of all lines of a panel over the pixels of the figure: some for a zoom.
const COLUMNS_PER_PIXEL: f64 = 1.0;

/// Pixels a millimetre of a figure on the page: text of 7 points has 11 pixels.
const PIXELS_PER_MM: f64 = 4.4;

/// Least and greatest width of a place, and the width from which on two panels stand in a row \[px\].
const WIDTHS: std::ops::RangeInclusive<f64> = 200.0..=4000.0;
const TWO_COLUMNS: f64 = 640.0;

/// Height of a row of panels over their width, and its bounds \[mm\].
const ASPECT: f64 = 0.5;
const ROW_MM: std::ops::RangeInclusive<f64> = 40.0..=62.0;

fn width_of(place: ViewSize) -> f64 {
    let width = if place.width.is_finite() { place.width } else { 0.0 };
    width.clamp(*WIDTHS.start(), *WIDTHS.end())
}

/// The figure as wide as its place.
fn laid_out(figure: Figure, place: ViewSize) -> Figure {
    let width = width_of(place);
    let columns = match place.view {
        View::Levels => 2,
        View::Steady => 1,
        _ if width >= TWO_COLUMNS => 2,
        _ => 1,
    };
    let width_mm = width / PIXELS_PER_MM;
    let row = (ASPECT * width_mm / f64::from(columns)).clamp(*ROW_MM.start(), *ROW_MM.end());
    figure.columns(columns as usize).width_mm(width_mm).row_height_mm(row)
}
