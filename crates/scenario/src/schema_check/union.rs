//! Unions: selection of the branch.

use serde_json::Value;

use super::accepted::{branches, kind_of, one_of};
use super::walker::{Place, Walker, has_type};
use crate::diagnostic::Diagnostic;
use crate::fault::Fault;
use crate::suggest::nearest;
use crate::wording::{brief, found, joined};

impl<'s> Walker<'s> {
    /// Checks a `oneOf`, which has three forms: objects with a `kind`, words, and keys of which
    /// exactly one must be given.
    pub(super) fn one_of(&mut self, node: &'s Value, value: &Value, at: &Place<'_>) {
        if branches(node).next().is_none() {
            return;
        }
        let kinds = self.kinds(node);
        if !kinds.is_empty() {
            self.tagged(node, &kinds, value, at);
        } else if branches(node).all(|branch| branch.get("const").is_some()) {
            if branches(node).all(|branch| branch.get("const") != Some(value)) {
                self.reject(node, value, at);
            }
        } else {
            self.exactly_one_key(node, value, at);
        }
    }

    fn tagged(&mut self, node: &'s Value, kinds: &[&'s str], value: &Value, at: &Place<'_>) {
        let Value::Object(object) = value else {
            let fault = Fault::NotAccepted(found(value));
            let near = value.as_str().and_then(|word| nearest(word, kinds.iter().copied()));
            let meant = near.map(|kind| format!("{{\"kind\": {}}}", brief(kind)));
            let accepted = self.accepted(node);
            self.found.push(at.diagnostic(fault, accepted).suggest(meant));
            return;
        };
        match object.get("kind") {
            None => {
                let key = "kind".to_owned();
                let near = nearest("kind", object.keys().map(String::as_str));
                let diagnostic = match near {
                    Some(near) => at
                        .key(near)
                        .diagnostic(Fault::UnknownKey, one_of(&["kind"]))
                        .suggest_word(Some("kind")),
                    None => at.diagnostic(Fault::MissingKey(key), one_of(kinds)),
                };
                self.found.push(diagnostic);
            }
            Some(Value::String(kind)) => {
                let meant = branches(node).find(|branch| kind_of(branch) == Some(kind));
                if let Some(branch) = meant {
                    return self.node(branch, value, at);
                }
                let fault = Fault::UnknownKind(kind.clone());
                let near = nearest(kind, kinds.iter().copied());
                let diagnostic = at.key("kind").diagnostic(fault, one_of(kinds));
                self.found.push(diagnostic.suggest_word(near));
            }
            Some(other) => {
                let fault = Fault::NotAccepted(found(other));
                self.found.push(at.key("kind").diagnostic(fault, one_of(kinds)));
            }
        }
    }

    fn exactly_one_key(&mut self, node: &Value, value: &Value, at: &Place<'_>) {
        let Value::Object(object) = value else { return };
        let required = |branch: &Value| branch.pointer("/required/0")?.as_str().map(str::to_owned);
        let keys: Vec<String> = branches(node).filter_map(required).collect();
        let given: Vec<String> =
            keys.iter().filter(|key| object.contains_key(*key)).cloned().collect();
        let accepted = format!("exactly one of {}", joined(&keys, "and"));
        let fault = match given.len() {
            1 => return,
            0 if self.is_misspelt(&keys, at) => return,
            0 => Fault::NoneGiven(keys),
            _ => Fault::SeveralGiven(given),
        };
        self.found.push(at.diagnostic(fault, accepted));
    }

    /// True where an unknown key of the object at `at` was reported as a misspelling of one of `keys`.
    fn is_misspelt(&self, keys: &[String], at: &Place<'_>) -> bool {
        let here = at.pointer().to_string();
        let inside = format!("{here}/");
        let meant = |diagnostic: &Diagnostic| {
            keys.iter().any(|key| diagnostic.suggestion.as_deref() == Some(&brief(key)))
        };
        // The faults of this object are the last ones found.
        let own = |diagnostic: &&Diagnostic| {
            diagnostic.pointer == here || diagnostic.pointer.starts_with(&inside)
        };
        let mut recent = self.found.iter().rev().take_while(own);
        recent.any(|diagnostic| diagnostic.fault == Fault::UnknownKey && meant(diagnostic))
    }

    /// Checks an `anyOf`, whose branches differ by their JSON type: a word or an object.
    pub(super) fn any_of(&mut self, node: &'s Value, value: &Value, at: &Place<'_>) {
        let Some(branches) = node.get("anyOf").and_then(Value::as_array) else { return };
        let fits = |kind: &str| has_type(value, kind);
        match branches.iter().find(|branch| self.type_of(branch).is_some_and(fits)) {
            Some(branch) => self.node(branch, value, at),
            None => self.reject(node, value, at),
        }
    }

    /// JSON type of a branch: its own, that of its target, or that of its first branch.
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
