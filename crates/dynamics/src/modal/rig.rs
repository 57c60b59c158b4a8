//! A structure with its contacts, and what is prepared of it once for many hits.

use std::collections::HashMap;
use std::f64::consts::TAU;
use std::sync::{Arc, Mutex, PoisonError};

use asperity_law::{CompiledLaw, ContactLaw, LawError};
use asperity_mesh::{ModalStructure, ModeCount, Stack};
use faer::{Mat, Side};

use super::model::StepModel;
use crate::{DynamicsError, Equilibrium, StaticContact};

/// Largest error of a tabulated pressure, as a share of the static pressure: a hundredth of what
/// the step itself errs at its default length.
const TABLE_TOLERANCE: f64 = 1e-5;

/// How much more that error may be where a table cannot hold it: laws that stiffen without bound.
const TOLERANCES: [f64; 3] = [1.0, 10.0, 100.0];

/// Entries of a rig's cache beyond which it starts anew.
const MOST_PREPARED: usize = 64;

/// One interface: what the integrator needs to know of it.
#[derive(Debug, Clone)]
pub struct ModalContact {
    /// Name, for messages.
    pub name: String,
    /// Nominal contact area \[m2\].
    pub area: f64,
    /// The contact law.
    pub law: Arc<dyn ContactLaw>,
    /// State at rest.
    pub at_rest: StaticContact,
}

/// A modal structure, its contacts at rest, and its mass-proportional damping.
///
/// Tables and step coefficients are prepared on demand and kept, so hits that differ only in
/// their force share them. What a hit answers does not depend on which hits came before.
#[derive(Debug)]
pub struct ModalRig {
    structure: ModalStructure,
    contacts: Vec<ModalContact>,
    rate: f64,
    natural: Option<f64>,
    prepared: Mutex<HashMap<(u64, i32), Arc<Prepared>>>,
}

/// A rig for one step length, its laws tabulated up to some pressure.
#[derive(Debug)]
pub(super) struct Prepared {
    pub(super) model: StepModel,
    pub(super) tables: Vec<Arc<CompiledLaw>>,
    /// Pressure \[Pa\] at which each table ends.
    pub(super) tops: Vec<f64>,
    /// Newton correction at each interface, in cells, below which the tangent stands for the law.
    pub(super) tolerances: Vec<f64>,
}

impl ModalRig {
    /// A rig from any modal structure, its `contacts` from the top down, and the
    /// mass-proportional damping `rate` \[1/s\].
    ///
    /// # Errors
    /// [`DynamicsError::Setting`] when there are not as many contacts as the structure has
    /// interfaces, more than 16, or a rate that is negative or not finite.
    pub fn new(
        structure: ModalStructure,
        contacts: Vec<ModalContact>,
        rate: f64,
    ) -> Result<Self, DynamicsError> {
        let (count, expected) = (contacts.len(), structure.interfaces());
        if count != expected || !(1..=super::block::MOST_INTERFACES).contains(&count) {
            return Err(DynamicsError::Setting {
                quantity: "number of contacts of a modal structure",
                value: count as f64,
                accepted: "one for each interface, 1 to 16 (finite differences take more)",
            });
        }
        if !(rate.is_finite() && rate >= 0.0) {
            let quantity = "damping rate [1/s]";
            let accepted = "finite and not negative";
            return Err(DynamicsError::Setting { quantity, value: rate, accepted });
        }
        let natural = natural_frequency(&structure, &contacts);
        let prepared = Mutex::default();
        Ok(Self { structure, contacts, rate, natural, prepared })
    }

    /// The rig of a `stack` at its `equilibrium`.
    ///
    /// # Errors
    /// Those of [`new`](Self::new), and [`DynamicsError::Mesh`] for a count of modes out of range.
    pub fn of_stack(
        stack: &Stack,
        equilibrium: &Equilibrium,
        rate: f64,
        modes: ModeCount,
    ) -> Result<Self, DynamicsError> {
        Self::of_parts(ModalStructure::of_stack(stack, modes)?, stack, equilibrium, rate)
    }

    /// The rig of a `stack` with a count of modes, the rigid one included, of each body.
    ///
    /// # Errors
    /// Those of [`of_stack`](Self::of_stack).
    pub fn with_counts(
        stack: &Stack,
        equilibrium: &Equilibrium,
        rate: f64,
        counts: &[usize],
    ) -> Result<Self, DynamicsError> {
        Self::of_parts(ModalStructure::with_counts(stack, counts)?, stack, equilibrium, rate)
    }

    fn of_parts(
        structure: ModalStructure,
        stack: &Stack,
        equilibrium: &Equilibrium,
        rate: f64,
    ) -> Result<Self, DynamicsError> {
        let named = stack.interfaces().iter().zip(equilibrium.contacts());
        let contacts = named.map(|(interface, &at_rest)| ModalContact {
            name: interface.name().to_owned(),
            area: interface.area(),
            law: Arc::clone(interface.law()),
            at_rest,
        });
        Self::new(structure, contacts.collect(), rate)
    }

    /// The contacts, from the top down.
    pub fn contacts(&self) -> &[ModalContact] {
        &self.contacts
    }

    /// The structure between the contacts.
    pub fn structure(&self) -> &ModalStructure {
        &self.structure
    }

    /// Mass-proportional damping h \[1/s\].
    pub fn rate(&self) -> f64 {
        self.rate
    }

