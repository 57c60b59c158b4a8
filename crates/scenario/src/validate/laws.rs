//! Contact laws: references that lead somewhere, and curves that increase.

use super::{MOST_SERIES_DEPTH, Node};
use crate::diagnostic::{Bound, Diagnostic, Problem, brief, list};
use crate::suggest::nearest;

/// Checks every law of the scenario, named or in place.
pub(super) fn check(root: &Node<'_>, found: &mut Vec<Diagnostic>) {
    let laws = root.get("laws");
    let names = laws.as_ref().and_then(|laws| laws.value.as_object());
    let known = names.map(|laws| list(laws.keys().map(|name| brief(name)))).unwrap_or_default();
    let accepted = match known.as_str() {
        "" => "a law written in place; \"laws\" holds none".to_owned(),
        known => format!("a name in \"laws\": {known}; or a law written in place"),
    };
    let mut checker = Checker { laws, accepted, found };
    for (name, law) in root.entries("laws") {
        checker.law(&law);
        checker.series(&law, Some(name));
    }
    for interface in root.items("interfaces") {
        if let Some(law) = interface.get("law") {
            checker.reference(&law);
            checker.series(&law, None);
        }
    }
}

struct Checker<'a, 'f> {
    laws: Option<Node<'a>>,
    /// What a reference to a law accepts, in words.
    accepted: String,
    found: &'f mut Vec<Diagnostic>,
}

