//! `asperity inspect`.

use std::collections::HashSet;
use std::fmt::Write as _;
use std::path::Path;

use asperity_experiment::{
    Choice, FrfOptions, InspectedChannel, Inspection, RigSettings, input_files, inspect, read_frfs,
};
use asperity_plot as plot;
use serde_json::{Value, json};

use crate::args::analyse::Inspect;
use crate::args::figures::FigureFormat;
use crate::failure::Failure;
use crate::rig;

/// Most channels in the printed table of a file.
const MOST_SHOWN: usize = 24;
/// Heights of an outline, from the lowest.
const HEIGHTS: [char; 8] = ['▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];
/// Width of a printed outline.
const COLUMNS: usize = 32;

/// Draws the frequency response functions of a file.
fn draw(file: &Path, path: &Path, asked: &Inspect) -> Result<(), Failure> {
    let options = FrfOptions { unit: asked.frf_unit.clone(), ..FrfOptions::default() };
    let functions = read_frfs(file, &options)?;
    let format = FigureFormat::of_path(path).unwrap_or(FigureFormat::Svg);
    let figure = plot::frf_file(&functions, plot::MagnitudeAxis::default());
    for (_, bytes) in figure.iter().flat_map(|figure| super::drawn("frf", figure, &[format])) {
        rig::write_file(path, &bytes, asked.overwrite)?;
    }
    Ok(())
}

/// Describes measurement files; one that cannot be read does not keep the others from it, and is the
/// error of the command.
pub(crate) fn run(asked: &Inspect, quiet: bool) -> Result<(), Failure> {
    let options = rig::channel_options(&asked.channels)?;
    let (mut answers, mut failed) = (Vec::new(), None);
    let (mut written, mut drawn) = (false, false);
    let mut told = HashSet::new();
    let files = input_files(&asked.files)?;
    for file in &files {
        let found = match inspect(file, &options) {
            Ok(found) => found,
            Err(error) => {
                if files.len() > 1 && !asked.json {
                    answer_line!("{}: cannot be read", file.display());
                }
                failed.get_or_insert(error);
                continue;
            }
        };
        if let Some(path) = asked.write_rig.as_deref().filter(|_| !written) {
            rig::write(path, &RigSettings::of_inspection(&found), asked.overwrite)?;
            written = true;
        }
        if let Some(path) = asked.draw.as_deref().filter(|_| !drawn) {
            draw(file, path, asked)?;
            drawn = true;
        }
        if asked.json {
            answers.push(found);
        } else {
            if !quiet {
                // A notice of many files is said once.
                let new = found.notices.iter().filter(|notice| told.insert((*notice).clone()));
                crate::progress::show_notices(new);
            }
            answer!("{}", in_words(&found));
        }
    }
    if asked.json {
        let answer = match answers.as_slice() {
            [one] => json!(one),
            many => Value::Array(many.iter().map(|one| json!(one)).collect()),
        };
        answer!("{}", super::pretty(&answer));
    }
    failed.map_or(Ok(()), |error| Err(error.into()))
}

fn in_words(found: &Inspection) -> String {
    let records = if found.records == 1 { "record" } else { "records" };
    let mut text = format!("{}: {}, {} {records}\n", found.file, found.format, found.records);
    text.push_str(
        "   record   #  name                  quantity      unit      samples    rate Hz  \
         seconds      smallest       largest           rms  outline\n",
    );
    for channel in found.channels.iter().take(MOST_SHOWN) {
        text.push_str(&row(channel));
    }
    if found.channels.len() > MOST_SHOWN {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "   ... and {} more", found.channels.len() - MOST_SHOWN);
    }
    for (role, choice) in [("force", &found.force), ("response", &found.response)] {
        let _ = match choice {
            Choice { channels, text: names, .. } if channels.len() > 1 => {
                writeln!(text, "   analyse takes {names} as the {role}s")
            }
            Choice { channel: Some(number), text: name, .. } => {
                writeln!(text, "   analyse takes #{number} `{name}` as the {role}")
            }
            Choice { text: reason, .. } => writeln!(text, "   {role}: {reason}"),
        };
    }
    text
}

fn row(channel: &InspectedChannel) -> String {
    let number = |value: Option<f64>| value.map_or("-".to_owned(), |value| format!("{value:.5e}"));
    let plain = |value: Option<f64>| value.map_or("-".to_owned(), |value| format!("{value}"));
    let short = |text: &str, most: usize| text.chars().take(most).collect::<String>();
    let seconds = channel.duration_s.map_or("-".to_owned(), |value| format!("{value:.4}"));
    let mut text = format!(
        "{:>9} {:>3}  {:<20}  {:<12}  {:<6}  {:>9} {:>10} {:>8} {:>13} {:>13} {:>13}  {}",
        channel.record,
        channel.number,
        short(&channel.name, 20),
        if channel.unit.is_empty() { "-" } else { &channel.quantity },
        short(&channel.unit, 6),
        channel.samples,
        plain(channel.sample_rate_hz),
        seconds,
        number(channel.range.map(|range| range[0])),
        number(channel.range.map(|range| range[1])),
        number(channel.deviation),
        outline(&channel.outline),
    );
    if channel.not_finite > 0 {
        let _ = write!(text, "  ({} samples not finite)", channel.not_finite);
    }
    text.push('\n');
    text
}

/// Largest magnitude of each interval, as a bar.
fn outline(intervals: &[[f64; 2]]) -> String {
    let part = intervals.len().div_ceil(COLUMNS).max(1);
    let heights: Vec<f64> = intervals
        .chunks(part)
        .map(|part| {
            part.iter().fold(0.0, |most: f64, one| most.max(one[0].abs()).max(one[1].abs()))
        })
        .collect();
    let largest = heights.iter().copied().fold(0.0, f64::max);
    let level = |height: &f64| {
        let share = if largest > 0.0 { height / largest } else { 0.0 };
        HEIGHTS[((share * HEIGHTS.len() as f64) as usize).min(HEIGHTS.len() - 1)]
    };
    heights.iter().map(level).collect()
}
