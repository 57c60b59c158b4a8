//! Laws in series against closed forms.

use std::sync::Arc;

use asperity_law::quadrature::closure_between;
use asperity_law::{
    Constant, ContactLaw, Exponential, Hyperbolic, InSeries, LawError, LawQuantity, LawsInSeries,
    Power, Pressure, SeriesContact, Tabulated,
};

fn power() -> Arc<dyn ContactLaw> {
    Arc::new(Power::new(1.81e10, 0.35, 0.0).unwrap())
}

fn close(what: &str, found: f64, expected: f64, relative: f64) {
    let off = (found - expected).abs();
    assert!(off <= relative * expected.abs(), "{what}: {found:e}, expected {expected:e}");
}

const PRESSURES: [f64; 5] = [1e-3, 50.0, 1.4e5, 2.3e6, 1e9];

/// One law with a layer is [`InSeries`]; so is a law with a constant stiffness.
#[test]
fn a_constant_stiffness_is_a_layer() {
    let stiffness = 7e11;
    let layer = InSeries::new(power(), stiffness).unwrap();
    let alone = LawsInSeries::new(vec![SeriesContact::new(power())], 1.0 / stiffness).unwrap();
    let constant = SeriesContact::new(Arc::new(Constant::new(stiffness).unwrap()));
    // However much it weighs.
    let constant = SeriesContact { pressure_offset: -3e4, ..constant };
    let pair = LawsInSeries::new(vec![SeriesContact::new(power()), constant], 0.0).unwrap();
    for series in [alone, pair] {
        assert_eq!(series.domain(), layer.domain());
        assert_eq!(series.reference_pressure(), layer.reference_pressure());
        for p in PRESSURES {
            let d = layer.closure(p);
            close("closure", series.closure(p), d, 1e-14);
            close("stiffness", series.stiffness(p), layer.stiffness(p), 1e-14);
            close("slope", series.stiffness_slope(p), layer.stiffness_slope(p), 1e-13);
            close("pressure", series.pressure(d).value, p, 1e-13);
            close("energy", series.energy(d), layer.energy(d), 1e-12);
            for x in [1e-12, 1e-8, -1e-8, -1e-5] {
                let (a, b) = (series.pressure_increment(p, x), layer.pressure_increment(p, x));
                close("increment", a.value, b.value, 1e-12);
                close("tangent", a.tangent, b.tangent, 1e-11);
            }
        }
    }
}

/// A soft layer that is closed at a few Pa: nothing of it shows in the law at 1e8 Pa, where the
/// quadrature of the default starts.
#[test]
fn the_default_closure_finds_a_soft_layer_far_below() {
    let soft = Hyperbolic::new(1e8, 4.6e-8).unwrap();
    let stiff = Constant::new(1e6).unwrap();
    for p in [1e6, 8.6e8] {
        let pair: Vec<Arc<dyn ContactLaw>> = vec![Arc::new(soft), Arc::new(stiff)];
        let pair =
            LawsInSeries::new(pair.into_iter().map(SeriesContact::new).collect(), 0.0).unwrap();
        let exact = soft.closure(p) + stiff.closure(p);
        close("closed form", pair.closure(p), exact, 1e-15);
        close("quadrature", closure_between(&pair, 0.0, p), exact, 1e-13);
    }
}

/// Equal laws take equal shares: n of them reach the pressure of one at n times its closure, with n
/// times its energy.
#[test]
fn equal_laws_share_the_closure() {
    let laws: [Arc<dyn ContactLaw>; 4] = [
        power(),
        Arc::new(Exponential::new(3e-8, 1.4e5).unwrap()),
        Arc::new(Hyperbolic::new(1e11, 1e-6).unwrap()),
        Arc::new(Tabulated::new(&[(0.0, 1e11), (2e5, 1.2e12), (1e6, 2.5e12)]).unwrap()),
    ];
    for law in laws {
        let series = LawsInSeries::new(vec![SeriesContact::new(law.clone()); 3], 0.0).unwrap();
        let (own, all) = (law.domain(), series.domain());
        assert_eq!(all.closure_lost, own.closure_lost.map(|lost| 3.0 * lost));
        close("limit", all.closure_limit.min(1e9), (3.0 * own.closure_limit).min(1e9), 1e-15);
        for p in PRESSURES {
            let d = law.closure(p);
            close("closure", series.closure(p), 3.0 * d, 1e-14);
            close("stiffness", series.stiffness(p), law.stiffness(p) / 3.0, 1e-14);
            close("slope", series.stiffness_slope(p), law.stiffness_slope(p) / 3.0, 1e-14);
            close("energy", series.energy(3.0 * d), 3.0 * law.energy(d), 1e-11);
            for increment in [0.3 * p, -0.3 * p, 1e-9 * p] {
                let x = 3.0 * law.closure_increment(p, increment);
                close("increment", series.pressure_increment(p, x).value, increment, 1e-12);
            }
        }
    }
}

