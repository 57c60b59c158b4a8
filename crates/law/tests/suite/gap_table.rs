//! Stiffnesses from pressures against gaps.

use asperity_law::{
    ContactLaw, Exponential, Hyperbolic, LawError, LawQuantity, Power, Tabulated,
    stiffness_from_gaps,
};

/// Rows of a law at pressures that grow by a factor, the closures shifted.
fn rows(law: &dyn ContactLaw, factor: f64, count: i32) -> Vec<(f64, f64)> {
    let pressures = (0..count).map(|row| 1e3 * factor.powi(row));
    pressures.map(|pressure| (law.closure(pressure) - 5e-6, pressure)).collect()
}

#[test]
fn stiffnesses_of_known_laws_come_back_at_second_order() {
    let laws: [Box<dyn ContactLaw>; 2] = [
        Box::new(Power::new(1.81e10, 0.35, 0.0).unwrap()),
        Box::new(Hyperbolic::new(1e11, 2e-6).unwrap()),
    ];
    for law in laws {
        let worst = |factor: f64, count: i32| {
            let points = stiffness_from_gaps(&rows(&law, factor, count)).unwrap();
            let error = |point: &(f64, f64)| (point.1 / law.stiffness(point.0) - 1.0).abs();
            points.iter().map(error).fold(0.0, f64::max)
        };
        let (coarse, fine) = (worst(1.2, 41), worst(1.2_f64.sqrt(), 81));
        assert!(coarse < 0.02, "{law:?}: {coarse}");
        assert!((3.0..5.0).contains(&(coarse / fine)), "{law:?}: {coarse} {fine}");
    }
}

#[test]
fn an_exponential_law_comes_back_exactly_and_so_do_its_pressures() {
    let law = Exponential::new(3e-7, 1e5).unwrap();
    let rows = rows(&law, 1.5, 20);
    let points = stiffness_from_gaps(&rows).unwrap();
    for &(pressure, stiffness) in &points {
        assert!((stiffness / law.stiffness(pressure) - 1.0).abs() < 1e-9);
    }
    // The table law is a cubic in pressure, which holds K = p / u0 exactly.
    let table = Tabulated::new(&points).unwrap();
    let closure = table.closure_increment(rows[0].1, rows[19].1 - rows[0].1);
    assert!((closure / (rows[19].0 - rows[0].0) - 1.0).abs() < 1e-9);
}

#[test]
fn rows_that_are_no_law_are_refused_and_open_rows_left_out() {
    let good = [(0.0, 0.0), (1e-7, 0.0), (2e-7, 1e4), (3e-7, 3e4), (4e-7, 8e4)];
    assert_eq!(stiffness_from_gaps(&good).unwrap().len(), 3);
    let quantity = |rows: &[(f64, f64)]| match stiffness_from_gaps(rows).unwrap_err() {
        LawError::Below { quantity, .. }
        | LawError::NotFinite { quantity, .. }
        | LawError::NotIncreasing { quantity, .. } => quantity,
        other => panic!("{other}"),
    };
    assert_eq!(quantity(&good[..4]), LawQuantity::Points);
    assert_eq!(quantity(&[(0.0, 1e4), (1e-7, 9e3), (2e-7, 2e4)]), LawQuantity::Pressure);
    assert_eq!(quantity(&[(0.0, 1e4), (0.0, 2e4), (2e-7, 3e4)]), LawQuantity::Closure);
    assert_eq!(quantity(&[(0.0, -1.0), (1e-7, 2e4), (2e-7, 3e4)]), LawQuantity::Pressure);
    assert_eq!(quantity(&[(0.0, 1.0), (1e-7, f64::NAN), (2e-7, 3e4)]), LawQuantity::Pressure);
}
