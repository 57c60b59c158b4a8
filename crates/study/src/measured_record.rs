//! Simulated runs as the records of a measurement.

use asperity_dynamics::History;
use asperity_measure::{Abscissa, Channel, ChannelQuantity, ChannelUnit, Origin, Record, Samples};

/// Force, acceleration and displacement of a run, as a data acquisition system
/// would have recorded them at the output rate (Hz).
pub fn measured_record(history: &History, rate_hz: f64, title: Option<&str>) -> Record {
    let start = history.time.first().copied().unwrap_or(0.0);
    let channel = |name: &str, unit: &str, quantity, samples: &[f64]| Channel {
        name: name.to_owned(),
        quantity,
        unit: ChannelUnit::of_text(unit),
        abscissa: Abscissa::even_time(start, rate_hz),
        samples: Samples::Real(samples.to_vec()),
        origin: Origin::default(),
    };
    Record {
        channels: vec![
            channel("force", "N", ChannelQuantity::Force, &history.force),
            channel("acceleration", "m/s^2", ChannelQuantity::Acceleration, &history.acceleration),
            channel("displacement", "m", ChannelQuantity::Displacement, &history.displacement),
        ],
        continues: false,
        title: title.unwrap_or_default().to_owned(),
        date: String::new(),
    }
}
