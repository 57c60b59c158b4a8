//! Random rigs with hits as measured, and problems with the right model of each and with a wrong one.

use asperity_identify::IdentificationProblem;
use asperity_scenario::Document;
use serde_json::{Value, json};

use crate::laws;
use crate::twin::{Noise, Sensors, Truth, data};

/// Faults of the wrong models of rigs.
pub const KINDS: [&str; 6] = ["damping", "pulse", "mass", "support", "friction", "sign"];

/// Families of the true law.
pub const LAWS: [&str; 3] = ["power", "modified power", "table"];

/// Measured hits of a rig.
const HITS: usize = 12;

/// Hits whose receptance is measured, and its lines.
const RECEPTANCES: usize = 3;
const LINES: usize = 14;

/// A rig with its true law and hits as measured.
pub struct Rig {
    pub kind: &'static str,
    pub law: &'static str,
    /// Points of the true law: pressure \[Pa\], stiffness \[Pa/m\].
    pub points: Vec<(f64, f64)>,
    truth: Truth,
    /// The true law as a document.
    exact: Value,
    data: Value,
    unknowns: Vec<Value>,
    noise: Noise,
}

impl Rig {
    /// The rig of a number, with random bodies, law, damping, forces and sensors.
    pub fn new(seed: u64, number: usize) -> Self {
        let kind = KINDS[number % KINDS.len()];
        let law = LAWS[number / KINDS.len() % LAWS.len()];
        let mut noise = Noise::new(1_000_000 * seed + number as u64);
        let mut uniform = |low: f64, high: f64| low + (high - low) * noise.uniform();
        let (modulus, density) = if uniform(0.0, 1.0) < 0.5 { (71e9, 2710) } else { (210e9, 7850) };
        let (mass, area) = (uniform(0.8, 2.5), uniform(1e-4, 2.5e-4));
        let at_rest = 9.81 * mass / area;
        let natural = uniform(600.0, 1000.0);
        let omega = std::f64::consts::TAU * natural;
        // Two equal contacts in series.
        let stiffness = 2.0 * mass * omega.powi(2) / area;
        let body = uniform(0.012, 0.03);
        let rise = uniform(2.5e-4, 4.5e-4);
        let least = uniform(0.15, 0.3) * 9.81 * mass;
        let most = uniform(0.6, 1.1) * 9.81 * mass;
        let contact_s = 2.0 * uniform(0.006, 0.015) / omega;
        let friction = 10.0_f64.powf(uniform(-3.0, -2.3));
        let support = uniform(5.0, 20.0) * mass * omega.powi(2);
        let base = uniform(0.5, 2.0);
        let (length, sample) = (uniform(0.08, 0.23), uniform(0.008, 0.02));
        let (points, written, law_unknowns, law_form) =
            true_law(law, at_rest, stiffness, &mut noise);
        let mut rig = json!({
            "schema": "asperity/scenario/1",
            "gravity_m_per_s2": 9.81,
            "bodies": [
                {"name": "block", "length_m": length, "mass_kg": mass,
                 "youngs_modulus_pa": modulus, "density_kg_per_m3": density},
                {"name": "sample", "length_m": sample, "area_m2": area,
                 "youngs_modulus_pa": 71e9, "density_kg_per_m3": 2710}
            ],
            "support": {"kind": "rigid"},
            "interfaces": [
                {"name": "upper", "area_m2": area, "law": "rough"},
                {"name": "lower", "area_m2": area, "law": "rough"}
            ],
            "laws": {"rough": written},
            "damping": {"kind": "mass_proportional", "ratio": body},
            "excitation": {"kind": "gamma_pulse", "peak_n": most, "rise_s": rise},
            "duration_s": 0.12,
            "output_rate_hz": 50_000
        });
        let mut unknowns = law_unknowns;
        let scalar = |pointer: &str, value: f64| json!({"kind": "scalar", "pointer": pointer, "bounds": [1e-2 * value, 30.0 * value], "start": 0.6 * value});
        let bodies = json!({"kind": "scalar", "pointer": "/damping/ratio", "bounds": [1e-3, 0.1], "start": 0.02});
        unknowns.push(bodies);
        match kind {
            "damping" => {
                let damping = json!({"kind": "kelvin_voigt", "time_s": contact_s});
                rig["interfaces"][0]["damping"] = damping.clone();
                rig["interfaces"][1]["damping"] = damping;
                let mut both = scalar("/interfaces/0/damping/time_s", contact_s);
                both["also"] = json!(["/interfaces/1/damping/time_s"]);
                unknowns.push(both);
            }
            "support" => {
                rig["support"] = json!({"kind": "spring_mass", "stiffness_n_per_m": support,
                    "mass_kg": base, "damping_ratio": 0.02});
            }
            "friction" => {
                rig["bodies"][0]["friction"] =
                    json!({"stiffness_n_per_m": 2e9, "coefficient": friction});
                unknowns.push(scalar("/bodies/0/friction/coefficient", friction));
            }
            _ => {}
        }
        let gains = if kind == "mass" { 0.0 } else { 0.03 };
        let mut gain = || (gains * noise.normal()).exp();
        let sensors = Sensors {
            signal_to_noise_db: 40.0,
            force_gain: gain(),
            response_gain: gain(),
            seed: 1_000_000 * seed + 500_000 + number as u64,
        };
        if gains > 0.0 {
            for channel in ["force", "response"] {
                let prior = json!({"value": 1, "relative": gains});
                unknowns.push(json!({"kind": "gain", "channel": channel, "prior": prior}));
            }
        }
        let document = Document::parse(&rig.to_string(), "rig.json").unwrap();
        let (mut truth, data) = measured(document, kind, [least, most], natural, sensors);
        let exact = std::mem::replace(&mut truth.scenario["laws"]["rough"], law_form);
        Self { kind, law, points, truth, exact, data, unknowns, noise }
    }

