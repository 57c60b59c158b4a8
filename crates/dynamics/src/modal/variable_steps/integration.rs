//! A case on its way: its steps and their lengths.

use std::array;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use asperity_structure::LoadCase;

use super::contact_solve::{Contact, FreeEnd, RowState, RowStep, solve};
use super::measures::{ContactMeasure, Measures};
use super::{StepControl, hermite, hermite_slope};
use crate::contact_energy::excess;
use crate::modal::assembly::ModalModel;
use crate::modal::row_modes::RowMode;
use crate::modal::step_coefficients::{LANES, Lanes, StepCoefficients};
use crate::modal::transient_case::pressure_at;
use crate::{ContactExtremes, DynamicsError, EnergyLedger, History};

/// Halvings of the base step at most.
const MOST_HALVINGS: usize = 14;

/// Halvings of the base step at rest.
const FIRST_HALVINGS: usize = 4;

/// Error over its bound below which the next step is doubled: the error is of fourth order.
const SMALL: f64 = 1.0 / 40.0;

/// Traction over the static pressure that counts as the largest so far at rest.
const LEAST_TRACTION: f64 = 1e-3;

/// Loss of the pressure at rest, over all of it, from which on a contact is near opening.
const NEAR_OPENING: f64 = 0.9;

/// Steps of one case at most.
const MOST_STEPS: usize = 8_000_000;

/// Participations of some modes side by side.
#[derive(Debug, Clone, Copy)]
struct ShapeBlock<const N: usize> {
    /// Of the closure of each row, and modal force per traction at each row.
    closure: [Lanes; N],
    force: [Lanes; N],
    load: Lanes,
    /// Damping rate.
    rate: Lanes,
}

/// States of some modes side by side.
#[derive(Debug, Clone, Copy, Default)]
struct StateBlock {
    displacement: Lanes,
    velocity: Lanes,
    acceleration: Lanes,
    /// Contact force and its rate.
    force: Lanes,
    force_rate: Lanes,
}

/// A step length with its coefficients.
#[derive(Debug, Clone)]
struct Level<const N: usize> {
    coefficients: Arc<StepCoefficients>,
    rows: RowStep<N>,
}

/// A case on its way.
pub(super) struct Integration<'a, const N: usize> {
    model: &'a ModalModel,
    load: &'a LoadCase,
    contacts: Vec<Contact<'a>>,
    control: StepControl,
    exponents: &'a [i32],
    levels: Vec<Option<Arc<Level<N>>>>,
    shapes: Vec<ShapeBlock<N>>,
    /// Closure per load of the modes left out.
    closure_per_load: [f64; N],
    /// Participations of each sensor.
    sensors: Vec<Vec<Lanes>>,
    modes: Vec<StateBlock>,
    /// Displacements and velocities at the end of the step without the tractions there.
    free: Vec<[Lanes; 2]>,
    rows: RowState<N>,
    /// Load and its rate.
    loaded: [f64; 2],
    /// The step before: its length, and the rows at its beginning.
    before: Option<(f64, RowState<N>)>,
    /// Largest traction of each row so far.
    largest: [f64; N],
    measures: Measures,
    /// Steps taken, and the shortest \[s\].
    pub(super) taken: usize,
    pub(super) shortest: f64,
    /// Base steps since a contact was near opening.
    pub(super) pressed: usize,
}

