//! Families of laws, with parameters over wide ranges.

use std::sync::Arc;

use asperity_law::{
    Constant, ContactLaw, Exponential, GreenwoodWilliamson, Hyperbolic, ModifiedPower, Persson,
    Power, Tabulated,
};
use proptest::prelude::*;

pub(crate) type AnyLaw = Arc<dyn ContactLaw>;

pub(crate) fn log_uniform(low: f64, high: f64) -> impl Strategy<Value = f64> {
    (low.ln()..high.ln()).prop_map(f64::exp)
}

/// Six pressures from 1 Pa to 1e9 Pa, ascending.
pub(crate) fn pressures() -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(log_uniform(1.0, 1e9), 6).prop_map(|mut p| {
        p.sort_by(f64::total_cmp);
        p
    })
}

pub(crate) fn constant() -> impl Strategy<Value = Constant> {
    log_uniform(1e6, 1e16).prop_map(|k| Constant::new(k).unwrap())
}

pub(crate) fn constant_unilateral() -> impl Strategy<Value = Constant> {
    log_uniform(1e6, 1e16).prop_map(|k| Constant::unilateral(k).unwrap())
}

/// Coefficient that gives a stiffness of 1e9 to 1e15 Pa/m at 1e5 Pa.
fn coefficient(stiffness: f64, exponent: f64) -> f64 {
    stiffness * 1e5_f64.powf(-exponent)
}

pub(crate) fn power_below_one() -> impl Strategy<Value = Power> {
    (log_uniform(1e9, 1e15), prop_oneof![Just(0.0), 0.0..0.99])
        .prop_map(|(k, m)| Power::new(coefficient(k, m), m, 0.0).unwrap())
}

pub(crate) fn power_below_one_referred() -> impl Strategy<Value = Power> {
    (log_uniform(1e9, 1e15), 0.0..0.99, log_uniform(1e2, 1e7))
        .prop_map(|(k, m, p)| Power::new(coefficient(k, m), m, p).unwrap())
}

pub(crate) fn power_from_one_on() -> impl Strategy<Value = Power> {
    let exponent = prop_oneof![Just(1.0), Just(2.0), 1.01..3.0];
    (log_uniform(1e9, 1e15), exponent, log_uniform(1e2, 1e7))
        .prop_map(|(k, m, p)| Power::new(coefficient(k, m), m, p).unwrap())
}

/// Exponents that differ from one by 1e-3 to 1e-15, either way.
pub(crate) fn power_next_to_one() -> impl Strategy<Value = Power> {
    let off = (log_uniform(1e-15, 1e-3), prop::bool::ANY);
    let m = off.prop_map(|(off, up)| if up { 1.0 + off } else { 1.0 - off });
    (log_uniform(1e9, 1e15), m, log_uniform(1e2, 1e7))
        .prop_map(|(k, m, p)| Power::new(coefficient(k, m), m, p).unwrap())
}

pub(crate) fn exponential() -> impl Strategy<Value = Exponential> {
    (log_uniform(1e-9, 1e-5), log_uniform(1e2, 1e7))
        .prop_map(|(u0, p)| Exponential::new(u0, p).unwrap())
}

pub(crate) fn hyperbolic() -> impl Strategy<Value = Hyperbolic> {
    (log_uniform(1e8, 1e14), log_uniform(1e-8, 1e-4))
        .prop_map(|(k, d)| Hyperbolic::new(k, d).unwrap())
}

/// Pressure scales of 2e4 Pa to 3e11 Pa, with gaps from 9 to -1000 standard deviations.
pub(crate) fn greenwood_williamson() -> impl Strategy<Value = GreenwoodWilliamson> {
    let shape = (log_uniform(1e8, 1e12), log_uniform(1e-6, 1e-3), log_uniform(1e-8, 1e-5));
    (shape, log_uniform(1e9, 1e12), log_uniform(1e2, 1e7)).prop_map(
        |((density, radius, height), modulus, p)| {
            GreenwoodWilliamson::new(density, radius, height, modulus, p).unwrap()
        },
    )
}

/// Rough enough that no pressure is 20 times that of full contact.
pub(crate) fn persson() -> impl Strategy<Value = Persson> {
    let shape =
        (log_uniform(0.05, 1.0), log_uniform(1e3, 1e6), 0.3..1.0_f64, log_uniform(3.0, 1e4));
    (shape, log_uniform(2e11, 1e12), log_uniform(1e2, 1e7)).prop_map(
        |((steepness, roll_off, hurst, range), modulus, p)| {
            let wavevectors = [roll_off, roll_off * range];
            Persson::new(steepness / roll_off, hurst, wavevectors, modulus, p).unwrap()
        },
    )
}

/// Two to seven points, from zero pressure or not, whose stiffnesses rise and fall.
pub(crate) fn table() -> impl Strategy<Value = Tabulated> {
    let step = (log_uniform(1.2, 30.0), log_uniform(0.1, 10.0));
    let first = prop_oneof![Just(0.0), log_uniform(1e2, 1e6)];
    let start = (first, log_uniform(1e9, 1e14));
    (start, prop::collection::vec(step, 1..7)).prop_map(|((p, k), steps)| {
        let mut points = vec![(p, k)];
        let (mut p, mut k) = (p.max(1e3), k);
        for (dp, dk) in steps {
            (p, k) = (p * dp, k * dk);
            points.push((p, k));
        }
        Tabulated::new(&points).unwrap()
    })
}

/// A power law softened below a transition, with one to five knots.
pub(crate) fn modified_power() -> impl Strategy<Value = ModifiedPower> {
    let knots = prop::collection::vec(0.05..1.0_f64, 0..5);
    (log_uniform(1e9, 1e15), 0.0..1.5_f64, log_uniform(1e3, 1e6), knots, 0.01..0.4_f64).prop_map(
        |(k, m, transition, gaps, softness)| {
            let c = k * transition.powf(-m);
            // In units of K and p at the transition the joint's slope is m. Secants of at least
            // m/2 from every knot to the joint keep it within three secants.
            let total: f64 = gaps.iter().sum::<f64>() + 0.5;
            let (mut u, mut knots) = (0.0, vec![(0.0, k * softness * 0.2)]);
            for gap in gaps {
                u += gap / total;
                let share = softness * (0.2 + 0.8 * u.powi(2));
                knots.push((u * transition, k * share.min(1.0 - 0.5 * m * (1.0 - u))));
            }
            ModifiedPower::new(c, m, transition, &knots).unwrap()
        },
    )
}

pub(crate) fn rough_surface() -> impl Strategy<Value = AnyLaw> {
    fn erase(law: impl ContactLaw + 'static) -> AnyLaw {
        Arc::new(law)
    }
    prop_oneof![greenwood_williamson().prop_map(erase), persson().prop_map(erase)]
}

pub(crate) fn any() -> impl Strategy<Value = AnyLaw> {
    fn erase(law: impl ContactLaw + 'static) -> AnyLaw {
        Arc::new(law)
    }
    prop_oneof![
        constant().prop_map(erase),
        constant_unilateral().prop_map(erase),
        power_below_one().prop_map(erase),
        power_below_one_referred().prop_map(erase),
        power_from_one_on().prop_map(erase),
        exponential().prop_map(erase),
        hyperbolic().prop_map(erase),
        table().prop_map(erase),
        modified_power().prop_map(erase),
    ]
}
