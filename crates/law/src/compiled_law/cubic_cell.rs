//! One cell of a tabulated law.

/// One cell of a [`CompiledLaw`](crate::CompiledLaw): a cubic and the closures for which it holds.
///
/// Finding the cell of a closure is a longer chain of dependent instructions than evaluating the
/// cubic. Closures of a motion stay in one cell for many steps: a caller that keeps the cell and
/// tests [`contains`](Self::contains) leaves the search to branch prediction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CubicCell {
    pub(crate) from: f64,
    pub(crate) to: f64,
    pub(crate) cells_per_metre: f64,
    pub(crate) offset: f64,
    pub(crate) cubic: [f64; 4],
}

impl CubicCell {
    /// A cell that contains nothing.
    pub const EMPTY: Self = Self {
        from: f64::INFINITY,
        to: f64::NEG_INFINITY,
        cells_per_metre: 0.0,
        offset: 0.0,
        cubic: [f64::NAN; 4],
    };

    /// True if closure increment `x` \[m\] lies in this cell.
    #[inline(always)]
    pub fn contains(&self, x: f64) -> bool {
        self.from <= x && x < self.to
    }

    /// Pressure increment \[Pa\] at closure increment `x` \[m\] in this cell, with the caller's
    /// `multiply_add(a, b, c) = a b + c`: one instruction where the machine has it.
    #[inline(always)]
    pub fn get(&self, x: f64, multiply_add: impl Fn(f64, f64, f64) -> f64) -> f64 {
        let [c0, c1, c2, c3] = self.cubic;
        let t = multiply_add(x, self.cells_per_metre, self.offset);
        multiply_add(multiply_add(multiply_add(c3, t, c2), t, c1), t, c0)
    }
}
