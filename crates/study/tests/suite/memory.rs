//! Memory of a study and of its answers does not grow with the number of runs.

use std::process::Command;

use asperity_study::{AnswerOptions, StudyFolder, answers, run};
use serde_json::json;

use crate::support::{Square, options, plan, study};

/// The variable of the number of runs.
const ROWS: &str = "ASPERITY_STUDY_ROWS";

/// Largest resident memory of this process so far, in bytes, where the system says it.
fn peak_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    line.trim().strip_suffix(" kB")?.trim().parse::<u64>().ok().map(|kilobytes| 1024 * kilobytes)
}

/// A study of as many runs as `ASPERITY_STUDY_ROWS` says, 4096 by default, and its answers; prints the
/// peaks of memory. The test below runs it in processes of its own.
#[test]
fn study_of_a_given_size() {
    let rows: u64 = std::env::var(ROWS).unwrap_or_default().parse().unwrap_or(4096);
    let folder = tempfile::tempdir().unwrap();
    let plan = plan(&study(&json!({"kind": "sobol", "rows": rows, "seed": 3}), 4096)).unwrap();
    let model = Square::new(u64::MAX);
    run(&plan, &model, &options(folder.path()), &model.stop, &|_, _| ()).unwrap();
    let of_study = peak_bytes().unwrap_or(0);
    let study = StudyFolder::open(folder.path()).unwrap();
    let found = answers(&plan, &study, &AnswerOptions::default()).unwrap();
    assert_eq!(found.runs, rows);
    // The middle of 2 to 13.5, less what is missing below 2.5.
    let median = found.observables[0].quantiles[2].1.value;
    assert!((median - 64.0).abs() < 0.1, "{median}");
    eprintln!("peaks;{of_study};{}", peak_bytes().unwrap_or(0));
}

/// Peaks of a study of this size and of its answers; none where the system does not say it.
fn peaks(rows: u64) -> Option<[u64; 2]> {
    peak_bytes()?;
    let test = ["memory::study_of_a_given_size", "--exact", "--nocapture"];
    let mut child = Command::new(std::env::current_exe().unwrap());
    let output = child.args(test).env(ROWS, rows.to_string()).output().unwrap();
    let text = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{text}");
    let line = text.lines().find_map(|line| line.strip_prefix("peaks;")).unwrap();
    let mut numbers = line.split(';').map(|number| number.parse().unwrap());
    Some([numbers.next().unwrap(), numbers.next().unwrap()])
}

#[test]
fn memory_does_not_grow_with_the_runs() {
    let Some(few) = peaks(300_000) else {
        eprintln!(
            "skipped memory_does_not_grow_with_the_runs: the system states no peak of memory"
        );
        return;
    };
    // More than 2^20 values are not sorted at once.
    let many = peaks(1_500_000).unwrap();
    let megabytes = [few, many].map(|peaks| peaks.map(|bytes| bytes / 1_000_000));
    // One column of the additional runs alone takes 10 MB, and their table 60 MB.
    assert!(many[0] < few[0] + 8_000_000, "study: {megabytes:?} MB");
    assert!(many[1] < few[1] + 8_000_000, "answers: {megabytes:?} MB");
}
