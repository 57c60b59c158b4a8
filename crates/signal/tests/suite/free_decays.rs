//! Free decays without a force, against exact and independently integrated ones.

use crate::noise::Noise;
use crate::oscillator::integrated;
use asperity_signal::{
    AmplitudeTrend, DecayEnd, DecayOrigin, DecayResonance, FoundDecay, FreeDecay, FreeDecayOptions,
    PeakOrigin, find_decays, level_range,
};
use std::f64::consts::{FRAC_PI_2, TAU};

const RATE: f64 = 10_000.0;
/// Points of a quadrature, and steps of an integration in a sample.
const POINTS: usize = 200;
const SUBSTEPS: usize = 20;

fn options(resonance_hz: f64) -> FreeDecayOptions {
    FreeDecayOptions {
        resonance_hz,
        half_width_hz: f64::INFINITY,
        search_half_width_hz: f64::INFINITY,
        derivatives: 0,
        noise_density: None,
    }
}

/// A mode that is struck at time zero.
fn ring(frequency: f64, damping: f64, t: f64) -> f64 {
    let omega = TAU * frequency;
    let damped = omega * (1.0 - damping * damping).sqrt();
    if t < 0.0 { 0.0 } else { (-damping * omega * t).exp() * (damped * t).sin() }
}

fn sampled(count: usize, of: impl Fn(f64) -> f64) -> Vec<f64> {
    (0..count).map(|n| of(n as f64 / RATE)).collect()
}

/// Displacement and acceleration after a blow of half a millisecond that makes the mode swing to about
/// `amplitude`, from the restoring force over the mass.
fn struck(
    restoring: impl Fn(f64, f64) -> f64,
    amplitude: f64,
    count: usize,
) -> (Vec<f64>, Vec<f64>) {
    const LENGTH: f64 = 5e-4;
    let peak = amplitude * TAU * 200.0 * FRAC_PI_2 / LENGTH;
    let force = |t: f64| if t < LENGTH { peak * (TAU * 0.5 * t / LENGTH).sin() } else { 0.0 };
    let (displacement, acceleration) = integrated(1.0, restoring, force, RATE, count + 6, 20);
    (displacement[6..].to_vec(), acceleration[6..].to_vec())
}

fn deviation(values: &[f64]) -> (f64, f64) {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let square = values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (count - 1.0);
    (mean, square.sqrt())
}

/// Verified against the linear mode simulated, at 20, 40 and 60 dB of noise below the first
/// amplitude, over 100 records: frequency and damping of the whole decay and of one point at a given
/// time are unbiased within four standard errors plus 1e-5 (2e-4 of the damping ratio), and the
/// stated deviations are within 0.8 to 1.25 of the scatter.
#[test]
fn stated_deviations_are_the_scatter() {
    const RUNS: usize = 100;
    let (frequency, damping) = (200.0, 0.004);
    let clean = sampled(20_000, |t| ring(frequency, damping, t + 0.01));
    let damped = frequency * (1.0_f64 - damping * damping).sqrt();
    for decibels in [20.0, 40.0, 60.0] {
        let level = 10.0_f64.powf(-decibels / 20.0) / 2.0_f64.sqrt();
        let mut columns: [Vec<(f64, f64)>; 4] = Default::default();
        for run in 0..RUNS {
            let samples = Noise::new(1000 + run as u64).added_to(&clean, level);
            let found = FreeDecay::of(&samples, RATE, &options(frequency)).unwrap();
            assert!(found.is_one_mode(), "{decibels} dB, {run}: {:?}", found.beating);
            let mean = found.mean.unwrap();
            // Lines depend on the damping found; a point at one time has one amplitude.
            let at = |p: &&asperity_signal::DecayPoint| (p.point.time_s - 0.15).abs() < 0.02;
            let one = found.points.iter().find(at).unwrap();
            for (column, point) in [(0, &mean), (2, one)] {
                let (value, sd) = (point.point, point.uncertainty);
                columns[column].push((value.frequency_hz / damped, sd.frequency_hz / damped));
                columns[column + 1]
                    .push((value.damping_ratio / damping, sd.damping_ratio / damping));
            }
        }
        for (column, values) in columns.iter().enumerate() {
            let (mean, scatter) = deviation(&values.iter().map(|v| v.0).collect::<Vec<_>>());
            let stated = values.iter().map(|v| v.1).sum::<f64>() / RUNS as f64;
            let bias = if column % 2 == 0 { 1e-5 } else { 2e-3 };
            let standard_error = scatter / (RUNS as f64).sqrt();
            assert!(
                (mean - 1.0).abs() < 4.0 * standard_error + bias,
                "{decibels} dB, {column}: {mean}, scatter {scatter:e}"
            );
            // Without noise to speak of, the ends of the filter are what is left.
            assert!(
                (0.8..1.25).contains(&(stated / scatter)),
                "{decibels} dB, {column}: {stated:e} of {scatter:e}"
            );
        }
    }
}

