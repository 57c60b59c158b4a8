//! Contact laws: references to existing laws, and increasing curves.

use super::{MAX_SERIES_DEPTH, MAX_SERIES_LAWS, Node};
use crate::diagnostic::{Diagnostic, MAX_FAULTS};
use crate::fault::{Bound, Fault};
use crate::suggest::nearest;
use crate::wording::{brief, list};

/// Most laws of a scenario.
const MAX_LAWS: usize = 1000;

/// Checks all laws of the scenario, named or in place.
pub(super) fn check(root: &Node<'_>, found: &mut Vec<Diagnostic>) {
    let laws = root.get("laws");
    let names = laws.as_ref().and_then(|laws| laws.value.as_object());
    if let (Some(laws), Some(names)) = (&laws, names)
        && names.len() > MAX_LAWS
    {
        let accepted = format!("at most {MAX_LAWS} laws");
        found.push(Diagnostic::new(&laws.at, Fault::TooManyLaws(names.len()), accepted));
    }
    let known = names.map(|laws| list(laws.keys().map(|name| brief(name)))).unwrap_or_default();
    let accepted = match known.as_str() {
        "" => "a law written in place; \"laws\" holds none".to_owned(),
        known => format!("a name in \"laws\": {known}; or a law written in place"),
    };
    let mut checker = Checker { laws, accepted, found };
    for (name, law) in root.entries("laws") {
        if checker.found.len() >= MAX_FAULTS {
            return;
        }
        checker.law(&law);
        checker.series(&law, Some(name));
    }
    for interface in root.items("interfaces") {
        if checker.found.len() >= MAX_FAULTS {
            return;
        }
        if let Some(law) = interface.get("law") {
            checker.reference(&law);
            checker.series(&law, None);
        }
    }
}

struct Checker<'a, 'f> {
    laws: Option<Node<'a>>,
    /// Accepted references to a law, in words.
    accepted: String,
    found: &'f mut Vec<Diagnostic>,
}