    /// The problem with the right model, started from the truth alone.
    #[allow(dead_code, reason = "used by the example")]
    pub fn at_truth(&self) -> IdentificationProblem {
        let (mut rig, mut unknowns) = (self.truth.scenario.clone(), self.unknowns.clone());
        rig["laws"]["rough"] = self.exact.clone();
        for one in &mut unknowns {
            one.as_object_mut().unwrap().remove("start");
        }
        problem(&rig, &unknowns, &self.data, 1)
    }

    /// The problem with the right model, or the wrong one.
    pub fn problem(&mut self, right: bool) -> IdentificationProblem {
        let (mut rig, mut unknowns) = (self.truth.scenario.clone(), self.unknowns.clone());
        let mut data = self.data.clone();
        if !right {
            let is_of = |one: &Value, key: &str| {
                one["pointer"].as_str().is_some_and(|pointer| pointer.contains(key))
            };
            match self.kind {
                "damping" => {
                    for interface in rig["interfaces"].as_array_mut().unwrap() {
                        interface.as_object_mut().unwrap().remove("damping");
                    }
                    unknowns.retain(|one| !is_of(one, "/interfaces"));
                }
                "pulse" => {
                    // A half sine of the same width at half of the peak.
                    let rise = rig["excitation"]["rise_s"].as_f64().unwrap();
                    let peak = rig["excitation"]["peak_n"].clone();
                    let duration = GAMMA_WIDTH * rise * 1.5;
                    rig["excitation"] =
                        json!({"kind": "half_sine", "peak_n": peak, "duration_s": duration});
                }
                "mass" => {
                    let mass = rig["bodies"][0]["mass_kg"].as_f64().unwrap();
                    let sign = if self.noise.uniform() < 0.5 { -1.0 } else { 1.0 };
                    rig["bodies"][0]["mass_kg"] = json!(mass * (1.0 + 0.05 * sign));
                }
                "support" => rig["support"] = json!({"kind": "rigid"}),
                "friction" => {
                    rig["bodies"][0].as_object_mut().unwrap().remove("friction");
                    unknowns.retain(|one| !is_of(one, "/bodies"));
                }
                _ => {
                    for one in data.as_array_mut().unwrap() {
                        let table = one.get_mut("file").and_then(Value::as_object_mut);
                        for (_, column) in
                            table.into_iter().flatten().filter(|(key, _)| *key != "frequency_hz")
                        {
                            for number in column.as_array_mut().unwrap() {
                                *number = json!(-number.as_f64().unwrap());
                            }
                        }
                    }
                }
            }
        }
        problem(&rig, &unknowns, &data, 2)
    }
}

/// Hits of peaks in a range \[N\] on a rig near a natural frequency \[Hz\], and their data as measured: features of
/// hits, and receptances of others.
fn measured(
    document: Document,
    kind: &str,
    [least, most]: [f64; 2],
    natural: f64,
    mut sensors: Sensors,
) -> (Truth, Value) {
    let peak = |i: usize, count: usize| least + (most - least) * i as f64 / (count - 1) as f64;
    let of_receptances: Vec<f64> = (0..RECEPTANCES).map(|i| peak(i, RECEPTANCES)).collect();
    let mut peaks: Vec<f64> = (0..HITS).map(|i| peak(i, HITS)).collect();
    peaks.extend(&of_receptances);
    let sample = document.value()["bodies"][1]["length_m"].as_f64().unwrap();
    let cell = format!("{}", sample / 24.0);
    let mut truth = Truth::of(document, &peaks, &[("/method/cell_m", cell.as_str())]);
    truth.near_hz = natural;
    truth.with_damping = true;
    if kind == "friction" {
        // Ends of slip at a step of 20 us move the frequency by 4e-4.
        truth.scenario["method"] = json!({"kind": "modal"});
    }
    let hits = truth.measured(&sensors);
    // An analysis of the signed response shows the fundamental where the receptance has its lines.
    let places: Vec<f64> = hits[..HITS]
        .iter()
        .filter_map(|hit| hit["features"]["fundamental.frequency_hz"]["value"].as_f64())
        .collect();
    truth.near_hz = places.iter().sum::<f64>() / places.len() as f64;
    let mut data = data(&hits[..HITS]);
    // Differences of the engines and of the analysis; those with friction are larger.
    let [frequency, receptance, ratio] =
        if kind == "friction" { [2e-4, 1e-3, 1e-2] } else { [2e-5, 3e-4, 5e-4] };
    data[0]["floor"] = json!({
        "fundamental.frequency_hz": {"relative": frequency},
        "fundamental.receptance_m_per_n": {"relative": receptance},
        "fundamental.damping_ratio": {"relative": ratio},
        "harmonic_ratio": {"relative": ratio},
    });
    for (number, force) in of_receptances.iter().enumerate() {
        sensors.seed += 1000;
        let (band, table, deviation) = truth.receptance(HITS + number, &sensors, LINES);
        data.as_array_mut().unwrap().push(json!({
            "kind": "frf", "name": format!("receptance {}", number + 1), "file": table,
            "band_hz": band, "hit": {"force_peak_n": sensors.force_gain * force},
            "spread": {"relative": receptance, "absolute": deviation},
        }));
    }
    (truth, data)
}

