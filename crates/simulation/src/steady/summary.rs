//! `summary.json` of steady responses, under the names of the contract.

use asperity_harmonic::{Branch, HarmonicError, PeriodicResponse, Termination};
use serde::Serialize;

use super::{
    Backbones, CondensationReason, CondensedBody, IntegratedMotion, StabilityUnknown, Steady,
    SteadyLevel, TimeCheck, TimeSweep,
};
use crate::provenance::Provenance;
use crate::static_state::StaticSummary;
use crate::warning::Warning;

/// Identifier of the summary's format.
pub const STEADY_SCHEMA: &str = "asperity/steady/1";

/// The summary of the steady responses of one scenario.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SteadySummary {
    /// [`STEADY_SCHEMA`].
    pub schema: &'static str,
    /// Title of the scenario.
    pub title: Option<String>,
    /// State at rest.
    #[serde(rename = "static")]
    pub at_rest: StaticSummary,
    /// The force amplitudes, in the order of the request.
    pub levels: Vec<LevelSummary>,
    /// The branches from the other end of the range where one from its start leaves it there.
    pub other_parts: Vec<LevelSummary>,
    /// The backbones, if requested.
    pub backbone: Option<BackbonesSummary>,
    /// The stepped sines by time integration, if requested.
    pub time_sweeps: Vec<TimeSweepSummary>,
    /// Time of the computation \[s\].
    pub wall_s: f64,
    /// Origin of the numbers.
    pub provenance: Provenance,
}

/// Amplitude of the load.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(untagged)]
pub enum LoadAmplitude {
    /// A force.
    Force {
        /// Amplitude \[N\].
        force_n: f64,
    },
    /// A motion of the base.
    Base {
        /// Amplitude of its acceleration \[m/s2\].
        base_acceleration_m_per_s2: f64,
    },
}

impl LoadAmplitude {
    fn new(value: f64, base: bool) -> Self {
        if base {
            Self::Base { base_acceleration_m_per_s2: value }
        } else {
            Self::Force { force_n: value }
        }
    }

    /// The number.
    pub fn value(self) -> f64 {
        match self {
            Self::Force { force_n: value } | Self::Base { base_acceleration_m_per_s2: value } => {
                value
            }
        }
    }

    /// The unit.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Force { .. } => "N",
            Self::Base { .. } => "m/s²",
        }
    }
}

/// One amplitude of the load.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum LevelSummary {
    /// A branch of responses.
    Solved(Box<BranchSummary>),
    /// An amplitude without a response.
    Failed {
        /// Amplitude of the load.
        #[serde(flatten)]
        load: LoadAmplitude,
        /// The error.
        error: String,
    },
}

/// The branch of one force amplitude.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BranchSummary {
    /// Amplitude of the load.
    #[serde(flatten)]
    pub load: LoadAmplitude,
    /// Frequency of the largest fundamental of the loaded port \[Hz\].
    pub peak_frequency_hz: Option<f64>,
    /// Fundamental of the displacement at the first sensor there \[m\], relative to the base.
    pub peak_amplitude_1_m: Option<f64>,
    /// Ratio of displacements u2/u1 of the first sensor there: second harmonic over fundamental.
    pub displacement_ratio: Option<f64>,
    /// True if that response is stable; none if its stability was not computed.
    pub peak_is_stable: Option<bool>,
    /// Largest harmonic of a closure that is estimated to be missing in it, over the largest kept.
    pub peak_truncation: Option<f64>,
    /// True if that is a peak inside a branch that covers the whole range.
    pub peak_is_inside: bool,
    /// Number of points.
    pub points: usize,
    /// Number of harmonics.
    pub harmonics: usize,
    /// Largest share of the last harmonics in a response.
    pub truncation: f64,
    /// Termination of the branch.
    pub end: TerminationSummary,
    /// Frequency of the first response \[Hz\].
    pub start_frequency_hz: Option<f64>,
    /// Frequency of the last response \[Hz\].
    pub end_frequency_hz: Option<f64>,
    /// The branch with more harmonics that did not cover the range, where this one took its place.
    pub finer: Option<UnfinishedSummary>,
    /// Frequency of the stable response with the largest fundamental of the loaded port \[Hz\].
    pub stable_peak_frequency_hz: Option<f64>,
    /// Fundamental of the displacement at the first sensor there \[m\].
    pub stable_peak_amplitude_1_m: Option<f64>,
    /// The same response by time integration from its own state, where it loses contact.
    pub stable_peak_integrated: Option<TimeCheck>,
    /// Ranges of frequency in which neither part of the branch has a stable response \[Hz\].
    pub ranges_without_stable_hz: Vec<[f64; 2]>,
    /// Motions by time integration at frequencies in these ranges.
    pub motions: Vec<IntegratedMotion>,
    /// True if contact is lost in a response.
    pub contact_lost: bool,
    /// Frequency of the first response along the branch that loses contact \[Hz\].
    pub contact_lost_from_hz: Option<f64>,
    /// The bodies without inertia on the branch.
    pub condensed_bodies: Vec<CondensedBody>,
    /// The reason why they are condensed, if there are any.
    pub condensed_because: Option<CondensationReason>,
    /// Number of unstable points; none if stability was not computed for all.
    pub unstable_points: Option<usize>,
    /// The reason for which it was not, if it was not.
    pub stability_unknown: Option<StabilityUnknown>,
    /// The bifurcations, along the branch.
    pub bifurcations: Vec<BifurcationSummary>,
    /// A response by time integration, if requested.
    pub verify: Option<TimeCheck>,
    /// Warnings about the responses.
    pub warnings: Vec<Warning>,
    /// Time of the computation \[s\].
    pub wall_s: f64,
}

