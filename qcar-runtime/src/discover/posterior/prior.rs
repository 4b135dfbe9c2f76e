//! What is known of parameters, and of the sides of a car, before any measurement.

use crate::discover::observe::{Free, Run, Stimulus};
use crate::model::Model;

/// Standard deviation of the logarithm of a side's factor: parts of one drawing, and springs of one batch.
pub const SIDE: f64 = 0.015;

/// Standard deviation of a weak prior around where a search begins: a factor of ten, or the whole of a range that reaches
/// zero. What a part of the data hardly determines stays where the fit to all of them begins.
const STRAY: f64 = std::f64::consts::LN_10;

impl Free {
    /// How far it is from the centre of its prior in standard deviations, and the derivative of that: of a value whose range
    /// lies above zero in its logarithm. The standard deviation is that of a uniform distribution over the range.
    pub(super) fn prior(&self, value: f64, centre: f64) -> (f64, f64) {
        let of_width = |width: f64| width / 12.0_f64.sqrt();
        if self.lower > 0.0 {
            let sd = of_width((self.upper / self.lower).ln());
            ((value / centre.max(self.lower)).ln() / sd, 1.0 / (value * sd))
        } else {
            let sd = of_width(self.upper - self.lower);
            ((value - centre) / sd, 1.0 / sd)
        }
    }

    /// How far it is from its start in standard deviations of a weak prior, and the derivative of that.
    pub(super) fn strayed(&self, value: f64, start: f64) -> (f64, f64) {
        if self.lower > 0.0 {
            ((value / start.max(self.lower)).ln() / STRAY, 1.0 / (value * STRAY))
        } else {
            let width = self.upper - self.lower;
            ((value - start) / width, 1.0 / width)
        }
    }
}

/// True for a run that records one side of the car.
pub fn of_one_side(run: &Run) -> bool {
    matches!(run.stimulus, Stimulus::Cleat(_))
}

/// True for a parameter that may differ between the sides of a car.
pub fn is_of_a_side(model: &dyn Model, free: &Free) -> bool {
    model.about().parameters[free.parameter].unit != "1"
}
