//! The extension module of the Python package `qcar`: arrays in, arrays out. Names, docstrings and shapes that a user sees are in
//! `python/qcar`.

// What Python raises.
mod errors;
// What a model has.
mod described;
// Parameter sets by name.
mod sets;
// Matrices and their derivatives,
mod dense;
// responses,
mod responses;
// and ratios of them.
mod ratios;
// Work that a signal stops:
mod long;
// rides,
mod rides;
// and what is done with campaigns.
mod verbs;
// A model with all that is its own.
mod model;

use pyo3::prelude::*;

/// What `qcar` is made of; not for users.
#[pymodule]
fn _native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    let py = module.py();
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("Error", py.get_type::<errors::Error>())?;
    module.add("ModelError", py.get_type::<errors::ModelError>())?;
    module.add("ParameterError", py.get_type::<errors::ParameterError>())?;
    module.add("CampaignError", py.get_type::<errors::CampaignError>())?;
    module.add("SimulationError", py.get_type::<errors::SimulationError>())?;
    module.add_function(wrap_pyfunction!(verbs::models, module)?)?;
    module.add_function(wrap_pyfunction!(verbs::fit_campaign, module)?)?;
    module.add_function(wrap_pyfunction!(verbs::simulate_campaign, module)?)?;
    module.add_function(wrap_pyfunction!(verbs::discover_in_campaign, module)?)?;
    module.add_function(wrap_pyfunction!(verbs::read_values, module)?)?;
    module.add_class::<model::Model>()
}
