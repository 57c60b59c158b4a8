//! File names that every file system accepts, made from names that people give.

use std::collections::HashSet;

/// Longest name in bytes; the rest of a file's name and its extension come in addition.
const MAX_BYTES: usize = 120;

/// Characters that some file systems refuse.
const REFUSED: [char; 9] = ['/', '\\', ':', '*', '?', '"', '<', '>', '|'];

/// `name` as a file name, or a part of one.
///
/// Characters that a file system refuses or that no one sees, such as control characters and those
/// that change the direction of the text, become hyphens; dots and spaces at the ends go; the name of
/// a device of Windows, such as `con` or `nul.txt`, gets an underscore.
///
/// ```
/// use asperity_simulation::output::file_name::file_name;
///
/// assert_eq!(file_name("modified, 2"), "modified, 2");
/// assert_eq!(file_name("a/b\u{202e}c. "), "a-b-c");
/// assert_eq!(file_name("con"), "con_");
/// ```
pub fn file_name(name: &str) -> String {
    let is_bad = |c: char| c.is_control() || REFUSED.contains(&c) || is_format(c);
    let plain: String = name.chars().map(|c| if is_bad(c) { '-' } else { c }).collect();
    let mut end = plain.len().min(MAX_BYTES);
    while !plain.is_char_boundary(end) {
        end -= 1;
    }
    let plain = plain[..end].trim_matches(|c: char| c == '.' || c.is_whitespace());
    if plain.is_empty() {
        return "unnamed".to_owned();
    }
    let (stem, rest) = plain.split_at(plain.find('.').unwrap_or(plain.len()));
    if is_device(stem.trim_end()) { format!("{stem}_{rest}") } else { plain.to_owned() }
}

/// [`file_name`]s of `names`, in their order. They differ, upper and lower case counted as equal: a
/// later name that would repeat one gets a number.
pub fn distinct_file_names<'a>(names: impl IntoIterator<Item = &'a str>) -> Vec<String> {
    let mut taken = HashSet::new();
    let distinct = |name: &str| {
        let name = file_name(name);
        let numbered = (2..).map(|number| format!("{name}-{number}"));
        let mut candidates = std::iter::once(name.clone()).chain(numbered);
        candidates.find(|candidate| taken.insert(candidate.to_lowercase())).unwrap_or(name)
    };
    names.into_iter().map(distinct).collect()
}

/// True for names of devices, which Windows opens in place of a file.
fn is_device(stem: &str) -> bool {
    let stem = stem.to_lowercase();
    let numbered = |kind: &str| {
        let number = stem.strip_prefix(kind).unwrap_or_default();
        number.chars().count() == 1
            && number.contains(|c: char| c.is_ascii_digit() || "¹²³".contains(c))
    };
    let named = ["con", "prn", "aux", "nul", "conin$", "conout$", "clock$"];
    named.contains(&stem.as_str()) || numbered("com") || numbered("lpt")
}

/// True for format characters of Unicode (category Cf), which are not seen: joiners, marks of
/// direction, tags.
fn is_format(c: char) -> bool {
    matches!(
        c,
        '\u{ad}' | '\u{600}'..='\u{605}' | '\u{61c}' | '\u{6dd}' | '\u{70f}' | '\u{180e}'
            | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}'
            | '\u{feff}' | '\u{fff9}'..='\u{fffb}' | '\u{e0001}'..='\u{e007f}'
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_people_stay_as_they_are() {
        for name in
            ["modified", "guide-sample", "Käfer 2 (neu)", "μ_0.35", "console", "a.con", "法則"]
        {
            assert_eq!(file_name(name), name);
        }
    }

    #[test]
    fn names_that_a_file_system_refuses_or_that_deceive_are_changed() {
        for (name, expected) in [
            ("con", "con_"),
            ("NUL", "NUL_"),
            ("nul.2.csv", "nul_.2.csv"),
            ("com1", "com1_"),
            ("LPT³", "LPT³_"),
            ("aux .x", "aux _.x"),
            ("law. .", "law"),
            (" .hidden", "hidden"),
            ("..", "unnamed"),
            ("", "unnamed"),
            ("../../etc/passwd", "-..-etc-passwd"),
            ("C:\\x", "C--x"),
            ("exe\u{202e}gpj", "exe-gpj"),
            ("a\u{200b}b\u{0}c\u{85}d\u{feff}", "a-b-c-d-"),
        ] {
            assert_eq!(file_name(name), expected, "{name:?}");
        }
        let long = file_name(&"é".repeat(1000));
        assert!(long.len() <= MAX_BYTES && long.starts_with("éé"));
    }

    #[test]
    fn names_that_would_share_a_file_get_numbers() {
        let names = ["a:b", "a*b", "A-B", "a-b-2", "other"];
        assert_eq!(distinct_file_names(names), ["a-b", "a-b-2", "A-B-3", "a-b-2-2", "other"]);
    }
}
