//! A continuation as equations in scaled unknowns.

use std::f64::consts::TAU;

use num_complex::Complex64;

use crate::arc_length::Curve;
use crate::balance::{Balance, Conditions, Overflow};
use crate::factorization::dot;
use crate::linear_response::{LinearSolver, resonance_near};
use crate::linearisation::{Border, Linearisation};
use crate::{ContactSystem, Continuation, HarmonicError};

/// Harmonic balance along a [`Continuation`], in unknowns of order one.
///
/// The unknowns are the closures over a reference `a`, then the frequency and the anti-damping
/// rate over theirs where these are sought, last the parameter. Along a range of frequencies a is
/// the largest linear response and the parameter the frequency over the width of the resonance;
/// along forces and amplitudes a is proportional to them, and the parameter their logarithm, so
/// that small motions are resolved as well as large ones.
#[derive(Debug)]
pub(crate) struct ContinuationProblem<'a> {
    balance: Balance<'a>,
    linearisation: Linearisation,
    continuation: Continuation,
    /// Closures per unit: a length [m], a length per force [m/N], or a ratio.
    closure: f64,
    frequency: f64,
    closures: Vec<f64>,
    /// Gradient of the displacement of the load's port by closures, real and imaginary parts.
    gradient: [Vec<f64>; 2],
}

/// Most unknowns of closures that matrices are factored for, where there is another way.
const MOST_DIRECT: usize = 200;

/// The same where the other way is not open.
const MOST_FACTORED: usize = 2000;

/// Springs over mean tangents, for free motions.
const OFF_RESONANCE: f64 = 2.0;

/// Points at which the linear response is scanned for its size and width.
const SCAN: u32 = 200;

impl<'a> ContinuationProblem<'a> {
    pub(crate) fn new(
        system: &'a ContactSystem,
        continuation: Continuation,
        harmonics: usize,
        samples: usize,
    ) -> Result<Self, HarmonicError> {
        let resolution = (harmonics, samples);
        let free = matches!(continuation, Continuation::Mode { .. });
        let factor = if free { OFF_RESONANCE } else { 1.0 };
        let iterates = is_iterative(system, harmonics);
        let many = iterates.then(|| Balance::of_many(system, resolution, factor)).flatten();
        let equations = system.pairs() * (2 * harmonics + 1);
        if iterates && many.is_none() && equations > MOST_FACTORED {
            // Bounds of iterations do not bound the memory of matrices.
            return Err(HarmonicError::Setting {
                quantity: "number of contacts times (2 harmonics + 1), of residual flexibilities that are not positive definite,",
                value: equations as f64,
                accepted: "at most 2000",
            });
        }
        let balance = many.unwrap_or_else(|| Balance::new(system, harmonics, samples));
        Self::of(balance, continuation)
    }

    /// The continuation with given equations.
    pub(crate) fn of(
        balance: Balance<'a>,
        continuation: Continuation,
    ) -> Result<Self, HarmonicError> {
        let system = balance.system();
        let mut solver = LinearSolver::new(system);
        let mut size = |w: f64| solver.at(w).map_or(f64::NAN, |found| found.size());
        let (closure, frequency) = match continuation {
            Continuation::Frequency { force, from, to } => {
                let at = |i: u32| TAU * (from + (to - from) * f64::from(i) / f64::from(SCAN));
                let sizes: Vec<f64> = (0..=SCAN).map(|i| size(at(i))).collect();
                let largest = sizes.iter().copied().fold(0.0, f64::max);
                let mean = sizes.iter().sum::<f64>() / f64::from(SCAN + 1);
                let span = TAU * (to - from).abs();
                // The width of a resonance is that of a rectangle of its area and height.
                let width = (0.5 * span * mean / largest).clamp(1e-4 * span, span);
                (force * largest, width)
            }
            Continuation::Force { frequency, .. } => {
                let w = TAU * frequency;
                (size(w), w)
            }
            Continuation::PhaseResonance { near, .. } => {
                let w = resonance_near(system, TAU * near);
                (size(w), 0.1 * w)
            }
            Continuation::Mode { near, .. } => (1.0, 0.1 * resonance_near(system, TAU * near)),
        };
        let positive = |value: f64| value.is_finite() && value > 0.0;
        if !(positive(closure) && positive(frequency)) {
            return Err(HarmonicError::NoLinearResponse { frequency_hz: continuation.start().0 });
        }
        let n = balance.unknowns();
        let linearisation = Linearisation::new(&balance, n + further(continuation) + 1);
        let (closures, gradient) = (vec![0.0; n], [vec![0.0; n], vec![0.0; n]]);
        Ok(Self { balance, linearisation, continuation, closure, frequency, closures, gradient })
    }

