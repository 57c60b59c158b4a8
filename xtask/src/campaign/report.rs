//! Reports of a campaign: `report.json` and `report.md`, and a summary on the terminal.

use std::path::Path;

use anyhow::Result;
use asperity_figure::report::{Report, TableCell, four_digits};
use serde_json::json;

use super::Judged;
use super::answer::Kind;
use super::judgement::{Class, EngineJudgement};
use super::stated::StatedErrors;
use super::steady::{AMPLITUDE, LINEAR};

/// Engines in the order of the report.
const ENGINES: [&str; 2] = ["modal", "finite differences"];

/// Judgements of the engines, in the order of [`ENGINES`].
fn engines(judged: &Judged) -> [&EngineJudgement; 2] {
    [&judged.judgement.modal, &judged.judgement.finite_difference]
}

/// Headings of [`counts`].
const COLUMNS: [&str; 4] = [
    "modal, contact kept",
    "modal, contact lost",
    "finite differences, contact kept",
    "finite differences, contact lost",
];

/// Numbers of answers of a class, by engine, without and with loss of contact.
fn counts(judged: &[Judged], class: Class) -> [usize; 4] {
    [(0, false), (0, true), (1, false), (1, true)].map(|(engine, lost)| {
        let of_class = |one: &&Judged| {
            engines(one)[engine].class == class && one.judgement.contact_lost == lost
        };
        judged.iter().filter(of_class).count()
    })
}

/// Writes `report.json` and `report.md` into `folder`.
pub(super) fn write(folder: &Path, title: &str, judged: &[Judged], seconds: f64) -> Result<()> {
    let classes = Class::ALL.map(|class| {
        let [kept, lost, kept_2, lost_2] = counts(judged, class);
        json!({
            "class": class,
            "modal": {"contact_kept": kept, "contact_lost": lost},
            "finite_difference": {"contact_kept": kept_2, "contact_lost": lost_2},
        })
    });
    let scenarios: Vec<_> = judged
        .iter()
        .map(|one| {
            let [modal, finite_difference] = engines(one);
            json!({
                "scenario": one.name,
                "modal": modal,
                "finite_difference": finite_difference,
                "contact_lost": one.judgement.contact_lost,
                "refinements": one.judgement.refinements,
                "undecided": undecided(one),
                "steady": one.steady,
                "stated_errors": one.stated,
                "wall_s": one.seconds,
            })
        })
        .collect();
    let tolerances =
        Kind::ALL.map(|kind| json!({"of": kind.words(), "tolerance": kind.tolerance()}));
    let report = json!({
        "schema": "asperity/campaign/1",
        "title": title,
        "tolerances": tolerances,
        "classes": classes,
        "scenarios": scenarios,
        "wall_s": seconds,
    });
    let text = serde_json::to_string_pretty(&report)?;
    crate::reproduce::write(&folder.join("report.json"), text.as_bytes())?;

    let class_row = |class: Class| {
        let numbers = counts(judged, class).map(|count| TableCell::Number(count.to_string()));
        [TableCell::from(class.words())].into_iter().chain(numbers).collect::<Vec<_>>()
    };
    let tolerance_row =
        |kind: Kind| vec![TableCell::from(kind.words()), TableCell::from(kind.tolerance())];
    let mut report = Report::new(format!("Campaign: {title}"))
        .section("Classes of answers")
        .table(["class"].into_iter().chain(COLUMNS), Class::ALL.map(class_row))
        .section("Tolerances")
        .table(["of", "tolerance"], Kind::ALL.map(tolerance_row));
    let rows = steady_rows(judged);
    if !rows.is_empty() {
        let paragraph = format!(
            "Relative errors: up to {LINEAR} of static pressures and responses to a small force, up \
             to {AMPLITUDE} of responses to a large force."
        );
        let headers = ["of", "class", "number"];
        report = report
            .section("State at rest and steady responses")
            .paragraph(paragraph)
            .table(headers, steady_counts(judged))
            .table(["scenario", "of", "class", "error", "remark"], rows);
    }
    if let Some(totals) = stated_totals(judged) {
        let headers = ["scenario", "observable", "error over the stated", "relative error"];
        report = report
            .section("Stated errors of modal answers")
            .paragraph(format!("{totals}. Compared with runs to an accuracy of 1e-4."))
            .table(headers, stated_rows(judged));
    }
    for class in [Class::SilentlyWrong, Class::NamedWrong] {
        let rows = wrong_rows(judged, class);
        if !rows.is_empty() {
            let headers =
                ["scenario", "engine", "observable", "answer", "truth", "error in tolerances"];
            report = report.section(class.words()).table(headers, rows);
        }
    }
    for class in [Class::Refused, Class::SilentlyUndecided, Class::NamedUndecided] {
        let rows = remark_rows(judged, class);
        if !rows.is_empty() {
            report = report.section(class.words()).table(["scenario", "engine", "remark"], rows);
        }
    }
    let markdown = report.to_markdown(ToOwned::to_owned);
    crate::reproduce::write(&folder.join("report.md"), markdown.as_bytes())
}

