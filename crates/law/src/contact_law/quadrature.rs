//! Closure and work of any law, by adaptive Gauss-Legendre quadrature of `1/K` and `p/K`.
//!
//! Panels are linear in pressure where the range is short compared with the pressure, else
//! logarithmic. Next to zero pressure K may vanish like p^m: the part of the integral below the
//! panels then follows from the local exponent `m = p K'/K`, and panels are added downwards until
//! the sum no longer changes, over fourteen decades at least: a soft layer that is closed at a few Pa
//! has no part in the exponent far above. The functions serve implementations of new laws.

use super::ContactLaw;
use crate::domain::no_less;

/// Points and weights of the 10-point Gauss-Legendre rule on (0, 1).
pub(crate) const GAUSS: [(f64, f64); 10] = [
    (0.013_046_735_741_414_14, 0.033_335_672_154_344_07),
    (0.067_468_316_655_507_75, 0.074_725_674_575_290_3),
    (0.160_295_215_850_487_8, 0.109_543_181_257_991_02),
    (0.283_302_302_935_376_4, 0.134_633_359_654_998_17),
    (0.425_562_830_509_184_4, 0.147_762_112_357_376_44),
    (0.574_437_169_490_815_6, 0.147_762_112_357_376_44),
    (0.716_697_697_064_623_6, 0.134_633_359_654_998_17),
    (0.839_704_784_149_512_2, 0.109_543_181_257_991_02),
    (0.932_531_683_344_492_3, 0.074_725_674_575_290_3),
    (0.986_953_264_258_585_9, 0.033_335_672_154_344_07),
];

