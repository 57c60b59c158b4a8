//! Residual and derivatives of the balance.

use std::sync::Arc;

use asperity_law::{Constant, ContactDamping, Friction, Power};
use asperity_mesh::{Body, Interface, Port, Stack, Support};
use asperity_structure::{Damping, PreloadedStructure};

use super::*;
use crate::factorization::Factorization;
use crate::linear_response::LinearSolver;
use crate::{Compliance, LawEvaluation};

const CONDITIONS: Conditions =
    Conditions { angular_frequency: 4819.2, anti_damping: 0.0, force: 0.55279 };

/// The paper's rig with a sample of another density [kg/m3] and a guide of another modulus [Pa].
fn rig(density: f64, modulus: f64) -> ContactSystem {
    let law = Arc::new(Power::new(1.81e10, 0.35, 0.0).unwrap());
    let guide = Body::with_mass("guide", 0.229, 1.61, modulus, 2710.0).unwrap();
    let sample = Body::new("sample", 0.015, 1.15e-4, 71e9, density).unwrap();
    let contact = |name| Interface::new(name, 1.15e-4, law.clone()).unwrap();
    let contacts = vec![contact("upper"), contact("lower")];
    let stack = Stack::new(vec![guide, sample], contacts, Support::Rigid, 9.81).unwrap();
    let structure = PreloadedStructure::new(stack, Damping::Rate(416.0)).unwrap();
    ContactSystem::of_structure(&structure, LawEvaluation::Exact).unwrap()
}

/// The least residual over the motion that Newton's method reaches from the linear response.
fn floor(system: &ContactSystem) -> f64 {
    let mut balance = Balance::new(system, 7, 128);
    let (n, terms) = (balance.unknowns(), balance.fourier().terms());
    let linear = LinearSolver::new(system).at(CONDITIONS.angular_frequency).unwrap();
    let mut x = vec![0.0; n];
    for (x, linear) in x.chunks_exact_mut(terms).zip(linear.closures.chunks_exact(3)) {
        for (to, value) in x.iter_mut().zip(linear) {
            *to = CONDITIONS.force * value;
        }
    }
    let (mut matrix, mut residual) = (Factorization::new(n), vec![0.0; n]);
    let largest = |all: &[f64]| all.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
    let mut least = f64::INFINITY;
    for _ in 0..12 {
        balance.evaluate(&x, &CONDITIONS).unwrap();
        balance.residual(&x, &CONDITIONS, &mut residual);
        least = least.min(largest(&residual) / largest(&x));
        balance.d_residual_d_closures(n, matrix.matrix());
        assert!(matrix.factorize());
        matrix.solve(&mut residual);
        x.iter_mut().zip(&residual).for_each(|(x, r)| *x -= r);
    }
    least
}

/// However light the sample and however stiff the guide.
#[test]
fn the_residual_falls_to_rounding() {
    for (density, modulus) in
        [(2710.0, 71e9), (1.0, 71e9), (1e-3, 71e9), (1e-6, 71e9), (2710.0, 1e30), (1e-3, 1e20)]
    {
        let least = floor(&rig(density, modulus));
        assert!(least < 4e-15, "{density} kg/m3, {modulus} Pa: {least:.1e}");
    }
}

fn bar(length: f64, mass: f64) -> Body {
    Body::with_mass("bar", length, mass, 71e9, 2710.0).unwrap()
}

fn contact() -> Interface {
    Interface::new("contact", 1.15e-4, Arc::new(Power::new(1.81e10, 0.35, 0.0).unwrap())).unwrap()
}

fn system(bodies: Vec<Body>, contacts: Vec<Interface>) -> ContactSystem {
    let stack = Stack::new(bodies, contacts, Support::Rigid, 9.81).unwrap();
    let structure = PreloadedStructure::new(stack, Damping::Rate(300.0)).unwrap();
    ContactSystem::of_structure(&structure, LawEvaluation::Exact).unwrap()
}

/// Closures of up to 0.35 of those at which the contacts would carry nothing.
fn motion(system: &ContactSystem, terms: usize) -> Vec<f64> {
    let of = |at: usize| {
        let (i, k) = (at / terms, at % terms);
        let contact = system.contacts().get(i).unwrap_or(&system.contacts()[0]);
        let size = 0.35 * contact.pressure() / contact.stiffness();
        size * (1.0 + at as f64).sin() / (1.0 + k as f64)
    };
    (0..system.pairs() * terms).map(of).collect()
}

