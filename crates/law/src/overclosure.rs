//! Pressure-overclosure tables: a law as straight segments, for finite-element codes.

mod row_density;

use crate::contact_law::{ContactLaw, Pressure};
use crate::error::{LawError, LawQuantity, above, at_least};
use row_density::RowDensity;

/// Pressure at rest below which a table need not be accurate, as a share of the pressure at rest.
const WORKING_SHARE: f64 = 0.3;

/// The same share of the top pressure for a table without a pressure at rest.
const WORKING_SHARE_OF_TOP: f64 = 0.01;

/// Lowest pressure of the table of a law that never separates, as a share of the lowest working
/// pressure.
const LOWEST_SHARE: f64 = 0.01;

/// Pressure from which the rows are dense, as a share of the lowest working pressure: the wider segment
/// below it ends before the working pressures begin.
const DENSE_SHARE: f64 = 0.8;

/// Halvings of the segment at rest until the rows about it increase.
const HALVINGS: i32 = 40;

/// Places in a segment at which its errors are sampled, both ends included.
const SAMPLES: usize = 9;

/// A law as a table of rows joined by straight lines,
///
/// ```text
/// p(o) = p_i + (p_(i+1) - p_i) (o - o_i) / (o_(i+1) - o_i),    o = d - d_first.
/// ```
///
/// The overclosure `o` counts from the first row, which has zero pressure. The rows lie on the law,
/// closer where its curvature is greater, but for two: the segment about the pressure at rest is the
/// tangent of the law there, so that closure and stiffness at rest are exact. A table for two contacts
/// with different pressures at rest cannot be exact for both: each contact needs its own.
///
/// A law that never separates begins with its tangent at a small pressure; a law that carries
/// tension is cut at zero pressure; a law of constant stiffness has two rows.
///
/// # Example
/// ```
/// use asperity_law::{BeyondTable, ContactLaw, LawError, OverclosureTable, Power};
///
/// let law = Power::new(1.81e10, 0.35, 0.0)?;
/// let table = OverclosureTable::new(&law, Some(1.4e5), 1e6, 200)?;
/// let at_rest = table.pressure(law.closure(1.4e5), BeyondTable::PressureHeld);
/// assert!((at_rest.value / 1.4e5 - 1.0).abs() < 1e-12);
/// assert!((at_rest.tangent / law.stiffness(1.4e5) - 1.0).abs() < 1e-9);
/// assert!(table.accuracy(&law).closure_error < 2e-5);
/// # Ok::<(), LawError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct OverclosureTable {
    rows: Vec<OverclosureRow>,
    first_closure: f64,
    working_pressure: f64,
}

/// A row of an [`OverclosureTable`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OverclosureRow {
    /// Pressure \[Pa\].
    pub pressure: f64,
    /// Overclosure \[m\], the closure from that of the first row.
    pub overclosure: f64,
}

/// The pressure beyond the last row of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum BeyondTable {
    /// The last pressure, with zero tangent.
    PressureHeld,
    /// The last segment continues.
    SlopeHeld,
}

/// Errors that the straight segments cause, between the lowest working pressure and the top.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct TableAccuracy {
    /// Lowest pressure \[Pa\] at which the errors were sampled.
    pub pressure_min: f64,
    /// Largest relative difference of the tangent from the stiffness of the law.
    pub tangent_error: f64,
    /// Pressure \[Pa\] of that difference.
    pub tangent_error_pressure: f64,
    /// Largest relative difference of the overclosure at a pressure.
    pub closure_error: f64,
}

impl OverclosureTable {
    /// Fewest rows of a table.
    pub const MIN_ROWS: usize = 16;

