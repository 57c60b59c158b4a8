//! Closures and tractions at the end of a step.
//!
//! ```text
//! x + B T + D T' = x*,      w + C T + E T' = w*
//! T = q(x) + c(x) w,        T' = K w + c'(x) w^2 + c a
//! ```
//!
//! with closures x, their rates w and accelerations a, tractions T and their rates T'. Newton's method in
//! x; the other three lines are linear in w and T' at given closures.

use std::array;
use std::sync::Arc;

use asperity_law::CompiledLaw;
use asperity_structure::PreloadedContact;

use crate::modal::assembly::MOST_INTERFACES;
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
    pub(super) least: f64,
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
    /// Losses of accelerations per traction and per its rate, modes that follow at once included.
    acceleration: [Matrix<N>; 2],
    /// Loss of the closure per traction by modes that follow at once.
    follows: Matrix<N>,
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
        let h = step.step;
        let follows: Matrix<N> = array::from_fn(|i| array::from_fn(|j| entry(&step.follows, i, j)));
        // Their traction is a cubic, whose second derivative is bound to its ends.
        let of_cubic = [-6.0 / (h * h), 4.0 / h];
        let acceleration = array::from_fn(|k| {
            array::from_fn(|i| {
                array::from_fn(|j| entry(&step.acceleration[k], i, j) + of_cubic[k] * follows[i][j])
            })
        });
        Self {
            step: h,
            closure: both(&step.closure),
            rate: both(&step.rate),
            acceleration,
            follows,
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

    /// True where a pressure increment \[Pa\] is near the opening of the contact.
    pub(super) fn is_near_opening(&self, pressure: f64) -> bool {
        pressure <= (1.0 - PreloadedContact::NEAR_OPENING) * self.least
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
    #[inline(always)]
    fn damping(&self, closure: f64, [pressure, stiffness]: [f64; 2]) -> [f64; 2] {
        let Some(damping) = self.preloaded.damping() else { return [0.0; 2] };
        let pressure = self.pressure() + pressure;
        let is_open = closure <= self.open_below;
        let slope = if is_open { 0.0 } else { self.table.tangent_slope(closure) / stiffness };
        let by_closure = stiffness * damping.coefficient_slope(pressure, stiffness, slope);
        // Without contact, and beyond the table, the slope is beyond bounds.
        let by_closure = if by_closure.is_finite() { by_closure } else { 0.0 };
        [damping.coefficient(pressure, stiffness), by_closure]
    }
}

impl<const N: usize> RowState<N> {
    /// True if all closures, tractions and their rates are numbers.
    pub(super) fn is_finite(&self) -> bool {
        let all = [&self.closure, &self.rate, &self.traction, &self.traction_rate];
        all.into_iter().flatten().all(|number| number.is_finite())
    }

    /// All increments zero.
    pub(super) fn at_rest(contacts: &[Contact<'_>]) -> Self {
        let zero = [0.0; N];
        Self {
            closure: zero,
            rate: zero,
            pressure: zero,
            stiffness: array::from_fn(|i| {
                contacts.get(i).map_or(0.0, |contact| contact.law(0.0)[1])
            }),
            traction: zero,
            traction_rate: zero,
        }
    }
}

/// The rows at the end of a step from `begin`, with the tractions of `guess` to begin with, or the last try if they are not found.
/// `scale` is the largest traction of each so far.
#[inline(always)]
pub(super) fn solve<const N: usize>(
    contacts: &[Contact<'_>],
    step: &RowStep<N>,
    free: &FreeEnd<N>,
    [begin, guess]: [&RowState<N>; 2],
    scale: &[f64; N],
) -> Result<RowState<N>, RowState<N>> {
    let rows = rows_of::<N>(contacts.len());
    let mut now = *guess;
    for i in 0..rows {
        now.closure[i] = free.closure[i]
            - product(&step.closure[0][i], &now.traction, rows)
            - product(&step.closure[1][i], &now.traction_rate, rows);
    }
    let mut damping = [[0.0; 2]; N];
    // Pressures at the closures by the tangents of the correction before.
    let mut expected = [f64::NAN; N];
    for correction in 0..MOST_CORRECTIONS {
        let before = now.traction_rate;
        for (i, contact) in contacts.iter().enumerate().take(rows) {
            let found = contact.law(now.closure[i]);
            [now.pressure[i], now.stiffness[i]] = found;
            if step.is_damped {
                damping[i] = contact.damping(now.closure[i], found);
            }
        }
        let part = rates(contacts, step, free, &damping, begin, &mut now);
        if correction > 0 {
            let mut largest = 0.0_f64;
            for i in 0..rows {
                let bent = (now.pressure[i] - expected[i]).abs();
                let turned = (now.traction_rate[i] - before[i]).abs() * step.step;
                largest = largest.max((bent + turned) / scale[i].max(now.traction[i].abs()));
            }
            if largest <= CONVERGED {
                return if now.is_finite() { Ok(now) } else { Err(now) };
            }
        }
        let mut excess = [0.0; N];
        let mut matrix = [[0.0; N]; N];
        for i in 0..rows {
            excess[i] = now.closure[i] - free.closure[i]
                + product(&step.closure[0][i], &now.traction, rows)
                + product(&step.closure[1][i], &now.traction_rate, rows);
            for j in 0..rows {
                let slope = now.stiffness[j] + damping[j][1] * now.rate[j];
                let slope = if part[j] { 0.0 } else { slope.max(0.0) };
                matrix[i][j] = step.closure[0][i][j] * slope;
            }
            matrix[i][i] += 1.0;
        }
        let change = linear_solve(matrix, excess, rows);
        for i in 0..rows {
            now.closure[i] -= change[i];
            expected[i] = now.pressure[i] - now.stiffness[i] * change[i];
        }
    }
    Err(now)
}

/// Rates of closures and tractions, and the viscous parts of the tractions, at closures whose pressures are
/// known; true for rows that part, whose faces would pull on each other: their traction is the least.
#[inline(always)]
fn rates<const N: usize>(
    contacts: &[Contact<'_>],
    step: &RowStep<N>,
    free: &FreeEnd<N>,
    damping: &[[f64; 2]; N],
    begin: &RowState<N>,
    now: &mut RowState<N>,
) -> [bool; N] {
    if step.is_damped {
        return damped_rates(contacts, step, free, damping, begin, now);
    }
    let rows = rows_of::<N>(contacts.len());
    let mut right = [0.0; N];
    let mut matrix = [[0.0; N]; N];
    for i in 0..rows {
        right[i] = free.rate[i] - product(&step.rate[0][i], &now.pressure, rows);
        for j in 0..rows {
            matrix[i][j] = step.rate[1][i][j] * now.stiffness[j];
        }
        matrix[i][i] += 1.0;
    }
    now.rate = linear_solve(matrix, right, rows);
    now.traction = now.pressure;
    for i in 0..rows {
        now.traction_rate[i] = now.stiffness[i] * now.rate[i];
    }
    [false; N]
}

/// The same with dampers: linear in the rates w and the rates T' of the tractions,
///
/// ```text
/// w + C (q + c w) + E T' = w*,      T' = (K + c' w) w + c a,
/// a = a* - A T - A' T' - F T'',     T'' = (6 (T0 - T) / h + 2 T0' + 4 T') / h
/// ```
///
/// with the accelerations a of modes in motion, less the flexibility F of modes that follow at once under the
/// second derivative of the cubic from T0 and T0' on.
#[inline(always)]
fn damped_rates<const N: usize>(
    contacts: &[Contact<'_>],
    step: &RowStep<N>,
    free: &FreeEnd<N>,
    damping: &[[f64; 2]; N],
    begin: &RowState<N>,
    now: &mut RowState<N>,
) -> [bool; N] {
    let rows = rows_of::<N>(contacts.len());
    let inverse = step.step.recip();
    let [by_traction, by_rate] = &step.acceleration;
    let before: [f64; N] = array::from_fn(|j| {
        (6.0 * begin.traction[j] * inverse + 2.0 * begin.traction_rate[j]) * inverse
    });
    let mut part = [false; N];
    for _ in 0..=rows {
        let held = |j: usize, number: f64| if part[j] { 0.0 } else { number };
        let c: [f64; N] = array::from_fn(|j| held(j, damping[j][0]));
        let slope: [f64; N] =
            array::from_fn(|j| held(j, now.stiffness[j] + damping[j][1] * now.rate[j]));
        let at_rest: [f64; N] = array::from_fn(|j| {
            let least = contacts.get(j).map_or(0.0, |contact| contact.least);
            if part[j] { least } else { now.pressure[j] }
        });
        // T' = constant + sum of shares of w.
        let implicit: Matrix<N> = array::from_fn(|i| {
            array::from_fn(|j| f64::from(u8::from(i == j)) + c[i] * held(j, by_rate[i][j]))
        });
        let constant = array::from_fn(|i| {
            let by_state = (0..rows).map(|j| by_traction[i][j] * at_rest[j]).sum::<f64>();
            c[i] * (free.acceleration[i] - product(&step.follows[i], &before, rows) - by_state)
        });
        let constant = linear_solve(implicit, constant, rows);
        let mut shares = [[0.0; N]; N];
        for j in 0..rows {
            let column = array::from_fn(|i| {
                held(i, if i == j { slope[j] } else { 0.0 }) - c[i] * by_traction[i][j] * c[j]
            });
            shares[j] = linear_solve(implicit, column, rows);
        }
        let mut right = [0.0; N];
        let mut matrix = [[0.0; N]; N];
        for i in 0..rows {
            right[i] = free.rate[i]
                - product(&step.rate[0][i], &at_rest, rows)
                - product(&step.rate[1][i], &constant, rows);
            for j in 0..rows {
                matrix[i][j] =
                    step.rate[0][i][j] * c[j] + product(&step.rate[1][i], &shares[j], rows);
            }
            matrix[i][i] += 1.0;
        }
        now.rate = linear_solve(matrix, right, rows);
        let mut parts_more = false;
        for (j, contact) in contacts.iter().enumerate().take(rows) {
            now.traction[j] = at_rest[j] + c[j] * now.rate[j];
            now.traction_rate[j] =
                constant[j] + (0..rows).map(|k| shares[k][j] * now.rate[k]).sum::<f64>();
            if c[j] > 0.0 && now.traction[j] < contact.least {
                part[j] = true;
                parts_more = true;
            }
        }
        if !parts_more {
            break;
        }
    }
    part
}

/// Number of rows, which the compiler knows where they are few.
#[inline(always)]
pub(super) fn rows_of<const N: usize>(rows: usize) -> usize {
    if N == MOST_INTERFACES { rows.min(N) } else { N }
}

#[inline(always)]
fn product<const N: usize>(row: &[f64; N], numbers: &[f64; N], count: usize) -> f64 {
    let mut sum = 0.0;
    for i in 0..count {
        sum += row[i] * numbers[i];
    }
    sum
}

/// The solution of the first `count` equations, whose matrix has the pivots of a positive definite one.
#[inline(always)]
fn linear_solve<const N: usize>(
    mut matrix: Matrix<N>,
    mut right: [f64; N],
    count: usize,
) -> [f64; N] {
    // Two contacts, the usual ones, by one division.
    if N == 2 {
        let [[a, b], [c, d]] = [[matrix[0][0], matrix[0][1]], [matrix[1][0], matrix[1][1]]];
        let inverse = 1.0 / (a * d - b * c);
        (right[0], right[1]) =
            (inverse * (d * right[0] - b * right[1]), inverse * (a * right[1] - c * right[0]));
        return right;
    }
    for k in 0..count {
        let inverse = 1.0 / matrix[k][k];
        for i in k + 1..count {
            let factor = matrix[i][k] * inverse;
            for j in k + 1..count {
                matrix[i][j] -= factor * matrix[k][j];
            }
            right[i] -= factor * right[k];
        }
        matrix[k][k] = inverse;
    }
    for k in (0..count).rev() {
        for j in k + 1..count {
            right[k] -= matrix[k][j] * right[j];
        }
        right[k] *= matrix[k][k];
    }
    right
}
