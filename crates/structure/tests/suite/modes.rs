//! Linearised modes against closed forms and against the grid's eigenvalues.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use asperity_law::{Constant, ContactDamping};
use asperity_mesh::{Body, BodyDamping, Grid, Interface, Stack, Support};
use asperity_structure::{Damping, LinearisedMode, PreloadedContact, PreloadedStructure};
use faer::{Mat, Side};

use crate::linear_structure::LinearStructure;
use crate::rigs::{
    AREA, DISC, Law, at_rest, constant, modified, power, rig, rig_on, slope, three_bodies,
};

fn modes_of(stack: &Stack, rate: f64, count: usize) -> Vec<LinearisedMode> {
    PreloadedStructure::new(stack.clone(), Damping::Rate(rate)).unwrap().modes(count).unwrap()
}

fn structure_of(stack: &Stack, cell: f64) -> (LinearStructure, Vec<f64>) {
    let grid = Grid::new(stack, cell).unwrap();
    let stiffness = at_rest(stack).contacts().iter().map(PreloadedContact::stiffness).collect();
    (LinearStructure::on_grid(stack, &grid), stiffness)
}

fn grid_modes_of(stack: &Stack, cell: f64) -> Vec<f64> {
    let (structure, stiffness) = structure_of(stack, cell);
    grid_frequencies(&structure, &stiffness)
}

/// All natural frequencies [Hz] of `structure` with its contacts replaced by springs of
/// `contact_stiffness` [Pa/m] per area: `k phi = w^2 M phi` with lumped masses as the symmetric
/// problem of `M^(-1/2) k M^(-1/2)`.
fn grid_frequencies(structure: &LinearStructure, contact_stiffness: &[f64]) -> Vec<f64> {
    let size = structure.nodes();
    let mut matrix = Mat::<f64>::zeros(size, size);
    for &(row, column, value) in structure.stiffness() {
        matrix[(row, column)] += value;
    }
    for (contact, stiffness) in structure.contacts().iter().zip(contact_stiffness) {
        let k = stiffness * contact.area;
        matrix[(contact.above, contact.above)] += k;
        if let Some(below) = contact.below {
            matrix[(below, below)] += k;
            matrix[(contact.above, below)] -= k;
            matrix[(below, contact.above)] -= k;
        }
    }
    let root: Vec<f64> = structure.mass().iter().map(|mass| mass.sqrt()).collect();
    let scaled = Mat::from_fn(size, size, |i, j| matrix[(i, j)] / (root[i] * root[j]));
    let squares = scaled.self_adjoint_eigenvalues(Side::Lower).unwrap();
    squares.into_iter().map(|square| square.max(0.0).sqrt() / TAU).collect()
}

/// Three equal lengths, so that every body's cells shrink in the same ratio.
fn equal_lengths(support: Support) -> Stack {
    let law: Law = Arc::new(Constant::new(6e11).unwrap());
    let contact = |name| Interface::new(name, AREA, Arc::clone(&law)).unwrap();
    Stack::new(
        vec![
            Body::new("a", 0.05, 6e-4, 210e9, 7800.0).unwrap(),
            Body::new("b", 0.05, 2e-4, 71e9, 2710.0).unwrap(),
            Body::new("c", 0.05, 3e-4, 110e9, 4500.0).unwrap(),
        ],
        vec![contact("ab"), contact("bc"), contact("c0")],
        support,
        9.81,
    )
    .unwrap()
}

/// Exact solution 1: `a cot(th) (D1s + k) + D1s k - a^2 = 0`, written out for
/// two bars on a wall, independent of the matrix of the code.
#[test]
fn modes_of_the_rig_solve_the_exact_transcendental_equation() {
    let stack = rig(&constant());
    let [guide, sample] = stack.bodies() else { panic!("two bodies") };
    let k = 8.5e11 * AREA;
    let terms = |frequency: f64| {
        let w = TAU * frequency;
        let phase = w * guide.length() / guide.wave_speed();
        let d1 = -guide.axial_rigidity() * w / guide.wave_speed() * phase.tan();
        let d1s = k * d1 / (k + d1);
        let a = sample.axial_rigidity() * w / sample.wave_speed();
        let th = w * sample.length() / sample.wave_speed();
        [a / th.tan() * (d1s + k), d1s * k, -a * a]
    };
    for mode in modes_of(&stack, 0.0, 8) {
        let residual = |frequency| terms(frequency).iter().sum::<f64>();
        let size: f64 = terms(mode.frequency_hz).iter().map(|term| term.abs()).sum();
        // Round-off of tangents near their poles, where mode shapes have a node at the face.
        assert!(residual(mode.frequency_hz).abs() < 1e-9 * size, "{}", mode.frequency_hz);
        // A frequency off by 1e-9 is on the wrong side of the root.
        let (below, above) = (mode.frequency_hz * (1.0 - 1e-9), mode.frequency_hz * (1.0 + 1e-9));
        assert!(residual(below) * residual(above) < 0.0, "{}", mode.frequency_hz);
    }
}

