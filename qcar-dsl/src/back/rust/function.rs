//! A straight-line program as Rust: one operation a line, a result stored where it is computed.

use std::collections::BTreeSet;

use crate::back::straight::{At, Function, Language, Local, Locals, Pieces, Straight, Written, computed, usual_name};
use crate::expr;
use crate::program::Value;
use crate::program::schedule::Compiled;

use super::names::names;

/// All straight-line functions of a model.
pub fn functions(compiled: &Compiled) -> Vec<String> {
    let straight = Straight::new(compiled);
    let functions = straight.functions("a line");
    functions.iter().map(|own| function(&straight, own)).collect()
}

/// The Rust text of a program: one function, or one that calls several in turn.
fn function(straight: &Straight, function: &Function) -> String {
    let cut = Pieces::cut(function.program);
    let pieces = (0..cut.pieces.len()).map(|piece| Printer::new(straight, function, &cut, piece).function());
    match cut.pieces.len() {
        1 => pieces.collect(),
        _ => [caller(function, &cut)]
            .into_iter()
            .chain(pieces)
            .collect::<Vec<_>>()
            .join("\n"),
    }
}

/// The function that hands its arguments to the pieces.
fn caller(function: &Function, cut: &Pieces) -> String {
    let arguments = function.arguments.iter();
    let arguments = arguments.map(|name| format!("{name}: {}", kind(name))).collect();
    let mut text = doc(&function.doc, computed(cut.program).count());
    text += &heading(&function.name, arguments, cut.program.outputs.len());
    text += &format!("    let mut kept = [V::of(0.0); {}];\n", cut.kept.len());
    for piece in 1..=cut.pieces.len() {
        text += &format!(
            "    V::apart(#[inline(always)] || {}_{piece}({}, &mut kept, out));\n",
            function.name,
            function.arguments.join(", ")
        );
    }
    text + "}\n"
}

/// What an argument is: entries for each lane, or a number of each.
fn kind(argument: &str) -> &'static str {
    match argument {
        "p" => "&impl Entries<V, PARAMETERS>",
        "constants" => "&impl Entries<V, CONSTANTS>",
        "x" => "&impl Entries<V, STATES>",
        "u" => "&impl Entries<V, INPUTS>",
        "contact" => "&seam::Contact<V>",
        _ => "V",
    }
}

fn doc(text: &str, count: usize) -> String {
    let operations = if count == 1 { "operation" } else { "operations" };
    let count = format!("{count} {operations}.");
    let lines = text.lines().chain(["", &count]);
    lines
        .map(|line| format!("{}\n", format!("/// {line}").trim_end()))
        .collect()
}

fn heading(name: &str, mut arguments: Vec<String>, results: usize) -> String {
    arguments.push(format!("out: &mut impl Results<V, {results}>"));
    format!(
        "#[inline(always)]\npub fn {name}<V: Number>({}) {{\n",
        arguments.join(", ")
    )
}

/// Prints one piece of a program, which may be all of it.
struct Printer<'a> {
    straight: &'a Straight<'a>,
    function: &'a Function<'a>,
    cut: &'a Pieces<'a>,
    piece: usize,
    locals: Locals,
}

impl<'a> Printer<'a> {
    fn new(straight: &'a Straight<'a>, function: &'a Function<'a>, cut: &'a Pieces<'a>, piece: usize) -> Self {
        let free = names(function.arguments);
        let leaf = |leaf| straight.local(leaf, function.arguments);
        Printer {
            straight,
            function,
            cut,
            piece,
            locals: Locals::new(function, cut, piece, free, &leaf),
        }
    }

    fn function(&self) -> String {
        let name = &self.function.name;
        let count = self.cut.pieces[self.piece].len();
        let results = self.cut.program.outputs.len();
        if self.cut.pieces.len() == 1 {
            return doc(&self.function.doc, count) + &heading(name, self.arguments(), results) + &self.body();
        }
        let number = self.piece + 1;
        let kept = format!("kept: &mut [V; {}]", self.cut.kept.len());
        let arguments = self.arguments().into_iter().chain([kept]).collect();
        doc(&format!("Piece {number} of [`{name}`]."), count)
            + &heading(&format!("{name}_{number}"), arguments, results)
            + &self.body()
    }

