//! Time integration of `dx/dt = f(t, x)`: adaptive Dormand–Prince 5(4) and fixed-step RK4.
//!
//! A problem implements [`System`]; both integrators drive it through the same calls, hand every accepted [`Step`]
//! (with its dense output) back to it, and say in a [`Report`] why they stopped and what it cost. Known times at which
//! the right-hand side jumps are given as `breaks`: steps end there, and [`System::enter`] begins the next leg, so a
//! right-hand side never has to guess on which side of a jump it is being asked.
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

/// A system of ordinary differential equations of first order, and what is to be done along its solution.
pub trait System {
    /// The right-hand side: writes `dx = f(t, x)`, and after it the [`System::signals`].
    ///
    /// A value that is not finite is legal and means that the solution does not exist there: the step is refused.
    fn derivative(&mut self, t: f64, x: &[f64], dx: &mut [f64]);

    /// The number of signals that come with the derivative, written after it; an accepted step interpolates both.
    ///
    /// So a signal that the right-hand side has at hand costs nothing more, however finely it is recorded.
    fn signals(&self) -> usize {
        0
    }

    /// Called where a smooth leg begins: at the start, at each break, and after an event that asked to restart.
    ///
    /// It may change the state; from here to the next call the right-hand side must be smooth in `t`.
    fn enter(&mut self, _t: f64, _x: &mut [f64]) {}

    /// Takes an accepted step.
    fn accept(&mut self, _step: &Step<'_>) {}

    /// The first time after `from` at which the right-hand side will have a kink, as predicted from the state at
    /// `t` and its rate; infinite where nothing is in sight.
    ///
    /// A method of high order loses its order across a kink, so a step ends there. The error control would find that too,
    /// but by failed steps, and short ones until the kink is passed.
    fn next_bend(&self, _t: f64, _x: &[f64], _dx: &[f64], _from: f64) -> f64 {
        f64::INFINITY
    }

    /// True where the system goes on from an accepted step that ended at `t` in state `x` by a method of its own that takes
    /// less than this one. The integration pauses there, until [`DormandPrince::resume`].
    fn takes_over(&mut self, _t: f64, _x: &[f64]) -> bool {
        false
    }

    /// The number of event functions.
    fn events(&self) -> usize {
        0
    }

    /// The event functions; an event happens where one changes sign (zero counts as positive).
    fn event_values(&mut self, _t: f64, _x: &[f64], _values: &mut [f64]) {}

    /// Says what follows from an event; it may note the event, and changes the state only in [`System::enter`].
    fn happen(&mut self, _event: &Event<'_>) -> After {
        After::Continue
    }
}

/// An event function has changed its sign.
#[derive(Clone, Copy, Debug)]
pub struct Event<'a> {
    /// Which event function.
    pub index: usize,
    /// The first instant, to rounding, that has the new sign.
    pub time: f64,
    /// True where the new sign is positive.
    pub rising: bool,
    /// The state at that instant, from the dense output.
    pub state: &'a [f64],
}

/// What follows from an event.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum After {
    /// The right-hand side is smooth across it: the step stands.
    Continue,
    /// The step ends at the event, and a new leg begins there.
    Restart,
    /// The integration ends at the event.
    Stop,
}

/// How an integration ended.
#[derive(Clone, Copy, Debug, PartialEq)]
#[must_use = "an integration may have stopped before its end"]
pub struct Report {
    /// Why it stopped.
    pub reason: Reason,
    /// Where it stopped; the state is the solution at this time.
    pub time: f64,
    /// What it cost.
    pub effort: Effort,
}

/// Why an integration stopped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reason {
    /// It has reached the end of its span.
    End,
    /// The event function with this place asked for it.
    Event(usize),
    /// The system goes on by itself; see [`System::takes_over`].
    TakenOver,
    /// The state or its derivative is not finite just after this time, however short the step.
    NotFinite,
    /// The tolerance cannot be met after this time with a step that still advances it.
    StepTooSmall,
    /// Events follow one another without an end after this time, as those of a ball that comes to rest.
    Crowded,
    /// The limit of attempted steps is used up.
    TooManySteps,
}

impl Reason {
    /// True where the solution is known as far as was wanted.
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

/// What an integration cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Effort {
    /// Calls of the right-hand side.
    pub evaluations: usize,
    /// Steps that were taken.
    pub accepted: usize,
    /// Steps that missed the tolerance or were not finite.
    pub rejected: usize,
    /// Events that were located.
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

/// The smooth legs of a span: its ends and the breaks inside it, pairwise.
///
/// Breaks must ascend; one that is no further than rounding from its predecessor is passed over.
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

/// A step below this no longer advances the time of a span reliably.
fn shortest_step(start: f64, end: f64) -> f64 {
    16.0 * f64::EPSILON * start.abs().max(end.abs())
}

/// True where every entry is finite. Adding up `0 * value` needs no branch in the loop.
fn all_finite(values: &[f64]) -> bool {
    values.iter().map(|v| v * 0.0).sum::<f64>() == 0.0
}
