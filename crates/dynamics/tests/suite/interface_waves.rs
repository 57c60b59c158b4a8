//! Waves across one interface between long bars against exact solutions: linear
//! transmission, any nonlinear law's ordinary differential equation, and the
//! second harmonic. Perturbation form: gravity sets the static pressure only.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use crate::support::half_spaces::{
    LENGTH, PULSE, delay, impedance, pulse, relative_norm, run, stack,
};
use crate::support::half_spaces::{transmitted_haversine, window};
use crate::support::receptance::transform;
use crate::support::{AREA, Law, constant, exponential, modified, power, slope};
use asperity_law::{Constant, ContactLaw, Power};
use asperity_structure::{LoadCase, TimeFunction};
use differential_equations::prelude::{ExplicitRungeKutta, IVP, ODE};
use faer::c64;

/// Static pressure [Pa].
const P0: f64 = 1.4e5;

/// Cells a bar of the convergence studies.
const CELLS: [usize; 4] = [127, 255, 511, 1023];

fn sizes() -> Vec<f64> {
    CELLS.iter().map(|&cells| LENGTH / cells as f64).collect()
}

/// Exact solution 2 in time, with slope 2 in the cell.
#[test]
fn a_linear_interface_transmits_the_exact_pulse() {
    let stack = stack(&constant(), P0);
    let alpha = 2.0 * 8.5e11 / impedance();
    let peak = 0.5 * P0;
    let errors: Vec<f64> = CELLS
        .iter()
        .map(|&cells| {
            let (times, samples) = window(&run(&stack, cells, &pulse(peak), 3.0));
            let found: Vec<f64> = samples.pressure.iter().map(|p| (p - P0) / peak).collect();
            let exact: Vec<f64> = times.iter().map(|&t| transmitted_haversine(alpha, t)).collect();
            relative_norm(&found, &exact)
        })
        .collect();
    let order = slope(&sizes(), &errors);
    assert!((1.9..2.1).contains(&order), "{errors:?}");
    // Dispersion: (k dx)^2 (1 - C^2) k L / 24 = 6e-5 for k = 2 pi / (c T).
    assert!(errors[3] < 1e-4, "{errors:?}");
}

/// Exact solution 2 in frequency: `T = 1 / (1 + i W)`, `R = i W / (1 + i W)`
/// (for `exp(+i w t)`), `W = w Z / (2 K)`; moduli and phases, slope 2.
#[test]
fn reflection_and_transmission_follow_the_exact_coefficients() {
    // Soft enough for W up to 2, stiff enough that exp(-alpha t) is 1e-6 at the window's end.
    let stiffness = 3e11;
    let law: Law = Arc::new(Constant::new(stiffness).unwrap());
    let stack = stack(&law, P0);
    let peak = 0.5 * P0;
    // Below the first zero of the pulse's spectrum, 2 / T.
    let frequencies: Vec<f64> = (1..=15).map(|i| 1e3 * f64::from(i)).collect();
    let mut errors = Vec::new();
    for cells in CELLS {
        let transient = run(&stack, cells, &pulse(peak), 4.0);
        let history = &transient.history;
        let interval = history.time[1];
        let echo = history.time.iter().position(|&t| t >= 2.0 * delay()).unwrap();
        let (_, samples) = window(&transient);
        let first = history.time.iter().position(|&t| t >= delay()).unwrap();
        let passed: Vec<f64> = samples.pressure.iter().map(|p| p - P0).collect();
        // The incident wave leaves the top displaced for good; the echo comes on top, twice.
        let left = history.sensors[0].displacement[echo - 1];
        let returned: Vec<f64> =
            history.sensors[0].displacement[echo..].iter().map(|u| 0.5 * (u - left)).collect();
        let mut worst = 0.0_f64;
        for &frequency in &frequencies {
            let iw = c64::new(0.0, TAU * frequency);
            let at = |start: usize, wave: f64| {
                let late = history.time[start] - wave * delay();
                (-iw * late).exp()
            };
            let incident = transform(&history.load, interval, frequency) / AREA;
            let t = transform(&passed, interval, frequency) * at(first, 1.0) / incident;
            // Pressure of the echo from its displacement: Z i w u.
            let r = transform(&returned, interval, frequency) * at(echo, 2.0) * iw * impedance()
                / incident;
            let number = TAU * frequency * impedance() / (2.0 * stiffness);
            let exact_t = c64::new(1.0, number).inv();
            let exact_r = c64::new(0.0, number) * exact_t;
            worst = worst.max((t - exact_t).norm()).max((r - exact_r).norm());
            if cells == CELLS[3] {
                let modulus = 1.0 / number.hypot(1.0);
                // Without the phases' error of the long way: (w dt)^2 / 8 of the contact step, 1e-5.
                assert!((t.norm() - modulus).abs() < 1e-4, "{frequency} Hz");
                assert!((r.norm() - number * modulus).abs() < 1e-4, "{frequency} Hz");
            }
        }
        errors.push(worst);
    }
    let order = slope(&sizes(), &errors);
    assert!((1.9..2.1).contains(&order), "{errors:?}");
}

