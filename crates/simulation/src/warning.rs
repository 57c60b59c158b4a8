//! Warnings about a response that was computed but may mislead.

use std::fmt;

use asperity_structure::PreloadedContact;
use serde::Serialize;

/// A reason for doubt about a response, found whichever command asked for it.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
#[non_exhaustive]
pub enum Warning {
    /// Pressures left those at which the interface's law was measured; its stiffness is held at
    /// the end values there.
    OutsideMeasuredRange {
        /// Name of the interface.
        interface: String,
        /// Lowest pressure of the response \[Pa\].
        pressure_min_pa: f64,
        /// Highest pressure of the response \[Pa\].
        pressure_max_pa: f64,
        /// Lowest pressure of the measurement \[Pa\].
        measured_min_pa: f64,
        /// Highest pressure of the measurement \[Pa\].
        measured_max_pa: f64,
    },
    /// The accuracy that was asked for is not reached, by the estimated errors.
    AccuracyNotReached {
        /// Largest estimated error over the scale of its observable.
        estimated: f64,
        /// Relative accuracy that was asked for.
        asked: f64,
    },
    /// The response depends on rounding: two forces that differ by 1e-12 give responses that diverge.
    Sensitive {
        /// Time at which they diverge \[s\].
        from_s: f64,
    },
    /// A steady response differs from its time integration.
    IntegrationDiffers {
        /// Frequency \[Hz\].
        frequency_hz: f64,
        /// Difference of the fundamentals over the integrated one.
        relative_difference: f64,
    },
    /// Time integration from rest settles on another motion than a steady response, and from its own state it stays
    /// there: both exist.
    AnotherMotion {
        /// Frequency \[Hz\].
        frequency_hz: f64,
        /// Difference of the fundamentals over the integrated one.
        relative_difference: f64,
    },
    /// The largest stable steady response is left by time integration from its own state.
    NotKept {
        /// Frequency \[Hz\].
        frequency_hz: f64,
        /// Difference of the fundamentals over the integrated one.
        relative_difference: f64,
        /// Largest relative distance of the integrated fundamental of a period from the mean over many.
        scatter: f64,
    },
    /// A steady response that is given as the peak leaves out harmonics that matter.
    Unresolved {
        /// Frequency \[Hz\].
        frequency_hz: f64,
        /// Harmonics kept.
        harmonics: usize,
        /// Largest harmonic of a closure that is estimated to be missing, over the largest kept.
        truncation: f64,
    },
    /// The energy balance does not close to [`MOST_RESIDUAL`].
    EnergyBalance {
        /// Remainder of the balance over the input.
        residual_relative: f64,
    },
    /// The response is largest where the force is too weak for a receptance, and the fundamental is another maximum.
    HiddenResonance {
        /// Frequency \[Hz\].
        frequency_hz: f64,
    },
    /// A maximum of the receptance hardly is a peak, or hardly is none: the fundamental or the second harmonic may be
    /// another, or there may be none.
    MarginalPeak {
        /// Frequency \[Hz\].
        frequency_hz: f64,
    },
    /// The record ends before the response has decayed to [`UNDECAYED_RATIO`](asperity_signal::UNDECAYED_RATIO): a half-power
    /// damping ratio is too large, and a small maximum may be a ripple of its end.
    NotDecayed {
        /// Standard deviation of the last cycle or twentieth of the decay over its largest value.
        remaining: f64,
    },
}

/// Remainder of the energy balance, over the input, up to which there is no warning.
pub const MOST_RESIDUAL: f64 = 1e-2;

impl Warning {
    /// The warning about pressures of `lowest` to `highest` \[Pa\] at `interface`, if its law was
    /// measured in a range that they leave.
    pub(crate) fn outside_measured_range(
        interface: &PreloadedContact,
        lowest: f64,
        highest: f64,
    ) -> Option<Self> {
        let (low, high) = interface.law().measured_range()?;
        (lowest < low || highest > high).then(|| Self::OutsideMeasuredRange {
            interface: interface.name().to_owned(),
            pressure_min_pa: lowest,
            pressure_max_pa: highest,
            measured_min_pa: low,
            measured_max_pa: high,
        })
    }

