//! Universal files of displacements on meshes, for programs of modal analysis.

use std::fmt::Write as _;

use asperity_matrices::Deck;

/// Displacements of the nodes of a mesh, ascending, as a dataset 55 of an analysis.
#[derive(Debug)]
pub(super) struct UniversalField<'a> {
    pub(super) name: String,
    pub(super) analysis: Analysis,
    pub(super) displacements: &'a [[f64; 3]],
}

/// Analysis of a field.
#[derive(Debug, Clone, Copy)]
pub(super) enum Analysis {
    /// Static, load case 1.
    Static,
    /// Normal mode of modal mass 1, with its number, frequency \[Hz\] and damping ratio.
    Mode(i64, f64, f64),
    /// Step of a response, with its number and time \[s\].
    Transient(i64, f64),
}

impl Analysis {
    /// Code, specific whole numbers and specific numbers.
    fn records(self) -> (i64, Vec<i64>, Vec<f64>) {
        match self {
            Self::Static => (1, vec![1, 1, 1], vec![0.0]),
            Self::Mode(number, frequency, ratio) => {
                (2, vec![2, 4, 1, number], vec![frequency, 1.0, ratio, 0.0])
            }
            Self::Transient(number, time) => (4, vec![2, 1, 1, number], vec![time]),
        }
    }
}

/// A universal file of the body `name`: units (dataset 164), nodes (2411), lines along the edges of free faces (82), and
/// each field (55).
pub(super) fn universal_file(name: &str, deck: &Deck, fields: &[UniversalField<'_>]) -> String {
    let mut text = String::new();
    push_line(&mut text, "    -1\n   164");
    push_line(&mut text, &format!("{:>10}{:<20}{:>10}", 1, "SI: m, N, s", 2));
    let (one, zero) = (exponent(1.0, 25, 17), exponent(0.0, 25, 17));
    push_line(&mut text, &format!("{one}{one}{one}\n{zero}"));
    push_line(&mut text, "    -1\n    -1\n  2411");
    for (node, place) in deck.nodes().iter() {
        push_line(&mut text, &integers(&[node, 1, 1, 11]));
        push_line(&mut text, &place.map(|x| exponent(x, 25, 16)).concat());
    }
    push_line(&mut text, "    -1");
    let edges: Vec<[i64; 2]> = deck.free_edges();
    for (number, edges) in (1_usize..).zip(edges.chunks(EDGES_OF_LINE)) {
        push_line(&mut text, "    -1\n    82");
        // Zero lifts the pen.
        let nodes: Vec<i64> = edges.iter().flat_map(|&[a, b]| [a, b, 0]).collect();
        push_line(&mut text, &format!("{number:>10}{:>10}{:>10}", nodes.len(), 8));
        push_line(&mut text, &header(name));
        for nodes in nodes.chunks(8) {
            push_line(&mut text, &integers(nodes));
        }
        push_line(&mut text, "    -1");
    }
    for field in fields {
        let (analysis, whole, numbers) = field.analysis.records();
        push_line(&mut text, "    -1\n    55");
        push_line(&mut text, &format!("{}\n{}\nNONE\nNONE\nNONE", header(name), field.name));
        // Structural, three translations, displacement, real, three numbers a node.
        push_line(&mut text, &integers(&[1, analysis, 2, 8, 2, 3]));
        push_line(&mut text, &integers(&whole));
        push_line(&mut text, &numbers.iter().map(|x| exponent(*x, 13, 5)).collect::<String>());
        for (node, displacement) in deck.nodes().numbers().zip(field.displacements) {
            push_line(&mut text, &integers(&[node]));
            push_line(&mut text, &displacement.map(|x| exponent(x, 13, 5)).concat());
        }
        push_line(&mut text, "    -1");
    }
    text
}

/// Edges of a trace line, which has at most 250 entries.
const EDGES_OF_LINE: usize = 83;

fn push_line(text: &mut String, content: &str) {
    text.push_str(content);
    text.push('\n');
}

/// Whole numbers in ten characters each.
fn integers(numbers: &[i64]) -> String {
    let mut text = String::new();
    for number in numbers {
        let _ = write!(text, "{number:>10}");
    }
    text
}

/// A header line: at most 80 characters.
fn header(text: &str) -> String {
    text.chars().take(80).collect()
}

/// A number in `width` characters, with `digits` digits after the point and two of the exponent at least.
fn exponent(value: f64, width: usize, digits: usize) -> String {
    let text = format!("{value:.digits$e}");
    let (mantissa, power) = text.split_once('e').unwrap_or((&text, "0"));
    let (sign, power) = match power.strip_prefix('-') {
        Some(power) => ('-', power),
        None => ('+', power),
    };
    let text = format!("{mantissa}E{sign}{power:0>2}");
    format!("{text:>width$}")
}