impl<'a, const N: usize> Integration<'a, N> {
    /// `load` on `model` from rest, with tables of laws up to `2^exponent` \[Pa\] above rest.
    pub(super) fn new(
        model: &'a ModalModel,
        load: &'a LoadCase,
        exponents: &'a [i32],
        control: StepControl,
    ) -> Result<Self, DynamicsError> {
        let tables = model.tables(exponents)?;
        let pairs = model.contacts().iter().zip(tables);
        let contacts: Vec<Contact<'_>> =
            pairs.map(|(contact, table)| Contact::new(contact, table)).collect();
        let structure = model.row_modes();
        let (modes, rate) = (&structure.modes, model.preloaded().damping_rate());
        let shape = |modes: &[RowMode]| ShapeBlock {
            closure: array::from_fn(|i| {
                lanes(modes, |mode| mode.closure.get(i).copied().unwrap_or(0.0))
            }),
            force: array::from_fn(|i| {
                lanes(modes, |mode| mode.closure.get(i).map_or(0.0, |g| g * model.area(i)))
            }),
            load: lanes(modes, |mode| mode.load),
            rate: lanes(modes, |mode| mode.total_damping(rate)),
        };
        let blocks = || modes.chunks(LANES);
        let sensor =
            |s: usize| blocks().map(|modes| lanes(modes, |mode| mode.sensors[s])).collect();
        let shapes: Vec<ShapeBlock<N>> = blocks().map(shape).collect();
        let of_contact =
            |i: usize| contacts.get(i).map_or(0.0, |contact| LEAST_TRACTION * contact.pressure());
        Ok(Self {
            model,
            load,
            control,
            exponents,
            levels: vec![None; MOST_HALVINGS + 1],
            closure_per_load: array::from_fn(|i| {
                structure.residual.load.get(i).copied().unwrap_or(0.0)
            }),
            sensors: (0..model.sensors()).map(sensor).collect(),
            modes: vec![StateBlock::default(); shapes.len()],
            free: vec![[[0.0; LANES]; 2]; shapes.len()],
            shapes,
            rows: RowState::at_rest(&contacts),
            loaded: [load.value(0.0), 0.0],
            before: None,
            largest: array::from_fn(of_contact),
            measures: Measures::new(&contacts),
            contacts,
            taken: 0,
            shortest: control.base,
            pressed: 0,
        })
    }

    /// Integrates to the end, or until `stop` is set; `record` sees the state at the end of each base step, and
    /// their number, and may end the run there.
    #[inline(always)]
    pub(super) fn run(
        &mut self,
        mut record: impl FnMut(&mut Self, usize) -> ControlFlow<()>,
        stop: &AtomicBool,
    ) -> Result<(), DynamicsError> {
        let whole = 1_usize << MOST_HALVINGS;
        let mut level = FIRST_HALVINGS;
        let mut coefficients = self.level(level);
        for step in 0..self.control.steps {
            if stop.load(Ordering::Relaxed) {
                return Err(DynamicsError::Stopped { steps: self.taken });
            }
            // Parts of the base step that have passed, in steps of the shortest length.
            let mut passed = 0;
            self.pressed += 1;
            while passed < whole {
                let start = step as f64 + passed as f64 / whole as f64;
                let error = loop {
                    let load = self.load_within(&coefficients, start);
                    let is_shortest = level == MOST_HALVINGS;
                    if let Some((end, error)) = self.attempt(&coefficients, load, is_shortest)
                        && (error <= 1.0 || is_shortest)
                    {
                        self.complete(&coefficients, load, end);
                        break error;
                    }
                    if is_shortest || self.taken > MOST_STEPS {
                        return Err(self.unstable(start));
                    }
                    level += 1;
                    coefficients = self.level(level);
                };
                passed += whole >> level;
                if error < SMALL
                    && level > 0
                    && passed.is_multiple_of(whole >> (level - 1))
                    && self.may_lengthen(level)
                {
                    level -= 1;
                    coefficients = self.level(level);
                }
            }
            if record(self, step + 1).is_break() {
                break;
            }
        }
        Ok(())
    }

    /// True if the modes that a step of twice the length does not show ring with so little energy that it
    /// may be lost.
    fn may_lengthen(&mut self, level: usize) -> bool {
        let (short, long) = (self.level(level), self.level(level - 1));
        self.ringing(Some(&short.coefficients), &long.coefficients)
            <= self.control.tolerance * self.measures.work.abs()
    }

