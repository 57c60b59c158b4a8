//! Tabulated laws against the laws themselves.

use std::sync::Arc;

use asperity_law::{
    CompiledLaw, Constant, ContactLaw, Exponential, Hyperbolic, InSeries, LawError, LawQuantity,
    ModifiedPower, Power, Tabulated,
};
use proptest::prelude::*;

const STATE: f64 = 1.373e5;

const KNOTS: [(f64, f64); 4] =
    [(0.0, 0.02e12), (0.025e6, 0.12e12), (0.078e6, 0.40e12), (0.14e6, 0.97e12)];

const TABLE: [(f64, f64); 4] =
    [(0.14e6, 1.15e12), (0.35e6, 1.75e12), (0.57e6, 1.63e12), (1e6, 2.46e12)];

/// Every law at the rig's scale, alone and as an implicit contact step.
fn laws() -> Vec<Arc<dyn ContactLaw>> {
    let mut laws: Vec<Arc<dyn ContactLaw>> = vec![
        Arc::new(Constant::new(8.5e11).unwrap()),
        Arc::new(Constant::unilateral(8.5e11).unwrap()),
        Arc::new(Power::new(1.81e10, 0.35, 0.0).unwrap()),
        Arc::new(Power::new(1.81e10, 0.35, 1e5).unwrap()),
        Arc::new(Power::new(1e8, 0.8, 0.0).unwrap()),
        Arc::new(Power::new(1e11, 0.2, 0.0).unwrap()),
        Arc::new(Power::new(1e2, 2.0, 1e5).unwrap()),
        Arc::new(ModifiedPower::new(1.81e10, 0.35, 2e5, &KNOTS).unwrap()),
        Arc::new(Exponential::new(1e-7, 1e5).unwrap()),
        Arc::new(Hyperbolic::new(1e11, 3e-6).unwrap()),
        Arc::new(Tabulated::new(&TABLE).unwrap()),
    ];
    for law in laws.clone() {
        laws.push(Arc::new(InSeries::new(law.clone(), 3e11).unwrap()));
        laws.push(Arc::new(InSeries::new(law, 3e13).unwrap()));
    }
    laws
}

/// The bound is kept at points other than those it was found at, and is what was asked for.
fn estimate_holds(
    law: &dyn ContactLaw,
    top: f64,
    tolerance: f64,
    shares: &[f64],
) -> Result<(), TestCaseError> {
    let table = CompiledLaw::new(law, STATE, top, tolerance).unwrap();
    let bound = table.error_estimate();
    prop_assert!(bound <= tolerance * STATE.max((top - STATE) / 1000.0));
    estimate_covers(law, &table, shares)
}

/// The error at shares of the table is at most its estimate.
fn estimate_covers(
    law: &dyn ContactLaw,
    table: &CompiledLaw,
    shares: &[f64],
) -> Result<(), TestCaseError> {
    let bound = table.error_estimate();
    for share in shares {
        let x = table.x_lo() + share * (table.x_hi() - table.x_lo());
        let exact = law.pressure_increment(STATE, x).value;
        let off = (table.get(x) - exact).abs();
        prop_assert!(off <= bound, "{law:?} at {x:e}: off by {off:e}, bound {bound:e}");
        let (value, tangent) = table.get_with_tangent(x);
        prop_assert_eq!(value, table.get(x));
        prop_assert_eq!(tangent, table.tangent(x));
    }
    Ok(())
}

