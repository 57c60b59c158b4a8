//! Rules of Rust sources: every test runs, and nothing is left for later.

use super::Finding;
use super::repository::Repository;

/// Forbidden text, in two halves so that this file may hold it, and the reason.
const FORBIDDEN: [(&str, &str, &str); 6] = [
    ("#[ig", "nore", "every test runs: mend it or remove it"),
    (", ig", "nore)]", "every test runs: mend it or remove it"),
    ("```ig", "nore", "every example compiles: mend it or make it text"),
    ("to", "do!(", "unfinished code"),
    ("unimple", "mented!(", "unfinished code"),
    ("db", "g!(", "left over from debugging"),
];

/// No skipped test or example, no placeholder, no debugging aid.
pub(super) fn unfinished(repository: &Repository) -> Vec<Finding> {
    let mut found = Vec::new();
    for (path, number, line) in repository.source_lines() {
        let comment = line.trim_start().starts_with("//");
        for (start, end, why) in FORBIDDEN {
            let example = start.starts_with("```");
            // Comments may speak of code; examples live in nothing but comments.
            if comment == example && line.contains(&format!("{start}{end}")) {
                found.push(Finding::at(path, number, format!("`{start}{end}`: {why}")));
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_forbidden_text_is_found_where_it_counts() {
        for (start, end, _) in FORBIDDEN {
            let comment = if start.starts_with("```") { "/// " } else { "" };
            let text = format!("fn f() {{}}\n{comment}{start}{end}\n");
            let repository = Repository::of(&[("a.rs", &text)]);
            let found = unfinished(&repository);
            assert_eq!(found.len(), 1, "{text}");
            assert_eq!(found[0].place, "a.rs:2");
        }
    }

    #[test]
    fn comments_and_ordinary_code_pass() {
        let text = format!("// no {}{} here\nfn autodo() {{}}\n/// ```\n", "to", "do!()");
        assert_eq!(unfinished(&Repository::of(&[("a.rs", &text)])), []);
    }
}
