//! `asperity study`: the same bytes after kills, Ctrl-C, and in shards.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use asperity_scenario::Document;
use serde_json::{Value, json};

use crate::{asperity, files, fixture, text};

/// Kills of one study.
const KILLS: u64 = 5;

/// A folder with a study of quick hits, each of whose chunks takes some milliseconds.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let rig = Document::read(fixture("scenarios/nouira2020-constant.json")).unwrap();
    let mut scenario = rig.value().clone();
    scenario["duration_s"] = json!(0.01);
    let study = json!({
        "schema": "asperity/study/1",
        "scenario": scenario,
        "inputs": [
            {"pointer": "/excitation/peak_n", "name": "force",
             "distribution": {"kind": "log_uniform", "lower": 0.5, "upper": 3}}
        ],
        "design": {"kind": "sobol", "rows": 128, "seed": 5},
        "chunk_rows": 8
    });
    fs::write(folder.path().join("rig.json"), study.to_string()).unwrap();
    folder
}

fn command(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_asperity"));
    command.args(arguments).current_dir(folder).stdout(Stdio::null()).stderr(Stdio::piped());
    command
}

fn table(folder: &Path, arguments: &[&str]) -> String {
    let output = asperity(folder, arguments);
    assert!(output.status.success(), "{arguments:?}: {}", text(&output.stderr));
    fs::read_to_string(folder.join(arguments[3]).join("study.csv")).unwrap()
}

#[test]
fn kills_at_any_moment_do_not_change_a_byte() {
    let folder = folder();
    let folder = folder.path();
    let whole = table(folder, &["study", "rig.json", "--out", "whole", "--threads", "2"]);
    assert_eq!(whole.lines().count(), 129);
    assert!(whole.starts_with("force,static.natural_frequency_hz,"));
    assert_eq!(files(&folder.join("whole")), ["study.csv", "study.json", "study.parquet"]);
    for kill in 0..KILLS {
        let again = ["study", "rig.json", "--out", "killed", "--resume", "--quiet"];
        let mut child = command(folder, &again).spawn().unwrap();
        // Moments from the start of the program to some chunks later.
        std::thread::sleep(Duration::from_millis(7 + (kill * 37) % 101));
        child.kill().unwrap();
        child.wait().unwrap();
    }
    let resumed =
        table(folder, &["study", "rig.json", "--out", "killed", "--resume", "--threads=1"]);
    assert_eq!(resumed, whole);
    assert_eq!(files(&folder.join("killed")), ["study.csv", "study.json", "study.parquet"]);
}

/// Each of some studies, 3 or as many as `ASPERITY_KILLS` says, is killed once, at moments from its
/// start to its end, joining included, and goes on with another number of threads.
#[test]
fn kills_from_start_to_end_do_not_change_a_byte() {
    let studies: u32 = std::env::var("ASPERITY_KILLS").unwrap_or_default().parse().unwrap_or(3);
    let folder = folder();
    let folder = folder.path();
    let started = Instant::now();
    table(folder, &["study", "rig.json", "--out", "whole", "--threads", "1"]);
    let length = started.elapsed();
    let bytes = |out: &str| {
        ["study.csv", "study.parquet"].map(|name| fs::read(folder.join(out).join(name)).unwrap())
    };
    let mut interrupted = 0;
    for number in 0..studies {
        let out = format!("killed{number}");
        let begin = ["study", "rig.json", "--out", &out, "--threads", "1", "--quiet"];
        let mut child = command(folder, &begin).spawn().unwrap();
        // Evenly over the time of a run, in an order without pattern.
        std::thread::sleep(length.mul_f64((f64::from(number) * 0.618_033_988_749_895).fract()));
        child.kill().unwrap();
        child.wait().unwrap();
        interrupted += u32::from(!folder.join(&out).join("study.csv").exists());
        let threads = format!("--threads={}", 2 + number % 3);
        table(folder, &["study", "rig.json", "--out", &out, "--resume", &threads]);
        assert!(bytes(&out) == bytes("whole"), "study {number}");
        let whole = ["study.csv", "study.json", "study.parquet"];
        assert_eq!(files(&folder.join(&out)), whole);
    }
    assert!(interrupted >= studies / 2, "{interrupted} were interrupted");
    eprintln!("{interrupted} of {studies} studies were interrupted, after up to {length:?}");
}

