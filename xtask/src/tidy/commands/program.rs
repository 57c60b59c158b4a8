//! A program's subcommands and their options.

use std::collections::{BTreeMap, BTreeSet};
use std::process::{Command, Stdio};

use anyhow::{Context, Result, ensure};
use cargo_metadata::Message;

use super::{ENDS, option};
use crate::workspace::cargo;

/// Options that every command has.
const EVERYWHERE: [&str; 2] = ["--help", "--version"];

/// A program with its subcommands and their options.
#[derive(Debug, Clone)]
pub(crate) struct Program {
    name: String,
    /// Options by subcommand; that of a subcommand follows its name after a space.
    commands: BTreeMap<String, BTreeSet<String>>,
}

impl Program {
    /// The workspace's binary `name`, built and asked for its help.
    pub(crate) fn built(name: &str) -> Result<Self> {
        // Features as in the other tasks, so that nothing is built twice.
        let output = cargo(&["build", "--quiet", "--workspace", "--bin", name])
            .arg("--message-format=json-render-diagnostics")
            .stderr(Stdio::inherit())
            .output()
            .context("cannot run cargo build")?;
        ensure!(output.status.success(), "cannot build {name}");
        let executable = Message::parse_stream(&output.stdout[..])
            .filter_map(|message| match message {
                Ok(Message::CompilerArtifact(artifact)) if artifact.target.name == name => {
                    artifact.executable
                }
                _ => None,
            })
            .last()
            .with_context(|| format!("cargo built no {name}"))?;
        Self::of_help(name, |words| {
            let output = Command::new(executable.as_std_path())
                .args(words)
                .output()
                .with_context(|| format!("cannot run {name}"))?;
            Ok(String::from_utf8_lossy(&output.stdout).into_owned())
        })
    }

    /// The program that prints such help when called with `help` and with
    /// `help` and a subcommand.
    pub(crate) fn of_help(name: &str, help: impl Fn(&[&str]) -> Result<String>) -> Result<Self> {
        let mut commands = BTreeMap::new();
        for command in subcommands(&help(&["help"])?) {
            let text = help(&["help", &command])?;
            for nested in subcommands(&text) {
                let text = help(&["help", &command, &nested])?;
                commands.insert(format!("{command} {nested}"), options(&text));
            }
            commands.insert(command, options(&text));
        }
        Ok(Self { name: name.to_owned(), commands })
    }

    /// The program that `command` parses the arguments of.
    pub(crate) fn of_clap(name: &str, command: &clap::Command) -> Self {
        let options = |command: &clap::Command| {
            let named = command.get_arguments().filter_map(clap::Arg::get_long);
            named.map(|long| format!("--{long}")).collect()
        };
        let commands = command
            .get_subcommands()
            .map(|command| (command.get_name().to_owned(), options(command)))
            .collect();
        Self { name: name.to_owned(), commands }
    }

    /// True if any subcommand has this option.
    pub(crate) fn has_option(&self, option: &str) -> bool {
        EVERYWHERE.contains(&option) || self.commands.values().any(|known| known.contains(option))
    }

    /// The arguments that a command line gives this program, if it calls it.
    pub(crate) fn arguments<'a>(&self, words: &'a [String]) -> Option<Vec<&'a str>> {
        let name: Vec<&str> = self.name.split(' ').collect();
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        let is_name = |part: &[&str]| {
            let (given, own) = (part[0], name[0]);
            let same = given == own || given.rsplit('/').next() == Some(own);
            same && part[1..] == name[1..]
        };
        let start = if words.starts_with(&["cargo", "run"]) {
            let separator = words.iter().position(|word| *word == "--")?;
            words[..separator].iter().any(|word| *word == self.name).then_some(separator + 1)?
        } else {
            let calls = |at: &usize| *at == 0 || ENDS.contains(&words[at - 1]);
            let at = (0..(words.len() + 1).saturating_sub(name.len()))
                .filter(calls)
                .find(|&at| is_name(&words[at..at + name.len()]))?;
            at + name.len()
        };
        let ends = |word: &&str| ENDS.contains(word);
        let rest = words[start..].iter().copied();
        Some(rest.take_while(|word| !ends(word)).collect())
    }

    /// The first fault of these arguments, if any.
    pub(crate) fn wrong(&self, arguments: &[&str]) -> Option<String> {
        let name = &self.name;
        let (first, rest) = arguments.split_first()?;
        let placeholder = first.starts_with(['<', '[', '…']) || first.contains("...");
        let placeholder = placeholder || first.chars().all(|c| c.is_ascii_uppercase());
        if placeholder || *first == "help" || EVERYWHERE.contains(first) {
            return None;
        }
        let nested = rest.first().map(|second| format!("{first} {second}"));
        let nested = nested.filter(|nested| self.commands.contains_key(nested));
        let first = nested.unwrap_or_else(|| (*first).to_owned());
        let Some(known) = self.commands.get(&first) else {
            return Some(format!("there is no `{name} {first}`"));
        };
        let options = rest.iter().take_while(|word| **word != "--").filter_map(|word| option(word));
        let unknown =
            options.into_iter().find(|word| !known.contains(*word) && !EVERYWHERE.contains(word));
        unknown.map(|word| format!("`{name} {first}` has no {word}"))
    }
}

/// The subcommands that a help lists.
fn subcommands(help: &str) -> Vec<String> {
    let listed = help.lines().skip_while(|line| *line != "Commands:").skip(1);
    // Names stand two spaces in; further lines of a description stand further in.
    let names = listed
        .take_while(|line| !line.is_empty())
        .filter_map(|line| line.strip_prefix("  ").filter(|rest| !rest.starts_with(' ')))
        .filter_map(|rest| rest.split_whitespace().next());
    names.filter(|name| *name != "help").map(str::to_owned).collect()
}

/// The options that a help declares.
fn options(help: &str) -> BTreeSet<String> {
    let declared = help.lines().map(str::trim_start).filter(|line| line.starts_with('-'));
    declared
        .filter_map(|line| line.split_whitespace().take(2).find_map(option))
        .map(str::to_owned)
        .collect()
}
