//! Mass, stiffness and contact pairs of the grid, as matrices for second methods.
#![allow(dead_code, reason = "each suite that includes the file uses a part")]

use asperity_mesh::{Grid, Stack, Support};

/// The two faces of a contact, a node each.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ContactPair {
    /// Node of the upper face.
    pub(crate) above: usize,
    /// Node of the lower face; `None` for an immovable support.
    pub(crate) below: Option<usize>,
    /// Nominal contact area [m2].
    pub(crate) area: f64,
}

/// `M u'' + C u' + k u = f` without its contacts: lumped masses and symmetric
/// stiffness triplets over numbered nodes.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct LinearStructure {
    mass: Vec<f64>,
    in_body: Vec<bool>,
    position: Vec<f64>,
    stiffness: Vec<(usize, usize, f64)>,
    support_damping: f64,
    contacts: Vec<ContactPair>,
}

impl LinearStructure {
    /// The structure of a stack on its finite-difference grid: nodes from the
    /// top down, body after body, then the support's mass if it has one.
    pub(crate) fn on_grid(stack: &Stack, grid: &Grid) -> Self {
        let mut structure = Self {
            mass: Vec::with_capacity(grid.nodes() + 1),
            in_body: Vec::with_capacity(grid.nodes() + 1),
            position: Vec::with_capacity(grid.nodes() + 1),
            stiffness: Vec::with_capacity(4 * grid.nodes() + 1),
            support_damping: stack.support().damping(),
            contacts: Vec::with_capacity(stack.interfaces().len()),
        };
        let mut top = 0.0;
        for (bar, interface) in grid.bars().iter().zip(stack.interfaces()) {
            let first = structure.mass.len();
            for node in 0..bar.nodes() {
                let at_end = node == 0 || node == bar.cells();
                let mass = if at_end { bar.end_mass() } else { bar.cell_mass() };
                structure.push_node(mass, true, top + node as f64 * bar.cell_length());
            }
            for node in first..first + bar.cells() {
                structure.push_spring(node, Some(node + 1), bar.cell_stiffness());
            }
            top += bar.cells() as f64 * bar.cell_length();
            let above = structure.mass.len() - 1;
            structure.contacts.push(ContactPair {
                above,
                below: Some(above + 1),
                area: interface.area(),
            });
        }
        match *stack.support() {
            Support::Rigid => {
                if let Some(last) = structure.contacts.last_mut() {
                    last.below = None;
                }
            }
            Support::SpringMass { stiffness, mass, .. } => {
                let node = structure.mass.len();
                structure.push_node(mass, false, top);
                structure.push_spring(node, None, stiffness);
            }
        }
        structure
    }

    fn push_node(&mut self, mass: f64, in_body: bool, position: f64) {
        self.mass.push(mass);
        self.in_body.push(in_body);
        self.position.push(position);
    }

    /// A spring of stiffness `k` [N/m] between two nodes, or a node and the ground.
    fn push_spring(&mut self, node: usize, other: Option<usize>, k: f64) {
        self.stiffness.push((node, node, k));
        if let Some(other) = other {
            self.stiffness.extend([(other, other, k), (node, other, -k), (other, node, -k)]);
        }
    }

    /// Number of nodes.
    pub(crate) fn nodes(&self) -> usize {
        self.mass.len()
    }

    /// Lumped mass of each node [kg].
    pub(crate) fn mass(&self) -> &[f64] {
        &self.mass
    }

    /// Mass of each node on which mass-proportional damping acts [kg]: zero at the support.
    pub(crate) fn damped_mass(&self) -> impl Iterator<Item = f64> + '_ {
        self.mass.iter().zip(&self.in_body).map(|(&mass, &damped)| if damped { mass } else { 0.0 })
    }

    /// Distance of each node from the top [m].
    pub(crate) fn position(&self) -> &[f64] {
        &self.position
    }

    /// Stiffness as `(row, column, value [N/m])`; entries of the same place add up.
    pub(crate) fn stiffness(&self) -> &[(usize, usize, f64)] {
        &self.stiffness
    }

    /// Viscous coefficient between the last node and the ground [N s/m]: the support's damper.
    pub(crate) fn support_damping(&self) -> f64 {
        self.support_damping
    }

    /// The contacts, from the top down.
    pub(crate) fn contacts(&self) -> &[ContactPair] {
        &self.contacts
    }

    /// `y = k u`, contacts not included.
    pub(crate) fn elastic_forces(&self, displacement: &[f64]) -> Vec<f64> {
        let mut forces = vec![0.0; self.nodes()];
        for &(row, column, value) in &self.stiffness {
            forces[row] += value * displacement[column];
        }
        forces
    }
}
