//! Nodes of the integrals over the slopes of a rough surface.

use crate::contact_law::quadrature::GAUSS;

/// Width of a panel in ln t.
const PANEL: f64 = 0.5;

/// Panels at the largest slope, each half as wide as the next: at pressures beyond full contact only
/// these slopes matter.
const HALVED: i32 = 11;

/// Slope, over the scale of the slopes, below which an integrand is negligible.
const LEAST: f64 = 1e-18;

/// A node of the Gauss-Legendre rule over panels in ln t.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SlopeNode {
    /// `t^2`.
    pub(super) square: f64,
    /// Weight of the integral over t, times `1/q(t)` \[m\].
    pub(super) weight: f64,
}

impl SlopeNode {
    /// The nodes up to the slope `top`, descending, for a `wavelength` 1/q(t) \[m\] that changes at slopes
    /// of about `scale`.
    pub(super) fn all(top: f64, scale: f64, wavelength: impl Fn(f64) -> f64) -> Vec<Self> {
        let range = (top / (LEAST * top.min(scale))).ln();
        let halved = (1 - HALVED..=0).map(|power| PANEL * 2.0_f64.powi(power));
        let even = (2..).map(|panel| PANEL * f64::from(panel)).take_while(|end| *end < range);
        let mut start = 0.0;
        let mut nodes = Vec::new();
        for end in halved.chain(even) {
            for (place, weight) in GAUSS {
                let t = top * (-(start + place * (end - start))).exp();
                let weight = weight * (end - start) * t * wavelength(t);
                nodes.push(Self { square: t * t, weight });
            }
            start = end;
        }
        nodes
    }
}