/// The undamped oscillator `u'' = -w^2 u + c u^3` that swings to an amplitude.
#[derive(Debug, Clone, Copy)]
struct Swing {
    frequency_hz: f64,
    /// Amplitude of the fundamental.
    fundamental: f64,
    mean_square_velocity: f64,
}

/// The swing to `amplitude`, by Gauss-Chebyshev quadrature of the period and the cosine sum of the
/// motion over it.
fn softening(omega: f64, cubic: f64, amplitude: f64) -> Swing {
    let speed = |angle: f64| {
        let square = 0.5 * amplitude * amplitude * (1.0 + angle.sin().powi(2));
        (omega * omega - cubic * square).sqrt()
    };
    let step = FRAC_PI_2 / POINTS as f64;
    let (mut time, mut cosine, mut work) = (0.0, 0.0, 0.0);
    let whole: f64 = (0..POINTS).map(|k| step / speed((k as f64 + 0.5) * step)).sum();
    // From the turning point on: u = a cos(angle).
    for k in 0..POINTS {
        let angle = (k as f64 + 0.5) * step;
        let passed = step / speed(FRAC_PI_2 - angle);
        time += 0.5 * passed;
        cosine += amplitude * angle.cos() * (FRAC_PI_2 * time / whole).cos() * passed;
        time += 0.5 * passed;
        work += (amplitude * angle.cos()).powi(2) * speed(angle) * step;
    }
    Swing {
        frequency_hz: 0.25 / whole,
        fundamental: 2.0 * cosine / whole,
        mean_square_velocity: work / whole,
    }
}

