//! Designs: exact properties, uniformity, and the order at which the error of an integral falls.

use asperity_sampling::{Design, MOST_DIMENSIONS, SaltelliBlock};

fn column(design: &Design, j: usize) -> Vec<f64> {
    (0..design.rows()).map(|row| design.point(row)[j]).collect()
}

/// Numbers of points in `cells` equal intervals.
fn counts(values: &[f64], cells: usize) -> Vec<usize> {
    let mut counts = vec![0; cells];
    for value in values {
        assert!(*value > 0.0 && *value < 1.0);
        counts[(value * cells as f64) as usize] += 1;
    }
    counts
}

#[test]
fn larger_designs_begin_with_the_smaller_ones() {
    for design in [Design::random, Design::sobol, Design::saltelli] {
        let [small, large] = [10_000, 1_000_000].map(|rows| design(3, rows, 7).unwrap());
        for row in 0..small.rows() {
            assert_eq!(small.point(row), large.point(row));
        }
    }
}

#[test]
fn rows_depend_on_the_seed() {
    for design in [Design::random, Design::latin_hypercube, Design::sobol, Design::saltelli] {
        let [one, two] = [1, 2].map(|seed| design(2, 64, seed).unwrap());
        let same = (0..64).filter(|&row| one.point(row) == two.point(row)).count();
        assert_eq!(same, 0);
    }
}

#[test]
fn each_stratum_of_a_latin_hypercube_has_one_point() {
    for rows in [1, 2, 7, 100, 1000] {
        let design = Design::latin_hypercube(4, rows, 3).unwrap();
        for j in 0..4 {
            assert!(counts(&column(&design, j), rows as usize).iter().all(|&count| count == 1));
        }
    }
}

/// The first `2^m` points of the first two dimensions have one point in each elementary interval of
/// area `2^-m`, whatever its shape, and so have the next `2^m`.
#[test]
fn two_dimensions_of_a_sobol_sequence_are_a_perfect_net() {
    for seed in 0..4 {
        let design = Design::sobol(2, 1 << 11, seed).unwrap();
        for (m, start) in [(10, 0), (10, 1 << 10), (6, 0), (6, 64 * 5)] {
            for across in 0..=m {
                let (columns, lines) = (1_usize << across, 1_usize << (m - across));
                let mut counts = vec![0; columns * lines];
                for row in start..start + (1 << m) {
                    let point = design.point(row);
                    let cell = |x: f64, n: usize| (x * n as f64) as usize;
                    counts[cell(point[0], columns) * lines + cell(point[1], lines)] += 1;
                }
                assert!(counts.iter().all(|&count| count == 1), "{columns} by {lines} cells");
            }
        }
    }
}

#[test]
fn every_dimension_of_a_sobol_sequence_is_evenly_filled() {
    let design = Design::sobol(MOST_DIMENSIONS, 256, 11).unwrap();
    for j in 0..MOST_DIMENSIONS {
        assert!(counts(&column(&design, j), 256).iter().all(|&count| count == 1));
    }
}

/// Scrambling makes each single row uniform: over the seeds, the first row has the mean and the
/// variance of a uniform number, within five standard errors, and coordinates are uncorrelated.
#[test]
fn each_row_is_uniform_over_the_seeds() {
    const SEEDS: u64 = 20_000;
    for design in [Design::random, Design::latin_hypercube, Design::sobol] {
        for row in [0, 1, 5] {
            let of_seed = |seed| design(2, 8, seed).unwrap().point(row);
            let points: Vec<Vec<f64>> = (0..SEEDS).map(of_seed).collect();
            let mean = |f: &dyn Fn(&[f64]) -> f64| {
                points.iter().map(|point| f(point)).sum::<f64>() / SEEDS as f64
            };
            let error = 5.0 / (SEEDS as f64).sqrt();
            assert!((mean(&|x| x[0]) - 0.5).abs() < error * (1.0_f64 / 12.0).sqrt());
            assert!((mean(&|x| x[1].powi(2)) - 1.0 / 3.0).abs() < error * (4.0_f64 / 45.0).sqrt());
            assert!(mean(&|x| (x[0] - 0.5) * (x[1] - 0.5)).abs() < error / 12.0);
        }
    }
}

