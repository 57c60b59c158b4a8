//! Progress of long computations.

/// The computation under way.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Stage {
    /// Searches of a fit.
    Fit,
    /// Searches along profiles.
    Profile,
    /// Training points of the response surface.
    Surrogate,
    /// Markov chains.
    Sampling,
    /// Draws evaluated on the model.
    Draws,
    /// Candidates of a model comparison.
    Comparison,
}

impl Stage {
    /// Name for display.
    pub fn name(self) -> &'static str {
        match self {
            Self::Fit => "fitting",
            Self::Profile => "profiles",
            Self::Surrogate => "response surface",
            Self::Sampling => "sampling",
            Self::Draws => "draws",
            Self::Comparison => "comparing models",
        }
    }
}

/// State of a long computation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// The computation.
    pub stage: Stage,
    /// Parts done.
    pub done: usize,
    /// Parts in total.
    pub of: usize,
    /// Lowest cost so far; infinite before the first.
    pub cost: f64,
}

/// A callback that receives the progress.
pub type ProgressCallback<'a> = dyn Fn(Progress) + Sync + 'a;

/// The callback of computations without one.
pub(crate) const NO_PROGRESS: &ProgressCallback<'static> = &|_| ();

/// Reports parts done of a stage that has no cost.
pub(crate) fn report(progress: &ProgressCallback<'_>, stage: Stage, done: usize, of: usize) {
    progress(Progress { stage, done, of, cost: f64::INFINITY });
}