/// A branch that did not cover the range.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct UnfinishedSummary {
    /// Number of harmonics.
    pub harmonics: usize,
    /// Number of points.
    pub points: usize,
    /// Termination of the branch.
    pub end: TerminationSummary,
    /// Frequency of the last response \[Hz\].
    pub end_frequency_hz: f64,
}

/// Termination of a branch.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum TerminationSummary {
    /// The last value of the range is reached.
    Reached,
    /// The branch has returned to its start.
    Returned,
    /// The corrector does not converge at the smallest step.
    NotConverged,
    /// The largest number of points is reached.
    PointLimit,
    /// Contact is lost, where the branch was to end.
    ContactLost,
    /// A closure is beyond the domain of a law.
    BeyondLaw {
        /// Name of the interface.
        interface: String,
        /// The closure \[m\].
        closure_m: f64,
    },
}

/// A bifurcation on a branch.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BifurcationSummary {
    /// Kind of the bifurcation.
    pub kind: &'static str,
    /// Frequency \[Hz\].
    pub frequency_hz: f64,
    /// Fundamental of the first sensor \[m\].
    pub amplitude_1_m: f64,
}

/// Both backbones.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BackbonesSummary {
    /// Phase resonance over force.
    pub phase_resonance: BackboneSummary,
    /// The damped mode over amplitude.
    pub mode: BackboneSummary,
}

/// One backbone.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum BackboneSummary {
    /// A branch of resonances.
    Solved {
        /// Number of points.
        points: usize,
        /// Termination of the branch.
        end: TerminationSummary,
        /// Frequency of the last point \[Hz\].
        last_frequency_hz: Option<f64>,
        /// Fundamental of the first sensor at the last point \[m\].
        last_amplitude_1_m: Option<f64>,
    },
    /// A backbone that was not found.
    Failed {
        /// The error.
        error: String,
    },
}

impl SteadySummary {
    /// The summary of `steady`, for a scenario with this title and state at rest.
    pub fn new(
        title: Option<String>,
        at_rest: StaticSummary,
        steady: &Steady,
        provenance: Provenance,
    ) -> Self {
        let backbones = |found: &Backbones| BackbonesSummary {
            phase_resonance: BackboneSummary::of(&found.phase_resonance),
            mode: BackboneSummary::of(&found.mode),
        };
        let base = steady.is_base_motion;
        let levels = |levels: &[SteadyLevel]| {
            levels.iter().map(|level| LevelSummary::of(level, base)).collect()
        };
        let sweeps = steady.time_sweeps.iter().map(|sweep| TimeSweepSummary::of(sweep, base));
        Self {
            schema: STEADY_SCHEMA,
            title,
            at_rest,
            levels: levels(&steady.levels),
            other_parts: levels(&steady.other_parts),
            backbone: steady.backbones.as_ref().map(backbones),
            time_sweeps: sweeps.collect(),
            wall_s: steady.wall_s,
            provenance,
        }
    }
}

impl SteadySummary {
    /// The branches of all levels, then the other parts, as `steady.csv` numbers them from 1.
    pub fn parts(&self) -> impl Iterator<Item = &LevelSummary> {
        self.levels.iter().chain(&self.other_parts)
    }
}

/// A stepped sine by time integration.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TimeSweepSummary {
    /// Amplitude of the load.
    #[serde(flatten)]
    pub load: LoadAmplitude,
    /// `"up"` or `"down"`.
    pub direction: &'static str,
    /// Number of frequencies.
    pub frequencies: usize,
    /// Frequency of the largest fundamental \[Hz\].
    pub peak_frequency_hz: Option<f64>,
    /// Largest fundamental of the first sensor \[m\].
    pub peak_amplitude_1_m: Option<f64>,
    /// Number of frequencies at which the motion has not settled.
    pub unsettled: usize,
    /// Largest relative change of a fundamental between its last periods and those before.
    pub largest_change: f64,
    /// Pairs of neighbouring frequencies between which the fundamental jumps \[Hz\].
    pub jumps_hz: Vec<[f64; 2]>,
    /// The error of a sweep that failed.
    pub error: Option<String>,
}

