//! Spectra, frequency response functions, harmonics and damping of sampled signals.
//!
//! A hit of a hammer test is two sampled signals: the force `F` and the displacement, velocity
//! or acceleration that responds to it. All results start from the one-sided
//! Fourier transform by the rectangle rule,
//!
//! ```text
//! X(f) = dt * sum_n x_n exp(-i 2 pi f n dt),    0 <= n < N,
//! ```
//!
//! evaluated on a grid by FFT ([`Spectrum`]) or at any single frequency
//! ([`transform_at`]). The receptance `H(f) = U(f) / F(f)` \[m/N\] of a [`FrequencyResponse`]
//! gives the fundamental `(f1, A1 = |H(f1)|)` and the second harmonic `(f2, A2 = |H(f2)|)`
//! ([`find_harmonics`]), with the ratio of receptances `A2/A1` ([`Harmonics::ratio`]), and damping
//! from the half-power width ([`half_power`]). [`envelope_decrement`] and, where one mode decays,
//! [`logarithmic_decrement`] give damping from the decay itself. [`ReceptanceFeatures`] are all of these for one hit.
//!
//! [`hammer_test`] analyses a record of many hits. Its steps:
//!
//! | step | items |
//! |---|---|
//! | detect hits in a record or a stream | [`find_hits`], [`HitFinder`] |
//! | check their quality | [`quality_issues`], [`QualityIssue`] |
//! | force pulse, sensor offset and drift | [`Pulse`], [`Offset`], [`HighPass`] |
//! | windows and their correction | [`ForceWindow`], [`ResponseWindow`], [`ExponentialWindow`] |
//! | fundamental and second harmonic | [`dominant_frequency`], [`find_harmonics`] |
//! | harmonic or mode near twice the fundamental | [`HarmonicTest`] |
//! | derivatives of a peak | [`PeakSensitivity`] |
//! | uncertainty from noise | [`peak_uncertainty`], [`ModeUncertainty`], [`quiet_density`] |
//! | damping by three methods | [`half_power`], [`circle_fit`], [`logarithmic_decrement`] |
//! | length of a decay in its record | [`decay_length`] |
//! | averages: H1, H2, Hv, coherence | [`FrfAverage`], [`FrfEstimator`] |
//! | frequency and damping against amplitude | [`backbone`], [`BandPass`] |
//!
//! [`FreeDecay`] analyses decays without a measured force, which [`find_decays`] finds.
//!
//! A peak is a true local maximum of `|H|`, refined on the transform itself. A search without a
//! peak returns `None`, never a limit of its window; frequencies at which the force is too weak are
//! masked.
//!
//! The crate contains no mechanics. Fast transforms are those of `asperity-transform`.
//!
//! ```
//! use asperity_signal::{HarmonicOptions, FrequencyResponse, find_harmonics, half_power};
//!
//! // Impulse response of a 1 kg oscillator at 800 Hz with 3.5 % of critical damping.
//! let (rate, natural, damping) = (2.0e5, 800.0, 0.035_f64);
//! let omega = std::f64::consts::TAU * natural;
//! let damped = omega * (1.0 - damping * damping).sqrt();
//! let time = |n: usize| n as f64 / rate;
//! let displacement: Vec<f64> = (0..24_000)
//!     .map(|n| (-damping * omega * time(n)).exp() * (damped * time(n)).sin() / damped)
//!     .collect();
//! let mut force = vec![0.0; displacement.len()];
//! force[0] = rate;
//!
//! let hit = FrequencyResponse::from_displacement(&force, &displacement, rate)?;
//! let found = find_harmonics(&hit, 820.0, &HarmonicOptions::default());
//! let peak = found.fundamental.ok_or("an oscillator has a peak")?;
//! assert!((peak.frequency_hz - natural * (1.0 - 2.0 * damping * damping).sqrt()).abs() < 0.1);
//! assert!((half_power(&hit, &peak).ok_or("a mode has a width")? - damping).abs() < 1e-4);
//! assert!(found.second.is_none());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod average;
mod bessel;
mod complex_system;
mod damping;
mod decay_length;
mod decimation;
mod decrement;
mod dominant;
mod envelope_decrement;
mod error;
mod fit;
mod form;
mod free_decay;
mod frf;
mod hammer;
mod harmonics;
mod high_pass;
mod hit;
mod interpolation;
mod noise;
mod offset;
mod peak;
mod peak_sensitivity;
mod pulse;
mod receptance_features;
mod response;
mod ring_down;
mod root;
mod sampled_peak;
mod shared_force;
mod spectra;
mod spectrum;
mod sums;
mod transform;
mod uncertainty;
mod window;

pub use asperity_transform::fast_length;
pub use average::{
    Coherence, FrfAverage, FrfEstimator, FrfSums, HvScaling, MagnitudeSpread, SpectralDensity,
};
pub use damping::{
    CircleFit, DampingComparison, HalfPower, circle_fit, circle_fit_of, half_power,
    half_power_crossings, half_power_of,
};
pub use decay_length::decay_length;
pub use decimation::DecimationFilter;
pub use decrement::{LogarithmicDecrement, logarithmic_decrement};
pub use dominant::dominant_frequency;
pub use envelope_decrement::envelope_decrement;
pub use error::SignalError;
pub use form::{FrfForm, ResponseKind};
pub use free_decay::{
    AmplitudeTrend, Beating, DecayEnd, DecayHarmonic, DecayOrigin, DecayPoint, DecayResonance,
    FoundDecay, FreeDecay, FreeDecayOptions, LinearMode, TwoModes, find_decays, level_range,
};
pub use frf::{ForceMask, Frf};
pub use hammer::{
    AnalysedHit, BandMode, FundamentalSearch, HammerOptions, HammerTest, HarmonicTest, HitFeatures,
    HitWindows, ModeFeatures, ModeUncertainty, PeakOrigin, analyse_hit, hammer_test,
};
pub use harmonics::{HarmonicOptions, Harmonics, SECOND_HARMONIC_WINDOW, find_harmonics};
pub use high_pass::HighPass;
pub use hit::{
    DoubleHit, HitChannel, HitFinder, HitLength, HitOptions, HitRecord, QualityIssue,
    QualityOptions, Trigger, TriggerLevel, UNDECAYED_RATIO, double_hits, find_hits, quality_issues,
};
pub use noise::{RobustLevel, band_density, quiet_density, robust_level, white_density};
pub use num_complex::Complex64;
pub use offset::{Offset, OffsetSource};
pub use peak::Peak;
pub use peak_sensitivity::{PeakDerivative, PeakSensitivity};
pub use pulse::Pulse;
pub use receptance_features::ReceptanceFeatures;
pub use response::FrequencyResponse;
pub use ring_down::{
    Backbone, BackboneOptions, BackbonePoint, BackboneUncertainty, BandPass, analytic_signal,
    backbone,
};
pub use sampled_peak::SampledPeak;
pub use shared_force::SharedForce;
pub use spectra::UnfilteredEnd;
pub use spectrum::Spectrum;
pub use transform::{transform_at, transform_pair_at};
pub use uncertainty::{
    NoiseDensity, NoiseWindows, PeakUncertainty, peak_uncertainty, ratio_uncertainty,
};
pub use window::{ExponentialWindow, ForceWindow, ResponseWindow};