/// Derivatives of residual and load's displacement at a motion against central differences.
fn assert_derivatives(balance: &mut Balance<'_>, x: &[f64]) {
    let n = balance.unknowns();
    let at = |w: f64| Conditions { angular_frequency: w, anti_damping: 20.0, force: 3.0 };
    let w = 5200.0;
    let mut found = |x: &[f64], w: f64| {
        let mut residual = vec![0.0; n];
        balance.evaluate(x, &at(w)).unwrap();
        balance.residual(x, &at(w), &mut residual);
        (residual, balance.load_displacement(1, &at(w)))
    };
    let slopes = |up: (Vec<f64>, Complex64), down: (Vec<f64>, Complex64), size: f64| {
        let pairs = up.0.iter().zip(&down.0);
        let rows: Vec<f64> = pairs.map(|(a, b)| (a - b) / (2.0 * size)).collect();
        (rows, (up.1 - down.1) / (2.0 * size))
    };
    let size = 1e-5 * x.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
    let columns: Vec<_> = (0..n)
        .map(|column| {
            let moved = |sign: f64| {
                let mut x = x.to_vec();
                x[column] += sign * size;
                x
            };
            slopes(found(&moved(1.0), w), found(&moved(-1.0), w), size)
        })
        .collect();
    let by_frequency = slopes(found(x, w + 0.05), found(x, w - 0.05), 0.05);
    found(x, w);
    let (mut matrix, mut slope) = (vec![0.0; n * n], vec![0.0; n]);
    balance.d_residual_d_closures(n, &mut matrix);
    balance.d_residual_d_frequency(&at(w), &mut slope);
    let largest = |all: &[f64]| all.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
    let (mut real, mut imaginary) = (vec![0.0; n], vec![0.0; n]);
    balance.d_displacement_d_closures(&mut real, &mut imaginary);
    let outputs = largest(&real).max(largest(&imaginary));
    for (column, (rows, output)) in columns.iter().enumerate() {
        for (row, expected) in rows.iter().enumerate() {
            let off = (matrix[row * n + column] - expected).abs();
            assert!(off < 1e-5 * largest(rows), "{row} {column}: {off}");
        }
        let own = Complex64::new(real[column], imaginary[column]);
        assert!((own - output).norm() < 1e-5 * outputs, "{own} {output}");
    }
    for (own, expected) in slope.iter().zip(&by_frequency.0) {
        assert!((own - expected).abs() < 1e-5 * largest(&by_frequency.0), "{own} {expected}");
    }
    let [own, ..] = balance.d_displacement_d_conditions(&at(w));
    assert!((own / by_frequency.1 - 1.0).norm() < 1e-5, "{own} {}", by_frequency.1);
}

/// With damped contacts: one that holds, one that carries nothing for a part of the period, one
/// without damping.
#[test]
fn derivatives_with_damped_contacts_match_differences() {
    let kelvin_voigt = ContactDamping::kelvin_voigt(4e-6).unwrap();
    let power = ContactDamping::power(6e8, 1e5, 1.3).unwrap();
    let contacts =
        vec![contact().with_damping(kelvin_voigt), contact().with_damping(power), contact()];
    let system = system(vec![bar(0.2, 1.6), bar(0.06, 0.3), bar(0.1, 0.5)], contacts);
    let mut balance = Balance::new(&system, 3, 48);
    let x = motion(&system, balance.fourier().terms());
    assert_derivatives(&mut balance, &x);
    let carries_nothing = balance.samples_of(&balance.force_samples, 1).iter();
    let least = -system.contacts()[1].area() * system.contacts()[1].pressure();
    assert!(carries_nothing.filter(|force| **force == least).count() > 2);
}

fn pushes() -> Interface {
    Interface::new("contact", 1.15e-4, Arc::new(Constant::unilateral(1e12).unwrap())).unwrap()
}

/// With contacts that open for a third of the period, and that open or close for less than the time between
/// two samples.
#[test]
fn derivatives_with_open_contacts_match_differences() {
    for contact in [pushes, contact] {
        let system = system(vec![bar(0.2, 1.6), bar(0.06, 0.3)], vec![contact(), contact()]);
        let mut balance = Balance::new(&system, 3, 32);
        let opens = |i: usize| {
            let contact = &system.contacts()[i];
            contact.closure() - contact.law().closure(0.0)
        };
        // Of a cosine whose extremum lies halfway between two samples.
        let (sin, cos) = (std::f64::consts::TAU * 0.5 / 32.0).sin_cos();
        for (first, second) in [(1.3, 1.004), (-1.004, 1.004)] {
            let mut x = vec![0.0; 14];
            for (i, size) in [(0, first), (1, second)] {
                let mean = if size < 0.0 { 2.0 } else { 0.0 };
                let size: f64 = opens(i) * size;
                x[7 * i] = -mean * opens(i);
                (x[7 * i + 1], x[7 * i + 2]) = (-size.abs() * cos, -size.abs() * sin);
            }
            assert_derivatives(&mut balance, &x);
        }
    }
}