impl TimeSweepSummary {
    fn of(sweep: &TimeSweep, base: bool) -> Self {
        let points = sweep.outcome.as_ref().map_or(&[][..], |points| points);
        let peak = points.iter().max_by(|a, b| a.amplitude_1_m.total_cmp(&b.amplitude_1_m));
        Self {
            load: LoadAmplitude::new(sweep.force_n, base),
            direction: sweep.direction(),
            frequencies: points.len(),
            peak_frequency_hz: peak.map(|peak| peak.frequency_hz),
            peak_amplitude_1_m: peak.map(|peak| peak.amplitude_1_m),
            unsettled: points.iter().filter(|point| !point.settled).count(),
            largest_change: points.iter().fold(0.0, |most, point| point.change.max(most)),
            jumps_hz: sweep.jumps(),
            error: sweep.outcome.as_ref().err().map(ToString::to_string),
        }
    }
}

impl LevelSummary {
    fn of(level: &SteadyLevel, base: bool) -> Self {
        let load = LoadAmplitude::new(level.force_n, base);
        let branch = match &level.outcome {
            Ok(branch) => branch,
            Err(error) => return Self::Failed { load, error: error.to_string() },
        };
        let (peak, stable) = (branch.highest(), branch.highest_stable());
        let bifurcations = branch.special.iter().filter(|special| special.kind.is_bifurcation());
        let amplitude = |peak: &PeriodicResponse, k: usize| peak.at_sensor(0, k).norm();
        Self::Solved(Box::new(BranchSummary {
            load,
            peak_frequency_hz: peak.map(PeriodicResponse::frequency_hz),
            peak_amplitude_1_m: peak.map(|peak| amplitude(peak, 1)),
            displacement_ratio: peak.map(|peak| amplitude(peak, 2) / amplitude(peak, 1)),
            peak_is_stable: peak.and_then(PeriodicResponse::stable),
            peak_truncation: peak.map(|peak| peak.truncation),
            peak_is_inside: branch.peak().is_some(),
            points: branch.points.len(),
            harmonics: branch.harmonics,
            truncation: branch.truncation(),
            end: TerminationSummary::of(&branch.termination),
            start_frequency_hz: branch.points.first().map(PeriodicResponse::frequency_hz),
            end_frequency_hz: branch.points.last().map(PeriodicResponse::frequency_hz),
            finer: branch.finer.as_ref().map(|finer| UnfinishedSummary {
                harmonics: finer.harmonics,
                points: finer.points,
                end: TerminationSummary::of(&finer.termination),
                end_frequency_hz: finer.frequency_hz,
            }),
            stable_peak_frequency_hz: stable.map(PeriodicResponse::frequency_hz),
            stable_peak_amplitude_1_m: stable.map(|peak| amplitude(peak, 1)),
            stable_peak_integrated: level.from_own_state,
            ranges_without_stable_hz: level.ranges_without_stable_hz.clone(),
            motions: level.motions.clone(),
            contact_lost: branch.points.iter().any(PeriodicResponse::contact_lost),
            contact_lost_from_hz: branch
                .points
                .iter()
                .find(|point| point.contact_lost())
                .map(PeriodicResponse::frequency_hz),
            condensed_bodies: level
                .condensed
                .as_ref()
                .map_or_else(Vec::new, |condensed| condensed.light.bodies().to_vec()),
            condensed_because: level.condensed.as_ref().map(|condensed| condensed.reason),
            unstable_points: branch
                .points
                .iter()
                .map(|point| point.stable().map(|stable| usize::from(!stable)))
                .sum(),
            stability_unknown: level.stability_unknown,
            bifurcations: bifurcations
                .map(|special| BifurcationSummary {
                    kind: special.kind.name(),
                    frequency_hz: special.response.frequency_hz(),
                    amplitude_1_m: amplitude(&special.response, 1),
                })
                .collect(),
            verify: level.check,
            warnings: level.warnings.clone(),
            wall_s: level.wall_s,
        }))
    }
}

impl BackboneSummary {
    fn of(outcome: &Result<Branch, HarmonicError>) -> Self {
        match outcome {
            Ok(branch) => Self::Solved {
                points: branch.points.len(),
                end: TerminationSummary::of(&branch.termination),
                last_frequency_hz: branch.points.last().map(PeriodicResponse::frequency_hz),
                last_amplitude_1_m: branch.points.last().map(|point| point.at_sensor(0, 1).norm()),
            },
            Err(error) => Self::Failed { error: error.to_string() },
        }
    }
}

impl TerminationSummary {
    fn of(end: &Termination) -> Self {
        match end {
            Termination::Reached => Self::Reached,
            Termination::Returned => Self::Returned,
            Termination::NotConverged => Self::NotConverged,
            Termination::PointLimit => Self::PointLimit,
            Termination::ContactLost => Self::ContactLost,
            Termination::BeyondLaw { interface, closure } => {
                Self::BeyondLaw { interface: interface.clone(), closure_m: *closure }
            }
        }
    }
}
