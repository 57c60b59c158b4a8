//! What is predicted: rows of numbers from the outcomes of strikes.

use asperity_signal::{BackboneOptions, BackbonePoint, BandPass, Complex64, backbone};

use crate::unknowns::Gains;
use asperity_study::quantity::{Observable, observable_names};

/// One predicted number.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Row {
    /// A feature of a strike, by its place among the summary's numbers.
    Feature {
        /// The strike.
        strike: usize,
        /// The feature.
        column: usize,
    },
    /// A feature of one strike over that of another.
    Ratio {
        /// The strikes above and below.
        strikes: [usize; 2],
        /// The feature.
        column: usize,
    },
    /// Real or imaginary part of a receptance \[m/N\].
    Receptance {
        /// The strike.
        strike: usize,
        /// Place among its frequencies.
        place: usize,
        /// Which part.
        part: Part,
    },
    /// Frequency of the backbone \[Hz\] at a measured amplitude \[m\].
    Backbone {
        /// The strike.
        strike: usize,
        /// The amplitude, as measured.
        amplitude: f64,
    },
    /// Stiffness of a law \[Pa/m\], by its place among those asked for.
    Stiffness {
        /// The place.
        place: usize,
    },
}

/// A part of a complex number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Part {
    Real,
    Imaginary,
}

/// What came of a strike, or a derivative of it.
#[derive(Debug, Clone, Default)]
pub(super) struct Outcome {
    /// Numbers of the summary; NaN where there is none.
    pub(super) columns: Vec<f64>,
    /// Receptance at the frequencies asked for \[m/N\].
    pub(super) receptance: Vec<Complex64>,
    /// The backbone, if asked for, in the order of time.
    pub(super) backbone: Vec<BackbonePoint>,
}

/// The outcomes at one point.
#[derive(Debug, Clone, Default)]
pub(super) struct Outcomes {
    /// Of every strike.
    pub(super) strikes: Vec<Outcome>,
    /// Stiffnesses asked for \[Pa/m\].
    pub(super) stiffness: Vec<f64>,
}

/// Columns that are receptances, which gains of both sensors scale.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Columns {
    pub(super) names: Vec<String>,
    receptance: Vec<bool>,
}

impl Columns {
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

impl Row {
    /// The number as sensors of these `gains` (one pair a strike) show it.
    pub(super) fn value(
        &self,
        outcomes: &Outcomes,
        gains: &[Gains],
        columns: &Columns,
    ) -> Option<f64> {
        let shown = |strike: usize, column: usize| {
            let number = *outcomes.strikes[strike].columns.get(column)?;
            let receptance = columns.receptance[column];
            let scale = if receptance { receptance_gain(gains[strike]) } else { 1.0 };
            (!number.is_nan()).then_some(number * scale)
        };
        match *self {
            Self::Feature { strike, column } => shown(strike, column),
            Self::Ratio { strikes: [above, below], column } => {
                Some(shown(above, column)? / shown(below, column)?)
            }
            Self::Receptance { strike, place, part } => {
                let value = *outcomes.strikes[strike].receptance.get(place)?;
                Some(part.of(value) * receptance_gain(gains[strike]))
            }
            Self::Backbone { strike, amplitude } => {
                frequency_at(&outcomes.strikes[strike].backbone, amplitude / gains[strike].response)
            }
            Self::Stiffness { place } => outcomes.stiffness.get(place).copied(),
        }
    }

    /// Its derivative at fixed gains, from the `rates` of the outcomes; a backbone's are in two
    /// outcomes, a step `backbones.0` beyond and before.
    pub(super) fn rate(
        &self,
        outcomes: &Outcomes,
        rates: &Outcomes,
        backbones: (f64, &[[Vec<BackbonePoint>; 2]]),
        gains: &[Gains],
        columns: &Columns,
    ) -> Option<f64> {
        match *self {
            Self::Ratio { strikes: [above, below], column } => {
                let part = |strike: usize| {
                    let value = *outcomes.strikes[strike].columns.get(column)?;
                    Some(*rates.strikes[strike].columns.get(column)? / value)
                };
                let rate = self.value(outcomes, gains, columns)? * (part(above)? - part(below)?);
                (!rate.is_nan()).then_some(rate)
            }
            Self::Backbone { strike, amplitude } => {
                let (step, curves) = backbones;
                let [beyond, before] = curves.get(strike)?;
                let at = |curve| frequency_at(curve, amplitude / gains[strike].response);
                Some((at(beyond)? - at(before)?) / (2.0 * step))
            }
            // All else is linear in the outcomes.
            _ => self.value(rates, gains, columns),
        }
    }
}

impl Part {
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

/// Half width of the band of a decay over its fundamental, as for measured hits.
const BAND_PART: f64 = 0.3;

/// The backbone of a decay \[m\] about its fundamental \[Hz\], found as for measured hits; empty
/// where there is none.
pub(super) fn backbone_of(decay: &[f64], rate: f64, fundamental: f64) -> Vec<BackbonePoint> {
    let options = BandPass::around(fundamental, BAND_PART).map(BackboneOptions::new);
    let found = options.and_then(|options| backbone(decay, rate, &options));
    found.map(|found| found.points).unwrap_or_default()
}

/// Ratio of amplitudes over which a backbone is carried on at its ends.
const BEYOND: f64 = 1.5;

/// Frequency \[Hz\] of a backbone at an amplitude \[m\], linear in its logarithm, and carried on a
/// little at either end; none further out.
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
