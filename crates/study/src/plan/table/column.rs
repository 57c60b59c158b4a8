//! Column of a file for one input, and the values that it accepts.

use asperity_table::unquoted;
use serde_json::Value;

/// Integers that are exact as floating-point numbers.
const MOST_EXACT: i64 = 1 << 53;

/// Most names of columns in a message.
const MOST_NAMES: usize = 20;

/// An input that a file has a column for.
#[derive(Debug, Clone)]
pub(crate) struct TableColumn {
    /// Names that the column may have, the first one found counts.
    pub(crate) names: Vec<String>,
    /// The values that are accepted; finite numbers when left out.
    pub(crate) options: Option<Vec<Value>>,
}

impl TableColumn {
    /// The place of the column among the columns of a file.
    pub(super) fn place(&self, found: &[String]) -> Result<usize, String> {
        for name in &self.names {
            let mut places = (0..found.len()).filter(|&at| unquoted(&found[at]) == name);
            let place = places.next();
            if places.next().is_some() {
                return Err(format!("has the column `{name}` twice; accepted: once"));
            }
            if let Some(place) = place {
                return Ok(place);
            }
        }
        let mut accepted = found[..found.len().min(MOST_NAMES)].join(", ");
        if found.len() > MOST_NAMES {
            accepted.push_str(", ...");
        }
        let names = self.names.join("` or `");
        Err(format!("has no column `{names}`; its columns are: {accepted}"))
    }

    /// The value of a text, or the words for what is wrong with it.
    pub(super) fn of_text(&self, text: &str) -> Result<Value, String> {
        let text = text.trim();
        let Some(options) = &self.options else {
            if let Ok(integer) = text.parse::<i64>()
                && integer.abs() < MOST_EXACT
                && text != "-0"
            {
                return Ok(integer.into());
            }
            return self.of_number(text.parse().unwrap_or(f64::NAN)).map_err(|_| {
                format!("`{text}` is no number; accepted: finite numbers such as 2.5e-3")
            });
        };
        let same = |option: &&Value| match option {
            Value::String(option) => option == unquoted(text),
            Value::Number(option) => text.parse().ok() == option.as_f64(),
            other => serde_json::from_str(unquoted(text)).ok().as_ref() == Some(*other),
        };
        options.iter().find(same).cloned().ok_or_else(|| {
            let options: Vec<String> = options.iter().map(Value::to_string).collect();
            format!("`{text}` is none of the values {}", options.join(", "))
        })
    }

    /// The value of a number, or the words for what is wrong with it.
    pub(super) fn of_number(&self, number: f64) -> Result<Value, String> {
        if self.options.is_some() {
            return self.of_text(&number.to_string());
        }
        if number.is_finite() {
            return Ok(number.into());
        }
        Err(format!("{number} is no number; accepted: finite numbers"))
    }
}
