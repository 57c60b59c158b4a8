//! Excitation and sensors: places on bodies, and files of samples.

use std::path::Path;

use asperity_structure::{ExcitationSpec, SamplesFile};
use serde::Deserialize;

use super::Node;
use crate::diagnostic::{Diagnostic, MAX_FAULTS};
use crate::fault::Fault;
use crate::input_file::InputError;
use crate::load_samples::{LoadSamples, SamplesError};
use crate::suggest::nearest;

/// Checks the places of the force, of the sensors and of springs, the names of sensors, and a file of samples.
pub(super) fn check(root: &Node<'_>, folder: &Path, found: &mut Vec<Diagnostic>) {
    let excitation = root.get("excitation");
    let sensors = root.items("sensors");
    for owner in excitation.iter().chain(&sensors) {
        if found.len() >= MAX_FAULTS {
            return;
        }
        if let Some(at) = owner.get("at") {
            place(root, &at, found);
        }
    }
    for spring in root.items("springs") {
        for end in ["from", "to"].into_iter().filter_map(|key| spring.get(key)) {
            if found.len() < MAX_FAULTS {
                place(root, &end, found);
            }
        }
    }
    if let Some(excitation) = excitation {
        base_displacement(&excitation, found);
        samples(&excitation, folder, found);
    }
}

/// The place `at` names a body, and lies on it.
fn place(root: &Node<'_>, at: &Node<'_>, found: &mut Vec<Diagnostic>) {
    let (Some(name), Some(node)) = (at.text("body"), at.get("body")) else { return };
    let bodies = root.items("bodies");
    let Some(body) = bodies.iter().find(|body| body.text("name") == Some(name)) else {
        let names: Vec<&str> = bodies.iter().filter_map(|body| body.text("name")).collect();
        let accepted = format!("the name of a body: {}", names.join(", "));
        let diagnostic = Diagnostic::new(&node.at, Fault::UnknownBody(name.to_owned()), accepted);
        found.push(diagnostic.suggest_word(nearest(name, names.iter().copied())));
        return;
    };
    if let (Some(position_m), Some(length_m)) = (at.number("position_m"), body.number("length_m"))
        && position_m > length_m
    {
        let fault = Fault::BeyondBody { position_m, length_m };
        let accepted = format!("0 to {length_m}, from the upper end of the body");
        found.push(Diagnostic::new(&at.at.child("position_m"), fault, accepted));
    }
}

/// Bars move along their axis.
pub(super) fn no_direction(root: &Node<'_>, found: &mut Vec<Diagnostic>) {
    let direction = root.get("excitation").and_then(|excitation| excitation.get("direction"));
    if let Some(direction) = direction {
        let accepted = "no direction: bars move along their axis";
        found.push(Diagnostic::new(&direction.at, Fault::UnknownKey, accepted));
    }
}

fn base_displacement(excitation: &Node<'_>, found: &mut Vec<Diagnostic>) {
    let Some(displacement) = excitation.get("displacement") else { return };
    if displacement.text("kind") == Some("half_sine") {
        let accepted = "gamma_pulse, haversine, harmonic or samples; or the half-sine as an \
                        acceleration or velocity";
        found.push(Diagnostic::new(&displacement.at.child("kind"), Fault::BaseJump, accepted));
    }
}

fn samples(excitation: &Node<'_>, folder: &Path, found: &mut Vec<Diagnostic>) {
    // What is no excitation was rejected by the schema.
    let Ok(spec) = ExcitationSpec::deserialize(excitation.value) else { return };
    if let ExcitationSpec::Samples { points: Some(points), peak_n, .. } = &spec {
        return check_points(excitation, points, peak_n.is_some(), found);
    }
    let Some(SamplesFile { file, column, peak }) = spec.samples() else { return };
    let quantities = ["acceleration", "velocity", "displacement"];
    let owner = quantities.into_iter().find_map(|key| excitation.get(key));
    let owner = owner.unwrap_or_else(|| excitation.clone());
    let read = LoadSamples::read(&folder.join(file), column);
    let read = read.and_then(|samples| match peak {
        Some(peak) => samples.rescaled(peak),
        None => Ok(samples),
    });
    let Err(source) = read else { return };
    let (key, accepted) = if source == SamplesError::ZeroForce {
        let entries = owner.value.as_object().into_iter().flatten();
        let key = entries.map(|(key, _)| key.as_str()).find(|key| key.starts_with("peak"));
        let key = key.unwrap_or("file");
        (key, format!("no {key}, or samples that are not zero throughout"))
    } else {
        let accepted = format!(
            "a CSV file with the header time_s,{column} and rows of increasing time, relative to \
             the scenario's folder"
        );
        ("file", accepted)
    };
    let near = match source {
        SamplesError::Input(InputError::NotFound) => neighbour(folder, file),
        _ => None,
    };
    let fault = Fault::Samples { file: file.to_owned(), source };
    let diagnostic = Diagnostic::new(&owner.at.child(key), fault, accepted);
    found.push(diagnostic.suggest_word(near.as_deref()));
}

/// Times of the points increase, and a force to be rescaled is not zero throughout.
fn check_points(
    excitation: &Node<'_>,
    points: &[[f64; 2]],
    is_rescaled: bool,
    found: &mut Vec<Diagnostic>,
) {
    let place = excitation.at.child("points");
    if let Some(row) = points.windows(2).position(|pair| pair[1][0] <= pair[0][0]) {
        let [previous_s, time_s] = [points[row][0], points[row + 1][0]];
        let fault = Fault::TimeNotIncreasing { time_s, previous_s };
        let at = place.child(row + 1).child(0);
        found.push(Diagnostic::new(&at, fault, "times that increase from point to point"));
    } else if is_rescaled && points.iter().all(|point| point[1] == 0.0) {
        let fault = Fault::Degenerate { quantity: "the largest force", value: 0.0 };
        let accepted = "no peak_n, or points that are not zero throughout";
        found.push(Diagnostic::new(&excitation.at.child("peak_n"), fault, accepted));
    }
}

/// CSV file in the same folder whose name is nearest to `file`.
fn neighbour(folder: &Path, file: &str) -> Option<String> {
    let parent = Path::new(file).parent()?;
    let name = Path::new(file).file_name()?.to_str()?;
    let entries = std::fs::read_dir(folder.join(parent)).ok()?;
    let mut names: Vec<String> = entries
        .take(1000)
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .filter(|name| name.to_lowercase().ends_with(".csv"))
        .collect();
    names.sort();
    let near = nearest(name, names.iter().map(String::as_str))?;
    Some(parent.join(near).to_string_lossy().into_owned())
}
