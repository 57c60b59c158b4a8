//! Summits of random heights in elastic contact.

mod summit_moments;

use std::sync::Arc;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::contact_law::quadrature::{gauss, gauss_short};
use crate::contact_law::{ContactLaw, Pressure};
use crate::domain::{Domain, no_less};
use crate::draw::{Draw, rounded};
use crate::error::{LawError, LawQuantity, above};
use crate::law_form::LawForm;
use summit_moments::SummitMoments;

/// Halley steps at most; about three are needed.
const ITERATIONS: usize = 60;

/// Halley step of the gap whose cube is below rounding.
const SETTLED: f64 = 1e-6;

/// Relative increment of pressure, and increment of the gap in standard deviations, above which
/// a difference of absolute values has enough digits.
const SHORT: f64 = 0.5;

/// Increment of the gap in standard deviations up to which the short rule integrates it to rounding.
const BRIEF: f64 = 0.05;

/// Greenwood-Williamson law: spherical summits of one radius R, of density η and of normally
/// distributed heights with standard deviation σ, each in elastic Hertzian contact with a plane,
///
/// ```text
/// p = 4/3 E* η R^(1/2) σ^(3/2) F_3/2(h),    K = -dp/du = 2 E* η R^(1/2) σ^(1/2) F_1/2(h),
/// F_n(h) = integral from h of (z - h)^n exp(-z^2/2) dz / sqrt(2 pi),    h = u / σ,
/// ```
///
/// with the gap u of the plane from the mean of the summits' heights, and the contact modulus
/// `1/E* = (1 - ν1^2)/E1 + (1 - ν2^2)/E2`. Two rough faces count as one, with the sum of their
/// profiles. The closure is `u(p_ref) - u`, from the reference pressure; contact is never lost, as heights
/// have no bound.
///
/// Valid where the summits do not interact and stay elastic: real contact area a small part of the
/// nominal one, and plasticity index `(E*/H) (σ/R)^(1/2)` below 0.6, H the hardness.
///
/// Limits: at low pressures K p^-1 σ tends to h, so that K is nearly proportional to p; heights of
/// exponential distribution would give `K = p / σ` exactly. Far above the highest summits' contact, `-h`
/// large, every summit is a Hertzian contact of approach `-u`.
///
/// Source: Greenwood and Williamson, Proc. R. Soc. A 295, 300 (1966), doi 10.1098/rspa.1966.0242.
///
/// # Example
/// ```
/// use asperity_law::{ContactLaw, GreenwoodWilliamson, LawError};
///
/// // 1e10 summits per m2 of radius 50 um and height 0.5 um rms; aluminium on aluminium.
/// let law = GreenwoodWilliamson::new(1e10, 50e-6, 0.5e-6, 39.8e9, 0.14e6)?;
/// assert_eq!(law.closure(0.14e6), 0.0);
/// // Stiffness over pressure is a few times the inverse of the height.
/// let share = law.stiffness(0.14e6) * 0.5e-6 / 0.14e6;
/// assert!((2.0..5.0).contains(&share));
/// # Ok::<(), LawError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GreenwoodWilliamson {
    /// `4/3 E* η R^(1/2) σ^(3/2)` \[Pa\].
    scale: f64,
    height: f64,
    reference_pressure: f64,
    /// Gap at the reference pressure, in σ.
    reference: f64,
}

impl GreenwoodWilliamson {
    /// The law of `summit_density` η \[1/m2\], `summit_radius` R \[m\], standard deviation of heights
    /// `height_rms` σ \[m\] and `contact_modulus` E* \[Pa\], with closures counted from
    /// `reference_pressure` \[Pa\]; all positive.
    ///
    /// # Errors
    /// [`LawError`] if a value is not positive and finite, or the pressures that they give overflow.
    pub fn new(
        summit_density: f64,
        summit_radius: f64,
        height_rms: f64,
        contact_modulus: f64,
        reference_pressure: f64,
    ) -> Result<Self, LawError> {
        let density = above(LawQuantity::SummitDensity, summit_density, 0.0)?;
        let radius = above(LawQuantity::SummitRadius, summit_radius, 0.0)?;
        let height = above(LawQuantity::HeightRms, height_rms, 0.0)?;
        let modulus = above(LawQuantity::ContactModulus, contact_modulus, 0.0)?;
        let reference_pressure = above(LawQuantity::ReferencePressure, reference_pressure, 0.0)?;
        let scale = 4.0 / 3.0 * modulus * density * radius.sqrt() * height.powf(1.5);
        let scale = above(LawQuantity::Pressure, scale, 0.0)?;
        let reference = gap(reference_pressure / scale);
        Ok(Self { scale, height, reference_pressure, reference })
    }

