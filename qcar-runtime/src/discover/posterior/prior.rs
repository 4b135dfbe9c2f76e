//! Priors of parameters and of the sides of a car.

use crate::discover::observe::{Free, Run, Stimulus};
use crate::model::Model;

/// Prior standard deviation of a side's log factor: parts of one drawing and springs of one batch.
pub const SIDE: f64 = 0.015;

/// Standard deviation of the weak prior around the start, as a log ratio: a factor of ten. For a range that reaches
/// zero or negative values it is the width of the range. This prior keeps parameters that the data hardly determine
/// near their start. A choice.
const WEAK: f64 = std::f64::consts::LN_10;

impl Free {
    /// Distance from the centre of the prior in standard deviations, and its derivative. The scale is logarithmic if
    /// the range is positive. The standard deviation is that of a uniform distribution over the range.
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

    /// Distance from the start in standard deviations of the weak prior, and its derivative.
    pub(super) fn weak_prior(&self, value: f64, start: f64) -> (f64, f64) {
        if self.lower > 0.0 {
            ((value / start.max(self.lower)).ln() / WEAK, 1.0 / (value * WEAK))
        } else {
            let width = self.upper - self.lower;
            ((value - start) / width, 1.0 / width)
        }
    }
}

/// True for a run that records one side of the car.
pub fn is_one_sided(run: &Run) -> bool {
    matches!(run.stimulus, Stimulus::Cleat(_))
}

/// True for a parameter that may differ between the sides: one with a unit.
pub fn may_differ_by_side(model: &dyn Model, free: &Free) -> bool {
    model.about().parameters[free.parameter].unit != "1"
}
