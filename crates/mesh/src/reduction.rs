//! Reduction of a sparse body to component modes.

mod dissection;
mod elimination_tree;
mod factor;
mod lanczos;
mod projection;
mod supernodes;

use faer::{Mat, Scale};

use crate::component_modes::massless_modes;
use crate::{ComponentModes, MeshError, NormalMode, PortPair, ResidualFlexibility, SparseBody};
use factor::Factor;

/// First shift over the typical square of a row's own frequency.
const FIRST_SHIFT: f64 = 1e-9;

/// The shift over the lowest elastic square, and the largest that is kept.
const SHIFT: f64 = 0.0025;
const LARGEST_SHIFT: f64 = 0.1;

/// Square over the typical one up to which a mode counts as rigid: rounding of matrices that are
/// written with 14 digits.
const RIGID: f64 = 1e-12;

/// Most modes of a body.
pub const MOST_REDUCED_MODES: usize = 2000;

/// Relative error of the series in the shift: with n terms, two at least, the nth power of the shift over the lowest
/// square left out.
const SERIES: f64 = 1e-12;

/// Part of a load outside the modes kept up to which it is rounding: of the weight of a free body, for example. Its flexibility would
/// be rounding too, out of proportion to the flexibility of other ports.
const OUTSIDE: f64 = 1e-9;

/// Ports whose flexibility is computed at once.
const AT_ONCE: usize = 64;

/// A port of a [`SparseBody`]: rows and their weights \[-\], a unit load pattern and the displacement
/// average that it works on.
pub type PortPattern = Vec<(usize, f64)>;

/// A body in its lowest free modes, with the flexibility of all others at ports.
///
/// ```text
/// K phi_n = w_n^2 M phi_n,    phi_n^T M phi_n = 1,
/// R_ab = sum over the modes left out of (b_a . phi_n) (b_b . phi_n) / w_n^2
/// ```
///
/// with the patterns `b_a` of ports. One factorisation `K + s M = L L^T` with a small shift `s` serves
/// the modes, by block Lanczos iteration, and the flexibility: the solutions for the ports without their
/// part along the modes kept are `sum phi_n phi_n^T b / (w_n^2 + s)`; as many terms of the series of
/// `1 / w_n^2` in `s` are taken as leave an error of at most 1e-12 of R.
///
/// Sources: R. H. MacNeal, Comput. Struct. 1971, 1, 581, doi 10.1016/0045-7949(71)90031-9;
/// S. Rubin, AIAA J. 1975, 13, 995, doi 10.2514/3.60497.
#[derive(Debug, Clone, PartialEq)]
pub struct ReducedBody {
    /// Angular frequencies \[rad/s\], lowest first; zero for rigid motions.
    pub angular_frequencies: Vec<f64>,
    /// Participation of each port \[kg^-1/2\], by modes.
    pub participations: Vec<Vec<f64>>,
    /// Flexibility between ports of the modes left out \[m/N\].
    pub residual: ResidualFlexibility,
}

impl ReducedBody {
    /// The `modes` lowest modes of `body`, and its rigid ones at least, with the residual flexibility of
    /// all others between `ports`.
    ///
    /// ```
    /// use asperity_mesh::{ReducedBody, SparseBody};
    /// use faer::sparse::{SparseColMat, Triplet};
    ///
    /// // Two masses of 1 kg joined by a spring of 200 N/m.
    /// let k = [(0, 0, 200.0), (1, 0, -200.0), (1, 1, 200.0)].map(|(i, j, v)| Triplet::new(i, j, v));
    /// let m = [(0, 0, 1.0), (1, 1, 1.0)].map(|(i, j, v)| Triplet::new(i, j, v));
    /// let k = SparseColMat::try_new_from_triplets(2, 2, &k).unwrap();
    /// let m = SparseColMat::try_new_from_triplets(2, 2, &m).unwrap();
    /// let body = SparseBody::new(k, m, Vec::new())?;
    ///
    /// let reduced = ReducedBody::new(&body, &[vec![(0, 1.0)]], 1)?;
    /// assert_eq!(reduced.angular_frequencies, [0.0]);
    /// // The mode left out has w^2 = 400 / s2 and 1 / sqrt(2 kg) at the port.
    /// assert!((reduced.residual.get(0, 0) - 0.5 / 400.0).abs() < 1e-14);
    /// # Ok::<(), asperity_mesh::MeshError>(())
    /// ```
    ///
    /// # Errors
    /// [`MeshError::DegreeOfFreedom`] for a port at a row that does not exist; [`MeshError::ModeCount`]
    /// for no modes, or more than [`MOST_REDUCED_MODES`]; [`MeshError::Matrix`] for a stiffness matrix
    /// with a negative eigenvalue, or with a motion that has neither stiffness nor mass, for matrices that are too large
    /// for the memory, or eigenvalues that do not converge.
    pub fn new(body: &SparseBody, ports: &[PortPattern], modes: usize) -> Result<Self, MeshError> {
        Self::with_shapes(body, ports, modes).map(|(reduced, _)| reduced)
    }

