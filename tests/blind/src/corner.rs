//! The equations of motion of one corner, in z and x, written out by hand.

// The tyre's inner parts.
mod tire;
// From forces to accelerations.
mod accelerations;

use crate::axle::{Axle, Mount};
use crate::hidden::Laws;
use crate::other_law::{INNER, Other};

/// Index of each vertical coordinate.
pub const WHEEL: usize = 0;
/// Body above this axle.
pub const BODY: usize = 1;
/// Top mount.
pub const TM: usize = 2;
/// Sub-frame.
pub const SF: usize = 3;
/// Powertrain.
pub const PWT: usize = 4;
/// Belt of the tyre.
pub const BELT: usize = 5;
/// Pitch angle of the sub-frame.
pub const PITCH: usize = 6;
/// Body above the other axle.
pub const OTHER: usize = 7;
/// Fluid of the hydraulic mount, as travel of the mount.
pub const FLUID: usize = 8;
/// Resonator on the wheel.
pub const RESONATOR: usize = 9;
/// Longitudinal wheel, body, sub-frame, powertrain, other wheel.
pub const X_WHEEL: usize = 10;
/// See [`X_WHEEL`].
pub const X_BODY: usize = 11;
/// See [`X_WHEEL`].
pub const X_SF: usize = 12;
/// See [`X_WHEEL`].
pub const X_PWT: usize = 13;
/// See [`X_WHEEL`].
pub const X_OTHER: usize = 14;
/// Upward bending displacement of the body where the suspension acts.
pub const FLEX: usize = 15;
/// Number of coordinates.
pub const COORDINATES: usize = 16;
const FRICTION: usize = 2 * COORDINATES;
const TM_BRANCH: usize = FRICTION + 1;
const PWT_BRANCH: usize = FRICTION + 2;
/// Index of the force of the tyre's relaxing branch, N, positive in compression.
const TIRE_BRANCH: usize = FRICTION + 3;
const LOOP: usize = FRICTION + 4;
/// Index of the force of a damper in series with a spring, N.
const SERIES: usize = FRICTION + 5;
/// Index of the first state of a law in another form.
const OTHER_LAW: usize = FRICTION + 6;
/// Length of the state: positions, velocities, inner forces.
pub const STATES: usize = OTHER_LAW + INNER;

/// Positions, velocities, inner forces.
pub type State = [f64; STATES];

/// A corner with its hidden effects.
pub struct Corner<'a> {
    pub axle: &'a Axle,
    pub laws: &'a Laws,
}

/// The force on each coordinate, N.
type Forces = [f64; COORDINATES];

/// The excitation: forces on the tyre's ring along z and x, N, and the rate of its deflection, m/s.
#[derive(Clone, Copy, Default)]
pub struct Push {
    pub z: f64,
    pub x: f64,
    pub compression_rate: f64,
}

