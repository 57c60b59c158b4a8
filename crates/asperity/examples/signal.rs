//! Frequency response function, harmonics and damping of samples.
#![allow(clippy::print_stdout, reason = "an example prints its results")]

use asperity::prelude::*;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // The response of 1 kg at 800 Hz with 2 % of damping to a force in the first sample.
    let (rate, omega, ratio) = (51_200.0, std::f64::consts::TAU * 800.0, 0.02);
    let response = |t: f64| (-ratio * omega * t).exp() * (omega * t).sin() / omega;
    let displacement: Vec<f64> = (0..20_480).map(|n| response(f64::from(n) / rate)).collect();
    let mut force = vec![0.0; displacement.len()];
    force[0] = rate;
    let response = FrequencyResponse::from_displacement(&force, &displacement, rate)?;
    let harmonics = find_harmonics(&response, 800.0, &HarmonicOptions::default());
    let peak = harmonics.fundamental.ok_or("no peak")?;
    let damping = half_power(&response, &peak).ok_or("no width")?;
    println!("{:.2} Hz, {:.3e} m/N, damping {damping:.4}", peak.frequency_hz, peak.magnitude);
    Ok(())
}
