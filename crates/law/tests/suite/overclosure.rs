//! Pressure-overclosure tables against the laws that they tabulate.

use std::sync::Arc;

use asperity_law::{
    BeyondTable, Constant, ContactLaw, Exponential, Hyperbolic, LawError, LawQuantity,
    ModifiedPower, OverclosureTable, Power, Tabulated,
};

const KNOTS: [(f64, f64); 4] =
    [(0.0, 0.02e12), (0.025e6, 0.12e12), (0.078e6, 0.40e12), (0.14e6, 0.97e12)];

fn modified() -> ModifiedPower {
    ModifiedPower::new(1.81e10, 0.35, 2e5, &KNOTS).unwrap()
}

fn curved_laws() -> Vec<Arc<dyn ContactLaw>> {
    vec![
        Arc::new(modified()),
        Arc::new(Power::new(1.81e10, 0.35, 0.0).unwrap()),
        Arc::new(Power::new(5e6, 1.2, 1.4e5).unwrap()),
        Arc::new(Exponential::new(3e-7, 1.4e5).unwrap()),
        Arc::new(Hyperbolic::new(1e11, 2e-6).unwrap()),
        Arc::new(Tabulated::new(&[(1e5, 1e12), (2e5, 0.4e12), (5e5, 2e12)]).unwrap()),
    ]
}

#[test]
fn the_state_at_rest_is_exact_and_rows_increase() {
    for law in curved_laws() {
        for at_rest in [2e3, 0.1373e6, 0.1377e6, 0.9e6] {
            for rows in [OverclosureTable::MIN_ROWS, 57, 200] {
                let table = OverclosureTable::new(&law, Some(at_rest), 1e6, rows).unwrap();
                assert!(table.rows().len() <= rows);
                assert!(table.rows().windows(2).all(|pair| {
                    pair[0].pressure < pair[1].pressure && pair[0].overclosure < pair[1].overclosure
                }));
                let (first, last) = (table.rows()[0], table.rows()[table.rows().len() - 1]);
                assert_eq!((first.pressure, first.overclosure), (0.0, 0.0));
                assert_eq!(last.pressure, 1e6);
                let found = table.pressure(law.closure(at_rest), BeyondTable::PressureHeld);
                assert!((found.value / at_rest - 1.0).abs() < 1e-9, "{law:?} {found:?}");
                assert!((found.tangent / law.stiffness(at_rest) - 1.0).abs() < 1e-9, "{law:?}");
            }
        }
    }
}

/// Pressures that the table was not sampled at.
#[test]
fn stated_errors_hold_at_other_pressures_and_fall_at_second_and_first_order() {
    for law in curved_laws() {
        let accuracy = |rows| {
            let table = OverclosureTable::new(&law, Some(0.14e6), 1e6, rows).unwrap();
            let stated = table.accuracy(&law);
            let mut closure_error = 0.0_f64;
            for step in 0..3000 {
                let closure = {
                    let pressure = 0.042e6 + (1e6 - 0.042e6) * f64::from(step) / 3000.0;
                    law.closure(pressure)
                };
                let found = table.pressure(closure, BeyondTable::SlopeHeld);
                let exact = law.pressure(closure);
                let tangent_error = (found.tangent / exact.tangent - 1.0).abs();
                assert!(tangent_error <= stated.tangent_error * 1.001 + 1e-9, "{law:?}");
                let closure_at_pressure =
                    closure + (exact.value - found.value) / found.tangent - table.first_closure();
                let exact = closure - table.first_closure();
                closure_error = closure_error.max((closure_at_pressure / exact - 1.0).abs());
            }
            assert!(closure_error <= stated.closure_error * 1.1, "{law:?}: {closure_error}");
            assert!(closure_error >= stated.closure_error * 0.5, "{law:?}: {closure_error}");
            stated
        };
        let (coarse, fine) = (accuracy(100), accuracy(399));
        if law.measured_range().is_some() {
            // No order where the stiffness has a minimum and kinks.
            continue;
        }
        let closure_ratio = coarse.closure_error / fine.closure_error;
        let tangent_ratio = coarse.tangent_error / fine.tangent_error;
        assert!((12.0..22.0).contains(&closure_ratio), "{law:?}: {closure_ratio}");
        assert!((3.3..5.0).contains(&tangent_ratio), "{law:?}: {tangent_ratio}");
    }
}

