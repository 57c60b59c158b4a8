//! Stiffness measured at some pressures.

use std::sync::Arc;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::contact_law::{ContactLaw, forward};
use crate::draw::{Draw, rounded};
use crate::error::{LawError, LawQuantity, above, at_least, rising};
use crate::law_form::{LawFault, LawForm};
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
        LawFault::first(faults(points.iter().copied()))?;
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

/// Faults of points (pressure \[Pa\], stiffness \[Pa/m\]).
fn faults(points: impl Iterator<Item = (f64, f64)> + Clone) -> impl Iterator<Item = LawFault> {
    let before = std::iter::once(None).chain(points.clone().map(|point| Some(point.0)));
    before.zip(points).enumerate().flat_map(|(row, (before, (p, k)))| {
        let place = |column| move || format!("/points/{row}/{column}");
        let rises = rising(LawQuantity::Pressure, row, p, before);
        let (pressure, stiffness) =
            (at_least(LawQuantity::Pressure, p, 0.0), above(LawQuantity::Stiffness, k, 0.0));
        [
            LawFault::of(pressure, place(0), "a pressure of at least 0 Pa"),
            LawFault::of(rises, place(0), "a number greater than the one in the row before"),
            LawFault::of(stiffness, place(1), "a stiffness greater than 0 Pa/m"),
        ]
        .into_iter()
        .flatten()
    })
}

/// Smooth monotone curve through measured points, constant outside them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TableSpec {
    /// Pairs [pressure in Pa, stiffness in Pa/m], pressures increasing.
    #[schemars(length(min = 2))]
    pub points: Vec<[f64; 2]>,
}

impl LawForm for TableSpec {
    fn faults(&self) -> Box<dyn Iterator<Item = LawFault> + '_> {
        Box::new(faults(self.points.iter().map(|&[p, k]| (p, k))))
    }

    fn highest_pressure(&self) -> f64 {
        self.points.last().map_or(0.0, |point| point[0])
    }

    fn build(&self, _static_pressure: f64) -> Result<Arc<dyn ContactLaw>, LawError> {
        let points: Vec<_> = self.points.iter().map(|&[p, k]| (p, k)).collect();
        Ok(Arc::new(Tabulated::new(&points)?))
    }

    fn sample(draw: &mut dyn Draw, pressure: f64, stiffness: f64) -> Self {
        let exponent = draw.uniform(0.1, 0.8);
        let count = draw.whole(2..=7);
        let (low, high) =
            (pressure * draw.log_uniform(0.02, 0.5), pressure * draw.log_uniform(2.0, 50.0));
        let mut points = Vec::with_capacity(count + 1);
        if draw.chance(0.6) {
            let at_zero = stiffness * (low / pressure).powf(exponent) * draw.uniform(0.2, 0.9);
            points.push([0.0, rounded(at_zero)]);
        }
        for at in 0..count {
            let place = low * (high / low).powf(at as f64 / (count - 1) as f64);
            let scatter = draw.log_uniform(0.85, 1.18);
            let value = stiffness * (place / pressure).powf(exponent) * scatter;
            points.push([rounded(place), rounded(value)]);
        }
        Self { points }
    }
}
