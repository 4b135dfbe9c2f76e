//! A compiled model printed as C99: a header and a source that need `math.h` and nothing else.
//!
//! Every statement is one operation of a program, in its order, so a compiler that contracts nothing
//! (`-ffp-contract=off`) gives the bits of the evaluator if both call the same `libm`. The functions allocate nothing
//! and keep no state between calls.

// Texts as comments and literals.
mod text;
// Definitions that all functions use.
mod support;
// A program as a C function.
mod function;
// Sizes, indices and declarations.
mod header;
// Names, units and sparsity as data.
mod data;

use crate::back::straight::{Function, Straight, kinks};
use crate::program::Program;
use crate::program::schedule::Compiled;

/// The two files of a model.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sources {
    /// Sizes, positions and declarations.
    pub header: String,
    /// The functions and the data.
    pub source: String,
}

/// A model as C, with `values` as the defaults of its parameters; `stem` is the name of the files without extension.
pub fn sources(compiled: &Compiled, values: &[f64], stem: &str) -> Sources {
    let about = &compiled.about;
    let kinks = motion_kinks(compiled);
    let functions = functions(compiled, &kinks);
    let printed = function::Functions::print(&functions, compiled);
    let source = [
        format!(
            "/* {}; see {stem}.h. */\n\n#include \"{stem}.h\"\n\n#include <math.h>\n",
            about.name
        ),
        support::used(functions.iter().map(|function| function.program)),
        data::data(about, values),
        printed.definitions,
        data::functions(about),
    ];
    Sources {
        header: header::header(compiled, &kinks, &printed.declarations),
        source: source.join("\n"),
    }
}

/// The kinks of the equations of motion. An integrator locates the times at which their values change sign.
pub fn motion_kinks(compiled: &Compiled) -> Program {
    kinks(&compiled.programs.derivative)
}

fn functions<'a>(compiled: &'a Compiled, kinks: &'a Program) -> Vec<Function<'a>> {
    let straight = Straight::new(compiled);
    let mut functions = straight.functions("an angular frequency in rad/s");
    functions.push(straight.kinks(kinks));
    functions
}
