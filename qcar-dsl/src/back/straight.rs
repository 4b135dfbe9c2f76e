//! The straight-line functions of a model, independent of the language: their programs, their arguments, and names for
//! the values that they read, compute and return.

// Names of the results.
mod results;
// Names of the values.
mod labels;
// A long program in pieces.
mod pieces;
// Names of the local variables.
mod locals;
// An operation as text.
mod language;
// Kinks of laws.
mod kinks;

use std::collections::BTreeMap;
use std::fmt;

use qcar_model::About;

use crate::back::equations::Sheet;
use crate::back::notation::Notation;
use crate::expr::Symbol;
use crate::program::schedule::Compiled;
use crate::program::{Program, Value};

pub use kinks::kinks;
pub use language::{Language, Operator, ProgramText, usual_name};
pub use locals::{Locals, Names};
pub use pieces::{Leaf, Pieces, computed};
pub use results::{entry_name, parameter_jacobian_names, sensitivity_names};

use labels::{labels, of_constants};

/// A function to be printed in some language.
pub struct Function<'a> {
    /// Its name.
    pub name: String,
    /// Its results, and the equations or lines of the model behind them; several lines.
    pub doc: String,
    /// The names of the arguments that it may read.
    pub arguments: &'static [&'static str],
    /// A name for each result, for a comment.
    pub results: Vec<String>,
    /// The program that it runs.
    pub program: &'a Program,
    /// Names of the values of the program that have a name in the model.
    pub labels: BTreeMap<Value, String>,
}

impl Function<'_> {
    /// True for a frequency response.
    pub fn is_response(&self) -> bool {
        self.arguments.contains(&FREQUENCIES)
    }
}

/// A leaf as a function reads it.
pub struct Local {
    /// The argument, `p`.
    pub argument: &'static str,
    /// The part of the argument.
    pub at: At,
    /// Its name in the model, `k_tire`.
    pub name: String,
}

/// The part of an argument that is read.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum At {
    /// The whole argument.
    Whole,
    /// An entry, counted from 0.
    Entry(usize),
    /// A member of a struct, or an entry of one.
    Member(&'static str),
}

impl fmt::Display for At {
    /// In the syntax of Rust and C, after the argument.
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            At::Whole => Ok(()),
            At::Entry(entry) => write!(out, "[{entry}]"),
            At::Member(member) => write!(out, ".{member}"),
        }
    }
}

/// The argument of a frequency response.
pub const FREQUENCIES: &str = "frequencies";

/// The functions of one model.
pub struct Straight<'a> {
    compiled: &'a Compiled,
    /// The name of each prepared constant.
    constants: Vec<String>,
}

const STATE: &[&str] = &["constants", "x", "u"];
const POINT: &[&str] = &["p", "x", "u"];
const CONTACT: &[&str] = &["constants", "x", "s", "v"];
const ROLLS: &[&str] = &["constants", "x", "u", "contact"];
const RESPONDS: &[&str] = &["constants", FREQUENCIES];

const PREPARE: &str = "The constants of a parameter set: values that depend on the parameters alone.";
const OUTPUTS: &str = "The outputs `y = h(x, u)`, see [`derivative`].";
const MATRICES: &str = "The nonzeros of A = ∂f/∂x, B = ∂f/∂u, C = ∂h/∂x and D = ∂h/∂u, see [`derivative`].";
const SENSITIVITIES: &str = "The nonzeros of the parameter Jacobians of A, B, C and D.";
const PARAMETER_JACOBIAN: &str = "The nonzeros of ∂f/∂p and ∂h/∂p.";
const ROLLING: &str =
    "The equations of motion while the tyre rolls over a profile: the forces of `contact` act on the wheel, and
the inner states of the tyre follow its stretch and rate.";
const ROLLING_OUTPUTS: &str = "The outputs while the tyre rolls over a profile.";
const KINKS: &str = "What changes its sign where a law of the equations of motion bends or jumps.";

impl<'a> Straight<'a> {
    /// Names the values that the programs of a model read.
    pub fn new(compiled: &'a Compiled) -> Self {
        let constants = of_constants(compiled);
        Straight { compiled, constants }
    }

