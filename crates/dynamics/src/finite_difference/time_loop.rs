//! The loop over time.

use asperity_mesh::Grid;
use asperity_structure::PreloadedStructure;
use pulp::{Simd, WithSimd};

use super::bar::Bar;
use super::contact::{ContactForm, ContactStep};
use super::guide::GuideStep;
use super::ledger::Ledger;
use super::loads::{Loads, Place};
use super::support::SupportStep;
use crate::{DynamicsError, EnergyLedger, History, Transient};
use asperity_structure::LoadCase;
use std::sync::atomic::{AtomicBool, Ordering};

/// Most steps between two measurements of the viscous power.
const LEDGER_STEPS: usize = 32;

/// Samples between two calls of the progress listener, and two looks at the flag that stops the run.
const PROGRESS_SAMPLES: usize = 64;

/// A whole run.
pub(super) struct TimeLoop<'a> {
    pub(super) structure: &'a PreloadedStructure,
    pub(super) grid: &'a Grid,
    pub(super) form: ContactForm,
    pub(super) loads: &'a Loads<'a>,
    pub(super) sensors: &'a [Place],
    pub(super) samples: usize,
    pub(super) stride: usize,
    pub(super) step: f64,
    pub(super) stop: &'a AtomicBool,
    pub(super) progress: &'a (dyn Fn(f64) + Sync),
}

impl WithSimd for TimeLoop<'_> {
    type Output = Result<Transient, DynamicsError>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        let mut state = State::new(&self)?;
        let mut history =
            History::with_capacity(self.samples, self.sensors.len(), state.contacts.len());
        let sensors: Vec<_> = self
            .sensors
            .iter()
            .map(|place| (*place, place.nodes(&state.bars[place.body])))
            .collect();
        for sample in 0..self.samples {
            if sample % PROGRESS_SAMPLES == 0 && self.stop.load(Ordering::Relaxed) {
                return Err(DynamicsError::Stopped { steps: sample * self.stride });
            }
            let start = (sample * self.stride) as f64 * self.step;
            state.sample_loads(start);
            if sample == 0 {
                // From rest, w+ = F dt^2 / (2 m): half of what the scheme gives with w- = 0.
                state.halve_first_loads();
            }
            for n in 0..self.stride {
                state.step(n);
                if n == 0 {
                    history.time.push(start);
                    let force = self.loads.forces.first().map(|(_, force)| *force);
                    let load = force.or(self.loads.base_acceleration);
                    history.load.push(load.map_or(0.0, |load| load.value(start)));
                    for ((place, nodes), motion) in sensors.iter().zip(&mut history.sensors) {
                        motion.push_states(state.at(place.body, nodes), self.step);
                    }
                    state.observe(&mut history);
                }
                if n % LEDGER_STEPS == 0 {
                    let power = state.viscous_power();
                    state.ledger.measure(power, start + (n as f64 + 0.5) * self.step);
                }
            }
            if let Some(interface) = state.overflow() {
                return Err(DynamicsError::Unstable { time_s: start, interface });
            }
            if sample % PROGRESS_SAMPLES == 0 {
                (self.progress)(sample as f64 / self.samples as f64);
            }
        }
        for motion in &mut history.sensors {
            motion.start_at_rest();
        }
        (self.progress)(1.0);
        let steps = self.samples * self.stride;
        let end = steps as f64 * self.step;
        let power = state.viscous_power();
        state.ledger.measure(power, end - 0.5 * self.step);
        state.ledger.close(end);
        let contacts = state.contacts.iter().map(|contact| contact.record(self.step, steps));
        let contacts = contacts.collect();
        let energy = state.balance(self.form);
        Ok(Transient { step: self.step, steps, contacts, energy, history })
    }
}

/// A force on two nodes of a body with their weights, and its values \[N\] at the steps of a sample.
struct NodalForce<'a> {
    body: usize,
    nodes: [(usize, f64); 2],
    force: &'a LoadCase,
    values: Vec<f64>,
}

