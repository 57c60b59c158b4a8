//! Keyword lines: `*NAME, KEY=VALUE, FLAG`.

/// A keyword and its parameters, in upper case.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Keyword {
    pub(super) name: String,
    parameters: Vec<(String, String)>,
}

impl Keyword {
    /// The keyword of a line that starts with one `*`; lines that end with a comma have been joined.
    pub(super) fn parse(line: &str) -> Self {
        let mut parts = line.trim_start_matches('*').split(',');
        let name = parts.next().unwrap_or_default();
        let name = name.split_whitespace().collect::<Vec<_>>().join(" ").to_uppercase();
        let parameters = parts.filter(|part| !part.trim().is_empty()).map(|part| {
            let (key, value) = part.split_once('=').unwrap_or((part, ""));
            (key.trim().to_uppercase(), value.trim().trim_matches('"').to_owned())
        });
        Self { name, parameters: parameters.collect() }
    }

    /// The value of a parameter as written; empty for a flag.
    pub(super) fn value(&self, key: &str) -> Option<&str> {
        let found = self.parameters.iter().find(|(name, _)| name == key);
        found.map(|(_, value)| value.as_str())
    }

    /// The name given by a parameter, in upper case; none if it is absent or empty.
    pub(super) fn label(&self, key: &str) -> Option<String> {
        self.value(key).filter(|value| !value.is_empty()).map(str::to_uppercase)
    }

    pub(super) fn has(&self, key: &str) -> bool {
        self.value(key).is_some()
    }

    /// The reason why a mesh with this keyword cannot be read, and the remedy.
    pub(super) fn obstacle(&self) -> Option<(String, &'static str)> {
        let feature = format!("*{}", self.name);
        match self.name.as_str() {
            "PART" | "INSTANCE" | "ASSEMBLY" => Some((
                feature,
                "write a flat deck (Abaqus/CAE: attributes of the model, \"Do not use parts and assemblies in \
                 input files\")",
            )),
            "NGEN" | "NFILL" | "NCOPY" | "NMAP" | "ELGEN" | "ELCOPY" | "SUBMODEL" => {
                Some((feature, "write every node and every element into the deck"))
            }
            "SYSTEM" => Some((feature, "write the places of nodes in the global system")),
            "NODE" if self.has("SYSTEM") && self.label("SYSTEM").as_deref() != Some("R") => Some((
                format!("{feature} with SYSTEM={}", self.value("SYSTEM").unwrap_or_default()),
                "write the places of nodes as x, y, z",
            )),
            "NODE" | "ELEMENT" | "NSET" | "ELSET" if self.has("INPUT") => Some((
                format!("{feature} with INPUT"),
                "use *INCLUDE, or write the lines into the deck",
            )),
            "NSET" | "ELSET" if self.has("INSTANCE") => Some((
                format!("{feature} with INSTANCE"),
                "write a flat deck, without parts and instances",
            )),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_parameters_are_read_in_any_case() {
        let keyword = Keyword::parse("*Solid  section, ELSET = all_Parts , generate,");
        assert_eq!(keyword.name, "SOLID SECTION");
        assert_eq!(keyword.label("ELSET").as_deref(), Some("ALL_PARTS"));
        assert!(keyword.has("GENERATE") && !keyword.has("NSET"));
    }
}