    /// Lowest natural frequency linearised at rest \[Hz\], of the modes kept; none without stiffness.
    pub fn natural_frequency(&self) -> Option<f64> {
        self.natural
    }

    /// The rig for steps of `step` \[s\], its tables reaching `2^reach` \[Pa\] above rest.
    ///
    /// # Errors
    /// [`DynamicsError::Law`] when a law cannot be tabulated that far.
    pub(super) fn prepare(&self, step: f64, reach: i32) -> Result<Arc<Prepared>, DynamicsError> {
        let key = (step.to_bits(), reach);
        // A thread that panicked elsewhere leaves whole entries behind.
        let mut cache = self.prepared.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(found) = cache.get(&key) {
            return Ok(Arc::clone(found));
        }
        let of_reach = cache.iter().find(|((_, other), _)| *other == reach);
        let (tables, tops) = match of_reach {
            Some((_, found)) => (found.tables.clone(), found.tops.clone()),
            None => self.compile(reach)?,
        };
        let areas: Vec<f64> = self.contacts.iter().map(|contact| contact.area).collect();
        let named = self.contacts.iter().zip(&tops);
        let stiffest: Vec<f64> = named
            .map(|(contact, &top)| contact.law.stiffness(top).max(contact.at_rest.stiffness))
            .collect();
        let model = StepModel::new(&self.structure, &areas, &stiffest, self.rate, step);
        let tolerances = tables.iter().map(|table| tolerance(table)).collect();
        let prepared = Arc::new(Prepared { model, tables, tops, tolerances });
        if cache.len() >= MOST_PREPARED {
            cache.clear();
        }
        cache.insert(key, Arc::clone(&prepared));
        Ok(prepared)
    }

    fn compile(&self, reach: i32) -> Result<(Vec<Arc<CompiledLaw>>, Vec<f64>), DynamicsError> {
        let mut tables = Vec::with_capacity(self.contacts.len());
        let mut tops = Vec::with_capacity(self.contacts.len());
        for contact in &self.contacts {
            let state = contact.at_rest.pressure;
            let top = state + f64::from(reach).exp2();
            let compile =
                |times| CompiledLaw::uniform(&contact.law, state, top, times * TABLE_TOLERANCE);
            let mut table = compile(TOLERANCES[0]);
            for times in &TOLERANCES[1..] {
                if !matches!(table, Err(LawError::Unresolved { .. })) {
                    break;
                }
                table = compile(*times);
                tracing::warn!(
                    interface = contact.name,
                    share_of_static_pressure = times * TABLE_TOLERANCE,
                    "the law is too steep for its table, which is coarser than usual"
                );
            }
            let named = |source| DynamicsError::Law { interface: contact.name.clone(), source };
            tables.push(Arc::new(table.map_err(named)?));
            tops.push(top);
        }
        Ok((tables, tops))
    }
}

/// Newton correction, in cells, below which the tangent stands for the law.
///
/// A correction `x` leaves an error of pressure `p'' x^2 / 2`; it may be as large as the table's
/// own. The steepest tenth of the cells, those next to a singular loss of contact, do not count:
/// there a correction is larger than this anyway, and is followed by another.
fn tolerance(table: &CompiledLaw) -> f64 {
    let cells = table.cells().iter().skip(1);
    let mut bends: Vec<f64> =
        cells.map(|[_, _, c2, c3]| (2.0 * c2).abs().max((2.0 * c2 + 6.0 * c3).abs())).collect();
    let tenth = bends.len() * 9 / 10;
    let steep = match bends.get(tenth) {
        Some(_) => *bends.select_nth_unstable_by(tenth, f64::total_cmp).1,
        None => 0.0,
    };
    let bound = table.error_estimate().max(TABLE_TOLERANCE * table.pressure_state().abs());
    (2.0 * bound / steep).sqrt().clamp(0.05, 4.0)
}

/// The lowest frequency of `w^2 + G (1/k + R)^-1 G^T`, contacts being springs k.
fn natural_frequency(structure: &ModalStructure, contacts: &[ModalContact]) -> Option<f64> {
    let modes = structure.oscillators();
    let n = contacts.len();
    let springs: Vec<f64> = contacts.iter().map(|c| c.at_rest.stiffness * c.area).collect();
    if springs.iter().any(|&k| k <= 0.0 || !k.is_finite()) {
        return None;
    }
    let flexibility = Mat::from_fn(n, n, |i, j| {
        structure.residual().closure[i][j] + if i == j { 1.0 / springs[i] } else { 0.0 }
    });
    let shapes = Mat::from_fn(n, modes.len(), |i, m| modes[m].closure[i]);
    let forces = {
        use faer::linalg::solvers::Solve;
        flexibility.partial_piv_lu().solve(&shapes)
    };
    let coupled = shapes.transpose() * &forces;
    let stiffness = Mat::from_fn(modes.len(), modes.len(), |a, b| {
        let own = if a == b { modes[a].angular_frequency.powi(2) } else { 0.0 };
        own + 0.5 * (coupled[(a, b)] + coupled[(b, a)])
    });
    let squares = stiffness.self_adjoint_eigenvalues(Side::Lower).ok()?;
    let lowest = squares.first().copied().filter(|square| *square > 0.0)?;
    Some(lowest.sqrt() / TAU)
}
