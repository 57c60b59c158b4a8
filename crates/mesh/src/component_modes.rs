//! Component modes: free-interface normal modes with residual flexibility at ports.

use faer::{Mat, Side};

use crate::PortPair;
use crate::error::{MeshError, not_negative};

/// One mass-normalised mode of a structure with open contacts.
#[derive(Debug, Clone, PartialEq)]
pub struct NormalMode {
    /// Angular frequency w \[rad/s\]; zero for a rigid motion.
    pub angular_frequency: f64,
    /// True if the mass-proportional damping h of the bodies acts on it.
    pub mass_damped: bool,
    /// Damping rate of its own \[1/s\], beyond mass-proportional damping.
    pub damping_rate: f64,
    /// True if its inertia is neglected, `c q' + w^2 q = force`: the damped flexibility of modes left
    /// out.
    pub massless: bool,
    /// Participation phi of each port: the shape there \[kg^-1/2\].
    pub ports: Vec<f64>,
}

impl NormalMode {
    /// A rigid motion under mass-proportional damping, with its participations \[kg^-1/2\].
    pub fn rigid(ports: Vec<f64>) -> Self {
        Self::elastic(0.0, ports)
    }

    /// A mode of `angular_frequency` \[rad/s\] under mass-proportional damping, with its
    /// participations \[kg^-1/2\].
    pub fn elastic(angular_frequency: f64, ports: Vec<f64>) -> Self {
        Self { angular_frequency, mass_damped: true, damping_rate: 0.0, massless: false, ports }
    }

    /// Damping rate of the mode \[1/s\] under the mass-proportional damping `mass_damping` \[1/s\].
    pub fn total_damping(&self, mass_damping: f64) -> f64 {
        self.damping_rate + if self.mass_damped { mass_damping } else { 0.0 }
    }

    /// Participation of the closure of a pair of ports \[kg^-1/2\].
    pub fn closure(&self, pair: PortPair) -> f64 {
        pair.closure(&self.ports)
    }
}

/// Static flexibility of the modes left out, between ports \[m/N\]: symmetric.
///
/// Sources: R. H. MacNeal, Comput. Struct. 1971, 1, 581, doi 10.1016/0045-7949(71)90031-9;
/// S. Rubin, AIAA J. 1975, 13, 995, doi 10.2514/3.60497.
#[derive(Debug, Clone, PartialEq)]
pub struct ResidualFlexibility {
    ports: usize,
    /// By rows.
    entries: Vec<f64>,
}

impl ResidualFlexibility {
    /// No flexibility between `ports` ports: no mode is left out.
    pub fn zero(ports: usize) -> Self {
        Self { ports, entries: vec![0.0; ports * ports] }
    }

    /// The flexibility given by its rows.
    ///
    /// # Errors
    /// [`MeshError::ModalSize`] for a row that has not one entry per port.
    pub fn from_rows(rows: &[Vec<f64>]) -> Result<Self, MeshError> {
        let ports = rows.len();
        match rows.iter().find(|row| row.len() != ports) {
            Some(row) => Err(MeshError::ModalSize { found: row.len(), ports }),
            None => Ok(Self { ports, entries: rows.concat() }),
        }
    }

    /// Number of ports.
    pub fn ports(&self) -> usize {
        self.ports
    }

    /// Displacement of port `a` per force at port `b` \[m/N\].
    pub fn get(&self, a: usize, b: usize) -> f64 {
        self.entries[a * self.ports + b]
    }

    /// Closure of pair `a` per force at pair `b`, which acts on both of its ports \[m/N\].
    pub fn closure(&self, a: PortPair, b: PortPair) -> f64 {
        let row = |port: usize| b.closure(&self.entries[port * self.ports..][..self.ports]);
        row(a.upper) - a.lower.map_or(0.0, row)
    }

    /// Adds `value` \[m/N\] between two ports, both ways.
    pub(crate) fn add_between(&mut self, a: usize, b: usize, value: f64) {
        self.entries[a * self.ports + b] += value;
        if a != b {
            self.entries[b * self.ports + a] += value;
        }
    }

