//! Points of a branch as it is followed, with location of its special points.

use std::f64::consts::TAU;

use num_complex::Complex64;

use crate::arc_length::{ArcLength, CorrectorFailure, CurvePoint};
use crate::continuation_problem::ContinuationProblem;
use crate::floquet::FloquetSolver;
use crate::{Branch, ContactSystem, PeriodicResponse, SpecialPoint, SpecialPointKind, Termination};

/// A branch under construction.
///
/// Stability is analysed when the branch has ended: branches that too few harmonics describe are
/// abandoned before.
pub(crate) struct BranchRecorder<'a> {
    floquet: Option<FloquetSolver<'a>>,
    pub(crate) branch: Branch,
    /// Slope of the amplitude along the branch at the last point.
    slope: f64,
    /// Points with the lengths of the steps from them, for the location of bifurcations.
    steps: Vec<(CurvePoint, f64)>,
    /// Distance of each special point from the point before it.
    distances: Vec<f64>,
}

/// Phases at which a closure beyond a law is looked for.
const PHASES: u32 = 4096;

pub(crate) type Arc<'a> = ArcLength<ContinuationProblem<'a>>;

impl<'a> BranchRecorder<'a> {
    pub(crate) fn new(
        floquet: Option<FloquetSolver<'a>>,
        harmonics: usize,
        samples: usize,
    ) -> Self {
        let termination = Termination::NotConverged;
        let branch = Branch {
            points: Vec::new(),
            special: Vec::new(),
            termination,
            harmonics,
            samples,
            finer: None,
        };
        Self { floquet, branch, slope: 0.0, steps: Vec::new(), distances: Vec::new() }
    }

    /// The branch with its stability.
    pub(crate) fn ended(mut self, arc: &mut Arc<'_>, progress: &dyn Fn()) -> Branch {
        if let Some(mut floquet) = self.floquet.take() {
            self.analyse(arc, &mut floquet, progress);
        }
        self.branch
    }

    /// Leaves out the analysis of stability.
    pub(crate) fn without_stability(&mut self) {
        self.floquet = None;
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

    /// Takes back the last point if its closure exceeds the limit of a law between the places at which its force was
    /// evaluated, and gives the termination.
    pub(crate) fn beyond_law(&mut self, system: &ContactSystem) -> Option<Termination> {
        let last = self.branch.points.last()?;
        let interface = last.pressures.iter().position(|range| !range.highest.is_finite())?;
        let phases = (0..PHASES).map(|n| TAU * f64::from(n) / f64::from(PHASES));
        let closures = phases.map(|phase| last.closure_at(interface, phase)[0]);
        let closure = closures.fold(f64::NEG_INFINITY, f64::max);
        self.branch.points.pop();
        let after = self.branch.points.len();
        self.branch.special.retain(|special| special.after + 1 < after);
        self.distances.truncate(self.branch.special.len());
        let interface = system.contacts()[interface].name().to_owned();
        Some(Termination::BeyondLaw { interface, closure })
    }

    /// The response at a point, which the curve evaluated last.
    fn response(curve: &ContinuationProblem<'_>, point: &CurvePoint) -> PeriodicResponse {
        let at = curve.conditions(&point.unknowns);
        PeriodicResponse::of(curve.balance(), curve.closures(), &at, point.iterations)
    }

    pub(crate) fn record(&mut self, arc: &mut Arc<'_>, point: &CurvePoint) {
        self.slope = arc.curve.amplitude_slope(&point.unknowns, &point.tangent);
        self.branch.points.push(Self::response(&arc.curve, point));
    }

    /// Records the next point and the special points on the step to it.
    pub(crate) fn step(
        &mut self,
        arc: &mut Arc<'_>,
        from: &CurvePoint,
        next: &CurvePoint,
        step: f64,
    ) {
        let before = self.slope;
        self.record(arc, next);
        if self.floquet.is_some() {
            self.steps.push((from.clone(), step));
        }
        let last = from.unknowns.len() - 1;
        let turns = (from.tangent[last], next.tangent[last]);
        let mut found = Vec::new();
        // Between the ends of a step around a corner nothing is found: it counts as at the first.
        if turns.0 * turns.1 < 0.0 {
            let fold = arc.locate(from, step, turns, |_, at| at.tangent[last]);
            found.push((SpecialPointKind::Fold, fold.unwrap_or_else(|_| from.clone())));
        }
        let slopes = (before, self.slope);
        if slopes.0 > 0.0 && slopes.1 <= 0.0 {
            let slope = |curve: &mut ContinuationProblem<'_>, at: &CurvePoint| {
                curve.amplitude_slope(&at.unknowns, &at.tangent)
            };
            let peak = arc.locate(from, step, slopes, slope);
            found.push((SpecialPointKind::Peak, peak.unwrap_or_else(|_| from.clone())));
        }
        let orientations = (from.orientation, next.orientation);
        if orientations.0 != orientations.1
            && let Ok(crossing) = arc.locate(from, step, orientations, |_, at| at.orientation)
        {
            found.push((SpecialPointKind::BranchPoint, crossing));
        }
        let after = self.branch.points.len() - 2;
        found.sort_by(|a, b| along(from, &a.1).total_cmp(&along(from, &b.1)));
        for (kind, point) in found {
            self.add_special(arc, kind, after, from, &point);
        }
    }

