//! Self-affine roughness by Persson's theory.

mod exponential_integral;
mod slope_node;

use std::f64::consts::PI;
use std::sync::Arc;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::contact_law::quadrature::{gauss, gauss_short, work_between};
use crate::contact_law::{ContactLaw, Pressure, inverse, refine_increment};
use crate::domain::{Domain, no_less};
use crate::draw::{Draw, rounded};
use crate::error::{LawError, LawQuantity, above, at_most};
use crate::law_form::{LawFault, LawForm};
use exponential_integral::scaled_exponential_integral;
use slope_node::SlopeNode;

/// Width in ln p of a panel of an increment.
const PANEL: f64 = 0.5;

/// Exponent below that at the largest slope beyond which an integrand is negligible.
const NEGLIGIBLE: f64 = 45.0;

/// Changes of `ln p` times the steepness of `ln g` below which increments are integrated, for the
/// increments and for absolute values: a difference of gaps or pressures then loses digits.
const SHORT: f64 = 4.0;
const CLOSE: f64 = 0.7;

/// The same for increments that the short rule integrates to rounding.
const BRIEF: f64 = 0.05;

/// The same for increments that Newton steps find from the tangent.
const SMALL: f64 = 1e-3;

/// Pressure over `E* T` beyond which the length g is zero: faces in contact everywhere.
const FULL: f64 = 27.3;

/// Newton steps of the pressure at most.
const ITERATIONS: usize = 80;

/// Newton step of ln p whose square is below rounding.
const SETTLED: f64 = 1e-9;

/// Persson's law for self-affine roughness of rms height h, Hurst exponent H and wavevectors from `q0`
/// (roll-off) to `q1` (cut-off), pressed against a flat face,
///
/// ```text
/// K = p / g(p),    g = sqrt(pi) integral of q^2 C(q) w(q) exp(-(w p / E*)^2) dq,
/// 1 / w(q)^2 = pi integral from q0 to q of q^3 C dq,    C(q) ~ q^(-2-2H),
/// ```
///
/// with the power spectrum C, `h^2 = 2 pi integral of q C dq`, and the contact modulus
/// `1/E* = (1 - ν1^2)/E1 + (1 - ν2^2)/E2`. With t = 1/w, the rms slope of the wavevectors below q over
/// `sqrt(2)`, up to T for all of them, the length g and the mean gap u are
///
/// ```text
/// g = 2/sqrt(pi) integral to T of exp(-(p / (E* t))^2) / q(t) dt,
/// u = 1/sqrt(pi) integral to T of E1((p / (E* t))^2) / q(t) dt,    E1 the exponential integral.
/// ```
///
/// The integrals are sums over fixed nodes, so that both are consistent to rounding. The closure is
/// `u(p_ref) - u`. Contact is never lost; at full contact, where the pressure is infinite,
/// u is zero.
///
/// Valid for elastic contact without adhesion of random surfaces whose lateral size is many times
/// `2 pi / q0`. Two rough faces count as one, with the sum of their spectra.
///
/// Limit: at low pressures `K = p / u0`, `u0 = g(0)`, so that `p = β E* exp(-u / u0)`.
///
/// The theory's elastic energy is that of complete contact within the contact patches; simulations
/// of light contact find less, so that u0 is about 0.4 to 0.5 times the value here (the factor γ of
/// Yang and Persson, J. Phys. Condens. Matter 20, 215214 (2008), doi 10.1088/0953-8984/20/21/215214).
///
/// Source: Persson, Phys. Rev. Lett. 99, 125502 (2007), doi 10.1103/PhysRevLett.99.125502.
///
/// # Example
/// ```
/// use asperity_law::{ContactLaw, LawError, Persson};
///
/// // Roughness of 1 um rms, H = 0.8, wavelengths from 0.6 mm to 0.6 um; aluminium on aluminium.
/// let law = Persson::new(1e-6, 0.8, [1e4, 1e7], 39.8e9, 0.14e6)?;
/// assert!((law.length() / 1.062e-6 - 1.0).abs() < 1e-3);
/// // Nearly K = p / u0.
/// let length = 0.14e6 / law.stiffness(0.14e6);
/// assert!(length < law.length() && length > 0.9 * law.length());
/// # Ok::<(), LawError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Persson {
    modulus: f64,
    /// Largest t.
    slope: f64,
    /// Nodes in descending t.
    nodes: Arc<[SlopeNode]>,
    length: f64,
    reference_pressure: f64,
    reference_gap: f64,
}

