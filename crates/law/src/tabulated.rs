//! Stiffness measured at some pressures.

use crate::contact_law::{ContactLaw, forward};
use crate::error::{LawError, LawQuantity, above, at_least, increasing};
use crate::pchip;
use crate::power::Power;
use crate::spliced::{Spliced, SplicedNode};

/// Piecewise monotone cubic K(p) through measured pairs of pressure and stiffness, constant outside
/// them.
///
/// Between points K is monotone (PCHIP), so that it stays between their stiffnesses and positive;
/// the data as a whole need not be monotone. Contact is lost at zero closure. With two points of
/// equal stiffness it is the unilateral spring. Valid within
/// [`measured_range`](ContactLaw::measured_range); outside the law is extrapolated.
///
/// Source of the interpolant: Fritsch and Butland, SIAM J. Sci. Stat. Comput. 5, 300 (1984),
/// doi 10.1137/0905021.
///
/// # Example
/// ```
/// use asperity_law::{ContactLaw, LawError, Tabulated};
///
/// let law = Tabulated::new(&[(0.14e6, 1.15e12), (0.35e6, 1.75e12), (1e6, 2.46e12)])?;
/// assert!((law.pressure(law.closure(0.5e6)).value / 0.5e6 - 1.0).abs() < 1e-14);
/// assert_eq!(law.measured_range(), Some((0.14e6, 1e6)));
/// # Ok::<(), LawError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Tabulated {
    spliced: Spliced,
    points: Vec<(f64, f64)>,
}

impl Tabulated {
    /// The law through `points` (pressure \[Pa\], stiffness \[Pa/m\]), at least two, with pressures
    /// from zero on, strictly increasing, and positive stiffnesses.
    ///
    /// # Errors
    /// [`LawError`] if the points are outside these limits or not finite.
    pub fn new(points: &[(f64, f64)]) -> Result<Self, LawError> {
        let (&[(first, held_below), _, ..], Some(&(last, held_above))) = (points, points.last())
        else {
            return Err(LawError::Below {
                quantity: LawQuantity::Points,
                value: points.len() as f64,
                limit: 2.0,
            });
        };
        at_least(LawQuantity::Pressure, first, 0.0)?;
        increasing(LawQuantity::Pressure, points.iter().map(|point| point.0))?;
        for point in points {
            above(LawQuantity::Stiffness, point.1, 0.0)?;
        }
        let mut pieces = pchip::pieces(points, &pchip::slopes(points));
        if first > 0.0 {
            let held = |pressure| SplicedNode { pressure, stiffness: held_below, slope: 0.0 };
            pieces.insert(0, [held(0.0), held(first)]);
        }
        Ok(Self {
            spliced: Spliced::new(&pieces, Power::new(held_above, 0.0, last)?),
            points: points.to_vec(),
        })
    }

    /// The points (pressure \[Pa\], stiffness \[Pa/m\]).
    pub fn points(&self) -> &[(f64, f64)] {
        &self.points
    }
}

impl ContactLaw for Tabulated {
    forward!(self => self.spliced);

    fn kinks(&self) -> Vec<f64> {
        self.points.iter().map(|point| point.0).collect()
    }

    fn measured_range(&self) -> Option<(f64, f64)> {
        Some((self.points.first()?.0, self.points.last()?.0))
    }
}
