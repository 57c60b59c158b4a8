//! The root of an increasing function.

/// Most doublings of a bracket, and most halvings.
const DOUBLINGS: usize = 64;
const HALVINGS: usize = 200;

/// The root of an increasing function by halving a bracket to rounding. The bracket grows from
/// `start` by `width`, twice `width` and so on, until it holds the root.
pub(super) fn increasing_root(excess: impl Fn(f64) -> f64, start: f64, mut width: f64) -> f64 {
    let (mut low, mut high) = (start, start);
    for _ in 0..DOUBLINGS {
        let (below, above) = (excess(low), excess(high));
        if below <= 0.0 && above >= 0.0 {
            break;
        }
        if below > 0.0 {
            low -= width;
        } else {
            high += width;
        }
        width *= 2.0;
    }
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        if excess(middle) > 0.0 { high = middle } else { low = middle }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::increasing_root;

    /// Roots on both sides of the start, near and far, to a rounding; a step is found as well.
    #[test]
    fn roots_are_found_to_rounding() {
        for root in [-1e9_f64, -0.3, 2.0, 7e5] {
            let found = increasing_root(|x| (x - root) + (x - root).powi(3), 0.1, 1.0);
            assert!((found / root - 1.0).abs() <= f64::EPSILON, "{found} {root}");
        }
        let found = increasing_root(|x| if x < 0.7 { -1.0 } else { 1.0 }, 0.0, 0.1);
        assert!((found / 0.7 - 1.0).abs() <= f64::EPSILON, "{found}");
    }
}
