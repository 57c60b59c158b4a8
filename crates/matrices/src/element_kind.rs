//! Solid elements of CalculiX and Abaqus: their nodes and faces.

/// Shape of an element.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ElementKind {
    /// Four nodes: C3D4.
    Tetrahedron4,
    /// Ten nodes: C3D10.
    Tetrahedron10,
    /// Six nodes: C3D6.
    Wedge6,
    /// Fifteen nodes: C3D15.
    Wedge15,
    /// Eight nodes: C3D8, C3D8R, C3D8I.
    Hexahedron8,
    /// Twenty nodes: C3D20, C3D20R.
    Hexahedron20,
    /// Any other, whose nodes are known and whose faces are not.
    Other,
}

/// Corners of the faces S1, S2, ..., counted from one; normals point outwards.
const TETRAHEDRON: [&[usize]; 4] = [&[1, 3, 2], &[1, 2, 4], &[2, 3, 4], &[3, 1, 4]];
const WEDGE: [&[usize]; 5] = [&[1, 3, 2], &[4, 5, 6], &[1, 2, 5, 4], &[2, 3, 6, 5], &[3, 1, 4, 6]];
const HEXAHEDRON: [&[usize]; 6] =
    [&[1, 4, 3, 2], &[5, 6, 7, 8], &[1, 2, 6, 5], &[2, 3, 7, 6], &[3, 4, 8, 7], &[4, 1, 5, 8]];

/// Edges with a node in the middle, in the order of those nodes.
const TETRAHEDRON_EDGES: [(usize, usize); 6] = [(1, 2), (2, 3), (3, 1), (1, 4), (2, 4), (3, 4)];
const WEDGE_EDGES: [(usize, usize); 9] =
    [(1, 2), (2, 3), (3, 1), (4, 5), (5, 6), (6, 4), (1, 4), (2, 5), (3, 6)];
const HEXAHEDRON_EDGES: [(usize, usize); 12] = [
    (1, 2),
    (2, 3),
    (3, 4),
    (4, 1),
    (5, 6),
    (6, 7),
    (7, 8),
    (8, 5),
    (1, 5),
    (2, 6),
    (3, 7),
    (4, 8),
];

impl ElementKind {
    /// The kind of an element type such as `C3D8I`, in upper case. Letters after the number of nodes, for
    /// reduced integration, incompatible modes or hybrid elements, do not change the faces.
    pub(crate) fn of_type(name: &str) -> Self {
        let Some(rest) = name.strip_prefix("C3D") else { return Self::Other };
        let digits = rest.bytes().take_while(u8::is_ascii_digit).count();
        match &rest[..digits] {
            "4" => Self::Tetrahedron4,
            "10" => Self::Tetrahedron10,
            "6" => Self::Wedge6,
            "15" => Self::Wedge15,
            "8" => Self::Hexahedron8,
            "20" => Self::Hexahedron20,
            _ => Self::Other,
        }
    }

    /// Number of nodes; none if it is not known.
    pub(crate) fn nodes(self) -> Option<usize> {
        match self {
            Self::Tetrahedron4 => Some(4),
            Self::Tetrahedron10 => Some(10),
            Self::Wedge6 => Some(6),
            Self::Wedge15 => Some(15),
            Self::Hexahedron8 => Some(8),
            Self::Hexahedron20 => Some(20),
            Self::Other => None,
        }
    }

    /// Number of faces.
    pub fn faces(self) -> usize {
        self.corners().len()
    }

