//! Units: rational powers of kg, m and s (rad is 1).

use std::fmt;

/// Exponents of kg, m, s as fractions of 6, so that square and cube roots stay exact.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct Unit {
    /// Sixths of the exponents of kg, m and s.
    pub sixths: [i16; 3],
}

impl Unit {
    /// A plain number; also rad.
    pub const ONE: Unit = Unit::new(0, 0, 0);
    /// Mass.
    pub const KILOGRAM: Unit = Unit::new(1, 0, 0);
    /// Rotational inertia, kg m².
    pub const ROTATIONAL_INERTIA: Unit = Unit::new(1, 2, 0);
    /// Length.
    pub const METER: Unit = Unit::new(0, 1, 0);
    /// Time.
    pub const SECOND: Unit = Unit::new(0, 0, 1);
    /// Force.
    pub const NEWTON: Unit = Unit::new(1, 1, -2);

    /// Whole powers of kg, m and s.
    pub const fn new(kilogram: i16, meter: i16, second: i16) -> Unit {
        Unit {
            sixths: [6 * kilogram, 6 * meter, 6 * second],
        }
    }

    /// True if the unit has kg once, as those of a mass, stiffness, damping and force do.
    pub fn is_proportional_to_mass(self) -> bool {
        self.sixths[0] == Self::KILOGRAM.sixths[0]
    }

    /// The unit of a product.
    pub fn times(self, other: Unit) -> Unit {
        self.combine(other, i16::saturating_add)
    }

    /// The unit of a quotient.
    pub fn per(self, other: Unit) -> Unit {
        self.combine(other, i16::saturating_sub)
    }

    fn combine(self, other: Unit, exponent: impl Fn(i16, i16) -> i16) -> Unit {
        let [a, b] = [self.sixths, other.sixths];
        Unit {
            sixths: [exponent(a[0], b[0]), exponent(a[1], b[1]), exponent(a[2], b[2])],
        }
    }

    /// The unit of `a^exponent`; `None` if an exponent of the result is no multiple of 1/6, or larger than 100.
    pub fn power(self, exponent: f64) -> Option<Unit> {
        let mut sixths = [0; 3];
        for (result, own) in sixths.iter_mut().zip(self.sixths) {
            let exact = f64::from(own) * exponent;
            if (exact - exact.round()).abs() > 1e-9 || exact.abs() > 600.0 {
                return None;
            }
            *result = exact.round() as i16;
        }
        Some(Unit { sixths })
    }
}

/// A symbol with its unit and its size in SI, `multiply / divide`. Two numbers keep decimal sizes exact.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Symbol {
    /// 1000 for kN.
    pub multiply: f64,
    /// 1000 for mm.
    pub divide: f64,
    /// The coherent unit.
    pub unit: Unit,
}

/// The symbol of a name, if there is one.
pub fn symbol(name: &str) -> Option<Symbol> {
    let (_, multiply, divide, unit) = *SYMBOLS.iter().find(|(symbol, ..)| *symbol == name)?;
    Some(Symbol { multiply, divide, unit })
}

const SYMBOLS: &[(&str, f64, f64, Unit)] = &[
    ("kg", 1.0, 1.0, Unit::KILOGRAM),
    ("m", 1.0, 1.0, Unit::METER),
    ("mm", 1.0, 1e3, Unit::METER),
    ("cm", 1.0, 1e2, Unit::METER),
    ("km", 1e3, 1.0, Unit::METER),
    ("s", 1.0, 1.0, Unit::SECOND),
    ("ms", 1.0, 1e3, Unit::SECOND),
    ("N", 1.0, 1.0, Unit::NEWTON),
    ("kN", 1e3, 1.0, Unit::NEWTON),
    ("MN", 1e6, 1.0, Unit::NEWTON),
    ("Nm", 1.0, 1.0, Unit::new(1, 2, -2)),
    ("Ns", 1.0, 1.0, Unit::new(1, 1, -1)),
    ("J", 1.0, 1.0, Unit::new(1, 2, -2)),
    ("W", 1.0, 1.0, Unit::new(1, 2, -3)),
    ("Pa", 1.0, 1.0, Unit::new(1, -1, -2)),
    ("kPa", 1e3, 1.0, Unit::new(1, -1, -2)),
    ("MPa", 1e6, 1.0, Unit::new(1, -1, -2)),
    ("bar", 1e5, 1.0, Unit::new(1, -1, -2)),
    ("Hz", 1.0, 1.0, Unit::new(0, 0, -1)),
    ("rad", 1.0, 1.0, Unit::ONE),
    ("deg", std::f64::consts::PI, 180.0, Unit::ONE),
    ("percent", 1.0, 1e2, Unit::ONE),
];

impl fmt::Display for Unit {
    /// As an engineer writes it: with N if it contains a force, and numerators before denominators.
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let [kilogram, meter, second] = self.sixths;
        let factors = if kilogram != 0 && second != 0 {
            [
                ("N", kilogram),
                ("kg", 0),
                ("m", meter - kilogram),
                ("s", second + 2 * kilogram),
            ]
        } else {
            [("N", 0), ("kg", kilogram), ("m", meter), ("s", second)]
        };
        let raised = |positive: bool| -> Vec<String> {
            factors
                .iter()
                .filter(|(_, e)| *e != 0 && (*e > 0) == positive)
                .map(|(s, e)| factor(s, e.abs()))
                .collect()
        };
        let (above, below) = (raised(true), raised(false));
        let above = if above.is_empty() {
            "1".to_string()
        } else {
            above.join(" ")
        };
        match below.as_slice() {
            [] => write!(f, "{above}"),
            [one] => write!(f, "{above}/{one}"),
            several => write!(f, "{above}/({})", several.join(" ")),
        }
    }
}

/// A symbol to a positive power in sixths.
fn factor(symbol: &str, sixths: i16) -> String {
    match (sixths, sixths % 6, sixths % 3, sixths % 2) {
        (6, ..) => symbol.to_string(),
        (_, 0, ..) => format!("{symbol}^{}", sixths / 6),
        (_, _, 0, _) => format!("{symbol}^({}/2)", sixths / 3),
        (_, _, _, 0) => format!("{symbol}^({}/3)", sixths / 2),
        _ => format!("{symbol}^({sixths}/6)"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_print_as_an_engineer_writes_them() {
        for (unit, text) in [
            (Unit::ONE, "1"),
            (Unit::KILOGRAM, "kg"),
            (Unit::ROTATIONAL_INERTIA, "kg m^2"),
            (Unit::NEWTON.per(Unit::METER), "N/m"),
            (Unit::NEWTON.times(Unit::SECOND).per(Unit::METER), "N s/m"),
            (Unit::METER.per(Unit::SECOND).per(Unit::SECOND), "m/s^2"),
            (Unit::ONE.per(Unit::SECOND), "1/s"),
            (Unit::NEWTON.times(Unit::METER), "N m"),
            (Unit::new(0, -1, -1), "1/(m s)"),
            (Unit::new(0, 3, 0).power(0.5).unwrap(), "m^(3/2)"),
            (Unit::METER.power(1.0 / 3.0).unwrap(), "m^(1/3)"),
            (Unit::METER.power(1.0 / 6.0).unwrap(), "m^(1/6)"),
        ] {
            assert_eq!(unit.to_string(), text);
        }
    }

    #[test]
    fn a_root_and_its_power_cancel() {
        let root = Unit::NEWTON.power(0.5).unwrap();
        assert_eq!(root.times(root), Unit::NEWTON);
        assert_eq!(root.power(2.0), Some(Unit::NEWTON));
        assert_eq!(Unit::METER.power(0.2), None);
    }
}
