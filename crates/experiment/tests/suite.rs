//! Analysis of files in blocks, compared with that of whole records.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::f64::consts::{PI, TAU};
use std::path::PathBuf;

use asperity_experiment::{
    Analysis, AnalysisError, AnalysisOptions, DecayOptions, FrequencyBand, ResponseAnalysis,
    ResponseChoice, analyse, analyse_decays, analyse_sources,
};
use asperity_measure::{
    Abscissa, Channel, ChannelQuantity, ChannelUnit, Format, MeasurementSource, Origin,
    ReadOptions, Record, Samples, WriteOptions, write,
};
use asperity_signal::{
    FrfForm, FundamentalSearch, HammerOptions, HarmonicOptions, HitLength, HitOptions,
    ResponseKind, TriggerLevel, hammer_test,
};
use tempfile::TempDir;

const RATE: f64 = 10_000.0;
const BAND: FrequencyBand = FrequencyBand { low_hz: 250.0, high_hz: 350.0 };

/// Mode at 300 Hz, hit every half second with increasing force.
fn hit_mode(hits: usize) -> (Vec<f64>, Vec<f64>) {
    let (omega, damping, step) = (TAU * 300.0, 0.01, 1.0 / RATE);
    let (mut u, mut v) = (0.0, 0.0);
    let sample = |n: usize| {
        let t = n as f64 * step;
        let since = t % 0.5 - 0.02;
        let peak = 5.0 + (t / 0.5).floor();
        let f = if (0.0..2e-3).contains(&since) { peak * (PI * since / 2e-3).sin() } else { 0.0 };
        let a = f - 2.0 * damping * omega * v - omega * omega * u;
        v += a * step;
        u += v * step;
        (f, a)
    };
    (0..(hits as f64 * 0.5 * RATE) as usize).map(sample).unzip()
}

fn record(force: &[f64], response: &[f64]) -> Record {
    let channel = |name: &str, unit: &str, samples: &[f64]| Channel {
        name: name.to_owned(),
        quantity: ChannelQuantity::Unknown,
        unit: ChannelUnit::of_text(unit),
        abscissa: Abscissa::even_time(0.0, RATE),
        samples: Samples::Real(samples.to_vec()),
        origin: Origin::default(),
    };
    let channels = vec![channel("force", "N", force), channel("acc", "m/s^2", response)];
    Record { channels, ..Record::default() }
}

fn store(folder: &TempDir, name: &str, force: &[f64], response: &[f64]) -> PathBuf {
    let path = folder.path().join(name);
    let options = WriteOptions::default();
    write(&path, &[record(force, response)], Format::UniversalBinary, &options).unwrap();
    path
}

/// The only response of an analysis.
fn only(analysis: Analysis) -> ResponseAnalysis {
    let [only] = <[ResponseAnalysis; 1]>::try_from(analysis.responses).unwrap();
    only
}

fn analysed(path: &PathBuf, block: usize) -> ResponseAnalysis {
    let reading = ReadOptions { block, ..ReadOptions::default() };
    let options = AnalysisOptions {
        reading,
        band_hz: Some(BAND),
        trigger_level_n: Some(1.0),
        hit_length_s: Some(0.48),
        pre_trigger_s: 0.01,
        ..AnalysisOptions::default()
    };
    only(analyse(std::slice::from_ref(path), &options).unwrap())
}

/// Verified against [`hammer_test`] on the whole record: each hit has the same numbers to the last
/// bit for any size of the blocks.
#[test]
fn blocks_and_the_whole_record_give_equal_results() {
    let folder = tempfile::tempdir().unwrap();
    let (force, response) = hit_mode(5);
    let path = store(&folder, "a.uff", &force, &response);
    let hits = HitOptions {
        trigger_level: TriggerLevel::Absolute(1.0),
        pre_trigger: 100,
        length: HitLength::UntilNext { limit: 4800 },
        hold_off: 2000,
    };
    let limits = (BAND.low_hz, BAND.high_hz);
    let reference = FundamentalSearch::Band(limits, FrfForm::Receptance);
    let mut options = HammerOptions::new(hits, ResponseKind::Acceleration, reference);
    options.harmonics =
        HarmonicOptions { fundamental_window: (0.97, 1.03), ..HarmonicOptions::default() };
    options.band_part = 50.0 / 300.0;
    let whole = hammer_test(&force, &response, RATE, &options).unwrap();
    for block in [313, 4096, 1 << 20] {
        let found = analysed(&path, block);
        assert_eq!(found.report.hits.len(), 5);
        for (hit, exact) in found.report.hits.iter().zip(&whole.hits) {
            let features = exact.features.as_ref().unwrap();
            let first = hit.fundamental.unwrap();
            assert_eq!(Some(first.frequency_hz), features.mode.frequency_hz);
            assert_eq!(Some(first.magnitude), features.mode.magnitude);
            assert_eq!(first.damping_ratio_decrement, features.mode.damping.decrement);
            assert_eq!(hit.impulse_ns, exact.pulse.map(|pulse| pulse.impulse_n_s));
            assert_eq!(hit.time_s, (exact.start + exact.trigger as u64) as f64 / RATE);
        }
        let coherence = whole.average.coherence().unwrap();
        let same = |(a, b): (&f64, &f64)| a == b || (a.is_nan() && b.is_nan());
        let found_coherence = found.average.coherence.unwrap();
        // Both averages have 4800 samples.
        assert!(found_coherence.iter().zip(&coherence.values).all(same));
    }
}

