//! A structure as modes: modes and what the modes left out still yield.
//!
//! Between its contacts a structure is linear. Expanded in mass-normalised
//! modes `n` of the parts taken apart (contacts open, hammer off), under a
//! drive force `f` and contact forces `F_j` beyond those at rest,
//!
//! ```text
//! q_n'' + c_n q_n' + w_n^2 q_n = b_n f - sum_j g_nj F_j
//! closure_i = sum_n g_ni q_n + r_i f - sum_j R_ij F_j
//! output    = sum_n o_n q_n + r_o f - sum_j s_j F_j
//! ```
//!
//! where the residual flexibilities `R`, `r`, `s` are the static yielding of
//! all modes left out. Nothing here is particular to bars: modes of a finite
//! element model fill the same numbers.

use std::f64::consts::PI;

use crate::error::{MeshError, not_negative};
use crate::{Body, Stack, Support};

/// One mass-normalised mode.
#[derive(Debug, Clone, PartialEq)]
pub struct NormalMode {
    /// Angular frequency w \[rad/s\]; zero for a rigid motion.
    pub angular_frequency: f64,
    /// Whether the mass-proportional damping h of the bodies acts on it.
    pub mass_damped: bool,
    /// Damping rate of its own \[1/s\], beyond mass-proportional damping.
    pub damping_rate: f64,
    /// Shape at the driving point \[kg^-1/2\].
    pub drive: f64,
    /// Shape at the output \[kg^-1/2\].
    pub output: f64,
    /// Shape of each interface's closure, upper face less lower face \[kg^-1/2\].
    pub closure: Vec<f64>,
}

/// Static flexibility of the modes left out \[m/N\].
#[derive(Debug, Clone, PartialEq)]
pub struct ResidualFlexibility {
    /// Closure of interface i per contact force at j: row i, column j.
    pub closure: Vec<Vec<f64>>,
    /// Closure of each interface per drive force.
    pub drive: Vec<f64>,
    /// Output per contact force at each interface.
    pub output: Vec<f64>,
    /// Output per drive force.
    pub direct: f64,
    /// Displacement of the driving point per drive force.
    pub driving_point: f64,
}

impl ResidualFlexibility {
    /// Adds the static flexibility of `mode`, which must not be rigid: the mode is left out then.
    pub fn add(&mut self, mode: &NormalMode) {
        let yielding = mode.angular_frequency.powi(-2);
        for (row, g) in self.closure.iter_mut().zip(&mode.closure) {
            for (entry, other) in row.iter_mut().zip(&mode.closure) {
                *entry += g * other * yielding;
            }
        }
        for (entry, g) in self.drive.iter_mut().zip(&mode.closure) {
            *entry += g * mode.drive * yielding;
        }
        for (entry, g) in self.output.iter_mut().zip(&mode.closure) {
            *entry += g * mode.output * yielding;
        }
        self.direct += mode.drive * mode.output * yielding;
        self.driving_point += mode.drive * mode.drive * yielding;
    }
}

/// Modes and residual flexibility of a structure with open contacts.
#[derive(Debug, Clone, PartialEq)]
pub struct ComponentModes {
    modes: Vec<NormalMode>,
    residual: ResidualFlexibility,
}

/// How many modes of each body are kept.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ModeCount {
    /// This many, the rigid one included.
    PerBody(usize),
    /// So many that up to `angular_frequency` \[rad/s\] the inertia of the modes left out, which
    /// residual flexibility neglects, is at most `tolerance` of the body's own.
    Bound {
        /// Highest angular frequency of interest \[rad/s\].
        angular_frequency: f64,
        /// Share of the body's rigid receptance `1 / (m w^2)` that may be neglected.
        tolerance: f64,
    },
}

/// Most modes of one body.
const MOST_MODES: usize = 2000;

