//! Parameter sets: what Python gives by name, made rows with a value for every parameter of the model.

use std::collections::BTreeMap;

use ndarray::{Array2, ArrayView1, ArrayView2};
use pyo3::PyResult;
use qcar::catalogue::Loaded;
use qcar_runtime::response::parameters::Values;

use crate::errors;

/// Rows of values for all parameters of a model, and for each parameter the one that it takes its value from.
pub struct Sets {
    /// A row for each set.
    pub p: Array2<f64>,
    /// Itself, for a parameter that is not tied.
    pub leader: Vec<usize>,
}

/// Gives every parameter its value in every set: the columns of `given` are those of `names`, the others have their defaults.
///
/// # Errors
/// A name that the model does not have, a parameter without any value, a value that is not finite, and masses that are not above
/// zero.
pub fn resolve(model: &Loaded, names: &[String], given: ArrayView2<'_, f64>) -> PyResult<Sets> {
    let about = model.about();
    let row =
        |set: usize| -> BTreeMap<String, f64> { names.iter().cloned().zip(given.row(set).iter().copied()).collect() };
    let resolved = |set: usize| {
        let values = Values::resolve(about, &row(set), &BTreeMap::new());
        values.map_err(|problems| {
            let sentences: Vec<String> = problems.iter().map(ToString::to_string).collect();
            errors::of_parameters(format!(
                "{}{}",
                errors::which("parameter set", set, given.nrows()),
                sentences.join("\n")
            ))
        })
    };
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
        for (&place, &value) in places.iter().zip(own) {
            values.set(place, value);
        }
        into.assign(&ArrayView1::from(values.as_slice()));
        let inertias = model.check_inertias(values.as_slice());
        inertias.map_err(|error| {
            errors::of_parameters(format!("{}{error}", errors::which("parameter set", set, given.nrows())))
        })?;
    }
    let leader = (0..about.parameters.len()).map(|k| values.leader(k)).collect();
    Ok(Sets { p, leader })
}

fn none(parameters: usize) -> Sets {
    Sets {
        p: Array2::zeros((0, parameters)),
        leader: (0..parameters).collect(),
    }
}
