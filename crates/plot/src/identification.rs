//! Figures and report of an identification.
//!
//! | file | draws |
//! |---|---|
//! | `law` | stiffness over pressure, and the uncertainty left |
//! | `observations` | (data with their predictions, labels and units of features) |
//! | `predictions` | measured against predicted; standardised residuals |
//! | `uncertainty` | profile likelihoods and posterior draws of the parameters |
//! | `comparison`, `design` | other laws; proposed hits |
//! | `report` | `report.html` |

mod comparison;
mod design;
mod law;
mod observations;
mod predictions;
mod report;
mod uncertainty;

use asperity_figure::Figure;
use asperity_identify::Identification;

pub use design::measurement;
pub use observations::feature_name;
pub use report::identification_report;

/// The figures with their names; those without anything to draw are left out.
pub fn identification(found: &Identification) -> Vec<(&'static str, Figure)> {
    let rows = observations::rows(found);
    let all = [
        ("law", Some(law::law(found, &rows))),
        ("features", predictions::features(&rows)),
        ("receptance", predictions::receptance(&rows)),
        ("backbone", predictions::backbone(&rows)),
        ("steady", predictions::steady(&rows)),
        ("residuals", predictions::residuals(&rows)),
        ("profiles", uncertainty::profiles(found)),
        ("pairs", uncertainty::pairs(found)),
        ("comparison", found.comparison.as_ref().map(comparison::comparison)),
        ("design", found.design.as_ref().map(design::design)),
    ];
    all.into_iter().filter_map(|(name, figure)| Some((name, figure?))).collect()
}

/// A probability in percent.
pub(super) fn percent(probability: f64) -> String {
    let text = format!("{:.3}", 100.0 * probability);
    format!("{} %", text.trim_end_matches('0').trim_end_matches('.'))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentages_have_no_trailing_zeros() {
        assert_eq!(percent(0.95), "95 %");
        assert_eq!(percent(0.6827), "68.27 %");
        assert_eq!(percent(0.9), "90 %");
    }
}
