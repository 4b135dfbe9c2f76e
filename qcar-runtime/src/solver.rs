//! Time integration of `dx/dt = f(t, x)`: adaptive Dormand–Prince 5(4) and fixed-step RK4.
//!
//! A problem implements [`System`]. Both integrators use the same calls, return every accepted [`Step`] (with its dense
//! output) to it, and report in a [`Report`] why they stopped and their effort. Known times at which the right-hand
//! side jumps are given as `breaks`: steps end there, and [`System::enter`] begins the next leg, so a right-hand side
//! always knows on which side of a jump it is evaluated.
//!
//! Nothing is allocated after an integrator has been built.

mod step;
// The time of an event within a step.
mod events;
// Step-size control.
mod control;
mod fastest;
// Explicit Runge-Kutta methods, adaptive and fixed.
mod dormand_prince;
pub(crate) mod rk4;
// An implicit Runge-Kutta method with derivatives.
pub(crate) mod radau;
// Exponentials of matrices.
mod matrix;
// Polynomials through past forces.
mod polynomial;
// Exponential integrator: linear parts are integrated exactly.
mod exponential;
// Many linear systems at once, under known forces.
mod hold;

pub use dormand_prince::{DormandPrince, Settings};
pub use exponential::{Driven, ExponentialAbreast, ExponentialAdams};
pub use hold::Hold;
pub use polynomial::PAST;
pub use rk4::Rk4;
pub use step::Step;

/// A system of first-order ordinary differential equations, with its actions along the solution.
pub trait System {
    /// The right-hand side: writes `dx = f(t, x)`, followed by the [`System::signals`].
    ///
    /// A value that is not finite is allowed and means that the solution does not exist there: the step is rejected.
    fn derivative(&mut self, t: f64, x: &[f64], dx: &mut [f64]);

    /// Number of signals that are written after the derivative; an accepted step interpolates both.
    ///
    /// So a signal that the right-hand side computes anyway has no further cost, however finely it is recorded.
    fn signals(&self) -> usize {
        0
    }

    /// Called where a smooth leg begins: at the start, at each break, and after an event that requests a restart.
    ///
    /// It may change the state; from here to the next call the right-hand side must be smooth in `t`.
    fn enter(&mut self, _t: f64, _x: &mut [f64]) {}

    /// Takes an accepted step.
    fn accept(&mut self, _step: &Step<'_>) {}

    /// The first time after `from` at which the right-hand side will have a kink, predicted from the state at `t` and
    /// its rate; infinite if none is expected.
    ///
    /// A method of high order loses its order across a kink, so a step ends there. The error control would also find
    /// the kink, but by failed steps, and short ones until it is passed.
    fn next_kink(&self, _t: f64, _x: &[f64], _dx: &[f64], _from: f64) -> f64 {
        f64::INFINITY
    }

    /// True if the system continues from an accepted step that ended at `t` in state `x` by a method of its own that
    /// needs less effort. The integration pauses there, until [`DormandPrince::resume`].
    fn takes_over(&mut self, _t: f64, _x: &[f64]) -> bool {
        false
    }

    /// The number of event functions.
    fn events(&self) -> usize {
        0
    }

    /// The event functions; an event is a change of sign (zero counts as positive).
    fn event_values(&mut self, _t: f64, _x: &[f64], _values: &mut [f64]) {}

    /// Consequence of an event. It may record the event, but changes the state only in [`System::enter`].
    fn happen(&mut self, _event: &Event<'_>) -> After {
        After::Continue
    }
}

/// An event function has changed its sign.
#[derive(Clone, Copy, Debug)]
pub struct Event<'a> {
    /// Position of the event function.
    pub index: usize,
    /// The first time, to rounding, with the new sign.
    pub time: f64,
    /// True if the new sign is positive.
    pub rising: bool,
    /// The state at that time, from the dense output.
    pub state: &'a [f64],
}

/// Consequence of an event.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum After {
    /// The right-hand side is smooth across it: the step continues.
    Continue,
    /// The step ends at the event, and a new leg begins there.
    Restart,
    /// The integration ends at the event.
    Stop,
}