/// The force of a spring that only pushes under a cosine, against its Fourier series in closed form.
#[test]
fn the_force_of_a_spring_that_opens_is_its_fourier_series() {
    let system = system(vec![bar(0.2, 1.6)], vec![pushes()]);
    let contact = &system.contacts()[0];
    let (k, opening) = (contact.spring(), contact.law().closure(0.0) - contact.closure());
    let mut balance = Balance::new(&system, 5, 80);
    for ratio in [-0.9995, -0.6, 0.2, 0.98] {
        let a = opening.abs() / 0.6;
        // Closed while a cos(th) > ratio a, for |th| < half.
        let (mean, half) = (opening - ratio * a, f64::acos(ratio));
        let mut x = [0.0; 11];
        (x[0], x[1]) = (mean, a);
        let at = Conditions { angular_frequency: 4e3, anti_damping: 0.0, force: 1.0 };
        balance.evaluate(&x, &at).unwrap();
        let sine = |n: i32| if n == 0 { half } else { (f64::from(n) * half).sin() / f64::from(n) };
        for n in 0..=5 {
            let scale = if n == 0 { 1.0 } else { 2.0 } * k * a / std::f64::consts::PI;
            let wanted = scale * (0.5 * (sine(n - 1) + sine(n + 1)) - ratio * sine(n));
            let found = match n {
                0 => balance.forces[0] - k * opening,
                1 => balance.forces[1] + k * a,
                n => balance.forces[2 * n as usize - 1],
            };
            assert!((found - wanted).abs() < 1e-8 * k * a, "{ratio} {n}: {found} {wanted}");
        }
    }
}

/// The force of a power law under a cosine that opens the contact a little, just touches, or hardly holds, against
/// a double-exponential rule on the closed piece: it changes smoothly from one to the other.
#[test]
fn the_force_of_a_contact_that_hardly_holds_is_its_integral() {
    let system = system(vec![bar(0.2, 1.6)], vec![contact()]);
    let one = &system.contacts()[0];
    let opening = one.law().closure(0.0) - one.closure();
    let a = 2.0 * opening.abs();
    let at_rest = one.area() * one.pressure();
    let mut balance = Balance::new(&system, 5, 80);
    for least in [-1e-2, -1e-4, -1e-6, 0.0, 1e-6, 1e-4, 1e-3, 1e-2, 0.05, 0.2] {
        // Beyond the opening the closure is a (least + 1 + cos(th)).
        let half = if least < 0.0 { f64::acos(-1.0 - least) } else { std::f64::consts::PI };
        let mut x = [0.0; 11];
        (x[0], x[1]) = (opening + a * (1.0 + least), a);
        balance.evaluate(&x, &Conditions { force: 1.0, ..CONDITIONS }).unwrap();
        let mut wanted = [0.0; 6];
        for n in -400..=400 {
            let t = 0.01 * f64::from(n);
            let place = std::f64::consts::FRAC_PI_2 * t.sinh();
            let weight = 0.01 * std::f64::consts::FRAC_PI_2 * t.cosh() / place.cosh().powi(2);
            // From the end of the piece, to all digits.
            let from_end = half / (1.0 + (2.0 * place).exp());
            let th = half - from_end;
            let at_end = least + 1.0 + half.cos();
            let rise = 2.0 * (0.5 * (half + th)).sin() * (0.5 * from_end).sin();
            let closure = opening + a * (at_end + rise).max(0.0);
            let (mut force, mut tangent) = ([0.0], [0.0]);
            system.forces(0, &[closure], &mut force, &mut tangent);
            let share = 0.5 * half * weight * (force[0] + at_rest) / std::f64::consts::PI;
            for (k, wanted) in (0..).map(f64::from).zip(&mut wanted) {
                *wanted += share * (k * th).cos() * if k == 0.0 { 1.0 } else { 2.0 };
            }
        }
        let spring = one.spring();
        for (n, wanted) in wanted.iter().enumerate() {
            let found = match n {
                0 => balance.forces[0] + at_rest,
                1 => balance.forces[1] + spring * a,
                n => balance.forces[2 * n - 1],
            };
            let off = (found - wanted).abs() / wanted.abs().max(at_rest);
            assert!(off < 1e-9, "{least} {n}: {found} {wanted} {off:.1e}");
        }
    }
}

