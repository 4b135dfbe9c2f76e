//! Swept sines: harmonics over frequency.

// Measured harmonics.
mod measured;
// Prediction by a linear model.
mod linear;
// Prediction by a nonlinear model, by harmonic balance.
mod nonlinear;
// Non-steady part of a sweep response.
mod unsteady;

pub use linear::sweep as linear;
pub use nonlinear::sweep as nonlinear;
pub use unsteady::{replayed, unsteady};

use super::dataset::Evidence;
use super::prediction::PredictError;
use super::sensor::excitation_of;
use crate::model::Model;
use crate::transmissibility::Point;

/// Position of the excitation of the model that the reference sensor of a run measures.
fn excitation(model: &dyn Model, evidence: &Evidence, run: usize, reference: &Point) -> Result<usize, PredictError> {
    excitation_of(model.about(), reference)
        .ok_or_else(|| PredictError::no_input(model.about(), &evidence.runs[run], &reference.location))
}
