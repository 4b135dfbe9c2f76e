//! The exceptions of the Python package, and their mapping from failures of qcar.

use pyo3::PyErr;
use pyo3::create_exception;
use pyo3::exceptions::PyValueError;

create_exception!(
    qcar,
    Error,
    PyValueError,
    "Input that qcar cannot use. The message states the place, the reason and the remedy."
);
create_exception!(
    qcar,
    ModelError,
    Error,
    "A model that the compiler refuses, or a name or path that is not a model."
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
    "A campaign that cannot be read, or that has no data for its model."
);
create_exception!(qcar, SimulationError, Error, "A ride that cannot be simulated.");

/// The message of a failure without its final line break.
fn words(of: impl ToString) -> String {
    of.to_string().trim_end().to_string()
}

/// The exception for a failure of a model.
pub fn of_model(failure: impl ToString) -> PyErr {
    ModelError::new_err(words(failure))
}

/// The exception for a failure of parameters.
pub fn of_parameters(failure: impl ToString) -> PyErr {
    ParameterError::new_err(words(failure))
}

/// The exception for a failure of a campaign.
pub fn of_campaign(failure: impl ToString) -> PyErr {
    CampaignError::new_err(words(failure))
}

/// The exception for a failure of a ride.
pub fn of_ride(failure: impl ToString) -> PyErr {
    SimulationError::new_err(words(failure))
}

/// The number of the set or ride that fails, as a prefix of the message; empty if there is only one.
pub fn which(what: &str, nth: usize, of: usize) -> String {
    match of {
        1 => String::new(),
        _ => format!("{what} {nth} of {of}, counted from 0: "),
    }
}