    /// As [`new`](Self::new), with shapes at all rows.
    ///
    /// # Errors
    /// Those of [`new`](Self::new).
    pub fn with_shapes(
        body: &SparseBody,
        ports: &[PortPattern],
        modes: usize,
    ) -> Result<(Self, RowShapes), MeshError> {
        let size = body.size();
        if let Some(&(dof, _)) = ports.iter().flatten().find(|(dof, _)| *dof >= size) {
            return Err(MeshError::DegreeOfFreedom { dof, size });
        }
        if !(1..=MOST_REDUCED_MODES).contains(&modes) {
            let body = "body of matrices".to_owned();
            return Err(MeshError::ModeCount { body, modes, limit: MOST_REDUCED_MODES });
        }
        let typical = body.typical_square();
        if typical.is_nan() || typical <= 0.0 {
            let problem = "zero, or without stiffness on its diagonal where there is mass";
            return Err(MeshError::Matrix { matrix: "stiffness or mass", problem });
        }
        let rigid = RIGID * typical;
        let mut shift = FIRST_SHIFT * typical;
        let mut factor = Factor::new(body, shift)?;
        let mut found = lanczos::lowest(body, &factor, (shift, rigid), modes)?;
        let elastic = found.squares.iter().copied().find(|square| *square > 0.0);
        if let Some(lowest) = elastic.filter(|lowest| shift > LARGEST_SHIFT * lowest) {
            // A shift far above the lowest mode separates the modes poorly.
            shift = (SHIFT * lowest).max(rigid);
            factor = Factor::new(body, shift)?;
            found = lanczos::lowest(body, &factor, (shift, rigid), modes)?;
        }
        let rigid_count = found.squares.iter().filter(|square| **square == 0.0).count();
        let kept = modes.max(rigid_count).min(found.squares.len());
        let shapes = found.shapes.subcols(0, kept).to_owned();
        let participations = participations(&shapes, ports);
        let squares = &found.squares[..kept];
        let of_shift = Shifted { body, factor: &factor, shift };
        // The modes left out are at least as high as the highest that was found.
        let least = found.squares.get(kept).or(squares.last()).copied().unwrap_or_default();
        let (residual, flexible) = of_shift.residual(ports, (&shapes, &participations), least)?;
        let angular_frequencies = squares.iter().map(|square| square.sqrt()).collect();
        let rows = RowShapes { modes: shapes, flexible };
        Ok((Self { angular_frequencies, participations, residual }, rows))
    }

    /// Number of rigid motions.
    pub fn rigid_count(&self) -> usize {
        self.angular_frequencies.iter().filter(|frequency| **frequency == 0.0).count()
    }

    /// The component modes of several bodies with `contacts` between `ports` ports of all of them; `places`
    /// of a body are the numbers of its own ports there. Under stiffness-proportional damping of
    /// `retardation_time` b \[s\] modes have the damping rate `b w^2` of their own, and the flexibility left
    /// out becomes massless modes of the same retardation time. Mass-proportional damping acts on all
    /// modes.
    ///
    /// # Errors
    /// Those of [`ComponentModes::new`]; [`MeshError::NoPort`] for a place that does not exist.
    pub fn joined(
        bodies: &[(&Self, &[usize])],
        ports: usize,
        retardation_time: f64,
        contacts: Vec<PortPair>,
    ) -> Result<ComponentModes, MeshError> {
        let mut modes = Vec::new();
        let mut residual = ResidualFlexibility::zero(ports);
        for (body, places) in bodies {
            if let Some(&port) = places.iter().find(|&&port| port >= ports) {
                return Err(MeshError::NoPort { port, ports });
            }
            for (&frequency, own) in body.angular_frequencies.iter().zip(&body.participations) {
                let mut participations = vec![0.0; ports];
                for (&port, &value) in places.iter().zip(own) {
                    participations[port] = value;
                }
                modes.push(NormalMode {
                    damping_rate: retardation_time * frequency * frequency,
                    ..NormalMode::elastic(frequency, participations)
                });
            }
            if retardation_time > 0.0 {
                let own = places.len();
                let matrix = Mat::from_fn(own, own, |a, b| body.residual.get(a, b));
                let highest = body.angular_frequencies.last().filter(|highest| **highest > 0.0);
                let w = highest.copied().unwrap_or(1.0 / retardation_time);
                modes.extend(massless_modes(&matrix, (places, ports), w, retardation_time));
                continue;
            }
            for (i, &a) in places.iter().enumerate() {
                for (j, &b) in places.iter().enumerate().skip(i) {
                    residual.add_between(a, b, body.residual.get(i, j));
                }
            }
        }
        ComponentModes::new(modes, residual, contacts, Vec::new())
    }
}

