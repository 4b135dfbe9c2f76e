//! SI units of campaigns: `N s/m`, `N*s/m`, `kg m^2`, `m/s^2`, `m/s²`, `1`; and other units of files.

use qcar_signals::si::in_si;

/// Exponents of kilogram, metre and second. The radian counts as 1.
pub type Dimension = [i32; 3];

/// The dimension of a unit; `None` if it is no coherent SI unit (`N/mm`, `g`, `bar`, `deg`).
///
/// Everything after the one `/` divides: `N s/m`, `m/s^2`; another needs parentheses, `N/(m/s)`.
pub fn dimension(unit: &str) -> Option<Dimension> {
    let plain = unit.replace('²', "^2").replace('³', "^3");
    let spaced = plain.replace(['*', '·'], " ").replace(" ^ ", "^");
    let Some((above, below)) = spaced.split_once('/') else {
        return product(&spaced);
    };
    let below = match below.trim().strip_prefix('(') {
        Some(rest) => dimension(rest.strip_suffix(')')?)?,
        None => product(below)?,
    };
    let above = product(above)?;
    Some(std::array::from_fn(|i| above[i] - below[i]))
}

fn product(text: &str) -> Option<Dimension> {
    let mut factors = text.split_whitespace().peekable();
    factors.peek()?;
    factors.try_fold([0; 3], |sum, factor| {
        let (symbol, exponent) = match factor.split_once('^') {
            Some((symbol, exponent)) => (symbol, exponent.parse().ok()?),
            None => (factor, 1),
        };
        let base = base(symbol)?;
        Some(std::array::from_fn(|i| sum[i] + exponent * base[i]))
    })
}

fn base(symbol: &str) -> Option<Dimension> {
    Some(match symbol {
        "1" | "rad" => [0, 0, 0],
        "kg" => [1, 0, 0],
        "m" => [0, 1, 0],
        "s" => [0, 0, 1],
        "Hz" => [0, 0, -1],
        "N" => [1, 1, -2],
        "Pa" => [1, -1, -2],
        "J" => [1, 2, -2],
        "W" => [1, 2, -3],
        _ => return None,
    })
}

/// A unit of a file, and its value in SI.
#[derive(Clone, Debug, PartialEq)]
pub struct Declared {
    multiply: f64,
    divide: f64,
    /// The coherent SI unit of the same kind.
    pub coherent: String,
    /// As in the file.
    pub written: String,
}

impl Declared {
    /// `N/mm`, `N s/mm`, `mm`, `kN`, `km/h`, and every coherent unit; `None` if it is unknown. `g` is the standard
    /// acceleration.
    pub fn of(unit: &str) -> Option<Declared> {
        let unit = unit.trim();
        if dimension(unit).is_some() {
            return Some(Declared {
                multiply: 1.0,
                divide: 1.0,
                coherent: unit.into(),
                written: unit.into(),
            });
        }
        let si = in_si(unit)?;
        Some(Declared {
            multiply: si.multiply,
            divide: si.divide,
            coherent: coherent(si.dimension),
            written: unit.into(),
        })
    }

    /// A number with its unit, such as `187 N/mm`: its value in SI, and the unit.
    pub fn quantity(text: &str) -> Option<(f64, Declared)> {
        let text = text.trim();
        let mut ends = text.char_indices().map(|(at, c)| at + c.len_utf8()).rev();
        let end = ends.find(|&end| text[..end].trim_end().parse::<f64>().is_ok())?;
        let value = text[..end]
            .trim_end()
            .parse::<f64>()
            .ok()
            .filter(|value| value.is_finite())?;
        let unit = Declared::of(&text[end..])?;
        Some((unit.si(value), unit))
    }

    /// Converts a value in this unit to SI.
    pub fn si(&self, value: f64) -> f64 {
        value * self.multiply / self.divide
    }

    /// Converts a value in SI to this unit.
    pub fn shown(&self, value: f64) -> f64 {
        value * self.divide / self.multiply
    }

    /// True if it is of the kind of another unit.
    pub fn is_like(&self, unit: &str) -> bool {
        dimension(&self.coherent) == dimension(unit)
    }
}

/// True unless a unit for an angle does not say which angle it counts: a speed in `1/min` may be in revolutions.
pub fn says_its_angle(unit: &str, si: &str) -> bool {
    !si.starts_with("rad") || ["rad", "deg", "°", "rpm"].iter().any(|symbol| unit.contains(symbol))
}

