//! The mesh of an input deck of CalculiX or Abaqus.
//!
//! Source: Dhondt, "CalculiX CrunchiX user's manual", version 2.20; Abaqus keywords of flat decks, without
//! parts and instances. Read are `*NODE`, `*ELEMENT`, `*NSET`, `*ELSET`, `*SURFACE, TYPE=ELEMENT`, `*TRANSFORM`
//! and `*INCLUDE`; other keywords do not change the mesh.
//!
//! | module | contents |
//! |---|---|
//! | `keyword` | keyword lines and their parameters |
//! | `parser` | lines to blocks of nodes, elements, sets and surfaces |
//! | `sets` | sets and surfaces by name, resolved when the whole deck is read |

mod keyword;
mod parser;
mod sets;

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::path::Path;

use crate::nodes::{cross, dot, minus};
use crate::text::Content;
use crate::{ElementKind, MatricesError, MatrixUnits, Nodes};

/// The mesh of an input deck: nodes, elements, sets and surfaces.
#[derive(Debug, Clone, PartialEq)]
pub struct Deck {
    file: String,
    nodes: Nodes,
    elements: Vec<MeshElement>,
    node_sets: BTreeMap<String, Vec<i64>>,
    element_sets: BTreeMap<String, Vec<i64>>,
    surfaces: BTreeMap<String, Surface>,
    transformed: Vec<i64>,
}

/// An element of a mesh.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MeshElement {
    /// Its number.
    pub number: i64,
    /// Its shape.
    pub kind: ElementKind,
    /// Its nodes, in the order of the program.
    pub nodes: Vec<i64>,
}

/// A face of an element in a surface.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SurfaceFace {
    /// Number of the element.
    pub element: i64,
    /// Number of the face, from 1.
    pub face: u8,
    /// Its nodes: the corners, anticlockwise as seen from outside, then the middle of each edge from one
    /// corner to the next. 3 or 4 nodes of a linear face, 6 or 8 of a quadratic one.
    pub nodes: Vec<i64>,
}

/// A surface, or the reason why it has no faces.
type Surface = Result<Vec<SurfaceFace>, String>;

impl SurfaceFace {
    /// The corners.
    pub fn corners(&self) -> &[i64] {
        let count = self.nodes.len();
        &self.nodes[..if count > 4 { count / 2 } else { count }]
    }
}

impl Deck {
    /// Reads a deck, plain or gzip, and the files that it includes.
    ///
    /// # Errors
    /// [`MatricesError`] names file and line of content that is not of the format, of elements and sets that
    /// name nodes or sets that the deck does not have, and of parts, instances and generated meshes, which
    /// cannot be read.
    pub fn read(path: &Path) -> Result<Self, MatricesError> {
        let folder = path.parent().unwrap_or(Path::new(""));
        parser::parse(Content::open(path)?, Some(folder))
    }

    /// Reads a deck in memory, which includes no files. `name` stands for the file in errors.
    ///
    /// # Errors
    /// As [`Self::read`].
    ///
    /// ```
    /// use asperity_matrices::Deck;
    ///
    /// let deck = Deck::of_text("beam.inp", "*NODE, NSET=END\n1, 0, 0, 0.5\n2, 1, 0, 0.5\n")?;
    /// assert_eq!(deck.node_set("end")?, [1, 2]);
    /// assert_eq!(deck.nodes().get(2), Some([1.0, 0.0, 0.5]));
    /// # Ok::<(), asperity_matrices::MatricesError>(())
    /// ```
    pub fn of_text(name: &str, text: &str) -> Result<Self, MatricesError> {
        parser::parse(Content::of_bytes(name, text.as_bytes().to_vec()), None)
    }

    /// The nodes.
    pub fn nodes(&self) -> &Nodes {
        &self.nodes
    }

    /// The elements, in the order of the deck.
    pub fn elements(&self) -> &[MeshElement] {
        &self.elements
    }

    /// The nodes of a set, ascending. Names of sets and surfaces are the same in upper and lower case.
    ///
    /// # Errors
    /// If the deck has no such set; the names that it has are listed.
    pub fn node_set(&self, name: &str) -> Result<&[i64], MatricesError> {
        self.by_name("node set", &self.node_sets, name).map(Vec::as_slice)
    }

    /// The elements of a set, ascending.
    ///
    /// # Errors
    /// If the deck has no such set; the names that it has are listed.
    pub fn element_set(&self, name: &str) -> Result<&[i64], MatricesError> {
        self.by_name("element set", &self.element_sets, name).map(Vec::as_slice)
    }

    /// The faces of a surface.
    ///
    /// # Errors
    /// If the deck has no such surface, or one that is not of element faces.
    pub fn surface(&self, name: &str) -> Result<&[SurfaceFace], MatricesError> {
        let surface = self.by_name("surface", &self.surfaces, name)?;
        surface.as_deref().map_err(|reason| {
            let what = format!("{}: the surface {name} {reason}", self.file);
            MatricesError::inconsistent(what, "expected faces of solid elements, S1 to S6")
        })
    }

