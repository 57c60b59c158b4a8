//! Settings of the views that are not part of a scenario: force levels, frequency range, axis.

use asperity_plot::MagnitudeAxis;
use asperity_scenario::AnyScenario;
use asperity_simulation::assemble::Assembly;
use asperity_simulation::patches::assemble_patches;
use asperity_simulation::static_state::StaticSummary;
use asperity_simulation::steady::Shaken;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::measured::Measured;
use crate::state::State;

/// Accepted numbers of levels and of shaker amplitudes, and levels unless set.
const LEVELS: std::ops::RangeInclusive<usize> = 2..=200;
const MOST_AMPLITUDES: usize = 12;
const USUAL_LEVELS: usize = 24;

/// Levels over the amplitude of the scenario, or over the forces of measured hits, and the range of frequencies
/// over the natural frequency at rest, unless set.
const LEVEL_RANGE: (f64, f64) = (0.1, 1.5);
const HIT_RANGE: (f64, f64) = (0.8, 1.2);
const FREQUENCY_RANGE: (f64, f64) = (0.6, 1.3);

/// Amplitudes of a shaker, over the one whose resonance would take the load of a contact at rest from it,
/// unless set.
const SHARES: [f64; 3] = [0.2, 0.6, 1.0];

/// Damping ratio that those amplitudes count with.
const USUAL_RATIO: f64 = 0.03;

/// Settings of the page; what is left out is chosen by the scenario.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(crate) struct Settings {
    /// Axis of magnitudes.
    pub(crate) magnitude: Magnitude,
    /// Lowest and highest load of the levels, and their number.
    pub(crate) level_from: Option<f64>,
    pub(crate) level_to: Option<f64>,
    pub(crate) levels: Option<usize>,
    /// Amplitudes of the shaker \[N\], or of the acceleration of the base \[m/s2\].
    pub(crate) amplitudes: Option<Vec<f64>>,
    /// Range of frequencies of steady responses.
    pub(crate) from_hz: Option<f64>,
    pub(crate) to_hz: Option<f64>,
    /// Adds the backbones.
    pub(crate) backbone: bool,
}

/// Axis of magnitudes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Magnitude {
    #[default]
    Log,
    Linear,
    Db,
}

impl From<Magnitude> for MagnitudeAxis {
    fn from(magnitude: Magnitude) -> Self {
        match magnitude {
            Magnitude::Log => Self::Log,
            Magnitude::Linear => Self::Linear,
            Magnitude::Db => Self::Db,
        }
    }
}

impl Settings {
    /// The settings that a scenario gives, and a structure of matrices at rest; none of them for a scenario that cannot be
    /// assembled.
    pub(crate) fn usual(
        state: &State,
        measured: Option<&Measured>,
    ) -> (Self, Option<StaticSummary>) {
        let folder = state.document.folder();
        let found = match &state.scenario {
            AnyScenario::Bars(scenario) => {
                Assembly::new(scenario, folder).map(|found| (Self::of(&found, measured), None))
            }
            AnyScenario::Structure(scenario) => assemble_patches(scenario, folder)
                .map(|found| (Self::of(&found, measured), Some(found.structure.at_rest()))),
        };
        found.unwrap_or_default()
    }

    fn of<S: Shaken>(assembly: &Assembly<S>, measured: Option<&Measured>) -> Self {
        let natural = assembly.structure.natural_frequency_hz();
        let natural = natural.filter(|hz| *hz > 0.0).unwrap_or(100.0);
        let load = assembly.load.amplitude().abs();
        let load = if load > 0.0 { load } else { 10.0 };
        let held = assembly.structure.interfaces().iter();
        let held = held.map(|one| one.pressure() * one.area()).fold(f64::INFINITY, f64::min);
        let held = if held.is_finite() && held > 0.0 { held } else { load };
        let is_base = assembly.load.base().is_some();
        let whole = 2.0 * USUAL_RATIO * if is_base { GRAVITY } else { held };
        let (from, to) = measured.map_or((LEVEL_RANGE.0 * load, LEVEL_RANGE.1 * load), |hits| {
            let (low, high) = hits.forces();
            (HIT_RANGE.0 * low, HIT_RANGE.1 * high)
        });
        Self {
            level_from: Some(rounded(from)),
            level_to: Some(rounded(to)),
            levels: Some(USUAL_LEVELS),
            amplitudes: Some(SHARES.map(|share| rounded(share * whole)).to_vec()),
            from_hz: Some(rounded(FREQUENCY_RANGE.0 * natural)),
            to_hz: Some(rounded(FREQUENCY_RANGE.1 * natural)),
            ..Self::default()
        }
    }