/// Published digits of the exact solution, all of them.
#[test]
fn the_first_four_modes_of_the_rig_have_their_known_values() {
    let known = [(831.98, 0.005), (11229.3, 0.05), (22351.6, 0.05), (31863.6, 0.05)];
    let found = modes_of(&rig(&constant()), 0.0, 4);
    for (mode, (value, half_digit)) in found.iter().zip(known) {
        assert!((mode.frequency_hz - value).abs() < half_digit, "{}", mode.frequency_hz);
    }
}

#[test]
fn static_frequencies_of_the_three_laws_have_their_known_values() {
    for (law, value) in [(modified(), 875.49), (power(), 946.86), (constant(), 831.98)] {
        let found = modes_of(&rig(&law), 0.0, 1)[0].frequency_hz;
        assert!((found - value).abs() < 0.005, "{found} for {value}");
    }
}

/// Exact modes against the eigenvalues of the grid, a second method of ours:
/// the grid's error is of second order in the cell.
#[test]
fn grid_frequencies_meet_the_exact_modes_with_slope_two() {
    for support in [Support::Rigid, DISC] {
        let stack = equal_lengths(support);
        let exact = modes_of(&stack, 0.0, 4);
        let cells = [7.0, 15.0, 31.0, 63.0];
        let sizes: Vec<f64> = cells.iter().map(|n| 0.05 / n).collect();
        let grids: Vec<_> = sizes.iter().map(|&size| grid_modes_of(&stack, size)).collect();
        for (number, mode) in exact.iter().enumerate() {
            let errors: Vec<f64> =
                grids.iter().map(|grid| (grid[number] / mode.frequency_hz - 1.0).abs()).collect();
            let order = slope(&sizes, &errors);
            assert!((1.9..2.1).contains(&order), "mode {number}: {errors:?}");
        }
    }
}

/// The same on the rig itself, whose bodies' cells shrink in slightly different ratios.
#[test]
fn grid_frequencies_of_the_rig_converge_with_slope_two() {
    let stack = rig(&constant());
    let exact = modes_of(&stack, 0.0, 3);
    let cells = [7.0, 15.0, 31.0];
    let sizes: Vec<f64> = cells
        .iter()
        .map(|n| Grid::new(&stack, 0.015 / n).unwrap().bars()[0].cell_length())
        .collect();
    let grids: Vec<_> = cells.iter().map(|n| grid_modes_of(&stack, 0.015 / n)).collect();
    for (number, mode) in exact.iter().enumerate() {
        let errors: Vec<f64> =
            grids.iter().map(|grid| (grid[number] / mode.frequency_hz - 1.0).abs()).collect();
        let order = slope(&sizes, &errors);
        assert!((1.9..2.1).contains(&order), "mode {number}: {errors:?}");
    }
}

