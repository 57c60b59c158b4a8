//! The same scheme as a plain loop over nodes in order: Eq. (4) with `f64`
//! arithmetic, left to the compiler's own vectorisation for its default target.

use asperity_dynamics::{Excitation, Sampling};
use asperity_law::{CompiledLaw, InSeries};
use asperity_mesh::Grid;
use asperity_structure::PreloadedStructure;

struct Bar {
    now: Vec<f64>,
    before: Vec<f64>,
    own: f64,
    neighbour: f64,
    past: f64,
    compliance: f64,
}

struct Contact {
    area: f64,
    table: CompiledLaw,
    now: f64,
    before: f64,
}

/// Marches the whole run; returns the top's displacement at the output samples.
pub(crate) fn march(
    structure: &PreloadedStructure,
    excitation: &Excitation,
    sampling: &Sampling,
) -> Vec<f64> {
    let grid = Grid::new(structure.stack(), 1e-3).unwrap();
    let (step, stride) = grid.step_within(sampling.interval(), 0.95).unwrap();
    let a2 = structure.damping_rate() * step;
    let mut bars: Vec<Bar> = grid
        .bars()
        .iter()
        .map(|bar| {
            let a1 = (step / bar.critical_step()).powi(2);
            Bar {
                now: vec![0.0; bar.nodes()],
                before: vec![0.0; bar.nodes()],
                own: (2.0 * (1.0 - a1) + a2) / (1.0 + a2),
                neighbour: a1 / (1.0 + a2),
                past: 1.0 / (1.0 + a2),
                compliance: step * step / (bar.end_mass() * (1.0 + a2)),
            }
        })
        .collect();
    let mut contacts = contacts(structure, &bars, excitation);
    let mut displacement = Vec::with_capacity(sampling.samples());
    let mut forces = vec![0.0; stride];
    for sample in 0..sampling.samples() {
        excitation.sample_into(sample as f64 * sampling.interval(), step, &mut forces);
        displacement.push(bars[0].now[0]);
        for &force in &forces {
            advance(&mut bars, &mut contacts, force);
        }
    }
    displacement
}

fn contacts(structure: &PreloadedStructure, bars: &[Bar], excitation: &Excitation) -> Vec<Contact> {
    let contacts = structure.contacts().iter().enumerate();
    contacts
        .map(|(i, contact)| {
            let below = bars.get(i + 1).map_or(0.0, |bar| bar.compliance);
            let b = 0.5 * contact.area() * (bars[i].compliance + below);
            let series = InSeries::new(contact.law().clone(), 1.0 / b).unwrap();
            let top = contact.pressure() + 3.0 * excitation.peak() / contact.area();
            let table = CompiledLaw::new(&series, contact.pressure(), top, 1e-6).unwrap();
            Contact { area: contact.area(), table, now: 0.0, before: 0.0 }
        })
        .collect()
}

fn advance(bars: &mut [Bar], contacts: &mut [Contact], force: f64) {
    for bar in bars.iter_mut() {
        let last = bar.now.len() - 1;
        let Bar { now, before, own, neighbour, past, .. } = bar;
        before[0] = *own * now[0] + 2.0 * *neighbour * now[1] - *past * before[0];
        for k in 1..last {
            before[k] = *own * now[k] + *neighbour * (now[k - 1] + now[k + 1]) - *past * before[k];
        }
        before[last] = *own * now[last] + 2.0 * *neighbour * now[last - 1] - *past * before[last];
        std::mem::swap(now, before);
    }
    bars[0].now[0] += force * bars[0].compliance;
    for (i, contact) in contacts.iter_mut().enumerate() {
        let above = *bars[i].now.last().unwrap();
        let below = bars.get(i + 1).map_or(0.0, |bar| bar.now[0]);
        let push = contact.area * contact.table.get(0.5 * (above - below + contact.before));
        let up = push * bars[i].compliance;
        *bars[i].now.last_mut().unwrap() -= up;
        let mut down = 0.0;
        if let Some(bar) = bars.get_mut(i + 1) {
            down = push * bar.compliance;
            bar.now[0] += down;
        }
        contact.before = contact.now;
        contact.now = above - below - up - down;
    }
}
