//! Extremes, times without contact, mean stiffness and energies, summed over steps.
//!
//! Within a step a closure is the cubic through its values and rates at both ends. So extremes between
//! steps, and the times at which contact opens and closes, are found to fourth order.

use super::contact_solve::{Contact, RowState};
use super::hermite;

/// Halvings of a bracket about a root, to rounding of a part of a step.
const HALVINGS: usize = 50;

/// Sums over the steps so far.
#[derive(Debug, Clone)]
pub(super) struct Measures {
    pub(super) contacts: Vec<ContactMeasure>,
    /// Work of the load \[J\].
    pub(super) work: f64,
    /// Viscous loss of bodies \[J\].
    pub(super) loss: f64,
}

/// Sums of one contact.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct ContactMeasure {
    /// Lowest and highest closure increment \[m\].
    pub(super) lowest: f64,
    pub(super) highest: f64,
    /// Time without contact \[s\].
    pub(super) open: f64,
    /// Integral of the stiffness over time \[Pa s/m\].
    pub(super) stiffness: f64,
    /// Viscous loss per area \[J/m2\].
    pub(super) loss: f64,
}

impl Measures {
    pub(super) fn new(contacts: &[Contact<'_>]) -> Self {
        let contacts = vec![ContactMeasure::default(); contacts.len()];
        Self { contacts, work: 0.0, loss: 0.0 }
    }

    /// Work of a load that is a quadratic in the step on a port from one motion to another.
    pub(super) fn count_work(&mut self, load: [f64; 3], port: [[f64; 2]; 2], step: f64) {
        let [[a, da], [b, db]] = port;
        let (da, db) = (step * da, step * db);
        let mean = 0.5 * (a + b) + (da - db) / 12.0;
        let first_moment = (3.0 * a + 7.0 * b) / 20.0 + da / 30.0 - db / 20.0;
        self.work += load[0] * (b - a) + load[1] * (b - mean) + load[2] * (b - 2.0 * first_moment);
    }

    /// Takes in a step between two states of the rows.
    #[inline(always)]
    pub(super) fn take<const N: usize>(
        &mut self,
        contacts: &[Contact<'_>],
        ends: [&RowState<N>; 2],
        step: f64,
    ) {
        let [begin, end] = ends;
        for (i, (measure, contact)) in self.contacts.iter_mut().zip(contacts).enumerate() {
            let cubic =
                [begin.closure[i], begin.rate[i] * step, end.closure[i], end.rate[i] * step];
            measure.take(contact, cubic, [begin.stiffness[i], end.stiffness[i]], step);
            let viscous = |rows: &RowState<N>| (rows.traction[i] - rows.pressure[i]) * rows.rate[i];
            measure.loss += 0.5 * step * (viscous(begin) + viscous(end));
        }
    }
}

impl ContactMeasure {
    #[inline(always)]
    fn take(&mut self, contact: &Contact<'_>, cubic: [f64; 4], ends: [f64; 2], step: f64) {
        let [begin, begins, end, ends_with] = cubic;
        let mut places = [0.0, 1.0, 1.0, 1.0];
        let mut count = 1;
        let (mut low, mut high) = (begin.min(end), begin.max(end));
        // A cubic whose slopes at both ends are at most three times its rise, of one sign, is monotone.
        let rise = 3.0 * (end - begin);
        let is_monotone = [begins, ends_with]
            .iter()
            .all(|slope| slope * rise >= 0.0 && slope.abs() <= rise.abs());
        if !is_monotone {
            for place in turning_points(cubic).into_iter().flatten() {
                let closure = hermite(cubic, place);
                (low, high) = (low.min(closure), high.max(closure));
                places[count] = place;
                count += 1;
            }
        }
        (self.lowest, self.highest) = (self.lowest.min(low), self.highest.max(high));
        let level = contact.open_below;
        if high <= level {
            self.open += step;
        } else if low > level {
            let middle = contact.law(hermite(cubic, 0.5))[1];
            self.stiffness += step / 6.0 * (ends[0] + 4.0 * middle + ends[1]);
        } else {
            // Monotone pieces, each of them open on one side of its root.
            for piece in places[..=count].windows(2) {
                self.take_piece(contact, cubic, [piece[0], piece[1]], step);
            }
        }
    }

    #[cold]
    #[inline(never)]
    fn take_piece(
        &mut self,
        contact: &Contact<'_>,
        cubic: [f64; 4],
        [from, to]: [f64; 2],
        step: f64,
    ) {
        let above = |s: f64| hermite(cubic, s) > contact.open_below;
        let (mut pressed_from, mut pressed_to) = (from, to);
        match (above(from), above(to)) {
            (false, false) => {
                self.open += step * (to - from);
                return;
            }
            (true, true) => {}
            (begins, _) => {
                let (mut low, mut high) = (from, to);
                for _ in 0..HALVINGS {
                    let middle = 0.5 * (low + high);
                    if above(middle) == begins { low = middle } else { high = middle }
                }
                let root = 0.5 * (low + high);
                if begins {
                    pressed_to = root;
                } else {
                    pressed_from = root;
                }
                self.open += step * (to - from - (pressed_to - pressed_from));
            }
        }
        // Gauss's points lie within, where a stiffness that jumps has its value in contact.
        let (middle, half) = (0.5 * (pressed_from + pressed_to), 0.5 * (pressed_to - pressed_from));
        let apart = 0.6_f64.sqrt() * half;
        let at = |s: f64| contact.law(hermite(cubic, s))[1];
        let sum = 5.0 * at(middle - apart) + 8.0 * at(middle) + 5.0 * at(middle + apart);
        self.stiffness += step * half * sum / 9.0;
    }
}

/// Places within a step at which a cubic turns.
fn turning_points(cubic: [f64; 4]) -> [Option<f64>; 2] {
    let [a, da, b, db] = cubic;
    let rise = b - a;
    // slope = da + 2 c s + 3 d s^2
    let (c, d) = (3.0 * rise - 2.0 * da - db, da + db - 2.0 * rise);
    let inside = |s: f64| (s > 0.0 && s < 1.0).then_some(s);
    let discriminant = c * c - 3.0 * d * da;
    if discriminant <= 0.0 {
        return [None; 2];
    }
    let sum = -(c + discriminant.sqrt().copysign(c));
    let [first, second] = [inside(sum / (3.0 * d)), inside(da / sum)];
    match (first, second) {
        (Some(p), Some(q)) if p > q => [second, first],
        found => [found.0, found.1],
    }
}
