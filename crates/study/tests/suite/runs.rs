//! Runs: the same bytes whatever interrupts or divides them.

use std::fs;
use std::sync::atomic::AtomicBool;

use asperity_study::{RunOptions, Shard, StudyError, StudyFolder, StudyOutcome, run};
use serde_json::json;

use crate::support::{Square, options, plan, study, table};

#[test]
fn the_table_has_a_row_per_run_with_failures_and_warnings() {
    let plan = plan(&study(&json!({"kind": "grid", "levels": [24, 2]}), 7)).unwrap();
    let table = table(&plan);
    let mut reader = csv::Reader::from_reader(table.as_bytes());
    let header: Vec<_> = reader.headers().unwrap().iter().map(str::to_owned).collect();
    assert_eq!(header, ["/excitation/peak_n", "case", "square", "error", "warnings"]);
    let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    assert_eq!(rows.len(), 48);
    assert_eq!(rows[0].iter().collect::<Vec<_>>(), ["2.25", "a, b", "", "", "small"]);
    assert_eq!(rows[2].iter().collect::<Vec<_>>(), ["2.75", "a, b", "7.5625", "", ""]);
    let reason = "too large, \"by\" far\nindeed";
    assert_eq!(rows[47].iter().collect::<Vec<_>>(), ["13.75", "'=c", "", reason, ""]);
}

#[test]
fn chunks_and_interruptions_do_not_change_a_byte() {
    let design = json!({"kind": "sobol", "rows": 1000, "seed": 3});
    let of_size = |chunk_rows| plan(&study(&design, chunk_rows)).unwrap();
    let whole = table(&of_size(1000));
    assert_eq!(table(&of_size(64)), whole);
    let plan = of_size(64);
    let stops = [1, 64, 65, 500, 900];
    for (stop_after, drops) in stops.into_iter().flat_map(|rows| [(rows, false), (rows, true)]) {
        let folder = tempfile::tempdir().unwrap();
        let model = Square { drops, ..Square::new(stop_after) };
        let first = run(&plan, &model, &options(folder.path()), &model.stop, &|_, _| ()).unwrap();
        assert_eq!(first, StudyOutcome::Stopped);
        assert!(!folder.path().join("study.csv").exists());
        let again = RunOptions { resume: true, ..options(folder.path()) };
        let rest = Square::new(u64::MAX);
        let outcome = run(&plan, &rest, &again, &rest.stop, &|_, _| ()).unwrap();
        let StudyOutcome::Complete(table) = outcome else { panic!("{outcome:?}") };
        assert_eq!(fs::read_to_string(table).unwrap(), whole);
        let rows = |model: Square| model.rows.into_inner();
        assert_eq!(rows(model) + rows(rest), 1000, "no row is computed twice");
        assert!(!folder.path().join("chunks").exists());
    }
}

#[test]
fn shards_give_the_bytes_of_one_run() {
    let plan = plan(&study(&json!({"kind": "latin_hypercube", "rows": 100}), 8)).unwrap();
    let whole = table(&plan);
    let folder = tempfile::tempdir().unwrap();
    let never = AtomicBool::new(false);
    for number in [3, 1] {
        let shard = Shard::new(number, 3).unwrap();
        let model = Square::new(u64::MAX);
        let options = RunOptions { shard, ..options(folder.path()) };
        // The second time a shard has nothing to do.
        for _ in 0..2 {
            let outcome = run(&plan, &model, &options, &never, &|_, _| ()).unwrap();
            assert_eq!(outcome, StudyOutcome::ShardDone);
        }
        assert_eq!(model.rows.into_inner(), if number == 3 { 32 } else { 36 });
    }
    let study = StudyFolder::open(folder.path()).unwrap();
    let missing = study.merge().unwrap_err().to_string();
    assert!(missing.ends_with("lacks 4 of 13 chunks, the first is number 1"), "{missing}");
    let model = Square::new(u64::MAX);
    let last = RunOptions { shard: Shard::new(2, 3).unwrap(), ..options(folder.path()) };
    run(&plan, &model, &last, &never, &|_, _| ()).unwrap();
    assert_eq!(fs::read_to_string(study.merge().unwrap()).unwrap(), whole);
    // Merged once more, and continued, the result stays.
    assert_eq!(fs::read_to_string(study.merge().unwrap()).unwrap(), whole);
    for (number, count) in [(0, 3), (4, 3), (1, 1_000_000)] {
        assert!(Shard::new(number, count).is_err());
    }
}

