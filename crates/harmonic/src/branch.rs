//! A branch of periodic responses.

use crate::PeriodicResponse;

/// Kind of a special point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum SpecialPointKind {
    /// The parameter turns back: two responses meet, and one multiplier is +1.
    Fold,
    /// The fundamental of the load's port is largest.
    Peak,
    /// A multiplier passes -1: a motion of twice the period branches off.
    PeriodDoubling,
    /// A pair of complex multipliers leaves the unit circle: a quasi-periodic motion branches off.
    NeimarkSacker,
    /// Another branch of motions of the same period crosses, and one multiplier is +1: the
    /// determinant of the extended Jacobian changes its sign.
    BranchPoint,
}

impl SpecialPointKind {
    /// Name in records: `fold`, `peak`, `period_doubling`, `neimark_sacker` or `branch_point`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Fold => "fold",
            Self::Peak => "peak",
            Self::PeriodDoubling => "period_doubling",
            Self::NeimarkSacker => "neimark_sacker",
            Self::BranchPoint => "branch_point",
        }
    }

    /// True for all kinds but a peak, at which stability does not change.
    pub fn is_bifurcation(self) -> bool {
        self != Self::Peak
    }
}

/// A special point located on a branch.
#[derive(Debug, Clone, PartialEq)]
pub struct SpecialPoint {
    /// Its kind.
    pub kind: SpecialPointKind,
    /// It lies between points `after` and `after + 1`.
    pub after: usize,
    /// The response there.
    pub response: PeriodicResponse,
}

/// Termination of a branch.
#[derive(Debug, Clone, PartialEq)]
pub enum Termination {
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
    /// At the first response that loses contact, as asked for.
    ContactLost,
}

/// Periodic responses in the order of the branch.
#[derive(Debug, Clone, PartialEq)]
pub struct Branch {
    /// The points.
    pub points: Vec<PeriodicResponse>,
    /// Folds, peaks and bifurcations, in the order of the branch.
    pub special: Vec<SpecialPoint>,
    /// Its termination.
    pub termination: Termination,
    /// Harmonics kept.
    pub harmonics: usize,
    /// Samples per period.
    pub samples: usize,
    /// The branch with more harmonics that did not cover the range, where this one took its place.
    pub finer: Option<UnfinishedBranch>,
}

/// Share of a range of frequency below which a part without a stable response is left out.
const NARROW: f64 = 1e-3;

/// A branch that did not cover its range.
#[derive(Debug, Clone, PartialEq)]
pub struct UnfinishedBranch {
    /// Harmonics kept.
    pub harmonics: usize,
    /// Its termination.
    pub termination: Termination,
    /// Number of its points.
    pub points: usize,
    /// Frequency of its last point \[Hz\].
    pub frequency_hz: f64,
}

impl Branch {
    /// The largest fundamental of the load's port: the highest located peak, or the highest
    /// point where the branch has no peak inside.
    pub fn highest(&self) -> Option<&PeriodicResponse> {
        let peaks = self.special.iter().filter(|special| special.kind == SpecialPointKind::Peak);
        let all = peaks.map(|special| &special.response).chain(&self.points);
        all.max_by(|a, b| a.amplitude(1).total_cmp(&b.amplitude(1)))
    }

    /// The stable response with the largest fundamental of the load's port, peaks included, of those with a truncation
    /// of at most 2e-3; none where stability is not known.
    pub fn highest_stable(&self) -> Option<&PeriodicResponse> {
        let all = self.special.iter().map(|special| &special.response).chain(&self.points);
        let stable = all.filter(|one| one.stable() == Some(true) && one.is_resolved());
        stable.max_by(|a, b| a.amplitude(1).total_cmp(&b.amplitude(1)))
    }

    /// The ranges of frequency \[Hz\] between `from` and `to` in which the branch has no stable response, in rising
    /// order: those that no two neighbouring points span of which none is unstable or has a truncation above 2e-3. Ranges
    /// below a thousandth of the whole, as next to a fold, are left out.
    pub fn ranges_without_stable(&self, from: f64, to: f64) -> Vec<[f64; 2]> {
        let (low, high) = (from.min(to), from.max(to));
        let spans = self.points.windows(2).filter_map(|pair| {
            let is_stable =
                |point: &PeriodicResponse| point.stable() != Some(false) && point.is_resolved();
            let stable = pair.iter().all(is_stable);
            let [a, b] = [pair[0].frequency_hz(), pair[1].frequency_hz()];
            stable.then_some([a.min(b), a.max(b)])
        });
        let mut spans: Vec<[f64; 2]> = spans.chain([[high, high]]).collect();
        spans.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let (mut found, mut end) = (Vec::new(), low);
        for [first, last] in spans {
            if first.min(high) - end > NARROW * (high - low) {
                found.push([end, first.min(high)]);
            }
            end = end.max(last);
        }
        found
    }

    /// The highest response if it is a peak located inside a branch that covers its range; else a
    /// part not computed may be higher.
    pub fn peak(&self) -> Option<&PeriodicResponse> {
        let highest = self.highest().filter(|_| self.is_complete())?;
        self.of_kind(SpecialPointKind::Peak).find(|peak| peak.amplitude(1) >= highest.amplitude(1))
    }

    /// Special points of one kind.
    pub fn of_kind(&self, kind: SpecialPointKind) -> impl Iterator<Item = &PeriodicResponse> {
        let found = self.special.iter().filter(move |special| special.kind == kind);
        found.map(|special| &special.response)
    }

    /// Largest truncation of any point.
    pub fn truncation(&self) -> f64 {
        self.points.iter().fold(0.0, |largest, point| largest.max(point.truncation))
    }

    /// True if the branch covers the whole range.
    pub fn is_complete(&self) -> bool {
        self.termination == Termination::Reached
    }
}