impl Persson {
    /// The law of `height_rms` h \[m\], `hurst_exponent` 0 < H <= 1, `wavevectors` q0 < q1 \[1/m\] and
    /// `contact_modulus` E* \[Pa\], with closures counted from `reference_pressure` \[Pa\].
    ///
    /// # Errors
    /// [`LawError`] if a value is outside these limits, not positive or not finite.
    pub fn new(
        height_rms: f64,
        hurst_exponent: f64,
        wavevectors: [f64; 2],
        contact_modulus: f64,
        reference_pressure: f64,
    ) -> Result<Self, LawError> {
        let [roll_off, cut_off] = wavevectors;
        let height = above(LawQuantity::HeightRms, height_rms, 0.0)?;
        let hurst = above(LawQuantity::HurstExponent, hurst_exponent, 0.0)?;
        at_most(LawQuantity::HurstExponent, hurst, 1.0)?;
        let roll_off = above(LawQuantity::RollOff, roll_off, 0.0)?;
        let range = (above_roll_off(cut_off, roll_off)? / roll_off).ln();
        let modulus = above(LawQuantity::ContactModulus, contact_modulus, 0.0)?;
        let reference_pressure = above(LawQuantity::ReferencePressure, reference_pressure, 0.0)?;
        let exponent = 2.0 - 2.0 * hurst;
        // h^2 = pi C(q0) q0^2 (1 - (q1/q0)^(-2H)) / H
        let scale = (height * roll_off).powi(2) * hurst / -(-2.0 * hurst * range).exp_m1();
        let share =
            if exponent * range < 1e-17 { range } else { (exponent * range).exp_m1() / exponent };
        let slope = above(LawQuantity::Slope, (scale * share).sqrt(), 0.0)?;
        let nodes = SlopeNode::all(slope, scale.sqrt(), |t| {
            let share = t * t / scale;
            let curved = exponent * share > 1e-17;
            let log = if curved { (exponent * share).ln_1p() / exponent } else { share };
            (-log).exp() / roll_off
        });
        let mut law = Self {
            modulus,
            slope,
            nodes: nodes.into(),
            length: 0.0,
            reference_pressure,
            reference_gap: 0.0,
        };
        law.length = above(LawQuantity::Length, law.length_at(0.0), 0.0)?;
        law.reference_gap = law.gap(reference_pressure);
        above(LawQuantity::ReferenceGap, law.reference_gap, 0.0)?;
        Ok(law)
    }

    /// Length u0 \[m\] over which the pressure grows by a factor e at low pressures.
    pub fn length(&self) -> f64 {
        self.length
    }

    /// Root mean square gradient of the surface.
    pub fn rms_gradient(&self) -> f64 {
        self.slope * std::f64::consts::SQRT_2
    }

    /// Mean gap u \[m\] at a pressure \[Pa\]; +inf at zero pressure.
    pub fn gap(&self, pressure: f64) -> f64 {
        if pressure == 0.0 {
            return f64::INFINITY;
        }
        self.sum(pressure, scaled_exponential_integral) / PI.sqrt()
    }

    /// The length g \[m\].
    fn length_at(&self, pressure: f64) -> f64 {
        self.sum(pressure, |_| 1.0) * 2.0 / PI.sqrt()
    }