struct State<'a> {
    bars: Vec<Bar>,
    contacts: Vec<ContactStep<'a>>,
    support: SupportStep,
    guides: Vec<GuideStep>,
    forces: Vec<NodalForce<'a>>,
    /// Acceleration of the base and its values \[m/s2\] at the steps of a sample.
    base: Option<(&'a LoadCase, Vec<f64>)>,
    /// Acceleration of the nodes of each body by the base and by friction in its guide \[m/s2\].
    accelerations: Vec<f64>,
    ledger: Ledger,
    rate: f64,
    step: f64,
}

impl<'a> State<'a> {
    #[inline(never)]
    fn new(run: &TimeLoop<'a>) -> Result<Self, DynamicsError> {
        let (structure, loads, step) = (run.structure, run.loads, run.step);
        let rate = structure.damping_rate();
        let grids = run.grid.bars().iter();
        let bars: Vec<_> = grids.map(|grid| Bar::new(grid, step, rate)).collect();
        let support = SupportStep::new(structure.stack().support(), step);
        let peak = loads.peak(&bars, support.mass);
        let below = bars[1..].iter().map(|bar| bar.end_compliance).chain([support.compliance]);
        let contacts = structure
            .contacts()
            .iter()
            .zip(bars.iter().zip(below))
            .map(|(contact, (above, below))| {
                let compliance = above.end_compliance + below;
                ContactStep::new(contact, run.form, compliance, step, peak / contact.area())
            })
            .collect::<Result<_, _>>()?;
        let bodies = structure.stack().bodies().iter().enumerate();
        let guided = bodies.filter(|(_, body)| body.friction().is_some()).map(|(i, _)| i);
        let guides = structure.guides().iter().zip(guided);
        let guides = guides
            .map(|(guide, i)| GuideStep::new(guide, i, &bars[i], step))
            .collect::<Result<_, _>>()?;
        let nodal = |(place, force): &(Place, &'a LoadCase)| NodalForce {
            body: place.body,
            nodes: place.nodes(&bars[place.body]),
            force,
            values: vec![0.0; run.stride],
        };
        let forces = loads.forces.iter().map(nodal).collect();
        let base = loads.base_acceleration.map(|base| (base, vec![0.0; run.stride]));
        let accelerations = vec![0.0; bars.len()];
        let ledger = Ledger::default();
        Ok(Self {
            bars,
            contacts,
            support,
            guides,
            forces,
            base,
            accelerations,
            ledger,
            rate,
            step,
        })
    }

    /// Takes up the loads at the steps from `start` \[s\] to the next sample.
    fn sample_loads(&mut self, start: f64) {
        let step = self.step;
        let base = self.base.iter_mut().map(|(base, values)| (*base, values));
        let forces = self.forces.iter_mut().map(|force| (force.force, &mut force.values));
        for (load, values) in forces.chain(base) {
            if start > load.ends_at() {
                values.fill(0.0);
                continue;
            }
            for (n, value) in values.iter_mut().enumerate() {
                *value = load.value(start + n as f64 * step);
            }
        }
    }

    fn halve_first_loads(&mut self) {
        let base = self.base.iter_mut().map(|(_, values)| values);
        for values in self.forces.iter_mut().map(|force| &mut force.values).chain(base) {
            values[0] *= 0.5;
        }
    }

    /// Step number `n` from the latest sample.
    #[inline(always)]
    fn step(&mut self, n: usize) {
        let inertial = self.base.as_ref().map_or(0.0, |(_, values)| -values[n]);
        self.accelerations.fill(inertial);
        for guide in &mut self.guides {
            let contact = &self.contacts[guide.contact];
            self.accelerations[guide.body] += guide.acceleration(contact.area() * contact.normal());
        }
        for (bar, &acceleration) in self.bars.iter_mut().zip(&self.accelerations) {
            bar.advance(acceleration);
        }
        self.support.advance(inertial);
        for force in &self.forces {
            for (node, weight) in force.nodes {
                self.bars[force.body].push(node, weight * force.values[n]);
            }
        }
        self.close_contacts();
        for guide in &mut self.guides {
            guide.complete(self.bars[guide.body].mean());
        }
        self.support.complete();
        self.count_input(n, inertial);
    }

