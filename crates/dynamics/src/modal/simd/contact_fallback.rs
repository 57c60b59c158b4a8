//! Contact fallback: Newton's method with a line search, lane by lane, where it does not converge without.

use super::block::{Block, Coefficient, LaneVector, WHOLE, lane_of, set_lane};
use super::table_lookup::{TableLookup, TableRow};

/// Most corrections.
const CORRECTIONS: usize = 100;

/// Largest error of a closure that is left, in cells.
const ERROR: f64 = 1e-9;

/// Slope of the energy along a correction, over the one at its start, at which the line search ends, and
/// most halvings of a correction.
const FLAT: f64 = 0.1;
const HALVINGS: usize = 40;

impl<S: TableLookup, C: Coefficient<S>, const N: usize> Block<'_, S, C, N> {
    /// Solves `y + B p(y) = y*` in the lanes that `marks` has as ones.
    ///
    /// With B positive definite and the pressures rising, the equations state the minimum
    /// of a convex energy, to which Newton's method with a line search descends from anywhere. A lane that is
    /// not finite is left as it is.
    #[cold]
    #[inline(never)]
    pub(super) fn solve_fallback(
        &mut self,
        marks: &LaneVector<S>,
        closure: &mut [LaneVector<S>; N],
        pressure: &mut [LaneVector<S>; N],
    ) {
        for lane in 0..2 * S::F64_LANES {
            if lane_of::<S>(marks, lane) != 1.0 {
                continue;
            }
            let of = |constant: C| constant.lane(lane);
            let target: [f64; N] =
                std::array::from_fn(|i| lane_of::<S>(&self.contacts[i].predicted, lane));
            if target.iter().any(|value| !value.is_finite()) {
                continue;
            }
            let contacts: [Curve<'_, N>; N] = std::array::from_fn(|i| Curve {
                history: match self.dampers.get(i) {
                    Some(damper) => lane_of::<S>(&damper.history, lane),
                    None => 0.0,
                },
                friction: self.sliders.get(i).map_or([0.0; 3], |slider| {
                    let now = |numbers| lane_of::<S>(numbers, lane);
                    [now(&slider.stuck), of(slider.stiffness), now(&slider.limit)]
                }),
                least: self.dampers.get(i).map_or(f64::NEG_INFINITY, |damper| of(damper.least)),
                table: self
                    .rows
                    .get((of(self.contacts[i].whole) - WHOLE) as usize..)
                    .unwrap_or(&[]),
                first: of(self.contacts[i].first),
                rest: of(self.contacts[i].rest),
                last: of(self.contacts[i].last),
                coupling: std::array::from_fn(|j| of(self.contacts[i].coupling[j])),
            });
            let rows = self.interfaces();
            let (y, p) = minimum(&contacts[..rows], &target);
            for i in 0..rows {
                set_lane::<S>(&mut closure[i], lane, y[i]);
                set_lane::<S>(&mut pressure[i], lane, p[i]);
            }
        }
    }
}

/// The law of one interface in one lane, and what its closure loses to every pressure.
struct Curve<'a, const N: usize> {
    table: &'a [TableRow],
    first: f64,
    rest: f64,
    last: f64,
    coupling: [f64; N],
    /// Added to the table, and the least sum, of a damped contact.
    history: f64,
    least: f64,
    /// Traction of the stuck friction element at no closure, its stiffness and its limit.
    friction: [f64; 3],
}

impl<const N: usize> Curve<'_, N> {
    /// Traction increment at a closure, and its tangent.
    fn pressure(&self, unbounded: f64) -> (f64, f64) {
        let closure = unbounded.max(self.first).min(self.last);
        let place = closure + self.rest;
        let cell = (place as usize).min(self.table.len().saturating_sub(1));
        let t = closure - (cell as f64 - self.rest);
        let [c0, c1, c2, c3] = self.table.get(cell).copied().unwrap_or_default();
        let free = c0 + t * (c1 + t * (c2 + t * c3)) + self.history;
        let slope = if closure == unbounded && free > self.least {
            (c1 + t * (2.0 * c2 + t * 3.0 * c3)).max(0.0)
        } else {
            0.0
        };
        let [stuck, stiffness, limit] = self.friction;
        let force = stuck + stiffness * unbounded;
        let sticks = if force.abs() < limit { stiffness } else { 0.0 };
        (free.max(self.least) + force.min(limit).max(-limit), slope + sticks)
    }
}

/// Closures and pressures of all interfaces: the closures that the pressures q ask for, `y = y* - B q`, have the
/// pressures p(y), and q follows them by corrections `(I + K B) dq = p(y) - q` until both are the same.
///
/// The energy `E = (y* - y) . q / 2 + integral of p dy` is convex in y, and its slope along `dy = -B dq` is
/// `dy . (p - q)`.
fn minimum<const N: usize>(contacts: &[Curve<'_, N>], target: &[f64; N]) -> ([f64; N], [f64; N]) {
    let rows = contacts.len();
    let coupled = |of: &[f64; N]| -> [f64; N] {
        std::array::from_fn(|i| match contacts.get(i) {
            Some(contact) => (0..rows).map(|j| contact.coupling[j] * of[j]).sum(),
            None => 0.0,
        })
    };
    let (mut q, mut corrections) = ([0.0; N], 0);
    loop {
        let lost = coupled(&q);
        let y: [f64; N] = std::array::from_fn(|i| target[i] - lost[i]);
        let (mut p, mut tangent) = (q, [0.0; N]);
        for i in 0..rows {
            (p[i], tangent[i]) = contacts[i].pressure(y[i]);
        }
        let off: [f64; N] = std::array::from_fn(|i| p[i] - q[i]);
        if corrections == CORRECTIONS || coupled(&off).iter().all(|error| error.abs() < ERROR) {
            return (y, p);
        }
        corrections += 1;
        let change = correction(contacts, &tangent, off);
        let way = coupled(&change).map(|lost| -lost);
        let slope = |share: f64| -> f64 {
            let of = |i: usize| {
                let reached = contacts[i].pressure(y[i] + share * way[i]).0;
                way[i] * (reached - q[i] - share * change[i])
            };
            (0..rows).map(of).sum()
        };
        let share = share_of(slope);
        for i in 0..rows {
            q[i] += share * change[i];
        }
    }
}

/// The share of a correction at which the energy, whose slope is given, hardly falls any more: all of it, or
/// less where it passes the minimum.
fn share_of(slope: impl Fn(f64) -> f64) -> f64 {
    let flat = FLAT * slope(0.0).abs();
    if slope(1.0) <= flat {
        return 1.0;
    }
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        let at = slope(middle);
        if at.abs() <= flat {
            return middle;
        }
        if at > 0.0 { high = middle } else { low = middle }
    }
    0.5 * (low + high)
}

