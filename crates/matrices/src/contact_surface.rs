//! Surfaces of a mesh in the plane of a contact patch.

use crate::face_shape::FaceShape;
use crate::nodes::{cross, dot, norm};
use crate::polygon::{self, Polygon};
use crate::{Deck, MatricesError, SurfaceFace};

/// Distance of the middle of an edge from its chord, over the chord, up to which the edge is straight; and of nodes
/// of two faces that are at one place, over the size of the faces.
const STRAIGHT: f64 = 1e-6;

/// Error of the area of a curved face by the chords of its edges.
const CURVED_AREA: f64 = 1e-3;

/// Most parts of a curved edge.
const MOST_PARTS: f64 = 16.0;

/// A surface of one side of a contact patch: faces of solid elements of a deck.
#[derive(Debug, Clone)]
pub struct ContactSurface<'a> {
    /// The body, where there are several.
    pub(crate) body: Option<&'a str>,
    pub(crate) name: &'a str,
    pub(crate) deck: &'a Deck,
    pub(crate) faces: Vec<SurfaceFace>,
}

impl<'a> ContactSurface<'a> {
    /// The surface `name` (`*SURFACE, TYPE=ELEMENT`) of a deck.
    ///
    /// # Errors
    /// Those of [`Deck::surface`]; a surface without faces, or of nodes with local directions (`*TRANSFORM`).
    pub fn of_surface(
        deck: &'a Deck,
        name: &'a str,
        body: Option<&'a str>,
    ) -> Result<Self, MatricesError> {
        Self { body, name, deck, faces: deck.surface(name)?.to_vec() }.checked("surface")
    }

    /// The [faces on](Deck::faces_on) the node set `name` of a deck.
    ///
    /// # Errors
    /// Those of [`Deck::node_set`]; a set on which no face lies, or of nodes with local directions (`*TRANSFORM`).
    pub fn of_node_set(
        deck: &'a Deck,
        name: &'a str,
        body: Option<&'a str>,
    ) -> Result<Self, MatricesError> {
        Self { body, name, deck, faces: deck.faces_on(name)? }.checked("node set")
    }

    fn checked(self, kind: &str) -> Result<Self, MatricesError> {
        let Self { name, deck, faces, .. } = &self;
        if faces.is_empty() {
            let what = format!("the {kind} {name} has no face of a solid element");
            let remedy = "expected faces of C3D4, C3D10, C3D6, C3D15, C3D8 or C3D20, all nodes of which are in it";
            return Err(MatricesError::inconsistent(what, remedy));
        }
        let transformed = deck.transformed_nodes();
        let mut nodes = faces.iter().flat_map(|face| &face.nodes);
        if let Some(node) = nodes.find(|node| transformed.binary_search(node).is_ok()) {
            let what =
                format!("node {node} of the {kind} {name} has local directions (*TRANSFORM)");
            return Err(MatricesError::inconsistent(what, "expected rows along x, y, z"));
        }
        Ok(self)
    }

    fn places(&self, face: &SurfaceFace) -> Vec<[f64; 3]> {
        // Elements of a deck have nodes that it has.
        face.nodes.iter().filter_map(|&node| self.deck.nodes().get(node)).collect()
    }

    fn shape(&self, face: &SurfaceFace) -> Result<FaceShape, MatricesError> {
        FaceShape::of_nodes(face.nodes.len())
            .ok_or_else(|| self.wrong(face, "has neither 3, 4, 6 nor 8 nodes"))
    }

    /// Vector areas of the faces \[m2\], along the outward normals.
    pub(crate) fn vector_areas(&self) -> Result<Vec<[f64; 3]>, MatricesError> {
        let of_face = |face| {
            let (shape, places) = (self.shape(face)?, self.places(face));
            let mut sum = [0.0; 3];
            for (at, weight) in shape.rule() {
                let derivatives = shape.at(at).derivatives;
                let along = |k: usize| {
                    let parts = places.iter().zip(derivatives);
                    parts.fold([0.0; 3], |sum, (place, slope)| {
                        [0, 1, 2].map(|x| sum[x] + place[x] * slope[k])
                    })
                };
                let normal = cross(along(0), along(1));
                sum = [0, 1, 2].map(|x| sum[x] + weight * normal[x]);
            }
            Ok(sum)
        };
        self.faces.iter().map(of_face).collect()
    }

