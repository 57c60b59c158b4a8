//! A preloaded structure in modes, prepared once for many cases.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

use asperity_law::{CompiledLaw, Friction};
use asperity_mesh::{ComponentModes, MeshError, Port};
use asperity_structure::{Guide, LoadCase, PreloadedContact, PreloadedStructure};

use super::damped_table::{DampedTable, stiffness_in_step};
use super::decimation::Decimation;
use super::law_tables::{table, top};
use super::linear_tail::LinearTail;
use super::row_modes::RowModes;
use super::simd::table_lookup::TableRow;
use super::step_coefficients::StepCoefficients;
use super::step_model::{InterpolationChoice, StepModel};
use crate::DynamicsError;
use crate::error::check_modal_damping;

/// Most interfaces that the vector kernel couples.
pub(super) const MOST_INTERFACES: usize = 16;

/// Entries of the caches beyond which they are emptied.
const MOST_TABULATED: usize = 64;
const MOST_TAILS: usize = 8;

/// A preloaded structure in component modes, with what its steps need.
///
/// Tables and step coefficients are prepared on demand and kept, so cases that differ only in
/// their force share them. The response to a case does not depend on earlier cases.
#[derive(Debug)]
pub struct ModalModel {
    structure: PreloadedStructure<ComponentModes>,
    /// The modes in the rows of a step.
    rows: RowModes,
    /// Ports of the component modes that are loaded and read.
    at: (usize, Vec<usize>),
    /// Port of the stack that the load acts on; none for component modes.
    port: Option<Port>,
    prepared: Mutex<Prepared>,
    step_coefficients: Mutex<KnownCoefficients>,
}

/// Tabulated models by the bits of their step and of the error of their tables, the exponents of these, and
/// interpolation.
type Prepared = HashMap<([u64; 2], Vec<i32>, InterpolationChoice), Arc<TabulatedModel>>;

/// Coefficients of steps of their own by the bits of the step and the exponents of the tables.
type KnownCoefficients = HashMap<(u64, Vec<i32>), Arc<StepCoefficients>>;

/// A model for one step length, with its laws tabulated up to some pressure.
#[derive(Debug)]
pub(super) struct TabulatedModel {
    pub(super) step_model: StepModel,
    pub(super) tables: Vec<Arc<CompiledLaw>>,
    /// Their error, as a share of the static pressures.
    pub(super) table_tolerance: f64,
    /// Newton correction at each row, in cells, below which the law is replaced by its tangent.
    pub(super) tolerances: Vec<f64>,
    /// Of every contact if one is damped or there is friction, else none.
    pub(super) damped: Vec<DampedTable>,
    tails: Mutex<Vec<KnownTail>>,
}

/// The rest of responses of so many steps after the first `from`, or that there is none.
#[derive(Debug)]
struct KnownTail {
    sensor: usize,
    from: usize,
    steps: usize,
    decimation: Arc<Decimation>,
    tail: Option<Arc<LinearTail>>,
}

/// Table of a guide, where there is no pressure, and its cells per metre.
const NO_PRESSURE: [TableRow; 1] = [[0.0; 4]];
const GUIDE_CELLS_PER_METRE: f64 = 1e9;

impl TabulatedModel {
    /// Cells of the law of row `i`, a contact or a guide.
    pub(super) fn cells(&self, i: usize) -> &[TableRow] {
        self.tables.get(i).map_or(&NO_PRESSURE, |table| table.cells())
    }

    /// Cells per closure of row `i` \[1/m\].
    pub(super) fn cells_per_metre(&self, i: usize) -> f64 {
        let scale = |table: &Arc<CompiledLaw>| table.scales()[1].cells_per_metre;
        self.tables.get(i).map_or(GUIDE_CELLS_PER_METRE, scale)
    }

    /// The cell of row `i` that begins at rest.
    pub(super) fn cell_at_rest(&self, i: usize) -> f64 {
        self.tables.get(i).map_or(0.0, |table| table.scales()[1].offset)
    }