    /// Adds the static flexibility of `mode`, which must not be rigid: the mode is left out then.
    pub fn add(&mut self, mode: &NormalMode) {
        let yielding = mode.angular_frequency.powi(-2);
        for (row, phi) in self.entries.chunks_exact_mut(self.ports.max(1)).zip(&mode.ports) {
            for (entry, other) in row.iter_mut().zip(&mode.ports) {
                *entry += phi * other * yielding;
            }
        }
    }
}

/// Part of the largest eigenvalue of a residual flexibility below which it is rounding.
const ROUNDING: f64 = 1e-13;

/// Eigenvalues of a flexibility whose ports are scaled to a flexibility of one, and shapes by columns, for which the
/// sum of eigenvalue times shape times shape is the flexibility; none without eigenvalues.
///
/// Ports may be means over cells and loads in newtons beside each other; and the eigenvalue algorithm loses
/// digits of numbers far below 1.
fn flexible_shapes(flexibility: &Mat<f64>) -> Option<(Vec<f64>, Mat<f64>)> {
    let (scaled, scale) = of_unit_diagonal(flexibility);
    let found = scaled.self_adjoint_eigen(Side::Lower).ok()?;
    let values = found.S().column_vector().iter().copied().collect();
    Some((values, Mat::from_fn(scale.len(), scale.len(), |i, k| scale[i] * found.U()[(i, k)])))
}

/// The flexibility with its ports scaled to a flexibility of one, and the factor of each; a port without flexibility
/// stays as it is.
fn of_unit_diagonal(flexibility: &Mat<f64>) -> (Mat<f64>, Vec<f64>) {
    let size = flexibility.nrows();
    let root = |i: usize| flexibility[(i, i)].max(0.0).sqrt();
    let scale: Vec<f64> = (0..size).map(root).collect();
    let over = |value: f64, by: f64| if by > 0.0 { value / by } else { 0.0 };
    let entry = |i: usize, j: usize| over(over(flexibility[(i, j)], scale[i]), scale[j]);
    (Mat::from_fn(size, size, entry), scale)
}

/// A matrix F with as many rows as the flexibility has ports, for which `F F^T` is the flexibility \[m/N\]; none without
/// eigenvalues.
///
/// Its columns are massless coordinates of unit stiffness. By Cholesky's factorisation, with 1e-13 of the flexibility of
/// each port added there, since smooth flexibilities of many ports are singular to rounding; by eigenvalues where that is
/// not positive definite, without the negative ones.
pub fn flexibility_factor(flexibility: &Mat<f64>) -> Option<Mat<f64>> {
    let (mut scaled, scale) = of_unit_diagonal(flexibility);
    let size = scale.len();
    for i in 0..size {
        scaled[(i, i)] += ROUNDING;
    }
    if let Ok(cholesky) = scaled.llt(Side::Lower) {
        let lower = cholesky.L();
        let entry = |i: usize, j: usize| if i < j { 0.0 } else { scale[i] * lower[(i, j)] };
        return Some(Mat::from_fn(size, size, entry));
    }
    let (values, shapes) = flexible_shapes(flexibility)?;
    let largest = values.iter().copied().fold(0.0, f64::max);
    let kept: Vec<usize> =
        (0..size).filter(|&k| values[k] > 1e-15 * largest && values[k] > 0.0).collect();
    Some(Mat::from_fn(size, kept.len(), |i, k| values[kept[k]].sqrt() * shapes[(i, kept[k])]))
}

/// Massless modes of the `flexibility` \[m/N\] between some `ports` of a number of them, one for each
/// of its eigenvectors, written with the angular frequency `w` \[rad/s\], for which any may be taken, under a
/// retardation time \[s\].
pub(crate) fn massless_modes(
    flexibility: &Mat<f64>,
    (ports, count): (&[usize], usize),
    w: f64,
    retardation_time: f64,
) -> Vec<NormalMode> {
    let Some((values, vectors)) = flexible_shapes(flexibility) else { return Vec::new() };
    let largest = values.iter().copied().fold(0.0, f64::max);
    let mode = |k: usize| {
        let mut participations = vec![0.0; count];
        for (i, &port) in ports.iter().enumerate() {
            participations[port] = w * values[k].sqrt() * vectors[(i, k)];
        }
        NormalMode {
            mass_damped: false,
            damping_rate: retardation_time * w * w,
            massless: true,
            ..NormalMode::elastic(w, participations)
        }
    };
    (0..ports.len()).filter(|&k| values[k] > ROUNDING * largest).map(mode).collect()
}