    /// The settings, with those of `usual` that are left out.
    pub(crate) fn filled(&self, usual: &Self) -> Self {
        Self {
            magnitude: self.magnitude,
            level_from: self.level_from.or(usual.level_from),
            level_to: self.level_to.or(usual.level_to),
            levels: self.levels.or(usual.levels),
            amplitudes: self.amplitudes.clone().or_else(|| usual.amplitudes.clone()),
            from_hz: self.from_hz.or(usual.from_hz),
            to_hz: self.to_hz.or(usual.to_hz),
            backbone: self.backbone,
        }
    }

    /// The fault of the settings, if they have one.
    pub(crate) fn fault(&self) -> Option<String> {
        let levels = self.levels.filter(|count| !LEVELS.contains(count)).map(|count| {
            format!("{count} levels; accepted: {} to {}", LEVELS.start(), LEVELS.end())
        });
        let amplitudes = self.amplitudes.as_ref().map(Vec::len);
        let amplitudes = amplitudes.filter(|count| !(1..=MOST_AMPLITUDES).contains(count));
        levels.or_else(|| {
            Some(format!("{} amplitudes; accepted: 1 to {MOST_AMPLITUDES}", amplitudes?))
        })
    }
}

/// Acceleration that lifts a body off its support \[m/s2\].
const GRAVITY: f64 = 9.81;

/// `value` with two significant digits.
pub(crate) fn rounded(value: f64) -> f64 {
    format!("{value:.1e}").parse().unwrap_or(value)
}

/// JSON Pointer to the amplitude of the load of a scenario; none without a load.
pub(crate) fn amplitude_pointer(document: &Value) -> Option<String> {
    let excitation = document.get("excitation")?;
    let kind = excitation.get("kind")?.as_str()?;
    if kind == "samples" {
        return Some("/excitation/peak_n".to_owned());
    }
    let of = |object: &Value, place: &str| {
        let keys = object.as_object()?.keys();
        let mut found = keys.filter(|key| is_amplitude(key));
        found.next().map(|key| format!("{place}/{key}"))
    };
    of(excitation, "/excitation").or_else(|| {
        let inner = excitation.as_object()?;
        inner.iter().find_map(|(key, value)| of(value, &format!("/excitation/{key}")))
    })
}

fn is_amplitude(key: &str) -> bool {
    key.starts_with("peak_") || key.starts_with("amplitude_")
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn the_load_of_every_kind_has_an_amplitude() {
        let pointer = |excitation: Value| amplitude_pointer(&json!({ "excitation": excitation }));
        let hammer = json!({"kind": "gamma_pulse", "peak_n": 1, "rise_s": 1});
        assert_eq!(pointer(hammer).unwrap(), "/excitation/peak_n");
        let shaken = json!({"kind": "base_motion", "acceleration":
            {"kind": "harmonic", "amplitude_m_per_s2": 1, "frequency_hz": 300}});
        assert_eq!(pointer(shaken).unwrap(), "/excitation/acceleration/amplitude_m_per_s2");
        let measured = json!({"kind": "samples", "file": "a.csv"});
        assert_eq!(pointer(measured).unwrap(), "/excitation/peak_n");
        assert_eq!(pointer(json!({"kind": "none"})), None);
    }
}
