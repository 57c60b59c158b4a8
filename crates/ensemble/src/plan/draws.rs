//! Weighted draws from a CSV file, such as `posterior.csv` of an identification.

use std::path::Path;

use asperity_design::WeightedDraws;
use asperity_scenario::{file_sha256, open_input};
use asperity_study::error::StudyError;

use crate::error::EnsembleError;
use crate::spec::DrawsSpec;

/// Most bytes of a file of draws.
const MOST_BYTES: u64 = 1 << 30;

/// The draws that `spec` asks for, and the SHA-256 of their file.
pub(crate) fn read_draws(
    folder: &Path,
    spec: &DrawsSpec,
) -> Result<(WeightedDraws, String), EnsembleError> {
    let path = folder.join(&spec.file);
    let input = |source| EnsembleError::from(StudyError::Input { path: path.clone(), source });
    let file = open_input(&path, MOST_BYTES).map_err(input)?;
    let sha256 = file_sha256(&path).map_err(input)?;
    let fault = |fault: String| EnsembleError::Part { place: "/draws".into(), fault };
    let text = |error: csv::Error| fault(format!("{}: {error}", path.display()));
    let mut reader = csv::Reader::from_reader(file);
    let header = reader.headers().map_err(text)?.clone();
    let place = |name: &str| header.iter().position(|column| column == name);
    let names: Vec<&str> = header.iter().collect();
    let mut wanted = Vec::new();
    for (pointer, name) in &spec.columns {
        let Some(at) = name.as_str().and_then(place) else {
            let accepted = names.join(", ");
            let found = format!("{pointer} has the column {name}; accepted: {accepted}");
            return Err(fault(found));
        };
        wanted.push(at);
    }
    let weight = place(&spec.weight);
    let (mut draws, mut weights) = (Vec::new(), Vec::new());
    for (number, row) in reader.records().enumerate() {
        let row = row.map_err(text)?;
        let number_at = |at: usize| {
            let field = row.get(at).unwrap_or_default();
            field
                .trim()
                .parse::<f64>()
                .map_err(|_| fault(format!("`{field}` in row {} is not a number", number + 1)))
        };
        draws.push(wanted.iter().map(|&at| number_at(at)).collect::<Result<Vec<_>, _>>()?);
        weights.push(weight.map_or(Ok(1.0), number_at)?);
    }
    let draws = WeightedDraws::new(&draws, &weights)
        .map_err(|source| EnsembleError::Design { place: "/draws".into(), source })?;
    Ok((draws, sha256))
}
