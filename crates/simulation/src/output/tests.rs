use std::fs;
use std::path::Path;

use super::*;

fn request<'a>(folder: &'a Path, command: &'a str) -> OutputRequest<'a> {
    OutputRequest {
        folder,
        command,
        document: "rig.json".as_ref(),
        replace_other_document: false,
        overwrite: false,
    }
}

/// Writes a result of two files with this content.
fn write_result(request: &OutputRequest<'_>, files: [&str; 2], content: &str) {
    let output = OutputFolder::claim(request).unwrap();
    output.write(files[0], content).unwrap();
    output.finish(files[1], content).unwrap();
}

/// Files and their contents, without the marker.
fn contents(folder: &Path) -> Vec<(String, String)> {
    let mut found: Vec<_> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.file_name().unwrap() != marker::MARKER)
        .map(|path| {
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            (name, fs::read_to_string(path).unwrap())
        })
        .collect();
    found.sort();
    found
}

fn named(files: &[(&str, &str)]) -> Vec<(String, String)> {
    files.iter().map(|(name, text)| ((*name).to_owned(), (*text).to_owned())).collect()
}

const SIMULATE: [&str; 2] = ["history.csv", "summary.json"];
const LAW: [&str; 2] = ["law-pl.csv", "law.json"];

#[test]
fn a_claim_changes_nothing_and_leaves_nothing() {
    let parent = tempfile::tempdir().unwrap();
    let folder = parent.path().join("deep/out");
    let output = OutputFolder::claim(&request(&folder, "simulate")).unwrap();
    output.write("history.csv", "1").unwrap();
    assert!(!folder.exists());
    drop(output);
    assert_eq!(fs::read_dir(parent.path()).unwrap().count(), 0);
}

#[test]
fn a_result_replaces_the_earlier_one_of_its_command_and_no_other() {
    let parent = tempfile::tempdir().unwrap();
    let folder = parent.path().join("out");
    let [simulate, law] = ["simulate", "law"].map(|command| request(&folder, command));
    write_result(&simulate, SIMULATE, "1");
    write_result(&law, LAW, "2");
    write_result(&simulate, ["frf.csv", "summary.json"], "3");
    let kept = [("frf.csv", "3"), ("law-pl.csv", "2"), ("law.json", "2"), ("summary.json", "3")];
    assert_eq!(contents(&folder), named(&kept));
    write_result(&law, ["law-modified.csv", "law.json"], "4");
    let kept =
        [("frf.csv", "3"), ("law-modified.csv", "4"), ("law.json", "4"), ("summary.json", "3")];
    assert_eq!(contents(&folder), named(&kept));
    assert_eq!(fs::read_dir(parent.path()).unwrap().count(), 1, "the work folder is removed");
}

/// Of two results that share a file name, one would be incomplete.
#[test]
fn a_result_with_a_file_of_the_same_name_is_replaced_as_a_whole_on_request() {
    let parent = tempfile::tempdir().unwrap();
    let folder = parent.path().join("out");
    write_result(&request(&folder, "simulate"), SIMULATE, "1");
    let steady = request(&folder, "steady");
    let refused = OutputFolder::claim(&steady).unwrap_err();
    assert!(matches!(&refused, OutputError::OtherKind { command, .. } if command == "simulate"));
    let steady = OutputRequest { overwrite: true, ..steady };
    write_result(&steady, ["steady.csv", "summary.json"], "2");
    assert_eq!(contents(&folder), named(&[("steady.csv", "2"), ("summary.json", "2")]));
}

#[test]
fn other_files_are_named_and_kept() {
    let parent = tempfile::tempdir().unwrap();
    let folder = parent.path().join("out");
    write_result(&request(&folder, "simulate"), SIMULATE, "1");
    fs::write(folder.join("thesis.tex"), "x").unwrap();
    fs::write(folder.join(".DS_Store"), "of the system").unwrap();
    let refused = OutputFolder::claim(&request(&folder, "simulate")).unwrap_err();
    assert!(matches!(&refused, OutputError::Occupied { files, count: 1, .. }
        if files == &["thesis.tex"]));
    let allowed = OutputRequest { overwrite: true, ..request(&folder, "simulate") };
    write_result(&allowed, ["frf.csv", "summary.json"], "2");
    fs::remove_file(folder.join(".DS_Store")).unwrap();
    let kept = [("frf.csv", "2"), ("summary.json", "2"), ("thesis.tex", "x")];
    assert_eq!(contents(&folder), named(&kept));
}

