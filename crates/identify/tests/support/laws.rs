//! True laws of twin experiments, of families that a Gaussian process about a power law is not.

use serde_json::{Value, json};

use crate::twin::Noise;

/// The families.
pub const FAMILIES: [&str; 6] =
    ["modified power", "shoulder", "bump", "exponential", "hyperbolic", "kink"];

/// Static pressure of the rig \[Pa\], and a stiffness there \[Pa/m\].
const AT_REST: f64 = 1.41e5;
const STIFFNESS: f64 = 1.1e12;

/// A true law of a family, with random numbers, as a table: stiffness over pressure.
pub fn law(family: &str, noise: &mut Noise) -> Vec<(f64, f64)> {
    let scale = (0.1 * noise.normal()).exp();
    let mut uniform = |low: f64, high: f64| low + (high - low) * noise.uniform();
    let log_k: Box<dyn Fn(f64) -> f64> = match family {
        // Straight lines between random knots of ln K over ln p, rounded, up to a power law.
        "modified power" => {
            let knots: Vec<(f64, f64)> =
                (0..4).map(|_| (uniform(-2.0, 0.35), uniform(0.1, 0.6))).collect();
            Box::new(move |x| {
                let bend =
                    |&(at, slope): &(f64, f64)| -slope * 0.1 * (1.0 + ((at - x) / 0.1).exp()).ln();
                0.35 * x + knots.iter().map(bend).sum::<f64>()
            })
        }
        "shoulder" => {
            let (at, width, height) = (uniform(-1.2, 0.3), uniform(0.1, 0.4), uniform(0.3, 1.0));
            Box::new(move |x| 0.35 * x + height * (0.5 + 0.5 * ((x - at) / width).tanh()))
        }
        "bump" => {
            let (at, width) = (uniform(-1.0, 0.2), uniform(0.25, 0.5));
            let height = uniform(0.2, 0.5) * width;
            Box::new(move |x| 0.5 * x + height * (-0.5 * ((x - at) / width).powi(2)).exp())
        }
        // K = p / u0.
        "exponential" => Box::new(|x| x),
        // K = K0 (1 + p / (K0 dm))^2.
        "hyperbolic" => {
            let share = uniform(0.8, 4.0);
            Box::new(move |x| 2.0 * (1.0 + x.exp() / share).ln())
        }
        "kink" => {
            let (at, below, above) = (uniform(-0.8, 0.2), uniform(0.6, 1.5), uniform(0.1, 0.5));
            Box::new(move |x| if x < at { below * (x - at) } else { above * (x - at) })
        }
        other => panic!("there is no family {other}"),
    };
    let count = 160;
    let point = |i: usize| {
        let pressure = 2e3 * (1e6_f64 / 2e3).powf(i as f64 / (count - 1) as f64);
        let x = (pressure / AT_REST).ln();
        (pressure, STIFFNESS * scale * (log_k(x) - log_k(0.0)).exp())
    };
    (0..count).map(point).collect()
}

/// The law as a scenario writes it.
pub fn written(points: &[(f64, f64)]) -> Value {
    json!({"kind": "table", "points": points.iter().map(|p| [p.0, p.1]).collect::<Vec<_>>()})
}