    /// Gap u \[m\] from the mean of the summits' heights at a pressure \[Pa\]; +inf at zero.
    pub fn gap(&self, pressure: f64) -> f64 {
        self.height * self.at(pressure)
    }

    /// Separation in σ at a pressure.
    fn at(&self, pressure: f64) -> f64 {
        gap(pressure / self.scale)
    }

    /// Pressure \[Pa\] and stiffness \[Pa/m\] at a gap in σ.
    fn state(&self, gap: f64) -> Pressure {
        let moments = SummitMoments::at(gap);
        let factor = self.scale * moments.factor();
        Pressure {
            value: factor * moments.three_halves,
            tangent: 1.5 * factor * moments.half / self.height,
        }
    }

    /// True if an increment of the gap in σ is better integrated than differenced.
    fn is_short(gap: f64, increment: f64) -> bool {
        increment.abs() < SHORT * (-0.25 * gap).max(1.0)
    }

    /// True for an increment of the gap in σ over which pressures change little.
    fn is_brief(gap: f64, increment: f64) -> bool {
        increment.abs() * gap.max(1.0) < BRIEF * (-gap).max(1.0)
    }
}

impl ContactLaw for GreenwoodWilliamson {
    fn stiffness(&self, pressure: f64) -> f64 {
        if pressure <= 0.0 {
            return 0.0;
        }
        // In proportion to the pressure, which keeps its digits.
        let moments = SummitMoments::at(self.at(pressure));
        1.5 * pressure * (moments.half / moments.three_halves) / self.height
    }

    fn stiffness_slope(&self, pressure: f64) -> f64 {
        if pressure < 0.0 {
            return 0.0;
        }
        if pressure == 0.0 {
            return f64::INFINITY;
        }
        let moments = SummitMoments::at(self.at(pressure));
        0.5 * moments.minus_half / moments.half / self.height
    }

    fn domain(&self) -> Domain {
        Domain { pressure_min: 0.0, closure_lost: None, closure_limit: f64::INFINITY }
    }

    fn reference_pressure(&self) -> f64 {
        self.reference_pressure
    }

    fn closure(&self, pressure: f64) -> f64 {
        let (from, to) = (self.reference_pressure, no_less(pressure, 0.0));
        if (to - from).abs() < SHORT * from {
            self.closure_increment(from, to - from)
        } else {
            self.height * (self.reference - self.at(to))
        }
    }

    fn closure_increment(&self, from: f64, increment: f64) -> f64 {
        let guess = if increment.abs() < SHORT * from {
            gauss(&|s| 1.0 / self.stiffness(from + s), 0.0, increment)
        } else {
            self.height * (self.at(from) - self.at(no_less(from + increment, 0.0)))
        };
        // The inverse of `pressure_increment` to its last digits.
        let found = self.pressure_increment(from, guess);
        let refined = guess + (increment - found.value) / found.tangent;
        if refined.is_finite() { refined } else { guess }
    }

    fn pressure(&self, closure: f64) -> Pressure {
        let width = closure / self.height;
        // Pressures change by a factor of about exp(h width).
        if width.abs() * (2.0 + self.reference.max(0.0)) < SHORT {
            let from = self.reference_pressure;
            let increment = self.pressure_increment(from, closure);
            return Pressure { value: from + increment.value, ..increment };
        }
        self.state(self.reference - width)
    }

    fn pressure_increment(&self, from: f64, closure_increment: f64) -> Pressure {
        let (start, width) = (self.at(from), closure_increment / self.height);
        let end = self.state(start - width);
        let value = if Self::is_short(start, width) {
            let tangent = |down: f64| self.state(start - down).tangent;
            self.height * gauss(&tangent, 0.0, width)
        } else {
            end.value - from
        };
        Pressure { value, ..end }
    }

