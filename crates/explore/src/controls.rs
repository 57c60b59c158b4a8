//! Values of a scenario that can be changed, found by walking its JSON Schema beside its values: a key that is new in
//! the schema appears by itself.

use asperity_law::{Draw, LawSpec};
use asperity_plot::pointer_words;
use asperity_scenario::{AnyScenario, Document, four_digits};
use asperity_simulation::laws::ScenarioLaws;
use asperity_simulation::static_state::StaticSummary;
use serde::Serialize;
use serde_json::{Map, Value, json};

/// Controls under one heading.
#[derive(Debug, Serialize)]
pub(crate) struct Group {
    title: String,
    /// True for a group that is shown open at first.
    open: bool,
    controls: Vec<Control>,
}

/// A value that can be changed.
#[derive(Debug, Serialize)]
pub(crate) struct Control {
    pointer: String,
    label: String,
    /// Meaning of the value, from the schema.
    help: String,
    #[serde(flatten)]
    kind: Kind,
}

#[derive(Debug, Serialize)]
#[serde(tag = "control", rename_all = "snake_case")]
enum Kind {
    /// A number with its unit; without a value where the scenario leaves it out.
    Number {
        value: Option<f64>,
        unit: &'static str,
        whole: bool,
        /// Range of the slider at first.
        low: f64,
        high: f64,
        log: bool,
    },
    Flag {
        value: bool,
    },
    /// One of several values.
    Choice {
        chosen: String,
        options: Vec<Choice>,
    },
    /// Pairs of a pressure and a stiffness, or of a time and a force.
    Pairs {
        value: Vec<[f64; 2]>,
        /// Names of both numbers with their units.
        columns: [&'static str; 2],
        /// True where stiffnesses increase too.
        increasing: bool,
        /// True for a force over time, which can be drawn.
        pulse: bool,
    },
}

#[derive(Debug, Serialize)]
struct Choice {
    label: String,
    value: Value,
}

/// Values of keys that a newly chosen kind needs and the scenario does not have.
const USUAL: [(&str, f64); 11] = [
    ("peak_n", 10.0),
    ("amplitude_n", 1.0),
    ("rise_s", 3e-4),
    ("duration_s", 1e-3),
    ("frequency_hz", 500.0),
    ("stiffness_n_per_m", 1e8),
    ("mass_kg", 1.0),
    ("damping_ratio", 0.02),
    ("ratio", 0.03),
    ("time_s", 1e-6),
    ("slip_force_n", 1.0),
];

/// Pressure \[Pa\] and stiffness \[Pa/m\] of a newly chosen law where the state at rest is not known.
const USUAL_CONTACT: (f64, f64) = (1e5, 1e12);

/// Stiffness of a newly chosen layer over that of the law.
const LAYER: f64 = 10.0;

/// Endings of keys whose sliders are logarithmic.
const LOGARITHMIC: [&str; 6] =
    ["coefficient", "_per_m", "_pa", "_per_m3", "length_m", "height_rms_m"];

/// Ranges of sliders over the value of the file.
const LINEAR_HIGH: f64 = 3.0;
const LOG_FACTOR: f64 = 30.0;

/// The controls of a document; `base` is the document of the file, which the ranges of sliders go by, and `at_rest` its
/// state at rest where it is a structure of matrices.
pub(crate) fn groups(
    schema: &Value,
    document: &Document,
    base: &Document,
    at_rest: Option<&StaticSummary>,
) -> Vec<Group> {
    let contacts = contacts(document, at_rest);
    let walker = Walker { schema, document, base: base.value(), contacts };
    let value = document.value();
    let names = |list: &str| -> Vec<String> {
        let items = value.get(list).and_then(Value::as_array).into_iter().flatten();
        let name = |(index, item): (usize, &Value)| {
            let name = item.get("name").and_then(Value::as_str);
            name.map_or_else(|| (index + 1).to_string(), str::to_owned)
        };
        items.enumerate().map(name).collect()
    };
    let mut groups = Vec::new();
    let mut add = |title: String, open: bool, keys: &[String]| {
        let mut controls = Vec::new();
        for pointer in keys {
            walker.walk_at(pointer, &mut controls);
        }
        if !controls.is_empty() {
            groups.push(Group { title, open, controls });
        }
    };
    add("Excitation".to_owned(), true, &["/excitation".to_owned()]);
    let laws = value.get("laws").and_then(Value::as_object);
    let mut laws: Vec<&String> = laws.into_iter().flat_map(Map::keys).collect();
    let is_used = |name: &str| uses(value.get("interfaces"), name);
    laws.sort_by_key(|name| !is_used(name));
    for name in laws {
        let place = format!("/laws/{}", escaped(name));
        add(format!("Law {name}"), is_used(name), &[place]);
    }
    for (list, noun, open) in [
        ("interfaces", "Interface", true),
        ("bodies", "Body", false),
        ("loads", "Load", false),
        ("springs", "Spring", false),
        ("sensors", "Sensor", false),
    ] {
        for (index, name) in names(list).into_iter().enumerate() {
            add(format!("{noun} {name}"), open, &[format!("/{list}/{index}")]);
        }
    }
    add("Damping".to_owned(), true, &["/damping".to_owned()]);
    add("Support".to_owned(), false, &["/support".to_owned()]);
    let shown = ["excitation", "laws", "interfaces", "bodies", "loads", "springs", "sensors"];
    let shown = [&shown[..], &["damping", "support"]].concat();
    let properties = schema.get("properties").and_then(Value::as_object);
    let rest = properties.into_iter().flat_map(Map::keys);
    let rest = rest.filter(|key| !shown.contains(&key.as_str()));
    let rest: Vec<String> = rest.map(|key| format!("/{}", escaped(key))).collect();
    add("Run".to_owned(), false, &rest);
    groups
}

/// True if a law is named somewhere in a value.
fn uses(value: Option<&Value>, name: &str) -> bool {
    match value {
        Some(Value::Array(items)) => items.iter().any(|item| uses(Some(item), name)),
        Some(Value::Object(object)) => object.iter().any(|(key, inner)| match inner {
            Value::String(text) => key == "law" && text == name,
            inner => uses(Some(inner), name),
        }),
        _ => false,
    }
}

/// Pressure and stiffness at rest of each named law.
fn contacts(document: &Document, at_rest: Option<&StaticSummary>) -> Vec<(String, f64, f64)> {
    let laws = match (document.any_scenario(), at_rest) {
        (Ok(AnyScenario::Bars(bars)), _) => ScenarioLaws::of_bars(&bars),
        (Ok(AnyScenario::Structure(structure)), Some(at_rest)) => {
            Ok(ScenarioLaws::of_structure(&structure, at_rest))
        }
        _ => return Vec::new(),
    };
    let laws = laws.and_then(|laws| laws.built()).unwrap_or_default().into_iter();
    let at_rest = laws.map(|one| {
        let stiffness = one.law.stiffness(one.static_pressure_pa);
        (one.name, one.static_pressure_pa, stiffness)
    });
    at_rest.filter(|(_, pressure, stiffness)| *pressure > 0.0 && *stiffness > 0.0).collect()
}

struct Walker<'a> {
    schema: &'a Value,
    document: &'a Document,
    base: &'a Value,
    contacts: Vec<(String, f64, f64)>,
}

