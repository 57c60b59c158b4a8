//! Twin experiments: hits simulated by finite differences, with the noise and the gain errors of
//! sensors, analysed as measured ones are, and identified by the other engine.

use std::fmt::Write as _;

use asperity_identify::IdentificationProblem;
use asperity_scenario::Document;
use asperity_signal::{
    DecimationFilter, FrfAverage, FundamentalSearch, HammerOptions, HitLength, HitOptions,
    HitRecord, ResponseKind, TriggerLevel, analyse_hit, transform_pair_at,
};
use asperity_simulation::run::simulate;
use serde_json::{Value, json};

/// Time before the hit \[s\].
const BEFORE_S: f64 = 5e-3;

/// Samples of a simulated motion in one of a record, whose filter removes what would alias, as the filter of a recorder
/// does: high modes of stiff bodies ring above half the sample rate, and one of them may alias onto the second harmonic.
const OVERSAMPLING: f64 = 4.0;

/// Share of the sample rate of a record up to which its filter passes all.
const BAND: f64 = 0.22;

/// A change by which simulated frequencies are right to 6e-6 instead of 2e-5: hits share this error, so that
/// it is not to be seen beside the mean of their noise.
#[allow(dead_code, reason = "used by the examples")]
pub const FINE_CELL: (&str, &str) = ("/method/cell_m", "0.00025");

/// Least amplitude of a backbone over its first: a rig with friction soon comes to rest, and a model with
/// more of it has no prediction further down.
const LEAST_AMPLITUDE: f64 = 0.1;

/// Columns of a table of backbones.
const BACKBONE_HEADER: &str = "index,amplitude_m,frequency_hz,damping_ratio,frequency_uncertainty_hz,damping_ratio_uncertainty\n";

/// True where larger problems are asked for, as every night: the variable `ASPERITY_LONG` is set.
#[allow(dead_code, reason = "used by the tests with long and short problems")]
pub fn is_long() -> bool {
    std::env::var_os("ASPERITY_LONG").is_some()
}

/// Responses of a rig without measurement errors.
pub struct Truth {
    /// The scenario with the modal engine.
    pub scenario: Value,
    /// Frequency about which the analysis looks for the fundamental \[Hz\].
    pub near_hz: f64,
    /// True if the features have a damping ratio.
    pub with_damping: bool,
    rate: f64,
    hits: Vec<(f64, Vec<f64>, Vec<f64>)>,
}

/// Noise and gains of the sensors.
#[derive(Debug, Clone, Copy)]
pub struct Sensors {
    /// Power of each channel over the record, over that of its white noise \[dB\].
    pub signal_to_noise_db: f64,
    /// Measured over true value.
    pub force_gain: f64,
    /// The same of the response.
    pub response_gain: f64,
    /// Seed of the noise.
    pub seed: u64,
}

impl Truth {
    /// Hits on the `scenario` with these peaks \[N\], by finite differences, after these changes.
    pub fn new(scenario: &str, peaks: &[f64], changes: &[(&str, &str)]) -> Self {
        Self::of(Document::read(scenario).unwrap(), peaks, changes)
    }

    /// Hits on the scenario of a document.
    pub fn of(mut document: Document, peaks: &[f64], changes: &[(&str, &str)]) -> Self {
        let method = r#"{"kind": "finite_difference", "cell_m": 0.001}"#;
        document.set("/method", method).unwrap();
        for (pointer, value) in changes {
            document.set(pointer, value).unwrap();
        }
        let rate = document.value()["output_rate_hz"].as_f64().unwrap();
        document.set("/output_rate_hz", &(OVERSAMPLING * rate).to_string()).unwrap();
        let filter = DecimationFilter::keeping(OVERSAMPLING * rate, BAND * rate);
        assert_eq!(filter.factor() as f64, OVERSAMPLING);
        let hits = peaks.iter().map(|peak| {
            document.set("/excitation/peak_n", &peak.to_string()).unwrap();
            let typed = document.scenario().unwrap();
            let history = simulate(&document, &typed).unwrap().transient.history;
            let sampled = |signal: &[f64]| filter.apply(signal, &(0..signal.len()));
            (*peak, sampled(&history.load), sampled(&history.sensors[0].acceleration))
        });
        let hits = hits.collect();
        document.set("/output_rate_hz", &rate.to_string()).unwrap();
        let method = r#"{"kind": "modal", "step_s": 2e-5}"#;
        document.set("/method", method).unwrap();
        let scenario = document.value().clone();
        Self { scenario, near_hz: 850.0, with_damping: false, rate, hits }
    }

