//! Steady responses as tables.

use asperity_harmonic::{Branch, PeriodicResponse};
use asperity_table::DataTable;

use super::{Backbones, Steady, SteadyLevel, TimeSweep};

/// A harmonic is a column if it exceeds this share of the fundamental at some point.
const MATTERS: f64 = 1e-4;

/// `steady.csv`: a row per point of every branch, in the order of [`Steady::parts`], with harmonics up to the
/// highest that matters.
pub fn steady_table(steady: &Steady, interfaces: &[&str]) -> DataTable {
    let points: Vec<Place<'_>> = (1..)
        .zip(steady.parts())
        .flat_map(|(branch, level)| {
            let points = level.outcome.as_ref().map_or(&[][..], |branch| &branch.points);
            let place = move |(number, point)| Place { level, branch, number, point };
            (1..).zip(points).map(place)
        })
        .collect();
    let column = |value: &dyn Fn(&PeriodicResponse) -> f64| -> Vec<f64> {
        points.iter().map(|place| value(place.point)).collect()
    };
    let mut table = DataTable::new()
        .counts("branch", points.iter().map(|place| place.branch))
        .counts("point", points.iter().map(|place| place.number))
        .with(load_name(steady.is_base_motion), column(&|point| point.force))
        .with("frequency_hz", column(&PeriodicResponse::frequency_hz));
    let branches: Vec<&Branch> =
        steady.parts().filter_map(|level| level.outcome.as_ref().ok()).collect();
    let matter = harmonics_that_matter(&branches, steady.sensors.len());
    for (sensor, name) in steady.sensors.iter().enumerate() {
        let prefix = match (name, sensor) {
            (Some(name), 1..) => format!("{name}:"),
            _ => String::new(),
        };
        for k in 1..=matter {
            let amplitude = |point: &PeriodicResponse| {
                if k <= point.harmonics() { point.at_sensor(sensor, k).norm() } else { f64::NAN }
            };
            table = table.with(format!("{prefix}amplitude_{k}_m"), column(&amplitude));
        }
        let phase = |point: &PeriodicResponse| point.at_sensor(sensor, 1).arg();
        table = table.with(format!("{prefix}phase_1_rad"), column(&phase));
        if steady.is_base_motion {
            let transmissibility = |point: &PeriodicResponse| {
                let base = steady.base_shares[sensor] * point.force;
                let motion = point.sensors[sensor].clone().absolute(base);
                motion.acceleration(1).norm() / point.force
            };
            table = table.with(format!("{prefix}transmissibility_1"), column(&transmissibility));
        }
    }
    let pressures: Vec<_> = points.iter().map(|place| place.level.pressures(place.point)).collect();
    for (at, name) in interfaces.iter().enumerate() {
        let ends: (Vec<f64>, Vec<f64>) = pressures
            .iter()
            .map(|ranges| {
                ranges.get(at).map_or((f64::NAN, f64::NAN), |range| (range.lowest, range.highest))
            })
            .unzip();
        table = table
            .with(format!("{name}:pressure_min_pa"), ends.0)
            .with(format!("{name}:pressure_max_pa"), ends.1);
    }
    let stable: Vec<Option<bool>> = points.iter().map(|place| place.point.stable()).collect();
    let lost: Vec<bool> = points.iter().map(|place| place.point.contact_lost()).collect();
    let truncation = column(&|point| point.truncation);
    table.with("stable", stable).with("contact_lost", lost).with("truncation", truncation)
}

/// A point of a branch, with the numbers of both, from 1.
struct Place<'a> {
    level: &'a SteadyLevel,
    branch: usize,
    number: usize,
    point: &'a PeriodicResponse,
}

