//! Stiffnesses of a monotone law as relative steps.
//!
//! The steps are `s[i] = 1 - K[i] / K[i+1]`, between 0 and 1: the relative increase from one point to
//! the next. For a table, with stiffnesses at given pressures, the parameters are `K[0]`
//! and the steps. A modified power law leads up to `K_t = C p_t^m` at its transition, so the steps
//! go down from there,
//!
//! ```text
//! K[n-1] = K_t (1 - s_min) (1 - s[n-1]),    K[i] = K[i+1] (1 - s[i]),
//! s_min = m (1 - p[n-1] / p_t) / 3,
//! ```
//!
//! where `s_min` keeps the last secant at a third of the power law's slope at least, so that the
//! cubic there is monotone (Fritsch and Carlson). Any steps between 0 and 1 make a law.

use asperity_scenario::{JsonPointer, four_digits};
use serde_json::Value;

/// The stiffnesses of a law, to be identified.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct MonotoneLaw {
    /// Name of the law.
    pub(super) name: String,
    /// Pointer to the pairs of pressure and stiffness.
    pub(super) pairs: String,
    /// Pointer to the law.
    law: String,
    /// True if the steps lead up to a power law.
    below_power: bool,
    /// Number of pairs.
    pub(super) count: usize,
}

impl MonotoneLaw {
    /// The law of that name in a scenario; `None` if it is neither a table nor a modified power law.
    pub(super) fn find(scenario: &Value, name: &str) -> Option<Self> {
        let law = JsonPointer::root().child("laws").child(name).to_string();
        let spec = scenario.pointer(&law)?;
        let (key, below_power) = match spec.get("kind")?.as_str()? {
            "modified_power" => ("knots", true),
            "table" => ("points", false),
            _ => return None,
        };
        let count = spec.get(key)?.as_array()?.len();
        let name = name.to_owned();
        Some(Self { name, pairs: format!("{law}/{key}"), law, below_power, count })
    }

    /// True if the first parameter is the softest stiffness itself.
    pub(super) fn has_base(&self) -> bool {
        !self.below_power
    }

    /// The parameters of the law as the scenario has it: the softest stiffness if
    /// [`has_base`](Self::has_base), then the steps.
    pub(super) fn read(&self, scenario: &Value) -> Option<Vec<f64>> {
        let pairs = self.values(scenario)?;
        let mut steps: Vec<f64> =
            pairs.windows(2).map(|pair| 1.0 - pair[0][1] / pair[1][1]).collect();
        if self.below_power {
            let (top, least) = self.top(scenario, &pairs)?;
            steps.push(1.0 - pairs.last()?[1] / (top * (1.0 - least)));
        } else {
            steps.insert(0, pairs.first()?[1]);
        }
        Some(steps)
    }

    /// Writes the stiffnesses for these `parameters` into a scenario; `None` without such a law.
    pub(super) fn write(&self, scenario: &mut Value, parameters: &[f64]) -> Option<()> {
        let pairs = self.values(scenario)?;
        let mut stiffness = vec![0.0; self.count];
        if self.below_power {
            let (top, least) = self.top(scenario, &pairs)?;
            let mut level = top * (1.0 - least);
            for (value, step) in stiffness.iter_mut().zip(parameters).rev() {
                level *= 1.0 - step;
                *value = level;
            }
        } else {
            let (first, steps) = parameters.split_first()?;
            let mut level = *first;
            stiffness[0] = level;
            for (value, step) in stiffness[1..].iter_mut().zip(steps) {
                level /= 1.0 - step;
                *value = level;
            }
        }
        let items = scenario.pointer_mut(&self.pairs)?.as_array_mut()?;
        for (item, value) in items.iter_mut().zip(stiffness) {
            *item.get_mut(1)? = value.into();
        }
        Some(())
    }

    /// The pressures of the stiffnesses \[Pa\].
    pub(super) fn pressures(&self, scenario: &Value) -> Vec<f64> {
        self.values(scenario).unwrap_or_default().iter().map(|pair| pair[0]).collect()
    }

