//! Ports of linear systems, and the motion of a port.

use asperity_mesh::Port;
use num_complex::Complex64;

/// A port of a linear system, where a load acts or a sensor reads.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SystemPort {
    /// Of a stack.
    Stack(Port),
    /// Of component modes, by number; a rigid mass has port 0 alone.
    Number(usize),
}

impl From<Port> for SystemPort {
    fn from(port: Port) -> Self {
        Self::Stack(port)
    }
}

impl From<usize> for SystemPort {
    fn from(number: usize) -> Self {
        Self::Number(number)
    }
}

/// The periodic motion of a port, `u(t) = U_0 + Re sum_k U_k exp(i k w t)`.
#[derive(Debug, Clone, PartialEq)]
pub struct PortMotion {
    /// Angular frequency w \[rad/s\].
    pub angular_frequency: f64,
    /// Mean displacement `U_0` from rest \[m\], positive down.
    pub mean: f64,
    /// Complex amplitudes `U_k` of the displacement, harmonics 1 to H \[m\].
    pub harmonics: Vec<Complex64>,
}

impl PortMotion {
    /// Displacement of harmonic k >= 1 \[m\]; zero beyond H.
    pub fn displacement(&self, k: usize) -> Complex64 {
        let harmonic = k.checked_sub(1).and_then(|i| self.harmonics.get(i));
        harmonic.copied().unwrap_or_default()
    }

    /// Velocity of harmonic k >= 1, `i k w U_k` \[m/s\].
    pub fn velocity(&self, k: usize) -> Complex64 {
        self.displacement(k) * Complex64::new(0.0, k as f64 * self.angular_frequency)
    }

    /// Acceleration of harmonic k >= 1, `-(k w)^2 U_k` \[m/s2\].
    pub fn acceleration(&self, k: usize) -> Complex64 {
        self.displacement(k) * -(k as f64 * self.angular_frequency).powi(2)
    }

    /// The motion in space of a port whose displacement is relative to a base with the acceleration
    /// `a cos(w t)` \[m/s2\]: the base adds `-a / w^2` to the first harmonic.
    #[must_use]
    pub fn absolute(mut self, base_acceleration: f64) -> Self {
        if let Some(first) = self.harmonics.first_mut() {
            *first -= base_acceleration / self.angular_frequency.powi(2);
        }
        self
    }
}