    /// True if steps of `step` \[s\] would lose as little of the energy of modes that ring.
    pub(super) fn may_take_steps(&self, step: f64) -> bool {
        let long = self.model.step_coefficients(step, self.exponents);
        self.ringing(None, &long) <= self.control.tolerance * self.measures.work.abs()
    }

    /// Energy of the modes that ring \[J\] and are in motion at `short` steps, if given, and follow their forces at
    /// once at `long` ones.
    fn ringing(&self, short: Option<&StepCoefficients>, long: &StepCoefficients) -> f64 {
        let mut ringing = 0.0;
        for (n, mode) in self.model.row_modes().modes.iter().enumerate() {
            let follows = |steps: &StepCoefficients| steps.modes[n].follows();
            if follows(long) && !short.is_some_and(follows) {
                let (state, lane) = (&self.modes[n / LANES], n % LANES);
                let w = mode.angular_frequency;
                let force = state.force[lane] + mode.load * self.loaded[0];
                let apart = w * state.displacement[lane] - force / w;
                ringing += 0.5 * (state.velocity[lane].powi(2) + apart * apart);
            }
        }
        ringing
    }

    #[cold]
    fn unstable(&self, start: f64) -> DynamicsError {
        DynamicsError::Unstable {
            time_s: start * self.control.base,
            interface: self.model.contacts()[0].name().to_owned(),
        }
    }

    fn level(&mut self, level: usize) -> Arc<Level<N>> {
        let (model, exponents, contacts) = (self.model, self.exponents, &self.contacts);
        let step = self.control.base / (1_usize << level) as f64;
        let known = self.levels[level].get_or_insert_with(|| {
            let coefficients = model.step_coefficients(step, exponents);
            let rows = RowStep::new(&coefficients, contacts);
            Arc::new(Level { coefficients, rows })
        });
        Arc::clone(known)
    }

    /// Coefficients of the load within the step from `start` base steps, a quadratic; none without a load.
    #[inline(always)]
    fn load_within(&self, level: &Level<N>, start: f64) -> Option<[f64; 3]> {
        let (begin, step) = (start * self.control.base, level.coefficients.step);
        if begin > self.load.ends_at() && self.loaded == [0.0; 2] {
            return None;
        }
        let (middle, last) = (self.load.value(begin + 0.5 * step), self.load.value(begin + step));
        let first = self.loaded[0];
        Some([first, 4.0 * middle - 3.0 * first - last, 2.0 * (first - 2.0 * middle + last)])
    }

    /// The rows at the end of a step, and the error of its tractions over the tolerance; none where the
    /// contacts are not solved. In the shortest step a traction may jump, as damped faces meet.
    #[inline(always)]
    fn attempt(
        &mut self,
        level: &Level<N>,
        load: Option<[f64; 3]>,
        may_jump: bool,
    ) -> Option<(RowState<N>, f64)> {
        let step = level.coefficients.step;
        let mut sums = [[[0.0; LANES]; N]; 3];
        let blocks = self.modes.iter().zip(&level.coefficients.blocks).zip(&self.shapes);
        let is_damped = level.rows.is_damped();
        for (((state, shares), shape), free) in blocks.zip(&mut self.free) {
            let from = [&state.displacement, &state.velocity, &state.force, &state.force_rate];
            for (end, shares) in free.iter_mut().zip(&shares.free) {
                *end = [0.0; LANES];
                for (share, number) in shares.iter().zip(from) {
                    add_product(end, share, number);
                }
            }
            if let Some(load) = load {
                for (end, shares) in free.iter_mut().zip(&shares.load) {
                    for (share, load) in shares.iter().zip(load) {
                        add_product(end, share, &[load; LANES]);
                    }
                }
            }
            for i in 0..N {
                add_product(&mut sums[0][i], &shape.closure[i], &free[0]);
                add_product(&mut sums[1][i], &shape.closure[i], &free[1]);
            }
            if is_damped {
                let moved =
                    acceleration(&shares.acceleration, free, None, shape, end_of(load, step));
                for i in 0..N {
                    add_product(&mut sums[2][i], &shape.closure[i], &moved);
                }
            }
        }
        let [closure, rate, acceleration] = sums.map(|of_rows| of_rows.map(|sum| sum.iter().sum()));
        let mut free = FreeEnd { closure, rate, acceleration };
        let [value, slope] = end_of(load, step);
        for i in 0..N {
            free.closure[i] += self.closure_per_load[i] * value;
            free.rate[i] += self.closure_per_load[i] * slope;
        }
        let guess = self.continued(step);
        let end = solve(&self.contacts, &level.rows, &free, [&self.rows, &guess], &self.largest);
        let end = end
            .or_else(|last| if may_jump && last.is_finite() { Ok(last) } else { Err(()) })
            .ok()?;
        let share = match &self.before {
            Some((before, _)) => (step / (step + before)).powi(2) / 16.0,
            None => 1.0,
        };
        let mut largest = 0.0_f64;
        for i in 0..N {
            let scale = self.largest[i].max(end.traction[i].abs());
            largest = largest.max((end.traction[i] - guess.traction[i]).abs() / scale);
        }
        Some((end, share * largest / self.control.tolerance))
    }