    /// The features of the hits as `sensors` measure them, one JSON object a hit.
    pub fn measured(&self, sensors: &Sensors) -> Vec<Value> {
        self.measured_with_backbones(sensors).0
    }

    /// The features, and the backbones of the hits as a table, numbered from 1.
    pub fn measured_with_backbones(&self, sensors: &Sensors) -> (Vec<Value>, String) {
        let mut table = String::from(BACKBONE_HEADER);
        let mut noise = Noise::new(sensors.seed);
        let before = (BEFORE_S * self.rate) as usize;
        let mut options = HammerOptions::new(
            HitOptions {
                trigger_level: TriggerLevel::Automatic,
                pre_trigger: before,
                length: HitLength::Samples(1),
                hold_off: before + 1,
            },
            ResponseKind::Acceleration,
            FundamentalSearch::Frequency(self.near_hz),
        );
        options.windows.force_s = Some((2e-3, 1e-3));
        options.windows.until_noise = true;
        let one = |(place, (_, force, response)): (usize, &(f64, Vec<f64>, Vec<f64>))| {
            let mut shown = |signal: &[f64], gain: f64| -> Vec<f64> {
                let power = signal.iter().map(|x| x * x).sum::<f64>() / signal.len() as f64;
                let deviation = power.sqrt() * 10.0_f64.powf(-sensors.signal_to_noise_db / 20.0);
                let silence = std::iter::repeat_n(0.0, before);
                let signal = silence.chain(signal.iter().copied());
                signal.map(|x| gain * (x + deviation * noise.normal())).collect()
            };
            let force = shown(force, sensors.force_gain);
            let response = shown(response, sensors.response_gain);
            let mut average =
                FrfAverage::new(force.len(), self.rate, ResponseKind::Acceleration, 1).unwrap();
            let hit = HitRecord {
                start: 0,
                trigger: before + 2,
                force,
                responses: vec![response],
                sample_rate_hz: self.rate,
                missing: 0,
            };
            let found = analyse_hit(hit, &options, &mut average);
            let features = found.features.expect("a good hit");
            let number = |value: f64, deviation: f64| json!({"value": value, "standard_deviation": deviation});
            let backbone = features.backbone.as_ref().expect("a decay");
            let largest = backbone.points.first().map_or(0.0, |point| point.amplitude);
            let least = LEAST_AMPLITUDE * largest;
            let points = backbone.points.iter().zip(&features.backbone_uncertainty);
            for (point, sigma) in points.take_while(|(point, _)| point.amplitude > least) {
                let omega = std::f64::consts::TAU * point.frequency_hz;
                let row = [
                    point.amplitude / omega.powi(2),
                    point.frequency_hz,
                    point.damping_ratio,
                    sigma.frequency_hz,
                    sigma.damping_ratio,
                ];
                let row = row.map(|value| format!("{value:e}")).join(",");
                let _ = writeln!(table, "{},{row}", place + 1);
            }
            let first = features.harmonics.fundamental.unwrap();
            let sigma = features.fundamental_uncertainty.unwrap();
            let mut measured = json!({
                "fundamental.frequency_hz": number(first.frequency_hz, sigma.frequency_hz),
                "fundamental.receptance_m_per_n": number(first.magnitude, sigma.magnitude),
            });
            let ratio = (features.mode.damping.half_power, features.mode_uncertainty.half_power);
            if let (true, (Some(ratio), Some(deviation))) = (self.with_damping, ratio) {
                measured["fundamental.damping_ratio"] = number(ratio, deviation);
            }
            // The frequency of the second harmonic is left out: on so flat a peak noise moves it two
            // to three times as far as its linear uncertainty says.
            if let (Some(ratio), Some(deviation)) =
                (features.harmonics.ratio(), features.ratio_uncertainty)
            {
                measured["harmonic_ratio"] = number(ratio, deviation);
            }
            json!({"force_peak_n": found.pulse.unwrap().refined_peak_n, "features": measured})
        };
        let measured = self.hits.iter().enumerate().map(one).collect();
        (measured, table)
    }

