//! A preloaded structure in modes, prepared once for many hits.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

use asperity_law::{CompiledLaw, LawError};
use asperity_mesh::ComponentModes;
use asperity_structure::{PreloadedContact, PreloadedStructure};

use super::damped_table::{DampedTable, stiffness_in_step};
use super::drive::DriveForce;
use super::step_model::{InterpolationChoice, StepModel};
use crate::DynamicsError;

/// Largest error of a tabulated pressure, as a share of the static pressure: a hundredth of
/// the error of the step at its default length.
const TABLE_TOLERANCE: f64 = 1e-5;

/// Fewest cells of the table of a damped contact: its coefficient may bend where the law is straight.
const DAMPED_CELLS: usize = 1024;

/// Factors on that error, tried in turn for laws that stiffen without bound.
const TOLERANCES: [f64; 3] = [1.0, 10.0, 100.0];

/// Most interfaces that the vector kernel couples.
pub(super) const MOST_INTERFACES: usize = 16;

/// Entries of the cache beyond which it is emptied.
const MOST_TABULATED: usize = 64;

/// A preloaded structure in component modes, with what its steps need.
///
/// Tables and step coefficients are prepared on demand and kept, so hits that differ only in
/// their force share them. The response to a hit does not depend on earlier hits.
#[derive(Debug)]
pub struct ModalModel {
    structure: PreloadedStructure<ComponentModes>,
    prepared: Mutex<Prepared>,
}

/// Tabulated models by the bits of their step, the exponents of their tables, and interpolation.
type Prepared = HashMap<(u64, Vec<i32>, InterpolationChoice), Arc<TabulatedModel>>;

/// A model for one step length, with its laws tabulated up to some pressure.
#[derive(Debug)]
pub(super) struct TabulatedModel {
    pub(super) step_model: StepModel,
    pub(super) tables: Vec<Arc<CompiledLaw>>,
    /// Newton correction at each interface, in cells, below which the law is replaced by its tangent.
    pub(super) tolerances: Vec<f64>,
    /// Of every contact if one is damped, else none.
    pub(super) damped: Vec<DampedTable>,
}

impl ModalModel {
    /// A model of any structure in component modes.
    ///
    /// # Errors
    /// [`DynamicsError::Setting`] for more than 16 contacts.
    pub fn new(structure: PreloadedStructure<ComponentModes>) -> Result<Self, DynamicsError> {
        let count = structure.contacts().len();
        if count > MOST_INTERFACES {
            return Err(DynamicsError::Setting {
                quantity: "number of contacts of a modal structure",
                value: count as f64,
                accepted: "1 to 16 (finite differences take more)",
            });
        }
        Ok(Self { structure, prepared: Mutex::default() })
    }

    /// The structure with its contacts and damping.
    pub fn preloaded(&self) -> &PreloadedStructure<ComponentModes> {
        &self.structure
    }

    /// The contacts, in the order of the structure's.
    pub fn contacts(&self) -> &[PreloadedContact] {
        self.structure.contacts()
    }

    /// True if a contact is damped.
    pub(super) fn is_damped(&self) -> bool {
        self.contacts().iter().any(|contact| contact.damping().is_some())
    }

    /// The structure between the contacts.
    pub fn structure(&self) -> &ComponentModes {
        self.structure.component_modes()
    }

