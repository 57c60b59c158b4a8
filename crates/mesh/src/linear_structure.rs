//! Mass, stiffness and contact pairs of a discretised structure.

use crate::{Grid, Stack, Support};

/// The two faces of a contact, a node each.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactPair {
    /// Node of the upper face.
    pub above: usize,
    /// Node of the lower face; `None` for an immovable support.
    pub below: Option<usize>,
    /// Nominal contact area \[m2\].
    pub area: f64,
}

/// `M u'' + C u' + k u = f` without its contacts: lumped masses and symmetric
/// stiffness triplets over numbered nodes.
///
/// ```
/// use std::sync::Arc;
///
/// use asperity_law::Constant;
/// use asperity_mesh::{Body, Grid, Interface, LinearStructure, Stack, Support};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let guide = Body::with_mass("guide", 0.229, 1.61, 71e9, 2710.0)?;
/// let contact = Interface::new("guide-disc", 1.15e-4, Arc::new(Constant::new(8.5e11)?))?;
/// let stack = Stack::new(vec![guide], vec![contact], Support::Rigid, 9.81)?;
/// let structure = LinearStructure::on_grid(&stack, &Grid::new(&stack, 5e-3)?);
/// assert!((structure.mass().iter().sum::<f64>() - 1.61).abs() < 1e-12);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct LinearStructure {
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
    pub fn on_grid(stack: &Stack, grid: &Grid) -> Self {
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

    /// A spring of stiffness `k` \[N/m\] between two nodes, or a node and the ground.
    fn push_spring(&mut self, node: usize, other: Option<usize>, k: f64) {
        self.stiffness.push((node, node, k));
        if let Some(other) = other {
            self.stiffness.extend([(other, other, k), (node, other, -k), (other, node, -k)]);
        }
    }

    /// Number of nodes.
    pub fn nodes(&self) -> usize {
        self.mass.len()
    }

    /// Lumped mass of each node \[kg\].
    pub fn mass(&self) -> &[f64] {
        &self.mass
    }

    /// Mass of each node on which mass-proportional damping acts \[kg\]: zero at the support.
    pub fn damped_mass(&self) -> impl Iterator<Item = f64> + '_ {
        self.mass.iter().zip(&self.in_body).map(|(&mass, &damped)| if damped { mass } else { 0.0 })
    }

    /// Distance of each node from the top \[m\].
    pub fn position(&self) -> &[f64] {
        &self.position
    }

    /// Stiffness as `(row, column, value [N/m])`; entries of the same place add up.
    pub fn stiffness(&self) -> &[(usize, usize, f64)] {
        &self.stiffness
    }

    /// Viscous coefficient between the last node and the ground [N s/m]: the support's damper.
    pub fn support_damping(&self) -> f64 {
        self.support_damping
    }

    /// Node of the driving point, which is also the output.
    pub fn drive(&self) -> usize {
        0
    }

    /// The contacts, from the top down.
    pub fn contacts(&self) -> &[ContactPair] {
        &self.contacts
    }

    /// `y = k u`, contacts not included.
    pub fn elastic_forces(&self, displacement: &[f64]) -> Vec<f64> {
        let mut forces = vec![0.0; self.nodes()];
        for &(row, column, value) in &self.stiffness {
            forces[row] += value * displacement[column];
        }
        forces
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Body, Interface};
    use asperity_law::Constant;
    use std::sync::Arc;

    fn structure(support: Support) -> (Stack, LinearStructure) {
        let law = Arc::new(Constant::new(1e12).unwrap());
        let body = |name| Body::new(name, 0.02, 2e-4, 71e9, 2710.0).unwrap();
        let contact = |name| Interface::new(name, 1e-4, law.clone()).unwrap();
        let stack = Stack::new(
            vec![body("a"), body("b"), body("c")],
            vec![contact("ab"), contact("bc"), contact("c0")],
            support,
            9.81,
        )
        .unwrap();
        let grid = Grid::new(&stack, 5e-3).unwrap();
        let structure = LinearStructure::on_grid(&stack, &grid);
        (stack, structure)
    }

    #[test]
    fn three_bodies_on_a_rigid_support_are_numbered_from_the_top() {
        let (stack, structure) = structure(Support::Rigid);
        assert_eq!(structure.nodes(), 24);
        let faces: Vec<_> = structure.contacts().iter().map(|c| (c.above, c.below)).collect();
        assert_eq!(faces, [(7, Some(8)), (15, Some(16)), (23, None)]);
        let mass: f64 = structure.mass().iter().sum();
        let expected: f64 = stack.bodies().iter().map(Body::mass).sum();
        assert!((mass - expected).abs() < 1e-15);
        assert!((structure.position()[23] - 0.06).abs() < 1e-15);
    }

    /// Free bodies: a rigid translation meets no elastic force; a uniform strain
    /// is resisted by E A strain at the ends only.
    #[test]
    fn elastic_forces_of_rigid_and_uniform_strain_fields() {
        let (_, structure) = structure(Support::Rigid);
        assert!(structure.elastic_forces(&[1.0; 24]).iter().all(|f| f.abs() < 1e-6));
        let strained: Vec<f64> = structure.position().iter().map(|x| 1e-3 * x).collect();
        let forces = structure.elastic_forces(&strained);
        let expected = 71e9 * 2e-4 * 1e-3;
        assert!((forces[0] + expected).abs() < 1e-6 * expected);
        assert!((forces[7] - expected).abs() < 1e-6 * expected);
        assert!(forces[1..7].iter().all(|f| f.abs() < 1e-6 * expected));
    }

    #[test]
    fn a_spring_mass_support_is_one_more_node_without_body_damping() {
        let support = Support::SpringMass { stiffness: 1e8, mass: 5.0, damping_ratio: 0.1 };
        let (_, structure) = structure(support);
        assert_eq!(structure.nodes(), 25);
        assert_eq!(structure.contacts()[2].below, Some(24));
        assert_eq!(structure.mass()[24], 5.0);
        assert_eq!(structure.damped_mass().last(), Some(0.0));
        assert!((structure.support_damping() - 2.0 * 0.1 * (5e8_f64).sqrt()).abs() < 1e-9);
        let mut shift = vec![0.0; 25];
        shift[24] = 2.0;
        assert_eq!(structure.elastic_forces(&shift)[24], 2e8);
    }
}
