//! Times of properties.

use std::fmt;

/// Days from 1 March of the year 0, in the calendar carried back, to 1 January 1904.
const DAYS_TO_1904: i64 = 695_361;

/// A time in UTC: seconds since 1904 and fractions of 2^-64 s.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TdmsTime {
    /// Whole seconds since the start of 1904.
    pub seconds: i64,
    /// Fraction, in 2^-64 s.
    pub fraction: u64,
}

impl TdmsTime {
    /// Seconds since `other`.
    pub fn since(self, other: Self) -> f64 {
        let fraction = |time: Self| time.fraction as f64 * 2f64.powi(-64);
        (i128::from(self.seconds) - i128::from(other.seconds)) as f64
            + (fraction(self) - fraction(other))
    }
}

impl fmt::Display for TdmsTime {
    /// ISO 8601, to the microsecond; empty for years without four digits.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Years begin in March, so that the leap day is their last.
        let (days, second) = (self.seconds.div_euclid(86_400), self.seconds.rem_euclid(86_400));
        let days = days.saturating_add(DAYS_TO_1904);
        if !(0..3_652_000).contains(&days) {
            return Ok(());
        }
        let (cycle, day) = (days / 146_097, days % 146_097);
        let year = (day - day / 1460 + day / 36_524 - day / 146_096) / 365;
        let day_of_year = day - (365 * year + year / 4 - year / 100);
        let month = (5 * day_of_year + 2) / 153;
        let day_of_month = day_of_year - (153 * month + 2) / 5 + 1;
        let year = 400 * cycle + year + i64::from(month >= 10);
        let month = if month < 10 { month + 3 } else { month - 9 };
        let (hour, minute) = (second / 3600, second / 60 % 60);
        let micros = (u128::from(self.fraction) * 1_000_000) >> 64;
        write!(
            f,
            "{year:04}-{month:02}-{day_of_month:02}T{hour:02}:{minute:02}:{:02}",
            second % 60
        )?;
        write!(f, ".{micros:06}Z")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(seconds: i64, fraction: u64) -> String {
        TdmsTime { seconds, fraction }.to_string()
    }

    #[test]
    fn days_of_the_calendar() {
        assert_eq!(written(0, 0), "1904-01-01T00:00:00.000000Z");
        // 1970 is 66 years of which 17 are leap years later.
        assert_eq!(written(2_082_844_800, 1 << 63), "1970-01-01T00:00:00.500000Z");
        // 1 795 273 957 is the output of `date -u -d 2026-11-21T15:12:37 +%s`.
        assert_eq!(written(1_795_273_957 + 2_082_844_800, 0), "2026-11-21T15:12:37.000000Z");
        // The last day of February of a leap year, and the day after.
        assert_eq!(written(951_782_400 + 2_082_844_800, 0), "2000-02-29T00:00:00.000000Z");
        assert_eq!(written(951_868_800 + 2_082_844_800, 0), "2000-03-01T00:00:00.000000Z");
        assert_eq!(written(-1, u64::MAX), "1903-12-31T23:59:59.999999Z");
        for nonsense in [i64::MIN, i64::MAX, -(1 << 50), 1 << 50] {
            assert_eq!(written(nonsense, 0), "");
        }
    }

    #[test]
    fn the_time_between_two() {
        let (one, other) = (
            TdmsTime { seconds: 5, fraction: 1 << 62 },
            TdmsTime { seconds: 3, fraction: 1 << 63 },
        );
        assert_eq!(one.since(other), 1.75);
        let far = TdmsTime { seconds: i64::MIN, fraction: 0 };
        assert!(one.since(far) > 9e18);
    }
}