    /// All functions. `at` describes the argument of a frequency response, which depends on the language.
    pub fn functions(&self, at: &str) -> Vec<Function<'a>> {
        let (programs, about) = (&self.compiled.programs, &self.compiled.about);
        let rates: Vec<String> = about
            .states
            .iter()
            .map(|state| format!("d/dt {}", state.name))
            .collect();
        let seen: Vec<String> = about.outputs.iter().map(|output| output.name.to_string()).collect();
        let motion = self.equations();
        let mut functions = vec![
            self.function("prepare", PREPARE, &["p"], self.constants.clone(), &programs.prepare),
            self.function("derivative", &motion, STATE, rates.clone(), &programs.derivative),
            self.function("outputs", OUTPUTS, STATE, seen.clone(), &programs.outputs),
            self.matrices(),
            self.function(
                "sensitivities",
                SENSITIVITIES,
                POINT,
                sensitivity_names(about),
                &programs.sensitivities,
            ),
            self.function(
                "parameter_jacobian",
                PARAMETER_JACOBIAN,
                POINT,
                parameter_jacobian_names(about),
                &programs.parameter_jacobian,
            ),
        ];
        for (place, response) in programs.responses.iter().enumerate() {
            functions.push(self.response(place, "", &response.value, at));
            functions.push(self.response(place, "_jacobian", &response.with_jacobian, at));
        }
        if let Some(rolling) = &programs.rolling {
            let force = vec!["force".to_string()];
            functions.push(self.function("contact_force", &self.tyre(), CONTACT, force, &rolling.contact_force));
            functions.push(self.function("rolling_derivative", ROLLING, ROLLS, rates, &rolling.derivative));
            functions.push(self.function("rolling_outputs", ROLLING_OUTPUTS, ROLLS, seen, &rolling.outputs));
        }
        functions
    }

    /// The nonzeros of A, B, C and D.
    pub fn matrices(&self) -> Function<'a> {
        let about = &self.compiled.about;
        let entries = about.matrices.iter().map(|entry| entry_name(about, entry)).collect();
        self.function("matrices", MATRICES, POINT, entries, &self.compiled.programs.matrices)
    }

    /// The function of the program that [`kinks`] gives for the equations of motion.
    pub fn kinks<'p>(&self, program: &'p Program) -> Function<'p> {
        let nameless = vec![String::new(); program.outputs.len()];
        self.function("kinks", KINKS, STATE, nameless, program)
    }

    /// Names of the values of a program.
    pub fn labels(&self, program: &Program) -> BTreeMap<Value, String> {
        labels(self.compiled, program)
    }

    fn function<'p>(
        &self,
        name: &str,
        doc: &str,
        arguments: &'static [&'static str],
        results: Vec<String>,
        program: &'p Program,
    ) -> Function<'p> {
        Function {
            name: name.into(),
            doc: doc.into(),
            arguments,
            results,
            program,
            labels: self.labels(program),
        }
    }

    /// The argument, and the part of it, from which a leaf is read.
    pub fn local(&self, leaf: Leaf, arguments: &[&str]) -> Local {
        let local = |argument, at, name: &str| Local {
            argument,
            at,
            name: name.into(),
        };
        let entry = |argument, place: usize, name: &str| local(argument, At::Entry(place), name);
        let symbol = match leaf {
            Leaf::Prepared(place) => return entry("constants", place as usize, &self.constants[place as usize]),
            Leaf::Symbol(symbol) => symbol,
        };
        let about = &self.compiled.about;
        if let Some(place) = self.compiled.vectors.state(symbol) {
            return entry("x", place, &about.states[place].name);
        }
        if let Some(place) = self.compiled.vectors.input(symbol) {
            return entry("u", place, &about.inputs[place].name);
        }
        let rolls = arguments.contains(&"contact");
        match symbol {
            Symbol::Parameter(place) => entry("p", place as usize, &about.parameters[place as usize].name),
            Symbol::Frequency => local(FREQUENCIES, At::Whole, "omega"),
            Symbol::Stretch(_) if rolls => local("contact", At::Member("s"), "s_contact"),
            Symbol::Rate(_) if rolls => local("contact", At::Member("v"), "v_contact"),
            Symbol::ContactForce(0) => local("contact", At::Member("force[0]"), "f_contact_0"),
            Symbol::ContactForce(_) => local("contact", At::Member("force[1]"), "f_contact_1"),
            Symbol::Stretch(_) => local("s", At::Whole, "s_contact"),
            Symbol::Rate(_) => local("v", At::Whole, "v_contact"),
            other => unreachable!("a program reads parameters, states, inputs and a contact, not {other:?}"),
        }
    }

    /// The response to an excitation, alone or with its parameter Jacobian.
    fn response<'p>(&self, place: usize, suffix: &str, program: &'p Program, at: &str) -> Function<'p> {
        let about = &self.compiled.about;
        let excitation = &about.excitations[place];
        let layout = &about.responses[place];
        let output = |place: u16| &about.outputs[place as usize].name;
        let responds = layout.outputs.iter().map(|&place| output(place).to_string());
        let mut rows: Vec<String> = complex(responds).collect();
        if !suffix.is_empty() {
            let derivative = |&(row, parameter): &(u16, u16)| {
                let row = output(layout.outputs[row as usize]);
                format!("∂{row}/∂{}", about.parameters[parameter as usize].name)
            };
            rows.extend(complex(layout.jacobian.iter().map(derivative)));
        }
        let doc = format!(
            "The response per {} of `{}` at {at}{}: `Z(ω) = K + jωC - ω²M`, eliminated without fill.\n
Real parts of all rows, then imaginary parts{}.",
            if excitation.force { "N" } else { "m" },
            excitation.name,
            if suffix.is_empty() {
                ""
            } else {
                ", and its parameter Jacobian"
            },
            if suffix.is_empty() {
                ""
            } else {
                "; the same of the Jacobian"
            },
        );
        // All values of a response are parts of complex numbers, so only its leaves have names.
        let labels = BTreeMap::new();
        let name = response_name(about, place, suffix);
        Function {
            name,
            doc,
            arguments: RESPONDS,
            results: rows,
            program,
            labels,
        }
    }

    /// The equations, and the lines of the model behind them.
    fn equations(&self) -> String {
        let mut text = String::from("The equations of motion `dx = f(x, u)`.\n\n```text\n");
        let sheet = Sheet::new(&self.compiled.model, Notation::Text);
        let motion = sheet.motion.iter().flat_map(|(_, equations)| equations);
        for equation in motion.chain(&sheet.inner).chain(&sheet.names) {
            text += &format!("{} = {}\n", equation.left, equation.right.join(" "));
        }
        text += "```\n\nIn the model file:\n\n```text\n";
        let coordinates = self
            .compiled
            .model
            .coordinates
            .iter()
            .map(|coordinate| &coordinate.declared);
        let links = self.compiled.model.links.iter().map(|link| &link.declared);
        for declared in coordinates.chain(links) {
            text += &format!("{}\n", declared.line);
        }
        text + "```"
    }

    /// The tyre's law.
    fn tyre(&self) -> String {
        let about = &self.compiled.about;
        let link = about
            .contact
            .as_ref()
            .map(|contact| &self.compiled.model.links[contact.link as usize]);
        let line = link.map(|link| link.declared.line.as_str()).unwrap_or_default();
        format!("The resisting force of the tyre while it rolls.\n\n```text\n{line}\n```")
    }
}

/// The name of the function of a response.
pub fn response_name(about: &About, place: usize, suffix: &str) -> String {
    format!(
        "response_{}_{}{suffix}",
        about.excitations[place].axis, about.excitations[place].name
    )
}

/// Real parts, then imaginary parts.
fn complex(names: impl Iterator<Item = String> + Clone) -> impl Iterator<Item = String> {
    let imaginary = names.clone().map(|name| format!("im {name}"));
    names.map(|name| format!("re {name}")).chain(imaginary)
}
