//! Shape functions of element faces: triangles of 3 and 6 nodes, quadrangles of 4 and 8.

/// Most nodes of a face.
pub(crate) const MOST_FACE_NODES: usize = 8;

/// Newton steps of an inverse map.
const MOST_STEPS: usize = 30;

/// Error of an inverse map over the size of the face.
const REACHED: f64 = 1e-13;

/// Shape of an element face. Nodes are the corners, then the middles of the edges from each corner to the next.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum FaceShape {
    /// Three or six nodes, over xi, eta >= 0, xi + eta <= 1.
    Triangle { quadratic: bool },
    /// Four or eight nodes, over -1 <= xi, eta <= 1.
    Quadrangle { quadratic: bool },
}

/// Shape functions N and their derivatives by xi and eta at a point; entries past the nodes are zero.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ShapeValues {
    pub(crate) values: [f64; MOST_FACE_NODES],
    pub(crate) derivatives: [[f64; 2]; MOST_FACE_NODES],
}

/// Points and weights of a rule on the triangle (0, 0), (1, 0), (0, 1), exact up to the fifth degree; weights sum
/// to 1/2. Source: J. Radon, Monatsh. Math. Phys. 1948, 52, 286, doi 10.1007/BF01525334.
pub(crate) fn triangle_rule() -> [([f64; 2], f64); 7] {
    let root = 15.0_f64.sqrt();
    let (a, b) = ((6.0 - root) / 21.0, (6.0 + root) / 21.0);
    let (of_a, of_b) = ((155.0 - root) / 2400.0, (155.0 + root) / 2400.0);
    [
        ([1.0 / 3.0, 1.0 / 3.0], 9.0 / 80.0),
        ([a, a], of_a),
        ([1.0 - 2.0 * a, a], of_a),
        ([a, 1.0 - 2.0 * a], of_a),
        ([b, b], of_b),
        ([1.0 - 2.0 * b, b], of_b),
        ([b, 1.0 - 2.0 * b], of_b),
    ]
}

impl FaceShape {
    /// The shape of a face of `nodes` nodes.
    pub(crate) fn of_nodes(nodes: usize) -> Option<Self> {
        match nodes {
            3 => Some(Self::Triangle { quadratic: false }),
            6 => Some(Self::Triangle { quadratic: true }),
            4 => Some(Self::Quadrangle { quadratic: false }),
            8 => Some(Self::Quadrangle { quadratic: true }),
            _ => None,
        }
    }

    /// Number of corners.
    pub(crate) fn corners(self) -> usize {
        match self {
            Self::Triangle { .. } => 3,
            Self::Quadrangle { .. } => 4,
        }
    }

