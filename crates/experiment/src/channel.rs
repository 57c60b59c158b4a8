//! Selection of the channels of force and response.

use std::path::Path;

use asperity_measure::{Channel, ChannelQuantity, Record};

use crate::error::AnalysisError;
use crate::near_name::nearest;

/// Selection of a channel by its number, its name or its quantity.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ChannelSelector {
    /// Number in the file, from 1, such as `#2`.
    Number(usize),
    /// Name, or else the word for a quantity such as `acceleration`.
    Name(String),
}

impl From<&str> for ChannelSelector {
    /// Parses `#NUMBER`; any other text is a name.
    fn from(text: &str) -> Self {
        let number = text.strip_prefix('#').and_then(|number| number.trim().parse().ok());
        number.map_or_else(|| Self::Name(text.to_owned()), Self::Number)
    }
}

impl std::fmt::Display for ChannelSelector {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Number(number) => write!(f, "#{number}"),
            Self::Name(name) => f.write_str(name),
        }
    }
}

impl ChannelSelector {
    /// Indices of the channels that fit.
    pub fn fitting(&self, record: &Record) -> Vec<usize> {
        let places = |fits: &dyn Fn(&Channel) -> bool| -> Vec<usize> {
            let channels = record.channels.iter().enumerate();
            channels.filter(|(_, channel)| fits(channel)).map(|(place, _)| place).collect()
        };
        match self {
            Self::Number(number) => {
                number.checked_sub(1).filter(|at| *at < record.channels.len()).into_iter().collect()
            }
            Self::Name(name) => {
                let named = places(&|channel| channel.name.trim() == name.trim());
                let quantity = ChannelQuantity::of_name(name);
                let is_word = !name.trim().contains(|c: char| !c.is_alphabetic());
                if named.is_empty() && is_word && quantity != ChannelQuantity::Unknown {
                    places(&|channel| channel.quantity == quantity)
                } else {
                    named
                }
            }
        }
    }
}

/// Choice of the responses.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ResponseChoice {
    /// The only acceleration, velocity or displacement.
    Only,
    /// All accelerations, velocities and displacements.
    All,
    /// These channels, each once. The first sets the band of the fundamental, where none is given.
    Channels(Vec<ChannelSelector>),
}

impl ResponseChoice {
    /// The choice of some texts: none for the only response, `all`, or a channel each.
    pub fn of(channels: &[ChannelSelector]) -> Self {
        let is_all = |channel: &ChannelSelector| *channel == "all".into();
        match channels {
            [] => Self::Only,
            [one] if is_all(one) => Self::All,
            _ => Self::Channels(channels.to_vec()),
        }
    }
}

/// Role of a channel in an analysis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ChannelRole {
    Force,
    Response,
}

impl ChannelRole {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Force => "force",
            Self::Response => "response",
        }
    }

    fn fits(self, quantity: ChannelQuantity) -> bool {
        match self {
            Self::Force => quantity == ChannelQuantity::Force,
            Self::Response => matches!(
                quantity,
                ChannelQuantity::Acceleration
                    | ChannelQuantity::Velocity
                    | ChannelQuantity::Displacement
            ),
        }
    }

    fn accepted(self) -> &'static str {
        match self {
            Self::Force => "a force, or volts of a sensor with its sensitivity",
            Self::Response => {
                "an acceleration, a velocity or a displacement, or volts of a sensor with its \
                 sensitivity"
            }
        }
    }
}

/// Indices of the chosen responses.
pub(crate) fn choose_responses(
    file: &Path,
    record: &Record,
    choice: &ResponseChoice,
) -> Result<Vec<usize>, AnalysisError> {
    let role = ChannelRole::Response;
    let places = match choice {
        ResponseChoice::Only => vec![choose(file, record, role, None)?],
        ResponseChoice::Channels(wanted) => {
            let places = wanted.iter().map(|wanted| choose(file, record, role, Some(wanted)));
            places.collect::<Result<Vec<_>, _>>()?
        }
        ResponseChoice::All => {
            let fits =
                |channel: &Channel| role.fits(channel.quantity) && channel.unit.known().is_some();
            let places: Vec<usize> =
                (0..record.channels.len()).filter(|at| fits(&record.channels[*at])).collect();
            // Without any, the error of a missing response.
            if places.is_empty() { vec![choose(file, record, role, None)?] } else { places }
        }
    };
    for (number, place) in places.iter().enumerate() {
        if places[..number].contains(place) {
            let channel = record.channels[*place].name.clone();
            return Err(AnalysisError::ChannelTwice { file: file.to_owned(), channel });
        }
    }
    Ok(places)
}