/// Static forces \[N\] at the ports of a structure under which the massless modes of one of its bodies have these
/// `coordinates`: `phi_n f = w_n^2 q_n`.
///
/// Modes left out of a body follow forces with one retardation time, so that they are always where these forces would
/// hold them. Modes as [`ReducedBody::joined`](crate::ReducedBody::joined) makes them, orthogonal in ports of unit
/// flexibility.
pub fn massless_forces(modes: &[&NormalMode], coordinates: &[f64]) -> Vec<f64> {
    let ports = modes.first().map_or(0, |mode| mode.ports.len());
    let squared = |mode: &NormalMode| mode.angular_frequency.powi(2);
    let flexibility = |port: usize| -> f64 {
        modes.iter().map(|mode| mode.ports[port].powi(2) / squared(mode)).sum()
    };
    let flexibilities: Vec<f64> = (0..ports).map(flexibility).collect();
    let mut forces = vec![0.0; ports];
    for (mode, q) in modes.iter().zip(coordinates) {
        let scaled = mode.ports.iter().zip(&flexibilities).filter(|(_, own)| **own > 0.0);
        let eigenvalue =
            scaled.map(|(shape, own)| shape * shape / own).sum::<f64>() / squared(mode);
        for ((force, shape), own) in forces.iter_mut().zip(&mode.ports).zip(&flexibilities) {
            if *own > 0.0 {
                *force += shape * q / (own * eigenvalue);
            }
        }
    }
    forces
}

/// Free-interface normal modes and residual flexibility of a structure with open contacts.
///
/// Between its contacts a structure is linear. Expanded in mass-normalised modes `n` of the parts
/// taken apart (contacts open), under forces `f_b` at [ports](crate::Port) `b`,
///
/// ```text
/// q_n'' + c_n q_n' + w_n^2 q_n = sum_b phi_nb f_b
/// u_a = sum_n phi_na q_n + sum_b R_ab f_b
/// ```
///
/// with the displacements `u_a` of ports and the residual flexibility `R` of all modes left out; a
/// massless mode lacks the term `q_n''`. Contacts join ports: the closure of a pair is `u_upper -
/// u_lower`, and its force F beyond that at rest acts with `-F` above and `F` below. Guides are
/// pairs with the ground. The modes come from bars in closed form, from
/// [matrices](ComponentModes::from_matrices), or from elsewhere; solvers see no difference.
///
/// ```
/// use asperity_mesh::{ComponentModes, NormalMode, PortPair, ResidualFlexibility};
///
/// // A mass of 4 kg on one contact; its one port is its displacement.
/// let mass = NormalMode::rigid(vec![0.5]);
/// let contacts = vec![PortPair::on_ground(0)];
/// let modes = ComponentModes::new(vec![mass], ResidualFlexibility::zero(1), contacts, vec![])?;
/// assert_eq!(modes.contacts().len(), 1);
/// # Ok::<(), asperity_mesh::MeshError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ComponentModes {
    modes: Vec<NormalMode>,
    residual: ResidualFlexibility,
    /// Contacts, and after them guides.
    pairs: Vec<PortPair>,
    contacts: usize,
}

impl ComponentModes {
    /// A structure from its modes, the residual flexibility, the pairs of ports that contacts join,
    /// and the ports that move in guides with friction.
    ///
    /// # Errors
    /// [`MeshError::ModalSize`] when a mode has not one participation per port;
    /// [`MeshError::NoPort`] for a contact or guide at a port that does not exist;
    /// [`MeshError::Negative`] for a frequency or rate that is negative or not finite.
    pub fn new(
        modes: Vec<NormalMode>,
        residual: ResidualFlexibility,
        contacts: Vec<PortPair>,
        guides: Vec<usize>,
    ) -> Result<Self, MeshError> {
        let ports = residual.ports;
        if let Some(mode) = modes.iter().find(|mode| mode.ports.len() != ports) {
            return Err(MeshError::ModalSize { found: mode.ports.len(), ports });
        }
        for mode in &modes {
            not_negative("mode", "angular frequency [rad/s]", mode.angular_frequency)?;
            not_negative("mode", "damping rate [1/s]", mode.damping_rate)?;
        }
        let count = contacts.len();
        let pairs = contacts.into_iter().chain(guides.into_iter().map(PortPair::on_ground));
        let pairs: Vec<PortPair> = pairs.collect();
        let used = pairs.iter().flat_map(|pair| [Some(pair.upper), pair.lower]).flatten();
        match used.max() {
            Some(port) if port >= ports => Err(MeshError::NoPort { port, ports }),
            _ => Ok(Self { modes, residual, pairs, contacts: count }),
        }
    }