/// No mode is missed or counted twice: the n-th exact mode is the n-th of the
/// grid, also where modes nearly coincide (equal bodies in weak contact, whose
/// clamped frequencies coincide exactly).
#[test]
fn no_mode_is_missed() {
    let soft: Law = Arc::new(Constant::new(1e8).unwrap());
    let twin = |name| Body::new(name, 0.05, AREA, 71e9, 2710.0).unwrap();
    let contact = |name| Interface::new(name, AREA, Arc::clone(&soft)).unwrap();
    let twins = Stack::new(
        vec![twin("a"), twin("b"), twin("c")],
        vec![contact("ab"), contact("bc"), contact("c0")],
        Support::Rigid,
        9.81,
    )
    .unwrap();
    let stacks = [
        (rig(&modified()), 1e-3),
        (rig_on(&power(), DISC), 1e-3),
        (three_bodies(Support::Rigid), 0.2e-3),
        (three_bodies(DISC), 0.2e-3),
        (twins, 0.4e-3),
    ];
    for (stack, cell) in stacks {
        let exact: Vec<f64> = modes_of(&stack, 0.0, 12).iter().map(|m| m.frequency_hz).collect();
        let grid = grid_modes_of(&stack, cell);
        for (number, (a, b)) in exact.iter().zip(&grid).enumerate() {
            // The grid's error is (k dx)^2 / 24, below 0.3 % for ten cells a radian.
            assert!((a / b - 1.0).abs() < 3e-3, "mode {number}: exact {a}, grid {b}");
        }
        // Between two well separated modes the counts are equal.
        for pair in exact.windows(2).filter(|pair| pair[1] > 1.02 * pair[0]) {
            let middle = 0.5 * (pair[0] + pair[1]);
            let count = |list: &[f64]| list.iter().filter(|f| **f < middle).count();
            assert_eq!(count(&exact), count(&grid), "below {middle} Hz");
        }
    }
}

fn mass_product(stack: &Stack, a: &LinearisedMode, b: &LinearisedMode) -> f64 {
    // Simpson's rule on 2000 intervals a body.
    let intervals = 2000;
    let mut sum = 0.0;
    for (index, body) in stack.bodies().iter().enumerate() {
        for i in 0..=intervals {
            let weight = match i {
                0 => 1.0,
                _ if i == intervals => 1.0,
                _ if i % 2 == 1 => 4.0,
                _ => 2.0,
            };
            let s = f64::from(i) / f64::from(intervals);
            let product = a.displacement(body, index, s) * b.displacement(body, index, s);
            sum += weight * body.mass() * product / (3.0 * f64::from(intervals));
        }
    }
    if let Support::SpringMass { mass, .. } = *stack.support() {
        sum += mass * a.support * b.support;
    }
    sum
}

/// Modes of different frequency are orthogonal in mass, support included; the
/// closed-form modal mass inside the damping ratio is that of the shapes.
#[test]
fn shapes_are_orthogonal_in_mass_and_damping_ratios_follow_from_them() {
    let rate = 120.0;
    for stack in [rig(&constant()), rig_on(&constant(), DISC), three_bodies(DISC)] {
        let found = modes_of(&stack, rate, 5);
        for (i, a) in found.iter().enumerate() {
            let own = mass_product(&stack, a, a);
            for b in &found[i + 1..] {
                let size = (own * mass_product(&stack, b, b)).sqrt();
                // Simpson on shapes of a few wavelengths: 1e-12, and round-off.
                assert!(mass_product(&stack, a, b).abs() < 1e-8 * size);
            }
            let w = TAU * a.frequency_hz;
            let disc = match *stack.support() {
                Support::Rigid => 0.0,
                Support::SpringMass { mass, .. } => mass,
            };
            let viscous = rate * (own - disc * a.support * a.support)
                + stack.support().damping() * a.support * a.support;
            let ratio = viscous / (2.0 * w * own);
            assert!((a.damping_ratio / ratio - 1.0).abs() < 1e-8, "{} {ratio}", a.damping_ratio);
        }
    }
}

/// Against the complex eigenvalues of the damped grid in state space: the
/// ratio is a first-order perturbation, so that it is right to second order in
/// the damping, which is asserted by its slope.
#[test]
fn damping_ratios_meet_the_complex_eigenvalues_of_the_state_space() {
    let scales = [0.4, 0.2, 0.1];
    let mut errors = vec![Vec::new(); 3];
    for scale in scales {
        let disc = Support::SpringMass { stiffness: 2e8, mass: 3.0, damping_ratio: 0.2 * scale };
        let stack = rig_on(&constant(), disc);
        let rate = 400.0 * scale;
        let found = modes_of(&stack, rate, 3);
        let complex = state_space_ratios(&stack, rate, 2e-3);
        for (number, mode) in found.iter().enumerate() {
            let error = (complex[number].1 / mode.damping_ratio - 1.0).abs();
            // zeta^2 = 0.0064 at scale 0.4, and the grid's own (k dx)^2 / 24 = 3e-5.
            assert!(error < 0.01 * scale * scale + 5e-5, "mode {number}: {error}");
            errors[number].push(error);
        }
    }
    // The two modes that share the disc are not proportionally damped.
    for errors in &errors[..2] {
        let order = slope(&scales, errors);
        assert!((1.9..2.1).contains(&order), "{errors:?}");
    }
}

