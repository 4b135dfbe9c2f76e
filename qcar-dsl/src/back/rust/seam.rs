//! `impl Model`: the generated functions as the runtime's trait.

use qcar_model::About;

use crate::back::straight::response_name;
use crate::program::schedule::Compiled;

use super::names::camel;

/// The model's type and its implementation of the trait.
pub fn implementation(compiled: &Compiled) -> String {
    let about = &compiled.about;
    let name = camel(&about.name);
    format!(
        "/// This model behind the seam of the workbench.
#[derive(Clone, Copy, Debug, Default)]
pub struct {name};

impl seam::Model for {name} {{
    fn about(&self) -> &seam::About {{
        &ABOUT
    }}

    fn prepare(&self, p: &[f64], constants: &mut [f64]) {{
        straight::prepare(fixed(p), fixed_mut(constants));
    }}

    fn derivative(&self, constants: &[f64], x: &[f64], u: &[f64], dx: &mut [f64]) {{
        straight::derivative(fixed(constants), fixed(x), fixed(u), fixed_mut(dx));
    }}

    fn outputs(&self, constants: &[f64], x: &[f64], u: &[f64], y: &mut [f64]) {{
        straight::outputs(fixed(constants), fixed(x), fixed(u), fixed_mut(y));
    }}

    fn matrices(&self, p: &[f64], x: &[f64], u: &[f64], nonzeros: &mut [f64]) {{
        straight::matrices(fixed(p), {point}, fixed_mut(nonzeros));
    }}

    fn sensitivities(&self, p: &[f64], x: &[f64], u: &[f64], nonzeros: &mut [f64]) {{
        straight::sensitivities(fixed(p), {point}, fixed_mut(nonzeros));
    }}

    fn parameter_jacobian(&self, p: &[f64], x: &[f64], u: &[f64], nonzeros: &mut [f64]) {{
        straight::parameter_jacobian(fixed(p), fixed(x), fixed(u), fixed_mut(nonzeros));
    }}
{SETS}{response}{rolling}}}
",
        point = "fixed(x), fixed(u)",
        response = response(about),
        rolling = if about.contact.is_some() { ROLLING } else { "" },
    )
}

/// The frequency responses, one arm for each excitation with and without its Jacobian.
fn response(about: &About) -> String {
    if about.responses.is_empty() {
        return String::new();
    }
    let arm = |place: usize, suffix: &str| {
        let block = camel(&response_name(about, place, suffix));
        format!(
            "            ({place}, {}) => respond(omega, into, &{block}(constants)),\n",
            !suffix.is_empty()
        )
    };
    let arms: String = (0..about.responses.len())
        .flat_map(|place| [arm(place, ""), arm(place, "_jacobian")])
        .collect();
    format!(
        "
    fn response(&self, excitation: usize, constants: &[f64], omega: &[f64], into: seam::ResponseMut<'_>) {{
        let constants = fixed(constants);
        match (excitation, into.jacobian.is_some()) {{
{arms}            _ => no_response(&ABOUT, excitation),
        }}
    }}
"
    )
}

/// The straight-line functions of the responses as types, which the runtime compiles once for each instruction set.
pub fn blocks(about: &About) -> String {
    let block = |place: usize, suffix: &str| {
        let (function, layout) = (response_name(about, place, suffix), &about.responses[place]);
        let jacobian = if suffix.is_empty() { 0 } else { layout.jacobian.len() };
        let (name, rows) = (camel(&function), 2 * (layout.outputs.len() + jacobian));
        format!(
            "
struct {name}<'a>(&'a [f64; CONSTANTS]);

impl Block<{rows}> for {name}<'_> {{
    #[inline(always)]
    fn compute(&self, frequencies: &[f64; LINES], rows: &mut [[f64; LINES]; {rows}]) {{
        straight::{function}(self.0, frequencies, rows);
    }}
}}
"
        )
    };
    (0..about.responses.len())
        .flat_map(|place| [block(place, ""), block(place, "_jacobian")])
        .collect()
}

const PARAMETERS: &str = "[seam::Lanes; PARAMETERS]";
const CONSTANTS: &str = "[seam::Lanes; CONSTANTS]";
const STATES: &str = "[seam::Lanes; STATES]";
const INPUTS: &str = "[seam::Lanes; INPUTS]";

