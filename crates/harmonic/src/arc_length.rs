//! Arc-length continuation of a curve of solutions.

use crate::StepControl;
use crate::balance::Overflow;
use crate::factorization::dot;

/// `size` equations in `size + 1` unknowns of order one, the last of which is the parameter.
pub(crate) trait Curve {
    /// Number of equations.
    fn size(&self) -> usize;

    /// True if the tangent may turn at a point, as where friction begins to slip.
    fn has_kinks(&self) -> bool;

    /// Size of the unknowns that the residual is compared with.
    fn weight(&self, v: &[f64]) -> f64;

    /// Evaluates the curve at `v`, which residual and Jacobian then refer to.
    fn evaluate(&mut self, v: &[f64]) -> Result<(), Overflow>;

    /// Writes the residual.
    fn residual(&mut self, v: &[f64], out: &mut [f64]);

    /// Takes the derivatives at `v`, evaluated last, as `size` rows with one of `size + 1` numbers below them; false if
    /// they are singular.
    fn linearise(&mut self, v: &[f64], last: &[f64]) -> bool;

    /// Solves the equations linearised last for a right-hand side, in place, to a relative accuracy; false if the
    /// solution is not found.
    fn solve(&self, x: &mut [f64], accuracy: f64) -> bool;

    /// True if equations are solved by iteration: to linearise them costs little, and the sign of their determinant is not
    /// known.
    fn is_iterative(&self) -> bool;

    /// Sign of the determinant; constant where it is not known.
    fn orientation(&self) -> f64;
}

/// A solution with its unit tangent.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct CurvePoint {
    pub(crate) unknowns: Vec<f64>,
    pub(crate) tangent: Vec<f64>,
    pub(crate) iterations: usize,
    /// Sign of the determinant of the Jacobian with the tangent as last row. It is constant along
    /// a branch, folds included, and changes where another branch crosses.
    pub(crate) orientation: f64,
    /// Second and third derivatives along the branch, of the cubic through this point and the one
    /// before with their tangents; none without a point before, or where the tangent may turn.
    pub(crate) curving: Option<[Vec<f64>; 2]>,
}

impl CurvePoint {
    /// Adds the derivatives of the cubic from the point `before`.
    fn curve_from(&mut self, before: &Self) {
        let s = distance(&self.unknowns, &before.unknowns);
        let places = || {
            let ends = self.unknowns.iter().zip(&before.unknowns);
            let slopes = self.tangent.iter().zip(&before.tangent);
            ends.zip(slopes).map(|((x, x0), (t, t0))| ((x - x0) / s, t0, t))
        };
        let second = places().map(|(mean, t0, t)| (2.0 * t0 + 4.0 * t - 6.0 * mean) / s).collect();
        let third = places().map(|(mean, t0, t)| 6.0 * (t0 + t - 2.0 * mean) / (s * s)).collect();
        self.curving = Some([second, third]);
    }
}

/// Failure of Newton's method.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum CorrectorFailure {
    /// No convergence; the relative residual left.
    Stalled(f64),
    /// A law gave no finite force.
    Overflow(Overflow),
}

/// The equation that completes the system to a square one.
#[derive(Debug, Clone, Copy)]
enum Constraint<'p> {
    /// The plane through a point, normal to a tangent.
    Normal { through: &'p [f64], tangent: &'p [f64] },
    /// A fixed parameter; the tangent keeps its sense of this one.
    Parameter { value: f64, sense: f64 },
}

/// Relative residual at which an iteration has converged, and the one accepted where rounding
/// stops it before.
const CONVERGED: f64 = 1e-13;
const STALLED: f64 = 1e-10;

/// Relative accuracy of a step of Newton's method and of a tangent, for a curve that solves by iteration.
const STEP_ACCURACY: f64 = 1e-5;
const TANGENT_ACCURACY: f64 = 1e-10;

/// Relative residual of a point whose Jacobian serves for the tangent at the solution next to it.
const CLOSE: f64 = 1e-7;

/// Step below which a turn of the tangent is that of a kink, for a curve that may have some.
const KINK: f64 = 1e-4;

/// Step below which a change of orientation is a branch that crosses.
const CROSSING: f64 = 1e-3;

/// Lengths tried to pass a corner, and iterations for the direction beyond it.
const CORNER_STEPS: [f64; 6] = [3e-6, 1e-5, 3e-5, 1e-4, 3e-4, 1e-3];
const CORNER_DIRECTIONS: usize = 6;

