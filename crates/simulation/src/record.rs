//! Results as files: CSV text under the column names of the contract, and runs as measurement
//! records.

use asperity_dynamics::History;
use asperity_measure::{Abscissa, Channel, ChannelQuantity, ChannelUnit, Origin, Record, Samples};
use asperity_signal::Frf;
use asperity_table::columns_to_csv;

use crate::laws::LawTable;
use crate::modes::LinearisedModes;

/// `history.csv`: a row per output sample.
pub fn history_csv(history: &History, interfaces: &[&str]) -> String {
    columns_to_csv(history_columns(history, interfaces))
}

/// Columns of `history.csv`, with their names.
pub fn history_columns<'a>(history: &'a History, interfaces: &[&str]) -> Vec<(String, &'a [f64])> {
    let mut columns: Vec<(String, &[f64])> = vec![
        ("time_s".to_owned(), &history.time),
        ("force_n".to_owned(), &history.force),
        ("displacement_m".to_owned(), &history.displacement),
        ("acceleration_m_per_s2".to_owned(), &history.acceleration),
    ];
    for (name, columns_of) in interfaces.iter().zip(&history.interfaces) {
        columns.push((format!("{name}:pressure_pa"), &columns_of.pressure));
        columns.push((format!("{name}:closure_m"), &columns_of.closure));
        columns.push((format!("{name}:stiffness_pa_per_m"), &columns_of.stiffness));
    }
    columns
}

/// `frf.csv`: a row per frequency.
pub fn frf_csv(frf: &Frf) -> String {
    columns_to_csv(frf_columns(frf))
}

/// Columns of `frf.csv`, with their names.
pub fn frf_columns(frf: &Frf) -> [(&'static str, Vec<f64>); 5] {
    [
        ("frequency_hz", frf.frequency_hz.clone()),
        ("real_m_per_n", frf.values.iter().map(|value| value.re).collect()),
        ("imag_m_per_n", frf.values.iter().map(|value| value.im).collect()),
        ("magnitude_m_per_n", frf.magnitude()),
        ("phase_rad", frf.phase()),
    ]
}

/// `law-<name>.csv`: a row per pressure.
pub fn law_csv(table: &LawTable) -> String {
    columns_to_csv(law_columns(table))
}

/// Columns of `law-<name>.csv`, with their names.
pub fn law_columns(table: &LawTable) -> [(&'static str, &[f64]); 4] {
    [
        ("pressure_pa", &table.pressure),
        ("stiffness_pa_per_m", &table.stiffness),
        ("closure_m", &table.closure),
        ("energy_j_per_m2", &table.energy),
    ]
}

/// `modes.csv`: the shape of each mode along the stack, a row per place.
pub fn modes_csv(modes: &LinearisedModes) -> String {
    columns_to_csv(modes_columns(modes))
}

/// Columns of `modes.csv`, with their names.
pub fn modes_columns(modes: &LinearisedModes) -> Vec<(String, &[f64])> {
    let mut columns: Vec<(String, &[f64])> = vec![("position_m".to_owned(), &modes.positions)];
    for (number, (mode, shape)) in modes.modes.iter().zip(&modes.shapes).enumerate() {
        columns.push((format!("mode_{}:{:.3}_hz", number + 1, mode.frequency_hz), shape));
    }
    columns
}

/// Force, acceleration and displacement of a run as a data acquisition system would have recorded
/// them at the output rate \[Hz\].
pub fn measurement_record(history: &History, rate_hz: f64, title: Option<&str>) -> Record {
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
