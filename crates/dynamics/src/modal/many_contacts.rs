//! Modal steps with many contacts, coupled by a dense flexibility.
//!
//! Modes move exactly under forces that are held within a step at the mean of both ends; motions without
//! inertia and the flexibility left out follow the force linearly. With the closures `x*` that the forces at
//! the old end alone would give, and the flexibility `G` of a step, the closures at its end obey
//!
//! ```text
//! x_i + sum_j G_ij A_j (p_j(x_j) - p_j0) = x*_i.
//! ```
//!
//! Newton steps take the forces of closed contacts as unknowns, `(1 / (A k) + G) f = r`, which is symmetric and
//! positive definite however stiff or soft the contacts are. Its factor is kept while stiffnesses change little.
//!
//! With damping a contact has the traction `p + dR/dt`, not below zero where its law separates, with the viscous impulse
//! `R = integral of c(p) dx` and its rate at the end of a step, of second order:
//!
//! ```text
//! dR/dt = (3 R - 4 R_0 + R_before) / (2 h).
//! ```
//!
//! R grows with x, so that the equations keep one solution. The mean of tractions of both ends acts on modes in a step: a linear
//! damper on a mass and a spring is stable at any step, as the roots of its difference equation show.

mod contact_factor;
mod contact_forces;
mod observation;
mod run_parts;

use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use asperity_mesh::ComponentModes;
use asperity_structure::{LoadCase, PreloadedContact, PreloadedStructure};
use faer::Mat;

use crate::contact_energy::excess;
use crate::error::{balanced, check_modal_damping};
use crate::run_bounds::check_many_contacts;
use crate::{DynamicsError, EnergyLedger, History, Sampling, Transient};
use contact_factor::{Work, dot, times};
use contact_forces::ContactForces;
pub use observation::{ContactsResponse, ContactsState};
use run_parts::{Extremes, Residual, SteppedMode};

/// Most contacts.
pub const MOST_CONTACTS: usize = 1000;

/// Newton steps within a step of time.
const MOST_ITERATIONS: usize = 60;

/// Residual of a closure over the largest so far at which the contact equations are solved, and the
/// closure, over the largest of static pressure over stiffness, that counts at least.
const SOLVED: f64 = 1e-11;
const LEAST: f64 = 1e-4;

/// Roundings of a viscous force that are no residual: impulses grow to some times their size at rest.
const ROUNDINGS: f64 = 100.0 * f64::EPSILON;

/// The same of the force at rest, from which forces are counted: a soft structure on stiff contacts moves by far more
/// under it than these close.
const ROUNDINGS_AT_REST: f64 = 4.0 * f64::EPSILON;

/// A structure in component modes with many contacts, under a load at one port, read at others.
///
/// ```
/// use std::sync::Arc;
///
/// use asperity_dynamics::{ManyContacts, Sampling};
/// use asperity_law::{ContactLaw, Power};
/// use asperity_mesh::{ComponentModes, NormalMode, PortPair, ResidualFlexibility};
/// use asperity_structure::{
///     Damping, LoadCase, PreloadedStructure, TimeFunction, UnloadedContact, contacts_at_rest,
/// };
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// // A mass of 4 kg on two contacts, pressed down by its weight at port 2.
/// let mass = NormalMode::rigid(vec![0.5, 0.5, 0.5]);
/// let pairs = vec![PortPair::on_ground(0), PortPair::on_ground(1)];
/// let modes = ComponentModes::new(vec![mass], ResidualFlexibility::zero(3), pairs, vec![])?;
/// let law: Arc<dyn ContactLaw> = Arc::new(Power::new(1e8, 0.5, 0.0)?);
/// let contact = |name: &str, gap: f64| UnloadedContact {
///     name: name.to_owned(), area: 1e-4, law: Arc::clone(&law), gap, damping: None,
/// };
/// let contacts = [contact("near", 0.0), contact("far", 1e-3)];
/// let at_rest = contacts_at_rest(&modes, &contacts, &[(2, 4.0 * 9.81)])?;
/// assert!(at_rest[1].gap() > 0.0);
///
/// let structure = PreloadedStructure::of_components(modes, at_rest, Damping::Rate(50.0))?;
/// let system = ManyContacts::new(Arc::new(structure), 2, vec![2])?;
/// let pulse = LoadCase::force(TimeFunction::Haversine { duration: 1e-3 }, 20.0);
/// let response = system.integrate(&pulse, &Sampling::new(0.05, 2e4)?, 4)?;
/// assert!(response.energy.residual_relative() < 1e-2);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct ManyContacts {
    structure: Arc<PreloadedStructure<ComponentModes>>,
    load: usize,
    sensors: Vec<usize>,
    forces: ContactForces,
    /// Contacts whose means over their area are recorded together.
    groups: Vec<Range<usize>>,
    /// Samples, ascending, at which the state is kept.
    instants: Vec<usize>,
}

