//! Designs whose rows come from a file: the same results as a design that gives them, and what is
//! refused in which words.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use asperity_scenario::Document;
use asperity_study::{StudyError, StudyOutcome, StudyPlan, run};
use parquet::basic::Compression;
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::parser::parse_message_type;
use serde_json::{Value, json};

use crate::support::{Square, options, table};

/// A folder with the scenario.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let scenario = fs::read("../simulation/examples/block.json").unwrap();
    fs::write(folder.path().join("block.json"), scenario).unwrap();
    folder
}

fn study(file: &str) -> Value {
    json!({
        "schema": "asperity/study/1",
        "scenario": "block.json",
        "inputs": [
            {"pointer": "/excitation/peak_n"},
            {"pointer": "/title", "name": "case",
             "distribution": {"kind": "choice", "values": ["a, b", "=c", 7]}}
        ],
        "design": {"kind": "table", "file": file},
        "chunk_rows": 100
    })
}

fn plan(folder: &Path, study: &Value) -> Result<StudyPlan, StudyError> {
    StudyPlan::of(Document::parse(&study.to_string(), folder.join("study.json")).unwrap())
}

/// Rows of the two inputs, of which only the columns of a study count.
fn rows(count: usize) -> Vec<(f64, &'static str)> {
    let force = |row: usize| 2.25 + 12.0 * (row as f64 * 0.618_033_988_749_895).fract();
    (0..count).map(|row| (force(row), ["a, b", "=c", "7"][row % 3])).collect()
}

fn csv(rows: &[(f64, &str)]) -> String {
    let mut text = "id,case,/excitation/peak_n\n".to_owned();
    for (row, (force, case)) in rows.iter().enumerate() {
        writeln!(text, "\"run\n{row}\",\"{case}\",{force}").unwrap();
    }
    text
}

/// A Parquet file of the same rows, in groups of 70.
fn parquet(path: &Path, rows: &[(f64, &str)]) {
    let schema = "message rows { optional double f; required binary case (UTF8);
        required int64 id; }";
    let mut schema = schema.to_owned();
    // The parser of schemas takes no name with slashes; the column is named by the study instead.
    schema = schema.replace(" f;", " force;");
    let schema = Arc::new(parse_message_type(&schema).unwrap());
    let properties = WriterProperties::builder()
        .set_compression(Compression::SNAPPY)
        .set_data_page_row_count_limit(16)
        .set_write_batch_size(16)
        .build();
    let file = fs::File::create(path).unwrap();
    let mut writer = SerializedFileWriter::new(file, schema, Arc::new(properties)).unwrap();
    for group in rows.chunks(70) {
        let mut into = writer.next_row_group().unwrap();
        let forces: Vec<f64> = group.iter().map(|row| row.0).collect();
        let cases: Vec<ByteArray> = group.iter().map(|row| row.1.into()).collect();
        let ids: Vec<i64> = (0..).take(group.len()).collect();
        let mut column = into.next_column().unwrap().unwrap();
        let levels = vec![1; group.len()];
        column.typed::<DoubleType>().write_batch(&forces, Some(&levels), None).unwrap();
        column.close().unwrap();
        let mut column = into.next_column().unwrap().unwrap();
        column.typed::<ByteArrayType>().write_batch(&cases, None, None).unwrap();
        column.close().unwrap();
        let mut column = into.next_column().unwrap().unwrap();
        column.typed::<Int64Type>().write_batch(&ids, None, None).unwrap();
        column.close().unwrap();
        into.close().unwrap();
    }
    writer.close().unwrap();
}

fn study_of_parquet() -> Value {
    let mut study = study("rows.parquet");
    study["inputs"][0]["name"] = json!("force");
    study
}

#[test]
fn csv_and_parquet_give_their_rows_and_the_same_results() {
    let folder = folder();
    let folder = folder.path();
    let rows = rows(1000);
    fs::write(folder.join("rows.csv"), csv(&rows)).unwrap();
    parquet(&folder.join("rows.parquet"), &rows);
    let plans =
        [plan(folder, &study("rows.csv")).unwrap(), plan(folder, &study_of_parquet()).unwrap()];
    let expected: Vec<Vec<Value>> = rows
        .iter()
        .map(|(force, case)| vec![json!(force), if *case == "7" { json!(7) } else { json!(case) }])
        .collect();
    for plan in &plans {
        assert_eq!((plan.rows(), plan.dimensions()), (1000, 2));
        assert_eq!(plan.values(0..1000).unwrap(), expected);
        for range in [0..1, 69..71, 255..257, 300..640, 999..1000] {
            let part = &expected[range.start as usize..range.end as usize];
            assert_eq!(plan.values(range).unwrap(), part);
        }
    }
    let [of_csv, of_parquet] = plans.map(|plan| table(&plan));
    assert_eq!(of_csv.replacen("/excitation/peak_n", "force", 1), of_parquet);
    assert_eq!(of_csv.lines().nth(1), Some("2.25,\"a, b\",,,small"));
}

#[test]
fn integers_stay_integers() {
    let folder = folder();
    let folder = folder.path();
    fs::write(folder.join("rows.csv"), "\u{feff}case,/excitation/peak_n\n7.0,-3\n=c, 1e3 \n")
        .unwrap();
    let plan = plan(folder, &study("rows.csv")).unwrap();
    let rows = plan.values(0..2).unwrap();
    assert_eq!(rows, [[json!(-3), json!(7)], [json!(1000.0), json!("=c")]]);
}