    /// The faces in a plane.
    pub(crate) fn in_plane(&self, plane: &Plane) -> Result<Vec<PlaneFace<'_>>, MatricesError> {
        self.faces.iter().map(|face| self.plane_face(face, plane)).collect()
    }

    fn plane_face<'b>(
        &self,
        face: &'b SurfaceFace,
        plane: &Plane,
    ) -> Result<PlaneFace<'b>, MatricesError> {
        let shape = self.shape(face)?;
        let places: Vec<[f64; 2]> =
            self.places(face).into_iter().map(|place| plane.project(place)).collect();
        let corners = shape.corners();
        let mut outline = places[..corners].to_vec();
        let chord = |i: usize| (places[i], places[(i + 1) % corners]);
        let mut bent = 0.0_f64;
        let mut segments = 0.0;
        for (i, middle) in places[corners..].iter().enumerate() {
            let (a, b) = chord(i);
            let length = (b[0] - a[0]).hypot(b[1] - a[1]);
            let rise = polygon::cross(a, b, *middle).abs() / length;
            bent = bent.max(rise / length);
            segments += 2.0 / 3.0 * rise * length;
        }
        let straight = bent <= STRAIGHT;
        if polygon::area(&outline) < 0.0 {
            outline.reverse();
        }
        let area = polygon::area(&outline);
        let size = area.sqrt();
        let longest = (0..corners)
            .map(|i| {
                let (a, b) = chord(i);
                (b[0] - a[0]).hypot(b[1] - a[1])
            })
            .fold(0.0, f64::max);
        if !(area > 1e-9 * longest * longest && longest > 0.0) {
            return Err(self.wrong(face, "has no area in the plane of the patch"));
        }
        if !polygon::is_convex(&outline) {
            return Err(self.wrong(face, "is folded: its corners are no convex polygon"));
        }
        let facets = if straight {
            vec![outline]
        } else {
            let parts = (segments / area / CURVED_AREA).sqrt().clamp(1.0, MOST_PARTS).ceil();
            let place = |at| shape.interpolate(&places, at);
            let triangles = shape.triangles(parts as usize).into_iter();
            let turned = |triangle: [[f64; 2]; 3]| {
                let mut facet = triangle.map(place).to_vec();
                if polygon::area(&facet) < 0.0 {
                    facet.reverse();
                }
                facet
            };
            triangles.map(turned).collect()
        };
        let around = |facet: Polygon| {
            let bounds = Bounds::of_places(&facet);
            (facet, bounds)
        };
        let facets = facets.into_iter().map(around).collect();
        let bounds = Bounds::of_places(&places);
        Ok(PlaneFace { face, shape, places, size, straight, facets, bounds })
    }

    /// The error of a face that cannot be used.
    pub(crate) fn wrong(&self, face: &SurfaceFace, problem: &str) -> MatricesError {
        let SurfaceFace { element, face, .. } = face;
        let what = format!("face S{face} of element {element} in {} {problem}", self.name);
        MatricesError::inconsistent(what, "expected faces of valid solid elements")
    }
}

/// A face of a surface in the plane of a patch.
#[derive(Debug)]
pub(crate) struct PlaneFace<'a> {
    pub(crate) face: &'a SurfaceFace,
    pub(crate) shape: FaceShape,
    /// Places of its nodes.
    pub(crate) places: Vec<[f64; 2]>,
    pub(crate) size: f64,
    straight: bool,
    /// Convex anticlockwise polygons that cover the face: one if its edges are straight.
    pub(crate) facets: Vec<(Polygon, Bounds)>,
    pub(crate) bounds: Bounds,
}

impl PlaneFace<'_> {
    /// True if the other face covers the same area: nodes at the same places, but for middles of straight edges.
    pub(crate) fn coincides(&self, other: &PlaneFace<'_>) -> bool {
        let corners = self.shape.corners();
        let near =
            |a: &[f64; 2], b: &[f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]) <= STRAIGHT * self.size;
        let all = |own: &[[f64; 2]], others: &[[f64; 2]]| {
            own.iter().all(|a| others.iter().any(|b| near(a, b)))
        };
        corners == other.shape.corners()
            && all(&self.places[..corners], &other.places[..corners])
            && ((self.straight && other.straight)
                || (self.places.len() == other.places.len()
                    && all(&self.places[corners..], &other.places[corners..])))
    }

    /// Integrals of the shape functions over the face and its area \[m2\].
    pub(crate) fn integrals(&self) -> (Vec<f64>, f64) {
        let (mut sums, mut area) = (vec![0.0; self.places.len()], 0.0);
        for (at, weight) in self.shape.rule() {
            let [[a, b], [c, d]] = self.shape.jacobian(&self.places, at);
            let part = weight * (a * d - b * c).abs();
            area += part;
            for (sum, value) in sums.iter_mut().zip(self.shape.at(at).values) {
                *sum += part * value;
            }
        }
        (sums, area)
    }

    /// Its edges as a polygon: corners, with the middles of curved edges between them.
    pub(crate) fn outline(&self) -> Polygon {
        let corners = self.shape.corners();
        if self.straight {
            return self.places[..corners].to_vec();
        }
        (0..corners).flat_map(|i| [self.places[i], self.places[corners + i]]).collect()
    }
}

