//! Estimated errors of a response, from those that it is compared with.

use asperity_dynamics::ContactExtremes;

use super::Task;
use crate::accuracy::ErrorEstimate;
use crate::error_control::response::Response;

impl Task<'_> {
    /// Errors by the step.
    pub(super) fn step_errors(&self, fine: &Response) -> ErrorEstimate {
        let Some(Ok(other)) = &self.other else {
            return ErrorEstimate::unknown(fine.observables.all(), self.accuracy());
        };
        let [finer, coarser] =
            if self.compares_with_half() { [other, fine] } else { [fine, other] };
        if finer.record.is_of_second_order && !coarser.record.is_of_second_order {
            // The error of the finer one may be the larger.
            return ErrorEstimate::unknown(fine.observables.all(), self.accuracy());
        }
        // Of second order while contact holds; of first where it is lost, or friction begins to slip. At steps of its own
        // half the difference from a coarser one is a bound by experience; twice that from a finer one bounds near runs too.
        let kinks = fine.loses_contact() || other.loses_contact() || fine.has_friction();
        let divisor = match (self.compares_with_half(), kinks) {
            (false, _) if self.varies_steps() => 2.0,
            (true, _) if self.varies_steps() => 0.5,
            (false, false) => 3.0,
            (false, true) => 1.0,
            (true, false) => 0.75,
            (true, true) => 0.5,
        };
        ErrorEstimate::new(
            fine.observables.all(),
            other.observables.all(),
            divisor,
            self.accuracy(),
        )
    }

    /// Errors by the truncation of modes, of third order in their number; with loss of contact or
    /// friction of no certain order, the whole difference.
    pub(super) fn truncation_errors(&self, fine: &Response) -> ErrorEstimate {
        match &self.fewer {
            Some(Ok(fewer)) => {
                let kinks = fewer.loses_contact() || fine.loses_contact() || fine.has_friction();
                let is_of_more = fewer.record.modes > fine.record.modes;
                let divisor = if kinks || is_of_more { 1.0 } else { 3.0 };
                ErrorEstimate::new(
                    fine.observables.all(),
                    fewer.observables.all(),
                    divisor,
                    self.accuracy(),
                )
            }
            None | Some(Err(_)) => ErrorEstimate::unknown(fine.observables.all(), self.accuracy()),
        }
    }

    /// Upper bound of the errors by modes that are too fast for the fine response and for the response of
    /// another step.
    pub(super) fn fast_mode_errors(&self, fine: &Response) -> ErrorEstimate {
        if self.varies_steps() {
            // Steps are short until modes too fast for longer ones are at rest.
            return ErrorEstimate::of_share(fine.observables.all(), 0.0, self.accuracy());
        }
        let step = match &self.other {
            Some(Ok(other)) => other.record.step.min(fine.record.step),
            _ => fine.record.step,
        };
        let error = fine.case.error_of_fast_modes(step, &fine.record);
        ErrorEstimate::of_share(fine.observables.all(), error, self.accuracy())
    }

    /// Errors by the tables of the laws: their largest differences from the laws, over the ranges of
    /// pressure, are those of the forces.
    pub(super) fn table_errors(&self, fine: &Response) -> ErrorEstimate {
        let Ok(errors) = fine.record.table_errors(&fine.case.model) else {
            return ErrorEstimate::unknown(fine.observables.all(), self.accuracy());
        };
        let share = |(error, contact): (f64, &ContactExtremes)| {
            if error == 0.0 { 0.0 } else { error / (contact.pressure_max - contact.pressure_min) }
        };
        let shares = errors.into_iter().zip(&fine.record.contacts).map(share);
        let largest = shares.fold(0.0, f64::max);
        ErrorEstimate::of_share(fine.observables.all(), largest, self.accuracy())
    }
}