    pub(crate) fn balance(&self) -> &Balance<'a> {
        &self.balance
    }

    /// The closures' series of the unknowns last evaluated [m].
    pub(crate) fn closures(&self) -> &[f64] {
        &self.closures
    }

    /// Value of the parameter for a frequency [Hz], a force [N] or an amplitude [m].
    pub(crate) fn parameter(&self, value: f64) -> f64 {
        match self.continuation {
            Continuation::Frequency { .. } => TAU * value / self.frequency,
            _ => value.ln(),
        }
    }

    /// Reference of the closures and its relative slope with respect to the parameter.
    fn reference(&self, parameter: f64) -> (f64, f64) {
        match self.continuation {
            Continuation::Frequency { .. } => (self.closure, 0.0),
            _ => (self.closure * parameter.exp(), 1.0),
        }
    }

    pub(crate) fn conditions(&self, v: &[f64]) -> Conditions {
        let n = self.balance.unknowns();
        let parameter = v[v.len() - 1];
        let mut at = Conditions { angular_frequency: 0.0, anti_damping: 0.0, force: 0.0 };
        match self.continuation {
            Continuation::Frequency { force, .. } => {
                at.force = force;
                at.angular_frequency = self.frequency * parameter;
            }
            Continuation::Force { frequency, .. } => {
                at.force = parameter.exp();
                at.angular_frequency = TAU * frequency;
            }
            Continuation::PhaseResonance { .. } => {
                at.force = parameter.exp();
                at.angular_frequency = self.frequency * v[n];
            }
            Continuation::Mode { .. } => {
                at.angular_frequency = self.frequency * v[n];
                at.anti_damping = self.frequency * v[n + 1];
            }
        }
        at
    }

    /// Unknowns from a motion: closures' series [m] of any number of harmonics, and conditions.
    pub(crate) fn unknowns(&self, closures: &[f64], at: &Conditions, value: f64) -> Vec<f64> {
        let pairs = self.balance.system().pairs();
        let terms = self.balance.fourier().terms();
        let given = closures.len() / pairs;
        let parameter = self.parameter(value);
        let (reference, _) = self.reference(parameter);
        let mut v = vec![0.0; self.size() + 1];
        for i in 0..pairs {
            for c in 0..given.min(terms) {
                v[i * terms + c] = closures[i * given + c] / reference;
            }
        }
        let n = pairs * terms;
        match self.continuation {
            Continuation::PhaseResonance { .. } => v[n] = at.angular_frequency / self.frequency,
            Continuation::Mode { .. } => {
                v[n] = at.angular_frequency / self.frequency;
                v[n + 1] = at.anti_damping / self.frequency;
            }
            Continuation::Frequency { .. } | Continuation::Force { .. } => {}
        }
        v[self.size()] = parameter;
        v
    }

    /// Unknowns of the linearised response at the start of the continuation.
    pub(crate) fn linear_start(&self) -> Option<Vec<f64>> {
        let system = self.balance.system();
        let (from, _) = self.continuation.range();
        let mut at = Conditions { angular_frequency: 0.0, anti_damping: 0.0, force: 0.0 };
        let mut scale = from;
        let mut turn = Complex64::new(1.0, 0.0);
        match self.continuation {
            Continuation::Frequency { force, .. } => {
                at.angular_frequency = TAU * from;
                scale = force;
            }
            Continuation::Force { frequency, .. } => at.angular_frequency = TAU * frequency,
            Continuation::PhaseResonance { .. } => at.angular_frequency = 10.0 * self.frequency,
            Continuation::Mode { near, .. } => {
                at.angular_frequency = resonance_near(system, TAU * near);
            }
        }
        let linear = LinearSolver::new(system).at(at.angular_frequency)?;
        if let Continuation::Mode { .. } = self.continuation {
            // At resonance a force in phase with the velocity supplies the power of the anti-damping,
            // which is of the order of the half-power width: a start for Newton's method.
            scale = from / linear.displacement.norm();
            turn = linear.displacement.conj() / linear.displacement.norm();
            at.anti_damping =
                half_power_width(system, at.angular_frequency, linear.displacement.norm());
        }
        let closures: Vec<f64> = linear
            .closures
            .chunks_exact(3)
            .flat_map(|series| {
                let rotated = Complex64::new(series[1], -series[2]) * turn;
                [scale * series[0], scale * rotated.re, -scale * rotated.im]
            })
            .collect();
        Some(self.unknowns(&closures, &at, from))
    }

    /// Slope of `ln |U_1|` of the load's port along a tangent, at the motion last evaluated.
    pub(crate) fn amplitude_slope(&mut self, v: &[f64], tangent: &[f64]) -> f64 {
        let at = self.conditions(v);
        let parameter = v.len() - 1;
        let (reference, growth) = self.reference(v[parameter]);
        let [real, imaginary] = &mut self.gradient;
        self.balance.d_displacement_d_closures(real, imaginary);
        let derivatives = self.balance.d_displacement_d_conditions(&at);
        let mut slope = Complex64::new(0.0, 0.0);
        for (j, x) in self.closures.iter().enumerate() {
            let change = reference * tangent[j] + x * growth * tangent[parameter];
            slope += Complex64::new(real[j], imaginary[j]) * change;
        }
        if let Continuation::Frequency { .. } = self.continuation {
            slope += derivatives[0] * (self.frequency * tangent[parameter]);
        }
        (slope / self.balance.load_displacement(1, &at)).re
    }
}

