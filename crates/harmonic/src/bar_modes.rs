//! The free modes of the bars of a stack.

use std::f64::consts::PI;

use asperity_mesh::{Body, Stack, Support};

use crate::ModalSystem;

/// The `count` lowest free-free modes of all bars and the support together, at least the rigid
/// ones, with the static flexibility of all others.
///
/// A bar of mass m has modes at `n pi c / L` with the end values `sqrt(2/m)` and
/// `(-1)^n sqrt(2/m)`, `1/sqrt(m)` for n = 0. The elastic ones together give the flexibility
/// `L / (3 E A)` at an end and `-L / (6 E A)` across; what the kept ones do not give is residual.
pub(crate) fn of(stack: &Stack, rate: f64, count: usize) -> ModalSystem {
    let interfaces = stack.interfaces().len();
    let mut modal = ModalSystem::empty(interfaces);
    let kept = kept(stack, count);
    let mut closure = vec![0.0; interfaces];
    for (i, (body, &kept)) in stack.bodies().iter().zip(&kept).enumerate() {
        let elastic = body.length() / body.axial_rigidity();
        let (mut direct, mut cross) = (elastic / 3.0, -elastic / 6.0);
        for n in 0..kept {
            let w = n as f64 * first_frequency(body);
            let sign = if n % 2 == 0 { 1.0 } else { -1.0 };
            let top = (if n == 0 { 1.0 } else { 2.0 } / body.mass()).sqrt();
            let bottom = sign * top;
            if n > 0 {
                direct -= top * top / (w * w);
                cross -= top * bottom / (w * w);
            }
            closure.fill(0.0);
            closure[i] = bottom;
            if i > 0 {
                closure[i - 1] = -top;
            }
            modal.push(w, rate, &closure, if i == 0 { top } else { 0.0 });
        }
        modal.add_residual(i, i, direct);
        if i == 0 {
            modal.add_residual_drive(0, cross);
            modal.add_residual_direct(direct);
        } else {
            modal.add_residual(i - 1, i - 1, direct);
            modal.add_residual(i - 1, i, -cross);
            modal.add_residual(i, i - 1, -cross);
        }
    }
    if let Support::SpringMass { stiffness, mass, .. } = *stack.support() {
        closure.fill(0.0);
        closure[interfaces - 1] = -1.0 / mass.sqrt();
        let w = (stiffness / mass).sqrt();
        modal.push(w, stack.support().damping() / mass, &closure, 0.0);
    }
    modal
}

fn first_frequency(body: &Body) -> f64 {
    PI * body.wave_speed() / body.length()
}

/// How many modes of each bar are among the `count` lowest; the rigid ones always are.
fn kept(stack: &Stack, count: usize) -> Vec<usize> {
    let mut kept = vec![1; stack.bodies().len()];
    let support = usize::from(*stack.support() != Support::Rigid);
    for _ in kept.len() + support..count {
        let next = |i: usize, kept: &[usize]| kept[i] as f64 * first_frequency(&stack.bodies()[i]);
        let lowest = (0..kept.len()).min_by(|&a, &b| next(a, &kept).total_cmp(&next(b, &kept)));
        if let Some(lowest) = lowest {
            kept[lowest] += 1;
        }
    }
    kept
}