impl ModeCount {
    /// Number of modes of `body`, the rigid one included.
    ///
    /// A free-free mode n has receptance `2 / (m (w_n^2 - w^2))` at the faces. Of this, residual
    /// flexibility keeps `2 / (m w_n^2)` and neglects, over `1 / (m w^2)`,
    /// `2 (w / w_n)^4 / (1 - (w / w_n)^2)`; with `w_n = n w_1` the sum over n > N is below
    /// `2 (w / w_1)^4 / (1 - (w / w_N+1)^2)` times `1 / (N + 1)^4 + 1 / (3 (N + 1)^3)`.
    ///
    /// # Errors
    /// [`MeshError::ModeCount`] for no modes, or more than 2000.
    pub fn of(self, body: &Body) -> Result<usize, MeshError> {
        let name = || body.name().to_owned();
        let refuse = |modes: f64| MeshError::ModeCount { body: name(), modes, limit: MOST_MODES };
        match self {
            Self::PerBody(modes) if (1..=MOST_MODES).contains(&modes) => Ok(modes),
            Self::PerBody(modes) => Err(refuse(modes as f64)),
            Self::Bound { angular_frequency, tolerance } => {
                not_negative(body.name(), "angular frequency [rad/s]", angular_frequency)?;
                let first = PI * body.wave_speed() / body.length();
                let ratio = angular_frequency / first;
                let neglected = |kept: usize| {
                    let next = kept as f64;
                    let tail = next.powi(-4) + next.powi(-3) / 3.0;
                    // Below resonance with margin, or the series says nothing.
                    let below = 1.0 - (ratio / next).powi(2);
                    if below < 0.5 { f64::INFINITY } else { 2.0 * ratio.powi(4) * tail / below }
                };
                (1..=MOST_MODES)
                    .find(|&kept| neglected(kept) <= tolerance)
                    .ok_or_else(|| refuse(ratio))
            }
        }
    }

    /// Number of modes of every body of `stack`, the rigid one included.
    ///
    /// # Errors
    /// Those of [`of`](Self::of).
    pub fn counts(self, stack: &Stack) -> Result<Vec<usize>, MeshError> {
        stack.bodies().iter().map(|body| self.of(body)).collect()
    }
}

impl ComponentModes {
    /// A structure from its modes and residual flexibility, wherever they come from.
    ///
    /// # Errors
    /// [`MeshError::ModalSize`] when a row has not one entry per interface;
    /// [`MeshError::Negative`] for a frequency or rate that is negative or not finite.
    pub fn new(modes: Vec<NormalMode>, residual: ResidualFlexibility) -> Result<Self, MeshError> {
        let interfaces = residual.closure.len();
        let rows = modes.iter().map(|mode| mode.closure.len());
        let others = residual.closure.iter().map(Vec::len);
        for found in rows.chain(others).chain([residual.drive.len(), residual.output.len()]) {
            if found != interfaces {
                return Err(MeshError::ModalSize { found, interfaces });
            }
        }
        for mode in &modes {
            not_negative("mode", "angular frequency [rad/s]", mode.angular_frequency)?;
            not_negative("mode", "damping rate [1/s]", mode.damping_rate)?;
        }
        Ok(Self { modes, residual })
    }

    /// The free-free modes of every bar of `stack` in closed form, and its support.
    ///
    /// `w_n = n pi c / L`; at the upper face the shape is `sqrt(2 / m)`, at the lower
    /// `(-1)^n sqrt(2 / m)`, and `sqrt(1 / m)` for n = 0. The flexibility of all elastic modes is
    /// `L / (3 E A)` at a face and `-L / (6 E A)` across.
    ///
    /// # Errors
    /// [`MeshError::ModeCount`] when `modes` asks for none or too many.
    pub fn of_stack(stack: &Stack, modes: ModeCount) -> Result<Self, MeshError> {
        Self::with_counts(stack, &modes.counts(stack)?)
    }

