//! Messages of malformed scenarios: each names the place, the fault and the accepted values.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use asperity_scenario::{
    Document, DocumentError, InputError, MAX_DOCUMENT_BYTES, check_schema, scenario_schema,
};

const FOLDER: &str = "../../fixtures/malformed";

/// Malformed scenarios, sorted by name.
fn fixtures() -> Vec<PathBuf> {
    let entries = fs::read_dir(FOLDER).unwrap();
    let files = entries.map(|entry| entry.unwrap().path());
    let mut fixtures: Vec<PathBuf> = files.filter(|path| path.is_file()).collect();
    fixtures.sort();
    fixtures
}

/// Message without the folder.
fn message(path: &Path) -> String {
    let message = match Document::read(path) {
        Err(error) => error.to_string(),
        Ok(document) => match document.scenario() {
            Err(invalid) => invalid.to_string(),
            Ok(_) => panic!("{} is accepted", path.display()),
        },
    };
    message.replace(&format!("{FOLDER}/"), "")
}

#[test]
fn every_message_is_as_reviewed() {
    let mut shown = String::new();
    for path in fixtures() {
        writeln!(shown, "{}\n", message(&path)).unwrap();
    }
    insta::assert_snapshot!(shown);
}

#[test]
fn every_message_names_its_file_and_what_is_accepted() {
    let fixtures = fixtures();
    assert!(fixtures.len() >= 45);
    for path in fixtures {
        assert_eq!(path.extension().unwrap(), "json", "{}", path.display());
        let name = path.file_name().unwrap().to_str().unwrap();
        for line in message(&path).lines() {
            assert!(line.starts_with(&format!("{name}: ")), "{line}");
            assert!(line.contains("accepted: ") || line.contains("expected "), "{line}");
            assert!(line.len() < 700, "{line}");
        }
    }
}

#[test]
fn every_samples_file_belongs_to_a_scenario() {
    let texts: Vec<String> =
        fixtures().iter().filter_map(|path| fs::read_to_string(path).ok()).collect();
    for entry in fs::read_dir(format!("{FOLDER}/samples")).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        let used = format!("\"samples/{name}\"");
        assert!(texts.iter().any(|text| text.contains(&used)), "{name}");
    }
}

/// The span of a diagnostic covers the faulty key or value.
#[test]
fn spans_cover_the_faults() {
    let document = Document::read(format!("{FOLDER}/several-problems.json")).unwrap();
    let invalid = document.scenario().unwrap_err();
    let underlined =
        invalid.diagnostics.iter().map(|found| &document.text()[found.span.clone().unwrap()]);
    let expected = [r#""lenght_m""#, r#""modifed""#, "350000.0", "0", "1.5"];
    assert_eq!(underlined.collect::<Vec<_>>(), expected);
}

/// Faults of the schema are faults for an independent validator too; documents that violate
/// conditions between values only are valid for both.
#[test]
fn an_independent_validator_agrees() {
    let schema = scenario_schema();
    let validator = jsonschema::draft202012::new(schema).unwrap();
    let (mut refused, mut accepted) = (0, 0);
    for path in fixtures() {
        let Ok(document) = Document::read(&path) else {
            continue;
        };
        let ours = check_schema(schema, document.value());
        assert_eq!(ours.is_empty(), validator.is_valid(document.value()), "{}", path.display());
        if ours.is_empty() { accepted += 1 } else { refused += 1 }
    }
    assert!(refused >= 40 && accepted >= 25, "{refused} {accepted}");
}

#[test]
fn a_huge_file_is_rejected_before_it_is_read() {
    let file = tempfile::NamedTempFile::new().unwrap();
    let bytes = 100_000_000;
    file.as_file().set_len(bytes).unwrap();
    let max = MAX_DOCUMENT_BYTES;
    assert_input_error(file.path(), InputError::TooLarge { bytes, max });
}

#[test]
fn a_directory_and_a_missing_file_are_named() {
    let folder = tempfile::tempdir().unwrap();
    assert_input_error(folder.path(), InputError::Directory);
    assert_input_error(&folder.path().join("none.json"), InputError::NotFound);
}

#[cfg(unix)]
#[test]
fn a_file_that_may_not_be_read_is_named() {
    use std::os::unix::fs::PermissionsExt;
    let file = tempfile::NamedTempFile::new().unwrap();
    fs::write(file.path(), "{}").unwrap();
    fs::set_permissions(file.path(), fs::Permissions::from_mode(0o000)).unwrap();
    if fs::read(file.path()).is_ok() {
        return; // A privileged user may read any file.
    }
    assert_input_error(file.path(), InputError::NotPermitted);
}

#[cfg(unix)]
#[test]
fn a_device_is_not_a_scenario() {
    assert_input_error(Path::new("/dev/zero"), InputError::NotRegular);
}

fn assert_input_error(path: &Path, expected: InputError) {
    let message = match Document::read(path) {
        Err(DocumentError::Input { path: named, source }) => {
            assert_eq!((named.as_path(), source), (path, expected));
            format!("{source}")
        }
        other => panic!("{other:?}"),
    };
    assert!(!message.is_empty());
}

/// The schema and the conditions between values report one fault once.
#[test]
fn no_fault_is_reported_twice() {
    for path in fixtures() {
        if let Ok(document) = Document::read(&path) {
            let invalid = document.scenario().unwrap_err();
            let lines: Vec<String> = invalid.diagnostics.iter().map(ToString::to_string).collect();
            let distinct: BTreeSet<&String> = lines.iter().collect();
            assert_eq!(distinct.len(), lines.len(), "{lines:#?}");
        }
    }
}