    fn corners(self) -> &'static [&'static [usize]] {
        match self {
            Self::Tetrahedron4 | Self::Tetrahedron10 => &TETRAHEDRON,
            Self::Wedge6 | Self::Wedge15 => &WEDGE,
            Self::Hexahedron8 | Self::Hexahedron20 => &HEXAHEDRON,
            Self::Other => &[],
        }
    }

    /// Positions, in the nodes of the element, of the nodes of face `face` (from one): corners, then
    /// the middle of each edge from one corner to the next, if the element has such nodes.
    pub(crate) fn face(self, face: usize) -> Option<Vec<usize>> {
        let corners = *self.corners().get(face.checked_sub(1)?)?;
        let (edges, first): (&[(usize, usize)], _) = match self {
            Self::Tetrahedron10 => (&TETRAHEDRON_EDGES, 4),
            Self::Wedge15 => (&WEDGE_EDGES, 6),
            Self::Hexahedron20 => (&HEXAHEDRON_EDGES, 8),
            _ => (&[], 0),
        };
        let mut positions: Vec<usize> = corners.iter().map(|corner| corner - 1).collect();
        for (index, &from) in corners.iter().enumerate() {
            let to = corners[(index + 1) % corners.len()];
            let edge =
                edges.iter().position(|&(a, b)| (a, b) == (from, to) || (a, b) == (to, from));
            positions.extend(edge.map(|edge| first + edge));
        }
        Some(positions)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::nodes::minus;

    /// Places of the corners, and of the middle nodes as the programs number them.
    fn places(kind: ElementKind) -> Vec<[f64; 3]> {
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let triangle = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
        let at = |z: f64| move |[x, y]: &[f64; 2]| [*x, *y, z];
        let (mut places, edges): (Vec<[f64; 3]>, &[(usize, usize)]) = match kind.faces() {
            4 => {
                let mut corners: Vec<_> = triangle.iter().map(at(0.0)).collect();
                corners.push([0.0, 0.0, 1.0]);
                (corners, &TETRAHEDRON_EDGES)
            }
            5 => (
                triangle.iter().map(at(0.0)).chain(triangle.iter().map(at(1.0))).collect(),
                &WEDGE_EDGES,
            ),
            _ => (
                square.iter().map(at(0.0)).chain(square.iter().map(at(1.0))).collect(),
                &HEXAHEDRON_EDGES,
            ),
        };
        if kind.nodes() != Some(places.len()) {
            for &(a, b) in edges {
                let (a, b) = (places[a - 1], places[b - 1]);
                places.push([0, 1, 2].map(|x| 0.5 * (a[x] + b[x])));
            }
        }
        assert_eq!(kind.nodes(), Some(places.len()));
        places
    }

    #[test]
    fn faces_point_outwards_and_middle_nodes_lie_between_corners() {
        let names = ["C3D4", "C3D10", "C3D6", "C3D15", "C3D8I", "C3D20R"];
        for name in names {
            let kind = ElementKind::of_type(name);
            let places = places(kind);
            let count = places.len() as f64;
            let centre = [0, 1, 2].map(|x| places.iter().map(|p| p[x]).sum::<f64>() / count);
            for face in 1..=kind.faces() {
                let nodes: Vec<_> = kind.face(face).unwrap().iter().map(|&n| places[n]).collect();
                let corners = if nodes.len() > 4 { nodes.len() / 2 } else { nodes.len() };
                let (a, b) = (minus(nodes[1], nodes[0]), minus(nodes[2], nodes[1]));
                let normal = [
                    a[1] * b[2] - a[2] * b[1],
                    a[2] * b[0] - a[0] * b[2],
                    a[0] * b[1] - a[1] * b[0],
                ];
                let out = minus(nodes[0], centre);
                let along: f64 = normal.iter().zip(out).map(|(n, o)| n * o).sum();
                assert!(along > 0.0, "{name} S{face}");
                for (index, middle) in nodes[corners..].iter().enumerate() {
                    let (a, b) = (nodes[index], nodes[(index + 1) % corners]);
                    assert_eq!(*middle, [0, 1, 2].map(|x| 0.5 * (a[x] + b[x])), "{name} S{face}");
                }
            }
            assert_eq!(kind.face(kind.faces() + 1), None);
        }
        assert_eq!(ElementKind::of_type("S8R"), ElementKind::Other);
    }
}
