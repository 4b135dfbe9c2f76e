//! A straight-line program as Rust: one operation in each line; a result is stored where it is computed.

use std::collections::BTreeSet;

use crate::back::straight::{
    FREQUENCIES, Function, Language, Leaf, Local, Locals, Pieces, ProgramText, Straight, computed,
};
use crate::expr;
use crate::program::Value;
use crate::program::schedule::Compiled;

use super::names::names;

/// All straight-line functions of a model.
pub fn functions(compiled: &Compiled) -> Vec<String> {
    let straight = Straight::new(compiled);
    let mut functions = straight.functions("a block of lines");
    let widths = functions.iter().map(|function| match function.is_response() {
        true => Width::Lines,
        false => Width::One,
    });
    let mut widths: Vec<Width> = widths.collect();
    let sets = straight
        .functions("")
        .into_iter()
        .filter(|own| SETS.contains(&own.name.as_str()));
    functions.extend(sets.map(of_sets));
    widths.resize(functions.len(), Width::Sets);
    let all = functions.iter().zip(widths);
    all.map(|(own, width)| written(&straight, own, width)).collect()
}

/// The functions that also exist for several parameter sets at once.
const SETS: [&str; 6] = [
    "prepare",
    "derivative",
    "matrices",
    "sensitivities",
    "contact_force",
    "rolling_derivative",
];

fn of_sets(function: Function) -> Function {
    Function {
        doc: format!(
            "[`{}`] of several parameter sets at once, each with its own state and input.",
            function.name
        ),
        name: format!("{}_sets", function.name),
        ..function
    }
}

fn written(straight: &Straight, function: &Function, width: Width) -> String {
    self::function(&Signature {
        function,
        doc: function.doc.lines().map(String::from).collect(),
        arguments: function
            .arguments
            .iter()
            .map(|&argument| (argument, kind(argument, width)))
            .collect(),
        leaf: &|leaf| straight.local(leaf, function.arguments),
        width,
    })
}

fn kind(argument: &str, width: Width) -> &'static str {
    match (argument, width) {
        ("p", Width::Sets) => "&[[f64; LINES]; PARAMETERS]",
        ("constants", Width::Sets) => "&[[f64; LINES]; CONSTANTS]",
        ("x", Width::Sets) => "&[[f64; LINES]; STATES]",
        ("u", Width::Sets) => "&[[f64; LINES]; INPUTS]",
        ("s" | "v", Width::Sets) => "&[f64; LINES]",
        ("contact", Width::Sets) => "&seam::Contacts",
        ("p", _) => "&[f64; PARAMETERS]",
        ("constants", _) => "&[f64; CONSTANTS]",
        ("x", _) => "&[f64; STATES]",
        ("u", _) => "&[f64; INPUTS]",
        ("contact", _) => "&seam::Contact",
        (FREQUENCIES, _) => "&[f64; LINES]",
        _ => "f64",
    }
}

/// Number of operations in a piece over several sets. LLVM does not vectorise a loop that writes to about 250 rows, so
/// eight sets take eight times as long as one. With pieces of 30 to 100 operations they take a third of that.
const OF_SETS: usize = 60;

/// How many points or sets a function computes in a call. More than one are a loop, which the optimiser vectorises.
#[derive(Clone, Copy, PartialEq)]
enum Width {
    /// One point of one parameter set.
    One,
    /// A block of lines of a frequency response.
    Lines,
    /// A block of parameter sets.
    Sets,
}

impl Width {
    fn is_wide(self) -> bool {
        self != Width::One
    }

    /// True if an argument has another value in each pass of the loop.
    fn varies(self, argument: &str) -> bool {
        self == Width::Sets || argument == FREQUENCIES
    }

    /// The name of a pass of the loop, for the count of operations.
    fn turn(self) -> &'static str {
        match self {
            Width::One => "",
            Width::Lines => " a line",
            Width::Sets => " a set",
        }
    }
}

/// The signature of a function.
struct Signature<'a> {
    function: &'a Function<'a>,
    /// Its doc comment, line by line; the operation count is added.
    doc: Vec<String>,
    /// Names and types of the arguments that it may read, `("p", "&[f64; 19]")`.
    arguments: Vec<(&'static str, &'static str)>,
    /// Where a leaf is read, and its name.
    leaf: &'a dyn Fn(Leaf) -> Local,
    /// How many points or sets the function computes.
    width: Width,
}

/// The Rust text of a program: one function, or a function that calls one for each piece.
fn function(signature: &Signature) -> String {
    let cut = match signature.width {
        Width::Sets => Pieces::cut_to(signature.function.program, OF_SETS),
        Width::One | Width::Lines => Pieces::cut(signature.function.program),
    };
    let pieces = (0..cut.pieces.len()).map(|piece| Printer::new(signature, &cut, piece).function());
    match cut.pieces.len() {
        1 => pieces.collect(),
        _ => [caller(signature, &cut)]
            .into_iter()
            .chain(pieces)
            .collect::<Vec<_>>()
            .join("\n"),
    }
}