    /// Integral of `kernel(x) exp(-x) / q(t)` over the slopes t, `x = (p / (E* t))^2`.
    fn sum(&self, pressure: f64, kernel: impl Fn(f64) -> f64) -> f64 {
        let push = (pressure / self.modulus).powi(2);
        let least = push / (self.slope * self.slope);
        let factor = (-least).exp();
        if factor == 0.0 {
            return 0.0;
        }
        // Summed with the rounding of each addition (Kahan).
        let (mut sum, mut rest) = (0.0, 0.0);
        for node in self.nodes.iter() {
            let argument = push / node.square;
            if argument - least > NEGLIGIBLE {
                break;
            }
            let term = node.weight * kernel(argument) * (least - argument).exp() - rest;
            let next: f64 = sum + term;
            rest = (next - sum) - term;
            sum = next;
        }
        factor * sum
    }

    /// The pressure of a gap \[m\]: Newton's method for ln u over ln p, which is concave.
    fn pressure_at(&self, gap: f64) -> f64 {
        if gap <= 0.0 {
            return f64::INFINITY;
        }
        let start = (self.reference_gap - gap) / self.length;
        let mut log = self.reference_pressure.ln() + start.min(0.0);
        for _ in 0..ITERATIONS {
            let pressure = log.exp();
            if pressure == 0.0 {
                return 0.0;
            }
            let found = self.gap(pressure);
            let step = if found > 0.0 {
                (found / gap).ln() * found / self.length_at(pressure)
            } else {
                -0.5
            };
            if step.abs() <= SETTLED {
                return pressure * (1.0 + step);
            }
            if step.is_nan() {
                return f64::NAN;
            }
            log += step.clamp(-40.0, 2.0);
        }
        log.exp()
    }

    fn state(&self, value: f64, pressure: f64) -> Pressure {
        if pressure == f64::INFINITY {
            return Pressure::RIGID;
        }
        Pressure { value, tangent: self.stiffness(pressure) }
    }

    /// Change of `ln p` over an increment, and the panels that its integral takes.
    fn log_change(&self, from: f64, increment: f64) -> (f64, f64) {
        let log = no_less(increment / from, -1.0).ln_1p();
        let highest = from.max(from + increment) / (self.modulus * self.slope);
        (log, log.abs() * (1.0 + 2.0 * highest * highest))
    }
}

impl ContactLaw for Persson {
    fn stiffness(&self, pressure: f64) -> f64 {
        if pressure <= 0.0 { 0.0 } else { pressure / self.length_at(pressure) }
    }

    fn stiffness_slope(&self, pressure: f64) -> f64 {
        if pressure < 0.0 {
            return 0.0;
        }
        let length = self.length_at(pressure);
        let bend = self.sum(pressure, |argument| argument) * 2.0 / PI.sqrt();
        (1.0 + 2.0 * bend / length) / length
    }

    fn domain(&self) -> Domain {
        Domain { pressure_min: 0.0, closure_lost: None, closure_limit: self.reference_gap }
    }

    fn reference_pressure(&self) -> f64 {
        self.reference_pressure
    }

    fn closure(&self, pressure: f64) -> f64 {
        let (from, to) = (self.reference_pressure, no_less(pressure, 0.0));
        if self.log_change(from, to - from).1 < CLOSE {
            self.closure_increment(from, to - from)
        } else {
            self.reference_gap - self.gap(to)
        }
    }

    fn closure_increment(&self, from: f64, increment: f64) -> f64 {
        let (log, steps) = self.log_change(from, increment);
        if steps >= SHORT {
            return self.gap(from) - self.gap(no_less(from + increment, 0.0));
        }
        // dp/K = g d(ln p)
        let panels = (steps / PANEL).ceil().max(1.0);
        let width = log / panels;
        let length = |log: f64| self.length_at(from * log.exp());
        (0..panels as u32).map(|panel| gauss(&length, width * f64::from(panel), width)).sum()
    }

    fn pressure(&self, closure: f64) -> Pressure {
        let from = self.reference_pressure;
        let pressure = self.pressure_at(self.reference_gap - closure);
        if self.log_change(from, pressure - from).1 < CLOSE {
            let increment = refine_increment(self, from, closure, pressure - from);
            return Pressure { value: from + increment.value, ..increment };
        }
        self.state(pressure, pressure)
    }

