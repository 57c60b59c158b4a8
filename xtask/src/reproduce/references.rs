//! The stored tables that `--check` compares with.

use std::path::Path;

use anyhow::{Context, Result};
use asperity_table::Table;

use super::paper_figure::Finished;

/// Largest difference from the stored table, over the largest magnitude of its
/// column. Machines with and without fused multiply-add round differently; over
/// a run the difference grows to about 1e-9 of the response.
const TOLERANCE: f64 = 1e-6;

/// The same for columns of errors and of their slopes, differences of nearly
/// equal numbers, in which that rounding weighs up to a thousand times as much,
/// for times and thresholds that are found in whole steps, and for what a fit or a
/// profile found, which stop when they are near enough.
const COARSE_TOLERANCE: f64 = 1e-3;
const COARSE_COLUMNS: [&str; 5] = ["_error", "_slope", "contact_lost_s", "threshold_n", ":fit"];

/// The same for quantiles of draws from a posterior: a draw that rounding turns the other way
/// changes all that follow it, as another seed does, which moves two of them apart by 5e-3 (one
/// standard deviation, measured over six seeds).
const SAMPLED_TOLERANCE: f64 = 3e-2;
const SAMPLED_COLUMNS: [&str; 3] = [":lower", ":median", ":upper"];

/// End of the name of a column with the Monte Carlo standard errors of the column named before it;
/// two such columns may differ by [`MOST_STANDARD_ERRORS`] of their difference, and their errors,
/// which are estimates, by the factor [`ERROR_FACTOR`].
const MONTE_CARLO_ERROR: &str = ":monte_carlo_error";
const MOST_STANDARD_ERRORS: f64 = 5.0;
const ERROR_FACTOR: f64 = 4.0;

/// Most rows stored of a table: a longer one is stored in equal strides.
const MOST_ROWS: usize = 400;

/// Stores the tables.
pub(crate) fn store(folder: &Path, finished: &[Finished]) -> Result<()> {
    std::fs::create_dir_all(folder)?;
    for done in finished {
        let place = folder.join(format!("{}.csv", done.figure.id));
        super::write(&place, decimated(&done.table)?.to_csv().as_bytes())?;
    }
    Ok(())
}

/// Differences from the stored tables, one line each.
pub(crate) fn compare(folder: &Path, finished: &[Finished]) -> Result<Vec<String>> {
    let mut differences = Vec::new();
    for done in finished {
        let id = done.figure.id;
        let place = folder.join(format!("{id}.csv"));
        let stored = read(&place)?;
        if let Some(difference) = difference(&stored, &decimated(&done.table)?) {
            differences.push(format!("{id}: {difference}"));
        }
    }
    Ok(differences)
}

/// A stored table; NaN where a field is empty.
fn read(place: &Path) -> Result<Table> {
    let mut reader = csv::Reader::from_path(place).with_context(|| {
        format!("no reference table {}; store it with --bless", place.display())
    })?;
    let names: Vec<String> = reader.headers()?.iter().map(str::to_owned).collect();
    let mut columns = vec![Vec::new(); names.len()];
    for row in reader.records() {
        for (column, field) in columns.iter_mut().zip(&row?) {
            column.push(if field.is_empty() { f64::NAN } else { field.parse()? });
        }
    }
    let mut table = Table::new();
    for (name, values) in names.into_iter().zip(columns) {
        table.push(name, values)?;
    }
    Ok(table)
}

fn decimated(table: &Table) -> Result<Table> {
    let stride = table.rows().div_ceil(MOST_ROWS).max(1);
    let mut decimated = Table::new();
    for column in table.columns() {
        let values: Vec<f64> = column.values().iter().copied().step_by(stride).collect();
        decimated.push(column.name(), values)?;
    }
    Ok(decimated)
}

/// Largest difference of a value in the column of this name whose largest magnitude is `scale`.
fn tolerance(column: &str, scale: f64) -> f64 {
    let is_any = |ends: &[&str]| ends.iter().any(|end| column.ends_with(end));
    let relative = if is_any(&SAMPLED_COLUMNS) {
        SAMPLED_TOLERANCE
    } else if is_any(&COARSE_COLUMNS) {
        COARSE_TOLERANCE
    } else {
        TOLERANCE
    };
    relative * scale
}

/// The first difference between two tables, in words.
fn difference(stored: &Table, computed: &Table) -> Option<String> {
    let names = |table: &Table| table.names().map(str::to_owned).collect::<Vec<_>>();
    let (old, new) = (names(stored), names(computed));
    if old != new {
        return Some(format!("columns {old:?} are stored, {new:?} computed"));
    }
    if stored.rows() != computed.rows() {
        return Some(format!("{} rows are stored, {} computed", stored.rows(), computed.rows()));
    }
    for (old, new) in stored.columns().iter().zip(computed.columns()) {
        let name = old.name();
        let finite = old.values().iter().filter(|value| value.is_finite());
        let scale = finite.fold(0.0, |largest: f64, value| largest.max(value.abs()));
        let errors_of = |table: &Table| {
            table.column(&format!("{name}{MONTE_CARLO_ERROR}")).ok().map(<[f64]>::to_vec)
        };
        let errors = errors_of(stored).zip(errors_of(computed));
        let allowed = |row: usize| match &errors {
            Some((old, new)) => MOST_STANDARD_ERRORS * old[row].hypot(new[row]),
            None => tolerance(name, scale),
        };
        for (row, (&a, &b)) in old.values().iter().zip(new.values()).enumerate() {
            let same = if name.ends_with(MONTE_CARLO_ERROR) {
                a <= ERROR_FACTOR * b && b <= ERROR_FACTOR * a
            } else {
                (a - b).abs() <= allowed(row)
            };
            if !(same || (a.is_nan() && b.is_nan())) {
                return Some(format!("{name}, row {}: {a:e} is stored, {b:e} computed", row + 1));
            }
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(values: &[f64]) -> Table {
        Table::new().with_column("a_m", values).unwrap()
    }

    #[test]
    fn a_change_beyond_the_tolerance_is_found_and_named() {
        let stored = table(&[1.0, -2.0, f64::NAN]);
        assert_eq!(difference(&stored, &table(&[1.0, -2.0 + 1e-7, f64::NAN])), None);
        let changed = difference(&stored, &table(&[1.0, -2.001, f64::NAN])).unwrap();
        assert!(changed.contains("a_m, row 2"), "{changed}");
        assert!(difference(&stored, &table(&[1.0, -2.0])).is_some());
        assert!(difference(&stored, &table(&[1.0, -2.0, 0.0])).is_some());
        for (name, change, is_found) in
            [("a:fit", 9e-4, false), ("a:fit", 2e-3, true), ("a:lower", 1e-2, false)]
        {
            let column = |value: f64| Table::new().with_column(name, vec![value]).unwrap();
            assert_eq!(difference(&column(1.0), &column(1.0 + change)).is_some(), is_found);
        }
        let sampled = |value: f64, error: f64| {
            Table::new()
                .with_column("a:upper", vec![value])
                .and_then(|table| table.with_column("a:upper:monte_carlo_error", vec![error]))
                .unwrap()
        };
        let old = sampled(1.0, 0.03);
        for (value, error, is_found) in
            [(1.2, 0.03, false), (1.22, 0.03, true), (1.0, 0.1, false), (1.0, 0.13, true)]
        {
            assert_eq!(difference(&old, &sampled(value, error)).is_some(), is_found, "{value}");
        }
        let other = Table::new().with_column("b_m", vec![1.0, -2.0, f64::NAN]).unwrap();
        assert!(difference(&stored, &other).is_some());
    }
}
