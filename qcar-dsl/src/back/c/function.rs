//! A straight-line program as C: one operation in each line; a result is stored where it is computed.

use std::collections::BTreeSet;

use crate::back::straight::{
    FREQUENCIES, Function, Language, Leaf, Local, Locals, Names, Pieces, ProgramText, Straight, usual_name,
};
use crate::expr;
use crate::program::Value;
use crate::program::schedule::Compiled;

use super::support::{LARGER, SIGN, SMALLER, TABLE};
use super::text::{self, comment, remark};

/// The functions of a model, printed.
pub struct Functions {
    /// Declarations for the header.
    pub declarations: String,
    /// Definitions for the source file.
    pub definitions: String,
}

impl Functions {
    /// Prints all of them.
    pub fn print(functions: &[Function], compiled: &Compiled) -> Functions {
        let straight = Straight::new(compiled);
        let mut printed = Functions {
            declarations: String::new(),
            definitions: String::new(),
        };
        for function in functions {
            let signature = Signature::new(function, &compiled.about.name);
            let declared = signature.heading("", &[]);
            let doc = format!("{}{}", function.doc, rows(function));
            printed.declarations += &format!("{}{declared};\n\n", comment(&doc));
            printed.definitions += &signature.definitions(&straight);
        }
        printed
    }
}

/// The meaning of the results of a frequency response. Those of other functions are entries of vectors or nonzeros.
fn rows(function: &Function) -> String {
    match (function.is_response(), function.name.ends_with("_jacobian")) {
        (true, false) => format!("\nIn out: {}.", function.results.join(", ")),
        (true, true) => "\nIn out: the rows of the response, then those of its Jacobian; the source names each.".into(),
        (false, _) => String::new(),
    }
}

/// The signature of a function.
struct Signature<'a> {
    function: &'a Function<'a>,
    /// The name of the model, which prefixes that of the function.
    model: &'a str,
}

impl<'a> Signature<'a> {
    fn new(function: &'a Function<'a>, model: &'a str) -> Self {
        Signature { function, model }
    }

    fn name(&self) -> String {
        format!("{}_{}", self.model, self.function.name)
    }

    /// `void axle_a_derivative(const double *constants, …, double *out)`
    fn heading(&self, suffix: &str, more: &[&str]) -> String {
        let arguments = self.function.arguments.iter().map(|argument| self.argument(argument));
        let more = more.iter().map(|argument| argument.to_string());
        let all: Vec<String> = arguments.chain(more).chain(["double *out".into()]).collect();
        format!("void {}{suffix}({})", self.name(), all.join(", "))
    }

    fn argument(&self, argument: &str) -> String {
        match argument {
            "contact" => format!("{}_contact contact", self.model),
            FREQUENCIES => "double omega".into(),
            "s" | "v" => format!("double {argument}"),
            _ => format!("const double *{argument}"),
        }
    }

    fn definitions(&self, straight: &Straight) -> String {
        let cut = Pieces::cut(self.function.program);
        let count = cut.pieces.len();
        let pieces = (0..count).map(|piece| Printer::new(self, straight, &cut, piece).definition());
        let pieces: String = pieces.collect();
        if count == 1 {
            pieces
        } else {
            pieces + &self.caller(&cut)
        }
    }

    /// The function that hands its arguments to the pieces.
    fn caller(&self, cut: &Pieces) -> String {
        let arguments = self.function.arguments.iter().map(|&argument| passed(argument));
        let arguments = arguments.collect::<Vec<_>>().join(", ");
        let calls =
            (1..=cut.pieces.len()).map(|piece| format!("    {}_{piece}({arguments}, kept, out);\n", self.name()));
        let kept = format!("    double kept[{}];\n", cut.kept.len().max(1));
        format!(
            "{}\n{{\n{kept}{}}}\n\n",
            self.heading("", &[]),
            calls.collect::<String>()
        )
    }
}

/// The name of an argument inside of a function.
fn passed(argument: &'static str) -> &'static str {
    if argument == FREQUENCIES { "omega" } else { argument }
}

/// Prints one piece of a program; a short program has one piece.
struct Printer<'a> {
    signature: &'a Signature<'a>,
    straight: &'a Straight<'a>,
    cut: &'a Pieces<'a>,
    piece: usize,
    locals: Locals,
}

impl<'a> Printer<'a> {
    fn new(signature: &'a Signature<'a>, straight: &'a Straight<'a>, cut: &'a Pieces<'a>, piece: usize) -> Self {
        let function = signature.function;
        let arguments = function.arguments.iter().map(|&argument| passed(argument));
        let free = Names::beside(RESERVED.iter().copied().chain(arguments));
        let read = |leaf: Leaf| straight.local(leaf, function.arguments);
        Printer {
            signature,
            straight,
            cut,
            piece,
            locals: Locals::new(function, cut, piece, free, &read),
        }
    }

    fn definition(&self) -> String {
        let heading = match self.cut.pieces.len() {
            1 => self.signature.heading("", &[]),
            _ => {
                let suffix = format!("_{}", self.piece + 1);
                format!("static {}", self.signature.heading(&suffix, &["double *kept"]))
            }
        };
        let lines = self.body().into_iter().map(|statement| format!("    {statement}\n"));
        format!("{heading}\n{{\n{}}}\n\n", lines.collect::<String>())
    }

