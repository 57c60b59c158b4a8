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

/// Share of a range of frequency below which a part with or without stable responses is left out.
const NARROW: f64 = 1e-3;

/// Width of the range of frequency of some points \[Hz\].
fn width(points: &[PeriodicResponse]) -> f64 {
    let all = points.iter().map(PeriodicResponse::frequency_hz);
    let (low, high) =
        all.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), f| (low.min(f), high.max(f)));
    high - low
}

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
    /// of at most 2e-3; none where stability is not known. Responses at bifurcations, and stable parts of the branch
    /// below a thousandth of its range of frequency, are left out: no structure is found there.
    pub fn highest_stable(&self) -> Option<&PeriodicResponse> {
        let is_stable = |one: &PeriodicResponse| one.stable() == Some(true) && one.is_resolved();
        let (peaks, bifurcations): (Vec<_>, Vec<_>) =
            self.special.iter().partition(|special| special.kind == SpecialPointKind::Peak);
        // Parts of the branch between bifurcations, each stable or not throughout.
        let numbers: Vec<usize> = (0..self.points.len()).collect();
        let parts = numbers.chunk_by(|&n, &next| {
            is_stable(&self.points[n]) == is_stable(&self.points[next])
                && !bifurcations.iter().any(|special| special.after == n)
        });
        let narrow = NARROW * width(&self.points);
        let wide = parts.filter_map(|part| {
            let range = part[0]..part[part.len() - 1];
            let points = &self.points[range.start..=range.end];
            (is_stable(&points[0]) && width(points) >= narrow).then_some((range, points))
        });
        let all = wide.flat_map(|(range, points)| {
            let inside = peaks.iter().filter(move |peak| range.contains(&peak.after));
            points.iter().chain(inside.map(|peak| &peak.response).filter(|one| is_stable(one)))
        });
        all.max_by(|a, b| a.amplitude(1).total_cmp(&b.amplitude(1)))
    }

    /// The ranges of frequency \[Hz\] between `from` and `to` in which none of some branches has a stable response, in
    /// rising order: those that no two neighbouring points span of which none is unstable or has a truncation above 2e-3.
    /// Ranges below a thousandth of the whole, as next to a fold, are left out.
    pub fn ranges_without_stable<'a>(
        branches: impl IntoIterator<Item = &'a Self>,
        from: f64,
        to: f64,
    ) -> Vec<[f64; 2]> {
        let (low, high) = (from.min(to), from.max(to));
        let pairs = branches.into_iter().flat_map(|branch| branch.points.windows(2));
        let spans = pairs.filter_map(|pair| {
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

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use num_complex::Complex64;

    use super::*;

    fn response(frequency_hz: f64, amplitude: f64, multiplier: f64) -> PeriodicResponse {
        PeriodicResponse {
            angular_frequency: TAU * frequency_hz,
            force: 1.0,
            anti_damping: 0.0,
            mean_displacement: 0.0,
            displacement: vec![Complex64::new(amplitude, 0.0)],
            sensors: Vec::new(),
            closures: vec![0.0; 3],
            pressures: Vec::new(),
            truncation: 0.0,
            modal_mass: 1.0,
            iterations: 0,
            multipliers: Some(vec![Complex64::new(multiplier, 0.0)]),
        }
    }

    /// A stable part of 2e-4 of the range and the bifurcation at its end are left out, though they are higher; a peak
    /// between two points of a wide part is not.
    #[test]
    fn the_highest_stable_response_is_not_at_a_bifurcation() {
        let rows = [
            (100.0, 1.0, 0.5),
            (110.0, 2.0, 0.5),
            (120.0, 3.0, 0.5),
            (130.0, 2.5, 0.5),
            (130.0, 4.0, 1.5),
            (120.0, 6.0, 1.5),
            (119.99, 7.0, 0.9),
            (119.985, 7.5, 0.9),
            (150.0, 8.0, 1.5),
        ];
        let special = |kind, after, response| SpecialPoint { kind, after, response };
        let mut branch = Branch {
            points: rows.map(|(f, u, multiplier)| response(f, u, multiplier)).to_vec(),
            special: vec![
                special(SpecialPointKind::Peak, 2, response(122.0, 3.2, 0.5)),
                special(SpecialPointKind::Fold, 3, response(131.0, 3.9, 1.0)),
                special(SpecialPointKind::NeimarkSacker, 7, response(119.98, 7.9, 1.0)),
            ],
            termination: Termination::Reached,
            harmonics: 1,
            samples: 8,
            finer: None,
        };
        assert_eq!(branch.highest_stable().map(|one| one.amplitude(1)), Some(3.2));
        // A bifurcation between two stable points parts the branch there; the upper part is still wide.
        branch.special.push(special(
            SpecialPointKind::PeriodDoubling,
            1,
            response(115.0, 2.4, 1.0),
        ));
        assert_eq!(branch.highest_stable().map(|one| one.amplitude(1)), Some(3.2));
        branch.points.iter_mut().for_each(|point| point.truncation = 1.0);
        assert_eq!(branch.highest_stable(), None);
    }
}
