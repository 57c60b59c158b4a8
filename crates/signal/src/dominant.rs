//! The dominant resonance of a band.

use crate::form::FrfForm;
use crate::peak::{PowerGrid, refine};
use crate::response::FrequencyResponse;
use crate::spectra::HitSpectra;
use std::f64::consts::TAU;

/// Frequency (Hz) of the largest peak of `|H|` in a band.
///
/// The reference of [`find_harmonics`](crate::find_harmonics) for measured hits, whose static
/// frequency is not known.
///
/// - `band_hz`: open interval, in hertz.
/// - `form`: the form whose magnitudes are compared; accelerance weighs the higher of two modes
///   more, receptance the lower. Inverse forms are compared by their reciprocals.
/// - `force_threshold`: smallest admissible magnitude of the force's transform, over its largest up
///   to the end of the band.
///
/// The frequency is the place of the maximum of the receptance, refined on the exact transform,
/// whatever the form. `None` if there is no peak; a value that only rises towards a limit of the
/// band is none.
///
/// ```
/// use asperity_signal::{FrequencyResponse, FrfForm, dominant_frequency};
///
/// // Impulse response of a 1 kg oscillator at 200 Hz with 2 % of critical damping.
/// let (rate, omega, zeta) = (2e4, std::f64::consts::TAU * 200.0, 0.02_f64);
/// let damped = omega * (1.0 - zeta * zeta).sqrt();
/// let displacement: Vec<f64> = (0..20_000)
///     .map(|n| f64::from(n) / rate)
///     .map(|t| (-zeta * omega * t).exp() * (damped * t).sin() / damped)
///     .collect();
/// let mut force = vec![0.0; displacement.len()];
/// force[0] = rate;
/// let hit = FrequencyResponse::from_displacement(&force, &displacement, rate)?;
/// let found = dominant_frequency(&hit, (100.0, 1000.0), FrfForm::Accelerance, 0.02);
/// assert!((found.ok_or("a peak in the band")? - 199.9).abs() < 0.1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn dominant_frequency(
    response: &FrequencyResponse,
    band_hz: (f64, f64),
    form: FrfForm,
    force_threshold: f64,
) -> Option<f64> {
    let (low, high) = band_hz;
    let ordered = low >= 0.0 && high > low && high.is_finite();
    if !ordered {
        return None;
    }
    let band = response.band(4, high);
    let grid = PowerGrid::of(&band, response.kind(), low, force_threshold);
    let in_form = |index: usize| {
        let omega = TAU * grid.frequency(index);
        grid.power[index] * omega.powi(2 * form.derivatives())
    };
    let mut maxima = grid.maxima(band_hz);
    maxima.sort_by(|&a, &b| in_form(b).total_cmp(&in_form(a)));
    let valid = |&index: &usize| grid.force[index] >= grid.force_floor;
    let inside = |frequency: &f64| *frequency > low && *frequency < high;
    maxima.into_iter().filter(valid).find_map(|k| refine(response, &grid, k).filter(inside))
}
