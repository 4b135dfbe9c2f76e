//! The extension module of the Python package `qcar`: arrays in, arrays out. Names, docstrings and shapes that a user
//! sees are in `python/qcar`.

// Exceptions.
mod errors;
// The description of a model.
mod described;
// Parameter sets by name.
mod sets;
// Matrices and their derivatives.
mod dense;
// Frequency responses.
mod responses;
// Ratios of responses.
mod ratios;
// Long work, which a signal stops.
mod long;
// Rides.
mod rides;
// Verbs on campaigns.
mod verbs;
// The model class.
mod model;

use pyo3::prelude::*;

/// The extension module behind `qcar`, not for direct use.
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
