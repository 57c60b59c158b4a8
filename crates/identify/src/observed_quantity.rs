//! Predicted quantities from the results of simulated hits.

use std::f64::consts::TAU;

use asperity_signal::{BackboneOptions, BackbonePoint, BandPass, Complex64, backbone};

use crate::problem_parameters::Gains;
use asperity_simulation::quantity::{observable_names, unit_of};

/// The quantity of one observation.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum ObservedQuantity {
    /// A feature of a hit, by its place among the summary's numbers.
    Feature {
        /// The hit.
        hit: usize,
        /// The feature.
        column: usize,
    },
    /// Ratio of a feature of two hits.
    Ratio {
        /// The hits above and below.
        hits: [usize; 2],
        /// The feature.
        column: usize,
    },
    /// Real or imaginary part of a receptance \[m/N\].
    Receptance {
        /// The hit.
        hit: usize,
        /// Place among its frequencies.
        place: usize,
        /// The part.
        part: ComplexPart,
    },
    /// Frequency \[Hz\] or damping ratio of the backbone at a measured amplitude \[m\].
    Backbone {
        /// The hit.
        hit: usize,
        /// The amplitude, as measured.
        amplitude: f64,
        /// True for the damping ratio.
        is_damping: bool,
    },
    /// Amplitude \[m\] of a steady response to a shaker.
    SteadyAmplitude {
        /// The response, by its index among all.
        response: usize,
    },
    /// Phase \[rad\] of a steady response to a shaker.
    SteadyPhase {
        /// The response.
        response: usize,
        /// The measured phase: the prediction is within half a turn of it.
        near: f64,
    },
    /// Stiffness of a law \[Pa/m\], by its index among those requested.
    Stiffness {
        /// The place.
        place: usize,
    },
}

/// A part of a complex number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ComplexPart {
    Real,
    Imaginary,
}

/// Results of a hit, or their derivatives.
#[derive(Debug, Clone, Default)]
pub(super) struct HitOutcome {
    /// Numbers of the summary; NaN where there is none.
    pub(super) columns: Vec<f64>,
    /// Receptance at the requested frequencies \[m/N\].
    pub(super) receptance: Vec<Complex64>,
    /// The backbone, if requested, in the order of time.
    pub(super) backbone: Vec<BackbonePoint>,
    /// Lowest and highest pressure \[Pa\] at each interface, of a cell of a patch; empty in derivatives.
    pub(super) pressures: Vec<[f64; 2]>,
}

/// Results at one point.
#[derive(Debug, Clone, Default)]
pub(super) struct PointOutcomes {
    /// Of every hit.
    pub(super) hits: Vec<HitOutcome>,
    /// Requested stiffnesses \[Pa/m\].
    pub(super) stiffness: Vec<f64>,
    /// Steady responses to a shaker as the sensors show them \[m\].
    pub(super) steady: Vec<Option<Complex64>>,
}

/// Names of the summary's numbers, and those that are receptances, which the gains scale.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct SummaryColumns {
    pub(super) names: Vec<String>,
    receptance: Vec<bool>,
}

impl SummaryColumns {
    /// The numbers of a structure with these interfaces, and with these sensors after the first.
    pub(super) fn new(interfaces: &[&str], further: &[&str]) -> Self {
        let names = observable_names(interfaces, further, false);
        let receptance = names.iter().map(|name| unit_of(name) == "m/N").collect();
        Self { names, receptance }
    }

    pub(super) fn find(&self, feature: &str) -> Option<usize> {
        self.names.iter().position(|name| name == feature)
    }
}

impl ObservedQuantity {
    /// The quantity as measured with these `gains` (one pair per hit).
    pub(super) fn value(
        &self,
        outcomes: &PointOutcomes,
        gains: &[Gains],
        columns: &SummaryColumns,
    ) -> Option<f64> {
        let shown = |hit: usize, column: usize| {
            let number = *outcomes.hits[hit].columns.get(column)?;
            let receptance = columns.receptance[column];
            let scale = if receptance { receptance_gain(gains[hit]) } else { 1.0 };
            (!number.is_nan()).then_some(number * scale)
        };
        match *self {
            Self::Feature { hit, column } => shown(hit, column),
            Self::Ratio { hits: [above, below], column } => {
                Some(shown(above, column)? / shown(below, column)?)
            }
            Self::Receptance { hit, place, part } => {
                let value = *outcomes.hits[hit].receptance.get(place)?;
                Some(part.of(value) * receptance_gain(gains[hit]))
            }
            Self::Backbone { hit, amplitude, is_damping } => {
                value_at(&outcomes.hits[hit].backbone, amplitude / gains[hit].response, is_damping)
            }
            Self::SteadyAmplitude { response } => Some((*outcomes.steady.get(response)?)?.norm()),
            Self::SteadyPhase { response, near } => {
                let phase = (*outcomes.steady.get(response)?)?.arg();
                Some(phase - TAU * ((phase - near) / TAU).round())
            }
            Self::Stiffness { place } => outcomes.stiffness.get(place).copied(),
        }
    }

