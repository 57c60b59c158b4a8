//! What is wrong with a hit, in words.

use asperity_signal::{HitChannel, QualityIssue};

/// A issue with its evidence.
pub(super) fn in_words(issue: &QualityIssue) -> String {
    match *issue {
        QualityIssue::DoubleHit(double) => format!(
            "double hit: {:.0} % of the first blow after {:.3} ms",
            100.0 * double.ratio,
            1e3 * (double.second_s - double.first_s)
        ),
        QualityIssue::Overload { channel, samples, value, .. } => {
            format!("overload: the {} stands at {value} for {samples} samples", name(channel))
        }
        QualityIssue::Dropout { channel, samples, value, .. } => {
            format!("dropout: the {} stays at {value} for {samples} samples", name(channel))
        }
        QualityIssue::NotFinite { channel, samples, .. } => {
            format!("dropout: {samples} samples of the {} are no numbers", name(channel))
        }
        QualityIssue::Truncated { samples, missing } => {
            format!("truncated: {missing} of {} samples are missing", samples + missing)
        }
        QualityIssue::NotDecayed { ratio, threshold, .. } => format!(
            "not decayed: {:.1} % of the largest response are left at the end, more than {:.1} %",
            100.0 * ratio,
            100.0 * threshold
        ),
        _ => "another fault".to_owned(),
    }
}

fn name(channel: HitChannel) -> &'static str {
    match channel {
        HitChannel::Force => "force",
        HitChannel::Response(_) => "response",
    }
}
