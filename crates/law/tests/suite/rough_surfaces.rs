//! Laws of rough surfaces against their limiting cases and an independent integration.

use asperity_law::{ContactLaw, GreenwoodWilliamson, Persson};

const DENSITY: f64 = 1e10;
const RADIUS: f64 = 50e-6;
const HEIGHT: f64 = 0.5e-6;
const MODULUS: f64 = 39.8e9;

fn greenwood_williamson() -> GreenwoodWilliamson {
    GreenwoodWilliamson::new(DENSITY, RADIUS, HEIGHT, MODULUS, 0.14e6).unwrap()
}

/// Integral of `f` from zero to `top` by Simpson's rule.
fn simpson(f: impl Fn(f64) -> f64, top: f64) -> f64 {
    let cells = 200_000;
    let step = top / f64::from(cells);
    let weight = |i: i32| if i == 0 || i == cells { 1.0 } else { f64::from(2 + 2 * (i % 2)) };
    (0..=cells).map(|i| weight(i) * f(step * f64::from(i))).sum::<f64>() * step / 3.0
}

/// Pressure and stiffness at a gap, summed over Hertzian summits whose heights have the
/// density `heights` \[1/m\].
fn summits(gap: f64, heights: impl Fn(f64) -> f64) -> (f64, f64) {
    // A summit of approach t carries 4/3 E* R^(1/2) t^(3/2). With t = s^2 the integrand is smooth.
    let reach = (12.0 * HEIGHT - gap.min(0.0)).sqrt();
    let sum = |power: i32| simpson(|s| s.powi(power) * 2.0 * s * heights(gap + s * s), reach);
    let factor = MODULUS * DENSITY * RADIUS.sqrt();
    (4.0 / 3.0 * factor * sum(3), 2.0 * factor * sum(1))
}

#[test]
fn greenwood_williamson_is_the_sum_over_hertzian_summits() {
    let law = greenwood_williamson();
    let normal = |z: f64| {
        (-0.5 * (z / HEIGHT).powi(2)).exp() / (HEIGHT * (2.0 * std::f64::consts::PI).sqrt())
    };
    for gap in [4.0, 2.5, 1.0, 0.0, -1.0, -4.0] {
        let (pressure, stiffness) = summits(gap * HEIGHT, normal);
        assert!((law.gap(pressure) / HEIGHT - gap).abs() < 1e-8, "{gap}");
        assert!((law.stiffness(pressure) / stiffness - 1.0).abs() < 1e-8, "{gap}");
        let closure = law.gap(0.14e6) - gap * HEIGHT;
        assert!((law.pressure(closure).value / pressure - 1.0).abs() < 1e-7, "{gap}");
    }
}

/// The same summits with heights of exponential distribution have K = p / σ.
#[test]
fn exponential_heights_have_a_stiffness_proportional_to_pressure() {
    let exponential = |z: f64| (-z / HEIGHT).exp() / HEIGHT;
    for gap in [0.5, 1.0, 3.0, 6.0] {
        // The tail beyond the reach of the integration is 6e-6 of the whole.
        let (pressure, stiffness) = summits(gap * HEIGHT, exponential);
        assert!((stiffness * HEIGHT / pressure - 1.0).abs() < 1e-3, "{gap}");
    }
}

#[test]
fn greenwood_williamson_is_nearly_proportional_when_light_and_hertzian_when_heavy() {
    let law = greenwood_williamson();
    // F_1/2 / F_3/2 = (2 h / 3) (1 + 5 / (2 h^2) + ...) for large h.
    let pressure = 1e-30;
    let h = law.gap(pressure) / HEIGHT;
    let share = law.stiffness(pressure) * HEIGHT / (pressure * h);
    assert!((share - 1.0).abs() < 3.0 / (h * h) && h > 10.0, "{h} {share}");
    // All summits pressed by the same approach -u.
    let pressure = 1e14;
    let approach = -law.gap(pressure);
    let hertz = 4.0 / 3.0 * MODULUS * DENSITY * RADIUS.sqrt() * approach.powf(1.5);
    assert!((hertz / pressure - 1.0).abs() < 1e-4, "{hertz}");
    let stiffness = 1.5 * pressure / approach;
    assert!((law.stiffness(pressure) / stiffness - 1.0).abs() < 1e-4);
}

