//! Stiffnesses from a table of pressures against gaps.

use crate::error::{LawError, LawQuantity, above, at_least, increasing};

/// Fewest rows in contact.
const MIN_ROWS: usize = 3;

/// Points (pressure \[Pa\], stiffness \[Pa/m\]) of a [`Tabulated`](crate::Tabulated) law from rows
/// (closure \[m\], pressure \[Pa\]), such as a solver for the contact of rough surfaces computes.
///
/// ```text
/// K = dp/dd = p d(ln p)/dd
/// ```
///
/// with the derivative of the parabola through three neighbouring rows of ln p, which is exact for a
/// law `K = p / u0`. Closure is the negative of a gap. Closures and pressures increase strictly; rows
/// of zero pressure, from which only the loss of contact would follow, are left out. At least three
/// rows are in contact.
///
/// A tabulated law has constant stiffness below its first point and loses contact there.
///
/// # Errors
/// [`LawError`] if the rows are outside these limits or not finite.
///
/// # Example
/// ```
/// use asperity_law::{LawError, stiffness_from_gaps};
///
/// let rows: Vec<_> = (0..20).map(|i| 1e-7 * f64::from(i)).map(|d| (d, 1e4 * (d / 3e-7).exp())).collect();
/// for (pressure, stiffness) in stiffness_from_gaps(&rows)? {
///     assert!((stiffness / (pressure / 3e-7) - 1.0).abs() < 1e-12);
/// }
/// # Ok::<(), LawError>(())
/// ```
pub fn stiffness_from_gaps(rows: &[(f64, f64)]) -> Result<Vec<(f64, f64)>, LawError> {
    for row in rows {
        at_least(LawQuantity::Pressure, row.1, 0.0)?;
    }
    let open = rows.iter().take_while(|row| row.1 == 0.0).count();
    let rows = &rows[open..];
    at_least(LawQuantity::Points, rows.len() as f64, MIN_ROWS as f64)?;
    increasing(LawQuantity::Closure, rows.iter().map(|row| row.0))?;
    increasing(LawQuantity::Pressure, rows.iter().map(|row| row.1))?;
    let last = rows.len() - 1;
    let point = |row: usize| {
        let middle = row.clamp(1, last - 1);
        let secant = |at: usize| {
            let (start, stop) = (rows[at], rows[at + 1]);
            ((stop.1 - start.1) / start.1).ln_1p() / (stop.0 - start.0)
        };
        let (before, after) = (secant(middle - 1), secant(middle));
        let (left, right) =
            (rows[middle].0 - rows[middle - 1].0, rows[middle + 1].0 - rows[middle].0);
        let bend = (after - before) / (left + right);
        // The secants in the middle of their steps lie on the derivative of the parabola.
        let slope = before + bend * (left + 2.0 * (rows[row].0 - rows[middle].0));
        let slope = if slope > 0.0 {
            slope
        } else if row < middle {
            before
        } else {
            after
        };
        let pressure = rows[row].1;
        Ok((pressure, above(LawQuantity::Stiffness, pressure * slope, 0.0)?))
    };
    (0..=last).map(point).collect()
}
