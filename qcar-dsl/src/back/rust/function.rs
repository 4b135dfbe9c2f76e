//! A straight-line program as Rust: one operation in each line; a result is stored where it is computed.

use std::collections::BTreeSet;

use crate::back::straight::{
    At, FREQUENCIES, Function, Language, Local, Locals, Pieces, ProgramText, Straight, computed,
};
use crate::program::Value;

use super::language::{Numbers, Vectors};
use super::names::{camel, names};

/// The kind of numbers that a function computes with.
#[derive(Clone, Copy)]
pub enum Form {
    /// Single numbers.
    Numbers,
    /// Vectors of several parameter sets.
    Sets,
    /// Vectors of several lines of a response that has so many outputs.
    Lines(usize),
}

impl Form {
    /// The arguments of a function with their types; the results come last.
    fn arguments(self, function: &Function) -> Vec<(&'static str, String)> {
        let results = function.program.outputs.len();
        match self {
            Form::Numbers => {
                let arguments = function.arguments.iter();
                let arguments = arguments.map(|&name| (name, of_number(name).to_string()));
                arguments.chain([("out", format!("&mut [f64; {results}]"))]).collect()
            }
            Form::Sets => vec![
                ("sets", format!("&{}<'_>", sets(function))),
                ("first", "usize".into()),
                ("out", format!("&mut [interface::Lanes; {results}]")),
            ],
            Form::Lines(outputs) => vec![
                ("constants", "&[interface::Lanes; CONSTANTS]".into()),
                (FREQUENCIES, "&interface::Lanes".into()),
                ("first", "usize".into()),
                ("out", format!("&mut LinesMut<'_, V, {outputs}, {results}>")),
            ],
        }
    }

    /// How a variable is read.
    fn read(self, local: &Local) -> String {
        let (argument, at) = (local.argument, local.at);
        let by_reference = if at == At::Whole { "" } else { "&" };
        match self {
            Form::Numbers => format!("{argument}{at}"),
            Form::Sets => format!("V::load({by_reference}sets.{argument}{at}, first)"),
            Form::Lines(_) => format!("V::load({by_reference}{argument}{at}, first)"),
        }
    }

    /// How a result is stored.
    fn store(self, place: usize, value: &str) -> String {
        match self {
            Form::Numbers => format!("out[{place}] = {value};"),
            Form::Sets => format!("V::store({value}, &mut out[{place}], first);"),
            Form::Lines(_) => format!("out.put({place}, {value});"),
        }
    }

    /// The type of a value.
    fn value(self) -> &'static str {
        match self {
            Form::Numbers => "f64",
            Form::Sets | Form::Lines(_) => "V",
        }
    }

    fn language(self) -> &'static dyn Language {
        match self {
            Form::Numbers => &Numbers,
            Form::Sets | Form::Lines(_) => &Vectors,
        }
    }

    fn doc(self, function: &Function) -> String {
        let own = format!("[`super::super::straight::{}`]", function.name);
        match self {
            Form::Numbers => function.doc.clone(),
            Form::Sets => format!("{own} of several parameter sets, each with its own state and input."),
            Form::Lines(_) => format!("{own} at several lines, or of several parameter sets at one."),
        }
    }
}

/// The type of the arguments of a function over parameter sets.
pub fn sets(function: &Function) -> String {
    camel(&format!("{}_sets", function.name))
}

/// The type of an argument of a function over single numbers.
fn of_number(argument: &str) -> &'static str {
    match argument {
        "p" => "&[f64; PARAMETERS]",
        "constants" => "&[f64; CONSTANTS]",
        "x" => "&[f64; STATES]",
        "u" => "&[f64; INPUTS]",
        "contact" => "&interface::Contact",
        _ => "f64",
    }
}

/// The Rust text of a program: one function, or one that calls several in turn.
pub fn function(straight: &Straight, function: &Function, form: Form) -> String {
    let cut = Pieces::cut(function.program);
    let pieces = (0..cut.pieces.len()).map(|piece| Printer::new(straight, function, form, &cut, piece).function());
    match cut.pieces.len() {
        1 => pieces.collect(),
        _ => [caller(function, form, &cut)]
            .into_iter()
            .chain(pieces)
            .collect::<Vec<_>>()
            .join("\n"),
    }
}

/// The function that hands its arguments to the pieces.
fn caller(function: &Function, form: Form, cut: &Pieces) -> String {
    let arguments = form.arguments(function);
    let (names, typed): (Vec<&str>, Vec<String>) = arguments
        .iter()
        .map(|(name, kind)| (*name, format!("{name}: {kind}")))
        .unzip();
    let mut text = doc(&form.doc(function), computed(cut.program).count());
    text += inline(form, &function.name);
    text += &heading(&function.name, typed);
    let zero = form.language().number(0.0);
    text += &format!("    let mut kept = [{zero}; {}];\n", cut.kept.len());
    for piece in 1..=cut.pieces.len() {
        text += &format!("    {}_{piece}({}, &mut kept);\n", function.name, names.join(", "));
    }
    text + "}\n"
}

