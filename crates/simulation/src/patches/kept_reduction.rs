//! Reductions kept on disk beside the scenario, under what they depend on.
//!
//! The shapes of the modes at all rows, which few need, are a file beside it.
//!
//! A kept reduction is a file of little-endian numbers: a mark, the number of bodies, of each the numbers of modes and
//! ports, angular frequencies, participations and residual flexibility, and a check sum. A file that is not
//! whole is made again.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use asperity_matrices::Dof;
use asperity_mesh::{ReducedBody, ResidualFlexibility, RowShapes};
use asperity_scenario::{PatchSpec, StaticLoadSpec, StructureScenario, text_sha256};
use faer::Mat;
use serde_json::json;

use crate::error::SimulationError;

/// Folder of kept reductions, in the folder of the scenario.
pub const FOLDER: &str = ".asperity-reductions";

/// Files of kept reductions and shapes of a folder; the oldest are removed.
const MOST_KEPT: usize = 40;

const MARK: &[u8; 8] = b"asprrd03";
const SHAPES_MARK: &[u8; 8] = b"asprsh03";

/// Name of the file of a reduction in a folder, from all that the reduction depends on.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ReductionKey(String);

impl ReductionKey {
    /// The key of the bodies of `scenario` with their ports: of its bodies with what is held, cells, places and the patterns of its loads,
    /// whose size does not count, as that of gravity does not, and of all files named there, with their sizes and times of change.
    ///
    /// # Errors
    /// [`SimulationError::Input`] for a file that cannot be read.
    pub fn new(folder: &Path, scenario: &StructureScenario) -> Result<Self, SimulationError> {
        let StructureScenario { bodies, gravity_m_per_s2, loads, interfaces, .. } = scenario;
        let unit = |load: &StaticLoadSpec| StaticLoadSpec {
            force_n: load.force_n.map(|_| 1.0),
            factor: None,
            ..load.clone()
        };
        let cells: Vec<_> = interfaces
            .iter()
            .map(|PatchSpec { body, cells, array, above, below, split, along, area_m2, .. }| {
                json!([body, cells, array, above, below, split, along, area_m2.is_some()])
            })
            .collect();
        let places: Vec<_> = scenario.sensors.iter().map(|sensor| &sensor.at).collect();
        let springs: Vec<_> = scenario.springs.iter().map(|one| (&one.from, &one.to)).collect();
        let parts = json!({
            "version": env!("CARGO_PKG_VERSION"),
            "bodies": bodies,
            "gravity": gravity_m_per_s2.map(|g| g != 0.0),
            "loads": loads.iter().map(unit).collect::<Vec<_>>(),
            "cells": cells,
            "springs": springs,
            "held": scenario.held,
            "load": scenario.excitation.at(),
            "base": scenario.excitation.base_direction(),
            "sensors": places,
        });
        let mut text = parts.to_string();
        for file in scenario.files() {
            let path = folder.join(file);
            let read = fs::metadata(&path).map_err(|source| SimulationError::Input {
                path: path.clone(),
                source: source.into(),
            })?;
            let changed = read.modified().ok().and_then(|time| {
                time.duration_since(std::time::UNIX_EPOCH).ok().map(|since| since.as_nanos())
            });
            let _ = write!(text, "\n{file} {} {changed:?}", read.len());
        }
        Ok(Self(text_sha256(&text)))
    }
}

/// True if there is a file of the kept reductions of `key` beside the scenario in `folder`.
pub(super) fn exists(folder: &Path, key: &ReductionKey) -> bool {
    folder.join(FOLDER).join(&key.0).is_file()
}

/// The kept reductions of `key` beside the scenario in `folder`, if there are.
pub fn find(folder: &Path, key: &ReductionKey) -> Option<Vec<ReducedBody>> {
    decoded(&fs::read(folder.join(FOLDER).join(&key.0)).ok()?)
}

/// Keeps `reductions` beside the scenario in `folder`, where it can be written to.
pub fn keep(folder: &Path, key: &ReductionKey, reductions: &[ReducedBody]) {
    if let Err(error) = write(&folder.join(FOLDER).join(&key.0), &encoded(reductions)) {
        tracing::info!("the reduction is not kept: {error}");
    }
}

/// Shapes of the modes kept of a body at its rows.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyShapes {
    /// The degree of freedom of each row.
    pub dofs: Vec<Dof>,
    /// Shapes \[kg^-1/2\]: rows by modes.
    pub shapes: Mat<f64>,
    /// Displacements of the modes left out per static force at each port of the body \[m/N\]: rows by ports. Without
    /// columns where there would be too many numbers.
    pub flexible: Mat<f64>,
}

/// Most numbers of the flexible shapes of a body that are kept.
const MOST_FLEXIBLE: usize = 20_000_000;

