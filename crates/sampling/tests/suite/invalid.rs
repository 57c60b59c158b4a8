//! Inputs that are refused, and in which words.

use asperity_sampling::{
    Correlation, Design, DesignError, Distribution, InputSpace, MOST_DIMENSIONS, WeightedDraws,
};

#[test]
fn distributions_state_the_fault() {
    let refused: [(Result<Distribution, DesignError>, &str); 9] = [
        (Distribution::uniform(1.0, 1.0), "the upper end minus the lower one of a uniform"),
        (Distribution::uniform(-f64::MAX, f64::MAX), "is inf; it must be positive and finite"),
        (Distribution::log_uniform(0.0, 1.0), "the lower end of a log-uniform distribution is 0"),
        (Distribution::normal(f64::NAN, 1.0), "the mean of a normal distribution is NaN"),
        (Distribution::normal(0.0, 0.0), "the standard deviation of a normal distribution is 0"),
        (Distribution::lognormal(-1.0, 1.0), "the median of a lognormal distribution is -1"),
        (Distribution::triangular(0.0, 2.0, 1.0), "the mode of a triangular distribution is 2"),
        (Distribution::choice(&[]), "the number of options of a choice distribution is 0"),
        (Distribution::choice(&[1.0, 0.0]), "a weight of a choice distribution is 0"),
    ];
    for (result, words) in refused {
        let text = result.unwrap_err().to_string();
        assert!(text.contains(words), "{text}");
    }
}

#[test]
fn correlations_state_the_fault() {
    let refused: [(&[&[f64]], &str); 6] = [
        (&[], "is empty"),
        (&[&[1.0, 0.5]], "has 2 numbers in row 1; expected 1"),
        (&[&[2.0]], "is 2 in row 1, column 1; the diagonal must be 1"),
        (&[&[1.0, 1.5], &[1.5, 1.0]], "is 1.5 in row 1, column 2; accepted: -1 to 1"),
        (&[&[1.0, 0.5], &[0.4, 1.0]], "is not symmetric: row 1, column 2"),
        (
            &[&[1.0, 0.9, -0.9], &[0.9, 1.0, 0.9], &[-0.9, 0.9, 1.0]],
            "is not positive definite: input 3",
        ),
    ];
    for (matrix, words) in refused {
        let matrix: Vec<Vec<f64>> = matrix.iter().map(|row| row.to_vec()).collect();
        for read in [Correlation::of_scores, Correlation::of_ranks] {
            let text = read(&matrix).unwrap_err().to_string();
            assert!(text.contains(words), "{text}");
        }
    }
}

#[test]
fn draws_state_the_fault() {
    let two = [vec![1.0], vec![2.0]];
    let refused = [
        (&[] as &[Vec<f64>], &[] as &[f64], "are empty"),
        (&two, &[1.0], "have 1 weights; expected 2"),
        (&[vec![1.0], vec![1.0, 2.0]], &[1.0, 1.0], "have 2 numbers in row 2; expected 1"),
        (&[vec![1.0], vec![f64::NAN]], &[1.0, 1.0], "have the number NaN in row 2"),
        (&two, &[1.0, -1.0], "have the weight -1 in row 2"),
        (&two, &[0.0, 0.0], "have weights with the sum 0"),
    ];
    for (draws, weights, words) in refused {
        let text = WeightedDraws::new(draws, weights).unwrap_err().to_string();
        assert!(text.contains(words), "{text}");
    }
}

#[test]
fn sizes_state_what_is_accepted() {
    assert!(Design::random(3, 0, 1).is_err());
    assert!(Design::random(0, 3, 1).is_err());
    assert!(Design::grid(vec![]).is_err());
    assert!(Design::grid(vec![3, 0]).is_err());
    assert!(Design::grid(vec![1 << 20, 1 << 20]).is_err());
    let text = Design::sobol(MOST_DIMENSIONS + 1, 8, 1).unwrap_err().to_string();
    assert_eq!(text, "the number of coordinates is 129; accepted: 1 to 128");
    assert!(Design::saltelli(MOST_DIMENSIONS / 2 + 1, 8, 1).is_err());
    assert!(Design::saltelli(8, 1 << 30, 1).is_err());
    assert!(InputSpace::independent(vec![]).is_err());
    let one = Correlation::of_ranks(&[vec![1.0]]).unwrap();
    let two = vec![Distribution::uniform(0.0, 1.0).unwrap(); 2];
    let text = InputSpace::new(two, Some(one), None).unwrap_err().to_string();
    assert_eq!(text, "the correlation matrix has 1 rows; expected 2, one for each distribution");
}
