//! Properties of contact laws of any parameters that a scenario accepts.

use asperity_law::CompiledLaw;
use asperity_scenario::Document;
use serde_json::Value;

use crate::documents::BASE;
use crate::numbers::Numbers;

/// Relative decrease of a rising curve that is rounding, and relative rounding of a closure.
const ROUNDING: f64 = 1e-9;
const CLOSURE_ROUNDING: f64 = 1e-12;

/// Magnitudes of parameters for which values have to hold, not only to be there.
const SENSIBLE: std::ops::RangeInclusive<f64> = 1e-20..=1e20;

/// Builds a law and evaluates it: no value is NaN, closures rise with pressure, pressures and
/// energies with closure, and a compiled table holds its error estimate. With parameters beyond
/// [`SENSIBLE`] magnitudes, products overflow, and the law only has to be evaluated.
///
/// # Panics
/// If one of these does not hold.
pub fn law(bytes: &[u8]) {
    let mut numbers = Numbers::new(bytes);
    let static_pressure = numbers.between(1e-3, 1e9);
    let law_json = numbers.law(static_pressure, 1e12);
    let text = law_json.to_string();
    let mut document = Document::parse(BASE, "fuzz.json").expect("the fixture is read");
    document.set("/interfaces/0/law", &text).expect("a scenario has an interface");
    // Parameters that a scenario refuses do not reach a law.
    let Ok(scenario) = document.scenario() else { return };
    let law = match scenario.laws.build(&scenario.interfaces[0].law, static_pressure) {
        Ok(law) => law,
        Err(error) => return assert!(!error.to_string().is_empty()),
    };
    let pressures = (0..60).map(|at| static_pressure * 10.0_f64.powf(0.2 * f64::from(at - 40)));
    if !is_sensible(&law_json) {
        for pressure in pressures {
            let closure = law.closure(pressure);
            let found = (law.stiffness(pressure), law.pressure(closure), law.energy(closure));
            std::hint::black_box(found);
        }
        drop(CompiledLaw::new(&law, static_pressure, 5.0 * static_pressure, 1e-4));
        return;
    }
    let mut last = f64::NEG_INFINITY;
    let mut closures = Vec::new();
    for pressure in pressures {
        let (stiffness, closure) = (law.stiffness(pressure), law.closure(pressure));
        assert!(stiffness >= 0.0, "{text}: stiffness {stiffness} at {pressure} Pa");
        assert!(!closure.is_nan(), "{text}: closure {closure} at {pressure} Pa");
        rises(&text, "closure", last, closure);
        last = closure;
        closures.push(closure);
    }
    closures.sort_by(f64::total_cmp);
    let (mut last_pressure, mut last_energy) = (f64::NEG_INFINITY, f64::NEG_INFINITY);
    for closure in closures.into_iter().filter(|closure| closure.is_finite()) {
        let (state, energy) = (law.pressure(closure), law.energy(closure));
        let pressure = state.value;
        // Next to a closure limit a steep tangent turns the rounding of a closure into one of pressure.
        let by_closure = CLOSURE_ROUNDING * closure.abs() * state.tangent;
        assert!(
            !pressure.is_nan() && !energy.is_nan(),
            "{text}: {pressure}, {energy} at {closure} m"
        );
        rises(&text, "pressure", last_pressure, pressure + by_closure);
        rises(&text, "energy", last_energy, energy + by_closure * closure.abs());
        (last_pressure, last_energy) = (pressure, energy);
    }
    let increment = law.pressure_increment(static_pressure, 0.0).value;
    assert!(increment.abs() <= ROUNDING * static_pressure, "{text}: increment {increment} at rest");
    compiled(&text, &law, static_pressure);
}

/// True if all numbers of a document are zero or of [`SENSIBLE`] magnitude.
fn is_sensible(document: &Value) -> bool {
    match document {
        Value::Number(number) => number.as_f64().is_some_and(|x| x == 0.0 || SENSIBLE.contains(&x)),
        Value::Array(values) => values.iter().all(is_sensible),
        Value::Object(entries) => entries.values().all(is_sensible),
        _ => true,
    }
}

fn compiled(text: &str, law: &dyn asperity_law::ContactLaw, pressure: f64) {
    let table = match CompiledLaw::new(law, pressure, 5.0 * pressure, 1e-4) {
        Ok(table) => table,
        Err(error) => return assert!(!error.to_string().is_empty()),
    };
    let (low, high) = (table.x_lo().max(-1.0), table.x_hi());
    let mut last = f64::NEG_INFINITY;
    for at in 0..200 {
        let x = low + (high - low) * (f64::from(at) + 0.5) / 200.0;
        let (value, exact) = (table.get(x), law.pressure_increment(pressure, x).value);
        assert!(!value.is_nan(), "{text}: the table has no value at {x} m");
        let error = (value - exact).abs();
        let most = table.error_estimate() + ROUNDING * (pressure + exact.abs());
        assert!(error <= 4.0 * most, "{text}: error {error} Pa at {x} m, estimate {most} Pa");
        assert!(value >= last - most, "{text}: the table falls at {x} m");
        last = value;
    }
}

fn rises(text: &str, quantity: &str, last: f64, value: f64) {
    let rounding = ROUNDING * last.abs().max(value.abs());
    let falls = last.is_finite() && value < last - rounding;
    assert!(!falls, "{text}: {quantity} falls from {last} to {value}");
}
