//! Sets and surfaces, resolved when the whole deck is read.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::{Deck, MeshElement, Surface, SurfaceFace};
use crate::error::Place;
use crate::{MatricesError, Nodes};

/// Most members of all sets and surfaces together.
const MOST_MEMBERS: usize = 50_000_000;

/// A line of a file.
pub(super) type FileLine = (Arc<str>, u64);

/// A member of a set as written.
#[derive(Debug, Clone)]
pub(super) enum Member {
    Number(i64),
    /// First, last and step of GENERATE.
    Range(i64, i64, i64),
    /// Another set of the same kind.
    Set(String),
    /// The nodes of an element set.
    NodesOf(String),
}

/// Elements and a face label of a surface as written.
#[derive(Debug, Clone)]
pub(super) struct SurfaceItem {
    pub(super) elements: Member,
    pub(super) face: String,
}

/// Members of sets with their lines, by name.
pub(super) type Sets = BTreeMap<String, Vec<(Member, FileLine)>>;

/// The parts of a deck as written.
#[derive(Debug, Default)]
pub(super) struct Written {
    pub(super) nodes: Nodes,
    pub(super) elements: Vec<MeshElement>,
    pub(super) element_lines: Vec<FileLine>,
    pub(super) node_sets: Sets,
    pub(super) element_sets: Sets,
    pub(super) surfaces: BTreeMap<String, Vec<(SurfaceItem, FileLine)>>,
    /// Surfaces without faces, with the reason.
    pub(super) faceless: BTreeMap<String, String>,
    pub(super) transforms: Vec<(String, FileLine)>,
}

pub(super) fn malformed(
    (file, line): &FileLine,
    found: impl Into<String>,
    expected: impl Into<String>,
) -> MatricesError {
    MatricesError::malformed(file, Place::Line(*line), found, expected)
}

/// Resolves the sets of one kind.
struct Resolver<'a> {
    kind: &'static str,
    written: &'a Sets,
    /// The members between two numbers that the deck has.
    between: &'a dyn Fn(i64, i64) -> Vec<i64>,
    /// The nodes of an element set; none if there is no such set.
    nodes_of: &'a dyn Fn(&str) -> Option<Vec<i64>>,
    done: BTreeMap<String, Vec<i64>>,
    members: usize,
}

impl Resolver<'_> {
    fn all(mut self) -> Result<BTreeMap<String, Vec<i64>>, MatricesError> {
        for name in self.written.keys() {
            self.set(name, 0)?;
        }
        Ok(self.done)
    }

    /// Resolves a set, and first the sets that it names, `depth` levels below.
    fn set(&mut self, name: &str, depth: usize) -> Result<(), MatricesError> {
        const DEEPEST: usize = 50;
        if self.done.contains_key(name) {
            return Ok(());
        }
        let mut members = Vec::new();
        for (member, line) in self.written.get(name).into_iter().flatten() {
            match member {
                Member::Number(number) => {
                    if (self.between)(*number, *number).is_empty() {
                        let found = format!("{} {number} in the set {name}", self.kind);
                        let expected = format!("a {} that the deck has", self.kind);
                        return Err(malformed(line, found, expected));
                    }
                    members.push(*number);
                }
                Member::Range(first, last, step) => {
                    let within = (self.between)(*first, *last);
                    members.extend(within.iter().filter(|number| (*number - first) % step == 0));
                }
                Member::Set(other) => {
                    if !self.written.contains_key(other) {
                        let expected =
                            format!("the number of a {} or the name of a set of them", self.kind);
                        return Err(malformed(
                            line,
                            format!("`{other}` in the set {name}"),
                            expected,
                        ));
                    }
                    if depth > DEEPEST {
                        let expected = format!("sets of at most {DEEPEST} levels, without circles");
                        return Err(malformed(
                            line,
                            format!("`{other}` in the set {name}"),
                            expected,
                        ));
                    }
                    self.set(other, depth + 1)?;
                    members.extend(&self.done[other]);
                }
                Member::NodesOf(set) => {
                    let Some(nodes) = (self.nodes_of)(set) else {
                        return Err(malformed(
                            line,
                            format!("no element set {set}"),
                            "an element set",
                        ));
                    };
                    members.extend(nodes);
                }
            }
            if members.len() > MOST_MEMBERS {
                members.sort_unstable();
                members.dedup();
            }
        }
        members.sort_unstable();
        members.dedup();
        self.members += members.len();
        if self.members > MOST_MEMBERS {
            let what = format!("the {} sets have more than {MOST_MEMBERS} members", self.kind);
            return Err(MatricesError::inconsistent(what, "expected fewer"));
        }
        self.done.insert(name.to_owned(), members);
        Ok(())
    }
}

