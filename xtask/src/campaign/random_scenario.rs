//! Random but sensible scenarios: a seed and a number determine one, whatever else is computed.
//!
//! Stacks of one to five bodies of engineering materials, centimetres to a metre long, under their
//! weight; contacts of all laws, with a stiffness at rest that puts the bodies above one on a
//! spring of 50 Hz to 16 kHz; a force from a small part of the weight to many times it.

use std::path::Path;

use anyhow::{Result, bail};
use asperity_dynamics::{FiniteDifference, Integrator};
use asperity_law::{Draw as _, LawRef, LawSpec, Laws, rounded};
use asperity_scenario::{
    AccelerationSpec, Along, BodySpec, Damping, DampingSpec, End, ExcitationSpec, InterfaceSpec,
    LoadSamples, MethodSpec, PlaceSpec, Scenario, SchemaId, SectionSpec, SensorKind, SensorSpec,
    SupportSpec,
};
use asperity_simulation::assemble::Assembly;

use super::draw::Draw;

/// Young's moduli \[Pa\] and densities \[kg/m³\] of steel, aluminium, titanium, brass, grey iron,
/// alumina, glass, granite, acrylic glass, polyethylene.
const MATERIALS: [(f64, f64); 10] = [
    (210e9, 7850.0),
    (71e9, 2710.0),
    (114e9, 4430.0),
    (100e9, 8500.0),
    (110e9, 7200.0),
    (370e9, 3900.0),
    (70e9, 2500.0),
    (50e9, 2650.0),
    (3e9, 1190.0),
    (1e9, 950.0),
];

/// Most node updates of a run by finite differences with their defaults: a second or less.
const MOST_NODE_STEPS: f64 = 5e8;

/// Most samples of the output.
const MOST_SAMPLES: f64 = 4e5;

/// Fewest periods of the lowest mode in a run.
const FEWEST_PERIODS: f64 = 12.0;

/// Most stacks that are drawn until one meets the limits of cost.
const MOST_ATTEMPTS: u64 = 200;

/// A scenario, and the samples file it names.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct RandomScenario {
    /// The scenario, without a method.
    pub(super) scenario: Scenario,
    /// Measured force, for the file that the excitation names.
    pub(super) samples: Option<LoadSamples>,
}

impl RandomScenario {
    /// The scenario of this number in a campaign with this seed.
    ///
    /// # Errors
    /// If none of many draws has a natural frequency and meets the limits of cost.
    pub(super) fn new(seed: u64, number: u64) -> Result<Self> {
        for attempt in 0..MOST_ATTEMPTS {
            let mut draw = Draw::new(seed, number, attempt);
            if let Some(mut found) = attempt_one(&mut draw, seed, number) {
                // A sequence of its own: the rest of the scenario does not depend on it.
                places(&mut Draw::new(seed, number, MOST_ATTEMPTS), &mut found.scenario);
                return Ok(found);
            }
        }
        bail!("seed {seed} has no scenario {number} within the limits of cost")
    }
}

fn attempt_one(draw: &mut Draw, seed: u64, number: u64) -> Option<RandomScenario> {
    let mut scenario = stack(draw, seed, number);
    // The structure at rest gives the time scale; no samples file is read for it.
    let natural = Assembly::new(&scenario, Path::new("")).ok()?.structure.natural_frequency()?;
    let ratio = if let DampingSpec::MassProportional(Damping::Ratio(ratio)) = scenario.damping {
        ratio
    } else {
        let ratio = draw.log_uniform(1e-3, 0.1);
        let rate = rounded(2.0 * ratio * std::f64::consts::TAU * natural);
        scenario.damping = DampingSpec::MassProportional(Damping::Rate(rate));
        ratio
    };
    let period = 1.0 / natural;
    let (excitation, samples, pulse) = excitation(draw, &scenario, period, seed, number);
    // Free vibration falls by a factor of 500 in 1/ratio periods.
    let periods = (draw.uniform(0.4, 1.2) / ratio).clamp(FEWEST_PERIODS, 120.0);
    scenario.output_rate_hz = output_rate(draw, natural);
    scenario.duration_s = rounded(pulse + periods * period);
    // Within the limits of cost the run is shortened to the fewest periods at most.
    let shortest = rounded(pulse + FEWEST_PERIODS * period);
    let fraction = (MOST_NODE_STEPS / node_steps(&scenario)?)
        .min(MOST_SAMPLES / (scenario.duration_s * scenario.output_rate_hz));
    if fraction < 1.0 {
        scenario.duration_s = rounded(scenario.duration_s * fraction);
    }
    scenario.excitation = excitation;
    (scenario.duration_s >= shortest).then_some(RandomScenario { scenario, samples })
}