/// Records in memory have the numbers of the same samples in a file, for any size of the blocks, and
/// a hash by which records that are given twice are found.
#[test]
fn records_in_memory_equal_those_of_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let (force, response) = hit_mode(3);
    let file = MeasurementSource::from(store(&folder, "a.uff", &force, &response));
    let in_memory = |name: &str, scale: f64| {
        let force: Vec<f64> = force.iter().map(|x| scale * x).collect();
        MeasurementSource::Records { name: name.into(), records: vec![record(&force, &response)] }
    };
    let analysed = |sources: &[MeasurementSource], block: usize| {
        let reading = ReadOptions { block, ..ReadOptions::default() };
        let options = AnalysisOptions { reading, ..AnalysisOptions::default() };
        let passes = std::cell::Cell::new(0);
        let found = analyse_sources(sources, &options, &|done| passes.set(done)).unwrap();
        assert_eq!(passes.get(), 2 * sources.len());
        only(found)
    };
    let of_file = analysed(&[file], 1 << 16);
    for block in [313, 1 << 20] {
        let found = analysed(&[in_memory("arrays", 1.0)], block);
        let unnamed = |found: &ResponseAnalysis| {
            let mut hits = found.report.hits.clone();
            for hit in &mut hits {
                hit.file.clear();
            }
            hits
        };
        assert_eq!(unnamed(&found), unnamed(&of_file));
        // Text, in which lines without a value are equal.
        assert_eq!(found.frf_table().to_csv(), of_file.frf_table().to_csv());
        assert_eq!(found.backbones, of_file.backbones);
        let source = &found.report.provenance.files[0];
        assert_eq!((source.file.as_str(), source.format.as_str()), ("arrays", "memory"));
    }
    let twice = |other| {
        let found = analysed(&[in_memory("a", 1.0), other], 1 << 16);
        found.report.notices.iter().any(|notice| notice.contains("same bytes"))
    };
    assert!(twice(in_memory("b", 1.0)) && !twice(in_memory("b", 1.01)));
}

/// The trigger level and the hit length are found from the force.
#[test]
fn trigger_level_and_hit_length_are_found() {
    let folder = tempfile::tempdir().unwrap();
    let (force, response) = hit_mode(6);
    let path = store(&folder, "a.uff", &force, &response);
    let options = AnalysisOptions { band_hz: Some(BAND), ..AnalysisOptions::default() };
    let found = only(analyse(&[path.clone(), path], &options).unwrap());
    assert_eq!(found.report.hits.len(), 12);
    assert!((found.report.settings.hit_length_s - 0.5).abs() < 2e-3);
    assert!(found.report.settings.trigger_level_n < 5.0);
    let numbers: Vec<usize> = found.report.hits.iter().map(|hit| hit.index).collect();
    assert_eq!(numbers, (1..=12).collect::<Vec<_>>());
    assert_eq!(found.report.hits[6].record, 1, "records count in each file");
    assert_eq!(found.hits_table().to_csv().lines().count(), 13);
    let points: usize = found.backbones.iter().map(|backbone| backbone.points.len()).sum();
    assert_eq!(found.backbone_table().to_csv().lines().count(), points + 1);
    // Amplitudes are displacements: a pulse of 10 N and 2 ms moves 1 kg at 300 Hz by less than its
    // impulse over mass and angular frequency.
    let most = 10.0 * 2e-3 * 2.0 / PI / (TAU * 300.0);
    let amplitudes = found.backbones.iter().flat_map(|backbone| &backbone.points);
    assert!(amplitudes.clone().count() > 100);
    assert!(amplitudes.clone().all(|point| point.amplitude < most));
    assert!(amplitudes.clone().any(|point| point.amplitude > 0.05 * most));
}