    /// The rows at the end of a step by the cubics of the step before.
    #[inline(always)]
    fn continued(&self, step: f64) -> RowState<N> {
        let mut next = self.rows;
        let Some((length, before)) = &self.before else { return next };
        let s = 1.0 + step / length;
        for i in 0..N {
            let ends = [
                before.traction[i],
                before.traction_rate[i] * length,
                self.rows.traction[i],
                self.rows.traction_rate[i] * length,
            ];
            next.traction[i] = hermite(ends, s);
            next.traction_rate[i] = hermite_slope(ends, s) / length;
        }
        next
    }

    /// Completes a step whose rows at its end are known.
    #[inline(always)]
    fn complete(&mut self, level: &Level<N>, load: Option<[f64; 3]>, end: RowState<N>) {
        let step = level.coefficients.step;
        let loaded = end_of(load, step);
        let port_before = load.map(|_| self.load_port());
        let mut loss = [0.0; LANES];
        let blocks = self.modes.iter_mut().zip(&level.coefficients.blocks).zip(&self.shapes);
        for (((state, shares), shape), free) in blocks.zip(&self.free) {
            let (mut force, mut force_rate) = ([0.0; LANES], [0.0; LANES]);
            for i in 0..N {
                add_product(&mut force, &shape.force[i], &[-end.traction[i]; LANES]);
                add_product(&mut force_rate, &shape.force[i], &[-end.traction_rate[i]; LANES]);
            }
            let mut reached = *free;
            for (reached, shares) in reached.iter_mut().zip(&shares.end) {
                add_product(reached, &shares[0], &force);
                add_product(reached, &shares[1], &force_rate);
            }
            let pushed = Some([&force, &force_rate]);
            let accelerated = acceleration(&shares.acceleration, &reached, pushed, shape, loaded);
            for l in 0..LANES {
                let [a, b] = [state.velocity[l], reached[1][l]];
                let [da, db] = [state.acceleration[l], accelerated[l]];
                let square = 0.5 * (a * a + b * b) + step / 6.0 * (a * da - b * db);
                loss[l] += shape.rate[l] * square;
            }
            let [displacement, velocity] = reached;
            let acceleration = accelerated;
            *state = StateBlock { displacement, velocity, acceleration, force, force_rate };
        }
        self.measures.loss += step * loss.iter().sum::<f64>();
        let begin = std::mem::replace(&mut self.rows, end);
        self.loaded = loaded;
        if let (Some(load), Some(before)) = (load, port_before) {
            let port = [before, self.load_port()];
            self.measures.count_work(load, port, step);
        }
        self.measures.take(&self.contacts, [&begin, &self.rows], step);
        for i in 0..N {
            self.largest[i] = self.largest[i].max(self.rows.traction[i].abs());
        }
        for (contact, pressure) in self.contacts.iter().zip(&self.rows.pressure) {
            if *pressure <= NEAR_OPENING * contact.least {
                self.pressed = 0;
            }
        }
        self.before = Some((step, begin));
        self.taken += 1;
        self.shortest = self.shortest.min(step);
    }

