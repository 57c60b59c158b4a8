//! The friction element of a row, and its derivative with respect to a parameter.
//!
//! ```text
//! t = max(-R, min(R, s + k y)),   s = t_before - k y_before,   R = slip + share max(0, p_0 + 3 n_1 - 3 n_2 + n_3)
//! ```
//!
//! per area of the row, with the normal tractions n of the contact at the last three steps (see the
//! kernel of [friction](crate::modal::simd)). While the element is stuck `t' = s' + k' y + k y'`, while
//! it slips `t' = R'` with the sign of t: the motion is continuous where one follows the other, and the
//! derivative belongs to the piece that the element is on.

use crate::difference::central_difference;
use crate::modal::assembly::ModalModel;
use asperity_law::Pressure;

/// Normal tractions at the last three steps, newest first \[Pa\].
type NormalTractions = [f64; 3];

fn extrapolated([newest, before, oldest]: NormalTractions) -> f64 {
    3.0 * (newest - before) + oldest
}

/// Stiffness \[Pa/m\], slip traction \[Pa\] and share of a contact's pressure, of a row.
#[derive(Debug, Clone, Copy, Default)]
struct Coefficients {
    stiffness: f64,
    slip: f64,
    share: f64,
}

impl Coefficients {
    /// The coefficients of row `i`, and its contact; none without an element.
    fn of_row(model: &ModalModel, i: usize) -> Option<(Self, usize)> {
        let (friction, contact) = model.friction(i)?;
        let area = model.area(i);
        let own = Self {
            stiffness: friction.stiffness() / area,
            slip: friction.limit(0.0) / area,
            share: friction.share_of_contact() * model.area(contact) / area,
        };
        Some((own, contact))
    }
}

/// An element between two steps.
#[derive(Debug, Clone, Copy)]
pub(super) struct FrictionElement {
    coefficients: Coefficients,
    /// The contact whose force limits it.
    pub(super) contact: usize,
    /// Traction of the stuck element at zero closure \[Pa\].
    stuck: f64,
    limit: f64,
    normal: NormalTractions,
    /// Pressure \[Pa\] that the limit is a share of.
    carried: f64,
}

impl FrictionElement {
    /// The element of row `i` at rest; none without one.
    pub(super) fn of_row(model: &ModalModel, i: usize) -> Option<Self> {
        let (coefficients, contact) = Coefficients::of_row(model, i)?;
        let (stuck, limit, normal, carried) = (0.0, 0.0, [0.0; 3], 0.0);
        Some(Self { coefficients, contact, stuck, limit, normal, carried })
    }

    /// The limit of the next step, its contact having the pressure `rest` \[Pa\] at rest.
    pub(super) fn predict_limit(&mut self, rest: f64) {
        self.carried = (rest + extrapolated(self.normal)).max(0.0);
        self.limit = self.coefficients.slip + self.coefficients.share * self.carried;
    }

    fn is_stuck(&self, closure: f64) -> bool {
        (self.stuck + self.coefficients.stiffness * closure).abs() < self.limit
    }

    /// Traction and tangent at a `closure` \[m\].
    pub(super) fn traction(&self, closure: f64) -> Pressure {
        let force = self.stuck + self.coefficients.stiffness * closure;
        let tangent = if self.is_stuck(closure) { self.coefficients.stiffness } else { 0.0 };
        Pressure { value: force.min(self.limit).max(-self.limit), tangent }
    }

    /// Completes a step at its `closure` \[m\] and `normal` traction of the contact \[Pa\].
    pub(super) fn advance(&mut self, closure: f64, normal: f64) {
        self.stuck = self.traction(closure).value - self.coefficients.stiffness * closure;
        self.normal = [normal, self.normal[0], self.normal[1]];
    }
}

/// The derivative of an element between two steps.
#[derive(Debug, Clone, Copy)]
pub(super) struct FrictionDerivative {
    coefficients: Coefficients,
    stuck: f64,
    normal: NormalTractions,
}

impl FrictionDerivative {
    /// The derivative of the element of row `i` from the models at the places of a stencil; none
    /// without one.
    pub(super) fn of_row(models: [&ModalModel; 4], i: usize, step: f64) -> Option<Self> {
        let [a, b, c, d] = models.map(|model| Coefficients::of_row(model, i));
        let four = [a?.0, b?.0, c?.0, d?.0];
        let slope =
            |of: fn(&Coefficients) -> f64| central_difference(four.each_ref().map(of), step);
        let coefficients = Coefficients {
            stiffness: slope(|one| one.stiffness),
            slip: slope(|one| one.slip),
            share: slope(|one| one.share),
        };
        Some(Self { coefficients, stuck: 0.0, normal: [0.0; 3] })
    }

    /// The derivative of the traction of `base` at a fixed `closure` \[m\], the pressure of its contact
    /// at rest having the derivative `rest`.
    pub(super) fn at_fixed_closure(&self, base: &FrictionElement, closure: f64, rest: f64) -> f64 {
        if base.is_stuck(closure) {
            return self.stuck + self.coefficients.stiffness * closure;
        }
        let carried = if base.carried > 0.0 { rest + extrapolated(self.normal) } else { 0.0 };
        let limit = self.coefficients.slip
            + self.coefficients.share * base.carried
            + base.coefficients.share * carried;
        limit * base.traction(closure).value.signum()
    }

    /// Completes a step, `base` not having been advanced yet: from the closure \[m\] of the step, and the
    /// derivatives of closure, traction of the element and normal traction of its contact.
    pub(super) fn advance(
        &mut self,
        base: &FrictionElement,
        closure: f64,
        (d_closure, d_traction, d_normal): (f64, f64, f64),
    ) {
        self.stuck = d_traction
            - self.coefficients.stiffness * closure
            - base.coefficients.stiffness * d_closure;
        self.normal = [d_normal, self.normal[0], self.normal[1]];
    }
}
