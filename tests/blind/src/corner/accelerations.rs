//! The accelerations that the forces on a corner cause.

use super::{
    BELT, BODY, COORDINATES, Corner, FLEX, FLUID, FRICTION, Forces, OTHER, PITCH, PWT, RESONATOR, SF, State, TM, WHEEL,
    X_BODY, X_OTHER, X_PWT, X_SF, X_WHEEL,
};
use crate::axle::{GRAVITY, Mount};
use crate::hidden::Apparent;

impl Corner<'_> {
    pub(super) fn accelerate(&self, y: &State, f: &Forces, gravity: bool, dy: &mut State) {
        let (a, l) = (self.axle, self.laws);
        let g = if gravity { GRAVITY } else { 0.0 };
        let acceleration = &mut dy[COORDINATES..FRICTION];
        let mut falls = |i: usize, m: f64, there: bool| {
            if there {
                acceleration[i] = f[i] / m - g;
            }
        };
        let powertrain = a.layout.powertrain != Mount::None;
        falls(BODY, self.body(), true);
        falls(TM, a.m_tm, a.layout.top_mount);
        falls(SF, a.m_sf, a.layout.subframe);
        falls(PWT, a.m_pwt, powertrain);
        falls(BELT, l.belt.map_or(1.0, |b| b.m_belt), l.belt.is_some());
        falls(
            RESONATOR,
            l.resonator.map_or(1.0, |r| r.m_resonator),
            l.resonator.is_some(),
        );
        let gear = l.inertance.unwrap_or(0.0);
        falls(WHEEL, l.carried_by_the_wheel(a.m_wheel), true);
        if gear > 0.0 {
            self.couple_by_inerter(gear, f, g, acceleration);
        }
        if let Some(apparent) = l.apparent {
            self.couple_by_body(apparent, f, g, acceleration);
        }
        if let Some(mode) = l.flexible {
            let elastic = mode.omega * (mode.omega * y[FLEX] + 2.0 * mode.damping * y[COORDINATES + FLEX]);
            acceleration[FLEX] = f[BODY] / (mode.generalised() * self.body()) - elastic;
            acceleration[BODY] += acceleration[FLEX];
        }
        if let Some(pitch) = l.pitch {
            acceleration[PITCH] = f[PITCH] / pitch.inertia;
        }
        if let Some(h) = l.hydraulic {
            acceleration[FLUID] = f[FLUID] / h.inertance;
        }
        let m_sf = if a.layout.subframe { a.m_sf } else { 0.0 };
        let m_pwt = if powertrain { a.m_pwt } else { 0.0 };
        acceleration[X_WHEEL] = f[X_WHEEL] / a.m_wheel;
        acceleration[X_BODY] = f[X_BODY] / (a.m_half_vehicle - a.m_wheel - m_sf - m_pwt - a.m_wheel_other_axle);
        acceleration[X_OTHER] = f[X_OTHER] / a.m_wheel_other_axle;
        if a.layout.subframe {
            acceleration[X_SF] = f[X_SF] / a.m_sf;
        }
        if powertrain {
            acceleration[X_PWT] = f[X_PWT] / a.m_pwt;
        }
    }

    /// An inerter beside the damper couples the masses at its two ends (upright layouts only).
    fn couple_by_inerter(&self, b: f64, f: &Forces, g: f64, acceleration: &mut [f64]) {
        let a = self.axle;
        let (top, m_top) = if a.layout.top_mount {
            (TM, a.m_tm)
        } else {
            (BODY, self.body())
        };
        let (m1, m2) = (m_top + b, a.m_wheel + b);
        let (f1, f2) = (f[top] - m_top * g, f[WHEEL] - a.m_wheel * g);
        let det = m1 * m2 - b * b;
        acceleration[top] = (m2 * f1 + b * f2) / det;
        acceleration[WHEEL] = (b * f1 + m1 * f2) / det;
    }

    /// A rigid body over both axles: the mass matrix for its vertical displacements above the two axles.
    fn couple_by_body(&self, apparent: Apparent, f: &Forces, g: f64, acceleration: &mut [f64]) {
        let a = self.axle;
        let here = self.body();
        let there = a.m_half_vehicle - a.m_corner - a.m_wheel_other_axle;
        let total = here + there;
        // Distances of the centre of gravity as shares of the wheelbase, which cancels.
        let (from_here, from_there) = (there / total, here / total);
        let radius = apparent.dynamic_index * from_here * from_there;
        let m11 = total * (from_there * from_there + radius);
        let m22 = total * (from_here * from_here + radius);
        let m12 = total * (from_here * from_there - radius);
        let f1 = f[BODY] - here * g;
        let f2 = f[OTHER] - there * g;
        let det = m11 * m22 - m12 * m12;
        acceleration[BODY] = (m22 * f1 - m12 * f2) / det;
        acceleration[OTHER] = (m11 * f2 - m12 * f1) / det;
    }
}