    /// The model for steps of `step` \[s\], with the table of each contact up to `2^exponent` \[Pa\]
    /// above rest, and a choice of interpolations.
    ///
    /// # Errors
    /// [`DynamicsError::Law`] when a law cannot be tabulated that far.
    pub(super) fn prepare(
        &self,
        step: f64,
        exponents: &[i32],
        interpolation: InterpolationChoice,
    ) -> Result<Arc<TabulatedModel>, DynamicsError> {
        let key = (step.to_bits(), exponents.to_vec(), interpolation);
        // A thread that panicked elsewhere leaves whole entries behind.
        let mut cache = self.prepared.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(found) = cache.get(&key) {
            return Ok(Arc::clone(found));
        }
        let mut tables = Vec::with_capacity(exponents.len());
        let mut tops = Vec::with_capacity(exponents.len());
        for (i, (contact, &exponent)) in self.contacts().iter().zip(exponents).enumerate() {
            let known = cache.iter().find(|((_, others, _), _)| others.get(i) == Some(&exponent));
            tables.push(match known {
                Some((_, found)) => Arc::clone(&found.tables[i]),
                None => Arc::new(compile(contact, top(contact, exponent))?),
            });
            tops.push(top(contact, exponent));
        }
        let areas: Vec<f64> = self.contacts().iter().map(PreloadedContact::area).collect();
        let named = self.contacts().iter().zip(&tops);
        let stiffest: Vec<f64> = named
            .map(|(contact, &top)| {
                let at = |pressure: f64| stiffness_in_step(contact, pressure, step);
                at(top).max(at(contact.pressure()))
            })
            .collect();
        let step_model = StepModel::new(
            self.structure(),
            &areas,
            &stiffest,
            self.structure.damping_rate(),
            step,
            interpolation,
        );
        let tolerances = tables.iter().map(|table| tolerance(table)).collect();
        let pairs = self.contacts().iter().zip(&tables);
        let damped = if self.is_damped() {
            pairs.map(|(contact, table)| DampedTable::new(contact, table, step)).collect()
        } else {
            Vec::new()
        };
        let prepared = Arc::new(TabulatedModel { step_model, tables, tolerances, damped });
        if cache.len() >= MOST_TABULATED {
            cache.clear();
        }
        cache.insert(key, Arc::clone(&prepared));
        Ok(prepared)
    }
}

/// Closures at which the error of a table is found.
const TABLE_SAMPLES: u32 = 64;

/// Largest difference \[Pa\] between the table and the law of a contact between two pressures \[Pa\].
pub(super) fn table_error(
    contact: &PreloadedContact,
    table: &CompiledLaw,
    [lowest, highest]: [f64; 2],
) -> f64 {
    let (law, state) = (contact.law(), contact.pressure());
    let [low, high] =
        [lowest, highest].map(|pressure| law.closure_increment(state, pressure - state));
    let error = |sample: u32| {
        let closure = low + (high - low) * f64::from(sample) / f64::from(TABLE_SAMPLES);
        (table.get(closure) - law.pressure_increment(state, closure).value).abs()
    };
    (0..=TABLE_SAMPLES).map(error).fold(0.0, f64::max)
}

/// Pressure \[Pa\] at which the table of a contact ends.
fn top(contact: &PreloadedContact, exponent: i32) -> f64 {
    contact.pressure() + f64::from(exponent).exp2()
}

/// The table of a contact's law up to `top` \[Pa\]; coarser than usual for a law that is too steep.
fn compile(contact: &PreloadedContact, top: f64) -> Result<CompiledLaw, DynamicsError> {
    let least_cells = if contact.damping().is_some() { DAMPED_CELLS } else { 0 };
    let compile = |times| {
        let (pressures, tolerance) = ((contact.pressure(), top), times * TABLE_TOLERANCE);
        CompiledLaw::uniform_of(contact.law(), pressures, tolerance, least_cells)
    };
    let mut table = compile(TOLERANCES[0]);
    for times in &TOLERANCES[1..] {
        if !matches!(table, Err(LawError::Unresolved { .. })) {
            break;
        }
        table = compile(*times);
    }
    table.map_err(|source| DynamicsError::Law { interface: contact.name().to_owned(), source })
}

/// A hit with its model tabulated for its step, and its drive.
#[derive(Debug, Clone)]
pub(super) struct PreparedHit {
    pub(super) model: Arc<ModalModel>,
    pub(super) tabulated: Arc<TabulatedModel>,
    /// Force of unit peak step by step, shared by hits of one shape, and the factor on it.
    pub(super) drive: Arc<DriveForce>,
    pub(super) amplitude: f64,
    /// Steps to take.
    pub(super) steps: usize,
}

impl PreparedHit {
    /// Closure increment \[m\] at and below which contact `i` is lost; -inf if it never separates.
    pub(super) fn open_below(&self, i: usize) -> f64 {
        let contact = &self.model.contacts()[i];
        if !contact.law().domain().separates() {
            return f64::NEG_INFINITY;
        }
        contact.law().closure_increment(contact.pressure(), -contact.pressure())
    }
}

/// Newton correction, in cells, below which the law is replaced by its tangent.
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