/// The function that hands its arguments to the pieces.
fn caller(signature: &Signature, cut: &Pieces) -> String {
    let names: Vec<&str> = signature.arguments.iter().map(|(name, _)| *name).collect();
    let wide = signature.width.is_wide();
    let zero = if wide { "[0.0; LINES]" } else { "0.0" };
    let mut text = doc(&signature.doc, computed(cut.program).count(), signature.width) + inline(signature, true);
    let arguments = signature
        .arguments
        .iter()
        .map(|(name, kind)| format!("{name}: {kind}"))
        .collect();
    text += &heading(&signature.function.name, arguments, wide, cut.program.outputs.len());
    text += &format!("    let mut kept = [{zero}; {}];\n", cut.kept.len());
    for piece in 1..=cut.pieces.len() {
        text += &format!(
            "    {}_{piece}({}, &mut kept, out);\n",
            signature.function.name,
            names.join(", ")
        );
    }
    text + "}\n"
}

fn doc(lines: &[String], count: usize, width: Width) -> String {
    let operations = if count == 1 { "operation" } else { "operations" };
    let count = format!("{count} {operations}{}.", width.turn());
    let lines = lines.iter().cloned().chain([String::new(), count]);
    lines
        .map(|line| format!("{}\n", format!("/// {line}").trim_end()))
        .collect()
}

fn heading(name: &str, mut arguments: Vec<String>, lines: bool, results: usize) -> String {
    arguments.push(format!("out: &mut {}", array(lines, results)));
    format!("pub fn {name}({}) {{\n", arguments.join(", "))
}

/// The `inline` attribute. Code over several lines is inlined into one function for each instruction set, as one loop
/// after another. Functions that run thousands of times in a ride are inlined into their callers. Any other piece stays
/// a separate function: inlined, the pieces would again be as long as the whole program.
fn inline(signature: &Signature, whole: bool) -> &'static str {
    match (signature.width.is_wide(), whole) {
        (true, _) => "#[inline(always)]\n",
        (false, true) if signature.function.name == "rolling_derivative" => "#[inline]\n",
        (false, true) => "",
        (false, false) => "#[inline(never)]\n",
    }
}

fn array(lines: bool, length: usize) -> String {
    format!("[{}; {length}]", if lines { "[f64; LINES]" } else { "f64" })
}

/// Prints one piece of a program; a short program has one piece.
struct Printer<'a> {
    signature: &'a Signature<'a>,
    cut: &'a Pieces<'a>,
    piece: usize,
    locals: Locals,
}

impl<'a> Printer<'a> {
    fn new(signature: &'a Signature<'a>, cut: &'a Pieces<'a>, piece: usize) -> Self {
        let free = names(signature.function.arguments);
        Printer {
            signature,
            cut,
            piece,
            locals: Locals::new(signature.function, cut, piece, free, signature.leaf),
        }
    }

    fn function(&self) -> String {
        let (name, width) = (&self.signature.function.name, self.signature.width);
        let count = self.cut.pieces[self.piece].len();
        let results = self.cut.program.outputs.len();
        if self.cut.pieces.len() == 1 {
            let (doc, heading) = (
                doc(&self.signature.doc, count, width),
                heading(name, self.arguments(), width.is_wide(), results),
            );
            return doc + inline(self.signature, true) + &heading + &self.body();
        }
        let number = self.piece + 1;
        let kept = format!("kept: &mut {}", array(width.is_wide(), self.cut.kept.len()));
        let arguments = self.arguments().into_iter().chain([kept]).collect();
        doc(&[format!("Piece {number} of [`{name}`].")], count, width)
            + inline(self.signature, false)
            + &heading(&format!("{name}_{number}"), arguments, width.is_wide(), results)
            + &self.body()
    }

    /// The arguments; those that the piece does not read begin with an underscore.
    fn arguments(&self) -> Vec<String> {
        let read: BTreeSet<&str> = self.leaves().into_iter().map(|(local, _)| local.argument).collect();
        let underscore = |name: &str| if read.contains(name) { "" } else { "_" };
        let arguments = self.signature.arguments.iter();
        arguments
            .map(|(name, kind)| format!("{}{name}: {kind}", underscore(name)))
            .collect()
    }

    fn leaves(&self) -> Vec<(Local, Value)> {
        let read = self.cut.read(self.piece).into_iter();
        read.map(|(leaf, value)| ((self.signature.leaf)(leaf), value)).collect()
    }

