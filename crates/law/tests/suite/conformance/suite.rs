//! Properties that every contact law has.
//!
//! Tolerances are multiples of the rounding `EPS` and of the condition number of what is computed:
//! a pressure found from a closure of magnitude d, known to EPS d, is known to K EPS d.

use asperity_law::quadrature::work_between;
use asperity_law::{ContactLaw, Domain, Pressure};
use proptest::prelude::*;

const EPS: f64 = f64::EPSILON;

/// Relative precision of the quadrature defaults.
const QUADRATURE: f64 = 1e-12;

/// Relative precision of short steps.
const SHORT_STEP: f64 = 1e-12;

type Outcome = Result<(), TestCaseError>;

/// A law without its closed forms: only the methods that the trait requires.
#[derive(Debug)]
struct Bare<'a>(&'a dyn ContactLaw);

impl ContactLaw for Bare<'_> {
    fn stiffness(&self, pressure: f64) -> f64 {
        self.0.stiffness(pressure)
    }
    fn stiffness_slope(&self, pressure: f64) -> f64 {
        self.0.stiffness_slope(pressure)
    }
    fn domain(&self) -> Domain {
        self.0.domain()
    }
    fn reference_pressure(&self) -> f64 {
        self.0.reference_pressure()
    }
    fn kinks(&self) -> Vec<f64> {
        self.0.kinks()
    }
}

fn close(what: &str, found: f64, expected: f64, tolerance: f64) -> Outcome {
    prop_assert!(
        (found - expected).abs() <= tolerance,
        "{what}: {found:e}, expected {expected:e}, off by {:e}, tolerance {tolerance:e}",
        (found - expected).abs()
    );
    Ok(())
}

/// Holds `law` to the suite at ascending positive pressures.
pub(crate) fn conform(law: &dyn ContactLaw, pressures: &[f64]) -> Outcome {
    let mut all = pressures.to_vec();
    if law.domain().is_bilateral() {
        all = pressures.iter().rev().map(|p| -p).chain(all).collect();
    }
    for &p in &all {
        closures_agree(law, p)?;
        round_trip(law, p)?;
        increments_agree(law, p)?;
        short_steps_agree(law, p)?;
        energies_agree(law, p)?;
        differences_agree(law, p)?;
    }
    interpolations_agree(law, &all)?;
    monotone(law, &all)?;
    limits(law, pressures)?;
    separation(law, pressures)
}

/// Closed form against quadrature of `1/K`; it also ties K to d.
fn closures_agree(law: &dyn ContactLaw, p: f64) -> Outcome {
    let d = Bare(law).closure(p);
    close("closure", law.closure(p), d, QUADRATURE * d.abs())
}

/// Largest error of interpolated pressures over the next pressure at which the law is not smooth.
const INTERPOLATED: f64 = 1e-10;

/// Pressures from the polynomials of a law that has them, in order and in turn.
fn interpolations_agree(law: &dyn ContactLaw, pressures: &[f64]) -> Outcome {
    let (kinks, mut found) = (law.kinks(), Vec::new());
    let turned = pressures.iter().rev().chain(pressures);
    let closures: Vec<f64> = turned.clone().map(|&p| law.closure(p)).collect();
    if !law.interpolate(&closures, &mut found) {
        return Ok(());
    }
    prop_assert_eq!(found.len(), closures.len());
    for (&p, at) in turned.zip(found) {
        let next = kinks.iter().copied().find(|kink| *kink >= p).unwrap_or(p);
        close("interpolated", at.value, p, rounding_of(law, p) + INTERPOLATED * next)?;
        close("its tangent", at.tangent, law.stiffness(at.value), 64.0 * EPS * at.tangent)?;
    }
    Ok(())
}

/// Rounding of a pressure found from its closure.
fn rounding_of(law: &dyn ContactLaw, p: f64) -> f64 {
    // Powers and logarithms of pressures up to 1e9 magnify rounding by ln(1e9) = 21 at most: that
    // of the pressure, and that of the closure from a reference pressure far above.
    32.0 * EPS * (p.abs() + law.stiffness(p) * law.closure(p).abs())
}

/// Pressure to closure and back, by closed form and by the default.
fn round_trip(law: &dyn ContactLaw, p: f64) -> Outcome {
    let d = law.closure(p);
    let back = law.pressure(d);
    let rounding = rounding_of(law, p);
    close("round trip", back.value, p, rounding)?;
    let k = law.stiffness(back.value);
    close("tangent", back.tangent, k, 64.0 * EPS * k)?;

    let bare = Bare(law).pressure(d);
    let condition = p.abs() + law.stiffness(p) * d.abs();
    close("default pressure", bare.value, p, rounding + QUADRATURE * condition)?;
    close("default tangent", bare.tangent, law.stiffness(bare.value), 0.0)
}

