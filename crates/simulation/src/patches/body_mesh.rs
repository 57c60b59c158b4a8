//! Meshes of bodies, and their displacements by modes and port forces.
//!
//! A displacement is the sum of the component modes kept and of the flexibility of the others, a local deformation about
//! the cells, loads and sensors, under the forces there.

use std::path::Path;

use asperity_matrices::Deck;
use asperity_scenario::StructureScenario;
use faer::Mat;

use super::body::read_deck;
use super::kept_reduction::{self, BodyShapes, ReductionKey};
use super::structure::{BodyMotion, PatchStructure, reduced};
use crate::error::SimulationError;

/// Mesh of a body with the shapes of its modes.
#[derive(Debug, Clone)]
pub(super) struct BodyMesh {
    /// Number of the body in the scenario.
    pub(super) number: usize,
    pub(super) name: String,
    pub(super) deck: Deck,
    shapes: BodyShapes,
    /// Number of ports of the body.
    ports: usize,
}

/// The meshes of the bodies that have one, in the order of the scenario.
pub(super) fn body_meshes(
    scenario: &StructureScenario,
    structure: &PatchStructure,
    folder: &Path,
) -> Result<Vec<BodyMesh>, SimulationError> {
    if scenario.bodies.iter().all(|body| body.mesh.is_none()) {
        return Ok(Vec::new());
    }
    let key = ReductionKey::new(folder, scenario)?;
    let all = match kept_reduction::find_shapes(folder, &key) {
        Some(shapes) => shapes,
        None => reduced(scenario, folder, &key)?.2,
    };
    let mut meshes = Vec::new();
    let bodies = scenario.bodies.iter().zip(all).zip(&structure.modes_per_body);
    for (number, ((body, shapes), &count)) in bodies.enumerate() {
        let Some(deck) = read_deck(body, folder)?.filter(|_| shapes.shapes.ncols() == count) else {
            continue;
        };
        let (name, ports) = (body.name.clone(), structure.own_ports[number].len());
        meshes.push(BodyMesh { number, name, deck, shapes, ports });
    }
    Ok(meshes)
}

impl BodyMesh {
    /// True if displacements have the flexibility of the modes left out: rows times ports are not too many numbers.
    pub(super) fn is_flexible(&self) -> bool {
        self.shapes.flexible.ncols() == self.ports
    }

    /// Displacements of the nodes, ascending, by the modes kept at these coordinates.
    pub(super) fn carried(&self, coordinates: &[f64]) -> Vec<[f64; 3]> {
        let mut values = vec![0.0; self.shapes.dofs.len()];
        add_columns(&self.shapes.shapes, coordinates, &mut values);
        self.at_nodes(&values)
    }

    /// Displacements of the nodes, ascending, in a motion \[m\]; by the modes kept alone unless [`Self::is_flexible`].
    pub(super) fn displacements(&self, motion: &BodyMotion) -> Vec<[f64; 3]> {
        let mut values = vec![0.0; self.shapes.dofs.len()];
        add_columns(&self.shapes.shapes, &motion.coordinates, &mut values);
        if self.is_flexible() {
            add_columns(&self.shapes.flexible, &motion.port_forces, &mut values);
        }
        self.at_nodes(&values)
    }

    /// Values of rows as displacements of the nodes, ascending; nodes without rows stand still.
    fn at_nodes(&self, values: &[f64]) -> Vec<[f64; 3]> {
        let numbers: Vec<i64> = self.deck.nodes().numbers().collect();
        let mut displacements = vec![[0.0; 3]; numbers.len()];
        let rows = self.shapes.dofs.iter().zip(values);
        for (dof, value) in rows.filter(|(dof, _)| dof.direction <= 3) {
            if let Ok(node) = numbers.binary_search(&dof.node) {
                displacements[node][usize::from(dof.direction) - 1] = *value;
            }
        }
        displacements
    }

    /// Places of the nodes \[m\], ascending by their numbers.
    pub(super) fn places(&self) -> Vec<[f64; 3]> {
        self.deck.nodes().iter().map(|(_, place)| place).collect()
    }

    /// Edges of the faces that are turned to `eye`, a vector towards it, by the numbers of their ends among the
    /// [places](Self::places).
    pub(super) fn edges_seen(&self, eye: [f64; 3]) -> Vec<[usize; 2]> {
        let numbers: Vec<i64> = self.deck.nodes().numbers().collect();
        let place = |node: i64| numbers.binary_search(&node).ok();
        let edges = self.deck.edges_seen(eye).into_iter();
        edges.filter_map(|[a, b]| Some([place(a)?, place(b)?])).collect()
    }
}

/// Adds the columns of a matrix times their factors.
fn add_columns(matrix: &Mat<f64>, factors: &[f64], sum: &mut [f64]) {
    for (column, factor) in matrix.col_iter().zip(factors) {
        for (sum, value) in sum.iter_mut().zip(column.iter()) {
            *sum += factor * value;
        }
    }
}
