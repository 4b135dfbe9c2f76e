//! Units in SI: factor, and exponents of kilogram, metre and second.

use crate::units::{bare, is_unit};

/// A unit in SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Si {
    /// A value in SI is `value * multiply / divide`: two numbers, so that 5 mm are exactly 0.005 m.
    pub multiply: f64,
    /// See `multiply`.
    pub divide: f64,
    /// Exponents of kilogram, metre and second. The radian counts as 1.
    pub dimension: [i32; 3],
}

/// Symbols without a prefix. `g` is the standard acceleration, since channels of rigs are no masses; `kg` is a separate
/// symbol.
const ALONE: &[(&str, f64, f64, [i32; 3])] = &[
    ("1", 1.0, 1.0, [0, 0, 0]),
    ("deg", std::f64::consts::PI, 180.0, [0, 0, 0]),
    ("°", std::f64::consts::PI, 180.0, [0, 0, 0]),
    ("rpm", std::f64::consts::PI, 30.0, [0, 0, -1]),
    ("%", 1.0, 100.0, [0, 0, 0]),
    ("kg", 1.0, 1.0, [1, 0, 0]),
    ("gn", 9.80665, 1.0, [0, 1, -2]),
    ("g0", 9.80665, 1.0, [0, 1, -2]),
    ("G", 9.80665, 1.0, [0, 1, -2]),
    ("sec", 1.0, 1.0, [0, 0, 1]),
    ("min", 60.0, 1.0, [0, 0, 1]),
    ("h", 3600.0, 1.0, [0, 0, 1]),
    ("in", 0.0254, 1.0, [0, 1, 0]),
    ("inch", 0.0254, 1.0, [0, 1, 0]),
    ("ft", 0.3048, 1.0, [0, 1, 0]),
    ("mph", 0.44704, 1.0, [0, 1, -1]),
    ("kph", 1.0, 3.6, [0, 1, -1]),
    ("kp", 9.80665, 1.0, [1, 1, -2]),
    ("kgf", 9.80665, 1.0, [1, 1, -2]),
    ("lbf", 4.448_221_615_260_5, 1.0, [1, 1, -2]),
    ("Nm", 1.0, 1.0, [1, 2, -2]),
    ("bar", 1e5, 1.0, [1, -1, -2]),
];

/// Symbols that may have a prefix.
const PREFIXED: &[(&str, f64, [i32; 3])] = &[
    ("m", 1.0, [0, 1, 0]),
    ("s", 1.0, [0, 0, 1]),
    ("g", 9.80665, [0, 1, -2]),
    ("N", 1.0, [1, 1, -2]),
    ("Pa", 1.0, [1, -1, -2]),
    ("Hz", 1.0, [0, 0, -1]),
    ("rad", 1.0, [0, 0, 0]),
    ("J", 1.0, [1, 2, -2]),
    ("W", 1.0, [1, 2, -3]),
];

const PREFIXES: &[(&str, f64, f64)] = &[
    ("", 1.0, 1.0),
    ("n", 1.0, 1e9),
    ("u", 1.0, 1e6),
    ("µ", 1.0, 1e6),
    ("μ", 1.0, 1e6),
    ("m", 1.0, 1e3),
    ("c", 1.0, 1e2),
    ("d", 1.0, 10.0),
    ("da", 10.0, 1.0),
    ("k", 1e3, 1.0),
    ("M", 1e6, 1.0),
    ("G", 1e9, 1.0),
];

/// A unit in SI, such as `m/s^2`, `m/s²`, `g`, `mm`, `kN` or `N*s/mm`; `None` for an unknown one, such as `V`. All
/// factors after a `/` are in the denominator.
pub fn in_si(unit: &str) -> Option<Si> {
    let plain = bare(unit).replace("**", "^").replace('²', "^2").replace('³', "^3");
    let mut parts = plain.split('/');
    let above = product(parts.next()?)?;
    parts.try_fold(above, |above, below| Some(per(above, product(below)?)))
}

/// True if a text is a unit, including non-mechanical ones such as `V` or `°C`.
pub fn is_known(unit: &str) -> bool {
    is_unit(unit) || in_si(unit).is_some()
}

