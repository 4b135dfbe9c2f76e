//! Numbers with the digits that a curve can show.

/// Significant digits of a curve.
const DIGITS: usize = 5;

/// The nearest number with this number of digits.
pub fn rounded(value: f64) -> f64 {
    format!("{value:.*e}", DIGITS - 1).parse().unwrap_or(value)
}

/// The same for a curve.
pub fn curve(values: impl IntoIterator<Item = f64>) -> Vec<f64> {
    values.into_iter().map(rounded).collect()
}

#[cfg(test)]
mod tests {
    use super::rounded;

    #[test]
    fn five_digits_are_left() {
        assert_eq!(rounded(0.000123456789), 0.00012346);
        assert_eq!(rounded(-98765.4321), -98765.0);
        assert_eq!(rounded(0.0), 0.0);
        assert!(rounded(f64::NAN).is_nan());
    }
}
