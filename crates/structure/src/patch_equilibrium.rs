//! Nonlinear static equilibrium of any structure in component modes: the least potential energy.
//!
//! With the modal displacements `q`, the elastic ones of which store `w^2 q^2 / 2`, the flexibility of
//! the modes left out written as further modes, and closures `d = B q`, equilibrium is the minimum of
//!
//! ```text
//! U(q) = sum_n w_n^2 q_n^2 / 2 + sum_j A_j E_j(d_j - g_j) - f . q,    dE/dd = p(d),
//! ```
//!
//! with areas A, initial gaps g and static loads f. U is convex, since pressures grow with closures.
//! Newton steps, in which open contacts have a small stiffness, with a search along each step for
//! the place where U falls no more, find it from anywhere.

use std::sync::Arc;

use asperity_law::{ContactDamping, ContactLaw};
use asperity_mesh::component_modes::flexibility_factor;
use asperity_mesh::{ComponentModes, PortPair};
use faer::linalg::matmul::triangular::{BlockStructure, matmul};
use faer::linalg::solvers::Solve;
use faer::{Accum, Mat, MatMut, MatRef, Par, Side};

use crate::{PreloadedContact, StructureError};

/// A contact before the loads are on: its faces are `gap` \[m\] apart, or touch.
#[derive(Debug, Clone)]
pub struct UnloadedContact {
    /// Name, for messages and outputs.
    pub name: String,
    /// Area \[m2\].
    pub area: f64,
    /// Contact law.
    pub law: Arc<dyn ContactLaw>,
    /// Initial gap g \[m\]; negative for an interference.
    pub gap: f64,
    /// Viscous damping, if there is any.
    pub damping: Option<ContactDamping>,
}

/// Newton steps before the search is given up.
const MOST_STEPS: usize = 200;

/// Halvings and doublings of a step.
const MOST_SEARCHES: usize = 60;

/// Decrement of the energy by a step, over the work of the loads, at which the minimum is reached.
const REACHED: f64 = 1e-26;

/// Stiffness of an open contact in the Newton matrix, over the mean of all at the reference pressure.
const FLOOR: f64 = 1e-9;

/// Part of the largest singular value below which contacts do not hold a rigid motion. Rounding of matrices of 14 digits
/// leaves closures of some 1e-8 in motions that have none.
const HELD: f64 = 1e-7;

/// Part of the loads that may act along a motion without stiffness.
const UNBALANCED: f64 = 1e-6;

/// Pressure at which the first step is linearised if the loads do not give one \[Pa\].
const FIRST_PRESSURE: f64 = 1e5;

/// A structure at rest under static loads.
#[derive(Debug, Clone)]
pub struct StaticState {
    /// The contacts.
    pub contacts: Vec<PreloadedContact>,
    /// Displacement of each mode from the place without loads \[m kg^1/2\]; zero along motions that nothing holds.
    pub coordinates: Vec<f64>,
    /// Force at each port, of contacts and loads \[N\].
    pub port_forces: Vec<f64>,
}

impl StaticState {
    /// Static displacement of a port of `modes` \[m\].
    pub fn displacement(&self, modes: &ComponentModes, port: usize) -> f64 {
        let carried: f64 =
            modes.modes().iter().zip(&self.coordinates).map(|(mode, q)| mode.ports[port] * q).sum();
        let forces = self.port_forces.iter().enumerate().filter(|(_, force)| **force != 0.0);
        carried + forces.map(|(b, force)| modes.residual().get(port, b) * force).sum::<f64>()
    }
}

/// The `contacts` at rest under forces at ports of `modes`: port and force \[N\] each.
///
/// # Errors
/// Those of [`static_state`].
pub fn contacts_at_rest(
    modes: &ComponentModes,
    contacts: &[UnloadedContact],
    loads: &[(usize, f64)],
) -> Result<Vec<PreloadedContact>, StructureError> {
    Ok(static_state(modes, contacts, loads)?.contacts)
}

