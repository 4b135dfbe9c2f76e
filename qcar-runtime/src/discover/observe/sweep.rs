//! Swept sines: the first harmonics at each frequency.

// The measured series.
mod measured;
// The predicted series of a linear model.
mod linear;
// The predicted series of a nonlinear model.
mod nonlinear;
// The difference between a sweep as driven and its steady harmonics.
mod unsteady;

pub use linear::sweep as linear;
pub use nonlinear::sweep as nonlinear;
pub use unsteady::{replayed, unsteady};

use super::dataset::Evidence;
use super::prediction::PredictError;
use super::sensor::excitation_of;
use crate::model::Model;
use crate::transmissibility::Point;

/// The excitation of the model that a sensor measured in a run.
fn excitation(model: &dyn Model, evidence: &Evidence, run: usize, reference: &Point) -> Result<usize, PredictError> {
    excitation_of(model.about(), reference)
        .ok_or_else(|| PredictError::no_input(model.about(), &evidence.runs[run], &reference.location))
}
