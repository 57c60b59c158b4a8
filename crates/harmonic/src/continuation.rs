//! One-parameter families of periodic responses.

use crate::HarmonicError;

/// A one-parameter family of periodic motions. The load is `F cos(2 pi f t)`: a force \[N\], or the acceleration of
/// the base \[m/s2\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Continuation {
    /// Responses to one force amplitude over frequency.
    Frequency {
        /// Force amplitude F \[N\].
        force: f64,
        /// Frequency at the start \[Hz\].
        from: f64,
        /// Frequency at the end \[Hz\], higher or lower.
        to: f64,
    },
    /// Responses at one frequency over the force amplitude.
    Force {
        /// Frequency f \[Hz\].
        frequency: f64,
        /// Force amplitude at the start \[N\].
        from: f64,
        /// Force amplitude at the end \[N\].
        to: f64,
    },
    /// Phase resonance over the force amplitude: the fundamental of the displacement of
    /// the load's port lags the load by a quarter period, `Re(U_1) = 0`.
    PhaseResonance {
        /// Frequency near which the linearised structure resonates \[Hz\].
        near: f64,
        /// Force amplitude at the start \[N\], low enough for a nearly linear response.
        from: f64,
        /// Force amplitude at the end \[N\].
        to: f64,
    },
    /// A damped nonlinear mode over amplitude, by the extended periodic motion concept: no force,
    /// and the anti-damping `xi M u'` that just keeps the motion periodic. Its damping ratio is
    /// `xi / (2 w)`.
    ///
    /// The amplitude is that of the fundamental at the load's port. Source: M. Krack,
    /// Comput. Struct. 2015, 154, 59, doi 10.1016/j.compstruc.2015.03.008.
    Mode {
        /// Frequency near which the linearised structure resonates \[Hz\].
        near: f64,
        /// Amplitude at the start \[m\], low enough for a nearly linear motion.
        from: f64,
        /// Amplitude at the end \[m\].
        to: f64,
    },
}

impl Continuation {
    /// Start and end of the parameter.
    pub fn range(&self) -> (f64, f64) {
        match *self {
            Self::Frequency { from, to, .. }
            | Self::Force { from, to, .. }
            | Self::PhaseResonance { from, to, .. }
            | Self::Mode { from, to, .. } => (from, to),
        }
    }

    /// Name of the parameter, with its unit.
    pub fn quantity(&self) -> &'static str {
        match self {
            Self::Frequency { .. } => "frequency [Hz]",
            Self::Force { .. } | Self::PhaseResonance { .. } => "force amplitude [N]",
            Self::Mode { .. } => "modal amplitude [m]",
        }
    }

    /// Frequency \[Hz\] and force amplitude \[N\] at the start.
    pub(crate) fn start(&self) -> (f64, f64) {
        match *self {
            Self::Frequency { force, from, .. } => (from, force),
            Self::Force { frequency, from, .. } => (frequency, from),
            Self::PhaseResonance { near, from, .. } => (near, from),
            Self::Mode { near, .. } => (near, 0.0),
        }
    }

    pub(crate) fn check(&self) -> Result<(), HarmonicError> {
        let (from, to) = self.range();
        let fine = |value: f64| value.is_finite() && value > 0.0;
        if !(fine(from) && fine(to)) || from == to {
            return Err(HarmonicError::EmptyRange { quantity: self.quantity(), from, to });
        }
        let (quantity, value) = match *self {
            Self::Frequency { force, .. } => ("force amplitude [N]", force),
            Self::Force { frequency, .. } => ("frequency [Hz]", frequency),
            Self::PhaseResonance { near, .. } | Self::Mode { near, .. } => ("frequency [Hz]", near),
        };
        crate::error::positive(quantity, value)?;
        Ok(())
    }
}