/// Verified against the conservative oscillator, by quadrature of its period, for a decay integrated in
/// time: the frequency changes by 5 % along the decay, and is that of its amplitude within 3e-4. The
/// damping force `2 zeta w v` takes the energy `E = w^2 a^2 / 2 - c a^4 / 4` away, so that the turning
/// point a decreases by `2 zeta w <v^2> / (dE/da)`, and the decay rate of the fundamental, up to 3 % above
/// `zeta w`, is known within 0.5 %.
#[test]
fn a_softening_oscillator_has_its_backbone() {
    let (omega, damping, cubic) = (TAU * 200.0, 0.005, 0.15 * (TAU * 200.0_f64).powi(2));
    let restoring =
        |u: f64, v: f64| 2.0 * damping * omega * v + omega * omega * u - cubic * u * u * u;
    let (samples, _) = struck(restoring, 1.0, 15_000);
    let found = FreeDecay::of(&samples, RATE, &options(198.0)).unwrap();
    assert!(found.is_one_mode(), "{:?}", found.beating);
    assert!(found.points.len() > 30);
    // Amplitude and frequency of the fundamental, and its decay rate.
    let exact = |k: i32| {
        let turning = 0.01 * f64::from(k);
        let swing = |share: f64| softening(omega, cubic, share * turning);
        let (here, below, above) = (swing(1.0), swing(0.999), swing(1.001));
        let slope = (above.fundamental / below.fundamental).ln() / (0.002 * turning);
        let force = omega * omega * turning - cubic * turning.powi(3);
        let fall = 2.0 * damping * omega * here.mean_square_velocity / force;
        [here.fundamental, here.frequency_hz, fall * slope]
    };
    let exact: Vec<[f64; 3]> = (1..=120).map(exact).collect();
    let relation = |amplitude: f64| {
        let above = exact.iter().position(|known| known[0] >= amplitude).unwrap();
        let start = [0.0, 200.0, damping * omega];
        let (low, high) = (if above == 0 { start } else { exact[above - 1] }, exact[above]);
        let share = (amplitude - low[0]) / (high[0] - low[0]);
        [1, 2].map(|of| low[of] + share * (high[of] - low[of]))
    };
    let largest = found.points[0].point.amplitude;
    assert!(largest > 0.5, "{largest}");
    assert!(relation(largest)[0] < 0.985 * 200.0 && relation(largest)[1] > 1.015 * damping * omega);
    for one in &found.points {
        let point = one.point;
        let [frequency_hz, decay_rate] = relation(point.amplitude);
        assert!((point.frequency_hz / frequency_hz - 1.0).abs() < 3e-4, "{frequency_hz} {point:?}");
        assert!((point.decay_rate / decay_rate - 1.0).abs() < 5e-3, "{decay_rate} {point:?}");
    }
}

/// Verified against the first order of the oscillator `u'' = -w^2 u - b u^2`: the second harmonic is
/// `b a / (6 w^2)` of the fundamental, in displacement and, by its order, in acceleration; the third,
/// of second order `(b a / w^2)^2 / 48`; the decay tells a harmonic. A mode at 2.04 of the
/// fundamental instead is told as a mode, and its ratio is reduced by the phase.
#[test]
fn harmonics_follow_the_amplitude() {
    let (omega, damping) = (TAU * 200.0, 0.005);
    let quadratic = 0.2 * omega * omega;
    let restoring =
        |u: f64, v: f64| 2.0 * damping * omega * v + omega * omega * u + quadratic * u * u;
    let (displacement, acceleration) = struck(restoring, 1.0, 10_000);
    for (derivatives, samples) in [(0, displacement), (2, acceleration)] {
        let options = FreeDecayOptions { derivatives, ..options(200.0) };
        let found = FreeDecay::of(&samples, RATE, &options).unwrap();
        let mut thirds = 0;
        for one in &found.points {
            let amplitude = one.point.amplitude / (TAU * one.point.frequency_hz).powi(derivatives);
            if amplitude < 0.1 {
                break;
            }
            let second = one.harmonics[0].unwrap().ratio;
            let expected = 0.2 * amplitude / 6.0;
            assert!((second / expected - 1.0).abs() < 0.02, "{derivatives}: {second} {expected}");
            // The filter's response to the beginning exceeds the third harmonic at first.
            let Some(third) = one.harmonics[1].map(|harmonic| harmonic.ratio) else { continue };
            thirds += 1;
            let expected = (0.2 * amplitude).powi(2) / 48.0;
            assert!((third / expected - 1.0).abs() < 0.05, "{derivatives}: {third} {expected}");
        }
        assert!(thirds > 5, "{thirds}");
        let origin = found.harmonic_test.and_then(|test| test.origin());
        assert_eq!(origin, Some(PeakOrigin::Harmonic), "{:?}", found.harmonic_test);
    }
    let modes = sampled(10_000, |t| ring(200.0, 0.005, t) + 0.05 * ring(408.0, 0.004, t));
    let found = FreeDecay::of(&modes, RATE, &options(200.0)).unwrap();
    let origin = found.harmonic_test.and_then(|test| test.origin());
    assert_eq!(origin, Some(PeakOrigin::Mode), "{:?}", found.harmonic_test);
}

