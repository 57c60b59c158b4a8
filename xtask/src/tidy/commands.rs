//! The rule of commands: every command and option named in the documents exists.

mod program;

use super::Finding;
use super::markdown::{Piece, pieces};
use super::repository::Repository;

pub(super) use program::Program;

/// Languages of code blocks that hold commands; empty for a block without one.
const SHELLS: [&str; 5] = ["", "sh", "bash", "shell", "console"];

/// Words that end the arguments of a command.
const ENDS: [&str; 7] = ["|", "||", "&&", ";", ">", ">>", "#"];

/// Options of other programs that documents may name by themselves.
const FOREIGN: [&str; 3] = ["--release", "--workspace", "--locked"];

/// Every subcommand and option of `programs` that a document names exists.
pub(super) fn unknown(repository: &Repository, programs: &[Program]) -> Vec<Finding> {
    let mut found = Vec::new();
    // The CHANGELOG speaks of commands as they were.
    for (path, text) in repository.texts(".md").filter(|(path, _)| *path != "CHANGELOG.md") {
        for (line, command) in commands(text) {
            for program in programs {
                let wrong = program.arguments(&command).and_then(|words| program.wrong(&words));
                found.extend(wrong.map(|message| Finding::at(path, line, message)));
            }
            let first = command.first().map_or("", String::as_str);
            if first.starts_with("--")
                && let Some(option) = option(first)
                && !FOREIGN.contains(&option)
                && !programs.iter().any(|program| program.has_option(option))
            {
                found.push(Finding::at(path, line, format!("no command has {option}")));
            }
        }
    }
    found
}

/// Commands in code spans and in the shell blocks of a document, as words.
fn commands(text: &str) -> Vec<(usize, Vec<String>)> {
    let mut found: Vec<(usize, Vec<String>)> = Vec::new();
    let mut continued = false;
    for (number, piece) in pieces(text) {
        let (line, joined) = match piece {
            Piece::Span(span) => (span, false),
            Piece::Block { language, line } if SHELLS.contains(&language) => {
                let typed = line.trim_start();
                let prompted = typed.strip_prefix("$ ");
                // In a session, what has no prompt is output.
                if language == "console" && prompted.is_none() && !continued {
                    continue;
                }
                (prompted.unwrap_or(typed), continued)
            }
            Piece::Prose(_) | Piece::Block { .. } => continue,
        };
        let more = line.trim_end().strip_suffix('\\');
        let words = more.unwrap_or(line).split_whitespace().map(str::to_owned);
        match found.last_mut() {
            Some((_, last)) if joined => last.extend(words),
            _ => found.push((number, words.collect())),
        }
        continued = more.is_some();
    }
    found
}

/// The option in a word such as `[--json]` or `--set=x`; none in `--` itself.
fn option(word: &str) -> Option<&str> {
    let start = word.trim_start_matches(['[', '(']);
    let name = start.strip_prefix("--")?;
    let length = name.find(|c: char| !c.is_ascii_alphanumeric() && c != '-').unwrap_or(name.len());
    (length > 0).then(|| &start[..length + 2])
}

#[cfg(test)]
mod tests {
    use super::*;

    const HELP: &str = "The command\n\nUsage: asperity <COMMAND>\n\nCommands:\n  \
        simulate  One transient run,\n            wrapped\n  sweep     Many\n  study     Any\n  help      Print\n\n\
        Options:\n  -h, --help  Print help\n";

    fn asperity() -> Program {
        let help = |words: &[&str]| {
            Ok(match words {
                ["help", "simulate"] => {
                    "Options:\n      --set <POINTER=VALUE>  x\n  -v, --verbose...\n"
                }
                ["help", "sweep"] => "Options:\n      --vary <X>  like --set\n",
                ["help", "study"] => {
                    "Commands:\n  slurm  A script\n  help   Print\n\nOptions:\n      --resume  x\n"
                }
                ["help", "study", "slurm"] => "Options:\n      --shards <N>  x\n",
                _ => HELP,
            }
            .to_owned())
        };
        Program::of_help("asperity", help).unwrap()
    }

    fn found(text: &str) -> Vec<String> {
        let repository = Repository::of(&[("docs/src/a.md", text)]);
        unknown(&repository, &[asperity()]).into_iter().map(|finding| finding.message).collect()
    }

    #[test]
    fn what_exists_passes() {
        let text = "`asperity simulate`, `asperity`, `asperity-law`, `--vary`, `asperity COMMAND`\n\
            `asperity study slurm a.json --shards 8`, `asperity study a.json --resume`, `--shards`\n\
            ```console\n$ asperity simulate a.json \\\n    --set /x=1 --verbose | less --no-init\n\
            asperity --nonsense is output\n$ asperity --version\n```\n\
            ```json\nasperity lost\n```\n\
            ```sh\ncargo run --release --bin asperity -- sweep a.json --vary /x=1:2:3\n```\n";
        assert_eq!(found(text), [""; 0]);
    }

    #[test]
    fn an_unknown_subcommand_is_found() {
        assert_eq!(found("`asperity swepe x`"), ["there is no `asperity swepe`"]);
        assert_eq!(found("```sh\n./target/release/asperity run x\n```").len(), 1);
        assert_eq!(found("```sh\ncargo run --bin asperity -- run x\n```").len(), 1);
    }

    #[test]
    fn an_unknown_option_is_found() {
        let text = "```sh\nasperity simulate a.json \\\n  --vary=/x=1\n```";
        assert_eq!(found(text), ["`asperity simulate` has no --vary"]);
        assert_eq!(found("Use `--sett`."), ["no command has --sett"]);
        assert_eq!(found("`asperity study a --shards 8`"), ["`asperity study` has no --shards"]);
        assert_eq!(
            found("`asperity study slurm a --resume`"),
            ["`asperity study slurm` has no --resume"]
        );
    }
}
