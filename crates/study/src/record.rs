//! Results as CSV text under the column names of the contract.

use asperity_dynamics::History;
use asperity_signal::Frf;
use asperity_structure::LinearisedMode;

use asperity_table::columns_to_csv;

use crate::laws::LawTable;

/// `history.csv`: a row per output sample.
pub fn history_csv(history: &History, interfaces: &[&str]) -> String {
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
    columns_to_csv(columns)
}

/// `frf.csv`: a row per frequency.
pub fn frf_csv(frf: &Frf) -> String {
    let real: Vec<f64> = frf.values.iter().map(|value| value.re).collect();
    let imag: Vec<f64> = frf.values.iter().map(|value| value.im).collect();
    columns_to_csv([
        ("frequency_hz", &frf.frequency_hz),
        ("real_m_per_n", &real),
        ("imag_m_per_n", &imag),
        ("magnitude_m_per_n", &frf.magnitude()),
        ("phase_rad", &frf.phase()),
    ])
}

/// `law-<name>.csv`: a row per pressure.
pub fn law_csv(table: &LawTable) -> String {
    columns_to_csv([
        ("pressure_pa", &table.pressure),
        ("stiffness_pa_per_m", &table.stiffness),
        ("closure_m", &table.closure),
        ("energy_j_per_m2", &table.energy),
    ])
}

/// `modes.csv`: the shape of each mode along the stack, a row per place.
pub fn modes_csv(places: &[f64], modes: &[LinearisedMode], shapes: &[Vec<f64>]) -> String {
    let mut columns: Vec<(String, &[f64])> = vec![("position_m".to_owned(), places)];
    for (number, (mode, shape)) in modes.iter().zip(shapes).enumerate() {
        columns.push((format!("mode_{}:{:.3}_hz", number + 1, mode.frequency_hz), shape));
    }
    columns_to_csv(columns)
}
