//! The measured force of each hit of an analysis, from the records that the analysis names.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use asperity_experiment::{AnalysisOptions, ChannelSelector, ResponseChoice, for_each_hit};
use asperity_scenario::file_sha256;
use asperity_signal::HitRecord;
use serde_json::{Map, Value};

use crate::records::{Force, force_of};

/// Largest difference of the times of one hit \[s\], and relative difference of its peaks.
const SAME_TIME_S: f64 = 0.02;
const SAME_PEAK: f64 = 0.02;

/// The place of a hit in its record, and its peak force, as an analysis states them.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct HitSource {
    pub(super) file: String,
    pub(super) time_s: f64,
    pub(super) peak_n: f64,
}

impl HitSource {
    /// The source of a hit of an analysis.
    pub(super) fn of(hit: &Value) -> Option<Self> {
        Some(Self {
            file: hit.get("file")?.as_str()?.to_owned(),
            time_s: hit.get("time_s")?.as_f64()?,
            peak_n: hit.get("force_peak_n")?.as_f64()?,
        })
    }

    fn is(&self, hit: &HitRecord) -> bool {
        let time = (hit.start + hit.trigger as u64) as f64 / hit.sample_rate_hz;
        let peak = hit.force.iter().fold(0.0_f64, |peak, force| peak.max(*force));
        (time - self.time_s).abs() <= SAME_TIME_S && (peak / self.peak_n - 1.0).abs() <= SAME_PEAK
    }
}

/// The measured forces of hits of an analysis whose records are in one of the `folders`, or as the
/// analysis names them; and the reasons why others have none.
pub(super) fn forces_of(
    sources: &[Option<HitSource>],
    analysis: &Map<String, Value>,
    folders: &[PathBuf],
) -> (Vec<Option<Force>>, Vec<String>) {
    let options = options_of(analysis);
    let mut files: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    for (place, source) in sources.iter().enumerate() {
        if let Some(source) = source {
            files.entry(&source.file).or_default().push(place);
        }
    }
    let mut found = vec![None; sources.len()];
    let mut reasons = Vec::new();
    for (file, own) in files {
        let forces = match record(file, analysis, folders) {
            Ok(path) => forces_in(&path, &options),
            Err(reason) => Err(reason),
        };
        match forces {
            Err(reason) => reasons.push(reason),
            Ok(hits) => {
                for place in own {
                    let Some(source) = &sources[place] else { continue };
                    let own = hits.iter().find(|hit| source.is(hit));
                    found[place] = own.and_then(|hit| force_of(&mut hit.clone()));
                    if found[place].is_none() {
                        let time = source.time_s;
                        reasons.push(format!("{file} has no hit as analysed at {time} s"));
                    }
                }
            }
        }
    }
    (found, reasons)
}

/// The hits of a record.
fn forces_in(path: &Path, options: &AnalysisOptions) -> Result<Vec<HitRecord>, String> {
    let mut hits = Vec::new();
    for_each_hit(&[path.to_owned().into()], options, &mut |hit, _| hits.push(hit))
        .map_err(|error| error.to_string())?;
    Ok(hits)
}

/// The path of a record that an analysis names: with its SHA-256, if the analysis has one.
fn record(
    file: &str,
    analysis: &Map<String, Value>,
    folders: &[PathBuf],
) -> Result<PathBuf, String> {
    let files = analysis.get("provenance").and_then(|all| all.get("files")?.as_array());
    let is_own = |known: &&Value| known.get("file").and_then(Value::as_str) == Some(file);
    let known = files.into_iter().flatten().find(is_own);
    let hash = known.and_then(|known| known.get("sha256")?.as_str());
    let name = Path::new(file).file_name().unwrap_or_default();
    let mut places = vec![PathBuf::from(file)];
    places.extend(folders.iter().flat_map(|folder| [folder.join(file), folder.join(name)]));
    let mut differs = false;
    for place in places.into_iter().filter(|place| place.is_file()) {
        match hash.map(|hash| file_sha256(&place).map(|own| own == hash)) {
            None | Some(Ok(true)) => return Ok(place),
            _ => differs = true,
        }
    }
    Err(if differs {
        format!("{file} is not the file that was analysed")
    } else {
        format!("{file} was not found")
    })
}

/// The options of an analysis, as far as they cut hits.
fn options_of(analysis: &Map<String, Value>) -> AnalysisOptions {
    let number = |key: &str| analysis.get("settings")?.get(key)?.as_f64();
    let channel = |role: &str| -> Option<ChannelSelector> {
        let channels = analysis.get("channels")?.as_array()?;
        let own = channels.iter().find(|one| one["role"] == role)?;
        Some(ChannelSelector::from(own.get("name")?.as_str()?))
    };
    let default = AnalysisOptions::default();
    AnalysisOptions {
        force: channel("force"),
        responses: ResponseChoice::of(channel("response").as_slice()),
        trigger_level_n: number("level_n"),
        hit_length_s: number("length_s"),
        pre_trigger_s: number("pre_trigger_s").unwrap_or(default.pre_trigger_s),
        hold_off_s: number("hold_off_s").unwrap_or(default.hold_off_s),
        ..default
    }
}
