//! Results as files: CSV text under the column names of the contract, and runs as measurement
//! records.

use std::borrow::Cow;

use asperity_dynamics::SensorHistory;
use asperity_measure::{Abscissa, Channel, ChannelQuantity, ChannelUnit, Origin, Record, Samples};
use asperity_signal::Frf;
use asperity_structure::SensorKind;
use asperity_table::columns_to_csv;

use crate::assemble::Interfaces;
use crate::contact_path::contact_paths;
use crate::error::SimulationError;
use crate::laws::LawTable;
use crate::modes::LinearisedModes;
use crate::run::{Run, receptance, transmissibility};

/// `history.csv`: a row per output sample.
pub fn history_csv<S: Interfaces>(run: &Run<S>) -> String {
    let columns = history_columns(run);
    columns_to_csv(columns.iter().map(|(name, column)| (name.as_str(), &**column)))
}

/// Columns of `history.csv`, with their names.
///
/// Beside time there are the force, or the acceleration of the base; the motion at the top, or what each
/// sensor reads; and the contacts, with the tractions of those with damping or friction. With a motion of
/// the base, sensors read the absolute motion, and columns `relative_...` have the motion relative to the
/// base.
pub fn history_columns<S: Interfaces>(run: &Run<S>) -> Vec<(String, Cow<'_, [f64]>)> {
    let history = &run.transient.history;
    let load =
        if run.assembly.load.base().is_some() { "base_acceleration_m_per_s2" } else { "force_n" };
    let mut columns: Vec<(String, Cow<'_, [f64]>)> = vec![
        ("time_s".to_owned(), (&history.time).into()),
        (load.to_owned(), (&history.load).into()),
    ];
    for Motion { name, kind, absolute, relative } in motions(run) {
        let prefix = name.map_or(String::new(), |name| format!("{name}:"));
        let column = kind.column();
        match absolute {
            None => columns.push((format!("{prefix}{column}"), relative.into())),
            Some(absolute) => {
                columns.push((format!("{prefix}{column}"), absolute.into()));
                columns.push((format!("{prefix}relative_{column}"), relative.into()));
            }
        }
    }
    let paths = contact_paths(run).into_iter();
    for (path, columns_of) in paths.zip(&history.interfaces) {
        let name = path.name();
        columns.push((format!("{name}:pressure_pa"), (&columns_of.pressure).into()));
        columns.push((format!("{name}:closure_m"), (&columns_of.closure).into()));
        columns.push((format!("{name}:stiffness_pa_per_m"), (&columns_of.stiffness).into()));
        if path.is_dissipative() {
            columns.push((format!("{name}:traction_pa"), path.traction));
        }
    }
    columns
}

/// Quantity that a sensor reads.
#[derive(Debug, Clone)]
pub struct Motion<'a> {
    /// Name of the sensor; none for the top of a scenario without sensors.
    pub name: Option<&'a str>,
    /// Quantity.
    pub kind: SensorKind,
    /// Absolute motion where the base moves.
    pub absolute: Option<Vec<f64>>,
    /// Motion relative to the base.
    pub relative: &'a [f64],
}

/// Quantity of each sensor; without sensors displacement and acceleration of the top.
pub fn motions<S>(run: &Run<S>) -> Vec<Motion<'_>> {
    let both = [SensorKind::Displacement, SensorKind::Acceleration];
    let mut motions = Vec::new();
    for (number, sensor) in run.assembly.sensors.iter().enumerate() {
        let name = sensor.name.as_deref();
        let kinds = if name.is_none() { &both[..] } else { std::slice::from_ref(&sensor.kind) };
        for &kind in kinds {
            let relative = read(&run.transient.history.sensors[number], kind);
            let moves = run.assembly.load.base().is_some();
            let absolute = moves.then(|| absolute(run, number, kind));
            motions.push(Motion { name, kind, absolute, relative });
        }
    }
    motions
}

/// The samples of a sensor relative to the base.
fn read(sensor: &SensorHistory, kind: SensorKind) -> &[f64] {
    match kind {
        SensorKind::Displacement => &sensor.displacement,
        SensorKind::Velocity => &sensor.velocity,
        SensorKind::Acceleration => &sensor.acceleration,
    }
}

