//! Motion of meshes and pressures of cells at instants of a response, and their files.

use std::fmt::Write as _;
use std::path::Path;

use asperity_matrices::VtuGrid;
use asperity_scenario::StructureScenario;

use super::body_mesh::{BodyMesh, body_meshes};
use super::mode_shapes::STATIC_FIELD;
use super::patch_map::patch_maps;
use super::run::PatchRun;
use super::universal_file::{Analysis, UniversalField, universal_file};
use super::{PatchMap, patch_grid};
use crate::error::SimulationError;

/// Name of the displacements at an instant.
const FIELD: &str = "displacement";

/// Displacements on the mesh of a body at instants of a response, from rest and relative to the base.
#[derive(Debug, Clone)]
pub struct MeshMotion {
    mesh: BodyMesh,
    /// Time of each instant \[s\], and the displacements of the nodes then, ascending \[m\].
    instants: Vec<(f64, Vec<[f64; 3]>)>,
    /// Displacements of the nodes at rest by all loads \[m\], where the flexible shapes are kept.
    rest: Option<Vec<[f64; 3]>>,
}

impl PatchRun {
    /// The motion of the meshes of the bodies that have one, at the instants of the run. `scenario` is that of the run, whose
    /// files are looked for in `folder`.
    ///
    /// # Errors
    /// Those of [`assemble_patches`](super::assemble_patches).
    pub fn mesh_motions(
        &self,
        scenario: &StructureScenario,
        folder: &Path,
    ) -> Result<Vec<MeshMotion>, SimulationError> {
        if self.states.is_empty() {
            return Ok(Vec::new());
        }
        let structure = &self.run.assembly.structure;
        let motions: Vec<_> =
            self.states.iter().map(|state| (state.time, structure.motions(state))).collect();
        let on_mesh = |mesh: BodyMesh| MeshMotion {
            instants: motions
                .iter()
                .map(|(time, motions)| (*time, mesh.displacements(&motions[mesh.number])))
                .collect(),
            rest: mesh.is_flexible().then(|| mesh.displacements(&structure.rest[mesh.number])),
            mesh,
        };
        Ok(body_meshes(scenario, structure, folder)?.into_iter().map(on_mesh).collect())
    }

    /// The cells at each instant of the run, as grids of `ParaView`; none where no cells have places.
    ///
    /// # Errors
    /// Those of [`patch_maps`].
    pub fn cell_grids(
        &self,
        scenario: &StructureScenario,
        folder: &Path,
    ) -> Result<Vec<String>, SimulationError> {
        if self.states.is_empty() {
            return Ok(Vec::new());
        }
        let structure = &self.run.assembly.structure;
        let maps = patch_maps(scenario, structure, folder)?;
        let at = |state| {
            let moved = |map: &PatchMap| {
                let patch = structure.patches.iter().find(|patch| patch.name == map.name);
                patch.map_or_else(|| map.clone(), |patch| map.at(patch, state))
            };
            patch_grid(&maps.iter().map(moved).collect::<Vec<_>>())
        };
        Ok(self.states.iter().filter_map(at).collect())
    }
}

impl MeshMotion {
    /// Name of the body.
    pub fn body(&self) -> &str {
        &self.mesh.name
    }

    /// Number of each node, ascending.
    pub fn nodes(&self) -> impl Iterator<Item = i64> {
        self.mesh.deck.nodes().numbers()
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

    /// Time of each instant \[s\], and the displacements of the nodes then \[m\].
    pub fn instants(&self) -> impl ExactSizeIterator<Item = (f64, &[[f64; 3]])> {
        self.instants.iter().map(|(time, displacements)| (*time, &displacements[..]))
    }

    /// The mesh at each instant, with the displacements then and those at rest, as grids of `ParaView`.
    pub fn grids(&self) -> impl Iterator<Item = String> {
        let grid = VtuGrid::of_mesh(&self.mesh.deck);
        self.instants.iter().map(move |(_, displacements)| {
            let rest = self.rest.iter().map(|rest| (STATIC_FIELD, rest.clone()));
            let fields = std::iter::once((FIELD, displacements.clone())).chain(rest);
            grid.to_text(&fields.collect::<Vec<_>>(), &[])
        })
    }

    /// A universal file: units (dataset 164), nodes (2411), lines along the edges of free faces (82), and the displacements
    /// at each instant (55).
    pub fn universal_file(&self) -> String {
        let fields: Vec<UniversalField<'_>> = (1..)
            .zip(&self.instants)
            .map(|(number, (time, displacements))| UniversalField {
                name: FIELD.to_owned(),
                analysis: Analysis::Transient(number, *time),
                displacements,
            })
            .collect();
        universal_file(&self.mesh.name, &self.mesh.deck, &fields)
    }
}

/// A collection of `ParaView`: for each instant its time \[s\] and the files of its parts.
pub fn time_series(instants: &[(f64, Vec<String>)]) -> String {
    let mut text = String::from(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n<Collection>\n",
    );
    for (time, files) in instants {
        for (part, file) in files.iter().enumerate() {
            let _ = writeln!(
                text,
                "<DataSet timestep=\"{time:e}\" group=\"\" part=\"{part}\" file=\"{file}\"/>"
            );
        }
    }
    text.push_str("</Collection>\n</VTKFile>\n");
    text
}
