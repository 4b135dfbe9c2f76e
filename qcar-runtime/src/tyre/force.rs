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
        let s = -self.deflection;
        let at_rest = law(s, 0.0);
        let spring = (-at_rest).max(0.0);
        let growth = (at_rest - law(s, -self.growth.rate)).max(0.0);
        let shrinkage = (law(s, self.shrinkage.rate) - at_rest).clamp(0.0, spring);
        let along = |axis: usize| {
            spring * self.direction[axis] + growth * self.growth.direction[axis]
                - shrinkage * self.shrinkage.direction[axis]
        };
        Contact {
            s,
            v: self.shrinkage.rate - self.growth.rate,
            force: [along(1), along(0)],
        }
    }
}