#[test]
fn faults_of_a_table_are_named_with_their_place() {
    let folder = folder();
    let folder = folder.path();
    let fault = |text: &str| {
        fs::write(folder.join("rows.csv"), text).unwrap();
        plan(folder, &study("rows.csv")).unwrap_err().to_string()
    };
    let header = "case,/excitation/peak_n\n";
    for (text, words) in [
        ("case,force\n7,1\n", "no column `/excitation/peak_n`; its columns are: case, force"),
        ("case,case,/excitation/peak_n\n", "has the column `case` twice"),
        (&format!("{header}7,1\n7\n"), "has 1 fields in line 3; accepted: 2, as in its header"),
        (&format!("{header}7,1\n7,x\n"), "`x` is no number"),
        (&format!("{header}7,1\n7,x\n"), "row 2, column `/excitation/peak_n`"),
        (&format!("{header}7,\n"), "`` is no number"),
        (&format!("{header}7,nan\n"), "`nan` is no number"),
        (&format!("{header}8,1\n"), "`8` is none of the values \"a, b\", \"=c\", 7; row 1"),
        (header, "has 0 rows; accepted: 1 to"),
    ] {
        let found = fault(text);
        assert!(found.contains(words) && found.contains("rows.csv"), "`{found}` lacks `{words}`");
    }
    fs::write(folder.join("rows.csv"), format!("{header}7,1\n7,2\n")).unwrap();
    let changed = |change: &dyn Fn(&mut Value)| {
        let mut study = study("rows.csv");
        change(&mut study);
        match plan(folder, &study).unwrap_err() {
            StudyError::Invalid(invalid) => invalid.diagnostics[0].to_string(),
            other => other.to_string(),
        }
    };
    let found = changed(&|study| study["design"]["rows"] = json!(3));
    assert!(found.ends_with("rows.csv has 2 rows; accepted: 3"), "{found}");
    let found = changed(&|study| study["design"]["file"] = json!("none.csv"));
    assert!(found.contains("none.csv"), "{found}");
    let found = changed(&|study| study["design"] = json!({"kind": "sobol", "rows": 8}));
    assert!(
        found.starts_with("/inputs/0/distribution: there is none; accepted: a dist"),
        "{found}"
    );
    let found = changed(&|study| {
        study["inputs"][0]["distribution"] = json!({"kind": "uniform", "lower": 0, "upper": 1});
    });
    assert!(found.contains("accepted: none, or a choice"), "{found}");
    let found = changed(&|study| study["correlation"] = json!({"matrix": [[1]]}));
    assert!(found.starts_with("/correlation: "), "{found}");
}

#[test]
fn a_table_that_changes_is_refused_and_makes_another_study() {
    let folder = folder();
    let folder = folder.path();
    fs::write(folder.join("rows.csv"), csv(&rows(300))).unwrap();
    let before = plan(folder, &study("rows.csv")).unwrap();
    let never = AtomicBool::new(false);
    let out = folder.join("out");
    let model = Square::new(101);
    let stopped = run(&before, &model, &options(&out), &model.stop, &|_, _| ()).unwrap();
    assert_eq!(stopped, StudyOutcome::Stopped);
    fs::write(folder.join("rows.csv"), csv(&rows(301))).unwrap();
    let found = before.values(0..1).unwrap_err().to_string();
    assert!(found.contains("has changed since the study read it"), "{found}");
    let after = plan(folder, &study("rows.csv")).unwrap();
    let rest = asperity_study::RunOptions { resume: true, ..options(&out) };
    let found = run(&after, &Square::new(u64::MAX), &rest, &never, &|_, _| ()).unwrap_err();
    assert!(found.to_string().contains("a study with another table of rows"), "{found}");
}

#[test]
fn damaged_parquet_files_are_errors() {
    let folder = folder();
    let folder = folder.path();
    let path = folder.join("rows.parquet");
    parquet(&path, &rows(20));
    let whole = fs::read(&path).unwrap();
    let read = || plan(folder, &study_of_parquet());
    assert!(read().is_ok());
    let mut refused = 0;
    for place in (0..whole.len()).step_by(3) {
        let mut damaged = whole.clone();
        damaged[place] ^= [0x01, 0x80, 0xff][place % 9 / 3];
        fs::write(&path, damaged).unwrap();
        // Other numbers are no fault that a reader can find.
        refused += usize::from(read().is_err());
        fs::write(&path, &whole[..place]).unwrap();
        assert!(read().is_err(), "cut after {place} bytes");
    }
    assert!(refused > whole.len() / 12, "{refused} of {}", whole.len() / 3);
    let study = study("rows.parquet");
    fs::write(&path, &whole).unwrap();
    let found = plan(folder, &study).unwrap_err().to_string();
    assert!(found.contains("its columns are: force, case, id"), "{found}");
    let mut texts = study_of_parquet();
    texts["inputs"][1] = json!({"pointer": "/title", "name": "case"});
    let found = plan(folder, &texts).unwrap_err().to_string();
    assert!(found.contains("column `case` of type BYTE_ARRAY; accepted: numbers"), "{found}");
}
