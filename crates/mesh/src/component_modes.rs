//! Component modes: free-interface normal modes with residual flexibility.

use crate::error::{MeshError, not_negative};
use crate::mode_count::{checked_count, first_frequency};
use crate::{ModeCount, Stack, Support};

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
    /// Shape at the driving point \[kg^-1/2\].
    pub drive: f64,
    /// Shape at the output \[kg^-1/2\].
    pub output: f64,
    /// Shape of each contact pair's closure, upper face less lower face \[kg^-1/2\].
    pub closure: Vec<f64>,
    /// Shape of the displacement in each guide with friction \[kg^-1/2\]. Modes left out are taken
    /// not to move there.
    pub guide: Vec<f64>,
}

impl NormalMode {
    /// A rigid motion under mass-proportional damping, of shape `drive` at the driving point, which
    /// is also the output, and `closure` at the contact pairs \[kg^-1/2\].
    pub fn rigid(drive: f64, closure: Vec<f64>) -> Self {
        Self::elastic(0.0, drive, closure)
    }

    /// A mode of `angular_frequency` \[rad/s\] under mass-proportional damping, of shape `drive` at
    /// the driving point, which is also the output, and `closure` at the contact pairs \[kg^-1/2\].
    pub fn elastic(angular_frequency: f64, drive: f64, closure: Vec<f64>) -> Self {
        Self {
            angular_frequency,
            mass_damped: true,
            damping_rate: 0.0,
            massless: false,
            drive,
            output: drive,
            closure,
            guide: Vec::new(),
        }
    }

    /// Damping rate of the mode \[1/s\] under the mass-proportional damping `mass_damping` \[1/s\].
    pub fn total_damping(&self, mass_damping: f64) -> f64 {
        self.damping_rate + if self.mass_damped { mass_damping } else { 0.0 }
    }
}

/// Static flexibility of the modes left out \[m/N\].
///
/// Sources: R. H. MacNeal, Comput. Struct. 1971, 1, 581, doi 10.1016/0045-7949(71)90031-9;
/// S. Rubin, AIAA J. 1975, 13, 995, doi 10.2514/3.60497.
#[derive(Debug, Clone, PartialEq)]
pub struct ResidualFlexibility {
    /// Closure of pair i per contact force at pair j: row i, column j.
    pub closure: Vec<Vec<f64>>,
    /// Closure of each pair per drive force.
    pub drive: Vec<f64>,
    /// Output per contact force at each pair.
    pub output: Vec<f64>,
    /// Output per drive force.
    pub direct: f64,
    /// Displacement of the driving point per drive force.
    pub driving_point: f64,
}

impl ResidualFlexibility {
    /// No flexibility between `interfaces` contact pairs: no mode is left out.
    pub fn zero(interfaces: usize) -> Self {
        Self {
            closure: vec![vec![0.0; interfaces]; interfaces],
            drive: vec![0.0; interfaces],
            output: vec![0.0; interfaces],
            direct: 0.0,
            driving_point: 0.0,
        }
    }

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

/// Free-interface normal modes and residual flexibility of a structure with open contacts.
///
/// Between its contacts a structure is linear. Expanded in mass-normalised modes `n` of the parts
/// taken apart (contacts open), under a drive force `f` and contact forces `F_j` beyond those at
/// rest,
///
/// ```text
/// q_n'' + c_n q_n' + w_n^2 q_n = b_n f - sum_j g_nj F_j
/// closure_i = sum_n g_ni q_n + r_i f - sum_j R_ij F_j
/// output    = sum_n o_n q_n + r_o f - sum_j s_j F_j
/// ```
///
/// with the residual flexibilities `R`, `r`, `s` of all modes left out; a massless mode lacks the term
/// `q_n''`. The modes come from bars in
/// closed form, from [matrices](ComponentModes::from_matrices), or from elsewhere.
///
/// ```
/// use asperity_mesh::{ComponentModes, NormalMode, ResidualFlexibility};
///
/// // A mass of 4 kg on one contact.
/// let mass = NormalMode::rigid(0.5, vec![0.5]);
/// let modes = ComponentModes::new(vec![mass], ResidualFlexibility::zero(1))?;
/// assert_eq!(modes.interfaces(), 1);
/// # Ok::<(), asperity_mesh::MeshError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ComponentModes {
    modes: Vec<NormalMode>,
    residual: ResidualFlexibility,
}

impl ComponentModes {
    /// A structure from its modes and residual flexibility.
    ///
    /// # Errors
    /// [`MeshError::ModalSize`] when a row has not one entry per interface;
    /// [`MeshError::GuideCount`] when modes have differently many guides;
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
        let guides = modes.first().map_or(0, |mode| mode.guide.len());
        if let Some(mode) = modes.iter().find(|mode| mode.guide.len() != guides) {
            return Err(MeshError::GuideCount { found: mode.guide.len(), guides });
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
    /// `(-1)^n sqrt(2 / m)`, and `sqrt(1 / m)` for n = 0. Each body with friction has a guide, from the
    /// top down, whose displacement is the mean of the bar's: that of its rigid mode. The flexibility of all elastic modes is
    /// `L / (3 E A)` at a face and `-L / (6 E A)` across.
    ///
    /// With the retardation time b of a body its modes have the damping rate `b w_n^2` of their own, and
    /// the flexibility left out is that of two massless modes, one symmetric and one antisymmetric, of
    /// the same retardation time. A loss factor is replaced by viscous damping of the same ratio at
    /// each mode, `eta w_n`; its flexibility left out has no loss.
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
        let mut residual = ResidualFlexibility::zero(interfaces);
        let guided: Vec<usize> =
            (0..stack.bodies().len()).filter(|&i| stack.bodies()[i].friction().is_some()).collect();
        for (i, body) in stack.bodies().iter().enumerate() {
            let count = counts.get(i).copied().unwrap_or(0);
            let kept = checked_count(body, count)?;
            let first = first_frequency(body);
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
                // The mean displacement of an elastic mode of a free bar is zero.
                let mean = |&body: &usize| if body == i && n == 0 { shape } else { 0.0 };
                let guide = guided.iter().map(mean).collect();
                let mode = NormalMode::elastic(w, at_top, closure);
                let damping_rate = w * body.damping().loss(w);
                modes.push(NormalMode { damping_rate, guide, ..mode });
            }
            let time = body.damping().retardation_time().unwrap_or(0.0);
            if time > 0.0 {
                // Both ends move alike in even modes and against each other in odd ones.
                for (flexibility, sign) in
                    [(0.5 * (same + across), 1.0), (0.5 * (same - across), -1.0)]
                {
                    let w = kept as f64 * first;
                    let shape = w * flexibility.max(0.0).sqrt();
                    let mut closure = vec![0.0; interfaces];
                    closure[i] = sign * shape;
                    if i > 0 {
                        closure[i - 1] = -shape;
                    }
                    let mode = NormalMode::elastic(w, if i == 0 { shape } else { 0.0 }, closure);
                    let damping_rate = time * w * w;
                    modes.push(NormalMode {
                        mass_damped: false,
                        damping_rate,
                        massless: true,
                        guide: vec![0.0; guided.len()],
                        ..mode
                    });
                }
                continue;
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
                massless: false,
                drive: 0.0,
                output: 0.0,
                closure,
                guide: vec![0.0; guided.len()],
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

    /// Number of guides with friction.
    pub fn guides(&self) -> usize {
        self.modes.first().map_or(0, |mode| mode.guide.len())
    }

    /// Number of interfaces.
    pub fn interfaces(&self) -> usize {
        self.residual.closure.len()
    }
}
