//! Excitations as documents give them.

use asperity_mesh::{Body, Port};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{BaseQuantity, LoadCase, PlaceSpec, SampledFunction, StructureError, TimeFunction};

/// Force on the stack, or motion of its base; positive ones point down.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum ExcitationSpec {
    /// No force: the stack stays in static equilibrium.
    #[default]
    None,
    /// Hammer pulse F (t/rise)^2 exp(2 (1 - t/rise)): smooth, without a zero in its spectrum.
    GammaPulse {
        /// Largest force F in N; negative pulls.
        peak_n: f64,
        /// Time of the largest force in s.
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        rise_s: f64,
        /// Place of the force; the top of the stack when left out.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        at: Option<PlaceSpec>,
    },
    /// Pulse F sin(pi t / duration), zero afterwards.
    HalfSine {
        /// Largest force F in N; negative pulls.
        peak_n: f64,
        /// Length of the pulse in s.
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        duration_s: f64,
        /// Place of the force; the top of the stack when left out.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        at: Option<PlaceSpec>,
    },
    /// Pulse F sin^2(pi t / duration), zero afterwards.
    Haversine {
        /// Largest force F in N; negative pulls.
        peak_n: f64,
        /// Length of the pulse in s.
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        duration_s: f64,
        /// Place of the force; the top of the stack when left out.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        at: Option<PlaceSpec>,
    },
    /// Shaker: F sin(2 pi f t) from t = 0 on.
    Harmonic {
        /// Amplitude F of the force in N.
        amplitude_n: f64,
        /// Frequency f in Hz.
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        frequency_hz: f64,
        /// Place of the force; the top of the stack when left out.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        at: Option<PlaceSpec>,
    },
    /// Measured or drawn force, linear between its samples and zero outside them, from exactly one of `file` and
    /// `points`.
    #[schemars(extend("oneOf" = [{"required": ["points"]}, {"required": ["file"]}]))]
    Samples {
        /// CSV file with the columns `time_s,force_n`, relative to the folder of the scenario; give this or
        /// `points`.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(length(min = 1))]
        file: Option<String>,
        /// Pairs of a time in s and a force in N, 2 to 10000, times increasing; give this or `file`.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(length(min = 2, max = 10_000))]
        points: Option<Vec<[f64; 2]>>,
        /// Largest magnitude in N to which the force is rescaled; as measured when left out, reversed
        /// when negative.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        peak_n: Option<f64>,
        /// Place of the force; the top of the stack when left out.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        at: Option<PlaceSpec>,
    },
    /// Motion of the base below the support, with exactly one of `acceleration`, `velocity` and
    /// `displacement`. Responses are relative to the base and absolute; damping of the bodies and
    /// friction in guides act relative to the base.
    #[schemars(extend("oneOf" = [
        {"required": ["acceleration"]}, {"required": ["velocity"]}, {"required": ["displacement"]}
    ]))]
    BaseMotion {
        /// Acceleration of the base in m/s²; give this, `velocity` or `displacement`.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        acceleration: Option<AccelerationSpec>,
        /// Velocity of the base in m/s; give this, `acceleration` or `displacement`.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        velocity: Option<VelocitySpec>,
        /// Displacement of the base in m; give this, `acceleration` or `velocity`.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        displacement: Option<DisplacementSpec>,
        /// Direction of the motion of a structure of matrices, along which every support moves; its length does not
        /// count. Bars move along their axis, downwards.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        direction: Option<[f64; 3]>,
    },
}