    /// The arguments; those that the piece does not read have an underscore in front.
    fn arguments(&self) -> Vec<String> {
        let read: BTreeSet<&str> = self.leaves().into_iter().map(|(local, _)| local.argument).collect();
        let underscore = |name: &str| if read.contains(name) { "" } else { "_" };
        let arguments = self.function.arguments.iter();
        arguments
            .map(|name| format!("{}{name}: {}", underscore(name), kind(name)))
            .collect()
    }

    fn leaves(&self) -> Vec<(Local, Value)> {
        let read = self.cut.read(self.piece).into_iter();
        read.map(|(leaf, value)| (self.straight.local(leaf, self.function.arguments), value))
            .collect()
    }

    fn body(&self) -> String {
        let leaves = self.leaves().into_iter().map(|(local, value)| {
            let at = match local.at {
                At::Entry(entry) => format!(".at({entry})"),
                At::Whole | At::Member(_) => local.at.to_string(),
            };
            format!("let {} = {}{at};", self.local(value), local.argument)
        });
        let kept = self.cut.inherited(self.piece).into_iter();
        let kept = kept.map(|value| format!("let {} = kept[{}];", self.local(value), self.cut.kept[&value]));
        let stored = self.cut.stored(self.piece).into_iter();
        let stored = stored.map(|(place, value)| self.store(place, value));
        let computed = self.cut.pieces[self.piece].iter();
        let computed = computed.flat_map(|&value| self.compute(value));
        indent(leaves.chain(kept).chain(stored).chain(computed)) + "}\n"
    }

    /// The statement that computes a value, and those that put it where it is wanted.
    fn compute(&self, value: Value) -> Vec<String> {
        let mut statements = vec![format!(
            "let {} = {};",
            self.local(value),
            self.written().operation(value)
        )];
        if let Some(place) = self.cut.kept.get(&value) {
            statements.push(format!("kept[{place}] = {};", self.local(value)));
        }
        let results = self.cut.results(value).iter();
        statements.extend(results.map(|&place| self.store(place, value)));
        statements
    }

    fn store(&self, place: usize, value: Value) -> String {
        let comment = self.function.results.get(place);
        let comment = comment.map(|result| format!(" // {result}"));
        format!(
            "out.put({place}, {});{}",
            self.written().operand(value),
            comment.unwrap_or_default()
        )
    }

    fn local(&self, value: Value) -> &str {
        self.locals.name(value)
    }

    fn written(&self) -> Written<'_> {
        Written {
            language: &Rust,
            program: self.cut.program,
            locals: &self.locals,
        }
    }
}

/// How Rust writes.
struct Rust;

impl Language for Rust {
    fn number(&self, number: f64) -> String {
        format!("V::of({})", self.knot(number))
    }

    fn call(&self, function: expr::Function, a: &str) -> String {
        let name = match function {
            expr::Function::Ln => "ln",
            other => usual_name(other),
        };
        format!("V::{name}({a})")
    }

    fn power(&self, a: &str, b: &str) -> String {
        format!("V::powf({a}, {b})")
    }

    fn smaller(&self, a: &str, b: &str) -> String {
        format!("V::min({a}, {b})")
    }

    fn larger(&self, a: &str, b: &str) -> String {
        format!("V::max({a}, {b})")
    }

    fn choice(&self, test: &str, a: &str, b: &str) -> String {
        format!("V::choose({test}, {a}, {b})")
    }

    /// The same in every lane.
    fn knot(&self, knot: f64) -> String {
        match knot {
            _ if knot.is_nan() => "f64::NAN".into(),
            _ if knot == f64::INFINITY => "f64::INFINITY".into(),
            _ if knot == f64::NEG_INFINITY => "f64::NEG_INFINITY".into(),
            _ => format!("{knot:?}"),
        }
    }

    /// Each row from a line of its own on.
    fn table(&self, order: u8, x: &str, rows: [Vec<String>; 3]) -> String {
        let row = |entries: Vec<String>| {
            let lines: Vec<String> = entries.chunks(ENTRIES).map(|line| line.join(", ")).collect();
            format!("    &[{}]", lines.join(",\n      "))
        };
        format!("{TABLE}({order}, {x},\n{})", rows.map(row).join(",\n"))
    }
}

/// How many points of a table stand on a line.
const ENTRIES: usize = 8;

/// What interpolates at run time.
const TABLE: &str = "::qcar_runtime::generated::table";

fn indent(statements: impl Iterator<Item = String>) -> String {
    let indented = |statement: String| -> String { statement.lines().flat_map(|line| ["    ", line, "\n"]).collect() };
    statements.map(indented).collect()
}