impl ManyContacts {
    /// The structure under a load at its port `load`, read at its ports `sensors`.
    ///
    /// # Errors
    /// [`DynamicsError::Setting`] for more than [`MOST_CONTACTS`] contacts;
    /// [`DynamicsError::Mesh`] for a port that does not exist; [`DynamicsError::Dissipative`] for contacts with
    /// friction; [`DynamicsError::ModalDamping`] for ratios of modes.
    pub fn new(
        structure: Arc<PreloadedStructure<ComponentModes>>,
        load: usize,
        sensors: Vec<usize>,
    ) -> Result<Self, DynamicsError> {
        check_modal_damping(&structure)?;
        let ports = structure.component_modes().ports();
        if let Some(&port) = [load].iter().chain(&sensors).find(|&&port| port >= ports) {
            return Err(asperity_mesh::MeshError::NoPort { port, ports }.into());
        }
        let count = structure.contacts().len();
        if count > MOST_CONTACTS {
            return Err(DynamicsError::Setting {
                quantity: "number of contacts",
                value: count as f64,
                accepted: "1 to 1000",
            });
        }
        if let Some(element) = structure.friction() {
            return Err(DynamicsError::Dissipative { element: element.to_owned() });
        }
        let forces = ContactForces::new(structure.contacts());
        let groups = (0..count).map(|contact| contact..contact + 1).collect();
        Ok(Self { structure, load, sensors, forces, groups, instants: Vec::new() })
    }

    /// The same with one interface of the history for each range of contacts, with means over their area.
    #[must_use]
    pub fn with_groups(self, groups: Vec<Range<usize>>) -> Self {
        Self { groups, ..self }
    }

    /// The same with the [state](ContactsState) kept at these samples, in any order; those beyond a response have none.
    #[must_use]
    pub fn with_instants(self, mut instants: Vec<usize>) -> Self {
        instants.sort_unstable();
        instants.dedup();
        Self { instants, ..self }
    }

    /// The structure with its contacts at rest.
    pub fn structure(&self) -> &PreloadedStructure<ComponentModes> {
        &self.structure
    }

    /// The response from rest to `load`, whose own port does not count, with `parts` steps between samples.
    ///
    /// The history has one interface for each contact, or [group](Self::with_groups) of them; pressures are those of
    /// laws, without the viscous part of the traction.
    ///
    /// # Errors
    /// [`DynamicsError::Setting`] for a load out of range or no parts; [`DynamicsError::Unstable`] when the
    /// contact equations of a step are not solved, [`DynamicsError::TooLarge`] for more than 1e10 steps times contacts, [`DynamicsError::Coarse`] when the energy
    /// balance does not close.
    pub fn integrate(
        &self,
        load: &LoadCase,
        sampling: &Sampling,
        parts: usize,
    ) -> Result<Transient, DynamicsError> {
        let found = self.integrate_unless(load, sampling, parts, &AtomicBool::new(false))?;
        Ok(found.transient)
    }