/// The interface's own equation, `d' = (2/Z) (q_in(t) - q(d))`, in the units `1 / alpha` of time and
/// `P0 / K1` of closure.
struct InterfaceEquation<'a> {
    law: &'a Law,
    peak: f64,
    alpha: f64,
    unit: f64,
}

impl<'a> InterfaceEquation<'a> {
    fn new(law: &'a Law, peak: f64) -> Self {
        let stiffness = law.stiffness(P0);
        Self { law, peak, alpha: 2.0 * stiffness / impedance(), unit: P0 / stiffness }
    }

    /// Pressure increment \[Pa\] at a closure increment in its unit.
    fn pressure_increment(&self, closure: f64) -> f64 {
        self.law.pressure_increment(P0, closure * self.unit).value
    }
}

impl ODE for InterfaceEquation<'_> {
    fn diff(&self, time: f64, closure: &f64, rate: &mut f64) {
        let t = time / self.alpha;
        let incident = if (0.0..PULSE).contains(&t) {
            self.peak * (PI * t / PULSE).sin().powi(2)
        } else {
            0.0
        };
        *rate = (incident - self.pressure_increment(*closure)) / P0;
    }
}

/// Pressure and closure increments at `times` [s] from the interface's own equation, by the method
/// DOP853 of an independent library. Its dense output is of fourth order: steps are short.
fn interface_equation(law: &Law, peak: f64, times: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let equation = InterfaceEquation::new(law, peak);
    let mut closures = Vec::new();
    // The pulse and what follows it are solved apart: its curvature jumps where it ends.
    let pulse_ends = times.partition_point(|&t| t < PULSE);
    let (during, after) = times.split_at(pulse_ends);
    let mut from = (0.0, 0.0);
    for (part, until) in [(during, PULSE), (after, times.last().copied().unwrap_or(PULSE))] {
        let until = until * equation.alpha;
        let mut ends: Vec<f64> = part.iter().map(|t| t * equation.alpha).collect();
        ends.push(until);
        let method = ExplicitRungeKutta::dop853().rtol(1e-10).atol(1e-12).h_max(0.02);
        let solution = IVP::ode(&equation, from.0, until, from.1)
            .t_eval(&ends)
            .method(method.max_steps(1_000_000))
            .solve()
            .unwrap();
        let solved = &solution.y[..part.len()];
        from = (until, *solution.y.last().unwrap());
        closures.extend(solved.iter().map(|y| y * equation.unit));
    }
    let pressures = closures.iter().map(|&y| equation.pressure_increment(y / equation.unit));
    (pressures.collect(), closures)
}

/// The independent library agrees with exact solution 2.
#[test]
fn the_interface_equation_of_a_linear_law_has_its_closed_form() {
    let law = constant();
    let peak = 0.5 * P0;
    let alpha = 2.0 * law.stiffness(P0) / impedance();
    let times: Vec<f64> = (1..=200).map(|n| f64::from(n) * PULSE / 80.0).collect();
    let (pressures, _) = interface_equation(&law, peak, &times);
    for (&t, pressure) in times.iter().zip(pressures) {
        let exact = transmitted_haversine(alpha, t);
        assert!((pressure / peak - exact).abs() < 1e-9, "{t}: {pressure} {exact}");
    }
}

/// Errors of transmitted pressure and of closure for each grid, and the time
/// that contact was lost on the finest [s].
fn against_the_interface_equation(law: &Law, peak: f64) -> (Vec<f64>, Vec<f64>, f64) {
    let stack = stack(law, P0);
    let d0 = law.closure(P0);
    let (mut pressure, mut closure, mut lost) = (Vec::new(), Vec::new(), 0.0);
    for cells in CELLS {
        let transient = run(&stack, cells, &pulse(peak), 3.0);
        let (times, samples) = window(&transient);
        let (q, d) = interface_equation(law, peak, &times);
        let found_q: Vec<f64> = samples.pressure.iter().map(|p| p - P0).collect();
        let found_d: Vec<f64> = samples.closure.iter().map(|c| c - d0).collect();
        pressure.push(relative_norm(&found_q, &q));
        closure.push(relative_norm(&found_d, &d));
        lost = transient.contacts[0].lost;
    }
    (pressure, closure, lost)
}

/// Exact solution 3, while contact holds: slope 2.
#[test]
fn a_nonlinear_interface_follows_its_own_equation() {
    for (name, law) in
        [("power", power()), ("modified", modified()), ("exponential", exponential())]
    {
        for peak in [1.5 * P0, -0.6 * P0] {
            let (pressure, closure, lost) = against_the_interface_equation(&law, peak);
            let orders = (slope(&sizes(), &pressure), slope(&sizes(), &closure));
            assert_eq!(lost, 0.0, "{name}");
            for (order, errors) in [(orders.0, &pressure), (orders.1, &closure)] {
                assert!((1.85..2.15).contains(&order), "{name} {peak}: {order} {errors:?}");
            }
            assert!(pressure[3] < 1e-3 && closure[3] < 1e-3, "{name}");
        }
    }
}