    fn pressure_increment(&self, from: f64, closure_increment: f64) -> Pressure {
        let linear = closure_increment * self.stiffness(from);
        let guess = if self.log_change(from, linear).1 < SMALL {
            linear
        } else {
            self.pressure_at(self.gap(from) - closure_increment) - from
        };
        if self.log_change(from, guess).1 < SHORT {
            return refine_increment(self, from, closure_increment, guess);
        }
        self.state(guess, from + guess)
    }

    /// The default with the short rule for the closure where ln p changes little.
    fn pressure_step(&self, from: f64, closure_increment: f64) -> Option<Pressure> {
        let closure = |increment: f64| {
            let (log, steps) = self.log_change(from, increment);
            if steps > BRIEF {
                return self.closure_increment(from, increment);
            }
            gauss_short(&|log: f64| self.length_at(from * log.exp()), 0.0, log)
        };
        inverse::step((from, closure_increment), |pressure| self.stiffness(pressure), closure)
    }

    /// Finite at full contact too, as dd = g dp / p.
    fn energy(&self, closure: f64) -> f64 {
        let pressure = self.pressure(closure).value;
        if pressure.is_nan() || closure > self.reference_gap {
            return if closure.is_nan() { closure } else { pressure };
        }
        let full = FULL * self.modulus * self.slope;
        work_between(self, self.reference_pressure, pressure.min(full))
    }
}

/// `cut_off` if it is finite and greater than `roll_off`.
fn above_roll_off(cut_off: f64, roll_off: f64) -> Result<f64, LawError> {
    above(LawQuantity::CutOff, cut_off, roll_off)
}

/// Elastic contact of a self-affine surface (Persson), K(p) = p / u0 at low pressures, which never
/// separates.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PerssonSpec {
    /// Root mean square height in m.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub height_rms_m: f64,
    /// Hurst exponent, above 0 and at most 1.
    #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 1.0))]
    pub hurst_exponent: f64,
    /// Smallest wavevector of the roughness in rad/m.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub roll_off_per_m: f64,
    /// Largest wavevector of the roughness in rad/m, above the smallest.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub cut_off_per_m: f64,
    /// Contact modulus E* in Pa, `1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2`.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub contact_modulus_pa: f64,
}

impl LawForm for PerssonSpec {
    fn faults(&self) -> Box<dyn Iterator<Item = LawFault> + '_> {
        let cut_off = above_roll_off(self.cut_off_per_m, self.roll_off_per_m);
        let accepted = "a cut_off_per_m greater than roll_off_per_m";
        Box::new(LawFault::of(cut_off, || "/cut_off_per_m".to_owned(), accepted).into_iter())
    }

    fn build(&self, static_pressure: f64) -> Result<Arc<dyn ContactLaw>, LawError> {
        Ok(Arc::new(Persson::new(
            self.height_rms_m,
            self.hurst_exponent,
            [self.roll_off_per_m, self.cut_off_per_m],
            self.contact_modulus_pa,
            static_pressure,
        )?))
    }

    fn sample(draw: &mut dyn Draw, pressure: f64, stiffness: f64) -> Self {
        // Rough enough that no pressure of engineering is far above that of full contact.
        let steepness = draw.log_uniform(0.05, 1.0);
        let (hurst, range) = (draw.uniform(0.3, 1.0), draw.log_uniform(3.0, 1e4));
        let modulus = draw.log_uniform(2e11, 1e12);
        // Lengths scale with the height at a given steepness; K is nearly p over a length.
        let unit = Persson::new(1.0, hurst, [steepness, steepness * range], modulus, pressure);
        let height =
            rounded(pressure / stiffness / unit.map_or(1.0, |law| law.length_at(pressure)));
        let roll_off = rounded(steepness / height);
        Self {
            height_rms_m: height,
            hurst_exponent: hurst,
            roll_off_per_m: roll_off,
            cut_off_per_m: rounded(roll_off * range),
            contact_modulus_pa: modulus,
        }
    }
}