/// Two modes whose beat has three periods and more in the decay are told from one, for offsets of 1
/// to 12 % and amplitude ratios of 0.2 to 1, at three decay rates; a nonlinear mode, whose frequency
/// changes by as much, and one with dry friction, whose amplitude falls to nothing, are one mode.
#[test]
fn close_modes_are_no_backbone() {
    for damping in [0.001, 0.002, 0.005] {
        for offset in [0.01, 0.02, 0.05, 0.12] {
            for ratio in [0.2, 0.5, 1.0] {
                let samples = sampled(30_000, |t| {
                    ring(200.0, damping, t + 0.003)
                        + ratio * ring(200.0 * (1.0 + offset), damping, t + 0.001)
                });
                for noise in [0.0, 1e-3] {
                    let samples = Noise::new(7).added_to(&samples, noise);
                    let found = FreeDecay::of(&samples, RATE, &options(200.0)).unwrap();
                    let told = !found.is_one_mode();
                    assert!(told, "{damping} {offset} {ratio} {noise}: {:?}", found.beating);
                }
            }
        }
    }
    let omega = TAU * 200.0;
    let dry = |u: f64, v: f64| omega * omega * u + 0.004 * omega * v + 4e2 * (v / 2.0).tanh();
    let hardening = |u: f64, v: f64| omega * omega * (u + 0.3 * u * u * u) + 0.01 * omega * v;
    for (samples, _) in [struck(dry, 1.0, 12_000), struck(hardening, 1.0, 12_000)] {
        let found = FreeDecay::of(&samples, RATE, &options(200.0)).unwrap();
        assert!(found.is_one_mode(), "{:?}", found.beating);
        assert!(found.points.len() > 10);
    }
}

/// A mode beside hum at 1 % of its first amplitude, 4 Hz away: the decay ends before the hum is strong,
/// where frequency and damping still have the values simulated, within 2e-4 and 3 %; without a filter that
/// separates them, the rest is not told as the mode.
#[test]
fn a_decay_ends_where_other_vibration_remains() {
    let samples =
        sampled(40_000, |t| ring(200.0, 0.004, t + 0.01) + 0.01 * (TAU * 204.0 * t + 0.3).sin());
    let samples = Noise::new(8).added_to(&samples, 1e-4);
    let found = FreeDecay::of(&samples, RATE, &options(200.0)).unwrap();
    assert!(found.is_one_mode() && found.reaches_noise, "{:?}", found.beating);
    let last = found.points.last().unwrap().point;
    assert!((0.04..0.5).contains(&last.amplitude), "{last:?}");
    let mean = found.mean.unwrap().point;
    assert!((mean.frequency_hz / 200.0 - 1.0).abs() < 2e-4, "{mean:?}");
    assert!((mean.damping_ratio / 0.004 - 1.0).abs() < 0.03, "{mean:?}");
}

/// A mode just below half the sample rate has a band that ends there; one above has none.
#[test]
fn bands_end_at_half_the_sample_rate() {
    let samples = sampled(20_000, |t| ring(4400.0, 0.0005, t));
    let found = FreeDecay::of(&samples, RATE, &options(4400.0)).unwrap();
    assert!(found.band.high_hz() <= 5000.0 && found.band.high_hz() > 4900.0);
    assert!((found.mean.unwrap().point.frequency_hz - 4400.0).abs() < 0.01);
    assert!(FreeDecay::of(&samples, RATE, &options(5100.0)).is_err());
}

fn places(samples: &[&[f64]]) -> Vec<FoundDecay> {
    find_decays(samples, RATE, 200.0).unwrap()
}

