//! Number of modes kept of each body.

use std::f64::consts::PI;

use crate::error::{MeshError, not_negative};
use crate::{Body, Stack, Support};

/// Number of modes kept of each body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ModeCount {
    /// This many, the rigid one included.
    PerBody(usize),
    /// The lowest of all bodies and the support together; the rigid ones at least.
    Lowest(usize),
    /// So many that up to `angular_frequency` \[rad/s\] the inertia of the modes left out, which
    /// residual flexibility neglects, is at most `tolerance` of the body's own.
    Bound {
        /// Highest angular frequency of interest \[rad/s\].
        angular_frequency: f64,
        /// Share of the body's rigid receptance `1 / (m w^2)` that may be neglected.
        tolerance: f64,
    },
}

/// Most modes of one body.
const MOST_MODES: usize = 2000;

impl ModeCount {
    /// Number of modes of every body of `stack`, the rigid one included.
    ///
    /// For a [`Bound`](Self::Bound): a free-free mode n has the receptance
    /// `2 / (m (w_n^2 - w^2))` at the faces. Of this, residual flexibility keeps `2 / (m w_n^2)` and
    /// neglects, over `1 / (m w^2)`, `2 (w / w_n)^4 / (1 - (w / w_n)^2)`; with `w_n = n w_1` the sum
    /// over n > N is below `2 (w / w_1)^4 / (1 - (w / w_N+1)^2)` times
    /// `1 / (N + 1)^4 + 1 / (3 (N + 1)^3)`.
    ///
    /// # Errors
    /// [`MeshError::ModeCount`] for no modes, or more than 2000, and [`MeshError::FrequencyBound`]
    /// for a bound that needs more.
    pub fn counts(self, stack: &Stack) -> Result<Vec<usize>, MeshError> {
        let bodies = stack.bodies().iter();
        match self {
            Self::PerBody(modes) => bodies.map(|body| checked_count(body, modes)).collect(),
            Self::Lowest(count) => Ok(lowest_counts(stack, count)),
            Self::Bound { angular_frequency, tolerance } => {
                bodies.map(|body| bounded_count(body, angular_frequency, tolerance)).collect()
            }
        }
    }
}

/// Angular frequency of the first elastic free-free mode, `pi c / L` \[rad/s\].
pub(crate) fn first_frequency(body: &Body) -> f64 {
    PI * body.wave_speed() / body.length()
}

pub(crate) fn checked_count(body: &Body, modes: usize) -> Result<usize, MeshError> {
    if (1..=MOST_MODES).contains(&modes) {
        Ok(modes)
    } else {
        Err(MeshError::ModeCount { body: body.name().to_owned(), modes, limit: MOST_MODES })
    }
}

fn bounded_count(body: &Body, frequency: f64, tolerance: f64) -> Result<usize, MeshError> {
    not_negative(body.name(), "angular frequency [rad/s]", frequency)?;
    let ratio = frequency / first_frequency(body);
    let neglected = |kept: usize| {
        let next = kept as f64;
        let tail = next.powi(-4) + next.powi(-3) / 3.0;
        // The series holds below resonance only, and is used with a margin.
        let below = 1.0 - (ratio / next).powi(2);
        if below < 0.5 { f64::INFINITY } else { 2.0 * ratio.powi(4) * tail / below }
    };
    let fewest = (1..=MOST_MODES).find(|&kept| neglected(kept) <= tolerance);
    fewest.ok_or_else(|| MeshError::FrequencyBound {
        body: body.name().to_owned(),
        ratio,
        limit: MOST_MODES,
    })
}

fn lowest_counts(stack: &Stack, count: usize) -> Vec<usize> {
    let mut kept = vec![1; stack.bodies().len()];
    let support = usize::from(*stack.support() != Support::Rigid);
    for _ in kept.len() + support..count {
        let next = |i: usize| kept[i] as f64 * first_frequency(&stack.bodies()[i]);
        let lowest = (0..kept.len()).min_by(|&a, &b| next(a).total_cmp(&next(b)));
        if let Some(lowest) = lowest {
            kept[lowest] += 1;
        }
    }
    kept
}