/// Places of the force and of sensors, and a moving base in place of some pulses.
fn places(draw: &mut Draw, scenario: &mut Scenario) {
    let bodies = scenario.bodies.clone();
    let place = |draw: &mut Draw| {
        let body = draw.one_of(&bodies);
        let along = match draw.weighted(&[1.0, 1.0, 3.0]) {
            0 => Along::End(End::Upper),
            1 => Along::End(End::Lower),
            _ => Along::PositionM(rounded(body.length_m * draw.uniform(0.02, 0.98))),
        };
        PlaceSpec { body: body.name.clone(), along }
    };
    if draw.chance(0.4) {
        let sensor = SensorSpec {
            name: "sensor".to_owned(),
            at: Some(place(draw)),
            kind: SensorKind::Acceleration,
        };
        scenario.sensors.push(sensor);
    }
    let weight: f64 = bodies.iter().map(mass).sum();
    let moves = draw.chance(0.15);
    let acceleration = match &mut scenario.excitation {
        ExcitationSpec::GammaPulse { peak_n, rise_s, .. } if moves => {
            let (peak_m_per_s2, rise_s) = (rounded(*peak_n / weight), *rise_s);
            AccelerationSpec::GammaPulse { peak_m_per_s2, rise_s }
        }
        ExcitationSpec::Haversine { peak_n, duration_s, .. } if moves => {
            let (peak_m_per_s2, duration_s) = (rounded(*peak_n / weight), *duration_s);
            AccelerationSpec::Haversine { peak_m_per_s2, duration_s }
        }
        ExcitationSpec::GammaPulse { at, .. }
        | ExcitationSpec::HalfSine { at, .. }
        | ExcitationSpec::Haversine { at, .. }
        | ExcitationSpec::Harmonic { at, .. }
        | ExcitationSpec::Samples { at, .. } => {
            if draw.chance(0.4) {
                *at = Some(place(draw));
            }
            return;
        }
        ExcitationSpec::None | ExcitationSpec::BaseMotion { .. } => return,
    };
    scenario.excitation = ExcitationSpec::BaseMotion {
        acceleration: Some(acceleration),
        velocity: None,
        displacement: None,
        direction: None,
    };
}

/// Node updates of a run by finite differences with their defaults.
fn node_steps(scenario: &Scenario) -> Option<f64> {
    let unloaded = Scenario { excitation: ExcitationSpec::None, ..scenario.clone() };
    let Assembly { structure, load, sampling, .. } =
        Assembly::new(&unloaded, Path::new("")).ok()?;
    let method = Integrator::from(FiniteDifference::default());
    let outline = method.outline(&structure, &load, &sampling).ok()?;
    Some(outline.unknowns as f64 * outline.steps as f64)
}

/// A law of any kind with about `stiffness` \[Pa/m\] at `pressure` \[Pa\]. One in ten of the drawn laws
/// of Persson is kept: finite differences evaluate such a law by quadrature in every step.
fn law(draw: &mut Draw, pressure: f64, stiffness: f64) -> LawSpec {
    loop {
        let law = LawSpec::sample(draw, pressure, stiffness, 2);
        if !has_quadrature(&law) || draw.chance(0.1) {
            return law;
        }
    }
}

pub(super) fn has_quadrature(law: &LawSpec) -> bool {
    matches!(law, LawSpec::Persson(_))
        || law.inner_laws().any(|inner| match inner {
            LawRef::InPlace(law) => has_quadrature(law),
            LawRef::Named(_) => false,
        })
}

