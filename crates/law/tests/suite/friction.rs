//! Jenkins elements against their closed forms.

use std::f64::consts::{PI, TAU};

use asperity_law::Friction;

/// Forces over one settled cycle of amplitude `amplitude` in `steps` steps, at displacements
/// `X cos(2 pi n / steps)`.
fn cycle(friction: Friction, amplitude: f64, limit: f64, steps: usize) -> Vec<(f64, f64)> {
    let place = |n: usize| amplitude * (TAU * n as f64 / steps as f64).cos();
    let (mut force, mut before) = (friction.force(0.0, amplitude, limit), amplitude);
    let mut found = Vec::new();
    for n in 1..=2 * steps {
        let x = place(n % steps);
        force = friction.force(force, x - before, limit);
        before = x;
        if n > steps {
            found.push((x, force));
        }
    }
    found
}

/// Loss, secant stiffness and harmonic coefficients over amplitude, stuck and slipping, under a slip
/// force of its own and one that is a share of a contact's: of second order in the step of the
/// sums, the force itself having no error.
#[test]
fn cycles_follow_the_closed_forms() {
    let elements = [
        (Friction::slip_force(2e7, 0.3).unwrap(), 50.0),
        (Friction::coefficient(5e6, 0.02).unwrap(), 15.0),
    ];
    for (friction, contact) in elements {
        let limit = friction.limit(contact);
        let slip = limit / friction.stiffness();
        for ratio in [0.3, 1.0, 1.2, 2.0, 7.0, 60.0] {
            let amplitude = ratio * slip;
            let errors = [4000, 8000].map(|steps| {
                let loop_ = cycle(friction, amplitude, limit, steps);
                let mut loss = 0.0;
                let (mut storage, mut in_phase_with_velocity) = (0.0, 0.0);
                let (mut x0, mut f0) = *loop_.last().unwrap();
                for (n, &(x, f)) in loop_.iter().enumerate() {
                    loss += 0.5 * (f + f0) * (x - x0);
                    let angle = TAU * (n + 1) as f64 / steps as f64;
                    storage += 2.0 / steps as f64 * f * angle.cos() / amplitude;
                    in_phase_with_velocity -= 2.0 / steps as f64 * f * angle.sin() / amplitude;
                    (x0, f0) = (x, f);
                }
                let exact = friction.loss_per_cycle(amplitude, limit);
                let [real, imaginary] = friction.harmonic_coefficients(amplitude, limit);
                let largest = loop_.iter().map(|(_, f)| f.abs()).fold(0.0, f64::max);
                let secant = friction.secant_stiffness(amplitude, limit);
                assert!((largest / amplitude / secant - 1.0).abs() < 1e-12);
                assert!((imaginary * PI * amplitude * amplitude - exact).abs() <= 1e-12 * exact);
                let scale = limit * amplitude;
                [
                    (loss - exact).abs() / scale,
                    (storage - real).abs() / friction.stiffness(),
                    (in_phase_with_velocity - imaginary).abs() / friction.stiffness(),
                ]
            });
            for (coarse, fine) in errors[0].iter().zip(&errors[1]) {
                // Kinks fall anywhere between two steps: second order, but not smoothly.
                assert!(*coarse < 2e-5 && *fine < 7e-6, "{ratio}: {errors:?}");
            }
        }
    }
}

/// One step from reversal to reversal gives the force of ten thousand.
#[test]
fn steps_need_not_be_divided() {
    let friction = Friction::slip_force(1e7, 0.2).unwrap();
    let turns = [3e-8, -1e-8, 1.5e-8, -6e-8, 2e-9];
    let (mut at_once, mut divided, mut before) = (0.0, 0.0, 0.0);
    for x in turns {
        at_once = friction.force(at_once, x - before, 0.2);
        for _ in 0..10_000 {
            divided = friction.force(divided, (x - before) / 1e4, 0.2);
        }
        assert!((at_once - divided).abs() < 1e-12, "{x}: {at_once} {divided}");
        before = x;
    }
}

#[test]
fn values_out_of_range_are_errors() {
    for bad in [-1.0, f64::NAN, f64::INFINITY] {
        assert!(Friction::slip_force(1e7, bad).is_err());
        assert!(Friction::slip_force(bad, 0.2).is_err());
        assert!(Friction::coefficient(1e7, bad).is_err());
    }
    assert!(Friction::coefficient(0.0, 0.1).is_err());
    let text = Friction::coefficient(1e7, -0.1).unwrap_err().to_string();
    assert!(text.contains("coefficient of friction is -0.1"), "{text}");
    assert_eq!(Friction::coefficient(1e7, 0.1).unwrap().limit(-3.0), 0.0);
}
