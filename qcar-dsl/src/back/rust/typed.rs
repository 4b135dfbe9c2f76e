//! The public interface of a generated model: fixed sizes and nalgebra's types.

use qcar_model::{About, Matrix};

use crate::program::schedule::Compiled;

/// Sizes, and the positions of states, inputs and outputs.
pub fn sizes(about: &About) -> String {
    let size =
        |name: &str, what: &str, size: usize| format!("/// Number of {what}.\npub const {name}: usize = {size};\n");
    [
        size("PARAMETERS", "parameters", about.parameters.len()),
        size("STATES", "states", about.states.len()),
        size("INPUTS", "inputs", about.inputs.len()),
        size("OUTPUTS", "outputs", about.outputs.len()),
        size("CONSTANTS", "constants of a parameter set", about.constants),
        places("state", "x", about.states.iter().map(|own| (&*own.name, &*own.unit))),
        places("input", "u", about.inputs.iter().map(|own| (&*own.name, &*own.unit))),
        places("output", "y", about.outputs.iter().map(|own| (&*own.name, &*own.unit))),
    ]
    .concat()
}

fn places<'a>(what: &str, vector: &str, names: impl Iterator<Item = (&'a str, &'a str)>) -> String {
    let constant = |(place, (name, unit)): (usize, (&str, &str))| {
        let constant = name.replace('.', "_").to_uppercase();
        format!("    /// `{name}`, {unit}.\n    pub const {constant}: usize = {place};\n")
    };
    let constants: String = names.enumerate().map(constant).collect();
    format!("\n/// Positions in `{vector}`.\npub mod {what} {{\n{constants}}}\n")
}

/// The functions over nalgebra's types.
pub fn functions(compiled: &Compiled) -> String {
    MOTION.to_string() + &matrices(&compiled.about)
}

/// The functions of a prepared parameter set, which are the same for every model.
const MOTION: &str = "\
/// The constants of a parameter set: values that depend on the parameters alone, computed once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prepared(pub [f64; CONSTANTS]);

impl Prepared {
    /// Computes the constants of a parameter set.
    pub fn new(p: &Parameters) -> Prepared {
        let mut constants = [0.0; CONSTANTS];
        straight::prepare(&p.to_array(), &mut constants);
        Prepared(constants)
    }
}

/// The equations of motion `dx = f(x, u)`, see [`straight::derivative`].
pub fn derivative(
    prepared: &Prepared,
    x: &SVector<f64, STATES>,
    u: &SVector<f64, INPUTS>,
) -> SVector<f64, STATES> {
    let mut dx = SVector::zeros();
    straight::derivative(&prepared.0, &x.data.0[0], &u.data.0[0], &mut dx.data.0[0]);
    dx
}

/// The outputs `y = h(x, u)`.
pub fn outputs(
    prepared: &Prepared,
    x: &SVector<f64, STATES>,
    u: &SVector<f64, INPUTS>,
) -> SVector<f64, OUTPUTS> {
    let mut y = SVector::zeros();
    straight::outputs(&prepared.0, &x.data.0[0], &u.data.0[0], &mut y.data.0[0]);
    y
}

";

/// The functions of the matrices and their derivatives; of a nonlinear model they take a state and an input.
fn matrices(about: &About) -> String {
    let (point, zero, at) = match about.linear {
        true => ("", "&[0.0; STATES], &[0.0; INPUTS]", ""),
        false => (
            ", x: &SVector<f64, STATES>, u: &SVector<f64, INPUTS>",
            "&x.data.0[0], &u.data.0[0]",
            " at a state and an input",
        ),
    };
    format!(
        "/// A = ∂f/∂x, B = ∂f/∂u, C = ∂h/∂x and D = ∂h/∂u{at}.
pub fn state_space(p: &Parameters{point}) -> StateSpace<STATES, INPUTS, OUTPUTS> {{
    let mut nonzeros = [0.0; {matrices}];
    straight::matrices(&p.to_array(), {zero}, &mut nonzeros);
    let mut system = StateSpace::zeros();
{scatter}    system
}}

/// The nonzeros of the parameter Jacobians of A, B, C and D{at}, in the order of [`SENSITIVITIES`].
pub fn sensitivities(p: &Parameters{point}) -> [f64; {sensitivities}] {{
    let mut nonzeros = [0.0; {sensitivities}];
    straight::sensitivities(&p.to_array(), {zero}, &mut nonzeros);
    nonzeros
}}

/// The derivatives of A, B, C and D by each parameter{at}, dense: `jacobians(…).a[\"NAME\"]` is ∂A/∂NAME.
pub fn jacobians(p: &Parameters{point}) -> Jacobians<STATES, INPUTS, OUTPUTS> {{
    Jacobians::new(&Parameters::NAMES, &SENSITIVITIES, &sensitivities({given}))
}}
",
        given = if about.linear { "p" } else { "p, x, u" },
        matrices = about.matrices.len(),
        scatter = scatter(about),
        sensitivities = about.sensitivities.len(),
    )
}

/// The statements that put the nonzeros into their matrices, which are stored column by column.
fn scatter(about: &About) -> String {
    let statement = |(place, entry): (usize, &qcar_model::Entry)| {
        let matrix = match entry.matrix {
            Matrix::A => "a",
            Matrix::B => "b",
            Matrix::C => "c",
            Matrix::D => "d",
        };
        format!(
            "    system.{matrix}.data.0[{}][{}] = nonzeros[{place}];\n",
            entry.column, entry.row
        )
    };
    about.matrices.iter().enumerate().map(statement).collect()
}