impl<'a> Walker<'a> {
    /// The controls at a pointer, and inside its value.
    fn walk_at(&self, pointer: &str, found: &mut Vec<Control>) {
        let mut node = self.schema;
        let mut value = Some(self.document.value());
        for part in pointer.split('/').skip(1) {
            let part = part.replace("~1", "/").replace("~0", "~");
            node = self.target(node);
            let inner = node.get("properties").and_then(|all| all.get(&part));
            let inner = inner.or_else(|| node.get("additionalProperties"));
            let Some(inner) = inner.or_else(|| node.get("items")) else { return };
            value = value.and_then(|value| match value {
                Value::Array(items) => items.get(part.parse::<usize>().ok()?),
                value => value.get(&part),
            });
            value = value.or_else(|| default_of(inner));
            node = inner;
        }
        self.walk(node, value, pointer, found);
    }

    /// The node that another refers to, or itself.
    fn target(&self, node: &'a Value) -> &'a Value {
        let reference = node.get("$ref").and_then(Value::as_str);
        let target = reference.and_then(|text| self.schema.pointer(text.strip_prefix('#')?));
        target.map_or(node, |target| self.target(target))
    }

    fn walk(
        &self,
        node: &'a Value,
        value: Option<&Value>,
        pointer: &str,
        found: &mut Vec<Control>,
    ) {
        let help = text_of(node, "description");
        let node = self.target(node);
        let help = if help.is_empty() { text_of(node, "description") } else { help };
        let control = |kind: Kind| Control {
            pointer: pointer.to_owned(),
            label: label(pointer),
            help: first(help),
            kind,
        };
        if let Some(options) = self.choices(node, value, pointer) {
            let chosen = options.0;
            if options.1.len() > 1 {
                found.push(control(Kind::Choice { chosen, options: options.1 }));
            }
        }
        match (value, text_of(node, "type")) {
            (Some(Value::Object(object)), _) => self.object(node, object, pointer, found),
            (Some(Value::Array(items)), _) => {
                if let Some(pairs) = pairs(items) {
                    let increasing = pointer.ends_with("/knots");
                    let pulse = pointer == "/excitation/points";
                    let columns = if pulse { ["t (s)", "F (N)"] } else { ["p (Pa)", "K (Pa/m)"] };
                    found.push(control(Kind::Pairs { value: pairs, columns, increasing, pulse }));
                } else if let Some(item) = node.get("items") {
                    for (index, inner) in items.iter().enumerate() {
                        self.walk(item, Some(inner), &format!("{pointer}/{index}"), found);
                    }
                }
            }
            (Some(Value::Bool(value)), _) => found.push(control(Kind::Flag { value: *value })),
            (Some(Value::Number(_)) | None, "number" | "integer") => {
                found.push(control(self.number(node, value.and_then(Value::as_f64), pointer)));
            }
            _ => {}
        }
    }

    /// The values in an object, and those that it may have.
    fn object(
        &self,
        node: &'a Value,
        object: &Map<String, Value>,
        pointer: &str,
        found: &mut Vec<Control>,
    ) {
        let node = self.branch(node, object.get("kind")).unwrap_or(node);
        let alternatives = alternatives(node);
        let properties = node.get("properties").and_then(Value::as_object);
        for (key, inner) in properties.into_iter().flatten() {
            let value = object.get(key).or_else(|| default_of(inner));
            let is_const = inner.get("const").is_some();
            if is_const || (value.is_none() && alternatives.contains(&key.as_str())) {
                continue;
            }
            self.walk(inner, value, &format!("{pointer}/{}", escaped(key)), found);
        }
    }

    /// The branch of a union of objects for a kind.
    fn branch(&self, node: &'a Value, kind: Option<&Value>) -> Option<&'a Value> {
        let kind = kind?;
        let union = node.get("oneOf").or_else(|| node.get("anyOf"))?.as_array()?;
        union.iter().map(|branch| self.target(branch)).find_map(|branch| {
            if kind_of(branch) == Some(kind) {
                return Some(branch);
            }
            self.branch(branch, Some(kind))
        })
    }

    /// The choice among words, laws by name, or kinds of an object, with the list.
    fn choices(
        &self,
        node: &'a Value,
        value: Option<&Value>,
        pointer: &str,
    ) -> Option<(String, Vec<Choice>)> {
        if let Some(words) = words(node) {
            let chosen = value.and_then(Value::as_str).unwrap_or_default().to_owned();
            let choice = |word: &str| Choice { label: word.to_owned(), value: json!(word) };
            return Some((chosen, words.into_iter().map(choice).collect()));
        }
        if pointer.ends_with("/law") && value.is_some_and(Value::is_string) {
            let laws = self.document.value().get("laws").and_then(Value::as_object)?;
            let chosen = value.and_then(Value::as_str)?.to_owned();
            let choice = |name: &String| Choice { label: name.clone(), value: json!(name) };
            return Some((chosen, laws.keys().map(choice).collect()));
        }
        let kind = value.and_then(|value| value.get("kind")).and_then(Value::as_str);
        if kind.is_none() {
            if let Some(optional) = self.optional(node, value, pointer) {
                return Some(optional);
            }
            if value.is_some() {
                return None;
            }
        }
        let mut branches = Vec::new();
        self.kinds(node, &mut branches);
        let mut options = Vec::new();
        if value.is_none() {
            options.push(Choice { label: "none".to_owned(), value: Value::Null });
        }
        let is_law =
            branches.iter().any(|branch| kind_of(branch) == Some(&json!("modified_power")));
        let new_laws = if is_law { self.laws(value, pointer) } else { Vec::new() };
        for branch in branches {
            let Some(name) = kind_of(branch).and_then(Value::as_str) else { continue };
            let new = || {
                if is_law {
                    let law = new_laws.iter().find(|law| law.get("kind") == Some(&json!(name)));
                    return law.cloned();
                }
                self.skeleton(branch, Some(name), value)
            };
            let own = value.filter(|_| kind == Some(name)).cloned();
            if let Some(value) = own.or_else(new) {
                options.push(Choice { label: name.to_owned(), value });
            }
        }
        let chosen = kind.unwrap_or("none").to_owned();
        (!options.is_empty()).then_some((chosen, options))
    }

    /// The choice to give an object that the scenario of the file leaves out and that has no kinds, such as
    /// friction.
    fn optional(
        &self,
        node: &'a Value,
        value: Option<&Value>,
        pointer: &str,
    ) -> Option<(String, Vec<Choice>)> {
        let is_left_out = self.base.pointer(pointer).is_none() && default_of(node).is_none();
        if !is_left_out || text_of(node, "type") != "object" || node.get("properties").is_none() {
            return None;
        }
        let given = self.skeleton(node, None, value)?;
        let choice = |label: &str, value: Value| Choice { label: label.to_owned(), value };
        let options = vec![choice("none", Value::Null), choice("given", given)];
        Some((if value.is_some() { "given" } else { "none" }.to_owned(), options))
    }

    /// The branches of a union that have a kind.
    fn kinds(&self, node: &'a Value, found: &mut Vec<&'a Value>) {
        let union = node.get("oneOf").or_else(|| node.get("anyOf")).and_then(Value::as_array);
        for branch in union.into_iter().flatten().map(|branch| self.target(branch)) {
            if kind_of(branch).is_some() {
                found.push(branch);
            } else {
                self.kinds(branch, found);
            }
        }
    }

    /// A law of each kind with the stiffness at rest of the present one.
    fn laws(&self, value: Option<&Value>, pointer: &str) -> Vec<Value> {
        struct Middle;
        impl Draw for Middle {
            fn unit(&mut self) -> f64 {
                0.5
            }
        }
        let name = pointer.strip_prefix("/laws/").unwrap_or_default();
        let name = name.replace("~1", "/").replace("~0", "~");
        let known = self.contacts.iter().find(|contact| contact.0 == name);
        let (pressure, stiffness) = known.map_or(USUAL_CONTACT, |(_, p, k)| (*p, *k));
        let mut laws: Vec<LawSpec> = LawSpec::SAMPLERS
            .iter()
            .map(|sample| sample(&mut Middle, pressure, stiffness))
            .collect();
        let present = value.and_then(|value| serde_json::from_value::<LawSpec>(value.clone()).ok());
        if let Some(present) = present {
            let layer = crate::settings::rounded(LAYER * stiffness);
            laws.push(LawSpec::with_layer(present.into(), layer));
        }
        laws.iter().map(|law| json!(law)).collect()
    }

    /// An object, of a kind if it has one, with numbers for its keys, those of the present object where it has them; none
    /// where it needs something else.
    fn skeleton(
        &self,
        branch: &'a Value,
        kind: Option<&str>,
        present: Option<&Value>,
    ) -> Option<Value> {
        let mut object = Map::new();
        if let Some(kind) = kind {
            object.insert("kind".to_owned(), json!(kind));
        }
        let alternative = alternatives(branch).into_iter().next();
        let required = branch.get("required").and_then(Value::as_array);
        let required = required.into_iter().flatten().filter_map(Value::as_str);
        for key in required.filter(|key| *key != "kind").chain(alternative) {
            let node = branch.get("properties")?.get(key)?;
            let known = present.and_then(|present| present.get(key)).cloned();
            let target = self.target(node);
            let usual = || {
                let is_number = matches!(text_of(target, "type"), "number" | "integer");
                let usual = USUAL.iter().find(|usual| usual.0 == key);
                is_number.then(|| json!(usual.map_or(1.0, |usual| usual.1)))
            };
            let drawn = || (key == "points").then(|| pulse(present));
            let value =
                known.or_else(|| default_of(node).cloned()).or_else(usual).or_else(drawn)?;
            object.insert(key.to_owned(), value);
        }
        Some(Value::Object(object))
    }

    fn number(&self, node: &Value, value: Option<f64>, pointer: &str) -> Kind {
        let base = self.base.pointer(pointer).and_then(Value::as_f64);
        let key = pointer.rsplit('/').next().unwrap_or_default();
        let center = base
            .or(value)
            .or_else(|| USUAL.iter().find(|usual| usual.0 == key).map(|usual| usual.1));
        let center = center.unwrap_or(1.0);
        let whole = text_of(node, "type") == "integer";
        let log = !whole && center > 0.0 && LOGARITHMIC.iter().any(|ending| key.ends_with(ending));
        let bound = |keys: [&str; 2]| keys.iter().find_map(|key| node.get(*key)?.as_f64());
        let (least, most) =
            (bound(["minimum", "exclusiveMinimum"]), bound(["maximum", "exclusiveMaximum"]));
        let (mut low, mut high) = if log {
            (center / LOG_FACTOR, center * LOG_FACTOR)
        } else if center == 0.0 {
            (0.0, 1.0)
        } else {
            let high = LINEAR_HIGH * center.abs();
            (if center < 0.0 { -high } else { 0.0 }, high)
        };
        if let Some(value) = value {
            (low, high) = (low.min(value), high.max(value));
        }
        if let Some(least) = least {
            // A value at an excluded end is not accepted.
            let excluded = node.get("exclusiveMinimum").is_some();
            let least = if excluded { least + (high - least) * 1e-3 } else { least };
            low = if log { low.max(least.min(center)) } else { low.max(least) };
        }
        if let Some(most) = most {
            high = high.min(most);
        }
        let (low, high) = (crate::settings::rounded(low), crate::settings::rounded(high));
        Kind::Number { value, unit: pointer_words(pointer).1, whole, low, high, log }
    }
}

/// Points of a pulse to begin a drawing with: the present gamma pulse, or a haversine about as high and as long as the
/// present force.
fn pulse(present: Option<&Value>) -> Value {
    /// Intervals of the points, and rise times of a gamma pulse that are drawn.
    const PARTS: u32 = 10;
    const RISES: f64 = 5.0;
    let number = |key: &str| present?.get(key)?.as_f64();
    let usual = |key: &str| USUAL.iter().find(|usual| usual.0 == key).map_or(1.0, |usual| usual.1);
    let peak = number("peak_n").or_else(|| number("amplitude_n"));
    let peak = peak.unwrap_or_else(|| usual("peak_n"));
    let (duration, rise) = match number("rise_s") {
        Some(rise) => (RISES * rise, Some(rise)),
        None => (number("duration_s").unwrap_or_else(|| usual("duration_s")), None),
    };
    let point = |part: u32| {
        let share = f64::from(part) / f64::from(PARTS);
        let time = share * duration;
        let shape = match rise {
            _ if part == 0 || part == PARTS => 0.0,
            Some(rise) => (time / rise).powi(2) * (2.0 * (1.0 - time / rise)).exp(),
            None => (std::f64::consts::PI * share).sin().powi(2),
        };
        [time, peak * shape].map(|number| four_digits(number).parse().unwrap_or(number))
    };
    json!((0..=PARTS).map(point).collect::<Vec<_>>())
}

/// Words of a value, without the part of the scenario that the heading names.
fn label(pointer: &str) -> String {
    if pointer.matches('/').count() == 1 {
        return "Kind".to_owned();
    }
    let (words, _) = pointer_words(pointer);
    let is_item = ["/laws/", "/bodies/", "/interfaces/", "/sensors/", "/loads/", "/springs/"]
        .iter()
        .any(|list| pointer.starts_with(list));
    match words.rsplit_once(" of ") {
        Some((words, _)) if is_item => words.to_owned(),
        _ if is_item && pointer.matches('/').count() == 2 => "Kind".to_owned(),
        _ => words,
    }
}

/// The first paragraph of a description, on one line.
fn first(description: &str) -> String {
    description.split("\n\n").next().unwrap_or_default().replace('\n', " ")
}

fn text_of<'v>(node: &'v Value, key: &str) -> &'v str {
    node.get(key).and_then(Value::as_str).unwrap_or_default()
}

