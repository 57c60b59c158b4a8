//! Solids of 20-node hexahedra on graded grids: matrices and meshes as a finite-element program writes them.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use anyhow::Result;

use crate::hexahedron::{self, NODES};

/// Lines of a grid along x, y and z \[m\].
pub(crate) type Lines = [Vec<f64>; 3];

/// A linear elastic material.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Material {
    /// Young's modulus \[Pa\].
    pub(crate) youngs_modulus: f64,
    /// Poisson's ratio.
    pub(crate) poisson: f64,
    /// Density \[kg/m3\].
    pub(crate) density: f64,
}

/// A block of elements between the lines of a grid.
#[derive(Debug)]
pub(crate) struct Solid {
    nodes: Vec<[f64; 3]>,
    elements: Vec<[usize; 20]>,
    material: Material,
    /// Held degrees of freedom: node, and axis from zero.
    held: Vec<(usize, usize)>,
    /// Named faces: element, and number of the face from one.
    surfaces: Vec<(String, Vec<(usize, usize)>)>,
}

impl Solid {
    /// The block of all cells of a grid.
    pub(crate) fn block(lines: &Lines, material: Material) -> Self {
        let counts = [0, 1, 2].map(|axis| 2 * (lines[axis].len() - 1) + 1);
        let place = |axis: usize, i: usize| {
            let line = &lines[axis];
            if i.is_multiple_of(2) { line[i / 2] } else { 0.5 * (line[i / 2] + line[i / 2 + 1]) }
        };
        let mut numbers = vec![None; counts.iter().product()];
        let at = |[i, j, k]: [usize; 3]| (k * counts[1] + j) * counts[0] + i;
        let mut nodes = Vec::new();
        for k in 0..counts[2] {
            for j in 0..counts[1] {
                for i in 0..counts[0] {
                    if (i % 2) + (j % 2) + (k % 2) <= 1 {
                        numbers[at([i, j, k])] = Some(nodes.len());
                        nodes.push([place(0, i), place(1, j), place(2, k)]);
                    }
                }
            }
        }
        let mut elements = Vec::new();
        for k in (0..counts[2] - 1).step_by(2) {
            for j in (0..counts[1] - 1).step_by(2) {
                for i in (0..counts[0] - 1).step_by(2) {
                    elements.push(NODES.map(|offset| {
                        let along = |from: usize, axis: usize| from + (offset[axis] + 1.0) as usize;
                        numbers[at([along(i, 0), along(j, 1), along(k, 2)])].unwrap_or_default()
                    }));
                }
            }
        }
        Self { nodes, elements, material, held: Vec::new(), surfaces: Vec::new() }
    }

    /// The nodes in the plane where the coordinate along an axis is `value`.
    fn in_plane(&self, axis: usize, value: f64) -> impl Iterator<Item = usize> {
        let near = move |place: &[f64; 3]| (place[axis] - value).abs() < 1e-9;
        (0..self.nodes.len()).filter(move |&node| near(&self.nodes[node]))
    }

    /// Holds the motion along an axis in a plane of symmetry across it.
    pub(crate) fn hold_plane(&mut self, axis: usize, value: f64) {
        let nodes: Vec<usize> = self.in_plane(axis, value).collect();
        self.held.extend(nodes.into_iter().map(|node| (node, axis)));
    }

    /// Names the faces across z at `height` whose x and y are at most `reach`.
    pub(crate) fn name_surface(&mut self, name: &str, height: f64, reach: f64) {
        // Faces 1 and 2 of the element are its lower and its upper one.
        let faces = |(number, element): (usize, &[usize; 20])| {
            let of = |corners: std::ops::Range<usize>| {
                element[corners].iter().all(|&node| {
                    let [x, y, z] = self.nodes[node];
                    (z - height).abs() < 1e-9 && x.max(y) < reach + 1e-9
                })
            };
            match (of(0..4), of(4..8)) {
                (true, _) => Some((number, 1)),
                (_, true) => Some((number, 2)),
                _ => None,
            }
        };
        let found = self.elements.iter().enumerate().filter_map(faces).collect();
        self.surfaces.push((name.to_owned(), found));
    }

