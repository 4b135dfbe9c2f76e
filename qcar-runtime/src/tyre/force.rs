//! From the geometry of a contact and the law of a link to the force on the wheel.

use super::Touch;
use crate::model::Contact;

impl Touch {
    /// The force of the tyre on its wheel, `[z, x]` as in [`Contact::force`], by `law(s, v)`: the resisting force (N,
    /// positive in tension) at stretch `s` (m, negative here) and rate `v` (m/s).
    ///
    /// - The spring, `law(s, 0)`, pushes along the direction of the contact; where it would pull, it is zero.
    /// - Growth pushes along its own direction with what the law has more at the rate of growth.
    /// - Shrinkage pulls along its own direction with what the law has less at the rate of shrinkage, but never more
    ///   than the spring pushes. So the total never pulls against the direction of the contact.
    #[inline(always)]
    pub fn force(&self, law: impl Fn(f64, f64) -> f64) -> Contact {
        self.pushing(self.strains().map(|[s, v]| law(s, v)))
    }

    /// Stretches and rates at which the law is asked: at rest, growing and shrinking.
    #[inline(always)]
    pub(crate) fn strains(&self) -> [[f64; 2]; 3] {
        let s = -self.deflection;
        [[s, 0.0], [s, -self.growth.rate], [s, self.shrinkage.rate]]
    }

    /// [`Touch::force`] by what the law says of these.
    #[inline(always)]
    pub(crate) fn pushing(&self, [at_rest, growing, shrinking]: [f64; 3]) -> Contact {
        let spring = (-at_rest).max(0.0);
        let growth = (at_rest - growing).max(0.0);
        // As `clamp` has it, which would ask at every turn of a loop whether the ends are in order.
        let less = shrinking - at_rest;
        let less = if less < 0.0 { 0.0 } else { less };
        let shrinkage = if less > spring { spring } else { less };
        let along = |axis: usize| {
            spring * self.direction[axis] + growth * self.growth.direction[axis]
                - shrinkage * self.shrinkage.direction[axis]
        };
        Contact {
            s: -self.deflection,
            v: self.shrinkage.rate - self.growth.rate,
            force: [along(1), along(0)],
        }
    }
}
