//! Findings and rigid motions of small structures.
#![allow(clippy::unwrap_used, reason = "the structures are valid")]

use asperity_matrices::{Dof, Matrices, Nodes, RigidMotions, SparseSymmetric};

/// Point masses at the corners of a square in space, each pair joined by a bar of stiffness `k`; every second node
/// has an internal row with stiffness and mass.
fn truss(k: f64, mass: f64, internal: bool) -> (Matrices, Nodes) {
    let places =
        [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.5], [1.0, 1.0, 1.0]];
    let mut dofs: Vec<Dof> =
        (1..=5).flat_map(|node| (1..=3).map(move |axis| Dof::new(node, axis))).collect();
    let (mut stiffness, mut masses) = (Vec::new(), Vec::new());
    for a in 0..5 {
        for b in 0..a {
            let along: [f64; 3] = std::array::from_fn(|x| places[a][x] - places[b][x]);
            let length = along.iter().map(|x| x * x).sum::<f64>().sqrt();
            for i in 0..3 {
                for j in 0..3 {
                    let value = k * along[i] * along[j] / (length * length);
                    stiffness.push((3 * a + i, 3 * b + j, -value));
                    if j <= i {
                        stiffness.push((3 * a + i, 3 * a + j, value));
                        stiffness.push((3 * b + i, 3 * b + j, value));
                    }
                }
            }
        }
        masses.extend((0..3).map(|axis| (3 * a + axis, 3 * a + axis, mass)));
    }
    if internal {
        // With mass, and coupled to a node.
        dofs.push(Dof::new(1001, 1));
        stiffness.push((15, 15, 3.0 * k));
        masses.extend([(15, 15, mass), (15, 2, 0.2 * mass)]);
    }
    let size = dofs.len();
    let stiffness = SparseSymmetric::from_triplets(size, stiffness);
    let masses = SparseSymmetric::from_triplets(size, masses);
    let numbered = (1..).zip(places);
    (Matrices::new(stiffness, masses, dofs).unwrap(), Nodes::new(numbered))
}

#[test]
fn a_free_structure_has_six_rigid_motions_and_its_mass() {
    let (matrices, nodes) = truss(1e8, 2.0, false);
    let rigid = matrices.rigid_motions(&nodes, None);
    assert_eq!(rigid.translational_mass(), [10.0; 3]);
    assert_eq!(rigid.free_count(), 6);
    assert_eq!(rigid.free_axes().count(), 6);
    // Moment of inertia about the x axis through the centre (0.6, 0.4, 0.5).
    let about_x: f64 =
        nodes.iter().map(|(_, [_, y, z])| 2.0 * ((y - 0.4).powi(2) + (z - 0.5).powi(2))).sum();
    assert!((rigid.mass[3][3] - about_x).abs() < 1e-12);
    assert!(rigid.mass[0][3].abs() < 1e-12 && rigid.mass[0][4].abs() < 1e-12);
    let texts: Vec<String> =
        matrices.findings(Some(&nodes)).iter().map(ToString::to_string).collect();
    assert_eq!(
        texts,
        [
            "extent along x, y, z: 2.000000, 1.000000, 1.500000 m",
            "mass in translation along x, y, z: 1.000000e1, 1.000000e1, 1.000000e1 kg",
            "6 rigid motions without stiffness: along x, along y, along z, about x, about y, about z",
        ]
    );
    assert_eq!(RigidMotions::NAMES.len(), 6);
}

#[test]
fn internal_rows_have_no_part_in_rigid_motions_and_gravity() {
    let (matrices, nodes) = truss(1e8, 2.0, true);
    let sum: f64 = matrices.mass().multiply(&[1.0; 16]).iter().sum();
    assert!((sum - 32.8).abs() < 1e-12);
    let rigid = matrices.rigid_motions(&nodes, None);
    assert_eq!(rigid.translational_mass(), [10.0; 3]);
    assert_eq!(rigid.free_count(), 6);
    let gravity = matrices.gravity_loads([0.0, 0.0, -10.0], Some(&nodes));
    assert_eq!(gravity.iter().sum::<f64>(), -100.0);
    assert_eq!(gravity[15], 0.0);
    let texts: Vec<String> =
        matrices.findings(Some(&nodes)).iter().map(ToString::to_string).collect();
    assert!(texts[0].starts_with("1 of 16 rows belong to no node of the mesh"), "{texts:?}");
    // Without a mesh only nodes below 1 are known to be internal.
    assert_eq!(matrices.internal_rows(None), [false; 16]);
}

#[test]
fn a_structure_held_at_a_node_turns_about_it() {
    let (matrices, nodes) = truss(1e8, 2.0, false);
    let held = rest(&matrices, |dof| dof.node != 1);
    let rigid = held.rigid_motions(&nodes, None);
    assert_eq!((rigid.free_count(), rigid.free_axes().count()), (3, 0));
    assert_eq!(rigid.translational_mass(), [8.0; 3]);
    let texts: Vec<String> = held.findings(Some(&nodes)).iter().map(ToString::to_string).collect();
    assert!(texts[0].starts_with("1 nodes of the mesh have no rows"), "{texts:?}");
    assert_eq!(texts[3], "3 rigid motions without stiffness");
    let clamped = rest(&held, |dof| ![2, 3].contains(&dof.node));
    assert_eq!(clamped.rigid_motions(&nodes, None).free_count(), 0);
}

