//! VTU files, unstructured grids as `ParaView` reads them.
//!
//! Source: "VTK file formats", XML formats, version 1.0, numbers as text.

use std::fmt::Write as _;

use crate::{Deck, ElementKind};

/// An unstructured grid with numbers at its points and cells.
///
/// ```
/// use asperity_matrices::VtuGrid;
///
/// let mut grid = VtuGrid::default();
/// grid.add_polygon(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
/// let text = grid.to_text(&[], &[("pressure_pa", vec![1e6])]);
/// assert!(text.contains("Name=\"pressure_pa\""));
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
pub struct VtuGrid {
    points: Vec<[f64; 3]>,
    /// Points of each cell, and its kind.
    cells: Vec<(Vec<usize>, u8)>,
}

/// Kinds of cells.
const VERTEX: u8 = 1;
const POLYGON: u8 = 7;

impl VtuGrid {
    /// The nodes of a mesh, ascending, with its solid elements of known shape.
    pub fn of_mesh(deck: &Deck) -> Self {
        let numbers: Vec<i64> = deck.nodes().numbers().collect();
        let cell = |element: &crate::MeshElement| {
            let kind = match element.kind {
                ElementKind::Tetrahedron4 => 10,
                ElementKind::Hexahedron8 => 12,
                ElementKind::Wedge6 => 13,
                ElementKind::Tetrahedron10 => 24,
                ElementKind::Hexahedron20 => 25,
                ElementKind::Wedge15 => 26,
                ElementKind::Other => return None,
            };
            let nodes = element.nodes.iter().map(|node| numbers.binary_search(node).ok());
            Some((nodes.collect::<Option<Vec<usize>>>()?, kind))
        };
        let points = deck.nodes().iter().map(|(_, place)| place).collect();
        Self { points, cells: deck.elements().iter().filter_map(cell).collect() }
    }

    /// Adds a plane polygon, or a point where it has one corner, as a cell with points of its own.
    pub fn add_polygon(&mut self, corners: &[[f64; 3]]) {
        let first = self.points.len();
        self.points.extend(corners);
        let kind = if corners.len() == 1 { VERTEX } else { POLYGON };
        self.cells.push(((first..self.points.len()).collect(), kind));
    }

    /// The file, with vectors at the points and numbers at the cells, by their names.
    ///
    /// # Panics
    /// If there is not one vector a point and one number a cell.
    pub fn to_text(
        &self,
        vectors: &[(&str, Vec<[f64; 3]>)],
        numbers: &[(&str, Vec<f64>)],
    ) -> String {
        let Self { points, cells } = self;
        let mut text = format!(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\">\n\
             <UnstructuredGrid>\n<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n<Points>\n",
            points.len(),
            cells.len()
        );
        array(&mut text, "Float64", "Points", Some(3), points.iter().map(triple));
        text.push_str("</Points>\n<Cells>\n");
        let connectivity = cells.iter().map(|(points, _)| {
            points.iter().map(ToString::to_string).collect::<Vec<_>>().join(" ")
        });
        array(&mut text, "Int64", "connectivity", None, connectivity);
        let ends = cells.iter().scan(0, |end, (points, _)| {
            *end += points.len();
            Some(end.to_string())
        });
        array(&mut text, "Int64", "offsets", None, ends);
        array(&mut text, "UInt8", "types", None, cells.iter().map(|(_, kind)| kind.to_string()));
        text.push_str("</Cells>\n<PointData>\n");
        for (name, values) in vectors {
            assert_eq!(values.len(), points.len(), "vectors at points");
            array(&mut text, "Float64", name, Some(3), values.iter().map(triple));
        }
        text.push_str("</PointData>\n<CellData>\n");
        for (name, values) in numbers {
            assert_eq!(values.len(), cells.len(), "numbers at cells");
            array(
                &mut text,
                "Float64",
                name,
                None,
                values.iter().map(|value| format!("{value:e}")),
            );
        }
        text.push_str("</CellData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n");
        text
    }
}

fn triple([x, y, z]: &[f64; 3]) -> String {
    format!("{x:e} {y:e} {z:e}")
}

fn array(
    text: &mut String,
    kind: &str,
    name: &str,
    components: Option<u8>,
    lines: impl Iterator<Item = String>,
) {
    let name = name.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;");
    let _ = write!(text, "<DataArray type=\"{kind}\" Name=\"{name}\" format=\"ascii\"");
    if let Some(components) = components {
        let _ = write!(text, " NumberOfComponents=\"{components}\"");
    }
    text.push_str(">\n");
    for line in lines {
        text.push_str(&line);
        text.push('\n');
    }
    text.push_str("</DataArray>\n");
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lines of an array.
    fn lines<'a>(text: &'a str, name: &str) -> Vec<&'a str> {
        let start = text.find(&format!("Name=\"{name}\"")).unwrap();
        let start = start + text[start..].find(">\n").unwrap() + 2;
        text[start..start + text[start..].find("</").unwrap()].lines().collect()
    }

    #[test]
    fn a_mesh_and_a_patch_are_written() {
        let deck = "*NODE\n9,0,0,0\n3,1,0,0\n5,0,1,0\n7,0,0,1\n*ELEMENT, TYPE=C3D4\n1,9,3,5,7\n*ELEMENT, TYPE=MASS\n2,9\n";
        let deck = Deck::of_text("a.inp", deck).unwrap();
        let mut grid = VtuGrid::of_mesh(&deck);
        grid.add_polygon(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.5]]);
        grid.add_polygon(&[[0.0, 0.0, 2.0]]);
        let text = grid
            .to_text(&[("mode <1>", vec![[1.0, 0.0, -2.5e-9]; 8])], &[("p", vec![1.0, 2.0, 3.0])]);
        assert!(text.contains("NumberOfPoints=\"8\" NumberOfCells=\"3\""));
        // Points are the nodes in the order of their numbers.
        assert_eq!(lines(&text, "Points")[..2], ["1e0 0e0 0e0", "0e0 1e0 0e0"]);
        assert_eq!(lines(&text, "connectivity"), ["3 0 1 2", "4 5 6", "7"]);
        assert_eq!(lines(&text, "offsets"), ["4", "7", "8"]);
        assert_eq!(lines(&text, "types"), ["10", "7", "1"]);
        assert_eq!(lines(&text, "mode &lt;1>")[7], "1e0 0e0 -2.5e-9");
        assert_eq!(lines(&text, "p"), ["1e0", "2e0", "3e0"]);
    }
}