    fn body(&self) -> String {
        let (a_line, once): (Vec<_>, Vec<_>) = self
            .leaves()
            .into_iter()
            .partition(|(local, _)| self.signature.width.varies(local.argument));
        let read = |(local, value): &(Local, Value)| {
            let line = if self.signature.width.varies(local.argument) {
                self.line()
            } else {
                ""
            };
            format!("let {} = {}{}{line};", self.local(*value), local.argument, local.at)
        };
        let once: Vec<String> = once.iter().map(read).collect();
        let kept = self.cut.inherited(self.piece).into_iter().map(|value| {
            format!(
                "let {} = kept[{}]{};",
                self.local(value),
                self.cut.kept[&value],
                self.line()
            )
        });
        let stored = self
            .cut
            .stored(self.piece)
            .into_iter()
            .map(|(place, value)| self.store(place, value));
        let computed = self.cut.pieces[self.piece]
            .iter()
            .flat_map(|&value| self.compute(value));
        let repeated: Vec<String> = a_line
            .iter()
            .map(read)
            .chain(kept)
            .chain(stored)
            .chain(computed)
            .collect();
        match self.signature.width.is_wide() {
            true => format!(
                "{}    for line in 0..LINES {{\n{}    }}\n}}\n",
                indent(&once, 1),
                indent(&repeated, 2)
            ),
            false => format!("{}{}}}\n", indent(&once, 1), indent(&repeated, 1)),
        }
    }

    /// The index of the line or set; empty if there is only one.
    fn line(&self) -> &'static str {
        if self.signature.width.is_wide() { "[line]" } else { "" }
    }

    /// The statements that compute a value and store it.
    fn compute(&self, value: Value) -> Vec<String> {
        let mut statements = vec![format!(
            "let {} = {};",
            self.local(value),
            self.written().operation(value)
        )];
        if let Some(place) = self.cut.kept.get(&value) {
            statements.push(format!("kept[{place}]{} = {};", self.line(), self.local(value)));
        }
        let results = self.cut.results(value).iter();
        statements.extend(results.map(|&place| self.store(place, value)));
        statements
    }

    fn store(&self, place: usize, value: Value) -> String {
        let comment = self
            .signature
            .function
            .results
            .get(place)
            .map(|result| format!(" // {result}"));
        format!(
            "out[{place}]{} = {};{}",
            self.line(),
            self.written().operand(value),
            comment.unwrap_or_default()
        )
    }

    fn local(&self, value: Value) -> &str {
        self.locals.name(value)
    }

    fn written(&self) -> ProgramText<'_> {
        ProgramText {
            language: &Rust,
            program: self.cut.program,
            locals: &self.locals,
        }
    }
}

/// The syntax of Rust.
struct Rust;

impl Language for Rust {
    fn number(&self, number: f64) -> String {
        match number {
            _ if number.is_nan() => "f64::NAN".into(),
            _ if number == f64::INFINITY => "f64::INFINITY".into(),
            _ if number == f64::NEG_INFINITY => "f64::NEG_INFINITY".into(),
            _ => format!("{number:?}"),
        }
    }

    fn call(&self, function: expr::Function, a: &str) -> String {
        format!("{}({a})", function_path(function))
    }

    fn power(&self, a: &str, b: &str) -> String {
        format!("f64::powf({a}, {b})")
    }

    fn smaller(&self, a: &str, b: &str) -> String {
        format!("f64::min({a}, {b})")
    }

    fn larger(&self, a: &str, b: &str) -> String {
        format!("f64::max({a}, {b})")
    }

    fn choice(&self, test: &str, a: &str, b: &str) -> String {
        format!("if {test} > 0.0 {{ {a} }} else {{ {b} }}")
    }

    /// Each row begins on a line of its own.
    fn table(&self, order: u8, x: &str, rows: [Vec<String>; 3]) -> String {
        let row = |entries: Vec<String>| {
            let lines: Vec<String> = entries.chunks(ENTRIES).map(|line| line.join(", ")).collect();
            format!("    &[{}]", lines.join(",\n      "))
        };
        format!("{TABLE}({order}, {x},\n{})", rows.map(row).join(",\n"))
    }
}

/// Number of points of a table in one line.
const ENTRIES: usize = 8;

/// The function that interpolates at run time.
const TABLE: &str = "::qcar_runtime::generated::table";

fn indent(statements: &[String], depth: usize) -> String {
    let margin = "    ".repeat(depth);
    let lines = statements.iter().flat_map(|statement| statement.lines());
    lines.flat_map(|line| [margin.as_str(), line, "\n"]).collect()
}

fn function_path(f: expr::Function) -> &'static str {
    match f {
        expr::Function::Abs => "f64::abs",
        expr::Function::Sign => "sign",
        expr::Function::Sqrt => "f64::sqrt",
        expr::Function::Exp => "f64::exp",
        expr::Function::Ln => "f64::ln",
        expr::Function::Sin => "f64::sin",
        expr::Function::Cos => "f64::cos",
        expr::Function::Tan => "f64::tan",
        expr::Function::Atan => "f64::atan",
        expr::Function::Tanh => "f64::tanh",
    }
}