    /// The same structure in which only the `count` lowest modes have inertia: the others become massless, or
    /// without damping a part of the flexibility left out. Rigid motions keep their inertia.
    #[must_use]
    pub fn with_inertia_of(&self, count: usize) -> Self {
        let mut inert: Vec<f64> = self
            .modes
            .iter()
            .filter(|mode| !mode.massless)
            .map(|mode| mode.angular_frequency)
            .collect();
        inert.sort_by(f64::total_cmp);
        let highest = inert.get(count.max(1) - 1).copied().unwrap_or(f64::INFINITY);
        let mut residual = self.residual.clone();
        let mut modes = Vec::with_capacity(self.modes.len());
        for mode in &self.modes {
            if mode.massless || mode.angular_frequency <= highest {
                modes.push(mode.clone());
            } else if mode.damping_rate > 0.0 {
                modes.push(NormalMode { massless: true, mass_damped: false, ..mode.clone() });
            } else {
                residual.add(mode);
            }
        }
        Self { modes, residual, ..self.clone() }
    }

    /// The modes.
    pub fn modes(&self) -> &[NormalMode] {
        &self.modes
    }

    /// The flexibility of the modes left out.
    pub fn residual(&self) -> &ResidualFlexibility {
        &self.residual
    }

    /// Number of ports.
    pub fn ports(&self) -> usize {
        self.residual.ports
    }

    /// The ports that contacts join.
    pub fn contacts(&self) -> &[PortPair] {
        &self.pairs[..self.contacts]
    }

    /// The displacements in guides with friction.
    pub fn guides(&self) -> &[PortPair] {
        &self.pairs[self.contacts..]
    }

    /// Contacts, and after them guides.
    pub fn pairs(&self) -> &[PortPair] {
        &self.pairs
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Massless modes that forces at ports hold tell these forces, as far as they move anything: the displacements that
    /// they give are the same. Four ports, the flexibility of three of which has rank two and that of one is zero, of units far apart.
    #[test]
    fn massless_modes_tell_the_forces_that_hold_them() {
        let columns = [[3e-9, 1e-9, 4e-6, 0.0], [1e-9, -2e-9, 5e-6, 0.0]];
        let flexibility =
            Mat::from_fn(4, 4, |i, j| columns.iter().map(|column| column[i] * column[j]).sum());
        let (w, held) = (3e4, [2.0, -7.0, 0.25, 40.0]);
        let modes = massless_modes(&flexibility, (&[4, 1, 2, 0], 6), w, 1e-5);
        assert_eq!(modes.len(), 2);
        let force_at = |port: usize| [4, 1, 2, 0].iter().position(|&own| own == port);
        let force_at = |port: usize| force_at(port).map_or(0.0, |place| held[place]);
        let coordinate = |mode: &NormalMode| {
            let work = mode.ports.iter().enumerate();
            work.map(|(port, shape)| shape * force_at(port)).sum::<f64>() / (w * w)
        };
        let coordinates: Vec<f64> = modes.iter().map(coordinate).collect();
        let all: Vec<&NormalMode> = modes.iter().collect();
        let found = massless_forces(&all, &coordinates);
        let found = [4, 1, 2, 0].map(|port| found[port]);
        assert_eq!(found[3], 0.0);
        for i in 0..4 {
            let [exact, by_found] = [held, found]
                .map(|forces| (0..4).map(|j| flexibility[(i, j)] * forces[j]).sum::<f64>());
            assert!((by_found - exact).abs() <= 1e-9 * exact.abs(), "{i}: {by_found:e} {exact:e}");
        }
    }
}
