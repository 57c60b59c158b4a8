//! A mode and a pulse whose motions are known in closed form.

use std::f64::consts::TAU;

use asperity_measure::Record;
use asperity_signal::Complex64;

use super::hammer::{MASS, NATURAL_HZ, RATE, channel};

/// Time of the peak after the start of the pulse \[s\].
const RISE_S: f64 = 3.4e-4;
/// When the first blow begins, and the time from one to the next \[s\].
const FIRST_S: f64 = 0.02;
const SPACING_S: f64 = 0.5;

/// Force, displacement, velocity and acceleration.
pub(crate) type Signals = [Vec<f64>; 4];

/// A mode struck by pulses `F (t / rise)^2 exp(2 (1 - t / rise))` of these heights, one every
/// half second.
///
/// With the pole `p` and `q = p + 2 / rise`, the pulse and `exp(p t)` convolve to
/// `g = 2 exp(p t) / q^3 - (t^2 / q + 2 t / q^2 + 2 / q^3) exp(-2 t / rise)`; the displacement is
/// `Im g / (m w_d)`, and `g' = p g + F`.
pub(crate) fn blows(damping: f64, peaks: &[f64]) -> Signals {
    mode_under_blows((NATURAL_HZ, damping, 1.0 / MASS), peaks)
}

/// [`blows`] on a mode of this frequency \[Hz\], damping ratio and modal constant \[1/kg\].
pub(crate) fn mode_under_blows(
    (natural_hz, damping, constant): (f64, f64, f64),
    peaks: &[f64],
) -> Signals {
    let omega = TAU * natural_hz;
    let damped = omega * (1.0 - damping * damping).sqrt();
    let pole = Complex64::new(-damping * omega, damped);
    let fall = 2.0 / RISE_S;
    let q = pole + fall;
    let count = (SPACING_S * RATE) as usize * peaks.len();
    let mut signals: Signals = std::array::from_fn(|_| vec![0.0; count]);
    for (number, peak) in peaks.iter().enumerate() {
        let begin = ((FIRST_S + SPACING_S * number as f64) * RATE).round() as usize;
        for n in begin..count {
            let t = (n - begin) as f64 / RATE;
            let force = peak * (t / RISE_S * (1.0 - t / RISE_S).exp()).powi(2);
            let height = peak * 2.0_f64.exp() / (RISE_S * RISE_S);
            let rest = (1.0 / q * t + 2.0 / (q * q)) * t + 2.0 / (q * q * q);
            let g = ((pole * t).exp() * 2.0 / (q * q * q) - rest * (-fall * t).exp()) * height;
            signals[0][n] += force;
            // The force in g' is real, and no part of the velocity.
            let acceleration = pole * (pole * g + force);
            for (signal, motion) in signals[1..].iter_mut().zip([g, pole * g, acceleration]) {
                signal[n] += motion.im * constant / damped;
            }
        }
    }
    signals
}

/// A record of the force and one motion, `scale` of the unit a metre (per second).
pub(crate) fn record(force: &[f64], name: &str, unit: &str, motion: &[f64], scale: f64) -> Record {
    let motion = motion.iter().map(|x| x * scale).collect();
    Record {
        channels: vec![channel("hammer", "N", force.to_vec()), channel(name, unit, motion)],
        ..Record::default()
    }
}

/// Samples with evenly distributed noise of this size, the same on every machine.
pub(crate) fn noisy(samples: &[f64], size: f64, seed: u64) -> Vec<f64> {
    let mut state = seed;
    let mut noise = || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    };
    samples.iter().map(|x| x + size * noise()).collect()
}
