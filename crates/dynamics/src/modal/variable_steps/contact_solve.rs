//! Closures and tractions at the end of a step.
//!
//! ```text
//! x + B T + D T' = x*,      w + C T + E T' = w*
//! T = q(x) + c(x) w,        T' = K w + c'(x) w^2 + c a
//! ```
//!
//! with closures x, their rates w and accelerations a, tractions T and their rates T'. Newton's method in
//! x; the rates follow from the second line, which is linear in w; accelerations, which act through D and
//! E alone, are those of the correction before.

use std::array;
use std::sync::Arc;

use asperity_law::CompiledLaw;
use asperity_structure::PreloadedContact;

use crate::modal::step_coefficients::{RowMatrix, StepCoefficients};

/// Corrections before a step counts as too long.
const MOST_CORRECTIONS: usize = 12;

/// Bend of the laws in a correction, over the largest traction, below which it is the last.
const CONVERGED: f64 = 1e-9;

/// A contact with the table of its law.
#[derive(Debug)]
pub(super) struct Contact<'a> {
    pub(super) preloaded: &'a PreloadedContact,
    table: Arc<CompiledLaw>,
    /// Least traction increment \[Pa\].
    least: f64,
    /// Closure increment \[m\] at and below which contact is lost.
    pub(super) open_below: f64,
}

/// The rows at one time.
#[derive(Debug, Clone, Copy)]
pub(super) struct RowState<const N: usize> {
    /// Closure increment \[m\] and its rate \[m/s\].
    pub(super) closure: [f64; N],
    pub(super) rate: [f64; N],
    /// Pressure increment of the law \[Pa\] and stiffness \[Pa/m\].
    pub(super) pressure: [f64; N],
    pub(super) stiffness: [f64; N],
    /// Traction increment \[Pa\] and its rate \[Pa/s\].
    pub(super) traction: [f64; N],
    pub(super) traction_rate: [f64; N],
}

/// The rows at the end of a step without the tractions there.
#[derive(Debug, Clone, Copy)]
pub(super) struct FreeEnd<const N: usize> {
    pub(super) closure: [f64; N],
    pub(super) rate: [f64; N],
    pub(super) acceleration: [f64; N],
}

type Matrix<const N: usize> = [[f64; N]; N];

/// Rows of a step: losses of closures, rates and accelerations per traction and per its rate.
#[derive(Debug, Clone)]
pub(super) struct RowStep<const N: usize> {
    step: f64,
    closure: [Matrix<N>; 2],
    rate: [Matrix<N>; 2],
    acceleration: [Matrix<N>; 2],
    is_damped: bool,
}

impl<const N: usize> RowStep<N> {
    pub(super) fn new(step: &StepCoefficients, contacts: &[Contact<'_>]) -> Self {
        let entry = |matrix: &RowMatrix, i: usize, j: usize| {
            matrix.get(i).and_then(|row| row.get(j)).copied().unwrap_or(0.0)
        };
        let both = |pair: &[RowMatrix; 2]| {
            array::from_fn(|k| array::from_fn(|i| array::from_fn(|j| entry(&pair[k], i, j))))
        };
        Self {
            step: step.step,
            closure: both(&step.closure),
            rate: both(&step.rate),
            acceleration: both(&step.acceleration),
            is_damped: contacts.iter().any(|contact| contact.preloaded.damping().is_some()),
        }
    }
}

impl<const N: usize> RowStep<N> {
    /// True if a contact is damped.
    pub(super) fn is_damped(&self) -> bool {
        self.is_damped
    }
}

impl<'a> Contact<'a> {
    pub(super) fn new(preloaded: &'a PreloadedContact, table: Arc<CompiledLaw>) -> Self {
        let (law, pressure) = (preloaded.law(), preloaded.pressure());
        let (mut least, mut open_below) = (f64::NEG_INFINITY, f64::NEG_INFINITY);
        if law.domain().separates() {
            (least, open_below) = (-pressure, law.closure_increment(pressure, -pressure));
        } else if !law.domain().is_bilateral() {
            least = -pressure;
        }
        Self { preloaded, table, least, open_below }
    }

    /// Area \[m2\].
    pub(super) fn area(&self) -> f64 {
        self.preloaded.area()
    }

    /// Static pressure \[Pa\].
    pub(super) fn pressure(&self) -> f64 {
        self.preloaded.pressure()
    }

    /// Pressure increment \[Pa\] and stiffness \[Pa/m\] at a closure increment \[m\].
    #[inline(always)]
    pub(super) fn law(&self, closure: f64) -> [f64; 2] {
        if closure <= self.open_below {
            return [self.least, 0.0];
        }
        let (pressure, stiffness) = self.table.get_with_tangent(closure);
        if pressure.is_nan() { self.exact_law(closure) } else { [pressure, stiffness] }
    }

    #[cold]
    #[inline(never)]
    fn exact_law(&self, closure: f64) -> [f64; 2] {
        let found = self.preloaded.law().pressure_increment(self.pressure(), closure);
        [found.value, found.tangent]
    }

