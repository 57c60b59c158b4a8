//! The points of a branch as it is followed, and what is special about them.

use crate::arc_length::{ArcLength, Failure, Station};
use crate::floquet::Judge;
use crate::problem::Problem;
use crate::{Branch, BranchEnd, ContactSystem, Response, Special, SpecialPoint};

/// A branch in the making.
pub(crate) struct Recorder {
    judge: Option<Judge>,
    pub(crate) branch: Branch,
    /// Slope of the amplitude along the branch at the last point.
    slope: f64,
}

impl Recorder {
    pub(crate) fn new(judge: Option<Judge>, harmonics: usize, samples: usize) -> Self {
        let end = BranchEnd::NotConverged;
        let branch = Branch { points: Vec::new(), special: Vec::new(), end, harmonics, samples };
        Self { judge, branch, slope: 0.0 }
    }

    pub(crate) fn ended(mut self, end: BranchEnd) -> Branch {
        self.branch.end = end;
        self.branch
    }

    pub(crate) fn why(system: &ContactSystem, failure: Failure) -> BranchEnd {
        match failure {
            Failure::Stalled(_) => BranchEnd::NotConverged,
            Failure::Overflow(overflow) => BranchEnd::BeyondLaw {
                interface: system.contacts()[overflow.interface].name().to_owned(),
                closure: overflow.closure,
            },
        }
    }

    /// The response at a station, which the curve evaluated last.
    fn response(&mut self, curve: &Problem<'_>, station: &Station) -> Response {
        let at = curve.conditions(&station.place);
        let balance = curve.balance();
        let mut response = Response::of(balance, curve.closures(), &at, station.iterations);
        if let Some(judge) = &mut self.judge {
            response.multipliers =
                Some(judge.multipliers(balance, curve.closures(), at.angular_frequency));
        }
        response
    }

    pub(crate) fn record(&mut self, arc: &mut ArcLength<Problem<'_>>, station: &Station) {
        self.slope = arc.curve.amplitude_slope(&station.place, &station.tangent);
        let response = self.response(&arc.curve, station);
        self.branch.points.push(response);
    }

    /// Records the next point and what lies on the step to it.
    pub(crate) fn step(
        &mut self,
        arc: &mut ArcLength<Problem<'_>>,
        from: &Station,
        next: &Station,
        step: f64,
    ) {
        let before = self.slope;
        self.record(arc, next);
        let last = from.place.len() - 1;
        let turns = (from.tangent[last], next.tangent[last]);
        let mut found = Vec::new();
        if turns.0 * turns.1 < 0.0
            && let Ok(fold) = arc.locate(from, step, turns, |_, at| at.tangent[last])
        {
            found.push((Special::Fold, fold));
        }
        let slopes = (before, self.slope);
        if slopes.0 > 0.0
            && slopes.1 <= 0.0
            && let Ok(peak) = arc.locate(from, step, slopes, |curve, at| {
                curve.amplitude_slope(&at.place, &at.tangent)
            })
        {
            found.push((Special::Peak, peak));
        }
        let orientations = (from.orientation, next.orientation);
        if orientations.0 != orientations.1
            && let Ok(crossing) = arc.locate(from, step, orientations, |_, at| at.orientation)
        {
            found.push((Special::BranchPoint, crossing));
        }
        let folded = found.iter().any(|(kind, _)| *kind == Special::Fold);
        found.extend(self.bifurcation(arc, from, step, folded));
        let after = self.branch.points.len() - 2;
        let along = |station: &Station| -> f64 {
            let steps = station.place.iter().zip(&from.place).zip(&from.tangent);
            steps.map(|((x, x0), t)| (x - x0) * t).sum()
        };
        found.sort_by(|a, b| along(&a.1).total_cmp(&along(&b.1)));
        for (kind, station) in found {
            // The curve evaluates the place again for its observables.
            if arc.ahead(&station, 0.0).is_ok() {
                let response = self.response(&arc.curve, &station);
                self.branch.special.push(SpecialPoint { kind, after, response });
            }
        }
    }

    /// The period doubling or Neimark-Sacker bifurcation between the last two points, if there is
    /// one. A multiplier that passes +1 belongs to a fold or a branch point, which the continuation
    /// itself locates more exactly than a structure in few modes can.
    fn bifurcation(
        &mut self,
        arc: &mut ArcLength<Problem<'_>>,
        from: &Station,
        step: f64,
        folded: bool,
    ) -> Option<(Special, Station)> {
        let [.., before, after] = &self.branch.points[..] else { return None };
        let counts = (before.unstable_multipliers()?, after.unstable_multipliers()?);
        if counts.0 == counts.1 || (folded && counts.0.abs_diff(counts.1) == 1) {
            return None;
        }
        // The multiplier, in order of size, that passes the unit circle.
        let index = counts.0.min(counts.1);
        let excess = |multipliers: &[faer::c64]| multipliers[index].norm() - 1.0;
        let ends = (excess(before.multipliers.as_ref()?), excess(after.multipliers.as_ref()?));
        let outside = if counts.0 > counts.1 { before } else { after };
        let passing = outside.multipliers.as_ref()?[index];
        if passing.im == 0.0 && passing.re > 0.0 {
            return None;
        }
        let judge = self.judge.as_mut()?;
        let mut crossing = faer::c64::new(0.0, 0.0);
        let station = arc
            .locate(from, step, ends, |curve, at| {
                let frequency = curve.conditions(&at.place).angular_frequency;
                let multipliers = judge.multipliers(curve.balance(), curve.closures(), frequency);
                crossing = multipliers[index];
                excess(&multipliers)
            })
            .ok()?;
        // Two real multipliers only meet the circle at its real points.
        let kind = if crossing.im.abs() > 1e-6 {
            Special::NeimarkSacker
        } else if crossing.re < 0.0 {
            Special::PeriodDoubling
        } else {
            return None;
        };
        Some((kind, station))
    }

    /// Lands on the end of the range from the last step that crosses it.
    pub(crate) fn finish(
        mut self,
        arc: &mut ArcLength<Problem<'_>>,
        from: &Station,
        next: &Station,
        end: f64,
    ) -> Branch {
        let last = from.place.len() - 1;
        let share = (end - from.place[last]) / (next.place[last] - from.place[last]);
        let blend = |a: &[f64], b: &[f64]| -> Vec<f64> {
            a.iter().zip(b).map(|(a, b)| a + share * (b - a)).collect()
        };
        let mut guess = blend(&from.place, &next.place);
        guess[last] = end;
        let sense = next.tangent[last].signum();
        match arc.solve_at(&guess, sense) {
            Ok(landed) => {
                let step = landed
                    .place
                    .iter()
                    .zip(&from.place)
                    .zip(&from.tangent)
                    .map(|((x, x0), t)| (x - x0) * t)
                    .sum();
                self.step(arc, from, &landed, step);
                self.ended(BranchEnd::Reached)
            }
            Err(_) => self.ended(BranchEnd::NotConverged),
        }
    }
}