/// The functions of several parameter sets; the runtime compiles each of them once for each instruction set.
pub fn sets(about: &About) -> String {
    let of_model: [(&str, &[&str], usize); 4] = [
        ("prepare", &[PARAMETERS], about.constants),
        ("derivative", &[CONSTANTS, STATES, INPUTS], about.states.len()),
        ("matrices", &[PARAMETERS, STATES, INPUTS], about.matrices.len()),
        (
            "sensitivities",
            &[PARAMETERS, STATES, INPUTS],
            about.sensitivities.len(),
        ),
    ];
    let of_contact: [(&str, &[&str], usize); 2] = [
        ("contact_force", &[CONSTANTS, STATES, "seam::Lanes", "seam::Lanes"], 1),
        (
            "rolling_derivative",
            &[CONSTANTS, STATES, INPUTS, "seam::Contacts"],
            about.states.len(),
        ),
    ];
    let rolls = about.contact.is_some();
    let functions = of_model.iter().chain(of_contact.iter().filter(|_| rolls));
    let written = functions.map(|(function, types, rows)| {
        let fields: Vec<String> = types.iter().map(|own| format!("&'a {own}")).collect();
        let arguments: Vec<String> = (0..types.len()).map(|place| format!("self.{place}")).collect();
        format!(
            "
struct {name}<'a>({fields});

impl Sets<{rows}> for {name}<'_> {{
    #[inline(always)]
    fn compute(&self, rows: &mut [seam::Lanes; {rows}]) {{
        straight::{function}_sets({arguments}, rows);
    }}
}}
",
            name = camel(&format!("{function}_sets")),
            fields = fields.join(", "),
            arguments = arguments.join(", "),
        )
    });
    written.collect()
}

const SETS: &str = "
    fn prepare_sets(&self, p: &[seam::Lanes], constants: &mut [seam::Lanes]) {
        together(&PrepareSets(fixed(p)), constants);
    }

    fn derivative_sets(&self, constants: &[seam::Lanes], x: &[seam::Lanes], u: &[seam::Lanes], dx: &mut [seam::Lanes]) {
        together(&DerivativeSets(fixed(constants), fixed(x), fixed(u)), dx);
    }

    fn matrices_sets(&self, p: &[seam::Lanes], x: &[seam::Lanes], u: &[seam::Lanes], nonzeros: &mut [seam::Lanes]) {
        together(&MatricesSets(fixed(p), fixed(x), fixed(u)), nonzeros);
    }

    fn sensitivities_sets(&self, p: &[seam::Lanes], x: &[seam::Lanes], u: &[seam::Lanes], nonzeros: &mut [seam::Lanes]) {
        together(&SensitivitiesSets(fixed(p), fixed(x), fixed(u)), nonzeros);
    }
";

const ROLLING: &str = "
    #[inline]
    fn contact_force(&self, constants: &[f64], x: &[f64], s: f64, v: f64) -> f64 {
        let mut force = [0.0];
        straight::contact_force(fixed(constants), fixed(x), s, v, &mut force);
        force[0]
    }

    #[inline]
    fn rolling_derivative(&self, constants: &[f64], x: &[f64], u: &[f64], contact: &seam::Contact, dx: &mut [f64]) {
        straight::rolling_derivative(fixed(constants), fixed(x), fixed(u), contact, fixed_mut(dx));
    }

    fn rolling_outputs(&self, constants: &[f64], x: &[f64], u: &[f64], contact: &seam::Contact, y: &mut [f64]) {
        straight::rolling_outputs(fixed(constants), fixed(x), fixed(u), contact, fixed_mut(y));
    }

    fn contact_force_sets(&self, constants: &[seam::Lanes], x: &[seam::Lanes], s: &seam::Lanes, v: &seam::Lanes) -> seam::Lanes {
        let mut force = [[0.0; LINES]];
        together(&ContactForceSets(fixed(constants), fixed(x), s, v), &mut force);
        force[0]
    }

    fn rolling_derivative_sets(
        &self,
        constants: &[seam::Lanes],
        x: &[seam::Lanes],
        u: &[seam::Lanes],
        contacts: &seam::Contacts,
        dx: &mut [seam::Lanes],
    ) {
        together(&RollingDerivativeSets(fixed(constants), fixed(x), fixed(u), contacts), dx);
    }
";
