//! The force on the wheel from the geometry of a contact and the law of a link.

use super::Touch;
use crate::model::Contact;

impl Touch {
    /// The force of the tyre on its wheel, `[z, x]` as in [`Contact::force`], by `law(s, v)`: the resisting force (N,
    /// positive in tension) at stretch `s` (m, negative here) and rate `v` (m/s).
    ///
    /// - The spring, `law(s, 0)`, pushes along the direction of the contact; it is zero instead of pulling.
    /// - Growth pushes along its own direction with the increase of the law by the rate of growth.
    /// - Shrinkage pulls along its own direction with the decrease of the law by the rate of shrinkage, but at most as
    ///   much as the spring pushes. So the total never pulls against the direction of the contact.
    #[inline(always)]
    pub fn force(&self, law: impl Fn(f64, f64) -> f64) -> Contact {
        self.pushing(self.strains().map(|[s, v]| law(s, v)))
    }

    /// The same for a point contact that is continued into the air: as the point approaches, the spring pulls there as
    /// much as it pushes at the opposite deflection, so that the force is smooth where the tyre lands.
    pub(crate) fn continued_force(&self, law: impl Fn(f64, f64) -> f64) -> Contact {
        let mut contact = self.pushing(self.strains().map(|[s, v]| law(s, v)));
        if self.deflection < 0.0 && self.growth.rate > 0.0 {
            // A law of a tyre may be zero where there is no deflection.
            let [at_rest, growing] = [0.0, -self.growth.rate].map(|rate| law(self.deflection, rate));
            let force = at_rest.min(0.0) + (at_rest - growing).max(0.0);
            contact.force = [1, 0].map(|axis| force * self.direction[axis]);
        }
        contact
    }

    /// Stretches and rates at which the law is evaluated: at rest, growing and shrinking.
    #[inline(always)]
    pub(crate) fn strains(&self) -> [[f64; 2]; 3] {
        let s = -self.deflection;
        [[s, 0.0], [s, -self.growth.rate], [s, self.shrinkage.rate]]
    }

    /// [`Touch::force`] from the law at these points.
    #[inline(always)]
    pub(crate) fn pushing(&self, [at_rest, growing, shrinking]: [f64; 3]) -> Contact {
        let spring = (-at_rest).max(0.0);
        let growth = (at_rest - growing).max(0.0);
        // As `clamp`, which would check the order of its bounds in every pass of a loop.
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
