//! Laws with parameters over wide ranges: samples of the list of kinds, and families of extreme parameters.

use std::sync::Arc;

use asperity_law::{ContactLaw, Draw, LawSpec, Laws, Power, Tabulated};
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

/// Numbers that a sample draws from; zeros follow their end.
pub(crate) struct Stream(pub(crate) std::vec::IntoIter<f64>);

impl Draw for Stream {
    fn unit(&mut self) -> f64 {
        self.0.next().unwrap_or_default()
    }
}

/// A sample of a kind of the list, with its document form, about a state of 1e4 Pa to 1e7 Pa and 1e6 Pa/m to
/// 1e16 Pa/m. Kinds whose stiffness is an integral are drawn four times less often.
pub(crate) fn sample() -> impl Strategy<Value = (LawSpec, AnyLaw)> {
    let kind = 0..LawSpec::SAMPLERS.len();
    let numbers = prop::collection::vec(0.0..1.0_f64, 24);
    let state = (log_uniform(1e4, 1e7), log_uniform(1e6, 1e16));
    ([kind.clone(), kind], numbers, state).prop_map(|(kinds, numbers, (pressure, stiffness))| {
        let sample = |kind: usize| {
            let mut stream = Stream(numbers.clone().into_iter());
            LawSpec::SAMPLERS[kind](&mut stream, pressure, stiffness)
        };
        let mut spec = sample(kinds[0]);
        if matches!(spec, LawSpec::GreenwoodWilliamson(_) | LawSpec::Persson(_)) {
            spec = sample(kinds[1]);
        }
        let law = Laws::default().build(&spec.clone().into(), pressure).unwrap();
        (spec, law)
    })
}

/// A law of any kind.
pub(crate) fn any() -> impl Strategy<Value = AnyLaw> {
    sample().prop_map(|(_, law)| law)
}
