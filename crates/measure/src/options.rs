//! What a caller knows that a file does not say.

/// How to read a file. The default takes everything from the file.
#[derive(Debug, Clone, PartialEq)]
pub struct ReadOptions {
    /// Samples per second \[Hz\], for a file without a time axis. One that the
    /// file gives goes before.
    pub sample_rate_hz: Option<f64>,
    /// Along which axis of an array the samples run; by default the longer one.
    pub sample_axis: Option<SampleAxis>,
    /// Names of the channels, in order; an empty one keeps that of the file.
    pub names: Vec<String>,
    /// Units of the channels, in order; an empty one keeps that of the file.
    pub units: Vec<String>,
    /// Most samples of a channel in one record; longer measurements come in
    /// records that continue each other. At least 1.
    pub block: usize,
    /// Most bytes that a compressed file may unfold to, per byte of the file
    /// (one MiB is always allowed).
    pub expansion: u64,
}

impl Default for ReadOptions {
    fn default() -> Self {
        Self {
            sample_rate_hz: None,
            sample_axis: None,
            names: Vec::new(),
            units: Vec::new(),
            block: 1 << 20,
            expansion: 10,
        }
    }
}

/// The axis of an array along which the samples of a channel run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SampleAxis {
    /// Rows are instants: shape (samples, channels).
    First,
    /// Columns are instants: shape (channels, samples).
    Last,
}
