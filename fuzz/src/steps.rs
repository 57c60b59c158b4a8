//! Properties of both integrators on any small structure.

use std::path::Path;

use asperity_dynamics::{FiniteDifference, Integrator, Modal};
use asperity_scenario::Document;
use asperity_simulation::assemble::Assembly;

use crate::numbers::Numbers;

/// Most values that a run may update: it takes some milliseconds.
const MOST_UPDATES: f64 = 2e5;

/// Runs a small scenario with both integrators: an error with words, or finite samples, ordered
/// extremes and a finite energy balance.
///
/// # Panics
/// If one of these does not hold.
pub fn step(bytes: &[u8]) {
    let mut numbers = Numbers::new(bytes);
    let text = numbers.scenario().to_string();
    let document = Document::parse(&text, "fuzz.json").expect("numbers make JSON");
    let Ok(scenario) = document.scenario() else { return };
    let assembly = match Assembly::new(&scenario, Path::new("")) {
        Ok(assembly) => assembly,
        Err(error) => return assert!(!error.to_string().is_empty()),
    };
    let cells =
        FiniteDifference { cell: numbers.between(1e-3, 0.2), ..FiniteDifference::default() };
    let modes_per_body = Some(1 + numbers.below(4));
    let modal = Modal { modes_per_body, ..Modal::default() };
    for method in [Integrator::from(cells), Integrator::from(modal)] {
        run(&text, &assembly, &method);
    }
}

fn run(text: &str, assembly: &Assembly, method: &Integrator) {
    let Assembly { structure, load, sampling, .. } = assembly;
    let sensors = assembly.sensor_ports();
    let Ok(outline) = method.outline(structure, load, sampling) else { return };
    if outline.unknowns as f64 * outline.steps as f64 > MOST_UPDATES {
        return;
    }
    let transient = match method.integrate(structure, load, &sensors, sampling) {
        Ok(transient) => transient,
        Err(error) => return assert!(!error.to_string().is_empty()),
    };
    let name = method.name();
    let history = &transient.history;
    assert_eq!(history.sensors[0].displacement.len(), sampling.samples(), "{text}: {name}");
    let sensor = &history.sensors[0];
    for values in [&history.load, &sensor.displacement, &sensor.velocity, &sensor.acceleration] {
        assert!(values.iter().all(|value| value.is_finite()), "{text}: {name}: not finite");
    }
    for contact in &transient.contacts {
        assert!(contact.pressure_min <= contact.pressure_max, "{text}: {name}: {contact:?}");
        assert!(
            contact.stiffness_average >= 0.0 && contact.lost >= 0.0,
            "{text}: {name}: {contact:?}"
        );
    }
    assert!(transient.energy.residual_relative() >= 0.0, "{text}: {name}: {:?}", transient.energy);
}