impl<'a> Checker<'a, '_> {
    /// A name that must exist, or a law in place.
    fn reference(&mut self, node: &Node<'a>) {
        let Some(name) = node.value.as_str() else {
            return self.law(node);
        };
        let readable = self.laws.as_ref().is_none_or(|laws| laws.value.is_object());
        if readable && self.named(name).is_none() {
            let laws = self.laws.as_ref().and_then(|laws| laws.value.as_object());
            let near = nearest(name, laws.into_iter().flatten().map(|(name, _)| name.as_str()));
            let problem = Problem::UnknownLaw { name: name.to_owned() };
            let unknown = Diagnostic::new(&node.at, problem, self.accepted.clone());
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
            Some("in_series") => {
                if let Some(inner) = law.get("law") {
                    self.reference(&inner);
                }
            }
            _ => {}
        }
    }

    /// The stiffness of a power law must not overflow or vanish at a usual
    /// pressure, 1e6 Pa.
    fn power(&mut self, law: &Node<'a>) {
        if let (Some(coefficient), Some(exponent)) =
            (law.number("coefficient"), law.number("exponent"))
        {
            let value = coefficient * 1e6_f64.powf(exponent);
            self.storable(law, value, "the stiffness C p^m at 1e6 Pa");
        }
    }

    fn storable(&mut self, law: &Node<'a>, value: f64, quantity: &'static str) {
        if value == 0.0 || !value.is_finite() {
            let problem = Problem::Degenerate { quantity, value };
            let accepted = "a coefficient and an exponent that give a finite stiffness above zero";
            self.found.push(Diagnostic::new(&law.at, problem, accepted));
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
            let problem = Problem::FirstKnot { pressure_pa: first.pair[0] };
            self.found.push(Diagnostic::new(
                &first.node.at.child(0),
                problem,
                "0, the stiffness without pressure",
            ));
        }
        let Some(transition_pa) = law.number("transition_pa") else {
            return;
        };
        for knot in &knots {
            let pressure_pa = knot.pair[0];
            if pressure_pa >= transition_pa {
                let problem = Problem::KnotBeyondTransition { pressure_pa, transition_pa };
                let accepted = "a pressure below transition_pa, above which the power law holds";
                self.found.push(Diagnostic::new(&knot.node.at.child(0), problem, accepted));
            }
        }
        let (Some(coefficient), Some(exponent)) =
            (law.number("coefficient"), law.number("exponent"))
        else {
            return;
        };
        let transition_stiffness_pa_per_m = coefficient * transition_pa.powf(exponent);
        self.storable(law, transition_stiffness_pa_per_m, "the stiffness C p^m at transition_pa");
        if let Some(last) = knots.last()
            && last.pair[1] >= transition_stiffness_pa_per_m
        {
            let stiffness_pa_per_m = last.pair[1];
            let problem =
                Problem::KnotTooStiff { stiffness_pa_per_m, transition_stiffness_pa_per_m };
            let accepted =
                "a stiffness below coefficient transition_pa^exponent, so that the law increases";
            self.found.push(Diagnostic::new(&last.node.at.child(1), problem, accepted));
        }
    }

    /// The numbers of one column must increase.
    fn curve(&mut self, points: &[Pair<'a>], quantity: &'static str, column: usize) {
        for (before, point) in points.iter().zip(points.iter().skip(1)) {
            let (previous, value) = (before.pair[column], point.pair[column]);
            if value <= previous {
                let problem = Problem::NotIncreasing { quantity, previous, value };
                let accepted = "a number greater than the one in the row before";
                self.found.push(Diagnostic::new(&point.node.at.child(column), problem, accepted));
            }
        }
    }

    fn pressures_and_stiffnesses(&mut self, points: &[Pair<'a>]) {
        let bounds = [
            (Bound::AtLeast(0.0), "a pressure of at least 0 Pa"),
            (Bound::Above(0.0), "a stiffness greater than 0 Pa/m"),
        ];
        for point in points {
            for (column, (bound, accepted)) in bounds.into_iter().enumerate() {
                let value = point.pair[column];
                if !bound.holds(value) {
                    let problem = Problem::OutOfBounds { value, bound };
                    self.found.push(Diagnostic::new(
                        &point.node.at.child(column),
                        problem,
                        accepted,
                    ));
                }
            }
        }
    }

    /// Follows laws in series inwards from `start`: a reference, or the law
    /// named `own` in "laws".
    fn series(&mut self, start: &Node<'a>, own: Option<&'a str>) {
        let mut chain: Vec<&str> = own.into_iter().collect();
        let mut law = start.clone();
        for _ in 0..=MOST_SERIES_DEPTH {
            if let Some(name) = law.value.as_str() {
                let first = chain.iter().position(|known| *known == name);
                chain.push(name);
                if let Some(first) = first {
                    // One report a cycle: at its law that is first in the alphabet.
                    if first == 0 && own == chain.iter().copied().min() {
                        let chain = chain.into_iter().map(str::to_owned).collect();
                        let problem = Problem::CyclicLaw { chain };
                        let accepted = "a law that does not lead back to this one";
                        let at = start.at.child("law");
                        self.found.push(Diagnostic::new(&at, problem, accepted));
                    }
                    return;
                }
                match self.named(name) {
                    Some(named) => law = named,
                    None => return,
                }
            }
            match (law.text("kind"), law.get("law")) {
                (Some("in_series"), Some(inner)) => law = inner,
                _ => return,
            }
        }
        let most = MOST_SERIES_DEPTH;
        let accepted = format!("at most {most} laws in series inside one another");
        self.found.push(Diagnostic::new(&start.at, Problem::LawTooDeep { most }, accepted));
    }

    fn named(&self, name: &str) -> Option<Node<'a>> {
        self.laws.as_ref()?.get(name)
    }
}

/// A row [pressure, stiffness] and its place.
struct Pair<'a> {
    node: Node<'a>,
    pair: [f64; 2],
}

/// The rows of the array at `key`, unless one of them is not a pair of numbers.
fn pairs<'a>(law: &Node<'a>, key: &str) -> Vec<Pair<'a>> {
    let pair = |node: Node<'a>| {
        let [pressure, stiffness] = node.value.as_array()?.as_slice() else {
            return None;
        };
        let pair = [pressure.as_f64()?, stiffness.as_f64()?];
        Some(Pair { node, pair })
    };
    let rows: Option<Vec<Pair<'a>>> = law.items(key).into_iter().map(pair).collect();
    rows.unwrap_or_default()
}
