//! The work of an identification under way: its progress, and requests to stop.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use asperity_inference::{Progress, Stage};

/// The parts of an identification, in their order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
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

const STAGES: usize = 4;

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
    /// Share of the whole that is done, estimated from the evaluations of the model.
    pub share: f64,
    /// Estimated time left; `None` before the first evaluations.
    pub left: Option<Duration>,
}

/// The progress of an identification under way and a request to stop it, shared between threads.
#[derive(Debug, Default)]
pub struct Work {
    stopped: Arc<AtomicBool>,
    /// Points evaluated in the part under way.
    points: AtomicUsize,
    state: Mutex<State>,
}

#[derive(Debug, Default)]
struct State {
    /// Beginnings of the whole, and of the part under way.
    started: Option<[Instant; 2]>,
    stage: usize,
    /// Evaluations that each part is expected to need, or has needed.
    expected: [f64; STAGES],
    /// Evaluations for the last surface of the posterior.
    surface: f64,
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

    /// The progress; `None` before the beginning.
    pub fn progress(&self) -> Option<WorkProgress> {
        let state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        let elapsed = state.started?.map(|begun| begun.elapsed().as_secs_f64());
        let here = self.points.load(Ordering::Relaxed) as f64;
        let done = state.expected[..state.stage].iter().sum::<f64>() + here;
        let rest: f64 = state.expected[state.stage + 1..].iter().sum();
        // A part that needs more than was expected is taken to need a quarter more than so far.
        let own = state.expected[state.stage].max(1.25 * here);
        let whole = done - here + own + rest;
        let share = if whole > 0.0 { done / whole } else { 0.0 };
        let left = seconds_left(elapsed, [done, here], [own, rest]).map(Duration::from_secs_f64);
        let stages =
            [WorkStage::Fit, WorkStage::Profiles, WorkStage::Posterior, WorkStage::Comparison];
        Some(WorkProgress { stage: stages[state.stage], share, left })
    }

    /// Begins, with the evaluations that each part is expected to need.
    pub(crate) fn plan(&self, expected: [f64; STAGES]) {
        self.points.store(0, Ordering::Relaxed);
        *self.state.lock().unwrap_or_else(PoisonError::into_inner) =
            State { started: Some([Instant::now(); 2]), expected, ..State::default() };
    }

    /// Expects more evaluations of a part.
    pub(crate) fn expect(&self, stage: WorkStage, more: f64) {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        state.expected[stage as usize] += more;
    }

    /// Expects of the posterior what its progress tells: once a surface has been trained so many `draws`, and after them
    /// another surface with its draws, unless the part ends.
    pub(crate) fn follow(&self, now: &Progress, draws: usize) {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        let draws = draws as f64;
        if state.stage != WorkStage::Posterior as usize {
            return;
        }
        let rest = match now.stage {
            Stage::Surrogate => {
                state.surface = now.of as f64;
                draws
            }
            // More draws on the last surface are counted, rounds of surfaces are few.
            Stage::Draws if now.of as f64 > draws => draws,
            Stage::Draws => state.surface + draws,
            _ => return,
        };
        state.expected[WorkStage::Posterior as usize] =
            self.points.load(Ordering::Relaxed) as f64 + rest;
    }

    /// Expects all of the parts before the one under way again, and this one, as a part of this one.
    pub(crate) fn repeat(&self) {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        let here = self.points.load(Ordering::Relaxed) as f64;
        let stage = state.stage;
        let before: f64 = state.expected[..stage].iter().sum();
        state.expected[stage] = 2.0 * here + before;
    }

    /// Begins a part; the evaluations of the part before are now known. A part that is repeated belongs to the one under way.
    pub(crate) fn begin(&self, stage: WorkStage) {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        if (stage as usize) < state.stage {
            return;
        }
        let here = self.points.swap(0, Ordering::Relaxed) as f64;
        let before = state.stage;
        state.expected[before] = here;
        state.stage = stage as usize;
        if let Some([_, part]) = &mut state.started {
            *part = Instant::now();
        }
    }

    /// Evaluations so far.
    #[cfg(test)]
    pub(crate) fn done(&self) -> f64 {
        let state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        state.expected[..state.stage].iter().sum::<f64>()
            + self.points.load(Ordering::Relaxed) as f64
    }

    /// Counts evaluated points.
    pub(crate) fn add(&self, points: usize) {
        self.points.fetch_add(points, Ordering::Relaxed);
    }
}

/// Share of a part from which on its own pace is known.
const PACE_KNOWN: f64 = 0.05;