/// A structure at rest under forces at ports of `modes`: port and force \[N\] each.
///
/// Motions that neither stiffness nor contacts hold stay out if the loads do not act along them.
///
/// # Errors
/// [`StructureError::ContactCount`] unless there is one contact per pair, and at least one;
/// [`StructureError::NotHeld`] for loads that no contact carries;
/// [`StructureError::Setting`] and [`StructureError::NoEquilibrium`] as [`PreloadedContact::new`].
pub fn static_state(
    modes: &ComponentModes,
    contacts: &[UnloadedContact],
    loads: &[(usize, f64)],
) -> Result<StaticState, StructureError> {
    let pairs = modes.contacts();
    if contacts.len() != pairs.len() || contacts.is_empty() {
        return Err(StructureError::ContactCount { pairs: pairs.len(), contacts: contacts.len() });
    }
    let problem = EnergyProblem::new(modes, contacts, loads)?;
    let (place, closures) = problem.minimum()?;
    let at_rest = |(contact, closure): (&UnloadedContact, f64)| {
        let UnloadedContact { name, area, law, gap, damping } = contact;
        let law = Arc::clone(law);
        let closed = match law.domain().closure_lost {
            Some(lost) if closure - gap < lost => {
                PreloadedContact::open(name, *area, law, lost - (closure - gap))?
            }
            _ => {
                let pressure = law.pressure(closure - gap).value;
                PreloadedContact::new(name, *area, law, pressure)?
            }
        };
        Ok::<_, StructureError>(closed.with_damping(*damping))
    };
    let contacts: Vec<PreloadedContact> =
        contacts.iter().zip(closures).map(at_rest).collect::<Result<_, _>>()?;
    let mut port_forces = vec![0.0; modes.ports()];
    for &(port, force) in loads {
        port_forces[port] += force;
    }
    for (pair, contact) in pairs.iter().zip(&contacts) {
        let force = contact.area() * contact.pressure();
        port_forces[pair.upper] -= force;
        if let Some(lower) = pair.lower {
            port_forces[lower] += force;
        }
    }
    Ok(StaticState { contacts, coordinates: problem.coordinates(&place), port_forces })
}

/// The energy in coordinates with a diagonal elastic stiffness.
struct EnergyProblem<'a> {
    contacts: &'a [UnloadedContact],
    /// Elastic stiffness of each coordinate; zero for a rigid motion.
    stiffness: Vec<f64>,
    /// Mode of each elastic coordinate, and the rigid modes of which each of the others is a sum.
    modes: Vec<CoordinateModes>,
    /// Number of modes.
    count: usize,
    /// Closure of each contact per coordinate: a row a contact.
    closures: Mat<f64>,
    /// Static load along each coordinate.
    loads: Vec<f64>,
    /// Stiffness of an open contact in the Newton matrix \[N/m\].
    floor: f64,
    /// Pressure at which the first step is linearised \[Pa\].
    first_pressure: f64,
}

/// The lower triangle of `columns^T columns`, which a factorisation reads, into `square`: the block below the diagonal beside
/// the two blocks on it.
fn squared(columns: MatRef<'_, f64>, square: MatMut<'_, f64>) {
    let half = columns.ncols() / 2;
    let (left, right) = columns.split_at_col(half);
    let (upper_left, _, below, lower_right) = square.split_at_mut(half, half);
    let product = |to: MatMut<'_, f64>, shape, a: MatRef<'_, f64>, b: MatRef<'_, f64>| {
        let whole = BlockStructure::Rectangular;
        matmul(to, shape, Accum::Replace, a.transpose(), whole, b, whole, 1.0, Par::Seq);
    };
    let triangle = BlockStructure::TriangularLower;
    rayon::join(
        || {
            product(upper_left, triangle, left, left);
            product(lower_right, triangle, right, right);
        },
        || product(below, BlockStructure::Rectangular, right, left),
    );
}

