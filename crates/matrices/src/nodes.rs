//! Places of the nodes of a mesh, and vectors between them.

use std::collections::BTreeMap;

/// The nodes of a mesh and their places.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Nodes {
    places: BTreeMap<i64, [f64; 3]>,
}

impl Nodes {
    /// Nodes by their numbers, with x, y and z.
    pub fn new(places: impl IntoIterator<Item = (i64, [f64; 3])>) -> Self {
        Self { places: places.into_iter().collect() }
    }

    /// Number of nodes.
    pub fn count(&self) -> usize {
        self.places.len()
    }

    /// True if the mesh has a node of this number.
    pub fn contains(&self, node: i64) -> bool {
        self.places.contains_key(&node)
    }

    /// The place of a node.
    pub fn get(&self, node: i64) -> Option<[f64; 3]> {
        self.places.get(&node).copied()
    }

    /// Numbers of the nodes, ascending.
    pub fn numbers(&self) -> impl Iterator<Item = i64> {
        self.places.keys().copied()
    }

    /// Numbers and places of the nodes, ascending.
    pub fn iter(&self) -> impl Iterator<Item = (i64, [f64; 3])> {
        self.places.iter().map(|(node, place)| (*node, *place))
    }

    /// Numbers between `first` and `last`, ascending.
    pub(crate) fn between(&self, first: i64, last: i64) -> impl Iterator<Item = i64> {
        self.places.range(first..=last).map(|(node, _)| *node)
    }

    /// Adds a node; the place that it had.
    pub(crate) fn insert(&mut self, node: i64, place: [f64; 3]) -> Option<[f64; 3]> {
        self.places.insert(node, place)
    }

    pub(crate) fn scale(&mut self, factor: f64) {
        for place in self.places.values_mut() {
            *place = place.map(|x| x * factor);
        }
    }
}

pub(crate) fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

pub(crate) fn norm(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

pub(crate) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