impl<'a> Checker<'a, '_> {
    /// Checks the name of a law, or a law in place.
    fn reference(&mut self, node: &Node<'a>) {
        let Some(name) = node.value.as_str() else {
            return self.law(node);
        };
        let readable = self.laws.as_ref().is_none_or(|laws| laws.value.is_object());
        if readable && self.named(name).is_none() {
            let laws = self.laws.as_ref().and_then(|laws| laws.value.as_object());
            let near = nearest(name, laws.into_iter().flatten().map(|(name, _)| name.as_str()));
            let fault = Fault::UnknownLaw(name.to_owned());
            let unknown = Diagnostic::new(&node.at, fault, self.accepted.clone());
            self.found.push(unknown.suggest_word(near));
        }
    }

    fn law(&mut self, law: &Node<'a>) {
        match law.text("kind") {
            Some("modified_power") => self.modified_power(law),
            Some("power") => self.power(law),
            Some("table") => {
                let points = pairs(law, "points");
                self.curve(&points, "the pressure of the points", 0);
                self.pressures_and_stiffnesses(&points);
            }
            Some("persson") => self.wavevectors(law),
            Some("in_series") => {
                for inner in inner_laws(law) {
                    self.reference(&inner);
                }
                if law.get("law").is_some() && law.get("stiffness_pa_per_m").is_none() {
                    let fault = Fault::MissingKey("stiffness_pa_per_m".to_owned());
                    let accepted = "the stiffness of the layer in series with \"law\"; or two or more \"laws\"";
                    self.found.push(Diagnostic::new(&law.at, fault, accepted));
                }
            }
            _ => {}
        }
    }

    /// Checks that the stiffness of a power law neither overflows nor vanishes at a typical
    /// pressure, 1e6 Pa.
    fn power(&mut self, law: &Node<'a>) {
        if let (Some(coefficient), Some(exponent)) =
            (law.number("coefficient"), law.number("exponent"))
        {
            let value = coefficient * 1e6_f64.powf(exponent);
            self.finite_positive(law, value, "the stiffness C p^m at 1e6 Pa");
        }
    }

    /// Checks that the wavevectors of a rough surface have a range.
    fn wavevectors(&mut self, law: &Node<'a>) {
        let (Some(previous), Some(value)) =
            (law.number("roll_off_per_m"), law.number("cut_off_per_m"))
        else {
            return;
        };
        if value <= previous {
            let quantity = "the wavevector, from roll-off to cut-off,";
            let fault = Fault::NotIncreasing { quantity, previous, value };
            let accepted = "a cut_off_per_m greater than roll_off_per_m";
            self.found.push(Diagnostic::new(&law.at.child("cut_off_per_m"), fault, accepted));
        }
    }

    fn finite_positive(&mut self, law: &Node<'a>, value: f64, quantity: &'static str) {
        if value == 0.0 || !value.is_finite() {
            let fault = Fault::Degenerate { quantity, value };
            let accepted = "a coefficient and an exponent that give a finite stiffness above zero";
            self.found.push(Diagnostic::new(&law.at, fault, accepted));
        }
    }

    fn modified_power(&mut self, law: &Node<'a>) {
        let knots = pairs(law, "knots");
        self.curve(&knots, "the pressure of the knots", 0);
        self.curve(&knots, "the stiffness of the knots", 1);
        self.pressures_and_stiffnesses(&knots);
        if let Some(first) = knots.first()
            && first.pair[0] != 0.0
        {
            let fault = Fault::FirstKnot { pressure_pa: first.pair[0] };
            self.found.push(Diagnostic::new(
                &first.node.at.child(0),
                fault,
                "0, the pressure of the first knot",
            ));
        }
        let Some(transition_pa) = law.number("transition_pa") else { return };
        for knot in knots.iter().take(MAX_FAULTS) {
            let pressure_pa = knot.pair[0];
            if pressure_pa >= transition_pa {
                let fault = Fault::KnotBeyondTransition { pressure_pa, transition_pa };
                let accepted = "a pressure below transition_pa, above which the power law holds";
                self.found.push(Diagnostic::new(&knot.node.at.child(0), fault, accepted));
            }
        }
        let (Some(coefficient), Some(exponent)) =
            (law.number("coefficient"), law.number("exponent"))
        else {
            return;
        };
        let transition_stiffness_pa_per_m = coefficient * transition_pa.powf(exponent);
        self.finite_positive(
            law,
            transition_stiffness_pa_per_m,
            "the stiffness C p^m at transition_pa",
        );
        if let Some(last) = knots.last()
            && last.pair[1] >= transition_stiffness_pa_per_m
        {
            let stiffness_pa_per_m = last.pair[1];
            let fault = Fault::KnotTooStiff { stiffness_pa_per_m, transition_stiffness_pa_per_m };
            let accepted =
                "a stiffness below coefficient transition_pa^exponent, so that the law increases";
            self.found.push(Diagnostic::new(&last.node.at.child(1), fault, accepted));
        }
    }

    /// Checks that the numbers of one column increase.
    fn curve(&mut self, points: &[Pair<'a>], quantity: &'static str, column: usize) {
        for (before, point) in points.iter().zip(points.iter().skip(1)) {
            if self.found.len() >= MAX_FAULTS {
                return;
            }
            let (previous, value) = (before.pair[column], point.pair[column]);
            if value <= previous {
                let fault = Fault::NotIncreasing { quantity, previous, value };
                let accepted = "a number greater than the one in the row before";
                self.found.push(Diagnostic::new(&point.node.at.child(column), fault, accepted));
            }
        }
    }

    fn pressures_and_stiffnesses(&mut self, points: &[Pair<'a>]) {
        let bounds = [
            (Bound::AtLeast(0.0), "a pressure of at least 0 Pa"),
            (Bound::Above(0.0), "a stiffness greater than 0 Pa/m"),
        ];
        for point in points {
            if self.found.len() >= MAX_FAULTS {
                return;
            }
            for (column, (bound, accepted)) in bounds.into_iter().enumerate() {
                let value = point.pair[column];
                if !bound.holds(value) {
                    let fault = Fault::OutOfBounds { value, bound };
                    self.found.push(Diagnostic::new(&point.node.at.child(column), fault, accepted));
                }
            }
        }
    }

    /// Follows laws in series inwards from `start`: a reference, or the law named `own` in "laws".
    fn series(&mut self, start: &Node<'a>, own: Option<&'a str>) {
        let (mut chain, mut count): (Vec<&str>, _) = (own.into_iter().collect(), 0);
        let Err((at, fault, accepted)) = self.follow(start, own, &mut chain, 0, &mut count) else {
            return;
        };
        if let Some(fault) = fault {
            let at = at.map_or_else(|| start.at.clone(), |key| start.at.child(key));
            self.found.push(Diagnostic::new(&at, fault, accepted));
        }
    }

    /// Follows one law at a `depth` of series, reached along the `chain` of names, and counts the laws
    /// that are in series.
    ///
    /// # Errors
    /// The key of the start, the fault and what is accepted; without a fault for a cycle that is
    /// reported elsewhere.
    fn follow(
        &self,
        law: &Node<'a>,
        own: Option<&'a str>,
        chain: &mut Vec<&'a str>,
        depth: usize,
        count: &mut usize,
    ) -> Result<(), (Option<&'static str>, Option<Fault>, String)> {
        let mut law = law.clone();
        let names = chain.len();
        if let Some(name) = law.value.as_str() {
            let first = chain.iter().position(|known| *known == name);
            chain.push(name);
            if let Some(first) = first {
                // One report for each cycle, at its first law in alphabetical order.
                let here = first == 0 && own == chain.iter().copied().min();
                let cycle =
                    || Fault::CyclicLaw(chain.iter().map(|&name| name.to_owned()).collect());
                let accepted = "a law that does not refer back to this one".to_owned();
                let outer = own.and_then(|own| self.named(own));
                let several = outer.is_some_and(|law| law.get("laws").is_some());
                let key = if several { "laws" } else { "law" };
                return Err((Some(key), here.then(cycle), accepted));
            }
            match self.named(name) {
                Some(named) => law = named,
                None => return Ok(()),
            }
        }
        if law.text("kind") == Some("in_series") {
            if depth == MAX_SERIES_DEPTH {
                let accepted = format!("at most {depth} nested laws in series");
                return Err((None, Some(Fault::LawTooDeep(depth)), accepted));
            }
            for inner in inner_laws(&law) {
                self.follow(&inner, own, chain, depth + 1, count)?;
            }
        } else {
            *count += 1;
            if *count > MAX_SERIES_LAWS {
                let fault = Fault::TooManyInSeries(MAX_SERIES_LAWS);
                let accepted =
                    format!("at most {MAX_SERIES_LAWS}, those of nested series included");
                return Err((None, Some(fault), accepted));
            }
        }
        chain.truncate(names);
        Ok(())
    }

    fn named(&self, name: &str) -> Option<Node<'a>> {
        self.laws.as_ref()?.get(name)
    }
}

/// The laws inside a law in series.
fn inner_laws<'a>(law: &Node<'a>) -> Vec<Node<'a>> {
    law.get("law").into_iter().chain(law.items("laws")).collect()
}

/// Row [pressure, stiffness] and its place.
struct Pair<'a> {
    node: Node<'a>,
    pair: [f64; 2],
}

/// Rows of the array at `key`; none if one of them is not a pair of numbers.
fn pairs<'a>(law: &Node<'a>, key: &str) -> Vec<Pair<'a>> {
    let pair = |node: Node<'a>| {
        let [pressure, stiffness] = node.value.as_array()?.as_slice() else { return None };
        let pair = [pressure.as_f64()?, stiffness.as_f64()?];
        Some(Pair { node, pair })
    };
    let rows: Option<Vec<Pair<'a>>> = law.items(key).into_iter().map(pair).collect();
    rows.unwrap_or_default()
}
