//! Reduction of sparse bodies against all modes of dense matrices.

use std::sync::Arc;

use asperity_mesh::{
    Body, BodyDamping, ComponentModes, Interface, Port, PortPair, PortPattern, ReducedBody,
    SparseBody, Stack, Support,
};
use faer::sparse::{SparseColMat, Triplet};
use faer::{Mat, MatRef};

/// Numbers between 0 and 1.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// Lattice of masses in three dimensions, each joined to its neighbours by springs in all directions,
/// as lower triangles, with the places of its rows. A free one has three rigid motions.
fn lattice(
    (nx, ny, nz): (usize, usize, usize),
    random: &mut Random,
) -> (Mat<f64>, Mat<f64>, Vec<Option<[f64; 3]>>) {
    let at = |x: usize, y: usize, z: usize| (z * ny + y) * nx + x;
    let size = 3 * nx * ny * nz;
    let (mut k, mut m) = (Mat::zeros(size, size), Mat::zeros(size, size));
    let mut places = vec![None; size];
    for z in 0..nz {
        for y in 0..ny {
            for x in 0..nx {
                let own = at(x, y, z);
                for axis in 0..3 {
                    m[(3 * own + axis, 3 * own + axis)] = 1.0 + random.next();
                    places[3 * own + axis] = Some([x, y, z].map(|c| c as f64));
                }
                for next in [(x + 1, y, z), (x, y + 1, z), (x, y, z + 1), (x + 1, y + 1, z)] {
                    if next.0 >= nx || next.1 >= ny || next.2 >= nz {
                        continue;
                    }
                    let other = at(next.0, next.1, next.2);
                    for axis in 0..3 {
                        let spring = 1e4 * (0.5 + random.next());
                        let (a, b) = (3 * own + axis, 3 * other + axis);
                        k[(a, a)] += spring;
                        k[(b, b)] += spring;
                        k[(a, b)] -= spring;
                        k[(b, a)] -= spring;
                    }
                }
            }
        }
    }
    (k, m, places)
}

fn sparse(matrix: MatRef<'_, f64>) -> SparseColMat<usize, f64> {
    let size = matrix.nrows();
    let lower = (0..size).flat_map(|j| (j..size).map(move |i| (i, j)));
    let entries: Vec<_> = lower
        .filter(|&(i, j)| matrix[(i, j)] != 0.0)
        .map(|(i, j)| Triplet::new(i, j, matrix[(i, j)]))
        .collect();
    SparseColMat::try_new_from_triplets(size, size, &entries).unwrap()
}

/// Compares with the dense computation: frequencies, participations up to the basis of equal
/// frequencies, and the flexibility of all others.
fn compare(k: &Mat<f64>, m: &Mat<f64>, places: Vec<Option<[f64; 3]>>, modes: usize) {
    let size = k.nrows();
    let ports: Vec<PortPattern> = vec![
        vec![(0, 1.0)],
        vec![(size - 1, 1.0)],
        vec![(size / 2, 0.25), (size / 3, 0.75), (1, -0.5)],
        (0..size).step_by(3).map(|row| (row, m[(row, row)])).collect(),
    ];
    let dense = (k.as_ref(), m.as_ref());
    let expected =
        ComponentModes::from_matrices(dense, &ports, vec![PortPair::on_ground(0)], modes);
    let expected = expected.unwrap();
    let body = SparseBody::new(sparse(k.as_ref()), sparse(m.as_ref()), places).unwrap();
    let found = ReducedBody::new(&body, &ports, modes).unwrap();
    assert_eq!(found.angular_frequencies.len(), expected.modes().len());
    let largest = expected.modes().last().unwrap().angular_frequency;
    for (own, mode) in found.angular_frequencies.iter().zip(expected.modes()) {
        assert!((own - mode.angular_frequency).abs() <= 1e-9 * largest, "{own} {mode:?}");
    }
    // Sums over all kept modes do not depend on the basis of equal frequencies.
    for a in 0..ports.len() {
        for b in 0..ports.len() {
            let of = |participations: &[f64]| participations[a] * participations[b];
            let own: f64 = found.participations.iter().map(|mode| of(mode)).sum();
            let other: f64 = expected.modes().iter().map(|mode| of(&mode.ports)).sum();
            let scale = |port: usize| -> f64 {
                let squares = expected.modes().iter().map(|mode| mode.ports[port].powi(2));
                squares.sum::<f64>().sqrt()
            };
            assert!((own - other).abs() < 1e-8 * scale(a) * scale(b), "{a} {b} {own} {other}");
            let [own, other] = [found.residual.get(a, b), expected.residual().get(a, b)];
            let scale = (0..ports.len()).map(|port| expected.residual().get(port, port));
            let scale = scale.fold(0.0, f64::max);
            assert!((own - other).abs() <= 1e-9 * scale, "{a} {b} {own:e} {other:e}");
        }
    }
}