/// The solution of `(I + K B) x = right` by elimination, which needs no pivots: its leading minors are at least one.
fn correction<const N: usize>(
    contacts: &[Curve<'_, N>],
    tangent: &[f64; N],
    mut right: [f64; N],
) -> [f64; N] {
    let rows = contacts.len();
    let mut matrix = [[0.0; N]; N];
    for (i, contact) in contacts.iter().enumerate() {
        matrix[i] = contact.coupling.map(|coupling| tangent[i] * coupling);
        matrix[i][i] += 1.0;
    }
    for k in 0..rows {
        let pivot = matrix[k];
        for i in k + 1..rows {
            let factor = matrix[i][k] / pivot[k];
            for (entry, above) in matrix[i].iter_mut().zip(&pivot).skip(k + 1) {
                *entry -= factor * above;
            }
            right[i] -= factor * right[k];
        }
    }
    for i in (0..rows).rev() {
        let known: f64 = (i + 1..rows).map(|j| matrix[i][j] * right[j]).sum();
        right[i] = (right[i] - known) / matrix[i][i];
    }
    right
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against the equations themselves: a kinked law, coupled almost singularly, with one
    /// contact open and one pressed.
    #[test]
    fn the_equations_are_met_where_newton_would_circle() {
        // Open below cell 1, then stiff, then soft: a kink that sends Newton back and forth.
        let table = [[-1.0, 0.0, 0.0, 0.0], [-1.0, 50.0, 0.0, 0.0], [49.0, 0.1, 0.0, 0.0]];
        let curve = |coupling| Curve {
            table: &table,
            first: -1.0,
            rest: 1.0,
            last: 1.999,
            coupling,
            history: 0.0,
            least: f64::NEG_INFINITY,
            friction: [0.0; 3],
        };
        let contacts = [curve([0.9, -0.8]), curve([-0.8, 0.9])];
        for target in [[3.0, -5.0], [0.0, 0.0], [-1.0, -1.0], [10.0, -30.0], [1.0, 1.0]] {
            let (y, p) = minimum(&contacts, &target);
            for i in 0..2 {
                let total: f64 = (0..2).map(|j| contacts[i].coupling[j] * p[j]).sum();
                assert!((y[i] + total - target[i]).abs() < 1e-8, "{target:?} {y:?} {p:?}");
                assert_eq!(p[i], contacts[i].pressure(y[i]).0);
            }
        }
    }

    /// Random couplings, laws with kinks and friction against the equations themselves.
    #[test]
    fn random_equations_are_met() {
        const N: usize = 4;
        let mut state = 1_u64;
        let mut random = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        for trial in 0..2000 {
            // Steep and flat pieces above loss of contact, up to 1e8 times apart.
            let tables: Vec<Vec<TableRow>> = (0..N)
                .map(|_| {
                    let mut level = -10.0;
                    let mut rows = vec![[level, 0.0, 0.0, 0.0]];
                    for _ in 0..12 {
                        let (rise, bend) = (10.0_f64.powf(8.0 * random() - 4.0), random());
                        rows.push([level, rise * (1.0 - bend), rise * bend, 0.0]);
                        level += rise;
                    }
                    rows
                })
                .collect();
            let root: [[f64; N]; N] =
                std::array::from_fn(|_| std::array::from_fn(|_| 2.0 * random() - 1.0));
            let coupling = |i: usize, j: usize| -> f64 {
                let product: f64 = (0..N).map(|k| root[i][k] * root[j][k]).sum();
                product + if i == j { 1e-3 } else { 0.0 }
            };
            let contacts: [Curve<'_, N>; N] = std::array::from_fn(|i| Curve {
                table: &tables[i],
                first: -3.0,
                rest: 4.0,
                last: 8.999,
                coupling: std::array::from_fn(|j| coupling(i, j)),
                history: random() - 0.5,
                least: if trial % 2 == 0 { f64::NEG_INFINITY } else { -10.0 },
                friction: [random() - 0.5, 1e4 * random(), 10.0 * random()],
            });
            let target: [f64; N] = std::array::from_fn(|_| 20.0 * random() - 10.0);
            let (y, p) = minimum(&contacts, &target);
            for i in 0..N {
                let total: f64 = (0..N).map(|j| contacts[i].coupling[j] * p[j]).sum();
                let off = y[i] + total - target[i];
                assert!(off.abs() < 1e-8, "{trial}: {off} {target:?} {y:?} {p:?}");
                assert_eq!(p[i], contacts[i].pressure(y[i]).0);
            }
        }
    }
}
