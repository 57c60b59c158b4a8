//! Shapes of modes on the meshes of bodies, and their files: VTU, and universal files for modal programs.
//!
//! A shape is the sum of the component modes kept; the flexibility of the others, a local deformation about the
//! cells, is not in it.

use std::fmt::Write as _;
use std::path::Path;

use asperity_matrices::{Deck, VtuGrid};
use asperity_scenario::StructureScenario;

use super::body::read_deck;
use super::kept_reduction::{self, ReductionKey};
use super::modes::PatchModes;
use super::structure::{PatchStructure, reduced};
use crate::error::SimulationError;

/// Modes on the mesh of a body.
#[derive(Debug, Clone)]
pub struct MeshModes {
    /// Name of the body.
    pub body: String,
    deck: Deck,
    /// Frequency \[Hz\] and damping ratio of each mode.
    modes: Vec<[f64; 2]>,
    /// Displacements of the nodes, ascending, by modes \[kg^-1/2\].
    shapes: Vec<Vec<[f64; 3]>>,
}

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
    if scenario.bodies.iter().all(|body| body.mesh.is_none()) {
        return Ok(Vec::new());
    }
    let key = ReductionKey::new(folder, scenario)?;
    let all = match kept_reduction::find_shapes(folder, &key) {
        Some(shapes) => shapes,
        None => reduced(scenario, folder, &key)?.2,
    };
    let mut meshes = Vec::new();
    let mut first = 0;
    for ((body, own), &count) in scenario.bodies.iter().zip(&all).zip(&structure.modes_per_body) {
        let range = first..first + count;
        first += count;
        let Some(deck) = read_deck(body, folder)?.filter(|_| own.shapes.ncols() == count) else {
            continue;
        };
        let numbers: Vec<i64> = deck.nodes().numbers().collect();
        let shape = |mode: &asperity_structure::PortMode| {
            let mut displacements = vec![[0.0; 3]; numbers.len()];
            for (row, dof) in own.dofs.iter().enumerate().filter(|(_, dof)| dof.direction <= 3) {
                let Ok(node) = numbers.binary_search(&dof.node) else { continue };
                let parts = mode.coordinates[range.clone()].iter().enumerate();
                displacements[node][usize::from(dof.direction) - 1] =
                    parts.map(|(n, q)| q * own.shapes[(row, n)]).sum();
            }
            displacements
        };
        meshes.push(MeshModes {
            body: body.name.clone(),
            modes: found.modes.iter().map(|one| [one.frequency_hz, one.damping_ratio]).collect(),
            shapes: found.modes.iter().map(shape).collect(),
            deck,
        });
    }
    Ok(meshes)
}

impl MeshModes {
    /// The mesh with a vector field for each mode, as a grid of `ParaView`.
    pub fn grid(&self) -> String {
        let names: Vec<String> = (1..)
            .zip(&self.modes)
            .map(|(number, [frequency, _])| format!("mode {number}: {frequency:.2} Hz"))
            .collect();
        let vectors: Vec<(&str, Vec<[f64; 3]>)> =
            names.iter().map(String::as_str).zip(self.shapes.iter().cloned()).collect();
        VtuGrid::of_mesh(&self.deck).to_text(&vectors, &[])
    }

    /// A universal file: units (dataset 164), nodes (2411), and a normal mode each (55), whose modal mass is 1.
    pub fn universal_file(&self) -> String {
        let mut text = String::new();
        let line = |text: &mut String, content: &str| {
            text.push_str(content);
            text.push('\n');
        };
        line(&mut text, "    -1\n   164");
        line(&mut text, &format!("{:>10}{:<20}{:>10}", 1, "SI: m, N, s", 2));
        line(&mut text, &format!("{0}{0}{0}\n{1}", exponent(1.0, 25, 17), exponent(0.0, 25, 17)));
        line(&mut text, "    -1\n    -1\n  2411");
        for (node, place) in self.deck.nodes().iter() {
            line(&mut text, &format!("{node:>10}{:>10}{:>10}{:>10}", 1, 1, 11));
            line(&mut text, &place.map(|x| exponent(x, 25, 16)).concat());
        }
        line(&mut text, "    -1");
        for ((number, [frequency, ratio]), shape) in (1..).zip(&self.modes).zip(&self.shapes) {
            line(&mut text, "    -1\n    55");
            let _ = writeln!(text, "{}\nmode {number}\nNONE\nNONE\nNONE", header(&self.body));
            // Structural, normal mode, three translations, displacement, real, three numbers a node.
            line(&mut text, &[1, 2, 2, 8, 2, 3].map(|code| format!("{code:>10}")).concat());
            line(&mut text, &[2, 4, 1, number].map(|code| format!("{code:>10}")).concat());
            line(&mut text, &[*frequency, 1.0, *ratio, 0.0].map(|x| exponent(x, 13, 5)).concat());
            for (node, displacement) in self.deck.nodes().numbers().zip(shape) {
                line(&mut text, &format!("{node:>10}"));
                line(&mut text, &displacement.map(|x| exponent(x, 13, 5)).concat());
            }
            line(&mut text, "    -1");
        }
        text
    }
}

/// A header line: at most 80 characters.
fn header(text: &str) -> String {
    text.chars().take(80).collect()
}

/// A number in `width` characters, with `digits` digits after the point and two of the exponent at least.
fn exponent(value: f64, width: usize, digits: usize) -> String {
    let text = format!("{value:.digits$e}");
    let (mantissa, power) = text.split_once('e').unwrap_or((&text, "0"));
    let (sign, power) = match power.strip_prefix('-') {
        Some(power) => ('-', power),
        None => ('+', power),
    };
    let text = format!("{mantissa}E{sign}{power:0>2}");
    format!("{text:>width$}")
}
