//! Lines on standard input while a folder is watched.

use std::io::{BufRead, IsTerminal, stdin};
use std::sync::mpsc::{Receiver, channel};

/// A line of standard input.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Command {
    /// `reject 3,7`.
    Reject(Vec<usize>),
    /// `keep 3`.
    Keep(Vec<usize>),
    /// Any other text.
    Unknown(String),
}

impl Command {
    /// The command of a line; `None` for an empty one.
    fn of(line: &str) -> Option<Self> {
        let line = line.trim();
        let (word, numbers) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        let numbers = numbers.split([',', ' ']).filter(|text| !text.is_empty());
        let numbers: Option<Vec<usize>> =
            numbers.map(|text| text.trim_start_matches('#').parse().ok()).collect();
        match (word, numbers.filter(|numbers| !numbers.is_empty())) {
            ("", _) => None,
            ("reject" | "r", Some(numbers)) => Some(Self::Reject(numbers)),
            ("keep" | "k", Some(numbers)) => Some(Self::Keep(numbers)),
            _ => Some(Self::Unknown(line.to_owned())),
        }
    }
}

/// Commands as they come; none in a job in the background, which the terminal would stop.
pub(super) fn of_standard_input() -> Receiver<Command> {
    let (sender, commands) = channel();
    if !(stdin().is_terminal() && is_in_background()) {
        // Ends with the input, or with the command.
        std::thread::spawn(move || {
            for line in stdin().lock().lines().map_while(Result::ok) {
                if Command::of(&line).is_some_and(|command| sender.send(command).is_err()) {
                    break;
                }
            }
        });
    }
    commands
}

/// True if the terminal belongs to another group of processes, as far as the system tells.
fn is_in_background() -> bool {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    // The name before the last bracket may have blanks. Then: state, parent, group, session, terminal,
    // and the group that the terminal belongs to, -1 without a terminal.
    let mut fields = stat.rsplit(')').next().unwrap_or_default().split_ascii_whitespace();
    let group = fields.nth(2);
    let of_terminal = fields.nth(2);
    of_terminal.is_some_and(|of_terminal| of_terminal != "-1" && group != Some(of_terminal))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_commands() {
        assert_eq!(Command::of(" reject 3,7 "), Some(Command::Reject(vec![3, 7])));
        assert_eq!(Command::of("keep #3 4"), Some(Command::Keep(vec![3, 4])));
        assert_eq!(Command::of(""), None);
        for text in ["reject", "reject x", "3"] {
            assert_eq!(Command::of(text), Some(Command::Unknown(text.to_owned())));
        }
    }
}
