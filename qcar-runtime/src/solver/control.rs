//! The length of the next step: PI control after Gustafsson, as in Hairer, Nørsett, Wanner, II.4 and IV.2.

/// Damping of the controller against oscillating steps.
const BETA: f64 = 0.04;
/// Exponent of the proportional part: one fifth, minus the share of the integral part.
const ALPHA: f64 = 0.2 - 0.75 * BETA;
/// Safety factor of the next step.
const SAFETY: f64 = 0.9;
/// Smallest and largest change of a step.
const SHRINK: f64 = 0.2;
const GROW: f64 = 10.0;
/// Factor by which a step may be lengthened to reach an end, instead of two steps of half the length: usually the error
/// allows it.
const STRETCH: f64 = 1.4;
/// Smallest error over tolerance that is stored.
const LEAST: f64 = 1e-4;

/// State of the step-size controller.
pub(super) struct Control {
    /// The next step, s, if nothing cuts it short; zero before the first.
    pub step: f64,
    /// Longest allowed step, s.
    pub longest: f64,
    /// Logarithm of the last error over tolerance, so that powers are products.
    last_log: f64,
    just_rejected: bool,
}

impl Control {
    pub fn new(longest: f64) -> Self {
        Self {
            step: 0.0,
            longest,
            last_log: LEAST.ln(),
            just_rejected: false,
        }
    }

    /// Allows no step longer than `longest` (s), unless that is NaN.
    pub fn limit(&mut self, longest: f64) {
        self.longest = self.longest.min(longest);
    }

    /// End and length of the next step from `t`; it reaches `end` exactly instead of leaving a tiny step before it.
    pub fn next(&self, t: f64, end: f64) -> (f64, f64) {
        let (left, h) = (end - t, self.step.min(self.longest));
        let stretched = if self.just_rejected {
            h
        } else {
            (STRETCH * h).min(self.longest)
        };
        if left <= stretched {
            (end, left)
        } else if left <= 2.0 * h {
            (t + 0.5 * left, 0.5 * left)
        } else {
            (t + h, h)
        }
    }

    /// Accepts or rejects a step of length `h` by its error over tolerance, and sets the next length.
    ///
    /// An error that is infinite or NaN is rejected.
    pub fn judge(&mut self, error: f64, h: f64) -> bool {
        let accepted = error <= 1.0;
        if accepted {
            let log = error.max(1e-16).ln();
            let factor = SAFETY * (BETA * self.last_log - ALPHA * log).exp();
            let most = if self.just_rejected { 1.0 } else { GROW };
            // A step that was shortened by an end does not limit the next one.
            let grown = h * factor.clamp(SHRINK, most);
            self.step = if h < self.step && factor > 1.0 {
                grown.max(self.step)
            } else {
                grown
            }
            .min(self.longest);
            self.last_log = log.max(LEAST.ln());
        } else {
            let factor = SAFETY / error.powf(ALPHA);
            self.step = h * if factor.is_finite() { factor.max(SHRINK) } else { SHRINK };
        }
        self.just_rejected = !accepted;
        accepted
    }
}
