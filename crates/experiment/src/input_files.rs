//! Files named by paths, folders and patterns.

use std::cmp::Ordering;
use std::path::{Path, PathBuf};

use glob::{MatchOptions, glob_with};

use crate::error::AnalysisError;

/// Extensions of measurement files, which a folder is searched for.
const EXTENSIONS: [&str; 14] = [
    "uff", "unv", "uf", "csv", "txt", "tsv", "lvm", "npy", "npz", "mat", "wav", "tdms", "h5",
    "hdf5",
];

/// The files that some paths name, in the order of the paths.
///
/// A folder stands for the measurement files in it, told by their extension; a path that does not
/// exist and has `*`, `?` or `[...]` for the files that match. Those of a folder or a pattern are in
/// natural order: `hit_2` before `hit_10`.
///
/// # Errors
/// [`AnalysisError::NoFiles`] for a folder or a pattern without files.
///
/// ```
/// use asperity_experiment::input_files;
///
/// let folder = tempfile::tempdir()?;
/// for name in ["hit_10.npy", "hit_2.npy", "notes.md"] {
///     std::fs::write(folder.path().join(name), "")?;
/// }
/// let found = input_files(&[folder.path().join("hit_*.npy")])?;
/// assert!(found[0].ends_with("hit_2.npy") && found.len() == 2);
/// assert_eq!(input_files(&[folder.path().to_owned()])?, found);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn input_files(paths: &[PathBuf]) -> Result<Vec<PathBuf>, AnalysisError> {
    let mut files = Vec::new();
    for path in paths {
        let text = path.to_string_lossy();
        let mut found = if path.is_dir() {
            measurements_in(path)?
        } else if !path.exists() && text.contains(['*', '?', '[']) {
            matching(&text)
        } else {
            files.push(path.clone());
            continue;
        };
        if found.is_empty() {
            return Err(AnalysisError::NoFiles { path: path.clone() });
        }
        found.sort_by(|a, b| natural_order(&a.to_string_lossy(), &b.to_string_lossy()));
        files.extend(found);
    }
    Ok(files)
}

/// Measurement files in a folder, told by their extension, in natural order.
pub(crate) fn measurements_in(folder: &Path) -> Result<Vec<PathBuf>, AnalysisError> {
    let unreadable = |source: std::io::Error| {
        let file = folder.display().to_string();
        AnalysisError::from(asperity_measure::MeasureError::Io { file, source })
    };
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(unreadable)? {
        let path = entry.map_err(unreadable)?.path();
        let extension = path.extension().and_then(|extension| extension.to_str());
        let is_known = extension
            .is_some_and(|own| EXTENSIONS.iter().any(|known| known.eq_ignore_ascii_case(own)));
        let is_hidden =
            path.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.'));
        if is_known && !is_hidden && path.is_file() {
            found.push(path);
        }
    }
    found.sort_by(|a, b| natural_order(&a.to_string_lossy(), &b.to_string_lossy()));
    Ok(found)
}

/// Files that match a pattern; one that is not valid matches none.
fn matching(pattern: &str) -> Vec<PathBuf> {
    let options = MatchOptions { require_literal_leading_dot: true, ..MatchOptions::new() };
    let paths = glob_with(pattern, options).into_iter().flatten().flatten();
    paths.filter(|path| path.is_file()).collect()
}

/// Order in which numbers in names count as numbers.
fn natural_order(a: &str, b: &str) -> Ordering {
    let (mut a, mut b) = (a, b);
    loop {
        let digits = |text: &str| text.bytes().take_while(u8::is_ascii_digit).count();
        let (in_a, in_b) = (digits(a), digits(b));
        if in_a > 0 && in_b > 0 {
            let (number_a, number_b) =
                (a[..in_a].trim_start_matches('0'), b[..in_b].trim_start_matches('0'));
            let order = number_a.len().cmp(&number_b.len()).then_with(|| number_a.cmp(number_b));
            if order.is_ne() {
                return order;
            }
            (a, b) = (&a[in_a..], &b[in_b..]);
            continue;
        }
        let (mut rest_a, mut rest_b) = (a.chars(), b.chars());
        match (rest_a.next(), rest_b.next()) {
            (None, None) => return Ordering::Equal,
            (None, Some(_)) => return Ordering::Less,
            (Some(_), None) => return Ordering::Greater,
            (Some(x), Some(y)) if x != y => return x.cmp(&y),
            _ => (a, b) = (rest_a.as_str(), rest_b.as_str()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_in_names_count_as_numbers() {
        let mut names = ["b1", "a10", "a9", "a09x", "a", "a1b20", "a1b3"];
        names.sort_by(|a, b| natural_order(a, b));
        assert_eq!(names, ["a", "a1b3", "a1b20", "a9", "a09x", "a10", "b1"]);
    }

    #[test]
    fn a_path_without_files_is_an_error() {
        let folder = tempfile::tempdir().unwrap();
        let empty = folder.path().to_owned();
        for path in [empty.clone(), empty.join("*.npy"), empty.join("[.npy")] {
            let error = input_files(&[path]).unwrap_err();
            assert!(matches!(error, AnalysisError::NoFiles { .. }), "{error}");
        }
        // A missing file is an error where it is read.
        assert_eq!(input_files(&[empty.join("x.npy")]).unwrap().len(), 1);
    }
}
