//! A straight-line program as statements of MATLAB, and their helper functions.

use crate::back::straight::{Language, Leaf, Locals, Pieces, ProgramText};
use crate::program::{Op, Program, Value};

/// A program in one piece, with the names of its values.
pub struct Statements<'a> {
    pub cut: &'a Pieces<'a>,
    pub locals: &'a Locals,
}

impl Statements<'_> {
    /// All statements. `read` gives the expression from which a leaf is read; `target` gives the place where a result
    /// is stored, and its name.
    pub fn all(&self, read: &dyn Fn(Leaf) -> String, target: &dyn Fn(usize) -> (String, String)) -> String {
        let leaves = self.cut.read(0).into_iter();
        let leaves = leaves.map(|(leaf, value)| format!("{} = {};", self.locals.name(value), read(leaf)));
        let store = |place: usize, value: Value| {
            let (to, what) = target(place);
            format!("{to} = {}; % {what}", self.written().operand(value))
        };
        let stored = self.cut.stored(0).into_iter().map(|(place, value)| store(place, value));
        let computed = self.cut.pieces[0].iter().flat_map(|&value| {
            let computed = format!("{} = {};", self.locals.name(value), self.written().operation(value));
            let stored = self.cut.results(value).iter().map(move |&place| store(place, value));
            [computed].into_iter().chain(stored)
        });
        let lines = leaves.chain(stored).chain(computed);
        lines.map(|statement| format!("    {statement}\n")).collect()
    }

    fn written(&self) -> ProgramText<'_> {
        ProgramText {
            language: &Matlab,
            program: self.cut.program,
            locals: self.locals,
        }
    }
}

/// The syntax of MATLAB.
struct Matlab;

impl Language for Matlab {
    /// A negative number is in parentheses, since `^` binds more tightly than `-`.
    fn number(&self, number: f64) -> String {
        match number {
            _ if number.is_nan() => "NaN".into(),
            _ if number == f64::INFINITY => "Inf".into(),
            _ if number == f64::NEG_INFINITY => "(-Inf)".into(),
            _ if number.is_sign_negative() => format!("({number:?})"),
            _ => format!("{number:?}"),
        }
    }

    fn choice(&self, test: &str, a: &str, b: &str) -> String {
        format!("choose({test}, {a}, {b})")
    }

    fn table(&self, order: u8, x: &str, rows: [Vec<String>; 3]) -> String {
        let rows = rows.map(|entries| format!("[{}]", entries.join(", ")));
        format!("curve_at({order}, {x}, {})", rows.join(", "))
    }
}

/// A text between quotes.
pub fn text(text: &str) -> String {
    format!("'{}'", text.replace('\'', "''"))
}

/// The functions that a program uses.
pub fn support(program: &Program) -> String {
    let any = |is: fn(&Op) -> bool| program.ops.iter().any(is);
    let parts = [
        (any(|op| matches!(op, Op::Select(..))), CHOOSE),
        (any(|op| matches!(op, Op::Table(..))), CURVE),
    ];
    parts.iter().filter(|(used, _)| *used).map(|(_, text)| *text).collect()
}

const CHOOSE: &str = "
function r = choose(test, a, b)
    if test > 0, r = a; else, r = b; end
end
";

const CURVE: &str = "
% A derivative of the piecewise cubic curve through points; beyond its ends it is a straight line.
function r = curve_at(order, x, knots, values, slopes)
    above = sum(knots <= x);
    left = max(above, 1);
    t = x - knots(left);
    square = 0;
    cube = 0;
    if above > 0 && above < numel(knots)
        width = knots(left + 1) - knots(left);
        secant = (values(left + 1) - values(left)) / width;
        square = (3 * secant - 2 * slopes(left) - slopes(left + 1)) / width;
        cube = (slopes(left) + slopes(left + 1) - 2 * secant) / (width * width);
    end
    switch order
        case 0
            r = values(left) + t * (slopes(left) + t * (square + t * cube));
        case 1
            r = slopes(left) + t * (2 * square + t * (3 * cube));
        case 2
            r = 2 * square + t * (6 * cube);
        otherwise
            r = 6 * cube;
    end
end
";