impl BodyShapes {
    /// Shapes of a body, the flexible ones if they are not too many numbers.
    pub fn new(dofs: Vec<Dof>, RowShapes { modes, flexible }: RowShapes) -> Self {
        let rows = flexible.nrows();
        let is_kept = rows.saturating_mul(flexible.ncols()) <= MOST_FLEXIBLE;
        let flexible = if is_kept { flexible } else { Mat::zeros(rows, 0) };
        Self { dofs, shapes: modes, flexible }
    }
}

/// The kept shapes of `key`, if there are.
pub fn find_shapes(folder: &Path, key: &ReductionKey) -> Option<Vec<BodyShapes>> {
    decoded_shapes(&fs::read(folder.join(FOLDER).join(shapes_name(key))).ok()?)
}

/// Keeps `shapes` beside the reduction of `key`, where the folder can be written to.
pub fn keep_shapes(folder: &Path, key: &ReductionKey, shapes: &[BodyShapes]) {
    if let Err(error) = write(&folder.join(FOLDER).join(shapes_name(key)), &encoded_shapes(shapes))
    {
        tracing::info!("the shapes are not kept: {error}");
    }
}

fn shapes_name(key: &ReductionKey) -> String {
    format!("{}.shapes", key.0)
}

/// Writes a file under a temporary name, and removes the oldest of too many.
fn write(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    let folder = path.parent().unwrap_or(Path::new("."));
    fs::create_dir_all(folder)?;
    let unfinished = path.with_extension(format!("{}.part", std::process::id()));
    fs::write(&unfinished, bytes)?;
    fs::rename(&unfinished, path)?;
    let mut kept: Vec<(std::time::SystemTime, PathBuf)> = fs::read_dir(folder)?
        .flatten()
        .filter_map(|entry| Some((entry.metadata().ok()?.modified().ok()?, entry.path())))
        .collect();
    kept.sort();
    for (_, old) in kept.iter().rev().skip(MOST_KEPT) {
        fs::remove_file(old)?;
    }
    Ok(())
}

fn encoded(bodies: &[ReducedBody]) -> Vec<u8> {
    let mut bytes = MARK.to_vec();
    bytes.extend((bodies.len() as u64).to_le_bytes());
    for body in bodies {
        let (modes, ports) = (body.angular_frequencies.len(), body.residual.ports());
        bytes.extend((modes as u64).to_le_bytes());
        bytes.extend((ports as u64).to_le_bytes());
        let flexibility = (0..ports).flat_map(|a| (0..ports).map(move |b| (a, b)));
        let flexibility = flexibility.map(|(a, b)| body.residual.get(a, b));
        let participations = body.participations.iter().flatten().copied();
        let numbers = body.angular_frequencies.iter().copied().chain(participations);
        for number in numbers.chain(flexibility) {
            bytes.extend(number.to_le_bytes());
        }
    }
    let sum = check_sum(&bytes);
    bytes.extend(sum.to_le_bytes());
    bytes
}

fn decoded(bytes: &[u8]) -> Option<Vec<ReducedBody>> {
    let (content, sum) = bytes.split_at_checked(bytes.len().checked_sub(8)?)?;
    if check_sum(content).to_le_bytes() != sum {
        return None;
    }
    let mut words = Words(content.strip_prefix(MARK)?);
    let bodies = words.count()?;
    let mut found = Vec::new();
    for _ in 0..bodies {
        let (modes, ports) = (words.count()?, words.count()?);
        let angular_frequencies = words.numbers(modes)?;
        let participations = (0..modes).map(|_| words.numbers(ports)).collect::<Option<_>>()?;
        let rows = (0..ports).map(|_| words.numbers(ports)).collect::<Option<Vec<_>>>()?;
        let residual = ResidualFlexibility::from_rows(&rows).ok()?;
        found.push(ReducedBody { angular_frequencies, participations, residual });
    }
    words.0.is_empty().then_some(found)
}

fn encoded_shapes(bodies: &[BodyShapes]) -> Vec<u8> {
    let mut bytes = SHAPES_MARK.to_vec();
    bytes.extend((bodies.len() as u64).to_le_bytes());
    for BodyShapes { dofs, shapes, flexible } in bodies {
        bytes.extend((dofs.len() as u64).to_le_bytes());
        bytes.extend((shapes.ncols() as u64).to_le_bytes());
        bytes.extend((flexible.ncols() as u64).to_le_bytes());
        for dof in dofs {
            bytes.extend(dof.node.to_le_bytes());
            bytes.extend(u64::from(dof.direction).to_le_bytes());
        }
        for matrix in [shapes, flexible] {
            for column in 0..matrix.ncols() {
                for row in 0..matrix.nrows() {
                    bytes.extend(matrix[(row, column)].to_le_bytes());
                }
            }
        }
    }
    let sum = check_sum(&bytes);
    bytes.extend(sum.to_le_bytes());
    bytes
}