/// Names of the observables without a truth.
fn undecided(judged: &Judged) -> Vec<&str> {
    let unknown = judged.judgement.truth.iter().filter(|truth| !truth.known);
    unknown.map(|truth| truth.observable.name.as_str()).collect()
}

fn wrong_rows(judged: &[Judged], class: Class) -> Vec<Vec<TableCell>> {
    let mut rows = Vec::new();
    for one in judged {
        for (engine, name) in engines(one).into_iter().zip(ENGINES) {
            if engine.class != class {
                continue;
            }
            if let Some(panic) = &engine.error {
                let place = [one.name.as_str(), name, "panic", panic.as_str(), "", ""];
                rows.push(place.map(TableCell::from).to_vec());
            }
            for wrong in &engine.wrong {
                let value = |value: Option<f64>| TableCell::from(value.unwrap_or(f64::NAN));
                rows.push(vec![
                    TableCell::from(one.name.as_str()),
                    TableCell::from(name),
                    TableCell::from(wrong.name.as_str()),
                    value(wrong.value),
                    value(wrong.truth),
                    value(wrong.tolerances),
                ]);
            }
        }
    }
    rows
}

fn remark_rows(judged: &[Judged], class: Class) -> Vec<Vec<TableCell>> {
    let mut rows = Vec::new();
    for one in judged {
        for (engine, name) in engines(one).into_iter().zip(ENGINES) {
            if engine.class == class {
                let remark = match &engine.error {
                    Some(error) => error.clone(),
                    None => format!("no truth of {}", undecided(one).join(", ")),
                };
                rows.push(vec![
                    TableCell::from(one.name.as_str()),
                    TableCell::from(name),
                    TableCell::from(remark),
                ]);
            }
        }
    }
    rows
}