/// Bodies, contacts, support and damping, without a force.
fn stack(draw: &mut Draw, seed: u64, number: u64) -> Scenario {
    let gravity = if draw.chance(0.6) { 9.81 } else { draw.uniform(1.0, 20.0) };
    let count = draw.whole(1..=5);
    let bodies: Vec<BodySpec> = (0..count).map(|at| body(draw, at)).collect();
    let areas: Vec<f64> = bodies.iter().map(area).collect();
    let masses: Vec<f64> = bodies.iter().map(mass).collect();
    let mut laws = Laws::default();
    let mut interfaces = Vec::with_capacity(count);
    let mut above = 0.0;
    for at in 0..count {
        above += masses[at];
        let narrower = areas[at].min(areas.get(at + 1).copied().unwrap_or(f64::INFINITY));
        let area_m2 = rounded(narrower * draw.uniform(0.1, 1.0));
        let pressure = above * gravity / area_m2;
        let angular_frequency = std::f64::consts::TAU * draw.log_uniform(50.0, 16e3);
        let stiffness = angular_frequency.powi(2) * above / area_m2;
        let law = law(draw, pressure, stiffness);
        let law = if draw.chance(0.3) {
            let name = format!("law {at}");
            laws.insert(&name, law);
            LawRef::Named(name)
        } else {
            law.into()
        };
        interfaces.push(InterfaceSpec {
            name: format!("contact {at}"),
            area_m2,
            law,
            damping: None,
            friction: None,
        });
    }
    let support = if draw.chance(0.5) {
        SupportSpec::Rigid
    } else {
        let mass_kg = rounded(above * draw.log_uniform(0.05, 20.0));
        let angular_frequency = std::f64::consts::TAU * draw.log_uniform(50.0, 1e4);
        SupportSpec::SpringMass {
            stiffness_n_per_m: rounded(angular_frequency.powi(2) * (above + mass_kg)),
            mass_kg,
            damping_ratio: if draw.chance(0.1) { 0.0 } else { draw.log_uniform(1e-3, 0.1) },
        }
    };
    let amount = if draw.chance(0.8) {
        Damping::Ratio(draw.log_uniform(1e-3, 0.1))
    } else {
        Damping::Rate(0.0)
    };
    Scenario {
        schema: SchemaId::V1,
        title: Some(format!("campaign, seed {seed}, scenario {number}")),
        gravity_m_per_s2: gravity,
        bodies,
        support,
        interfaces,
        laws,
        damping: DampingSpec::MassProportional(amount),
        excitation: ExcitationSpec::None,
        sensors: Vec::new(),
        duration_s: 1.0,
        output_rate_hz: 1e4,
        method: MethodSpec::default(),
    }
}

fn body(draw: &mut Draw, at: usize) -> BodySpec {
    let &(youngs_modulus_pa, density_kg_per_m3) = draw.one_of(&MATERIALS);
    let length_m = draw.log_uniform(0.008, 1.0);
    let area = draw.log_uniform(1e-5, 5e-3);
    let section = if draw.chance(0.5) {
        SectionSpec::AreaM2(area)
    } else {
        SectionSpec::MassKg(rounded(density_kg_per_m3 * area * length_m))
    };
    BodySpec {
        name: format!("body {at}"),
        length_m,
        section,
        youngs_modulus_pa,
        density_kg_per_m3,
        friction: None,
    }
}

fn area(body: &BodySpec) -> f64 {
    match body.section {
        SectionSpec::AreaM2(area) => area,
        SectionSpec::MassKg(mass) => mass / (body.density_kg_per_m3 * body.length_m),
    }
}

fn mass(body: &BodySpec) -> f64 {
    match body.section {
        SectionSpec::AreaM2(area) => area * body.density_kg_per_m3 * body.length_m,
        SectionSpec::MassKg(mass) => mass,
    }
}

fn output_rate(draw: &mut Draw, natural: f64) -> f64 {
    const RATES: [f64; 7] = [5e3, 1e4, 2e4, 5e4, 1e5, 2e5, 4e5];
    let needed = 40.0 * natural;
    let lowest = RATES.iter().position(|&rate| rate >= needed).unwrap_or(RATES.len() - 1);
    RATES[(lowest + draw.whole(0..=2)).min(RATES.len() - 1)]
}