/// A limit on the size of files stands for a full disk: the manifest, a chunk, or a table does not fit.
#[test]
#[cfg(unix)]
fn a_full_disk_leaves_nothing_half_written() {
    let folder = folder();
    let folder = folder.path();
    let file = folder.join("rig.json");
    let mut study: Value = serde_json::from_str(&fs::read_to_string(&file).unwrap()).unwrap();
    // Chunks larger than the manifest and smaller than the table.
    study["chunk_rows"] = json!(20);
    fs::write(file, study.to_string()).unwrap();
    let whole = table(folder, &["study", "rig.json", "--out", "whole"]);
    for (kilobytes, file) in [(1, "study.json"), (6, "chunks/"), (13, "study.parquet")] {
        let out = format!("full{kilobytes}");
        let program = env!("CARGO_BIN_EXE_asperity");
        // Without its signal, a write beyond the limit is an error of the operating system.
        let lines = format!(
            "trap '' XFSZ; ulimit -f {kilobytes}; exec '{program}' study rig.json --out {out} 2>&1 | cat"
        );
        let output = Command::new("bash")
            .args(["-c", &format!("set -o pipefail; {lines}")])
            .current_dir(folder)
            .output()
            .unwrap();
        let said = text(&output.stdout);
        assert_eq!(output.status.code(), Some(1), "{kilobytes} kB: {said}");
        assert!(said.contains(&format!("{out}/{file}")), "{kilobytes} kB: {said}");
        assert!(said.contains("File too large"), "{kilobytes} kB: {said}");
        let all = |place: &Path| -> Vec<String> {
            let entries = fs::read_dir(place).into_iter().flatten();
            entries.map(|one| one.unwrap().file_name().to_string_lossy().into_owned()).collect()
        };
        let mut found = all(&folder.join(&out));
        found.extend(all(&folder.join(&out).join("chunks")));
        assert!(!found.iter().any(|name| name.starts_with('.')), "{kilobytes} kB: {found:?}");
        assert!(!found.contains(&file.to_owned()) && !found.contains(&"study.csv".to_owned()));
        let again = ["study", "rig.json", "--out", &out, "--resume", "--threads", "1"];
        assert_eq!(table(folder, &again), whole, "{kilobytes} kB");
        assert_eq!(files(&folder.join(&out)), ["study.csv", "study.json", "study.parquet"]);
    }
}

/// The page on other tools, whose study file and programs are run as they stand.
#[test]
fn programs_of_other_tools_drive_a_study() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/src/how-to/other-tools.md");
    let page = fs::read_to_string(page).unwrap();
    let blocks = |language: &str| -> Vec<String> {
        let parts = page.split("\n```").filter_map(|part| part.strip_prefix(language));
        parts.map(|part| part.trim_start().to_owned()).collect()
    };
    let folder = folder();
    let folder = folder.path();
    let study: Value =
        serde_json::from_str(&fs::read_to_string(folder.join("rig.json")).unwrap()).unwrap();
    fs::write(folder.join("rig.json"), study["scenario"].to_string()).unwrap();
    fs::write(folder.join("rows.json"), &blocks("json")[0]).unwrap();
    let python = std::env::var_os("PYTHON").unwrap_or_else(|| "python3".into());
    let bin = Path::new(env!("CARGO_BIN_EXE_asperity")).parent().unwrap();
    let path = std::env::var("PATH").unwrap_or_default();
    let path =
        std::env::join_paths([bin.to_owned()].into_iter().chain(std::env::split_paths(&path)));
    for (program, module) in blocks("python").iter().zip(["SALib", "openturns"]) {
        assert!(program.contains(&format!(" {module}")), "{program}");
        let has = Command::new(&python).args(["-c", &format!("import {module}, pandas")]).output();
        if !has.is_ok_and(|output| output.status.success()) {
            eprintln!("skipped programs_of_other_tools_drive_a_study: Python has no {module}");
            continue;
        }
        let mut run = Command::new(&python);
        run.args(["-c", program]).current_dir(folder).env("PATH", path.as_ref().unwrap());
        let output = run.output().unwrap();
        assert!(output.status.success(), "{module}: {}", text(&output.stderr));
        let found = text(&output.stdout);
        let total = |words: &str| -> f64 {
            let line = found.lines().find(|line| line.starts_with(words));
            let rest = line.unwrap_or_else(|| panic!("{words}: {found}")).rsplit("index ").next();
            rest.unwrap().split(' ').next().unwrap().parse().unwrap()
        };
        // The mass alone decides the frequency at rest, the force alone its work.
        for (of, input) in [("static.natural_frequency_hz", "mass"), ("energy.input_j", "force")] {
            for name in ["mass", "damping", "force"] {
                let index = total(&format!("{of}, {name}:"));
                let truth = f64::from(u8::from(name == input));
                assert!((index - truth).abs() < if name == input { 0.4 } else { 0.01 }, "{found}");
            }
        }
    }
}

