//! The work of a response, and how much of it a refinement may ask for.

/// Steps of a response beyond which it is not refined any more.
const MOST_STEPS: f64 = 2e6;

/// Steps times modes of a response beyond which it is not refined any more: some seconds of
/// computation, or minutes where a smaller accuracy than the default is asked for. While contact holds a
/// response at steps of its own converges, and is worth more.
pub(super) const MOST_WORK: f64 = 1e8;
pub(super) const MOST_WORK_PRESSED: f64 = 4e8;
pub(super) const MOST_WORK_ASKED: f64 = 4e9;

/// Steps times modes that a response at equal steps is expected to need, and multiple of what it has, beyond which steps
/// of its own take less time also while contact holds.
const MOST_EQUAL_WORK: f64 = 2e6;
const LEAST_GROWTH: f64 = 4.0;

/// Work of a response.
#[derive(Debug, Clone, Copy)]
pub(super) struct Work {
    /// Steps of the level, or those that were taken if they are more.
    pub(super) steps: f64,
    pub(super) modes: f64,
    /// Steps times modes beyond which the response is not refined any more.
    pub(super) most: f64,
}

impl Work {
    /// True if twice the steps are within the limits.
    pub(super) fn may_double_steps(&self) -> bool {
        2.0 * self.steps <= MOST_STEPS && self.may_double_modes()
    }

    /// True if twice the modes are within the limits.
    pub(super) fn may_double_modes(&self) -> bool {
        2.0 * self.steps * self.modes <= self.most
    }

    /// True if equal steps, of second order, whose error is `excess` times what it may be, ask for so much work that steps
    /// of a response's own take less time: half the step shows twice the modes.
    pub(super) fn is_slow(&self, excess: f64) -> bool {
        excess > LEAST_GROWTH && self.steps * self.modes * excess > MOST_EQUAL_WORK
    }
}