/// Results are equal to the last bit on one thread and on several.
#[test]
fn an_analysis_does_not_depend_on_threads() {
    let folder = tempfile::tempdir().unwrap();
    let (force, response) = hit_mode(21);
    let path = store(&folder, "a.uff", &force, &response);
    // Compared as text, since a coherence may be NaN.
    let found = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| format!("{:?}", analysed(&path, 4096)))
    };
    let one = found(1);
    assert!(one.contains("index: 21"));
    assert!(one == found(2) && one == found(5));
}

/// An overload is excluded and reported; a test without any other hit is an error that names it.
#[test]
fn an_overload_is_excluded() {
    let folder = tempfile::tempdir().unwrap();
    let (force, mut response) = hit_mode(3);
    for a in &mut response[5000..10_000] {
        *a = a.clamp(-2.0, 2.0);
    }
    let path = store(&folder, "a.uff", &force, &response);
    let found = analysed(&path, 4096);
    assert_eq!(found.report.average.excluded, [2]);
    let hit = &found.report.hits[1];
    assert!(hit.overload && !hit.averaged && hit.fundamental.is_none());
    assert!(hit.issues[0].contains("overload"), "{:?}", hit.issues);

    for a in &mut response {
        *a = a.clamp(-1.0, 1.0);
    }
    let path = store(&folder, "b.uff", &force, &response);
    let error = analyse(&[path], &AnalysisOptions::default()).unwrap_err();
    assert!(matches!(error, AnalysisError::NoGoodHit { hits: 3, .. }), "{error}");
    assert!(!error.is_wrong_request());
}

/// Three modes of a free structure at three places: natural frequency \[Hz\], damping ratio, and the
/// modal constants \[1/kg\].
const MODES: [(f64, f64, [f64; 3]); 3] = [
    (300.0, 0.010, [1.2, -0.8, 0.3]),
    (520.0, 0.006, [0.5, 1.0, -0.9]),
    (760.0, 0.008, [-0.7, 0.4, 1.1]),
];

/// Accelerations of the structure at the three places under half-sine pulses of 0.4 ms, exactly
/// integrated between the samples of a force that is linear between them; three hits.
fn hit_structure() -> (Vec<f64>, [Vec<f64>; 3]) {
    let count = (3.0 * 0.9 * RATE) as usize;
    let force_at = |n: usize| {
        let t = n as f64 / RATE;
        let since = t % 0.9 - 0.02;
        let peak = 8.0 + 4.0 * (t / 0.9).floor();
        if (0.0..1e-3).contains(&since) { peak * (PI * since / 1e-3).sin() } else { 0.0 }
    };
    let force: Vec<f64> = (0..count).map(force_at).collect();
    let mut responses = [vec![0.0; count], vec![0.0; count], vec![0.0; count]];
    for (f0, zeta, constants) in MODES {
        let omega = TAU * f0;
        let steps = 64;
        let dt = 1.0 / RATE / f64::from(steps);
        let (mut u, mut v) = (0.0, 0.0);
        for n in 0..count {
            let a = force[n] - 2.0 * zeta * omega * v - omega * omega * u;
            for (response, constant) in responses.iter_mut().zip(constants) {
                response[n] += constant * a;
            }
            let next = force.get(n + 1).copied().unwrap_or(0.0);
            for k in 0..steps {
                // Velocity Verlet with implicit damping: second order at a 64th of the sample.
                let f = force[n] + (next - force[n]) * (f64::from(k) + 0.5) / f64::from(steps);
                let middle = u + 0.5 * dt * v;
                let d = zeta * omega * dt;
                v = (v * (1.0 - d) + dt * (f - omega * omega * middle)) / (1.0 + d);
                u = middle + 0.5 * dt * v;
            }
        }
    }
    (force, responses)
}