/// Verified against the instants simulated: five blows of different force in noise are found within
/// a millisecond, also by a second response that hardly moves; the last ends with the record.
#[test]
fn blows_are_found_at_their_instants() {
    let blows = [(0.11, 1.0), (0.9, 0.2), (1.5, 3.0), (2.31, 0.05), (2.9, 0.5)];
    let record = sampled(36_000, |t| {
        blows.iter().map(|(at, height)| height * ring(200.0, 0.01, t - at)).sum()
    });
    let first = Noise::new(3).added_to(&record, 1e-3);
    let second = Noise::new(4).added_to(&vec![0.7; record.len()], 1e-2);
    for responses in [vec![first.as_slice()], vec![first.as_slice(), second.as_slice()]] {
        let found = places(&responses);
        assert_eq!(found.len(), blows.len(), "{found:?}");
        for (decay, (at, _)) in found.iter().zip(blows) {
            assert_eq!(decay.origin, DecayOrigin::Blow);
            assert!((decay.onset as f64 / RATE - at).abs() < 1e-3, "{decay:?}, not {at}");
        }
        assert!(found[..4].iter().all(|decay| decay.ended_by == DecayEnd::NextDecay));
        assert_eq!((found[4].ended_by, found[4].end), (DecayEnd::RecordEnd, record.len()));
    }
}

/// A shaker that drives a mode from rest at 0.99 of its frequency, and stops: twice in a record, by
/// integration. The decays begin after each stop, within 15 % of the time constant.
#[test]
fn the_end_of_a_sustained_excitation_is_found() {
    let (omega, damping) = (TAU * 200.0, 0.01);
    let stops = [1.0, 2.6];
    let time_constant = 1.0 / (damping * omega);
    let mut state = (0.0_f64, 0.0_f64);
    let mut record = Vec::new();
    for n in 0..40_000 * SUBSTEPS {
        let t = n as f64 / (RATE * SUBSTEPS as f64);
        let drives = t < stops[0] || (1.7..stops[1]).contains(&t);
        let force = if drives { (0.99 * omega * t).sin() } else { 0.0 };
        let a = force - 2.0 * damping * omega * state.1 - omega * omega * state.0;
        state.1 += a / (RATE * SUBSTEPS as f64);
        state.0 += state.1 / (RATE * SUBSTEPS as f64);
        if n % SUBSTEPS == 0 {
            record.push(state.0);
        }
    }
    let most = record.iter().copied().fold(0.0, f64::max);
    let record = Noise::new(9).added_to(&record, 1e-3 * most);
    let found = places(&[&record]);
    assert_eq!(found.len(), 2, "{found:?}");
    for (decay, stop) in found.iter().zip(stops) {
        assert_eq!(decay.origin, DecayOrigin::Release);
        let late = decay.onset as f64 / RATE - stop;
        assert!((0.0..0.15 * time_constant + 0.01).contains(&late), "{late} after {stop}");
        let samples = &record[decay.onset..decay.end];
        let analysed = FreeDecay::of(samples, RATE, &options(200.0)).unwrap();
        let mean = analysed.mean.unwrap().point;
        assert!((mean.frequency_hz / 199.99 - 1.0).abs() < 1e-4, "{mean:?}");
        assert!((mean.damping_ratio / damping - 1.0).abs() < 0.01, "{mean:?}");
        assert!(analysed.reaches_noise);
    }
}

/// Noise, a sustained sine and rest hold no decay, and the evidence says so; a record that begins in
/// a decay has one; two modes that beat are one decay.
#[test]
fn records_without_a_decay_have_none() {
    let noise = Noise::new(5).added_to(&vec![0.0; 20_000], 1.0);
    let sine = sampled(20_000, |t| (TAU * 200.0 * t).sin());
    for record in [&noise, &sine] {
        assert_eq!(places(&[record]), []);
        let (above, fall) = level_range(&[record], RATE, 200.0).unwrap();
        assert!(above < 3.0 && fall < 3.0, "{above} {fall}");
    }
    assert_eq!(places(&[&vec![0.5; 5000]]), []);
    let early = sampled(10_000, |t| ring(200.0, 0.005, t - 0.003));
    let found = places(&[&early]);
    assert_eq!((found.len(), found[0].origin), (1, DecayOrigin::Blow), "{found:?}");
    assert!(found[0].onset.abs_diff(30) < 3, "{found:?}");
    let begun = sampled(10_000, |t| ring(200.0, 0.005, t + 0.01));
    let found = places(&[&begun]);
    assert_eq!((found.len(), found[0].origin, found[0].onset), (1, DecayOrigin::RecordStart, 0));
    for offset in [2.0, 5.0, 10.0, 20.0] {
        let beat =
            sampled(30_000, |t| ring(200.0, 0.002, t - 0.2) + ring(200.0 + offset, 0.002, t - 0.2));
        assert_eq!(places(&[&beat]).len(), 1, "{offset}: {:?}", places(&[&beat]));
    }
}