    /// As [`integrate`](Self::integrate), with contacts one by one; once `stop` is set, it ends before the next sample.
    ///
    /// # Errors
    /// Those of [`integrate`](Self::integrate), and [`DynamicsError::Stopped`].
    pub fn integrate_unless(
        &self,
        load: &LoadCase,
        sampling: &Sampling,
        parts: usize,
        stop: &AtomicBool,
    ) -> Result<ContactsResponse, DynamicsError> {
        load.check()?;
        if parts == 0 {
            let (quantity, accepted) = ("number of steps between samples", "at least 1");
            return Err(DynamicsError::Setting { quantity, value: 0.0, accepted });
        }
        let step = sampling.interval() / parts as f64;
        let steps = sampling.samples() as f64 * parts as f64;
        check_many_contacts(steps, self.structure.contacts().len(), step)?;
        let mut run = Run::new(self, load, step);
        let samples = sampling.samples();
        let mut history = History::with_capacity(samples, self.sensors.len(), self.groups.len());
        let mut instants = self.instants.iter().peekable();
        let mut states = Vec::with_capacity(self.instants.len());
        for sample in 0..samples {
            if stop.load(Ordering::Relaxed) {
                return Err(DynamicsError::Stopped { steps: sample * parts });
            }
            let time = sample as f64 * sampling.interval();
            run.record(time, &mut history);
            if instants.next_if_eq(&&sample).is_some() {
                states.push(run.state(time));
            }
            for part in 1..=parts {
                run.advance((sample * parts + part) as f64 * step)?;
            }
        }
        let steps = samples * parts;
        let energy = run.energy();
        balanced(energy.residual_relative(), step, "step")?;
        let finished = |all: &[Extremes]| all.iter().map(|one| one.finished(steps)).collect();
        let contacts = finished(&run.extremes);
        let groups = finished(&run.group_extremes);
        let transient = Transient { step, steps, history, contacts: groups, energy };
        Ok(ContactsResponse { transient, contacts, states })
    }
}

/// The state of a run.
struct Run<'a> {
    system: &'a ManyContacts,
    load: &'a LoadCase,
    step: f64,
    modes: Vec<SteppedMode>,
    /// Closure of each contact, and displacement of each sensor, per contact force and load of modes left out.
    residual: Residual,
    /// Flexibility of a step between contacts, and of the load in closures.
    flexibility: Mat<f64>,
    flexibility_load: Vec<f64>,
    /// Displacements, velocities and forces of the modes.
    displacement: Vec<f64>,
    velocity: Vec<f64>,
    modal_force: Vec<f64>,
    /// Closures from rest, at the end and at the two ends before, and memory of others.
    closures: Vec<f64>,
    before: [Vec<f64>; 2],
    spare: Vec<f64>,
    /// Parts of a step without contact.
    shares: Vec<f64>,
    /// Force increments \[N\].
    forces: Vec<f64>,
    /// Force increments by laws alone \[N\].
    law_forces: Vec<f64>,
    /// Tangents of forces, and those of laws alone \[N/m\].
    stiffness: Vec<f64>,
    law_stiffness: Vec<f64>,
    /// Viscous impulse at the end and at the end before \[N s\], and viscous force \[N\] of each contact.
    impulses: [Vec<f64>; 2],
    viscous: Vec<f64>,
    load_value: f64,
    work: Work,
    /// Displacements and velocities of the modes without forces at the new end.
    drift: Vec<[f64; 2]>,
    free: Vec<f64>,
    largest: f64,
    /// Closures by the rounding of forces \[m\].
    noise: f64,
    extremes: Vec<Extremes>,
    group_extremes: Vec<Extremes>,
    ledger: EnergyLedger,
}

