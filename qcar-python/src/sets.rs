//! Parameter sets: converts values by name from Python to rows with a value for every parameter of the model.

use std::collections::BTreeMap;

use ndarray::{Array2, ArrayView1, ArrayView2};
use pyo3::PyResult;
use qcar::catalogue::Loaded;
use qcar_runtime::model::About;
use qcar_runtime::response::parameters::Values;

use crate::errors;

/// Rows of values for all parameters of a model, and for each parameter the one to which it is tied.
pub struct Sets {
    /// A row for each set.
    pub p: Array2<f64>,
    /// The leader of each parameter; the parameter itself if it is not tied.
    pub leader: Vec<usize>,
}

/// Determines the value of every parameter in every set: the columns of `given` are those of `names`, all others have
/// their defaults.
///
/// # Errors
/// Fails for a name that is no parameter of the model, a parameter without a value, a value that is not finite, or a
/// mass that is not positive.
pub fn resolve(model: &Loaded, names: &[String], given: ArrayView2<'_, f64>) -> PyResult<Sets> {
    let about = model.about();
    let refused = |set: usize, why: String| {
        let which = errors::which("parameter set", set, given.nrows());
        errors::of_parameters(which + &why)
    };
    let resolved = |set: usize| by_name(about, names, given.row(set)).map_err(|why| refused(set, why));
    let mut values = match given.nrows() {
        0 => return Ok(none(about.parameters.len())),
        _ => resolved(0)?,
    };
    let place = |name: &String| about.parameters.iter().position(|own| own.name == **name);
    let places: Vec<usize> = names.iter().filter_map(place).collect();
    let mut p = Array2::zeros((given.nrows(), about.parameters.len()));
    for (set, (mut into, own)) in p.rows_mut().into_iter().zip(given.rows()).enumerate() {
        if own.iter().any(|value| !value.is_finite()) {
            resolved(set)?;
        }
        // Tied parameters follow their leader, with the ties of the first set, which was resolved by name.
        places
            .iter()
            .zip(own)
            .for_each(|(&place, &value)| values.set(place, value));
        let inertias = model.check_inertias(values.as_slice());
        inertias.map_err(|error| refused(set, error.to_string()))?;
        into.assign(&ArrayView1::from(values.as_slice()));
    }
    let leader = (0..about.parameters.len()).map(|k| values.leader(k)).collect();
    Ok(Sets { p, leader })
}

/// One set, or all messages on what is wrong with it.
fn by_name(about: &About, names: &[String], given: ArrayView1<'_, f64>) -> Result<Values, String> {
    let given: BTreeMap<String, f64> = names.iter().cloned().zip(given.iter().copied()).collect();
    Values::resolve(about, &given, &BTreeMap::new()).map_err(|problems| {
        let sentences: Vec<String> = problems.iter().map(ToString::to_string).collect();
        sentences.join("\n")
    })
}

fn none(parameters: usize) -> Sets {
    Sets {
        p: Array2::zeros((0, parameters)),
        leader: (0..parameters).collect(),
    }
}