/// Random lattices of all shapes, with places and without.
#[test]
fn lattices_are_reduced_as_by_all_their_modes() {
    let mut random = Random(7);
    for (shape, modes) in
        [((2, 1, 1), 2), ((12, 2, 2), 10), ((4, 4, 4), 20), ((30, 1, 1), 6), ((60, 1, 1), 3)]
    {
        let (k, m, places) = lattice(shape, &mut random);
        compare(&k, &m, places, modes);
        compare(&k, &m, Vec::new(), modes);
    }
}

/// Rigid motions and frequencies four times, and eleven times: more copies than a block has vectors.
#[test]
fn repeated_modes_are_all_found() {
    for (shape, copies, modes) in [((5, 2, 2), 4, 28), ((3, 2, 2), 11, 55)] {
        let (k, m, _) = lattice(shape, &mut Random(3));
        let size = k.nrows();
        let repeat = |matrix: &Mat<f64>| {
            Mat::from_fn(copies * size, copies * size, |i, j| {
                if i / size == j / size { matrix[(i % size, j % size)] } else { 0.0 }
            })
        };
        compare(&repeat(&k), &repeat(&m), Vec::new(), modes);
    }
}

/// Rows without mass are statically condensed.
#[test]
fn rows_without_mass_have_no_mode() {
    let (k, mut m, places) = lattice((6, 2, 1), &mut Random(11));
    for row in [4, 9, 20] {
        m[(row, row)] = 0.0;
    }
    let size = k.nrows();
    let body = SparseBody::new(sparse(k.as_ref()), sparse(m.as_ref()), places).unwrap();
    let found = ReducedBody::new(&body, &[vec![(4, 1.0)]], size).unwrap();
    assert_eq!(found.angular_frequencies.len(), size - 3);
    assert_eq!(found.rigid_count(), 3);
    // The row is held by its neighbours' springs alone.
    let stiffness = k[(4, 4)];
    let held = found.residual.get(0, 0) * stiffness;
    assert!((held - 1.0).abs() < 1e-9, "{held}");
}

#[test]
fn matrices_that_are_none_are_refused() {
    let (k, m, places) = lattice((3, 2, 1), &mut Random(5));
    let (stiffness, mass) = (sparse(k.as_ref()), sparse(m.as_ref()));
    assert!(SparseBody::new(stiffness.clone(), mass.clone(), places[1..].to_vec()).is_err());
    let upper = stiffness.transpose().to_col_major().unwrap();
    assert!(SparseBody::new(upper, mass.clone(), Vec::new()).is_err());
    let mut negative = k.clone();
    negative[(0, 0)] -= 2e4;
    negative[(0, 0)] = negative[(0, 0)].max(1.0);
    let body = SparseBody::new(sparse(negative.as_ref()), mass.clone(), Vec::new()).unwrap();
    let error = ReducedBody::new(&body, &[vec![(0, 1.0)]], 2).unwrap_err();
    assert!(error.to_string().contains("not positive semidefinite"), "{error}");
    let body = SparseBody::new(stiffness, mass, Vec::new()).unwrap();
    assert!(ReducedBody::new(&body, &[vec![(k.nrows(), 1.0)]], 2).is_err());
    assert!(ReducedBody::new(&body, &[], 0).is_err());
}