    /// The receptance of the hit at `place` as `sensors` measure it, at `lines` frequencies, all of those that
    /// the length of the record tells apart within a width of the resonance: the band \[Hz\], the columns of a
    /// table, and the standard deviation of a part \[m/N\].
    #[allow(dead_code, reason = "used by the twins of judgements")]
    pub fn receptance(
        &self,
        place: usize,
        sensors: &Sensors,
        lines: usize,
    ) -> ([f64; 2], Value, f64) {
        let (_, force, response) = &self.hits[place];
        let (count, rate) = (force.len() as f64, self.rate);
        let spacing = rate / count;
        let first = (self.near_hz / spacing).round() - (lines / 2) as f64;
        let mut noise = Noise::new(sensors.seed);
        let ratio = 10.0_f64.powf(-sensors.signal_to_noise_db / 20.0);
        let rms = |signal: &[f64]| (signal.iter().map(|x| x * x).sum::<f64>() / count).sqrt();
        // Noise of a pulse so short is one complex factor of all lines, which their own deviations do not state:
        // the force has none.
        let force: Vec<f64> = force.iter().map(|f| sensors.force_gain * f).collect();
        let deviation_of_response = ratio * rms(response);
        let noisy = |x: &f64| sensors.response_gain * (x + deviation_of_response * noise.normal());
        let response: Vec<f64> = response.iter().map(noisy).collect();
        // Each part of the transform of white noise of this deviation, with the least force of the lines.
        let part = deviation_of_response * (0.5 * count).sqrt() / rate;
        let (mut columns, mut deviation) = ([const { Vec::new() }; 3], 0.0_f64);
        for line in 0..lines {
            let frequency = (first + line as f64) * spacing;
            let (x, f) = transform_pair_at(&response, &force, rate, frequency);
            let squared = (std::f64::consts::TAU * frequency).powi(2);
            let value = x / f / -squared;
            columns[0].push(frequency);
            columns[1].push(value.re);
            columns[2].push(value.im);
            deviation = deviation.max(part * sensors.response_gain.abs() / (squared * f.norm()));
        }
        let band = [columns[0][0] - 0.5 * spacing, columns[0][lines - 1] + 0.5 * spacing];
        let [frequency, real, imag] = columns;
        (band, json!({"frequency_hz": frequency, "real": real, "imag": imag}), deviation)
    }

    /// The problem of identifying `unknowns` from measured `hits`, with `more` keys.
    pub fn problem(&self, hits: &[Value], unknowns: &Value, more: &Value) -> IdentificationProblem {
        let mut problem = json!({
            "schema": "asperity/identify/1",
            "scenario": self.scenario,
            "unknowns": unknowns,
            "data": data(hits),
        });
        for (key, value) in more.as_object().into_iter().flatten() {
            problem[key] = value.clone();
        }
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/twin.json");
        IdentificationProblem::of(Document::parse(&problem.to_string(), folder).unwrap()).unwrap()
    }
}

/// The data of a problem: measured `hits`.
pub fn data(hits: &[Value]) -> Value {
    json!([{
        "kind": "hits",
        "name": "twin",
        // Difference of the engines, and of the analysis of a noisy record.
        "floor": {
            "fundamental.frequency_hz": {"relative": 5e-5},
            "fundamental.receptance_m_per_n": {"relative": 1e-3},
            "harmonic_ratio": {"relative": 1e-3},
        },
        "hits": hits,
    }])
}

/// Normal random numbers: `SplitMix64` and the method of Box and Muller.
pub struct Noise {
    state: u64,
    spare: Option<f64>,
}

impl Noise {
    pub fn new(seed: u64) -> Self {
        Self { state: seed.wrapping_mul(0x9e37_79b9_7f4a_7c15), spare: None }
    }

    pub fn uniform(&mut self) -> f64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub fn normal(&mut self) -> f64 {
        if let Some(spare) = self.spare.take() {
            return spare;
        }
        let radius = (-2.0 * (1.0 - self.uniform()).ln()).sqrt();
        let angle = std::f64::consts::TAU * self.uniform();
        self.spare = Some(radius * angle.sin());
        radius * angle.cos()
    }
}
