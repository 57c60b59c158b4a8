//! Tables of the book against those the example prints.

use crate::tables::tables;

/// Verified against the page of the book, line by line: to one in the last digit printed
/// (mathematical libraries differ in their last bits). Skipped without the book, as in a published
/// crate.
#[test]
fn the_table_of_bias_and_spread_is_that_of_the_book() {
    let page = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/src/explanation/estimators.md");
    let Ok(page) = std::fs::read_to_string(page) else {
        eprintln!("skipped the_table_of_bias_and_spread_is_that_of_the_book: no book here");
        return;
    };
    let rows = |text: &str| -> Vec<String> {
        text.lines().filter(|line| line.starts_with('|')).map(str::to_owned).collect()
    };
    // The tables of the example `calibration` follow a bold heading each.
    let own: Vec<&str> =
        page.split("\n\n").filter(|part| !part.starts_with("| quantity")).collect();
    let (printed, written) = (rows(&tables()), rows(&own.join("\n\n")));
    assert_eq!(printed.len(), written.len(), "rows of tables");
    for (printed, written) in printed.iter().zip(&written) {
        let agree = printed.split(' ').count() == written.split(' ').count()
            && printed.split(' ').zip(written.split(' ')).all(|(a, b)| same(a, b));
        assert!(agree, "the book says\n{written}\nand the example\n{printed}");
    }
}

/// Equal words, or numbers within one of the last digit; below 0.001 a zero is printed.
fn same(a: &str, b: &str) -> bool {
    let digits = |word: &str| word.split_once('.').map_or(0, |(_, digits)| digits.len());
    match (a.parse::<f64>(), b.parse::<f64>()) {
        (Ok(x), Ok(y)) if digits(a) + digits(b) > 0 => {
            let last = 0.1_f64.powf(digits(a).max(digits(b)) as f64);
            (x - y).abs() < 1.001 * last
        }
        _ => a == b,
    }
}

/// Verified against differing numbers, counts, names and digits.
#[test]
fn differing_rows_are_detected() {
    assert!(same("0.017", "0.018") && same("0", "0.001") && same("f1", "f1"));
    assert!(!same("0.017", "0.019") && !same("0", "0.002"));
    assert!(!same("(186", "(187") && !same("186", "187") && !same("H1", "H2"));
}