/// Increments of closure and pressure, down to relative sizes of 1e-12, keep their precision.
fn increments_agree(law: &dyn ContactLaw, p: f64) -> Outcome {
    for size in [-0.9, -0.3, -1e-4, -1e-12, 0.0, 1e-12, 1e-8, 1e-2, 0.7, 30.0] {
        let dp = size * p.abs();
        let x = law.closure_increment(p, dp);
        let by_quadrature = Bare(law).closure_increment(p, dp);
        close("closure increment", x, by_quadrature, QUADRATURE * x.abs())?;
        let difference = law.closure(p + dp) - law.closure(p);
        let rounding = EPS * (law.closure(p).abs() + law.closure(p + dp).abs());
        // p + dp itself is rounded.
        let shift = EPS * (p + dp).abs() / law.stiffness(p + dp);
        let slack = 32.0 * rounding + shift + QUADRATURE * x.abs();
        close("difference of closures", x, difference, slack)?;

        let back = law.pressure_increment(p, x);
        let condition = 32.0 * dp.abs() + 8.0 * law.stiffness(p + dp) * x.abs();
        close("increment round trip", back.value, dp, EPS * condition)?;
        let bare = Bare(law).pressure_increment(p, x);
        close("default increment", bare.value, dp, QUADRATURE * condition)?;
        // The tangent is taken at p + dp, whose last digit is lost where dp nearly undoes p.
        let near = Pressure { value: p + dp, tangent: law.stiffness(p + dp) };
        let slip = law.stiffness_slope(near.value).abs() * EPS * (8.0 * p.abs() + condition);
        let slack = 64.0 * EPS * near.tangent + slip;
        close("tangent of increment", back.tangent, near.tangent, slack)?;
    }
    Ok(())
}

/// Short steps against the inverse, where a law has one that is short enough.
fn short_steps_agree(law: &dyn ContactLaw, p: f64) -> Outcome {
    for share in [1e-4, 1e-3, 1e-2, 0.1, -1e-3, -1e-2, -0.1] {
        let x = share * p.abs() / law.stiffness(p);
        if let Some(step) = law.pressure_step(p, x) {
            let dp = law.pressure_increment(p, x).value;
            close("short step", step.value, dp, SHORT_STEP * dp.abs() + EPS * p.abs())?;
        }
    }
    Ok(())
}

/// Energy against quadrature of `p/K`.
fn energies_agree(law: &dyn ContactLaw, p: f64) -> Outcome {
    let d = law.closure(p);
    let start = if law.domain().separates() { 0.0 } else { law.reference_pressure() };
    let work = work_between(law, start, p);
    // The closure's rounding times dE/dd = p.
    let rounding = 32.0 * EPS * (p * d).abs() + p.abs() * rounding_of(law, p) / law.stiffness(p);
    let slack = QUADRATURE * work.abs() + rounding;
    close("energy", law.energy(d), work, slack)?;
    let slack = slack + QUADRATURE * ((p * d).abs() + p * p / law.stiffness(p));
    close("default energy", Bare(law).energy(d), work, slack)
}

/// Tangent, slope and energy gradient against central differences, away from kinks.
fn differences_agree(law: &dyn ContactLaw, p: f64) -> Outcome {
    let reach = 1e-5;
    if law.kinks().iter().any(|k| (k - p).abs() < 10.0 * reach * p.abs()) {
        return Ok(());
    }
    // Steps of 1e-5 of the natural scale leave an error of 1e-10 times the third derivative on
    // that scale, which steep cells of a table make as large as 1e3.
    let truncation = 1e-6;
    let k = law.stiffness(p);
    let h = reach * p.abs() / k;
    let (up, down) = (law.pressure_increment(p, h), law.pressure_increment(p, -h));
    close("tangent by difference", (up.value - down.value) / (2.0 * h), k, truncation * k)?;

    let dp = reach * p.abs();
    let slope = law.stiffness_slope(p);
    let difference = (law.stiffness(p + dp) - law.stiffness(p - dp)) / (2.0 * dp);
    let scale = slope.abs() + k / p.abs();
    close("slope by difference", difference, slope, truncation * scale)?;

    let d = law.closure(p);
    if h < 1e3 * EPS * d.abs() {
        return Ok(()); // next to the closure limit such a step is rounding
    }
    let (more, less) = (law.energy(d + h), law.energy(d - h));
    let rounding = 64.0 * EPS * (more.abs() + less.abs() + (p * d).abs()) / h;
    let gradient = (more - less) / ((d + h) - (d - h));
    close("energy gradient", gradient, p, truncation * p.abs() + rounding)
}