/// Stiffness by the theory's integral over wavevectors, with the power spectrum itself.
fn by_wavevectors(hurst: f64, pressure: f64) -> f64 {
    let [first, last] = WAVEVECTORS;
    let range: f64 = last / first;
    let pi = std::f64::consts::PI;
    let at_roll_off = RMS.powi(2) * hurst / (pi * first.powi(2) * (1.0 - range.powf(-2.0 * hurst)));
    let spectrum = |q: f64| at_roll_off * (q / first).powf(-2.0 - 2.0 * hurst);
    let power = 2.0 - 2.0 * hurst;
    // 1/w^2 = pi integral of q^3 C dq
    let inverse_square =
        |q: f64| pi * at_roll_off * first.powi(4) * ((q / first).powf(power) - 1.0) / power;
    // With q = q0 + s^2 the integrands are smooth where w is infinite.
    let integrand = |log: f64| {
        let s = (log.exp() - 1.0) * first.sqrt();
        let q = first + s * s;
        let w = 1.0 / inverse_square(q).sqrt();
        let x = (w * pressure / MODULUS).powi(2);
        let weight = q * q * spectrum(q) * w * 2.0 * s * (s + first.sqrt());
        if log == 0.0 { 0.0 } else { weight * (-x).exp() }
    };
    let length = pi.sqrt() * simpson(integrand, ((last / first - 1.0).sqrt() + 1.0).ln());
    pressure / length
}

const RMS: f64 = 1e-6;
const WAVEVECTORS: [f64; 2] = [1e4, 1e6];

#[test]
fn persson_is_the_integral_over_wavevectors() {
    for hurst in [0.5, 0.8] {
        let law = Persson::new(RMS, hurst, WAVEVECTORS, MODULUS, 0.14e6).unwrap();
        for pressure in [1e6, 1e7, 1e8, 1e9] {
            let stiffness = by_wavevectors(hurst, pressure);
            let error = law.stiffness(pressure) / stiffness - 1.0;
            assert!(error.abs() < 1e-7, "{hurst} {pressure}: {error:e}");
        }
    }
}

#[test]
fn persson_tends_to_an_exponential_law_at_low_pressures_and_to_contact_everywhere_at_high_ones() {
    for (hurst, expected) in [(0.5, 1.228_693_105_197_027), (0.8, 1.062_231_639_834_566)] {
        // Lengths over the rms height for a range of 1000, by quadrature with 25 digits.
        let law = Persson::new(RMS, hurst, [1e4, 1e7], MODULUS, 0.14e6).unwrap();
        assert!((law.length() / (expected * RMS) - 1.0).abs() < 1e-12, "{hurst}");
        let low = 1e-3;
        assert!((law.stiffness(low) * law.length() / low - 1.0).abs() < 1e-6);
        let ratio = law.pressure(law.closure(low) + 2.0 * law.length()).value / low;
        assert!((ratio / 2.0_f64.exp() - 1.0).abs() < 1e-5, "{ratio}");
        let full = MODULUS * law.rms_gradient();
        assert!(law.gap(5.0 * full) < 1e-6 * law.length());
        assert!(law.stiffness(3.0 * full) > 1e3 * 3.0 * full / law.length());
        assert_eq!(law.domain().closure_limit, law.gap(0.14e6));
    }
    // A Hurst exponent of one is the limit of smaller ones.
    let law = |hurst| Persson::new(RMS, hurst, WAVEVECTORS, MODULUS, 0.14e6).unwrap();
    let ratio = law(1.0).stiffness(1e8) / law(1.0 - 1e-9).stiffness(1e8);
    assert!((ratio - 1.0).abs() < 1e-7, "{ratio}");
}

/// The energy of full contact, where the pressure is infinite, is finite.
#[test]
fn persson_has_an_energy_at_full_contact() {
    let law = Persson::new(4.179e-4, 0.9085, [153.3, 65_520.0], 3.754e11, 1e5).unwrap();
    let limit = law.domain().closure_limit;
    let full = law.energy(limit);
    assert_eq!(law.closure(1e14), limit);
    let mut last = f64::NEG_INFINITY;
    for pressure in [1e4, 1e6, 1e9, 1e11, 1e12, 1e13] {
        let energy = law.energy(law.closure(pressure));
        assert!(energy >= last && energy <= full * (1.0 + 1e-12), "{pressure}: {energy}");
        last = energy;
    }
    assert!(full.is_finite() && full > 0.0);
    assert_eq!(law.energy(2.0 * limit), f64::INFINITY);
}