    /// Damping coefficient \[Pa s/m\] and its derivative by the closure.
    fn damping(&self, [pressure, stiffness]: [f64; 2]) -> [f64; 2] {
        let Some(damping) = self.preloaded.damping() else { return [0.0; 2] };
        let pressure = self.pressure() + pressure;
        let slope = self.preloaded.law().stiffness_slope(pressure);
        let by_pressure = damping.coefficient_slope(pressure, stiffness, slope);
        [damping.coefficient(pressure, stiffness), by_pressure * stiffness]
    }
}

impl<const N: usize> RowState<N> {
    /// All increments zero.
    pub(super) fn at_rest(contacts: &[Contact<'_>]) -> Self {
        let zero = [0.0; N];
        Self {
            closure: zero,
            rate: zero,
            pressure: zero,
            stiffness: array::from_fn(|i| contacts.get(i).map_or(0.0, |contact| contact.law(0.0)[1])),
            traction: zero,
            traction_rate: zero,
        }
    }
}

/// The rows at the end of a step, from the tractions of `guess` on; none if they are not found. `scale` is
/// the largest traction of each so far.
#[inline(always)]
pub(super) fn solve<const N: usize>(
    contacts: &[Contact<'_>],
    step: &RowStep<N>,
    free: &FreeEnd<N>,
    guess: &RowState<N>,
    scale: &[f64; N],
) -> Option<RowState<N>> {
    let mut now = *guess;
    for i in 0..N {
        now.closure[i] = free.closure[i]
            - product(&step.closure[0][i], &now.traction)
            - product(&step.closure[1][i], &now.traction_rate);
    }
    let mut damping = [[0.0; 2]; N];
    // Pressures at the closures by the tangents of the correction before.
    let mut expected = [f64::NAN; N];
    for correction in 0..MOST_CORRECTIONS {
        let before = now.traction_rate;
        for (i, contact) in contacts.iter().enumerate().take(N) {
            let found = contact.law(now.closure[i]);
            [now.pressure[i], now.stiffness[i]] = found;
            if step.is_damped {
                damping[i] = contact.damping(found);
            }
        }
        rates(contacts, step, free, &damping, &mut now);
        if correction > 0 {
            let mut largest = 0.0_f64;
            for i in 0..N {
                let bent = (now.pressure[i] - expected[i]).abs();
                let turned = (now.traction_rate[i] - before[i]).abs() * step.step;
                largest = largest.max((bent + turned) / scale[i].max(now.traction[i].abs()));
            }
            if largest <= CONVERGED {
                return now.closure.iter().all(|x| x.is_finite()).then_some(now);
            }
        }
        let mut excess = [0.0; N];
        let mut matrix = [[0.0; N]; N];
        for i in 0..N {
            excess[i] = now.closure[i] - free.closure[i]
                + product(&step.closure[0][i], &now.traction)
                + product(&step.closure[1][i], &now.traction_rate);
            for j in 0..N {
                let slope = now.stiffness[j] + damping[j][1] * now.rate[j];
                matrix[i][j] = step.closure[0][i][j] * slope.max(0.0);
            }
            matrix[i][i] += 1.0;
        }
        let change = linear_solve(matrix, excess);
        for i in 0..N {
            now.closure[i] -= change[i];
            expected[i] = now.pressure[i] - now.stiffness[i] * change[i];
        }
    }
    None
}

/// Rates of closures and tractions, and the viscous parts of the tractions, at closures whose pressures are
/// known.
#[inline(always)]
fn rates<const N: usize>(
    contacts: &[Contact<'_>],
    step: &RowStep<N>,
    free: &FreeEnd<N>,
    damping: &[[f64; 2]; N],
    now: &mut RowState<N>,
) {
    let mut accelerations = [0.0; N];
    let mut right = [0.0; N];
    let mut matrix = [[0.0; N]; N];
    for i in 0..N {
        right[i] = free.rate[i] - product(&step.rate[0][i], &now.pressure);
        for j in 0..N {
            matrix[i][j] = step.rate[1][i][j] * now.stiffness[j];
        }
        matrix[i][i] += 1.0;
    }
    if step.is_damped {
        for i in 0..N {
            accelerations[i] = free.acceleration[i]
                - product(&step.acceleration[0][i], &now.traction)
                - product(&step.acceleration[1][i], &now.traction_rate);
        }
        for i in 0..N {
            for j in 0..N {
                let [coefficient, slope] = damping[j];
                matrix[i][j] += step.rate[0][i][j] * coefficient
                    + step.rate[1][i][j] * slope * now.rate[j];
                right[i] -= step.rate[1][i][j] * coefficient * accelerations[j];
            }
        }
    }
    now.rate = linear_solve(matrix, right);
    now.traction = now.pressure;
    for i in 0..N {
        now.traction_rate[i] = now.stiffness[i] * now.rate[i];
    }
    if step.is_damped {
        for (i, contact) in contacts.iter().enumerate().take(N) {
            let ([coefficient, slope], rate) = (damping[i], now.rate[i]);
            now.traction[i] += coefficient * rate;
            now.traction_rate[i] += slope * rate * rate + coefficient * accelerations[i];
            if coefficient > 0.0 && now.traction[i] < contact.least {
                (now.traction[i], now.traction_rate[i]) = (contact.least, 0.0);
            }
        }
    }
}

#[inline(always)]
fn product<const N: usize>(row: &[f64; N], numbers: &[f64; N]) -> f64 {
    let mut sum = 0.0;
    for i in 0..N {
        sum += row[i] * numbers[i];
    }
    sum
}

/// The solution of equations whose matrix has the pivots of a positive definite one.
#[inline(always)]
fn linear_solve<const N: usize>(mut matrix: Matrix<N>, mut right: [f64; N]) -> [f64; N] {
    for k in 0..N {
        let inverse = 1.0 / matrix[k][k];
        for i in k + 1..N {
            let factor = matrix[i][k] * inverse;
            for j in k + 1..N {
                matrix[i][j] -= factor * matrix[k][j];
            }
            right[i] -= factor * right[k];
        }
        matrix[k][k] = inverse;
    }
    for k in (0..N).rev() {
        for j in k + 1..N {
            right[k] -= matrix[k][j] * right[j];
        }
        right[k] *= matrix[k][k];
    }
    right
}