    /// From the gap at `from`: pressures are sums at a gap.
    fn pressure_step(&self, from: f64, closure_increment: f64) -> Option<Pressure> {
        if from <= 0.0 {
            return None;
        }
        let (start, width) = (self.at(from), closure_increment / self.height);
        let end = self.state(start - width);
        let tangent = |down: f64| self.state(start - down).tangent;
        let value = if Self::is_brief(start, width) {
            self.height * gauss_short(&tangent, 0.0, width)
        } else {
            end.value - from
        };
        Some(Pressure { value, ..end })
    }

    fn energy(&self, closure: f64) -> f64 {
        let width = closure / self.height;
        if Self::is_short(self.reference, width) {
            let pressure = |down: f64| self.state(self.reference - down).value;
            return self.height * gauss(&pressure, 0.0, width);
        }
        let moment = |gap: f64| {
            let moments = SummitMoments::at(gap);
            moments.factor() * moments.five_halves
        };
        0.4 * self.scale * self.height * (moment(self.reference - width) - moment(self.reference))
    }
}

/// The gap h at which `F_3/2(h)` is `share`.
fn gap(share: f64) -> f64 {
    if share == 0.0 {
        return f64::INFINITY;
    }
    let target = share.ln();
    // The limits of large and of small shares.
    let mut h =
        if target > 0.0 { -(target * 2.0 / 3.0).exp() } else { (-2.0 * target).sqrt() - 1.0 };
    for _ in 0..ITERATIONS {
        let moments = SummitMoments::at(h);
        let off = moments.log_factor + moments.three_halves.ln() - target;
        // Of ln F_3/2 over h: the slope -a and the second derivative b.
        let a = 1.5 * moments.half / moments.three_halves;
        let b = 0.75 * moments.minus_half / moments.three_halves - a * a;
        let newton = off / a;
        let halley = newton / (1.0 - 0.5 * newton * b / a);
        let step = if halley * newton > 0.0 { halley } else { newton };
        h += step;
        if step.abs() <= SETTLED * h.abs().max(1.0) || step.is_nan() {
            break;
        }
    }
    // A last step without the rounding of the logarithms.
    let moments = SummitMoments::at(h);
    let factor = moments.factor();
    let step = (factor * moments.three_halves - share) / (1.5 * factor * moments.half);
    if step.is_finite() { h + step } else { h }
}

/// Hertzian contact of spherical summits whose heights are normally distributed (Greenwood and
/// Williamson), which never separates.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GreenwoodWilliamsonSpec {
    /// Number of summits per area in 1/m2.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub summit_density_per_m2: f64,
    /// Radius of the summits in m.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub summit_radius_m: f64,
    /// Standard deviation of the heights of the summits in m.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub summit_height_rms_m: f64,
    /// Contact modulus E* in Pa, `1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2`.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub contact_modulus_pa: f64,
}

impl LawForm for GreenwoodWilliamsonSpec {
    fn build(&self, static_pressure: f64) -> Result<Arc<dyn ContactLaw>, LawError> {
        Ok(Arc::new(GreenwoodWilliamson::new(
            self.summit_density_per_m2,
            self.summit_radius_m,
            self.summit_height_rms_m,
            self.contact_modulus_pa,
            static_pressure,
        )?))
    }

    fn sample(draw: &mut dyn Draw, pressure: f64, stiffness: f64) -> Self {
        // The gap in standard deviations gives K σ / p and p over the pressure scale.
        let moments = SummitMoments::at(draw.uniform(0.0, 3.5));
        let height = rounded(1.5 * moments.half / moments.three_halves * pressure / stiffness);
        let scale = pressure / (moments.factor() * moments.three_halves);
        let (radius, modulus) = (draw.log_uniform(1e-6, 1e-3), draw.log_uniform(1e9, 1e12));
        let density = scale / (4.0 / 3.0 * modulus * radius.sqrt() * height.powf(1.5));
        Self {
            summit_density_per_m2: rounded(density),
            summit_radius_m: radius,
            summit_height_rms_m: height,
            contact_modulus_pa: modulus,
        }
    }
}
