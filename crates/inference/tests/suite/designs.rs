//! Expected information against the closed forms of the linear normal model.

use asperity_inference::{DesignCandidate, InferenceError, design_sequence, expected_information};

use crate::models::assert_close;

fn candidate(name: &str, rows: &[[f64; 2]], deviation: f64) -> DesignCandidate {
    DesignCandidate {
        name: name.to_owned(),
        jacobian: rows.iter().map(|row| row.to_vec()).collect(),
        standard_deviations: vec![deviation; rows.len()],
    }
}

/// The inverse of a two-by-two matrix, written out.
fn inverse(m: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
    let determinant = m[0][0] * m[1][1] - m[0][1] * m[1][0];
    [
        [m[1][1] / determinant, -m[0][1] / determinant],
        [-m[1][0] / determinant, m[0][0] / determinant],
    ]
}

#[test]
fn gain_and_ratio_are_the_closed_forms() {
    let before = [[2.0, 0.6], [0.6, 0.5]];
    let rows = [[1.0, 0.5], [-0.3, 2.0]];
    let deviation = 0.7;
    let mut precision = inverse(before);
    for row in rows {
        for i in 0..2 {
            for j in 0..2 {
                precision[i][j] += row[i] * row[j] / (deviation * deviation);
            }
        }
    }
    let after = inverse(precision);
    let determinant = |m: [[f64; 2]; 2]| m[0][0] * m[1][1] - m[0][1] * m[1][0];
    let covariance: Vec<Vec<f64>> = before.iter().map(|row| row.to_vec()).collect();
    let targets = [vec![1.0, 0.0], vec![0.0, 1.0]];
    let gains = expected_information(&covariance, &[candidate("both", &rows, deviation)], &targets)
        .unwrap();
    let information = 0.5 * (determinant(before) / determinant(after)).ln();
    assert_close(gains[0].information, information, 1e-12, "information");
    let deviations = |m: [[f64; 2]; 2]| m[0][0].sqrt() + m[1][1].sqrt();
    assert_close(gains[0].target_ratio, deviations(after) / deviations(before), 1e-12, "ratio");
}

#[test]
fn a_sequence_turns_to_what_is_known_worst() {
    let covariance = vec![vec![4.0, 0.0], vec![0.0, 1.0]];
    let candidates =
        [candidate("first", &[[1.0, 0.0]], 1.0), candidate("second", &[[0.0, 1.0]], 1.0)];
    // Variances 4 -> 4/5 -> ...: the first parameter, then the second, whichever is larger.
    let sequence = design_sequence(&covariance, &candidates, &[], 3).unwrap();
    let order: Vec<usize> = sequence.iter().map(|gain| gain.candidate).collect();
    assert_eq!(order, [0, 1, 0]);
    assert_close(sequence[0].information, 0.5 * 5.0_f64.ln(), 1e-12, "first");
    assert_close(sequence[1].information, 0.5 * 2.0_f64.ln(), 1e-12, "second");
    assert_close(sequence[2].information, 0.5 * 1.8_f64.ln(), 1e-12, "third");
    // A target that only the second parameter moves asks for it from the start.
    let sequence = design_sequence(&covariance, &candidates, &[vec![0.0, 1.0]], 1).unwrap();
    assert_eq!(sequence[0].candidate, 1);
    assert_close(sequence[0].target_ratio, 0.5_f64.sqrt(), 1e-12, "ratio");

    let odd = expected_information(&covariance, &candidates, &[vec![1.0]]);
    assert!(matches!(odd, Err(InferenceError::Size { .. })));
}
