//! Correlation and weighted draws.

use asperity_sampling::{Correlation, Design, Distribution, InputSpace, WeightedDraws};

/// Correlation of two columns.
fn correlation(x: &[f64], y: &[f64]) -> f64 {
    let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
    let (mx, my) = (mean(x), mean(y));
    let product = |a: &[f64], ma: f64, b: &[f64], mb: f64| -> f64 {
        a.iter().zip(b).map(|(a, b)| (a - ma) * (b - mb)).sum()
    };
    product(x, mx, y, my) / (product(x, mx, x, mx) * product(y, my, y, my)).sqrt()
}

fn ranks(x: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..x.len()).collect();
    order.sort_by(|&a, &b| x[a].total_cmp(&x[b]));
    let mut ranks = vec![0.0; x.len()];
    for (rank, &at) in order.iter().enumerate() {
        ranks[at] = rank as f64;
    }
    ranks
}

fn columns(inputs: &InputSpace, rows: u64) -> Vec<Vec<f64>> {
    let design = Design::sobol(inputs.dimensions(), rows, 4).unwrap();
    let values: Vec<Vec<f64>> = (0..rows).map(|row| inputs.values(&design.point(row))).collect();
    (0..inputs.inputs()).map(|j| values.iter().map(|row| row[j]).collect()).collect()
}

#[test]
fn rank_correlation_is_recovered_and_distributions_are_kept() {
    let matrix = vec![vec![1.0, 0.7, -0.4], vec![0.7, 1.0, 0.1], vec![-0.4, 0.1, 1.0]];
    let distributions = vec![
        Distribution::lognormal(1e9, 0.8).unwrap(),
        Distribution::uniform(0.0, 1.0).unwrap(),
        Distribution::triangular(0.0, 0.2, 1.0).unwrap(),
    ];
    let correlated = Correlation::of_ranks(&matrix).unwrap();
    let inputs = InputSpace::new(distributions.clone(), Some(correlated), None).unwrap();
    assert!(inputs.is_correlated());
    let columns = columns(&inputs, 1 << 14);
    for i in 0..3 {
        for j in 0..i {
            let found = correlation(&ranks(&columns[i]), &ranks(&columns[j]));
            assert!((found - matrix[i][j]).abs() < 2e-3, "{i}, {j}: {found}");
        }
    }
    for (column, distribution) in columns.iter().zip(&distributions) {
        // Kolmogorov's distance of a scrambled net, far below the 1.36/sqrt(n) of random rows.
        let mut sorted = column.clone();
        sorted.sort_by(f64::total_cmp);
        let n = sorted.len() as f64;
        let distance =
            |(k, x): (usize, &f64)| (distribution.cumulative(*x) - (k as f64 + 0.5) / n).abs();
        let worst = sorted.iter().enumerate().map(distance).fold(0.0, f64::max);
        assert!(worst < 3e-3, "{worst}");
    }
}

#[test]
fn correlation_of_normal_inputs_is_that_of_their_scores() {
    let matrix = vec![vec![1.0, -0.9], vec![-0.9, 1.0]];
    let distributions =
        vec![Distribution::normal(5.0, 2.0).unwrap(), Distribution::normal(0.0, 1e-3).unwrap()];
    let correlated = Correlation::of_scores(&matrix).unwrap();
    let columns =
        columns(&InputSpace::new(distributions, Some(correlated), None).unwrap(), 1 << 14);
    let found = correlation(&columns[0], &columns[1]);
    assert!((found + 0.9).abs() < 1e-3, "{found}");
}

#[test]
fn draws_are_selected_in_proportion_to_their_weights() {
    let draws = [vec![1.0, 10.0], vec![2.0, 20.0], vec![3.0, 30.0], vec![4.0, 40.0]];
    let draws = WeightedDraws::new(&draws, &[0.0, 1.0, 3.0, 0.0]).unwrap();
    assert_eq!((draws.count(), draws.columns()), (4, 2));
    let inputs = InputSpace::new(Vec::new(), None, Some(draws)).unwrap();
    let columns = columns(&inputs, 1024);
    let share = |value: f64| columns[0].iter().filter(|&&x| x == value).count();
    assert_eq!([1.0, 2.0, 3.0, 4.0].map(share), [0, 256, 768, 0]);
    assert!(columns[0].iter().zip(&columns[1]).all(|(x, y)| *y == 10.0 * x));
    assert_eq!(inputs.values(&[1.0 - f64::EPSILON]), [3.0, 30.0]);
    assert_eq!(inputs.values(&[f64::EPSILON]), [2.0, 20.0]);
}
