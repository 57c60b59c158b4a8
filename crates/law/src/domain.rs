//! The range in which a law is defined.

/// The pressures and closures for which a contact law is defined.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Domain {
    /// Lowest pressure \[Pa\]: 0, or -inf for a bilateral law, which carries tension.
    pub pressure_min: f64,
    /// Closure \[m\] at which contact is lost; below it the faces are apart and the pressure is
    /// zero. `None` if contact is never lost at a finite closure.
    pub closure_lost: Option<f64>,
    /// Supremum of the closures \[m\]; +inf unless the law becomes rigid at a finite closure.
    pub closure_limit: f64,
}

impl Domain {
    /// The domain of a law that carries tension and never becomes rigid.
    pub const BILATERAL: Self =
        Self { pressure_min: f64::NEG_INFINITY, closure_lost: None, closure_limit: f64::INFINITY };

    /// True if contact is lost at a finite closure.
    pub fn separates(&self) -> bool {
        self.closure_lost.is_some()
    }

    /// True if the law carries tension.
    pub fn is_bilateral(&self) -> bool {
        self.pressure_min < 0.0
    }

    /// True if the faces are apart at `closure` \[m\]; at the closure of first contact they touch.
    pub fn is_open(&self, closure: f64) -> bool {
        self.closure_lost.is_some_and(|lost| closure < lost)
    }
}

/// The greater of `value` and `low`; unlike [`f64::max`] it propagates NaN.
pub(crate) fn no_less(value: f64, low: f64) -> f64 {
    if value < low { low } else { value }
}
