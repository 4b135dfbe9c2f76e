//! Quantities in messages: in SI, unless the program shows them in other units.

use std::fmt;
use std::sync::OnceLock;

/// Converts a value in an SI unit to the unit in which it is shown, with the name of that; `None` if it is shown in SI.
pub type Convert = fn(f64, &str) -> Option<(f64, String)>;

static CONVERT: OnceLock<Convert> = OnceLock::new();

/// Sets the units of all messages of this process. The first choice holds.
pub fn convert_by(convert: Convert) {
    let _ = CONVERT.set(convert);
}

/// A quantity in a message. A precision such as `{:.4}` is that of its value in SI; without one it has six digits.
#[derive(Clone, Copy, Debug)]
pub struct Shown<'a> {
    /// Value in the unit `si`.
    pub value: f64,
    /// SI unit.
    pub si: &'a str,
}

/// A value in an SI unit, to be shown.
pub fn shown(value: f64, si: &str) -> Shown<'_> {
    Shown { value, si }
}

impl fmt::Display for Shown<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.converted() {
            Some((value, unit)) => write!(out, "{value} {unit}"),
            None => {
                let digits = out.precision().map_or_else(|| six_digits(self.value), |_| self.value);
                fmt::Display::fmt(&digits, out)?;
                self.unit(out)
            }
        }
    }
}

impl fmt::LowerExp for Shown<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.converted() {
            Some((value, unit)) => write!(out, "{value} {unit}"),
            None => {
                fmt::LowerExp::fmt(&self.value, out)?;
                self.unit(out)
            }
        }
    }
}

impl Shown<'_> {
    fn converted(&self) -> Option<(f64, String)> {
        let (value, unit) = CONVERT.get().and_then(|convert| convert(self.value, self.si))?;
        Some((six_digits(value), unit))
    }

    fn unit(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.si {
            "" | "1" => Ok(()),
            si => write!(out, " {si}"),
        }
    }
}

/// A value rounded to six digits: a factor between units adds further ones, which say nothing.
pub fn six_digits(value: f64) -> f64 {
    rounded(value, 6)
}

/// A value rounded to a number of digits, at least 1.
pub fn rounded(value: f64, digits: usize) -> f64 {
    format!("{value:.*e}", digits - 1).parse().unwrap_or(value)
}