/// Against the exact modal parameters: three responses in one file, in the order asked for; one that is
/// dead is left out in words.
#[test]
fn the_modal_table_of_several_responses_is_exact() {
    let folder = tempfile::tempdir().unwrap();
    let (force, responses) = hit_structure();
    let channel = |name: &str, unit: &str, samples: &[f64]| Channel {
        name: name.to_owned(),
        quantity: ChannelQuantity::Unknown,
        unit: ChannelUnit::of_text(unit),
        abscissa: Abscissa::even_time(0.0, RATE),
        samples: Samples::Real(samples.to_vec()),
        origin: Origin::default(),
    };
    let dead = vec![0.0; force.len()];
    let channels = vec![
        channel("force", "N", &force),
        channel("a", "m/s^2", &responses[0]),
        channel("b", "g", &responses[1].iter().map(|a| a / 9.80665).collect::<Vec<_>>()),
        channel("dead", "m/s^2", &dead),
        channel("c", "m/s^2", &responses[2]),
    ];
    let path = folder.path().join("three.uff");
    let record = Record { channels, ..Record::default() };
    write(&path, &[record], Format::UniversalBinary, &WriteOptions::default()).unwrap();

    let options = |responses| AnalysisOptions {
        responses,
        band_hz: Some(FrequencyBand { low_hz: 200.0, high_hz: 900.0 }),
        keep_frfs: true,
        ..AnalysisOptions::default()
    };
    let ambiguous = analyse(std::slice::from_ref(&path), &options(ResponseChoice::Only));
    assert!(matches!(ambiguous, Err(AnalysisError::Ambiguous { .. })));
    let twice = options(ResponseChoice::of(&["a".into(), "#2".into()]));
    let twice = analyse(std::slice::from_ref(&path), &twice).unwrap_err();
    assert!(matches!(twice, AnalysisError::ChannelTwice { .. }), "{twice}");

    let all = options(ResponseChoice::of(&["all".into()]));
    let found = analyse(std::slice::from_ref(&path), &all).unwrap();
    let names: Vec<&str> = found.responses.iter().map(ResponseAnalysis::name).collect();
    assert_eq!(names, ["a", "b", "c"]);
    let notices = &found.responses[0].report.notices;
    assert!(notices.iter().any(|notice| notice.contains("dead is left out")), "{notices:?}");
    assert_eq!(found.responses[0].report.other_responses, ["b", "c"]);
    assert_eq!(found.modes.len(), 3);
    for (mode, (f0, zeta, constants)) in found.modes.iter().zip(MODES) {
        assert!((mode.natural_frequency_hz / f0 - 1.0).abs() < 2e-5, "{mode:?}");
        assert!((mode.damping_ratio / zeta - 1.0).abs() < 1e-2, "{mode:?}");
        assert_eq!(mode.responses.len(), 3);
        for (at, constant) in mode.responses.iter().zip(constants) {
            let [re, im] = at.modal_constant_per_kg;
            // Neighbouring modes, which a circle takes as constant, vary over it.
            assert!((re / constant - 1.0).abs() < 3e-2, "{constant} {at:?}");
            assert!((im / constant).abs() < 5e-2, "{constant} {at:?}");
            assert_eq!(at.hits, 3);
        }
    }
    assert_eq!(found.modes_table().to_csv().lines().count(), 10);
    // An average and three hits each.
    assert_eq!(found.frf_record(false).channels.len(), 12);
    let nodes: Vec<i64> = found.frf_record(false).channels[4..9]
        .iter()
        .map(|one| one.origin.response.as_ref().unwrap().node)
        .collect();
    assert_eq!(nodes, [2, 2, 2, 2, 3]);

    // Each response alone has the same results.
    let only_c = options(ResponseChoice::of(&["c".into()]));
    let alone = only(analyse(&[path], &only_c).unwrap());
    assert_eq!(alone.report.hits, found.responses[2].report.hits);
    // At zero frequency the receptance of an acceleration is not a number.
    assert!(alone.average.frf.values[1..] == found.responses[2].average.frf.values[1..]);
}

/// Hits of a mode at 420 Hz whose frequency falls with the square of its displacement, by `softening` times the
/// frequency at 1 um; forces of `peak` N on 1 kg.
fn softening_hits(softening: f64, peak: f64) -> (Vec<f64>, Vec<f64>) {
    const STEPS: usize = 20;
    let (omega, damping, rate) = (TAU * 420.0, 0.004, RATE);
    let step = 1.0 / (rate * STEPS as f64);
    let cubic = 8.0 / 3.0 * softening * omega * omega / 1e-12;
    let (mut u, mut v) = (0.0, 0.0);
    let sample = |n: usize| {
        let (mut f, mut a) = (0.0, 0.0);
        for k in 0..STEPS {
            let since = (n as f64 / rate + k as f64 * step) % 1.0 - 0.02;
            f = if (0.0..5e-4).contains(&since) { peak * (PI * since / 5e-4).sin() } else { 0.0 };
            a = f - 2.0 * damping * omega * v - omega * omega * u + cubic * u * u * u;
            v += a * step;
            u += v * step;
        }
        // Noise of a linear congruence.
        let random = |shift: usize| ((n * 1_103_515_245 + shift) % 65_536) as f64 / 65_536.0 - 0.5;
        (f + 1e-3 * random(7), a + 1e-2 * random(99))
    };
    (0..(3.0 * rate) as usize).map(sample).unzip()
}