    /// Number, from one, of the node nearest to a place.
    pub(crate) fn node_at(&self, place: [f64; 3]) -> usize {
        let off =
            |node: &[f64; 3]| -> f64 { node.iter().zip(place).map(|(a, b)| (a - b).powi(2)).sum() };
        let places = self.nodes.iter().map(off).enumerate();
        1 + places.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(number, _)| number)
    }

    /// Writes `NAME.sti`, `NAME.mas`, `NAME.dof` and `NAME.inp` as CalculiX does.
    pub(crate) fn write(&self, folder: &Path, name: &str) -> Result<()> {
        let mut rows = vec![None; 3 * self.nodes.len()];
        let mut listed = String::new();
        let mut count = 0;
        for (place, row) in rows.iter_mut().enumerate() {
            if !self.held.contains(&(place / 3, place % 3)) {
                count += 1;
                *row = Some(count);
                writeln!(listed, "{}.{}", place / 3 + 1, place % 3 + 1)?;
            }
        }
        let mut entries: Vec<(usize, usize, f64, f64)> = Vec::new();
        for element in &self.elements {
            let (stiffness, mass) = self.element(element);
            for a in 0..60 {
                let Some(row) = rows[3 * element[a / 3] + a % 3] else { continue };
                for b in 0..60 {
                    let Some(column) = rows[3 * element[b / 3] + b % 3] else { continue };
                    if row <= column {
                        let m = if a % 3 == b % 3 { mass[a / 3][b / 3] } else { 0.0 };
                        entries.push((column, row, stiffness[a][b], m));
                    }
                }
            }
        }
        entries.sort_by_key(|&(column, row, ..)| (column, row));
        let (mut stiffness, mut mass) = (String::new(), String::new());
        for same in entries.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
            let (column, row, ..) = same[0];
            let k: f64 = same.iter().map(|entry| entry.2).sum();
            let m: f64 = same.iter().map(|entry| entry.3).sum();
            writeln!(stiffness, "{row} {column} {k:.13e}")?;
            writeln!(mass, "{row} {column} {m:.13e}")?;
        }
        for (ending, text) in
            [("sti", stiffness), ("mas", mass), ("dof", listed), ("inp", self.deck()?)]
        {
            fs::write(folder.join(format!("{name}.{ending}")), text)?;
        }
        Ok(())
    }

    /// Nodes, elements and surfaces as an input deck.
    fn deck(&self) -> Result<String> {
        let mut deck = String::from("*NODE\n");
        for (number, [x, y, z]) in self.nodes.iter().enumerate() {
            writeln!(deck, "{}, {x:.12e}, {y:.12e}, {z:.12e}", number + 1)?;
        }
        deck.push_str("*ELEMENT, TYPE=C3D20, ELSET=SOLID\n");
        for (number, element) in self.elements.iter().enumerate() {
            let names: Vec<String> = element.iter().map(|node| (node + 1).to_string()).collect();
            writeln!(deck, "{}, {},", number + 1, names[..10].join(", "))?;
            writeln!(deck, "{}", names[10..].join(", "))?;
        }
        for (name, faces) in &self.surfaces {
            writeln!(deck, "*SURFACE, NAME={name}, TYPE=ELEMENT")?;
            for (element, face) in faces {
                writeln!(deck, "{}, S{face}", element + 1)?;
            }
        }
        Ok(deck)
    }

    /// Stiffness and mass of an element.
    fn element(&self, element: &[usize; 20]) -> (Vec<[f64; 60]>, Vec<[f64; 20]>) {
        let Material { youngs_modulus, poisson, density } = self.material;
        hexahedron::element(
            &element.map(|node| self.nodes[node]),
            [youngs_modulus, poisson, density],
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    type Field = fn([f64; 3]) -> [f64; 3];

    const STEEL: Material = Material { youngs_modulus: 2e11, poisson: 0.3, density: 7800.0 };

    /// Uniform strains have their exact energy, rigid motions none, and the mass is the block's.
    #[test]
    fn elements_pass_the_patch_test() {
        let lines = [vec![0.0, 0.01, 0.03], vec![0.0, 0.02], vec![0.0, 0.005, 0.02]];
        let solid = Solid::block(&lines, STEEL);
        let volume = 0.03 * 0.02 * 0.02;
        let lame = 2e11 * 0.3 / (1.3 * 0.4);
        let shear = 2e11 / 2.6;
        let fields: [(Field, f64); 4] = [
            (|[x, ..]| [1e-3 * x, 0.0, 0.0], 0.5e-6 * (lame + 2.0 * shear)),
            (|[_, y, _]| [1e-3 * y, 0.0, 0.0], 0.5e-6 * shear),
            (|[x, y, z]| [1e-3 * x, 1e-3 * y, 1e-3 * z], 0.5e-6 * (9.0 * lame + 6.0 * shear)),
            (|[x, y, _]| [1e-3 - 1e-3 * y, 1e-3 * x, 2e-3], 0.0),
        ];
        for (field, density) in fields {
            let (mut energy, mut mass) = (0.0, 0.0);
            for element in &solid.elements {
                let moved: Vec<f64> =
                    element.iter().flat_map(|&node| field(solid.nodes[node])).collect();
                let (stiffness, masses) = solid.element(element);
                for (row, a) in stiffness.iter().zip(&moved) {
                    energy += 0.5 * row.iter().zip(&moved).map(|(k, b)| k * a * b).sum::<f64>();
                }
                mass += masses.iter().flatten().sum::<f64>();
            }
            let scale = 1e-6 * shear * volume;
            assert!((energy - density * volume).abs() < 1e-8 * scale, "{energy} {density}");
            assert!((mass - 7800.0 * volume).abs() < 1e-12);
        }
    }
}
