//! Kinds of loss of the paper's rig, as twins have them and as a problem compares them.

use asperity_identify::IdentificationProblem;
use asperity_scenario::{Document, set_value};
use serde_json::{Value, json};
use tempfile::TempDir;

use crate::twin::{Noise, Sensors, Truth, data};

const SCENARIO: &str =
    concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/scenarios/nouira2020-modified.json");

/// The kinds.
pub const KINDS: [&str; 3] = ["bodies", "contacts", "friction"];

/// Numbers of each kind.
#[derive(Debug, Clone, Copy)]
pub struct Losses {
    /// Damping ratio of the bodies alone.
    pub ratio: f64,
    /// Damping ratio of the bodies beside another loss.
    pub beside: f64,
    /// Retardation time of the contacts \[s\].
    pub time_s: f64,
    /// Stuck stiffness of the guide of the bar \[N/m\], and its coefficient of friction.
    pub stuck: f64,
    pub coefficient: f64,
}

/// A lightly damped rig.
pub const LIGHT: Losses =
    Losses { ratio: 0.012, beside: 0.004, time_s: 3e-6, stuck: 2e8, coefficient: 0.003 };

/// The paper's rig, with the losses of figure x9.
pub const PAPER: Losses =
    Losses { ratio: 0.035, beside: 0.02, time_s: 6e-6, stuck: 2e9, coefficient: 0.02 };

impl Losses {
    /// Changes of the scenario that give it a loss of a kind, and the pointers to its number.
    pub fn changes(
        &self,
        kind: &str,
        size: f64,
    ) -> (Vec<(&'static str, Value)>, Vec<&'static str>) {
        let beside = ("/damping/ratio", json!(self.beside));
        let contacts = json!({"kind": "kelvin_voigt", "time_s": self.time_s * size});
        let friction = json!({
            "stiffness_n_per_m": self.stuck, "coefficient": self.coefficient * size,
        });
        match kind {
            "bodies" => {
                (vec![("/damping/ratio", json!(self.ratio * size))], vec!["/damping/ratio"])
            }
            "contacts" => (
                vec![
                    beside,
                    ("/interfaces/0/damping", contacts.clone()),
                    ("/interfaces/1/damping", contacts),
                ],
                vec!["/interfaces/0/damping/time_s", "/interfaces/1/damping/time_s"],
            ),
            _ => (
                vec![beside, ("/bodies/0/friction", friction)],
                vec!["/bodies/0/friction/coefficient"],
            ),
        }
    }

    /// Hits of 9, 20 and 32 N on a rig with the loss of a kind, of a random size.
    pub fn truth(&self, kind: &str, seed: u64) -> (Truth, f64) {
        let size = (0.2 * Noise::new(seed + 1000).normal()).exp();
        let changes = self.changes(kind, size).0.into_iter();
        let written: Vec<(&str, String)> =
            changes.map(|(pointer, value)| (pointer, value.to_string())).collect();
        let mut all = vec![("/output_rate_hz", "50000"), ("/duration_s", "0.1")];
        all.extend(written.iter().map(|(pointer, value)| (*pointer, value.as_str())));
        (Truth::new(SCENARIO, &[9.0, 20.0, 32.0], &all), size)
    }
}

/// Data of a problem.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Observed {
    /// Frequency and damping over amplitude along the decays.
    Backbones,
    /// Frequency, receptance and harmonic ratio of the hits.
    Features,
    /// Both.
    All,
}

/// A problem in a folder with its data.
pub struct Measured {
    pub problem: IdentificationProblem,
    _folder: TempDir,
}

impl Measured {
    /// Hits of a rig as measured with 40 dB of noise, for a scenario with the changes `own`, and
    /// other `keys` of a problem; none without data.
    fn new(
        truth: &Truth,
        observed: Observed,
        seed: u64,
        own: &[(&'static str, Value)],
        keys: &Value,
    ) -> Option<Self> {
        let sensors =
            Sensors { signal_to_noise_db: 40.0, force_gain: 1.0, response_gain: 1.0, seed };
        let (hits, table) = truth.measured_with_backbones(&sensors);
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("backbone.csv"), &table).unwrap();
        let mut all = if observed == Observed::Backbones { json!([]) } else { data(&hits) };
        if observed != Observed::Features {
            // A decay may be too short for a backbone.
            let decays = |number: &usize| table.contains(&format!("\n{number},"));
            let backbones = (1..=hits.len()).filter(decays).map(|number| {
                json!({
                    "kind": "backbone", "file": "backbone.csv", "index": number,
                    "hit": {"force_peak_n": hits[number - 1]["force_peak_n"]},
                    // Difference of the engines.
                    "spread": {"relative": 5e-5}, "damping_spread": {"relative": 1e-3},
                })
            });
            all.as_array_mut().unwrap().extend(backbones);
        }
        if all == json!([]) {
            return None;
        }
        let mut rig = truth.scenario.clone();
        rig["bodies"][0].as_object_mut().unwrap().remove("friction");
        for interface in rig["interfaces"].as_array_mut().unwrap() {
            interface.as_object_mut().unwrap().remove("damping");
        }
        for (pointer, value) in own {
            set_value(&mut rig, pointer, &value.to_string()).unwrap();
        }
        let mut problem = json!({
            "schema": "asperity/identify/1",
            "scenario": rig,
            "data": all,
            "draws": 100,
            "starts": 1,
        });
        for (key, value) in keys.as_object().into_iter().flatten() {
            problem[key] = value.clone();
        }
        let path = folder.path().join("problem.json");
        let document = Document::parse(&problem.to_string(), &path).unwrap();
        Some(Self { problem: IdentificationProblem::of(document).unwrap(), _folder: folder })
    }
}

/// The number of a kind as a parameter.
pub fn unknown(kind: &str) -> Value {
    let (_, pointers) = LIGHT.changes(kind, 1.0);
    let bounds = match kind {
        "bodies" => [1e-3, 0.1],
        "contacts" => [1e-8, 1e-4],
        _ => [1e-5, 0.1],
    };
    json!({"kind": "scalar", "pointer": pointers[0], "also": pointers[1..], "bounds": bounds})
}

impl Losses {
    /// Damped bodies, compared with the other kinds; none without data.
    pub fn comparison(&self, truth: &Truth, observed: Observed, seed: u64) -> Option<Measured> {
        let candidate = |kind: &str| {
            let set: serde_json::Map<String, Value> = self
                .changes(kind, 1.0)
                .0
                .into_iter()
                .map(|(pointer, value)| (pointer.to_owned(), value))
                .collect();
            json!({"name": kind, "set": set, "unknowns": [unknown(kind)]})
        };
        let keys = json!({
            "name": "bodies",
            "unknowns": [unknown("bodies")],
            "compare": [candidate("contacts"), candidate("friction")],
        });
        Measured::new(truth, observed, seed, &self.changes("bodies", 1.0).0, &keys)
    }

    /// The coefficient of friction and the damping ratio of the bodies as unknowns; none without data.
    pub fn friction(&self, truth: &Truth, observed: Observed, seed: u64) -> Option<Measured> {
        let keys = json!({"unknowns": [unknown("friction"), unknown("bodies")]});
        Measured::new(truth, observed, seed, &self.changes("friction", 1.0).0, &keys)
    }
}