    /// The table of at most `rows` rows, at least [`MIN_ROWS`](Self::MIN_ROWS), from zero pressure to
    /// `top` \[Pa\], exact at the pressure `at_rest` \[Pa\] if there is one.
    ///
    /// The errors are smallest above the lowest working pressure, 0.3 of the pressure at rest or,
    /// without one, a hundredth of the top.
    ///
    /// # Errors
    /// [`LawError`] unless 0 < `at_rest` < `top`, all finite, or if the closure or the stiffness at
    /// the top is not finite.
    pub fn new(
        law: &dyn ContactLaw,
        at_rest: Option<f64>,
        top: f64,
        rows: usize,
    ) -> Result<Self, LawError> {
        at_least(LawQuantity::Rows, rows as f64, Self::MIN_ROWS as f64)?;
        above(LawQuantity::PressureTop, top, 0.0)?;
        if let Some(pressure) = at_rest {
            above(LawQuantity::PressureState, pressure, 0.0)?;
            above(LawQuantity::PressureTop, top, pressure)?;
        }
        above(LawQuantity::Stiffness, law.stiffness(top), 0.0)?;
        let working_pressure =
            at_rest.map_or(WORKING_SHARE_OF_TOP * top, |pressure| WORKING_SHARE * pressure);
        let domain = law.domain();
        let low = if domain.separates() || domain.is_bilateral() {
            0.0
        } else {
            LOWEST_SHARE * working_pressure
        };
        let first_closure =
            if low > 0.0 { law.closure(low) - low / law.stiffness(low) } else { law.closure(0.0) };
        let overclosure = |pressure: f64| law.closure(pressure) - first_closure;
        let on_law =
            |pressure: f64| OverclosureRow { pressure, overclosure: overclosure(pressure) };
        let dense_from = DENSE_SHARE * working_pressure;
        let density = RowDensity::new(law, &overclosure, [low, dense_from, top]);
        // A law that never separates has one more row, at zero pressure.
        let segments = rows - 1 - usize::from(low > 0.0);
        let rows = match at_rest {
            _ if density.is_straight() => vec![on_law(low), on_law(top)],
            Some(pressure) => {
                let (closure, stiffness) = (overclosure(pressure), law.stiffness(pressure));
                let tangent = |at: f64| OverclosureRow {
                    pressure: at,
                    overclosure: closure + (at - pressure) / stiffness,
                };
                let about = |halvings: i32| {
                    let [below, above] = density.around(pressure, segments, 0.5_f64.powi(halvings));
                    let share =
                        density.share(below) / (density.share(below) + 1.0 - density.share(above));
                    let left = ((segments - 1) as f64 * share).round() as usize;
                    let left = left.clamp(1, segments - 2);
                    let left_part = density.pressures(low, below, left);
                    let right_part = density.pressures(above, top, segments - 1 - left);
                    let mut rows: Vec<_> = left_part[..left].iter().map(|&p| on_law(p)).collect();
                    rows.extend([tangent(below), tangent(above)]);
                    rows.extend(right_part[1..].iter().map(|&p| on_law(p)));
                    rows
                };
                let found = (0..HALVINGS).map(about).find(|rows| increasing(rows));
                found.unwrap_or_else(|| about(HALVINGS))
            }
            None => density.pressures(low, top, segments).into_iter().map(on_law).collect(),
        };
        let zero = (low > 0.0).then_some(OverclosureRow { pressure: 0.0, overclosure: 0.0 });
        let rows = zero.into_iter().chain(rows).collect();
        Ok(Self { rows, first_closure, working_pressure })
    }

    /// The rows; pressure and overclosure increase.
    pub fn rows(&self) -> &[OverclosureRow] {
        &self.rows
    }

    /// Closure \[m\] of the law at zero overclosure.
    pub fn first_closure(&self) -> f64 {
        self.first_closure
    }

    /// Pressure \[Pa\] and tangent \[Pa/m\] of the table at `closure` \[m\] of the law; zero below the
    /// first row.
    pub fn pressure(&self, closure: f64, beyond: BeyondTable) -> Pressure {
        let overclosure = closure - self.first_closure;
        if overclosure < 0.0 {
            return Pressure::OPEN;
        }
        let after = self.rows.partition_point(|row| row.overclosure <= overclosure);
        if after == self.rows.len() && beyond == BeyondTable::PressureHeld {
            return Pressure { value: self.rows[after - 1].pressure, tangent: 0.0 };
        }
        let right = after.min(self.rows.len() - 1);
        let (start, tangent) = (self.rows[right - 1], self.tangent(right - 1));
        let value = start.pressure + tangent * (overclosure - start.overclosure);
        Pressure { value, tangent }
    }

    /// Errors of the table against its `law`, sampled in each segment, the limits at its ends
    /// included.
    pub fn accuracy(&self, law: &dyn ContactLaw) -> TableAccuracy {
        let mut found = TableAccuracy {
            pressure_min: self.working_pressure,
            tangent_error: 0.0,
            tangent_error_pressure: self.working_pressure,
            closure_error: 0.0,
        };
        for (index, pair) in self.rows.windows(2).enumerate() {
            let (start, tangent) = (pair[0], self.tangent(index));
            let low = start.pressure.max(self.working_pressure);
            if low > pair[1].pressure {
                continue;
            }
            for sample in 0..SAMPLES {
                let share = sample as f64 / (SAMPLES - 1) as f64;
                let pressure = low + share * (pair[1].pressure - low);
                let tangent_error = (tangent / law.stiffness(pressure) - 1.0).abs();
                if tangent_error > found.tangent_error {
                    (found.tangent_error, found.tangent_error_pressure) = (tangent_error, pressure);
                }
                let exact = law.closure(pressure) - self.first_closure;
                let table = start.overclosure + (pressure - start.pressure) / tangent;
                found.closure_error = found.closure_error.max((table / exact - 1.0).abs());
            }
        }
        found
    }

    /// Slope of the segment that begins at a row \[Pa/m\].
    fn tangent(&self, row: usize) -> f64 {
        let (start, stop) = (self.rows[row], self.rows[row + 1]);
        (stop.pressure - start.pressure) / (stop.overclosure - start.overclosure)
    }
}

fn increasing(rows: &[OverclosureRow]) -> bool {
    rows.windows(2).all(|pair| {
        pair[0].pressure < pair[1].pressure && pair[0].overclosure < pair[1].overclosure
    })
}
