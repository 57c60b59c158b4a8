//! Scales from raw samples to the measured quantity.
//!
//! A channel may contain raw counts or volts, with scales in the
//! properties `NI_Scale[i]_...`. The last scale gives the samples; the input of each is
//! the output of another, or the raw data. The scales of a group or of the file
//! apply to channels without scales.

use crate::tdms_file::property::Properties;
use crate::tdms_file::{TdmsError, TdmsProperty};

/// Most scales of a channel, and most coefficients of a scale.
const MOST: u64 = 64;

/// The raw data as input of a scale.
const RAW: f64 = 0xffff_ffff_u32 as f64;

/// The scales of a channel in the order of application: coefficients of increasing powers.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Scales(Vec<Vec<f64>>);

impl Scales {
    /// The scales of the properties of one object; none without any.
    pub(crate) fn of(properties: &Properties) -> Result<Option<Self>, TdmsError> {
        let Some((count, offset)) = count(properties)? else { return Ok(None) };
        ScaleProperties { properties, offset, count }.scales().map(Some)
    }

    /// Number of coefficients.
    pub(crate) fn len(&self) -> usize {
        self.0.iter().map(Vec::len).sum()
    }

    /// Scales `values`.
    pub(crate) fn apply(&self, values: &mut [f64]) {
        for coefficients in &self.0 {
            for value in values.iter_mut() {
                let mut highest_first = coefficients.iter().rev();
                let highest = highest_first.next().copied().unwrap_or(0.0);
                *value = highest_first.fold(highest, |sum, next| sum * *value + next);
            }
        }
    }
}

/// Number of scales and its position; none without any.
fn count(properties: &Properties) -> Result<Option<(u64, u64)>, TdmsError> {
    if let Some(property) = properties.get("NI_Number_Of_Scales") {
        let count = property.number().unwrap_or(-1.0);
        if count.fract() != 0.0 || !(0.0..=MOST as f64).contains(&count) {
            let (found, expected) = (count.to_string(), format!("0 to {MOST}"));
            let quantity = "NI_Number_Of_Scales";
            return Err(TdmsError::malformed(property.offset, quantity, &found, expected));
        }
        return Ok((count > 0.0).then_some((count as u64, property.offset)));
    }
    let scale = |(name, property): (&String, &TdmsProperty)| {
        let index = name.strip_prefix("NI_Scale[")?.strip_suffix("]_Scale_Type")?;
        Some((u64::from(index.parse::<u32>().ok()?), property.offset))
    };
    match properties.iter().filter_map(scale).max_by_key(|(index, _)| *index) {
        Some((index, offset)) if index >= MOST => {
            let (found, expected) = (index.to_string(), format!("one of at most {MOST} scales"));
            Err(TdmsError::malformed(offset, "the index of a scale", &found, expected))
        }
        last => Ok(last.map(|(index, offset)| (index + 1, offset))),
    }
}

/// The properties of one object with `count` scales.
struct ScaleProperties<'p> {
    properties: &'p Properties,
    offset: u64,
    count: u64,
}

impl ScaleProperties<'_> {
    fn scales(&self) -> Result<Scales, TdmsError> {
        if let Some(status) = self.properties.get("NI_Scaling_Status") {
            match status.text() {
                Some("scaled") => return Ok(Scales::default()),
                Some("unscaled") => {}
                other => {
                    let (quantity, found) = ("NI_Scaling_Status", other.unwrap_or("no text"));
                    let expected = "scaled or unscaled";
                    return Err(TdmsError::malformed(status.offset, quantity, found, expected));
                }
            }
        }
        let (mut scales, mut input) = (Vec::new(), self.count as f64 - 1.0);
        while input != RAW {
            let index = input as u64;
            // More steps than scales mean a cycle.
            if scales.len() as u64 >= self.count || index >= self.count || input.fract() != 0.0 {
                let expected = format!("the raw data or another of {} scales", self.count);
                let (quantity, found) = ("the input of a scale", input.to_string());
                return Err(TdmsError::malformed(self.offset, quantity, &found, expected));
            }
            let (coefficients, next) = self.scale(index)?;
            scales.push(coefficients);
            input = next;
        }
        scales.reverse();
        Ok(Scales(scales))
    }

    /// Coefficients and input of a scale.
    fn scale(&self, index: u64) -> Result<(Vec<f64>, f64), TdmsError> {
        let kind = self.get(index, "Scale_Type");
        let name = kind.and_then(TdmsProperty::text).unwrap_or("missing");
        let coefficients = match name {
            "Linear" => {
                vec![self.number(index, "Linear_Y_Intercept")?, self.number(index, "Linear_Slope")?]
            }
            "Polynomial" => {
                let size = "Polynomial_Coefficients_Size";
                let property = self.get(index, size);
                // Four by default.
                let count = if property.is_some() { self.number(index, size)? } else { 4.0 };
                if !(1.0..=MOST as f64).contains(&count) {
                    let (found, expected) = (count.to_string(), format!("1 to {MOST}"));
                    let quantity = "the number of coefficients";
                    let offset = self.offset_of(property);
                    return Err(TdmsError::malformed(offset, quantity, &found, expected));
                }
                let coefficient =
                    |power: u64| self.number(index, &format!("Polynomial_Coefficients[{power}]"));
                (0..count as u64).map(coefficient).collect::<Result<_, _>>()?
            }
            other => {
                let expected = "Linear or Polynomial; save other channels with scaled samples";
                let (offset, quantity) = (self.offset_of(kind), "the scale of a channel");
                return Err(TdmsError::malformed(offset, quantity, other, expected));
            }
        };
        let input = self.get(index, &format!("{name}_Input_Source"));
        Ok((coefficients, input.and_then(TdmsProperty::number).unwrap_or(RAW)))
    }

    fn get(&self, index: u64, name: &str) -> Option<&TdmsProperty> {
        self.properties.get(&format!("NI_Scale[{index}]_{name}"))
    }

    fn offset_of(&self, property: Option<&TdmsProperty>) -> u64 {
        property.map_or(self.offset, |property| property.offset)
    }

    fn number(&self, index: u64, name: &str) -> Result<f64, TdmsError> {
        let property = self.get(index, name);
        let number = property.and_then(TdmsProperty::number);
        number.filter(|number| number.is_finite()).ok_or_else(|| {
            let found = number.map_or("missing".to_owned(), |number| number.to_string());
            let expected = format!("a finite NI_Scale[{index}]_{name}");
            let offset = self.offset_of(property);
            TdmsError::malformed(offset, "a number of a scale", &found, expected)
        })
    }
}
