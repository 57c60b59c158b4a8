//! A law in series with an elastic layer.

use crate::domain::{Domain, no_less};
use crate::error::{LawError, Quantity, above};
use crate::law::{ContactLaw, Pressure};

/// A law and a linear spring in series, `1/K = 1/K_law + 1/K_layer`.
///
/// The closures add: `d(p) = d_law(p) + (p - p_ref) / K_layer`, with the law's reference
/// pressure; the energies add too. With `K_layer -> inf` it is the law itself. It is also the
/// exact solution of an implicit contact step: `x + b p(x) = c` has the pressure of the law in
/// series with a layer of stiffness `1/b`, at closure c.
///
/// A law that separates still does; a closure limit is lifted to +inf.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InSeries<L> {
    law: L,
    stiffness: f64,
}

/// Iterations at most; about five are usual, and if all are spent the last iterate, which lies in
/// the bracket, is returned.
const ITERATIONS: usize = 128;

/// Part of the closure below which a residual that no longer halves is rounding.
const STALLED: f64 = 1e-13;

impl<L: ContactLaw> InSeries<L> {
    /// `law` in series with a layer of `stiffness` `K_layer` > 0 \[Pa/m\].
    ///
    /// # Errors
    /// [`LawError`] if the stiffness is not positive and finite.
    pub fn new(law: L, stiffness: f64) -> Result<Self, LawError> {
        Ok(Self { law, stiffness: above(Quantity::Stiffness, stiffness, 0.0)? })
    }

    /// The law without the layer.
    pub fn law(&self) -> &L {
        &self.law
    }

    /// Stiffness `K_layer` of the layer \[Pa/m\].
    pub fn layer_stiffness(&self) -> f64 {
        self.stiffness
    }

    /// Share of a closure increment that the law takes at inner stiffness `k`.
    fn share(&self, k: f64) -> f64 {
        self.stiffness / (k + self.stiffness)
    }

    /// Closure of the layer when its pressure rises by `increment`.
    fn layer(&self, increment: f64) -> f64 {
        increment / self.stiffness
    }

    /// The law's state as the pair's, with the tangent of both.
    fn paired(&self, inner: Pressure) -> Pressure {
        Pressure { value: inner.value, tangent: in_series(inner.tangent, self.stiffness) }
    }
}

/// `1 / (1/a + 1/b)` for 0 <= a <= inf and finite b > 0.
fn in_series(a: f64, b: f64) -> f64 {
    if a <= b { a / (1.0 + a / b) } else { b / (1.0 + b / a) }
}

impl<L: ContactLaw> ContactLaw for InSeries<L> {
    fn stiffness(&self, pressure: f64) -> f64 {
        in_series(self.law.stiffness(pressure), self.stiffness)
    }

    fn stiffness_slope(&self, pressure: f64) -> f64 {
        let share = self.share(self.law.stiffness(pressure));
        self.law.stiffness_slope(pressure) * share * share
    }

    fn domain(&self) -> Domain {
        let inner = self.law.domain();
        Domain {
            pressure_min: inner.pressure_min,
            closure_lost: inner
                .closure_lost
                .map(|lost| lost - self.layer(self.reference_pressure())),
            closure_limit: f64::INFINITY,
        }
    }

    fn reference_pressure(&self) -> f64 {
        self.law.reference_pressure()
    }

    fn kinks(&self) -> Vec<f64> {
        self.law.kinks()
    }

    fn measured_range(&self) -> Option<(f64, f64)> {
        self.law.measured_range()
    }

    fn closure(&self, pressure: f64) -> f64 {
        let p = no_less(pressure, self.law.domain().pressure_min);
        self.law.closure(p) + self.layer(p - self.reference_pressure())
    }

    fn closure_increment(&self, from: f64, increment: f64) -> f64 {
        let dp = no_less(increment, self.law.domain().pressure_min - from);
        self.law.closure_increment(from, dp) + self.layer(dp)
    }

    fn pressure(&self, closure: f64) -> Pressure {
        let domain = self.domain();
        if domain.is_open(closure) {
            return Pressure::OPEN;
        }
        if domain.closure_lost == Some(closure) {
            return Pressure { value: 0.0, tangent: self.stiffness(0.0) };
        }
        let path = Path {
            pressure: |x| self.law.pressure(x),
            closure: |p| self.law.closure(p),
            stiffness: |p| self.law.stiffness(p),
            origin: self.reference_pressure(),
            layer: self.stiffness,
        };
        self.paired(path.solve(closure))
    }