    /// The values that it reads or inherits, those that it computes, and the arguments that it does not use.
    fn body(&self) -> Vec<String> {
        let (cut, piece) = (self.cut, self.piece);
        let arguments = self.signature.function.arguments;
        let leaves = cut.read(piece).into_iter();
        let leaves: Vec<(Local, Value)> = leaves
            .map(|(leaf, value)| (self.straight.local(leaf, arguments), value))
            .collect();
        let declare = |value: Value, from: String| format!("const double {} = {from};", self.locals.name(value));
        let read = leaves
            .iter()
            .map(|(local, value)| declare(*value, format!("{}{}", passed(local.argument), local.at)));
        let inherited = cut.inherited(piece).into_iter();
        let inherited = inherited.map(|value| declare(value, format!("kept[{}]", cut.kept[&value])));
        let computed = cut.pieces[piece].iter().flat_map(|&value| self.compute(value));
        let stored = cut.stored(piece).into_iter();
        let stored = stored.map(|(place, value)| self.store(place, value));
        let needed = leaves.iter().map(|(local, _)| local.argument).collect();
        let unused = self.unused(needed);
        let unused = unused.iter().map(|argument| format!("(void){argument};"));
        read.chain(inherited)
            .chain(computed)
            .chain(stored)
            .chain(unused)
            .collect()
    }

    /// The arguments that the piece does not use.
    fn unused(&self, read: BTreeSet<&str>) -> Vec<&'static str> {
        let (cut, piece) = (self.cut, self.piece);
        let computed = &cut.pieces[piece];
        let keeps = !cut.inherited(piece).is_empty() || computed.iter().any(|value| cut.kept.contains_key(value));
        let writes = !cut.stored(piece).is_empty() || computed.iter().any(|&v| !cut.results(v).is_empty());
        let arguments = self.signature.function.arguments.iter().copied();
        let mut unused: Vec<&str> = arguments
            .filter(|argument| !read.contains(argument))
            .map(passed)
            .collect();
        if cut.pieces.len() > 1 && !keeps {
            unused.push("kept");
        }
        if !writes {
            unused.push("out");
        }
        unused
    }

    /// The statements that compute a value and store it.
    fn compute(&self, value: Value) -> Vec<String> {
        let name = self.locals.name(value);
        let mut statements = vec![format!("const double {name} = {};", self.written().operation(value))];
        if let Some(place) = self.cut.kept.get(&value) {
            statements.push(format!("kept[{place}] = {name};"));
        }
        let results = self.cut.results(value).iter();
        statements.extend(results.map(|&place| self.store(place, value)));
        statements
    }

    fn store(&self, place: usize, value: Value) -> String {
        let result = self.signature.function.results.get(place).map_or("", |result| result);
        format!("out[{place}] = {};{}", self.written().operand(value), remark(result))
    }

    fn written(&self) -> ProgramText<'_> {
        ProgramText {
            language: &C,
            program: self.cut.program,
            locals: &self.locals,
        }
    }
}

/// The syntax of C.
struct C;

impl Language for C {
    fn number(&self, number: f64) -> String {
        text::number(number)
    }

    fn call(&self, function: expr::Function, a: &str) -> String {
        let name = match function {
            expr::Function::Abs => "fabs",
            expr::Function::Sign => SIGN,
            other => usual_name(other),
        };
        format!("{name}({a})")
    }

    fn power(&self, a: &str, b: &str) -> String {
        format!("pow({a}, {b})")
    }

    fn smaller(&self, a: &str, b: &str) -> String {
        format!("{SMALLER}({a}, {b})")
    }

    fn larger(&self, a: &str, b: &str) -> String {
        format!("{LARGER}({a}, {b})")
    }

    fn choice(&self, test: &str, a: &str, b: &str) -> String {
        format!("{test} > 0.0 ? {a} : {b}")
    }

    fn table(&self, order: u8, x: &str, rows: [Vec<String>; 3]) -> String {
        let count = rows[0].len();
        let rows = rows.map(|entries| format!("(const double[]){{{}}}", entries.join(", ")));
        format!("{TABLE}({order}, {x}, {count}, {})", rows.join(", "))
    }
}

/// Keywords of C and C++, and names that a function uses in addition to its own variables.
const RESERVED: &[&str] = &[
    "NAN",
    "INFINITY",
    "_",
    "alignas",
    "alignof",
    "and",
    "asm",
    "atan",
    "auto",
    "bool",
    "break",
    "case",
    "catch",
    "char",
    "class",
    "const",
    "continue",
    "cos",
    "default",
    "delete",
    "do",
    "double",
    "else",
    "enum",
    "exp",
    "explicit",
    "export",
    "extern",
    "fabs",
    "false",
    "float",
    "for",
    "friend",
    "goto",
    "if",
    "inline",
    "int",
    "kept",
    "log",
    "long",
    "mutable",
    "namespace",
    "new",
    "not",
    "operator",
    "or",
    "out",
    "pow",
    "private",
    "protected",
    "public",
    "register",
    "restrict",
    "return",
    "short",
    "signed",
    "sin",
    "sizeof",
    "sqrt",
    "static",
    "struct",
    "switch",
    "tan",
    "tanh",
    "template",
    "this",
    "throw",
    "true",
    "try",
    "typedef",
    "typename",
    "union",
    "unsigned",
    "using",
    "virtual",
    "void",
    "volatile",
    "while",
    "xor",
    SIGN,
    SMALLER,
    LARGER,
    TABLE,
];