/// A contact on a wider one that also carries the weight between them: the closures of the contacts
/// at their own pressures.
#[test]
fn contacts_close_at_their_own_pressures() {
    let (ratio, weight, compliance) = (0.4, 3.2e4, 2.1e-13);
    let lower: Arc<dyn ContactLaw> = Arc::new(Hyperbolic::new(3e11, 2e-6).unwrap());
    let second =
        SeriesContact { law: lower.clone(), pressure_ratio: ratio, pressure_offset: weight };
    let series = LawsInSeries::new(vec![SeriesContact::new(power()), second], compliance).unwrap();
    for p in PRESSURES {
        let below = lower.closure_increment(weight, ratio * p);
        let d = power().closure(p) + below + compliance * p;
        close("closure", series.closure(p), d, 1e-14);
        let softness =
            1.0 / power().stiffness(p) + ratio / lower.stiffness(weight + ratio * p) + compliance;
        close("stiffness", series.stiffness(p), 1.0 / softness, 1e-14);
        // Work of each contact beyond that of the weight, in areas of the series.
        let work = |p: f64| lower.energy(lower.closure(p));
        let stored = work(weight + ratio * p) - work(weight) - weight * below;
        let energy = power().energy(power().closure(p)) + stored / ratio;
        let rounding = 1e-15 * work(weight + ratio * p) / ratio;
        let expected = energy + 0.5 * compliance * p * p;
        let off = (series.energy(d) - expected).abs();
        assert!(off < 1e-11 * expected + 8.0 * rounding, "energy at {p}: off by {off:e}");
        assert_eq!(series.pressure_increment(p, -1.01 * d), Pressure::lost_from(p));
    }
    assert_eq!(series.domain().closure_lost, Some(0.0));
}

/// The contact that is lost first decides.
#[test]
fn loss_of_contact_is_that_of_the_first() {
    let adhesive: Arc<dyn ContactLaw> = Arc::new(Exponential::new(3e-8, 1.4e5).unwrap());
    let pair = |upper: &Arc<dyn ContactLaw>, lower: &Arc<dyn ContactLaw>, weight: f64| {
        let below = SeriesContact { pressure_offset: weight, ..SeriesContact::new(lower.clone()) };
        LawsInSeries::new(vec![SeriesContact::new(upper.clone()), below], 0.0)
    };
    let separates = |series: Result<LawsInSeries, LawError>| series.unwrap().domain().separates();
    assert!(separates(pair(&power(), &adhesive, 300.0)));
    assert!(!separates(pair(&power(), &adhesive, 0.0)));
    assert!(!separates(pair(&adhesive, &power(), 300.0)));
    let spring: Arc<dyn ContactLaw> = Arc::new(Constant::new(1e12).unwrap());
    assert!(pair(&spring, &spring, 300.0).unwrap().domain().is_bilateral());
    // A spring above carries tension until the contact below it is lost, below zero pressure.
    let quantity = LawQuantity::PressureOffset;
    let expected = LawError::Above { quantity, value: 300.0, limit: 0.0 };
    assert_eq!(pair(&spring, &power(), 300.0).unwrap_err(), expected);
    let expected = LawError::Below { quantity, value: -1.0, limit: 0.0 };
    assert_eq!(pair(&power(), &power(), -1.0).unwrap_err(), expected);
    assert!(LawsInSeries::new(Vec::new(), 0.0).is_err());
    assert!(LawsInSeries::new(vec![SeriesContact::new(power())], -1e-12).is_err());
    let turned = SeriesContact { pressure_ratio: 0.0, ..SeriesContact::new(power()) };
    assert!(LawsInSeries::new(vec![turned], 0.0).is_err());
}
