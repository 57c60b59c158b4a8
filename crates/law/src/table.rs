//! Stiffness measured at some pressures.

use crate::domain::Domain;
use crate::error::{LawError, Quantity, above, at_least, increasing};
use crate::law::{ContactLaw, Pressure};
use crate::pchip;
use crate::power::Power;
use crate::spliced::{Node, Spliced};

/// Monotone cubic through measured pairs of pressure and stiffness, held at the end values
/// outside them.
///
/// Between points K is monotone (PCHIP), so that it stays between their stiffnesses and positive;
/// the data as a whole need not be monotone. Contact is lost at zero closure. With two points of
/// equal stiffness it is the unilateral spring. Outside
/// [`measured_range`](ContactLaw::measured_range) the law is an assumption.
///
/// Source of the interpolant: Fritsch and Butland, SIAM J. Sci. Stat. Comput. 5, 300 (1984),
/// doi 10.1137/0905021.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    spliced: Spliced,
    points: Vec<(f64, f64)>,
}

impl Table {
    /// The law through `points` (pressure \[Pa\], stiffness \[Pa/m\]), at least two, with pressures
    /// from zero on, strictly increasing, and positive stiffnesses.
    ///
    /// # Errors
    /// [`LawError`] if the points are outside these limits or not finite.
    pub fn new(points: &[(f64, f64)]) -> Result<Self, LawError> {
        let (&[(first, held_below), _, ..], Some(&(last, held_above))) = (points, points.last())
        else {
            return Err(LawError::Below {
                quantity: Quantity::Points,
                value: points.len() as f64,
                limit: 2.0,
            });
        };
        at_least(Quantity::Pressure, first, 0.0)?;
        increasing(Quantity::Pressure, points.iter().map(|point| point.0))?;
        for point in points {
            above(Quantity::Stiffness, point.1, 0.0)?;
        }
        let mut pieces = pchip::pieces(points, &pchip::slopes(points));
        if first > 0.0 {
            let held = |pressure| Node { pressure, stiffness: held_below, slope: 0.0 };
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

impl ContactLaw for Table {
    fn stiffness(&self, pressure: f64) -> f64 {
        self.spliced.stiffness(pressure)
    }

    fn stiffness_slope(&self, pressure: f64) -> f64 {
        self.spliced.stiffness_slope(pressure)
    }

    fn domain(&self) -> Domain {
        self.spliced.domain()
    }

    fn reference_pressure(&self) -> f64 {
        0.0
    }

    fn kinks(&self) -> Vec<f64> {
        self.points.iter().map(|point| point.0).collect()
    }

    fn measured_range(&self) -> Option<(f64, f64)> {
        Some((self.points.first()?.0, self.points.last()?.0))
    }

    fn closure(&self, pressure: f64) -> f64 {
        self.spliced.closure(pressure)
    }

    fn closure_increment(&self, from: f64, increment: f64) -> f64 {
        self.spliced.closure_increment(from, increment)
    }

    fn pressure(&self, closure: f64) -> Pressure {
        self.spliced.pressure(closure)
    }

    fn pressure_increment(&self, from: f64, closure_increment: f64) -> Pressure {
        self.spliced.pressure_increment(from, closure_increment)
    }

    fn energy(&self, closure: f64) -> f64 {
        self.spliced.energy(closure)
    }
}
