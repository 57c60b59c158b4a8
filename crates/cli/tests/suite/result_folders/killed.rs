//! Runs killed at any moment: the folder holds one complete result, and the next run works.

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::fs;
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use rustix::process::{Pid, Signal, kill_process};
use serde_json::Value;
use tempfile::TempDir;

use super::{QUICK, entries, hammer_csv, rig, store, succeed};
use crate::files;

const SIGNALS: [Signal; 3] = [Signal::KILL, Signal::TERM, Signal::INT];

/// Moments of a run, by what exists in its work folder.
const MOMENTS: [&str; 6] =
    ["lock", "new", "new/history.csv", "new/frf.svg", "new/summary.json", "exchanged"];

/// Files of a result, without the time that the run took.
type Contents = BTreeMap<String, Vec<u8>>;

fn contents(folder: &Path) -> Contents {
    let read = |name: String| {
        let mut bytes = fs::read(folder.join(&name)).unwrap();
        if Path::new(&name).extension().is_some_and(|extension| extension == "json") {
            let mut value: Value = serde_json::from_slice(&bytes).unwrap();
            for pointer in ["", "/numerics"] {
                if let Some(Value::Object(object)) = value.pointer_mut(pointer) {
                    object.remove("wall_s");
                }
            }
            bytes = value.to_string().into_bytes();
        }
        (name, bytes)
    };
    files(folder).into_iter().map(read).collect()
}

/// Starts a run, and kills it when `is_time`, unless it ends before.
fn kill(
    folder: &Path,
    arguments: &[impl AsRef<OsStr>],
    signal: Signal,
    is_time: impl Fn() -> bool,
) -> ExitStatus {
    let mut child: Child = Command::new(env!("CARGO_BIN_EXE_asperity"))
        .args(arguments)
        .current_dir(folder)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    while child.try_wait().unwrap().is_none() {
        if is_time() {
            kill_process(Pid::from_child(&child), signal).unwrap();
            break;
        }
    }
    child.wait().unwrap()
}

/// Two different runs of one command on one scenario, and their results.
struct Runs {
    folder: TempDir,
    arguments: [Vec<String>; 2],
    results: [Contents; 2],
}

impl Runs {
    fn new(common: &[&str], different: [&[&str]; 2]) -> Self {
        let folder = tempfile::tempdir().unwrap();
        store(&folder.path().join("rig.json"), &rig());
        let arguments = different.map(|different| {
            [common, different].concat().into_iter().map(str::to_owned).collect::<Vec<_>>()
        });
        let runs = Self { folder, arguments, results: Default::default() };
        let results = [0, 1].map(|run| {
            runs.succeed(run);
            contents(&runs.out())
        });
        assert_ne!(results[0], results[1]);
        Self { results, ..runs }
    }

    fn out(&self) -> PathBuf {
        self.folder.path().join("out/rig")
    }

    fn work(&self) -> PathBuf {
        self.folder.path().join("out/.rig.asperity")
    }

    fn succeed(&self, run: usize) {
        let arguments: Vec<&str> = self.arguments[run].iter().map(String::as_str).collect();
        succeed(self.folder.path(), &arguments);
    }

    fn kill(&self, run: usize, signal: Signal, is_time: impl Fn() -> bool) -> ExitStatus {
        kill(self.folder.path(), &self.arguments[run], signal, is_time)
    }

    /// The run whose result is in the folder, complete and alone.
    fn present(&self) -> usize {
        let found = contents(&self.out());
        let run = self.results.iter().position(|result| *result == found);
        run.unwrap_or_else(|| panic!("{:?} are of no single run", files(&self.out())))
    }

    /// Runs `run` over the result of the other, and kills it; then the folder holds one of both, and
    /// the next run ends well and leaves nothing but its result. True if the run was killed.
    fn survive(&self, run: usize, signal: Signal, is_time: impl Fn() -> bool) -> bool {
        assert_eq!(self.present(), 1 - run);
        let status = self.kill(run, signal, is_time);
        let present = self.present();
        if status.success() {
            assert_eq!(present, run);
        }
        self.succeed(run);
        assert_eq!(self.present(), run);
        assert_eq!(entries(&self.folder.path().join("out")), ["rig"]);
        !status.success()
    }
}

fn simulations() -> Runs {
    let common = [&["simulate", "rig.json"], &QUICK[..]].concat();
    Runs::new(&common, [&["--set", "/excitation/peak_n=20"], &[]])
}

#[test]
fn a_run_killed_at_any_step_leaves_one_complete_result() {
    let runs = simulations();
    let (mut run, mut killed) = (0, 0);
    for signal in SIGNALS {
        for moment in MOMENTS {
            let path = runs.work().join(moment);
            killed += usize::from(runs.survive(run, signal, || path.exists()));
            run = 1 - run;
        }
    }
    // Some may have ended before the signal; at "lock" all have their work before them.
    assert!(killed >= SIGNALS.len(), "only {killed} runs were killed");
}

