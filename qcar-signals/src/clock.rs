//! Dates and clock times in texts, as loggers stamp their rows.

use chrono::{Datelike, NaiveDate};

/// Seconds of a day.
pub(crate) const DAY: f64 = 86_400.0;
/// Days from 31 December of the year 0 to 1 January 2000.
const BEFORE_2000: i32 = 730_120;

/// Seconds in a text such as `12:30:05.25`, `2026-11-26 12:30:05`, `26.11.2026 12:30:05,25` or `2026-11-26`: since
/// midnight, or with a date since the year 2000. `None` for anything else, such as a day of an unknown month in
/// `11/26/2026`.
pub(crate) fn seconds(text: &str) -> Option<f64> {
    let text = text.trim().trim_end_matches('Z');
    let (date, time) = match text.split_once(['T', ' ']) {
        Some((date, time)) => (Some(date), Some(time.trim_start())),
        None if text.contains(':') => (None, Some(text)),
        None => (Some(text), None),
    };
    let days = date.map_or(Some(0.0), days)?;
    Some(days * DAY + time.map_or(Some(0.0), since_midnight)?)
}

/// Seconds in `hh:mm`, `hh:mm:ss` or the same with decimals behind a point or a comma.
fn since_midnight(time: &str) -> Option<f64> {
    let mut parts = time.split(':');
    let (hours, minutes, seconds) = (parts.next()?, parts.next()?, parts.next().unwrap_or("0"));
    let (whole, decimals) = seconds.split_once(['.', ',']).unwrap_or((seconds, "0"));
    let (hours, minutes, whole) = (number(hours)?, number(minutes)?, number(whole)?);
    let is_digits = decimals.bytes().all(|byte| byte.is_ascii_digit());
    if parts.next().is_some() || hours > 24 || minutes > 59 || whole > 60 || !is_digits {
        return None;
    }
    let fraction: f64 = format!("0.{decimals}").parse().ok()?;
    Some(f64::from(hours * 3600 + minutes * 60 + whole) + fraction)
}

/// Days from 1 January 2000 to a date in the order year, month, day between dashes or slashes, or day, month, year
/// between points.
fn days(date: &str) -> Option<f64> {
    let separator = date.chars().find(|c| !c.is_ascii_digit())?;
    let mut parts = date.split(separator);
    let (first, month, last) = (parts.next()?, parts.next()?, parts.next()?);
    let (year, day) = match (separator, first.len(), last.len()) {
        ('-' | '/', 4, 1..=2) => (first, last),
        ('.', 1..=2, 4) => (last, first),
        _ => return None,
    };
    let (year, month, day) = (number(year)?.try_into().ok()?, number(month)?, number(day)?);
    if parts.next().is_some() {
        return None;
    }
    let date = NaiveDate::from_ymd_opt(year, month, day)?;
    Some(f64::from(date.num_days_from_ce() - BEFORE_2000))
}

/// A whole number of at most four digits.
fn number(digits: &str) -> Option<u32> {
    let is_one = (1..=4).contains(&digits.len()) && digits.bytes().all(|byte| byte.is_ascii_digit());
    is_one.then(|| digits.parse().ok()).flatten()
}

/// Times since the first one, rounded to 10 µs: finer parts of a date are lost in its size.
pub(crate) fn since_first(times: &mut [f64]) {
    let first = times.iter().copied().find(|time| time.is_finite()).unwrap_or(0.0);
    for time in times {
        *time = ((*time - first) * 1e5).round() / 1e5;
    }
}

#[cfg(test)]
mod tests {
    use super::seconds;

    #[test]
    fn stamps_are_seconds() {
        let noon = |text: &str| seconds(text).unwrap() - seconds("2026-03-01").unwrap();
        assert_eq!(seconds("00:01:02.25"), Some(62.25));
        assert_eq!(seconds("12:30"), Some(45_000.0));
        assert_eq!(seconds("2000-01-01 00:00:01"), Some(1.0));
        assert_eq!(noon("2026-03-01 12:00:00"), 43_200.0);
        assert_eq!(noon("2026-03-01T12:00:00.5Z"), 43_200.5);
        assert_eq!(noon("01.03.2026 12:00:00,5"), 43_200.5);
        // February of 2026 has 28 days, of 2028 and 2000 29, of 2100 28.
        assert_eq!(noon("2026/02/28 12:00"), -43_200.0);
        for (year, days) in [(2028, 2.0), (2000, 2.0), (2100, 1.0)] {
            let day = |text: &str| seconds(&format!("{year}-{text}")).unwrap() / 86_400.0;
            assert_eq!(day("03-01") - day("02-28"), days, "{year}");
        }
        for other in [
            "11/26/2026",
            "12.5",
            "1.2.3",
            "2026-13-01",
            "2026-02-29",
            "12:60:00",
            "12:00:00:00",
            "a:b",
            "",
            "12:00:00.x",
            "05.03.24",
            "t 1:2",
        ] {
            assert_eq!(seconds(other), None, "{other}");
        }
    }
}
