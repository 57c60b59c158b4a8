//! A block from the models of its cases, and its load step by step.

use std::sync::Arc;

use asperity_law::Friction;
use asperity_structure::PreloadedContact;
use pulp::Simd;

use super::coefficient::Coefficient;
use super::pair::{LanePair, LaneVector, lane_vector, set_lane};
use super::work::Work;
use super::{Block, Contact, Damper, Load, Mode, Slider, WHOLE};
use crate::modal::damped_table::{PAST, RATE};
use crate::modal::oscillator::{ForceInterpolation, NODES};
use crate::modal::prepared_case::PreparedCase;
use crate::modal::simd::table_lookup::TableRow;
use crate::modal::step_model::ModeStep;

/// The tables of a block's lanes one behind the other, each once; and where each lane's begins,
/// interface by interface.
fn lay_out(lanes: &[&PreparedCase], interfaces: usize) -> (Vec<TableRow>, Vec<Vec<usize>>) {
    let mut rows: Vec<TableRow> = vec![[0.0; 4]];
    let mut laid: Vec<(*const TableRow, usize)> = Vec::new();
    let starts = (0..interfaces).map(|i| {
        let of = |lane: &&PreparedCase| {
            let tabulated = &lane.tabulated;
            let cells = match tabulated.damped.get(i) {
                Some(damped) => damped.rows(),
                None => tabulated.cells(i),
            };
            let table = cells.as_ptr();
            if let Some((_, start)) = laid.iter().find(|(other, _)| *other == table) {
                return *start;
            }
            // Even, so that halves round to the same row of the table wherever it is laid out.
            rows.resize(rows.len().next_multiple_of(2), [0.0; 4]);
            let start = rows.len();
            rows.extend_from_slice(cells);
            laid.push((table, start));
            start
        };
        lanes.iter().map(of).collect()
    });
    let starts = starts.collect();
    (rows, starts)
}

/// Newton correction, in cells, below which a damped contact is replaced by its tangent: its traction
/// has a kink where it would pull, which a longer correction may pass.
const DAMPED_TOLERANCE: f64 = 0.02;

/// The damper of interface `i` of each lane, at rest; of none beyond the last interface.
fn damper<S: Simd, C: Coefficient<S>>(
    simd: S,
    lanes: &[&PreparedCase],
    i: usize,
) -> Damper<LaneVector<S>, C> {
    let zero = LanePair(simd).splat(0.0);
    let lane = |lane: usize| lanes.get(lane).filter(|case| i < case.tabulated.tables.len());
    let all = |of: &dyn Fn(&PreparedCase) -> f64| {
        C::new(simd, &|at| lane(at).map_or(0.0, |case| of(case)))
    };
    Damper {
        impulse: [zero; PAST],
        history: zero,
        work: Work::none(zero),
        rate: RATE.map(|weight| all(&|case| weight / case.tabulated.step_model.step)),
        least: C::new(simd, &|at| {
            let contact = lane(at).and_then(|case| case.model.contacts().get(i));
            let separates = contact.filter(|contact| contact.law().domain().separates());
            separates.map_or(f64::NEG_INFINITY, |contact| -contact.pressure())
        }),
        rows: all(&|case| case.tabulated.tables[i].cells().len() as f64),
    }
}

/// The friction element of row `i` of each lane, at rest; one without force where there is none.
fn slider<S: Simd, C: Coefficient<S>, const N: usize>(
    simd: S,
    lanes: &[&PreparedCase],
    i: usize,
) -> Slider<LaneVector<S>, C, N> {
    let zero = LanePair(simd).splat(0.0);
    let element =
        |lane: usize| lanes.get(lane).and_then(|case| Some((case, case.model.friction(i)?)));
    let all = |of: &dyn Fn(&PreparedCase, Friction) -> f64| {
        let found = |lane: usize| element(lane).map_or(0.0, |(case, (one, _))| of(case, one));
        C::new(simd, &found)
    };
    Slider {
        stuck: zero,
        limit: zero,
        normal: [zero; 3],
        work: Work::none(zero),
        stiffness: all(&|case, friction| {
            friction.stiffness() / (case.model.area(i) * case.tabulated.cells_per_metre(i))
        }),
        slip: all(&|case, friction| friction.limit(0.0) / case.model.area(i)),
        share: std::array::from_fn(|j| {
            C::new(simd, &|lane| match element(lane) {
                Some((case, (friction, contact))) if contact == j => {
                    friction.share_of_contact() * case.model.area(j) / case.model.area(i)
                }
                _ => 0.0,
            })
        }),
        rest: C::new(simd, &|lane| {
            let contact = lanes.get(lane).and_then(|case| case.model.contacts().get(i));
            contact.map_or(0.0, PreloadedContact::pressure)
        }),
    }
}

