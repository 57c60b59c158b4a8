//! Matrices of a deck of 20-node hexahedra with equations between degrees of freedom, as a finite-element program writes them.

use std::collections::{BTreeMap, HashMap};
use std::fs::File;
use std::io::{BufWriter, Write as _};
use std::path::Path;

use crate::hexahedron;

/// A degree of freedom: node, and axis from one.
pub(crate) type Freedom = (u32, u32);

/// Nodes, elements and equations of a deck, of one material.
pub(crate) struct Bricks {
    nodes: HashMap<u32, [f64; 3]>,
    elements: Vec<[u32; 20]>,
    /// The first freedom of each equation by the others.
    dependent: HashMap<Freedom, Vec<(Freedom, f64)>>,
    /// Young's modulus \[Pa\], Poisson's ratio, density \[kg/m3\].
    material: [f64; 3],
}

impl Bricks {
    /// Reads the lists of a deck.
    pub(crate) fn read(deck: &str) -> Self {
        let [mut modulus, mut poisson, mut density] = [f64::NAN; 3];
        let mut found = Self {
            nodes: HashMap::new(),
            elements: Vec::new(),
            dependent: HashMap::new(),
            material: [0.0; 3],
        };
        for block in deck.split("\n*") {
            let (title, list) = block.split_once('\n').unwrap_or((block, ""));
            let numbers: Vec<f64> = list
                .split([',', '\n'])
                .filter(|text| !text.trim().is_empty())
                .map_while(|text| text.trim().parse().ok())
                .collect();
            match title.split(',').next().unwrap_or_default() {
                "NODE" => found.nodes.extend(
                    numbers.chunks_exact(4).map(|one| (one[0] as u32, [one[1], one[2], one[3]])),
                ),
                "ELEMENT" => found.elements.extend(
                    numbers
                        .chunks_exact(21)
                        .map(|one| std::array::from_fn(|node| one[node + 1] as u32)),
                ),
                "ELASTIC" => (modulus, poisson) = (numbers[0], numbers[1]),
                "DENSITY" => density = numbers[0],
                "EQUATION" => {
                    let terms: Vec<(Freedom, f64)> = numbers[1..]
                        .chunks_exact(3)
                        .map(|one| ((one[0] as u32, one[1] as u32), one[2]))
                        .collect();
                    assert_eq!(terms.len() as f64, numbers[0], "an equation is cut off");
                    let (first, others) = terms.split_first().unwrap();
                    let others = others.iter().map(|(at, c)| (*at, -c / first.1)).collect();
                    found.dependent.insert(first.0, others);
                }
                _ => {}
            }
        }
        found.material = [modulus, poisson, density];
        found
    }

    /// Writes `NAME.sti`, `NAME.mas` and `NAME.dof` in the form of CalculiX, and gives the traces of stiffness and mass.
    pub(crate) fn write(&self, folder: &Path, name: &str) -> [f64; 2] {
        let mut freedoms: Vec<Freedom> = self
            .nodes
            .keys()
            .flat_map(|&node| [1, 2, 3].map(|axis| (node, axis)))
            .filter(|at| !self.dependent.contains_key(at))
            .collect();
        freedoms.sort_unstable();
        let row: HashMap<Freedom, usize> =
            freedoms.iter().enumerate().map(|(row, at)| (*at, row)).collect();
        let terms = |at: Freedom| -> Vec<(usize, f64)> {
            match self.dependent.get(&at) {
                Some(others) => others.iter().map(|(other, c)| (row[other], *c)).collect(),
                None => vec![(row[&at], 1.0)],
            }
        };
        // Columns of the upper triangle.
        let mut columns: Vec<BTreeMap<usize, [f64; 2]>> = vec![BTreeMap::new(); freedoms.len()];
        for element in &self.elements {
            let places = element.map(|node| self.nodes[&node]);
            let (stiffness, mass) = hexahedron::element(&places, self.material);
            let own: Vec<Vec<(usize, f64)>> =
                (0..60).map(|a| terms((element[a / 3], a as u32 % 3 + 1))).collect();
            for (a, rows) in own.iter().enumerate() {
                for (b, others) in own.iter().enumerate() {
                    let m = if a % 3 == b % 3 { mass[a / 3][b / 3] } else { 0.0 };
                    for &(row, c) in rows {
                        for &(column, d) in others.iter().filter(|other| other.0 >= row) {
                            let entry = columns[column].entry(row).or_default();
                            entry[0] += c * d * stiffness[a][b];
                            entry[1] += c * d * m;
                        }
                    }
                }
            }
        }
        let open = |ending: &str| {
            BufWriter::new(File::create(folder.join(format!("{name}.{ending}"))).unwrap())
        };
        let [mut listed, mut stiffness, mut mass] = ["dof", "sti", "mas"].map(open);
        for (node, axis) in &freedoms {
            writeln!(listed, "{node}.{axis}").unwrap();
        }
        let mut traces = [0.0; 2];
        for (column, rows) in columns.iter().enumerate() {
            for (row, [k, m]) in rows {
                writeln!(stiffness, "{} {} {k:.13e}", row + 1, column + 1).unwrap();
                writeln!(mass, "{} {} {m:.13e}", row + 1, column + 1).unwrap();
                if *row == column {
                    traces = [traces[0] + k, traces[1] + m];
                }
            }
        }
        traces
    }
}