    /// Displacement and velocity of the load port.
    #[inline(never)]
    pub(super) fn load_port(&self) -> [f64; 2] {
        let residual = &self.model.row_modes().residual;
        let mut port = self.loaded.map(|load| residual.load_port * load);
        for (shape, state) in self.shapes.iter().zip(&self.modes) {
            port[0] += sum_product(&shape.load, &state.displacement);
            port[1] += sum_product(&shape.load, &state.velocity);
        }
        self.less_tractions(&residual.load, port)
    }

    /// `moved` less the displacement and the velocity by the tractions through a flexibility of each row.
    fn less_tractions(&self, flexibility: &[f64], moved: [f64; 2]) -> [f64; 2] {
        let mut moved = moved;
        for (i, (contact, share)) in self.contacts.iter().zip(flexibility).enumerate() {
            moved[0] -= share * contact.area() * self.rows.traction[i];
            moved[1] -= share * contact.area() * self.rows.traction_rate[i];
        }
        moved
    }

    /// Closures \[m\], tractions and their viscous parts \[Pa\] of the contacts.
    pub(super) fn rows_now(&self) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
        let (rows, count) = (&self.rows, self.contacts.len());
        let viscous = (0..count).map(|i| rows.traction[i] - rows.pressure[i]).collect();
        (rows.closure[..count].to_vec(), rows.traction[..count].to_vec(), viscous)
    }

    /// Stiffness of each contact \[Pa/m\].
    pub(super) fn stiffness_now(&self) -> Vec<f64> {
        self.rows.stiffness[..self.contacts.len()].to_vec()
    }

    /// Displacement of every mode \[m kg^(1/2)\].
    pub(super) fn modes(&self) -> impl Iterator<Item = f64> {
        let states = self.modes.iter().flat_map(|state| state.displacement);
        states.take(self.model.row_modes().modes.len())
    }

    /// Velocity of every mode \[m kg^(1/2)/s\].
    pub(super) fn mode_velocities(&self) -> impl Iterator<Item = f64> {
        let states = self.modes.iter().flat_map(|state| state.velocity);
        states.take(self.model.row_modes().modes.len())
    }

    /// Displacement of sensor `sensor` \[m\].
    pub(super) fn displacement(&self, sensor: usize) -> f64 {
        self.reading(sensor)[0]
    }

    /// Displacement \[m\], velocity \[m/s\] and acceleration \[m/s2\] of sensor `sensor`; to the
    /// acceleration the modes left out, and those that follow their forces at once, add nothing.
    fn reading(&self, sensor: usize) -> [f64; 3] {
        let residual = &self.model.row_modes().residual;
        let per_load = residual.sensors_per_load[sensor];
        let mut moved = self.loaded.map(|load| per_load * load);
        let mut accelerated = 0.0;
        for (participation, state) in self.sensors[sensor].iter().zip(&self.modes) {
            moved[0] += sum_product(participation, &state.displacement);
            moved[1] += sum_product(participation, &state.velocity);
            accelerated += sum_product(participation, &state.acceleration);
        }
        let [displacement, velocity] = self.less_tractions(&residual.sensors[sensor], moved);
        [displacement, velocity, accelerated]
    }

    /// Adds the state at `time` \[s\] to a history.
    pub(super) fn record(&self, history: &mut History, time: f64) {
        history.time.push(time);
        history.load.push(self.loaded[0]);
        for (sensor, columns) in history.sensors.iter_mut().enumerate() {
            columns.push(self.reading(sensor));
        }
        for (i, columns) in history.interfaces.iter_mut().enumerate() {
            let (contact, increment) = (&self.contacts[i], self.rows.closure[i]);
            let [pressure, stiffness] =
                pressure_at(contact.preloaded, contact.open_below, increment);
            columns.push((pressure, contact.preloaded.closure() + increment, stiffness));
        }
    }

    /// Extremes of the contacts, with averages over the whole duration.
    pub(super) fn contact_extremes(&self) -> Vec<ContactExtremes> {
        let duration = self.control.base * self.control.steps as f64;
        let extremes = |(contact, measure): (&Contact<'_>, &ContactMeasure)| {
            let at = |closure: f64| pressure_at(contact.preloaded, contact.open_below, closure)[0];
            ContactExtremes {
                pressure_min: at(measure.lowest),
                pressure_max: at(measure.highest),
                lost: measure.open,
                stiffness_average: measure.stiffness / duration,
            }
        };
        self.contacts.iter().zip(&self.measures.contacts).map(extremes).collect()
    }

    /// The energy balance so far.
    pub(super) fn ledger(&self) -> EnergyLedger {
        let structure = self.model.row_modes();
        let mut ledger = EnergyLedger {
            input: self.measures.work,
            dissipated: self.measures.loss,
            ..EnergyLedger::default()
        };
        for (n, mode) in structure.modes.iter().enumerate() {
            let (state, lane) = (&self.modes[n / LANES], n % LANES);
            if !mode.massless {
                ledger.kinetic += 0.5 * state.velocity[lane].powi(2);
            }
            ledger.elastic += 0.5 * (mode.angular_frequency * state.displacement[lane]).powi(2);
        }
        let (residual, load) = (&structure.residual, self.loaded[0]);
        let force = |i: usize| self.contacts[i].area() * self.rows.traction[i];
        ledger.elastic += 0.5 * residual.load_port * load * load;
        let pairs = self.contacts.iter().zip(&self.measures.contacts);
        for (i, (contact, measure)) in pairs.enumerate() {
            ledger.contact_dissipated += contact.area() * measure.loss;
            ledger.contact += contact.area() * excess(contact.preloaded, self.rows.closure[i]);
            ledger.elastic -= residual.load[i] * load * force(i);
            for j in 0..self.contacts.len() {
                ledger.elastic += 0.5 * force(i) * residual.closure[i][j] * force(j);
            }
        }
        ledger.dissipated += ledger.contact_dissipated;
        ledger
    }
}