/// True if the equations of so many harmonics are solved by iteration.
pub(crate) fn is_iterative(system: &ContactSystem, harmonics: usize) -> bool {
    system.is_modal() && system.pairs() * (2 * harmonics + 1) > MOST_DIRECT
}

/// Number of unknowns beside the closures and the parameter.
fn further(continuation: Continuation) -> usize {
    match continuation {
        Continuation::Frequency { .. } | Continuation::Force { .. } => 0,
        Continuation::PhaseResonance { .. } => 1,
        Continuation::Mode { .. } => 2,
    }
}

/// Twice the distance [rad/s] from resonance to where the linear response falls to 1/sqrt(2).
fn half_power_width(system: &ContactSystem, resonance: f64, peak: f64) -> f64 {
    let mut solver = LinearSolver::new(system);
    let mut lower = |w: f64| {
        let half = std::f64::consts::FRAC_1_SQRT_2 * peak;
        solver.at(w).is_none_or(|found| found.displacement.norm() < half)
    };
    let (mut inside, mut outside) = (0.0, 0.5 * resonance);
    for _ in 0..50 {
        let middle = 0.5 * (inside + outside);
        if lower(resonance + middle) { outside = middle } else { inside = middle }
    }
    2.0 * inside
}

impl Curve for ContinuationProblem<'_> {
    fn size(&self) -> usize {
        self.balance.unknowns() + further(self.continuation)
    }

    fn has_kinks(&self) -> bool {
        self.balance.system().friction().is_some()
    }

    fn weight(&self, v: &[f64]) -> f64 {
        v[..self.balance.unknowns()].iter().fold(0.0, |largest, value| largest.max(value.abs()))
    }

    fn evaluate(&mut self, v: &[f64]) -> Result<(), Overflow> {
        let (reference, _) = self.reference(v[v.len() - 1]);
        for (x, y) in self.closures.iter_mut().zip(v) {
            *x = reference * y;
        }
        let at = self.conditions(v);
        self.balance.evaluate(&self.closures, &at)
    }

    fn residual(&mut self, v: &[f64], out: &mut [f64]) {
        let n = self.balance.unknowns();
        let at = self.conditions(v);
        let (reference, _) = self.reference(v[v.len() - 1]);
        self.balance.residual(&self.closures, &at, &mut out[..n]);
        match self.continuation {
            Continuation::Frequency { .. } | Continuation::Force { .. } => {}
            Continuation::PhaseResonance { .. } => {
                out[n] = self.balance.load_displacement(1, &at).re;
            }
            Continuation::Mode { .. } => {
                let amplitude = v[v.len() - 1].exp();
                let displacement = self.balance.load_displacement(1, &at);
                out[n] = displacement.re - amplitude;
                out[n + 1] = displacement.im;
            }
        }
        for r in out.iter_mut() {
            *r /= reference;
        }
    }

    fn linearise(&mut self, v: &[f64], last: &[f64]) -> bool {
        let border = self.border(v);
        self.linearisation.take(&self.balance, border, last)
    }

    fn solve(&self, x: &mut [f64], accuracy: f64) -> bool {
        self.linearisation.solve(&self.balance, x, accuracy)
    }

    fn is_iterative(&self) -> bool {
        self.balance.is_of_many()
    }

    fn orientation(&self) -> f64 {
        self.linearisation.orientation()
    }
}

