//! From samples to spectra, frequency response functions, harmonics and damping.
//!
//! A hit is two sampled signals: the force `F` and the displacement, velocity
//! or acceleration it causes. Everything here starts from one sum, the one-sided
//! Fourier transform by the rectangle rule,
//!
//! ```text
//! X(f) = dt * sum_n x_n exp(-i 2 pi f n dt),    0 <= n < N,
//! ```
//!
//! evaluated on a grid by FFT ([`Spectrum`]) or at any single frequency
//! ([`transform_at`]). The receptance `H(f) = U(f) / F(f)` of a [`FrequencyResponse`]
//! follows, and from it the observables of a vibration test: the fundamental
//! and its second harmonic ([`find_harmonics`]), damping from the half-power
//! width ([`half_power`]) or from the decay itself ([`logarithmic_decrement`]),
//! and the time average of a stiffness ([`average_stiffness`]).
//!
//! A hammer test is a record of many hits. [`hammer_test`] goes all the way; its steps are
//! public:
//!
//! | step | by |
//! |---|---|
//! | cut a record or a stream into hits | [`find_hits`], [`HitFinder`] |
//! | judge them | [`quality_issues`], [`QualityIssue`] |
//! | describe the blow, take the offset away | [`Pulse`], [`Offset`] |
//! | window, and undo what the window did | [`ForceWindow`], [`ExponentialWindow`] |
//! | find where the fundamental is | [`dominant_frequency`], [`find_harmonics`] |
//! | say how it follows a parameter | [`PeakSensitivity`] |
//! | say how sure it is | [`peak_uncertainty`], [`white_density`], [`band_density`] |
//! | damping, three ways | [`half_power`], [`circle_fit`], [`logarithmic_decrement`] |
//! | average: H1, H2, Hv, coherence | [`FrfAverage`] |
//! | frequency and damping against amplitude | [`backbone`], [`BandPass`] |
//!
//! A peak is a true local maximum of `|H|` refined on the transform itself.
//! Where there is none the answer is `None`, never the edge of a search
//! window; where the force has no content the answer is masked and says so.
//!
//! The crate knows samples, rates and hertz. It knows no mechanics: no mesh,
//! no contact, no units beyond those in the documentation.
//!
//! ```
//! use asperity_signal::{HarmonicOptions, FrequencyResponse, find_harmonics, half_power};
//!
//! // A 1 kg oscillator at 800 Hz with 3.5 % of critical damping, struck by an impulse.
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
//! let peak = found.fundamental.ok_or("a linear oscillator has a peak")?;
//! assert!((peak.frequency_hz - natural * (1.0 - 2.0 * damping * damping).sqrt()).abs() < 0.1);
//! assert!((half_power(&hit, &peak).ok_or("and a width")? - damping).abs() < 1e-4);
//! assert!(found.second.is_none(), "and no second harmonic");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod average;
mod damping;
mod decimate;
mod decrement;
mod derivative;
mod dominant;
mod error;
mod fine;
mod form;
mod frf;
mod hammer;
mod harmonics;
mod hit;
mod interpolation;
mod noise;
mod pairwise;
mod peak;
mod response;
mod ring_down;
mod root;
mod shared_force;
mod spectrum;
mod transform;
mod uncertainty;
mod window;

pub use average::{
    Coherence, FrfAverage, FrfEstimator, HvScaling, MagnitudeSpread, SpectralDensity,
};
pub use damping::{
    CircleFit, DampingComparison, HalfPower, circle_fit, circle_fit_of, half_power,
    half_power_crossings, half_power_of,
};
pub use decimate::DecimationFilter;
pub use decrement::{LogarithmicDecrement, logarithmic_decrement};
pub use derivative::{PeakDerivative, PeakSensitivity};
pub use dominant::dominant_frequency;
pub use error::SignalError;
pub use form::{FrfForm, ResponseKind};
pub use frf::{ForceMask, Frf};
pub use hammer::{
    AnalysedHit, FundamentalSearch, HammerOptions, HammerTest, HitFeatures, HitWindows,
    analyse_hit, hammer_test,
};
pub use harmonics::{HarmonicOptions, Harmonics, find_harmonics};
pub use hit::{
    DoubleHit, HitChannel, HitFinder, HitLength, HitOptions, HitRecord, Offset, OffsetSource,
    Pulse, QualityIssue, QualityOptions, Trigger, TriggerLevel, double_hits, find_hits,
    quality_issues,
};
pub use noise::{RobustLevel, band_density, robust_level, white_density};
pub use pairwise::average_stiffness;
pub use peak::Peak;
pub use realfft::num_complex::Complex64;
pub use response::FrequencyResponse;
pub use ring_down::{
    Backbone, BackboneOptions, BackbonePoint, BandPass, analytic_signal, backbone,
};
pub use shared_force::{SharedForce, SharedForceFeatures};
pub use spectrum::{Spectrum, fast_length};
pub use transform::{transform_at, transform_pair_at};
pub use uncertainty::{NoiseDensity, PeakUncertainty, peak_uncertainty, ratio_uncertainty};
pub use window::{ExponentialWindow, ForceWindow};
