//! Where a law is defined.

/// The pressures and closures a contact law admits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Domain {
    /// Lowest pressure \[Pa\]: 0, or -inf for a bilateral law, which carries tension.
    pub pressure_min: f64,
    /// Closure at zero pressure \[m\] of a law that separates there; below it the faces are
    /// apart and the pressure is zero. `None` if contact is never lost at a finite closure.
    pub closure_lost: Option<f64>,
    /// Supremum of the closures \[m\]; +inf unless the law becomes rigid at a finite closure.
    pub closure_limit: f64,
}

impl Domain {
    /// The domain of a law that carries tension and never becomes rigid.
    pub const BILATERAL: Self =
        Self { pressure_min: f64::NEG_INFINITY, closure_lost: None, closure_limit: f64::INFINITY };

    /// Whether contact is lost at a finite closure.
    pub fn separates(&self) -> bool {
        self.closure_lost.is_some()
    }

    /// Whether the law carries tension.
    pub fn is_bilateral(&self) -> bool {
        self.pressure_min < 0.0
    }

    /// Whether the faces are apart at `closure` \[m\]; at the very closure of first contact they
    /// still touch.
    pub fn is_open(&self, closure: f64) -> bool {
        self.closure_lost.is_some_and(|lost| closure < lost)
    }
}

/// The greater of `value` and `low`; unlike [`f64::max`] it lets a NaN through.
pub(crate) fn no_less(value: f64, low: f64) -> f64 {
    if value < low { low } else { value }
}