/// Modes whose sum a coordinate is, with their shares; none for flexibility.
type CoordinateModes = Vec<(usize, f64)>;

impl<'a> EnergyProblem<'a> {
    fn new(
        modes: &ComponentModes,
        contacts: &'a [UnloadedContact],
        forces: &[(usize, f64)],
    ) -> Result<Self, StructureError> {
        let pairs = modes.contacts();
        let is_rigid = |number: &usize| modes.modes()[*number].angular_frequency == 0.0;
        let (rigid_numbers, elastic): (Vec<usize>, Vec<usize>) =
            (0..modes.modes().len()).partition(is_rigid);
        let rigid: Vec<_> = rigid_numbers.iter().map(|&number| &modes.modes()[number]).collect();
        let mut of_modes: Vec<CoordinateModes> = Vec::new();
        let along = |ports: &[f64]| -> f64 {
            forces.iter().map(|&(port, force)| ports[port] * force).sum()
        };
        let mut stiffness = Vec::new();
        let mut columns: Vec<Vec<f64>> = Vec::new();
        let mut loads = Vec::new();
        let rigid_closures =
            Mat::from_fn(pairs.len(), rigid.len(), |i, r| rigid[r].closure(pairs[i]));
        if !rigid.is_empty() {
            let rigid_loads: Vec<f64> = rigid.iter().map(|mode| along(&mode.ports)).collect();
            let size: f64 = rigid
                .iter()
                .map(|mode| {
                    let parts =
                        forces.iter().map(|&(port, force)| (mode.ports[port] * force).abs());
                    parts.sum::<f64>().powi(2)
                })
                .sum::<f64>()
                .sqrt();
            let svd = rigid_closures
                .svd()
                .map_err(|_| StructureError::Eigenvalues { size: rigid.len() })?;
            let values = svd.S().column_vector();
            let largest = if pairs.is_empty() { 0.0 } else { values[0] };
            for k in 0..rigid.len() {
                let turned = |of: &dyn Fn(usize) -> f64| -> f64 {
                    (0..rigid.len()).map(|r| svd.V()[(r, k)] * of(r)).sum()
                };
                let load = turned(&|r| rigid_loads[r]);
                if k < pairs.len() && values[k] > HELD * largest {
                    stiffness.push(0.0);
                    let shares = rigid_numbers.iter().enumerate();
                    of_modes.push(shares.map(|(r, &number)| (number, svd.V()[(r, k)])).collect());
                    columns.push(
                        (0..pairs.len()).map(|i| turned(&|r| rigid_closures[(i, r)])).collect(),
                    );
                    loads.push(load);
                } else if load.abs() > UNBALANCED * size {
                    return Err(StructureError::NotHeld { share: load.abs() / size });
                }
            }
        }
        for number in elastic {
            let mode = &modes.modes()[number];
            of_modes.push(vec![(number, 1.0)]);
            stiffness.push(mode.angular_frequency.powi(2));
            columns.push(pairs.iter().map(|&pair| mode.closure(pair)).collect());
            loads.push(along(&mode.ports));
        }
        for (column, load) in flexible_coordinates(modes, forces)? {
            stiffness.push(1.0);
            of_modes.push(Vec::new());
            columns.push(column);
            loads.push(load);
        }
        let closures = Mat::from_fn(pairs.len(), columns.len(), |i, k| columns[k][i]);
        let area: f64 = contacts.iter().map(|contact| contact.area).sum();
        let force: f64 = forces.iter().map(|(_, force)| force.abs()).sum();
        let mut first_pressure = force / area;
        if !(first_pressure.is_finite() && first_pressure > 0.0) {
            first_pressure = FIRST_PRESSURE;
        }
        let springs = contacts.iter().map(|one| one.area * one.law.stiffness(first_pressure));
        let floor = FLOOR * springs.sum::<f64>() / contacts.len() as f64;
        let count = modes.modes().len();
        let modes = of_modes;
        Ok(Self { contacts, stiffness, modes, count, closures, loads, floor, first_pressure })
    }

