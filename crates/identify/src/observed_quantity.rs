//! Predicted quantities from the results of simulated hits.

use asperity_signal::{BackboneOptions, BackbonePoint, BandPass, Complex64, backbone};

use crate::problem_parameters::Gains;
use asperity_study::quantity::{Observable, observable_names};

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
    /// A feature of one hit over that of another.
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
    /// Frequency of the backbone \[Hz\] at a measured amplitude \[m\].
    Backbone {
        /// The hit.
        hit: usize,
        /// The amplitude, as measured.
        amplitude: f64,
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
}

/// Results at one point.
#[derive(Debug, Clone, Default)]
pub(super) struct PointOutcomes {
    /// Of every hit.
    pub(super) hits: Vec<HitOutcome>,
    /// Requested stiffnesses \[Pa/m\].
    pub(super) stiffness: Vec<f64>,
}

/// Names of the summary's numbers, and those that are receptances, which the gains scale.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct SummaryColumns {
    pub(super) names: Vec<String>,
    receptance: Vec<bool>,
}

impl SummaryColumns {
    pub(super) fn new(interfaces: &[&str]) -> Self {
        let names = observable_names(interfaces);
        let receptance = Observable::all(interfaces.len())
            .iter()
            .map(|observable| observable.quantity.unit() == "m/N")
            .collect();
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
            Self::Backbone { hit, amplitude } => {
                frequency_at(&outcomes.hits[hit].backbone, amplitude / gains[hit].response)
            }
            Self::Stiffness { place } => outcomes.stiffness.get(place).copied(),
        }
    }

    /// Its derivative at fixed gains, from the derivatives of the results; that of a backbone from
    /// two backbones, a step `backbones.0` above and below.
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
            Self::Backbone { hit, amplitude } => {
                let (step, curves) = backbones;
                let [beyond, before] = curves.get(hit)?;
                let at = |curve| frequency_at(curve, amplitude / gains[hit].response);
                Some((at(beyond)? - at(before)?) / (2.0 * step))
            }
            // All others are linear in the results.
            _ => self.value(derivatives, gains, columns),
        }
    }
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

/// Frequency \[Hz\] of a backbone at an amplitude \[m\], linear in its logarithm and extrapolated by at most
/// [`BEYOND`]; `None` further out.
fn frequency_at(points: &[BackbonePoint], amplitude: f64) -> Option<f64> {
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
    Some(a.frequency_hz + share * (b.frequency_hz - a.frequency_hz))
}