    /// True if a gain of the response scales it.
    pub(super) fn is_receptance(&self, columns: &SummaryColumns) -> bool {
        match *self {
            Self::Receptance { .. } | Self::SteadyAmplitude { .. } => true,
            Self::Feature { column, .. } => columns.receptance.get(column) == Some(&true),
            _ => false,
        }
    }

    /// True if the quantity is of a hit for which `is_named` is true.
    pub(super) fn is_of_hit(&self, is_named: impl Fn(usize) -> bool) -> bool {
        match *self {
            Self::Feature { hit, .. }
            | Self::Receptance { hit, .. }
            | Self::Backbone { hit, .. } => is_named(hit),
            Self::Ratio { hits: [above, below], .. } => is_named(above) || is_named(below),
            Self::SteadyAmplitude { .. } | Self::SteadyPhase { .. } | Self::Stiffness { .. } => {
                false
            }
        }
    }

    /// Its derivative at fixed gains, from the derivatives of the results. The derivative of a backbone
    /// is the central difference of two backbones at the distance `backbones.0`.
    pub(super) fn derivative(
        &self,
        outcomes: &PointOutcomes,
        derivatives: &PointOutcomes,
        backbones: (f64, &[[Vec<BackbonePoint>; 2]]),
        gains: &[Gains],
        columns: &SummaryColumns,
    ) -> Option<f64> {
        match *self {
            Self::Ratio { hits: [above, below], column } => {
                let part = |hit: usize| {
                    let value = *outcomes.hits[hit].columns.get(column)?;
                    Some(*derivatives.hits[hit].columns.get(column)? / value)
                };
                let derivative =
                    self.value(outcomes, gains, columns)? * (part(above)? - part(below)?);
                (!derivative.is_nan()).then_some(derivative)
            }
            Self::Backbone { hit, amplitude, is_damping } => {
                let (step, curves) = backbones;
                let [beyond, before] = curves.get(hit)?;
                let at = |curve| value_at(curve, amplitude / gains[hit].response, is_damping);
                Some((at(beyond)? - at(before)?) / (2.0 * step))
            }
            Self::SteadyAmplitude { response } => {
                let [u, du] = steady(outcomes, derivatives, response)?;
                Some((u.conj() * du).re / u.norm())
            }
            Self::SteadyPhase { response, .. } => {
                let [u, du] = steady(outcomes, derivatives, response)?;
                Some((du / u).im)
            }
            // All others are linear in the results.
            _ => self.value(derivatives, gains, columns),
        }
    }
}

/// A steady response and its derivative.
fn steady(
    outcomes: &PointOutcomes,
    derivatives: &PointOutcomes,
    response: usize,
) -> Option<[Complex64; 2]> {
    Some([(*outcomes.steady.get(response)?)?, (*derivatives.steady.get(response)?)?])
}

impl ComplexPart {
    pub(super) fn of(self, value: Complex64) -> f64 {
        match self {
            Self::Real => value.re,
            Self::Imaginary => value.im,
        }
    }
}

fn receptance_gain(gains: Gains) -> f64 {
    gains.response / gains.force
}

/// Half width of the band of a decay relative to its fundamental, as for measured hits.
const BAND_PART: f64 = 0.3;

/// The backbone of a decay \[m\] about its fundamental \[Hz\], found as for measured hits; empty
/// where there is none.
pub(super) fn backbone_of(decay: &[f64], rate: f64, fundamental: f64) -> Vec<BackbonePoint> {
    let options = BandPass::around(fundamental, BAND_PART).map(BackboneOptions::new);
    let found = options.and_then(|options| backbone(decay, rate, &options));
    found.map(|found| found.points).unwrap_or_default()
}

/// Ratio of amplitudes over which a backbone is extrapolated at its ends.
const BEYOND: f64 = 1.5;

/// Frequency \[Hz\] or damping ratio of a backbone at an amplitude \[m\], linear in the logarithm of the
/// amplitude and extrapolated by at most [`BEYOND`]; `None` further out.
fn value_at(points: &[BackbonePoint], amplitude: f64, is_damping: bool) -> Option<f64> {
    let value = |point: &BackbonePoint| {
        if is_damping { point.damping_ratio } else { point.frequency_hz }
    };
    let falls = |pair: &&[BackbonePoint]| pair[0].amplitude > pair[1].amplitude;
    let mut pairs = points.windows(2).filter(falls);
    let first = pairs.clone().next()?;
    let last = pairs.clone().next_back()?;
    let pair = if amplitude > first[0].amplitude {
        (amplitude <= BEYOND * first[0].amplitude).then_some(first)?
    } else if amplitude < last[1].amplitude {
        (BEYOND * amplitude >= last[1].amplitude).then_some(last)?
    } else {
        pairs.find(|pair| (pair[1].amplitude..=pair[0].amplitude).contains(&amplitude))?
    };
    let [a, b] = [&pair[0], &pair[1]];
    let share = (amplitude / a.amplitude).ln() / (b.amplitude / a.amplitude).ln();
    Some(value(a) + share * (value(b) - value(a)))
}
