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

/// Phases nearer to 0 or 180 degrees than this differ from it by the errors of an eigenvector.
const ROUNDED: f64 = 1e-6;

impl Moving {
    pub(crate) fn of(part: &Part) -> Self {
        let phase = part.amplitude.arg().to_degrees();
        Moving {
            point: part.location.clone(),
            axis: part.axis.clone(),
            amplitude: part.amplitude.norm(),
            phase: match phase.abs() {
                size if size < ROUNDED => 0.0,
                size if size > 180.0 - ROUNDED => 180.0,
                _ => phase,
            },
        }
    }
}
