//! A preloaded structure in component modes as a linear system.

use asperity_mesh::{ComponentModes, NormalMode, PortPair};
use asperity_structure::{DampedMode, Guide, PreloadedStructure};
use faer::Mat;
use faer::linalg::solvers::{Solve, Svd};
use num_complex::Complex64;

use crate::modal_damping;
use crate::{Compliance, HarmonicError, LinearSystem, MeanBalance, Receptance};

/// Part of the largest singular value below which a rigid motion is not held by contacts.
const HELD: f64 = 1e-9;

/// Contact pairs, guides, and the load.
fn places(modes: &ComponentModes) -> Vec<PortPair> {
    modes.pairs().iter().copied().chain([PortPair::on_ground(0)]).collect()
}

fn rigid_modes(modes: &ComponentModes) -> Vec<&NormalMode> {
    modes.modes().iter().filter(|mode| mode.angular_frequency == 0.0).collect()
}

/// Closures of the rigid modes, a column each.
fn rigid_closures(modes: &ComponentModes) -> Mat<f64> {
    let rigid = rigid_modes(modes);
    let pairs = modes.pairs();
    Mat::from_fn(pairs.len(), rigid.len(), |i, r| rigid[r].closure(pairs[i]))
}

/// Number of independent rigid motions that close some contact.
fn held(closures: &Mat<f64>) -> usize {
    let values = closures.singular_values().unwrap_or_default();
    let largest = values.iter().copied().fold(0.0, f64::max);
    values.iter().filter(|&&value| value > HELD * largest).count()
}

/// Static flexibility of the elastic modes and the residual, between all places per force of a pair.
fn elastic_flexibility(modes: &ComponentModes) -> Mat<f64> {
    let (places, pairs) = (places(modes), modes.pairs());
    Mat::from_fn(places.len(), pairs.len(), |row, column| {
        let (a, b) = (places[row], pairs[column]);
        let elastic = modes.modes().iter().filter(|mode| mode.angular_frequency > 0.0);
        let kept =
            |mode: &NormalMode| mode.closure(a) * mode.closure(b) / mode.angular_frequency.powi(2);
        modes.residual().closure(a, b) + elastic.map(kept).sum::<f64>()
    })
}

/// Receptances of the modes and the residual flexibility; the displacement observed is that of the
/// driving point.
impl LinearSystem for PreloadedStructure<ComponentModes> {
    fn interfaces(&self) -> usize {
        self.component_modes().contacts().len()
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
        let n = modes.pairs().len();
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
            let drive = Mat::from_fn(rigid.len(), 1, |r, _| rigid[r].ports[0]);
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
    let modes = structure.component_modes();
    let places = places(modes);
    let load = places.len() - 1;
    let constant =
        |value| Receptance { value: Complex64::new(value, 0.0), ..Receptance::default() };
    into.clear();
    for (row, &a) in places.iter().enumerate() {
        for (column, &b) in places.iter().enumerate() {
            let left_out = constant(modes.residual().closure(a, b));
            if row == load && column == load {
                into.direct = left_out;
            } else if column == load {
                *into.drive_mut(row) = left_out;
            } else if row < load {
                *into.contact_mut(row, column) = left_out;
            }
        }
    }
    for mode in modes.modes() {
        let mass = if mode.massless { 0.0 } else { 1.0 };
        let rate = mode.total_damping(structure.damping_rate()) - mass * anti_damping;
        let square = mode.angular_frequency.powi(2);
        let value = Complex64::new(square - mass * w * w, w * rate).inv();
        let modal = Receptance {
            value,
            d_frequency: -value * value * Complex64::new(-2.0 * mass * w, rate),
            d_anti_damping: value * value * Complex64::new(0.0, mass * w),
        };
        let drive = mode.ports[0];
        for row in 0..load {
            for column in 0..load {
                let factor = mode.closure(places[row]) * mode.closure(places[column]);
                into.contact_mut(row, column).add(&modal, factor);
            }
            into.drive_mut(row).add(&modal, mode.closure(places[row]) * drive);
        }
        into.direct.add(&modal, drive * drive);
    }
}
