//! The paper's rig against converged values: spectral elements, two modal computations and finite
//! differences agree on them to 1e-5, for the pulse `F (t/tp)^2 exp(2 (1 - t/tp))`, tp = 0.34 ms,
//! over 0.12 s. The default grid of 1 mm with the centred contact, and the default modal step.

use asperity_dynamics::{FiniteDifference, Integrator, Modal};

use crate::support::hit_response::{Response, close, respond, respond_on};
use crate::support::receptance::Peak;
use crate::support::{constant, modified, power, single_body, slope};

fn finite_difference() -> Integrator {
    FiniteDifference::default().into()
}

fn modal() -> Integrator {
    Modal::default().into()
}

/// Relative tolerances.
struct Tolerances {
    fundamental: f64,
    amplitude: f64,
    ratio: f64,
    pressure: f64,
}

/// Finite differences: the error of the scheme is about 2e-5, in the lowest pressure 2e-4; the
/// values are given to 1e-5 and 1e-4 (A2/A1, pressures), and tolerances are some four times that.
const GRID: Tolerances =
    Tolerances { fundamental: 1e-4, amplitude: 2e-4, ratio: 3e-4, pressure: 1e-3 };

const STEPS: Tolerances =
    Tolerances { fundamental: 5e-5, amplitude: 1e-3, ratio: 2e-3, pressure: 2e-3 };

#[test]
fn the_modified_law_has_the_converged_responses() {
    let table = [
        // F, f1, A1 1e7, A2/A1, lowest pressure, K_avr, second peak
        (9.0, 868.428, 2.45393, 0.12334, 8.2285e4, 9.4985e11, 1702.6),
        (20.0, 851.97, 1.9866, 0.21100, 0.04921e6, 9.4625e11, 1634.6),
        (32.0, 822.794, 1.60696, 0.29364, 2.8845e4, 9.4303e11, 1565.4),
    ];
    for (method, tolerances) in [(finite_difference(), GRID), (modal(), STEPS)] {
        for (force, f1, a1, ratio, lowest, average, f2) in table {
            let Response { transient, first, second } = respond(&modified(), force, &method);
            let second = second.unwrap();
            close(first.frequency, f1, tolerances.fundamental, "f1");
            close(first.magnitude, a1 * 1e-7, tolerances.amplitude, "A1");
            close(second.magnitude / first.magnitude, ratio, tolerances.ratio, "A2/A1");
            close(second.frequency, f2, 1e-4, "f2");
            let contact = &transient.contacts[0];
            close(contact.pressure_min, lowest, tolerances.pressure, "lowest pressure");
            close(contact.stiffness_average, average, 1e-4, "K_avr");
            assert_eq!(contact.lost, 0.0);
            assert!(transient.energy.residual_relative() < 5e-4);
        }
    }
}

/// The power law's "permanent compression" does not hold at 32 N: contact at the guide is lost for
/// 0.32 ms in all.
#[test]
fn the_power_law_has_the_converged_responses_and_loses_contact_at_32_newton() {
    // Half of the last digit given; a step at either end of two losses.
    for (method, tolerances, at_loss, time) in
        [(finite_difference(), GRID, 1e-4, 0.005e-3), (modal(), STEPS, 1e-4, 3e-5)]
    {
        for (force, f1, ratio, lost) in [
            (9.0, 945.13, 0.05746, 0.0),
            (20.0, 942.39, 0.10079, 0.0),
            (32.0, 935.63, 0.15657, 0.32e-3),
        ] {
            let Response { first, second, transient } = respond(&power(), force, &method);
            // Where contact is lost the modal step is of lower order.
            // Found 2.1e-3 in A2/A1 at the default step, which no error control refines here.
            let (tolerance, of_ratio) = if lost > 0.0 {
                (at_loss, 3e-3)
            } else {
                (tolerances.fundamental, tolerances.ratio)
            };
            close(first.frequency, f1, tolerance, "f1");
            let found = second.unwrap().magnitude / first.magnitude;
            close(found, ratio, of_ratio, "A2/A1");
            let contact = &transient.contacts[0];
            assert!((contact.lost - lost).abs() < time, "{force} N: {contact:?}");
            assert_eq!(contact.pressure_min == 0.0, lost > 0.0);
            let stiffness = &transient.history.interfaces[0].stiffness;
            let open = stiffness.iter().filter(|k| **k == 0.0).count();
            assert!((open as f64 * 5e-6 - lost).abs() < 2e-5_f64.max(time));
        }
    }
}

/// With a constant stiffness the response is linear: one frequency, and no second harmonic.
#[test]
fn the_constant_stiffness_has_one_peak_at_any_force() {
    for (method, tolerances) in [(finite_difference(), GRID), (modal(), STEPS)] {
        let responses = [9.0, 20.0, 32.0].map(|force| respond(&constant(), force, &method));
        for response in &responses {
            close(response.first.frequency, 830.93, tolerances.fundamental, "f1");
            // Two contacts at static stiffness: the damped peak f0 sqrt(1 - 2 zeta^2).
            let expected = 831.98 * (1.0 - 2.0 * 0.035_f64.powi(2)).sqrt();
            close(response.first.frequency, expected, 2e-4, "f0 sqrt(1 - 2 zeta^2)");
            assert!(response.second.is_none(), "{:?}", response.second);
            let linear = response.first.magnitude / responses[0].first.magnitude;
            assert!((linear - 1.0).abs() < 1e-9, "{linear}");
            close(response.transient.contacts[0].stiffness_average, 8.5e11, 1e-12, "K_avr");
        }
    }
}

/// Fifth order in the step for what the quartic carries: the damping it adds, seen in A1, and the
/// frequency, of a guide whose modes all have it; against the same modes at a fifth of the step.
#[test]
fn amplitude_and_frequency_converge_with_slope_five() {
    for force in [9.0, 20.0] {
        let at = |step: f64| {
            let method = Modal { step: Some(step), modes_per_body: Some(1), ..Modal::default() };
            respond_on(&single_body(&modified(), 9.81), force, &method).first
        };
        let exact = at(8e-6);
        let steps = [48e-6, 40e-6, 32e-6];
        let found = steps.map(at);
        let of = |value: fn(&Peak) -> f64| -> [f64; 3] {
            found.each_ref().map(|peak| (value(peak) / value(&exact) - 1.0).abs())
        };
        let (amplitude, frequency) = (of(|peak| peak.magnitude), of(|peak| peak.frequency));
        let orders = [slope(&steps, &amplitude), slope(&steps, &frequency)];
        assert!(
            orders.iter().all(|order| (4.5..6.5).contains(order)),
            "{orders:?} {amplitude:?} {frequency:?}"
        );
        assert!(frequency[2] < 2e-5, "{frequency:?}");
    }
}