/// `--out out` and `--out out/law`, in any order.
#[test]
fn output_folders_inside_an_output_folder_stay() {
    let parent = tempfile::tempdir().unwrap();
    let [outer, inner] = ["out", "out/law"].map(|name| parent.path().join(name));
    write_result(&request(&outer, "simulate"), SIMULATE, "1");
    write_result(&request(&inner, "law"), LAW, "2");
    let running = OutputFolder::claim(&request(&inner, "law")).unwrap();
    write_result(&request(&outer, "simulate"), SIMULATE, "3");
    running.finish("law.json", "4").unwrap();
    assert_eq!(contents(&inner), named(&[("law.json", "4")]));
    assert_eq!(fs::read_to_string(outer.join("history.csv")).unwrap(), "3");
}

/// A file that appears while the run computes does not stop it, and is not lost.
#[test]
fn a_file_that_appears_during_a_run_is_kept() {
    let parent = tempfile::tempdir().unwrap();
    let folder = parent.path().join("out");
    write_result(&request(&folder, "simulate"), SIMULATE, "1");
    let output = OutputFolder::claim(&request(&folder, "simulate")).unwrap();
    fs::write(folder.join("notes.txt"), "x").unwrap();
    output.finish("summary.json", "2").unwrap();
    assert_eq!(contents(&folder), named(&[("notes.txt", "x"), ("summary.json", "2")]));
}

#[test]
fn results_of_another_document_are_replaced_on_request() {
    let parent = tempfile::tempdir().unwrap();
    let folder = parent.path().join("out");
    for document in ["a.json", "b.json"] {
        fs::write(parent.path().join(document), "{}").unwrap();
    }
    let [a, b] = ["a.json", "b.json"].map(|document| parent.path().join(document));
    let of_a = OutputRequest { document: &a, ..request(&folder, "simulate") };
    write_result(&of_a, SIMULATE, "1");
    let of_b = OutputRequest { document: &b, ..request(&folder, "law") };
    let refused = OutputFolder::claim(&of_b).unwrap_err();
    assert!(matches!(&refused, OutputError::OtherDocument { document, .. }
        if *document == a.canonicalize().unwrap()));
    write_result(&OutputRequest { replace_other_document: true, ..of_b }, LAW, "2");
    assert_eq!(contents(&folder), named(&[("law-pl.csv", "2"), ("law.json", "2")]));
}

/// Documents and results that are moved together still belong together.
#[test]
fn a_moved_folder_is_still_that_of_its_document() {
    let parent = tempfile::tempdir().unwrap();
    let [first, second] = ["first", "second"].map(|name| parent.path().join(name));
    fs::create_dir(&first).unwrap();
    fs::write(first.join("rig.json"), "{}").unwrap();
    for project in [&first, &second] {
        let document = project.join("rig.json");
        let folder = project.join("out/rig");
        let request = OutputRequest { document: &document, ..request(&folder, "simulate") };
        write_result(&request, SIMULATE, "1");
        if project == &first {
            fs::rename(&first, &second).unwrap();
        }
    }
}

#[test]
fn one_run_at_a_time_writes_to_a_folder() {
    let parent = tempfile::tempdir().unwrap();
    let [one, two] = ["one", "two"].map(|name| parent.path().join(name));
    let first = OutputFolder::claim(&request(&one, "simulate")).unwrap();
    let refused = OutputFolder::claim(&request(&one, "law")).unwrap_err();
    assert!(matches!(refused, OutputError::Busy { .. }));
    assert!(OutputFolder::claim(&request(&two, "law")).is_ok());
    first.finish("summary.json", "1").unwrap();
    assert!(OutputFolder::claim(&request(&one, "law")).is_ok());
}