    /// Displacements of the modes at a place.
    fn coordinates(&self, place: &[f64]) -> Vec<f64> {
        let mut coordinates = vec![0.0; self.count];
        for (modes, value) in self.modes.iter().zip(place) {
            for &(number, share) in modes {
                coordinates[number] += share * value;
            }
        }
        coordinates
    }

    /// Place and closures \[m\] at the minimum of the energy.
    fn minimum(&self) -> Result<(Vec<f64>, Vec<f64>), StructureError> {
        let size = self.stiffness.len();
        let mut place = vec![0.0; size];
        let mut closures = vec![0.0; self.contacts.len()];
        let mut springs: Vec<f64> = self
            .contacts
            .iter()
            .map(|contact| contact.area * contact.law.stiffness(self.first_pressure))
            .collect();
        let mut gradient = self.gradient(&place, &closures);
        let mut weighted = self.closures.clone();
        let mut matrix = Mat::zeros(size, size);
        for _ in 0..MOST_STEPS {
            let step = self.newton_step(&springs, &gradient, (&mut weighted, &mut matrix))?;
            let decrement: f64 = step.iter().zip(&gradient).map(|(a, b)| -a * b).sum();
            let work: f64 = self.loads.iter().zip(&place).map(|(f, q)| (f * q).abs()).sum();
            let own: f64 = self.stiffness.iter().zip(&place).map(|(k, q)| k * q * q).sum::<f64>();
            if decrement <= REACHED * (work + own) {
                return Ok((place, closures));
            }
            let ahead = self.closures_of(&step);
            let length = self.search((&place, &step), (&closures, &ahead), -decrement)?;
            for (value, change) in place.iter_mut().zip(&step) {
                *value += length * change;
            }
            closures = self.closures_of(&place);
            gradient = self.gradient(&place, &closures);
            springs = self.springs(&closures);
        }
        Err(self.not_found(&closures))
    }

    /// `-H^-1 gradient` with the contacts as `springs` \[N/m\]; overwrites closures weighted by them, and H.
    fn newton_step(
        &self,
        springs: &[f64],
        gradient: &[f64],
        (weighted, matrix): (&mut Mat<f64>, &mut Mat<f64>),
    ) -> Result<Vec<f64>, StructureError> {
        let size = self.stiffness.len();
        let weights: Vec<f64> =
            springs.iter().map(|spring| spring.max(self.floor).sqrt()).collect();
        for (weighted, closures) in weighted.col_iter_mut().zip(self.closures.col_iter()) {
            for ((value, weight), closure) in weighted.iter_mut().zip(&weights).zip(closures.iter())
            {
                *value = weight * closure;
            }
        }
        squared(weighted.as_ref(), matrix.as_mut());
        for (k, stiffness) in self.stiffness.iter().enumerate() {
            matrix[(k, k)] += stiffness;
        }
        // Coordinates of one size, in which the factorisation is as precise as it can be.
        let scale: Vec<f64> = (0..size).map(|k| matrix[(k, k)].sqrt().recip()).collect();
        for j in 0..size {
            for i in j..size {
                matrix[(i, j)] *= scale[i] * scale[j];
            }
        }
        let right = Mat::from_fn(size, 1, |k, _| -scale[k] * gradient[k]);
        let failed = |_| StructureError::Eigenvalues { size };
        let solution = matrix.llt(Side::Lower).map_err(failed)?.solve(&right);
        Ok((0..size).map(|k| scale[k] * solution[(k, 0)]).collect())
    }