#[test]
fn a_run_killed_at_any_time_leaves_one_complete_result() {
    const TIMES: u32 = 24;
    let runs = simulations();
    let started = Instant::now();
    runs.succeed(1);
    let whole: Duration = started.elapsed();
    let mut run = 0;
    for time in 0..TIMES {
        let started = Instant::now();
        // Most of them in the second half, where files are written.
        let fraction = f64::from(time + 1) / f64::from(TIMES);
        runs.survive(run, Signal::KILL, || started.elapsed() >= whole.mul_f64(fraction.sqrt()));
        run = 1 - run;
    }
}

/// A state that nobody can see is one that no killed run can leave.
#[test]
fn a_reader_finds_one_complete_result_at_any_time() {
    let runs = simulations();
    let folder = || fs::metadata(runs.out()).unwrap().ino();
    let mut observed = 0;
    thread::scope(|scope| {
        let writer = scope.spawn(|| [0, 1, 0, 1, 0, 1].map(|run| runs.succeed(run)));
        while !writer.is_finished() {
            let before = folder();
            let found = contents(&runs.out());
            // Otherwise the folder was exchanged between two files.
            if folder() == before {
                assert!(runs.results.contains(&found), "{:?}", found.keys());
                observed += 1;
            }
        }
    });
    assert!(observed > 0);
}

#[test]
fn other_commands_leave_one_complete_result() {
    let sweep = [&["sweep", "rig.json", "--vary", "/excitation/peak_n=9,20"], &QUICK[..]].concat();
    let all = [
        Runs::new(&sweep, [&["--set", "/damping/ratio=0.05"], &[]]),
        Runs::new(&["law", "rig.json"], [&["--set", "/laws/pl/exponent=0.4"], &[]]),
        Runs::new(&["modes", "rig.json"], [&["--count", "2"], &[]]),
    ];
    for runs in all {
        let mut run = 0;
        for moment in ["new", "exchanged"] {
            let path = runs.work().join(moment);
            for signal in SIGNALS {
                runs.survive(run, signal, || path.exists());
                run = 1 - run;
            }
        }
    }
}

/// Without an earlier result, there is no folder or a complete one.
#[test]
fn a_first_run_that_is_killed_leaves_no_part_of_a_result() {
    let runs = simulations();
    for moment in MOMENTS {
        fs::remove_dir_all(runs.folder.path().join("out")).unwrap();
        let path = runs.work().join(moment);
        runs.kill(0, Signal::KILL, || path.exists());
        if runs.out().exists() {
            assert_eq!(runs.present(), 0);
        }
        runs.succeed(0);
        assert_eq!(runs.present(), 0);
        assert_eq!(entries(&runs.folder.path().join("out")), ["rig"]);
    }
}

/// A conversion leaves the earlier file or the new one; the next removes what a killed one has left.
#[test]
fn a_killed_conversion_leaves_a_whole_file() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path().join("hit.uff");
    fs::write(folder.path().join("hit.csv"), hammer_csv(100_000)).unwrap();
    let convert = ["convert", "hit.csv", "hit.uff", "--to", "uff-ascii", "--overwrite"];
    succeed(folder.path(), &convert);
    let whole = fs::read(&place).unwrap();
    let unfinished = || entries(folder.path()).iter().any(|name| name.starts_with(".hit.uff"));
    for signal in SIGNALS {
        for _ in 0..4 {
            fs::write(&place, "as it was").unwrap();
            kill(folder.path(), &convert, signal, unfinished);
            let found = fs::read(&place).unwrap();
            assert!(found == b"as it was" || found == whole);
            succeed(folder.path(), &convert);
            assert_eq!(fs::read(&place).unwrap(), whole);
            assert_eq!(entries(folder.path()), ["hit.csv", "hit.uff"]);
        }
    }
}

/// A folder with other files is replaced file by file: a killed run may leave it incomplete, but
/// never with files of two runs, and the other files stay.
#[test]
fn files_of_two_runs_are_never_together() {
    let mut runs = simulations();
    fs::write(runs.out().join("thesis.tex"), "x").unwrap();
    for arguments in &mut runs.arguments {
        arguments.push("--overwrite".to_owned());
    }
    let inner = runs.out().join(".asperity/complete");
    let mut run = 0;
    for moment in ["", "history.csv", "summary.json", "../../frf.csv"] {
        for _ in 0..4 {
            runs.kill(run, Signal::KILL, || inner.join(moment).exists());
            assert_eq!(fs::read_to_string(runs.out().join("thesis.tex")).unwrap(), "x");
            let mut found = contents(&runs.out());
            found.remove("thesis.tex");
            let is_of = |run: usize| {
                found.iter().all(|(name, bytes)| runs.results[run].get(name) == Some(bytes))
            };
            assert!(is_of(0) || is_of(1), "{:?} are of no single run", found.keys());
            runs.succeed(run);
            let mut found = contents(&runs.out());
            assert_eq!(found.remove("thesis.tex").unwrap(), b"x");
            assert_eq!(found, runs.results[run]);
            assert!(!runs.out().join(".asperity").exists());
            run = 1 - run;
        }
    }
}
