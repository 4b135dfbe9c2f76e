//! The straight-line functions of a model: which programs, over which arguments, under which doc comments.

use std::collections::BTreeMap;

use crate::about::{About, Source};
use crate::equations::Sheet;
use crate::expr::Symbol;
use crate::notation::Notation;
use crate::program::Program;
use crate::schedule::Compiled;

use super::about::{entry_name, parameter_jacobian_names, sensitivity_names};
use super::function::{FREQUENCIES, Local, Signature, function};
use super::labels::{labels, of_constants};
use super::pieces::Leaf;

/// All straight-line functions.
pub fn functions(compiled: &Compiled) -> Vec<String> {
    let printer = Straight {
        compiled,
        constants: of_constants(compiled),
    };
    let (programs, about) = (&compiled.programs, &compiled.about);
    let rates: Vec<String> = about
        .states
        .iter()
        .map(|state| format!("d/dt {}", state.name))
        .collect();
    let seen: Vec<String> = about.outputs.iter().map(|output| output.name.clone()).collect();
    let entries: Vec<String> = about.matrices.iter().map(|entry| entry_name(about, entry)).collect();
    let mut functions = vec![
        printer.print("prepare", PREPARE, &["p"], printer.constants.clone(), &programs.prepare),
        printer.print(
            "derivative",
            &printer.equations(),
            STATE,
            rates.clone(),
            &programs.derivative,
        ),
        printer.print("outputs", OUTPUTS, STATE, seen.clone(), &programs.outputs),
        printer.print("matrices", MATRICES, POINT, entries, &programs.matrices),
        printer.print(
            "sensitivities",
            SENSITIVITIES,
            POINT,
            sensitivity_names(about),
            &programs.sensitivities,
        ),
        printer.print(
            "parameter_jacobian",
            PARAMETER_JACOBIAN,
            POINT,
            parameter_jacobian_names(about),
            &programs.parameter_jacobian,
        ),
    ];
    for (place, response) in programs.responses.iter().enumerate() {
        functions.push(printer.response(place, "", &response.value));
        functions.push(printer.response(place, "_jacobian", &response.with_jacobian));
    }
    if let Some(rolling) = &programs.rolling {
        let force = vec!["force".to_string()];
        functions.push(printer.print("contact_force", &printer.tyre(), CONTACT, force, &rolling.contact_force));
        functions.push(printer.print("rolling_derivative", ROLLING, ROLLS, rates, &rolling.derivative));
        functions.push(printer.print("rolling_outputs", ROLLING_OUTPUTS, ROLLS, seen, &rolling.outputs));
    }
    functions
}

const STATE: &[&str] = &["constants", "x", "u"];
const POINT: &[&str] = &["p", "x", "u"];
const CONTACT: &[&str] = &["constants", "x", "s", "v"];
const ROLLS: &[&str] = &["constants", "x", "u", "contact"];

const PREPARE: &str = "What depends on the parameters alone, once for a parameter set.";
const OUTPUTS: &str = "The outputs `y = h(x, u)`, see [`derivative`].";
const MATRICES: &str = "The nonzeros of A = ∂f/∂x, B = ∂f/∂u, C = ∂h/∂x and D = ∂h/∂u, see [`derivative`].";
const SENSITIVITIES: &str = "The nonzeros of the parameter Jacobians of A, B, C and D.";
const PARAMETER_JACOBIAN: &str = "The nonzeros of ∂f/∂p and ∂h/∂p.";
const ROLLING: &str =
    "The equations of motion while the tyre rolls over a profile: the forces of `contact` act on the wheel, and
the inner states of the tyre follow its stretch and rate.";
const ROLLING_OUTPUTS: &str = "The outputs while the tyre rolls over a profile.";

/// Prints the programs of one model.
struct Straight<'a> {
    compiled: &'a Compiled,
    /// What a reviewer calls each prepared constant.
    constants: Vec<String>,
}