    /// The rest of responses of `steps` steps after the first `from`, if there is one.
    pub(super) fn linear_tail(
        &self,
        sensor: usize,
        (from, steps): (usize, usize),
        decimation: &Arc<Decimation>,
    ) -> Option<Arc<LinearTail>> {
        let mut tails = self.tails.lock().unwrap_or_else(PoisonError::into_inner);
        let same = |known: &&KnownTail| {
            (known.sensor, known.from, known.steps) == (sensor, from, steps)
                && known.decimation == *decimation
        };
        if let Some(known) = tails.iter().find(same) {
            return known.tail.clone();
        }
        let tail =
            LinearTail::new(&self.step_model, &self.tables, sensor, (from, steps), decimation)
                .map(Arc::new);
        if tails.len() >= MOST_TAILS {
            tails.clear();
        }
        let decimation = Arc::clone(decimation);
        tails.push(KnownTail { sensor, from, steps, decimation, tail: tail.clone() });
        tail
    }
}

impl ModalModel {
    /// A model of a stack with this count of modes of each body, the rigid one included, under a load at the port `load`, read at the
    /// ports `sensors`.
    ///
    /// # Errors
    /// As [`new`](Self::new), and [`DynamicsError::Structure`] for a number of modes or a port
    /// out of range.
    pub fn of_stack(
        structure: &PreloadedStructure,
        counts: &[usize],
        load: Port,
        sensors: &[Port],
    ) -> Result<Self, DynamicsError> {
        let ports: Vec<Port> = [load].iter().chain(sensors).copied().collect();
        let sensors: Vec<usize> = (1..ports.len()).collect();
        let model = Self::new(structure.reduced_to(counts, &ports)?, 0, &sensors)?;
        Ok(Self { port: Some(load), ..model })
    }

    /// A model of any structure in component modes, under a load at its port `load`, read at its
    /// ports `sensors`.
    ///
    /// # Errors
    /// [`DynamicsError::Setting`] for more than 16 contacts, [`DynamicsError::ModalDamping`] for ratios
    /// of modes, [`DynamicsError::Mesh`] for a port that does not exist.
    pub fn new(
        structure: PreloadedStructure<ComponentModes>,
        load: usize,
        sensors: &[usize],
    ) -> Result<Self, DynamicsError> {
        check_modal_damping(&structure)?;
        let ports = structure.component_modes().ports();
        if let Some(&port) = [load].iter().chain(sensors).find(|&&port| port >= ports) {
            return Err(MeshError::NoPort { port, ports }.into());
        }
        let rows = RowModes::new(structure.component_modes(), load, sensors);
        let count = structure.contacts().len() + structure.guides().len();
        if count > MOST_INTERFACES {
            return Err(DynamicsError::Setting {
                quantity: "number of contacts and guides of a modal structure",
                value: count as f64,
                accepted: "1 to 16 (finite differences take more)",
            });
        }
        if let Some(open) = structure.contacts().iter().find(|contact| contact.gap() > 0.0) {
            return Err(DynamicsError::OpenAtRest { contact: open.name().to_owned() });
        }
        let at = (load, sensors.to_vec());
        Ok(Self {
            structure,
            rows,
            at,
            port: None,
            prepared: Mutex::default(),
            step_coefficients: Mutex::default(),
        })
    }

