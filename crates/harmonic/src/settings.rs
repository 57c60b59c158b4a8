//! Settings of harmonic balance and continuation.

use crate::{Floquet, HarmonicError};

/// Number of harmonics kept, and of samples of a period at which the laws are evaluated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FourierResolution {
    /// A fixed number of both; samples are raised to `4 H + 2` where they are fewer.
    Fixed {
        /// Harmonics H kept beside the mean.
        harmonics: usize,
        /// Samples per period.
        samples: usize,
    },
    /// As many harmonics as bring the estimated truncation of every point below the tolerance,
    /// with sixteen samples per harmonic; at the limit the branch is given with the truncation
    /// that is left.
    Automatic {
        /// Largest truncation accepted, relative to the largest closure harmonic.
        tolerance: f64,
        /// Most harmonics.
        most: usize,
    },
}

impl Default for FourierResolution {
    /// Automatic, to 1e-6, with at most 60 harmonics.
    fn default() -> Self {
        Self::Automatic { tolerance: 1e-6, most: 60 }
    }
}

impl FourierResolution {
    /// Most harmonics accepted.
    pub const MOST_HARMONICS: usize = 400;

    /// Most samples accepted: with the most harmonics the tables then take 210 MB.
    pub const MOST_SAMPLES: usize = 1 << 14;

    fn check(&self) -> Result<(), HarmonicError> {
        let (harmonics, samples) = match *self {
            Self::Fixed { harmonics, samples } => (harmonics, samples),
            Self::Automatic { tolerance, most } => {
                crate::error::positive("tolerance of the truncation", tolerance)?;
                (most, 0)
            }
        };
        if !(1..=Self::MOST_HARMONICS).contains(&harmonics) {
            return Err(HarmonicError::Setting {
                quantity: "number of harmonics",
                value: harmonics as f64,
                accepted: "1 to 400",
            });
        }
        if samples > Self::MOST_SAMPLES {
            return Err(HarmonicError::Setting {
                quantity: "samples per period",
                value: samples as f64,
                accepted: "at most 16384",
            });
        }
        Ok(())
    }
}

/// Control of the steps along a branch.
///
/// Lengths are in scaled variables, in which a resonance peak is about one high and one wide.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepControl {
    /// First step.
    pub first: f64,
    /// Longest step.
    pub longest: f64,
    /// Shortest step before the branch ends.
    pub shortest: f64,
    /// Turn of the tangent from step to step that is aimed at \[rad\]; steps with three times as much
    /// are repeated, shorter.
    pub turn: f64,
    /// Most points of a branch.
    pub points: usize,
}

impl Default for StepControl {
    fn default() -> Self {
        Self { first: 0.02, longest: 0.15, shortest: 1e-7, turn: 0.1, points: 20_000 }
    }
}

/// Settings of a branch.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct HarmonicSettings {
    /// Harmonics and samples.
    pub resolution: FourierResolution,
    /// Steps along the branch.
    pub steps: StepControl,
    /// Stability analysis at every point of a driven branch, if any. Modes of free motion have none.
    pub stability: Option<Floquet>,
    /// Ends the branch at its first response that loses contact, without stability. With automatic [`FourierResolution`] that
    /// response may have 12 harmonics, whatever its truncation.
    pub until_contact_lost: bool,
}

impl HarmonicSettings {
    pub(crate) fn check(&self) -> Result<(), HarmonicError> {
        self.resolution.check()?;
        let steps = &self.steps;
        for (quantity, value) in [
            ("first step", steps.first),
            ("longest step", steps.longest),
            ("shortest step", steps.shortest),
            ("turn of a step [rad]", steps.turn),
            ("number of points", steps.points as f64),
        ] {
            crate::error::positive(quantity, value)?;
        }
        self.stability.map_or(Ok(()), Floquet::check)
    }
}
