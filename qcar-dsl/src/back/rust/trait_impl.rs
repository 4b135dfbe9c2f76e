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
        "/// This model as the workbench sees it.
#[derive(Clone, Copy, Debug, Default)]
pub struct {name};

impl interface::Model for {name} {{
    fn about(&self) -> &interface::About {{
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
    let arm = |driver: &str, place: usize, suffix: &str| {
        let code = camel(&response_name(about, place, suffix));
        format!(
            "            ({place}, {}) => {driver}::<{code}, _, _, _>(constants, omega, into),\n",
            !suffix.is_empty()
        )
    };
    let arms = |driver: &str| -> String {
        let both = |place| [arm(driver, place, ""), arm(driver, place, "_jacobian")];
        (0..about.responses.len()).flat_map(both).collect()
    };
    format!(
        "
    fn response(&self, excitation: usize, constants: &[f64], omega: &[f64], into: interface::ResponseMut<'_>) {{
        let constants = fixed(constants);
        match (excitation, into.jacobian.is_some()) {{
{each}            _ => no_response(&ABOUT, excitation),
        }}
    }}

    fn line_sets(&self, excitation: usize, constants: &[interface::Lanes], omega: f64, with_jacobian: bool, into: &mut [interface::Lanes]) {{
        let constants = fixed(constants);
        match (excitation, with_jacobian) {{
{sets}            _ => no_response(&ABOUT, excitation),
        }}
    }}
",
        each = arms("respond"),
        sets = arms("respond_sets"),
    )
}

const SETS: &str = "
    fn prepare_sets(&self, p: &[interface::Lanes], constants: &mut [interface::Lanes]) {
        together(&PrepareSets { p: fixed(p) }, constants);
    }

    fn derivative_sets(&self, constants: &[interface::Lanes], x: &[interface::Lanes], u: &[interface::Lanes], dx: &mut [interface::Lanes]) {
        let sets = DerivativeSets { constants: fixed(constants), x: fixed(x), u: fixed(u) };
        together(&sets, dx);
    }

    fn matrices_sets(&self, p: &[interface::Lanes], x: &[interface::Lanes], u: &[interface::Lanes], nonzeros: &mut [interface::Lanes]) {
        together(&MatricesSets { p: fixed(p), x: fixed(x), u: fixed(u) }, nonzeros);
    }

    fn sensitivities_sets(&self, p: &[interface::Lanes], x: &[interface::Lanes], u: &[interface::Lanes], nonzeros: &mut [interface::Lanes]) {
        together(&SensitivitiesSets { p: fixed(p), x: fixed(x), u: fixed(u) }, nonzeros);
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
    fn rolling_derivative(&self, constants: &[f64], x: &[f64], u: &[f64], contact: &interface::Contact, dx: &mut [f64]) {
        straight::rolling_derivative(fixed(constants), fixed(x), fixed(u), contact, fixed_mut(dx));
    }

    fn rolling_outputs(&self, constants: &[f64], x: &[f64], u: &[f64], contact: &interface::Contact, y: &mut [f64]) {
        straight::rolling_outputs(fixed(constants), fixed(x), fixed(u), contact, fixed_mut(y));
    }

    fn contact_force_sets(&self, constants: &[interface::Lanes], x: &[interface::Lanes], s: &interface::Lanes, v: &interface::Lanes) -> interface::Lanes {
        let mut force = [interface::Lanes::default()];
        let sets = ContactForceSets { constants: fixed(constants), x: fixed(x), s, v };
        together(&sets, &mut force);
        force[0]
    }

    fn rolling_derivative_sets(
        &self,
        constants: &[interface::Lanes],
        x: &[interface::Lanes],
        u: &[interface::Lanes],
        contacts: &interface::Contacts,
        dx: &mut [interface::Lanes],
    ) {
        let sets = RollingDerivativeSets { constants: fixed(constants), x: fixed(x), u: fixed(u), contact: contacts };
        together(&sets, dx);
    }
";