impl<'a, S: Simd, C: Coefficient<S>, const N: usize> Block<'a, S, C, N> {
    /// The cases of `lanes`, at most one per lane of two vectors, all of as many modes and
    /// interfaces.
    pub(in crate::modal) fn new(simd: S, lanes: &[&'a PreparedCase]) -> Self {
        let count = lanes.first().map_or(0, |lane| lane.tabulated.step_model.modes.len());
        let interfaces = lanes.first().map_or(0, |lane| lane.model.rows());
        let has_friction = lanes.iter().any(|case| case.model.preloaded().friction().is_some());
        let (rows, starts) = lay_out(lanes, interfaces);
        let zero = LanePair(simd).splat(0.0);
        let all = |of: &dyn Fn(&'a PreparedCase) -> f64| {
            C::new(simd, &|lane| lanes.get(lane).map_or(0.0, |&lane| of(lane)))
        };
        let at = |i: usize, of: &dyn Fn(&'a PreparedCase) -> f64| {
            if i < interfaces { all(of) } else { C::new(simd, &|_| 0.0) }
        };
        let cells = |lane: &PreparedCase, i: usize| lane.tabulated.cells_per_metre(i);
        let step = |m: usize, of: &dyn Fn(&ModeStep) -> f64| {
            all(&|lane| of(&lane.tabulated.step_model.modes[m]))
        };
        let mode = |m: usize| Mode {
            predicted: zero,
            predicted_increment: zero,
            carry: [zero; NODES - 1],
            increment: zero,
            decay: step(m, &|mode| mode.recurrence.decay),
            spring: step(m, &|mode| -mode.recurrence.spring),
            contact: std::array::from_fn(|k| step(m, &|mode| -mode.recurrence.contact[k])),
            sensor: all(&|lane| lane.tabulated.step_model.modes[m].sensors[lane.sensor]),
            closure: std::array::from_fn(|i| {
                at(i, &|lane| lane.tabulated.step_model.modes[m].closure[i] * cells(lane, i))
            }),
            force: std::array::from_fn(|i| {
                at(i, &|lane| lane.tabulated.step_model.modes[m].force[i])
            }),
            // The square of the mean velocity, and a twelfth of its change, over the step:
            // summed by parts, 7/6 increment^2 - 1/6 increment increment_before.
            loss: [7.0 / 6.0, -1.0 / 6.0].map(|share| {
                all(&|lane| {
                    let model = &lane.tabulated.step_model;
                    share * model.modes[m].dynamics.rate / model.step
                })
            }),
            load: std::array::from_fn(|k| step(m, &|mode| mode.load * mode.recurrence.load[k])),
            load_port: step(m, &|mode| mode.load),
            carries: lanes.iter().any(|lane| {
                lane.tabulated.step_model.modes[m].interpolation == ForceInterpolation::Quartic
            }),
        };
        let contact = |i: usize| {
            let start = |lane: usize| starts.get(i).and_then(|s| s.get(lane)).copied();
            Contact {
                predicted: zero,
                stiffness: zero,
                coupling: std::array::from_fn(|j| {
                    let entry = |lane: &PreparedCase| {
                        lane.tabulated.step_model.coupling[i][j] * cells(lane, i)
                    };
                    if j < interfaces { at(i, &entry) } else { C::new(simd, &|_| 0.0) }
                }),
                sensor: at(i, &|lane| {
                    lane.tabulated.step_model.sensors_per_pressure[lane.sensor][i]
                }),
                rest: at(i, &|lane| lane.tabulated.cell_at_rest(i)),
                first: at(i, &|lane| -lane.tabulated.cell_at_rest(i)),
                // The last place within the last cell.
                last: at(i, &|lane| {
                    let cells = lane.tabulated.cells(i).len() as f64;
                    cells - 1e-6 - lane.tabulated.cell_at_rest(i)
                }),
                whole: C::new(simd, &|lane| WHOLE + start(lane).unwrap_or(0) as f64),
                whole_at_rest: C::new(simd, &|lane| {
                    let rest = lanes.get(lane).map_or(0.0, |case| case.tabulated.cell_at_rest(i));
                    WHOLE + start(lane).unwrap_or(0) as f64 + rest
                }),
                tolerance: at(i, &|lane| {
                    let tolerance = lane.tabulated.tolerances[i];
                    if C::DISSIPATIVE { tolerance.min(DAMPED_TOLERANCE) } else { tolerance }
                }),
                load: at(i, &|lane| lane.tabulated.step_model.residual.load[i] * cells(lane, i)),
                load_port: at(i, &|lane| {
                    // By reciprocity the closure per load is also this.
                    lane.tabulated.step_model.residual.load[i] * lane.model.area(i)
                }),
            }
        };
        Self {
            dampers: (0..if C::DISSIPATIVE { N } else { 0 })
                .map(|i| damper(simd, lanes, i))
                .collect(),
            sliders: (0..if has_friction { N } else { 0 })
                .map(|i| slider(simd, lanes, i))
                .collect(),
            modes: (0..count).map(mode).collect(),
            contacts: std::array::from_fn(contact),
            factors: vec![[zero; N]; if N == 2 { 0 } else { interfaces }],
            coupled: interfaces,
            rows,
            sensor_per_load: all(&|lane| {
                lane.tabulated.step_model.residual.sensors_per_load[lane.sensor]
            }),
            load_port: all(&|lane| lane.tabulated.step_model.residual.load_port),
            load_before: [zero; 2],
            reading: zero,
            load_displacement: zero,
            work: zero,
            loss: zero,
            lanes: (0..2 * S::F64_LANES).map(|lane| lanes.get(lane).copied()).collect(),
        }
    }

    /// Fills the load of the steps from `start` on; whether there is any.
    #[inline(always)]
    pub(in crate::modal) fn take_load(
        &self,
        simd: S,
        loads: &mut [Load<[S::f64s; 2]>],
        start: usize,
    ) -> bool {
        // One step more: the taps reach back to the step before.
        let lasting = |lane: &&PreparedCase| start < lane.load.steps() + 1;
        if !self.lanes.iter().flatten().any(lasting) {
            return false;
        }
        let pair = LanePair(simd);
        let mut cases = self.lanes.iter().flatten();
        let Some(first) = cases.next() else { return false };
        let at = |column: &[f64], n: usize| column.get(start + n).copied().unwrap_or(0.0);
        if cases.all(|case| Arc::ptr_eq(&case.load, &first.load)) {
            // One column for all lanes, as in a sweep over the force.
            let amplitude =
                lane_vector(simd, |lane| self.lanes[lane].map_or(0.0, |case| case.amplitude));
            for (n, Load(load)) in loads.iter_mut().enumerate() {
                let column = &first.load;
                load[0] = pair.mul(amplitude, pair.splat(at(&column.mean, n)));
                load[1] = pair.mul(amplitude, pair.splat(at(&column.rise, n)));
                load[2] = pair.mul(amplitude, pair.splat(at(&column.end, n)));
            }
            return true;
        }
        for (n, Load(load)) in loads.iter_mut().enumerate() {
            for (lane, case) in self.lanes.iter().enumerate() {
                let Some(case) = case else { continue };
                let columns = [&case.load.mean, &case.load.rise, &case.load.end];
                for (numbers, column) in load.iter_mut().zip(columns) {
                    set_lane::<S>(numbers, lane, case.amplitude * at(column, n));
                }
            }
        }
        true
    }
}