/// Frequency [Hz] and damping ratio of every oscillating pair of the grid, lowest first.
fn state_space_ratios(stack: &Stack, rate: f64, cell: f64) -> Vec<(f64, f64)> {
    let (structure, stiffness) = structure_of(stack, cell);
    let n = structure.nodes();
    let mut k = Mat::<f64>::zeros(n, n);
    for &(row, column, value) in structure.stiffness() {
        k[(row, column)] += value;
    }
    for (contact, stiffness) in structure.contacts().iter().zip(&stiffness) {
        let k_contact = stiffness * contact.area;
        k[(contact.above, contact.above)] += k_contact;
        if let Some(below) = contact.below {
            k[(below, below)] += k_contact;
            k[(contact.above, below)] -= k_contact;
            k[(below, contact.above)] -= k_contact;
        }
    }
    let mut damping: Vec<f64> = structure.damped_mass().map(|mass| rate * mass).collect();
    damping[n - 1] += structure.support_damping();
    // (u, v / scale): all entries of one size, for the accuracy of the smallest eigenvalues.
    let scale = 1e5;
    let mass = structure.mass();
    let a = Mat::from_fn(2 * n, 2 * n, |row, column| match (row < n, column < n) {
        (true, false) if row == column - n => scale,
        (false, true) => -k[(row - n, column)] / (mass[row - n] * scale),
        (false, false) if row == column => -damping[row - n] / mass[row - n],
        _ => 0.0,
    });
    let mut pairs: Vec<(f64, f64)> = a
        .eigenvalues()
        .unwrap()
        .into_iter()
        .filter(|value| value.im > 0.0)
        .map(|value| (value.norm() / TAU, -value.re / value.norm()))
        .collect();
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    pairs
}

/// On a rigid support mass-proportional damping gives every mode `h / (2 w)`,
/// and a ratio is that of the lowest mode.
#[test]
fn a_damping_ratio_is_that_of_the_lowest_mode() {
    let stack = rig(&modified());
    let structure = PreloadedStructure::new(stack, Damping::Ratio(0.035)).unwrap();
    let (rate, found) = (structure.damping_rate(), structure.modes(3).unwrap());
    assert!((found[0].damping_ratio - 0.035).abs() < 1e-12);
    for mode in found {
        let expected = rate / (4.0 * PI * mode.frequency_hz);
        assert!((mode.damping_ratio / expected - 1.0).abs() < 1e-12);
    }
}

/// A Kelvin-Voigt contact adds `beta w / 2` times its share of the strain energy, which is the
/// relative change of the squared frequency over that of its stiffness.
#[test]
fn a_damped_contact_adds_its_share_of_the_strain_energy() {
    let beta = 3e-6;
    let laws = |change: f64| [change, 1.0].map(|f| Constant::new(8.5e11 * f).unwrap());
    let stack = |change: f64, damping: Option<ContactDamping>| {
        let plain = rig_on(&constant(), DISC);
        let contacts = plain.interfaces().iter().zip(laws(change)).enumerate();
        let contacts = contacts.map(|(i, (one, law))| {
            let contact = Interface::new(one.name(), one.area(), Arc::new(law)).unwrap();
            if i == 0 {
                damping.map_or(contact.clone(), |d| contact.with_damping(d))
            } else {
                contact
            }
        });
        Stack::new(plain.bodies().to_vec(), contacts.collect(), DISC, 9.81).unwrap()
    };
    let bare = modes_of(&stack(1.0, None), 100.0, 3);
    let [soft, stiff] = [-1e-4, 1e-4].map(|e| modes_of(&stack(1.0 + e, None), 0.0, 3));
    for damping in [
        ContactDamping::kelvin_voigt(beta).unwrap(),
        ContactDamping::loss_ratio(TAU * 500.0 * beta, 500.0).unwrap(),
        ContactDamping::power(beta * 8.5e11, 1e5, 0.0).unwrap(),
    ] {
        let found = modes_of(&stack(1.0, Some(damping)), 100.0, 3);
        for number in 0..3 {
            let (low, high) = (soft[number].frequency_hz, stiff[number].frequency_hz);
            // d ln(w^2) / d ln K.
            let share = (high / low).ln() / 1e-4;
            let added = found[number].damping_ratio - bare[number].damping_ratio;
            let expected = 0.5 * beta * TAU * found[number].frequency_hz * share;
            assert!((added / expected - 1.0).abs() < 1e-6, "{number}: {added} {expected}");
        }
    }
}

