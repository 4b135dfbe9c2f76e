//! Errors of simulations.

use crate::road::RoadError;
use crate::roles::RoleError;
use crate::shown::{rounded, shown};
use crate::solver::Report;
use crate::tyre::TyreError;

/// Reason why a simulation failed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[expect(missing_docs, reason = "the message says it")]
pub enum SimulateError {
    #[error("{0}, expected {expected}; {remedy}", expected = .0.expected(), remedy = .0.remedy())]
    Road(#[from] RoadError),
    #[error(transparent)]
    Tyre(#[from] TyreError),
    #[error("{name} is {}; expected a positive number", shown(*.value, .unit))]
    NotPositive {
        name: &'static str,
        value: f64,
        unit: &'static str,
    },
    #[error("{name} has {found} values; expected {expected}")]
    Count {
        name: &'static str,
        found: usize,
        expected: usize,
    },
    #[error(transparent)]
    Role(#[from] RoleError),
    #[error(
        "a sample rate of {rate} Hz is too low at {}: the contact patch is passed in {} s, \
         which takes at least {} Hz to be seen",
        shown(*.speed, "m/s"),
        rounded(*.passage, 4),
        rounded(*.least, 4)
    )]
    TooFewSamples {
        rate: f64,
        speed: f64,
        passage: f64,
        least: f64,
    },
    #[error(
        "the tyre would be deflected by {:.4} under the static load, more than its radius of {}; \
         check k_tire, the static load and deflection, and the masses",
        shown(*.deflection, "m"),
        shown(*.radius, "m")
    )]
    TooSoft { deflection: f64, radius: f64 },
    #[error(
        "the tyre pushes no more when it is pressed further than its static deflection of {:.4}, so nothing \
         stands on it; check k_tire, the static load and deflection",
        shown(*.deflection, "m")
    )]
    Unstable { deflection: f64 },
    #[error(
        "model `{model}` has no static equilibrium on its tyre: with all else balanced, d({state})/dt stays at {rate:.3e}; \
         check k_tire, the static load and deflection, and that every parameter is a number"
    )]
    NoEquilibrium { model: String, state: String, rate: f64 },
    #[error("the simulation of model `{model}` stopped: {report}")]
    Stopped { model: String, report: Report },
    #[error("a record is of excitation {excitation}, counted from 0, but model `{model}` has {count}")]
    NoSuchExcitation {
        model: String,
        excitation: usize,
        count: usize,
    },
    #[error("excitation `{name}` is a force; its record must be a force, of power 0")]
    ForceByMotion { name: String },
    #[error(
        "the motion `{name}` cannot be held between samples, since its velocity would be infinite; \
         declare `band_limited = true`"
    )]
    HeldMotion { name: String },
    #[error("the record of `{name}` has {value} at sample {sample}; expected a finite number")]
    NotFinite { name: String, sample: usize, value: f64 },
}

/// `value`, or an error if it is not positive.
pub(super) fn positive(name: &'static str, value: f64, unit: &'static str) -> Result<f64, SimulateError> {
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err(SimulateError::NotPositive { name, value, unit })
    }
}
