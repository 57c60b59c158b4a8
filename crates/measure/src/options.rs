//! Options of reading and writing.

/// Options of reading a file; by default everything is taken from the file.
#[derive(Debug, Clone, PartialEq)]
pub struct ReadOptions {
    /// Sample rate \[Hz\] of a file without one.
    pub sample_rate_hz: Option<f64>,
    /// Sample axis of an array; by default the longer one.
    pub sample_axis: Option<SampleAxis>,
    /// Names of the channels, in order; an empty name keeps the file's.
    pub names: Vec<String>,
    /// Units of the channels, in order; an empty unit keeps the file's.
    pub units: Vec<String>,
    /// True if `names` and `units` have an entry for every channel of the first record, each where they
    /// are given; another number is then an error.
    pub complete: bool,
    /// Cells of a text that are no number.
    pub invalid_cells: InvalidCells,
    /// Most samples of a channel in one record, at least 1; longer measurements are divided into
    /// records that continue each other.
    pub block: usize,
    /// Most bytes of decompressed data per byte of the file (one MiB is always allowed).
    pub expansion: u64,
}

impl Default for ReadOptions {
    fn default() -> Self {
        Self {
            sample_rate_hz: None,
            sample_axis: None,
            names: Vec::new(),
            units: Vec::new(),
            complete: false,
            invalid_cells: InvalidCells::Refuse,
            block: 1 << 20,
            expansion: 10,
        }
    }
}

/// The axis of an array along which the samples of a channel lie.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SampleAxis {
    /// Rows: shape (samples, channels).
    First,
    /// Columns: shape (channels, samples).
    Last,
}

/// Treatment of a cell of a text that is no number, such as `---` or `OVL`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum InvalidCells {
    /// An error that names the row.
    #[default]
    Refuse,
    /// A missing sample: not a number.
    Dropout,
    /// A sample beyond the range of the sensor: infinite, negative for a cell that begins with a minus
    /// and an overload, such as `-OVL`.
    Overload,
}

/// Options of writing.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct WriteOptions {
    /// Title, for formats with a title and records without one.
    pub title: String,
    /// Date as text, likewise.
    pub date: String,
    /// Replaces an existing file, which is an error otherwise.
    pub replace: bool,
}