/// Time left \[s\] after the seconds since the whole and its part under way began, with the evaluations
/// `done` in all and `here` in the part, which needs `own` before the `rest`. A part keeps its pace, which
/// may be another than before (its hits may open contacts), and so does what comes after it.
fn seconds_left(
    [whole, part]: [f64; 2],
    [done, here]: [f64; 2],
    [own, rest]: [f64; 2],
) -> Option<f64> {
    let pace = if here > PACE_KNOWN * own { part / here } else { whole / done };
    (done > 0.0).then_some(pace * (own - here + rest))
}

/// Evaluations that each part of a typical identification needs.
pub(crate) fn expected_evaluations(
    [parameters, latents]: [usize; 2],
    starts: usize,
    draws: usize,
    compared: usize,
) -> [f64; STAGES] {
    // A free law has one start, no profiles, and surfaces over the combinations that the data inform.
    let (others, free) = (parameters - latents, latents > 0);
    let stencil = |count: usize| (2 * count + 1) as f64;
    let dimensions = others + latents.min(INFORMED);
    let product = |last: usize| (1..=last).map(|k| (dimensions + k) as f64).product::<f64>();
    let surface = if dimensions <= MOST_CUBIC { product(3) / 6.0 } else { product(2) / 2.0 };
    let compared_fit = 12.0 * stencil(others);
    let fit = if free { 8.0 * parameters as f64 } else { compared_fit * (starts + 1) as f64 };
    let profiles = if free { 0.0 } else { 70.0 * others as f64 };
    let posterior = if free {
        7.5 * surface + 3.0 * draws as f64
    } else {
        // One surface suffices where the model is right and nearly linear.
        1.3 * (5.0 * surface + draws as f64)
    };
    [fit, profiles, posterior, compared as f64 * (1.5 * compared_fit + 40.0)]
}

/// Evaluations that the explanations of a misfit need: short fits with a parameter more.
pub(crate) fn expected_of_explanations(parameters: usize) -> f64 {
    // Three of given numbers and usually three of losses, which end after five steps.
    6.0 * 5.0 * (2 * (parameters + 1) + 2) as f64
}

/// Combinations of latents that data usually inform.
const INFORMED: usize = 16;

/// Most dimensions of a cubic surface.
const MOST_CUBIC: usize = 10;

#[cfg(test)]
mod tests {
    use super::*;

    /// Evaluations of two identifications of records with a free law of 40 latents and 4 other parameters,
    /// 4826 and 11577 for fit and posterior; and of a power law.
    #[test]
    fn expected_evaluations_are_of_the_size_of_those_counted() {
        let free: f64 = expected_evaluations([44, 40], 4, 1000, 1)[..3].iter().sum();
        assert!((4826.0 / 2.0..2.0 * 4826.0).contains(&free), "{free}");
        let power: f64 = expected_evaluations([2, 0], 4, 1000, 1).iter().sum();
        assert!((1500.0..4500.0).contains(&power), "{power}");
    }

    #[test]
    fn shares_grow_to_one_over_the_parts() {
        let work = Work::default();
        assert!(work.progress().is_none());
        work.plan([100.0, 100.0, 200.0, 0.0]);
        assert_eq!(work.progress().unwrap().left, None);
        work.add(50);
        let half = work.progress().unwrap();
        assert_eq!((half.stage, half.share), (WorkStage::Fit, 0.125));
        assert!(half.left.is_some());
        // More than expected.
        work.add(350);
        let more = work.progress().unwrap().share;
        assert_eq!(more, 0.5);
        // Two slow parts after a fast one; the pace of a part that has hardly begun is the pace so far.
        assert_eq!(seconds_left([110.0, 100.0], [200.0, 100.0], [400.0, 50.0]), Some(350.0));
        assert_eq!(seconds_left([10.0, 0.0], [100.0, 0.0], [400.0, 50.0]), Some(45.0));
        assert_eq!(seconds_left([1.0, 1.0], [0.0, 0.0], [400.0, 50.0]), None);
        work.begin(WorkStage::Profiles);
        work.begin(WorkStage::Posterior);
        assert_eq!(work.progress().unwrap().share, 400.0 / 600.0);
        // A surface of 60 points and its draws, and another one.
        let progress = |stage, done, of| Progress { stage, done, of, cost: f64::INFINITY };
        work.add(60);
        work.follow(&progress(Stage::Surrogate, 60, 60), 100);
        assert_eq!(work.progress().unwrap().share, 460.0 / 560.0);
        work.add(100);
        work.follow(&progress(Stage::Draws, 1, 3), 100);
        assert_eq!(work.progress().unwrap().share, 560.0 / 720.0);
        work.follow(&progress(Stage::Draws, 200, 500), 100);
        assert_eq!(work.progress().unwrap().share, 560.0 / 660.0);
        work.add(40);
        work.begin(WorkStage::Comparison);
        assert_eq!(work.progress().unwrap().share, 1.0);
        assert!(!work.is_stopped());
        work.stop();
        assert!(work.is_stopped());
    }
}
