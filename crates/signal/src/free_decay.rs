//! Free decays without a measured force: frequency, damping and harmonics over amplitude.

mod beating;
mod harmonics;
mod one_mode;
mod resonance;
mod search;
mod trend;
mod two_modes;

pub use beating::Beating;
pub use harmonics::DecayHarmonic;
pub use one_mode::DecayPoint;
pub use resonance::DecayResonance;
pub use search::{DecayEnd, DecayOrigin, FoundDecay, find_decays, level_range};
pub use trend::AmplitudeTrend;
pub use two_modes::{LinearMode, TwoModes};

use crate::error::{Result, check_positive, check_rate, check_samples};
use crate::hammer::HarmonicTest;
use crate::noise::{MeasuredPart, quiet_density};
use crate::ring_down::{
    Backbone, BackboneOptions, BackbonePoint, BandPass, Polar, backbone_and_signal, half_line,
};
use beating::{BeatSearch, LARGEST_ERROR};
use harmonics::HarmonicBand;
use one_mode::{OneModePart, span_of};
use two_modes::ModeSearch;

/// Largest half width of the band of a mode, over its frequency.
const HALF_WIDTH: f64 = 0.3;
/// Part of the samples at their end that gives the noise.
const QUIET: f64 = 0.25;
/// Band of the noise, over the frequency of the mode.
const NOISE_BAND: (f64, f64) = (0.5, 2.5);
/// Fall of the logarithm of the amplitude over a line, and the cycles of a line.
const FALL_OF_LINE: f64 = 0.1;
const CYCLES: (f64, f64) = (4.0, 64.0);
/// Fewest lines in a decay.
const LINES: f64 = 20.0;
/// Fewest points of a backbone.
const FEWEST: usize = 4;
/// Orders of the harmonics.
const ORDERS: [i32; 2] = [2, 3];

/// Options of [`FreeDecay::of`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FreeDecayOptions {
    /// Frequency of the mode, in hertz.
    pub resonance_hz: f64,
    /// Largest half width of the band of the mode, in hertz; at most 0.3 of the frequency is used, and
    /// no more than up to half the sample rate.
    pub half_width_hz: f64,
    /// Half width of the band in which a second mode is searched, in hertz; at least the band of the mode,
    /// at most 0.3 of the frequency.
    pub search_half_width_hz: f64,
    /// Derivatives of the displacement that the samples are: 0 to 2.
    pub derivatives: i32,
    /// One-sided spectral density of the noise, in the samples' unit squared per hertz; `None` for
    /// the density of the last quarter.
    pub noise_density: Option<f64>,
}

/// Frequency, damping and harmonics of a mode over its amplitude in a free decay.
#[derive(Debug, Clone, PartialEq)]
pub struct FreeDecay {
    /// Points in the order of time, a quarter of a line apart.
    pub points: Vec<DecayPoint>,
    /// Line through the whole decay; `None` for fewer than four points.
    pub mean: Option<DecayPoint>,
    /// Time from the first sample to the end of the last line, in seconds: what follows is noise, or
    /// the end of the samples.
    pub length_s: f64,
    /// True if the decay ends in noise, or in other vibration that does not decay with it.
    pub reaches_noise: bool,
    /// Band of the mode.
    pub band: BandPass,
    /// Cycles of a line.
    pub cycles: f64,
    /// One-sided spectral density of the noise, in the samples' unit squared per hertz.
    pub noise_density: f64,
    /// Smallest amplitude accepted, in the samples' unit.
    pub floor: f64,
    /// A second mode in the band, if there is one above the noise.
    pub beating: Option<Beating>,
    /// Two linear modes that explain the decay, where one mode that depends on its amplitude does not.
    pub two_modes: Option<TwoModes>,
    /// Root mean square that one mode, with a frequency and a decay rate that follow its amplitude, leaves of the
    /// decay, over the decay; zero where that is noise.
    pub misfit: f64,
    /// True if the amplitude grows or hardly falls somewhere in the decay, as the amplitude of one
    /// mode does not.
    pub stalls: bool,
    /// Behaviour of the second harmonic along the decay; `None` where it is noise.
    pub harmonic_test: Option<HarmonicTest>,
}