fn problem(rig: &Value, unknowns: &[Value], data: &Value, starts: usize) -> IdentificationProblem {
    let problem = json!({
        "schema": "asperity/identify/1",
        "scenario": rig,
        "unknowns": unknowns,
        "data": data,
        "starts": starts,
        "draws": 300,
    });
    let document = Document::parse(&problem.to_string(), "twin.json").unwrap();
    IdentificationProblem::of(document).unwrap()
}

/// Width at half of the peak of the gamma pulse of degree two, over its rise.
const GAMMA_WIDTH: f64 = 1.697;

/// A law of a family with this stiffness at rest: its points, its document, the unknowns of its form, and the
/// document from which they start.
fn true_law(
    family: &str,
    at_rest: f64,
    stiffness: f64,
    noise: &mut Noise,
) -> (Vec<(f64, f64)>, Value, Vec<Value>, Value) {
    let mut uniform = |low: f64, high: f64| low + (high - low) * noise.uniform();
    let exponent = uniform(0.2, 0.6);
    let coefficient = stiffness / at_rest.powf(exponent);
    let scalar = |key: &str, bounds: [f64; 2]| json!({"kind": "scalar", "pointer": format!("/laws/rough/{key}"), "bounds": bounds});
    let pressure = |i: usize| at_rest * 1e-2 * 1000.0_f64.powf(i as f64 / 160.0);
    let power = |p: f64| coefficient * p.powf(exponent);
    let about = json!({"kind": "power", "coefficient": 1.2 * stiffness / at_rest.powf(0.4), "exponent": 0.4});
    let numbers = vec![
        scalar("coefficient", [1e-3 * coefficient, 1e3 * coefficient]),
        scalar("exponent", [0.02, 1.2]),
    ];
    match family {
        "power" => {
            let written =
                json!({"kind": "power", "coefficient": coefficient, "exponent": exponent});
            (
                (0..=160).map(|i| (pressure(i), power(pressure(i)))).collect(),
                written,
                numbers,
                about,
            )
        }
        "modified power" => {
            // Knots below the power law, as the paper's.
            let transition = at_rest * uniform(1.2, 1.6);
            let bend = uniform(0.2, 0.8);
            let at = [0.0, uniform(0.15, 0.3), uniform(0.5, 0.7), uniform(0.9, 1.1)];
            let knot = |share: f64| {
                let p = share * at_rest;
                let lowered = (p.max(0.05 * at_rest) / transition).powf(bend);
                (p, power(p.max(0.05 * at_rest)) * lowered)
            };
            let knots: Vec<(f64, f64)> = at.into_iter().map(knot).collect();
            let law = asperity_law::ModifiedPower::new(coefficient, exponent, transition, &knots)
                .unwrap();
            let document = |factor: f64| {
                let knots: Vec<[f64; 2]> = knots.iter().map(|k| [k.0, factor * k.1]).collect();
                json!({"kind": "modified_power", "coefficient": coefficient * factor, "exponent": exponent,
                    "transition_pa": transition, "knots": knots})
            };
            let mut unknowns = vec![json!({"kind": "monotone_law", "law": "rough"})];
            unknowns.extend(numbers);
            let of =
                |i: usize| (pressure(i), asperity_law::ContactLaw::stiffness(&law, pressure(i)));
            ((0..=160).map(of).collect(), document(1.0), unknowns, document(1.1))
        }
        _ => {
            let family = laws::FAMILIES[1 + (5.0 * noise.uniform()) as usize];
            let points = laws::law(family, noise);
            // The points are those of the paper's rig.
            let last = points.last().unwrap().0;
            let reference = points.iter().find(|point| point.0 >= 1.41e5).unwrap().1;
            let scaled =
                |p: &(f64, f64)| (p.0 * 10.0 * at_rest / last, p.1 * stiffness / reference);
            let points: Vec<(f64, f64)> = points.iter().map(scaled).collect();
            let written = laws::written(&points);
            (points, written, vec![json!({"kind": "free_law", "law": "rough"})], about)
        }
    }
}