/// Distance within which two corners are one.
const SAME_CORNER: f64 = 1e-6;

/// Angle between chord and mean tangent, over the turn of a step that is aimed at, beyond which a point lies on
/// another part of the curve.
const BESIDE: f64 = 0.5;

/// Newton iterations at most.
const ITERATIONS: usize = 12;

/// Iterations aimed at in a step.
const WANTED: f64 = 4.0;

/// Bisections at most to locate a special point on a step; fewer are needed for all bits.
const LOCATING: usize = 60;

/// Predictor, corrector and step length; all memory is allocated once.
#[derive(Debug)]
pub(crate) struct ArcLength<C> {
    pub(crate) curve: C,
    pub(crate) control: StepControl,
    residual: Vec<f64>,
    predicted: Vec<f64>,
    step: f64,
    /// Points at which a corner was passed.
    corners: Vec<Vec<f64>>,
}

impl<C: Curve> ArcLength<C> {
    pub(crate) fn new(curve: C, control: StepControl) -> Self {
        let size = curve.size();
        Self {
            curve,
            control,
            residual: vec![0.0; size + 1],
            predicted: vec![0.0; size + 1],
            step: control.first,
            corners: Vec::new(),
        }
    }

    /// The solution at the parameter of `guess`, its tangent in the `sense` (1 or -1) of the
    /// parameter.
    pub(crate) fn solve_at(
        &mut self,
        guess: &[f64],
        sense: f64,
    ) -> Result<CurvePoint, CorrectorFailure> {
        let mut unknowns = guess.to_vec();
        let mut tangent = vec![0.0; guess.len()];
        let value = guess[guess.len() - 1];
        let constraint = Constraint::Parameter { value, sense };
        let iterations = self.correct(&mut unknowns, constraint, &mut tangent)?;
        // With the parameter's unit row in place of a tangent t the determinant is its own times
        // `sense / |t|^2`.
        let orientation = sense * self.curve.orientation();
        Ok(CurvePoint { unknowns, tangent, iterations, orientation, curving: None })
    }

    /// The solution a length `s` ahead of a point, in the plane normal to its tangent; sought from
    /// the cubic through the last two points.
    pub(crate) fn ahead(
        &mut self,
        from: &CurvePoint,
        s: f64,
    ) -> Result<CurvePoint, CorrectorFailure> {
        for ((p, x), t) in self.predicted.iter_mut().zip(&from.unknowns).zip(&from.tangent) {
            *p = x + s * t;
        }
        let through = std::mem::take(&mut self.predicted);
        let mut unknowns = through.clone();
        if let Some([second, third]) = &from.curving {
            for ((x, a), b) in unknowns.iter_mut().zip(second).zip(third) {
                *x += s * s * (0.5 * a + s * b / 6.0);
            }
        }
        let mut tangent = vec![0.0; unknowns.len()];
        let constraint = Constraint::Normal { through: &through, tangent: &from.tangent };
        let solved = self.correct(&mut unknowns, constraint, &mut tangent);
        self.predicted = through;
        let orientation = self.curve.orientation();
        Ok(CurvePoint { unknowns, tangent, iterations: solved?, orientation, curving: None })
    }

    /// The next point along the curve, and the length of the step to it; the step is adapted to
    /// the turn of the tangent and the iterations.
    pub(crate) fn advance(
        &mut self,
        from: &CurvePoint,
    ) -> Result<(CurvePoint, f64), CorrectorFailure> {
        loop {
            let step = self.step;
            let failure = match self.ahead(from, step) {
                Ok(mut next) => {
                    let turn = dot(&next.tangent, &from.tangent).clamp(-1.0, 1.0).acos();
                    let off = distance(&next.unknowns, &from.unknowns);
                    // The corrector moves across the tangent, and could reach another branch: one
                    // beside this branch in the opposite sense, where it has turned back sharply. A
                    // branch that crosses, which changes the orientation too, is met at any step.
                    let kink = step < KINK && self.curve.has_kinks();
                    let smooth = turn <= 3.0 * self.control.turn || kink;
                    let reverses = next.orientation != from.orientation;
                    let crosses = step < CROSSING && off < 1.001 * step;
                    let is_beside = !kink && chord_angle(from, &next) > BESIDE * self.control.turn;
                    if smooth && !is_beside && off < 1.5 * step && (!reverses || crosses) {
                        let by_turn = self.control.turn / turn.max(1e-3 * self.control.turn);
                        let by_iterations = WANTED / next.iterations.max(1) as f64;
                        let factor = by_turn.min(by_iterations).clamp(0.5, 2.0);
                        self.step = (step * factor).min(self.control.longest);
                        if !self.curve.has_kinks() {
                            next.curve_from(from);
                        }
                        return Ok((next, step));
                    }
                    CorrectorFailure::Stalled(0.0)
                }
                Err(failure) => failure,
            };
            self.step = 0.5 * step;
            if self.step < self.control.shortest {
                // From a corner that is met again the curve leads back to it.
                let near = |corner: &Vec<f64>| distance(corner, &from.unknowns) < SAME_CORNER;
                let is_new = !self.corners.iter().any(near);
                self.corners.push(from.unknowns.clone());
                for length in CORNER_STEPS.into_iter().filter(|_| is_new) {
                    if let Some(next) = self.around_corner(from, length) {
                        self.step = length;
                        return Ok((next, length));
                    }
                }
                self.step = self.control.first;
                return Err(failure);
            }
        }
    }