    /// The parameters in words: `1 - K(0 MPa)/K(0.025 MPa) of "law"`.
    pub(super) fn step_labels(&self, pressures: &[f64]) -> Vec<String> {
        let name = &self.name;
        let at = |pressure: &f64| format!("K({} MPa)", four_digits(1e-6 * pressure));
        let mut labels: Vec<String> = pressures
            .windows(2)
            .map(|pair| format!("1 - {}/{} of \"{name}\"", at(&pair[0]), at(&pair[1])))
            .collect();
        if self.below_power {
            let last = pressures.last().map(at).unwrap_or_default();
            labels.push(format!("1 - {last}/K of the power law at the transition of \"{name}\""));
        } else {
            let first = pressures.first().map(at).unwrap_or_default();
            labels.insert(0, format!("{first} of \"{name}\""));
        }
        labels
    }

    fn values(&self, scenario: &Value) -> Option<Vec<[f64; 2]>> {
        let items = scenario.pointer(&self.pairs)?.as_array()?;
        let pair = |item: &Value| Some([item.get(0)?.as_f64()?, item.get(1)?.as_f64()?]);
        items.iter().map(pair).collect()
    }

    /// Stiffness at the transition, and the least relative step to it.
    fn top(&self, scenario: &Value, pairs: &[[f64; 2]]) -> Option<(f64, f64)> {
        let law = scenario.pointer(&self.law)?;
        let number = |key: &str| law.get(key)?.as_f64();
        let (coefficient, exponent) = (number("coefficient")?, number("exponent")?);
        let transition = number("transition_pa")?;
        let last = pairs.last()?[0];
        let part = exponent * (1.0 - last / transition) / 3.0;
        Some((coefficient * transition.powf(exponent), part))
    }
}

#[cfg(test)]
mod tests {
    use asperity_law::ModifiedPower;
    use serde_json::json;

    use super::*;

    fn scenario() -> Value {
        json!({"laws": {
            "m": {"kind": "modified_power", "coefficient": 1.81e10, "exponent": 0.35,
                  "transition_pa": 2e5, "knots": [[0.0, 0.02e12], [0.025e6, 0.12e12], [0.14e6, 0.97e12]]},
            "t": {"kind": "table", "points": [[1e4, 1e11], [1e5, 5e11], [1e6, 2e12]]},
            "c": {"kind": "constant", "stiffness_pa_per_m": 1e12},
        }})
    }

    /// Writing what was read changes nothing but the last bits.
    #[test]
    fn reading_and_writing_are_inverse() {
        for name in ["m", "t"] {
            let mut scenario = scenario();
            let law = MonotoneLaw::find(&scenario, name).unwrap();
            let before = law.values(&scenario).unwrap();
            let parameters = law.read(&scenario).unwrap();
            law.write(&mut scenario, &parameters).unwrap();
            for (a, b) in before.iter().zip(law.values(&scenario).unwrap()) {
                assert!((a[1] / b[1] - 1.0).abs() < 1e-13, "{a:?} {b:?}");
            }
        }
        assert!(MonotoneLaw::find(&scenario(), "c").is_none());
        assert!(MonotoneLaw::find(&scenario(), "x").is_none());
    }

    /// The steps and exponents at the ends of their ranges, in all combinations, are accepted by
    /// the law's own constructor.
    #[test]
    fn every_step_makes_a_law() {
        let ends = [1e-3, 0.3, 0.999];
        for (exponent, transition) in [(0.05, 1.41e5), (0.35, 2e5), (1.0, 2e6), (2.5, 2e7)] {
            for n in 0..27 {
                let steps = [ends[n % 3], ends[n / 3 % 3], ends[n / 9]];
                let mut scenario = scenario();
                scenario["laws"]["m"]["exponent"] = json!(exponent);
                scenario["laws"]["m"]["transition_pa"] = json!(transition);
                let law = MonotoneLaw::find(&scenario, "m").unwrap();
                law.write(&mut scenario, &steps).unwrap();
                let knots: Vec<_> =
                    law.values(&scenario).unwrap().into_iter().map(|[p, k]| (p, k)).collect();
                ModifiedPower::new(1.81e10, exponent, transition, &knots).unwrap();
            }
        }
    }
}
