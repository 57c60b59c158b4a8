//! The power law, softened at low pressure.

use std::sync::Arc;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::contact_law::{ContactLaw, forward};
use crate::draw::{Draw, rounded};
use crate::error::{
    LawError, LawQuantity, above, at_least, at_most, below, finite, regular, rising,
};
use crate::law_form::{LawFault, LawForm};
use crate::pchip;
use crate::power::{Power, REGULAR};
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
        at_least(LawQuantity::Points, knots.len() as f64, 1.0)?;
        let joint = (transition_pressure, power.stiffness(transition_pressure));
        LawFault::first(faults(joint, knots.iter().copied()))?;
        let mut points = knots.to_vec();
        points.push(joint);

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

/// Faults of `knots` below the transition, whose pressure \[Pa\] and stiffness \[Pa/m\] are those of
/// the `joint`.
fn faults(
    joint: (f64, f64),
    knots: impl DoubleEndedIterator<Item = (f64, f64)> + ExactSizeIterator + Clone,
) -> impl Iterator<Item = LawFault> {
    let top = LawFault::of(
        regular("the stiffness C p^m at transition_pa", joint.1),
        String::new,
        REGULAR,
    );
    let last = knots.len().saturating_sub(1);
    let before = std::iter::once(None).chain(knots.clone().map(Some));
    let of_rows = before.zip(knots).enumerate().flat_map(move |(row, (before, (p, k)))| {
        let pressure =
            |checked, accepted| LawFault::of(checked, || format!("/knots/{row}/0"), accepted);
        let stiffness =
            |checked, accepted| LawFault::of(checked, || format!("/knots/{row}/1"), accepted);
        let (p_before, k_before) = before.unzip();
        let first = if row == 0 { at_most(LawQuantity::Pressure, p, 0.0) } else { Ok(p) };
        let softer = if row == last { below(LawQuantity::Stiffness, k, joint.1) } else { Ok(k) };
        let rises = "a number greater than the one in the row before";
        [
            pressure(finite(LawQuantity::Pressure, p), "a finite pressure"),
            pressure(at_least(LawQuantity::Pressure, p, 0.0), "a pressure of at least 0 Pa"),
            pressure(first, "0, the pressure of the first knot"),
            pressure(rising(LawQuantity::Pressure, row, p, p_before), rises),
            pressure(
                below(LawQuantity::Pressure, p, joint.0),
                "a pressure below transition_pa, above which the power law holds",
            ),
            stiffness(above(LawQuantity::Stiffness, k, 0.0), "a stiffness greater than 0 Pa/m"),
            stiffness(rising(LawQuantity::Stiffness, row, k, k_before), rises),
            stiffness(
                softer,
                "a stiffness below coefficient transition_pa^exponent, so that the law increases",
            ),
        ]
        .into_iter()
        .flatten()
    });
    top.into_iter().chain(of_rows)
}

/// Power law C p^m above the transition pressure, a smooth monotone curve through the knots
/// below it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ModifiedPowerSpec {
    /// Coefficient C in Pa^(1-m)/m.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub coefficient: f64,
    /// Exponent m.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub exponent: f64,
    /// Transition pressure in Pa, above which the power law holds.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub transition_pa: f64,
    /// Pairs [pressure in Pa, stiffness in Pa/m] below the transition, the first at zero
    /// pressure, pressures and stiffnesses increasing.
    #[schemars(length(min = 1))]
    pub knots: Vec<[f64; 2]>,
}

impl LawForm for ModifiedPowerSpec {
    fn faults(&self) -> Box<dyn Iterator<Item = LawFault> + '_> {
        let top = self.coefficient * self.transition_pa.powf(self.exponent);
        Box::new(faults((self.transition_pa, top), self.knots.iter().map(|&[p, k]| (p, k))))
    }

    fn highest_pressure(&self) -> f64 {
        2.0 * self.transition_pa
    }

    fn build(&self, _static_pressure: f64) -> Result<Arc<dyn ContactLaw>, LawError> {
        let knots: Vec<_> = self.knots.iter().map(|&[p, k]| (p, k)).collect();
        let (coefficient, exponent) = (self.coefficient, self.exponent);
        Ok(Arc::new(ModifiedPower::new(coefficient, exponent, self.transition_pa, &knots)?))
    }

    fn sample(draw: &mut dyn Draw, pressure: f64, stiffness: f64) -> Self {
        let exponent = draw.uniform(0.0, 1.5);
        let coefficient = rounded(stiffness / pressure.powf(exponent));
        let transition_pa = rounded(pressure * draw.log_uniform(0.1, 10.0));
        let top = coefficient * transition_pa.powf(exponent);
        let softness = draw.uniform(0.01, 0.4);
        let gaps: Vec<f64> = (0..draw.whole(0..=4)).map(|_| draw.uniform(0.05, 1.0)).collect();
        // In units of K and p at the transition the joint's slope is m. Secants of at least m/2 from
        // every knot to the joint keep it within three secants.
        let total: f64 = gaps.iter().sum::<f64>() + 0.5;
        let (mut place, mut knots) = (0.0, vec![[0.0, top * softness * 0.2]]);
        for gap in gaps {
            place += gap / total;
            let share = softness * (0.2 + 0.8 * place * place);
            let share = share.min(1.0 - 0.5 * exponent * (1.0 - place));
            knots.push([place * transition_pa, top * share]);
        }
        Self { coefficient, exponent, transition_pa, knots }
    }
}
