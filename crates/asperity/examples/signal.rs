//! Frequency response function, harmonics and damping of samples.
#![allow(clippy::print_stdout, reason = "an example prints its results")]

use asperity::prelude::*;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // The response of 1 kg at 800 Hz with 2 % of damping to a force in the first sample.
    let (rate, omega, ratio) = (51_200.0, std::f64::consts::TAU * 800.0, 0.02);
    let time = (0..20_480).map(|n| f64::from(n) / rate);
    let displacement: Vec<f64> =
        time.map(|t| (-ratio * omega * t).exp() * (omega * t).sin() / omega).collect();
    let mut force = vec![0.0; displacement.len()];
    force[0] = rate;
    let response = FrequencyResponse::from_displacement(&force, &displacement, rate)?;
    let frf = response.receptance(4);
    let harmonics = find_harmonics(&response, 800.0, &HarmonicOptions::default());
    let peak = harmonics.fundamental.ok_or("no peak")?;
    let damping = half_power(&response, &peak).ok_or("no width")?;
    println!("{} frequencies, peak {:.3e} m/N", frf.len(), peak.magnitude);
    println!("{:.2} Hz, {:.2} % of damping", peak.frequency_hz, 100.0 * damping);
    Ok(())
}