    /// Name of the kind, as in `summary.json`.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::OutsideMeasuredRange { .. } => "outside_measured_range",
            Self::EnergyBalance { .. } => "energy_balance",
            Self::AccuracyNotReached { .. } => "accuracy_not_reached",
            Self::Sensitive { .. } => "sensitive",
            Self::IntegrationDiffers { .. } => "integration_differs",
            Self::AnotherMotion { .. } => "another_motion",
            Self::NotKept { .. } => "not_kept",
            Self::Unresolved { .. } => "unresolved",
            Self::HiddenResonance { .. } => "hidden_resonance",
            Self::MarginalPeak { .. } => "marginal_peak",
            Self::NotDecayed { .. } => "not_decayed",
        }
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OutsideMeasuredRange {
                interface,
                pressure_min_pa,
                pressure_max_pa,
                measured_min_pa,
                measured_max_pa,
            } => write!(
                f,
                "pressures of {pressure_min_pa:.4e} to {pressure_max_pa:.4e} Pa at interface \
                 \"{interface}\" leave those at which its law was measured, {measured_min_pa:.4e} \
                 to {measured_max_pa:.4e} Pa; the stiffness is held at the end values there"
            ),
            Self::AccuracyNotReached { estimated, asked } => write!(
                f,
                "the estimated relative error of the observables is {estimated:.1e}, more than the \
                 {asked:.0e} asked for; cell_m may be smaller, step_s and modes_per_body left out, \
                 modes of a reduction more, or a larger accuracy asked for"
            ),
            Self::Sensitive { from_s } => write!(
                f,
                "from {from_s:.4e} s on the response depends on rounding: forces that differ by \
                 1e-12 give responses that part; what depends on later times is one of many \
                 possible outcomes"
            ),
            Self::IntegrationDiffers { frequency_hz, relative_difference } => write!(
                f,
                "at {frequency_hz:.3} Hz the fundamental differs from time integration by {:.1} %: the \
                 branch is wrong there, or time integration settles on another motion; more \
                 harmonics, `bodies` elastic, or a stepped sine decide",
                100.0 * relative_difference
            ),
            Self::AnotherMotion { frequency_hz, relative_difference } => write!(
                f,
                "at {frequency_hz:.3} Hz time integration from rest settles on another motion, whose fundamental \
                 differs by {:.1} %; from the state of the response it stays there: both exist, and which one the \
                 structure takes depends on how it comes there, as a stepped sine (--sweep) shows",
                100.0 * relative_difference
            ),
            Self::NotKept { frequency_hz, relative_difference, scatter } => write!(
                f,
                "time integration from the largest stable response, at {frequency_hz:.3} Hz, does not keep it: the \
                 fundamental is then {:.1} % off, and that of a period scatters by {:.1} %; this peak is not that of the \
                 structure there, and a stepped sine (--sweep) shows what is",
                100.0 * relative_difference,
                100.0 * scatter
            ),
            Self::Unresolved { frequency_hz, harmonics, truncation } => write!(
                f,
                "the largest response, at {frequency_hz:.3} Hz with harmonics up to number {harmonics}, leaves out one of \
                 an estimated {:.1} % of the largest: its place and amplitude may be wrong; a check by time \
                 integration (--verify), a stepped sine (--sweep) or more harmonics decide",
                100.0 * truncation
            ),
            Self::EnergyBalance { residual_relative } => write!(
                f,
                "the energy balance closes to {residual_relative:.1e} of the input only; a smaller \
                 step or cell, or a law without a jump in stiffness, improves it"
            ),
            Self::HiddenResonance { frequency_hz } => write!(
                f,
                "the response is largest at {frequency_hz:.2} Hz, where the force is too weak for a receptance: the fundamental found \
                 need not be the resonance; a pulse of another length excites it"
            ),
            Self::MarginalPeak { frequency_hz } => write!(
                f,
                "whether the maximum at {frequency_hz:.2} Hz is the largest peak is not certain: it is about as high over its minima \
                 as the ripples of a record that ends while the motion rings, or as another maximum, or the force there or beside it is \
                 hardly strong enough; f1, A1 or A2/A1 depend on it, and a longer `duration_s`, or a pulse of another \
                 length, decides"
            ),
            Self::NotDecayed { remaining } => write!(
                f,
                "the record ends while {:.1} % of the decay remains, which widens peaks: a half-power damping ratio is too large, \
                 that by the decrement is not, and a small maximum may be a ripple of the end; a longer `duration_s` mends it",
                100.0 * remaining
            ),
        }
    }
}
