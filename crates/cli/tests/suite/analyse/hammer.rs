//! Records of one mode struck by a hammer.

use std::f64::consts::{PI, TAU};

use asperity_measure::{Abscissa, Channel, ChannelQuantity, ChannelUnit, Origin, Record, Samples};

pub(crate) const RATE: f64 = 25_600.0;
pub(crate) const NATURAL_HZ: f64 = 831.0;
pub(crate) const DAMPING: f64 = 0.01;
pub(crate) const MASS: f64 = 1.6;

pub(crate) fn channel(name: &str, unit: &str, samples: Vec<f64>) -> Channel {
    Channel {
        name: name.to_owned(),
        quantity: ChannelQuantity::Unknown,
        unit: ChannelUnit::of_text(unit),
        abscissa: Abscissa::even_time(0.0, RATE),
        samples: Samples::Real(samples),
        origin: Origin::default(),
    }
}

/// One mode struck by half-sines `(time, peak)`; its accelerations to the
/// accuracy of Störmer's scheme with 16 steps a sample.
pub(crate) fn hammer_record(seconds: f64, blows: &[(f64, f64)]) -> Record {
    const STEPS: usize = 16;
    let (omega, duration) = (TAU * NATURAL_HZ, 0.7e-3);
    let force_at = |t: f64| -> f64 {
        let one = |&(at, peak): &(f64, f64)| {
            let inside = (0.0..duration).contains(&(t - at));
            if inside { peak * (PI * (t - at) / duration).sin() } else { 0.0 }
        };
        blows.iter().map(one).sum()
    };
    let step = 1.0 / (RATE * STEPS as f64);
    let half = DAMPING * omega * step;
    let (mut before, mut now) = (0.0, 0.0);
    let (mut force, mut acceleration) = (Vec::new(), Vec::new());
    for n in 0..(seconds * RATE) as usize * STEPS {
        let f = force_at(n as f64 * step);
        let next = (2.0 * now - (1.0 - half) * before
            + step * step * (f / MASS - omega * omega * now))
            / (1.0 + half);
        if n % STEPS == 0 {
            force.push(f);
            acceleration.push((next - 2.0 * now + before) / (step * step));
        }
        (before, now) = (now, next);
    }
    let channels = vec![channel("hammer", "N", force), channel("top", "m/s^2", acceleration)];
    Record { channels, ..Record::default() }
}
