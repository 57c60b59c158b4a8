//! Component modes against the closed form of bars and against each other.

use std::f64::consts::PI;
use std::sync::Arc;

use asperity_law::Constant;
use asperity_mesh::component_modes::flexibility_factor;
use asperity_mesh::{
    BarStiffness, Body, ComponentModes, Grid, Interface, MeshError, ModeCount, Port, PortPair,
    ResidualFlexibility, Stack, Support,
};
use faer::{Mat, mat};

use crate::linear_structure::LinearStructure;

/// Two bars of different size.
fn stack(support: Support) -> Stack {
    let law = Arc::new(Constant::new(1e12).unwrap());
    let contact = |name| Interface::new(name, 1e-4, law.clone()).unwrap();
    let bodies = vec![
        Body::new("a", 0.2, 2e-3, 71e9, 2710.0).unwrap(),
        Body::new("b", 0.03, 1e-4, 71e9, 2710.0).unwrap(),
    ];
    Stack::new(bodies, vec![contact("ab"), contact("b0")], support, 9.81).unwrap()
}

/// Receptance of closure i per contact force j, without damping.
fn closure_receptance(structure: &ComponentModes, w: f64, (i, j): (usize, usize)) -> f64 {
    let [i, j] = [structure.contacts()[i], structure.contacts()[j]];
    let modes = structure.modes().iter();
    let sum: f64 =
        modes.map(|m| m.closure(i) * m.closure(j) / (m.angular_frequency.powi(2) - w * w)).sum();
    sum + structure.residual().closure(i, j)
}

/// Against the closed-form dynamic stiffness of the bars: the error is the neglected
/// inertia and falls with the fourth power of frequency, as the bound says.
#[test]
fn modes_and_residual_meet_the_closed_form_receptance() {
    let stack = stack(Support::Rigid);
    let exact = |w: f64, direct: bool| {
        let [a, b] = [0, 1].map(|i| BarStiffness::at(&stack.bodies()[i], w));
        // Flexibility is the inverse of the two-by-two dynamic stiffness.
        let inverse = |s: &BarStiffness| {
            let determinant = s.direct * s.direct - s.cross * s.cross;
            (s.direct / determinant, -s.cross / determinant)
        };
        let ((a_same, _), (b_same, b_across)) = (inverse(&a), inverse(&b));
        if direct { a_same + b_same } else { -b_across }
    };
    let first = PI * stack.bodies()[0].wave_speed() / stack.bodies()[0].length();
    for kept in [1, 2, 5] {
        let structure = ComponentModes::of_stack(&stack, ModeCount::PerBody(kept), &[]).unwrap();
        let error =
            |w: f64| (closure_receptance(&structure, w, (0, 0)) - exact(w, true)).abs() * w * w;
        let (low, high) = (error(0.05 * first), error(0.1 * first));
        let slope = (high / low).log2();
        assert!((slope - 4.0).abs() < 0.1, "{kept}: {slope}");
        let across = closure_receptance(&structure, 0.1 * first, (0, 1));
        assert!((across / exact(0.1 * first, false) - 1.0).abs() < 1e-6);
    }
}

#[test]
fn the_bound_keeps_the_modes_that_matter() {
    let stack = stack(Support::Rigid);
    let bar = &stack.bodies()[0];
    let first = PI * bar.wave_speed() / bar.length();
    let counts = |share: f64, tolerance: f64| {
        ModeCount::Bound { angular_frequency: share * first, tolerance }.counts(&stack).unwrap()
    };
    let kept = |share: f64, tolerance: f64| counts(share, tolerance)[0];
    assert_eq!(kept(0.01, 1e-3), 1);
    assert_eq!(kept(0.23, 1e-3), 2);
    assert!(kept(0.23, 1e-6) > 5);
    assert!(kept(20.0, 1e-3) > 28, "modes up to the band, with margin");
    assert_eq!(counts(0.23, 1e-3)[1], 1);
    assert!(ModeCount::PerBody(0).counts(&stack).is_err());
    let far = ModeCount::Bound { angular_frequency: 1e9, tolerance: 1e-3 };
    assert!(far.counts(&stack).is_err());
}