/// The time functions of one kinematic quantity, with the unit in the names of their amplitudes.
macro_rules! motion {
    ($(#[$doc:meta])* $name:ident, $peak:ident, $amplitude:ident, $column:literal) => {
        $(#[$doc])*
        #[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
        #[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
        pub enum $name {
            /// Pulse P (t/rise)^2 exp(2 (1 - t/rise)).
            GammaPulse {
                /// Largest value P.
                $peak: f64,
                /// Time of the largest value in s.
                #[schemars(extend("exclusiveMinimum" = 0.0))]
                rise_s: f64,
            },
            /// Pulse P sin(pi t / duration), zero afterwards; not for a displacement, whose velocity
            /// would jump.
            HalfSine {
                /// Largest value P.
                $peak: f64,
                /// Length of the pulse in s.
                #[schemars(extend("exclusiveMinimum" = 0.0))]
                duration_s: f64,
            },
            /// Pulse P sin^2(pi t / duration), zero afterwards.
            Haversine {
                /// Largest value P.
                $peak: f64,
                /// Length of the pulse in s.
                #[schemars(extend("exclusiveMinimum" = 0.0))]
                duration_s: f64,
            },
            /// A sin(2 pi f t) from t = 0 on.
            Harmonic {
                /// Amplitude A.
                $amplitude: f64,
                /// Frequency f in Hz.
                #[schemars(extend("exclusiveMinimum" = 0.0))]
                frequency_hz: f64,
            },
            /// Measured samples: an acceleration or velocity is linear between them, a displacement
            /// lies on a natural cubic spline.
            Samples {
                /// CSV file with the time in s and the quantity, relative to the folder of the
                /// scenario.
                #[schemars(length(min = 1))]
                file: String,
                /// Largest magnitude to which the samples are rescaled; as measured when left out,
                /// reversed when negative.
                #[serde(default, skip_serializing_if = "Option::is_none")]
                $peak: Option<f64>,
            },
        }

        impl $name {
            fn function(&self) -> FunctionSpec<'_> {
                match *self {
                    Self::GammaPulse { $peak, rise_s } => {
                        FunctionSpec::Of(TimeFunction::GammaPulse { rise: rise_s }, $peak)
                    }
                    Self::HalfSine { $peak, duration_s } => {
                        FunctionSpec::Of(TimeFunction::HalfSine { duration: duration_s }, $peak)
                    }
                    Self::Haversine { $peak, duration_s } => {
                        FunctionSpec::Of(TimeFunction::Haversine { duration: duration_s }, $peak)
                    }
                    Self::Harmonic { $amplitude, frequency_hz } => FunctionSpec::Of(
                        TimeFunction::Harmonic { frequency: frequency_hz },
                        $amplitude,
                    ),
                    Self::Samples { ref file, $peak } => FunctionSpec::Samples(SamplesFile {
                        file,
                        column: $column,
                        peak: $peak,
                    }),
                }
            }
        }
    };
}

motion!(
    /// Acceleration of the base over time.
    AccelerationSpec, peak_m_per_s2, amplitude_m_per_s2, "acceleration_m_per_s2"
);
motion!(
    /// Velocity of the base over time.
    VelocitySpec, peak_m_per_s, amplitude_m_per_s, "velocity_m_per_s"
);
motion!(
    /// Displacement of the base over time.
    DisplacementSpec, peak_m, amplitude_m, "displacement_m"
);

/// A time function and its amplitude, or the file or points that have both.
enum FunctionSpec<'a> {
    Of(TimeFunction, f64),
    Samples(SamplesFile<'a>),
    /// Times and values, and the largest magnitude to which they are rescaled.
    Points(&'a [[f64; 2]], Option<f64>),
}

/// File of samples that an excitation names.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SamplesFile<'a> {
    /// File, relative to the folder of the document.
    pub file: &'a str,
    /// Name of its column beside `time_s`.
    pub column: &'static str,
    /// Largest magnitude to which the samples are rescaled; none for samples as measured.
    pub peak: Option<f64>,
}

impl ExcitationSpec {
    /// The place of a force; none for the top of the stack, no force, or a motion of the base.
    pub fn at(&self) -> Option<&PlaceSpec> {
        match self {
            Self::None | Self::BaseMotion { .. } => None,
            Self::GammaPulse { at, .. }
            | Self::HalfSine { at, .. }
            | Self::Haversine { at, .. }
            | Self::Harmonic { at, .. }
            | Self::Samples { at, .. } => at.as_ref(),
        }
    }

    /// Direction of the motion of the base, if there is one.
    pub fn base_direction(&self) -> Option<[f64; 3]> {
        match self {
            Self::BaseMotion { direction, .. } => *direction,
            _ => None,
        }
    }

    /// The quantity of the base that is given, and its function.
    fn base(&self) -> Option<(BaseQuantity, FunctionSpec<'_>)> {
        let Self::BaseMotion { acceleration, velocity, displacement, .. } = self else {
            return None;
        };
        let acceleration = acceleration.as_ref().map(AccelerationSpec::function);
        let velocity = velocity.as_ref().map(VelocitySpec::function);
        let displacement = displacement.as_ref().map(DisplacementSpec::function);
        (acceleration.map(|function| (BaseQuantity::Acceleration, function)))
            .or(velocity.map(|function| (BaseQuantity::Velocity, function)))
            .or(displacement.map(|function| (BaseQuantity::Displacement, function)))
    }

    fn function(&self) -> FunctionSpec<'_> {
        match *self {
            Self::None => FunctionSpec::Of(TimeFunction::Zero, 0.0),
            Self::GammaPulse { peak_n, rise_s, .. } => {
                FunctionSpec::Of(TimeFunction::GammaPulse { rise: rise_s }, peak_n)
            }
            Self::HalfSine { peak_n, duration_s, .. } => {
                FunctionSpec::Of(TimeFunction::HalfSine { duration: duration_s }, peak_n)
            }
            Self::Haversine { peak_n, duration_s, .. } => {
                FunctionSpec::Of(TimeFunction::Haversine { duration: duration_s }, peak_n)
            }
            Self::Harmonic { amplitude_n, frequency_hz, .. } => {
                FunctionSpec::Of(TimeFunction::Harmonic { frequency: frequency_hz }, amplitude_n)
            }
            Self::Samples { file: Some(ref file), peak_n, .. } => {
                FunctionSpec::Samples(SamplesFile { file, column: "force_n", peak: peak_n })
            }
            Self::Samples { ref points, peak_n, .. } => {
                FunctionSpec::Points(points.as_deref().unwrap_or_default(), peak_n)
            }
            Self::BaseMotion { .. } => self
                .base()
                .map_or(FunctionSpec::Of(TimeFunction::Zero, 0.0), |(_, function)| function),
        }
    }

    /// The file of samples that the excitation names.
    pub fn samples(&self) -> Option<SamplesFile<'_>> {
        match self.function() {
            FunctionSpec::Samples(samples) => Some(samples),
            FunctionSpec::Of(..) | FunctionSpec::Points(..) => None,
        }
    }

    /// The load on a stack of `bodies`; `read` returns the samples of a file as measured.
    ///
    /// # Errors
    /// Those of `read`; [`StructureError::Samples`] for points whose times do not increase; [`StructureError::UnknownBody`] and [`StructureError::Setting`] for a place that
    /// does not exist, [`StructureError::BaseJump`] for a base displaced by a half-sine.
    pub fn load_case<E: From<StructureError>>(
        &self,
        bodies: &[Body],
        read: impl FnOnce(SamplesFile<'_>) -> Result<SampledFunction, E>,
    ) -> Result<LoadCase, E> {
        let port = self.at().map_or(Ok(Port::TOP), |at| at.port(bodies))?;
        self.load_case_at(port, read)
    }

    /// The load case with its force at `port`; `read` reads a file of samples.
    ///
    /// # Errors
    /// Those of `read`, and [`StructureError::BaseJump`] for a base displaced by a half-sine.
    pub fn load_case_at<E: From<StructureError>>(
        &self,
        port: Port,
        read: impl FnOnce(SamplesFile<'_>) -> Result<SampledFunction, E>,
    ) -> Result<LoadCase, E> {
        let (function, amplitude) = match self.function() {
            FunctionSpec::Of(function, amplitude) => (function, amplitude),
            FunctionSpec::Samples(file) => {
                let (unit, peak) = read(file)?.normalised();
                let signed = file.peak.unwrap_or(peak);
                (TimeFunction::Samples(unit.into()), signed)
            }
            FunctionSpec::Points(points, rescaled) => {
                let (time, value) = points.iter().map(|point| (point[0], point[1])).unzip();
                let (unit, peak) = SampledFunction::new(time, value)?.normalised();
                (TimeFunction::Samples(unit.into()), rescaled.unwrap_or(peak))
            }
        };
        if let Some((quantity, _)) = self.base() {
            return Ok(LoadCase::base_motion(quantity, function, amplitude)?);
        }
        Ok(LoadCase::force(function, amplitude).at(port))
    }
}