    /// [`of_stack`](Self::of_stack) with a count of modes, the rigid one included, of each body.
    ///
    /// # Errors
    /// [`MeshError::ModeCount`] for no modes or too many; a body without a count has none.
    pub fn with_counts(stack: &Stack, counts: &[usize]) -> Result<Self, MeshError> {
        let interfaces = stack.interfaces().len();
        let mut modes = Vec::new();
        let mut residual = ResidualFlexibility {
            closure: vec![vec![0.0; interfaces]; interfaces],
            drive: vec![0.0; interfaces],
            output: vec![0.0; interfaces],
            direct: 0.0,
            driving_point: 0.0,
        };
        for (i, body) in stack.bodies().iter().enumerate() {
            let count = counts.get(i).copied().unwrap_or(0);
            let kept = ModeCount::PerBody(count).of(body)?;
            let first = PI * body.wave_speed() / body.length();
            let static_flexibility = body.length() / body.axial_rigidity();
            let (mut same, mut across) = (static_flexibility / 3.0, -static_flexibility / 6.0);
            for n in 0..kept {
                let w = n as f64 * first;
                let shape = (if n == 0 { 1.0 } else { 2.0 } / body.mass()).sqrt();
                let at_bottom = if n % 2 == 0 { shape } else { -shape };
                if n > 0 {
                    same -= shape * shape / (w * w);
                    across -= shape * at_bottom / (w * w);
                }
                let mut closure = vec![0.0; interfaces];
                closure[i] = at_bottom;
                if i > 0 {
                    closure[i - 1] = -shape;
                }
                let at_top = if i == 0 { shape } else { 0.0 };
                modes.push(NormalMode {
                    angular_frequency: w,
                    mass_damped: true,
                    damping_rate: 0.0,
                    drive: at_top,
                    output: at_top,
                    closure,
                });
            }
            residual.closure[i][i] += same;
            if i == 0 {
                (residual.drive[0], residual.output[0]) = (across, across);
                (residual.direct, residual.driving_point) = (same, same);
            } else {
                residual.closure[i - 1][i - 1] += same;
                residual.closure[i - 1][i] -= across;
                residual.closure[i][i - 1] -= across;
            }
        }
        if let Support::SpringMass { stiffness, mass, .. } = *stack.support() {
            let mut closure = vec![0.0; interfaces];
            closure[interfaces - 1] = -(1.0 / mass).sqrt();
            modes.push(NormalMode {
                angular_frequency: (stiffness / mass).sqrt(),
                mass_damped: false,
                damping_rate: stack.support().damping() / mass,
                drive: 0.0,
                output: 0.0,
                closure,
            });
        }
        Self::new(modes, residual)
    }

    /// The modes.
    pub fn modes(&self) -> &[NormalMode] {
        &self.modes
    }

    /// The flexibility of the modes left out.
    pub fn residual(&self) -> &ResidualFlexibility {
        &self.residual
    }

    /// Number of interfaces.
    pub fn interfaces(&self) -> usize {
        self.residual.closure.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BarStiffness, Interface};
    use asperity_law::Constant;
    use std::sync::Arc;

    fn stack(support: Support) -> Stack {
        let law = Arc::new(Constant::new(1e12).unwrap());
        let contact = |name| Interface::new(name, 1e-4, law.clone()).unwrap();
        let bodies = vec![
            Body::new("a", 0.2, 2e-3, 71e9, 2710.0).unwrap(),
            Body::new("b", 0.03, 1e-4, 71e9, 2710.0).unwrap(),
        ];
        Stack::new(bodies, vec![contact("ab"), contact("b0")], support, 9.81).unwrap()
    }

    /// Receptance of closure 0 per contact force 0 of the modal structure, without damping.
    fn closure_receptance(structure: &ComponentModes, w: f64, (i, j): (usize, usize)) -> f64 {
        let modes = structure.modes().iter();
        let sum: f64 = modes
            .map(|m| m.closure[i] * m.closure[j] / (m.angular_frequency.powi(2) - w * w))
            .sum();
        sum + structure.residual().closure[i][j]
    }

