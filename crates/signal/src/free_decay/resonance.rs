//! The strongest resonance of free decays.

use crate::error::Result;
use crate::noise::median_of;
use crate::spectrum::Spectrum;
use crate::transform::transform_at;
use std::f64::consts::TAU;

/// Zero padding of the spectra.
const PADDING: usize = 4;
/// Least height of a neighbouring resonance over the height of the strongest, and the largest
/// minimum between both over the height of the neighbour.
const NEIGHBOUR: f64 = 0.02;
const VALLEY: f64 = 0.3;
/// Least power of a neighbour over the median about the strongest resonance: the largest of a
/// thousand lines of noise is ten times theirs.
const ABOVE_NOISE: f64 = 30.0;
/// Part of the distance to a neighbour that a band extends.
const SHARE: f64 = 0.5;

/// A resonance in the spectra of free decays.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DecayResonance {
    /// Frequency of the largest line, in hertz.
    pub frequency_hz: f64,
    /// Half of the distance to the next resonance, in hertz; infinite without one.
    pub half_width_hz: f64,
}

/// Parts in which hum is compared, its smallest level over the largest, most lines that may be hum, and fewest
/// cycles in a part.
const PARTS: usize = 8;
const LASTING: f64 = 0.7;
const MOST_HUM: usize = 100;
const FEWEST_CYCLES: f64 = 4.0;

/// True for a line that is equally strong in all parts of all responses.
fn is_hum(responses: &[(&[f64], i32)], sample_rate_hz: f64, frequency_hz: f64) -> bool {
    responses.iter().all(|(samples, _)| {
        let count = samples.len() / PARTS;
        if (count as f64) < FEWEST_CYCLES * sample_rate_hz / frequency_hz {
            return false;
        }
        // A Hann window keeps other lines out.
        let hann = |n: usize| 1.0 - (TAU * (n as f64 + 0.5) / count as f64).cos();
        let level = |part: &[f64]| {
            let windowed: Vec<f64> = part.iter().enumerate().map(|(n, x)| hann(n) * x).collect();
            transform_at(&windowed, sample_rate_hz, frequency_hz).norm()
        };
        let levels = samples.chunks_exact(count).map(level);
        let (least, most) = levels.fold((f64::INFINITY, 0.0_f64), |(least, most), level| {
            (least.min(level), most.max(level))
        });
        least > LASTING * most
    })
}

impl DecayResonance {
    /// The strongest resonance of some responses in a band, by their summed spectra as velocities.
    ///
    /// In a velocity modes of equal decay rate and energy are equally high. Each response is divided
    /// by its largest line in the band. Other maxima count as resonances from 2 % of the strongest
    /// and well above the noise, if the spectrum between both falls below 0.3 of theirs. A line that is as strong
    /// in each eighth of all responses is hum, which does not decay, and no resonance unless there is no other.
    ///
    /// - `responses`: the free decay, and the derivatives of the displacement that it is (0 to 2).
    /// - `band_hz`: lower and upper limit, in hertz.
    ///
    /// `None` without a maximum in the band.
    ///
    /// # Errors
    /// Those of [`Spectrum::new`].
    pub fn strongest(
        responses: &[(&[f64], i32)],
        sample_rate_hz: f64,
        band_hz: (f64, f64),
    ) -> Result<Option<Self>> {
        let mut sum: Vec<f64> = Vec::new();
        let mut step = 1.0;
        for (samples, derivatives) in responses {
            let spectrum = Spectrum::new(samples, sample_rate_hz, PADDING)?;
            step = spectrum.frequency_step();
            let power = |index: usize| {
                let frequency = spectrum.frequency(index);
                let weight = frequency.powi(1 - derivatives);
                spectrum.values()[index].norm_sqr() * weight * weight
            };
            let own: Vec<f64> = (0..spectrum.values().len())
                .map(|index| if index == 0 { 0.0 } else { power(index) })
                .collect();
            let inside = own
                .iter()
                .enumerate()
                .filter(|(index, _)| (band_hz.0..=band_hz.1).contains(&(*index as f64 * step)));
            let largest = inside.map(|(_, power)| *power).fold(0.0, f64::max);
            sum.resize(own.len(), 0.0);
            if largest > 0.0 {
                sum.iter_mut().zip(own).for_each(|(sum, own)| *sum += own / largest);
            }
        }
        let maxima: Vec<usize> = (1..sum.len().saturating_sub(1))
            .filter(|&k| sum[k] > sum[k - 1] && sum[k] >= sum[k + 1])
            .collect();
        let inside = |k: &usize| (band_hz.0..=band_hz.1).contains(&(*k as f64 * step));
        let mut inside: Vec<usize> = maxima.iter().copied().filter(inside).collect();
        inside.sort_by(|&a, &b| sum[b].total_cmp(&sum[a]));
        let Some(&highest) = inside.first() else { return Ok(None) };
        let noise_about = |top: usize| {
            let about = &sum[top / 2..(top + top / 2).min(sum.len())];
            median_of(&mut about.to_vec()).unwrap_or(0.0)
        };
        let is_mode = |&&k: &&usize| {
            !is_hum(responses, sample_rate_hz, k as f64 * step)
                && (k == highest || sum[k] > ABOVE_NOISE * noise_about(k))
        };
        let top = inside.iter().take(MOST_HUM).find(is_mode).copied().unwrap_or(highest);
        let noise = noise_about(top);
        let least = (NEIGHBOUR * NEIGHBOUR * sum[top]).max(ABOVE_NOISE * noise);
        // The nearest on each side: outwards, with the smallest value so far.
        let nearest = |mut outwards: &mut dyn Iterator<Item = usize>| {
            let mut valley = sum[top];
            Iterator::find(&mut outwards, |&k| {
                valley = valley.min(sum[k]);
                let is_maximum =
                    k > 0 && k + 1 < sum.len() && sum[k] > sum[k - 1] && sum[k] >= sum[k + 1];
                is_maximum && sum[k] >= least && valley < VALLEY * VALLEY * sum[k]
            })
        };
        let neighbours = [nearest(&mut (0..top).rev()), nearest(&mut (top + 1..sum.len()))];
        let distance = neighbours
            .into_iter()
            .flatten()
            .map(|k| k.abs_diff(top))
            .min()
            .map_or(f64::INFINITY, |lines| lines as f64 * step);
        Ok(Some(Self { frequency_hz: top as f64 * step, half_width_hz: SHARE * distance }))
    }
}
