//! Reasons from what the model and the data take as given: the support, the integration, the standard deviations.

use asperity_scenario::four_digits;

use super::{Reason, ReasonKind, Usability};
use crate::identification::Identification;

/// Half widths of its band by which a half-space of steel may move a law before care is needed: beyond this even a
/// support five times as stiff moves the law out of its band.
const SUPPORT_WIDTHS: f64 = 5.0;

/// Root mean square of the errors of the integration in a feature, in standard deviations of its observations, from
/// which care is needed.
const NUMERICAL: f64 = 1.0;

/// p-value of a smaller chi-square below which the standard deviations are too large.
const TOO_GOOD: f64 = 1e-6;

impl Identification {
    /// No residual shows a compliance in series with all contacts: the law takes it up.
    pub(super) fn of_support(&self) -> Option<Reason> {
        let support = self.rigid_support.filter(|_| self.law.informed_range().is_some())?;
        let half_widths = support.stiffness_n_per_m / support.half_space_n_per_m;
        let needs_care = half_widths > SUPPORT_WIDTHS && !support.is_stated;
        let usability = if needs_care { Usability::WithCare } else { Usability::Yes };
        let words = format!(
            "the support is taken as rigid, which the data hardly test: a half-space of steel under the lowest contact has {} N/m and would move the stiffness at {} MPa by {:.2} %, {:.1} times half of the width of its band; a support of less than {} N/m by more than that half. A support \"spring_mass\" in the scenario, with its stiffness, takes it into account; a tolerance of 0 of \"/support\" in \"given\" states that it is rigid.",
            four_digits(support.half_space_n_per_m),
            four_digits(1e-6 * support.pressure_pa),
            100.0 * support.half_space_shift,
            half_widths,
            four_digits(support.stiffness_n_per_m),
        );
        let numbers = [
            ("stiffness_n_per_m", support.stiffness_n_per_m),
            ("pressure_pa", support.pressure_pa),
            ("half_space_n_per_m", support.half_space_n_per_m),
            ("half_space_shift", support.half_space_shift),
        ];
        Some(Reason::new(ReasonKind::RigidSupport, usability, words, numbers))
    }

    pub(super) fn of_numerics(&self) -> Option<Reason> {
        let errors = self.feature_errors.iter().filter(|one| one.deviations > NUMERICAL);
        let worst = errors.max_by(|a, b| a.deviations.total_cmp(&b.deviations))?;
        let words = format!(
            "the errors of the integration are estimated as {:.1} standard deviations of the {} observations of {} (root mean square). Without \"step_s\" in \"method\" of the scenario the step is chosen by its \"accuracy\", and a smaller one lowers them.",
            worst.deviations, worst.observations, worst.feature
        );
        let numbers =
            [("deviations", worst.deviations), ("observations", worst.observations as f64)];
        Some(Reason::new(ReasonKind::Numerics, Usability::WithCare, words, numbers))
    }

    pub(super) fn of_spreads(&self) -> Option<Reason> {
        let goodness = &self.goodness;
        let freedom = goodness.degrees_of_freedom;
        let larger = goodness.p_value?;
        if freedom == 0 || 1.0 - larger > TOO_GOOD {
            return None;
        }
        let factor = (freedom as f64 / goodness.chi_square).sqrt();
        let words = format!(
            "chi-square is {:.1} for {freedom} degrees of freedom: the standard deviations of the data are about {factor:.1} times the residuals, and the intervals too wide by as much if the errors are random.",
            goodness.chi_square
        );
        let numbers = [("chi_square", goodness.chi_square), ("degrees_of_freedom", freedom as f64)];
        Some(Reason::new(ReasonKind::Spreads, Usability::Yes, words, numbers))
    }
}