/// The strongest mode and half of the distance to the next are those simulated; with noise alone
/// beside it there is no next.
#[test]
fn resonances_stand_apart_from_their_neighbours() {
    let two = sampled(20_000, |t| ring(200.0, 0.004, t) + 0.3 * ring(230.0, 0.004, t));
    let one = Noise::new(6).added_to(&sampled(20_000, |t| ring(200.0, 0.004, t)), 0.02);
    let of = |samples: &[f64]| {
        DecayResonance::strongest(&[(samples, 0)], RATE, (10.0, 4000.0)).unwrap().unwrap()
    };
    let (two, one) = (of(&two), of(&one));
    assert!((two.frequency_hz - 200.0).abs() < 0.5 && (two.half_width_hz - 15.0).abs() < 0.5);
    assert!((one.frequency_hz - 200.0).abs() < 0.5 && one.half_width_hz > 60.0, "{one:?}");
}

/// Two linear modes 1 to 12 Hz apart, of equal or of different amplitude, are found with their frequencies and
/// damping ratios within five deviations (1e-6 of a frequency, 1e-3 of a ratio), where local lines show one mode
/// that is damped otherwise; a linear mode, one that softens and one whose damping rises with amplitude remain one.
#[test]
fn two_modes_are_told_from_one_that_depends_on_its_amplitude() {
    let (first, ratios) = (420.0, (0.004, 0.0035));
    let cases = [(1.0, 0.6), (3.0, 1.0), (3.0, 0.3), (8.0, 0.9), (12.0, 0.5)];
    for (number, (apart, ratio)) in cases.into_iter().enumerate() {
        let second = first + apart;
        let motion =
            |t: f64| ring(first, ratios.0, t + 1e-4) + ratio * ring(second, ratios.1, t + 2e-4);
        let samples = Noise::new(number as u64).added_to(&sampled(15_000, motion), 4e-4);
        let found = FreeDecay::of(&samples, RATE, &options(first)).unwrap();
        let two = found.two_modes.unwrap_or_else(|| panic!("{apart} {ratio}: {}", found.misfit));
        assert!(!found.is_one_mode(), "{apart} {ratio}: {two:?}");
        let mut modes = two.modes;
        modes.sort_by(|a, b| a.frequency_hz.total_cmp(&b.frequency_hz));
        for (mode, (natural, damping)) in modes.iter().zip([(first, ratios.0), (second, ratios.1)])
        {
            let exact = natural * (1.0_f64 - damping * damping).sqrt();
            let off = (mode.frequency_hz - exact).abs();
            assert!(off < 5.0 * mode.frequency_uncertainty_hz + 1e-6 * exact, "{apart} {mode:?}");
            let off = (mode.damping_ratio - damping).abs();
            assert!(
                off < 5.0 * mode.damping_ratio_uncertainty + 1e-3 * damping,
                "{apart} {mode:?}"
            );
            assert!(mode.damping_ratio_uncertainty < 0.02 * damping, "{apart} {mode:?}");
        }
    }
    // Phase and decay in closed form: f = f0 (1 - c a), sigma = sigma0 (1 + d a).
    let (sigma, turn) = (TAU * first * ratios.0, TAU * first);
    for (number, (softer, lossier)) in
        [(0.0, 0.0), (0.0065, 0.0), (0.02, 0.0), (0.01, 0.3)].into_iter().enumerate()
    {
        let motion = |t: f64| {
            let fall = (-sigma * t).exp();
            let a = fall / (1.0 + lossier * (1.0 - fall));
            let swept = if lossier > 0.0 {
                (lossier * (1.0 - fall)).ln_1p() / (lossier * sigma)
            } else {
                (1.0 - fall) / sigma
            };
            a * (turn * (t - softer * swept)).cos()
        };
        let samples = Noise::new(90 + number as u64).added_to(&sampled(15_000, motion), 4e-4);
        let found = FreeDecay::of(&samples, RATE, &options(first)).unwrap();
        assert!(found.two_modes.is_none() && found.is_one_mode(), "{softer} {:?}", found.two_modes);
        assert!(found.misfit < 0.01, "{softer} {lossier}: {}", found.misfit);
        let frequency = |one: &asperity_signal::DecayPoint| {
            (one.point.frequency_hz, one.uncertainty.frequency_hz)
        };
        let trend = AmplitudeTrend::of(&found.points, frequency).unwrap();
        let ends = [0, found.points.len() - 1].map(|n| found.points[n].point.amplitude);
        let exact = -first * softer * (ends[0] - ends[1]);
        assert!(
            (trend.change() - exact).abs() < 4.0 * trend.change_uncertainty + 0.01 * exact.abs(),
            "{softer}: {trend:?} {exact}"
        );
        assert_eq!(trend.is_significant(), softer > 0.0, "{trend:?}");
    }
}

