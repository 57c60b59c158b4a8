//! A preloaded structure in component modes as a linear system.

use asperity_mesh::{ComponentModes, NormalMode};
use asperity_structure::{DampedMode, Guide, PreloadedStructure};
use faer::Mat;
use faer::linalg::solvers::{Solve, Svd};
use num_complex::Complex64;

use crate::modal_damping;
use crate::{Compliance, HarmonicError, LinearSystem, MeanBalance, Receptance};

/// Part of the largest singular value below which a rigid motion is not held by contacts.
const HELD: f64 = 1e-9;

/// Number of contact pairs and guides.
fn pairs(modes: &ComponentModes) -> usize {
    modes.interfaces() + modes.guides()
}

/// Closure of a mode at a contact pair, or its displacement in a guide.
fn closure(mode: &NormalMode, pair: usize) -> f64 {
    let contacts = mode.closure.len();
    if pair < contacts { mode.closure[pair] } else { mode.guide[pair - contacts] }
}

fn rigid_modes(modes: &ComponentModes) -> Vec<&NormalMode> {
    modes.modes().iter().filter(|mode| mode.angular_frequency == 0.0).collect()
}

/// Closures of the rigid modes, a column each.
fn rigid_closures(modes: &ComponentModes) -> Mat<f64> {
    let rigid = rigid_modes(modes);
    Mat::from_fn(pairs(modes), rigid.len(), |i, r| closure(rigid[r], i))
}

/// Number of independent rigid motions that close some contact.
fn held(closures: &Mat<f64>) -> usize {
    let values = closures.singular_values().unwrap_or_default();
    let largest = values.iter().copied().fold(0.0, f64::max);
    values.iter().filter(|&&value| value > HELD * largest).count()
}

/// Static flexibility of the elastic modes and the residual, between pairs and, in the last row, at the
/// driving point per force of a pair. The residual has no guides.
fn elastic_flexibility(modes: &ComponentModes) -> Mat<f64> {
    let (n, contacts) = (pairs(modes), modes.interfaces());
    Mat::from_fn(n + 1, n, |row, column| {
        let shape = |mode: &NormalMode| if row < n { closure(mode, row) } else { mode.drive };
        let elastic = modes.modes().iter().filter(|mode| mode.angular_frequency > 0.0);
        let kept: f64 = elastic
            .map(|mode| shape(mode) * closure(mode, column) / mode.angular_frequency.powi(2))
            .sum();
        let residual = modes.residual();
        kept + if column >= contacts {
            0.0
        } else if row == n {
            residual.drive[column]
        } else {
            residual.closure.get(row).map_or(0.0, |flexibilities| flexibilities[column])
        }
    })
}

/// Receptances of the modes and the residual flexibility; the displacement observed is that of the
/// driving point.
impl LinearSystem for PreloadedStructure<ComponentModes> {
    fn interfaces(&self) -> usize {
        self.component_modes().interfaces()
    }

    fn guides(&self) -> &[Guide] {
        self.guides()
    }

    fn compliance(&self, w: f64, anti_damping: f64, into: &mut Compliance) {
        if !self.damped_modes().is_empty() {
            let free = vec![Complex64::ZERO; into.interfaces()];
            return self.compliance_on_springs(w, anti_damping, &free, into);
        }
        plain_compliance(self, w, anti_damping, into);
    }

    fn compliance_on_springs(
        &self,
        w: f64,
        anti_damping: f64,
        springs: &[Complex64],
        into: &mut Compliance,
    ) {
        if self.damped_modes().is_empty() {
            plain_compliance(self, w, anti_damping, into);
            return into.add_springs(springs);
        }
        let at = (w, self.damping_rate(), anti_damping);
        modal_damping::write(self.damped_modes(), self.contacts(), at, springs, into, |k, into| {
            plain_compliance(self, w, anti_damping, into);
            into.add_springs(k);
        });
    }