/// The highest harmonic that matters at any point; two at least, as far as they were computed.
fn harmonics_that_matter(branches: &[&Branch], sensors: usize) -> usize {
    let computed = branches.iter().map(|branch| branch.harmonics).max().unwrap_or(1);
    let points = || branches.iter().flat_map(|branch| &branch.points);
    let above = |point: &PeriodicResponse, sensor: usize, k: usize| {
        let amplitude = |k: usize| point.at_sensor(sensor, k).norm();
        amplitude(k) > MATTERS * amplitude(1)
    };
    let matters =
        |k: usize| points().any(|point| (0..sensors).any(|sensor| above(point, sensor, k)));
    (1..=computed).rev().find(|&k| matters(k)).unwrap_or(1).max(computed.min(2))
}

/// `steady_time.csv`: a row per frequency of every stepped sine by time integration, in its order.
pub fn steady_time_table(steady: &Steady) -> DataTable {
    let sweeps: &[TimeSweep] = &steady.time_sweeps;
    let rows: Vec<_> = sweeps
        .iter()
        .flat_map(|sweep| {
            let points = sweep.outcome.as_ref().map_or(&[][..], |points| points);
            points.iter().map(move |point| (sweep, point))
        })
        .collect();
    let texts = rows.iter().map(|(sweep, _)| sweep.direction().to_owned());
    DataTable::new()
        .with(
            load_name(steady.is_base_motion),
            rows.iter().map(|(sweep, _)| sweep.force_n).collect::<Vec<f64>>(),
        )
        .with("direction", texts.collect::<Vec<String>>())
        .with("frequency_hz", rows.iter().map(|row| row.1.frequency_hz).collect::<Vec<f64>>())
        .with("amplitude_1_m", rows.iter().map(|row| row.1.amplitude_1_m).collect::<Vec<f64>>())
        .with("amplitude_2_m", rows.iter().map(|row| row.1.amplitude_2_m).collect::<Vec<f64>>())
        .with("phase_1_rad", rows.iter().map(|row| row.1.phase_1_rad).collect::<Vec<f64>>())
        .counts("periods", rows.iter().map(|row| row.1.periods))
        .with("change", rows.iter().map(|row| row.1.change).collect::<Vec<f64>>())
        .with("settled", rows.iter().map(|row| row.1.settled).collect::<Vec<bool>>())
}

/// `backbone.csv`: a row per point of both backbones. Modes have a damping ratio, phase resonances
/// a force.
pub fn backbone_table(backbones: &Backbones, base: bool) -> DataTable {
    let named = [("phase_resonance", &backbones.phase_resonance), ("mode", &backbones.mode)];
    let rows: Vec<(&str, i64, &PeriodicResponse)> = named
        .into_iter()
        .flat_map(|(name, outcome)| {
            let points = outcome.as_ref().map_or(&[][..], |branch| &branch.points);
            points.iter().zip(1..).map(move |(point, number)| (name, number, point))
        })
        .collect();
    let column = |value: &dyn Fn(bool, &PeriodicResponse) -> f64| -> Vec<f64> {
        rows.iter().map(|(name, _, point)| value(*name == "mode", point)).collect()
    };
    let names = rows.iter().map(|row| row.0.to_owned());
    DataTable::new()
        .with("backbone", names.collect::<Vec<String>>())
        .with("point", rows.iter().map(|row| row.1).collect::<Vec<i64>>())
        .with(load_name(base), column(&|mode, point| if mode { f64::NAN } else { point.force }))
        .with("frequency_hz", column(&|_, point| point.frequency_hz()))
        .with("amplitude_1_m", column(&|_, point| point.at_sensor(0, 1).norm()))
        .with(
            "displacement_ratio",
            column(&|_, point| (point.at_sensor(0, 2) / point.at_sensor(0, 1)).norm()),
        )
        .with(
            "damping_ratio",
            column(&|mode, point| if mode { point.damping_ratio() } else { f64::NAN }),
        )
        .with("modal_amplitude_m_sqrt_kg", column(&|_, point| point.modal_amplitude()))
        .with("contact_lost", rows.iter().map(|row| row.2.contact_lost()).collect::<Vec<bool>>())
}

/// Name of the column of the load's amplitude.
fn load_name(base: bool) -> &'static str {
    if base { "base_acceleration_m_per_s2" } else { "force_n" }
}
