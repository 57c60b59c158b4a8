//! Analysis of a hammer test, from records to features and average.

mod band_modes;
mod features;
mod harmonic_origin;
mod hit_noise;
mod mode_features;
mod mode_uncertainty;

pub use band_modes::BandMode;
pub use features::{FundamentalSearch, HitFeatures};
pub use harmonic_origin::{HarmonicTest, PeakOrigin};
pub use mode_features::ModeFeatures;
pub use mode_uncertainty::ModeUncertainty;

use crate::average::FrfAverage;
use crate::dominant::dominant_frequency;
use crate::error::{Result, check_positive};
use crate::form::ResponseKind;
use crate::frf::Frf;
use crate::harmonics::HarmonicOptions;
use crate::hit::{
    HitLength, HitOptions, HitRecord, QualityIssue, QualityOptions, Trigger, find_hits,
    issues_with_force,
};
use crate::offset::Offset;
use crate::pulse::Pulse;
use crate::uncertainty::NoiseDensity;
use crate::window::{ExponentialWindow, ForceWindow, ResponseWindow};

/// Windows of the signals of a hit.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct HitWindows {
    /// Margin and taper of the [`ForceWindow`] around each pulse, in seconds; none if `None`.
    pub force_s: Option<(f64, f64)>,
    /// Exponential window of force and response, with the value one at the trigger.
    pub exponential: Option<ExponentialWindow>,
    /// Sets both signals to zero where they are noise: the force outside the samples above its
    /// noise ([`ForceWindow::above`]), the response after its decay
    /// ([`ResponseWindow::until_noise`]). Signals without noise are not changed.
    pub until_noise: bool,
}

/// Options of [`hammer_test`].
#[derive(Debug, Clone, PartialEq)]
pub struct HammerOptions {
    /// Division of the record into hits.
    pub hits: HitOptions,
    /// Limits of the quality of a hit.
    pub quality: QualityOptions,
    /// Quantity of the response.
    pub response_kind: ResponseKind,
    /// Reference of the search for the fundamental.
    pub fundamental: FundamentalSearch,
    /// Options of the search for the fundamental and the second harmonic.
    pub harmonics: HarmonicOptions,
    /// Windows of force and response.
    pub windows: HitWindows,
    /// Band in which the response is noise, in hertz; `None` for its last tenth in time.
    pub noise_band_hz: Option<(f64, f64)>,
    /// Half width of the band of the decay, over the frequency of the fundamental.
    pub band_part: f64,
    /// Cycles per fitted line of the backbone.
    pub cycles: f64,
    /// Zero padding of the averaged transforms, 1 to 1024.
    pub padding: usize,
    /// Analyses and averages hits with a disqualifying issue too.
    pub keep_all: bool,
}

impl HammerOptions {
    /// Without windows and padding; the decay in 0.7 to 1.3 of the fundamental, four cycles a line.
    pub fn new(
        hits: HitOptions,
        response_kind: ResponseKind,
        fundamental: FundamentalSearch,
    ) -> Self {
        Self {
            hits,
            quality: QualityOptions::default(),
            response_kind,
            fundamental,
            harmonics: HarmonicOptions::default(),
            windows: HitWindows::default(),
            noise_band_hz: None,
            band_part: 0.3,
            cycles: 4.0,
            padding: 1,
            keep_all: false,
        }
    }
}

/// The quality, pulse and features of one hit.
#[derive(Debug, Clone, PartialEq)]
pub struct AnalysedHit {
    /// Index in the record of the first sample of the hit.
    pub start: u64,
    /// Index in the hit of the trigger.
    pub trigger: usize,
    /// Number of samples.
    pub samples: usize,
    /// Quality issues.
    pub issues: Vec<QualityIssue>,
    /// Offset of the force, which was subtracted.
    pub force_offset: Option<Offset>,
    /// Offset of the first response before the blow, which was subtracted; `None` within its error.
    pub response_offset: Option<Offset>,
    /// The force pulse, without offset and before any window.
    pub pulse: Option<Pulse>,
    /// Window of the response with [`HitWindows::until_noise`], if it ends in noise.
    pub response_window: Option<ResponseWindow>,
    /// Frequency response function of the hit, if it was averaged.
    pub frf: Option<Frf>,
    /// Harmonics, damping and backbone, if it was averaged.
    pub features: Option<HitFeatures>,
}

impl AnalysedHit {
    /// True if the hit is in the average: without a disqualifying issue, and with a transform.
    pub fn is_averaged(&self) -> bool {
        self.frf.is_some()
    }
}