/// A bar joined as a reduced body has the modes and the flexibility of the same bar in a stack, the sums of its ports
/// too; and flexibility without any elastic mode kept keeps its retardation time.
#[test]
fn a_bar_reduces_to_its_modes_in_a_stack() {
    let bar = Body::new("bar", 0.3, 2e-4, 70e9, 2700.0).unwrap();
    let damped = bar.clone().with_damping(BodyDamping::kelvin_voigt(3e-6).unwrap());
    let law = Arc::new(asperity_law::Constant::new(1e12).unwrap());
    let contact = Interface::new("foot", 1e-4, law).unwrap();
    let point = |position: f64| Port::Point { body: 0, position };
    let places = [point(0.0), Port::Mean { body: 0 }, point(0.1), point(0.3)];
    for (time, body) in [(0.0, bar.clone()), (3e-6, damped)] {
        let stack = Stack::new(vec![body], vec![contact.clone()], Support::Rigid, 9.81).unwrap();
        for count in [1, 4] {
            let own = ComponentModes::with_counts(&stack, &[count], &places[..3]).unwrap();
            let mut ports: Vec<_> = (0..4).map(|place| vec![(place, 1.0)]).collect();
            ports.push(vec![(0, 2.0), (3, -1.0)]);
            let reduced = ReducedBody::of_bar(&bar, &places, &ports, count).unwrap();
            let numbers = [0, 1, 2, 3, 4];
            let contacts = vec![PortPair::on_ground(3)];
            let joined = ReducedBody::joined(&[(&reduced, &numbers)], 5, time, contacts).unwrap();
            // Flexibility, and its retardation time, at 1e4 rad/s.
            let receptance = |modes: &ComponentModes, a: &[f64], b: &[f64]| -> [f64; 2] {
                let w: f64 = 1e4;
                let along = |of: &[f64], weights: &[f64]| -> f64 {
                    weights.iter().zip(of).map(|(weight, phi)| weight * phi).sum()
                };
                let mut sum = [0.0; 2];
                for (i, x) in a.iter().enumerate() {
                    let row = b.iter().enumerate();
                    sum[0] += row.map(|(j, y)| x * y * modes.residual().get(i, j)).sum::<f64>();
                }
                for mode in modes.modes() {
                    let inertia = if mode.massless { 0.0 } else { w * w };
                    let stiffness = mode.angular_frequency.powi(2) - inertia;
                    let loss = mode.damping_rate * w;
                    let size = along(&mode.ports, a) * along(&mode.ports, b)
                        / (stiffness * stiffness + loss * loss);
                    sum[0] += size * stiffness;
                    sum[1] -= size * loss;
                }
                sum
            };
            for (a, b) in [
                ([1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]),
                ([2.0, 0.0, 0.0, -1.0], [0.0, 1.0, 0.0, 1.0]),
            ] {
                let exact = receptance(&own, &a, &b);
                let found = receptance(&joined, &a, &b);
                for (found, exact) in found.iter().zip(exact) {
                    assert!(
                        (found - exact).abs() < 1e-12 * exact.abs() + 1e-24,
                        "{found:e} {exact:e}"
                    );
                }
            }
            let combined =
                receptance(&joined, &[0.0, 0.0, 0.0, 0.0, 1.0], &[0.0, 1.0, 0.0, 1.0, 0.0]);
            let exact = receptance(&own, &[2.0, 0.0, 0.0, -1.0], &[0.0, 1.0, 0.0, 1.0]);
            assert!((combined[0] / exact[0] - 1.0).abs() < 1e-12);
        }
    }
}