impl Straight<'_> {
    fn print(
        &self,
        name: &str,
        doc: &str,
        arguments: &[&'static str],
        results: Vec<String>,
        program: &Program,
    ) -> String {
        let lines = arguments.contains(&FREQUENCIES);
        let signature = Signature {
            name: name.into(),
            doc: doc.lines().map(String::from).collect(),
            arguments: arguments
                .iter()
                .map(|&argument| (argument, self.kind(argument)))
                .collect(),
            results,
            leaf: &|leaf| self.local(leaf, arguments),
            // A response is complex throughout: beside its leaves nothing in it has a name.
            labels: if lines {
                BTreeMap::new()
            } else {
                labels(self.compiled, program)
            },
            lines,
        };
        function(&signature, program)
    }

    fn kind(&self, argument: &str) -> String {
        match argument {
            "p" => "&[f64; PARAMETERS]".into(),
            "constants" => "&[f64; CONSTANTS]".into(),
            "x" => "&[f64; STATES]".into(),
            "u" => "&[f64; INPUTS]".into(),
            "contact" => "&seam::Contact".into(),
            FREQUENCIES => "&[f64; LINES]".into(),
            _ => "f64".into(),
        }
    }

    /// Where a leaf is read.
    fn local(&self, leaf: Leaf, arguments: &[&'static str]) -> Local {
        let at = |argument, place: usize, name: &str| Local {
            argument,
            place: format!("[{place}]"),
            name: name.into(),
        };
        let symbol = match leaf {
            Leaf::Prepared(place) => return at("constants", place as usize, &self.constants[place as usize]),
            Leaf::Symbol(symbol) => symbol,
        };
        let about = &self.compiled.about;
        if let Some(place) = about.states.iter().position(|state| state.symbol == symbol) {
            return at("x", place, &about.states[place].name);
        }
        if let Some(place) = about.inputs.iter().position(|input| input.symbol == symbol) {
            return at("u", place, &about.inputs[place].name);
        }
        let whole = |argument, name: &str| Local {
            argument,
            place: String::new(),
            name: name.into(),
        };
        let of_contact = |place: &str, name: &str| Local {
            argument: "contact",
            place: place.into(),
            name: name.into(),
        };
        let rolls = arguments.contains(&"contact");
        match symbol {
            Symbol::Parameter(place) => at("p", place as usize, &about.parameters[place as usize].name),
            Symbol::Frequency => Local {
                argument: FREQUENCIES,
                place: "[line]".into(),
                name: "omega".into(),
            },
            Symbol::Stretch(_) if rolls => of_contact(".s", "s_contact"),
            Symbol::Rate(_) if rolls => of_contact(".v", "v_contact"),
            Symbol::ContactForce(axis) => of_contact(&format!(".force[{axis}]"), &format!("f_contact_{axis}")),
            Symbol::Stretch(_) => whole("s", "s_contact"),
            Symbol::Rate(_) => whole("v", "v_contact"),
            other => unreachable!("a program reads parameters, states, inputs and a contact, not {other:?}"),
        }
    }

    /// The response to an excitation, alone or with its parameter Jacobian.
    fn response(&self, place: usize, suffix: &str, program: &Program) -> String {
        let about = &self.compiled.about;
        let excitation = &about.excitations[place];
        let layout = &about.responses[place];
        let output = |place: u16| &about.outputs[place as usize].name;
        let responds = layout.outputs.iter().map(|&place| output(place).clone());
        let mut rows: Vec<String> = complex(responds).collect();
        if !suffix.is_empty() {
            let derivative = |&(row, parameter): &(u16, u16)| {
                let row = output(layout.outputs[row as usize]);
                format!("∂{row}/∂{}", about.parameters[parameter as usize].name)
            };
            rows.extend(complex(layout.jacobian.iter().map(derivative)));
        }
        let doc = format!(
            "The response per {} of `{}` at a block of lines{}: `Z(ω) = K + jωC - ω²M`, eliminated without fill.\n
Real parts of all rows, then imaginary parts{}.",
            if matches!(excitation.source, Source::Force(_)) {
                "N"
            } else {
                "m"
            },
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
        self.print(
            &response_name(about, place, suffix),
            &doc,
            &["constants", FREQUENCIES],
            rows,
            program,
        )
    }

    /// The equations and the lines of the model that say so.
    fn equations(&self) -> String {
        let mut text = String::from("The equations of motion `dx = f(x, u)`.\n\n```text\n");
        let sheet = Sheet::new(&self.compiled.model, Notation::Text);
        let motion = sheet.motion.iter().flat_map(|(_, equations)| equations);
        for equation in motion.chain(&sheet.inner).chain(&sheet.names) {
            text += &format!("{} = {}\n", equation.left, equation.right.join(" "));
        }
        text += "```\n\nAs the model says it:\n\n```text\n";
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
