//! A branch of periodic responses.

use crate::Response;

/// What is special at a place of a branch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Special {
    /// The parameter turns back: two responses meet, and one multiplier is +1.
    Fold,
    /// The fundamental of the driving point is largest.
    Peak,
    /// A multiplier passes -1: a motion of twice the period branches off.
    PeriodDoubling,
    /// A pair of complex multipliers leaves the unit circle: a quasi-periodic motion branches off.
    NeimarkSacker,
    /// Another branch of motions of the same period crosses, and one multiplier is +1: the
    /// determinant of the extended Jacobian changes its sign.
    BranchPoint,
}

impl Special {
    /// Whether stability changes there; a peak is special for what is observed only.
    pub fn is_bifurcation(self) -> bool {
        self != Self::Peak
    }
}

/// A located place on a branch.
#[derive(Debug, Clone, PartialEq)]
pub struct SpecialPoint {
    /// What it is.
    pub kind: Special,
    /// It lies between points `after` and `after + 1`.
    pub after: usize,
    /// The response there.
    pub response: Response,
}

/// Why a branch ends where it does.
#[derive(Debug, Clone, PartialEq)]
pub enum BranchEnd {
    /// At the end of the range asked for.
    Reached,
    /// It turned back and left the range where it came in.
    Returned,
    /// Newton's method failed for the shortest step; the branch may go on beyond a kink that more
    /// harmonics or samples would resolve.
    NotConverged,
    /// A law gave no finite pressure further on: its closure limit.
    BeyondLaw {
        /// Name of the interface.
        interface: String,
        /// The closure increment asked for \[m\].
        closure: f64,
    },
    /// At the largest number of points.
    PointLimit,
}

/// Responses in the order of the branch, no point of which was left out.
#[derive(Debug, Clone, PartialEq)]
pub struct Branch {
    /// The points.
    pub points: Vec<Response>,
    /// Folds, peaks and bifurcations, in the order of the branch.
    pub special: Vec<SpecialPoint>,
    /// Why it ends.
    pub end: BranchEnd,
    /// Harmonics kept.
    pub harmonics: usize,
    /// Samples per period.
    pub samples: usize,
}

impl Branch {
    /// The largest fundamental of the driving point: the highest located peak, or the highest
    /// point where the branch has no peak inside.
    pub fn highest(&self) -> Option<&Response> {
        let peaks = self.special.iter().filter(|special| special.kind == Special::Peak);
        let all = peaks.map(|special| &special.response).chain(&self.points);
        all.max_by(|a, b| a.amplitude(1).total_cmp(&b.amplitude(1)))
    }

    /// Located places of one kind.
    pub fn of_kind(&self, kind: Special) -> impl Iterator<Item = &Response> {
        let found = self.special.iter().filter(move |special| special.kind == kind);
        found.map(|special| &special.response)
    }

    /// Largest truncation of any point.
    pub fn truncation(&self) -> f64 {
        self.points.iter().fold(0.0, |largest, point| largest.max(point.truncation))
    }

    /// Whether the whole range was followed.
    pub fn is_complete(&self) -> bool {
        self.end == BranchEnd::Reached
    }
}