/// States that a run killed at any step of the replacement leaves.
#[test]
fn what_killed_runs_leave_is_completed_or_removed() {
    let parent = tempfile::tempdir().unwrap();
    let (folder, work) = (parent.path().join("out"), parent.path().join(".out.asperity"));
    let result = |folder: &Path, content| {
        write_result(&request(folder, "simulate"), SIMULATE, content);
    };
    let leave = |name: &str, content| {
        let other = parent.path().join("other");
        result(&other, content);
        fs::create_dir_all(&work).unwrap();
        fs::rename(&other, work.join(name)).unwrap();
        fs::write(work.join("lock"), "").unwrap();
    };
    let expected = |content| named(&[("history.csv", content), ("summary.json", content)]);
    let recovered = |content| {
        drop(OutputFolder::claim(&request(&folder, "simulate")).unwrap());
        assert_eq!(contents(&folder), expected(content));
        assert_eq!(fs::read_dir(parent.path()).unwrap().count(), 1, "{work:?} remains");
    };
    result(&folder, "1");
    // While files are written: half a file, no marker.
    fs::create_dir_all(work.join("new")).unwrap();
    fs::write(work.join("new/history.csv"), "ha").unwrap();
    recovered("1");
    // Complete, before the exchange; after it, the earlier result in its place.
    leave("exchanged", "2");
    recovered("1");
    // After the earlier result has been moved away.
    leave("exchanged", "2");
    fs::rename(&folder, work.join("old")).unwrap();
    recovered("1");
    // Before the earlier result has been removed.
    leave("old", "0");
    recovered("1");
    // The same, with a file that is no result: it returns.
    leave("exchanged", "0");
    fs::write(work.join("exchanged/thesis.tex"), "x").unwrap();
    let refused = OutputFolder::claim(&request(&folder, "simulate")).unwrap_err();
    assert!(matches!(refused, OutputError::Occupied { .. }), "{refused}");
    assert_eq!(fs::read_to_string(folder.join("thesis.tex")).unwrap(), "x");
    // Replacement file by file.
    fs::remove_file(folder.join("thesis.tex")).unwrap();
    fs::create_dir_all(folder.join(".asperity/complete")).unwrap();
    fs::write(folder.join(".asperity/complete/history.csv"), "2").unwrap();
    recovered("1");
}

/// A folder beside the work folder that is no result, found under its name, is not deleted.
#[test]
fn a_work_folder_does_not_take_files_of_others_with_it() {
    let parent = tempfile::tempdir().unwrap();
    let folder = parent.path().join("out");
    let exchanged = parent.path().join(".out.asperity/exchanged");
    fs::create_dir_all(&exchanged).unwrap();
    fs::write(exchanged.join("thesis.tex"), "x").unwrap();
    assert!(OutputFolder::claim(&request(&folder, "simulate")).is_err());
    assert_eq!(fs::read_to_string(folder.join("thesis.tex")).unwrap(), "x");
}

#[test]
fn files_and_links_to_nothing_are_no_folders() {
    let parent = tempfile::tempdir().unwrap();
    let file = parent.path().join("thesis.tex");
    fs::write(&file, "x").unwrap();
    let refused = OutputFolder::claim(&request(&file, "simulate")).unwrap_err();
    assert!(matches!(refused, OutputError::NotAFolder(_)));
    assert_eq!(fs::read_to_string(file).unwrap(), "x");
}

/// The folder behind a link is replaced, not the link; its permissions stay.
#[cfg(unix)]
#[test]
fn links_and_permissions_stay() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let parent = tempfile::tempdir().unwrap();
    let (folder, link) = (parent.path().join("disk"), parent.path().join("out"));
    write_result(&request(&folder, "simulate"), SIMULATE, "1");
    fs::set_permissions(&folder, fs::Permissions::from_mode(0o770)).unwrap();
    symlink(&folder, &link).unwrap();
    write_result(&request(&link, "simulate"), SIMULATE, "2");
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(contents(&folder)[0].1, "2");
    assert_eq!(fs::metadata(&folder).unwrap().permissions().mode() & 0o777, 0o770);
    symlink(parent.path().join("nothing"), parent.path().join("broken")).unwrap();
    let broken = parent.path().join("broken");
    let refused = OutputFolder::claim(&request(&broken, "simulate")).unwrap_err();
    assert!(matches!(refused, OutputError::NotAFolder(_)));
}