impl FreeDecay {
    /// Analyses the free decay of a mode.
    ///
    /// The [`backbone`](crate::backbone) of the mode, whose lines are long enough for the amplitude
    /// to fall by 10 % (4 to 64 cycles), with standard deviations due to noise
    /// ([`BackbonePoint::uncertainty`]). A harmonic of order `k` is the mean over each line of
    ///
    /// ```text
    /// z_k exp(-i k p_1),   z_1 = a_1 exp(i p_1)
    /// ```
    ///
    /// with the analytic signals of the bands about the fundamental and `k` times it: another mode
    /// near, which does not follow the phase, averages out.
    ///
    /// - `samples`: free decay from the first sample on, any unit, without offset.
    ///
    /// Valid for one mode in the band; [`FreeDecay::is_one_mode`] tells. The decay ends where other
    /// vibration of at most 2 % of its first amplitude (10 % if it lasts) remains, and likewise where the beat with a mode
    /// that decays more slowly becomes strong. Limiting case: a linear mode
    /// has one frequency, one damping ratio and no harmonics.
    ///
    /// # Errors
    /// Those of [`backbone`](crate::backbone).
    ///
    /// ```
    /// use asperity_signal::{FreeDecay, FreeDecayOptions};
    ///
    /// let (rate, omega, zeta) = (1e4, std::f64::consts::TAU * 200.0, 0.005);
    /// let decay: Vec<f64> = (0..20_000)
    ///     .map(|n| f64::from(n) / rate)
    ///     .map(|t| (-zeta * omega * t).exp() * (omega * t).cos())
    ///     .collect();
    /// let options = FreeDecayOptions {
    ///     resonance_hz: 200.0,
    ///     half_width_hz: f64::INFINITY,
    ///     search_half_width_hz: f64::INFINITY,
    ///     derivatives: 2,
    ///     noise_density: None,
    /// };
    /// let found = FreeDecay::of(&decay, rate, &options)?;
    /// let mean = found.mean.ok_or("a decay has a mean")?;
    /// assert!(found.is_one_mode() && (mean.point.damping_ratio - zeta).abs() < 1e-5);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn of(samples: &[f64], sample_rate_hz: f64, options: &FreeDecayOptions) -> Result<Self> {
        check_samples("decay", samples)?;
        check_rate(sample_rate_hz)?;
        check_positive("the frequency of the mode", options.resonance_hz)?;
        check_positive("the half width of the band", options.half_width_hz.min(f64::MAX))?;
        let (rate, centre) = (sample_rate_hz, options.resonance_hz);
        // A band ends below half the sample rate; a mode above that is an error.
        let room = (0.5 * rate - centre).max(f64::MIN_POSITIVE);
        let half_width = (HALF_WIDTH * centre).min(options.half_width_hz).min(room);
        let band = BandPass::around(centre, half_width / centre)?;
        let part = MeasuredPart::of(samples);
        let quiet = &samples[((1.0 - QUIET) * part.measured as f64) as usize..part.measured];
        let within = (NOISE_BAND.0 * centre, (NOISE_BAND.1 * centre).min(0.5 * rate));
        let noise_density = options.noise_density.unwrap_or_else(|| {
            let quiet = quiet_density(quiet, rate, within).unwrap_or(0.0);
            quiet.max(part.rounding_density(rate))
        });
        let samples = &samples[..part.measured];
        let derivatives = options.derivatives;
        let mut settings = BackboneOptions {
            noise_density,
            derivatives,
            floor: part.resolved,
            ..BackboneOptions::new(band)
        };
        let (first, _) = backbone_and_signal(samples, rate, &settings)?;
        settings.cycles = cycles_of_line(&first, centre);
        let (found, signal) = backbone_and_signal(samples, rate, &settings)?;

