//! What Python raises, and which failure of qcar becomes which of it.

use pyo3::PyErr;
use pyo3::create_exception;
use pyo3::exceptions::PyValueError;

create_exception!(
    qcar,
    Error,
    PyValueError,
    "What was given to qcar cannot be used. The message says where and why, and what to do about it."
);
create_exception!(
    qcar,
    ModelError,
    Error,
    "A model that the compiler refuses, or a name or path that is no model."
);
create_exception!(
    qcar,
    ParameterError,
    Error,
    "A name that the model does not have, or a value that it cannot take."
);
create_exception!(
    qcar,
    CampaignError,
    Error,
    "A campaign that cannot be read, or that says nothing of its model."
);
create_exception!(qcar, SimulationError, Error, "A ride that cannot be simulated.");

/// A failure in its own words, less the line break that ends them on a terminal.
fn words(of: impl ToString) -> String {
    of.to_string().trim_end().to_string()
}

/// Of a model.
pub fn of_model(failure: impl ToString) -> PyErr {
    ModelError::new_err(words(failure))
}

/// Of its parameters.
pub fn of_parameters(failure: impl ToString) -> PyErr {
    ParameterError::new_err(words(failure))
}

/// Of a campaign.
pub fn of_campaign(failure: impl ToString) -> PyErr {
    CampaignError::new_err(words(failure))
}

/// Of a ride.
pub fn of_ride(failure: impl ToString) -> PyErr {
    SimulationError::new_err(words(failure))
}

/// Which of several an error is about, to stand before its sentence; nothing where there is one.
pub fn which(what: &str, nth: usize, of: usize) -> String {
    match of {
        1 => String::new(),
        _ => format!("{what} {nth} of {of}, counted from 0: "),
    }
}
