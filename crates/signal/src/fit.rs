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

/// Extremum of the quartic through five equally spaced samples next to the vertex of the parabola
/// through the middle three: its distance from the middle one, in samples, and its value. `None`
/// without a vertex, or if the quartic has no extremum within a sample of the middle one.
pub(crate) fn quartic_vertex([y0, y1, y2, y3, y4]: [f64; 5]) -> Option<(f64, f64)> {
    let (inner, outer) = (y3 - y1, y4 - y0);
    let (inner_rise, outer_rise) = ((y3 - y2) - (y2 - y1), (y4 - y2) - (y2 - y0));
    let a1 = (8.0 * inner - outer) / 12.0;
    let a2 = (16.0 * inner_rise - outer_rise) / 24.0;
    let a3 = (outer - 2.0 * inner) / 12.0;
    let a4 = (outer_rise - 4.0 * inner_rise) / 24.0;
    let (mut x, _) = parabola_vertex([y1, y2, y3])?;
    // Newton's method squares an error of about a hundredth of a sample in each step.
    for _ in 0..4 {
        let slope = a1 + x * (2.0 * a2 + x * (3.0 * a3 + x * 4.0 * a4));
        let curvature = 2.0 * a2 + x * (6.0 * a3 + x * 12.0 * a4);
        x -= slope / curvature;
    }
    (x.abs() <= 1.0).then_some((x, y2 + x * (a1 + x * (a2 + x * (a3 + x * a4)))))
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

/// Columns made orthogonal under weights, in order, each with its weighted sum of squares. Columns that depend on
/// those before are left out.
pub(crate) fn orthogonal(
    columns: impl Iterator<Item = Vec<f64>>,
    weights: &[f64],
) -> Vec<(Vec<f64>, f64)> {
    let sum = |a: &[f64], b: &[f64]| -> f64 {
        a.iter().zip(b).zip(weights).map(|((a, b), weight)| a * b * weight).sum()
    };
    let mut basis: Vec<(Vec<f64>, f64)> = Vec::new();
    for mut own in columns {
        let whole = sum(&own, &own);
        // Twice, as rounding leaves a part of nearly dependent columns.
        for (other, square) in basis.iter().chain(&basis) {
            let share = sum(&own, other) / square;
            own.iter_mut().zip(other).for_each(|(a, b)| *a -= share * b);
        }
        let square = sum(&own, &own);
        if square > 1e-20 * whole {
            basis.push((own, square));
        }
    }
    basis
}

/// Linear least squares in `N` parameters; `None` if degenerate.
pub(crate) fn least_squares<const N: usize>(
    observations: impl Iterator<Item = ([f64; N], f64)>,
) -> Option<[f64; N]> {
    let (rows, right): (Vec<[f64; N]>, Vec<f64>) = observations.unzip();
    let parameters = OrthogonalColumns::of(&rows)?.solve(right);
    parameters.iter().all(|x| x.is_finite()).then_some(parameters)
}

/// Derivatives of the parameters of [`least_squares`] with respect to each right side.
pub(crate) fn pseudo_inverse<const N: usize>(rows: &[[f64; N]]) -> Option<Vec<[f64; N]>> {
    let factors = OrthogonalColumns::of(rows)?;
    let column =
        |row: usize| factors.back_substituted(factors.columns.each_ref().map(|column| column[row]));
    Some((0..rows.len()).map(column).collect())
}

/// Orthonormal columns and the upper triangle, by modified Gram-Schmidt.
struct OrthogonalColumns<const N: usize> {
    columns: [Vec<f64>; N],
    upper: [[f64; N]; N],
}

impl<const N: usize> OrthogonalColumns<N> {
    fn of(rows: &[[f64; N]]) -> Option<Self> {
        let mut columns: [Vec<f64>; N] =
            std::array::from_fn(|j| rows.iter().map(|row| row[j]).collect());
        let mut upper = [[0.0; N]; N];
        for j in 0..N {
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
        }
        Some(Self { columns, upper })
    }

    fn solve(&self, mut right: Vec<f64>) -> [f64; N] {
        let mut projected = [0.0; N];
        for (basis, projected) in self.columns.iter().zip(&mut projected) {
            *projected = dot(basis, &right);
            right.iter_mut().zip(basis).for_each(|(x, q)| *x -= *projected * q);
        }
        self.back_substituted(projected)
    }

    fn back_substituted(&self, projected: [f64; N]) -> [f64; N] {
        let mut parameters = [0.0; N];
        for j in (0..N).rev() {
            let known: f64 = (j + 1..N).map(|k| self.upper[j][k] * parameters[k]).sum();
            parameters[j] = (projected[j] - known) / self.upper[j][j];
        }
        parameters
    }
}