    /// Free faces of solid elements all nodes of which are in a set, in the order of the elements.
    ///
    /// # Errors
    /// Those of [`Self::node_set`].
    pub fn faces_on(&self, name: &str) -> Result<Vec<SurfaceFace>, MatricesError> {
        let set = self.node_set(name)?;
        Ok(self.free_faces(|node| set.binary_search(node).is_ok()))
    }

    /// Edges of the free faces of solid elements between corners, each once, ascending.
    pub fn free_edges(&self) -> Vec<[i64; 2]> {
        edges_of(&self.free_faces(|_| true))
    }

    /// The same of those faces whose outer side is turned to `eye`, a vector towards it: what is seen of a convex body.
    pub fn edges_seen(&self, eye: [f64; 3]) -> Vec<[i64; 2]> {
        let place = |node: &i64| self.nodes.get(*node).unwrap_or_default();
        let middle = |nodes: &[i64]| {
            let sum =
                nodes.iter().map(place).fold([0.0; 3], |sum, x| [0, 1, 2].map(|k| sum[k] + x[k]));
            sum.map(|x| x / nodes.len() as f64)
        };
        let elements: HashMap<i64, &MeshElement> =
            self.elements.iter().map(|element| (element.number, element)).collect();
        let is_seen = |face: &SurfaceFace| {
            let corners = face.corners();
            let (Some(element), [a, b, c, ..]) = (elements.get(&face.element), corners) else {
                return true;
            };
            let [a, b, c] = [a, b, c].map(place);
            let normal = cross(minus(b, a), minus(c, a));
            let outwards = dot(normal, minus(middle(corners), middle(&element.nodes)));
            outwards * dot(normal, eye) > 0.0
        };
        let mut faces = self.free_faces(|_| true);
        faces.retain(is_seen);
        edges_of(&faces)
    }

    /// Free faces all nodes of which are `within`, in the order of the elements.
    fn free_faces(&self, within: impl Fn(&i64) -> bool) -> Vec<SurfaceFace> {
        let mut faces = Vec::new();
        // Faces by their corners: two elements share a face inside the mesh.
        let mut seen: HashMap<Vec<i64>, usize> = HashMap::new();
        for MeshElement { number, kind, nodes } in &self.elements {
            for face in 1..=kind.faces() {
                let Some(positions) = kind.face(face) else { continue };
                let nodes: Vec<i64> = positions.iter().map(|position| nodes[*position]).collect();
                if nodes.iter().all(&within) {
                    let face = SurfaceFace { element: *number, face: face as u8, nodes };
                    let mut corners = face.corners().to_vec();
                    corners.sort_unstable();
                    *seen.entry(corners.clone()).or_default() += 1;
                    faces.push((face, corners));
                }
            }
        }
        let free = faces.into_iter().filter(|(_, corners)| seen[corners] == 1);
        free.map(|(face, _)| face).collect()
    }

    /// Names of the node sets.
    pub fn node_set_names(&self) -> impl Iterator<Item = &str> {
        self.node_sets.keys().map(String::as_str)
    }

    /// Names of the surfaces.
    pub fn surface_names(&self) -> impl Iterator<Item = &str> {
        self.surfaces.keys().map(String::as_str)
    }

    /// Nodes of `*TRANSFORM`, ascending. Directions 1 to 3 of their rows are local ones, not x, y, z.
    pub fn transformed_nodes(&self) -> &[i64] {
        &self.transformed
    }

    /// Converts the places of the nodes to metres.
    pub fn convert(&mut self, units: MatrixUnits) {
        self.nodes.scale(units.length_m());
    }

    fn by_name<'a, T>(
        &self,
        kind: &str,
        map: &'a BTreeMap<String, T>,
        name: &str,
    ) -> Result<&'a T, MatricesError> {
        const MOST: usize = 20;
        map.get(&name.to_uppercase()).ok_or_else(|| {
            // The nearest names first, where there are too many to list.
            let mut names: Vec<&str> = map.keys().map(String::as_str).collect();
            if map.len() > MOST {
                let upper = name.to_uppercase();
                names.sort_by_key(|known| strsim::damerau_levenshtein(known, &upper));
                names.truncate(MOST);
                names.push("...");
            }
            let what = format!("{}: no {kind} {name}", self.file);
            let has = if names.is_empty() { "none".to_owned() } else { names.join(", ") };
            MatricesError::inconsistent(what, format!("the deck has {has}"))
        })
    }
}

/// Edges of faces between corners, each once, ascending.
fn edges_of(faces: &[SurfaceFace]) -> Vec<[i64; 2]> {
    let edges = faces.iter().flat_map(|face| {
        let corners = face.corners();
        let next = corners.iter().cycle().skip(1);
        corners.iter().zip(next).map(|(&a, &b)| [a.min(b), a.max(b)])
    });
    edges.collect::<BTreeSet<_>>().into_iter().collect()
}
