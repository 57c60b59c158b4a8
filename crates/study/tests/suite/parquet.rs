//! `study.parquet`: the rows of `study.csv`, with units and identity, in the same bytes each time.

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::AtomicBool;

use asperity_study::{RowModel, RowResult, run};
use parquet::file::metadata::{ColumnChunkMetaData, RowGroupMetaData};
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::{Field, Row};
use serde_json::{Value, json};

use crate::support::{Square, options, plan, study};

fn table(folder: &Path, rows: u64, chunk_rows: u64) -> PathBuf {
    let plan =
        plan(&study(&json!({"kind": "sobol", "rows": rows, "seed": 3}), chunk_rows)).unwrap();
    let model = Square::new(u64::MAX);
    run(&plan, &model, &options(folder), &model.stop, &|_, _| ()).unwrap();
    folder.join("study.parquet")
}

fn texts(row: &Row) -> Vec<String> {
    let text = |(_, field): (&String, &Field)| match field {
        Field::Null => String::new(),
        Field::Double(number) => asperity_table::Decimal(*number).to_string(),
        Field::Str(text) => text.clone(),
        other => panic!("{other:?}"),
    };
    row.get_column_iter().map(text).collect()
}

#[test]
fn parquet_has_the_rows_of_csv_with_their_identity() {
    let folder = tempfile::tempdir().unwrap();
    let path = table(folder.path(), 1000, 64);
    let reader = SerializedFileReader::new(File::open(&path).unwrap()).unwrap();
    let metadata = reader.metadata().file_metadata();
    let entry = |key: &str| -> Value {
        let mut entries = metadata.key_value_metadata().unwrap().iter();
        let found = entries.find(|one| one.key == format!("asperity:{key}")).unwrap();
        serde_json::from_str(found.value.as_ref().unwrap()).unwrap()
    };
    let manifest = fs::read_to_string(folder.path().join("study.json")).unwrap();
    let manifest: Value = serde_json::from_str(&manifest).unwrap();
    assert_eq!(entry("identity"), manifest["identity"]);
    let roles = ["input", "text_input", "observable", "error", "warnings"];
    for (column, role) in entry("columns").as_array().unwrap().iter().zip(roles) {
        assert_eq!(column["role"], role);
    }
    let mut csv = csv::Reader::from_path(folder.path().join("study.csv")).unwrap();
    let header: Vec<String> = csv.headers().unwrap().iter().map(str::to_owned).collect();
    let names: Vec<&str> =
        metadata.schema_descr().columns().iter().map(|column| column.name()).collect();
    assert_eq!(names, header);
    let mut rows = reader.get_row_iter(None).unwrap();
    let mut count = 0;
    for record in csv.records() {
        let expected: Vec<String> =
            record.unwrap().iter().map(|field| asperity_table::unquoted(field).into()).collect();
        assert_eq!(texts(&rows.next().unwrap().unwrap()), expected);
        count += 1;
    }
    assert!(rows.next().is_none() && count == 1000);
}

/// Thirty observables, one of them with a unit of its own.
struct Wide(Vec<String>);

impl RowModel for Wide {
    fn columns(&self) -> &[String] {
        &self.0
    }

    fn run(&self, rows: &[Vec<Value>], _stop: &AtomicBool) -> Option<Vec<RowResult>> {
        let result = |row: &Vec<Value>| {
            let x = row[0].as_f64().unwrap();
            Ok(((0_i32..).take(self.0.len()).map(|power| x.powi(power)).collect(), Vec::new()))
        };
        Some(rows.iter().map(result).collect())
    }
}

#[test]
fn bytes_do_not_depend_on_chunks_and_row_groups_are_bounded() {
    let mut bytes = Vec::new();
    for chunk_rows in [999, 40_000, 150_000] {
        let folder = tempfile::tempdir().unwrap();
        let mut study = study(&json!({"kind": "random", "rows": 150_000}), chunk_rows);
        // The size of chunks is part of the identity.
        study["chunk_rows"] = json!(chunk_rows);
        let plan = plan(&study).unwrap();
        let mut names: Vec<String> = (0..30).map(|power| format!("x{power}")).collect();
        names[1] = "fundamental.frequency_hz".into();
        let never = AtomicBool::new(false);
        run(&plan, &Wide(names), &options(folder.path()), &never, &|_, _| ()).unwrap();
        let path = folder.path().join("study.parquet");
        let reader = SerializedFileReader::new(File::open(&path).unwrap()).unwrap();
        let sizes: Vec<i64> =
            reader.metadata().row_groups().iter().map(RowGroupMetaData::num_rows).collect();
        assert_eq!(sizes, [123_361, 26_639], "2^22 numbers of 34 columns");
        let text = reader.metadata().file_metadata().key_value_metadata().unwrap()[1].value.clone();
        let columns: Value = serde_json::from_str(&text.unwrap()).unwrap();
        assert_eq!(columns[3]["unit"], "Hz");
        let end =
            reader.metadata().row_group(1).columns().iter().map(ColumnChunkMetaData::byte_range);
        let end = end.map(|(start, length)| start + length).max().unwrap();
        bytes.push(fs::read(&path).unwrap()[..end as usize].to_vec());
    }
    assert!(bytes[0] == bytes[1] && bytes[0] == bytes[2], "before the metadata");
}

/// A script that counts the rows and adds the squares, with the first reader that there is.
const READERS: &str = r"
import sys
path = sys.argv[1]
def pyarrow():
    import pyarrow.parquet as pq
    table = pq.read_table(path)
    assert b'asperity:identity' in table.schema.metadata
    return table.num_rows, sum(x for x in table['square'].to_pylist() if x is not None), table['case'][0].as_py()
def duckdb():
    import duckdb
    count, total = duckdb.sql(f'select count(*), sum(square) from read_parquet({path!r})').fetchall()[0]
    return count, total, duckdb.sql(f'select \x22case\x22 from read_parquet({path!r}) limit 1').fetchall()[0][0]
def polars():
    import polars
    table = polars.read_parquet(path)
    return table.height, table['square'].sum(), table['case'][0]
found = 0
for read in (pyarrow, duckdb, polars):
    try:
        rows, total, case = read()
    except ImportError:
        continue
    found += 1
    print(read.__name__, rows, repr(total), case, sep=';')
sys.exit(0 if found else 77)
";

#[test]
fn other_tools_open_the_table() {
    let folder = tempfile::tempdir().unwrap();
    let path = table(folder.path(), 1000, 100);
    let python = std::env::var_os("PYTHON").unwrap_or_else(|| "python3".into());
    let output = Command::new(python).arg("-c").arg(READERS).arg(&path).output();
    let Some(output) = output.ok().filter(|output| output.status.code() != Some(77)) else {
        eprintln!("skipped other_tools_open_the_table: Python has no pyarrow, duckdb or polars");
        return;
    };
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let mut csv = csv::Reader::from_path(folder.path().join("study.csv")).unwrap();
    let records: Vec<csv::StringRecord> = csv.records().map(Result::unwrap).collect();
    let sum: f64 = records.iter().filter_map(|row| row[2].parse::<f64>().ok()).sum();
    for line in String::from_utf8(output.stdout).unwrap().lines() {
        let fields: Vec<&str> = line.split(';').collect();
        assert_eq!(fields[1], "1000", "{line}");
        let total: f64 = fields[2].parse().unwrap();
        assert!((total / sum - 1.0).abs() < 1e-12, "{line} for {sum}");
        assert_eq!(fields[3], asperity_table::unquoted(&records[0][1]), "{line}");
    }
}
