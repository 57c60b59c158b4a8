//! The trait of contact laws, and the macro by which one law forwards to another.

pub(crate) mod inverse;
pub mod quadrature;

use std::fmt::Debug;
use std::sync::Arc;

use crate::domain::Domain;

pub(crate) use inverse::refine_increment;

/// Largest error of [`ContactLaw::interpolate`], over the pressure at the end of a polynomial.
pub(crate) const INTERPOLATION_ERROR: f64 = 1e-10;

/// Pressure and tangent from one call.
///
/// At a jump the tangent is the one-sided value towards higher closure: at first contact
/// `K(0+)`. Below first contact both fields are zero; at and beyond the closure limit both are
/// +inf.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pressure {
    /// Pressure `p` \[Pa\], or its increment, as stated by the function.
    pub value: f64,
    /// Tangent `dp/dd` \[Pa/m\].
    pub tangent: f64,
}

impl Pressure {
    /// The pressure of separated faces.
    pub const OPEN: Self = Self { value: 0.0, tangent: 0.0 };

    /// The pressure at and beyond the closure limit.
    pub const RIGID: Self = Self { value: f64::INFINITY, tangent: f64::INFINITY };

    /// The pressure increment from `from` \[Pa\] after loss of contact: exactly `-from`.
    pub const fn lost_from(from: f64) -> Self {
        Self { value: 0.0 - from, tangent: 0.0 }
    }
}

/// A pressure-dependent interface stiffness,
///
/// ```text
/// K(p) = dp/dd,    d(p) = integral of dp / K(p) from the reference pressure,    e = integral of p dd.
/// ```
///
/// An implementation supplies the first four methods. The others default to quadrature and a
/// safeguarded root, with a relative precision of about 1e-13; closed forms override them. A law
/// depends on the pressure only.
///
/// Source: Nouira et al., Lubricants 8, 73 (2020), Eq. (6), doi 10.3390/lubricants8070073.
///
/// Pressures below `domain().pressure_min` count as that minimum everywhere but in
/// [`stiffness`](Self::stiffness), which is zero there.
///
/// # Example
/// A new law, whose closures follow by quadrature:
/// ```
/// use asperity_law::{ContactLaw, Domain};
///
/// #[derive(Debug)]
/// struct Affine;
///
/// impl ContactLaw for Affine {
///     fn stiffness(&self, pressure: f64) -> f64 {
///         if pressure < 0.0 { 0.0 } else { 1e11 + 1e6 * pressure }
///     }
///     fn stiffness_slope(&self, pressure: f64) -> f64 {
///         if pressure < 0.0 { 0.0 } else { 1e6 }
///     }
///     fn domain(&self) -> Domain {
///         Domain { pressure_min: 0.0, closure_lost: Some(0.0), closure_limit: f64::INFINITY }
///     }
///     fn reference_pressure(&self) -> f64 {
///         0.0
///     }
/// }
///
/// let exact = 1e-6 * (1e6 * 2e5 / 1e11_f64).ln_1p();
/// assert!((Affine.closure(2e5) / exact - 1.0).abs() < 1e-13);
/// assert!((Affine.pressure(exact).value / 2e5 - 1.0).abs() < 1e-13);
/// ```
pub trait ContactLaw: Debug + Send + Sync {
    /// Stiffness `K(p) = dp/dd` \[Pa/m\] at `pressure` \[Pa\].
    ///
    /// Zero below `domain().pressure_min`; at zero pressure the right-hand limit.
    fn stiffness(&self, pressure: f64) -> f64;

    /// Slope `dK/dp` \[1/m\] at `pressure` \[Pa\]; at a kink that of the higher pressures.
    ///
    /// +inf where K leaves zero with a vertical tangent.
    fn stiffness_slope(&self, pressure: f64) -> f64;

    /// Pressures and closures for which the law is defined.
    fn domain(&self) -> Domain;

    /// Pressure \[Pa\] at which the closure counts zero; 0 for most laws that separate.
    fn reference_pressure(&self) -> f64;

    /// Pressures \[Pa\], ascending, where K or its slope is not smooth; quadrature splits there.
    fn kinks(&self) -> Vec<f64> {
        Vec::new()
    }

    /// Range of the measured pressures \[Pa\]; outside it the law is extrapolated. `None` for a law
    /// given by a formula.
    fn measured_range(&self) -> Option<(f64, f64)> {
        None
    }

    /// Closure `d(p) = integral of dp / K` \[m\] from the reference pressure to `pressure` \[Pa\].
    ///
    /// -inf at zero pressure for a law that never separates.
    fn closure(&self, pressure: f64) -> f64 {
        let reference = self.reference_pressure();
        quadrature::closure_between(self, reference, pressure)
    }

