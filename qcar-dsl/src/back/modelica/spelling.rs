//! Operations, texts and units in the syntax of Modelica.

use crate::back::straight::Language;
use crate::units::Unit;

/// The syntax of Modelica.
pub struct Modelica;

impl Language for Modelica {
    /// A negative number is in parentheses, since the grammar does not allow two operators in a row.
    fn number(&self, number: f64) -> String {
        match number {
            _ if !number.is_finite() => format!("({}.0/0.0)", if number.is_nan() { 0.0 } else { number.signum() }),
            _ if number.is_sign_negative() => format!("({number:?})"),
            _ => format!("{number:?}"),
        }
    }

    fn choice(&self, test: &str, a: &str, b: &str) -> String {
        format!("if {test} > 0.0 then {a} else {b}")
    }

    /// A branch for each piece of the curve, and a straight line beyond each of its ends.
    fn table(&self, order: u8, x: &str, [knots, values, slopes]: [Vec<String>; 3]) -> String {
        let last = knots.len() - 1;
        let line = |at: usize| {
            let t = format!("({x} - {})", knots[at]);
            polynomial(order, &t, [&values[at], &slopes[at], "0.0", "0.0"])
        };
        let piece = |left: usize| {
            let (t, width) = (
                format!("({x} - {})", knots[left]),
                format!("({} - {})", knots[left + 1], knots[left]),
            );
            let secant = format!("(({} - {}) / {width})", values[left + 1], values[left]);
            let (near, far) = (&slopes[left], &slopes[left + 1]);
            let square = format!("((3.0 * {secant} - 2.0 * {near} - {far}) / {width})");
            let cube = format!("(({near} + {far} - 2.0 * {secant}) / ({width} * {width}))");
            polynomial(order, &t, [&values[left], near, &square, &cube])
        };
        let first = format!("if {x} < {} then {}", knots[0], line(0));
        let pieces = (0..last).map(|left| format!(" elseif {x} < {} then {}", knots[left + 1], piece(left)));
        format!("{first}{} else {}", pieces.collect::<String>(), line(last))
    }
}

/// A derivative of a + b t + c t² + d t³.
fn polynomial(order: u8, t: &str, [a, b, c, d]: [&str; 4]) -> String {
    match order {
        0 => format!("{a} + {t} * ({b} + {t} * ({c} + {t} * {d}))"),
        1 => format!("{b} + {t} * (2.0 * {c} + {t} * (3.0 * {d}))"),
        2 => format!("2.0 * {c} + {t} * (6.0 * {d})"),
        _ => format!("6.0 * {d}"),
    }
}

/// A text between quotes.
pub fn string(text: &str) -> String {
    format!(
        "\"{}\"",
        text.replace('\\', "\\\\").replace('"', "\\\"").replace('\n', " ")
    )
}

/// A unit in Modelica's notation: `N.s/m`, `m/s2`; empty if its powers are not whole.
pub fn unit(unit: Unit) -> String {
    if unit.sixths.iter().any(|sixths| sixths % 6 != 0) {
        return String::new();
    }
    unit.to_string().replace(' ', ".").replace('^', "")
}

/// Keywords, and functions that the model uses.
pub const RESERVED: &[&str] = &[
    "abs",
    "algorithm",
    "and",
    "annotation",
    "atan",
    "block",
    "break",
    "class",
    "connect",
    "connector",
    "constant",
    "constrainedby",
    "cos",
    "der",
    "discrete",
    "each",
    "else",
    "elseif",
    "elsewhen",
    "encapsulated",
    "end",
    "enumeration",
    "equation",
    "exp",
    "expandable",
    "extends",
    "external",
    "false",
    "final",
    "flow",
    "for",
    "function",
    "if",
    "import",
    "impure",
    "in",
    "initial",
    "inner",
    "input",
    "log",
    "loop",
    "max",
    "min",
    "model",
    "not",
    "operator",
    "or",
    "outer",
    "output",
    "package",
    "parameter",
    "partial",
    "protected",
    "public",
    "pure",
    "record",
    "redeclare",
    "replaceable",
    "return",
    "sign",
    "sin",
    "sqrt",
    "stream",
    "tan",
    "tanh",
    "then",
    "time",
    "true",
    "type",
    "when",
    "while",
    "within",
    "Real",
];
