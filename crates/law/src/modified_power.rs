//! The power law, softened at low pressure.

use crate::contact_law::{ContactLaw, forward};
use crate::error::{LawError, LawQuantity, above, at_least, increasing};
use crate::pchip;
use crate::power::Power;
use crate::spliced::Spliced;

/// Modified power law: `K = C p^m` for `p >= p_t`, a monotone cubic through knots for `p < p_t`.
///
/// The knots lead from zero pressure, where K(0) > 0, to the transition pressure `p_t`; the cubic
/// is once continuously differentiable, with PCHIP slopes at the knots and the slope of the power
/// law, `m C p_t^(m-1)`, at the transition. Contact is lost at zero closure. With refined knots on
/// a power law it tends to that law.
///
/// Source: "Modified PL" of Nouira et al., Lubricants 8, 73 (2020), doi 10.3390/lubricants8070073,
/// who give no formula; the pairs of pressure and stiffness quoted there serve as knots. Monotone
/// slopes: Fritsch and Carlson, SIAM J. Numer. Anal. 17, 238 (1980), doi 10.1137/0717021.
///
/// # Example
/// ```
/// use asperity_law::{ContactLaw, LawError, ModifiedPower};
///
/// let knots = [(0.0, 0.02e12), (0.025e6, 0.12e12), (0.078e6, 0.40e12), (0.14e6, 0.97e12)];
/// let law = ModifiedPower::new(1.81e10, 0.35, 0.2e6, &knots)?;
/// assert!((law.stiffness(0.14e6) / 0.97e12 - 1.0).abs() < 1e-12);
/// assert!((law.stiffness(0.2e6) / 1.297e12 - 1.0).abs() < 1e-3);
/// # Ok::<(), LawError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ModifiedPower {
    spliced: Spliced,
    power: Power,
    knots: Vec<(f64, f64)>,
}

impl ModifiedPower {
    /// The law of `coefficient` C > 0 \[Pa^(1-m)/m\] and `exponent` m >= 0 above
    /// `transition_pressure` > 0 \[Pa\], and of `knots` (pressure \[Pa\], stiffness \[Pa/m\]) below.
    ///
    /// The knots start at pressure zero with positive stiffness, and pressure and stiffness both
    /// increase strictly from knot to knot and on to the transition.
    ///
    /// # Errors
    /// [`LawError`] if a parameter or knot is outside these limits or not finite, and
    /// [`LawError::Above`] with [`LawQuantity::TransitionSlope`] if the power law's slope at the
    /// transition is too steep for a monotone cubic from the last knot: move that knot.
    pub fn new(
        coefficient: f64,
        exponent: f64,
        transition_pressure: f64,
        knots: &[(f64, f64)],
    ) -> Result<Self, LawError> {
        above(LawQuantity::TransitionPressure, transition_pressure, 0.0)?;
        let power = Power::new(coefficient, exponent, transition_pressure)?;
        let &[(first, softest), ..] = knots else {
            return Err(LawError::Below { quantity: LawQuantity::Points, value: 0.0, limit: 1.0 });
        };
        at_least(LawQuantity::Pressure, first, 0.0)?;
        if first > 0.0 {
            return Err(LawError::Above {
                quantity: LawQuantity::Pressure,
                value: first,
                limit: 0.0,
            });
        }
        above(LawQuantity::Stiffness, softest, 0.0)?;
        let mut points = knots.to_vec();
        points.push((transition_pressure, power.stiffness(transition_pressure)));
        increasing(LawQuantity::Pressure, points.iter().map(|point| point.0))?;
        increasing(LawQuantity::Stiffness, points.iter().map(|point| point.1))?;

        let mut slopes = pchip::slopes(&points);
        let last = points.len() - 1;
        let joint = power.stiffness_slope(transition_pressure);
        let secant = (points[last].1 - points[last - 1].1) / (points[last].0 - points[last - 1].0);
        let limit = secant * pchip::steepest(slopes[last - 1] / secant);
        if joint > limit {
            return Err(LawError::Above {
                quantity: LawQuantity::TransitionSlope,
                value: joint,
                limit,
            });
        }
        slopes[last] = joint;
        Ok(Self {
            spliced: Spliced::new(&pchip::pieces(&points, &slopes), power),
            power,
            knots: knots.to_vec(),
        })
    }

    /// Coefficient C \[Pa^(1-m)/m\] of the power law above the transition.
    pub fn coefficient(&self) -> f64 {
        self.power.coefficient()
    }

    /// Exponent m \[-\] of the power law above the transition.
    pub fn exponent(&self) -> f64 {
        self.power.exponent()
    }

    /// Pressure \[Pa\] above which the law is the power law.
    pub fn transition_pressure(&self) -> f64 {
        self.power.reference_pressure()
    }

    /// Knots (pressure \[Pa\], stiffness \[Pa/m\]) below the transition.
    pub fn knots(&self) -> &[(f64, f64)] {
        &self.knots
    }
}

impl ContactLaw for ModifiedPower {
    forward!(self => self.spliced);

    fn kinks(&self) -> Vec<f64> {
        let inner = self.knots.iter().skip(1).map(|knot| knot.0);
        inner.chain([self.transition_pressure()]).collect()
    }
}
