//! Lines of a deck to blocks of nodes, elements, sets and surfaces.

use std::borrow::Cow;
use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::keyword::Keyword;
use super::sets::{FileLine, Member, Sets, SurfaceItem, Written, malformed};
use super::{Deck, MeshElement};
use crate::error::{Place, excerpt};
use crate::text::{Content, Lines, number, whole};
use crate::{ElementKind, MatricesError};

/// Most files that include each other.
const DEEPEST: usize = 10;

/// Block of data lines after a keyword.
enum Block {
    Nodes { set: Option<String> },
    Elements { kind: ElementKind, set: Option<String>, open: Option<MeshElement> },
    NodeSet { name: String, range: bool },
    ElementSet { name: String, range: bool },
    Surface { name: String },
    Skipped,
}

/// Parses a deck; included files are in `folder`, if there is one.
pub(super) fn parse(content: Content, folder: Option<&Path>) -> Result<Deck, MatricesError> {
    let name = content.name.clone();
    let mut parser = Parser {
        files: vec![Lines::new(content)],
        folder: folder.map(Path::to_owned),
        written: Written::default(),
        numbers: HashSet::new(),
    };
    parser.run()?;
    if parser.written.nodes.count() == 0 {
        let what = format!("{name}: no nodes");
        return Err(MatricesError::inconsistent(
            what,
            "expected *NODE and lines `number, x, y, z`",
        ));
    }
    parser.written.resolve(name)
}

struct Parser {
    /// The file that is read, after the files that include it.
    files: Vec<Lines>,
    folder: Option<PathBuf>,
    written: Written,
    /// Numbers of the elements.
    numbers: HashSet<i64>,
}

impl Parser {
    fn run(&mut self) -> Result<(), MatricesError> {
        let mut block = Block::Skipped;
        let mut place = (Arc::from(""), 0);
        let (mut line, mut next) = (Vec::new(), Vec::new());
        while self.next_line(&mut line, &mut place)? {
            if !line.starts_with(b"*") {
                self.data(&mut block, &line, &place)?;
                continue;
            }
            self.close(&mut block, &place)?;
            // A keyword line that ends with a comma continues.
            while line.ends_with(b",") && self.next_line(&mut next, &mut place)? {
                line.extend_from_slice(&next);
            }
            block = self.keyword(&Keyword::parse(&String::from_utf8_lossy(&line)), &place)?;
        }
        self.close(&mut block, &place)
    }

    /// Takes the next line that is neither empty nor a comment into `taken`, without blanks at its ends, and its place into
    /// `place`; false after the last one.
    fn next_line(
        &mut self,
        taken: &mut Vec<u8>,
        place: &mut FileLine,
    ) -> Result<bool, MatricesError> {
        while let Some(file) = self.files.last_mut() {
            let Some(line) = file.next()? else {
                self.files.pop();
                continue;
            };
            let line = line.trim_ascii();
            if line.is_empty() || line.starts_with(b"**") {
                continue;
            }
            taken.clear();
            taken.extend_from_slice(line);
            if *place.0 != *file.name {
                place.0 = Arc::from(file.name.as_str());
            }
            place.1 = file.line;
            return Ok(true);
        }
        Ok(false)
    }