impl ContinuationProblem<'_> {
    /// Derivatives beside those of the residual by the closures, at the motion last evaluated.
    fn border(&mut self, v: &[f64]) -> Border {
        let n = self.balance.unknowns();
        let at = self.conditions(v);
        let (reference, growth) = self.reference(v[v.len() - 1]);
        let scale = self.frequency / reference;
        let by_frequency = |balance: &Balance<'_>| {
            let mut column = vec![0.0; n];
            balance.d_residual_d_frequency(&at, &mut column);
            for slope in &mut column {
                *slope *= scale;
            }
            column
        };
        if let Continuation::Frequency { .. } = self.continuation {
            return Border { columns: vec![by_frequency(&self.balance)], rows: Vec::new() };
        }
        // X = a Y grows with the parameter, as do force and residual.
        let (mut parameter, mut part) = (vec![0.0; n], vec![0.0; n]);
        self.balance.d_residual_along(&v[..n], &mut parameter);
        self.balance.d_residual_d_force(&mut part);
        parameter.iter_mut().zip(&part).for_each(|(to, slope)| *to += slope * at.force / reference);
        self.balance.residual(&self.closures, &at, &mut part);
        parameter.iter_mut().zip(&part).for_each(|(to, r)| *to -= growth * r / reference);
        if let Continuation::Force { .. } = self.continuation {
            return Border { columns: vec![parameter], rows: Vec::new() };
        }
        let mut columns = vec![by_frequency(&self.balance)];
        if let Continuation::Mode { .. } = self.continuation {
            self.balance.d_residual_d_anti_damping(&at, &mut part);
            columns.push(part.iter().map(|slope| scale * slope).collect());
        }
        columns.push(parameter);
        // The rows of the displacement.
        let [real, imaginary] = &mut self.gradient;
        self.balance.d_displacement_d_closures(real, imaginary);
        let derivatives = self.balance.d_displacement_d_conditions(&at).map(|d| [d.re, d.im]);
        let displacement = self.balance.load_displacement(1, &at);
        let displacement = [displacement.re, displacement.im];
        let rows: Vec<Vec<f64>> =
            [real, imaginary].into_iter().take(columns.len() - 1).map(|row| row.clone()).collect();
        for (part, row) in rows.iter().enumerate() {
            columns[0].push(scale * derivatives[0][part]);
            if let Continuation::Mode { .. } = self.continuation {
                columns[1].push(scale * derivatives[1][part]);
            }
            let along = dot(row, &v[..n]);
            // At a solution the residual's own constant, the amplitude, grows alike.
            let own = (at.force * derivatives[2][part] - displacement[part]) / reference;
            if let Some(parameter) = columns.last_mut() {
                parameter.push(along + own);
            }
        }
        Border { columns, rows }
    }
}