/// The rows that are kept.
fn rest(matrices: &Matrices, kept: impl Fn(Dof) -> bool) -> Matrices {
    let kept: Vec<usize> = (0..matrices.size()).filter(|row| kept(matrices.dofs()[*row])).collect();
    let part = |matrix: &SparseSymmetric| {
        let all = (0..kept.len()).flat_map(|i| (0..=i).map(move |j| (i, j)));
        let entries: Vec<_> = all.map(|(i, j)| (i, j, matrix.get(kept[i], kept[j]))).collect();
        SparseSymmetric::from_triplets(kept.len(), entries)
    };
    let dofs = kept.iter().map(|row| matrices.dofs()[*row]).collect();
    Matrices::new(part(matrices.stiffness()), part(matrices.mass()), dofs).unwrap()
}

#[test]
fn a_hinge_about_an_oblique_axis_is_one_motion() {
    let (matrices, nodes) = truss(1e8, 2.0, false);
    // Held at (0, 0, 0) and (1, 1, 1).
    let hinged = rest(&matrices, |dof| ![1, 5].contains(&dof.node));
    let rigid = hinged.rigid_motions(&nodes, None);
    assert_eq!((rigid.free_count(), rigid.free_axes().count()), (1, 0));
    // A spring of 1e-7 of the stiffness holds it.
    let mut springs: Vec<_> = hinged.stiffness().triplets().collect();
    springs.push((1, 1, 10.0));
    let stiffness = SparseSymmetric::from_triplets(9, springs);
    let held = Matrices::new(stiffness, hinged.mass().clone(), hinged.dofs().to_vec()).unwrap();
    assert_eq!(held.rigid_motions(&nodes, None).free_count(), 0);
}

#[test]
fn parts_have_motions_of_their_own() {
    let (one, nodes) = truss(1e8, 2.0, false);
    // A second truss of nodes 11 to 15, held at node 11.
    let second = rest(&one, |dof| dof.node != 1);
    let shifted = |matrix: &SparseSymmetric, other: &SparseSymmetric| {
        let moved = other.triplets().map(|(row, column, value)| (row + 15, column + 15, value));
        SparseSymmetric::from_triplets(27, matrix.triplets().chain(moved).collect::<Vec<_>>())
    };
    let mut dofs = one.dofs().to_vec();
    dofs.extend(second.dofs().iter().map(|dof| Dof::new(dof.node + 10, dof.direction)));
    let stiffness = shifted(one.stiffness(), second.stiffness());
    let both = Matrices::new(stiffness, shifted(one.mass(), second.mass()), dofs).unwrap();
    let far = nodes.iter().map(|(node, [x, y, z])| (node + 10, [x + 9.0, y, z]));
    let mesh = Nodes::new(nodes.iter().chain(far));
    let counts: Vec<usize> = both
        .parts(&mesh)
        .iter()
        .map(|part| both.rigid_motions(&mesh, Some(part)).free_count())
        .collect();
    assert_eq!(counts, [6, 3]);
    let texts: Vec<String> = both.findings(Some(&mesh)).iter().map(ToString::to_string).collect();
    let expected = "part 2 of 2 (nodes 12 to 15): 3 rigid motions without stiffness";
    assert_eq!(texts.last().unwrap(), expected);
}

#[test]
fn faults_are_named_with_rows_and_numbers() {
    let dofs = vec![Dof::new(1, 1), Dof::new(2, 1)];
    let matrix = |a: f64, both: f64, b: f64| {
        SparseSymmetric::from_triplets(2, [(0, 0, a), (1, 0, both), (1, 1, b)])
    };
    let find = |stiffness, mass| -> Vec<String> {
        let found = Matrices::new(stiffness, mass, dofs.clone()).unwrap().findings(None);
        found.iter().map(|finding| format!("{}: {finding}", finding.is_fault)).collect()
    };
    let mass = || matrix(1.0, 0.0, 1.0);
    assert!(find(matrix(2.0, -1.0, 1.0), mass()).is_empty());
    let found = find(matrix(2.0, -1.0, -0.5), mass());
    let expected = "true: 1 diagonals of the stiffness are negative, the first -5e-1 in row 2 (node 2 direction 1)";
    assert!(found[0].starts_with(expected), "{found:?}");
    let found = find(matrix(2.0, -1.5, 1.0), mass());
    let expected = "true: the stiffness has the entry -1.5e0 of row 2 (node 2 direction 1) and column 1 (node 1 direction 1)";
    assert!(found[0].starts_with(expected), "{found:?}");
    assert_eq!(find(matrix(2.0, 0.0, 0.0), mass()), ["false: 1 of 2 rows have no stiffness"]);
    assert_eq!(
        find(matrix(2.0, 0.0, 1.0), matrix(1.0, 0.0, 0.0)),
        ["false: 1 of 2 rows have no mass"]
    );
    let found = find(matrix(2.0, 0.0, 1.0), matrix(0.0, 0.0, 0.0));
    assert_eq!(found, ["true: the mass matrix is zero; expected the mass of the structure"]);
    let error = Matrices::new(mass(), mass(), dofs[..1].to_vec()).unwrap_err().to_string();
    assert!(error.starts_with("the stiffness has 2 rows, the mass 2, and 1 rows have"), "{error}");
    let error = Matrices::new(mass(), mass(), vec![dofs[0]; 2]).unwrap_err().to_string();
    assert_eq!(error, "node 1 direction 1 has the rows 1 and 2; expected one row each");
}