    /// The next point beyond a corner, a turn of the tangent on a length much shorter than `s`; none if it is not
    /// found.
    ///
    /// The direction of the curve beyond the corner is the tangent of the Jacobian evaluated ahead, in the sense that
    /// keeps the orientation.
    fn around_corner(&mut self, from: &CurvePoint, s: f64) -> Option<CurvePoint> {
        let mut direction = from.tangent.clone();
        let mut at = from.unknowns.clone();
        for _ in 0..CORNER_DIRECTIONS {
            for ((x, x0), t) in at.iter_mut().zip(&from.unknowns).zip(&direction) {
                *x = x0 + s * t;
            }
            self.curve.evaluate(&at).ok()?;
            if !self.curve.linearise(&at, &direction) {
                return None;
            }
            let constraint = Constraint::Normal { through: &from.unknowns, tangent: &from.tangent };
            self.tangent(constraint, &mut direction, 0, 0.0).ok()?;
            if self.curve.orientation() != from.orientation {
                for t in &mut direction {
                    *t = -*t;
                }
            }
        }
        let ahead = CurvePoint { tangent: direction, curving: None, ..from.clone() };
        let next = self.ahead(&ahead, s).ok()?;
        let turn = dot(&next.tangent, &ahead.tangent).clamp(-1.0, 1.0).acos();
        let lies_ahead = distance(&next.unknowns, &from.unknowns) < 1.5 * s;
        let follows = turn <= 3.0 * self.control.turn && next.orientation == from.orientation;
        (lies_ahead && follows).then_some(next)
    }

    /// Zero, on a step of length `s`, of a function of the point with different signs at its ends:
    /// bisection mixed with the Illinois rule.
    pub(crate) fn locate(
        &mut self,
        from: &CurvePoint,
        s: f64,
        (low, high): (f64, f64),
        mut value: impl FnMut(&mut C, &CurvePoint) -> f64,
    ) -> Result<CurvePoint, CorrectorFailure> {
        let (mut a, mut b) = ((0.0, low), (s, high));
        let (mut best, mut kept_end) = (None, 0);
        for count in 0..LOCATING {
            let secant = (a.0 * b.1 - b.0 * a.1) / (b.1 - a.1);
            let inside = secant > a.0 && secant < b.0;
            let at = if inside && count % 4 != 3 { secant } else { 0.5 * (a.0 + b.0) };
            let point = self.ahead(from, at)?;
            let found = value(&mut self.curve, &point);
            best = Some(point);
            if found.abs() <= 1e-13 * low.abs().max(high.abs()) {
                break;
            }
            if (found > 0.0) == (a.1 > 0.0) {
                a = (at, found);
                b.1 *= if kept_end == 1 { 0.5 } else { 1.0 };
                kept_end = 1;
            } else {
                b = (at, found);
                a.1 *= if kept_end == -1 { 0.5 } else { 1.0 };
                kept_end = -1;
            }
            if b.0 - a.0 <= 1e-13 * s {
                break;
            }
        }
        best.ok_or(CorrectorFailure::Stalled(0.0))
    }

