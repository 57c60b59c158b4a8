//! Hits grouped by force.

use std::fmt::Write as _;

use asperity_signal::Complex64;
use serde::Serialize;

use crate::hit_report::{HitReport, HitStatistics};

/// Largest force of a group over its smallest.
pub(crate) const WIDTH: f64 = 1.25;
/// Least change of a mean frequency, in its standard errors; more than for a normal distribution, since
/// few hits tell the scatter.
const SIGNIFICANT: f64 = 4.0;
/// Scatter over the frequency below which there is no noise.
const NO_NOISE: f64 = 1e-9;
/// Most frequencies at which the coherence of a group is evaluated.
const MOST_LINES: usize = 64;

/// Hits of about one force, which are repetitions.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct ForceLevel {
    /// Mean, smallest and largest peak force \[N\].
    pub force_peak_n: HitStatistics,
    /// Numbers of the hits.
    pub hits: Vec<usize>,
    /// Frequency f1 \[Hz\].
    pub frequency_hz: Option<HitStatistics>,
    /// Receptance A1 \[m/N\].
    pub magnitude: Option<HitStatistics>,
    /// Half-power damping ratio.
    pub damping_ratio: Option<HitStatistics>,
    /// Ratio A2/A1, where the second peak is the harmonic.
    pub harmonic_ratio: Option<HitStatistics>,
    /// Coherence of force and response of these hits at f1; `None` for one hit.
    pub coherence: Option<f64>,
}

/// Energies `|F|^2`, `|X|^2` and `conj(F) X` of one hit at some frequencies of the band.
#[derive(Debug, Clone, Default)]
pub(crate) struct BandSums(Vec<(f64, f64, f64, Complex64)>);

impl BandSums {
    /// The sums of a hit, from the lines of its own spectra: frequency, `|F|^2`, `|X|^2`, `conj(F) X`.
    pub(crate) fn of(lines: impl Iterator<Item = (f64, f64, f64, Complex64)>) -> Self {
        let lines: Vec<_> = lines.collect();
        let step = lines.len().div_ceil(MOST_LINES).max(1);
        Self(lines.into_iter().step_by(step).collect())
    }
}

/// Groups the averaged hits by force, from the smallest on.
///
/// Sorted forces are divided at the widest relative gap until the largest of each group is at
/// most 1.25 times its smallest.
pub(crate) fn force_levels(hits: &[HitReport], sums: &[BandSums]) -> Vec<ForceLevel> {
    let mut sorted: Vec<(f64, &HitReport, &BandSums)> = hits
        .iter()
        .zip(sums)
        .filter(|(hit, _)| hit.averaged)
        .filter_map(|(hit, sums)| Some((hit.force_peak_n.filter(|force| *force > 0.0)?, hit, sums)))
        .collect();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut groups = Vec::new();
    divide(&sorted, &mut groups);
    groups.into_iter().filter_map(ForceLevel::of).collect()
}

type Member<'a> = (f64, &'a HitReport, &'a BandSums);

fn divide<'a, 'b>(sorted: &'b [Member<'a>], groups: &mut Vec<&'b [Member<'a>]>) {
    let (Some(first), Some(last)) = (sorted.first(), sorted.last()) else {
        return;
    };
    if last.0 <= WIDTH * first.0 {
        return groups.push(sorted);
    }
    let gap = |at: &usize| sorted[*at].0 / sorted[at - 1].0;
    let widest = (1..sorted.len()).max_by(|a, b| gap(a).total_cmp(&gap(b))).unwrap_or(1);
    let (low, high) = sorted.split_at(widest);
    divide(low, groups);
    divide(high, groups);
}