/// A law that never separates falls to zero pressure below a uniform table, without a jump or a pull on the way, and is
/// off by no more than the estimate; with a smaller tolerance it is followed further down.
#[test]
fn faces_that_never_separate_have_no_pressure_far_apart() {
    let exponential = Arc::new(Exponential::new(1e-7, 1e5).unwrap());
    let laws: [(Arc<dyn ContactLaw>, f64); 4] = [
        (exponential.clone(), 1e-8),
        (Arc::new(InSeries::new(exponential, 3e11).unwrap()), 1e-8),
        (Arc::new(Power::new(1e7, 1.0, 1e5).unwrap()), 1e-8),
        // Its closures reach so far that rounding allows no more.
        (Arc::new(Power::new(1e5, 1.3, 1e5).unwrap()), 2e-6),
    ];
    for (law, smallest) in laws {
        let mut started = 0.0;
        for tolerance in [1e-4, smallest] {
            let table = CompiledLaw::uniform(&law, STATE, 1e6, tolerance).unwrap();
            let (lowest, limit) = (table.x_lo(), tolerance * STATE);
            assert!(lowest < 1.1 * started, "{law:?}: {lowest:e} after {started:e}");
            started = lowest;
            for below in [lowest.next_down(), 2.0 * lowest, -1.0] {
                assert_eq!(table.get_with_tangent(below), (-STATE, 0.0), "{law:?} {below}");
            }
            assert!(table.error_estimate() <= limit);
            let scale = table.scales()[1];
            let width = scale.cells_per_metre.recip();
            let mut last = (-STATE, 0.0);
            for i in 1..(100.0 * scale.offset) as usize {
                let x = lowest + 0.01 * i as f64 * width;
                let (value, tangent) = table.get_with_tangent(x);
                let off = (value - law.pressure_increment(STATE, x).value).abs();
                assert!(off <= table.error_estimate(), "{law:?} at {x:e}: {off:e}");
                let rounding = 1e-13 * STATE;
                assert!(value >= last.0 - rounding, "{law:?} at {x:e}: {value} below {}", last.0);
                // No jump, and none of the tangent, which doubles within a cell at most.
                let rise = 0.01 * width * tangent.max(last.1);
                assert!(value - last.0 <= 1.5 * rise + rounding, "{law:?} at {x:e}");
                last = (value, tangent);
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn the_error_estimate_holds_at_any_point(
        which in 0..33_usize,
        top in 1.5e5..2e6_f64,
        exponent in 3.0..6.0_f64,
        shares in prop::collection::vec(0.0..1.0_f64, 256),
    ) {
        estimate_holds(&laws()[which], top, 10.0_f64.powf(-exponent), &shares)?;
    }

    /// Tables as free laws are: many points, whose stiffness changes by up to a factor of 3 from one to the
    /// next.
    #[test]
    fn the_error_estimate_holds_for_any_table(
        steps in prop::collection::vec((1.05..2.0_f64, -0.2..1.1_f64), 4..40),
        top in 2e5..2e6_f64,
        exponent in 4.0..7.0_f64,
        shares in prop::collection::vec(0.0..1.0_f64, 1024),
    ) {
        let mut points = vec![(2e3, 5e10)];
        for (rise, stiffening) in steps {
            let &(p, k) = points.last().unwrap();
            points.push((p * rise, k * f64::exp(stiffening)));
        }
        let law = Tabulated::new(&points).unwrap();
        let tolerance = 10.0_f64.powf(-exponent);
        match CompiledLaw::uniform(&law, STATE, top, tolerance) {
            Err(LawError::Unresolved { .. }) => {}
            table => estimate_covers(&law, &table.unwrap(), &shares)?,
        }
    }

    /// Next to loss of contact, where the curvature of a power law is unbounded.
    #[test]
    fn the_error_estimate_holds_next_to_loss_of_contact(
        which in 0..33_usize,
        logs in prop::collection::vec(-12.0..-1.0_f64, 64),
    ) {
        let shares: Vec<f64> = logs.into_iter().map(|log| 10.0_f64.powf(log)).collect();
        estimate_holds(&laws()[which], 1e6, 1e-6, &shares)?;
    }

    #[test]
    fn the_error_estimate_holds_for_any_power(
        m in prop_oneof![Just(0.0), 0.2..1.8_f64],
        state in 10.0..1e6_f64,
        ratio in 1.1..50.0_f64,
        share in 0.0..1.0_f64,
    ) {
        let law = Power::new(1e12 * 1e5_f64.powf(-m), m, state).unwrap();
        let table = match CompiledLaw::new(&law, state, ratio * state, 1e-5) {
            // Just below m = 1 a power law separates, but at a closure of 1 / (1 - m).
            Err(LawError::Unresolved { .. }) if (m - 1.0).abs() < 1e-2 => return Ok(()),
            table => table.unwrap(),
        };
        let x = table.x_lo() + share * (table.x_hi() - table.x_lo());
        let off = (table.get(x) - law.pressure_increment(state, x).value).abs();
        prop_assert!(off <= table.error_estimate());
    }
}

#[test]
fn the_state_is_exact() {
    for law in laws() {
        let table = CompiledLaw::new(&law, STATE, 1e6, 1e-6).unwrap();
        let (value, tangent) = table.get_with_tangent(0.0);
        assert_eq!(value, 0.0, "{law:?}");
        assert_eq!(table.get(0.0), 0.0);
        let k = law.stiffness(STATE);
        // One product with the cell's width and one with its inverse.
        assert!((tangent / k - 1.0).abs() < 1e-14, "{law:?}");
    }
}

#[test]
fn open_faces_are_exact_from_loss_of_contact_on() {
    for law in laws().into_iter().filter(|law| law.domain().separates()) {
        let table = CompiledLaw::new(&law, STATE, 1e6, 1e-6).unwrap();
        let lost = table.x_lo();
        let expected = law.closure_increment(STATE, -STATE);
        assert_eq!(lost, expected);
        for x in [lost, lost.next_down(), 1.001 * lost, 2.0 * lost, 1e9 * lost, -1.0, -1e9] {
            assert_eq!(table.get(x), -STATE, "{law:?} at {x:e}");
        }
        for x in [1.001 * lost, 2.0 * lost, -1.0, -1e9] {
            assert_eq!(table.get_with_tangent(x), (-STATE, 0.0));
        }
        assert!(table.get(0.999 * lost) != -STATE);
    }
}

#[test]
fn a_state_may_be_loss_of_contact_itself() {
    let law = Power::new(1.81e10, 0.35, 0.0).unwrap();
    let table = CompiledLaw::new(&law, 0.0, 1e6, 1e-5).unwrap();
    assert_eq!((table.get(0.0), table.get(-1e-9), table.x_lo()), (0.0, 0.0, 0.0));
    let x = 0.37 * table.x_hi();
    assert!((table.get(x) - law.pressure(x).value).abs() <= table.error_estimate());
}

#[test]
fn outside_the_table_is_nan() {
    for law in laws() {
        let table = CompiledLaw::new(&law, STATE, 1e6, 1e-6).unwrap();
        let beyond = table.x_hi() * (1.0 + 1e-9) + 1e-18;
        for x in [beyond, 10.0 * beyond, 1e300, f64::INFINITY, f64::NAN] {
            assert!(table.get(x).is_nan() && table.get_with_tangent(x).1.is_nan(), "{law:?} {x:e}");
        }
        assert!(table.get(table.x_hi() * (1.0 - 1e-9)).is_finite());
        assert!(law.pressure_increment(STATE, table.x_hi()).value >= (1e6 - STATE) * (1.0 - 1e-9));
        if !law.domain().separates() {
            assert!(table.get(table.x_lo() * (1.0 + 1e-9)).is_nan());
            assert!(table.get(table.x_lo() * (1.0 - 1e-9)).is_finite());
        }
    }
}

#[test]
fn the_lowest_pressure_is_as_documented() {
    let exponential = Exponential::new(1e-7, 1e5).unwrap();
    let table = CompiledLaw::new(&exponential, STATE, 1e6, 1e-6).unwrap();
    let lowest = STATE + table.get(table.x_lo() * (1.0 - 1e-12));
    assert!((lowest * 64.0 / STATE - 1.0).abs() < 1e-4, "{lowest}");

    let spring = Constant::new(8.5e11).unwrap();
    let table = CompiledLaw::new(&spring, STATE, 1e6, 1e-6).unwrap();
    assert!((table.x_lo() + (1e6 - STATE) / 8.5e11).abs() < 1e-18);
}

/// Cubic Hermite cells: halving them divides the error of a smooth law by 16.
#[test]
fn the_error_falls_with_the_fourth_power_of_the_cell() {
    let law = Exponential::new(1e-7, 1e5).unwrap();
    let sized = |tolerance| {
        let table = CompiledLaw::new(&law, STATE, 1e6, tolerance).unwrap();
        (table.cells().len() as f64, table.error_estimate())
    };
    let ((coarse, more), (fine, less)) = (sized(1e-3), sized(1e-8));
    let slope = (more / less).ln() / (fine / coarse).ln();
    assert!((slope - 4.0).abs() < 0.15, "slope {slope}");
}

/// The documented evaluation of the cells is that of `get`.
#[test]
fn the_cells_are_as_documented() {
    let law = Power::new(1.81e10, 0.35, 0.0).unwrap();
    let table = CompiledLaw::new(&law, STATE, 1e6, 1e-6).unwrap();
    for share in [0.0, 0.001, 0.1, 0.5, 0.99] {
        let x = table.x_lo() + share * (table.x_hi() - table.x_lo());
        let [fine, coarse] = table.scales();
        let scale = if x < table.fine_below() { fine } else { coarse };
        let s = x * scale.cells_per_metre + scale.offset;
        let [c0, c1, c2, c3] = table.cells()[s.floor() as usize];
        let t = s - s.floor();
        assert_eq!(c0 + t * (c1 + t * (c2 + t * c3)), table.get(x));
    }
    assert_eq!(table.pressure_state(), STATE);
}

#[test]
fn invalid_tables() {
    let power = Power::new(1.81e10, 0.35, 0.0).unwrap();
    let exponential = Exponential::new(1e-7, 1e5).unwrap();
    for bad in [f64::NAN, f64::INFINITY, -1.0] {
        assert!(CompiledLaw::new(&power, bad, 1e6, 1e-6).is_err());
        assert!(CompiledLaw::new(&power, STATE, bad, 1e-6).is_err());
        assert!(CompiledLaw::new(&power, STATE, 1e6, bad).is_err());
    }
    assert!(CompiledLaw::new(&power, STATE, STATE, 1e-6).is_err());
    assert!(CompiledLaw::new(&power, STATE, 1e6, 0.0).is_err());
    let error = CompiledLaw::new(&exponential, 0.0, 1e6, 1e-6).unwrap_err();
    let quantity = LawQuantity::PressureState;
    assert_eq!(error, LawError::NotAbove { quantity, value: 0.0, limit: 0.0 });

    // More than 65536 cells, or so many more that it is plain from fewer.
    match CompiledLaw::new(&power, STATE, 1e6, 1e-13).unwrap_err() {
        LawError::Unresolved { cells, value, limit } => {
            let gain = (CompiledLaw::MAX_CELLS as f64 / cells as f64).powi(4);
            assert!(cells <= CompiledLaw::MAX_CELLS);
            assert!(value > limit && limit == 1e-13 * STATE);
            assert!(cells > 60_000 || value > limit * gain);
        }
        other => panic!("{other}"),
    }
    let error = CompiledLaw::new(&power, 1e-3, 1e9, 1e-6).unwrap_err();
    assert!(matches!(error, LawError::Unresolved { cells: 0, .. }));
}

/// Second method: a cell gives what the table gives, wherever it says that it holds; and it
/// never holds for a closure that it was not found for and does not contain.
#[test]
fn a_cell_gives_the_value_of_the_table() {
    let law = asperity_law::Power::new(1.81e10, 0.35, 0.0).unwrap();
    let table = CompiledLaw::new(&law, 0.137e6, 1e6, 1e-6).unwrap();
    let span = table.x_hi() - table.x_lo();
    let mut cell = asperity_law::CubicCell::EMPTY;
    let mut kept = 0;
    for step in 0..200_000 {
        let x = table.x_lo() + span * (0.49 + 0.51 * (f64::from(step) * 1e-4).sin());
        if cell.contains(x) {
            kept += 1;
        } else {
            cell = table.cell(x).unwrap();
        }
        // The two round their place in the cell differently, by a few parts in 1e16 of the index.
        let difference = cell.get(x, |a, b, c| a * b + c) - table.get(x);
        assert!(difference.abs() <= 1e-12 * 1e6, "{x}: {difference}");
    }
    assert!(kept > 150_000, "closures that move little stay in their cell");
    assert_eq!(table.cell(0.0).unwrap().get(0.0, |a, b, c| a * b + c), 0.0);
    let open = table.cell(table.x_lo() - 1.0).unwrap();
    assert!(open.contains(table.x_lo() - 1e-3));
    assert_eq!(open.get(table.x_lo() - 1e-3, |a, b, c| a * b + c), -0.137e6);
    assert!(table.cell(table.x_hi() + span).is_none() && table.cell(f64::NAN).is_none());
}
