//! Small models for the tests.

use asperity_inference::{Parameter, ParameterScale, Prior};

pub(crate) fn linear(name: &str, start: f64, bounds: [f64; 2]) -> Parameter {
    Parameter::linear(name, start, bounds).unwrap()
}

pub(crate) fn linear_with_prior(
    name: &str,
    start: f64,
    bounds: [f64; 2],
    mean: f64,
    standard_deviation: f64,
) -> Parameter {
    let prior = Prior { mean, standard_deviation };
    Parameter::new(name, start, bounds, ParameterScale::Linear, Some(prior)).unwrap()
}

pub(crate) fn assert_close(found: f64, expected: f64, relative: f64, what: &str) {
    let apart = (found - expected).abs();
    assert!(apart <= relative * expected.abs(), "{what}: {found}, expected {expected}");
}

/// Standard normal numbers by the Box-Muller transform of a 64-bit congruential generator,
/// independent of the crate's own.
pub(crate) struct Noise(pub(crate) u64);

impl Noise {
    fn uniform(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    }

    pub(crate) fn normal(&mut self) -> f64 {
        let radius = (-2.0 * self.uniform().ln()).sqrt();
        radius * (std::f64::consts::TAU * self.uniform()).cos()
    }
}