impl Corner<'_> {
    /// Body mass of this corner, kg.
    fn body(&self) -> f64 {
        let a = self.axle;
        let mut rest = a.m_wheel;
        if a.layout.top_mount {
            rest += a.m_tm;
        }
        if a.layout.subframe {
            rest += a.m_sf;
        }
        if a.layout.powertrain != Mount::None {
            rest += a.m_pwt;
        }
        a.m_corner - rest
    }

    /// The body's bending at the suspension less that at the sensor, as share of the former.
    pub fn sensor_beside_bend(&self) -> f64 {
        self.laws.flexible.map_or(0.0, |mode| 1.0 - mode.at_sensor)
    }

    /// Remaining share of the damping at a time, which is given as a share of the run.
    fn warm(&self, share: f64) -> f64 {
        self.laws.heat.map_or(1.0, |heat| heat.left(share))
    }

    /// The coordinate in contact with the road.
    pub fn ring(&self) -> usize {
        if self.laws.belt.is_some() { BELT } else { WHEEL }
    }

    /// The derivative of the state under the excitation `push`, at a time that is given as a share of the run.
    pub fn derivative(&self, share: f64, y: &State, push: Push, gravity: bool) -> State {
        let mut f = [0.0; COORDINATES];
        let mut dy = [0.0; STATES];
        dy[..COORDINATES].copy_from_slice(&y[COORDINATES..FRICTION]);
        f[self.ring()] += push.z;
        f[X_WHEEL] += push.x;
        self.tire_inside(y, push, &mut f, &mut dy);
        self.strut(share, y, &mut f, &mut dy);
        self.mounts(y, &mut f, &mut dy);
        f[BODY] -= self.laws.body_drag.unwrap_or(0.0) * y[COORDINATES + BODY];
        f[BODY] -= self.laws.other.map_or(0.0, |law| law.drag(y[COORDINATES + BODY]));
        f[WHEEL] -= self.laws.wheel_drag.unwrap_or(0.0) * y[COORDINATES + WHEEL];
        self.longitudinal(y, &mut f);
        self.accelerate(y, &f, gravity, &mut dy);
        dy
    }

    /// Force of a law in another form that has states, N.
    fn remembered(&self, y: &State, dy: &mut State, force: impl Fn(&Other, &[f64], &mut [f64]) -> f64) -> f64 {
        let law = self.laws.other.as_ref();
        law.map_or(0.0, |law| force(law, &y[OTHER_LAW..], &mut dy[OTHER_LAW..]))
    }

    fn pivot(&self, y: &State) -> (f64, f64) {
        if !self.axle.layout.subframe {
            return (y[BODY], y[COORDINATES + BODY]);
        }
        let arm = self.laws.pitch.map_or(0.0, |p| p.arm_offset);
        (
            y[SF] + arm * y[PITCH],
            y[COORDINATES + SF] + arm * y[COORDINATES + PITCH],
        )
    }

    fn push_pivot(&self, f: &mut Forces, force: f64) {
        if !self.axle.layout.subframe {
            f[BODY] += force;
            return;
        }
        f[SF] += force;
        f[PITCH] += self.laws.pitch.map_or(0.0, |p| p.arm_offset) * force;
    }

    /// Spring, damper and top mount.
    fn strut(&self, share: f64, y: &State, f: &mut Forces, dy: &mut State) {
        let (a, v) = (self.axle, &y[COORDINATES..]);
        let arms = a.layout.subframe;
        let (mr_spring, mr_damper) = if arms { (a.mr_spring, a.mr_damper) } else { (1.0, 1.0) };
        let (pivot, pivot_v) = self.pivot(y);
        let top = if a.layout.top_mount { TM } else { BODY };

        let s = (y[BODY] - pivot - mr_spring * (y[WHEEL] - pivot)) / mr_spring;
        let force = self.spring(s) / mr_spring;
        f[BODY] -= force;
        f[WHEEL] += mr_spring * force;
        self.push_pivot(f, (1.0 - mr_spring) * force);

        let s = (y[top] - pivot - mr_damper * (y[WHEEL] - pivot)) / mr_damper;
        let rate = (v[top] - pivot_v - mr_damper * (v[WHEEL] - pivot_v)) / mr_damper;
        let force = self.damper(share, s, rate, y, dy) / mr_damper;
        f[top] -= force;
        f[WHEEL] += mr_damper * force;
        self.push_pivot(f, (1.0 - mr_damper) * force);

        let past = (v[BODY] - pivot_v - mr_damper * (v[WHEEL] - pivot_v)) / mr_damper;
        let rate = if self.laws.friction_past_mount { past } else { rate };
        let end = if self.laws.friction_past_mount { BODY } else { top };
        let force = self.dry(rate, y, dy) / mr_damper;
        f[end] -= force;
        f[WHEEL] += mr_damper * force;
        self.push_pivot(f, (1.0 - mr_damper) * force);

        if a.layout.top_mount {
            let (s, rate) = (y[BODY] - y[TM], v[BODY] - v[TM]);
            let mut force = a.k_tm * s + a.c_tm * rate + self.laws.cubic_top_mount.unwrap_or(0.0) * s.powi(3);
            if let Some(branch) = self.laws.top_mount_relaxation {
                force += y[TM_BRANCH];
                let fade = std::f64::consts::TAU * branch.relaxation_frequency;
                dy[TM_BRANCH] = branch.k_maxwell * rate - fade * y[TM_BRANCH];
            }
            force += self.remembered(y, dy, |law, inner, dy| law.top_mount(rate, inner, dy));
            f[BODY] -= force;
            f[TM] += force;
        }
    }

    /// Resisting force of the spring at the wheel, N, for an extension given in wheel travel, m.
    fn spring(&self, s: f64) -> f64 {
        let rise = self.laws.rate_increase_at_40mm.unwrap_or(0.0) / 3.0 * (s / 0.04).powi(2);
        let stop = self.laws.bump_stop.map_or(0.0, |b| b.k_stop * (s + b.gap).min(0.0));
        let k = self.axle.k_wheel_z;
        k * s * (1.0 + rise) + stop + self.laws.other.map_or(0.0, |law| law.spring(k, s))
    }

    /// Resisting force of the damper at the wheel without its friction, N.
    fn damper_law(&self, share: f64, s: f64, v: f64) -> f64 {
        let l = self.laws;
        let mut c = self.axle.c_wheel_z * (1.0 - l.fade.unwrap_or(0.0) * share);
        if let Some(ratio) = l.rebound_over_compression {
            c *= 2.0 / (1.0 + ratio) * if v > 0.0 { ratio } else { 1.0 };
        }
        if let Some(p) = l.segmented {
            let (c1, c2) = if v > 0.0 {
                (p.c_rebound, p.q_rebound)
            } else {
                (p.c_compression, p.q_compression)
            };
            c = c1 + c2 * v.abs();
        }
        if let Some(d) = l.digressive {
            c = d.c0 / (1.0 + v.abs() / d.v0);
        }
        if let Some(force) = l.other.and_then(|law| law.damper(c, s, v)) {
            return self.warm(share) * force;
        }
        let engaged = l.free_play.is_none_or(|gap| s.abs() > gap / 2.0);
        let quadratic = l.quadratic_damping.unwrap_or(0.0) * v * v.abs();
        if engaged {
            self.warm(share) * (c * v + quadratic)
        } else {
            0.0
        }
    }

    fn damper(&self, share: f64, s: f64, v: f64, y: &State, dy: &mut State) -> f64 {
        let Some(k) = self.laws.k_series else {
            return self.damper_law(share, s, v);
        };
        dy[SERIES] = k * (v - y[SERIES] / (self.warm(share) * self.axle.c_wheel_z));
        y[SERIES]
    }

    /// Dry friction and the loop of a hysteresis, N.
    fn dry(&self, v: f64, y: &State, dy: &mut State) -> f64 {
        let mut force = 0.0;
        if let Some(friction) = self.laws.friction {
            force += y[FRICTION];
            dy[FRICTION] = friction.k_presliding * (v - v.abs() * y[FRICTION] / friction.f_coulomb);
        }
        if let Some(b) = self.laws.bouc_wen {
            force += y[LOOP];
            let part = y[LOOP] / b.f_hysteresis;
            let lost = b.loop_shape * v.abs() * part * part.abs() + (1.0 - b.loop_shape) * v * part * part;
            dy[LOOP] = b.k_hysteresis * (v - lost);
        }
        force + self.remembered(y, dy, |law, inner, dy| law.friction(v, inner, dy))
    }

    /// Sub-frame and powertrain.
    fn mounts(&self, y: &State, f: &mut Forces, dy: &mut State) {
        let (a, v) = (self.axle, &y[COORDINATES..]);
        if a.layout.subframe {
            let (h, front) = self.laws.pitch.map_or((0.0, 0.5), |p| (p.half_length, p.front_share));
            for (arm, part) in [(h, front), (-h, 1.0 - front)] {
                let s = y[BODY] - y[SF] - arm * y[PITCH];
                let rate = v[BODY] - v[SF] - arm * v[PITCH];
                let force = part * (a.k_sf_z * s + a.c_sf_z * rate);
                f[BODY] -= force;
                f[SF] += force;
                f[PITCH] += arm * force;
            }
        }
        if let Some(other) = self.laws.apparent {
            f[OTHER] -= other.k_wheel_z_other * y[OTHER] + other.c_wheel_z_other * v[OTHER];
        }
        let carrier = match a.layout.powertrain {
            Mount::None => return,
            Mount::Body => BODY,
            Mount::Subframe => SF,
        };
        let (s, rate) = (y[PWT] - y[carrier], v[PWT] - v[carrier]);
        let mut force = a.k_pwt_z * s + a.c_pwt_z * rate;
        if let Some(branch) = self.laws.powertrain_relaxation {
            force += y[PWT_BRANCH];
            let fade = std::f64::consts::TAU * branch.relaxation_frequency;
            dy[PWT_BRANCH] = branch.k_maxwell * rate - fade * y[PWT_BRANCH];
        }
        if let Some(h) = self.laws.hydraulic {
            let push = h.k_volume * (s - y[FLUID]);
            force += push;
            f[FLUID] += push - h.c_track * v[FLUID];
        }
        force += self.remembered(y, dy, |law, inner, dy| law.powertrain_mount(rate, inner, dy));
        f[PWT] -= force;
        f[carrier] += force;
    }

    /// The longitudinal chain: wheel, sub-frame, body, powertrain and the other axle's wheel.
    fn longitudinal(&self, y: &State, f: &mut Forces) {
        let (a, v) = (self.axle, &y[COORDINATES..]);
        let mut join = |upper: usize, lower: usize, k: f64, c: f64, extra: &dyn Fn(f64) -> f64| {
            let s = y[upper] - y[lower];
            let force = k * s + c * (v[upper] - v[lower]) + extra(s);
            f[upper] -= force;
            f[lower] += force;
        };
        let none = |_: f64| 0.0;
        let saturation = |s: f64| self.saturation(s);
        let carrier = if a.layout.subframe { X_SF } else { X_BODY };
        join(X_WHEEL, carrier, a.k_wheel_x, a.c_wheel_x, &saturation);
        join(X_OTHER, X_BODY, a.k_wheel_x, a.c_wheel_x, &none);
        if a.layout.subframe {
            join(X_SF, X_BODY, a.k_sf_x, a.c_sf_x, &none);
        }
        match a.layout.powertrain {
            Mount::None => {}
            Mount::Body => join(X_PWT, X_BODY, a.k_pwt_x, a.c_pwt_x, &none),
            Mount::Subframe => join(X_PWT, X_SF, a.k_pwt_x, a.c_pwt_x, &none),
        }
    }

    /// Additional force of the longitudinal bushing beyond its linear travel, N.
    pub fn saturation(&self, s: f64) -> f64 {
        let other = self.laws.other.map_or(0.0, |law| law.bushing(self.axle.k_wheel_x, s));
        let Some(law) = self.laws.saturation else { return other };
        let beyond = (s.abs() - law.linear_travel).max(0.0);
        let curvature = self.axle.k_wheel_x * law.rate_increase_at_twice_travel / (2.0 * law.linear_travel);
        s.signum() * curvature * beyond * beyond
    }
}