    /// Rigid motions carry no mean force, `phi_rigid . P0 = 0`; across them the closures are
    /// elastic, `N^T (X0 + G P0) = 0` with N orthogonal to the rigid closures.
    fn mean_balance(&self) -> MeanBalance {
        let modes = self.component_modes();
        let n = pairs(modes);
        let rigid = rigid_modes(modes);
        let elastic = elastic_flexibility(modes);
        let mut balance = MeanBalance {
            closure: vec![0.0; n * n],
            force: vec![0.0; n * n],
            output_closure: vec![0.0; n],
            output_force: (0..n).map(|i| -elastic[(n, i)]).collect(),
        };
        let closures = rigid_closures(modes);
        let Ok(svd) = Svd::new(closures.as_ref()) else {
            return balance;
        };
        let (left, held) = (svd.U(), held(&closures));
        for row in 0..n {
            for column in 0..n {
                if row < held {
                    balance.force[row * n + column] = left[(column, row)];
                } else {
                    balance.closure[row * n + column] = left[(column, row)];
                    balance.force[row * n + column] =
                        (0..n).map(|i| left[(i, row)] * elastic[(i, column)]).sum();
                }
            }
        }
        if !rigid.is_empty() && held == rigid.len() {
            // The rigid motions from the closures, Phi q = X0 + G P0, by least squares.
            let squares = closures.transpose() * &closures;
            let drive = Mat::from_fn(rigid.len(), 1, |r, _| rigid[r].drive);
            let weights = &closures * squares.partial_piv_lu().solve(&drive);
            for i in 0..n {
                balance.output_closure[i] = weights[(i, 0)];
                balance.output_force[i] +=
                    (0..n).map(|row| weights[(row, 0)] * elastic[(row, i)]).sum::<f64>();
            }
        }
        balance
    }

    fn lowest_modes(&self, _count: usize) -> Result<ComponentModes, HarmonicError> {
        Ok(self.component_modes().clone())
    }

    fn mass_damping(&self) -> f64 {
        self.damping_rate()
    }

    fn damped_modes(&self) -> &[DampedMode] {
        self.damped_modes()
    }

    fn check(&self) -> Result<(), HarmonicError> {
        let closures = rigid_closures(self.component_modes());
        let (free, held) = (closures.ncols(), held(&closures));
        if held < free { Err(HarmonicError::Floating { free, held }) } else { Ok(()) }
    }
}

/// The receptances without the dampers of linearised modes.
fn plain_compliance(
    structure: &PreloadedStructure<ComponentModes>,
    w: f64,
    anti_damping: f64,
    into: &mut Compliance,
) {
    let (n, pairs) = (structure.component_modes().interfaces(), pairs(structure.component_modes()));
    let residual = structure.component_modes().residual();
    let constant =
        |value| Receptance { value: Complex64::new(value, 0.0), ..Receptance::default() };
    into.clear();
    for row in 0..n {
        for column in 0..n {
            *into.contact_mut(row, column) = constant(residual.closure[row][column]);
        }
        *into.drive_mut(row) = constant(residual.drive[row]);
    }
    into.direct = constant(residual.driving_point);
    for mode in structure.component_modes().modes() {
        let mass = if mode.massless { 0.0 } else { 1.0 };
        let rate = mode.total_damping(structure.damping_rate()) - mass * anti_damping;
        let square = mode.angular_frequency.powi(2);
        let value = Complex64::new(square - mass * w * w, w * rate).inv();
        let modal = Receptance {
            value,
            d_frequency: -value * value * Complex64::new(-2.0 * mass * w, rate),
            d_anti_damping: value * value * Complex64::new(0.0, mass * w),
        };
        for row in 0..pairs {
            for column in 0..pairs {
                let factor = closure(mode, row) * closure(mode, column);
                into.contact_mut(row, column).add(&modal, factor);
            }
            into.drive_mut(row).add(&modal, closure(mode, row) * mode.drive);
        }
        into.direct.add(&modal, mode.drive * mode.drive);
    }
}
