//! Shapes of modes and static displacements on the meshes of bodies, and their files: VTU, and universal files for modal
//! programs.
//!
//! A shape is the sum of the component modes kept; the flexibility of the others, a local deformation about the
//! cells, is not in it. Static displacements have both.

use std::path::Path;

use asperity_matrices::VtuGrid;
use asperity_scenario::StructureScenario;
use asperity_structure::PortMode;

use super::body_mesh::{BodyMesh, body_meshes};
use super::modes::PatchModes;
use super::structure::PatchStructure;
use super::universal_file::{Analysis, UniversalField, universal_file};
use crate::error::SimulationError;

/// Modes on the mesh of a body.
#[derive(Debug, Clone)]
pub struct MeshModes {
    mesh: BodyMesh,
    /// Frequency \[Hz\] and damping ratio of each mode.
    modes: Vec<[f64; 2]>,
    /// Displacements of the nodes, ascending, by modes \[kg^-1/2\].
    shapes: Vec<Vec<[f64; 3]>>,
    /// Displacements of the nodes at rest by all loads \[m\], where the flexible shapes are kept.
    rest: Option<Vec<[f64; 3]>>,
}

/// Name of the displacements at rest.
pub(super) const STATIC_FIELD: &str = "displacement at rest";

/// The shapes of `found` on the meshes of the bodies that have one.
///
/// # Errors
/// Those of [`assemble_patches`](super::assemble_patches).
pub fn mesh_modes(
    scenario: &StructureScenario,
    structure: &PatchStructure,
    found: &PatchModes,
    folder: &Path,
) -> Result<Vec<MeshModes>, SimulationError> {
    let on_mesh = |mesh: BodyMesh| {
        let first = structure.modes_per_body[..mesh.number].iter().sum();
        let own = first..first + structure.modes_per_body[mesh.number];
        let shape = |mode: &PortMode| mesh.carried(&mode.coordinates[own.clone()]);
        let rest = mesh.is_flexible().then(|| mesh.displacements(&structure.rest[mesh.number]));
        MeshModes {
            modes: found.modes.iter().map(|one| [one.frequency_hz, one.damping_ratio]).collect(),
            shapes: found.modes.iter().map(shape).collect(),
            rest,
            mesh,
        }
    };
    Ok(body_meshes(scenario, structure, folder)?.into_iter().map(on_mesh).collect())
}

impl MeshModes {
    /// The mesh with a vector field of the displacements at rest and of each mode, as a grid of `ParaView`.
    pub fn grid(&self) -> String {
        let names: Vec<String> = (1..)
            .zip(&self.modes)
            .map(|(number, [frequency, _])| format!("mode {number}: {frequency:.2} Hz"))
            .collect();
        let rest = self.rest.iter().map(|rest| (STATIC_FIELD, rest.clone()));
        let shapes = names.iter().map(String::as_str).zip(self.shapes.iter().cloned());
        let vectors: Vec<(&str, Vec<[f64; 3]>)> = rest.chain(shapes).collect();
        VtuGrid::of_mesh(&self.mesh.deck).to_text(&vectors, &[])
    }

    /// Displacement of a node at rest by all loads \[m\]; none for a node that the mesh does not have, or where the flexible shapes
    /// are too many to be kept.
    pub fn at_rest(&self, node: i64) -> Option<[f64; 3]> {
        let place = self.mesh.deck.nodes().numbers().position(|number| number == node)?;
        self.rest.as_ref().map(|rest| rest[place])
    }

    /// Name of the body.
    pub fn body(&self) -> &str {
        &self.mesh.name
    }

    /// Places of the nodes \[m\], ascending by their numbers.
    pub fn places(&self) -> Vec<[f64; 3]> {
        self.mesh.places()
    }

    /// Edges of the faces that are turned to `eye`, a vector towards it, by the numbers of their ends among the
    /// [places](Self::places).
    pub fn edges_seen(&self, eye: [f64; 3]) -> Vec<[usize; 2]> {
        self.mesh.edges_seen(eye)
    }

    /// Frequency \[Hz\] of each mode, and its displacements of the nodes \[kg^-1/2\].
    pub fn shapes(&self) -> impl Iterator<Item = (f64, &[[f64; 3]])> {
        self.modes.iter().zip(&self.shapes).map(|([frequency, _], shape)| (*frequency, &shape[..]))
    }

    /// A universal file: units (dataset 164), nodes (2411), lines along the edges of free faces (82), the displacements at rest
    /// and a normal mode each (55), whose modal mass is 1.
    pub fn universal_file(&self) -> String {
        let rest = self.rest.iter().map(|rest| UniversalField {
            name: STATIC_FIELD.to_owned(),
            analysis: Analysis::Static,
            displacements: rest,
        });
        let modes = (1..).zip(&self.modes).zip(&self.shapes);
        let modes = modes.map(|((number, &[frequency, ratio]), shape)| UniversalField {
            name: format!("mode {number}"),
            analysis: Analysis::Mode(number, frequency, ratio),
            displacements: shape,
        });
        let fields: Vec<UniversalField<'_>> = rest.chain(modes).collect();
        universal_file(&self.mesh.name, &self.mesh.deck, &fields)
    }
}
