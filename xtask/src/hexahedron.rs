//! The quadratic hexahedron of 20 nodes: its stiffness and mass by 27 Gauss points.

/// Corners and middles of edges of the element, in the order of C3D20.
pub(crate) const NODES: [[f64; 3]; 20] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
    [0.0, -1.0, -1.0],
    [1.0, 0.0, -1.0],
    [0.0, 1.0, -1.0],
    [-1.0, 0.0, -1.0],
    [0.0, -1.0, 1.0],
    [1.0, 0.0, 1.0],
    [0.0, 1.0, 1.0],
    [-1.0, 0.0, 1.0],
    [-1.0, -1.0, 0.0],
    [1.0, -1.0, 0.0],
    [1.0, 1.0, 0.0],
    [-1.0, 1.0, 0.0],
];

/// Stiffness \[N/m\], by node and axis, and mass of one axis \[kg\], by node, of an element with nodes at these `places` \[m\],
/// of Young's modulus \[Pa\], Poisson's ratio and density \[kg/m3\].
///
/// # Panics
/// For an element that is turned inside out.
pub(crate) fn element(
    places: &[[f64; 3]; 20],
    [modulus, poisson, density]: [f64; 3],
) -> (Vec<[f64; 60]>, Vec<[f64; 20]>) {
    let shear = 0.5 * modulus / (1.0 + poisson);
    let lame = 2.0 * shear * poisson / (1.0 - 2.0 * poisson);
    let (mut stiffness, mut mass) = (vec![[0.0; 60]; 60], vec![[0.0; 20]; 20]);
    let far = 0.6_f64.sqrt();
    let line = [(-far, 5.0 / 9.0), (0.0, 8.0 / 9.0), (far, 5.0 / 9.0)];
    for (x, wx) in line {
        for (y, wy) in line {
            for (z, wz) in line {
                let (values, slopes) = shape([x, y, z]);
                let mut jacobian = [[0.0; 3]; 3];
                for (place, slope) in places.iter().zip(&slopes) {
                    for i in 0..3 {
                        for j in 0..3 {
                            jacobian[i][j] += slope[i] * place[j];
                        }
                    }
                }
                let (inverse, determinant) = inverted(jacobian);
                assert!(determinant > 0.0, "an element is turned inside out");
                let weight = wx * wy * wz * determinant;
                let gradients = slopes.map(|slope| {
                    [0, 1, 2].map(|i| (0..3).map(|j| inverse[i][j] * slope[j]).sum::<f64>())
                });
                for (a, of_a) in gradients.iter().enumerate() {
                    for (b, of_b) in gradients.iter().enumerate() {
                        mass[a][b] += density * weight * values[a] * values[b];
                        let dot: f64 = of_a.iter().zip(of_b).map(|(p, q)| p * q).sum();
                        for i in 0..3 {
                            for j in 0..3 {
                                let same = if i == j { dot } else { 0.0 };
                                stiffness[3 * a + i][3 * b + j] += weight
                                    * (lame * of_a[i] * of_b[j]
                                        + shear * (of_a[j] * of_b[i] + same));
                            }
                        }
                    }
                }
            }
        }
    }
    (stiffness, mass)
}

/// The inverse of a matrix, and its determinant.
fn inverted(a: [[f64; 3]; 3]) -> ([[f64; 3]; 3], f64) {
    let minor = |i: usize, j: usize| {
        let [p, q] = [(i + 1) % 3, (i + 2) % 3];
        let [r, s] = [(j + 1) % 3, (j + 2) % 3];
        a[p][r] * a[q][s] - a[p][s] * a[q][r]
    };
    let determinant: f64 = (0..3).map(|j| a[0][j] * minor(0, j)).sum();
    let inverse = [0, 1, 2].map(|i| [0, 1, 2].map(|j| minor(j, i) / determinant));
    (inverse, determinant)
}

/// The shape functions of the element and their derivatives at a place in it.
fn shape(at: [f64; 3]) -> ([f64; 20], [[f64; 3]; 20]) {
    let (mut values, mut slopes) = ([0.0; 20], [[0.0; 3]; 20]);
    for (node, corner) in NODES.iter().enumerate() {
        let factor = [0, 1, 2].map(|axis| 1.0 + at[axis] * corner[axis]);
        if let Some(middle) = corner.iter().position(|c| *c == 0.0) {
            let [p, q] = [(middle + 1) % 3, (middle + 2) % 3];
            let flat = 1.0 - at[middle] * at[middle];
            values[node] = 0.25 * flat * factor[p] * factor[q];
            slopes[node][middle] = -0.5 * at[middle] * factor[p] * factor[q];
            slopes[node][p] = 0.25 * flat * corner[p] * factor[q];
            slopes[node][q] = 0.25 * flat * corner[q] * factor[p];
        } else {
            let sum: f64 = (0..3).map(|axis| at[axis] * corner[axis]).sum();
            values[node] = 0.125 * factor.iter().product::<f64>() * (sum - 2.0);
            for axis in 0..3 {
                let [b, c] = [factor[(axis + 1) % 3], factor[(axis + 2) % 3]];
                slopes[node][axis] = 0.125 * corner[axis] * b * c * (sum - 2.0 + factor[axis]);
            }
        }
    }
    (values, slopes)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Functions are one at their node, and derivatives agree with differences.
    #[test]
    fn shape_functions_interpolate() {
        for (node, place) in NODES.iter().enumerate() {
            let (values, _) = shape(*place);
            for (other, value) in values.iter().enumerate() {
                let expected = if node == other { 1.0 } else { 0.0 };
                assert!((value - expected).abs() < 1e-14, "{node} {other}");
            }
        }
        let (at, h) = ([0.3, -0.2, 0.6], 1e-6);
        let (_, slopes) = shape(at);
        for axis in 0..3 {
            let [mut ahead, mut behind] = [at; 2];
            ahead[axis] += h;
            behind[axis] -= h;
            let (ahead, behind) = (shape(ahead).0, shape(behind).0);
            for node in 0..20 {
                let slope = (ahead[node] - behind[node]) / (2.0 * h);
                assert!((slope - slopes[node][axis]).abs() < 1e-8, "{node} {axis}");
            }
        }
    }
}