    /// Eq. (5) at each contact, between faces that have moved on without its force.
    #[inline(always)]
    fn close_contacts(&mut self) {
        for (i, contact) in self.contacts.iter_mut().enumerate() {
            let (above, below) = self.bars.split_at_mut(i + 1);
            let upper = &mut above[i];
            let face = upper.last();
            let lower = |below: &[Bar], support: &SupportStep| {
                below.first().map_or(support.reached(), |bar| bar.states(0)[0])
            };
            let closure = upper.states(face)[0] - lower(below, &self.support);
            let force = contact.area() * contact.solve(closure);
            upper.push(face, -force);
            match below.first_mut() {
                Some(bar) => bar.push(0, force),
                None => self.support.push(force),
            }
            contact.advance(upper.states(face)[0] - lower(below, &self.support));
        }
    }

    /// Counts the work of the loads in step `n`, `F (w+ - w-) / 2`.
    #[inline(always)]
    fn count_input(&mut self, n: usize, inertial: f64) {
        for force in &self.forces {
            let [reached, _, before] = self.at(force.body, &force.nodes);
            self.ledger.input += 0.5 * force.values[n] * (reached - before);
        }
        if self.base.is_some() {
            let travels = self.bars.iter().map(|bar| bar.mass() * bar.travel());
            let momentum = self.support.mass * self.support.travel() + travels.sum::<f64>();
            self.ledger.input += 0.5 * inertial * momentum;
        }
    }

    /// Displacements \[m\] between two nodes of a body at the state reached, and one and two steps
    /// earlier.
    #[inline(always)]
    fn at(&self, body: usize, nodes: &[(usize, f64); 2]) -> [f64; 3] {
        let [(left, left_weight), (right, right_weight)] = *nodes;
        let (left, right) = (self.bars[body].states(left), self.bars[body].states(right));
        [0, 1, 2].map(|i| left_weight * left[i] + right_weight * right[i])
    }

    /// Viscous power of the bodies \[W\] half a step before the newest state.
    #[inline(always)]
    fn viscous_power(&self) -> f64 {
        let mut power = 0.0;
        // A closure would be compiled on its own, for the machine's plainest instructions.
        for bar in &self.bars {
            power += bar.viscous_power(self.rate);
        }
        power
    }

    /// Keeps the contacts one step before the newest state in the history.
    fn observe(&self, history: &mut History) {
        for (contact, columns) in self.contacts.iter().zip(&mut history.interfaces) {
            columns.push(contact.observe());
        }
    }

    /// The first interface whose numbers are not finite any more, if any.
    fn overflow(&self) -> Option<String> {
        let lost = self.contacts.iter().find(|contact| !contact.is_finite());
        let name = lost.or(self.contacts.first()).map(|contact| contact.name().to_owned());
        name.filter(|_| lost.is_some() || !self.bars[0].states(0)[0].is_finite())
    }

    fn balance(&self, form: ContactForm) -> EnergyLedger {
        let (mut kinetic, mut elastic) = self.support.energy(self.step);
        for bar in &self.bars {
            kinetic += bar.kinetic_energy();
            elastic += bar.elastic_energy();
        }
        let guides = self.guides.iter().map(GuideStep::energy);
        let elements = guides.chain(self.contacts.iter().map(ContactStep::friction_energy));
        let (friction_stored, friction_dissipated) =
            elements.fold((0.0, 0.0), |sum, (stored, lost)| (sum.0 + stored, sum.1 + lost));
        let (mut contact, mut work, mut contact_dissipated) = (0.0, 0.0, 0.0);
        for step in &self.contacts {
            let (stored, done) = step.energy();
            contact += stored;
            work += done;
            contact_dissipated += step.loss();
        }
        EnergyLedger {
            input: self.ledger.input,
            dissipated: self.ledger.dissipated
                + self.support.loss
                + contact_dissipated
                + friction_dissipated,
            contact_dissipated,
            friction_dissipated,
            kinetic,
            elastic: elastic + friction_stored,
            contact,
            numerical_loss: if form == ContactForm::NewLevel { work - contact } else { 0.0 },
        }
    }
}