/// The results of [`hammer_test`].
#[derive(Debug, Clone)]
pub struct HammerTest {
    /// The trigger level used.
    pub trigger: Trigger,
    /// All hits, also those that were not averaged.
    pub hits: Vec<AnalysedHit>,
    /// The average of the hits without disqualifying issues.
    pub average: FrfAverage,
}

/// Divides a record into hits, analyses each, and averages those without disqualifying issues.
///
/// For each hit the offsets of force and response are subtracted, quality issues are detected,
/// windows are applied and features extracted. A hit with a
/// disqualifying issue ([`QualityIssue::is_disqualifying`]) has
/// issues and a pulse only, and is not averaged.
///
/// - `force`: in newtons, positive when the hammer pushes.
/// - `response`: in m, m/s or m/s^2 according to [`HammerOptions::response_kind`], sampled with the
///   force.
///
/// # Errors
/// Those of [`find_hits`] and [`FrfAverage::new`], and
/// [`SignalError::Option`](crate::SignalError::Option) for a band or number of cycles out of range.
///
/// ```
/// use asperity_signal::{
///     FrfEstimator, HammerOptions, HitLength, HitOptions, FundamentalSearch, ResponseKind, TriggerLevel, hammer_test,
/// };
///
/// // A 1 kg oscillator at 200 Hz with 2 % of critical damping, and two impulses.
/// let (rate, omega, damping) = (2.0e4, std::f64::consts::TAU * 200.0, 0.02_f64);
/// let damped = omega * (1.0 - damping * damping).sqrt();
/// let (mut force, mut displacement) = (vec![0.0; 24_000], vec![0.0; 24_000]);
/// for (start, impulse) in [(500, 0.01), (12_500, 0.02)] {
///     force[start] = impulse * rate;
///     for (n, u) in displacement[start..].iter_mut().enumerate() {
///         let t = n as f64 / rate;
///         *u += impulse * (-damping * omega * t).exp() * (damped * t).sin() / damped;
///     }
/// }
/// let hits = HitOptions {
///     trigger_level: TriggerLevel::Automatic,
///     pre_trigger: 100,
///     length: HitLength::Samples(10_000),
///     hold_off: 2_000,
/// };
/// let options = HammerOptions::new(hits, ResponseKind::Displacement, FundamentalSearch::Frequency(190.0));
/// let test = hammer_test(&force, &displacement, rate, &options)?;
/// assert_eq!((test.hits.len(), test.average.averages()), (2, 2));
/// for hit in &test.hits {
///     let features = hit.features.as_ref().ok_or("a good hit has features")?;
///     let ratio = features.mode.damping.mean().ok_or("and damping")?;
///     assert!((ratio - damping).abs() < 1e-4);
/// }
/// let receptance = test.average.frf(FrfEstimator::H1)?;
/// assert_eq!(receptance.len(), 5_001);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn hammer_test(
    force: &[f64],
    response: &[f64],
    sample_rate_hz: f64,
    options: &HammerOptions,
) -> Result<HammerTest> {
    check_positive("the half width of the band of the decay", options.band_part)?;
    check_positive("the cycles of a line", options.cycles)?;
    let (hits, trigger) = find_hits(force, &[response], sample_rate_hz, &options.hits)?;
    let samples = match options.hits.length {
        HitLength::Samples(samples) => samples,
        HitLength::UntilNext { .. } => hits.iter().map(|hit| hit.force.len()).max().unwrap_or(1),
    };
    let mut average =
        FrfAverage::new(samples, sample_rate_hz, options.response_kind, options.padding)?;
    let hits = hits.into_iter().map(|hit| analyse_hit(hit, options, &mut average)).collect();
    Ok(HammerTest { trigger, hits, average })
}