#[test]
fn folders_of_other_things_are_refused_and_kept() {
    let design = json!({"kind": "random", "rows": 20});
    let first = plan(&study(&design, 5)).unwrap();
    let never = AtomicBool::new(false);
    let model = Square::new(u64::MAX);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    run(&first, &model, &options(path), &never, &|_, _| ()).unwrap();
    let text = |result: Result<StudyOutcome, StudyError>| result.unwrap_err().to_string();
    let begun = text(run(&first, &model, &options(path), &never, &|_, _| ()));
    assert!(begun.contains("chunks of this study"), "{begun}");
    let before = fs::read(path.join("study.csv")).unwrap();
    let again = RunOptions { resume: true, ..options(path) };
    let other = plan(&study(&json!({"kind": "random", "rows": 20, "seed": 2}), 5)).unwrap();
    let foreign = text(run(&other, &model, &again, &never, &|_, _| ()));
    assert!(foreign.contains("the study of other inputs, or of another design"), "{foreign}");
    let mut scenario = study(&design, 5);
    let block = fs::read_to_string("../simulation/examples/block.json").unwrap();
    scenario["scenario"] = serde_json::from_str(&block).unwrap();
    scenario["scenario"]["duration_s"] = json!(0.0123);
    let foreign = text(run(&plan(&scenario).unwrap(), &model, &again, &never, &|_, _| ()));
    assert!(foreign.contains("the study of another scenario"), "{foreign}");
    assert_eq!(fs::read(path.join("study.csv")).unwrap(), before);

    let other = tempfile::tempdir().unwrap();
    fs::write(other.path().join("thesis.tex"), "text").unwrap();
    let occupied = text(run(&first, &model, &options(other.path()), &never, &|_, _| ()));
    assert!(occupied.contains("holds `thesis.tex`, which is no part of a study"), "{occupied}");
    assert_eq!(fs::read_dir(other.path()).unwrap().count(), 1);
    assert!(StudyFolder::open(other.path()).unwrap_err().to_string().contains("holds no study"));
}

#[test]
fn damaged_foreign_and_misplaced_chunks_are_found() {
    let plan = plan(&study(&json!({"kind": "random", "rows": 20}), 5)).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let model = Square::new(15);
    run(&plan, &model, &options(folder.path()), &model.stop, &|_, _| ()).unwrap();
    let chunk = |number: u64| folder.path().join(format!("chunks/{number:08}.csv"));
    let study = StudyFolder::open(folder.path()).unwrap();
    let fault = || study.merge().unwrap_err().to_string();
    // A copy of one chunk as another.
    fs::copy(chunk(1), chunk(3)).unwrap();
    assert!(fault().contains("is a chunk of another study, or of another place in it"));
    // Cut in a line, and at the end of a line.
    let text = fs::read_to_string(chunk(1)).unwrap().replace("chunk 1 ", "chunk 3 ");
    fs::write(chunk(3), &text[..text.len() - 3]).unwrap();
    assert!(fault().contains("is damaged: a row has other columns"), "{}", fault());
    let last = text.trim_end().rfind('\n').unwrap();
    fs::write(chunk(3), &text[..=last]).unwrap();
    assert!(fault().contains("is damaged: it has another number of rows"));
    fs::rename(chunk(3), chunk(4)).unwrap();
    assert!(fault().contains("is no chunk of this study"));
    assert!(!folder.path().join("study.csv").exists());
}
