//! What is wrong with a hit, in words.

use asperity_signal::{Channel, Verdict};

/// A verdict with its evidence.
pub(super) fn in_words(verdict: &Verdict) -> String {
    match *verdict {
        Verdict::DoubleHit(double) => format!(
            "double hit: {:.0} % of the first blow after {:.3} ms",
            100.0 * double.ratio,
            1e3 * (double.second_s - double.first_s)
        ),
        Verdict::Overload { channel, samples, value, .. } => {
            format!("overload: the {} stands at {value} for {samples} samples", name(channel))
        }
        Verdict::Dropout { channel, samples, value, .. } => {
            format!("dropout: the {} stays at {value} for {samples} samples", name(channel))
        }
        Verdict::NotFinite { channel, samples, .. } => {
            format!("dropout: {samples} samples of the {} are no numbers", name(channel))
        }
        Verdict::Truncated { samples, missing } => {
            format!("truncated: {missing} of {} samples are missing", samples + missing)
        }
        Verdict::NotDecayed { ratio, threshold, .. } => format!(
            "not decayed: {:.1} % of the largest response are left at the end, more than {:.1} %",
            100.0 * ratio,
            100.0 * threshold
        ),
        _ => "another fault".to_owned(),
    }
}

fn name(channel: Channel) -> &'static str {
    match channel {
        Channel::Force => "force",
        Channel::Response(_) => "response",
    }
}