    /// Against the closed-form dynamic stiffness of the bars: the error is the neglected
    /// inertia and falls with the fourth power of frequency, as the bound says.
    #[test]
    fn modes_and_residual_meet_the_closed_form_receptance() {
        let stack = stack(Support::Rigid);
        let exact = |w: f64, direct: bool| {
            let [a, b] = [0, 1].map(|i| BarStiffness::at(&stack.bodies()[i], w));
            // Flexibility is the inverse of the two-by-two dynamic stiffness.
            let inverse = |s: &BarStiffness| {
                let determinant = s.direct * s.direct - s.cross * s.cross;
                (s.direct / determinant, -s.cross / determinant)
            };
            let ((a_same, _), (b_same, b_across)) = (inverse(&a), inverse(&b));
            if direct { a_same + b_same } else { -b_across }
        };
        let first = PI * stack.bodies()[0].wave_speed() / stack.bodies()[0].length();
        for kept in [1, 2, 5] {
            let structure = ComponentModes::of_stack(&stack, ModeCount::PerBody(kept)).unwrap();
            let error =
                |w: f64| (closure_receptance(&structure, w, (0, 0)) - exact(w, true)).abs() * w * w;
            let (low, high) = (error(0.05 * first), error(0.1 * first));
            let slope = (high / low).log2();
            assert!((slope - 4.0).abs() < 0.1, "{kept}: {slope}");
            let across = closure_receptance(&structure, 0.1 * first, (0, 1));
            assert!((across / exact(0.1 * first, false) - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn the_bound_keeps_the_modes_that_matter() {
        let stack = stack(Support::Rigid);
        let [bar, slab] = [&stack.bodies()[0], &stack.bodies()[1]];
        let first = PI * bar.wave_speed() / bar.length();
        let kept = |share: f64, tolerance: f64| {
            ModeCount::Bound { angular_frequency: share * first, tolerance }.of(bar).unwrap()
        };
        assert_eq!(kept(0.01, 1e-3), 1);
        assert_eq!(kept(0.23, 1e-3), 2);
        assert!(kept(0.23, 1e-6) > 5);
        assert!(kept(20.0, 1e-3) > 28, "modes up to the band, with margin");
        let slab_modes = ModeCount::Bound { angular_frequency: 0.23 * first, tolerance: 1e-3 };
        assert_eq!(slab_modes.of(slab).unwrap(), 1);
        assert!(ModeCount::PerBody(0).of(bar).is_err());
        assert!(ModeCount::Bound { angular_frequency: 1e9, tolerance: 1e-3 }.of(bar).is_err());
    }

    /// Leaving a mode out of many gives what keeping fewer gives.
    #[test]
    fn a_mode_left_out_is_flexibility() {
        let stack = stack(Support::Rigid);
        let of = |modes| ComponentModes::of_stack(&stack, ModeCount::PerBody(modes)).unwrap();
        let mut residual = of(3).residual().clone();
        residual.add(&of(3).modes()[2]);
        residual.add(&of(3).modes()[5]);
        let fewer = of(2);
        for i in 0..2 {
            for j in 0..2 {
                let off = residual.closure[i][j] - fewer.residual().closure[i][j];
                assert!(off.abs() < 1e-15 * residual.closure[i][i]);
            }
            assert!((residual.drive[i] - fewer.residual().drive[i]).abs() < 1e-24);
            assert!((residual.output[i] - fewer.residual().output[i]).abs() < 1e-24);
        }
        assert!((residual.direct - fewer.residual().direct).abs() < 1e-24);
    }

    #[test]
    fn a_spring_mass_support_is_one_more_oscillator() {
        let support = Support::SpringMass { stiffness: 1e8, mass: 4.0, damping_ratio: 0.1 };
        let structure = ComponentModes::of_stack(&stack(support), ModeCount::PerBody(2)).unwrap();
        let last = structure.modes().last().unwrap();
        assert_eq!(structure.modes().len(), 5);
        assert_eq!(last.angular_frequency, 5e3);
        assert_eq!(last.closure, [0.0, -0.5]);
        assert!(!last.mass_damped && (last.damping_rate - 2.0 * 0.1 * 5e3).abs() < 1e-9);
    }

    #[test]
    fn rows_of_unequal_length_are_refused() {
        let whole =
            ComponentModes::of_stack(&stack(Support::Rigid), ModeCount::PerBody(1)).unwrap();
        let mut modes = whole.modes().to_vec();
        modes[0].closure.pop();
        assert!(ComponentModes::new(modes, whole.residual().clone()).is_err());
        let mut modes = whole.modes().to_vec();
        modes[0].angular_frequency = f64::NAN;
        assert!(ComponentModes::new(modes, whole.residual().clone()).is_err());
    }
}