    /// Newton's method; writes the tangent at the solution.
    fn correct(
        &mut self,
        unknowns: &mut [f64],
        constraint: Constraint<'_>,
        tangent: &mut [f64],
    ) -> Result<usize, CorrectorFailure> {
        let size = self.curve.size();
        let mut last = f64::INFINITY;
        let mut unit = vec![0.0; size + 1];
        unit[size] = 1.0;
        if let Constraint::Parameter { value, .. } = constraint {
            unknowns[size] = value;
        }
        for iteration in 0..=ITERATIONS {
            self.curve.evaluate(unknowns).map_err(CorrectorFailure::Overflow)?;
            self.curve.residual(unknowns, &mut self.residual[..size]);
            let largest = self.residual[..size].iter().fold(0.0_f64, |a, r| a.max(r.abs()));
            let norm = largest / self.curve.weight(unknowns);
            let converged = norm <= CONVERGED || (norm <= STALLED && norm > 0.25 * last);
            if !converged && (iteration == ITERATIONS || norm.is_nan() || norm > 1e6) {
                return Err(CorrectorFailure::Stalled(norm));
            }
            let close = converged && last <= CLOSE && !self.curve.is_iterative();
            last = norm;
            if close {
                return self.tangent(constraint, tangent, iteration, norm);
            }
            let row = match constraint {
                Constraint::Normal { tangent, .. } => tangent,
                Constraint::Parameter { .. } => &unit[..],
            };
            if !self.curve.linearise(unknowns, row) {
                return Err(CorrectorFailure::Stalled(norm));
            }
            if converged {
                return self.tangent(constraint, tangent, iteration, norm);
            }
            self.residual[size] = match constraint {
                Constraint::Normal { through, tangent } => {
                    let steps = tangent.iter().zip(unknowns.iter().zip(through));
                    steps.map(|(t, (x, p))| t * (x - p)).sum()
                }
                Constraint::Parameter { .. } => 0.0,
            };
            if !self.curve.solve(&mut self.residual, STEP_ACCURACY) {
                return Err(CorrectorFailure::Stalled(norm));
            }
            for (x, dx) in unknowns.iter_mut().zip(&self.residual) {
                *x -= dx;
            }
        }
        Err(CorrectorFailure::Stalled(last))
    }

    /// Writes the unit tangent from the factors of the Jacobian; the iterations if it is finite, else
    /// the residual.
    fn tangent(
        &self,
        constraint: Constraint<'_>,
        tangent: &mut [f64],
        iterations: usize,
        residual: f64,
    ) -> Result<usize, CorrectorFailure> {
        tangent.fill(0.0);
        tangent[self.curve.size()] = match constraint {
            Constraint::Normal { .. } => 1.0,
            Constraint::Parameter { sense, .. } => sense,
        };
        if !self.curve.solve(tangent, TANGENT_ACCURACY) {
            return Err(CorrectorFailure::Stalled(residual));
        }
        let length = dot(tangent, tangent).sqrt();
        for t in tangent.iter_mut() {
            *t /= length;
        }
        if length.is_finite() { Ok(iterations) } else { Err(CorrectorFailure::Stalled(residual)) }
    }
}

