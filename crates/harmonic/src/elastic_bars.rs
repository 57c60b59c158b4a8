//! A preloaded stack of elastic bars as a linear system, in closed form.

use asperity_mesh::{ComponentModes, ModeCount, Port, Stack, Support};
use asperity_structure::{DampedMode, Guide, PreloadedStructure, StructureError};
use num_complex::Complex64;

use crate::modal_damping;
use crate::{Compliance, HarmonicError, LinearSystem, MeanBalance, SystemPort, bars_on_springs};

/// Exact at every frequency.
impl LinearSystem for PreloadedStructure {
    fn interfaces(&self) -> usize {
        self.contacts().len()
    }

    fn guides(&self) -> &[Guide] {
        self.guides()
    }

    fn default_port(&self) -> SystemPort {
        Port::TOP.into()
    }

    fn check_port(&self, port: SystemPort) -> Result<(), HarmonicError> {
        let SystemPort::Stack(own) = port else { return Err(HarmonicError::ForeignPort { port }) };
        own.check(self.stack()).map_err(StructureError::from)?;
        Ok(())
    }

    fn compliance(
        &self,
        at: (f64, f64),
        ports: &[SystemPort],
        springs: &[Complex64],
        into: &mut Compliance,
    ) {
        let on_springs = |springs: &[Complex64], into: &mut Compliance| {
            bars_on_springs::write((self.stack(), self.damping_rate()), at, ports, springs, into);
        };
        if self.damped_modes().is_empty() {
            return on_springs(springs, into);
        }
        let of_port = |mode: &DampedMode, port: usize| match ports[port] {
            SystemPort::Stack(port) => mode.shape.participation(self.stack(), port),
            SystemPort::Number(_) => 0.0,
        };
        let damped = (self.damped_modes(), self.contacts(), self.damping_rate());
        modal_damping::write(damped, at, springs, into, of_port, on_springs);
    }

    /// Without guides the contacts carry the mean forces of rest, and so does the support. The mean
    /// force in a guide takes from the contacts below, and its closure is the mean displacement of the bar.
    fn mean_balance(&self, ports: &[SystemPort]) -> MeanBalance {
        let contacts = self.contacts().len();
        let guided: Vec<usize> = guided(self.stack()).collect();
        let n = contacts + guided.len();
        let mut balance = MeanBalance {
            closure: vec![0.0; n * n],
            force: vec![0.0; n * n],
            port_closure: Vec::with_capacity(n * ports.len()),
            port_force: Vec::with_capacity(n * ports.len()),
        };
        for i in 0..contacts {
            balance.force[i * n + i] = 1.0;
        }
        for (pair, &body) in (contacts..).zip(&guided) {
            for below in body..contacts {
                balance.force[below * n + pair] = 1.0;
            }
            let mut mean = MeanRow::new(n);
            mean.add(self.stack(), &guided, Port::Mean { body }, -1.0);
            balance.closure[pair * n..][..n].copy_from_slice(&mean.closure);
            balance.force[pair * n..][..n].copy_from_slice(&mean.force);
            balance.closure[pair * n + pair] = 1.0;
        }
        for port in ports {
            let mut row = MeanRow::new(n);
            if let SystemPort::Stack(port) = *port {
                row.add(self.stack(), &guided, port, 1.0);
            }
            balance.port_closure.extend(row.closure);
            balance.port_force.extend(row.force);
        }
        balance
    }

    fn lowest_modes(&self, count: usize) -> Result<ComponentModes, HarmonicError> {
        let modes = ComponentModes::of_stack(self.stack(), ModeCount::Lowest(count), &[]);
        Ok(modes.map_err(StructureError::from)?)
    }

    fn mass_damping(&self) -> f64 {
        self.damping_rate()
    }

    fn damped_modes(&self) -> &[DampedMode] {
        self.damped_modes()
    }
}

/// The bodies in guides with friction, by their places.
fn guided(stack: &Stack) -> impl Iterator<Item = usize> {
    let bodies = stack.bodies().iter().enumerate();
    bodies.filter(|(_, body)| body.friction().is_some()).map(|(i, _)| i)
}

