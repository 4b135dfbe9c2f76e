//! A step with its dense output.

/// An accepted step, from `start` to `end`.
///
/// The interpolant is the quartic of Hairer, Nørsett, Wanner, *Solving Ordinary Differential Equations I*, II.6: the
/// cubic Hermite polynomial through both ends and both slopes, plus a term that the method's stages give. It is
/// continuous with its slope from step to step, and accurate to fourth order for Dormand–Prince, third for RK4.
#[derive(Clone, Copy, Debug)]
pub struct Step<'a> {
    /// Where it begins, s.
    pub start: f64,
    /// Where it ends, s; before `start + length` where an event cut it short.
    pub end: f64,
    /// The length over which the interpolant is defined, s.
    pub(super) length: f64,
    /// State at `start` and at `start + length`.
    pub(super) states: [&'a [f64]; 2],
    /// Derivative at `start` and at `start + length`, and after it the signals.
    pub(super) slopes: [&'a [f64]; 2],
    /// The term of fourth order divided by the length; empty for a cubic.
    pub(super) quartic: &'a [f64],
    /// The mean rate of each state over the step, and after it the mean of each signal.
    pub(super) means: &'a [f64],
    /// The estimated error over what is tolerated, of as many such steps as make the longest that is allowed; infinite
    /// where there is no estimate, or where an event has cut the step short and the stages of the method lie beyond it.
    pub(super) error: f64,
}

/// An error so far below the tolerance shows a smooth step.
const SMOOTH: f64 = 0.3;

impl<'a> Step<'a> {
    /// The state where the step begins.
    pub fn start_state(&self) -> &'a [f64] {
        self.states[0]
    }

    /// The state where the method's step ends.
    pub fn end_state(&self) -> &'a [f64] {
        self.states[1]
    }

    /// The rates of the states where the step ends, and after them the signals; none where an event has cut it short.
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
    /// They are exact at both ends; between them they are accurate to the order of the dense output less one. To be asked
    /// only where [`Step::has_rates`].
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

    /// True where [`Step::rates_at`] is as good between the ends of the step as at its ends.
    ///
    /// That asks for a step shorter than the tolerance would have it, as it is where something else limits its length:
    /// the interpolant is of lower order than the method, and does not show a kink inside the step. A kink makes the
    /// tolerance shorten the step, and the same error in a shorter step is one of a signal that is further off.
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
