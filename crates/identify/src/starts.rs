//! Agreement of the starts of the fit.

use asperity_inference::FitSolution;
use serde::Serialize;

/// Largest deviance above the best fit at which a start counts as having reached it: one standard
/// deviation along any direction.
const SAME_DEVIANCE: f64 = 1.0;

/// Share of the starts that reached the lowest cost.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum StartAgreement {
    /// All of two starts or more.
    All,
    /// More than one, not all: there are worse optima.
    Some,
    /// One alone, of several: others may find a better one.
    One,
    /// There was one start.
    NotTested,
}

impl StartAgreement {
    /// The agreement of the starts of a fit.
    pub fn of(fit: &FitSolution) -> Self {
        match (fit.starts.len(), starts_at_best(fit)) {
            (0 | 1, _) => Self::NotTested,
            (all, reached) if reached == all => Self::All,
            (_, 0 | 1) => Self::One,
            _ => Self::Some,
        }
    }
}

/// Number of starts whose deviance is at most one above the deviance of the best fit.
pub(crate) fn starts_at_best(fit: &FitSolution) -> usize {
    let reached = |cost: f64| 2.0 * (cost - fit.cost) <= SAME_DEVIANCE;
    fit.starts.iter().filter(|start| reached(start.cost)).count()
}

/// The conclusion about the starts, in a sentence.
pub(crate) fn about_starts(fit: &FitSolution) -> String {
    let (all, reached) = (fit.starts.len(), starts_at_best(fit));
    let mut others: Vec<f64> = fit.starts.iter().map(|start| 2.0 * start.cost).collect();
    others.sort_by(f64::total_cmp);
    let others: Vec<String> = others
        .split_off(reached.min(all))
        .into_iter()
        .map(|cost| if cost.is_finite() { format!("{cost:.1}") } else { "no run".to_owned() })
        .collect();
    let ends =
        format!("the others ended at {} (the best: {:.1})", others.join(", "), 2.0 * fit.cost);
    match StartAgreement::of(fit) {
        StartAgreement::NotTested => {
            "The fit had one start; whether others end in a better optimum was not tested."
                .to_owned()
        }
        StartAgreement::All => {
            format!("All {all} starts of the fit reached the same lowest cost.")
        }
        StartAgreement::Some => format!(
            "{reached} of {all} starts of the fit reached the lowest cost; in twice the cost, {ends}."
        ),
        StartAgreement::One => format!(
            "Only one of {all} starts of the fit reached the lowest cost, so that a better optimum may exist: in twice the cost, {ends}. More starts would tell."
        ),
    }
}

#[cfg(test)]
mod tests {
    use asperity_inference::{FitOptions, FunctionModel, Observation, Parameter, fit};

    use super::*;

    /// The fit of a double well from so many starts: two optima, of which one has the cost `1/2`.
    fn double_well(starts: usize, lower: f64) -> FitSolution {
        let model = FunctionModel {
            parameters: vec![Parameter::linear("x", 1.0, [lower, 2.0]).unwrap()],
            observations: Observation::list(&[0.0, 1.0], 0.1),
            function: |x: &[f64]| vec![3.0 * (x[0] * x[0] - 1.0), x[0]],
        };
        let options = FitOptions { starts, ..FitOptions::default() };
        fit(&model, &options).unwrap().into_solution()
    }

    #[test]
    fn starts_in_worse_optima_are_told() {
        let one_well = double_well(6, 0.5);
        assert_eq!(StartAgreement::of(&one_well), StartAgreement::All);
        assert!(about_starts(&one_well).starts_with("All 6 starts"));
        let alone = double_well(1, -2.0);
        assert_eq!(StartAgreement::of(&alone), StartAgreement::NotTested);
        let two = double_well(8, -2.0);
        let reached = starts_at_best(&two);
        assert!(reached > 1 && reached < 8, "{reached}");
        assert_eq!(StartAgreement::of(&two), StartAgreement::Some);
        let words = about_starts(&two);
        assert!(words.starts_with(&format!("{reached} of 8 starts")), "{words}");
        let worst = two.starts.iter().map(|start| start.cost).fold(0.0, f64::max);
        assert!(words.contains(&format!("{:.1}", 2.0 * worst)), "{words}");
    }
}
