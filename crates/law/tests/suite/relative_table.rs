//! Tables to a relative error, against their laws.

use std::sync::Arc;

use asperity_law::{
    ContactLaw, Hyperbolic, LawsInSeries, ModifiedPower, Power, RelativeTable, SeriesContact,
    Tabulated,
};
use proptest::prelude::*;

use crate::conformance::families;

const TOP: f64 = 1.6e6;

/// The largest relative errors of pressure and tangent at closures spread over the octaves of a table.
fn errors(law: &dyn ContactLaw, table: &RelativeTable) -> [f64; 2] {
    let lost = law.domain().closure_lost.unwrap();
    let height = law.closure(TOP) - lost;
    let mut worst = [0.0_f64; 2];
    for i in 0..5000 {
        let closure = height * (-17.5 * f64::from(i) / 5000.0).exp2();
        if let Some(found) = table.get(closure) {
            let exact = law.pressure(lost + closure);
            worst[0] = worst[0].max((found.value / exact.value - 1.0).abs());
            worst[1] = worst[1].max((found.tangent / exact.tangent - 1.0).abs());
        }
    }
    worst
}

fn laws() -> Vec<Arc<dyn ContactLaw>> {
    let knots = [(0.0, 0.02e12), (0.025e6, 0.12e12), (0.078e6, 0.40e12), (0.14e6, 0.97e12)];
    let points = [(0.14e6, 1.15e12), (0.35e6, 1.75e12), (0.57e6, 1.63e12), (1e6, 2.46e12)];
    let power: Arc<dyn ContactLaw> = Arc::new(Power::new(1.81e10, 0.35, 0.0).unwrap());
    let upper = SeriesContact::new(Arc::clone(&power));
    let lower = SeriesContact { pressure_offset: 399.0, ..SeriesContact::new(Arc::clone(&power)) };
    vec![
        power,
        Arc::new(LawsInSeries::new(vec![upper, lower], 0.015 / 71e9).unwrap()),
        Arc::new(ModifiedPower::new(1.81e10, 0.35, 0.2e6, &knots).unwrap()),
        Arc::new(Tabulated::new(&points).unwrap()),
        Arc::new(Hyperbolic::new(8.5e11, 1e-6).unwrap()),
        Arc::new(Power::new(1e8, 0.8, 0.0).unwrap()),
    ]
}

/// The laws of the rigs are within the stated errors, but for cells with their kinks.
#[test]
fn tables_are_exact_to_their_relative_errors() {
    for law in laws() {
        let table = RelativeTable::new(&*law, TOP).unwrap();
        assert!(table.left_out() <= 0.02, "{law:?}: {}", table.left_out());
        let [pressure, tangent] = errors(&*law, &table);
        assert!(pressure < 2e-11 && tangent < 2e-9, "{law:?}: {pressure:e} {tangent:e}");
    }
}

/// Below the table, above it, and where the faces are apart the law itself is to be taken.
#[test]
fn closures_outside_are_left_to_the_law() {
    let law = Power::new(1.81e10, 0.35, 0.0).unwrap();
    let table = RelativeTable::new(&law, TOP).unwrap();
    let height = law.closure(TOP);
    for closure in [-height, -0.0, 0.0, 1e-300, height * 2.0_f64.powi(-20), 2.1 * height, f64::NAN]
    {
        assert_eq!(table.get(closure), None, "{closure}");
    }
    assert!(table.get(height).is_some());
    // Contact is never lost: no table.
    assert_eq!(RelativeTable::new(&Power::new(1e6, 1.0, 1e5).unwrap(), TOP), None);
}

/// Pressure and tangent are continuous from cell to cell.
#[test]
fn neighbouring_cells_meet() {
    for law in laws() {
        let table = RelativeTable::new(&*law, TOP).unwrap();
        let height = law.closure(TOP);
        for i in 0..200 {
            let edge = height * (-f64::from(i) / 16.0).exp2();
            // The edges of cells are numbers of few binary digits.
            let edge = f64::from_bits((edge.to_bits() >> 46) << 46);
            let sides = [edge.next_down(), edge].map(|closure| table.get(closure));
            let [Some(below), Some(above)] = sides else { continue };
            assert!((below.value / above.value - 1.0).abs() < 1e-14, "{law:?} {edge}");
            assert!((below.tangent / above.tangent - 1.0).abs() < 1e-13, "{law:?} {edge}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// Tables of sampled laws give those laws.
    #[test]
    fn sampled_laws((_, law) in families::sample()) {
        if let Some(table) = RelativeTable::new(&*law, TOP) {
            let [pressure, tangent] = errors(&*law, &table);
            prop_assert!(pressure < 1e-9 && tangent < 1e-7, "{law:?}: {pressure:e} {tangent:e}");
        }
    }
}
