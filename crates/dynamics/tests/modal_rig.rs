//! The modal integrator at its defaults on the paper's rig, against converged values: spectral
//! elements, two modal computations and this project's finite differences agree on them to 1e-5.
#![allow(clippy::print_stdout, reason = "what was found, for a test that fails")]
#![allow(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

mod support;

use asperity_dynamics::Modal;
use support::struck::{Response, close, respond};
use support::{constant, modified, power, slope};

/// Within 0.005 % in f1, 0.1 % in A1, 0.2 % in A2/A1 and in lowest pressure; the mean stiffness to
/// the digits given. The last pair has more digits: converged at 32 N 822.794 Hz, 1.60696e-7 m/N, 0.29364,
/// 0.028845 MPa; at 9 N 868.428 Hz, 2.45393e-7 m/N, 0.12334, 0.082285 MPa.
#[test]
fn the_default_step_meets_the_converged_responses() {
    let table = [
        (9.0, 868.428, 2.45393, 0.12334, 8.2285e4, 9.4985e11, 1702.6),
        (20.0, 851.97, 1.9866, 0.21100, 0.04921e6, 9.4625e11, 1634.6),
        (32.0, 822.794, 1.60696, 0.29364, 2.8845e4, 9.4303e11, 1565.4),
    ];
    for (force, f1, a1, ratio, lowest, average, f2) in table {
        let Response { transient, first, second } = respond(&modified(), force, &Modal::default());
        println!("{force} N, step {:e}, {:?}", transient.step, transient.energy);
        let second = second.unwrap();
        close(first.frequency, f1, 5e-5, "f1");
        close(first.magnitude, a1 * 1e-7, 1e-3, "A1");
        close(second.magnitude / first.magnitude, ratio, 2e-3, "A2/A1");
        close(second.frequency, f2, 1e-4, "f2");
        close(transient.contacts[0].pressure_min, lowest, 2e-3, "lowest pressure");
        close(transient.contacts[0].stiffness_average, average, 1e-4, "K_avr");
        assert_eq!(transient.contacts[0].lost, 0.0);
        assert!(transient.energy.residual_relative() < 5e-4);
    }
}

#[test]
fn the_power_law_has_the_converged_responses_and_loses_contact_at_32_newton() {
    for (force, f1, ratio, lost) in [
        (9.0, 945.13, 0.05746, 0.0),
        (20.0, 942.39, 0.10079, 0.0),
        (32.0, 935.63, 0.15657, 0.32e-3),
    ] {
        let Response { first, second, transient } = respond(&power(), force, &Modal::default());
        // Where contact is lost the step is of lower order.
        close(first.frequency, f1, if lost > 0.0 { 1e-4 } else { 5e-5 }, "f1");
        close(second.unwrap().magnitude / first.magnitude, ratio, 2e-3, "A2/A1");
        // To a step at either end of two losses.
        assert!((transient.contacts[0].lost - lost).abs() < 3e-5, "{:?}", transient.contacts[0]);
        assert_eq!(transient.contacts[0].pressure_min == 0.0, lost > 0.0);
    }
}

#[test]
fn the_constant_stiffness_has_one_peak_at_any_force() {
    for force in [9.0, 32.0] {
        let response = respond(&constant(), force, &Modal::default());
        close(response.first.frequency, 830.93, 5e-5, "f1");
        assert!(response.second.is_none(), "{:?}", response.second);
        close(response.transient.contacts[0].stiffness_average, 8.5e11, 1e-12, "K_avr");
    }
}

/// Third order in the step for what the parabola carries: the damping it adds, seen in A1, and
/// the frequency; against the same modes at a tenth of the step.
#[test]
fn amplitude_and_frequency_converge_with_slope_three() {
    for force in [9.0, 20.0] {
        let at = |step: f64| {
            let method = Modal { step: Some(step), modes_per_body: Some(3), ..Modal::default() };
            respond(&modified(), force, &method).first
        };
        let exact = at(1e-6);
        let steps = [20e-6, 15e-6, 10e-6];
        let found = steps.map(at);
        let amplitude = found.each_ref().map(|peak| (peak.magnitude / exact.magnitude - 1.0).abs());
        let order = slope(&steps, &amplitude);
        println!("{force} N: A1 {amplitude:?}, slope {order:.3}");
        assert!((2.6..3.4).contains(&order), "{force} N: {order}");
        let frequency = found.map(|peak| (peak.frequency / exact.frequency - 1.0).abs());
        assert!(frequency[0] < 1e-4 && frequency[2] < 2e-5, "{frequency:?}");
    }
}