/// Leaving a mode out of many gives what keeping fewer gives.
#[test]
fn a_mode_left_out_is_flexibility() {
    let stack = stack(Support::Rigid);
    let ports = [Port::TOP, Port::Point { body: 1, position: 0.02 }];
    let of = |modes| ComponentModes::of_stack(&stack, ModeCount::PerBody(modes), &ports).unwrap();
    let mut residual = of(3).residual().clone();
    residual.add(&of(3).modes()[2]);
    residual.add(&of(3).modes()[5]);
    let fewer = of(2);
    for i in 0..fewer.ports() {
        for j in 0..fewer.ports() {
            let off = residual.get(i, j) - fewer.residual().get(i, j);
            assert!(off.abs() < 1e-15 * residual.get(3, 3), "{i} {j}: {off:e}");
        }
    }
}

/// A bar driven at x and read at y against its closed-form receptance,
/// `-cos(k x) cos(k (L - y)) / (E A k sin(k L))` for x <= y: the error is the neglected inertia, and
/// falls with the fourth power of frequency. Reciprocal to the last bit.
#[test]
fn a_bar_driven_at_x_and_read_at_y_meets_its_closed_form() {
    let stack = stack(Support::Rigid);
    let bar = &stack.bodies()[0];
    let first = PI * bar.wave_speed() / bar.length();
    let places = [(0.0, 0.07), (0.013, 0.2), (0.11, 0.11), (0.05, 0.17)];
    for (x, y) in places {
        let ports = [x, y].map(|position| Port::Point { body: 0, position });
        for kept in [1, 3] {
            let found = ComponentModes::of_stack(&stack, ModeCount::PerBody(kept), &ports).unwrap();
            let error = |w: f64| {
                let k = w / bar.wave_speed();
                let exact = -(k * x).cos() * (k * (bar.length() - y)).cos()
                    / (bar.axial_rigidity() * k * (k * bar.length()).sin());
                let modes = found.modes().iter();
                let modal = |m: &asperity_mesh::NormalMode| {
                    m.ports[0] * m.ports[1] / (m.angular_frequency.powi(2) - w * w)
                };
                let sum = modes.map(modal).sum::<f64>() + found.residual().get(0, 1);
                assert_eq!(found.residual().get(0, 1), found.residual().get(1, 0));
                (sum - exact).abs() * w * w
            };
            let (low, high) = (error(0.05 * first), error(0.1 * first));
            assert!(((high / low).log2() - 4.0).abs() < 0.1, "{x} {y} {kept}: {low:e} {high:e}");
        }
    }
}

/// The inertia under a base acceleration acts on rigid motions alone, with the mass of the whole.
#[test]
fn a_base_acceleration_moves_whole_bodies() {
    let support = Support::SpringMass { stiffness: 1e8, mass: 4.0, damping_ratio: 0.1 };
    let stack = stack(support);
    let of = |modes| ComponentModes::of_stack(&stack, modes, &[Port::Base, Port::TOP]).unwrap();
    let found = of(ModeCount::PerBody(4));
    let squares = found.modes().iter().map(|mode| mode.ports[0].powi(2)).sum::<f64>();
    let mass = stack.bodies().iter().map(Body::mass).sum::<f64>() + 4.0;
    assert!((squares / mass - 1.0).abs() < 1e-14);
    assert!((0..found.ports()).all(|port| found.residual().get(0, port) == 0.0));
}

/// A retardation time turns the flexibility left out into massless modes, at all ports alike.
#[test]
fn massless_modes_have_the_flexibility_of_the_residual() {
    let elastic = stack(Support::Rigid);
    let damping = asperity_mesh::BodyDamping::kelvin_voigt(1e-6).unwrap();
    let ports = [0.0, 0.03, 0.15].map(|position| Port::Point { body: 0, position });
    let of =
        |stack: &Stack| ComponentModes::of_stack(stack, ModeCount::PerBody(2), &ports).unwrap();
    let (plain, damped) = (of(&elastic), of(&elastic.clone().with_body_damping(damping)));
    let mut residual = damped.residual().clone();
    for mode in damped.modes().iter().filter(|mode| mode.massless) {
        residual.add(mode);
    }
    for i in 0..plain.ports() {
        for j in 0..plain.ports() {
            let off = residual.get(i, j) - plain.residual().get(i, j);
            assert!(off.abs() < 1e-13 * plain.residual().get(0, 0), "{i} {j}: {off:e}");
        }
    }
}

#[test]
fn ports_beside_the_stack_are_errors() {
    let stack = stack(Support::Rigid);
    for port in [
        Port::Mean { body: 2 },
        Port::Point { body: 0, position: 0.2001 },
        Port::Point { body: 0, position: -1e-9 },
        Port::Point { body: 1, position: f64::NAN },
    ] {
        let found = ComponentModes::of_stack(&stack, ModeCount::PerBody(1), &[port]);
        assert!(matches!(found, Err(MeshError::Port { .. })), "{found:?}");
    }
}

