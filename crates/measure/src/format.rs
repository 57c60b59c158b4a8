//! File formats.

use std::fmt;

/// A file format.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Format {
    /// Universal file with datasets 58 as text.
    UniversalText,
    /// Universal file with datasets 58b, binary.
    UniversalBinary,
    /// Columns of numbers as text: CSV, TXT, LVM.
    Text,
    /// One NumPy array.
    Npy,
    /// NumPy arrays in a zip archive.
    Npz,
    /// MATLAB version 5 to 7.
    Mat,
    /// RIFF WAVE.
    Wav,
    /// National Instruments TDMS.
    Tdms,
    /// HDF5, which MATLAB 7.3 also writes.
    Hdf5,
    /// Records in memory, not a file.
    Memory,
}

impl Format {
    /// Formats that are always readable, for messages.
    pub(crate) const READABLE: &'static str = "UFF 58, text, NPY, NPZ, MAT 5, WAV, TDMS";

    /// The format to write for an extension; the binary universal file for `uff`, `unv` and `uf`.
    pub fn of_extension(extension: &str) -> Option<Self> {
        Some(match extension.to_ascii_lowercase().as_str() {
            "uff" | "unv" | "uf" => Self::UniversalBinary,
            "csv" | "txt" | "lvm" => Self::Text,
            "npy" => Self::Npy,
            "npz" => Self::Npz,
            "mat" => Self::Mat,
            "wav" => Self::Wav,
            "tdms" => Self::Tdms,
            "h5" | "hdf5" => Self::Hdf5,
            _ => return None,
        })
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::UniversalText => "UFF 58",
            Self::UniversalBinary => "UFF 58b",
            Self::Text => "text",
            Self::Npy => "NPY",
            Self::Npz => "NPZ",
            Self::Mat => "MAT",
            Self::Wav => "WAV",
            Self::Tdms => "TDMS",
            Self::Hdf5 => "HDF5",
            Self::Memory => "memory",
        })
    }
}
