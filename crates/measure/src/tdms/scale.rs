//! Scales from raw samples to the measured quantity.
//!
//! A channel may contain raw counts or volts, with scales in the
//! properties `NI_Scale[i]_...`. The last scale gives the samples; the input of each is
//! the output of another, or the raw data. The scales of a group or of the file
//! apply to channels without scales.

use crate::source::Source;
use crate::tdms::property::{Properties, Property};
use crate::{FilePosition, MeasureError};

/// Most scales of a channel, and most coefficients of a scale.
const MOST: u64 = 64;

/// The raw data as input of a scale.
const RAW: f64 = 0xffff_ffff_u32 as f64;

/// The scales of a channel in the order of application: coefficients of increasing powers.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Scales(Vec<Vec<f64>>);

impl Scales {
    /// The scales of the properties of one object; none without any.
    pub(crate) fn of(
        source: &Source<'_>,
        properties: &Properties,
    ) -> Result<Option<Self>, MeasureError> {
        let Some((count, place)) = count(source, properties)? else { return Ok(None) };
        ScaleLevel { source, properties, place, count }.scales().map(Some)
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
fn count(
    source: &Source<'_>,
    properties: &Properties,
) -> Result<Option<(u64, FilePosition)>, MeasureError> {
    if let Some(number) = properties.get("NI_Number_Of_Scales") {
        let found = number.number().unwrap_or(-1.0);
        if found.fract() != 0.0 || !(0.0..=MOST as f64).contains(&found) {
            let (found, expected) = (found.to_string(), format!("0 to {MOST}"));
            return Err(source.malformed(number.place, "NI_Number_Of_Scales", &found, expected));
        }
        return Ok((found > 0.0).then_some((found as u64, number.place)));
    }
    let scale = |(name, property): (&String, &Property)| {
        let index = name.strip_prefix("NI_Scale[")?.strip_suffix("]_Scale_Type")?;
        Some((index.parse::<u32>().ok()?, property.place))
    };
    let last = properties.iter().filter_map(scale).max_by_key(|(index, _)| *index);
    match last {
        Some((index, place)) if u64::from(index) >= MOST => {
            let (found, expected) = (index.to_string(), format!("one of at most {MOST} scales"));
            Err(source.malformed(place, "the index of a scale", &found, expected))
        }
        last => Ok(last.map(|(index, place)| (u64::from(index) + 1, place))),
    }
}

/// The scales of one object.
struct ScaleLevel<'s, 'a, 'p> {
    source: &'s Source<'a>,
    properties: &'p Properties,
    place: FilePosition,
    count: u64,
}

impl ScaleLevel<'_, '_, '_> {
    fn scales(&self) -> Result<Scales, MeasureError> {
        if let Some(status) = self.properties.get("NI_Scaling_Status") {
            match status.text() {
                Some("scaled") => return Ok(Scales::default()),
                Some("unscaled") => {}
                other => {
                    let (place, found) = (status.place, other.unwrap_or("no text"));
                    return Err(self.wrong(
                        place,
                        "NI_Scaling_Status",
                        found,
                        "scaled or unscaled",
                    ));
                }
            }
        }
        let (mut scales, mut input) = (Vec::new(), self.count as f64 - 1.0);
        while input != RAW {
            let index = input as u64;
            // More steps than scales mean a cycle.
            if scales.len() as u64 >= self.count || index >= self.count || input.fract() != 0.0 {
                let expected = format!("the raw data or another of {} scales", self.count);
                let found = input.to_string();
                return Err(self.wrong(self.place, "the input of a scale", &found, &expected));
            }
            let (coefficients, next) = self.scale(index)?;
            scales.push(coefficients);
            input = next;
        }
        scales.reverse();
        Ok(Scales(scales))
    }

    /// Coefficients and input of a scale.
    fn scale(&self, index: u64) -> Result<(Vec<f64>, f64), MeasureError> {
        let quantity = "the scale of a channel";
        let kind = self.properties.get(&format!("NI_Scale[{index}]_Scale_Type"));
        let name = kind.and_then(Property::text).unwrap_or("missing");
        let coefficients = match name {
            "Linear" => {
                vec![self.number(index, "Linear_Y_Intercept")?, self.number(index, "Linear_Slope")?]
            }
            "Polynomial" => {
                let size = format!("NI_Scale[{index}]_Polynomial_Coefficients_Size");
                // Four by default.
                let count = match self.properties.get(&size) {
                    Some(_) => self.number(index, "Polynomial_Coefficients_Size")?,
                    None => 4.0,
                };
                let coefficient =
                    |power: u64| self.number(index, &format!("Polynomial_Coefficients[{power}]"));
                if !(1.0..=MOST as f64).contains(&count) {
                    let place = self.properties.get(&size).map_or(self.place, |size| size.place);
                    let (found, expected) = (count.to_string(), format!("1 to {MOST}"));
                    let quantity = "the number of coefficients";
                    return Err(self.wrong(place, quantity, &found, &expected));
                }
                (0..count as u64).map(coefficient).collect::<Result<_, _>>()?
            }
            other => {
                let place = kind.map_or(self.place, |kind| kind.place);
                let expected = "Linear or Polynomial; save other channels with scaled samples";
                return Err(self.wrong(place, quantity, other, expected));
            }
        };
        let input = self.properties.get(&format!("NI_Scale[{index}]_{name}_Input_Source"));
        let input = input.and_then(Property::number).unwrap_or(RAW);
        Ok((coefficients, input))
    }

    fn number(&self, index: u64, what: &str) -> Result<f64, MeasureError> {
        let name = format!("NI_Scale[{index}]_{what}");
        let property = self.properties.get(&name);
        let number = property.and_then(Property::number);
        number.filter(|number| number.is_finite()).ok_or_else(|| {
            let place = property.map_or(self.place, |property| property.place);
            let found = number.map_or("missing".to_owned(), |number| number.to_string());
            self.wrong(place, "a number of a scale", &found, &format!("a finite {name}"))
        })
    }

    fn wrong(
        &self,
        place: FilePosition,
        quantity: &'static str,
        found: &str,
        expected: &str,
    ) -> MeasureError {
        self.source.malformed(place, quantity, found, expected)
    }
}
