//! Unions: which branch was meant.

use serde_json::Value;

use super::accepted::{branches, kind_of, one_of};
use super::{Walker, has_type};
use crate::diagnostic::{Diagnostic, Found, Problem, brief, joined};
use crate::pointer::Pointer;
use crate::suggest::nearest;

impl<'s> Walker<'s> {
    /// A union of which exactly one branch must hold. The schema has three
    /// shapes of it: objects told apart by their `kind`, words, and keys of
    /// which exactly one must be given.
    pub(super) fn one_of(&mut self, node: &'s Value, value: &Value, at: &Pointer) {
        let kinds = self.kinds(node);
        if branches(node).next().is_none() {
        } else if !kinds.is_empty() {
            self.tagged(node, &kinds, value, at);
        } else if branches(node).all(|branch| branch.get("const").is_some()) {
            if branches(node).all(|branch| branch.get("const") != Some(value)) {
                self.refuse(node, value, at);
            }
        } else {
            self.exactly_one_key(node, value, at);
        }
    }

    fn tagged(&mut self, node: &'s Value, kinds: &[&'s str], value: &Value, at: &Pointer) {
        let Value::Object(object) = value else {
            let problem = Problem::NotAccepted { found: Found::of(value) };
            let near = value.as_str().and_then(|word| nearest(word, kinds.iter().copied()));
            let meant = near.map(|kind| format!("{{\"kind\": {}}}", brief(kind)));
            let accepted = self.accepted(node);
            self.found.push(Diagnostic::new(at, problem, accepted).suggest(meant));
            return;
        };
        match object.get("kind") {
            None => {
                let key = "kind".to_owned();
                let near = nearest("kind", object.keys().map(String::as_str));
                let diagnostic = match near {
                    Some(near) => {
                        Diagnostic::new(&at.child(near), Problem::UnknownKey, one_of(&["kind"]))
                            .suggest_word(Some("kind"))
                    }
                    None => Diagnostic::new(at, Problem::MissingKey { key }, one_of(kinds)),
                };
                self.found.push(diagnostic);
            }
            Some(Value::String(kind)) => {
                let meant = branches(node).find(|branch| kind_of(branch) == Some(kind));
                if let Some(branch) = meant {
                    return self.node(branch, value, at);
                }
                let problem = Problem::UnknownKind { kind: kind.clone() };
                let near = nearest(kind, kinds.iter().copied());
                let diagnostic = Diagnostic::new(&at.child("kind"), problem, one_of(kinds));
                self.found.push(diagnostic.suggest_word(near));
            }
            Some(other) => {
                let problem = Problem::NotAccepted { found: Found::of(other) };
                self.found.push(Diagnostic::new(&at.child("kind"), problem, one_of(kinds)));
            }
        }
    }

    fn exactly_one_key(&mut self, node: &Value, value: &Value, at: &Pointer) {
        let Value::Object(object) = value else {
            return;
        };
        let required = |branch: &Value| branch.pointer("/required/0")?.as_str().map(str::to_owned);
        let keys: Vec<String> = branches(node).filter_map(required).collect();
        let given: Vec<String> =
            keys.iter().filter(|key| object.contains_key(*key)).cloned().collect();
        let accepted = format!("exactly one of {}", joined(&keys, "and"));
        match given.len() {
            1 => {}
            0 if self.is_misspelt(&keys, at) => {}
            0 => self.found.push(Diagnostic::new(at, Problem::NoneGiven { keys }, accepted)),
            _ => self.found.push(Diagnostic::new(
                at,
                Problem::SeveralGiven { keys: given },
                accepted,
            )),
        }
    }

    /// Whether an unknown key of the object at `at` was already taken for one of `keys`.
    fn is_misspelt(&self, keys: &[String], at: &Pointer) -> bool {
        let (here, inside) = (at.to_string(), format!("{at}/"));
        let meant = |diagnostic: &Diagnostic| {
            keys.iter().any(|key| diagnostic.suggestion.as_deref() == Some(&brief(key)))
        };
        // The problems of this object are the last ones found.
        let own = |diagnostic: &&Diagnostic| {
            diagnostic.pointer == here || diagnostic.pointer.starts_with(&inside)
        };
        let mut recent = self.found.iter().rev().take_while(own);
        recent.any(|diagnostic| diagnostic.problem == Problem::UnknownKey && meant(diagnostic))
    }

    /// A union told apart by the JSON type of its branches: a word or an object.
    pub(super) fn any_of(&mut self, node: &'s Value, value: &Value, at: &Pointer) {
        let Some(branches) = node.get("anyOf").and_then(Value::as_array) else {
            return;
        };
        let matching = branches.iter().find(|branch| {
            let kind = self.type_of(branch);
            kind.is_some_and(|kind| has_type(value, kind))
        });
        match matching {
            Some(branch) => self.node(branch, value, at),
            None => self.refuse(node, value, at),
        }
    }

    /// The JSON type of a branch: its own, its target's or its first branch's.
    fn type_of(&self, node: &'s Value) -> Option<&'s str> {
        if let Some(kind) = node.get("type") {
            return kind.as_str();
        }
        match self.target(node) {
            Some(target) => self.type_of(target),
            None => branches(node).next().and_then(|branch| self.type_of(branch)),
        }
    }
}
