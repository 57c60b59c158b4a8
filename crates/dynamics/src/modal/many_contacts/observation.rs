//! Observation of a run: extremes of contacts and their groups, and motions of ports.

use std::ops::Range;

use super::Run;
use super::contact_factor::dot;
use super::run_parts::share_below_zero;
use crate::{ContactExtremes, History, Transient};

/// A response with its contacts one by one.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactsResponse {
    /// The response. Its extremes are of the means of groups: a group is lost while all of its contacts are.
    pub transient: Transient,
    /// Extremes of each contact.
    pub contacts: Vec<ContactExtremes>,
    /// States at the [instants](super::ManyContacts::with_instants).
    pub states: Vec<ContactsState>,
}

/// State of a structure with many contacts at an instant.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactsState {
    /// Time \[s\].
    pub time: f64,
    /// Load at its port \[N\], or acceleration of the base \[m/s2\].
    pub load: f64,
    /// Displacement of each component mode from rest \[m kg^1/2\].
    pub coordinates: Vec<f64>,
    /// Force of each contact beyond the force at rest, positive in compression, with its viscous part \[N\].
    pub forces: Vec<f64>,
    /// Pressure of each contact by its law \[Pa\].
    pub pressures: Vec<f64>,
    /// Distance of each contact from first contact \[m\]; zero for a closed one.
    pub gaps: Vec<f64>,
}

impl Run<'_> {
    /// Takes the end of a step into the extremes; contact is lost from where a line between both ends
    /// crosses first contact.
    pub(super) fn observe(&mut self, before: &[f64]) {
        let contacts = self.system.structure.contacts();
        let mut shares = std::mem::take(&mut self.shares);
        shares.fill(0.0);
        for (i, contact) in contacts.iter().enumerate() {
            let pressure = contact.pressure() + self.law_forces[i] / contact.area();
            let one = &mut self.extremes[i];
            one.pressure_min = one.pressure_min.min(pressure.max(self.system.forces.lowest(i)));
            one.pressure_max = one.pressure_max.max(pressure);
            one.stiffness_sum += self.law_stiffness[i] / contact.area();
            let Some(lost) = self.system.forces.lost_at(i) else { continue };
            let [old, new] = [before[i] - lost, self.closures[i] - lost];
            let share = share_below_zero(old, new);
            shares[i] = share;
            one.lost += share * self.step;
        }
        for (number, group) in self.system.groups.iter().enumerate() {
            let (pressure, _, stiffness) = self.group(group);
            let one = &mut self.group_extremes[number];
            one.pressure_min = one.pressure_min.min(pressure);
            one.pressure_max = one.pressure_max.max(pressure);
            one.stiffness_sum += stiffness;
            one.lost += self.step * shares[group.clone()].iter().copied().fold(1.0, f64::min);
        }
        self.shares = shares;
    }

    /// Pressure, closure and stiffness of a group, means over its area.
    fn group(&self, group: &Range<usize>) -> (f64, f64, f64) {
        let contacts = self.system.structure.contacts();
        let (mut area, mut force, mut closure, mut stiffness) = (0.0, 0.0, 0.0, 0.0);
        for i in group.clone() {
            let contact = &contacts[i];
            let carried = contact.area() * contact.pressure() + self.law_forces[i];
            area += contact.area();
            force += carried.max(contact.area() * self.system.forces.lowest(i));
            closure += contact.area() * (contact.closure() + self.closures[i]);
            stiffness += self.law_stiffness[i];
        }
        (force / area, closure / area, stiffness / area)
    }

    /// Displacement of the loaded port \[m\].
    pub(super) fn load_displacement(&self) -> f64 {
        let carried: f64 = self.modes.iter().zip(&self.displacement).map(|(m, q)| m.load * q).sum();
        let yielded = dot(&self.residual.load, &self.forces);
        carried + self.residual.own * self.load_value - yielded
    }

    /// Motion of a sensor. Modes with inertia alone contribute to velocities and accelerations.
    fn sensor(&self, number: usize) -> [f64; 3] {
        let yielded = dot(&self.residual.sensors[number], &self.forces);
        let mut motion = [self.residual.sensors_load[number] * self.load_value - yielded, 0.0, 0.0];
        for (m, mode) in self.modes.iter().enumerate() {
            let (shape, w) = (mode.sensors[number], mode.dynamics.angular_frequency);
            motion[0] += shape * self.displacement[m];
            if !mode.dynamics.massless {
                motion[1] += shape * self.velocity[m];
                motion[2] += shape
                    * (self.modal_force[m]
                        - mode.dynamics.rate * self.velocity[m]
                        - w * w * self.displacement[m]);
            }
        }
        motion
    }

    /// Adds the state at `time` \[s\] to a history.
    pub(super) fn record(&self, time: f64, history: &mut History) {
        history.time.push(time);
        history.load.push(self.load_value);
        for (number, sensor) in history.sensors.iter_mut().enumerate() {
            sensor.push(self.sensor(number));
        }
        for (group, interface) in self.system.groups.iter().zip(&mut history.interfaces) {
            interface.push(self.group(group));
        }
    }

    /// The state at `time` \[s\].
    pub(super) fn state(&self, time: f64) -> ContactsState {
        let (laws, contacts) = (&self.system.forces, self.system.structure.contacts());
        let pressure = |i: usize| {
            let pressure = contacts[i].pressure() + self.law_forces[i] / contacts[i].area();
            pressure.max(laws.lowest(i))
        };
        let gap = |i: usize| laws.lost_at(i).map_or(0.0, |lost| (lost - self.closures[i]).max(0.0));
        ContactsState {
            time,
            load: self.load_value,
            coordinates: self.displacement.clone(),
            forces: self.forces.clone(),
            pressures: (0..contacts.len()).map(pressure).collect(),
            gaps: (0..contacts.len()).map(gap).collect(),
        }
    }
}