    fn keyword(&mut self, keyword: &Keyword, place: &FileLine) -> Result<Block, MatricesError> {
        if let Some((feature, remedy)) = keyword.obstacle() {
            return Err(unsupported(place, feature, remedy));
        }
        let label = |key: &str| {
            keyword.label(key).ok_or_else(|| {
                let found = format!("*{} without {key}", keyword.name);
                malformed(place, found, format!("`*{}, {key}=...`", keyword.name))
            })
        };
        let range = keyword.has("GENERATE");
        Ok(match keyword.name.as_str() {
            "NODE" => Block::Nodes { set: keyword.label("NSET") },
            "ELEMENT" => {
                let kind = ElementKind::of_type(&label("TYPE")?);
                Block::Elements { kind, set: keyword.label("ELSET"), open: None }
            }
            "NSET" => {
                let name = label("NSET")?;
                let members = self.written.node_sets.entry(name.clone()).or_default();
                if let Some(elements) = keyword.label("ELSET") {
                    members.push((Member::NodesOf(elements), place.clone()));
                }
                Block::NodeSet { name, range }
            }
            "ELSET" => {
                let name = label("ELSET")?;
                self.written.element_sets.entry(name.clone()).or_default();
                Block::ElementSet { name, range }
            }
            "SURFACE" => {
                let name = label("NAME")?;
                let kind = keyword.label("TYPE").unwrap_or_else(|| "ELEMENT".into());
                if kind != "ELEMENT" || keyword.has("COMBINE") {
                    let how =
                        if kind == "ELEMENT" { "COMBINE".into() } else { format!("TYPE={kind}") };
                    let why = format!("is given by {how} (line {})", place.1);
                    self.written.faceless.insert(name, why);
                    return Ok(Block::Skipped);
                }
                self.written.surfaces.entry(name.clone()).or_default();
                Block::Surface { name }
            }
            "TRANSFORM" => {
                self.written.transforms.push((label("NSET")?, place.clone()));
                Block::Skipped
            }
            "INCLUDE" => {
                self.include(keyword, place)?;
                Block::Skipped
            }
            _ => Block::Skipped,
        })
    }

    fn include(&mut self, keyword: &Keyword, place: &FileLine) -> Result<(), MatricesError> {
        let name = keyword.value("INPUT").unwrap_or_default();
        let Some(folder) = self.folder.as_ref().filter(|_| !name.is_empty()) else {
            let remedy = "write the lines of the included file into the deck";
            return Err(unsupported(place, format!("*INCLUDE of `{name}`"), remedy));
        };
        if self.files.len() >= DEEPEST {
            let found = format!("*INCLUDE of `{name}` at level {DEEPEST}");
            return Err(malformed(
                place,
                found,
                "files that do not include each other in a circle",
            ));
        }
        let content = Content::open(&folder.join(name)).map_err(|error| {
            malformed(place, format!("*INCLUDE of `{name}`: {error}"), "a file beside the deck")
        })?;
        self.files.push(Lines::new(content));
        Ok(())
    }

    fn data(
        &mut self,
        block: &mut Block,
        line: &[u8],
        place: &FileLine,
    ) -> Result<(), MatricesError> {
        let wrong = |expected: &str| Err(malformed(place, excerpt(line), expected));
        let mut fields = line.split(|byte| *byte == b',').map(<[u8]>::trim_ascii);
        match block {
            Block::Skipped => {}
            Block::Nodes { set } => {
                let node = fields.next().and_then(whole);
                let mut coordinate = || match fields.next() {
                    None | Some(b"") => Some(0.0),
                    Some(field) => number(field),
                };
                let coordinates = [coordinate(), coordinate(), coordinate()];
                let (Some(node), [Some(x), Some(y), Some(z)]) = (node, coordinates) else {
                    return wrong("`node, x, y, z`");
                };
                if self.written.nodes.insert(node, [x, y, z]).is_some_and(|old| old != [x, y, z]) {
                    return wrong("each node once");
                }
                if let Some(set) = set {
                    extend(&mut self.written.node_sets, set, node, place);
                }
            }
            Block::Elements { kind, open, .. } => {
                let continues = line.ends_with(b",");
                let numbers: Option<Vec<i64>> =
                    fields.filter(|field| !field.is_empty()).map(whole).collect();
                let Some(numbers) = numbers.filter(|numbers| !numbers.is_empty()) else {
                    return wrong("`element, node, node, ...`, whole numbers");
                };
                let element = if let Some(element) = open {
                    element.nodes.extend(&numbers);
                    element
                } else {
                    let (number, nodes) = (numbers[0], numbers[1..].to_vec());
                    open.insert(MeshElement { number, kind: *kind, nodes })
                };
                let complete = match kind.nodes() {
                    Some(count) => element.nodes.len() >= count,
                    None => !continues,
                };
                if complete {
                    self.close(block, place)?;
                }
            }
            Block::NodeSet { name, range } => {
                let set = self.written.node_sets.entry(name.clone()).or_default();
                return members(set, fields, *range, line, place);
            }
            Block::ElementSet { name, range } => {
                let set = self.written.element_sets.entry(name.clone()).or_default();
                return members(set, fields, *range, line, place);
            }
            Block::Surface { name } => {
                let (Some(elements), Some(face)) = (fields.next(), fields.next()) else {
                    return wrong("`element, face` or `set, face`, with faces S1 to S6");
                };
                let elements = member(elements);
                let item = SurfaceItem { elements, face: text(face).to_uppercase() };
                let items = self.written.surfaces.entry(name.clone()).or_default();
                items.push((item, place.clone()));
            }
        }
        Ok(())
    }

