//! Requests of the page and answers to it, as JSON.

use serde::{Deserialize, Serialize};

use crate::settings::Settings;
use crate::state::{Change, Fault};

/// Most bytes of a request.
pub(crate) const MOST_BYTES: usize = 1 << 20;

/// Most changes of a state, and most characters of the name of a page.
pub(crate) const MOST_CHANGES: usize = 500;
const MOST_NAME: usize = 64;

/// Results that are computed together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Part {
    /// One hit: laws, history, receptance, paths of the contacts.
    Hit,
    /// Hits of several forces.
    Levels,
    /// Steady responses.
    Steady,
}

/// A figure of the page.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum View {
    Law,
    Frf,
    History,
    PressureClosure,
    Levels,
    Steady,
}

impl View {
    /// All views, in the order of the page.
    pub(crate) const ALL: [Self; 6] =
        [Self::Law, Self::Frf, Self::History, Self::PressureClosure, Self::Levels, Self::Steady];

    /// The part whose results it shows.
    pub(crate) fn part(self) -> Part {
        match self {
            Self::Law | Self::Frf | Self::History | Self::PressureClosure => Part::Hit,
            Self::Levels => Part::Levels,
            Self::Steady => Part::Steady,
        }
    }

    /// Heading on the page.
    pub(crate) fn title(self) -> &'static str {
        match self {
            Self::Law => "Contact laws",
            Self::Frf => "Receptance",
            Self::History => "Response over time",
            Self::PressureClosure => "Pressure against closure",
            Self::Levels => "Force levels",
            Self::Steady => "Steady responses",
        }
    }

    /// Name of its file.
    pub(crate) fn stem(self) -> &'static str {
        match self {
            Self::Law => "law",
            Self::Frf => "frf",
            Self::History => "history",
            Self::PressureClosure => "pressure-closure",
            Self::Levels => "levels",
            Self::Steady => "steady",
        }
    }
}

/// Asks what can be changed in a state.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct StateRequest {
    pub(crate) changes: Vec<Change>,
    #[serde(default)]
    pub(crate) settings: Settings,
}

/// Asks for a part of the results of a state.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ComputeRequest {
    /// Name of the page, at random.
    pub(crate) tab: String,
    pub(crate) part: Part,
    /// The views that are shown.
    pub(crate) views: Vec<ViewSize>,
    pub(crate) changes: Vec<Change>,
    /// Another state, drawn in grey.
    #[serde(default)]
    pub(crate) pinned: Option<Vec<Change>>,
    #[serde(default)]
    pub(crate) settings: Settings,
}

/// Asks for the measured force of a hit, as an excitation.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PulseRequest {
    pub(crate) changes: Vec<Change>,
    /// Number of the hit in the analysis shown, from 0.
    pub(crate) hit: usize,
}

/// Asks to write files to the folder of the page.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct KeepRequest {
    pub(crate) changes: Vec<Change>,
    #[serde(default)]
    pub(crate) settings: Settings,
    /// Views whose figures and tables are written.
    #[serde(default)]
    pub(crate) views: Vec<View>,
    /// Writes a problem for `identify` in their place.
    #[serde(default)]
    pub(crate) problem: bool,
    /// True to replace files, once the user has agreed.
    #[serde(default)]
    pub(crate) overwrite: bool,
}

/// A view and the width of its place on the page, in CSS pixels.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ViewSize {
    pub(crate) view: View,
    pub(crate) width: f64,
}

impl StateRequest {
    /// The fault of the request, if it has one.
    pub(crate) fn fault(&self) -> Option<String> {
        too_many(&self.changes)
    }
}

impl PulseRequest {
    /// The fault of the request, if it has one.
    pub(crate) fn fault(&self) -> Option<String> {
        too_many(&self.changes)
    }
}

impl KeepRequest {
    /// The fault of the request, if it has one.
    pub(crate) fn fault(&self) -> Option<String> {
        too_many(&self.changes).or_else(|| too_many_views(self.views.len()))
    }
}

impl ComputeRequest {
    /// The fault of the request, if it has one.
    pub(crate) fn fault(&self) -> Option<String> {
        if self.tab.is_empty() || self.tab.len() > MOST_NAME {
            return Some(format!("tab has {} bytes; accepted: 1 to {MOST_NAME}", self.tab.len()));
        }
        too_many_views(self.views.len())
            .or_else(|| too_many(&self.changes))
            .or_else(|| too_many(self.pinned.as_deref()?))
    }
}

fn too_many_views(count: usize) -> Option<String> {
    let most = View::ALL.len();
    (count > most).then(|| format!("{count} views; accepted: at most {most}"))
}

fn too_many(changes: &[Change]) -> Option<String> {
    let count = changes.len();
    (count > MOST_CHANGES).then(|| format!("{count} changes; accepted: at most {MOST_CHANGES}"))
}

/// A line of the answer to a [`ComputeRequest`].
#[derive(Debug, Clone, Serialize)]
#[serde(tag = "answer", rename_all = "snake_case")]
pub(crate) enum Answer {
    /// Share of the computation that is done.
    Progress { done: f64 },
    /// A figure with the data that the script of figures reads; of a draft the final one follows.
    Picture { view: View, svg: String, data: String, draft: bool },
    /// A view that cannot be shown, with the reason.
    Absent { view: View, reason: String },
    /// The numbers of the part, as the command prints them.
    Words { text: String },
    /// Values of the scenario that are not accepted.
    Faults { faults: Vec<Fault> },
    /// The computation failed.
    Error { text: String },
    /// A newer request of the page has taken its place.
    Superseded,
    /// The last line.
    Done { seconds: f64 },
}
