//! Largest inputs, checked before any is read.

use asperity_measure::MeasurementSource;

use crate::error::AnalysisError;

/// Most bytes of the files of one analysis, which are read in blocks: an hour or two.
pub const MAX_ANALYSED_BYTES: u64 = 1 << 38;

/// Most bytes of a file to convert. Its samples are held in memory: twice the size for samples of 4
/// bytes, and up to ten times for compressed files.
pub const MAX_CONVERTED_BYTES: u64 = 1 << 31;

/// Checks that files are regular and together hold at most `limit` bytes. A file that cannot be
/// looked at is left to its reader.
pub(crate) fn check_size(sources: &[MeasurementSource], limit: u64) -> Result<(), AnalysisError> {
    let mut bytes = 0_u64;
    for source in sources {
        let MeasurementSource::File(path) = source else { continue };
        let Ok(metadata) = std::fs::metadata(path) else { continue };
        if !metadata.is_file() && !metadata.is_dir() {
            let found = path.display().to_string();
            return Err(AnalysisError::Setting {
                name: "the input",
                found,
                expected: "a regular file",
            });
        }
        bytes = bytes.saturating_add(metadata.len());
    }
    if bytes > limit {
        let path = sources.first().map(|source| source.name().to_owned()).unwrap_or_default();
        return Err(AnalysisError::TooLarge { path, files: sources.len(), bytes, limit });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_add_up_and_devices_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let files = ["a", "b"].map(|name| {
            let path = folder.path().join(name);
            std::fs::write(&path, [0; 600]).unwrap();
            MeasurementSource::from(path)
        });
        assert!(check_size(&files, 1200).is_ok());
        let refused = check_size(&files, 1199).unwrap_err();
        assert!(matches!(refused, AnalysisError::TooLarge { bytes: 1200, files: 2, .. }));
        assert!(refused.is_wrong_request());
        #[cfg(unix)]
        assert!(check_size(&[MeasurementSource::File("/dev/null".into())], 1).is_err());
    }
}