    /// Ends the element that is being read, if there is one.
    fn close(&mut self, block: &mut Block, place: &FileLine) -> Result<(), MatricesError> {
        let Block::Elements { kind, set, open } = block else { return Ok(()) };
        let Some(element) = open.take() else { return Ok(()) };
        if let Some(count) = kind.nodes().filter(|count| *count != element.nodes.len()) {
            let found = format!("element {} with {} nodes", element.number, element.nodes.len());
            return Err(malformed(
                place,
                found,
                format!("{count} nodes, by the type of the element"),
            ));
        }
        if !self.numbers.insert(element.number) {
            return Err(malformed(
                place,
                format!("element {} again", element.number),
                "each element once",
            ));
        }
        if let Some(set) = set {
            extend(&mut self.written.element_sets, set, element.number, place);
        }
        self.written.element_lines.push(place.clone());
        self.written.elements.push(element);
        Ok(())
    }
}

/// Adds a number to the set `name`, as part of the range before it if it follows on it.
fn extend(sets: &mut Sets, name: &str, number: i64, place: &FileLine) {
    if !sets.contains_key(name) {
        sets.insert(name.to_owned(), Vec::new());
    }
    let Some(set) = sets.get_mut(name) else { return };
    if let Some((Member::Range(_, last, 1), _)) = set.last_mut()
        && *last + 1 == number
    {
        *last = number;
        return;
    }
    set.push((Member::Range(number, number, 1), place.clone()));
}

/// A number, or the name of a set.
fn member(field: &[u8]) -> Member {
    match whole(field) {
        Some(number) => Member::Number(number),
        None => Member::Set(text(field).trim_matches('"').to_uppercase()),
    }
}

fn text(field: &[u8]) -> Cow<'_, str> {
    String::from_utf8_lossy(field)
}

/// Adds the members of a data line to a set.
fn members<'a>(
    set: &mut Vec<(Member, FileLine)>,
    fields: impl Iterator<Item = &'a [u8]>,
    range: bool,
    line: &[u8],
    place: &FileLine,
) -> Result<(), MatricesError> {
    let fields: Vec<&[u8]> = fields.filter(|field| !field.is_empty()).collect();
    if !range {
        set.extend(fields.iter().map(|field| (member(field), place.clone())));
        return Ok(());
    }
    let numbers: Option<Vec<i64>> = fields.iter().copied().map(whole).collect();
    let (first, last, step) = match numbers.as_deref() {
        Some(&[first, last]) => (first, last, 1),
        Some(&[first, last, step]) => (first, last, step),
        _ => (0, -1, 1),
    };
    if first > last || step < 1 {
        let expected = "`first, last, step` with first <= last and step >= 1, after GENERATE";
        return Err(malformed(place, excerpt(line), expected));
    }
    set.push((Member::Range(first, last, step), place.clone()));
    Ok(())
}

fn unsupported((file, line): &FileLine, feature: String, remedy: &str) -> MatricesError {
    let place = Place::Line(*line);
    MatricesError::Unsupported { file: file.to_string(), place, feature, remedy: remedy.to_owned() }
}