/// The absolute motion that a sensor reads: its motion relative to the base, and the motion of the base.
fn absolute<S>(run: &Run<S>, sensor: usize, kind: SensorKind) -> Vec<f64> {
    let history = &run.transient.history;
    let relative = read(&history.sensors[sensor], kind);
    let share = run.assembly.sensors[sensor].base_share;
    let base = |time: f64| share * run.assembly.load.base_at(time)[kind as usize];
    history.time.iter().zip(relative).map(|(&time, relative)| relative + base(time)).collect()
}

/// `frf.csv`: a row per frequency.
pub fn frf_csv(columns: &[(String, Vec<f64>)]) -> String {
    columns_to_csv(columns.iter().map(|(name, column)| (name.as_str(), column.as_slice())))
}

/// Columns of `frf.csv`, with their names.
pub type FrfColumns = Vec<(String, Vec<f64>)>;

/// Columns of `frf.csv`, with their names: the receptance at the first sensor, and at each further one
/// under its name. With a motion of the base the columns are those of the transmissibility, absolute over
/// base motion, and after them those of the relative displacement per base acceleration \[s2\].
///
/// # Errors
/// [`SimulationError::Signal`] when a response cannot be analysed.
pub fn frf_columns<S: Interfaces>(run: &Run<S>) -> Result<Option<FrfColumns>, SimulationError> {
    let mut columns = Vec::new();
    for (number, sensor) in run.assembly.sensors.iter().enumerate() {
        let Some(frf) = receptance(run, number)? else { return Ok(None) };
        if number == 0 {
            columns.push(("frequency_hz".to_owned(), frf.frequency_hz.clone()));
        }
        let prefix = match (&sensor.name, number) {
            (Some(name), 1..) => format!("{name}:"),
            _ => String::new(),
        };
        if run.assembly.load.base().is_some() {
            push_frf(
                &mut columns,
                &format!("{prefix}transmissibility_"),
                "",
                &transmissibility(&frf, sensor.base_share),
            );
            push_frf(&mut columns, &format!("{prefix}relative_"), "_s2", &frf);
        } else {
            push_frf(&mut columns, &prefix, "_m_per_n", &frf);
        }
    }
    Ok(Some(columns))
}

fn push_frf(columns: &mut Vec<(String, Vec<f64>)>, prefix: &str, unit: &str, frf: &Frf) {
    columns
        .push((format!("{prefix}real{unit}"), frf.values.iter().map(|value| value.re).collect()));
    columns
        .push((format!("{prefix}imag{unit}"), frf.values.iter().map(|value| value.im).collect()));
    columns.push((format!("{prefix}magnitude{unit}"), frf.magnitude()));
    columns.push((format!("{prefix}phase_rad"), frf.phase()));
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

/// The load and the sensors of a run as a data acquisition system would have recorded them at the output
/// rate: without sensors acceleration and displacement of the top.
pub fn measurement_record<S>(run: &Run<S>, title: Option<&str>) -> Record {
    let (history, rate_hz) = (&run.transient.history, run.assembly.sampling.rate());
    let start = history.time.first().copied().unwrap_or(0.0);
    let channel = |name: &str, unit: &str, quantity, samples: Vec<f64>| Channel {
        name: name.to_owned(),
        quantity,
        unit: ChannelUnit::of_text(unit),
        abscissa: Abscissa::even_time(start, rate_hz),
        samples: Samples::Real(samples),
        origin: Origin::default(),
    };
    let load = history.load.clone();
    let mut channels = vec![match run.assembly.load.base() {
        None => channel("force", "N", ChannelQuantity::Force, load),
        Some(_) => channel("base acceleration", "m/s^2", ChannelQuantity::Acceleration, load),
    }];
    let mut motions = motions(run);
    if run.assembly.sensors.iter().all(|sensor| sensor.name.is_none()) {
        motions.reverse();
    }
    for Motion { name, kind, absolute, relative } in motions {
        let (word, unit, quantity) = match kind {
            SensorKind::Displacement => ("displacement", "m", ChannelQuantity::Displacement),
            SensorKind::Velocity => ("velocity", "m/s", ChannelQuantity::Velocity),
            SensorKind::Acceleration => ("acceleration", "m/s^2", ChannelQuantity::Acceleration),
        };
        let samples = absolute.unwrap_or_else(|| relative.to_vec());
        channels.push(channel(name.unwrap_or(word), unit, quantity, samples));
    }
    Record {
        channels,
        continues: false,
        title: title.unwrap_or_default().to_owned(),
        date: String::new(),
    }
}