impl<'a> Run<'a> {
    fn new(system: &'a ManyContacts, load: &'a LoadCase, step: f64) -> Self {
        let structure = &*system.structure;
        let component = structure.component_modes();
        let (pairs, rate) = (component.contacts(), structure.damping_rate());
        let ports = (system.load, &*system.sensors);
        let stepped = |mode| SteppedMode::new(mode, (rate, step), pairs, ports);
        let modes: Vec<SteppedMode> = component.modes().iter().map(stepped).collect();
        let residual = Residual::new(component, system.load, &system.sensors);
        let n = pairs.len();
        let mut flexibility = residual.closures.clone();
        let mut flexibility_load = residual.load.clone();
        for mode in &modes {
            for i in 0..n {
                let along = mode.new[0] * mode.closures[i];
                flexibility_load[i] += along * mode.load;
                for j in 0..n {
                    flexibility[(i, j)] += along * mode.closures[j];
                }
            }
        }
        let contacts = structure.contacts();
        let extremes = contacts.iter().map(|contact| Extremes::at(contact.pressure())).collect();
        let mean = |group: &Range<usize>| {
            let cells = &contacts[group.clone()];
            let force: f64 = cells.iter().map(|one| one.area() * one.pressure()).sum();
            Extremes::at(force / cells.iter().map(PreloadedContact::area).sum::<f64>())
        };
        let group_extremes = system.groups.iter().map(mean).collect();
        let closed = contacts.iter().filter(|contact| contact.stiffness() > 0.0);
        let scale = closed.map(|contact| contact.pressure().abs() / contact.stiffness());
        let largest = LEAST * scale.fold(0.0, f64::max);
        let noise = |(i, contact): (usize, &PreloadedContact)| {
            flexibility[(i, i)] * system.forces.impulse_size(i, contact) / step
        };
        let of_dampers = ROUNDINGS * contacts.iter().enumerate().map(noise).fold(0.0, f64::max);
        let of_row = |i: usize| {
            let carried = contacts.iter().enumerate();
            carried.map(|(j, one)| (flexibility[(i, j)] * one.area() * one.pressure()).abs()).sum()
        };
        let noise = of_dampers + ROUNDINGS_AT_REST * (0..n).map(of_row).fold(0.0, f64::max);
        let load_value = load.value(0.0);
        let modal_force = modes.iter().map(|mode| mode.load * load_value).collect();
        let mut run = Self {
            system,
            load,
            step,
            displacement: vec![0.0; modes.len()],
            velocity: vec![0.0; modes.len()],
            modal_force,
            closures: vec![0.0; n],
            before: [vec![0.0; n], vec![0.0; n]],
            spare: vec![0.0; n],
            shares: vec![0.0; n],
            forces: vec![0.0; n],
            law_forces: vec![0.0; n],
            stiffness: contacts.iter().map(PreloadedContact::spring).collect(),
            law_stiffness: contacts.iter().map(PreloadedContact::spring).collect(),
            impulses: [vec![0.0; n], vec![0.0; n]],
            viscous: vec![0.0; n],
            modes,
            residual,
            flexibility,
            flexibility_load,
            load_value,
            work: Work::new(n),
            drift: Vec::new(),
            free: vec![0.0; n],
            largest,
            noise,
            extremes,
            group_extremes,
            ledger: EnergyLedger::default(),
        };
        if load_value != 0.0 {
            run.settle();
        }
        let impulse = |i: usize| {
            let at = (i, &contacts[i]);
            system.forces.impulse(at, run.forces[i], run.law_stiffness[i]).0
        };
        let impulses: Vec<f64> = (0..n).map(impulse).collect();
        run.impulses = [impulses.clone(), impulses];
        run
    }

    /// Closures at a load that jumps at the start: the flexibility left out follows at once, as if there were no dampers.
    fn settle(&mut self) {
        let free: Vec<f64> = self.residual.load.iter().map(|r| r * self.load_value).collect();
        let flexibility = self.residual.closures.clone();
        if self.solve(&free, &flexibility, (0.0, 0.0)).is_ok() {
            self.before = [self.closures.clone(), self.closures.clone()];
        }
        for (m, mode) in self.modes.iter().enumerate() {
            self.modal_force[m] = mode.load * self.load_value - dot(&mode.closures, &self.forces);
        }
    }

