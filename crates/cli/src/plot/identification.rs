//! An identification: the law with its band, data against predictions, residuals, profiles, draws.
//!
//! | file | idea |
//! |---|---|
//! | `law` | stiffness over pressure, and what is left of its uncertainty |
//! | `rows`, `feature_name` | data with their predictions; names and units of features |
//! | `measured` | features, receptance and backbone against predictions |
//! | `residuals` | standardised residuals |
//! | `profiles`, `pairs` | deviance and draws of the unknowns |
//! | `comparison`, `design` | other laws; hits to come |
//! | `page`, `findings` | the report |

mod comparison;
mod design;
mod feature_name;
mod findings;
mod law;
mod measured;
mod page;
mod pairs;
mod profiles;
mod residuals;
mod rows;

use asperity_figure::Figure;
use asperity_identify::Identification;

pub(crate) use page::identification_report;
use rows::Row;

/// The figures with their names; those without anything to draw are left out.
pub(crate) fn identification(found: &Identification) -> Vec<(&'static str, Figure)> {
    let rows = rows::rows(found);
    let all = [
        ("law", Some(law::law(found, &rows))),
        ("features", measured::features(&rows)),
        ("receptance", measured::receptance(&rows)),
        ("backbone", measured::backbone(&rows)),
        ("residuals", residuals::residuals(&rows)),
        ("profiles", profiles::profiles(found)),
        ("pairs", pairs::pairs(found)),
        ("comparison", found.choice.as_ref().map(comparison::comparison)),
        ("design", found.design.as_ref().map(design::design)),
    ];
    all.into_iter().filter_map(|(name, figure)| Some((name, figure?))).collect()
}

/// A text that fits beside an axis.
fn fitted(text: &str, most: usize) -> String {
    if text.chars().count() <= most {
        return text.to_owned();
    }
    let kept: String = text.chars().take(most.saturating_sub(1)).collect();
    format!("{}…", kept.trim_end())
}

/// The name of an unknown for an axis: of a JSON Pointer the last key.
fn short(name: &str, most: usize) -> String {
    let last = if name.starts_with('/') { name.rsplit('/').next().unwrap_or(name) } else { name };
    fitted(&last.replace("~1", "/").replace("~0", "~"), most)
}

#[cfg(test)]
mod tests {
    use super::short;

    #[test]
    fn unknowns_are_named_in_short() {
        assert_eq!(short("/laws/modified/exponent", 20), "exponent");
        assert_eq!(short("/laws/a~1b", 20), "a/b");
        assert_eq!(short("modified: step 1", 20), "modified: step 1");
        assert_eq!(short("a rather long name", 8), "a rathe…");
    }
}