/// With friction: in a guide under the force of a damped contact, in one with a force of its own, across
/// a contact that is lost for a part of the period. Each slips for a part of it.
#[test]
fn derivatives_with_friction_match_differences() {
    let coefficient = Friction::coefficient(3e8, 0.3).unwrap();
    let fixed = Friction::slip_force(2e8, 3.0).unwrap();
    let kelvin_voigt = ContactDamping::kelvin_voigt(4e-6).unwrap();
    let contacts = vec![
        contact().with_damping(kelvin_voigt),
        contact(),
        contact().with_friction(Friction::coefficient(4e8, 0.3).unwrap()),
    ];
    let bodies = vec![
        bar(0.2, 1.6).with_friction(coefficient),
        bar(0.06, 0.3),
        bar(0.1, 0.5).with_friction(fixed),
    ];
    let system = system(bodies, contacts);
    let mut balance = Balance::new(&system, 3, 48);
    assert_eq!(balance.unknowns(), 5 * 7);
    let mut x: Vec<f64> = motion(&system, 7).iter().map(|x| -1.5 * x).collect();
    x[2 * 7..3 * 7].iter_mut().for_each(|x| *x *= 2.2);
    assert_derivatives(&mut balance, &x);
    for (i, friction) in balance.loops.iter().enumerate() {
        let (slipping, stuck) = friction.stages();
        assert!(slipping > 20 && stuck > 20, "{i}: {slipping} {stuck}");
    }
    let least = -system.contacts()[2].area() * system.contacts()[2].pressure();
    let lost = balance.samples_of(&balance.force_samples, 2).iter();
    assert!(lost.filter(|force| **force == least).count() > 2);
}

/// The closed form on springs against the receptances of free bars with springs put in, at ports of all
/// kinds, guides and derivatives included; derivatives against differences.
#[test]
fn bars_on_springs_are_free_bars_with_springs() {
    let rubbing =
        |length, mass| bar(length, mass).with_friction(Friction::slip_force(1e7, 1.0).unwrap());
    let disc = Support::SpringMass { stiffness: 3e8, mass: 0.7, damping_ratio: 0.02 };
    let point = |body, position| Port::Point { body, position };
    let ports = [
        Port::TOP,
        point(0, 0.07),
        point(0, 0.13),
        point(1, 0.06),
        point(2, 0.05),
        Port::Mean { body: 0 },
        Port::Mean { body: 1 },
        Port::Support,
        Port::Base,
    ]
    .map(crate::SystemPort::Stack);
    let size = 5 + ports.len();
    for (support, rate) in [(Support::Rigid, 0.0), (Support::Rigid, 900.0), (disc, 300.0)] {
        let bodies = vec![rubbing(0.2, 1.6), bar(0.06, 0.3), rubbing(0.1, 0.5)];
        let stack = Stack::new(bodies, vec![contact(); 3], support, 9.81).unwrap();
        let structure = PreloadedStructure::new(stack, Damping::Rate(rate)).unwrap();
        let system = ContactSystem::of_structure(&structure, LawEvaluation::Exact).unwrap();
        let springs = [0.9e8, 1.1e8, 0.7e8].map(|k| Complex64::new(k, 2e7));
        for w in [300.0, 6e3, 4.1e4, 2.3e5] {
            let on = |w: f64, anti_damping: f64, springs: &[Complex64]| {
                let mut found = Compliance::zero(5, ports.len());
                system.linear().compliance((w, anti_damping), &ports, springs, &mut found);
                found
            };
            let closed = on(w, 30.0, &springs);
            let mut free = on(w, 30.0, &[]);
            free.add_springs(&springs);
            let [up, down] =
                [on(w * (1.0 + 1e-5), 30.0, &springs), on(w * (1.0 - 1e-5), 30.0, &springs)];
            let [more, less] = [on(w, 31.0, &springs), on(w, 29.0, &springs)];
            for i in 0..size {
                for j in 0..size {
                    let (a, b) = (closed.get(i, j), free.get(i, j));
                    let of = |all: &Compliance| all.get(i, j).value;
                    let near = |a: Complex64, b: Complex64, most: f64, scale: f64| {
                        let off = (a - b).norm();
                        assert!(off <= most * scale, "{w}, {i} {j}: {a} {b}");
                    };
                    let scale = (closed.get(i, i).value * closed.get(j, j).value).norm().sqrt();
                    near(a.value, b.value, 1e-9, scale);
                    let slope = |i: usize| closed.get(i, i).d_frequency.norm();
                    let scale = a.d_frequency.norm().max((slope(i) * slope(j)).sqrt());
                    near(a.d_frequency, b.d_frequency, 1e-9, scale);
                    near(a.d_frequency, (of(&up) - of(&down)) / (2e-5 * w), 1e-5, scale);
                    let slope = |i: usize| closed.get(i, i).d_anti_damping.norm();
                    let scale = a.d_anti_damping.norm().max((slope(i) * slope(j)).sqrt());
                    near(a.d_anti_damping, b.d_anti_damping, 1e-9, scale);
                    near(a.d_anti_damping, (of(&more) - of(&less)) / 2.0, 1e-5, scale);
                }
            }
        }
    }
}
