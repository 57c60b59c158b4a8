//! Faults shown at their place in texts of any form.

use std::fmt::Write as _;
use std::path::Path;

use crate::{asperity, fixture, text};

/// A text as `asperity check` judges it: its exit status and message.
fn check(folder: &Path, scenario: &str) -> (Option<i32>, String) {
    std::fs::write(folder.join("scenario.json"), scenario).unwrap();
    let output = asperity(folder, &["check", "scenario.json"]);
    (output.status.code(), text(&output.stderr))
}

/// A valid scenario on one line, with its title and its duration as JSON.
fn on_one_line(title: &str, duration_s: &str) -> String {
    let rig = std::fs::read_to_string(fixture("scenarios/nouira2020-constant.json")).unwrap();
    let mut rig: serde_json::Value = serde_json::from_str(&rig).unwrap();
    rig["title"] = title.into();
    rig["duration_s"] = "DURATION".into();
    rig.to_string().replace("\"DURATION\"", duration_s)
}

/// A fault beyond column 65,535 is shown with its line and column, and some characters around it.
#[test]
fn a_fault_far_along_a_line_is_shown_with_its_column() {
    let folder = tempfile::tempdir().unwrap();
    for length in [100, 70_000, 15_000_000] {
        let scenario = on_one_line(&"x".repeat(length), "-1");
        let (status, message) = check(folder.path(), &scenario);
        assert_eq!(status, Some(2), "{message:.2000}");
        let column = scenario.find("\"duration_s\":-1").unwrap() + "\"duration_s\":".len() + 1;
        assert!(message.contains(&format!("scenario.json:1:{column}")), "{message:.2000}");
        assert!(message.contains("/duration_s: -1 is out of range"), "{message:.2000}");
        assert!(message.contains("\"duration_s\":-1"), "the text around it: {message:.2000}");
        assert!(message.len() < 3000, "{} bytes", message.len());
    }
}

#[test]
fn a_syntax_error_far_along_a_line_is_shown_with_its_column() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = on_one_line(&"x".repeat(1_000_000), "1,}");
    let (status, message) = check(folder.path(), &scenario);
    assert_eq!(status, Some(2), "{message:.2000}");
    let column = scenario.find(",}").unwrap() + 1;
    assert!(message.contains(&format!("line 1, column {column}")), "{message:.2000}");
    assert!(message.contains(&format!("scenario.json:1:{column}")), "{message:.2000}");
    assert!(message.len() < 3000, "{} bytes", message.len());
}

/// Hundreds of thousands of faults of all kinds, on one line and on as many.
#[test]
fn many_faults_of_a_large_text_are_counted_and_some_are_shown() {
    let folder = tempfile::tempdir().unwrap();
    for end in ["", "\n"] {
        let mut scenario = String::from("{\"schema\": \"asperity/scenario/1\", \"interfaces\": [");
        for number in 0..100_000 {
            let law = format!("a law of this name is missing {number}");
            let _ =
                write!(scenario, "{{\"name\": \"same\", \"aera\": 0, \"law\": \"{law}\"}},{end}");
        }
        scenario.push_str("0], \"laws\": {");
        for number in 0..1000 {
            let _ =
                write!(scenario, "\"a law of this name is given {number}\": {{\"kind\": 1}},{end}");
        }
        scenario.push_str("\"last\": null}}");
        let (status, message) = check(folder.path(), &scenario);
        assert_eq!(status, Some(2), "{message:.2000}");
        assert!(message.contains(" more"), "{message:.2000}");
        assert!(message.len() < 30_000, "{} bytes", message.len());
    }
}
