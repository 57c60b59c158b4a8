//! The force of the next hit, from the levels that were hit.

use serde::Serialize;

use crate::force_level::{ForceLevel, WIDTH};

/// Good hits of a level that tell its scatter.
const ENOUGH: usize = 3;
/// Ratio of neighbouring levels that leaves no gap.
const GAP: f64 = 1.6;

/// Good hits near a force that was asked for.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LevelCoverage {
    /// Force \[N\].
    pub force_n: f64,
    /// Good hits within 12 % of it.
    pub hits: usize,
}

/// Proposal for the next hit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NextLevel {
    /// Forces that were asked for, with their hits.
    pub wanted: Vec<LevelCoverage>,
    /// Force of the next hit \[N\]; `None` where nothing is missing.
    pub force_n: Option<f64>,
    /// The proposal with its reason, in words.
    pub sentence: String,
}

impl NextLevel {
    /// The level that is missing most: of the forces `wanted` \[N\] that with the fewest good hits,
    /// fewer than three; without any, a level with fewer than three hits, or else the middle of the
    /// widest gap between levels.
    pub fn of(levels: &[ForceLevel], wanted: &[f64]) -> Self {
        let forces: Vec<(f64, usize)> =
            levels.iter().map(|level| (level.force_peak_n.mean, level.hits.len())).collect();
        if !wanted.is_empty() {
            return Self::of_wanted(&forces, wanted);
        }
        let next = |force_n: f64, reason: String| Self {
            wanted: Vec::new(),
            force_n: Some(force_n),
            sentence: format!("next: about {force_n:.3} N, {reason}"),
        };
        let fewest = forces.iter().filter(|(_, hits)| *hits < ENOUGH).min_by_key(|(_, hits)| *hits);
        if let Some((force, hits)) = fewest {
            let hits = if *hits == 1 { "one hit".to_owned() } else { format!("{hits} hits") };
            return next(*force, format!("which has {hits}"));
        }
        let gaps = forces.windows(2).map(|pair| (pair[0].0, pair[1].0));
        let widest = gaps.max_by(|a, b| (a.1 / a.0).total_cmp(&(b.1 / b.0)));
        match (forces.as_slice(), widest) {
            ([], _) => Self {
                wanted: Vec::new(),
                force_n: None,
                sentence: "next: any force, there is no good hit yet".to_owned(),
            },
            (_, Some((low, high))) if high > GAP * low => {
                next((low * high).sqrt(), format!("between {low:.3} and {high:.3} N"))
            }
            ([(only, _)], _) => next(2.0 * only, "since all hits are of one level".to_owned()),
            _ => Self {
                wanted: Vec::new(),
                force_n: None,
                sentence: "each level has three hits or more, without a wide gap".to_owned(),
            },
        }
    }

    fn of_wanted(forces: &[(f64, usize)], wanted: &[f64]) -> Self {
        let near = WIDTH.sqrt();
        let wanted: Vec<LevelCoverage> = wanted
            .iter()
            .map(|&force_n| {
                let own = forces
                    .iter()
                    .filter(|(force, _)| *force <= near * force_n && *force >= force_n / near);
                LevelCoverage { force_n, hits: own.map(|(_, hits)| hits).sum() }
            })
            .collect();
        let fewest = wanted.iter().filter(|one| one.hits < ENOUGH).min_by_key(|one| one.hits);
        let (force_n, sentence) = match fewest {
            Some(LevelCoverage { force_n, hits }) => {
                (Some(*force_n), format!("next: {force_n} N, which has {hits} of {ENOUGH} hits"))
            }
            None => (None, format!("each level asked for has {ENOUGH} hits or more")),
        };
        Self { wanted, force_n, sentence }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hit_report::HitStatistics;

    fn levels(of: &[(f64, usize)]) -> Vec<ForceLevel> {
        let level = |&(force, hits): &(f64, usize)| ForceLevel {
            force_peak_n: HitStatistics::of(std::iter::repeat_n(force, hits)).unwrap(),
            hits: (1..=hits).collect(),
            ..ForceLevel::default()
        };
        of.iter().map(level).collect()
    }

    /// The level with the fewest hits first, then the widest gap, then nothing.
    #[test]
    fn the_missing_level_is_proposed() {
        let next = |of: &[(f64, usize)], wanted: &[f64]| NextLevel::of(&levels(of), wanted).force_n;
        assert_eq!(next(&[], &[]), None);
        assert_eq!(next(&[(10.0, 3), (20.0, 1)], &[]), Some(20.0));
        assert_eq!(next(&[(10.0, 3)], &[]), Some(20.0));
        assert_eq!(next(&[(10.0, 3), (40.0, 3)], &[]), Some(20.0));
        assert_eq!(next(&[(10.0, 3), (15.0, 3)], &[]), None);
        assert_eq!(next(&[(10.0, 3), (15.0, 3)], &[10.0, 30.0]), Some(30.0));
        assert_eq!(next(&[(10.5, 2), (31.0, 3)], &[10.0, 30.0]), Some(10.0));
        assert_eq!(next(&[(10.5, 3), (31.0, 3)], &[10.0, 30.0]), None);
        let found = NextLevel::of(&levels(&[(10.5, 2)]), &[10.0]);
        assert_eq!(found.wanted[0].hits, 2);
        assert_eq!(found.sentence, "next: 10 N, which has 2 of 3 hits");
    }
}