    /// Places of the corners in xi and eta.
    pub(crate) fn corner_places(self) -> &'static [[f64; 2]] {
        match self {
            Self::Triangle { .. } => &[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]],
            Self::Quadrangle { .. } => &[[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]],
        }
    }

    /// Shape functions at xi and eta.
    pub(crate) fn at(self, [x, y]: [f64; 2]) -> ShapeValues {
        let mut values = [0.0; MOST_FACE_NODES];
        let mut derivatives = [[0.0; 2]; MOST_FACE_NODES];
        match self {
            Self::Triangle { quadratic } => {
                let parts = [1.0 - x - y, x, y];
                let slopes = [[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]];
                for (i, (part, slope)) in parts.iter().zip(slopes).enumerate() {
                    if !quadratic {
                        (values[i], derivatives[i]) = (*part, slope);
                        continue;
                    }
                    values[i] = part * (2.0 * part - 1.0);
                    derivatives[i] = slope.map(|slope| (4.0 * part - 1.0) * slope);
                    let next = (i + 1) % 3;
                    values[3 + i] = 4.0 * part * parts[next];
                    derivatives[3 + i] =
                        [0, 1].map(|k| 4.0 * (slope[k] * parts[next] + part * slopes[next][k]));
                }
            }
            Self::Quadrangle { quadratic } => {
                for (i, [a, b]) in self.corner_places().iter().enumerate() {
                    let (along, across) = (1.0 + x * a, 1.0 + y * b);
                    if !quadratic {
                        values[i] = 0.25 * along * across;
                        derivatives[i] = [0.25 * a * across, 0.25 * b * along];
                        continue;
                    }
                    let (xa, yb) = (x * a, y * b);
                    values[i] = 0.25 * along * across * (xa + yb - 1.0);
                    derivatives[i] =
                        [0.25 * a * across * (2.0 * xa + yb), 0.25 * b * along * (2.0 * yb + xa)];
                    // The middle of the edge to the next corner.
                    let (middle, slope) = match i {
                        0 | 2 => {
                            let flat = 1.0 - x * x;
                            (0.5 * flat * across, [-x * across, 0.5 * b * flat])
                        }
                        // Edges along eta: the sign of xi is the corner's.
                        _ => {
                            let flat = 1.0 - y * y;
                            (0.5 * flat * along, [0.5 * a * flat, -y * along])
                        }
                    };
                    (values[4 + i], derivatives[4 + i]) = (middle, slope);
                }
            }
        }
        ShapeValues { values, derivatives }
    }

    /// Points and weights of a rule over the whole face in xi and eta.
    pub(crate) fn rule(self) -> Vec<([f64; 2], f64)> {
        match self {
            Self::Triangle { .. } => triangle_rule().to_vec(),
            Self::Quadrangle { .. } => {
                let far = 0.6_f64.sqrt();
                let line = [(-far, 5.0 / 9.0), (0.0, 8.0 / 9.0), (far, 5.0 / 9.0)];
                let point = |(x, a): (f64, f64)| line.map(|(y, b)| ([x, y], a * b));
                line.into_iter().flat_map(point).collect()
            }
        }
    }

    /// Triangles of `parts` parts of each edge that cover the face in xi and eta.
    pub(crate) fn triangles(self, parts: usize) -> Vec<[[f64; 2]; 3]> {
        let quadrangle = matches!(self, Self::Quadrangle { .. });
        let at = |i: usize, j: usize| {
            let [x, y] = [i, j].map(|n| n as f64 / parts as f64);
            if quadrangle { [2.0 * x - 1.0, 2.0 * y - 1.0] } else { [x, y] }
        };
        let mut triangles = Vec::new();
        for i in 0..parts {
            for j in 0..if quadrangle { parts } else { parts - i } {
                triangles.push([at(i, j), at(i + 1, j), at(i, j + 1)]);
                if quadrangle || i + j + 2 <= parts {
                    triangles.push([at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
                }
            }
        }
        triangles
    }

    /// Place of `values` at the nodes interpolated at xi and eta.
    pub(crate) fn interpolate<const D: usize>(self, nodes: &[[f64; D]], at: [f64; 2]) -> [f64; D] {
        let shape = self.at(at);
        let mut sum = [0.0; D];
        for (node, value) in nodes.iter().zip(shape.values) {
            for (sum, part) in sum.iter_mut().zip(node) {
                *sum += value * part;
            }
        }
        sum
    }

    /// Derivatives of a plane place by xi and eta: rows x and y.
    pub(crate) fn jacobian(self, nodes: &[[f64; 2]], at: [f64; 2]) -> [[f64; 2]; 2] {
        let shape = self.at(at);
        let mut sum = [[0.0; 2]; 2];
        for (node, slope) in nodes.iter().zip(shape.derivatives) {
            for (row, part) in sum.iter_mut().zip(node) {
                row[0] += part * slope[0];
                row[1] += part * slope[1];
            }
        }
        sum
    }

    /// Xi and eta of a place in the plane of the face, by Newton steps; none for a face that is folded.
    pub(crate) fn locate(self, nodes: &[[f64; 2]], place: [f64; 2], size: f64) -> Option<[f64; 2]> {
        let mut at = if self.corners() == 3 { [1.0 / 3.0; 2] } else { [0.0; 2] };
        for _ in 0..MOST_STEPS {
            let found = self.interpolate(nodes, at);
            let off = [place[0] - found[0], place[1] - found[1]];
            if off[0].hypot(off[1]) <= REACHED * size {
                return Some(at);
            }
            let [[a, b], [c, d]] = self.jacobian(nodes, at);
            let det = a * d - b * c;
            at[0] += (d * off[0] - b * off[1]) / det;
            at[1] += (a * off[1] - c * off[0]) / det;
            if !(at[0].abs() < 10.0 && at[1].abs() < 10.0) {
                return None;
            }
        }
        // Rounding of places far from the origin.
        let found = self.interpolate(nodes, at);
        ((place[0] - found[0]).hypot(place[1] - found[1]) <= 1e-9 * size).then_some(at)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHAPES: [usize; 4] = [3, 6, 4, 8];

    fn nodes(shape: FaceShape, count: usize) -> Vec<[f64; 2]> {
        let corners = shape.corner_places();
        let mut nodes = corners.to_vec();
        for (i, [x, y]) in corners.iter().enumerate().take(count - corners.len()) {
            let next = corners[(i + 1) % corners.len()];
            nodes.push([0.5 * (x + next[0]), 0.5 * (y + next[1])]);
        }
        nodes
    }

    /// Each function is one at its node and zero at the others, all sum to one, and derivatives are those of
    /// differences.
    #[test]
    fn shape_functions_interpolate() {
        for count in SHAPES {
            let shape = FaceShape::of_nodes(count).unwrap();
            for (i, node) in nodes(shape, count).into_iter().enumerate() {
                let values = shape.at(node).values;
                for (j, value) in values.iter().enumerate() {
                    let expected = if i == j { 1.0 } else { 0.0 };
                    assert!((value - expected).abs() < 1e-15, "{shape:?} {i} {j}");
                }
            }
            let (at, h) = ([0.21, 0.34], 1e-6);
            let here = shape.at(at);
            assert!((here.values.iter().sum::<f64>() - 1.0).abs() < 1e-15);
            for k in 0..2 {
                let [mut ahead, mut behind] = [at; 2];
                ahead[k] += h;
                behind[k] -= h;
                let (ahead, behind) = (shape.at(ahead).values, shape.at(behind).values);
                for j in 0..count {
                    let slope = (ahead[j] - behind[j]) / (2.0 * h);
                    assert!((slope - here.derivatives[j][k]).abs() < 1e-9, "{shape:?} {j} {k}");
                }
            }
        }
    }

    #[test]
    fn rules_are_exact_to_the_fifth_degree() {
        let factorial = |n: i32| (1..=n).map(f64::from).product::<f64>();
        for (p, q) in (0..=5).flat_map(|p| (0..=5 - p).map(move |q| (p, q))) {
            let sum: f64 =
                triangle_rule().iter().map(|([x, y], w)| w * x.powi(p) * y.powi(q)).sum();
            let exact = factorial(p) * factorial(q) / factorial(p + q + 2);
            assert!((sum - exact).abs() < 1e-15, "{p} {q}: {sum} {exact}");
        }
    }

    #[test]
    fn triangles_cover_the_face_and_places_are_found() {
        for count in SHAPES {
            let shape = FaceShape::of_nodes(count).unwrap();
            let area: f64 = shape
                .triangles(3)
                .iter()
                .map(|[a, b, c]| {
                    0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
                })
                .sum();
            let whole: f64 = shape.rule().iter().map(|(_, weight)| weight).sum();
            assert!((area - whole).abs() < 1e-14, "{shape:?}");
            // A skewed face, with curved edges where it has nodes for them.
            let bent: Vec<[f64; 2]> = nodes(shape, count)
                .into_iter()
                .map(|[x, y]| [x + 0.2 * y + 0.05 * x * y, y - 0.1 * x + 0.05 * x * x])
                .collect();
            let at = [0.3, 0.4];
            let found = shape.locate(&bent, shape.interpolate(&bent, at), 1.0).unwrap();
            assert!((found[0] - at[0]).abs() + (found[1] - at[1]).abs() < 1e-12, "{shape:?}");
        }
    }
}