/// Indices of the responses of a decay: the channels that `wanted` selects, of any quantity and unit;
/// without any, or for `all`, every acceleration, velocity and displacement.
pub(crate) fn choose_any_responses(
    file: &Path,
    record: &Record,
    wanted: &[ChannelSelector],
) -> Result<Vec<usize>, AnalysisError> {
    let role = ChannelRole::Response;
    let none = |wanted: String| {
        let channels = listed_all(record);
        let near = near_channel(record, &wanted);
        AnalysisError::NoChannel {
            file: file.to_owned(),
            role: role.name(),
            wanted,
            near,
            channels,
        }
    };
    if ResponseChoice::of(wanted) == ResponseChoice::All || wanted.is_empty() {
        let fits = |at: &usize| role.fits(record.channels[*at].quantity);
        let places: Vec<usize> = (0..record.channels.len()).filter(fits).collect();
        return if places.is_empty() { Err(none(String::new())) } else { Ok(places) };
    }
    let mut places: Vec<usize> = Vec::with_capacity(wanted.len());
    for selector in wanted {
        let fitting = selector.fitting(record);
        // A quantity may select several.
        if fitting.is_empty() {
            return Err(none(selector.to_string()));
        }
        if let Some(place) = fitting.iter().find(|place| places.contains(place)) {
            let channel = record.channels[*place].name.clone();
            return Err(AnalysisError::ChannelTwice { file: file.to_owned(), channel });
        }
        places.extend(fitting);
    }
    Ok(places)
}

/// Index of the only channel that fits a role.
pub(crate) fn choose(
    file: &Path,
    record: &Record,
    role: ChannelRole,
    wanted: Option<&ChannelSelector>,
) -> Result<usize, AnalysisError> {
    let fitting: Vec<usize> = if let Some(selector) = wanted {
        selector.fitting(record)
    } else {
        let channels = record.channels.iter().enumerate();
        let fitting =
            channels.filter(|(_, c)| role.fits(c.quantity)).map(|(place, _)| place).collect();
        history_response(record, role).map_or(fitting, |place| vec![place])
    };
    let (file_name, role_name) = (file.to_owned(), role.name());
    let wanted = wanted.map(ToString::to_string).unwrap_or_default();
    let place = match fitting[..] {
        [place] => place,
        [] => {
            let (file, role, channels) = (file_name, role_name, listed_all(record));
            let near = near_channel(record, &wanted);
            return Err(AnalysisError::NoChannel { file, role, wanted, near, channels });
        }
        _ => {
            let (file, role, channels) = (file_name, role_name, listed(record, &fitting));
            return Err(AnalysisError::Ambiguous { file, role, wanted, channels });
        }
    };
    let channel = &record.channels[place];
    if channel.unit.known().is_none() {
        return Err(AnalysisError::unit(file, channel));
    }
    if !role.fits(channel.quantity) {
        return Err(AnalysisError::Quantity {
            file: file_name,
            role: role_name,
            channel: channel.name.clone(),
            found: channel.quantity,
            expected: role.accepted(),
        });
    }
    Ok(place)
}

/// Index of the acceleration in the history of a simulation without named sensors, which has pressure and closure of
/// each contact, and one displacement and one acceleration of the same place.
fn history_response(record: &Record, role: ChannelRole) -> Option<usize> {
    let is_state = |channel: &Channel, name: &str| {
        let state = channel.name.rsplit_once(':').and_then(|(_, state)| state.strip_prefix(name));
        state.is_some_and(|unit| unit.is_empty() || unit.starts_with('_'))
    };
    let has = |name: &str| record.channels.iter().any(|channel| is_state(channel, name));
    if role != ChannelRole::Response || !has("pressure") || !has("closure") {
        return None;
    }
    let channels = record.channels.iter().enumerate();
    let motions: Vec<(usize, ChannelQuantity)> = channels
        .filter(|(_, channel)| role.fits(channel.quantity) && !is_state(channel, "closure"))
        .map(|(place, channel)| (place, channel.quantity))
        .collect();
    match motions[..] {
        [(_, ChannelQuantity::Displacement), (place, ChannelQuantity::Acceleration)]
        | [(place, ChannelQuantity::Acceleration), (_, ChannelQuantity::Displacement)] => {
            Some(place)
        }
        _ => None,
    }
}

/// Name of a channel that is nearest to one that names none.
pub(crate) fn near_channel(record: &Record, wanted: &str) -> Option<String> {
    let names = record.channels.iter().map(|channel| channel.name.as_str());
    nearest(wanted, names).map(str::to_owned)
}

/// List of all channels for a message.
pub(crate) fn listed_all(record: &Record) -> String {
    listed(record, &(0..record.channels.len()).collect::<Vec<_>>())
}

/// Most channels listed in a message.
const MAX_LISTED: usize = 12;

/// List of channels for a message.
fn listed(record: &Record, places: &[usize]) -> String {
    let one = |place: &usize| {
        let channel = &record.channels[*place];
        let unit = match channel.unit.text() {
            "" => "no unit".to_owned(),
            text => text.to_owned(),
        };
        format!("#{} `{}` ({}, {unit})", place + 1, channel.name, channel.quantity)
    };
    let mut words: Vec<String> = places.iter().take(MAX_LISTED).map(one).collect();
    if places.len() > MAX_LISTED {
        words.push(format!("and {} more", places.len() - MAX_LISTED));
    }
    if words.is_empty() { "none".to_owned() } else { words.join(", ") }
}
