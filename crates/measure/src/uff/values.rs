//! Numbers of some points of a function.

use num_complex::Complex64;

/// The numbers of some points of a function.
pub(super) struct Values {
    pub(super) abscissae: Vec<f64>,
    pub(super) real: Vec<f64>,
    pub(super) complex: Vec<Complex64>,
}

impl Values {
    /// Space for `count` points, a number the caller has checked.
    pub(super) fn for_points(count: usize, even: bool, complex: bool) -> Self {
        Self {
            abscissae: Vec::with_capacity(if even { 0 } else { count }),
            real: Vec::with_capacity(if complex { 0 } else { count }),
            complex: Vec::with_capacity(if complex { count } else { 0 }),
        }
    }
}