/// All strain energy of a rigid mass is in its contact: `zeta = beta w / 2`.
#[test]
fn a_rigid_mass_on_a_damped_contact_has_its_damping_ratio() {
    let block = Body::new("block", 1e-4, 1e-2, 1e13, 1e6).unwrap();
    let contact = Interface::new("contact", 1e-4, constant()).unwrap();
    let contact = contact.with_damping(ContactDamping::kelvin_voigt(7e-6).unwrap());
    let stack = Stack::new(vec![block], vec![contact], Support::Rigid, 9.81).unwrap();
    let mode = &modes_of(&stack, 0.0, 1)[0];
    let expected = 0.5 * 7e-6 * TAU * mode.frequency_hz;
    // The block takes some k L / (E A) = 9e-8 of the energy.
    assert!((mode.damping_ratio / expected - 1.0).abs() < 1e-6, "{mode:?}");
}

/// Rayleigh damping `C = a M + b K` of the whole: mass-proportional, bodies and contacts with one
/// retardation time. Every mode has `zeta = a / (2 w) + b w / 2`, stacks of any bodies.
#[test]
fn rayleigh_damping_of_bodies_and_contacts_has_its_closed_form() {
    let (a, b) = (200.0, 2e-6);
    let damping = ContactDamping::kelvin_voigt(b).unwrap();
    let bodies = BodyDamping::kelvin_voigt(b).unwrap();
    for stack in [rig(&modified()), rig(&power()), three_bodies(Support::Rigid)] {
        let contacts = stack.interfaces().iter().map(|one| one.clone().with_damping(damping));
        let gravity = 9.81;
        let damped =
            Stack::new(stack.bodies().to_vec(), contacts.collect(), Support::Rigid, gravity);
        let damped = damped.unwrap().with_body_damping(bodies);
        for mode in modes_of(&damped, a, 12) {
            let w = TAU * mode.frequency_hz;
            let expected = 0.5 * a / w + 0.5 * b * w;
            assert!((mode.damping_ratio / expected - 1.0).abs() < 1e-9, "{mode:?} {expected}");
        }
    }
}

/// A body with a loss factor adds `eta / 2` times its share of the strain energy, one with a
/// retardation time `b w / 2` times it; the share is the relative change of the squared frequency
/// over that of its modulus at constant density.
#[test]
fn a_damped_body_adds_its_share_of_the_strain_energy() {
    let stack = |factor: f64, damping: BodyDamping| {
        let plain = rig_on(&constant(), DISC);
        let [guide, sample] = plain.bodies() else { panic!("two bodies") };
        let (length, section) = (sample.length(), sample.section());
        let (modulus, density) = (sample.youngs_modulus() * factor, sample.density());
        let sample = Body::new("sample", length, section, modulus, density).unwrap();
        let bodies = vec![guide.clone(), sample.with_damping(damping)];
        Stack::new(bodies, plain.interfaces().to_vec(), DISC, 9.81).unwrap()
    };
    let bare = modes_of(&stack(1.0, BodyDamping::NONE), 100.0, 6);
    let [soft, stiff] = [-1e-4, 1e-4].map(|e| modes_of(&stack(1.0 + e, BodyDamping::NONE), 0.0, 6));
    let (b, eta) = (1e-6, 0.02);
    let viscous = modes_of(&stack(1.0, BodyDamping::kelvin_voigt(b).unwrap()), 100.0, 6);
    let hysteretic = modes_of(&stack(1.0, BodyDamping::loss_factor(eta).unwrap()), 100.0, 6);
    for number in 0..6 {
        let share = (stiff[number].frequency_hz / soft[number].frequency_hz).ln() / 1e-4;
        let w = TAU * bare[number].frequency_hz;
        for (found, loss) in [(&viscous, b * w), (&hysteretic, eta)] {
            let added = found[number].damping_ratio - bare[number].damping_ratio;
            let expected = 0.5 * loss * share;
            let scale = 0.5 * loss;
            assert!((added - expected).abs() < 1e-7 * scale, "{number}: {added} {expected}");
        }
    }
}