fn doc(text: &str, count: usize) -> String {
    let operations = if count == 1 { "operation" } else { "operations" };
    let count = format!("{count} {operations}.");
    let lines = text.lines().chain(["", &count]);
    lines
        .map(|line| format!("{}\n", format!("/// {line}").trim_end()))
        .collect()
}

/// The `inline` attribute. A function that runs thousands of times in a ride is inlined into its caller. A piece, which
/// has no name of its own, is not: inlined, the pieces would again be as long as the whole program. Functions over
/// vectors are not inlined.
fn inline(form: Form, name: &str) -> &'static str {
    match (form, name) {
        (Form::Numbers, "rolling_derivative") => "#[inline]\n",
        (Form::Numbers, "") => "#[inline(never)]\n",
        _ => "",
    }
}

fn heading(name: &str, arguments: Vec<String>) -> String {
    format!("pub fn {name}({}) {{\n", arguments.join(", "))
}

/// Prints one piece of a program; a short program has one piece.
struct Printer<'a> {
    straight: &'a Straight<'a>,
    function: &'a Function<'a>,
    form: Form,
    cut: &'a Pieces<'a>,
    piece: usize,
    locals: Locals,
}

impl<'a> Printer<'a> {
    fn new(
        straight: &'a Straight<'a>,
        function: &'a Function<'a>,
        form: Form,
        cut: &'a Pieces<'a>,
        piece: usize,
    ) -> Self {
        let free = names(function.arguments);
        let leaf = |leaf| straight.local(leaf, function.arguments);
        Printer {
            straight,
            function,
            form,
            cut,
            piece,
            locals: Locals::new(function, cut, piece, free, &leaf),
        }
    }

    fn function(&self) -> String {
        let name = &self.function.name;
        let count = self.cut.pieces[self.piece].len();
        if self.cut.pieces.len() == 1 {
            let doc = doc(&self.form.doc(self.function), count) + inline(self.form, name);
            return doc + &heading(name, self.arguments()) + &self.body();
        }
        let number = self.piece + 1;
        let kept = format!("kept: &mut [{}; {}]", self.form.value(), self.cut.kept.len());
        let arguments = self.arguments().into_iter().chain([kept]).collect();
        doc(&format!("Piece {number} of [`{name}`]."), count)
            + inline(self.form, "")
            + &heading(&format!("{name}_{number}"), arguments)
            + &self.body()
    }

    /// The arguments; numbers that the piece does not read begin with an underscore.
    fn arguments(&self) -> Vec<String> {
        let read: BTreeSet<&str> = self.leaves().into_iter().map(|(local, _)| local.argument).collect();
        let unread = |name: &&str| self.function.arguments.contains(name) && !read.contains(*name);
        let arguments = self.form.arguments(self.function).into_iter();
        arguments
            .map(|(name, kind)| format!("{}{name}: {kind}", if unread(&name) { "_" } else { "" }))
            .collect()
    }

    fn leaves(&self) -> Vec<(Local, Value)> {
        let read = self.cut.read(self.piece).into_iter();
        read.map(|(leaf, value)| (self.straight.local(leaf, self.function.arguments), value))
            .collect()
    }

    fn body(&self) -> String {
        let leaves = self.leaves().into_iter();
        let leaves = leaves.map(|(local, value)| format!("let {} = {};", self.local(value), self.form.read(&local)));
        let kept = self.cut.inherited(self.piece).into_iter();
        let kept = kept.map(|value| format!("let {} = kept[{}];", self.local(value), self.cut.kept[&value]));
        let stored = self.cut.stored(self.piece).into_iter();
        let stored = stored.map(|(place, value)| self.store(place, value));
        let computed = self.cut.pieces[self.piece].iter();
        let computed = computed.flat_map(|&value| self.compute(value));
        indent(leaves.chain(kept).chain(stored).chain(computed)) + "}\n"
    }

    /// The statements that compute a value and store it.
    fn compute(&self, value: Value) -> impl Iterator<Item = String> {
        let computed = format!("let {} = {};", self.local(value), self.written().operation(value));
        let kept = self.cut.kept.get(&value);
        let kept = kept.map(|place| format!("kept[{place}] = {};", self.local(value)));
        let results = self.cut.results(value).iter();
        let stored = results.map(move |&place| self.store(place, value));
        [computed].into_iter().chain(kept).chain(stored)
    }

    fn store(&self, place: usize, value: Value) -> String {
        let stored = self.form.store(place, &self.written().operand(value));
        match self.function.results.get(place) {
            Some(result) => stored + " // " + result,
            None => stored,
        }
    }

    fn local(&self, value: Value) -> &str {
        self.locals.name(value)
    }

    fn written(&self) -> ProgramText<'_> {
        ProgramText {
            language: self.form.language(),
            program: self.cut.program,
            locals: &self.locals,
        }
    }
}

fn indent(statements: impl Iterator<Item = String>) -> String {
    let mut text = String::new();
    for statement in statements {
        for line in statement.lines() {
            text.extend(["    ", line, "\n"]);
        }
    }
    text
}
