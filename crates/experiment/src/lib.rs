//! Measured hammer hits: from files to features of each hit, averaged frequency response functions
//! and backbones.
//!
//! Of each hit, with response spectrum `X(f)` (as a displacement) and force spectrum `F(f)`, the
//! receptance is `H(f) = X(f) / F(f)`. Its largest peak in the band of the fundamental is
//! `A1 = |H(f1)|`, its largest peak in 1.7 to 2.3 of `f1` is `A2 = |H(f2)|` if the hits show that it
//! is the second harmonic and no other mode, and the harmonic ratio
//! `A2/A1` is a ratio of receptances. The spectra of good hits are averaged (H1, H2 or Hv), and the
//! decay of each hit gives its backbone: frequency and damping over amplitude.
//!
//! Files are read twice, in blocks. The first pass finds the trigger level and the hit length, the
//! second cuts, checks and analyses the hits, several at a time on all cores. Memory grows by a row
//! and a backbone for each hit. Results do not depend on the number of threads.
//!
//! ```
//! use asperity_experiment::{AnalysisOptions, analyse};
//! use asperity_measure::{Abscissa, Channel, ChannelUnit, Format, Record, Samples, write};
//! # use asperity_measure::{ChannelQuantity, Origin, WriteOptions};
//!
//! // 1 kg on a spring at 100 Hz with 1 % damping, hit once: force and acceleration at 5 kHz.
//! let (rate, omega) = (5e3, 2.0 * std::f64::consts::PI * 100.0);
//! let (mut u, mut v) = (0.0, 0.0);
//! let (mut force, mut acceleration) = (Vec::new(), Vec::new());
//! for n in 0..5000 {
//!     let phase = (n as f64 - 100.0) / 10.0;
//!     let f = if (0.0..=1.0).contains(&phase) { 10.0 * (3.141_592_65 * phase).sin() } else { 0.0 };
//!     let a = f - 0.02 * omega * v - omega * omega * u;
//!     (v, u) = (v + a / rate, u + (v + a / rate) / rate);
//!     force.push(f);
//!     acceleration.push(a);
//! }
//! let channel = |name: &str, unit: &str, samples| Channel {
//!     name: name.to_owned(),
//!     quantity: ChannelQuantity::Unknown,
//!     unit: ChannelUnit::of_text(unit),
//!     abscissa: Abscissa::even_time(0.0, rate),
//!     samples: Samples::Real(samples),
//!     origin: Origin::default(),
//! };
//! let channels = vec![channel("hammer", "N", force), channel("top", "m/s^2", acceleration)];
//! let record = Record { channels, ..Record::default() };
//! let folder = tempfile::tempdir()?;
//! let file = folder.path().join("hit.uff");
//! write(&file, &[record], Format::UniversalBinary, &WriteOptions::default())?;
//!
//! let analysis = analyse(&[file], &AnalysisOptions::default())?;
//! let response = &analysis.responses[0];
//! let fundamental = response.report.hits[0].fundamental.unwrap();
//! assert!((fundamental.frequency_hz - 100.0).abs() < 0.5);
//! assert!(response.hits_table().to_csv().starts_with("file,index,record,time_s,force_peak_n"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! | module | holds |
//! |---|---|
//! | `options`, `channel` | [`AnalysisOptions`] and their text forms, selection of the channels |
//! | `rig` | [`RigSettings`]: a file in place of options |
//! | `stream` | files, or records in memory, as blocks of force and response in SI |
//! | `line_up` | channels of one rate with starts apart |
//! | `other_record`, `near_name` | for messages: channels in other records, and the nearest name |
//! | `source_hash` | checksums of files and records |
//! | `trigger`, `cutting` | trigger level and hit length; blocks to hits |
//! | `analyse`, `hit_analysis` | [`analyse`]: the two passes, hits for every response |
//! | `response_analysis`, `average` | hits of one response and their average |
//! | `modes` | modes of the band over hits and responses |
//! | `force_level` | hits grouped by force |
//! | `second_peak` | second harmonic or another mode |
//! | `analysis`, `report`, `hit_report`, `curve` | [`Analysis`], `analysis.json`, CSV, curves to draw |
//! | `decay` | [`analyse_decays`]: free decays without a force |
//! | `frf_record` | functions of hits and average as a record |
//! | `measured_frf` | functions from files of other programs |
//! | `convert` | [`convert`] from one format to another |
//! | `inspection` | [`inspect`]: content of a file before any analysis |
//! | `input_files` | folders and patterns to files |
//! | `input_size` | largest inputs |
//! | `watched_folder`, `next_level` | complete files of a folder; the force of the next hit |

mod analyse;
mod analysis;
mod average;
mod channel;
mod convert;
mod curve;
mod cutting;
mod decay;
mod error;
mod force_level;
mod frf_record;
mod hit_analysis;
mod hit_report;
mod hit_second_peak;
mod input_files;
mod input_size;
mod inspection;
mod line_up;
mod measured_frf;
mod modes;
mod near_name;
mod next_level;
mod options;
mod other_record;
mod plausibility;
mod report;
mod response_analysis;
mod rig;
mod second_peak;
mod source_hash;
mod stream;
mod trigger;
mod watched_folder;

pub use analyse::{analyse, analyse_sources};
pub use analysis::{Analysis, HitBackbone, HitFrf, ResponseAnalysis};
pub use average::AveragedFrf;
pub use channel::{ChannelSelector, ResponseChoice};
pub use convert::{Conversion, ConvertOptions, convert};
pub use curve::HitCurve;
pub use cutting::for_each_hit;
pub use decay::{
    DECAY_SCHEMA, DecayAnalysis, DecayCurve, DecayCurveReport, DecayHarmonicReport, DecayLevel,
    DecayMode, DecayOptions, DecayOutline, DecayReport, DecaySettings, DecayTrend, MeasuredDecay,
    analyse_decay_sources, analyse_decays,
};
pub use error::AnalysisError;
pub use force_level::ForceLevel;
pub use hit_report::{HitFundamental, HitReport, HitSecondHarmonic, HitStatistics};
pub use hit_second_peak::HitSecondPeak;
pub use input_files::input_files;
pub use input_size::{MAX_ANALYSED_BYTES, MAX_CONVERTED_BYTES};
pub use inspection::{Choice, INSPECTION_SCHEMA, InspectedChannel, Inspection, inspect};
pub use measured_frf::{FUNCTION_ROLE, FrfOptions, MeasuredFrf, read_frf, read_frfs};
pub use modes::{Mode, ModeAtResponse};
pub use next_level::{LevelCoverage, NextLevel};
pub use options::{
    AnalysisOptions, ChannelSensor, FrequencyBand, HitCount, RejectedHit, RigFile, TimeConstant,
    WindowOptions, parse_estimator, parse_frf_form,
};
pub use report::{
    ANALYSIS_SCHEMA, AnalysisProvenance, AnalysisReport, AnalysisSettings, AverageFundamental,
    AverageReport,
};
pub use rig::{
    RigChannel, RigEstimator, RigFault, RigInvalidCells, RigSampleAxis, RigSchemaId, RigSettings,
};
pub use second_peak::SecondPeakReport;
pub use stream::{AnalysedFile, UsedChannel};
pub use watched_folder::{CompleteFile, WatchedFolder};