/// Points and weights of the 4-point rule on (0, 1).
const GAUSS_SHORT: [(f64, f64); 4] = [
    (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
    (0.330_009_478_207_571_87, 0.326_072_577_431_273_07),
    (0.669_990_521_792_428_1, 0.326_072_577_431_273_07),
    (0.930_568_155_797_026_3, 0.173_927_422_568_726_93),
];

/// A panel is accepted when its two halves agree with it to this relative difference; the halves,
/// which are kept, are closer to the integral by three digits at least.
const AGREEMENT: f64 = 1e-13;

/// Bisections of a panel at most; what is left of a hidden kink is then 2^-24 of the panel.
const DEPTH: u32 = 24;

/// Panels of one integral at most, should the integrand be noise.
const BUDGET: usize = 4096;

/// Ratio of the end pressures of a logarithmic panel.
const RATIO: f64 = 16.0;

/// Logarithmic panels above zero pressure at least, where the integral is finite.
const PANELS: usize = 12;

/// Closure increment \[m\] from pressure `from` to pressure `to` \[Pa\] by quadrature of `1/K`.
///
/// Relative precision about 1e-13 for a law smooth between its kinks. -inf if `to` is zero and
/// the law never separates. Pressures below the law's minimum count as the minimum.
pub fn closure_between<L: ContactLaw + ?Sized>(law: &L, from: f64, to: f64) -> f64 {
    between(law, Weight::One, from, to)
}

/// Closure increment \[m\] from pressure `from` over `increment` \[Pa\] by quadrature of `1/K`,
/// with its relative precision kept for small increments.
pub fn closure_increment<L: ContactLaw + ?Sized>(law: &L, from: f64, increment: f64) -> f64 {
    let to = from + increment;
    let short = increment.abs() < 0.5 * from.abs();
    if to < law.domain().pressure_min || !short {
        return between(law, Weight::One, from, to);
    }
    // Panels in the increment itself, split at the kinks on the way.
    let ahead = |at: &f64| at * increment > 0.0 && at.abs() < increment.abs();
    let mut edges: Vec<f64> = law.kinks().iter().map(|k| k - from).filter(ahead).collect();
    if increment < 0.0 {
        edges.reverse();
    }
    edges.push(increment);
    let mut start = 0.0;
    let mut total = 0.0;
    for stop in edges {
        total += adaptive(&|s| 1.0 / law.stiffness(from + s), start, stop - start);
        start = stop;
    }
    total
}

/// Work \[J/m2\] done from pressure `from` to pressure `to` \[Pa\] by quadrature of `p/K`.
pub fn work_between<L: ContactLaw + ?Sized>(law: &L, from: f64, to: f64) -> f64 {
    between(law, Weight::Pressure, from, to)
}

/// The factor of `1/K` in the integrand.
#[derive(Clone, Copy)]
enum Weight {
    One,
    Pressure,
}

impl Weight {
    fn at(self, pressure: f64) -> f64 {
        match self {
            Self::One => 1.0,
            Self::Pressure => pressure,
        }
    }

    /// Power of the pressure, for the rest below the panels.
    fn degree(self) -> f64 {
        match self {
            Self::One => 0.0,
            Self::Pressure => 1.0,
        }
    }
}

/// Integral of `weight / K` between two pressures, signed.
fn between<L: ContactLaw + ?Sized>(law: &L, weight: Weight, from: f64, to: f64) -> f64 {
    let minimum = law.domain().pressure_min;
    let (from, to) = (no_less(from, minimum), no_less(to, minimum));
    if from.is_nan() || to.is_nan() {
        return f64::NAN;
    }
    if from > to {
        return -between(law, weight, to, from);
    }
    if from == to {
        return 0.0;
    }
    let mut edges = vec![from];
    edges.extend(law.kinks().into_iter().filter(|k| from < *k && *k < to));
    edges.push(to);

    let mut total = 0.0;
    for pair in edges.windows(2).rev() {
        let &[a, b] = pair else { continue };
        total += if minimum < 0.0 || b <= 2.0 * a {
            linear(law, weight, a, b)
        } else if a > 0.0 {
            logarithmic(law, weight, a, b)
        } else {
            from_zero(law, weight, b)
        };
    }
    total
}

/// A panel in pressure.
fn linear<L: ContactLaw + ?Sized>(law: &L, weight: Weight, a: f64, b: f64) -> f64 {
    adaptive(&|p| weight.at(p) / law.stiffness(p), a, b - a)
}

/// Panels in the logarithm of pressure, 0 < a < b.
fn logarithmic<L: ContactLaw + ?Sized>(law: &L, weight: Weight, a: f64, b: f64) -> f64 {
    let log = (b / a).ln();
    if !log.is_finite() {
        return f64::NAN;
    }
    let panels = (log / RATIO.ln()).ceil().max(1.0);
    let width = log / panels;
    let integrand = |t: f64| {
        let p = a * t.exp();
        p * weight.at(p) / law.stiffness(p)
    };
    let mut total = 0.0;
    for i in 0..panels as usize {
        total += adaptive(&integrand, i as f64 * width, width);
    }
    total
}

/// From zero pressure to `b`, no kink between: panels downwards, and the rest below them from the
/// local exponent, until the two agree; +inf if the integral diverges.
fn from_zero<L: ContactLaw + ?Sized>(law: &L, weight: Weight, b: f64) -> f64 {
    let rest = |p: f64| {
        let k = law.stiffness(p);
        let exponent = p * law.stiffness_slope(p) / k;
        let order = 1.0 + weight.degree() - exponent;
        if order > 0.0 { p * weight.at(p) / (k * order) } else { f64::INFINITY }
    };
    let mut top = b;
    let mut sum = 0.0;
    let mut estimate = rest(b);
    let mut panels = 0;
    while top > f64::MIN_POSITIVE * RATIO {
        let bottom = top / RATIO;
        sum += logarithmic(law, weight, bottom, top);
        top = bottom;
        panels += 1;
        let next = sum + rest(bottom);
        let settled = (next - estimate).abs() <= 2.0 * f64::EPSILON * next;
        estimate = next;
        if settled && estimate.is_finite() && panels >= PANELS {
            break;
        }
    }
    estimate
}

/// The ten-point rule over a signed `width` from `start`.
pub(crate) fn gauss(f: &impl Fn(f64) -> f64, start: f64, width: f64) -> f64 {
    let sum: f64 = GAUSS.iter().map(|(t, w)| w * f(start + width * t)).sum();
    sum * width
}

/// The four-point rule, for integrands that change little over the width.
pub(crate) fn gauss_short(f: &impl Fn(f64) -> f64, start: f64, width: f64) -> f64 {
    let sum: f64 = GAUSS_SHORT.iter().map(|(t, w)| w * f(start + width * t)).sum();
    sum * width
}

/// Integral of `f` over a signed `width` from `start`, bisecting panels until halves agree.
pub(crate) fn adaptive(f: &impl Fn(f64) -> f64, start: f64, width: f64) -> f64 {
    let mut stack = vec![(start, width, gauss(f, start, width), 0)];
    let mut total = 0.0;
    let mut spent = 0;
    while let Some((a, w, whole, depth)) = stack.pop() {
        let half = 0.5 * w;
        let left = gauss(f, a, half);
        let right = gauss(f, a + half, half);
        spent += 1;
        let off = (left + right - whole).abs() > AGREEMENT * (left + right).abs();
        // Wide panels may agree by accident: every panel is halved once.
        if depth == 0 || (off && depth < DEPTH && spent < BUDGET) {
            stack.push((a, half, left, depth + 1));
            stack.push((a + half, half, right, depth + 1));
        } else {
            total += left + right;
        }
    }
    total
}
