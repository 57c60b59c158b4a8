//! A second method: the single mass integrated in time until it is steady.

use std::f64::consts::TAU;
use std::sync::Arc;

use asperity_harmonic::{
    ContactSystem, Continuation, Floquet, FourierResolution, HarmonicSettings, LawEvaluation,
    PeriodicResponse, SpecialPointKind, StepControl, Termination, trace,
};
use asperity_law::Constant;
use asperity_mesh::{Body, Interface, Stack, Support};
use asperity_structure::{Damping, PreloadedStructure};

use crate::rigs::{AREA, Law, MASS, PRESSURE, mass_on, natural_frequency, rate_on};

/// `m u'' + m h u' + S (p - p0) = F cos(w t)`, by the classical Runge-Kutta method, 400 steps a
/// period: its error is below 1e-9 there.
pub(crate) struct Motion<'a> {
    pub(crate) law: &'a Law,
    pub(crate) rate: f64,
    pub(crate) force: f64,
    pub(crate) frequency: f64,
}

pub(crate) const STEPS: usize = 400;

impl Motion<'_> {
    fn slope(&self, phase: f64, [u, v]: [f64; 2]) -> [f64; 2] {
        let pressure = self.law.pressure_increment(PRESSURE, u).value;
        [v, (self.force * phase.cos() - AREA * pressure) / MASS - self.rate * v]
    }

    /// The state a period later; `observe` is called with the displacement at every step.
    pub(crate) fn period(&self, mut state: [f64; 2], mut observe: impl FnMut(f64)) -> [f64; 2] {
        let dt = 1.0 / (self.frequency * STEPS as f64);
        let ahead = |x: [f64; 2], k: [f64; 2], t: f64| [x[0] + t * k[0], x[1] + t * k[1]];
        for n in 0..STEPS {
            observe(state[0]);
            let phase = |half: f64| TAU * (n as f64 + half) / STEPS as f64;
            let a = self.slope(phase(0.0), state);
            let b = self.slope(phase(0.5), ahead(state, a, 0.5 * dt));
            let c = self.slope(phase(0.5), ahead(state, b, 0.5 * dt));
            let d = self.slope(phase(1.0), ahead(state, c, dt));
            for i in 0..2 {
                state[i] += dt / 6.0 * (a[i] + 2.0 * (b[i] + c[i]) + d[i]);
            }
        }
        state
    }

    /// Amplitudes of the first `count` harmonics after `periods` periods from `state`.
    pub(crate) fn settled(&self, mut state: [f64; 2], periods: usize, count: usize) -> Vec<f64> {
        for _ in 0..periods {
            state = self.period(state, |_| ());
        }
        let mut samples = Vec::new();
        self.period(state, |u| samples.push(u));
        (1..=count).map(|k| harmonic(&samples, k)).collect()
    }
}

/// Amplitude of harmonic k of samples over one period.
pub(crate) fn harmonic(samples: &[f64], k: usize) -> f64 {
    let n = samples.len() as f64;
    let angle = |i: usize| TAU * (k * i) as f64 / n;
    let cos: f64 = samples.iter().enumerate().map(|(i, u)| u * angle(i).cos()).sum();
    let sin: f64 = samples.iter().enumerate().map(|(i, u)| u * angle(i).sin()).sum();
    2.0 / n * cos.hypot(sin)
}

/// Displacement and velocity of a response at the start of a period.
pub(crate) fn state_of(response: &PeriodicResponse) -> [f64; 2] {
    let velocity: f64 = (1..)
        .map(f64::from)
        .zip(&response.displacement)
        .map(|(k, u)| -u.im * k * response.angular_frequency)
        .sum();
    [response.displacement_at(0.0), velocity]
}