/// A rectangle around places.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Bounds {
    pub(crate) low: [f64; 2],
    pub(crate) high: [f64; 2],
}

impl Default for Bounds {
    fn default() -> Self {
        Self { low: [f64::INFINITY; 2], high: [f64::NEG_INFINITY; 2] }
    }
}

impl Bounds {
    fn include(&mut self, place: [f64; 2]) {
        for (k, x) in place.into_iter().enumerate() {
            self.low[k] = self.low[k].min(x);
            self.high[k] = self.high[k].max(x);
        }
    }

    pub(crate) fn of_places(places: &[[f64; 2]]) -> Self {
        let mut bounds = Self::default();
        for place in places {
            bounds.include(*place);
        }
        bounds
    }

    pub(crate) fn of(faces: &[PlaneFace<'_>]) -> Self {
        let mut bounds = Self::default();
        for face in faces {
            bounds.include(face.bounds.low);
            bounds.include(face.bounds.high);
        }
        bounds
    }

    /// The rectangle in both.
    pub(crate) fn common(self, other: Self) -> Self {
        let low = [0, 1].map(|k| self.low[k].max(other.low[k]));
        Self { low, high: [0, 1].map(|k| self.high[k].min(other.high[k])) }
    }

    pub(crate) fn overlaps(&self, other: &Self) -> bool {
        (0..2).all(|k| self.low[k] < other.high[k] && other.low[k] < self.high[k])
    }
}

/// The plane of a patch: a normal and two directions in it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Plane {
    pub(crate) normal: [f64; 3],
    axes: [[f64; 3]; 2],
}

impl Plane {
    /// The plane with a normal. Its first direction is `along`, or the first of x, y, z that is far enough from the
    /// normal; its second is the next of them, or across both. None if `along` is along the normal.
    pub(crate) fn new(normal: [f64; 3], along: Option<[f64; 3]>) -> Option<Self> {
        let units = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let first = match along {
            Some(along) => within(along, normal)?,
            None => units.into_iter().find_map(|unit| within(unit, normal))?,
        };
        let mut second = cross(normal, first);
        // Towards the positive side of the axis that it follows most.
        let largest =
            second.iter().fold(0.0_f64, |most, x| if x.abs() > most.abs() { *x } else { most });
        if largest < 0.0 {
            second = second.map(|x| -x);
        }
        Some(Self { normal, axes: [first, second] })
    }

    pub(crate) fn project(&self, place: [f64; 3]) -> [f64; 2] {
        self.axes.map(|axis| dot(axis, place))
    }

    /// The place at a height along the normal.
    pub(crate) fn place(&self, [x, y]: [f64; 2], height: f64) -> [f64; 3] {
        let [a, b] = self.axes;
        [0, 1, 2].map(|k| x * a[k] + y * b[k] + height * self.normal[k])
    }

    /// Mean distance of the corners of a surface from the origin along the normal \[m\].
    pub(crate) fn height(&self, surface: &ContactSurface<'_>) -> f64 {
        let faces = surface.faces.iter();
        let nodes = faces.flat_map(|face| face.corners().iter());
        let places: Vec<f64> = nodes
            .filter_map(|&node| surface.deck.nodes().get(node))
            .map(|place| dot(self.normal, place))
            .collect();
        places.iter().sum::<f64>() / places.len() as f64
    }
}

/// The unit direction of `vector` across `normal`; none if it is within 30 degrees of the normal.
fn within(vector: [f64; 3], normal: [f64; 3]) -> Option<[f64; 3]> {
    let along = dot(vector, normal);
    let rest = [0, 1, 2].map(|k| vector[k] - along * normal[k]);
    let length = norm(rest);
    (length > 0.5 * norm(vector)).then(|| rest.map(|x| x / length))
}