    /// Advances by one step, to `time` \[s\].
    fn advance(&mut self, time: f64) -> Result<(), DynamicsError> {
        let load = self.load.value(time);
        let mut free = std::mem::take(&mut self.free);
        for (value, g) in free.iter_mut().zip(&self.flexibility_load) {
            *value = g * load;
        }
        self.drift.clear();
        for (m, mode) in self.modes.iter().enumerate() {
            let z = [self.displacement[m], self.velocity[m]];
            let moved = |row: [f64; 2], k: usize| {
                row[0] * z[0] + row[1] * z[1] + mode.old[k] * self.modal_force[m]
            };
            let next = [moved(mode.propagator.displacement, 0), moved(mode.propagator.velocity, 1)];
            for (value, closure) in free.iter_mut().zip(&mode.closures) {
                *value += closure * next[0];
            }
            self.drift.push(next);
        }
        let before = self.load_displacement();
        let mut old_closures = std::mem::take(&mut self.spare);
        old_closures.copy_from_slice(&self.closures);
        let flexibility = std::mem::replace(&mut self.flexibility, Mat::zeros(0, 0));
        let solved = self.solve(&free, &flexibility, (time, 1.0 / self.step));
        self.flexibility = flexibility;
        self.free = free;
        solved?;
        let mut loss = 0.0;
        for (m, mode) in self.modes.iter().enumerate() {
            let force = mode.load * load - dot(&mode.closures, &self.forces);
            let rate = mode.dynamics.rate;
            let old = [self.displacement[m], self.velocity[m]];
            let new =
                [self.drift[m][0] + mode.new[0] * force, self.drift[m][1] + mode.new[1] * force];
            loss += if mode.dynamics.massless {
                rate * (new[0] - old[0]).powi(2) / self.step
            } else {
                // Velocities of a cubic through both ends, squared and integrated.
                let rise = (new[0] - old[0]) / self.step;
                let (a, b) = (old[1] - rise, new[1] - rise);
                rate * self.step * (rise * rise + (2.0 * a * a + 2.0 * b * b - a * b) / 15.0)
            };
            (self.displacement[m], self.velocity[m]) = (new[0], new[1]);
            self.modal_force[m] = force;
        }
        let mean_load = 0.5 * (load + self.load_value);
        self.load_value = load;
        for (i, old) in old_closures.iter().enumerate() {
            if !self.system.forces.is_damped(i) {
                continue;
            }
            let contact = &self.system.structure.contacts()[i];
            let law = self.law_forces[i];
            let impulse = self.system.forces.impulse((i, contact), law, self.law_stiffness[i]).0;
            let viscous = self.forces[i] - law;
            loss += 0.5 * (viscous + self.viscous[i]) * (self.closures[i] - old);
            self.viscous[i] = viscous;
            self.impulses[1][i] = std::mem::replace(&mut self.impulses[0][i], impulse);
        }
        self.ledger.input += mean_load * (self.load_displacement() - before);
        self.ledger.dissipated += loss;
        self.observe(&old_closures);
        let [last, earlier] = &mut self.before;
        self.spare = std::mem::replace(earlier, std::mem::replace(last, old_closures));
        Ok(())
    }

    /// Solves the contact equations for closures `free` without contact forces at a `time` \[s\], with rates of impulses
    /// by the inverse `rate` of the step \[1/s\]; zero for none.
    fn solve(
        &mut self,
        free: &[f64],
        flexibility: &Mat<f64>,
        (time, rate): (f64, f64),
    ) -> Result<(), DynamicsError> {
        let mut work = std::mem::take(&mut self.work);
        let is_solved = self.newton(free, flexibility, rate, &mut work);
        if is_solved {
            self.closures.copy_from_slice(&work.place);
        }
        self.work = work;
        if is_solved { Ok(()) } else { Err(self.unstable(time)) }
    }

