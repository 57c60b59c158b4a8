//! Laws and fits with invalid input.

use asperity_law::{
    Constant, ContactLaw, Exponential, Hyperbolic, InSeries, LawError, LawQuantity, ModifiedPower,
    Power, Tabulated, fit_power,
};

const NOT_POSITIVE: [f64; 5] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1.0, 0.0];
const NEGATIVE: [f64; 4] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1e-300];

const KNOTS: [(f64, f64); 3] = [(0.0, 0.02e12), (0.078e6, 0.40e12), (0.14e6, 0.97e12)];

#[test]
fn parameters_that_must_be_positive() {
    for bad in NOT_POSITIVE {
        assert!(Constant::new(bad).is_err());
        assert!(Constant::unilateral(bad).is_err());
        assert!(Power::new(bad, 0.35, 0.0).is_err());
        assert!(Power::new(1e10, 1.0, bad).is_err());
        assert!(Power::new(1e10, 1.5, bad).is_err());
        assert!(Exponential::new(bad, 1e5).is_err());
        assert!(Exponential::new(1e-7, bad).is_err());
        assert!(Hyperbolic::new(bad, 1e-6).is_err());
        assert!(Hyperbolic::new(1e11, bad).is_err());
        assert!(InSeries::new(Constant::new(1e11).unwrap(), bad).is_err());
        assert!(ModifiedPower::new(bad, 0.35, 2e5, &KNOTS).is_err());
        assert!(ModifiedPower::new(1.81e10, 0.35, bad, &KNOTS).is_err());
        assert!(Tabulated::new(&[(0.0, 1e12), (1e5, bad)]).is_err());
        assert!(Tabulated::new(&[(0.0, bad), (1e5, 1e12)]).is_err());
        assert!(fit_power(&[(1e5, 1e12), (2e5, bad)]).is_err());
        assert!(fit_power(&[(1e5, 1e12), (bad, 2e12)]).is_err());
    }
}

#[test]
fn parameters_that_must_not_be_negative() {
    for bad in NEGATIVE {
        assert!(Power::new(1e10, bad, 1e5).is_err());
        assert!(Power::new(1e10, 0.35, bad).is_err());
        assert!(ModifiedPower::new(1.81e10, bad, 2e5, &KNOTS).is_err());
        assert!(Tabulated::new(&[(bad, 1e12), (1e5, 1.5e12)]).is_err());
    }
    assert!(Power::new(1e10, 0.0, 0.0).is_ok());
}

#[test]
fn errors_name_quantity_and_limit() {
    let quantity = LawQuantity::Stiffness;
    let error = Constant::new(-1.0).unwrap_err();
    assert_eq!(error, LawError::NotAbove { quantity, value: -1.0, limit: 0.0 });
    assert_eq!(error.to_string(), "stiffness [Pa/m] is -1; it must be greater than 0");
    let quantity = LawQuantity::ReferencePressure;
    let error = Power::new(1e10, 1.0, 0.0).unwrap_err();
    assert_eq!(error, LawError::NotAbove { quantity, value: 0.0, limit: 0.0 });
    let quantity = LawQuantity::Points;
    let error = Tabulated::new(&[(1.0, 2.0)]).unwrap_err();
    assert_eq!(error, LawError::Below { quantity, value: 1.0, limit: 2.0 });
}

#[test]
fn tables_out_of_order() {
    assert!(Tabulated::new(&[]).is_err());
    let quantity = LawQuantity::Pressure;
    for second in [1e5, 0.5e5] {
        let error = Tabulated::new(&[(1e5, 1e12), (second, 2e12)]).unwrap_err();
        let expected = LawError::NotIncreasing { quantity, index: 1, value: second, limit: 1e5 };
        assert_eq!(error, expected);
    }
    // Stiffnesses may fall.
    assert!(Tabulated::new(&[(1e5, 2e12), (2e5, 1e12)]).is_ok());
}

#[test]
fn knots_out_of_order() {
    let build = |knots: &[(f64, f64)]| ModifiedPower::new(1.81e10, 0.35, 2e5, knots);
    assert!(build(&KNOTS).is_ok());
    assert!(build(&[]).is_err());
    assert!(build(&[(1e3, 0.1e12), (1e5, 0.5e12)]).is_err(), "no knot at zero pressure");
    assert!(build(&[(0.0, 0.0), (1e5, 0.5e12)]).is_err(), "no stiffness at zero pressure");
    assert!(build(&[(0.0, 0.1e12), (0.0, 0.5e12)]).is_err());
    assert!(build(&[(0.0, 0.1e12), (1e5, 0.1e12)]).is_err(), "a plateau");
    assert!(build(&[(0.0, 0.1e12), (2e5, 0.5e12)]).is_err(), "a knot at the transition");
    assert!(build(&[(0.0, 0.1e12), (1e5, 1.3e12)]).is_err(), "stiffer than the transition");
    assert!(build(&[(0.0, 0.1e12), (f64::NAN, 0.5e12)]).is_err());
}

/// A last knot so stiff that the cubic to the joint would overshoot is refused, and the limit in
/// the error is the one that decides.
#[test]
fn a_joint_too_steep_for_a_monotone_cubic() {
    let stiffness_at = |share: f64| 1.81e10 * 2e5_f64.powf(0.35) * share;
    let build = |share| {
        ModifiedPower::new(1.81e10, 0.35, 2e5, &[(0.0, 0.1e12), (1.5e5, stiffness_at(share))])
    };
    let error = build(0.999).unwrap_err();
    let LawError::Above { quantity: LawQuantity::TransitionSlope, value, limit } = error else {
        panic!("{error}");
    };
    assert!(value > limit && (value / (0.35 * stiffness_at(1.0) / 2e5) - 1.0).abs() < 1e-14);

    // Every law that is built increases; find the last one and look closely.
    let (mut built, mut refused) = (0.9, 0.999);
    for _ in 0..40 {
        let middle = 0.5 * (built + refused);
        if build(middle).is_ok() {
            built = middle;
        } else {
            refused = middle;
        }
    }
    let law = build(built).unwrap();
    let slopes = (0..=10_000).map(|i| law.stiffness_slope(1.5e5 + 5.0 * f64::from(i)));
    let least = slopes.fold(f64::INFINITY, f64::min);
    // At the limit the slope touches zero: monotone, and no stricter than needed.
    let scale = 0.35 * stiffness_at(1.0) / 2e5;
    assert!(least > -1e-6 * scale && least < 1e-3 * scale, "least slope {least:e}");
}

#[test]
fn fits_of_too_few_points() {
    assert!(fit_power(&[]).is_err());
    assert!(fit_power(&[(1e5, 1e12)]).is_err());
    let error = fit_power(&[(1e5, 1e12), (1e5, 2e12), (1e5, 3e12)]).unwrap_err();
    assert!(matches!(error, LawError::NotAbove { quantity: LawQuantity::PressureSpread, .. }));
    assert!(fit_power(&[(1e5, 1e12), (1.000_001e5, 2e12)]).is_ok());
}
