//! Lines, parabolas and linear least squares through samples.

use crate::sums::dot;

/// Vertex of the parabola through three equally spaced samples: its distance from the middle one,
/// in samples, and its value. `None` if the samples are on a straight line.
pub(crate) fn parabola_vertex([before, here, after]: [f64; 3]) -> Option<(f64, f64)> {
    let slope = 0.5 * (after - before);
    let curvature = (after - here) - (here - before);
    let shift = -slope / curvature;
    (curvature != 0.0).then_some((shift, here + 0.5 * slope * shift))
}

/// Slope and root mean square residual of the least-squares line through `(k, y_k)`.
pub(crate) fn fitted_line(values: &[f64]) -> (f64, f64) {
    let count = values.len() as f64;
    let centre = 0.5 * (count - 1.0);
    let mean = values.iter().sum::<f64>() / count;
    let (mut cross, mut square) = (0.0, 0.0);
    for (k, value) in values.iter().enumerate() {
        let x = k as f64 - centre;
        cross += x * (value - mean);
        square += x * x;
    }
    let slope = cross / square;
    let residual = |(k, value): (usize, &f64)| value - mean - slope * (k as f64 - centre);
    let sum: f64 = values.iter().enumerate().map(residual).map(|r| r * r).sum();
    (slope, (sum / count).sqrt())
}

/// Linear least squares in three parameters by modified Gram-Schmidt; `None` if degenerate.
pub(crate) fn least_squares(
    observations: impl Iterator<Item = ([f64; 3], f64)>,
) -> Option<[f64; 3]> {
    let (mut columns, mut right): ([Vec<f64>; 3], Vec<f64>) = Default::default();
    for (coefficients, value) in observations {
        for (column, x) in columns.iter_mut().zip(coefficients) {
            column.push(x);
        }
        right.push(value);
    }
    let mut upper = [[0.0; 3]; 3];
    let mut projected = [0.0; 3];
    for j in 0..3 {
        let before = dot(&columns[j], &columns[j]);
        for i in 0..j {
            let basis = columns[i].clone();
            upper[i][j] = dot(&basis, &columns[j]);
            columns[j].iter_mut().zip(&basis).for_each(|(x, q)| *x -= upper[i][j] * q);
        }
        let square = dot(&columns[j], &columns[j]);
        // The column depends linearly on those before it, within rounding.
        if square.is_nan() || square <= 1e-24 * before {
            return None;
        }
        upper[j][j] = square.sqrt();
        columns[j].iter_mut().for_each(|x| *x /= upper[j][j]);
        projected[j] = dot(&columns[j], &right);
        let basis = &columns[j];
        right.iter_mut().zip(basis).for_each(|(x, q)| *x -= projected[j] * q);
    }
    let mut parameters = [0.0; 3];
    for j in (0..3).rev() {
        let known: f64 = (j + 1..3).map(|k| upper[j][k] * parameters[k]).sum();
        parameters[j] = (projected[j] - known) / upper[j][j];
    }
    parameters.iter().all(|x| x.is_finite()).then_some(parameters)
}