#[test]
#[cfg(unix)]
fn an_interrupt_ends_after_a_chunk_and_says_how_to_go_on() {
    let folder = folder();
    let folder = folder.path();
    let child =
        command(folder, &["study", "rig.json", "--out", "o", "--threads", "1"]).spawn().unwrap();
    let chunks = folder.join("o/chunks");
    while files(&chunks).is_empty() {
        std::thread::sleep(Duration::from_millis(1));
    }
    let id = rustix::process::Pid::from_child(&child);
    rustix::process::kill_process(id, rustix::process::Signal::INT).unwrap();
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130), "{}", text(&output.stderr));
    let words = "`asperity study rig.json --out o --resume` goes on";
    assert!(text(&output.stderr).contains(words), "{}", text(&output.stderr));
    assert!(!folder.join("o/study.csv").exists());
    let refused = asperity(folder, &["study", "rig.json", "--out", "o"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(text(&refused.stderr).contains("go on with --resume"), "{}", text(&refused.stderr));
}

#[test]
fn shards_are_joined_to_the_bytes_of_one_run() {
    let folder = folder();
    let folder = folder.path();
    let whole = table(folder, &["study", "rig.json", "--out", "whole"]);
    for shard in ["2/3", "3/3"] {
        let output = asperity(folder, &["study", "rig.json", "--out", "s", "--shard", shard]);
        assert!(output.status.success(), "{}", text(&output.stderr));
    }
    let missing = asperity(folder, &["study", "merge", "s"]);
    assert_eq!(missing.status.code(), Some(1));
    let words = "lacks 6 of 16 chunks, the first is number 0";
    assert!(text(&missing.stderr).contains(words), "{}", text(&missing.stderr));
    let unfinished = |count: &str| {
        let output = asperity(folder, &["study", "unfinished", "s", "--shards", count]);
        assert!(output.status.success(), "{}", text(&output.stderr));
        text(&output.stdout).trim_end().to_owned()
    };
    // Chunks 0, 3, 6, 9, 12 and 15 are missing.
    assert_eq!(unfinished("3"), "1");
    assert_eq!(unfinished("9"), "1,4,7");
    assert_eq!(unfinished("4"), "1-4");
    asperity(folder, &["study", "rig.json", "--out", "s", "--shard", "1/3"]);
    assert_eq!(unfinished("3"), "");
    assert!(asperity(folder, &["study", "merge", "s"]).status.success());
    assert_eq!(fs::read_to_string(folder.join("s/study.csv")).unwrap(), whole);
    let wrong = asperity(folder, &["study", "rig.json", "--out", "s", "--shard", "4/3"]);
    assert_eq!(wrong.status.code(), Some(2));
}

#[test]
fn a_study_and_a_sweep_of_the_same_values_have_the_same_numbers() {
    let folder = folder();
    let folder = folder.path();
    let mut study: Value =
        serde_json::from_str(&fs::read_to_string(folder.join("rig.json")).unwrap()).unwrap();
    let scenario = study["scenario"].take();
    fs::write(folder.join("scenario.json"), scenario.to_string()).unwrap();
    study["scenario"] = json!("scenario.json");
    study["inputs"][0] = json!({"pointer": "/excitation/peak_n",
        "distribution": {"kind": "choice", "values": [2, 9.5, 20]}});
    study["design"] = json!({"kind": "grid", "levels": [3]});
    fs::write(folder.join("grid.json"), study.to_string()).unwrap();
    let found = table(folder, &["study", "grid.json", "--out", "grid"]);
    let sweep =
        ["sweep", "scenario.json", "--vary", "/excitation/peak_n=2,9.5,20", "--out", "sweep"];
    assert!(asperity(folder, &sweep).status.success());
    assert_eq!(found, fs::read_to_string(folder.join("sweep/sweep.csv")).unwrap());
}

#[test]
#[cfg(unix)]
fn the_job_script_is_a_script_of_the_shell() {
    let folder = folder();
    let folder = folder.path();
    let output =
        asperity(folder, &["study", "slurm", "rig.json", "--shards", "8", "--out", "it's"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    fs::write(folder.join("job.sh"), &output.stdout).unwrap();
    let checked = Command::new("bash").arg("-n").arg("job.sh").current_dir(folder).status();
    assert!(checked.unwrap().success());
    let script = text(&output.stdout);
    assert!(
        script.contains("file='rig.json'\nfolder='it'\\''s'\nshards=8\nretries=3\n"),
        "{script}"
    );
    assert!(script.contains("--cpus-per-task=4 --mem=4G "), "{script}");
    assert!(script.contains("--time=04:00:00"), "{script}");
    for wrong in [["--time", "soon"], ["--memory", "much"]] {
        let ask = [&["study", "slurm", "rig.json", "--shards", "8"][..], &wrong[..]].concat();
        assert_eq!(asperity(folder, &ask).status.code(), Some(2), "{wrong:?}");
    }
}

/// A stand-in for sbatch runs a task at once: a shard fails twice, is sent again alone, and all are
/// joined; without retries left the script fails and names the shard.
#[test]
#[cfg(unix)]
fn the_job_script_sends_failed_shards_again() {
    use std::os::unix::fs::PermissionsExt;

    let folder = folder();
    let folder = folder.path();
    let whole = table(folder, &["study", "rig.json", "--out", "whole"]);
    let bin = folder.join("bin");
    fs::create_dir(&bin).unwrap();
    let store = |name: &str, lines: &str| {
        let path = bin.join(name);
        fs::write(&path, format!("#!/bin/bash\n{lines}")).unwrap();
        fs::set_permissions(path, fs::Permissions::from_mode(0o755)).unwrap();
    };
    store(
        "sbatch",
        r#"echo "$*" >> sent
array=
while [ "${1#-}" != "$1" ]; do
    case "$1" in --array=*) array=${1#--array=} ;; esac
    shift
done
export SLURM_CPUS_PER_TASK=1
for part in ${array//,/ }; do
    for number in $(seq "${part%-*}" "${part#*-}"); do
        SLURM_ARRAY_TASK_ID=$number bash "$@" >&2 || true
    done
done
if [ -z "$array" ]; then bash "$@" >&2 || echo "merge failed" >&2; fi
echo "$(grep -c "" sent);here"
"#,
    );
    let program = env!("CARGO_BIN_EXE_asperity");
    store(
        "asperity",
        &format!(
            r#"if [ "${{5:-}} ${{6:-}}" = "--shard 2/3" ] && [ "$(grep -c "" sent)" -le "$FAILS" ]; then exit 9; fi
exec '{program}' "$@"
"#
        ),
    );
    let path = format!("{}:{}", bin.display(), std::env::var("PATH").unwrap());
    for (out, fails, retries) in [("some", "3", "2"), ("many", "99", "1")] {
        let shards = ["--shards", "3", "--retries", retries, "--out", out];
        let ask = [&["study", "slurm", "rig.json"][..], &shards[..]].concat();
        fs::write(folder.join("job.sh"), asperity(folder, &ask).stdout).unwrap();
        let _ = fs::remove_file(folder.join("sent"));
        let mut job = Command::new("bash");
        job.arg("job.sh").current_dir(folder).env("PATH", &path).env("FAILS", fails);
        let output = job.output().unwrap();
        assert!(output.status.success(), "{}", text(&output.stderr));
        let sent = fs::read_to_string(folder.join("sent")).unwrap();
        let arrays: Vec<&str> =
            sent.split_whitespace().filter_map(|word| word.strip_prefix("--array=")).collect();
        assert_eq!(arrays[..2], ["1-3", "2"], "{sent}");
        assert!(sent.contains("--dependency=afterany:1 "), "{sent}");
        let table = fs::read_to_string(folder.join(out).join("study.csv"));
        if retries == "2" {
            assert_eq!((arrays.len(), table.unwrap()), (3, whole.clone()), "{sent}");
        } else {
            assert!(table.is_err());
            let words = "shards 2 are not finished after 1 retries";
            assert!(text(&output.stderr).contains(words), "{}", text(&output.stderr));
        }
    }
}

/// Shards beyond the largest array are sent as several arrays, and each shard once; shards without a
/// chunk are told.
#[test]
#[cfg(unix)]
fn the_job_script_keeps_to_the_largest_array() {
    use std::os::unix::fs::PermissionsExt;

    let folder = folder();
    let folder = folder.path();
    let bin = folder.join("bin");
    fs::create_dir(&bin).unwrap();
    let store = |name: &str, lines: &str| {
        let path = bin.join(name);
        fs::write(&path, format!("#!/bin/bash\n{lines}")).unwrap();
        fs::set_permissions(path, fs::Permissions::from_mode(0o755)).unwrap();
    };
    store("sbatch", "echo \"$*\" >> sent\ngrep -c \"\" sent\n");
    let path = format!("{}:{}", bin.display(), std::env::var("PATH").unwrap());
    let send = |shards: &str, limit: &str| {
        store("scontrol", &format!("echo 'MaxArraySize            = {limit}'\n"));
        let ask = ["study", "slurm", "rig.json", "--shards", shards];
        let output = asperity(folder, &ask);
        fs::write(folder.join("job.sh"), &output.stdout).unwrap();
        let _ = fs::remove_file(folder.join("sent"));
        let mut job = Command::new("bash");
        let ended = job.arg("job.sh").current_dir(folder).env("PATH", &path).output().unwrap();
        let sent = fs::read_to_string(folder.join("sent")).unwrap_or_default();
        (text(&output.stderr), ended, sent)
    };
    let (_, ended, sent) = send("12", "6");
    assert!(ended.status.success(), "{}", text(&ended.stderr));
    let arrays: Vec<(&str, &str)> = sent
        .lines()
        .filter_map(|line| {
            let array = line.split_once("--array=")?.1.split_once(' ')?.0;
            Some((array, line.split_once("job.sh shard ")?.1))
        })
        .collect();
    assert_eq!(arrays, [("1-5", "0"), ("1-5", "5"), ("1-2", "10")], "{sent}");
    assert!(sent.contains("--dependency=afterany:1:2:3 "), "{sent}");
    let said = text(&ended.stdout);
    assert!(said.contains("shards 1-12: job 1 2 3; then job 4 joins them"), "{said}");
    let (notes, ended, sent) = send("40", "1001");
    assert!(ended.status.success() && sent.contains("--array=1-40 "), "{sent}");
    assert!(
        notes.contains("40 shards for 16 chunks of 8 rows: 24 shards compute nothing"),
        "{notes}"
    );
    let (_, ended, sent) = send("3", "0");
    assert!(!ended.status.success() && sent.is_empty(), "{sent}");
    assert!(text(&ended.stderr).contains("it takes no arrays"), "{}", text(&ended.stderr));
}

#[test]
fn answers_give_quantiles_exceedances_and_indices() {
    let folder = folder();
    let folder = folder.path();
    let mut study: Value =
        serde_json::from_str(&fs::read_to_string(folder.join("rig.json")).unwrap()).unwrap();
    study["design"] = json!({"kind": "saltelli", "base_rows": 16});
    study["frf"] = json!({"start_hz": 600, "stop_hz": 1000, "count": 21});
    fs::write(folder.join("s.json"), study.to_string()).unwrap();
    let ask = ["study", "answers", "s.json", "--json", "--exceed", "energy.input_j=0"];
    assert_eq!(asperity(folder, &ask).status.code(), Some(2), "no study yet");
    assert!(asperity(folder, &["study", "s.json"]).status.success());
    let found = crate::answer(folder, &ask);
    assert_eq!((&found["runs"], &found["failed"]), (&json!(48), &json!(0)));
    let observables = found["observables"].as_array().unwrap();
    let of = |name: &str| observables.iter().find(|one| one["name"] == name).unwrap();
    assert_eq!(of("energy.input_j")["exceedances"][0]["value"], 1.0);
    // The force decides its own work alone, and nothing at rest.
    let work = &of("energy.input_j")["sobol_indices"]["inputs"][0];
    assert!((work["total"].as_f64().unwrap() - 1.0).abs() < 0.3, "{work}");
    assert!(of("static.natural_frequency_hz")["sobol_indices"].is_null());
    // Of a constant stiffness it differs by rounding.
    let average = found["observables"].as_array().unwrap().iter();
    let mut average =
        average.filter(|one| one["name"].as_str().unwrap().ends_with("stiffness_average_pa_per_m"));
    assert!(average.all(|one| one["sobol_indices"].is_null()));
    let written = files(&folder.join("out/s"));
    let names = ["answers.json", "distributions.svg", "exceedance.csv", "exceedance.svg"];
    let lines = ["frf.csv", "frf.svg"];
    let more = ["histograms.csv", "sobol-indices.svg", "study.csv", "study.json", "study.parquet"];
    assert_eq!(written, [&names[..], &lines[..], &more[..]].concat());
    let read = |name: &str| fs::read_to_string(folder.join("out/s").join(name)).unwrap();
    for (name, labels) in [
        ("distributions.svg", ["Share of runs (%)", "Work of the force (", " J)", "guide-sample"]),
        (
            "exceedance.svg",
            ["Probability of exceedance", "Lowest pressure (", "MPa)", "sample-disc"],
        ),
        ("frf.svg", ["Frequency (Hz)", "Receptance (", "95 %", "median"]),
        ("sobol-indices.svg", ["Sobol index", "force", "first order", "total"]),
    ] {
        let text = read(name);
        for label in labels {
            assert!(text.contains(label), "{name} lacks `{label}`");
        }
    }
    let histograms = read("histograms.csv");
    let runs = histograms.lines().filter(|line| line.starts_with("energy.input_j,J,"));
    let runs = runs.map(|line| line.rsplit(',').next().unwrap().parse::<f64>().unwrap());
    // Of 48 runs, those at A and B.
    assert_eq!((runs.clone().count(), runs.sum::<f64>()), (42, 32.0));
    let exceedance = read("exceedance.csv");
    let first = exceedance.lines().find(|line| line.starts_with("energy.input_j,")).unwrap();
    let fields: Vec<&str> = first.split(',').collect();
    assert_eq!((fields[1], fields[3], fields[5]), ("J", "1", "1"), "all are above the least");
    let ask = ["study", "answers", "s.json", "--quiet", "--figures", "png,pdf"];
    assert!(asperity(folder, &ask).status.success());
    assert!(fs::read(folder.join("out/s/exceedance.png")).unwrap().starts_with(b"\x89PNG"));
    assert!(fs::read(folder.join("out/s/sobol-indices.pdf")).unwrap().starts_with(b"%PDF"));
    let wrong = asperity(folder, &["study", "answers", "s.json", "--exceed", "f1=2"]);
    assert!(text(&wrong.stderr).contains("accepted: static.natural_frequency_hz"));
}
