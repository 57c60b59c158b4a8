//! A hammer test from records to features and average.

mod features;

pub use features::{FundamentalSearch, HitFeatures};

use crate::average::FrfAverage;
use crate::error::{Result, check_positive};
use crate::form::ResponseKind;
use crate::frf::Frf;
use crate::harmonics::HarmonicOptions;
use crate::hit::{
    HitLength, HitOptions, HitRecord, Offset, Pulse, QualityIssue, QualityOptions, Trigger,
    find_hits, issues_with_force,
};
use crate::window::{ExponentialWindow, ForceWindow};

/// What is done to the signals of a hit before they are transformed.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct HitWindows {
    /// Margin and taper of the [`ForceWindow`] around each blow, in seconds; none if `None`.
    pub force_s: Option<(f64, f64)>,
    /// Window of force and response, one at the trigger.
    pub exponential: Option<ExponentialWindow>,
}

/// How [`hammer_test`] works.
#[derive(Debug, Clone, PartialEq)]
pub struct HammerOptions {
    /// How the record is cut.
    pub hits: HitOptions,
    /// What is a good hit.
    pub quality: QualityOptions,
    /// What the response is.
    pub response_kind: ResponseKind,
    /// Where the fundamental is looked for.
    pub fundamental: FundamentalSearch,
    /// How the fundamental and the second harmonic are looked for.
    pub harmonics: HarmonicOptions,
    /// Windows.
    pub windows: HitWindows,
    /// Band in which the response is noise, in hertz; `None` takes its last tenth for noise.
    pub noise_band_hz: Option<(f64, f64)>,
    /// Half width of the band of the decay, over the fundamental.
    pub band_part: f64,
    /// Cycles over which a point of the backbone is fitted.
    pub cycles: f64,
    /// Zero padding of the averaged transforms, 1 to 1024.
    pub padding: usize,
    /// Whether hits with a disqualifying issue are analysed and averaged like the others.
    pub keep_all: bool,
}

impl HammerOptions {
    /// Unwindowed, unpadded; the decay in 0.7 to 1.3 of the fundamental, four cycles a point.
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

/// One hit, judged and analysed.
#[derive(Debug, Clone, PartialEq)]
pub struct AnalysedHit {
    /// Index in the record of the hit's first sample.
    pub start: u64,
    /// Index in the hit of the trigger.
    pub trigger: usize,
    /// Number of samples.
    pub samples: usize,
    /// What is wrong with it.
    pub issues: Vec<QualityIssue>,
    /// Offset of the force that was taken away.
    pub force_offset: Option<Offset>,
    /// The blow, without offset and before any window.
    pub pulse: Option<Pulse>,
    /// The hit's own frequency response function, if it was averaged.
    pub frf: Option<Frf>,
    /// Harmonics, damping and backbone, if it was averaged.
    pub features: Option<HitFeatures>,
}

impl AnalysedHit {
    /// Whether the hit is in the average: no issue disqualifies it and it can be transformed.
    pub fn is_averaged(&self) -> bool {
        self.frf.is_some()
    }
}

/// A whole test.
#[derive(Debug, Clone)]
pub struct HammerTest {
    /// The trigger level and its evidence.
    pub trigger: Trigger,
    /// Every hit, the bad ones too.
    pub hits: Vec<AnalysedHit>,
    /// The average of the good ones.
    pub average: FrfAverage,
}

/// Cuts a record into hits, judges and analyses each, and averages the good ones.
///
/// For each hit the force loses its offset at rest, the issues are found,
/// the windows applied, and for a good hit the features found. A hit with a
/// disqualifying issue ([`QualityIssue::is_disqualifying`]) is kept with its
/// issues and its pulse, and not averaged.
///
/// - `force`: in newtons, positive when the hammer pushes.
/// - `response`: in metres or m/s^2, as [`HammerOptions::response_kind`] says, sampled with the force.
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
/// // A 1 kg oscillator at 200 Hz with 2 % of critical damping, struck twice by one sample.
/// let (rate, omega, damping) = (2.0e4, std::f64::consts::TAU * 200.0, 0.02_f64);
/// let damped = omega * (1.0 - damping * damping).sqrt();
/// let (mut force, mut displacement) = (vec![0.0; 24_000], vec![0.0; 24_000]);
/// for (blow, impulse) in [(500, 0.01), (12_500, 0.02)] {
///     force[blow] = impulse * rate;
///     for (n, u) in displacement[blow..].iter_mut().enumerate() {
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
///     let ratio = features.damping.mean().ok_or("and damping")?;
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
    check_positive("the half width of the decay's band", options.band_part)?;
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

/// Judges and analyses one hit, and adds it to an average if it is good: a step of [`hammer_test`]
/// for hits that come one by one, such as those of a [`HitFinder`](crate::HitFinder).
///
/// Of the options, those that cut the record and the padding are not looked at; the response is
/// the first of the hit. A hit that cannot be transformed has neither features nor part in the
/// average.
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
    let pulse = Pulse::of(&hit.force, rate);
    let mut found = AnalysedHit {
        start: hit.start,
        trigger: hit.trigger,
        samples: hit.force.len(),
        issues,
        force_offset,
        pulse,
        frf: None,
        features: None,
    };
    let (Some(pulse), Some(measured)) = (pulse, hit.responses.first().cloned()) else {
        return found;
    };
    if !options.keep_all && found.issues.iter().any(QualityIssue::is_disqualifying) {
        return found;
    }
    if let Some((margin, taper)) = options.windows.force_s {
        ForceWindow::around(&pulse, margin, taper).apply(&mut hit.force, rate, None);
    }
    if let Some(window) = options.windows.exponential {
        let windowed = std::iter::once(&mut hit.force).chain(&mut hit.responses);
        windowed.for_each(|samples| window.apply(samples, rate, hit.trigger));
    }
    let Ok(response) = hit.response(0, options.response_kind) else {
        return found;
    };
    // What a response accepts, the average accepts, of this length at most.
    found.frf = average.push(response.force(), response.samples()).ok();
    found.features =
        features::of_hit(&response, &measured, hit.trigger, &pulse, force_offset.as_ref(), options);
    found
}
