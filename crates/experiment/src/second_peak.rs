//! The peak near twice the fundamental: second harmonic or another mode.

use asperity_signal::PeakOrigin;
use serde::Serialize;

use crate::hit_report::HitReport;
use crate::hit_second_peak::{HitSecondPeak, name};

/// Fewest hits, and least ratio of their forces, for a test by force.
const FEWEST_HITS: usize = 4;
const FORCE_RATIO: f64 = 1.5;
/// Growth exponent of A2/A1 with force between those of a mode (0) and of a harmonic (1).
const BETWEEN: f64 = 0.4;
/// Part of the decays that must agree.
const MAJORITY: f64 = 0.75;

/// Origin of the peaks near twice the fundamental of a test.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SecondPeakReport {
    /// `harmonic`, `mode` or `undecided`.
    pub origin: &'static str,
    /// Test that decided: `force` or `decay`.
    pub decided_by: Option<&'static str>,
    /// Hits with a peak.
    pub hits: usize,
    /// Exponent `d ln (A2/A1) / d ln F` over the hits: about 0 for a mode, 1 for the harmonic of a
    /// weak quadratic nonlinearity.
    pub force_exponent: Option<f64>,
    /// Standard error of that exponent.
    pub force_exponent_error: Option<f64>,
    /// The decision and its evidence, in words.
    pub sentence: String,
}

impl SecondPeakReport {
    /// Decides from all averaged hits with a peak; `None` without any.
    ///
    /// A harmonic vanishes as the force falls: over at least four hits whose forces differ by half,
    /// `A2/A1 ~ F^s` with `s` two standard errors above 0.4 is a harmonic, two below a mode. Where
    /// that does not decide, three quarters of the decays that do
    /// ([`HarmonicTest`](asperity_signal::HarmonicTest)) must agree.
    pub(crate) fn of(hits: &[HitReport]) -> Option<Self> {
        let peaks: Vec<(&HitReport, &HitSecondPeak)> = hits
            .iter()
            .filter(|hit| hit.averaged)
            .filter_map(|hit| Some((hit, hit.second_peak.as_ref()?)))
            .collect();
        if peaks.is_empty() {
            return None;
        }
        let ratio_to_f1 = peaks
            .iter()
            .filter_map(|(hit, peak)| Some(peak.frequency_hz / hit.fundamental?.frequency_hz));
        let (sum, count) = ratio_to_f1.fold((0.0, 0.0), |(sum, n), ratio| (sum + ratio, n + 1.0));
        let place = format!("the peak at {:.2} f1", sum / count);
        let force = ForceExponent::of(&peaks);
        let mut found = Self {
            origin: "undecided",
            decided_by: None,
            hits: peaks.len(),
            force_exponent: force.map(|force| force.exponent),
            force_exponent_error: force.map(|force| force.error),
            sentence: String::new(),
        };
        if let Some(force) = force
            && let Some(origin) = force.origin()
        {
            found.origin = name(origin);
            found.decided_by = Some("force");
            found.sentence = format!(
                "{place} is {}: A2/A1 changes with force to the power {:.2} (standard error {:.2}) \
                 over {} hits",
                with_article(origin),
                force.exponent,
                force.error,
                peaks.len()
            );
            return Some(found);
        }
        let told = |origin: &str| {
            peaks.iter().filter(|(_, peak)| peak.decay_origin == Some(origin)).count() as f64
        };
        let (harmonics, modes) = (told("harmonic"), told("mode"));
        let most = if harmonics > modes { PeakOrigin::Harmonic } else { PeakOrigin::Mode };
        if harmonics.max(modes) >= MAJORITY * (harmonics + modes) && harmonics + modes > 0.0 {
            found.origin = name(most);
            found.decided_by = Some("decay");
            let mean = |value: fn(&HitSecondPeak) -> Option<f64>| {
                let values: Vec<f64> = peaks.iter().filter_map(|(_, peak)| value(peak)).collect();
                values.iter().sum::<f64>() / values.len() as f64
            };
            found.sentence = format!(
                "{place} is {}: along the decay its amplitude follows that of the fundamental to \
                 the power {:.2}, and its phase drifts from twice the fundamental's by {:.2} rad \
                 (a harmonic: 2, and 0)",
                with_article(most),
                mean(|peak| peak.amplitude_exponent),
                mean(|peak| Some(peak.phase_drift_rad?.abs())),
            );
            return Some(found);
        }
        found.sentence = format!(
            "{place} may be the second harmonic or another mode: its decay is noise or tells \
             neither; hits of different forces tell them apart"
        );
        Some(found)
    }

    /// True for a second harmonic.
    pub(crate) fn is_harmonic(&self) -> bool {
        self.origin == name(PeakOrigin::Harmonic)
    }
}

/// Growth of A2/A1 with force.
#[derive(Debug, Clone, Copy)]
struct ForceExponent {
    exponent: f64,
    error: f64,
}

impl ForceExponent {
    fn of(peaks: &[(&HitReport, &HitSecondPeak)]) -> Option<Self> {
        let points: Vec<(f64, f64)> = peaks
            .iter()
            .filter_map(|(hit, peak)| Some((hit.force_peak_n?.ln(), peak.ratio.ln())))
            .filter(|(x, y)| x.is_finite() && y.is_finite())
            .collect();
        let count = points.len() as f64;
        let low = points.iter().map(|point| point.0).fold(f64::INFINITY, f64::min);
        let high = points.iter().map(|point| point.0).fold(f64::NEG_INFINITY, f64::max);
        if points.len() < FEWEST_HITS || high - low < FORCE_RATIO.ln() {
            return None;
        }
        let x = points.iter().map(|point| point.0).sum::<f64>() / count;
        let y = points.iter().map(|point| point.1).sum::<f64>() / count;
        let square: f64 = points.iter().map(|point| (point.0 - x).powi(2)).sum();
        let cross: f64 = points.iter().map(|point| (point.0 - x) * (point.1 - y)).sum();
        let exponent = cross / square;
        let rest: f64 =
            points.iter().map(|point| (point.1 - y - exponent * (point.0 - x)).powi(2)).sum();
        Some(Self { exponent, error: (rest / (count - 2.0) / square).sqrt() })
    }

    fn origin(&self) -> Option<PeakOrigin> {
        if self.exponent - 2.0 * self.error > BETWEEN {
            Some(PeakOrigin::Harmonic)
        } else if self.exponent + 2.0 * self.error < BETWEEN {
            Some(PeakOrigin::Mode)
        } else {
            None
        }
    }
}

fn with_article(origin: PeakOrigin) -> &'static str {
    match origin {
        PeakOrigin::Harmonic => "the second harmonic",
        _ => "another mode, not a harmonic",
    }
}