/// A force, the samples it is read from, and the time for which it acts \[s\].
fn excitation(
    draw: &mut Draw,
    scenario: &Scenario,
    period: f64,
    seed: u64,
    number: u64,
) -> (ExcitationSpec, Option<LoadSamples>, f64) {
    let weights: Vec<f64> =
        scenario.bodies.iter().map(|body| scenario.gravity_m_per_s2 * mass(body)).collect();
    let (top, all) = (weights[0], weights.iter().sum::<f64>());
    // Between the weights of the upper body and of the stack.
    let weight = top * (all / top).powf(draw.uniform(0.0, 1.0));
    let sign = if draw.chance(0.25) { -1.0 } else { 1.0 };
    let peak_n = rounded(sign * weight * draw.log_uniform(3e-4, 20.0));
    let duration_s = rounded(period * draw.log_uniform(0.15, 2.5));
    match draw.weighted(&[3.0, 2.0, 1.5, 1.5, 1.5]) {
        0 => {
            let rise_s = rounded(0.3 * duration_s);
            (ExcitationSpec::GammaPulse { peak_n, rise_s, at: None }, None, 8.0 * rise_s)
        }
        1 => (ExcitationSpec::HalfSine { peak_n, duration_s, at: None }, None, duration_s),
        2 => (ExcitationSpec::Haversine { peak_n, duration_s, at: None }, None, duration_s),
        3 => {
            let samples = measured_pulse(draw, peak_n, duration_s);
            let end = samples.time_s.last().copied().unwrap_or(duration_s);
            let peak_n = draw.chance(0.5).then_some(peak_n);
            let file = Some(format!("seed{seed}-{number}.csv"));
            (ExcitationSpec::Samples { file, points: None, peak_n, at: None }, Some(samples), end)
        }
        _ => {
            let amplitude_n = rounded(weight * draw.log_uniform(1e-4, 0.5));
            let frequency_hz = rounded(draw.log_uniform(0.3, 2.2) / period);
            (ExcitationSpec::Harmonic { amplitude_n, frequency_hz, at: None }, None, 0.0)
        }
    }
}

/// A pulse as a hammer and a data logger give it: sampled, uneven, with noise and, at times, a
/// second impact.
fn measured_pulse(draw: &mut Draw, peak_n: f64, duration_s: f64) -> LoadSamples {
    let count = draw.whole(24..=200);
    let skew = draw.uniform(0.7, 1.4);
    let noise = draw.log_uniform(1e-5, 5e-3);
    let second = draw.chance(0.2).then(|| (draw.uniform(0.1, 0.5), draw.uniform(1.2, 2.0)));
    let span = second.map_or(1.3, |(_, delay)| delay + 1.1);
    let pulse = |x: f64| {
        if (0.0..1.0).contains(&x) {
            (std::f64::consts::PI * x.powf(skew)).sin().powf(1.5)
        } else {
            0.0
        }
    };
    let mut time_s = Vec::with_capacity(count);
    let mut force_n = Vec::with_capacity(count);
    for at in 0..count {
        let x = span * at as f64 / (count - 1) as f64;
        let shape = pulse(x) + second.map_or(0.0, |(height, delay)| height * pulse(x - delay));
        let ends = at == 0 || at == count - 1;
        let scatter = if ends { 0.0 } else { noise * draw.uniform(-1.0, 1.0) };
        time_s.push(x * duration_s);
        force_n.push(rounded(peak_n * (shape + scatter)));
    }
    LoadSamples { time_s, values: force_n }
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_law::Sampler;
    use asperity_scenario::Document;

    #[test]
    fn a_seed_and_a_number_determine_a_valid_scenario() {
        for number in 0..40 {
            let random = RandomScenario::new(7, number).unwrap();
            assert_eq!(random, RandomScenario::new(7, number).unwrap());
            let text = serde_json::to_string(&random.scenario).unwrap();
            let document = Document::parse(&text, "random.json").unwrap();
            // A samples file is written beside the scenario by the campaign.
            if random.samples.is_none() {
                assert_eq!(document.scenario().unwrap(), random.scenario);
            }
        }
        assert_ne!(RandomScenario::new(7, 0).unwrap(), RandomScenario::new(8, 0).unwrap());
    }

    #[test]
    fn all_kinds_of_laws_supports_and_forces_are_drawn() {
        let text: String = (0..300)
            .map(|number| RandomScenario::new(1, number).unwrap().scenario)
            .map(|scenario| serde_json::to_string(&scenario).unwrap())
            .collect();
        let law_kind = |sample: &Sampler| {
            let law = sample(&mut Draw::new(1, 0, 0), 1e5, 1e12);
            serde_json::to_value(law).unwrap()["kind"].as_str().unwrap().to_owned()
        };
        let laws: Vec<String> = LawSpec::SAMPLERS.iter().map(law_kind).collect();
        let others = [
            "in_series",
            "rigid",
            "spring_mass",
            "gamma_pulse",
            "half_sine",
            "haversine",
            "samples",
            "harmonic",
        ];
        for kind in others.into_iter().chain(laws.iter().map(String::as_str)) {
            assert!(text.contains(&format!("\"kind\":\"{kind}\"")), "{kind}");
        }
        assert!(text.contains("rate_per_s") && text.contains("mass_kg"));
    }
}