/// A mean displacement per mean closure and mean force increment of the pairs.
struct MeanRow {
    closure: Vec<f64>,
    force: Vec<f64>,
}

impl MeanRow {
    fn new(pairs: usize) -> Self {
        Self { closure: vec![0.0; pairs], force: vec![0.0; pairs] }
    }

    /// Adds `factor` times the mean displacement of a port of `stack`, whose `guided` bodies have the
    /// pairs after the contacts.
    ///
    /// Under a force P from above and the force f of a guide, spread over its length, the part of a bar
    /// below x shortens by `(P (L - x) - f (L^2 - x^2) / (2 L)) / (E A)`, on average over x by
    /// `(P / 2 - f / 3) L / (E A)`.
    fn add(&mut self, stack: &Stack, guided: &[usize], port: Port, factor: f64) {
        let bodies = stack.bodies();
        let (body, by_force, by_guide) = match port {
            Port::Point { body, position } => {
                let part = position / bodies[body].length();
                (body, 1.0 - part, 0.5 * (1.0 - part * part))
            }
            Port::Mean { body } => (body, 0.5, 1.0 / 3.0),
            Port::Base => {
                for (body, own) in bodies.iter().enumerate() {
                    self.add(stack, guided, Port::Mean { body }, -factor * own.mass());
                }
                if let Support::SpringMass { mass, .. } = *stack.support() {
                    self.add(stack, guided, Port::Support, -factor * mass);
                }
                return;
            }
            _ => {
                if let Support::SpringMass { stiffness, .. } = *stack.support() {
                    self.force[bodies.len() - 1] += factor / stiffness;
                }
                return;
            }
        };
        let flexibility = factor * bodies[body].length() / bodies[body].axial_rigidity();
        if let Some(above) = body.checked_sub(1) {
            self.force[above] += by_force * flexibility;
        }
        if let Some(guide) = guided.iter().position(|&own| own == body) {
            self.force[bodies.len() + guide] -= by_guide * flexibility;
        }
        self.closure[body] += factor;
        let next = Port::Point { body: body + 1, position: 0.0 };
        let below = if body + 1 < bodies.len() { next } else { Port::Support };
        self.add(stack, guided, below, factor);
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use asperity_law::Constant;
    use asperity_mesh::{BarStiffness, Body, Interface};
    use asperity_structure::Damping;

    use super::*;
    use crate::Dual;

    /// Direct and cross end receptances of a free bar under the damping rate h.
    fn free_bar(body: &Body, w: f64, rate: f64) -> (Dual, Dual) {
        let contact = Interface::new("contact", 1e-4, Arc::new(Constant::new(1e12).unwrap()));
        let stack = Stack::new(vec![body.clone()], vec![contact.unwrap()], Support::Rigid, 9.81);
        let structure = PreloadedStructure::new(stack.unwrap(), Damping::Rate(rate)).unwrap();
        let mut found = Compliance::zero(1, 1);
        structure.compliance((w, 0.0), &[Port::TOP.into()], &[], &mut found);
        (*found.get(1, 1), *found.get(0, 1))
    }

    /// Without damping the receptances invert the closed-form stiffness; rounding grows with the
    /// condition of the small matrix.
    #[test]
    fn receptances_invert_the_dynamic_stiffness() {
        let body = Body::new("bar", 0.2, 1e-3, 71e9, 2710.0).unwrap();
        for w in [50.0, 5e3, 6.1e4, 2.3e5] {
            let (direct, cross) = free_bar(&body, w, 0.0);
            let k = BarStiffness::at(&body, w);
            let same = direct.value * k.direct + cross.value * k.cross;
            let other = direct.value * k.cross + cross.value * k.direct;
            // A slow bar is nearly rigid: k.direct and k.cross nearly cancel.
            let bound = 1e-14 * (k.direct * direct.value.re).abs().max(1.0);
            assert!((same - Complex64::new(1.0, 0.0)).norm() < bound, "{w}: {same}");
            assert!(other.norm() < bound, "{w}: {other}");
        }
    }
}
