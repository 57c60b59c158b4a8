//! Points of a branch as it is followed, with location of its special points.

use num_complex::Complex64;

use crate::arc_length::{ArcLength, CorrectorFailure, CurvePoint};
use crate::continuation_problem::ContinuationProblem;
use crate::floquet::FloquetSolver;
use crate::{Branch, ContactSystem, PeriodicResponse, SpecialPoint, SpecialPointKind, Termination};

/// A branch under construction.
pub(crate) struct BranchRecorder {
    floquet: Option<FloquetSolver>,
    pub(crate) branch: Branch,
    /// Slope of the amplitude along the branch at the last point.
    slope: f64,
}

impl BranchRecorder {
    pub(crate) fn new(floquet: Option<FloquetSolver>, harmonics: usize, samples: usize) -> Self {
        let termination = Termination::NotConverged;
        let branch =
            Branch { points: Vec::new(), special: Vec::new(), termination, harmonics, samples };
        Self { floquet, branch, slope: 0.0 }
    }

    pub(crate) fn ended(mut self, termination: Termination) -> Branch {
        self.branch.termination = termination;
        self.branch
    }

    pub(crate) fn termination(system: &ContactSystem, failure: CorrectorFailure) -> Termination {
        match failure {
            CorrectorFailure::Stalled(_) => Termination::NotConverged,
            CorrectorFailure::Overflow(overflow) => Termination::BeyondLaw {
                interface: system.contacts()[overflow.interface].name().to_owned(),
                closure: overflow.closure,
            },
        }
    }

    /// The response at a point, which the curve evaluated last.
    fn response(
        &mut self,
        curve: &ContinuationProblem<'_>,
        point: &CurvePoint,
    ) -> PeriodicResponse {
        let at = curve.conditions(&point.unknowns);
        let balance = curve.balance();
        let mut response = PeriodicResponse::of(balance, curve.closures(), &at, point.iterations);
        if let Some(floquet) = &mut self.floquet {
            response.multipliers =
                floquet.multipliers(balance, curve.closures(), at.angular_frequency);
        }
        response
    }

    pub(crate) fn record(
        &mut self,
        arc: &mut ArcLength<ContinuationProblem<'_>>,
        point: &CurvePoint,
    ) {
        self.slope = arc.curve.amplitude_slope(&point.unknowns, &point.tangent);
        let response = self.response(&arc.curve, point);
        self.branch.points.push(response);
    }

    /// Records the next point and the special points on the step to it.
    pub(crate) fn step(
        &mut self,
        arc: &mut ArcLength<ContinuationProblem<'_>>,
        from: &CurvePoint,
        next: &CurvePoint,
        step: f64,
    ) {
        let before = self.slope;
        self.record(arc, next);
        let last = from.unknowns.len() - 1;
        let turns = (from.tangent[last], next.tangent[last]);
        let mut found = Vec::new();
        if turns.0 * turns.1 < 0.0
            && let Ok(fold) = arc.locate(from, step, turns, |_, at| at.tangent[last])
        {
            found.push((SpecialPointKind::Fold, fold));
        }
        let slopes = (before, self.slope);
        if slopes.0 > 0.0
            && slopes.1 <= 0.0
            && let Ok(peak) = arc.locate(from, step, slopes, |curve, at| {
                curve.amplitude_slope(&at.unknowns, &at.tangent)
            })
        {
            found.push((SpecialPointKind::Peak, peak));
        }
        let orientations = (from.orientation, next.orientation);
        if orientations.0 != orientations.1
            && let Ok(crossing) = arc.locate(from, step, orientations, |_, at| at.orientation)
        {
            found.push((SpecialPointKind::BranchPoint, crossing));
        }
        let folded = found.iter().any(|(kind, _)| *kind == SpecialPointKind::Fold);
        found.extend(self.bifurcation(arc, from, step, folded));
        let after = self.branch.points.len() - 2;
        found.sort_by(|a, b| along(from, &a.1).total_cmp(&along(from, &b.1)));
        for (kind, point) in found {
            // The curve is evaluated there again for the observables.
            if arc.ahead(&point, 0.0).is_ok() {
                let response = self.response(&arc.curve, &point);
                self.branch.special.push(SpecialPoint { kind, after, response });
            }
        }
    }

    /// The period doubling or Neimark-Sacker bifurcation between the last two points, if there is
    /// one. A multiplier that passes +1 belongs to a fold or a branch point, which the continuation
    /// locates more exactly than a structure in few modes can.
    fn bifurcation(
        &mut self,
        arc: &mut ArcLength<ContinuationProblem<'_>>,
        from: &CurvePoint,
        step: f64,
        folded: bool,
    ) -> Option<(SpecialPointKind, CurvePoint)> {
        let [.., before, after] = &self.branch.points[..] else { return None };
        let counts = (before.unstable_multipliers()?, after.unstable_multipliers()?);
        if counts.0 == counts.1 || (folded && counts.0.abs_diff(counts.1) == 1) {
            return None;
        }
        // The multiplier, in order of size, that passes the unit circle.
        let index = counts.0.min(counts.1);
        let excess = |multipliers: &[Complex64]| multipliers[index].norm() - 1.0;
        let ends = (excess(before.multipliers.as_ref()?), excess(after.multipliers.as_ref()?));
        let outside = if counts.0 > counts.1 { before } else { after };
        let passing = outside.multipliers.as_ref()?[index];
        if passing.im == 0.0 && passing.re > 0.0 {
            return None;
        }
        let floquet = self.floquet.as_mut()?;
        let mut crossing = Complex64::new(0.0, 0.0);
        let point = arc
            .locate(from, step, ends, |curve, at| {
                let frequency = curve.conditions(&at.unknowns).angular_frequency;
                let multipliers = floquet.multipliers(curve.balance(), curve.closures(), frequency);
                crossing = multipliers
                    .as_ref()
                    .map_or(Complex64::new(f64::NAN, f64::NAN), |found| found[index]);
                crossing.norm() - 1.0
            })
            .ok()?;
        // Two real multipliers meet the circle at its real points only.
        let kind = if crossing.im.abs() > 1e-6 {
            SpecialPointKind::NeimarkSacker
        } else if crossing.re < 0.0 {
            SpecialPointKind::PeriodDoubling
        } else {
            return None;
        };
        Some((kind, point))
    }

    /// Solves at the end of the range, from the last step that crosses it.
    pub(crate) fn finish(
        mut self,
        arc: &mut ArcLength<ContinuationProblem<'_>>,
        from: &CurvePoint,
        next: &CurvePoint,
        end: f64,
    ) -> Branch {
        let last = from.unknowns.len() - 1;
        let share = (end - from.unknowns[last]) / (next.unknowns[last] - from.unknowns[last]);
        let blend = |a: &[f64], b: &[f64]| -> Vec<f64> {
            a.iter().zip(b).map(|(a, b)| a + share * (b - a)).collect()
        };
        let mut guess = blend(&from.unknowns, &next.unknowns);
        guess[last] = end;
        let sense = next.tangent[last].signum();
        match arc.solve_at(&guess, sense) {
            Ok(end_point) => {
                self.step(arc, from, &end_point, along(from, &end_point));
                self.ended(Termination::Reached)
            }
            Err(_) => self.ended(Termination::NotConverged),
        }
    }
}

/// Distance to a point along the tangent of `from`.
fn along(from: &CurvePoint, point: &CurvePoint) -> f64 {
    let steps = point.unknowns.iter().zip(&from.unknowns).zip(&from.tangent);
    steps.map(|((x, x0), t)| (x - x0) * t).sum()
}
