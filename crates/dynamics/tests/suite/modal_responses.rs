//! Responses of a batch: against the whole response, and against a lumped system solved
//! another way.

use std::sync::Arc;

use crate::support::{
    AREA, DISC, difference, every_law, modified, power, pulse, rig, rig_on, slope, three_bodies,
};
use asperity_dynamics::{Batch, CaseResponse, Decimation, ModalModel, Sampling, TransientCase};
use asperity_law::ContactLaw;
use asperity_mesh::{
    ComponentModes, ModeCount, NormalMode, Port, PortPair, ResidualFlexibility, Stack,
};
use asperity_structure::{Damping, LoadCase, PreloadedContact, PreloadedStructure, TimeFunction};

fn hit(stack: &Stack, excitation: LoadCase, duration: f64, step: Option<f64>) -> TransientCase {
    let structure = PreloadedStructure::new(stack.clone(), Damping::Ratio(0.035)).unwrap();
    let rig = ModalModel::of_stack(
        &structure,
        &ModeCount::PerBody(3).counts(structure.stack()).unwrap(),
        Port::TOP,
        &[Port::TOP],
    )
    .unwrap();
    TransientCase {
        model: Arc::new(rig),
        load: excitation,
        sensor: 0,
        duration,
        step,
        tolerance: None,
    }
}

fn record(hit: &TransientCase, factor: usize, taps: &[f64]) -> CaseResponse {
    let decimation = Arc::new(Decimation { factor, taps: taps.into(), ending: 70 });
    let mut records =
        Batch::default().run(std::slice::from_ref(hit), &|_, _| Arc::clone(&decimation));
    records.swap_remove(0).unwrap()
}

fn cases() -> Vec<TransientCase> {
    let half = LoadCase::force(TimeFunction::HalfSine { duration: 1e-3 }, 15.0);
    let sine = LoadCase::force(TimeFunction::Harmonic { frequency: 700.0 }, 4.0);
    vec![
        hit(&rig(&modified()), pulse(32.0), 6e-3, Some(1e-5)),
        hit(&rig(&power()), pulse(32.0), 4e-3, None),
        hit(&rig_on(&power(), DISC), half, 5e-3, None),
        hit(&three_bodies(DISC), sine, 3.3e-3, Some(4e-6)),
    ]
}

/// The steps of a batch are the samples of the whole response, and the rest of both agrees. The
/// samples go through velocities, the steps do without: round-off, 1e-12 without bounces.
#[test]
fn a_batch_and_a_transient_are_the_same_hit() {
    for hit in cases() {
        let record = record(&hit, 1, &[1.0]);
        let sampling = Sampling::new(record.steps as f64 * record.step, 1.0 / record.step).unwrap();
        let whole = Batch::default().transient(&hit, &sampling).unwrap();
        assert_eq!((whole.step, whole.steps), (record.step, record.steps));
        assert_eq!(record.displacement.len(), record.steps);
        assert_eq!(record.ending, record.displacement[record.steps - 70..]);
        let off = difference(&record.displacement, &whole.history.sensors[0].displacement);
        assert!(off < 1e-10, "{off}");
        assert_eq!(whole.contacts, record.contacts);
        assert_eq!(whole.energy, record.energy);
        for (contact, samples) in record.contacts.iter().zip(&whole.history.interfaces) {
            let average = contact.stiffness_average;
            let mean = samples.stiffness.iter().sum::<f64>() / samples.stiffness.len() as f64;
            // Tangents where Newton's method came from, at every fourth step, which matters where
            // contact is lost.
            assert!((average / mean - 1.0).abs() < 1e-2);
        }
    }
}

#[test]
fn a_thinned_record_is_the_filtered_whole() {
    let taps: Vec<f64> = (0..45).map(|tap| (0.3 * f64::from(tap)).cos() / 30.0).collect();
    for hit in cases() {
        let whole = record(&hit, 1, &[1.0]).displacement;
        for (factor, length) in [(1, 45), (7, 45), (4, 1), (13, 3), (200, 32), (5, 34)] {
            let found = record(&hit, factor, &taps[..length]).displacement;
            let filtered = |j: usize| -> f64 {
                let past =
                    (0..length).filter_map(|tap| (j * factor).checked_sub(tap).zip(Some(tap)));
                past.map(|(n, tap)| taps[tap] * whole.get(n).copied().unwrap_or(0.0)).sum()
            };
            // Until the last step has left the filter.
            let count = (whole.len() + length - 2) / factor + 1;
            assert_eq!(found.len(), count, "factor {factor}, {length} taps");
            let expected: Vec<f64> = (0..count).map(filtered).collect();
            let off = difference(&found, &expected);
            assert!(off < 1e-13, "factor {factor}, {length} taps: {off}");
        }
    }
}

/// A mass on a contact on a mass, which stands on a contact and hangs on a spring and damper.
struct Lumped {
    masses: [f64; 2],
    spring: f64,
    damper: f64,
    pressure: f64,
    law: Arc<dyn ContactLaw>,
}

