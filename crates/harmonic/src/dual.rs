//! Complex functions of frequency and anti-damping with their derivatives.

use std::ops::{Add, Mul, Sub};

use num_complex::Complex64;

/// A complex function of the angular frequency w \[rad/s\] and the anti-damping rate \[1/s\] with its
/// derivatives: a dual number.
///
/// Time goes as `exp(i w t)`, so that a damped structure lags: imaginary parts of direct receptances
/// are negative.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Dual {
    /// Value, of a receptance \[m/N\].
    pub value: Complex64,
    /// Derivative with respect to the angular frequency, of a receptance \[m s/(N rad)\].
    pub d_frequency: Complex64,
    /// Derivative with respect to the anti-damping rate, of a receptance \[m s/N\].
    pub d_anti_damping: Complex64,
}

/// The value of a [`Dual`], or one of its derivatives.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Part {
    Value,
    Frequency,
    AntiDamping,
}

impl Dual {
    pub(crate) fn part(&self, part: Part) -> Complex64 {
        match part {
            Part::Value => self.value,
            Part::Frequency => self.d_frequency,
            Part::AntiDamping => self.d_anti_damping,
        }
    }

    pub(crate) const ONE: Self = Self::constant(Complex64::ONE);

    pub(crate) const fn constant(value: Complex64) -> Self {
        Self { value, d_frequency: Complex64::ZERO, d_anti_damping: Complex64::ZERO }
    }

    /// `k - m w^2 + i w (c - m xi)`: dynamic stiffness of a mass m on a spring k with a damper c under
    /// the anti-damping rate xi.
    pub(crate) fn oscillator((k, m, c): (f64, f64, f64), (w, anti_damping): (f64, f64)) -> Self {
        let damper = c - m * anti_damping;
        Self {
            value: Complex64::new(k - m * w * w, w * damper),
            d_frequency: Complex64::new(-2.0 * m * w, damper),
            d_anti_damping: Complex64::new(0.0, -m * w),
        }
    }

    /// A function of this one, from its `value` and `slope` here.
    pub(crate) fn chain(self, value: Complex64, slope: Complex64) -> Self {
        let (d_frequency, d_anti_damping) = (slope * self.d_frequency, slope * self.d_anti_damping);
        Self { value, d_frequency, d_anti_damping }
    }

    pub(crate) fn inverse(self) -> Self {
        let value = self.value.inv();
        self.chain(value, -value * value)
    }

    /// Adds `factor` times `other`.
    pub(crate) fn add(&mut self, other: &Self, factor: f64) {
        self.value += other.value * factor;
        self.d_frequency += other.d_frequency * factor;
        self.d_anti_damping += other.d_anti_damping * factor;
    }
}

impl Add for Dual {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            d_frequency: self.d_frequency + other.d_frequency,
            d_anti_damping: self.d_anti_damping + other.d_anti_damping,
        }
    }
}

impl Sub for Dual {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + other * -1.0
    }
}

impl Mul for Dual {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self {
            value: self.value * other.value,
            d_frequency: self.d_frequency * other.value + self.value * other.d_frequency,
            d_anti_damping: self.d_anti_damping * other.value + self.value * other.d_anti_damping,
        }
    }
}

impl Mul<f64> for Dual {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        Self {
            value: self.value * factor,
            d_frequency: self.d_frequency * factor,
            d_anti_damping: self.d_anti_damping * factor,
        }
    }
}

impl Mul<Complex64> for Dual {
    type Output = Self;
    fn mul(self, factor: Complex64) -> Self {
        self.chain(self.value * factor, factor)
    }
}