    /// The model of `structure`, which has the same ports, under a load at the same port and read at the
    /// same sensors.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn with_structure(
        &self,
        structure: PreloadedStructure<ComponentModes>,
    ) -> Result<Self, DynamicsError> {
        let (load, sensors) = &self.at;
        Ok(Self { port: self.port, ..Self::new(structure, *load, sensors)? })
    }

    /// The structure with its contacts and damping.
    pub fn preloaded(&self) -> &PreloadedStructure<ComponentModes> {
        &self.structure
    }

    /// The contacts, in the order of the structure's.
    pub fn contacts(&self) -> &[PreloadedContact] {
        self.structure.contacts()
    }

    /// True if a contact is damped, or there is friction.
    pub(super) fn is_dissipative(&self) -> bool {
        let damped = self.contacts().iter().any(|contact| contact.damping().is_some());
        damped || self.structure.friction().is_some()
    }

    /// Number of sensors.
    pub fn sensors(&self) -> usize {
        self.rows.residual.sensors.len()
    }

    /// Refuses a load that is out of range or acts elsewhere than on the port of the model, and a
    /// sensor that the model does not have.
    pub(super) fn check(&self, load: &LoadCase, sensor: usize) -> Result<(), DynamicsError> {
        load.check()?;
        if self.port.is_some_and(|port| port != load.port()) {
            return Err(DynamicsError::LoadPort);
        }
        if sensor >= self.sensors() {
            let sensors = self.sensors();
            return Err(DynamicsError::NoSensor { sensor, sensors });
        }
        Ok(())
    }

    /// The modes in the rows of a step.
    pub(super) fn row_modes(&self) -> &RowModes {
        &self.rows
    }

    /// Number of rows: of contacts, and behind them of guides.
    pub(super) fn rows(&self) -> usize {
        self.rows.rows()
    }

    /// Area of row `i` \[m2\]; 1 for a guide, whose pressure is a force.
    pub(super) fn area(&self, i: usize) -> f64 {
        self.contacts().get(i).map_or(1.0, PreloadedContact::area)
    }

    /// The friction element of row `i`, and the contact that its coefficient is of.
    pub(super) fn friction(&self, i: usize) -> Option<(Friction, usize)> {
        if let Some(contact) = self.contacts().get(i) {
            return contact.friction().map(|friction| (friction, i));
        }
        let guide = |guide: &Guide| (guide.friction(), guide.contact());
        self.structure.guides().get(i - self.contacts().len()).map(guide)
    }

    /// The structure between the contacts.
    pub fn structure(&self) -> &ComponentModes {
        self.structure.component_modes()
    }

    /// Newton correction of row `i`, in cells, below which its law is replaced by its tangent.
    ///
    /// A correction that passes a kink of the friction leaves an error of the friction's stiffness times
    /// the correction. It may be as large as the error of the table of the contact that gives the scale.
    fn tolerance(&self, i: usize, tables: &[Arc<CompiledLaw>], of_tables: f64) -> f64 {
        let own = tables.get(i).map(|table| tolerance(table, of_tables));
        let Some((friction, contact)) = self.friction(i) else { return own.unwrap_or(1.0) };
        let contact = &self.contacts()[contact];
        let carried = contact.area() * contact.pressure();
        let scale = if carried > 0.0 { carried } else { friction.limit(0.0) };
        let cells =
            tables.get(i).map_or(GUIDE_CELLS_PER_METRE, |table| table.scales()[1].cells_per_metre);
        let kink = of_tables * scale / friction.stiffness() * cells;
        own.map_or(kink, |own| own.min(kink))
    }

    /// The tables of the laws up to `2^exponent` \[Pa\] above rest, whose errors are this share of the static pressures.
    ///
    /// # Errors
    /// [`DynamicsError::Law`] when a law cannot be tabulated that far.
    pub(super) fn tables(
        &self,
        exponents: &[i32],
        tolerance: f64,
    ) -> Result<Vec<Arc<CompiledLaw>>, DynamicsError> {
        let contacts = self.contacts().iter().zip(exponents);
        contacts.map(|(contact, &exponent)| table(contact, exponent, tolerance)).collect()
    }

    /// The coefficients of steps of their own of `step` \[s\], for tables up to `2^exponent` \[Pa\] above
    /// rest.
    pub(super) fn step_coefficients(&self, step: f64, exponents: &[i32]) -> Arc<StepCoefficients> {
        let mut known = self.step_coefficients.lock().unwrap_or_else(PoisonError::into_inner);
        if known.len() >= MOST_TABULATED {
            known.clear();
        }
        let found = known.entry((step.to_bits(), exponents.to_vec())).or_insert_with(|| {
            let (areas, stiffest) = self.stiffest(step, exponents);
            let rate = self.structure.damping_rate();
            Arc::new(StepCoefficients::new(&self.rows, &areas, &stiffest, rate, step))
        });
        Arc::clone(found)
    }

    /// Areas of the rows \[m2\], and the highest stiffness expected at each in a step of `step` \[s\].
    fn stiffest(&self, step: f64, exponents: &[i32]) -> (Vec<f64>, Vec<f64>) {
        let areas: Vec<f64> = (0..self.rows()).map(|i| self.area(i)).collect();
        let named = self.contacts().iter().zip(exponents);
        let mut stiffest: Vec<f64> = named
            .map(|(contact, &exponent)| {
                let at = |pressure: f64| stiffness_in_step(contact, pressure, step);
                at(top(contact, exponent)).max(at(contact.pressure()))
            })
            .collect();
        stiffest.resize(areas.len(), 0.0);
        for (i, stiffness) in stiffest.iter_mut().enumerate() {
            *stiffness += self.friction(i).map_or(0.0, |(one, _)| one.stiffness() / areas[i]);
        }
        (areas, stiffest)
    }

    /// The model for steps of `step` \[s\], with the table of each contact up to `2^exponent` \[Pa\]
    /// above rest, whose error is this share of the static pressure, and a choice of interpolations.
    ///
    /// # Errors
    /// [`DynamicsError::Law`] when a law cannot be tabulated that far.
    pub(super) fn prepare(
        &self,
        step: f64,
        (exponents, table_tolerance): (&[i32], f64),
        interpolation: InterpolationChoice,
    ) -> Result<Arc<TabulatedModel>, DynamicsError> {
        let key = ([step, table_tolerance].map(f64::to_bits), exponents.to_vec(), interpolation);
        // A thread that panicked elsewhere leaves whole entries behind.
        let mut cache = self.prepared.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(found) = cache.get(&key) {
            return Ok(Arc::clone(found));
        }
        let tables = self.tables(exponents, table_tolerance)?;
        let (areas, stiffest) = self.stiffest(step, exponents);
        let rate = self.structure.damping_rate();
        let step_model = StepModel::new(&self.rows, &areas, &stiffest, rate, step, interpolation);
        let tolerance = |i| self.tolerance(i, &tables, table_tolerance);
        let tolerances = (0..self.rows()).map(tolerance).collect();
        let pairs = self.contacts().iter().zip(&tables);
        let damped = if self.is_dissipative() {
            pairs.map(|(contact, table)| DampedTable::new(contact, table, step)).collect()
        } else {
            Vec::new()
        };
        let tails = Mutex::default();
        let prepared =
            TabulatedModel { step_model, tables, table_tolerance, tolerances, damped, tails };
        let prepared = Arc::new(prepared);
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
    // Faces far apart are any distance from each other.
    let low = low.max(table.x_lo());
    let error = |sample: u32| {
        let closure = low + (high - low) * f64::from(sample) / f64::from(TABLE_SAMPLES);
        (table.get(closure) - law.pressure_increment(state, closure).value).abs()
    };
    (0..=TABLE_SAMPLES).map(error).fold(0.0, f64::max)
}

/// Newton correction, in cells, below which the law is replaced by its tangent.
///
/// A correction `x` leaves an error of pressure `p'' x^2 / 2`; it may be as large as the table's
/// own. The steepest tenth of the cells, those next to a singular loss of contact, do not count:
/// there a correction is larger than this anyway, and is followed by another.
fn tolerance(table: &CompiledLaw, of_tables: f64) -> f64 {
    let cells = table.cells().iter().skip(1);
    let mut bends: Vec<f64> =
        cells.map(|[_, _, c2, c3]| (2.0 * c2).abs().max((2.0 * c2 + 6.0 * c3).abs())).collect();
    let tenth = bends.len() * 9 / 10;
    let steep = match bends.get(tenth) {
        Some(_) => *bends.select_nth_unstable_by(tenth, f64::total_cmp).1,
        None => 0.0,
    };
    let bound = table.error_estimate().max(of_tables * table.pressure_state().abs());
    (2.0 * bound / steep).sqrt().clamp(0.05, 4.0)
}
