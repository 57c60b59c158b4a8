//! Readings of a response between its output samples.
//!
//! Peaks and damping of a response are read from sums over its samples, whose error is of second order in the time between
//! them: `(w h)^2 / 12` of what the end of a record or a bend of the force adds. The output rate is for files and figures; integrators that
//! hand out no filtered record are read more often, a whole number of times for each output sample and at whole steps, so that
//! neither the steps nor the output change.

/// The fewest readings for each output sample, of those that divide its `steps`, that are at least `least` and at most
/// `most`; else the most of them.
pub(crate) fn readings(steps: usize, least: f64, most: usize) -> usize {
    // The cast saturates.
    let least = least.ceil().max(1.0) as usize;
    let enough = (least..=steps.min(most)).find(|parts| steps.is_multiple_of(*parts));
    enough.unwrap_or_else(|| most_readings(steps, most))
}

/// The most readings for each output sample that divide its `steps` and are at most `most`; at least one.
pub(crate) fn most_readings(steps: usize, most: usize) -> usize {
    (1..=steps.min(most)).rev().find(|parts| steps.is_multiple_of(*parts)).unwrap_or(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn readings_divide_the_steps_of_a_sample() {
        assert_eq!([2.5, 3.0, 12.5, 40.0].map(|least| readings(28, least, 100)), [4, 4, 14, 28]);
        assert_eq!([0.3, 1.5].map(|least| readings(29, least, 100)), [1, 29]);
        // Not more than memory has room for.
        assert_eq!([28, 13, 1, 0].map(|most| readings(28, 20.0, most)), [28, 7, 1, 1]);
        assert_eq!([most_readings(1, 9), most_readings(12, 9), most_readings(12, 0)], [1, 6, 1]);
    }
}
