//! Following a curve of solutions by its arc length.

use crate::StepControl;
use crate::balance::Overflow;
use crate::factorization::Factorization;

/// `size` equations in `size + 1` unknowns of order one, the last of which is the parameter.
pub(crate) trait Curve {
    /// Number of equations.
    fn size(&self) -> usize;

    /// Size of the unknowns that the residual is compared with.
    fn weight(&self, v: &[f64]) -> f64;

    /// Takes up a place, which residual and Jacobian then refer to.
    fn evaluate(&mut self, v: &[f64]) -> Result<(), Overflow>;

    /// Writes the residual.
    fn residual(&mut self, v: &[f64], out: &mut [f64]);

    /// Writes `size` rows of `size + 1` derivatives; `column` is scratch of `size` values.
    fn jacobian(&mut self, v: &[f64], column: &mut [f64], out: &mut [f64]);
}

/// A solution with its unit tangent.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Station {
    pub(crate) place: Vec<f64>,
    pub(crate) tangent: Vec<f64>,
    pub(crate) iterations: usize,
    /// Sign of the determinant of the Jacobian with the tangent as last row. It is constant along
    /// a branch, folds included, and changes where another branch crosses.
    pub(crate) orientation: f64,
}

/// Why Newton's method found no solution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Failure {
    /// It did not converge, and left this relative residual.
    Stalled(f64),
    /// A law gave no finite force.
    Overflow(Overflow),
}

/// What completes the equations to a square system.
#[derive(Debug, Clone, Copy)]
enum Plane<'p> {
    /// The plane through a place, normal to a tangent.
    Normal { through: &'p [f64], tangent: &'p [f64] },
    /// A fixed parameter; the tangent keeps its sense of this one.
    Parameter { value: f64, sense: f64 },
}

/// Relative residual at which an iteration has converged, and the one accepted where rounding
/// stops it before.
const CONVERGED: f64 = 1e-13;
const STALLED: f64 = 1e-8;

/// Newton iterations at most.
const ITERATIONS: usize = 12;

/// Iterations that a step is meant to take.
const WANTED: f64 = 4.0;

/// Bisections at most to locate a place on a step; fewer are needed for all bits.
const LOCATING: usize = 60;

/// Predictor, corrector and step length; all memory is allocated once.
#[derive(Debug)]
pub(crate) struct ArcLength<C> {
    pub(crate) curve: C,
    control: StepControl,
    factors: Factorization,
    residual: Vec<f64>,
    column: Vec<f64>,
    predicted: Vec<f64>,
    step: f64,
}

impl<C: Curve> ArcLength<C> {
    pub(crate) fn new(curve: C, control: StepControl) -> Self {
        let size = curve.size();
        Self {
            curve,
            control,
            factors: Factorization::new(size + 1),
            residual: vec![0.0; size + 1],
            column: vec![0.0; size],
            predicted: vec![0.0; size + 1],
            step: control.first,
        }
    }

    /// The solution at the parameter of `guess`, its tangent in the `sense` (1 or -1) of the
    /// parameter.
    pub(crate) fn solve_at(&mut self, guess: &[f64], sense: f64) -> Result<Station, Failure> {
        let mut place = guess.to_vec();
        let mut tangent = vec![0.0; guess.len()];
        let value = guess[guess.len() - 1];
        let plane = Plane::Parameter { value, sense };
        let iterations = self.correct(&mut place, plane, &mut tangent)?;
        // With the parameter's unit row in place of a tangent t the determinant is its own times
        // `sense / |t|^2`.
        let orientation = sense * self.factors.determinant_sign();
        Ok(Station { place, tangent, iterations, orientation })
    }

    /// The solution a length `s` ahead of a station, in the plane normal to its tangent.
    pub(crate) fn ahead(&mut self, from: &Station, s: f64) -> Result<Station, Failure> {
        for ((p, x), t) in self.predicted.iter_mut().zip(&from.place).zip(&from.tangent) {
            *p = x + s * t;
        }
        let through = std::mem::take(&mut self.predicted);
        let mut place = through.clone();
        let mut tangent = vec![0.0; place.len()];
        let plane = Plane::Normal { through: &through, tangent: &from.tangent };
        let solved = self.correct(&mut place, plane, &mut tangent);
        self.predicted = through;
        let orientation = self.factors.determinant_sign();
        Ok(Station { place, tangent, iterations: solved?, orientation })
    }

    /// The next station along the curve, and the length of the step to it; the step is adapted to
    /// the turn of the tangent and the iterations.
    pub(crate) fn advance(&mut self, from: &Station) -> Result<(Station, f64), Failure> {
        loop {
            let step = self.step;
            let failure = match self.ahead(from, step) {
                Ok(next) => {
                    let turn = dot(&next.tangent, &from.tangent).clamp(-1.0, 1.0).acos();
                    let off = distance(&next.place, &from.place);
                    // The corrector moves across the tangent; it must not reach another branch.
                    if turn <= 3.0 * self.control.turn && off < 1.5 * step {
                        let by_turn = self.control.turn / turn.max(1e-3 * self.control.turn);
                        let by_iterations = WANTED / next.iterations.max(1) as f64;
                        let factor = by_turn.min(by_iterations).clamp(0.5, 2.0);
                        self.step = (step * factor).min(self.control.longest);
                        return Ok((next, step));
                    }
                    Failure::Stalled(0.0)
                }
                Err(failure) => failure,
            };
            self.step = 0.5 * step;
            if self.step < self.control.shortest {
                self.step = self.control.first;
                return Err(failure);
            }
        }
    }

