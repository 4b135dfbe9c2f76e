//! Accuracy of a simulation: the method of integration, its tolerance and its limit of steps.

use super::failure::SimulateError;
use crate::model::{About, StateKind};
use crate::solver::{self, DormandPrince, Effort, Report, Rk4, System};

/// Accuracy of a simulation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Method of time integration.
    pub method: Method,
    /// Largest number of steps that a simulation may attempt.
    pub most_steps: usize,
}

/// A method of time integration.
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
    /// The integrator of a system with this number of events; no step is longer than `longest_step` (s).
    pub(super) fn integrator(&self, about: &About, longest_step: f64, events: usize) -> Integrator {
        let most_steps = self.most_steps;
        match self.method {
            Method::Adaptive(relative) => {
                let absolute = scales(about).map(|scale| relative * scale).collect();
                let settings = solver::Settings {
                    relative,
                    absolute,
                    longest_step,
                    most_steps,
                };
                Integrator::Adaptive(DormandPrince::new(settings, events))
            }
            Method::Fixed(step) => {
                let states = about.states.len();
                Integrator::Fixed(Rk4::new(step.min(longest_step), most_steps, states, events))
            }
        }
    }
}

/// An integrator by either method.
pub(super) enum Integrator {
    Adaptive(DormandPrince),
    Fixed(Rk4),
}

impl Integrator {
    /// Begins an integration, or resumes one after the system has advanced by its own method, with its effort `spent`.
    pub fn go_on<S: System>(
        &mut self,
        system: &mut S,
        spent: Option<Effort>,
        (span, breaks): ((f64, f64), &[f64]),
        x: &mut [f64],
    ) -> Report {
        match (self, spent) {
            (Self::Adaptive(by), None) => by.integrate(system, span, breaks, x),
            (Self::Adaptive(by), Some(effort)) => by.resume(system, effort, span, breaks, x),
            (Self::Fixed(by), _) => by.integrate(system, span, breaks, x),
        }
    }
}

/// The effort of an integration.
///
/// # Errors
/// If it stopped before its end.
pub(super) fn judged(about: &About, report: Report) -> Result<Effort, SimulateError> {
    if report.reason.is_success() {
        Ok(report.effort)
    } else {
        let model = about.name.to_string();
        Err(SimulateError::Stopped { model, report })
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
