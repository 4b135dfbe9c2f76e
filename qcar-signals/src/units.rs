//! Recognises units in texts. Only times are converted, to seconds.

/// Symbols without a prefix.
const ALONE: [&str; 36] = [
    "%", "°", "°C", "°F", "deg", "degC", "grad", "rpm", "1/min", "U/min", "min", "h", "d", "g0", "in", "inch", "ft",
    "mi", "mph", "lb", "lbf", "lbm", "psi", "kp", "kgf", "dB", "count", "counts", "raw", "bit", "rad", "strain",
    "µstrain", "ue", "kph", "sec",
];
/// Symbols with an optional prefix.
const PREFIXED: [&str; 22] = [
    "m", "g", "s", "N", "V", "A", "Pa", "bar", "Hz", "W", "J", "K", "C", "F", "Ω", "Ohm", "l", "eps", "t", "T", "H",
    "Volts",
];
const PREFIXES: [&str; 11] = ["", "n", "u", "µ", "μ", "m", "c", "d", "k", "M", "G"];

/// True if a text is a unit: a product of known symbols with prefixes and exponents, such as `m/s^2`, `N/mm` or
/// `kN·s/m`.
pub(crate) fn is_unit(text: &str) -> bool {
    let text = bare(text);
    let known = |word: &str| {
        let symbol = word.trim_end_matches(|c: char| c.is_ascii_digit() || matches!(c, '^' | '²' | '³' | '-'));
        let prefixed = |symbol: &str| {
            let rests = PREFIXES.iter().filter_map(|prefix| symbol.strip_prefix(prefix));
            rests.into_iter().any(|rest| PREFIXED.contains(&rest))
        };
        word == "1" || ALONE.contains(&symbol) || prefixed(symbol)
    };
    matches!(text, "-" | "1") || {
        let mut words = text
            .split(['/', '*', '·', ' ', '(', ')', '.'])
            .filter(|word| !word.is_empty())
            .peekable();
        words.peek().is_some() && words.all(known)
    }
}

/// A unit without brackets.
pub(crate) fn bare(text: &str) -> &str {
    let text = text.trim();
    let inner = [('[', ']'), ('(', ')'), ('<', '>')]
        .iter()
        .find_map(|&(open, close)| text.strip_prefix(open)?.strip_suffix(close));
    inner.unwrap_or(text).trim()
}

/// A heading such as `Travel [mm]`, `Travel (mm)`, `Travel / mm` or `Travel in mm` as name and unit. Square brackets
/// always contain a unit, the other forms only if their content is one.
pub(crate) fn name_and_unit(heading: &str) -> (String, String) {
    let heading = heading.trim();
    let bracketed = |open: char, close: char| {
        let (name, unit) = heading.strip_suffix(close)?.rsplit_once(open)?;
        let sure = open == '[' || is_unit(unit);
        (sure && !name.trim().is_empty()).then(|| (name.trim().to_string(), unit.trim().to_string()))
    };
    let after = |word: &str| {
        let (name, unit) = heading.split_once(word)?;
        is_unit(unit).then(|| (name.trim().to_string(), unit.trim().to_string()))
    };
    let split = bracketed('[', ']')
        .or_else(|| bracketed('(', ')'))
        .or_else(|| after(" / "))
        .or_else(|| after(" in "));
    split.unwrap_or_else(|| (heading.into(), String::new()))
}

/// True if a channel of this name contains the times of the others.
pub(crate) fn is_time(name: &str) -> bool {
    let name = name.trim().to_lowercase();
    matches!(
        name.as_str(),
        "t" | "time" | "tout" | "zeit" | "times" | "timestamp" | "timestamps" | "tiempo" | "temps" | "tempo"
    )
}

/// Seconds in a unit of time; without a unit, seconds.
pub(crate) fn seconds(unit: &str) -> Option<f64> {
    match unit.trim() {
        "" | "s" | "S" | "sec" | "Sec" | "second" | "seconds" | "Sekunden" => Some(1.0),
        "ms" | "msec" => Some(1e-3),
        "us" | "µs" | "μs" => Some(1e-6),
        "ns" => Some(1e-9),
        "min" => Some(60.0),
        "h" => Some(3600.0),
        _ => None,
    }
}

/// Converts times to seconds. Divides if a second is a whole number of units, so that 5 ms are exactly 0.005 s.
pub(crate) fn in_seconds(times: &mut [f64], seconds: f64) {
    let per_second = (1.0 / seconds).round();
    for time in times {
        *time = if seconds < 1.0 {
            *time / per_second
        } else {
            *time * seconds
        };
    }
}

#[cfg(test)]
mod tests {
    use super::{is_unit, name_and_unit};

    #[test]
    fn products_of_known_symbols_are_units() {
        for unit in [
            "m/s^2", "[mm]", "N/mm", "kN·s/m", "m/s²", "°", "deg/s", "-", "kgf", "µm", "1/s", "rad/s",
        ] {
            assert!(is_unit(unit), "{unit}");
        }
        for other in ["furlong", "Travel", "wheel_left_z", "", "front", "05.03.2024", "x"] {
            assert!(!is_unit(other), "{other}");
        }
    }

    #[test]
    fn headings_are_split_into_name_and_unit() {
        let cases = [
            ("Travel [mm]", "Travel", "mm"),
            ("Acceleration (front)", "Acceleration (front)", ""),
            ("Force (kN)", "Force", "kN"),
            ("Kraft / N", "Kraft", "N"),
            ("Weg in mm", "Weg", "mm"),
            ("Force in front", "Force in front", ""),
            ("time", "time", ""),
        ];
        for (heading, name, unit) in cases {
            assert_eq!(name_and_unit(heading), (name.into(), unit.into()));
        }
    }
}
