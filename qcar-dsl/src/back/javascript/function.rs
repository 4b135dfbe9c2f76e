//! A straight-line program as a function of JavaScript: one operation in each line; a result is stored where it is
//! computed.

use super::RESERVED;
use crate::back::straight::{
    FREQUENCIES, Function, Language, Leaf, Locals, Names, Pieces, ProgramText, Straight, usual_name,
};
use crate::expr;
use crate::program::Value;

/// The text of a function.
pub fn text(function: &Function, straight: &Straight) -> String {
    let cut = Pieces::whole(function.program);
    let arguments: Vec<&str> = function.arguments.iter().copied().map(passed).collect();
    let read = |leaf: Leaf| straight.local(leaf, function.arguments);
    let names = Names::beside(RESERVED.iter().copied().chain(arguments.iter().copied()));
    let locals = Locals::new(function, &cut, 0, names, &read);
    let written = ProgramText {
        language: &JavaScript,
        program: function.program,
        locals: &locals,
    };
    let store = |place: usize, value: Value| {
        let result = function.results.get(place).filter(|result| !result.is_empty());
        let remark = result.map_or(String::new(), |result| format!(" // {result}"));
        format!("out[{place}] = {};{remark}", written.operand(value))
    };
    let leaves = cut.read(0).into_iter().map(|(leaf, value)| {
        let from = read(leaf);
        let (name, argument) = (locals.name(value), passed(from.argument));
        format!("const {name} = {argument}{};", from.at)
    });
    let stored = cut.stored(0).into_iter().map(|(place, value)| store(place, value));
    let computed = cut.pieces[0].iter().flat_map(|&value| {
        let computed = format!("const {} = {};", locals.name(value), written.operation(value));
        let results = cut.results(value).iter().map(move |&place| store(place, value));
        [computed].into_iter().chain(results)
    });
    let lines = leaves.chain(stored).chain(computed);
    let body: String = lines.map(|statement| format!("  {statement}\n")).collect();
    format!(
        "function {}({}) {{\n  const out = [];\n{body}  return out;\n}}\n",
        function.name,
        arguments.join(", ")
    )
}

/// The name of an argument, which no leaf of the program has.
fn passed(argument: &str) -> &str {
    if argument == FREQUENCIES {
        "angular_frequency"
    } else {
        argument
    }
}

/// The syntax of JavaScript.
struct JavaScript;

impl Language for JavaScript {
    /// A negative number is in parentheses, since `--` is an operator.
    fn number(&self, number: f64) -> String {
        match number {
            _ if number.is_nan() => "NaN".into(),
            f64::INFINITY => "Infinity".into(),
            f64::NEG_INFINITY => "(-Infinity)".into(),
            _ if number.is_sign_negative() => format!("({number:?})"),
            _ => format!("{number:?}"),
        }
    }

    fn call(&self, function: expr::Function, a: &str) -> String {
        format!("Math.{}({a})", usual_name(function))
    }

    fn power(&self, a: &str, b: &str) -> String {
        format!("Math.pow({a}, {b})")
    }

    fn smaller(&self, a: &str, b: &str) -> String {
        format!("Math.min({a}, {b})")
    }

    fn larger(&self, a: &str, b: &str) -> String {
        format!("Math.max({a}, {b})")
    }

    fn choice(&self, test: &str, a: &str, b: &str) -> String {
        format!("{test} > 0 ? {a} : {b}")
    }

    fn table(&self, order: u8, x: &str, rows: [Vec<String>; 3]) -> String {
        let rows = rows.map(|entries| format!("[{}]", entries.join(", ")));
        format!("curve_at({order}, {x}, {})", rows.join(", "))
    }
}
