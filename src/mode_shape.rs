//! The shape of a mode in results: the motion of each point, as amplitude and phase.

use qcar_runtime::modes::Part;
use serde::Serialize;

/// Motion of a point in a mode.
#[derive(Serialize)]
pub(crate) struct Moving {
    /// Mass or massless point.
    pub point: String,
    /// Its direction.
    pub axis: String,
    /// Amplitude relative to the largest.
    pub amplitude: f64,
    /// Phase, degrees.
    pub phase: f64,
}

impl Moving {
    pub(crate) fn of(part: &Part) -> Self {
        Moving {
            point: part.location.clone(),
            axis: part.axis.clone(),
            amplitude: part.amplitude.norm(),
            phase: part.amplitude.arg().to_degrees(),
        }
    }
}
