//! Whether draws reach as far as profiles.

use super::Posterior;
use crate::profile::Profile;

/// Share of the length of a profile's interval that draws may leave out at its ends.
const LEFT_OUT: f64 = 0.25;

/// Unknowns whose draws leave out much of what their profiles allow.
pub(super) fn unreached(found: &Posterior, profiles: &[Profile]) -> Vec<usize> {
    let lacks = |profile: &&Profile| {
        let [low, high] = profile.interval;
        let values = || found.draws.iter().filter_map(|draw| draw.get(profile.unknown).copied());
        let least = values().fold(f64::INFINITY, f64::min);
        let greatest = values().fold(f64::NEG_INFINITY, f64::max);
        let out = (least - low).max(0.0) + (high - greatest).max(0.0);
        out > LEFT_OUT * (high - low)
    };
    profiles.iter().filter(lacks).map(|profile| profile.unknown).collect()
}
