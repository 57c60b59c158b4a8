//! A state as command lines.

use std::fmt::Write as _;

use asperity_scenario::Document;
use serde_json::{Value, json};

use crate::computation::level_variation;
use crate::message::Part;
use crate::settings::Settings;
use crate::state::Change;

/// The command that computes each part; `given` are the changes with which the page was opened.
pub(crate) fn commands(
    document: &Document,
    given: &[String],
    changes: &[Change],
    settings: &Settings,
) -> Value {
    let set = changes.iter().map(|Change(pointer, value)| format!("{pointer}={value}"));
    let set: Vec<String> = given.iter().cloned().chain(set).collect();
    let command = |name: &str| {
        let mut text =
            format!("asperity {name} {}", quoted(&document.path().display().to_string()));
        for one in &set {
            // Writing to a String cannot fail.
            let _ = write!(text, " --set {}", quoted(one));
        }
        text
    };
    let mut found = vec![json!({ "part": Part::Hit, "text": command("simulate") })];
    if let Ok(variation) = level_variation(document, settings) {
        let text = format!("{} --vary {}", command("sweep"), quoted(&variation));
        found.push(json!({ "part": Part::Levels, "text": text }));
    }
    if let (Some(amplitudes), Some(from), Some(to)) =
        (&settings.amplitudes, settings.from_hz, settings.to_hz)
    {
        let list: Vec<String> = amplitudes.iter().map(f64::to_string).collect();
        let backbone = if settings.backbone { " --backbone" } else { "" };
        let text = format!(
            "{} --amplitude {} --from {from} --to {to}{backbone}",
            command("steady"),
            list.join(",")
        );
        found.push(json!({ "part": Part::Steady, "text": text }));
    }
    Value::Array(found)
}

/// A word of a command line of a POSIX shell.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| {
        c.is_ascii_alphanumeric() || matches!(c, '/' | '.' | '_' | '-' | '=' | ':' | ',' | '+')
    };
    if !word.is_empty() && word.chars().all(is_plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_quoted_where_a_shell_needs_it() {
        assert_eq!(quoted("/excitation/peak_n=1.5e-3"), "/excitation/peak_n=1.5e-3");
        assert_eq!(quoted("/title=it's"), r"'/title=it'\''s'");
        assert_eq!(quoted(r#"/laws/a={"kind":"power"}"#), r#"'/laws/a={"kind":"power"}'"#);
    }
}