/// Shapes of a reduced body at all of its rows.
#[derive(Debug, Clone, PartialEq)]
pub struct RowShapes {
    /// Of the modes kept \[kg^-1/2\]: rows by modes.
    pub modes: Mat<f64>,
    /// Displacement of the modes left out per static force at each port \[m/N\]: rows by ports. Its relative error
    /// is at most the shift over the lowest square left out, some 1e-8.
    pub flexible: Mat<f64>,
}

/// Participation of each port, by modes.
fn participations(shapes: &Mat<f64>, ports: &[PortPattern]) -> Vec<Vec<f64>> {
    let along = |mode: usize, pattern: &PortPattern| -> f64 {
        pattern.iter().map(|&(row, weight)| weight * shapes[(row, mode)]).sum()
    };
    let of_mode = |mode: usize| ports.iter().map(|pattern| along(mode, pattern)).collect();
    (0..shapes.ncols()).map(of_mode).collect()
}

/// A body with the factor of its shifted stiffness.
struct Shifted<'a> {
    body: &'a SparseBody,
    factor: &'a Factor,
    shift: f64,
}

impl Shifted<'_> {
    /// Flexibility of the modes left out between ports, and at all rows per force at each, of squares from `least` \[1/s2\] on, beside the kept `shapes` with
    /// their `participations`.
    fn residual(
        &self,
        ports: &[PortPattern],
        (shapes, participations): (&Mat<f64>, &[Vec<f64>]),
        least: f64,
    ) -> Result<(ResidualFlexibility, Mat<f64>), MeshError> {
        let (size, count) = (self.body.size(), ports.len());
        // Solutions for the ports without the modes kept, which are taken off the loads: the shift makes
        // rigid motions large, and their rounding with them.
        let mut left = Mat::<f64>::zeros(size, count);
        for (column, pattern) in ports.iter().enumerate() {
            for &(row, weight) in pattern {
                left[(row, column)] += weight;
            }
        }
        let along = Mat::from_fn(shapes.ncols(), count, |mode, port| participations[mode][port]);
        let norm = |matrix: &Mat<f64>, port: usize| matrix.col(port).norm_l2();
        let loads: Vec<f64> = (0..count).map(|port| norm(&left, port)).collect();
        left -= self.body.mass_times(shapes.as_ref()) * along;
        let is_outside: Vec<bool> =
            (0..count).map(|port| norm(&left, port) > OUTSIDE * loads[port]).collect();
        for port in (0..count).filter(|&port| !is_outside[port]) {
            left.col_mut(port).fill(0.0);
        }
        self.factor.solve(&mut left);
        let clear = |vectors: &mut Mat<f64>| {
            let images = self.body.mass_times(vectors.as_ref());
            let along = projection::along(shapes.as_ref(), images.as_ref());
            projection::take_off(vectors.as_mut(), shapes.as_ref(), along.as_ref());
        };
        clear(&mut left);
        let read = |pattern: &PortPattern, column: usize| -> f64 {
            pattern.iter().map(|&(row, weight)| weight * left[(row, column)]).sum()
        };
        let ratio = self.shift / least;
        let terms_needed = (SERIES.ln() / ratio.ln()).ceil() as i32;
        // Of the symmetric terms the rows from the first column on.
        let mut rows = vec![vec![0.0; count]; count];
        for start in (0..count).step_by(AT_ONCE) {
            let columns = AT_ONCE.min(count - start);
            let mut images = self.body.mass_times(left.subcols(start, columns));
            let rest = left.subcols(start, count - start);
            let mut terms = projection::along(rest, images.as_ref()) * Scale(self.shift);
            // The first term is the solution itself, the second the one above.
            for power in 2..terms_needed {
                self.factor.solve(&mut images);
                clear(&mut images);
                images = self.body.mass_times(images.as_ref());
                terms += projection::along(rest, images.as_ref()) * Scale(self.shift.powi(power));
            }
            for column in 0..columns {
                for row in column..count - start {
                    let (a, b) = (start + row, start + column);
                    let mean = 0.5 * (read(&ports[a], b) + read(&ports[b], a));
                    rows[a][b] = mean + terms[(row, column)];
                    rows[b][a] = rows[a][b];
                }
            }
        }
        for (a, row) in rows.iter_mut().enumerate() {
            for (b, value) in row.iter_mut().enumerate() {
                if !(is_outside[a] && is_outside[b]) {
                    *value = 0.0;
                }
            }
        }
        Ok((ResidualFlexibility::from_rows(&rows)?, left))
    }
}
