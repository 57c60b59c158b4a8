//! Names: unique, and usable in column headers and file names.

use std::collections::HashMap;

use super::node::Node;
use crate::diagnostic::{Diagnostic, MAX_FAULTS};
use crate::fault::Fault;

/// Longest name in bytes.
const MAX_BYTES: usize = 100;

/// Characters that a column header cannot contain without quotes.
const NOT_IN_HEADERS: &str = ",:\"";

/// Characters that are not accepted in file names by all systems.
const NOT_IN_FILES: &str = "/\\:*?\"<>|";

/// Checks the names of bodies, interfaces and laws.
pub(super) fn check(root: &Node<'_>, found: &mut Vec<Diagnostic>) {
    family(root, "bodies", "", found);
    family(root, "interfaces", NOT_IN_HEADERS, found);
    family(root, "sensors", NOT_IN_HEADERS, found);
    let mut first = HashMap::new();
    for (name, law) in root.entries("laws") {
        if found.len() >= MAX_FAULTS {
            return;
        }
        usable(name, NOT_IN_FILES, &law, found);
        // Some file systems ignore case.
        let accepted = "a unique name; upper and lower case count as equal";
        unique(name, &name.to_lowercase(), accepted, &law, &mut first, found);
    }
}

fn family(root: &Node<'_>, key: &str, excluded: &str, found: &mut Vec<Diagnostic>) {
    let mut first = HashMap::new();
    for item in root.items(key) {
        if found.len() >= MAX_FAULTS {
            return;
        }
        if let (Some(name), Some(node)) = (item.text("name"), item.get("name")) {
            usable(name, excluded, &node, found);
            unique(name, name, "a unique name", &node, &mut first, found);
        }
    }
}

fn unique(
    name: &str,
    identity: &str,
    accepted: &str,
    node: &Node<'_>,
    first: &mut HashMap<String, String>,
    found: &mut Vec<Diagnostic>,
) {
    if let Some(first) = first.get(identity) {
        let (name, first) = (name.to_owned(), first.clone());
        let fault = Fault::RepeatedName { name, first };
        found.push(Diagnostic::new(&node.at, fault, accepted));
    } else {
        first.insert(identity.to_owned(), node.at.to_string());
    }
}

fn usable(name: &str, excluded: &str, node: &Node<'_>, found: &mut Vec<Diagnostic>) {
    let bad = |character: &char| character.is_control() || excluded.contains(*character);
    let fault = match name.chars().find(bad) {
        Some(character) => Some(format!("contains the character {character:?}")),
        None if name.len() > MAX_BYTES => Some(format!("is longer than {MAX_BYTES} bytes")),
        None if name.trim_matches([' ', '.']) != name => {
            Some("starts or ends with a space or a dot".to_owned())
        }
        None => None,
    };
    if let Some(fault) = fault {
        let fault = Fault::UnusableName { name: name.to_owned(), fault };
        let but: String = excluded.chars().flat_map(|character| [' ', character]).collect();
        let mut accepted = "a name of letters, digits, spaces, hyphens and the like".to_owned();
        if !but.is_empty() {
            accepted.push_str(", without any of");
            accepted.push_str(&but);
        }
        let plain: String =
            name.trim_matches([' ', '.']).chars().map(|c| if bad(&c) { '-' } else { c }).collect();
        let plain = plain.trim_matches([' ', '.', '-']).to_owned();
        let plain = Some(plain).filter(|plain| !plain.is_empty() && plain.len() <= MAX_BYTES);
        found.push(Diagnostic::new(&node.at, fault, accepted).suggest_word(plain.as_deref()));
    } else if name.is_empty() {
        found.push(Diagnostic::new(&node.at, Fault::EmptyText, "a name of at least one character"));
    }
}
