//! Shapes of modes and static displacements on the meshes of bodies, and their files: VTU, and universal files for modal
//! programs.
//!
//! A shape is the sum of the component modes kept; the flexibility of the others, a local deformation about the
//! cells, is not in it. Static displacements have both.

use std::fmt::Write as _;
use std::path::Path;

use asperity_matrices::{Deck, VtuGrid};
use asperity_scenario::StructureScenario;

use super::body::read_deck;
use super::kept_reduction::{self, ReductionKey};
use super::modes::PatchModes;
use super::structure::{PatchStructure, StaticMotion, reduced};
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
    /// Displacements of the nodes at rest by all loads \[m\], where the flexible shapes are kept.
    rest: Option<Vec<[f64; 3]>>,
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
    let bodies = scenario.bodies.iter().zip(&all).zip(&structure.own_ports);
    for (((body, own), ports), &count) in bodies.zip(&structure.modes_per_body) {
        let range = first..first + count;
        first += count;
        let Some(deck) = read_deck(body, folder)?.filter(|_| own.shapes.ncols() == count) else {
            continue;
        };
        let numbers: Vec<i64> = deck.nodes().numbers().collect();
        let at_nodes = |of_row: &dyn Fn(usize) -> f64| {
            let mut displacements = vec![[0.0; 3]; numbers.len()];
            for (row, dof) in own.dofs.iter().enumerate().filter(|(_, dof)| dof.direction <= 3) {
                if let Ok(node) = numbers.binary_search(&dof.node) {
                    displacements[node][usize::from(dof.direction) - 1] = of_row(row);
                }
            }
            displacements
        };
        let carried = |coordinates: &[f64], row: usize| -> f64 {
            let parts = coordinates[range.clone()].iter().enumerate();
            parts.map(|(n, q)| q * own.shapes[(row, n)]).sum()
        };
        let shape =
            |mode: &asperity_structure::PortMode| at_nodes(&|row| carried(&mode.coordinates, row));
        let StaticMotion { coordinates, port_forces } = &structure.static_motion;
        let rest = |row: usize| {
            let yielded = ports.iter().enumerate();
            let yielded = yielded.map(|(k, &port)| own.flexible[(row, k)] * port_forces[port]);
            carried(coordinates, row) + yielded.sum::<f64>()
        };
        meshes.push(MeshModes {
            body: body.name.clone(),
            modes: found.modes.iter().map(|one| [one.frequency_hz, one.damping_ratio]).collect(),
            shapes: found.modes.iter().map(shape).collect(),
            rest: (own.flexible.ncols() == ports.len()).then(|| at_nodes(&rest)),
            deck,
        });
    }
    Ok(meshes)
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
        VtuGrid::of_mesh(&self.deck).to_text(&vectors, &[])
    }

    /// Displacement of a node at rest by all loads \[m\]; none for a node that the mesh does not have, or where the flexible shapes
    /// are too many to be kept.
    pub fn at_rest(&self, node: i64) -> Option<[f64; 3]> {
        let place = self.deck.nodes().numbers().position(|number| number == node)?;
        self.rest.as_ref().map(|rest| rest[place])
    }

    /// Name of the body.
    pub fn body(&self) -> &str {
        &self.body
    }

    /// Places of the nodes \[m\], ascending by their numbers.
    pub fn places(&self) -> Vec<[f64; 3]> {
        self.deck.nodes().iter().map(|(_, place)| place).collect()
    }

    /// Edges of the faces that are turned to `eye`, a vector towards it, by the numbers of their ends among the
    /// [places](Self::places).
    pub fn edges_seen(&self, eye: [f64; 3]) -> Vec<[usize; 2]> {
        let numbers: Vec<i64> = self.deck.nodes().numbers().collect();
        let place = |node: i64| numbers.binary_search(&node).ok();
        let edges = self.deck.edges_seen(eye).into_iter();
        edges.filter_map(|[a, b]| Some([place(a)?, place(b)?])).collect()
    }

    /// Frequency \[Hz\] of each mode, and its displacements of the nodes \[kg^-1/2\].
    pub fn shapes(&self) -> impl Iterator<Item = (f64, &[[f64; 3]])> {
        self.modes.iter().zip(&self.shapes).map(|([frequency, _], shape)| (*frequency, &shape[..]))
    }

    /// A universal file: units (dataset 164), nodes (2411), lines along the edges of free faces (82), the displacements at rest
    /// and a normal mode each (55), whose modal mass is 1.
    pub fn universal_file(&self) -> String {
        let mut text = String::new();
        push_line(&mut text, "    -1\n   164");
        push_line(&mut text, &format!("{:>10}{:<20}{:>10}", 1, "SI: m, N, s", 2));
        let (one, zero) = (exponent(1.0, 25, 17), exponent(0.0, 25, 17));
        push_line(&mut text, &format!("{one}{one}{one}\n{zero}"));
        push_line(&mut text, "    -1\n    -1\n  2411");
        for (node, place) in self.deck.nodes().iter() {
            push_line(&mut text, &integers(&[node, 1, 1, 11]));
            push_line(&mut text, &place.map(|x| exponent(x, 25, 16)).concat());
        }
        push_line(&mut text, "    -1");
        let edges: Vec<[i64; 2]> = self.deck.free_edges();
        for (number, edges) in (1_usize..).zip(edges.chunks(EDGES_OF_LINE)) {
            push_line(&mut text, "    -1\n    82");
            // Zero lifts the pen.
            let nodes: Vec<i64> = edges.iter().flat_map(|&[a, b]| [a, b, 0]).collect();
            push_line(&mut text, &format!("{number:>10}{:>10}{:>10}", nodes.len(), 8));
            push_line(&mut text, &header(&self.body));
            for nodes in nodes.chunks(8) {
                push_line(&mut text, &integers(nodes));
            }
            push_line(&mut text, "    -1");
        }
        if let Some(rest) = &self.rest {
            // Static, load case 1.
            self.push_field(&mut text, (STATIC_FIELD, 1), &[1, 1, 1], &[0.0], rest);
        }
        for ((number, [frequency, ratio]), shape) in (1..).zip(&self.modes).zip(&self.shapes) {
            let name = format!("mode {number}");
            let numbers = [*frequency, 1.0, *ratio, 0.0];
            self.push_field(&mut text, (&name, 2), &[2, 4, 1, number], &numbers, shape);
        }
        text
    }

    /// Adds displacements of the nodes as a dataset 55 of an analysis, with its specific whole numbers and numbers.
    fn push_field(
        &self,
        text: &mut String,
        (name, analysis): (&str, i64),
        whole: &[i64],
        numbers: &[f64],
        field: &[[f64; 3]],
    ) {
        push_line(text, "    -1\n    55");
        push_line(text, &format!("{}\n{name}\nNONE\nNONE\nNONE", header(&self.body)));
        // Structural, three translations, displacement, real, three numbers a node.
        push_line(text, &integers(&[1, analysis, 2, 8, 2, 3]));
        push_line(text, &integers(whole));
        push_line(text, &numbers.iter().map(|x| exponent(*x, 13, 5)).collect::<String>());
        for (node, displacement) in self.deck.nodes().numbers().zip(field) {
            push_line(text, &integers(&[node]));
            push_line(text, &displacement.map(|x| exponent(x, 13, 5)).concat());
        }
        push_line(text, "    -1");
    }
}

/// Name of the displacements at rest.
const STATIC_FIELD: &str = "displacement at rest";

/// Edges of a trace line, which has at most 250 entries.
const EDGES_OF_LINE: usize = 83;

fn push_line(text: &mut String, content: &str) {
    text.push_str(content);
    text.push('\n');
}

/// Whole numbers in ten characters each.
fn integers(numbers: &[i64]) -> String {
    let mut text = String::new();
    for number in numbers {
        let _ = write!(text, "{number:>10}");
    }
    text
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