#[test]
fn two_hundred_rows_of_the_papers_law_are_within_2e_5_in_closure() {
    let law = modified();
    let table = OverclosureTable::new(&law, Some(0.1373e6), 0.6e6, 200).unwrap();
    let accuracy = table.accuracy(&law);
    assert!(accuracy.closure_error < 1.2e-5, "{accuracy:?}");
    let to_one_megapascal = OverclosureTable::new(&law, Some(0.1373e6), 1e6, 200).unwrap();
    assert!(to_one_megapascal.accuracy(&law).closure_error < 2e-5);
    assert!(accuracy.tangent_error < 0.02, "{accuracy:?}");
    // Rows at equal steps of pressure, by the same measure.
    let even = (1..200).map(|row| {
        let (start, stop) = (0.6e6 * f64::from(row - 1) / 199.0, 0.6e6 * f64::from(row) / 199.0);
        let middle = 0.5 * (start + stop);
        let chord = 0.5 * (law.closure(start) + law.closure(stop));
        if start < accuracy.pressure_min { 0.0 } else { (chord / law.closure(middle) - 1.0).abs() }
    });
    assert!(even.fold(0.0, f64::max) > 3.0 * accuracy.closure_error);
}

/// The segment that is right for one contact is wrong for another one close by.
#[test]
fn a_table_for_one_contact_has_a_tangent_error_at_another() {
    let law = modified();
    let table = OverclosureTable::new(&law, Some(0.13733e6), 1e6, 200).unwrap();
    let other = table.pressure(law.closure(0.13776e6), BeyondTable::PressureHeld);
    let error = (other.tangent / law.stiffness(0.13776e6) - 1.0).abs();
    assert!(error > 1e-3, "{error}");
}

#[test]
fn a_constant_stiffness_has_two_rows_and_no_error() {
    let law = Constant::new(8.5e11).unwrap();
    let table = OverclosureTable::new(&law, Some(0.14e6), 1e6, 200).unwrap();
    assert_eq!(table.rows().len(), 2);
    assert!(table.accuracy(&law).closure_error < 1e-14);
    assert!(table.accuracy(&law).tangent_error < 1e-14);
}

#[test]
fn beyond_the_table_the_pressure_or_the_slope_is_held() {
    let law = modified();
    let table = OverclosureTable::new(&law, None, 0.6e6, 200).unwrap();
    let beyond = law.closure(0.62e6);
    let held = table.pressure(beyond, BeyondTable::PressureHeld);
    assert_eq!((held.value, held.tangent), (0.6e6, 0.0));
    let continued = table.pressure(beyond, BeyondTable::SlopeHeld);
    assert!((continued.value / 0.62e6 - 1.0).abs() < 1e-3);
    assert_eq!(table.pressure(-1e-9, BeyondTable::SlopeHeld).value, 0.0);
}

#[test]
fn pressures_that_do_not_increase_and_too_few_rows_are_refused() {
    let law = modified();
    let table = |at_rest, top, rows| OverclosureTable::new(&law, at_rest, top, rows);
    let quantity = |result: Result<_, LawError>| match result.unwrap_err() {
        LawError::NotAbove { quantity, .. }
        | LawError::Below { quantity, .. }
        | LawError::NotFinite { quantity, .. } => quantity,
        other => panic!("{other}"),
    };
    assert_eq!(quantity(table(Some(0.2e6), 0.1e6, 200)), LawQuantity::PressureTop);
    assert_eq!(quantity(table(Some(0.0), 0.1e6, 200)), LawQuantity::PressureState);
    assert_eq!(quantity(table(None, 0.0, 200)), LawQuantity::PressureTop);
    assert_eq!(quantity(table(None, f64::NAN, 200)), LawQuantity::PressureTop);
    assert_eq!(quantity(table(None, 1e6, 15)), LawQuantity::Rows);
}