    /// Length along a step at which the energy falls no more, or less than a tenth as fast as at first.
    fn search(
        &self,
        (place, step): (&[f64], &[f64]),
        (closures, ahead): (&[f64], &[f64]),
        first: f64,
    ) -> Result<f64, StructureError> {
        let own: f64 = self.stiffness.iter().zip(step).map(|(k, s)| k * s * s).sum();
        let fixed: f64 = self
            .stiffness
            .iter()
            .zip(place)
            .zip(step.iter().zip(&self.loads))
            .map(|((k, q), (s, f))| (k * q - f) * s)
            .sum();
        let slope = |length: f64| -> f64 {
            let pressures = self.contacts.iter().zip(closures.iter().zip(ahead)).map(
                |(contact, (closure, change))| {
                    let at = closure + length * change - contact.gap;
                    contact.area * contact.law.pressure(at).value * change
                },
            );
            fixed + length * own + pressures.sum::<f64>()
        };
        let (mut low, mut high) = (0.0, f64::INFINITY);
        let mut length = 1.0;
        for _ in 0..MOST_SEARCHES {
            let at = slope(length);
            if at.abs() <= 0.1 * first.abs() {
                return Ok(length);
            }
            // Beyond a limit of closure the pressure is infinite.
            if at > 0.0 || at.is_nan() {
                high = length;
            } else {
                low = length;
            }
            length = if high.is_finite() { 0.5 * (low + high) } else { 2.0 * length };
        }
        if low > 0.0 { Ok(low) } else { Err(self.not_found(closures)) }
    }

    fn closures_of(&self, place: &[f64]) -> Vec<f64> {
        let place = Mat::from_fn(place.len(), 1, |k, _| place[k]);
        let product = &self.closures * place;
        (0..self.contacts.len()).map(|i| product[(i, 0)]).collect()
    }

    fn gradient(&self, place: &[f64], closures: &[f64]) -> Vec<f64> {
        let forces = Mat::from_fn(self.contacts.len(), 1, |i, _| {
            let contact = &self.contacts[i];
            contact.area * contact.law.pressure(closures[i] - contact.gap).value
        });
        let product = self.closures.transpose() * forces;
        let coordinates = self.stiffness.iter().zip(place).zip(&self.loads).enumerate();
        coordinates
            .map(|(k, ((stiffness, q), load))| stiffness * q - load + product[(k, 0)])
            .collect()
    }

    fn springs(&self, closures: &[f64]) -> Vec<f64> {
        let spring = |(contact, closure): (&UnloadedContact, &f64)| {
            let tangent = contact.law.pressure(closure - contact.gap).tangent;
            contact.area * if tangent.is_finite() { tangent } else { f64::MAX.sqrt() }
        };
        self.contacts.iter().zip(closures).map(spring).collect()
    }

    /// The error that names the contact with the largest pressure.
    fn not_found(&self, closures: &[f64]) -> StructureError {
        let pressures = self.contacts.iter().zip(closures).map(|(contact, closure)| {
            (contact.law.pressure(closure - contact.gap).value, contact.name.clone())
        });
        let (pressure_pa, interface) =
            pressures.max_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or_default();
        StructureError::NoEquilibrium { interface, pressure_pa }
    }
}

/// The residual flexibility as coordinates of unit stiffness: closures and load along each.
fn flexible_coordinates(
    modes: &ComponentModes,
    forces: &[(usize, f64)],
) -> Result<Vec<(Vec<f64>, f64)>, StructureError> {
    let pairs = modes.contacts();
    let places: Vec<PortPair> = pairs
        .iter()
        .copied()
        .chain(forces.iter().map(|&(port, _)| PortPair::on_ground(port)))
        .collect();
    let count = places.len();
    let residual = |i: usize, j: usize| modes.residual().closure(places[i], places[j]);
    let matrix = Mat::from_fn(count, count, residual);
    let factor = flexibility_factor(&matrix).ok_or(StructureError::Eigenvalues { size: count })?;
    let coordinate = |column: usize| {
        let at = |i: usize| factor[(i, column)];
        let load = forces.iter().enumerate().map(|(n, (_, force))| force * at(pairs.len() + n));
        ((0..pairs.len()).map(at).collect(), load.sum())
    };
    Ok((0..factor.ncols()).map(coordinate).collect())
}
