//! A preloaded structure in component modes as a linear system.

use asperity_mesh::{ComponentModes, MeshError, NormalMode, PortPair};
use asperity_structure::{DampedMode, Guide, PreloadedStructure, StructureError};
use faer::Mat;
use faer::linalg::solvers::Svd;
use num_complex::Complex64;

use crate::modal_damping;
use crate::{Compliance, Dual, HarmonicError, LinearSystem, MeanBalance, SystemPort};

/// Part of the largest singular value below which a rigid motion is not held by contacts: rounding of matrices of 14
/// digits leaves closures of some 1e-8 in motions that have none.
const HELD: f64 = 1e-7;

/// The pairs, and the ports as pairs with the ground.
pub(crate) fn places(modes: &ComponentModes, ports: &[SystemPort]) -> Vec<PortPair> {
    let place = |port: &SystemPort| match *port {
        SystemPort::Number(port) => PortPair::on_ground(port),
        // The closure of a port with itself: it does not move.
        SystemPort::Stack(_) => PortPair::between(0, 0),
    };
    modes.pairs().iter().copied().chain(ports.iter().map(place)).collect()
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

/// The rigid motions that close some pair: with the singular value decomposition `Phi = U S V^T` of the closures
/// of the rigid modes, those along the leading columns of V. The others move without any force of the contacts.
struct HeldMotions {
    svd: Svd<f64>,
    count: usize,
}

impl HeldMotions {
    fn new(closures: &Mat<f64>) -> Option<Self> {
        let svd = Svd::new(closures.as_ref()).ok()?;
        let count = held(&svd);
        Some(Self { svd, count })
    }

    /// `Phi^+T` times the participations of some ports, a column each: the factors of the closures in the
    /// ports' displacements.
    fn weights(&self, shapes: &Mat<f64>) -> Mat<f64> {
        let (u, values, v) = (self.svd.U(), self.svd.S().column_vector(), self.svd.V());
        let along = v.transpose() * shapes;
        let scaled = Mat::from_fn(self.count, shapes.ncols(), |r, p| along[(r, p)] / values[r]);
        u.get(.., ..self.count) * scaled
    }
}

/// The rigid motions of component modes, those that close some pair first.
pub(crate) struct RigidMotions {
    pub(crate) modes: Vec<NormalMode>,
    /// Number of those that close some pair.
    pub(crate) held: usize,
}

impl RigidMotions {
    pub(crate) fn of(all: &ComponentModes) -> Self {
        let rigid = rigid_modes(all);
        let closures = rigid_closures(all);
        let own = || Self { modes: rigid.iter().copied().cloned().collect(), held: rigid.len() };
        // The turns of the columns alone are needed, but of all.
        let full = closures.nrows() < closures.ncols();
        let svd = if full { Svd::new(closures.as_ref()) } else { Svd::new_thin(closures.as_ref()) };
        let Ok(svd) = svd else { return own() };
        let right = svd.V();
        let turned = |r: usize| {
            let port = |port| (0..rigid.len()).map(|m| right[(m, r)] * rigid[m].ports[port]).sum();
            NormalMode { ports: (0..all.ports()).map(port).collect(), ..rigid[r].clone() }
        };
        Self { modes: (0..rigid.len()).map(turned).collect(), held: held(&svd) }
    }
}

/// Number of the singular values of rigid closures that are not rounding.
fn held(svd: &Svd<f64>) -> usize {
    let values = svd.S().column_vector();
    let largest = values.iter().copied().fold(0.0, f64::max);
    values.iter().filter(|&&value| value > HELD * largest).count()
}

/// Static flexibility of the elastic modes and the residual at `places`, per force of a pair.
fn elastic_flexibility(modes: &ComponentModes, places: &[PortPair]) -> Mat<f64> {
    let pairs = modes.pairs();
    Mat::from_fn(places.len(), pairs.len(), |row, column| {
        let (a, b) = (places[row], pairs[column]);
        let elastic = modes.modes().iter().filter(|mode| mode.angular_frequency > 0.0);
        let kept =
            |mode: &NormalMode| mode.closure(a) * mode.closure(b) / mode.angular_frequency.powi(2);
        modes.residual().closure(a, b) + elastic.map(kept).sum::<f64>()
    })
}

/// Receptances of the modes and the residual flexibility.
impl LinearSystem for PreloadedStructure<ComponentModes> {
    fn interfaces(&self) -> usize {
        self.component_modes().contacts().len()
    }

    fn guides(&self) -> &[Guide] {
        self.guides()
    }

    fn check_port(&self, port: SystemPort) -> Result<(), HarmonicError> {
        let ports = self.component_modes().ports();
        match port {
            SystemPort::Number(port) if port >= ports => {
                Err(StructureError::from(MeshError::NoPort { port, ports }).into())
            }
            SystemPort::Number(_) => Ok(()),
            SystemPort::Stack(_) => Err(HarmonicError::ForeignPort { port }),
        }
    }

    fn compliance(
        &self,
        at: (f64, f64),
        ports: &[SystemPort],
        springs: &[Complex64],
        into: &mut Compliance,
    ) {
        let on_springs = |springs: &[Complex64], into: &mut Compliance| {
            plain_compliance(self, at, ports, into);
            into.add_springs(springs);
        };
        if self.damped_modes().is_empty() {
            return on_springs(springs, into);
        }
        let of_port = |mode: &DampedMode, port: usize| match ports[port] {
            SystemPort::Number(number) => mode.ports[number],
            SystemPort::Stack(_) => 0.0,
        };
        let damped = (self.damped_modes(), self.contacts(), self.damping_rate());
        modal_damping::write(damped, at, springs, into, of_port, on_springs);
    }

    /// Rigid motions carry no mean force, `phi_rigid . P0 = 0`; across them the closures are
    /// elastic, `N^T (X0 + G P0) = 0` with N orthogonal to the rigid closures.
    fn mean_balance(&self, ports: &[SystemPort]) -> MeanBalance {
        let modes = self.component_modes();
        let n = modes.pairs().len();
        let rigid = rigid_modes(modes);
        let places = places(modes, ports);
        let elastic = elastic_flexibility(modes, &places);
        let entries = n * ports.len();
        let mut balance = MeanBalance {
            closure: vec![0.0; n * n],
            force: vec![0.0; n * n],
            port_closure: vec![0.0; entries],
            port_force: (0..entries).map(|at| -elastic[(n + at / n, at % n)]).collect(),
        };
        let Some(motions) = HeldMotions::new(&rigid_closures(modes)) else { return balance };
        let (left, held) = (motions.svd.U(), motions.count);
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
        // The rigid motions from the closures, Phi q = X0 + G P0; those that close nothing stay at rest.
        let shapes = Mat::from_fn(rigid.len(), ports.len(), |r, p| rigid[r].closure(places[n + p]));
        let weights = motions.weights(&shapes);
        for at in 0..entries {
            let (p, i) = (at / n, at % n);
            balance.port_closure[at] = weights[(i, p)];
            balance.port_force[at] +=
                (0..n).map(|row| weights[(row, p)] * elastic[(row, i)]).sum::<f64>();
        }
        balance
    }

    /// Rigid motions that close no contact are left out: no contact force changes them.
    fn lowest_modes(&self, count: usize) -> Result<ComponentModes, HarmonicError> {
        let all = self.component_modes();
        let RigidMotions { mut modes, held } = RigidMotions::of(all);
        modes.truncate(held);
        modes.extend(all.modes().iter().filter(|mode| mode.angular_frequency > 0.0).cloned());
        let guides = all.guides().iter().map(|guide| guide.upper).collect();
        let (residual, contacts) = (all.residual().clone(), all.contacts().to_vec());
        let modes = ComponentModes::new(modes, residual, contacts, guides);
        Ok(modes.map_err(StructureError::from)?.with_inertia_of(held + count))
    }

    fn as_component_modes(&self) -> Option<&ComponentModes> {
        let plain = self.damped_modes().is_empty() && self.guides().is_empty();
        plain.then(|| self.component_modes())
    }

    fn mass_damping(&self) -> f64 {
        self.damping_rate()
    }

    fn damped_modes(&self) -> &[DampedMode] {
        self.damped_modes()
    }
}

/// The receptances without the dampers of linearised modes.
fn plain_compliance(
    structure: &PreloadedStructure<ComponentModes>,
    at: (f64, f64),
    ports: &[SystemPort],
    into: &mut Compliance,
) {
    let modes = structure.component_modes();
    let places = places(modes, ports);
    for (row, &a) in places.iter().enumerate() {
        for (column, &b) in places.iter().enumerate().skip(row) {
            let left_out = modes.residual().closure(a, b);
            into.set(row, column, Dual::constant(left_out.into()));
        }
    }
    let mut participations = Vec::with_capacity(places.len());
    for mode in modes.modes() {
        participations.clear();
        participations.extend(places.iter().map(|&place| mode.closure(place)));
        let mass = if mode.massless { 0.0 } else { 1.0 };
        let (square, rate) = (mode.angular_frequency.powi(2), structure.damping_rate());
        let stiffness = Dual::oscillator((square, mass, mode.total_damping(rate)), at);
        into.add(&participations, &stiffness.inverse());
    }
}
