//! The summary of a run in words.

use std::fmt::Write as _;

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
        }
        None => line("fundamental", "no peak".to_owned()),
    }
    match &summary.second_harmonic {
        Some(_) if !stated("harmonic_ratio", summary.harmonic_ratio.unwrap_or(f64::NAN)) => {
            line("second harmonic", undetermined());
        }
        Some(s) => {
            let ratio = summary.harmonic_ratio.unwrap_or(f64::NAN);
            line("second harmonic", format!("{:.2} Hz, A2/A1 = {ratio:.4}", s.frequency_hz));
        }
        None => line("second harmonic", "no peak".to_owned()),
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