    fn add_special(
        &mut self,
        arc: &mut Arc<'_>,
        kind: SpecialPointKind,
        after: usize,
        from: &CurvePoint,
        point: &CurvePoint,
    ) {
        // The curve is evaluated there again for the observables.
        if arc.ahead(point, 0.0).is_ok() {
            let response = Self::response(&arc.curve, point);
            self.distances.push(along(from, point));
            self.branch.special.push(SpecialPoint { kind, after, response });
        }
    }

    /// Adds multipliers to all points, and the bifurcations that they show.
    fn analyse(&mut self, arc: &mut Arc<'_>, floquet: &mut FloquetSolver<'_>, progress: &dyn Fn()) {
        for point in &mut self.branch.points {
            progress();
            point.multipliers = floquet.multipliers(&point.closures, point.angular_frequency);
        }
        for (after, (from, step)) in std::mem::take(&mut self.steps).into_iter().enumerate() {
            progress();
            if let Some((kind, point)) = self.bifurcation(arc, floquet, (after, &from, step)) {
                self.add_special(arc, kind, after, &from, &point);
            }
        }
        for special in &mut self.branch.special {
            let at = &mut special.response;
            at.multipliers = floquet.multipliers(&at.closures, at.angular_frequency);
        }
        let mut special: Vec<_> =
            std::mem::take(&mut self.branch.special).into_iter().zip(&self.distances).collect();
        special.sort_by(|(a, x), (b, y)| a.after.cmp(&b.after).then(x.total_cmp(y)));
        self.branch.special = special.into_iter().map(|(special, _)| special).collect();
    }

    /// The period doubling or Neimark-Sacker bifurcation at which the response becomes stable or unstable on the step
    /// that follows a point, if there is one. A multiplier that passes +1 belongs to a fold or a branch point, which the continuation
    /// locates more exactly than a structure in few modes can.
    fn bifurcation(
        &self,
        arc: &mut Arc<'_>,
        floquet: &mut FloquetSolver<'_>,
        (number, from, step): (usize, &CurvePoint, f64),
    ) -> Option<(SpecialPointKind, CurvePoint)> {
        let (before, after) =
            (self.branch.points.get(number)?, self.branch.points.get(number + 1)?);
        let is_fold = |special: &SpecialPoint| {
            special.after == number && special.kind == SpecialPointKind::Fold
        };
        let folded = self.branch.special.iter().any(is_fold);
        let counts = (before.unstable_multipliers()?, after.unstable_multipliers()?);
        if (counts.0 == 0) == (counts.1 == 0) || (folded && counts.0.abs_diff(counts.1) == 1) {
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
        let mut crossing = Complex64::new(0.0, 0.0);
        let point = arc
            .locate(from, step, ends, |curve, at| {
                let frequency = curve.conditions(&at.unknowns).angular_frequency;
                let multipliers = floquet.multipliers(curve.closures(), frequency);
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
        &mut self,
        arc: &mut Arc<'_>,
        from: &CurvePoint,
        next: &CurvePoint,
        end: f64,
    ) -> Termination {
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
                Termination::Reached
            }
            Err(_) => Termination::NotConverged,
        }
    }
}

/// Distance to a point along the tangent of `from`.
fn along(from: &CurvePoint, point: &CurvePoint) -> f64 {
    let steps = point.unknowns.iter().zip(&from.unknowns).zip(&from.tangent);
    steps.map(|((x, x0), t)| (x - x0) * t).sum()
}