impl Lumped {
    /// Its modes: each mass is one, of shape `1 / sqrt(m)`, and has a port. The first is loaded, and the
    /// sensor is mass `sensor`.
    fn hit(&self, load: LoadCase, step: f64, sensor: usize) -> TransientCase {
        let [a, b] = self.masses.map(|mass| 1.0 / f64::sqrt(mass));
        let free = NormalMode::rigid(vec![a, 0.0]);
        let hung = NormalMode {
            mass_damped: false,
            damping_rate: self.damper / self.masses[1],
            ..NormalMode::elastic((self.spring / self.masses[1]).sqrt(), vec![0.0, b])
        };
        let pairs = vec![PortPair::between(0, 1), PortPair::on_ground(1)];
        let none = ResidualFlexibility::zero(2);
        let structure = ComponentModes::new(vec![free, hung], none, pairs, vec![]).unwrap();
        let contact =
            |name| PreloadedContact::new(name, AREA, Arc::clone(&self.law), self.pressure).unwrap();
        let contacts = vec![contact("between"), contact("below")];
        let damping = Damping::Rate(200.0);
        let structure = PreloadedStructure::of_components(structure, contacts, damping).unwrap();
        let rig = Arc::new(ModalModel::new(structure, 0, &[0, 1]).unwrap());
        TransientCase {
            model: rig,
            load,
            sensor,
            duration: 5e-3,
            step: Some(step),
            tolerance: None,
        }
    }

    /// The same masses by Runge and Kutta's fourth-order method, `parts` steps a sample.
    fn solve(
        &self,
        excitation: &LoadCase,
        interval: f64,
        samples: usize,
        parts: usize,
    ) -> [Vec<f64>; 2] {
        let [m, n] = self.masses;
        let pull = |d: f64| AREA * self.law.pressure_increment(self.pressure, d).value;
        let rate = |t: f64, y: [f64; 4]| {
            let [u, v, du, dv] = y;
            let (between, below) = (pull(u - v), pull(v));
            let hang = self.spring * v + self.damper * dv;
            let driven = excitation.value(t) - between;
            [du, dv, driven / m - 200.0 * du, (between - below - hang) / n]
        };
        let h = interval / parts as f64;
        let (mut y, mut out) = ([0.0; 4], [Vec::new(), Vec::new()]);
        for step in 0..samples * parts {
            if step % parts == 0 {
                out[0].push(y[0]);
                out[1].push(y[1]);
            }
            let t = step as f64 * h;
            let ahead = |k: [f64; 4], by: f64| std::array::from_fn(|i| y[i] + by * k[i]);
            let k1 = rate(t, y);
            let k2 = rate(t + 0.5 * h, ahead(k1, 0.5 * h));
            let k3 = rate(t + 0.5 * h, ahead(k2, 0.5 * h));
            let k4 = rate(t + h, ahead(k3, h));
            y = std::array::from_fn(|i| y[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]));
        }
        out
    }
}

/// Modes from elsewhere, by hand: no bar is in this, and the solution is another method's.
#[test]
fn modes_by_hand_move_as_the_masses_they_stand_for() {
    for (name, law, peak) in
        [("smooth", modified(), 20.0), ("bouncing", power(), 60.0), ("pulled", power(), -12.0)]
    {
        let lumped = Lumped { masses: [1.6, 0.3], spring: 4e6, damper: 40.0, pressure: 1.4e5, law };
        let excitation = LoadCase::force(TimeFunction::Haversine { duration: 0.8e-3 }, peak);
        let (steps, interval) = ([32e-6, 16e-6, 8e-6], 32e-6);
        let exact = lumped.solve(&excitation, interval, 157, 320);
        let errors = steps.map(|step| {
            let hit = lumped.hit(excitation.clone(), step, 0);
            let found = record(&hit, (interval / step).round() as usize, &[1.0]);
            difference(&found.displacement, &exact[0])
        });
        let order = slope(&steps, &errors);
        let bound = if name == "bouncing" { 5e-4 } else { 5e-6 };
        assert!(order > 4.0 && errors[2] < bound, "{name}: {errors:?}");
    }
}

/// The motion of another place than the one that is hit, as that of a structure from elsewhere may be.
#[test]
fn the_output_need_not_be_where_the_force_is() {
    let lumped =
        Lumped { masses: [1.6, 0.3], spring: 4e6, damper: 40.0, pressure: 1.4e5, law: modified() };
    let excitation = LoadCase::force(TimeFunction::Haversine { duration: 0.8e-3 }, 20.0);
    let exact = lumped.solve(&excitation, 8e-6, 625, 80);
    let found = record(&lumped.hit(excitation, 2e-6, 1), 4, &[1.0]);
    assert!(found.energy.residual_relative() < 1e-4, "{:?}", found.energy);
    let off = difference(&found.displacement, &exact[1]);
    assert!(off < 1e-5, "{off}");
}

/// Pressures and stiffnesses between steps are those of the law at the closures, over thousands of samples of a hit
/// that opens contacts.
#[test]
fn pressures_between_steps_are_those_of_the_law() {
    for (name, law) in every_law() {
        let stack = rig(&law);
        let structure = PreloadedStructure::new(stack.clone(), Damping::Ratio(0.035)).unwrap();
        let hit = hit(&stack, pulse(60.0), 0.03, None);
        let sampling = Sampling::new(0.03, 1.7e5).unwrap();
        let whole = Batch::default().transient(&hit, &sampling).unwrap();
        for (contact, seen) in structure.contacts().iter().zip(&whole.history.interfaces) {
            let largest = seen.pressure.iter().fold(0.0, |most: f64, p| most.max(p.abs()));
            for ((pressure, closure), stiffness) in
                seen.pressure.iter().zip(&seen.closure).zip(&seen.stiffness)
            {
                let of_law = contact.law().pressure(*closure);
                let off = (pressure - of_law.value).abs() / largest;
                let turned = (stiffness - of_law.tangent).abs() / contact.stiffness();
                assert!(off < 1e-10, "{name}: {pressure} {off:e}");
                // A rounding of the closure moves the stiffness next to zero pressure.
                assert!(turned < 1e-6 || *pressure < 1e-3 * largest, "{name}: {turned:e}");
            }
        }
    }
}
