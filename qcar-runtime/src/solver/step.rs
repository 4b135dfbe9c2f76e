//! A step with its dense output.

/// An accepted step, from `start` to `end`.
///
/// The interpolant is the quartic of Hairer, Nørsett, Wanner, *Solving Ordinary Differential Equations I*, II.6: the
/// cubic Hermite polynomial through both ends and both slopes, plus a term from the stages of the method. It is
/// continuous with its slope from step to step, and accurate to fourth order for Dormand–Prince, third for RK4.
#[derive(Clone, Copy, Debug)]
pub struct Step<'a> {
    /// Start, s.
    pub start: f64,
    /// End, s; before `start + length` if an event shortened it.
    pub end: f64,
    /// The length over which the interpolant is defined, s.
    pub(super) length: f64,
    /// State at `start` and at `start + length`.
    pub(super) states: [&'a [f64]; 2],
    /// Derivative at `start` and at `start + length`, followed by the signals.
    pub(super) slopes: [&'a [f64]; 2],
    /// The fourth-order term divided by the length; empty for a cubic.
    pub(super) quartic: &'a [f64],
    /// Mean rate of each state over the step, followed by the mean of each signal.
    pub(super) means: &'a [f64],
    /// Estimated error over tolerance of as many such steps as make the longest allowed one; infinite without an
    /// estimate, or if an event has shortened the step, so that stages of the method are beyond its end.
    pub(super) error: f64,
}

/// Error over tolerance below which a step counts as smooth.
const SMOOTH: f64 = 0.3;

impl<'a> Step<'a> {
    /// The state at the start of the step.
    pub fn start_state(&self) -> &'a [f64] {
        self.states[0]
    }

    /// The state at the end of the step of the method.
    pub fn end_state(&self) -> &'a [f64] {
        self.states[1]
    }

    /// The rates of the states at the end of the step, followed by the signals; `None` if an event has shortened it.
    pub fn end_rates(&self) -> Option<&'a [f64]> {
        self.error.is_finite().then_some(self.slopes[1])
    }

    /// Writes the state at time `t` of the step.
    pub fn at(&self, t: f64, state: &mut [f64]) {
        let n = state.len();
        let [x0, x1] = self.states.map(|x| &x[..n]);
        let [f0, f1] = self.slopes.map(|f| &f[..n]);
        let h = self.length;
        let a = (t - self.start) / h;
        let b = 1.0 - a;
        for i in 0..n {
            let rise = x1[i] - x0[i];
            let bend = h * f0[i] - rise;
            state[i] = x0[i] + a * (rise + b * (bend + a * (rise - h * f1[i] - bend)));
        }
        let weight = h * (a * b) * (a * b);
        for (x, q) in state.iter_mut().zip(self.quartic) {
            *x += weight * q;
        }
    }

    /// Writes the rates of the states from place `first` on at time `t` of the step, and after them the signals: the
    /// slopes of the interpolants of the states, and of those of the signals' integrals.
    ///
    /// They are exact at both ends; between them they are accurate to the order of the dense output minus one. Call it
    /// only if [`Step::has_rates`].
    pub fn rates_at(&self, t: f64, first: usize, rates: &mut [f64]) {
        let n = rates.len();
        let [y0, y1] = self.slopes.map(|slopes| &slopes[first..][..n]);
        let (means, quartic) = (&self.means[first..][..n], &self.quartic[first..][..n]);
        let a = (t - self.start) / self.length;
        let b = 1.0 - a;
        let weights = [b * (b - 2.0 * a), 6.0 * a * b, a * (a - 2.0 * b), 2.0 * a * b * (b - a)];
        for i in 0..n {
            rates[i] = weights[0] * y0[i] + weights[1] * means[i] + weights[2] * y1[i] + weights[3] * quartic[i];
        }
    }

    /// True if [`Step::rates_at`] is as accurate inside the step as at its ends.
    ///
    /// This needs a step shorter than the tolerance requires, limited by something else: the interpolant is of lower
    /// order than the method, and does not show a kink inside the step. A kink makes the tolerance shorten the step,
    /// and the same error in a shorter step is that of a less accurate signal.
    pub fn has_rates(&self) -> bool {
        self.error < SMOOTH
    }

    /// The same step, ended at `t` by an event.
    pub(super) fn until(&self, t: f64) -> Self {
        Self {
            end: t,
            error: f64::INFINITY,
            ..*self
        }
    }
}