fn decoded_shapes(bytes: &[u8]) -> Option<Vec<BodyShapes>> {
    let (content, sum) = bytes.split_at_checked(bytes.len().checked_sub(8)?)?;
    if check_sum(content).to_le_bytes() != sum {
        return None;
    }
    let mut words = Words(content.strip_prefix(SHAPES_MARK)?);
    let bodies = words.count()?;
    let mut found = Vec::new();
    for _ in 0..bodies {
        let (rows, modes, ports) = (words.count()?, words.count()?, words.count()?);
        let mut dofs = Vec::with_capacity(rows);
        for _ in 0..rows {
            let node = i64::from_le_bytes(words.next()?);
            dofs.push(Dof { node, direction: u64::from_le_bytes(words.next()?).try_into().ok()? });
        }
        let mut matrix = |columns: usize| {
            let values = words.numbers(rows.checked_mul(columns)?)?;
            Some(Mat::from_fn(rows, columns, |row, column| values[row + column * rows]))
        };
        let (shapes, flexible) = (matrix(modes)?, matrix(ports)?);
        found.push(BodyShapes { dofs, shapes, flexible });
    }
    words.0.is_empty().then_some(found)
}

/// Eight-byte words.
struct Words<'a>(&'a [u8]);

impl Words<'_> {
    fn next(&mut self) -> Option<[u8; 8]> {
        let (word, rest) = self.0.split_first_chunk::<8>()?;
        self.0 = rest;
        Some(*word)
    }

    /// A count of words that are left at most.
    fn count(&mut self) -> Option<usize> {
        let count = usize::try_from(u64::from_le_bytes(self.next()?)).ok()?;
        (count <= self.0.len() / 8).then_some(count)
    }

    fn numbers(&mut self, count: usize) -> Option<Vec<f64>> {
        let (numbers, rest) = self.0.split_at_checked(count.checked_mul(8)?)?;
        self.0 = rest;
        Some(numbers.as_chunks::<8>().0.iter().map(|word| f64::from_le_bytes(*word)).collect())
    }
}

/// FNV-1a over words of eight bytes, the last one filled up by zeros.
fn check_sum(bytes: &[u8]) -> u64 {
    let step = |sum: u64, word: u64| (sum ^ word).wrapping_mul(0x0100_0000_01b3);
    let (words, rest) = bytes.as_chunks::<8>();
    let mut last = [0; 8];
    last[..rest.len()].copy_from_slice(rest);
    let words = words.iter().chain(std::iter::once(&last)).map(|word| u64::from_le_bytes(*word));
    words.fold(0xcbf2_9ce4_8422_2325, step)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn body() -> ReducedBody {
        ReducedBody {
            angular_frequencies: vec![0.0, 3.5],
            participations: vec![vec![1.0, -2.0, 0.5], vec![0.1, 0.2, 0.3]],
            residual: ResidualFlexibility::from_rows(&[
                vec![1.0, 0.1, 0.0],
                vec![0.1, 2.0, 0.0],
                vec![0.0, 0.0, 3.0],
            ])
            .unwrap(),
        }
    }

    #[test]
    fn a_reduction_is_read_back_to_the_last_bit() {
        let bodies = vec![body(), body()];
        assert_eq!(decoded(&encoded(&bodies)), Some(bodies));
    }

    #[test]
    fn shapes_are_read_back_to_the_last_bit() {
        let body = BodyShapes {
            dofs: vec![Dof::new(-3, 1), Dof::new(12, 3)],
            shapes: Mat::from_fn(2, 3, |row, mode| row as f64 - 0.1 * mode as f64),
            flexible: Mat::from_fn(2, 2, |row, port| 1e-9 * (row + 3 * port) as f64),
        };
        let bodies = vec![body.clone(), body];
        let bytes = encoded_shapes(&bodies);
        assert_eq!(decoded_shapes(&bytes), Some(bodies));
        for end in 0..bytes.len() {
            assert_eq!(decoded_shapes(&bytes[..end]), None);
        }
    }

    #[test]
    fn a_file_that_is_not_whole_is_no_reduction() {
        let bytes = encoded(&[body()]);
        for end in 0..bytes.len() {
            assert_eq!(decoded(&bytes[..end]), None);
        }
        for at in 0..bytes.len() {
            let mut changed = bytes.clone();
            changed[at] ^= 4;
            assert_eq!(decoded(&changed), None);
        }
    }

    #[test]
    fn what_was_kept_is_found() {
        let folder = tempfile::tempdir().unwrap();
        let key = ReductionKey("a".to_owned());
        assert_eq!(find(folder.path(), &key), None);
        keep(folder.path(), &key, &[body()]);
        assert_eq!(find(folder.path(), &key), Some(vec![body()]));
    }
}
