//! Statements of the paper and their outcomes.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::{Context, Result, bail};
use serde::Deserialize;

/// One statement of the paper.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Claim {
    /// Name under which a figure gives the number.
    pub(crate) id: String,
    /// Section, table or figure of the paper.
    pub(crate) section: String,
    /// The statement in a few words.
    pub(crate) quote: String,
    /// Unit of the number, for display.
    pub(crate) unit: String,
    /// Condition on the number.
    pub(crate) expected: Expected,
    /// Reason for the tolerance.
    pub(crate) reason: String,
    /// The reading of the paper under which the claim is checked, if its words alone do not do.
    #[serde(default)]
    pub(crate) reading: Option<String>,
    /// Known reason for a claim that is not reproduced.
    #[serde(default)]
    pub(crate) why_not: Option<String>,
    /// The verdict that `--check` holds it to.
    pub(crate) verdict: Verdict,
}

/// Condition under which a number supports a claim.
#[derive(Debug, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub(crate) enum Expected {
    /// `value`, within `relative` of it.
    Near { value: f64, relative: f64 },
    /// From `low` to `high`.
    Between { low: f64, high: f64 },
    /// A yes: the number is 1 where the statement holds and 0 where not.
    Holds,
}

impl Expected {
    fn met_by(&self, value: f64) -> bool {
        match *self {
            Self::Near { value: expected, relative } => {
                (value - expected).abs() <= relative * expected.abs()
            }
            Self::Between { low, high } => (low..=high).contains(&value),
            Self::Holds => value == 1.0,
        }
    }

    /// The paper's number and its tolerance, for display.
    pub(crate) fn in_words(&self) -> String {
        match *self {
            Self::Near { value, relative } => {
                format!("{} ± {} %", plain(value), (1e5 * relative).round() / 1e3)
            }
            Self::Between { low, high } => format!("{} to {}", plain(low), plain(high)),
            Self::Holds => "holds".to_owned(),
        }
    }
}

/// A number as the paper writes it: with an exponent from a million on.
fn plain(value: f64) -> String {
    if value.abs() < 1e6 { format!("{value}") } else { format!("{value:e}") }
}

/// Outcome of a claim.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Verdict {
    /// The paper's statement holds as written.
    Reproduced,
    /// It holds under a stated reading of an ambiguous or inconsistent passage.
    UnderReading,
    /// It does not hold, and the reason is given.
    NotReproduced,
}

/// A claim with its number and verdict.
#[derive(Debug)]
pub(crate) struct CheckedClaim<'a> {
    pub(crate) claim: &'a Claim,
    pub(crate) value: f64,
    pub(crate) verdict: Verdict,
}

impl CheckedClaim<'_> {
    /// Message of `--check` about an outcome that differs from the stored one.
    pub(crate) fn difference(&self) -> Option<String> {
        (self.verdict != self.claim.verdict).then(|| {
            format!(
                "claim {}: {:?} is stored, but {} {} makes it {:?}",
                self.claim.id, self.claim.verdict, self.value, self.claim.unit, self.verdict
            )
        })
    }
}

/// Reads the claims.
pub(crate) fn load(path: &Path) -> Result<Vec<Claim>> {
    let reading = || format!("reading {}", path.display());
    let text = std::fs::read_to_string(path).with_context(reading)?;
    serde_json::from_str(&text).with_context(reading)
}

/// Checks every claim for which there is a value; with `all`, each must have one
/// and each value a claim.
pub(crate) fn check<'a>(
    claims: &'a [Claim],
    values: &BTreeMap<String, f64>,
    all: bool,
) -> Result<Vec<CheckedClaim<'a>>> {
    if let Some(stray) = values.keys().find(|id| !claims.iter().any(|claim| claim.id == **id)) {
        bail!("a figure gives a value for \"{stray}\", which is no claim in claims.json");
    }
    let mut checked = Vec::new();
    for claim in claims {
        let Some(&value) = values.get(&claim.id) else {
            if all {
                bail!("no figure gives a value for the claim \"{}\"", claim.id);
            }
            continue;
        };
        let verdict = match (claim.expected.met_by(value), &claim.reading) {
            (true, None) => Verdict::Reproduced,
            (true, Some(_)) => Verdict::UnderReading,
            (false, _) => Verdict::NotReproduced,
        };
        checked.push(CheckedClaim { claim, value, verdict });
    }
    Ok(checked)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn claim(expected: &str, reading: &str) -> Claim {
        let text = format!(
            r#"{{"id": "a", "section": "1", "quote": "q", "unit": "Hz", "expected": {expected},
                "reason": "r", "verdict": "reproduced"{reading}}}"#
        );
        serde_json::from_str(&text).unwrap()
    }

    #[test]
    fn the_verdict_follows_from_the_number_and_the_reading() {
        let near = r#"{"kind": "near", "value": 800, "relative": 0.05}"#;
        let cases = [
            (claim(near, ""), 839.0, Verdict::Reproduced),
            (claim(near, ""), 841.0, Verdict::NotReproduced),
            (claim(near, r#", "reading": "x""#), 800.0, Verdict::UnderReading),
            (claim(r#"{"kind": "holds"}"#, ""), 0.0, Verdict::NotReproduced),
            (claim(r#"{"kind": "between", "low": 1, "high": 2}"#, ""), 2.0, Verdict::Reproduced),
            (claim(near, ""), f64::NAN, Verdict::NotReproduced),
        ];
        for (claim, value, verdict) in cases {
            let values = BTreeMap::from([("a".to_owned(), value)]);
            let claims = [claim];
            let checked = check(&claims, &values, true).unwrap();
            assert_eq!(checked[0].verdict, verdict);
            assert_eq!(checked[0].difference().is_some(), verdict != Verdict::Reproduced);
        }
    }

    #[test]
    fn a_claim_without_a_number_and_a_number_without_a_claim_are_refused() {
        let claims = [claim(r#"{"kind": "holds"}"#, "")];
        assert!(check(&claims, &BTreeMap::new(), true).is_err());
        assert!(check(&claims, &BTreeMap::new(), false).unwrap().is_empty());
        let stray = BTreeMap::from([("b".to_owned(), 1.0)]);
        assert!(check(&claims, &stray, false).is_err());
    }
}