/// The amplitudes of a mode without noise, digitised to 9 or 12 bits, and of one with noise that is padded: one
/// mode, its damping ratio within 1 % and five deviations, and no beat.
#[test]
fn coarse_steps_and_padding_are_no_beat() {
    let (frequency, damping) = (420.0, 0.004);
    let clean = sampled(30_000, |t| ring(frequency, damping, t + 1e-3));
    let coarse = |bits: i32| -> Vec<f64> {
        let step = 2.0_f64.powi(1 - bits);
        clean.iter().map(|x| (x / step).round() * step).collect()
    };
    let mut padded = Noise::new(3).added_to(&clean[..12_000], 4e-4);
    padded.resize(30_000, 0.0);
    for (name, samples) in [("9 bits", coarse(9)), ("12 bits", coarse(12)), ("padded", padded)] {
        let found = FreeDecay::of(&samples, RATE, &options(frequency)).unwrap();
        assert!(found.is_one_mode() && found.two_modes.is_none(), "{name}: {:?}", found.beating);
        assert!(found.beating.is_none_or(|beat| beat.decay_rate_error < 0.05), "{name}");
        let mean = found.mean.unwrap();
        let off = (mean.point.damping_ratio - damping).abs();
        assert!(
            off < 0.01 * damping && off < 5.0 * mean.uncertainty.damping_ratio,
            "{name} {mean:?}"
        );
        assert!(found.reaches_noise, "{name}");
    }
}

/// Hum of a tenth of the first amplitude at 50 Hz, whose velocity is the strongest line, is no resonance.
#[test]
fn hum_is_no_resonance() {
    let samples = sampled(20_000, |t| ring(420.0, 0.004, t - 0.1) + 0.1 * (TAU * 50.0 * t).sin());
    let found = DecayResonance::strongest(&[(&samples, 2)], RATE, (10.0, 4000.0)).unwrap();
    assert!((found.unwrap().frequency_hz - 420.0).abs() < 1.0, "{found:?}");
    let hum = sampled(20_000, |t| (TAU * 50.0 * t).sin());
    let found = DecayResonance::strongest(&[(&hum, 2)], RATE, (10.0, 4000.0)).unwrap();
    assert!((found.unwrap().frequency_hz - 50.0).abs() < 1.0, "{found:?}");
}