/// Usual units of a dimension.
const USUAL: [(&str, Dimension); 12] = [
    ("1", [0, 0, 0]),
    ("kg", [1, 0, 0]),
    ("m", [0, 1, 0]),
    ("s", [0, 0, 1]),
    ("Hz", [0, 0, -1]),
    ("m/s", [0, 1, -1]),
    ("m/s^2", [0, 1, -2]),
    ("N", [1, 1, -2]),
    ("N/m", [1, 0, -2]),
    ("N s/m", [1, 0, -1]),
    ("N m", [1, 2, -2]),
    ("Pa", [1, -1, -2]),
];

/// The coherent unit of a dimension, in its usual form if there is one.
fn coherent(of: Dimension) -> String {
    let usual = USUAL.iter().find(|(_, dimension)| *dimension == of);
    usual.map_or_else(
        || {
            let base = ["kg", "m", "s"].iter().zip(of).filter(|(_, power)| *power != 0);
            base.map(|(symbol, power)| format!("{symbol}^{power}"))
                .collect::<Vec<_>>()
                .join(" ")
        },
        |(unit, _)| (*unit).into(),
    )
}

/// Examples of units of the same kind as a coherent one, for messages.
pub fn examples(si: &str) -> String {
    let such: &[&str] = match dimension(si) {
        _ if si == "rad" => &["deg", "mrad"],
        Some([0, 0, -1]) if si == "rad/s" => &["deg/s", "rpm"],
        Some([0, 1, 0]) => &["mm", "in"],
        Some([0, 1, -1]) => &["mm/s", "km/h"],
        Some([0, 1, -2]) => &["g", "mm/s^2"],
        Some([1, 1, -2]) => &["kN", "lbf"],
        Some([1, 0, -2]) => &["N/mm", "lbf/in"],
        Some([1, 0, -1]) => &["N s/mm", "kN s/m"],
        _ => &[],
    };
    let such: Vec<String> = such.iter().map(|unit| format!("\"{unit}\"")).collect();
    match such.is_empty() {
        true => format!("a unit of the kind of {si}"),
        false => format!("a unit of the kind of {si}, such as {}", such.join(" or ")),
    }
}

#[cfg(test)]
mod tests {
    use super::{Declared, coherent, dimension};

    #[test]
    fn declared_units_come_to_si_and_back() {
        for (unit, value, si, kind) in [
            ("N/mm", 25.0, 25e3, "N/m"),
            ("N s/mm", 1.5, 1500.0, "N s/m"),
            ("mm", 23.61, 0.02361, "m"),
            ("g", 1.0, 9.80665, "m/s^2"),
            ("km/h", 30.0, 30.0 / 3.6, "m/s"),
            ("N*s/m", 1410.0, 1410.0, "N*s/m"),
            ("N/(m/s)", 1410.0, 1410.0, "N/(m/s)"),
        ] {
            let declared = Declared::of(unit).unwrap();
            assert_eq!((declared.si(value), declared.coherent.as_str()), (si, kind), "{unit}");
            assert!((declared.shown(si) / value - 1.0).abs() < 1e-15, "{unit}");
        }
        assert_eq!(Declared::of("V"), None);
    }

    #[test]
    fn a_number_may_have_its_unit_after_it() {
        let si = |text| Declared::quantity(text).map(|(value, unit)| (value, unit.coherent));
        assert_eq!(si("187 N/mm"), Some((187e3, "N/m".into())));
        assert_eq!(si(" 1.5e3N s/m"), Some((1500.0, "N s/m".into())));
        assert_eq!(si("30 km/h"), Some((30.0 / 3.6, "m/s".into())));
        for text in ["", "187", "N/mm", "187 V", "inf m", "1 2 m"] {
            assert_eq!(si(text), None, "{text}");
        }
    }

    #[test]
    fn a_dimension_has_a_unit_that_has_it() {
        for of in [[1, 0, -2], [2, -3, 1], [0, 0, -2], [0, 0, 0]] {
            assert_eq!(dimension(&coherent(of)), Some(of));
        }
    }

    #[test]
    fn spellings_of_one_unit_agree() {
        let damping = dimension("N s/m");
        assert_eq!(damping, Some([1, 0, -1]));
        for spelling in ["N*s/m", "N·s/m", "N s / m", "N/(m/s)", "kg/s", "s N/m"] {
            assert_eq!(dimension(spelling), damping, "{spelling}");
        }
        assert_eq!(dimension("m/s^2"), Some([0, 1, -2]));
        assert_eq!(dimension("m/s²"), Some([0, 1, -2]));
        assert_eq!(dimension("1"), Some([0, 0, 0]));
    }

    #[test]
    fn what_is_not_coherent_has_no_dimension() {
        for unit in ["N/mm", "g", "", "/m", "N//m", "m^x", "deg", "N s/", "kN", "m/s/s"] {
            assert_eq!(dimension(unit), None, "{unit}");
        }
    }
}