fn product(text: &str) -> Option<Si> {
    let mut factors = bare(text)
        .split(['*', '·', ' '])
        .filter(|factor| !factor.is_empty())
        .peekable();
    factors.peek()?;
    let one = Si {
        multiply: 1.0,
        divide: 1.0,
        dimension: [0; 3],
    };
    factors.try_fold(one, |product, text| Some(times(product, factor(text)?)))
}

/// A symbol and its exponent: `s`, `s^2`, `s2` or `s^-2`.
fn factor(text: &str) -> Option<Si> {
    let symbol = text.trim_end_matches(|c: char| c.is_ascii_digit());
    let symbol = symbol.strip_suffix('-').unwrap_or(symbol);
    let power = text[symbol.len()..].trim_start_matches('^');
    let symbol = symbol.strip_suffix('^').unwrap_or(symbol);
    if symbol.is_empty() || known(text).is_some() {
        return known(text);
    }
    let (si, power) = (known(symbol)?, if power.is_empty() { 1 } else { power.parse().ok()? });
    (-9..=9).contains(&power).then(|| Si {
        multiply: si.multiply.powi(power),
        divide: si.divide.powi(power),
        dimension: si.dimension.map(|exponent| exponent * power),
    })
}

fn known(symbol: &str) -> Option<Si> {
    let alone = ALONE.iter().find(|(name, ..)| *name == symbol);
    if let Some(&(_, multiply, divide, dimension)) = alone {
        return Some(Si {
            multiply,
            divide,
            dimension,
        });
    }
    PREFIXES.iter().find_map(|&(prefix, multiply, divide)| {
        let rest = symbol.strip_prefix(prefix)?;
        let (_, size, dimension) = PREFIXED.iter().find(|(name, ..)| *name == rest)?;
        Some(Si {
            multiply: multiply * size,
            divide,
            dimension: *dimension,
        })
    })
}

fn times(a: Si, b: Si) -> Si {
    Si {
        multiply: a.multiply * b.multiply,
        divide: a.divide * b.divide,
        dimension: std::array::from_fn(|i| a.dimension[i] + b.dimension[i]),
    }
}

fn per(a: Si, b: Si) -> Si {
    Si {
        multiply: a.multiply * b.divide,
        divide: a.divide * b.multiply,
        dimension: std::array::from_fn(|i| a.dimension[i] - b.dimension[i]),
    }
}

#[cfg(test)]
mod tests {
    use super::in_si;

    const LENGTH: [i32; 3] = [0, 1, 0];
    const ACCELERATION: [i32; 3] = [0, 1, -2];
    const FORCE: [i32; 3] = [1, 1, -2];

    #[test]
    fn units_of_rigs_are_converted() {
        let cases = [
            ("m/s^2", 1.0, ACCELERATION),
            ("m/s²", 1.0, ACCELERATION),
            ("m/s2", 1.0, ACCELERATION),
            ("m/s/s", 1.0, ACCELERATION),
            ("m s^-2", 1.0, ACCELERATION),
            ("[mm/s^2]", 0.001, ACCELERATION),
            ("g", 9.80665, ACCELERATION),
            ("mg", 0.00980665, ACCELERATION),
            ("mm", 0.001, LENGTH),
            ("µm", 1e-6, LENGTH),
            ("in", 0.0254, LENGTH),
            ("kN", 1e3, FORCE),
            ("daN", 10.0, FORCE),
            ("kg m/s^2", 1.0, FORCE),
            ("km/h", 1.0 / 3.6, [0, 1, -1]),
            ("N/mm", 1e3, [1, 0, -2]),
            ("N*s/mm", 1e3, [1, 0, -1]),
            ("1/s", 1.0, [0, 0, -1]),
        ];
        for (unit, size, dimension) in cases {
            let si = in_si(unit).unwrap_or_else(|| panic!("{unit} is not known"));
            let value = si.multiply / si.divide;
            assert!(
                (value / size - 1.0).abs() < 1e-15 && si.dimension == dimension,
                "{unit}: {si:?}"
            );
        }
    }

    #[test]
    fn units_outside_mechanics_are_not_converted() {
        for unit in [
            "", "V", "mV/g", "counts", "°C", "N//m", "m^x", "s^99999", "-", "/s", "2", "dB", "m/",
        ] {
            assert_eq!(in_si(unit), None, "{unit}");
        }
    }

    #[test]
    fn a_decimal_prefix_rounds_once() {
        let si = in_si("mm").unwrap();
        assert_eq!(5.0 * si.multiply / si.divide, 0.005);
    }
}
