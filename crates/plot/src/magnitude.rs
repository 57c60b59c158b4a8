//! Magnitudes of frequency response functions on a linear, logarithmic or decibel axis, and phases.

use asperity_figure::Axis;

/// Most of the magnitude's range that is drawn, largest over least.
const MOST_RANGE: f64 = 1e6;
/// Room above the largest magnitude of a logarithmic axis.
const HEAD: f64 = 3.5;

/// Axis of the magnitudes of frequency response functions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum MagnitudeAxis {
    /// Linear.
    Linear,
    /// Logarithmic.
    #[default]
    Log,
    /// Decibels, relative to one unit.
    Db,
}

impl MagnitudeAxis {
    /// An axis that shows these magnitudes; others may lie beyond it.
    pub(super) fn axis(self, label: &str, unit: &str, shown: impl Iterator<Item = f64>) -> Axis {
        let positive = shown.filter(|magnitude| *magnitude > 0.0 && magnitude.is_finite());
        let (low, high) = positive
            .fold((f64::INFINITY, 0.0), |(low, high), m| (f64::min(low, m), f64::max(high, m)));
        let axis = match self {
            Self::Linear => Axis::linear(label, unit),
            Self::Log => Axis::log(label, unit),
            Self::Db => Axis::linear(label, format!("dB re 1 {unit}")),
        };
        if high == 0.0 {
            return axis;
        }
        match self {
            Self::Linear => axis.range(0.0, 1.2 * high),
            Self::Log | Self::Db => {
                let low = (low / 1.3).max(high / MOST_RANGE);
                axis.range(self.value(low), self.value(HEAD * high))
            }
        }
    }

    /// The number that stands for a magnitude on the axis.
    pub(super) fn value(self, magnitude: f64) -> f64 {
        match self {
            Self::Linear | Self::Log => magnitude,
            Self::Db => 20.0 * magnitude.log10(),
        }
    }
}

/// An axis of phases in degrees.
pub(super) fn phase_axis() -> Axis {
    let ticks = [-180, -90, 0, 90, 180];
    let ticks = ticks.map(|at| (f64::from(at), at.to_string().replace('-', "−")));
    Axis::linear("Phase", "°").range(-180.0, 180.0).ticks(ticks)
}

/// Frequencies and phases \[rad\] as a line in degrees, broken where the phase jumps from one end of
/// its range to the other.
pub(super) fn phase_line(frequency: &[f64], phase: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let (mut x, mut y) = (Vec::new(), Vec::new());
    let mut last = f64::NAN;
    for (&frequency, phase) in frequency.iter().zip(phase) {
        let degrees = phase.to_degrees();
        if (degrees - last).abs() > 180.0 {
            x.push(frequency);
            y.push(f64::NAN);
        }
        x.push(frequency);
        y.push(degrees);
        last = degrees;
    }
    (x, y)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn decibels_are_twenty_a_decade() {
        assert!((MagnitudeAxis::Db.value(1e-3) + 60.0).abs() < 1e-12);
        assert_eq!(MagnitudeAxis::Log.value(1e-3), 1e-3);
    }

    #[test]
    fn a_phase_that_wraps_is_not_drawn_across_the_panel() {
        let (x, y) = phase_line(&[1.0, 2.0, 3.0], &[-3.0, -0.999 * PI, 0.999 * PI]);
        assert_eq!(x, [1.0, 2.0, 3.0, 3.0]);
        assert!(y[2].is_nan() && y[1] < -179.0 && y[3] > 179.0);
    }
}