    /// Where on a step of length `s` a function of the station, of different signs at its ends,
    /// is zero: bisection mixed with the Illinois rule.
    pub(crate) fn locate(
        &mut self,
        from: &Station,
        s: f64,
        (low, high): (f64, f64),
        mut value: impl FnMut(&mut C, &Station) -> f64,
    ) -> Result<Station, Failure> {
        let (mut a, mut b) = ((0.0, low), (s, high));
        let (mut best, mut kept_end) = (None, 0);
        for count in 0..LOCATING {
            let secant = (a.0 * b.1 - b.0 * a.1) / (b.1 - a.1);
            let inside = secant > a.0 && secant < b.0;
            let at = if inside && count % 4 != 3 { secant } else { 0.5 * (a.0 + b.0) };
            let station = self.ahead(from, at)?;
            let found = value(&mut self.curve, &station);
            best = Some(station);
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
        best.ok_or(Failure::Stalled(0.0))
    }

    /// Newton's method; writes the tangent at the solution.
    fn correct(
        &mut self,
        place: &mut [f64],
        plane: Plane<'_>,
        tangent: &mut [f64],
    ) -> Result<usize, Failure> {
        let size = self.curve.size();
        let mut last = f64::INFINITY;
        if let Plane::Parameter { value, .. } = plane {
            place[size] = value;
        }
        for iteration in 0..=ITERATIONS {
            self.curve.evaluate(place).map_err(Failure::Overflow)?;
            self.curve.residual(place, &mut self.residual[..size]);
            let largest = self.residual[..size].iter().fold(0.0_f64, |a, r| a.max(r.abs()));
            let norm = largest / self.curve.weight(place);
            let converged = norm <= CONVERGED || (norm <= STALLED && norm > 0.25 * last);
            if !converged && (iteration == ITERATIONS || norm.is_nan() || norm > 1e6) {
                return Err(Failure::Stalled(norm));
            }
            last = norm;
            self.curve.jacobian(place, &mut self.column, self.factors.matrix());
            let row = &mut self.factors.matrix()[size * (size + 1)..];
            self.residual[size] = match plane {
                Plane::Normal { through, tangent } => {
                    row.copy_from_slice(tangent);
                    tangent
                        .iter()
                        .zip(place.iter().zip(through))
                        .map(|(t, (x, p))| t * (x - p))
                        .sum()
                }
                Plane::Parameter { .. } => {
                    row.fill(0.0);
                    row[size] = 1.0;
                    0.0
                }
            };
            if !self.factors.factorize() {
                return Err(Failure::Stalled(norm));
            }
            if converged {
                tangent.fill(0.0);
                tangent[size] = match plane {
                    Plane::Normal { .. } => 1.0,
                    Plane::Parameter { sense, .. } => sense,
                };
                self.factors.solve(tangent);
                let length = dot(tangent, tangent).sqrt();
                for t in tangent.iter_mut() {
                    *t /= length;
                }
                return if length.is_finite() {
                    Ok(iteration)
                } else {
                    Err(Failure::Stalled(norm))
                };
            }
            self.factors.solve(&mut self.residual);
            for (x, dx) in place.iter_mut().zip(&self.residual) {
                *x -= dx;
            }
        }
        Err(Failure::Stalled(last))
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The circle x^2 + l^2 = 1, whose folds are at l = -1 and 1.
    struct Circle;

    impl Curve for Circle {
        fn size(&self) -> usize {
            1
        }
        fn weight(&self, _: &[f64]) -> f64 {
            1.0
        }
        fn evaluate(&mut self, _: &[f64]) -> Result<(), Overflow> {
            Ok(())
        }
        fn residual(&mut self, v: &[f64], out: &mut [f64]) {
            out[0] = v[0] * v[0] + v[1] * v[1] - 1.0;
        }
        fn jacobian(&mut self, v: &[f64], _: &mut [f64], out: &mut [f64]) {
            out[..2].copy_from_slice(&[2.0 * v[0], 2.0 * v[1]]);
        }
    }

    #[test]
    fn a_circle_is_followed_around_and_its_folds_located() {
        let mut arc = ArcLength::new(Circle, StepControl::default());
        let mut station = arc.solve_at(&[0.9, 0.0], 1.0).unwrap();
        assert!((station.place[0] - 1.0).abs() < 1e-12);
        let (mut folds, mut length) = (Vec::new(), 0.0);
        while length < 2.0 * std::f64::consts::PI {
            let (next, step) = arc.advance(&station).unwrap();
            let ends = (station.tangent[1], next.tangent[1]);
            if ends.0 * ends.1 < 0.0 {
                let fold = arc.locate(&station, step, ends, |_, at| at.tangent[1]).unwrap();
                folds.push(fold.place[1]);
            }
            length += distance(&next.place, &station.place);
            station = next;
        }
        assert_eq!(folds.len(), 2);
        // Quadratic at a fold: half the digits of the tangent would do.
        assert!((folds[0] - 1.0).abs() < 1e-12 && (folds[1] + 1.0).abs() < 1e-12);
    }
}
