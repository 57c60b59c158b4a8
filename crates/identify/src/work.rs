//! The work of an identification under way: its progress, and requests to stop.

mod forecast;

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use asperity_inference::Progress;

pub(crate) use forecast::{Forecast, Sizes, expected_of_explanations};
use forecast::{Measured, Moment};

/// The parts of an identification, in their order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum WorkStage {
    /// Fit of the problem's law.
    Fit,
    /// Profiles of the parameters.
    Profiles,
    /// Draws from the posterior.
    Posterior,
    /// Comparison with other laws, and the design.
    Comparison,
}

impl WorkStage {
    /// Name for display.
    pub fn name(self) -> &'static str {
        match self {
            Self::Fit => "fit",
            Self::Profiles => "profiles",
            Self::Posterior => "posterior",
            Self::Comparison => "comparison",
        }
    }
}

/// The progress of an identification.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WorkProgress {
    /// The part under way.
    pub stage: WorkStage,
    /// Share of the whole time that is over, as estimated; it never falls.
    pub share: f64,
    /// Estimated time left; `None` before the first evaluations.
    pub left: Option<Duration>,
    /// Time left that about one identification in ten exceeds: what a search finds decides on the work after it.
    pub most: Option<Duration>,
}

/// The progress of an identification under way and a request to stop it, shared between threads.
#[derive(Debug, Default)]
pub struct Work {
    stopped: Arc<AtomicBool>,
    state: Mutex<Option<State>>,
}

#[derive(Debug)]
struct State {
    begun: Instant,
    stage: WorkStage,
    expected: Forecast,
    measured: Measured,
    /// Beginning of what is measured now.
    moment: Instant,
    /// Largest share that was shown.
    shown: f64,
}

impl State {
    fn begin(&mut self, moment: Moment) {
        self.measured.begin(moment);
        self.moment = Instant::now();
    }
}

impl Work {
    /// Requests the identification to end soon, with the results that are finished.
    pub fn stop(&self) {
        self.stopped.store(true, Ordering::Relaxed);
    }

    /// The flag of a request to stop, for handlers of signals.
    pub fn stop_flag(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.stopped)
    }

    /// True after a request to stop.
    pub fn is_stopped(&self) -> bool {
        self.stopped.load(Ordering::Relaxed)
    }

    fn state(&self) -> MutexGuard<'_, Option<State>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The progress; `None` before the beginning.
    pub fn progress(&self) -> Option<WorkProgress> {
        let mut state = self.state();
        let state = state.as_mut()?;
        let since = state.moment.elapsed().as_secs_f64();
        let left = state.measured.seconds_left(&state.expected, since);
        let most = state.measured.seconds_left(&state.expected.long(), since);
        let over = state.begun.elapsed().as_secs_f64();
        let share = left.map_or(0.0, |left| over / (over + left));
        state.shown = state.shown.max(share);
        let [left, most] =
            [left, most].map(|left| left.and_then(|left| Duration::try_from_secs_f64(left).ok()));
        Some(WorkProgress { stage: state.stage, share: state.shown, left, most })
    }

    /// Begins, with what is expected.
    pub(crate) fn plan(&self, expected: Forecast) {
        *self.state() = Some(State {
            begun: Instant::now(),
            stage: WorkStage::Fit,
            expected,
            measured: Measured::default(),
            moment: Instant::now(),
            shown: 0.0,
        });
    }

    fn change(&self, change: impl FnOnce(&mut State)) {
        if let Some(state) = self.state().as_mut() {
            change(state);
        }
    }

    /// Expects more evaluations of the comparison.
    pub(crate) fn expect_compared(&self, more: f64) {
        self.change(|state| state.expected.comparison += more);
    }

    /// Follows the progress of the posterior, of so many `draws`.
    pub(crate) fn follow(&self, now: &Progress, draws: usize) {
        self.change(|state| {
            let before = state.measured.moment;
            if state.stage == WorkStage::Posterior {
                let since = state.moment.elapsed().as_secs_f64();
                state.measured.follow(now, draws as f64, since);
            }
            if state.measured.moment != before {
                state.moment = Instant::now();
            }
        });
    }

    /// The search goes on with other standard deviations, if at all.
    pub(crate) fn found(&self) {
        self.change(|state| state.begin(Moment::Continued));
    }

    /// All of the parts before the one under way come again.
    pub(crate) fn repeat(&self) {
        self.change(|state| state.begin(Moment::Repeated));
    }

    /// Begins a part. A part that is repeated belongs to the one under way.
    pub(crate) fn begin(&self, stage: WorkStage) {
        self.change(|state| {
            state.stage = state.stage.max(stage);
            state.begin(match stage {
                WorkStage::Fit => Moment::Search,
                WorkStage::Profiles => Moment::Profiles,
                WorkStage::Posterior => Moment::Surface,
                WorkStage::Comparison => Moment::Comparison,
            });
        });
    }

    /// Counts evaluated points.
    pub(crate) fn count(&self, points: usize) {
        self.change(|state| state.measured.count(points));
    }

    /// Takes in that counted points took so many seconds together.
    pub(crate) fn time(&self, points: usize, seconds: f64) {
        self.change(|state| state.measured.time(points, seconds));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_inference::PosteriorOptions;

    #[test]
    fn the_share_never_falls() {
        let work = Work::default();
        assert!(work.progress().is_none());
        work.time(1, 1.0);
        work.repeat();
        let sizes = Sizes { parameters: 3, latents: 0, observations: 10, starts: 1, compared: 0 };
        work.plan(Forecast::new(sizes, &PosteriorOptions::default()));
        let begun = work.progress().unwrap();
        assert_eq!((begun.stage, begun.share, begun.left), (WorkStage::Fit, 0.0, None));
        work.time(100, 1e-9);
        let mut last = 0.0;
        for stage in [WorkStage::Profiles, WorkStage::Posterior, WorkStage::Fit] {
            work.begin(stage);
            work.count(10);
            work.time(10, 1e-3);
            let now = work.progress().unwrap();
            assert!(
                now.share >= last && now.share < 1.0 && now.left.is_some() && now.most >= now.left,
                "{now:?}"
            );
            last = now.share;
            // A part that comes again belongs to the last.
            assert_eq!(now.stage, stage.max(WorkStage::Profiles).max(now.stage));
        }
        work.repeat();
        assert!(work.progress().unwrap().share >= last);
        assert!(!work.is_stopped());
        work.stop();
        assert!(work.is_stopped());
    }
}