impl ForceLevel {
    fn of(members: &[Member<'_>]) -> Option<Self> {
        let statistics = |value: &dyn Fn(&HitReport) -> Option<f64>| {
            HitStatistics::of(members.iter().filter_map(|(_, hit, _)| value(hit)))
        };
        let frequency_hz = statistics(&|hit| Some(hit.fundamental?.frequency_hz));
        let mut numbers: Vec<usize> = members.iter().map(|(_, hit, _)| hit.index).collect();
        numbers.sort_unstable();
        Some(Self {
            force_peak_n: statistics(&|hit| hit.force_peak_n)?,
            hits: numbers,
            frequency_hz,
            magnitude: statistics(&|hit| Some(hit.fundamental?.magnitude)),
            damping_ratio: statistics(&|hit| hit.fundamental?.damping_ratio),
            harmonic_ratio: statistics(&|hit| hit.harmonic_ratio),
            coherence: frequency_hz.and_then(|first| coherence(members, first.mean)),
        })
    }
}

/// Coherence of some hits at the line nearest a frequency (Hz); `None` for one hit.
fn coherence(members: &[Member<'_>], frequency_hz: f64) -> Option<f64> {
    let lines = &members.first()?.2.0;
    let far = |line: &(f64, f64, f64, Complex64)| (line.0 - frequency_hz).abs();
    let nearest = (0..lines.len()).min_by(|&a, &b| far(&lines[a]).total_cmp(&far(&lines[b])))?;
    let (mut force, mut response, mut cross) = (0.0, 0.0, Complex64::ZERO);
    for (.., sums) in members {
        let (_, f, x, c) = sums.0.get(nearest)?;
        force += f;
        response += x;
        cross += c;
    }
    let found = cross.norm_sqr() / (force * response);
    (members.len() > 1 && found.is_finite()).then_some(found)
}

/// The change of the fundamental from the lowest to the highest level, in words; `None` for one level.
///
/// Its measure is the scatter at one force, pooled over the levels and not less than the standard
/// deviation due to noise, which counts where no level has two hits.
pub(crate) fn change_with_force(levels: &[ForceLevel], hits: &[HitReport]) -> Option<String> {
    let known: Vec<(&ForceLevel, HitStatistics)> =
        levels.iter().filter_map(|level| Some((level, level.frequency_hz?))).collect();
    let ((low, first), (high, last)) = (known.first()?, known.last()?);
    if known.len() < 2 {
        return None;
    }
    let (squares, freedom) = known.iter().fold((0.0, 0.0), |(squares, freedom), (_, one)| {
        let degrees = one.hits as f64 - 1.0;
        let square = one.standard_deviation.map_or(0.0, |s| degrees * s * s);
        (squares + square, freedom + degrees)
    });
    let noise = HitStatistics::of(
        hits.iter().filter_map(|hit| Some(hit.fundamental?.frequency_uncertainty_hz?.powi(2))),
    );
    let noise = noise.map_or(0.0, |noise| noise.mean.sqrt());
    let (scatter, name) = if freedom > 0.0 {
        ((squares / freedom).sqrt().max(noise), "scatter at one force")
    } else {
        (noise, "standard deviation due to noise")
    };
    let error = scatter * (1.0 / first.hits as f64 + 1.0 / last.hits as f64).sqrt();
    let change = last.mean / first.mean - 1.0;
    let verb = if change < 0.0 { "falls" } else { "rises" };
    let forces = format!("from {:.3} to {:.3} N", low.force_peak_n.mean, high.force_peak_n.mean);
    let change_hz = (last.mean - first.mean).abs();
    if change_hz < SIGNIFICANT * error {
        return Some(format!(
            "f1 does not change with force {forces}, by more than {SIGNIFICANT} standard errors"
        ));
    }
    let mut text = format!("f1 {verb} {:.2} % {forces}", 100.0 * change.abs());
    // Simulated hits have no noise.
    if scatter > NO_NOISE * first.mean {
        let times = change_hz / scatter;
        let digits = usize::from(times < 10.0);
        // Writing to a string cannot fail.
        let _ = write!(text, ", {times:.digits$} times its {name}");
    }
    Some(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Verified against groups that are seen at once: forces within a quarter of each other stay
    /// together, and a group is divided at its widest gap.
    #[test]
    fn forces_are_divided_at_gaps() {
        let hit = HitReport::default();
        let sums = BandSums::default();
        let of = |forces: &[f64]| -> Vec<usize> {
            let sorted: Vec<Member<'_>> = forces.iter().map(|f| (*f, &hit, &sums)).collect();
            let mut groups = Vec::new();
            divide(&sorted, &mut groups);
            groups.iter().map(|group| group.len()).collect()
        };
        assert_eq!(of(&[9.0, 9.5, 10.0, 19.0, 20.0, 31.0, 32.0, 33.0]), [3, 2, 3]);
        assert_eq!(of(&[10.0, 12.4]), [2]);
        assert_eq!(of(&[10.0, 12.6]), [1, 1]);
        assert_eq!(of(&[]), Vec::<usize>::new());
    }
}