/// Angle \[rad\] between the chord to the next point and the mean of both tangents: of third order in the step on
/// a smooth curve, and the distance over the step to another part of it beside this one.
fn chord_angle(from: &CurvePoint, next: &CurvePoint) -> f64 {
    let ends = next.unknowns.iter().zip(&from.unknowns).zip(next.tangent.iter().zip(&from.tangent));
    let [mut product, mut chord, mut mean] = [0.0; 3];
    for ((b, a), (t, s)) in ends {
        product += (b - a) * (s + t);
        chord += (b - a).powi(2);
        mean += (s + t).powi(2);
    }
    (product / (chord * mean).sqrt()).clamp(-1.0, 1.0).acos()
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::factorization::Factorization;

    /// A curve in x and l by its equation and the derivatives with respect to both.
    struct PlaneCurve {
        equation: fn(f64, f64) -> f64,
        derivatives: fn(f64, f64) -> [f64; 2],
        factors: Factorization,
    }

    impl PlaneCurve {
        fn new(equation: fn(f64, f64) -> f64, derivatives: fn(f64, f64) -> [f64; 2]) -> Self {
            Self { equation, derivatives, factors: Factorization::new(2) }
        }
    }

    impl Curve for PlaneCurve {
        fn size(&self) -> usize {
            1
        }
        fn has_kinks(&self) -> bool {
            false
        }
        fn weight(&self, _: &[f64]) -> f64 {
            1.0
        }
        fn evaluate(&mut self, _: &[f64]) -> Result<(), Overflow> {
            Ok(())
        }
        fn residual(&mut self, v: &[f64], out: &mut [f64]) {
            out[0] = (self.equation)(v[0], v[1]);
        }
        fn linearise(&mut self, v: &[f64], last: &[f64]) -> bool {
            let rows = self.factors.matrix();
            rows[..2].copy_from_slice(&(self.derivatives)(v[0], v[1]));
            rows[2..].copy_from_slice(last);
            self.factors.factorize()
        }
        fn solve(&self, x: &mut [f64], _: f64) -> bool {
            self.factors.solve(x);
            true
        }
        fn is_iterative(&self) -> bool {
            false
        }
        fn orientation(&self) -> f64 {
            self.factors.determinant_sign()
        }
    }

    /// The circle x^2 + l^2 = 1, whose folds are at l = -1 and 1.
    #[test]
    fn a_circle_is_followed_around_and_its_folds_located() {
        let circle = PlaneCurve::new(|x, l| x * x + l * l - 1.0, |x, l| [2.0 * x, 2.0 * l]);
        let mut arc = ArcLength::new(circle, StepControl::default());
        let mut point = arc.solve_at(&[0.9, 0.0], 1.0).unwrap();
        assert!((point.unknowns[0] - 1.0).abs() < 1e-12);
        let (mut folds, mut length) = (Vec::new(), 0.0);
        while length < 2.0 * std::f64::consts::PI {
            let (next, step) = arc.advance(&point).unwrap();
            let ends = (point.tangent[1], next.tangent[1]);
            if ends.0 * ends.1 < 0.0 {
                let fold = arc.locate(&point, step, ends, |_, at| at.tangent[1]).unwrap();
                folds.push(fold.unknowns[1]);
            }
            length += distance(&next.unknowns, &point.unknowns);
            point = next;
        }
        assert_eq!(folds.len(), 2);
        // Quadratic at a fold: half the digits of the tangent would do.
        assert!((folds[0] - 1.0).abs() < 1e-12 && (folds[1] + 1.0).abs() < 1e-12);
    }

    /// `l = x` below zero, `l = x - 2/3 b x^(3/2)` above, as where a contact begins to open: the tangent turns by more
    /// than a right angle on a length of `1 / b^2`, below the shortest step.
    #[test]
    fn a_corner_shorter_than_any_step_is_passed() {
        const B: f64 = 1e5;
        let grazing = || {
            PlaneCurve::new(
                |x, l| x - l - 2.0 / 3.0 * B * x.max(0.0).powf(1.5),
                |x, _| [1.0 - B * x.max(0.0).sqrt(), -1.0],
            )
        };
        for start in [-0.3, -0.31, -0.3123] {
            let mut arc = ArcLength::new(grazing(), StepControl::default());
            let mut point = arc.solve_at(&[start, start], 1.0).unwrap();
            let orientation = point.orientation;
            let (mut before, mut most, mut count) = (0, f64::NEG_INFINITY, 0);
            while point.unknowns[0] < 0.0 || point.unknowns[1] > -0.5 {
                let [x, l] = point.unknowns[..] else { panic!() };
                assert!((x - l - 2.0 / 3.0 * B * x.max(0.0).powf(1.5)).abs() < 1e-9);
                before += usize::from(x < 0.0);
                most = most.max(l);
                count += 1;
                assert!(count < 200, "{start}: {x} {l}");
                point = arc.advance(&point).unwrap().0;
                assert_eq!(point.orientation, orientation);
            }
            // The corner is at zero; the last point before it is within a step of 1e-3.
            assert!(before > 3 && most > -1e-3, "{start}: {before} {most}");
        }
    }

    /// `x = 0.015 tanh(l / 0.01)`: a step of the curve that a step of the continuation could miss.
    #[test]
    fn a_step_does_not_pass_over_what_lies_between() {
        for start in [-0.5, -0.52, -0.54, -0.56, -0.58] {
            let edge = PlaneCurve::new(
                |x, l| x - 0.015 * (l / 0.01).tanh(),
                |_, l| [1.0, -1.5 / (l / 0.01).cosh().powi(2)],
            );
            let mut arc = ArcLength::new(edge, StepControl::default());
            let mut point = arc.solve_at(&[0.0, start], 1.0).unwrap();
            let mut inside = 0;
            while point.unknowns[1] < 0.2 {
                point = arc.advance(&point).unwrap().0;
                inside += usize::from(point.unknowns[1].abs() < 0.01);
            }
            assert!(inside > 3, "{start}: {inside} points");
        }
    }
}
