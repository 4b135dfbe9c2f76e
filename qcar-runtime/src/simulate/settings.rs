//! How a simulation is integrated.

use super::failure::SimulateError;
use crate::model::{About, StateKind};
use crate::solver::{self, DormandPrince, Effort, Rk4, System};

/// How exact a simulation is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// How time is stepped.
    pub method: Method,
    /// The most steps that the whole of a simulation may attempt, by whichever method.
    pub most_steps: usize,
}

/// How time is stepped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// By Dormand–Prince 5(4) at this relative tolerance.
    Adaptive(f64),
    /// By RK4 with steps of this length, s.
    Fixed(f64),
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            method: Method::Adaptive(1e-6),
            most_steps: 10_000_000,
        }
    }
}

impl Settings {
    /// Integrates `system` on from `x`; no step is longer than `longest_step` (s).
    ///
    /// # Errors
    /// Where the integration stops before its end.
    pub(super) fn integrate<S: System>(
        &self,
        about: &About,
        system: &mut S,
        span: (f64, f64),
        (longest_step, breaks): (f64, &[f64]),
        x: &mut [f64],
    ) -> Result<Effort, SimulateError> {
        let (most_steps, events) = (self.most_steps, system.events());
        let report = match self.method {
            Method::Adaptive(relative) => {
                let absolute = scales(about).map(|scale| relative * scale).collect();
                let settings = solver::Settings {
                    relative,
                    absolute,
                    longest_step,
                    most_steps,
                };
                DormandPrince::new(settings, events).integrate(system, span, breaks, x)
            }
            Method::Fixed(step) => {
                Rk4::new(step.min(longest_step), most_steps, x.len(), events).integrate(system, span, breaks, x)
            }
        };
        if report.reason.is_success() {
            Ok(report.effort)
        } else {
            Err(SimulateError::Stopped {
                model: about.name.to_string(),
                report,
            })
        }
    }
}

/// The size of each state below which its relative error no longer matters: a centimetre, a tenth of a metre per
/// second, one SI unit of an inner state.
pub(super) fn scales(about: &About) -> impl Iterator<Item = f64> {
    about.states.iter().map(|state| match state.kind {
        StateKind::Position => 0.01,
        StateKind::Velocity => 0.1,
        StateKind::Inner => 1.0,
    })
}
