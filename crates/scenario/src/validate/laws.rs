//! Contact laws: references to existing laws, series that end, and the faults that each law finds.

use asperity_law::{LawError, LawRef, LawSpec, Laws, MAX_SERIES_DEPTH, MAX_SERIES_LAWS};
use serde::Deserialize;

use super::node::Node;
use crate::diagnostic::{Diagnostic, MAX_FAULTS};
use crate::fault::Fault;
use crate::pointer::JsonPointer;
use crate::suggest::nearest;
use crate::wording::{brief, list};

/// Most laws of a scenario.
const MAX_LAWS: usize = 1000;

/// Checks all laws of the scenario, named or in place. A law that the schema rejects as a whole is
/// skipped.
pub(super) fn check(root: &Node<'_>, found: &mut Vec<Diagnostic>) {
    let entries = root.entries("laws");
    if entries.len() > MAX_LAWS {
        let accepted = format!("at most {MAX_LAWS} laws");
        let fault = Fault::TooManyLaws(entries.len());
        found.push(Diagnostic::new(&root.at.child("laws"), fault, accepted));
        return;
    }
    let names: Vec<&str> = entries.iter().map(|(name, _)| *name).collect();
    let known = list(names.iter().map(|name| brief(name)));
    let accepted = match known.as_str() {
        "" => "a law written in place; \"laws\" holds none".to_owned(),
        known => format!("a name in \"laws\": {known}; or a law written in place"),
    };
    let readable = |node: &Node<'_>| LawSpec::deserialize(node.value).ok();
    let laws = entries.iter().filter_map(|(name, law)| Some(((*name).to_owned(), readable(law)?)));
    let laws: Laws = laws.collect();
    let are_named = root.get("laws").is_none_or(|laws| laws.value.is_object());
    let mut checker = Checker { names: are_named.then_some(names), accepted, found };
    for (name, node) in &entries {
        if let Some(law) = laws.get(name) {
            checker.law(law, &node.at);
            checker.series(&laws, &LawRef::Named((*name).to_owned()), &node.at, true);
        }
    }
    for interface in root.items("interfaces") {
        let Some(node) = interface.get("law") else { continue };
        if let Ok(law) = LawRef::deserialize(node.value) {
            checker.reference(&law, &node.at);
            checker.series(&laws, &law, &node.at, false);
        }
    }
}

struct Checker<'a, 'f> {
    /// Names of the laws; `None` where they cannot be read.
    names: Option<Vec<&'a str>>,
    /// Accepted references to a law, in words.
    accepted: String,
    found: &'f mut Vec<Diagnostic>,
}

impl Checker<'_, '_> {
    /// Checks the name of a law, or a law in place.
    fn reference(&mut self, law: &LawRef, at: &JsonPointer) {
        let name = match law {
            _ if self.found.len() >= MAX_FAULTS => return,
            LawRef::Named(name) => name,
            LawRef::InPlace(law) => return self.law(law, at),
        };
        if let Some(names) = self.names.as_ref().filter(|names| !names.contains(&name.as_str())) {
            let near = nearest(name, names.iter().copied());
            let fault = Fault::UnknownLaw(name.to_owned());
            let unknown = Diagnostic::new(at, fault, self.accepted.clone());
            self.report(unknown.suggest_word(near));
        }
    }

    /// Checks a law and those inside it.
    fn law(&mut self, law: &LawSpec, at: &JsonPointer) {
        if let LawSpec::InSeries(series) = law {
            if let Some(inner) = &series.law {
                self.reference(inner, &at.child("law"));
            }
            for (index, inner) in series.laws.iter().enumerate() {
                self.reference(inner, &at.child("laws").child(index));
            }
        }
        for fault in law.faults().take(MAX_FAULTS) {
            let pointer = format!("{at}{}", fault.pointer);
            let found = Diagnostic::new(at, Fault::Law(fault.error), fault.accepted);
            self.report(Diagnostic { pointer, ..found });
        }
    }

    /// Follows laws in series inwards, from a law in "laws" or in an interface. A cycle is reported once,
    /// in "laws" at its first law in alphabetical order.
    fn series(&mut self, laws: &Laws, law: &LawRef, at: &JsonPointer, in_laws: bool) {
        let Err(error) = laws.check_series(law) else { return };
        let (at, accepted) = match &error {
            LawError::CyclicLaw(chain) => {
                let first = chain.iter().min();
                let here = first == chain.last() && first.is_some_and(|name| name == law.name());
                if !(in_laws && here) {
                    return;
                }
                let several = match laws.resolve(law) {
                    Some(LawSpec::InSeries(series)) => !series.laws.is_empty(),
                    _ => false,
                };
                let accepted = "a law that does not refer back to this one".to_owned();
                (at.child(if several { "laws" } else { "law" }), accepted)
            }
            LawError::SeriesTooDeep { .. } => {
                (at.clone(), format!("at most {MAX_SERIES_DEPTH} nested laws in series"))
            }
            LawError::TooManyInSeries { .. } => {
                let nested = "those of nested series included";
                (at.clone(), format!("at most {MAX_SERIES_LAWS}, {nested}"))
            }
            // The schema asks for two laws.
            _ => return,
        };
        self.report(Diagnostic::new(&at, Fault::Law(error), accepted));
    }

    fn report(&mut self, diagnostic: Diagnostic) {
        if self.found.len() < MAX_FAULTS {
            self.found.push(diagnostic);
        }
    }
}