fn default_of(node: &Value) -> Option<&Value> {
    node.get("default")
}

fn kind_of(branch: &Value) -> Option<&Value> {
    branch.pointer("/properties/kind/const")
}

/// The words that a text may be; none for other nodes.
fn words(node: &Value) -> Option<Vec<&str>> {
    if let Some(list) = node.get("enum").and_then(Value::as_array) {
        return list.iter().map(Value::as_str).collect();
    }
    let union = node.get("oneOf")?.as_array()?;
    union.iter().map(|branch| branch.get("const")?.as_str()).collect()
}

/// Keys of which an object has exactly one.
fn alternatives(node: &Value) -> Vec<&str> {
    let union = node.get("oneOf").and_then(Value::as_array);
    let branches = union.into_iter().flatten().filter(|branch| branch.get("properties").is_none());
    let required = branches.filter_map(|branch| branch.get("required")?.as_array());
    required.flatten().filter_map(Value::as_str).collect()
}

/// Pairs of numbers, if the items are some.
fn pairs(items: &[Value]) -> Option<Vec<[f64; 2]>> {
    let pair = |item: &Value| match item.as_array()?.as_slice() {
        [x, y] => Some([x.as_f64()?, y.as_f64()?]),
        _ => None,
    };
    if items.is_empty() { None } else { items.iter().map(pair).collect() }
}

/// A key as a part of a JSON Pointer.
fn escaped(key: &str) -> String {
    key.replace('~', "~0").replace('/', "~1")
}