/// The frequency of the mode falls by 8 Hz within each hit: one row that says so, with a deviation of half of the
/// change that the backbone shows. A linear mode has none.
#[test]
fn a_nonlinear_mode_is_named_in_the_modal_table() {
    let folder = TempDir::new().unwrap();
    for (name, softening, changes) in [("linear", 0.0, false), ("softening", 0.02, true)] {
        let (force, response) = softening_hits(softening, 8.5);
        let path = store(&folder, name, &force, &response);
        let band_hz = Some(FrequencyBand { low_hz: 360.0, high_hz: 480.0 });
        let options = AnalysisOptions { band_hz, ..AnalysisOptions::default() };
        let found = analyse(&[path], &options).unwrap();
        assert_eq!(found.modes.len(), 1, "{name}: {:?}", found.modes);
        let at = &found.modes[0].responses[0];
        let sigma = at.natural_frequency_uncertainty_hz.unwrap();
        assert_eq!(at.frequency_change_hz.is_some(), changes, "{name}: {at:?}");
        if let Some(change) = at.frequency_change_hz {
            // The filter rings while the amplitude falls by half.
            assert!((-8.0..-2.0).contains(&change) && sigma >= 0.5 * change.abs(), "{at:?}");
            let off = (at.damping_ratio - 0.004).abs();
            assert!(at.damping_ratio_uncertainty.unwrap() > 0.2 * off, "{at:?}");
        }
    }
}

/// A reversed response, a force beyond a hand hammer, and a sample rate near the band are notices with value and
/// usual range; an ordinary test has none of them.
#[test]
fn unusual_hits_are_noticed() {
    let (force, response) = hit_mode(4);
    let options = AnalysisOptions { band_hz: Some(BAND), ..AnalysisOptions::default() };
    let folder = TempDir::new().unwrap();
    let notices = |name: &str, force: &[f64], response: &[f64], options: &AnalysisOptions| {
        let path = store(&folder, name, force, response);
        only(analyse(&[path], options).unwrap()).report.notices.join("\n")
    };
    let words = ["opposite signs", "hand hammer", "ten times the upper limit"];
    let usual = notices("usual", &force, &response, &options);
    assert!(words.iter().all(|word| !usual.contains(word)), "{usual}");
    let reversed: Vec<f64> = response.iter().map(|x| -x).collect();
    let hard: Vec<f64> = force.iter().map(|x| 1e3 * x).collect();
    let wide = FrequencyBand { low_hz: 250.0, high_hz: 1200.0 };
    let found =
        notices("unusual", &hard, &reversed, &AnalysisOptions { band_hz: Some(wide), ..options });
    assert!(words.iter().all(|word| found.contains(word)), "{found}");
}

/// Two modes 3 Hz apart in a record: no backbone, and both with their damping in the report.
#[test]
fn two_modes_of_a_decay_are_reported() {
    let decay = |n: usize| {
        let t = n as f64 / RATE;
        let ring = |hz: f64, ratio: f64| (-ratio * TAU * hz * t).exp() * (TAU * hz * t).cos();
        ring(420.0, 0.004) + 0.7 * ring(423.0, 0.0035)
    };
    let response: Vec<f64> = (0..20_000).map(decay).collect();
    let folder = TempDir::new().unwrap();
    let path = store(&folder, "decay", &vec![0.0; response.len()], &response);
    let found = analyse_decays(&[path], &DecayOptions::default()).unwrap();
    let report = &found.report.decays[0].responses[0];
    assert!(report.mean.is_none() && report.modes.len() == 2, "{report:?}");
    assert!((report.modes[0].frequency_hz - 420.0).abs() < 0.01, "{:?}", report.modes);
    assert!((report.modes[1].damping_ratio / 0.0035 - 1.0).abs() < 0.01, "{:?}", report.modes);
    assert!(report.warnings[0].contains("two linear modes explain the decay"), "{report:?}");
}
