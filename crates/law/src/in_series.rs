//! A law in series with an elastic layer.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::contact_law::{ContactLaw, Pressure};
use crate::domain::{Domain, no_less};
use crate::error::{LawError, LawQuantity, above};
use crate::law_form::LawFault;

/// A law and a linear spring in series, `1/K = 1/K_law + 1/K_layer`.
///
/// The closures add, `d(p) = d_law(p) + (p - p_ref) / K_layer` with the reference pressure of the
/// law; so do the energies. With `K_layer -> inf` it is the law itself. It also solves an implicit
/// contact step: the pressure of `x + b p(x) = c` is that of the law in series with a layer of
/// stiffness `1/b`, at closure c. Valid while the layer is linear elastic.
///
/// Loss of contact remains; a closure limit becomes +inf.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InSeries<L> {
    law: L,
    stiffness: f64,
}

/// Largest number of iterations; about five are usual. After the last one the best iterate, which
/// lies in the bracket, is returned.
const ITERATIONS: usize = 128;

/// Steps of the closure of the law in a short step at most.
const SHORT_ITERATIONS: usize = 4;

/// Step of the closure, over it, whose square is below rounding.
const SETTLED: f64 = 1e-9;

/// Part of the closure below which a residual that no longer halves is rounding.
const STALLED: f64 = 1e-13;

impl<L: ContactLaw> InSeries<L> {
    /// `law` in series with a layer of `stiffness` `K_layer` > 0 \[Pa/m\].
    ///
    /// # Errors
    /// [`LawError`] if the stiffness is not positive and finite.
    pub fn new(law: L, stiffness: f64) -> Result<Self, LawError> {
        Ok(Self { law, stiffness: above(LawQuantity::Stiffness, stiffness, 0.0)? })
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

    /// The state of the law with the tangent of law and layer.
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
        let curve = SeriesCurve {
            pressure: |x| self.law.pressure(x),
            closure: |p| self.law.closure(p),
            stiffness: |p| self.law.stiffness(p),
            origin: self.reference_pressure(),
            layer: self.stiffness,
        };
        self.paired(curve.solve(closure))
    }

    fn pressure_increment(&self, from: f64, closure_increment: f64) -> Pressure {
        if self.law.domain().separates()
            && closure_increment < self.closure_increment(from, 0.0 - from)
        {
            return Pressure::lost_from(from);
        }
        let curve = SeriesCurve {
            pressure: |x| self.law.pressure_increment(from, x),
            closure: |dp| self.law.closure_increment(from, dp),
            stiffness: |dp| self.law.stiffness(from + dp),
            origin: 0.0,
            layer: self.stiffness,
        };
        self.paired(curve.solve(closure_increment))
    }

    /// By short steps of the law, whose closures are found by Newton's method.
    fn pressure_step(&self, from: f64, closure_increment: f64) -> Option<Pressure> {
        let mut closure = closure_increment * self.share(self.law.stiffness(from));
        for _ in 0..SHORT_ITERATIONS {
            let inner = self.law.pressure_step(from, closure)?;
            let residual = closure_increment - closure - self.layer(inner.value);
            let step = residual * self.share(inner.tangent);
            closure += step;
            if step.abs() <= SETTLED * closure.abs() {
                let value = inner.value + inner.tangent * step;
                return Some(self.paired(Pressure { value, ..inner }));
            }
        }
        None
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

/// The curve of a law from a state of zero closure and pressure `origin`, and the layer in series.
struct SeriesCurve<P, D, K> {
    pressure: P,
    closure: D,
    stiffness: K,
    origin: f64,
    layer: f64,
}

/// A point of that curve.
#[derive(Clone, Copy)]
struct CurvePoint {
    closure: f64,
    pressure: f64,
    tangent: f64,
}

impl<P: Fn(f64) -> Pressure, D: Fn(f64) -> f64, K: Fn(f64) -> f64> SeriesCurve<P, D, K> {
    /// State of the law where `x + (p - origin) / K_layer = total`.
    ///
    /// Newton's method for the closure x of the law where the law is softer than the layer, for its
    /// pressure p where it is stiffer. Each equation then has a slope between once and twice that of
    /// its linear part, so that a step is never wrong by more than a factor of two. The bracket is
    /// halved instead where a step fails to halve the residual, as it may next to kinks.
    fn solve(&self, total: f64) -> Pressure {
        // The law alone or the layer alone reaches at least as far from the origin; the lesser of
        // the two bounds the root, and is finite.
        let alone = self.at_closure(total);
        let of_layer = self.layer * total;
        let mut at = if (alone.pressure - self.origin).abs() <= of_layer.abs() {
            alone
        } else {
            self.at_pressure(self.origin + of_layer)
        };
        let origin = CurvePoint { closure: 0.0, pressure: self.origin, tangent: 0.0 };
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
            // The residual is known to rounding; that of a law that is itself iterated only until
            // it no longer improves.
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
                // The step beyond an exact residual, else the best point.
                best.1 = if exact { at } else { best.1 };
                break;
            }
        }
        let CurvePoint { pressure: value, tangent, .. } = best.1;
        Pressure { value, tangent }
    }

    fn at_closure(&self, closure: f64) -> CurvePoint {
        let p = (self.pressure)(closure);
        CurvePoint { closure, pressure: p.value, tangent: p.tangent }
    }

    fn at_pressure(&self, pressure: f64) -> CurvePoint {
        CurvePoint {
            closure: (self.closure)(pressure),
            pressure,
            tangent: (self.stiffness)(pressure),
        }
    }
}

/// `v` if the iteration converges and it lies in the bracket, else the midpoint; the last step is
/// only clamped to the bracket.
fn bounded(v: f64, (low, high): (f64, f64), converges: bool, last: bool) -> f64 {
    if last {
        no_less(if v > high { high } else { v }, low)
    } else if converges && low <= v && v <= high {
        v
    } else {
        0.5 * (low + high)
    }
}

/// Laws in series, with an elastic layer if one is given: `1/K = sum 1/K_law + 1/K_layer`; exactly
/// one of law and laws.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, bound(deserialize = "R: Deserialize<'de>"))]
#[schemars(extend("oneOf" = [{"required": ["law"]}, {"required": ["laws"]}]))]
pub struct InSeriesSpec<R> {
    /// The one law in series with a layer: a name from "laws", or a law written in place; give
    /// this or laws.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "R")]
    pub law: Option<R>,
    /// Two or more laws, of contacts that carry the same pressure; give this or law.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(length(min = 2))]
    pub laws: Vec<R>,
    /// Stiffness `K_layer` of the elastic layer in Pa/m; without it the laws alone are in series.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub stiffness_pa_per_m: Option<f64>,
}

impl<R> InSeriesSpec<R> {
    /// References to the laws in series.
    pub fn inner_laws(&self) -> impl Iterator<Item = &R> {
        self.law.iter().chain(&self.laws)
    }

    /// Faults that the schema does not state: one law needs a layer.
    pub(crate) fn faults(&self) -> impl Iterator<Item = LawFault> {
        let missing = self.law.is_some() && self.stiffness_pa_per_m.is_none();
        let error = LawError::MissingKey("stiffness_pa_per_m");
        let accepted = "the stiffness of the layer in series with \"law\"; or two or more \"laws\"";
        missing.then_some(LawFault { pointer: String::new(), error, accepted }).into_iter()
    }
}
