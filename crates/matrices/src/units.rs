//! Units of matrices and meshes.

use crate::{Dof, Matrices, MatricesError};

/// The units of a file in metre, kilogram and second.
///
/// Finite-element programs have no units of their own. Millimetre, tonne and second, for example, are
/// `MatrixUnits::new(1e-3, 1e3, 1.0)`; forces are then in newton.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MatrixUnits {
    length_m: f64,
    mass_kg: f64,
    time_s: f64,
}

impl MatrixUnits {
    /// Metre, kilogram, second.
    pub const SI: Self = Self { length_m: 1.0, mass_kg: 1.0, time_s: 1.0 };

    /// Units of `length_m` metres, `mass_kg` kilograms and `time_s` seconds.
    ///
    /// # Errors
    /// If one of them is not positive and finite.
    pub fn new(length_m: f64, mass_kg: f64, time_s: f64) -> Result<Self, MatricesError> {
        for (name, value) in [("length_m", length_m), ("mass_kg", mass_kg), ("time_s", time_s)] {
            if !(value > 0.0 && value.is_finite()) {
                let what = format!("the unit {name} is {value}");
                return Err(MatricesError::inconsistent(what, "expected a positive number"));
            }
        }
        Ok(Self { length_m, mass_kg, time_s })
    }

    /// The unit of length in m.
    pub fn length_m(self) -> f64 {
        self.length_m
    }
}

impl Matrices {
    /// Converts matrices from `units` to SI: with the units `L`, `m`, `t`,
    ///
    /// ```text
    /// K(i, j) *= m / t^2 L^r,        M(i, j) *= m L^r,
    /// ```
    ///
    /// where `r` is the number of rotations among the degrees of freedom of row and column.
    pub fn convert(&mut self, units: MatrixUnits) {
        if units == MatrixUnits::SI {
            return;
        }
        let (mass, stiffness) = (units.mass_kg, units.mass_kg / (units.time_s * units.time_s));
        let arm = |dof: Dof| if dof.is_rotation() { units.length_m } else { 1.0 };
        self.scale(|row, column| {
            let power = arm(row) * arm(column);
            [stiffness * power, mass * power]
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::SparseSymmetric;

    #[test]
    fn millimetre_tonne_second_become_metre_kilogram_second() {
        // A beam element with a rotation in mm, t, s: N/mm, N, N mm; t, t mm, t mm^2.
        let matrix = |u: f64, both: f64, rotation: f64| {
            SparseSymmetric::from_triplets(2, [(0, 0, u), (1, 0, both), (1, 1, rotation)])
        };
        let dofs = vec![Dof::new(1, 2), Dof::new(1, 6)];
        let mut matrices =
            Matrices::new(matrix(5.0, 7.0, 9.0), matrix(2e-3, 3e-3, 4e-3), dofs.clone()).unwrap();
        matrices.convert(MatrixUnits::new(1e-3, 1e3, 1.0).unwrap());
        // N/m, N, N m; kg, kg m, kg m^2.
        let expected =
            Matrices::new(matrix(5e3, 7.0, 9e-3), matrix(2.0, 3e-3, 4e-6), dofs).unwrap();
        for (found, expected) in
            [(matrices.stiffness(), expected.stiffness()), (matrices.mass(), expected.mass())]
        {
            for (a, b) in found.values().iter().zip(expected.values()) {
                assert!((a - b).abs() <= 1e-15 * b.abs(), "{a} {b}");
            }
        }
    }

    #[test]
    fn a_unit_is_positive() {
        let error = MatrixUnits::new(0.0, 1.0, 1.0).unwrap_err().to_string();
        assert_eq!(error, "the unit length_m is 0; expected a positive number");
        assert!(MatrixUnits::new(1.0, f64::NAN, 1.0).is_err());
    }
}
