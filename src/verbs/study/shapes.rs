//! Modes of the fitted model and of the extended model.

use qcar_runtime::modes::{Mode, Part, modes};
use serde::Serialize;

use super::gather::Study;
use crate::mode_shape::Moving;
use crate::report::rounded::rounded;

/// Modes before and after.
#[derive(Serialize)]
pub struct Shapes {
    before: Vec<Shape>,
    after: Option<Vec<Shape>>,
}

/// A mode.
#[derive(Serialize)]
pub struct Shape {
    /// Natural frequency, Hz.
    pub frequency: f64,
    /// Damping ratio.
    pub damping: f64,
    parts: Vec<Moving>,
}

/// The modes of both models.
pub fn shapes(of: &Study) -> Shapes {
    let all = |modes: Vec<Mode>| modes.iter().map(shape).collect();
    Shapes {
        before: all(modes(&*of.fitted.model, &of.fitted.values())),
        after: of.after.as_ref().map(|after| all(modes(&*after.model, &after.values))),
    }
}

/// A mode for the report.
pub fn shape(of: &Mode) -> Shape {
    let moving = |part: &Part| {
        let own = Moving::of(part);
        Moving {
            amplitude: rounded(own.amplitude),
            phase: rounded(own.phase),
            ..own
        }
    };
    Shape {
        frequency: rounded(of.frequency),
        damping: rounded(of.damping),
        parts: of.shape.iter().map(moving).collect(),
    }
}