/// A mass on a spring that only pushes, the plainest contact that opens: branches over its resonance complete from
/// a twentieth of the weight to the whole of it, and the response of the upper part, 2 % above the lowest fold, is
/// that of integration in time within 0.1 %.
#[test]
fn a_mass_on_a_spring_that_only_pushes_has_whole_branches() {
    let law: Law = Arc::new(Constant::unilateral(1e12).unwrap());
    let system = mass_on(&law, LawEvaluation::default());
    let rate = rate_on(&law);
    let natural = natural_frequency(&law);
    let weight = MASS * 9.81;
    // The peak of a higher force leans further.
    for (share, low) in [(0.05, 0.4), (0.1, 0.4), (0.3, 0.4), (1.0, 0.15)] {
        let force = share * weight;
        let range = Continuation::Frequency { force, from: low * natural, to: 1.5 * natural };
        let settings = HarmonicSettings {
            resolution: FourierResolution::Automatic { tolerance: 1e-5, most: 30 },
            stability: Some(Floquet::default()),
            ..HarmonicSettings::default()
        };
        let branch = trace(&system, &range, &settings).unwrap();
        assert!(branch.is_complete(), "{share}: {:?}", branch.termination);
        let opens = branch.points.iter().any(PeriodicResponse::contact_lost);
        // 7 % of the weight opens the contact at resonance.
        assert_eq!(opens, share > 0.07, "{share}");
        let folds = branch.of_kind(SpecialPointKind::Fold).map(PeriodicResponse::frequency_hz);
        let folds: Vec<f64> = folds.collect();
        assert!(if opens { folds.len() >= 2 } else { folds.is_empty() }, "{share}: {folds:?}");
        // Two responses meet at a fold: `det(M - 1)` of the map over a period, integrated, has the multiplier 1
        // there, and different signs three points away on both sides.
        let beside = |point: &PeriodicResponse| {
            let motion = Motion { law: &law, rate, force, frequency: point.frequency_hz() };
            let state = state_of(point);
            let length = 1e-4 * point.amplitude(1);
            let size = [length, length * point.angular_frequency];
            let column = |i: usize| {
                let moved = |sign: f64| {
                    let mut state = state;
                    state[i] += sign * size[i];
                    motion.period(state, |_| ())
                };
                let (up, down) = (moved(1.0), moved(-1.0));
                [0, 1].map(|row| (up[row] - down[row]) / (2.0 * size[i]))
            };
            let [[a, c], [b, d]] = [column(0), column(1)];
            (a - 1.0) * (d - 1.0) - b * c
        };
        // Below three tenths of the natural frequency thirty harmonics do not resolve the impacts of the highest force.
        let all = branch.special.iter().filter(|found| found.kind == SpecialPointKind::Fold);
        for fold in all.filter(|fold| fold.response.frequency_hz() > 0.3 * natural) {
            let [before, after] =
                [fold.after - 3, fold.after + 4].map(|point| beside(&branch.points[point]));
            let hz = fold.response.frequency_hz();
            assert!(before * after < 0.0, "{share}: {before} and {after} beside {hz} Hz");
        }
        // Next to the fold transients hardly decay.
        let lowest = 1.02 * folds.iter().copied().fold(f64::INFINITY, f64::min);
        let away = |point: &&PeriodicResponse| {
            point.stable() == Some(true) && (!opens || point.frequency_hz() > lowest)
        };
        let highest = branch.points.iter().filter(away);
        let point = highest.max_by(|a, b| a.amplitude(1).total_cmp(&b.amplitude(1))).unwrap();
        let motion = Motion { law: &law, rate, force, frequency: point.frequency_hz() };
        let series = &point.closures;
        let w = point.angular_frequency;
        let (mut u, mut v) = (series[0], 0.0);
        for (k, pair) in (1..).map(f64::from).zip(series[1..].chunks_exact(2)) {
            u += pair[0];
            v += k * w * pair[1];
        }
        let found = motion.settled([u, v], 40, 2);
        assert!((found[0] / point.amplitude(1) - 1.0).abs() < 1e-3, "{share}: {found:?}");
        if opens {
            assert!((found[1] / point.amplitude(2) - 1.0).abs() < 1e-2, "{share}: {found:?}");
        }
    }
}

/// With one harmonic, a mass on a spring that only pushes has the closed form
///
/// ```text
/// (k A / pi) (sin h - h cos h) = W,    (k (h - sin h cos h) / pi - m w^2)^2 + (m c w)^2 = (F / A)^2,
/// ```
///
/// contact being closed for phases within h of the largest closure.
#[test]
fn one_harmonic_of_a_mass_on_a_spring_that_only_pushes_is_the_closed_form() {
    use std::f64::consts::PI;
    let law: Law = Arc::new(Constant::unilateral(1e12).unwrap());
    let system = mass_on(&law, LawEvaluation::default());
    let (rate, natural) = (rate_on(&law), natural_frequency(&law));
    let (weight, spring) = (MASS * 9.81, AREA * 1e12);
    let force = 0.3 * weight;
    let range = Continuation::Frequency { force, from: 0.4 * natural, to: 1.5 * natural };
    let found = crate::rigs::branch(&system, range, (1, 64));
    assert!(found.is_complete());
    let opening = found.points.iter().filter(|point| point.contact_lost());
    assert!(opening.clone().count() > 20);
    for point in opening {
        let [mean, cosine, sine] = point.closures[..] else { panic!() };
        let (a, w) = (f64::hypot(cosine, sine), point.angular_frequency);
        let half = f64::acos(-(mean + weight / spring) / a);
        let held = spring * a / PI * (half.sin() - half * half.cos());
        assert!((held / weight - 1.0).abs() < 1e-8, "{held} {weight}");
        let stiffness = spring / PI * (half - half.sin() * half.cos());
        let needed = a * f64::hypot(stiffness - MASS * w * w, MASS * rate * w);
        assert!((needed / force - 1.0).abs() < 1e-7, "{needed} {force}");
    }
}

/// A branch with fewer harmonics that covers the range takes the place of one with too many points: a bar on a spring that only pushes, whose high modes are excited by every impact.
#[test]
fn fewer_harmonics_take_the_place_of_a_branch_without_an_end() {
    let bar = Body::with_mass("bar", 0.1415, 0.4723, 2e11, 2700.0).unwrap();
    let law: Law = Arc::new(Constant::unilateral(2.52e13).unwrap());
    let contact = Interface::new("contact", 6.86e-4, law).unwrap();
    let stack = Stack::new(vec![bar], vec![contact], Support::Rigid, 9.81).unwrap();
    let structure = PreloadedStructure::new(stack, Damping::Ratio(0.011)).unwrap();
    let system = ContactSystem::of_structure(&structure, LawEvaluation::default()).unwrap();
    let range = Continuation::Frequency { force: 0.433, from: 3450.0, to: 20_700.0 };
    let with = |points: usize| {
        let settings = HarmonicSettings {
            resolution: FourierResolution::Automatic { tolerance: 1e-5, most: 30 },
            steps: StepControl { points, ..StepControl::default() },
            ..HarmonicSettings::default()
        };
        trace(&system, &range, &settings).unwrap()
    };
    let found = with(1500);
    assert!(found.is_complete() && found.harmonics < 30 && found.points.len() <= 1500);
    let finer = found.finer.unwrap();
    assert_eq!((finer.harmonics, finer.points), (30, 1500));
    assert_eq!(finer.termination, Termination::PointLimit);
    assert!(finer.frequency_hz > 3450.0 && finer.frequency_hz < 20_700.0);
    // None covers the range: the branch with the most harmonics is given.
    let short = with(200);
    assert_eq!((short.harmonics, short.points.len(), &short.finer), (30, 200, &None));
    assert_eq!(short.termination, Termination::PointLimit);
}