    /// Newton steps to the closures of `work`; false if they do not end.
    fn newton(&mut self, free: &[f64], flexibility: &Mat<f64>, rate: f64, work: &mut Work) -> bool {
        let (forces, contacts) = (&self.system.forces, self.system.structure.contacts());
        let Work { factor, place, from, change, rest, carried } = work;
        // The parabola through the last three ends.
        let [last, earlier] = &self.before;
        for (((x, now), last), earlier) in
            place.iter_mut().zip(&self.closures).zip(last).zip(earlier)
        {
            *x = 3.0 * (now - last) + earlier;
        }
        let mut merit = f64::INFINITY;
        for _ in 0..MOST_ITERATIONS {
            forces.evaluate(contacts, place, &mut self.law_forces, &mut self.law_stiffness);
            self.add_dampers(rate);
            times(flexibility, &self.forces, carried);
            let mut size = 0.0_f64;
            for (i, value) in rest.iter_mut().enumerate() {
                *value = free[i] - place[i] - carried[i];
                // A residual that is no number counts.
                size = if value.abs() <= size { size } else { value.abs() };
            }
            self.largest = place.iter().fold(self.largest, |most, value| most.max(value.abs()));
            if size <= (SOLVED * self.largest).max(self.noise) {
                return true;
            }
            if !size.is_finite() {
                return false;
            }
            // A step that makes the residual much larger is halved.
            if size > 2.0 * merit {
                for ((x, start), step) in place.iter_mut().zip(&*from).zip(change.iter_mut()) {
                    *step *= 0.5;
                    *x = start + *step;
                }
                continue;
            }
            merit = size;
            if !factor.update(&self.stiffness, flexibility) {
                return false;
            }
            factor.solve(flexibility, rest, change);
            from.copy_from_slice(place);
            for (x, change) in place.iter_mut().zip(&*change) {
                *x += change;
            }
        }
        false
    }

    /// Forces and stiffnesses of contacts from those of their laws.
    fn add_dampers(&mut self, rate: f64) {
        self.forces.copy_from_slice(&self.law_forces);
        self.stiffness.copy_from_slice(&self.law_stiffness);
        let laws = &self.system.forces;
        for (i, contact) in self.system.structure.contacts().iter().enumerate() {
            if !laws.is_damped(i) || rate == 0.0 {
                continue;
            }
            let (impulse, damper) =
                laws.impulse((i, contact), self.law_forces[i], self.law_stiffness[i]);
            let [last, before] = [self.impulses[0][i], self.impulses[1][i]];
            let force = self.law_forces[i] + rate * (1.5 * impulse - 2.0 * last + 0.5 * before);
            let least = contact.area() * (laws.lowest(i) - contact.pressure());
            (self.forces[i], self.stiffness[i]) = if force > least {
                (force, self.law_stiffness[i] + 1.5 * rate * damper)
            } else {
                (least, 0.0)
            };
        }
    }

    fn unstable(&self, time_s: f64) -> DynamicsError {
        let contacts = self.system.structure.contacts().iter().zip(&self.closures);
        let worst = contacts.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
        let interface = worst.map(|(contact, _)| contact.name().to_owned()).unwrap_or_default();
        DynamicsError::Unstable { time_s, interface }
    }

    /// The ledger at the end.
    fn energy(&self) -> EnergyLedger {
        let mut ledger = self.ledger;
        for (m, mode) in self.modes.iter().enumerate() {
            if !mode.dynamics.massless {
                ledger.kinetic += 0.5 * self.velocity[m].powi(2);
            }
            ledger.elastic +=
                0.5 * (mode.dynamics.angular_frequency * self.displacement[m]).powi(2);
        }
        let mut carried = vec![0.0; self.forces.len()];
        times(&self.residual.closures, &self.forces, &mut carried);
        ledger.elastic += 0.5 * self.residual.own * self.load_value.powi(2);
        let contacts = self.system.structure.contacts();
        for (i, contact) in contacts.iter().enumerate() {
            ledger.elastic += 0.5 * self.forces[i] * carried[i]
                - self.residual.load[i] * self.load_value * self.forces[i];
            ledger.contact += contact.area() * excess(contact, self.closures[i]);
        }
        ledger
    }
}