#[test]
fn a_spring_mass_support_is_one_more_oscillator() {
    let support = Support::SpringMass { stiffness: 1e8, mass: 4.0, damping_ratio: 0.1 };
    let structure = ComponentModes::of_stack(&stack(support), ModeCount::PerBody(2), &[]).unwrap();
    let last = structure.modes().last().unwrap();
    assert_eq!(structure.modes().len(), 5);
    assert_eq!(last.angular_frequency, 5e3);
    let closures = structure.contacts().iter().map(|&pair| last.closure(pair));
    assert_eq!(closures.collect::<Vec<_>>(), [0.0, -0.5]);
    assert!(!last.mass_damped && (last.damping_rate - 2.0 * 0.1 * 5e3).abs() < 1e-9);
}

#[test]
fn rows_of_unequal_length_are_errors() {
    let whole =
        ComponentModes::of_stack(&stack(Support::Rigid), ModeCount::PerBody(1), &[]).unwrap();
    let of = |modes, contacts: &[PortPair]| {
        ComponentModes::new(modes, whole.residual().clone(), contacts.to_vec(), vec![])
    };
    assert!(of(whole.modes().to_vec(), whole.contacts()).is_ok());
    let mut modes = whole.modes().to_vec();
    modes[0].ports.pop();
    assert!(matches!(of(modes, whole.contacts()), Err(MeshError::ModalSize { .. })));
    let mut modes = whole.modes().to_vec();
    modes[0].angular_frequency = f64::NAN;
    assert!(of(modes, whole.contacts()).is_err());
    let beyond = [PortPair::on_ground(whole.ports())];
    let error = of(whole.modes().to_vec(), &beyond).unwrap_err();
    assert_eq!(error, MeshError::NoPort { port: 3, ports: 3 });
    assert!(ResidualFlexibility::from_rows(&[vec![0.0, 1.0], vec![0.0]]).is_err());
}

/// Beyond the rigid ones, the lowest modes of all bodies and the support are kept.
#[test]
fn the_lowest_modes_of_all_bodies_are_kept() {
    let counts = |support, count| ModeCount::Lowest(count).counts(&stack(support)).unwrap();
    assert_eq!(counts(Support::Rigid, 1), [1, 1]);
    assert_eq!(counts(Support::Rigid, 8), [7, 1]);
    // The slab's first elastic mode lies above the bar's sixth and below its seventh.
    assert_eq!(counts(Support::Rigid, 9), [7, 2]);
    let disc = Support::SpringMass { stiffness: 1e8, mass: 4.0, damping_ratio: 0.1 };
    assert_eq!(counts(disc, 9), [7, 1]);
}

/// Modes of the matrices of a grid.
fn on_grid(stack: &Stack, cell: f64, count: usize) -> ComponentModes {
    let grid = Grid::new(stack, cell).unwrap();
    let structure = LinearStructure::on_grid(stack, &grid);
    let size = structure.nodes();
    let mut stiffness = Mat::<f64>::zeros(size, size);
    for &(row, column, value) in structure.stiffness() {
        stiffness[(row, column)] += value;
    }
    let of_mass = |i: usize, j: usize| if i == j { structure.mass()[i] } else { 0.0 };
    let mass = Mat::from_fn(size, size, of_mass);
    let mut ports = vec![vec![(0, 1.0)]];
    let mut contacts = Vec::new();
    for pair in structure.contacts() {
        let mut port = |node| {
            ports.push(vec![(node, 1.0)]);
            ports.len() - 1
        };
        contacts.push(PortPair { upper: port(pair.above), lower: pair.below.map(port) });
    }
    let matrices = (stiffness.as_ref(), mass.as_ref());
    ComponentModes::from_matrices(matrices, &ports, contacts, count).unwrap()
}