        let half = half_line(rate, &settings);
        let harmonics = ORDERS.map(|order| {
            let order = (order, options.derivatives);
            HarmonicBand::of(samples, quiet, rate, centre, order)
        });
        let [second, third] = harmonics;
        let harmonics = [second?, third?];
        let describe = |point: &BackbonePoint| {
            let middle = (point.time_s * rate).round() as usize;
            DecayPoint {
                point: *point,
                uncertainty: point.uncertainty(&settings),
                harmonics: [0, 1].map(|k| harmonics[k].as_ref()?.ratio(&signal, middle, half)),
            }
        };
        let mut points: Vec<DecayPoint> = found.points.iter().map(describe).collect();
        let search = BeatSearch {
            sample_rate_hz: rate,
            carrier_hz: centre,
            width_hz: band.width_hz(),
            line_s: settings.cycles / centre,
            noise_density,
        };
        let part = OneModePart::of(&points, &signal, half, &search);
        let (two_modes, misfit) =
            first_two_modes(samples, rate, options, &settings).unwrap_or((None, 0.0));
        let is_cut = part.points < points.len();
        points.truncate(part.points);
        let mut decay = Self {
            mean: None,
            length_s: 0.0,
            reaches_noise: found.masked_noise > 0 || is_cut,
            band,
            cycles: settings.cycles,
            noise_density,
            floor: found.floor,
            beating: part.beating,
            two_modes,
            misfit,
            stalls: part.stalls,
            harmonic_test: None,
            points,
        };
        let Some(span) = span_of(&decay.points, half, rate) else { return Ok(decay) };
        decay.length_s = *span.end() as f64 / rate;
        if decay.points.len() < FEWEST {
            return Ok(decay);
        }
        let middle_s = 0.5 * (span.start() + span.end()) as f64 / rate;
        let length_s = (span.end() - span.start()) as f64 / rate;
        decay.mean = Polar::of(&signal).line(span, rate, band.centre_hz()).map(|line| {
            let point = BackbonePoint::of_line(&line, middle_s, &settings.filter());
            let uncertainty = point.uncertainty_over(length_s, &settings);
            DecayPoint { point, uncertainty, harmonics: [None; 2] }
        });
        let second = harmonics[0].as_ref().map(|band| band.noise_density);
        decay.harmonic_test = decay.mean.zip(second).and_then(|(mean, noise)| {
            HarmonicTest::of(samples, rate, mean.point.frequency_hz, noise)
        });
        Ok(decay)
    }

    /// True if the band holds one mode: its amplitude falls everywhere, and no second mode changes the local
    /// decay rates by a quarter of their mean or more.
    pub fn is_one_mode(&self) -> bool {
        let is_two = self.two_modes.is_some_and(|two| two.decay_rate_error >= LARGEST_ERROR);
        !self.stalls && !is_two && self.beating.is_none_or(|beating| beating.is_small())
    }
}

/// Two linear modes in the whole band that may hold a mode: next to a second one the band of the first is
/// so narrow that the filter settles after the decay.
fn first_two_modes(
    samples: &[f64],
    rate: f64,
    options: &FreeDecayOptions,
    settings: &BackboneOptions,
) -> Option<(Option<TwoModes>, f64)> {
    let centre = options.resonance_hz;
    let widest = options.search_half_width_hz.max(options.half_width_hz);
    let half_width = (HALF_WIDTH * centre).min(widest).min(0.5 * rate - centre);
    let band = BandPass::around(centre, half_width / centre).ok()?;
    let cycles = BackboneOptions::new(band).cycles;
    let narrow = settings.filter();
    let settings = BackboneOptions { band, cycles, ..*settings };
    let (found, signal) = backbone_and_signal(samples, rate, &settings).ok()?;
    let (first, last) = (found.points.first()?, found.points.last()?);
    let place = |point: &BackbonePoint| (point.time_s * rate).round() as usize;
    let search = ModeSearch {
        signal: signal.get(place(first)..=place(last))?,
        sample_rate_hz: rate,
        carrier_hz: centre,
        width_hz: band.width_hz(),
        noise_density: settings.noise_density,
    };
    let (two, misfit) = search.two_modes();
    // The band of the mode holds less of the other.
    let gain = |mode: &LinearMode| narrow.gain(mode.frequency_hz).abs();
    let within = |two: TwoModes| {
        let passed = gain(&two.modes[1]) / gain(&two.modes[0]);
        TwoModes { decay_rate_error: two.decay_rate_error * passed, ..two }
    };
    Some((two.map(within), misfit))
}

/// Cycles of lines over which the amplitude falls by a tenth, at least twenty in the decay.
fn cycles_of_line(first: &Backbone, centre_hz: f64) -> f64 {
    let (Some(begin), Some(last)) = (first.points.first(), first.points.last()) else {
        return CYCLES.0;
    };
    let span = last.time_s - begin.time_s;
    let decay_rate = (begin.amplitude / last.amplitude).ln() / span;
    let wanted = (FALL_OF_LINE * centre_hz / decay_rate).min(span * centre_hz / LINES);
    if wanted.is_finite() { wanted.clamp(CYCLES.0, CYCLES.1) } else { CYCLES.0 }
}
