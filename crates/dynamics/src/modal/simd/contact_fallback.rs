//! Contact fallback: nonlinear Gauss-Seidel, lane by lane, where Newton's method does not converge.

use super::block::{Block, Coefficient, LaneVector, WHOLE, lane_of, set_lane};
use super::table_lookup::{TableLookup, TableRow};
use crate::modal::increasing_root::increasing_root;

/// Sweeps over the interfaces.
const SWEEPS: usize = 400;

impl<S: TableLookup, C: Coefficient<S>, const N: usize> Block<'_, S, C, N> {
    /// Solves `y + B p(y) = y*` in the lanes that `marks` has as ones, interface by interface.
    ///
    /// With B positive definite and the pressures rising, the equations state the minimum
    /// of a convex energy, and sweeps over the interfaces descend to it, if slowly. A lane that is
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
            let (y, p) = gauss_seidel(&contacts, &target);
            for i in 0..N {
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
    fn pressure(&self, unbounded: f64) -> f64 {
        let closure = unbounded.max(self.first).min(self.last);
        let place = closure + self.rest;
        let cell = (place as usize).min(self.table.len().saturating_sub(1));
        let t = closure - (cell as f64 - self.rest);
        let [c0, c1, c2, c3] = self.table.get(cell).copied().unwrap_or_default();
        let normal = (c0 + t * (c1 + t * (c2 + t * c3)) + self.history).max(self.least);
        let [stuck, stiffness, limit] = self.friction;
        normal + (stuck + stiffness * unbounded).min(limit).max(-limit)
    }

    /// The closure at which `y + b p(y) = target`, by halving a bracket.
    fn closure(&self, own: f64, target: f64) -> f64 {
        let excess = |y: f64| y + own * self.pressure(y) - target;
        increasing_root(excess, target, 1.0)
    }
}

/// Closures and pressures of all interfaces by sweeps over them.
fn gauss_seidel<const N: usize>(
    contacts: &[Curve<'_, N>; N],
    target: &[f64; N],
) -> ([f64; N], [f64; N]) {
    let mut y = *target;
    let mut p: [f64; N] = std::array::from_fn(|i| contacts[i].pressure(y[i]));
    for _ in 0..SWEEPS {
        let mut moved: f64 = 0.0;
        for i in 0..N {
            let others: f64 =
                (0..N).filter(|&j| j != i).map(|j| contacts[i].coupling[j] * p[j]).sum();
            let reached = contacts[i].closure(contacts[i].coupling[i], target[i] - others);
            moved = moved.max((reached - y[i]).abs());
            (y[i], p[i]) = (reached, contacts[i].pressure(reached));
        }
        if moved < 1e-9 {
            break;
        }
    }
    (y, p)
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
            let (y, p) = gauss_seidel(&contacts, &target);
            for i in 0..2 {
                let total: f64 = (0..2).map(|j| contacts[i].coupling[j] * p[j]).sum();
                assert!((y[i] + total - target[i]).abs() < 1e-6, "{target:?} {y:?} {p:?}");
                assert_eq!(p[i], contacts[i].pressure(y[i]));
            }
        }
    }
}