/// Modes of a grid's matrices against the closed form of its bars: frequencies, receptances and
/// residual flexibility approach with the square of the cell, rigid modes exactly.
#[test]
fn modes_of_matrices_approach_the_bars() {
    let stack = stack(Support::Rigid);
    let exact = ComponentModes::of_stack(&stack, ModeCount::Lowest(5), &[Port::TOP]).unwrap();
    let mut frequencies: Vec<f64> = exact.modes().iter().map(|m| m.angular_frequency).collect();
    frequencies.sort_by(f64::total_cmp);
    let w = 0.3 * frequencies[2];
    // Both bodies have cells of 0.03 m over 7 and 15, the long one of a near multiple.
    let cells = [0.03 / 7.0, 0.03 / 15.0];
    let errors = cells.map(|cell| {
        let found = on_grid(&stack, cell, 5);
        assert_eq!(found.modes().len(), 5);
        assert!(found.modes()[..2].iter().all(|mode| mode.angular_frequency == 0.0));
        let last = found.modes()[4].angular_frequency / frequencies[4] - 1.0;
        let mut worst = last.abs();
        for place in [(0, 0), (0, 1), (1, 1)] {
            let expected = closure_receptance(&exact, w, place);
            worst = worst.max((closure_receptance(&found, w, place) / expected - 1.0).abs());
        }
        let residual = |modes: &ComponentModes| modes.residual().get(0, 0);
        worst.max((residual(&found) / residual(&exact) - 1.0).abs())
    });
    let slope = (errors[0] / errors[1]).ln() / (cells[0] / cells[1]).ln();
    assert!(errors[1] < 1e-2 && (1.7..2.3).contains(&slope), "{errors:?}, slope {slope}");
}

/// All modes or few with residual flexibility: the static part is the same.
#[test]
fn modes_left_out_of_matrices_are_flexibility() {
    let stack = stack(Support::Rigid);
    let (few, all) = (on_grid(&stack, 5e-3, 3), on_grid(&stack, 5e-3, 10_000));
    assert_eq!(all.residual(), &ResidualFlexibility::zero(all.ports()));
    let statically = |modes: &ComponentModes, i: usize, j: usize| {
        let [i, j] = [modes.contacts()[i], modes.contacts()[j]];
        let elastic = modes.modes().iter().filter(|mode| mode.angular_frequency > 0.0);
        let kept: f64 =
            elastic.map(|m| m.closure(i) * m.closure(j) / m.angular_frequency.powi(2)).sum();
        kept + modes.residual().closure(i, j)
    };
    for (i, j) in [(0, 0), (0, 1), (1, 1)] {
        assert!((statically(&few, i, j) / statically(&all, i, j) - 1.0).abs() < 1e-12);
    }
}

#[test]
fn matrices_that_make_no_structure_are_errors() {
    let of = |k: &Mat<f64>, m: &Mat<f64>, dof| {
        let ports = [vec![(0, 1.0)], vec![(dof, 1.0)]];
        let contacts = vec![PortPair::on_ground(1)];
        ComponentModes::from_matrices((k.as_ref(), m.as_ref()), &ports, contacts, 1)
    };
    let (k, m) = (mat![[2.0, -1.0], [-1.0, 2.0]], mat![[1.0, 0.0], [0.0, 1.0]]);
    assert!(of(&k, &m, 1).is_ok());
    assert_eq!(of(&k, &m, 2), Err(MeshError::DegreeOfFreedom { dof: 2, size: 2 }));
    let negative = mat![[-2.0, 0.0], [0.0, 1.0]];
    for (k, m) in [(&negative, &m), (&k, &negative), (&mat![[1.0]], &m), (&k, &mat![[0.0]])] {
        assert!(matches!(of(k, m, 0), Err(MeshError::Matrix { .. })));
    }
}

/// The factor times its transpose is the flexibility again: of random matrices, of ports apart by eight orders, singular
/// ones, and with a port without flexibility.
#[test]
fn the_factor_of_a_flexibility_gives_it_again() {
    let mut state = 1_u64;
    let mut random = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    for (size, rank) in [(1, 1), (5, 5), (60, 60), (6, 3), (40, 39), (7, 0)] {
        let root = Mat::from_fn(size, rank, |_, _| random());
        let scale: Vec<f64> = (0..size)
            .map(|i| if size == 40 && i == 7 { 0.0 } else { 10.0_f64.powf(8.0 * random() - 9.0) })
            .collect();
        let exact = Mat::from_fn(size, size, |i, j| {
            let product: f64 = (0..rank).map(|k| root[(i, k)] * root[(j, k)]).sum();
            scale[i] * scale[j] * product
        });
        let factor = flexibility_factor(&exact).unwrap();
        assert!(factor.ncols() <= size);
        let found = &factor * factor.transpose();
        for i in 0..size {
            for j in 0..size {
                let most = 2e-13 * (exact[(i, i)] * exact[(j, j)]).sqrt();
                assert!((found[(i, j)] - exact[(i, j)]).abs() <= most, "{size} {rank} {i} {j}");
            }
        }
    }
}