    /// Closure increment \[m\] when the pressure rises from `from` by `increment` \[Pa\].
    ///
    /// In contrast to a difference of closures it keeps its relative precision for small increments.
    /// `from` must lie in the domain, and be positive for a law that never separates.
    fn closure_increment(&self, from: f64, increment: f64) -> f64 {
        quadrature::closure_increment(self, from, increment)
    }

    /// Pressure `p(d)` \[Pa\] and tangent at `closure` \[m\]: the inverse of
    /// [`closure`](Self::closure).
    fn pressure(&self, closure: f64) -> Pressure {
        inverse::pressure(self, closure)
    }

    /// Pressure increment \[Pa\], and tangent, when the closure grows by `closure_increment` \[m\]
    /// from the closure at pressure `from` \[Pa\]: the inverse of
    /// [`closure_increment`](Self::closure_increment).
    ///
    /// Keeps its relative precision for small increments; exactly `-from` after loss of contact. Valid where `closure_increment` is.
    fn pressure_increment(&self, from: f64, closure_increment: f64) -> Pressure {
        inverse::pressure_increment(self, from, closure_increment)
    }

    /// Pressure increment, and tangent, over a small `closure_increment` \[m\] of either sign from pressure
    /// `from` \[Pa\]: a Runge-Kutta step of `dp/dd = K(p)`, corrected by Newton steps on the closure, which is
    /// far cheaper than [`pressure_increment`](Self::pressure_increment) of a law without a closed inverse.
    ///
    /// `None` where pressure or stiffness is not positive, or two corrections do not suffice.
    fn pressure_step(&self, from: f64, closure_increment: f64) -> Option<Pressure> {
        let closure = |increment| self.closure_increment(from, increment);
        inverse::step((from, closure_increment), |pressure| self.stiffness(pressure), closure)
    }

    /// Pressures and tangents at `closures` \[m\], best in order, cheaper than by [`pressure`](Self::pressure): from
    /// polynomials, to within 1e-10 of the pressure at the end of the polynomial, or in closed form. `false`, and nothing
    /// found, for a law without either.
    fn interpolate(&self, _closures: &[f64], _found: &mut Vec<Pressure>) -> bool {
        false
    }

    /// Stored energy `integral of p dd` \[J/m2\] at `closure` \[m\].
    ///
    /// Counted from first contact for a law that separates (zero when open), otherwise from the
    /// closure at the reference pressure (negative below it). Its derivative is the pressure.
    fn energy(&self, closure: f64) -> f64 {
        let domain = self.domain();
        if closure.is_nan() {
            return closure;
        }
        if domain.is_open(closure) {
            return 0.0;
        }
        let start = if domain.separates() { 0.0 } else { self.reference_pressure() };
        quadrature::work_between(self, start, self.pressure(closure).value)
    }
}

/// The methods that depend on the stiffness, forwarded to another law.
macro_rules! forward {
    ($self:ident => $law:expr) => {
        fn stiffness(&$self, pressure: f64) -> f64 {
            $law.stiffness(pressure)
        }
        fn stiffness_slope(&$self, pressure: f64) -> f64 {
            $law.stiffness_slope(pressure)
        }
        fn domain(&$self) -> $crate::Domain {
            $law.domain()
        }
        fn reference_pressure(&$self) -> f64 {
            $law.reference_pressure()
        }
        fn closure(&$self, pressure: f64) -> f64 {
            $law.closure(pressure)
        }
        fn closure_increment(&$self, from: f64, increment: f64) -> f64 {
            $law.closure_increment(from, increment)
        }
        fn pressure(&$self, closure: f64) -> $crate::Pressure {
            $law.pressure(closure)
        }
        fn pressure_increment(&$self, from: f64, closure_increment: f64) -> $crate::Pressure {
            $law.pressure_increment(from, closure_increment)
        }
        fn pressure_step(&$self, from: f64, closure_increment: f64) -> Option<$crate::Pressure> {
            $law.pressure_step(from, closure_increment)
        }
        fn interpolate(&$self, closures: &[f64], found: &mut Vec<$crate::Pressure>) -> bool {
            $law.interpolate(closures, found)
        }
        fn energy(&$self, closure: f64) -> f64 {
            $law.energy(closure)
        }
    };
}
pub(crate) use forward;

/// Pointers to a law are laws.
macro_rules! pointers {
    ($($pointer:ty),*) => {$(
        impl<T: ContactLaw + ?Sized> ContactLaw for $pointer {
            forward!(self => (**self));
            fn kinks(&self) -> Vec<f64> {
                (**self).kinks()
            }
            fn measured_range(&self) -> Option<(f64, f64)> {
                (**self).measured_range()
            }
        }
    )*};
}

pointers!(Arc<T>, Box<T>, &T);