/// Exact solution 3, with contact lost and regained.
#[test]
fn an_interface_that_opens_follows_its_own_equation() {
    let unilateral: Law = Arc::new(Constant::unilateral(8.5e11).unwrap());
    let laws = [("power", power()), ("modified", modified()), ("unilateral", unilateral)];
    for (name, law) in laws {
        let (pressure, closure, lost) = against_the_interface_equation(&law, -3.0 * P0);
        let orders = (slope(&sizes(), &pressure), slope(&sizes(), &closure));
        assert!(lost > 0.3 * PULSE, "{name}: {lost}");
        for (order, errors) in [(orders.0, &pressure), (orders.1, &closure)] {
            assert!((1.8..2.2).contains(&order), "{name}: {order} {errors:?}");
        }
    }
}

/// Amplitudes [Pa] of the first and second harmonic of the transmitted pressure
/// over the last whole periods before the first echo.
fn harmonics(law: &Law, number: f64, peak: f64, cells: usize) -> (f64, f64, f64) {
    let k1 = law.stiffness(P0);
    let w = number * 2.0 * k1 / impedance();
    let frequency = w / TAU;
    let stack = stack(law, P0);
    let excitation = LoadCase::force(TimeFunction::Harmonic { frequency }, peak * AREA);
    let transient = run(&stack, cells, &excitation, 3.0);
    let (times, samples) = window(&transient);
    // The last period, resampled by cubic interpolation at whole fractions of it.
    let points = 256;
    let last = times[times.len() - 3];
    let first = last - TAU / w;
    // The start of the wave leaves a transient exp(-alpha t) behind: 1e-11 of it is left.
    assert!(first * 2.0 * k1 / impedance() > 25.0, "the window is too short for W = {number}");
    let step = TAU / w / f64::from(points);
    let wave: Vec<f64> = (0..points)
        .map(|i| cubic(&times, &samples.pressure, first + f64::from(i) * step) - P0)
        .collect();
    let amplitude = |order: f64| {
        2.0 * transform(&wave, step, order * frequency).norm() / (f64::from(points) * step)
    };
    (w, amplitude(1.0), amplitude(2.0))
}

/// Lagrange's cubic through the four samples about `time`.
fn cubic(times: &[f64], values: &[f64], time: f64) -> f64 {
    let interval = times[1] - times[0];
    let place = (time - times[0]) / interval;
    let i = place.floor();
    let t = place - i;
    let i = i as usize;
    let [a, b, c, d] = [values[i - 1], values[i], values[i + 1], values[i + 2]];
    -a * t * (t - 1.0) * (t - 2.0) / 6.0 + b * (t + 1.0) * (t - 1.0) * (t - 2.0) / 2.0
        - c * (t + 1.0) * t * (t - 2.0) / 2.0
        + d * (t + 1.0) * t * (t - 1.0) / 6.0
}

/// Exact solution 4: the second harmonic over the ratio W, and its slope 2 in
/// the amplitude of the incident wave.
#[test]
fn the_second_harmonic_follows_the_perturbation_solution() {
    for (name, law) in [("power", power()), ("exponential", exponential())] {
        let k1 = law.stiffness(P0);
        let k2 = 0.5 * law.stiffness_slope(P0) * k1;
        for number in [0.25, 0.5, 1.0, 2.0] {
            let peaks = [0.005 * P0, 0.01 * P0, 0.02 * P0];
            let mut seconds = Vec::new();
            for peak in peaks {
                let (w, first, second) = harmonics(&law, number, peak, CELLS[3]);
                seconds.push(second);
                // A wave of displacement A has the pressure Z w A.
                let a = peak / (impedance() * w);
                let shape = number * number
                    / ((1.0 + number * number) * (1.0 + 4.0 * number * number).sqrt());
                let expected = k2 / k1 * a * a * shape;
                let found = second / (impedance() * 2.0 * w);
                let linear = 1.0 / number.hypot(1.0);
                let off = (first / peak / linear - 1.0, found / expected - 1.0);
                // The next order is (P / p0)^2 = 4e-4 at most; the law's table adds its
                // error of up to 1e-6 p0, of which some 1e-9 p0 fall on a second
                // harmonic of 1e-6 p0.
                assert!(off.0.abs() < 1e-4 && off.1.abs() < 5e-4, "{name} W {number}: {off:?}");
            }
            let order = slope(&peaks, &seconds);
            assert!((1.99..2.01).contains(&order), "{name} W {number}: {order}");
        }
    }
}

/// The power law's own coefficients, `K1 = C p^m`, `K2 = m C^2 p^(2m-1) / 2`.
#[test]
fn the_coefficients_of_the_power_law_are_its_taylor_series() {
    let law = Power::new(1.81e10, 0.35, 0.0).unwrap();
    let (k1, k2) =
        (1.81e10 * P0.powf(0.35), 0.5 * 0.35 * 1.81e10_f64.powi(2) * P0.powf(2.0 * 0.35 - 1.0));
    let d = 1e-10;
    let q = law.pressure_increment(P0, d).value;
    assert!(((q - k1 * d) / (k2 * d * d) - 1.0).abs() < 1e-3);
}