impl Written {
    pub(super) fn resolve(self, file: String) -> Result<Deck, MatricesError> {
        for (element, line) in self.elements.iter().zip(&self.element_lines) {
            if let Some(node) = element.nodes.iter().find(|node| !self.nodes.contains(**node)) {
                let found = format!("element {} has the node {node}", element.number);
                return Err(malformed(line, found, "nodes with a place (*NODE)"));
            }
        }
        let index: BTreeMap<i64, usize> = (self.elements.iter().enumerate())
            .map(|(position, element)| (element.number, position))
            .collect();
        let element_sets = Resolver {
            kind: "element",
            written: &self.element_sets,
            between: &|first, last| index.range(first..=last).map(|(number, _)| *number).collect(),
            nodes_of: &|_| None,
            done: BTreeMap::new(),
            members: 0,
        };
        let element_sets = element_sets.all()?;
        let nodes_of = |set: &str| {
            let elements =
                element_sets.get(set)?.iter().map(|number| &self.elements[index[number]]);
            Some(elements.flat_map(|element| element.nodes.iter().copied()).collect())
        };
        let node_sets = Resolver {
            kind: "node",
            written: &self.node_sets,
            between: &|first, last| self.nodes.between(first, last).collect(),
            nodes_of: &nodes_of,
            done: BTreeMap::new(),
            members: 0,
        };
        let node_sets = node_sets.all()?;
        let mut surfaces: BTreeMap<String, Surface> = BTreeMap::new();
        let mut room = MOST_MEMBERS;
        for (name, items) in &self.surfaces {
            let mut faces = Vec::new();
            for (item, line) in items {
                let single;
                let elements = match &item.elements {
                    Member::Set(set) => element_sets.get(set).ok_or_else(|| {
                        let expected = "the number of an element, or the name of a set of elements";
                        malformed(line, format!("`{set}` in the surface {name}"), expected)
                    })?,
                    Member::Number(number) => {
                        single = vec![*number];
                        &single
                    }
                    Member::Range(..) | Member::NodesOf(_) => continue,
                };
                room = room.checked_sub(elements.len()).ok_or_else(|| {
                    let found = format!("more than {MOST_MEMBERS} faces of surfaces");
                    malformed(line, found, "fewer")
                })?;
                for number in elements {
                    let element = index.get(number).map(|position| &self.elements[*position]);
                    let element = element.ok_or_else(|| {
                        let found = format!("element {number} in the surface {name}");
                        malformed(line, found, "an element that the deck has")
                    })?;
                    faces.push(face_of(element, &item.face, line)?);
                }
            }
            surfaces.insert(name.clone(), Ok(faces));
        }
        surfaces.extend(self.faceless.iter().map(|(name, why)| (name.clone(), Err(why.clone()))));
        let mut transformed = Vec::new();
        for (name, line) in &self.transforms {
            let nodes = node_sets.get(name);
            let nodes = nodes
                .ok_or_else(|| malformed(line, format!("no node set {name}"), "a node set"))?;
            transformed.extend(nodes);
        }
        transformed.sort_unstable();
        transformed.dedup();
        let Self { nodes, elements, .. } = self;
        Ok(Deck { file, nodes, elements, node_sets, element_sets, surfaces, transformed })
    }
}

/// The face of an element by its label, such as S3.
fn face_of(
    element: &MeshElement,
    label: &str,
    line: &FileLine,
) -> Result<SurfaceFace, MatricesError> {
    let number = label.strip_prefix('S').and_then(|number| number.parse::<u8>().ok());
    let positions = number.and_then(|face| Some((face, element.kind.face(usize::from(face))?)));
    let Some((face, positions)) = positions else {
        let found = format!("the face `{label}` of element {}", element.number);
        let expected = match element.kind.faces() {
            0 => "a solid element (C3D4, C3D10, C3D6, C3D15, C3D8, C3D20)".to_owned(),
            faces => format!("a face of the element, S1 to S{faces}"),
        };
        return Err(malformed(line, found, expected));
    };
    let nodes = positions.iter().map(|position| element.nodes[*position]).collect();
    Ok(SurfaceFace { element: element.number, face, nodes })
}