/// Numbers of comparisons at rest and of steady responses, by quantity and class.
fn steady_totals(judged: &[Judged]) -> Vec<(&'static str, Class, usize)> {
    let mut totals: Vec<(&'static str, Class, usize)> = Vec::new();
    for one in judged.iter().flat_map(|judged| &judged.steady) {
        match totals.iter_mut().find(|(of, class, _)| (*of, *class) == (one.of, one.class)) {
            Some((_, _, count)) => *count += 1,
            None => totals.push((one.of, one.class, 1)),
        }
    }
    totals.sort_by_key(|(of, _, _)| *of);
    totals
}

fn steady_counts(judged: &[Judged]) -> Vec<Vec<TableCell>> {
    let row = |(of, class, count): (&str, Class, usize)| {
        vec![of.into(), class.words().into(), TableCell::Number(count.to_string())]
    };
    steady_totals(judged).into_iter().map(row).collect()
}

/// Comparisons at rest and of steady responses that are not right.
fn steady_rows(judged: &[Judged]) -> Vec<Vec<TableCell>> {
    let mut rows = Vec::new();
    for one in judged {
        for steady in one.steady.iter().filter(|steady| steady.class != Class::Right) {
            rows.push(vec![
                one.name.as_str().into(),
                steady.of.into(),
                steady.class.words().into(),
                steady.error.unwrap_or(f64::NAN).into(),
                steady.remark.as_str().into(),
            ]);
        }
    }
    rows
}

/// Names and stated errors of the answers whose errors were compared, the largest ratio first.
fn stated(judged: &[Judged]) -> Vec<(&str, &StatedErrors)> {
    let compared = judged.iter().filter_map(|one| Some((one.name.as_str(), one.stated.as_ref()?)));
    let mut compared: Vec<_> = compared.collect();
    compared.sort_by(|(_, one), (_, other)| other.ratio.total_cmp(&one.ratio));
    compared
}

/// The comparison of errors of answers with the stated ones, in words.
fn stated_totals(judged: &[Judged]) -> Option<String> {
    let ratios: Vec<f64> = stated(judged).iter().map(|(_, one)| one.ratio).collect();
    let (largest, median) = (ratios.first()?, ratios[ratios.len() / 2]);
    let within = |limit: f64| ratios.iter().filter(|&&ratio| ratio <= limit).count();
    Some(format!(
        "{} answers: largest error over the stated one {} at the median, {} at most; within it {}, within \
         twice it {}",
        ratios.len(),
        four_digits(median),
        four_digits(*largest),
        within(1.0),
        within(2.0)
    ))
}

/// Answers with an error beyond the stated one.
fn stated_rows(judged: &[Judged]) -> Vec<Vec<TableCell>> {
    let beyond = stated(judged).into_iter().take_while(|(_, one)| one.ratio > 1.0);
    let row = |(name, one): (&str, &StatedErrors)| {
        vec![name.into(), one.observable.as_str().into(), one.ratio.into(), one.relative.into()]
    };
    beyond.map(row).collect()
}

/// Prints the classes and every silently wrong answer.
pub(super) fn print(title: &str, judged: &[Judged], folder: &Path, seconds: f64) {
    println!("campaign: {title}, {seconds:.0} s: {}", folder.join("report.md").display());
    let heading = ["modal: kept", "lost", "cells: kept", "lost"].map(|name| format!("{name:>12}"));
    println!("{:<20}{}", "contact", heading.concat());
    for class in Class::ALL {
        let numbers = counts(judged, class).map(|count| format!("{count:>12}"));
        println!("{:<20}{}", class.words(), numbers.concat());
    }
    for (of, class, count) in steady_totals(judged) {
        println!("{of}: {} {count}", class.words());
    }
    if let Some(totals) = stated_totals(judged) {
        println!("stated errors of modal answers: {totals}");
    }
    for one in judged {
        for steady in one.steady.iter().filter(|steady| steady.class == Class::SilentlyWrong) {
            let error = steady.error.map_or("all".to_owned(), four_digits);
            println!("{} {}: off by {error}; {}", one.name, steady.of, steady.remark);
        }
        for (engine, name) in engines(one).into_iter().zip(ENGINES) {
            if engine.class != Class::SilentlyWrong {
                continue;
            }
            if let Some(panic) = &engine.error {
                println!("{} {name}: panic: {panic}", one.name);
            }
            if let Some(wrong) = engine.wrong.first() {
                let shown = |value: Option<f64>| value.map_or("none".to_owned(), four_digits);
                println!(
                    "{} {name}: {} is {}, truth {}, off by {} tolerances",
                    one.name,
                    wrong.name,
                    shown(wrong.value),
                    shown(wrong.truth),
                    wrong.tolerances.map_or("all".to_owned(), four_digits)
                );
            }
        }
    }
}