/// Analyses one hit and adds it to an average unless an issue disqualifies it: the step of
/// [`hammer_test`] for the hits of a [`HitFinder`](crate::HitFinder).
///
/// [`HammerOptions::hits`] and [`HammerOptions::padding`] are not used; the response is
/// the first of the hit. A hit that cannot be transformed has no features and is not averaged.
pub fn analyse_hit(
    mut hit: HitRecord,
    options: &HammerOptions,
    average: &mut FrfAverage,
) -> AnalysedHit {
    let rate = hit.sample_rate_hz;
    let force_offset = Offset::at_rest(&hit.force);
    let mut force = hit.force.clone();
    if let Some(offset) = &force_offset {
        offset.remove(&mut force);
    }
    let issues = issues_with_force(&hit, &force, &options.quality);
    hit.force = force;
    let trigger = hit.trigger;
    let mut response_offset = None;
    if let Some(response) = hit.responses.first_mut() {
        response_offset = Offset::of_response(response, trigger);
        if let Some(offset) = &response_offset {
            offset.remove(response);
        }
    }
    let pulse = Pulse::of(&hit.force, rate);
    let mut found = AnalysedHit {
        start: hit.start,
        trigger: hit.trigger,
        samples: hit.force.len(),
        issues,
        force_offset,
        response_offset,
        pulse,
        response_window: None,
        frf: None,
        features: None,
    };
    let (Some(pulse), Some(measured)) = (pulse, hit.responses.first().cloned()) else {
        return found;
    };
    if !options.keep_all && found.issues.iter().any(QualityIssue::is_disqualifying) {
        return found;
    }
    let resonance_hz = resonance(&hit, options);
    let mut noise = resonance_hz.map_or_else(NoiseDensity::default, |frequency| {
        hit_noise::noise_density(&hit.force, &measured, rate, frequency, options)
    });
    apply_windows(&mut hit, &pulse, &mut noise, options);
    let Ok(unwindowed) = hit.response(0, options.response_kind) else {
        return found;
    };
    found.response_window = noise.windows.response;
    if found.response_window.is_some() {
        // What remains at the end is noise.
        found.issues.retain(|issue| !matches!(issue, QualityIssue::NotDecayed { .. }));
    }
    let response = noise.windows.response.map(|window| unwindowed.with_response_window(&window));
    let response = response.unwrap_or_else(|| unwindowed.clone());
    // Fails for a hit longer than the average only, which then has no transform.
    found.frf = average.push(response.force(), response.samples()).ok();
    let response = response.interpolated();
    let responses = (&response, &unwindowed);
    found.features = features::of_hit(responses, &measured, &pulse, noise, options);
    found
}

/// Frequency (Hz) of the resonance about which the noise of a hit is measured.
fn resonance(hit: &HitRecord, options: &HammerOptions) -> Option<f64> {
    let raw = hit.response(0, options.response_kind).ok()?;
    let threshold = options.harmonics.force_threshold;
    let (band, form) = match options.fundamental {
        FundamentalSearch::Frequency(frequency) => {
            let (low, high) = options.harmonics.fundamental_window;
            // The form in which white noise of the response is white.
            ((low * frequency, high * frequency), options.response_kind.form())
        }
        FundamentalSearch::Band(band, form) => (band, form),
    };
    dominant_frequency(&raw, band, form, threshold)
}

/// Least force above its noise, in standard deviations, over which a force window extends.
const ABOVE_NOISE: f64 = 6.0;
/// Margin and taper of that window \[s\].
const FORCE_MARGIN_S: (f64, f64) = (0.2e-3, 0.5e-3);

/// Applies the windows to a hit, but for that of the response, and enters them in the noise.
fn apply_windows(
    hit: &mut HitRecord,
    pulse: &Pulse,
    noise: &mut NoiseDensity,
    options: &HammerOptions,
) {
    let (rate, windows) = (hit.sample_rate_hz, &mut noise.windows);
    if let Some((margin, taper)) = options.windows.force_s {
        windows.force = Some(ForceWindow::around(pulse, margin, taper));
    } else if options.windows.until_noise {
        // Noise of the whole band, which may be more than that about the resonance.
        let wide = Offset::at_rest(&hit.force).map_or(0.0, |offset| offset.deviation);
        let level = ABOVE_NOISE * (0.5 * noise.force * rate).sqrt().max(wide);
        let (margin, taper) = FORCE_MARGIN_S;
        windows.force = ForceWindow::above(&hit.force, rate, level, margin, taper);
    }
    if let Some(window) = windows.force {
        window.apply(&mut hit.force, rate, None);
    }
    if let (Some(window), Some(response)) = (windows.response, hit.responses.first_mut()) {
        let quiet = ((window.end_s * rate) as usize).min(response.len() - 1);
        let rest = &response[quiet..];
        let offset = rest.iter().sum::<f64>() / rest.len() as f64;
        for x in response.iter_mut() {
            *x -= offset;
        }
    }
    if let Some(window) = options.windows.exponential {
        let windowed = std::iter::once(&mut hit.force).chain(&mut hit.responses);
        windowed.for_each(|samples| window.apply(samples, rate, hit.trigger));
        windows.exponential_rate = window.rate();
        windows.exponential_origin_s = hit.trigger as f64 / rate;
    }
}
