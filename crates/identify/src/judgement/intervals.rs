//! Reasons from values outside of their intervals.

use asperity_inference::ProfileEnd;
use asperity_scenario::four_digits;

use super::{Reason, ReasonKind, Usability};
use crate::identification::Identification;

/// Distance of a best value from its interval, over the width of the interval, which is rounding and
/// the noise of the draws.
const SLACK: f64 = 0.05;

/// The same distance up to which a skewed posterior accounts for it, if its draws have converged and the data are
/// explained.
const SKEWED: f64 = 0.5;

/// Deviance above the best fit up to which another optimum is as good.
const AS_GOOD: f64 = 4.0;

/// Distance of a value from an interval, over the width of the interval; infinite if that is no number.
fn beyond(value: f64, low: f64, high: f64) -> f64 {
    let share = (low - value).max(value - high) / (high - low);
    if share.is_nan() { f64::INFINITY } else { share }
}

impl Identification {
    /// The posterior interval of a parameter.
    fn interval(&self, parameter: usize) -> [f64; 2] {
        let tail = 0.5 * (1.0 - self.level);
        [tail, 1.0 - tail].map(|tail| self.posterior.quantile(parameter, tail))
    }

    /// Another optimum as good, outside the interval of a parameter: the one farthest outside.
    pub(super) fn of_second_optimum(&self) -> Option<Reason> {
        let others = self.fit.distinct_optima.iter().skip(1);
        let as_good = others.filter(|other| 2.0 * (other.cost - self.fit.cost) < AS_GOOD);
        let apart = as_good.flat_map(|other| {
            let parameters = (0..self.names.len()).filter(|&j| !self.latent[j]);
            let outside = parameters.filter(|&j| !self.holds(j, other.point[j]));
            outside.map(move |j| {
                let [low, high] = self.interval(j);
                (beyond(other.point[j], low, high), j, other)
            })
        });
        let (share, j, other) = apart.max_by(|a, b| a.0.total_cmp(&b.0))?;
        let (usability, why) = self.of_outside(share);
        let words = format!(
            "the fit has two optima that the data do not tell apart: {} is {} or {}, {} % of the width of its interval outside of it{}.",
            self.labels[j],
            four_digits(self.fit.point[j]),
            four_digits(other.point[j]),
            four_digits(100.0 * share),
            if why.is_empty() { "" } else { "; the draws have converged, and lie about both" }
        );
        let numbers = [
            ("value", self.fit.point[j]),
            ("other", other.point[j]),
            ("deviance", 2.0 * (other.cost - self.fit.cost)),
            ("beyond", share),
        ];
        Some(Reason::new(ReasonKind::Starts, usability, words, numbers))
    }

    /// True if the posterior interval of a parameter holds a value, up to [`SLACK`].
    fn holds(&self, parameter: usize, value: f64) -> bool {
        let [low, high] = self.interval(parameter);
        let slack = SLACK * (high - low) + 1e-9 * value.abs();
        (low - slack..=high + slack).contains(&value)
    }

    pub(super) fn of_intervals(&self) -> Vec<Reason> {
        let mut found = Vec::new();
        for estimate in self.estimates() {
            let [low, high] = estimate.posterior_interval;
            let value = estimate.value;
            let place = self.names.iter().position(|name| *name == estimate.name);
            let inside = place.is_none_or(|place| self.holds(place, value));
            // The interval of a parameter without a limit on that side has equal tails within the bounds.
            let side = usize::from(value > high);
            let is_open = estimate.at_bound || self.is_open(place, side);
            if !inside && !is_open {
                let (usability, why) = self.of_outside(beyond(value, low, high));
                let words = format!(
                    "the best value of {}, {}, is outside its interval, {} to {}{why}.",
                    estimate.label,
                    four_digits(value),
                    four_digits(low),
                    four_digits(high)
                );
                let numbers = [("value", value), ("lower", low), ("upper", high)];
                found.push(Reason::new(ReasonKind::Interval, usability, words, numbers));
            }
        }
        let law = &self.law;
        let outside = |i: &usize| {
            let slack = SLACK * (law.upper[*i] - law.lower[*i]) + 1e-9 * law.stiffness[*i];
            let inside = law.lower[*i] - slack..=law.upper[*i] + slack;
            law.informed[*i] && !inside.contains(&law.stiffness[*i])
        };
        let outside: Vec<usize> = (0..law.pressure.len()).filter(outside).collect();
        if let (Some(first), Some(last)) = (outside.first(), outside.last()) {
            let [low, high] = [law.pressure[*first], law.pressure[*last]];
            let off = |&i: &usize| beyond(law.stiffness[i], law.lower[i], law.upper[i]);
            let farthest = outside.iter().map(off).fold(0.0, f64::max);
            let (usability, why) = self.of_outside(farthest);
            let words = format!(
                "the best fit of law \"{}\" is outside its own band at {} pressures from {} to {} MPa, by up to {} % of its width{why}.",
                law.name,
                outside.len(),
                four_digits(1e-6 * low),
                four_digits(1e-6 * high),
                four_digits(100.0 * farthest)
            );
            let numbers = [
                ("pressures", outside.len() as f64),
                ("lower_pa", low),
                ("upper_pa", high),
                ("beyond", farthest),
            ];
            found.push(Reason::new(ReasonKind::Interval, usability, words, numbers));
        }
        found
    }

    /// Usability of a result whose best value, or one as good, is outside its interval by a share of the interval's
    /// width, and why it may be: an interval with equal tails holds the mass of a skewed posterior, not its highest density.
    fn of_outside(&self, share: f64) -> (Usability, &'static str) {
        if share <= SKEWED && self.sampler_has_converged() && self.explains() {
            (
                Usability::WithCare,
                "; the draws have converged: the posterior is skewed, and most of it lies on one side of the best fit",
            )
        } else {
            (Usability::No, "")
        }
    }

    /// True if the profile of a parameter has no end on a side.
    fn is_open(&self, parameter: Option<usize>, side: usize) -> bool {
        let mut own = self.profiles.iter().filter(|one| Some(one.parameter) == parameter);
        own.next().is_some_and(|profile| profile.ends[side] != ProfileEnd::Crossed)
    }
}