/// Slope of the logarithm of the root mean square error over 32 seeds of the mean of a product with
/// a known integral of 1, over the logarithm of the number of rows.
fn order(design: fn(usize, u64, u64) -> Design) -> f64 {
    const DIMENSIONS: usize = 6;
    const SEEDS: u64 = 32;
    let function = |x: Vec<f64>| -> f64 { x.iter().map(|x| 1.0 + 0.8 * (x - 0.5)).product() };
    let error = |rows: u64| {
        let of_seed = |seed| {
            let design = design(DIMENSIONS, rows, seed);
            let sum: f64 = (0..rows).map(|row| function(design.point(row))).sum();
            (sum / rows as f64 - 1.0).powi(2)
        };
        ((0..SEEDS).map(of_seed).sum::<f64>() / SEEDS as f64).sqrt()
    };
    let points: Vec<(f64, f64)> = (6..=13).map(|m| (f64::from(m), error(1 << m).log2())).collect();
    let n = points.len() as f64;
    let (x, y) =
        (points.iter().map(|p| p.0).sum::<f64>() / n, points.iter().map(|p| p.1).sum::<f64>() / n);
    let covariance: f64 = points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
    covariance / points.iter().map(|p| (p.0 - x).powi(2)).sum::<f64>()
}

#[test]
fn integrals_converge_at_their_order() {
    let random = order(|d, n, seed| Design::random(d, n, seed).unwrap());
    assert!((random + 0.5).abs() < 0.08, "random: {random}");
    let sobol = order(|d, n, seed| Design::sobol(d, n, seed).unwrap());
    assert!(sobol < -0.95, "Sobol: {sobol}");
}

/// A sum of functions of one input each: a Latin hypercube has their one-dimensional error.
#[test]
fn a_latin_hypercube_integrates_sums_far_better_than_random_rows() {
    let error = |design: &Design| {
        let f = |x: &[f64]| x[0].exp() + x[1].powi(2) + x[2];
        let rows = design.rows();
        let mean = (0..rows).map(|row| f(&design.point(row))).sum::<f64>() / rows as f64;
        (mean - (1.0_f64.exp() - 1.0 + 1.0 / 3.0 + 0.5)).abs()
    };
    for seed in 0..5 {
        // Strata of width 1/n: a standard error of |f'| / sqrt(12) n^-3/2, 1e-5 here.
        assert!(error(&Design::latin_hypercube(3, 1000, seed).unwrap()) < 1e-4);
    }
    assert!(error(&Design::random(3, 1000, 0).unwrap()) > 1e-3);
}

#[test]
fn a_grid_has_all_combinations() {
    let grid = Design::grid(vec![2, 3]).unwrap();
    let points: Vec<Vec<f64>> = (0..grid.rows()).map(|row| grid.point(row)).collect();
    let columns = [0.25, 0.75].into_iter().flat_map(|x| [1.0, 3.0, 5.0].map(|y| vec![x, y / 6.0]));
    assert_eq!(points, columns.collect::<Vec<_>>());
}

#[test]
fn saltelli_rows_exchange_one_coordinate() {
    let design = Design::saltelli(3, 8, 2).unwrap();
    assert_eq!(design.rows(), 40);
    for base in 0..8 {
        let point = |block| design.point(base * 5 + block);
        let (a, b) = (point(0), point(1));
        assert!((0..3).all(|j| a[j] != b[j]));
        for i in 0..3 {
            let row = base * 5 + 2 + i;
            let exchanged = design.point(row);
            assert_eq!(SaltelliBlock::of_row(row, 3), (base, SaltelliBlock::Exchanged(i as usize)));
            for j in 0..3 {
                assert_eq!(exchanged[j], if j as u64 == i { b[j] } else { a[j] });
            }
        }
    }
}