fn monotone(law: &dyn ContactLaw, ascending: &[f64]) -> Outcome {
    for pair in ascending.windows(2) {
        let (d0, d1) = (law.closure(pair[0]), law.closure(pair[1]));
        prop_assert!(d0 <= d1, "closures {d0:e}, {d1:e} at {pair:?}");
        prop_assert!(
            law.pressure(d0).value <= law.pressure(d1).value + 2.0 * rounding_of(law, pair[1])
        );
        prop_assert!(law.energy(d0) <= law.energy(d1) || pair[0] < 0.0);
        prop_assert!(law.stiffness(pair[0]) > 0.0);
    }
    Ok(())
}

/// Zero pressure, the closure limit, and numbers that are none.
fn limits(law: &dyn ContactLaw, pressures: &[f64]) -> Outcome {
    let domain = law.domain();
    let reference = law.reference_pressure();
    prop_assert_eq!(law.closure(reference), 0.0);
    let at_reference = law.pressure(0.0).value;
    close("pressure at zero closure", at_reference, reference, 32.0 * EPS * reference)?;
    let p = pressures[0];
    prop_assert!(law.pressure(f64::NAN).value.is_nan());
    prop_assert!(law.pressure_increment(p, f64::NAN).value.is_nan());
    prop_assert!(law.closure(f64::NAN).is_nan());
    prop_assert!(law.closure_increment(p, f64::NAN).is_nan());
    prop_assert!(law.energy(f64::NAN).is_nan());
    prop_assert!(law.stiffness(f64::NAN).is_nan() || law.stiffness_slope(1.0) == 0.0);
    prop_assert!(law.closure(pressures[0]) < domain.closure_limit);
    let high = law.closure(1e30);
    prop_assert!(high <= domain.closure_limit, "{high:e} passes the limit");
    if domain.closure_limit.is_finite() {
        prop_assert_eq!(law.pressure(domain.closure_limit), Pressure::RIGID);
        prop_assert_eq!(law.pressure(2.0 * domain.closure_limit), Pressure::RIGID);
        let room = domain.closure_limit - law.closure(pressures[5]);
        prop_assert!(law.pressure(domain.closure_limit - 0.5 * room).value > pressures[5]);
        prop_assert!(law.pressure_increment(pressures[0], f64::INFINITY).value == f64::INFINITY);
    }
    if domain.is_bilateral() {
        return Ok(());
    }
    prop_assert_eq!(law.stiffness(-1.0), 0.0);
    prop_assert_eq!(law.closure(-1.0), law.closure(0.0));
    if !domain.separates() {
        prop_assert_eq!(law.closure(0.0), f64::NEG_INFINITY);
        prop_assert_eq!(law.stiffness(0.0), 0.0);
        let far = law.pressure(law.closure(1e-9)).value;
        prop_assert!(far > 0.0 && far < 2e-9, "{far:e} Pa far below");
    }
    Ok(())
}

/// Loss of contact at a finite closure.
fn separation(law: &dyn ContactLaw, pressures: &[f64]) -> Outcome {
    let domain = law.domain();
    prop_assert_eq!(domain.separates(), domain.closure_lost.is_some());
    let Some(lost) = domain.closure_lost else {
        return Ok(());
    };
    prop_assert_eq!(law.closure(0.0), lost);
    prop_assert_eq!(law.energy(lost), 0.0);
    let touching = Pressure { value: 0.0, tangent: law.stiffness(0.0) };
    prop_assert_eq!(law.pressure(lost), touching);
    for p in pressures {
        let apart = lost - law.closure_increment(0.0, *p);
        prop_assert_eq!(law.pressure(apart), Pressure::OPEN);
        prop_assert_eq!(Bare(law).pressure(apart), Pressure::OPEN);
        prop_assert_eq!(law.energy(apart), 0.0);
        let away = law.closure_increment(*p, -p) * (1.0 + 1e-9);
        let open = Pressure { value: -p, tangent: 0.0 };
        prop_assert_eq!(law.pressure_increment(*p, away), open);
        prop_assert_eq!(Bare(law).pressure_increment(*p, away), open);
        // Pressures below zero are none.
        prop_assert_eq!(law.closure_increment(*p, -2.0 * p), law.closure_increment(*p, -p));
    }
    Ok(())
}
