//! The length of the next step: PI control after Gustafsson, as in Hairer, Nørsett, Wanner, II.4 and IV.2.

/// The damping of the controller against steps that swing.
const BETA: f64 = 0.04;
/// Of the error exponent, one fifth, what is left to the proportional part.
const ALPHA: f64 = 0.2 - 0.75 * BETA;
/// A step is chosen to miss the tolerance by this factor on the safe side.
const SAFETY: f64 = 0.9;
/// A step changes at most by these factors.
const SHRINK: f64 = 0.2;
const GROW: f64 = 10.0;
/// A step may be so much longer than meant to reach an end, rather than be two of half the length: mostly it is good enough.
const STRETCH: f64 = 1.4;
/// A smaller error over the tolerance is remembered as this.
const LEAST: f64 = 1e-4;

/// What is known of the step size.
pub(super) struct Control {
    /// The next step, s, if nothing cuts it short; zero before the first.
    pub step: f64,
    /// The longest step that is allowed, s.
    pub longest: f64,
    /// Logarithm of the last error over the tolerance: a power of it is a product.
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

    /// Allows no step longer than `longest` (s), where that is a number.
    pub fn limit(&mut self, longest: f64) {
        self.longest = self.longest.min(longest);
    }

    /// End and length of the next step from `t`; it reaches `end` exactly rather than leave a sliver before it.
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

    /// Takes or refuses a step of length `h` by its error over the tolerance, and sets the next length.
    ///
    /// An error that is not finite, or not a number, is refused like any other that is not small.
    pub fn judge(&mut self, error: f64, h: f64) -> bool {
        let accepted = error <= 1.0;
        if accepted {
            let log = error.max(1e-16).ln();
            let factor = SAFETY * (BETA * self.last_log - ALPHA * log).exp();
            let most = if self.just_rejected { 1.0 } else { GROW };
            // A step that was cut short by an end says nothing against the length that was meant.
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
