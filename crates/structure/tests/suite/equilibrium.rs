//! Static equilibrium against the discrete nonlinear equations.

use asperity_law::ContactLaw;
use asperity_mesh::{Body, Grid, Stack, Support};
use asperity_structure::{Damping, PreloadedStructure, StructureError};

use crate::linear_structure::LinearStructure;
use crate::rigs::{
    DISC, Law, at_rest, constant, every_law, exponential, modified, power, rig, rig_on,
    three_bodies,
};

/// Largest force [N] left over at any node when elastic forces, weights and the
/// pressures that the laws give for the closures of `field` are added up.
fn imbalance(stack: &Stack, field: &[f64], grid: &Grid) -> f64 {
    let structure = LinearStructure::on_grid(stack, grid);
    let mut left: Vec<f64> = structure
        .elastic_forces(field)
        .iter()
        .zip(structure.mass())
        .map(|(elastic, mass)| mass * stack.gravity() - elastic)
        .collect();
    for (contact, interface) in structure.contacts().iter().zip(stack.interfaces()) {
        let below = contact.below.map_or(0.0, |node| field[node]);
        let force = interface.law().pressure(field[contact.above] - below).value * contact.area;
        left[contact.above] -= force;
        if let Some(node) = contact.below {
            left[node] += force;
        }
    }
    left.iter().fold(0.0, |worst: f64, force| worst.max(force.abs()))
}

/// Static displacement [m] at every node of the grid, from the top down:
/// `u(x) = u_bottom + integral from x to L of (N + rho A g s) ds / (E A)`, quadratic, so that the
/// grid's differences of it are exact.
fn field_of(stack: &Stack, grid: &Grid) -> Vec<f64> {
    let rest = at_rest(stack).static_displacement();
    let mut field = Vec::with_capacity(grid.nodes() + 1);
    let mut load = 0.0;
    for ((body, &(_, bottom)), bar) in stack.bodies().iter().zip(&rest.faces).zip(grid.bars()) {
        let length = body.length();
        let weight = body.mass() * stack.gravity();
        field.extend((0..bar.nodes()).map(|node| {
            let s = node as f64 / bar.cells() as f64;
            let shortening = load * (1.0 - s) + 0.5 * weight * (1.0 - s * s);
            bottom + shortening * length / body.axial_rigidity()
        }));
        load += weight;
    }
    if *stack.support() != Support::Rigid {
        field.push(rest.support);
    }
    field
}

/// Weight of the whole stack without its support [N].
fn weight(stack: &Stack) -> f64 {
    stack.bodies().iter().map(Body::mass).sum::<f64>() * stack.gravity()
}

/// The static field solves the discrete nonlinear equations. The equations are
/// monotone, so that this solution is the only one.
#[test]
fn the_static_field_balances_weights_elastic_forces_and_pressures() {
    let mut stacks: Vec<(&str, Stack)> =
        every_law().into_iter().map(|(name, law)| (name, rig(&law))).collect();
    stacks.push(("rig on a disc", rig_on(&modified(), DISC)));
    stacks.push(("three bodies", three_bodies(Support::Rigid)));
    stacks.push(("three bodies on a disc", three_bodies(DISC)));
    for (name, stack) in stacks {
        let grid = Grid::new(&stack, 2e-3).unwrap();
        let mut field = field_of(&stack, &grid);
        let off = imbalance(&stack, &field, &grid) / weight(&stack);
        // Round-off of the elastic forces: E A u / dx is about 1e5 weights.
        assert!(off < 1e-9, "{name}: {off}");
        // A face moved by 1 pm is noticed.
        field[0] += 1e-12;
        assert!(imbalance(&stack, &field, &grid) / weight(&stack) > 1e-3, "{name}");
    }
}

/// The static state of each interface is the law at the weight above over the area.
#[test]
fn pressures_are_the_weight_above_over_the_area() {
    for (name, law) in every_law() {
        let stack = rig(&law);
        let structure = at_rest(&stack);
        let mut above = 0.0;
        for ((body, interface), state) in
            stack.bodies().iter().zip(stack.interfaces()).zip(structure.contacts())
        {
            above += body.mass() * 9.81;
            let pressure = above / interface.area();
            assert!((state.pressure() / pressure - 1.0).abs() < 1e-14, "{name}");
            assert_eq!(state.stiffness(), law.stiffness(state.pressure()), "{name}");
            let back = law.pressure(state.closure()).value;
            assert!((back / pressure - 1.0).abs() < 1e-12, "{name}");
        }
    }
}

/// The disc sinks by the whole weight, its own included, over its stiffness.
#[test]
fn the_disc_sinks_under_all_that_rests_on_it() {
    let stack = rig_on(&power(), DISC);
    let expected = (weight(&stack) + 3.0 * 9.81) / 2e8;
    let found = at_rest(&stack).static_displacement().support;
    assert!((found / expected - 1.0).abs() < 1e-14);
    assert_eq!(at_rest(&rig(&power())).static_displacement().support, 0.0);
}

fn weightless(law: &Law) -> Stack {
    let stack = rig(law);
    Stack::new(stack.bodies().to_vec(), stack.interfaces().to_vec(), Support::Rigid, 0.0).unwrap()
}

/// A law that never separates is infinitely far away at zero pressure.
#[test]
fn without_gravity_a_law_that_never_separates_has_no_equilibrium() {
    let error =
        PreloadedStructure::new(weightless(&exponential()), Damping::Rate(0.0)).unwrap_err();
    let expected =
        StructureError::NoEquilibrium { interface: "guide-sample".to_owned(), pressure_pa: 0.0 };
    assert_eq!(error, expected);
}

/// A power law just touches at zero pressure: it rests, but has no frequency
/// that a damping ratio or a mode could refer to.
#[test]
fn without_gravity_a_power_law_rests_but_has_no_frequency() {
    let of = |damping| PreloadedStructure::new(weightless(&power()), damping);
    let structure = of(Damping::Rate(100.0)).unwrap();
    assert_eq!(structure.contacts()[0].closure(), 0.0);
    assert_eq!((structure.damping_rate(), structure.natural_frequency()), (100.0, None));
    let no_frequency = |error| matches!(error, StructureError::NoFrequency { .. });
    assert!(no_frequency(structure.modes(1).unwrap_err()));
    assert!(no_frequency(of(Damping::Ratio(0.035)).unwrap_err()));
    assert_eq!(of(Damping::Ratio(0.0)).unwrap().damping_rate(), 0.0);
}

#[test]
fn damping_that_is_negative_or_not_finite_is_an_error() {
    for bad in [-0.1, f64::NAN, f64::INFINITY] {
        for damping in [Damping::Ratio(bad), Damping::Rate(bad)] {
            let error = PreloadedStructure::new(rig(&constant()), damping).unwrap_err();
            assert!(matches!(error, StructureError::Setting { .. }), "{damping:?}");
        }
    }
}