/// Load and its rate at the end of a step of `step` \[s\].
#[inline(always)]
fn end_of(load: Option<[f64; 3]>, step: f64) -> [f64; 2] {
    load.map_or([0.0; 2], |[a, b, c]| [a + b + c, (b + 2.0 * c) / step])
}

/// Accelerations of modes with these displacements and velocities under a contact force and its rate, and
/// the load and its rate.
#[inline(always)]
fn acceleration<const N: usize>(
    shares: &[Lanes; 4],
    [displacement, velocity]: &[Lanes; 2],
    force: Option<[&Lanes; 2]>,
    shape: &ShapeBlock<N>,
    load: [f64; 2],
) -> Lanes {
    let mut sum = [0.0; LANES];
    add_product(&mut sum, &shares[0], displacement);
    add_product(&mut sum, &shares[1], velocity);
    for k in 0..2 {
        let mut total = shape.load.map(|participation| participation * load[k]);
        if let Some(force) = force {
            for (total, force) in total.iter_mut().zip(force[k]) {
                *total += force;
            }
        }
        add_product(&mut sum, &shares[2 + k], &total);
    }
    sum
}

/// A number of each of at most [`LANES`] modes.
fn lanes(modes: &[RowMode], of: impl Fn(&RowMode) -> f64) -> Lanes {
    array::from_fn(|lane| modes.get(lane).map_or(0.0, &of))
}

#[inline(always)]
fn add_product(sum: &mut Lanes, a: &Lanes, b: &Lanes) {
    for l in 0..LANES {
        sum[l] += a[l] * b[l];
    }
}

#[inline(always)]
fn sum_product(a: &Lanes, b: &Lanes) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
