//! Numbering, masses and elastic forces of a grid's matrices.

use std::sync::Arc;

use asperity_law::Constant;
use asperity_mesh::{Body, Grid, Interface, Stack, Support};

use crate::linear_structure::LinearStructure;

fn structure(support: Support) -> (Stack, LinearStructure) {
    let law = Arc::new(Constant::new(1e12).unwrap());
    let body = |name| Body::new(name, 0.02, 2e-4, 71e9, 2710.0).unwrap();
    let contact = |name| Interface::new(name, 1e-4, law.clone()).unwrap();
    let stack = Stack::new(
        vec![body("a"), body("b"), body("c")],
        vec![contact("ab"), contact("bc"), contact("c0")],
        support,
        9.81,
    )
    .unwrap();
    let grid = Grid::new(&stack, 0.02 / 7.0).unwrap();
    let structure = LinearStructure::on_grid(&stack, &grid);
    (stack, structure)
}

#[test]
fn three_bodies_on_a_rigid_support_are_numbered_from_the_top() {
    let (stack, structure) = structure(Support::Rigid);
    assert_eq!(structure.nodes(), 24);
    let faces: Vec<_> = structure.contacts().iter().map(|c| (c.above, c.below)).collect();
    assert_eq!(faces, [(7, Some(8)), (15, Some(16)), (23, None)]);
    let mass: f64 = structure.mass().iter().sum();
    let expected: f64 = stack.bodies().iter().map(Body::mass).sum();
    assert!((mass - expected).abs() < 1e-15);
    assert!((structure.position()[23] - 0.06).abs() < 1e-15);
}

/// Free bodies: a rigid translation meets no elastic force; a uniform strain
/// is resisted by E A strain at the ends only.
#[test]
fn elastic_forces_of_rigid_and_uniform_strain_fields() {
    let (_, structure) = structure(Support::Rigid);
    assert!(structure.elastic_forces(&[1.0; 24]).iter().all(|f| f.abs() < 1e-6));
    let strained: Vec<f64> = structure.position().iter().map(|x| 1e-3 * x).collect();
    let forces = structure.elastic_forces(&strained);
    let expected = 71e9 * 2e-4 * 1e-3;
    assert!((forces[0] + expected).abs() < 1e-6 * expected);
    assert!((forces[7] - expected).abs() < 1e-6 * expected);
    assert!(forces[1..7].iter().all(|f| f.abs() < 1e-6 * expected));
}

#[test]
fn a_spring_mass_support_is_one_more_node_without_body_damping() {
    let support = Support::SpringMass { stiffness: 1e8, mass: 5.0, damping_ratio: 0.1 };
    let (_, structure) = structure(support);
    assert_eq!(structure.nodes(), 25);
    assert_eq!(structure.contacts()[2].below, Some(24));
    assert_eq!(structure.mass()[24], 5.0);
    assert_eq!(structure.damped_mass().last(), Some(0.0));
    assert!((structure.support_damping() - 2.0 * 0.1 * (5e8_f64).sqrt()).abs() < 1e-9);
    let mut shift = vec![0.0; 25];
    shift[24] = 2.0;
    assert_eq!(structure.elastic_forces(&shift)[24], 2e8);
}
