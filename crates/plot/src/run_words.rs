//! The summary of a run in words.

use std::fmt::Write as _;

use asperity_signal::HarmonicOptions;
use asperity_simulation::summary::{Amplitude, Summary};

/// Error over value up to which a number of a response that depends on rounding is stated.
const STATED: f64 = 0.05;

/// The summary of a run as text, a line for each number.
pub fn run_words(summary: &Summary) -> String {
    let mut lines = Vec::new();
    let mut line = |name: &str, value: String| lines.push(format!("{name:<26}{value}\n"));
    if let Some(natural) = summary.at_rest.natural_frequency_hz {
        line("natural frequency at rest", format!("{natural:.2} Hz"));
    }
    // Numbers that depend on rounding are not stated.
    let stated = |name: &str, value: f64| {
        let error =
            summary.accuracy.as_ref().and_then(|accuracy| accuracy.errors.get(name)?.as_f64());
        !summary.sensitive || error.is_some_and(|error| error <= STATED * value.abs())
    };
    let windows = HarmonicOptions::default();
    let undetermined = || "not determined, depends on rounding".to_owned();
    match &summary.fundamental {
        Some(f) if !stated("fundamental.frequency_hz", f.frequency_hz) => {
            line("fundamental", undetermined());
        }
        Some(f) => {
            let unit = match f.amplitude {
                Amplitude::PerForce { .. } => "m/N",
                Amplitude::PerBase { .. } => "s^2 (relative displacement per base acceleration)",
            };
            let (hz, receptance) = (f.frequency_hz, f.amplitude.value());
            line("fundamental", format!("{hz:.2} Hz, {receptance:.4e} {unit}"));
            if let Some(ratio) = f.damping_ratio
                && stated("fundamental.damping_ratio", ratio)
            {
                line("damping (half power)", format!("{:.2} %", 100.0 * ratio));
            }
            if let Some(ratio) = f.damping_ratio_decrement
                && stated("fundamental.damping_ratio_decrement", ratio)
            {
                line("damping (decrement)", format!("{:.2} %", 100.0 * ratio));
            }
        }
        None => {
            let natural = summary.at_rest.natural_frequency_hz;
            line("fundamental", no_peak(&summary.masked_hz, natural, windows.fundamental_window));
        }
    }
    match &summary.second_harmonic {
        Some(_) if !stated("harmonic_ratio", summary.harmonic_ratio.unwrap_or(f64::NAN)) => {
            line("second harmonic", undetermined());
        }
        Some(s) => {
            let ratio = summary.harmonic_ratio.unwrap_or(f64::NAN);
            line("second harmonic", format!("{:.2} Hz, A2/A1 = {ratio:.4}", s.frequency_hz));
        }
        None => {
            let first = summary.fundamental.map(|first| first.frequency_hz);
            line("second harmonic", no_peak(&summary.masked_hz, first, windows.second_window));
        }
    }
    for contact in &summary.interfaces {
        let (low, high) = (contact.pressure_min_pa / 1e6, contact.pressure_max_pa / 1e6);
        let named = |what: &str| format!("interfaces.{}.{what}", contact.name);
        let mut text = if stated(&named("pressure_max_pa"), contact.pressure_max_pa) {
            format!("{low:.4} to {high:.4} MPa")
        } else {
            undetermined()
        };
        if contact.contact_lost_s > 0.0 && stated(&named("contact_lost_s"), contact.contact_lost_s)
        {
            let _ = write!(text, ", contact lost for {:.3} ms", 1e3 * contact.contact_lost_s);
        }
        line(&contact.name, text);
    }
    let residual = summary.energy.residual_relative;
    line("energy balance", format!("closes to {residual:.1e} of the input"));
    if let Some(accuracy) = &summary.accuracy {
        let (error, asked) = (accuracy.estimated_error, accuracy.asked);
        let reached = if accuracy.reached { "" } else { ", not reached" };
        line("estimated error", format!("{error:.1e} ({asked:.0e} asked for{reached})"));
    }
    if let Some(from) = summary.sensitive_from_s {
        line("depends on rounding", format!("from {:.3} ms on", 1e3 * from));
    }
    let numerics = &summary.numerics;
    line("run", format!("{} steps in {:.3} s", numerics.steps, numerics.wall_s));
    lines.concat()
}

/// Words in the place of a peak in a window about a frequency \[Hz\]: the highest maximum in it that the force
/// is too weak for, if there is one.
fn no_peak(masked_hz: &[f64], about: Option<f64>, (low, high): (f64, f64)) -> String {
    let in_window =
        |hz: &&f64| about.is_some_and(|about| **hz > low * about && **hz < high * about);
    match masked_hz.iter().find(in_window) {
        Some(hz) => format!("no peak; the force is too weak for the maximum at {hz:.2} Hz"),
        None => "no peak".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_masked_maximum_is_named_in_its_window() {
        let masked = [300.0, 810.0, 1700.0];
        let weak = |hz: &str| format!("no peak; the force is too weak for the maximum at {hz} Hz");
        assert_eq!(no_peak(&masked, Some(800.0), (0.4, 1.4)), weak("810.00"));
        assert_eq!(no_peak(&masked, Some(800.0), (1.7, 2.3)), weak("1700.00"));
        assert_eq!(no_peak(&masked, Some(2000.0), (1.7, 2.3)), "no peak");
        assert_eq!(no_peak(&masked, None, (0.4, 1.4)), "no peak");
    }
}