    fn pressure_increment(&self, from: f64, closure_increment: f64) -> Pressure {
        if self.law.domain().separates()
            && closure_increment < self.closure_increment(from, 0.0 - from)
        {
            return Pressure::lost_from(from);
        }
        let path = Path {
            pressure: |x| self.law.pressure_increment(from, x),
            closure: |dp| self.law.closure_increment(from, dp),
            stiffness: |dp| self.law.stiffness(from + dp),
            origin: 0.0,
            layer: self.stiffness,
        };
        self.paired(path.solve(closure_increment))
    }

    fn energy(&self, closure: f64) -> f64 {
        let domain = self.domain();
        if domain.is_open(closure) {
            return 0.0;
        }
        let p = self.pressure(closure).value;
        let start = if domain.separates() { 0.0 } else { self.reference_pressure() };
        self.law.energy(self.law.closure(p)) + 0.5 * (p - start) * self.layer(p + start)
    }
}

/// The law's curve from a state where its closure is zero and its pressure is `origin`, and the
/// layer in series.
struct Path<P, D, K> {
    pressure: P,
    closure: D,
    stiffness: K,
    origin: f64,
    layer: f64,
}

/// A point of the law's curve.
#[derive(Clone, Copy)]
struct Point {
    closure: f64,
    pressure: f64,
    tangent: f64,
}

impl<P: Fn(f64) -> Pressure, D: Fn(f64) -> f64, K: Fn(f64) -> f64> Path<P, D, K> {
    /// State of the law where `x + (p - origin) / K_layer = total`.
    ///
    /// Newton on the law's closure x where the law is softer than the layer, on its pressure p
    /// where it is stiffer. In its own variable each equation has a slope between once and twice
    /// that of its linear part, so that Newton's step is never off by more than a factor of two,
    /// however steep or flat the law. A bracket is halved instead where a step fails to halve the
    /// residual, as it may where the regimes alternate or the law has kinks.
    fn solve(&self, total: f64) -> Pressure {
        // The law alone or the layer alone would be pressed at least as far from the origin; the
        // lesser of the two bounds the root, and is finite.
        let alone = self.at_closure(total);
        let reach = self.layer * total;
        let mut at = if (alone.pressure - self.origin).abs() <= reach.abs() {
            alone
        } else {
            self.at_pressure(self.origin + reach)
        };
        let origin = Point { closure: 0.0, pressure: self.origin, tangent: 0.0 };
        let (mut low, mut high) = if total < 0.0 { (at, origin) } else { (origin, at) };
        let (mut last, mut best) = (f64::INFINITY, (f64::INFINITY, at));
        for _ in 0..ITERATIONS {
            let residual = total - at.closure - (at.pressure - self.origin) / self.layer;
            if residual > 0.0 {
                low = at;
            } else {
                high = at;
            }
            let size = residual.abs();
            // The residual is known no better than this; a law that is itself the result of an
            // iteration may not even allow that, but then stops improving.
            let halved = size <= 0.5 * last;
            let exact = size <= 4.0 * f64::EPSILON * total.abs();
            let done = exact || (!halved && size <= STALLED * total.abs());
            last = size;
            if size < best.0 {
                best = (size, at);
            }
            let k = at.tangent;
            at = if k <= self.layer {
                let step = residual / (1.0 + k / self.layer);
                let ends = (low.closure, high.closure);
                self.at_closure(bounded(at.closure + step, ends, halved, done))
            } else {
                let step = residual * self.layer / (1.0 + self.layer / k);
                let ends = (low.pressure, high.pressure);
                self.at_pressure(bounded(at.pressure + step, ends, halved, done))
            };
            if done {
                // One more step, from rounding to rounding, if the last ones made progress.
                best.1 = if exact { at } else { best.1 };
                break;
            }
        }
        let Point { pressure: value, tangent, .. } = best.1;
        Pressure { value, tangent }
    }

    fn at_closure(&self, closure: f64) -> Point {
        let p = (self.pressure)(closure);
        Point { closure, pressure: p.value, tangent: p.tangent }
    }

    fn at_pressure(&self, pressure: f64) -> Point {
        Point { closure: (self.closure)(pressure), pressure, tangent: (self.stiffness)(pressure) }
    }
}

/// `v` if the iteration converges and it lies in the bracket, else the bracket's middle; the last
/// step is small and only kept from leaving the bracket.
fn bounded(v: f64, (low, high): (f64, f64), converges: bool, last: bool) -> f64 {
    if last {
        no_less(if v > high { high } else { v }, low)
    } else if converges && low <= v && v <= high {
        v
    } else {
        0.5 * (low + high)
    }
}