/// Result of an integration.
#[derive(Clone, Copy, Debug, PartialEq)]
#[must_use = "an integration may have stopped before its end"]
pub struct Report {
    /// Stopping reason.
    pub reason: Reason,
    /// Time at which it stopped; the state is the solution at this time.
    pub time: f64,
    /// Effort.
    pub effort: Effort,
}

/// Stopping reason of an integration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reason {
    /// It has reached the end of its span.
    End,
    /// The event function at this position requested it.
    Event(usize),
    /// The system continues by its own method; see [`System::takes_over`].
    TakenOver,
    /// The state or its derivative is not finite just after this time, for any step length.
    NotFinite,
    /// The tolerance cannot be met after this time with a step that still advances the time.
    StepTooSmall,
    /// Events accumulate after this time, as for a ball that comes to rest.
    Crowded,
    /// The limit of attempted steps was reached.
    TooManySteps,
}

impl Reason {
    /// True if the solution is known as far as requested.
    pub fn is_success(self) -> bool {
        matches!(self, Self::End | Self::Event(_))
    }
}

impl std::fmt::Display for Report {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let t = self.time;
        match self.reason {
            Reason::End => write!(f, "reached the end at t = {t} s"),
            Reason::Event(index) => write!(f, "stopped by event {index} at t = {t} s"),
            Reason::TakenOver => write!(f, "left to the system at t = {t} s"),
            Reason::NotFinite => write!(f, "the state or its derivative is not finite after t = {t} s"),
            Reason::StepTooSmall => write!(f, "the tolerance cannot be met after t = {t} s with any step"),
            Reason::Crowded => write!(f, "endless events after t = {t} s"),
            Reason::TooManySteps => write!(
                f,
                "{} steps were not enough: it got to t = {t} s; the model may be too stiff for an explicit method",
                self.effort.accepted + self.effort.rejected
            ),
        }
    }
}

/// Effort of an integration.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Effort {
    /// Number of calls of the right-hand side.
    pub evaluations: usize,
    /// Number of accepted steps.
    pub accepted: usize,
    /// Number of steps that missed the tolerance or were not finite.
    pub rejected: usize,
    /// Number of located events.
    pub events: usize,
}

impl std::ops::AddAssign for Effort {
    fn add_assign(&mut self, other: Self) {
        self.evaluations += other.evaluations;
        self.accepted += other.accepted;
        self.rejected += other.rejected;
        self.events += other.events;
    }
}

/// Integrates the smooth legs of a span in turn, until one stops before its end; returns the last reason and time.
#[inline(always)]
fn over_legs(
    span: (f64, f64),
    breaks: &[f64],
    mut integrate: impl FnMut((f64, f64)) -> (Reason, f64),
) -> (Reason, f64) {
    let (mut reason, mut time) = (Reason::End, span.0);
    for leg in legs(span, breaks) {
        (reason, time) = integrate(leg);
        if reason != Reason::End {
            break;
        }
    }
    (reason, time)
}

/// The smooth legs of a span: its ends and the breaks inside it, pairwise.
///
/// Breaks must ascend; a break within rounding of its predecessor is ignored.
fn legs<'a>(span: (f64, f64), breaks: &'a [f64]) -> impl Iterator<Item = (f64, f64)> + 'a {
    let (start, end) = span;
    let gap = shortest_step(start, end);
    let inside = breaks
        .iter()
        .copied()
        .filter(move |&b| b > start + gap && b < end - gap);
    let mut last = start;
    inside.chain(std::iter::once(end)).filter_map(move |next| {
        let leg = (last, next);
        (next - last > gap).then(|| last = next).map(|()| leg)
    })
}

/// Smallest step that reliably advances the time of a span.
fn shortest_step(start: f64, end: f64) -> f64 {
    16.0 * f64::EPSILON * start.abs().max(end.abs())
}

/// True if every entry is finite. A sum of `0 * value` needs no branch in the loop.
fn all_finite(values: &[f64]) -> bool {
    values.iter().map(|v| v * 0.0).sum::<f64>() == 0.0
}
