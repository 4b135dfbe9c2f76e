//! The tyre of a corner: its sidewall, its resonator and its relaxing branch.

use super::{BELT, COORDINATES, Corner, Forces, OTHER_LAW, Push, RESONATOR, State, TIRE_BRANCH, WHEEL};

impl Corner<'_> {
    /// Sidewall, resonator, and the state of the relaxing branch.
    pub(super) fn tire_inside(&self, y: &State, push: Push, f: &mut Forces, dy: &mut State) {
        let v = &y[COORDINATES..];
        if let Some(belt) = self.laws.belt {
            let force = belt.k_sidewall * (y[WHEEL] - y[BELT]) + belt.c_sidewall * (v[WHEEL] - v[BELT]);
            f[WHEEL] -= force;
            f[BELT] += force;
        }
        if let Some(r) = self.laws.resonator {
            let (s, rate) = (y[RESONATOR] - y[WHEEL], v[RESONATOR] - v[WHEEL]);
            let cubic = self.laws.resonator_cubic.unwrap_or(0.0) * s.powi(3);
            let force = r.k_resonator * s + cubic + r.damping() * rate;
            f[RESONATOR] -= force;
            f[WHEEL] += force;
        }
        if let Some(t) = self.laws.tire_relaxation {
            let k = (t.stiffness_ratio - 1.0) * self.axle.k_tire;
            let rate = std::f64::consts::TAU * t.relaxation_frequency;
            dy[TIRE_BRANCH] = k * push.compression_rate - rate * y[TIRE_BRANCH];
        }
        if let Some(law) = self.laws.other {
            let inner = &y[OTHER_LAW..];
            law.tire_relaxes(self.axle.k_tire, push.compression_rate, inner, &mut dy[OTHER_LAW..]);
        }
    }

    /// Force of the relaxing branch, N, positive in compression.
    pub fn tire_memory(&self, y: &State) -> f64 {
        y[TIRE_BRANCH] + self.laws.other.map_or(0.0, |law| law.tire_memory(&y[OTHER_LAW..]))
    }

    /// Force of the tyre that does not roll, N, for a compression of its tread from rest, m; positive if it pushes the
    /// ring up.
    pub fn tire_force(&self, y: &State, compression: f64, rate: f64) -> f64 {
        let whole = self.whole_tire(compression, |s| self.standing(s));
        let memory = if self.laws.rolling_only {
            0.0
        } else {
            self.tire_memory(y)
        };
        self.standing(whole) + self.axle.c_tire * rate + memory
    }

    /// Elastic force of the whole tyre that does not roll, N, for a compression from rest, m.
    fn standing(&self, compression: f64) -> f64 {
        let a = self.axle;
        let linear = a.k_tire * compression;
        if self.laws.rolling_only {
            return linear;
        }
        let growth = self.laws.tire_increase.unwrap_or(0.0) / (2.0 * a.static_tire_def);
        let other = self.laws.other.map_or(0.0, |law| law.tire(a.k_tire, compression));
        linear + a.k_tire * growth * compression * compression + other
    }

    /// The compression of the whole tyre, m, that belongs to a compression of its tread, by Newton's method. Tread and
    /// sidewalls in series have the elastic `force` that was measured for the whole tyre.
    pub fn whole_tire(&self, tread: f64, force: impl Fn(f64) -> f64) -> f64 {
        let Some(belt) = self.laws.belt else { return tread };
        let tread_of = |whole: f64| whole - force(whole) / belt.k_sidewall;
        let mut whole = tread;
        for _ in 0..20 {
            let slope = (tread_of(whole + 1e-6) - tread_of(whole)) / 1e-6;
            let missing = (tread - tread_of(whole)) / slope;
            whole += missing;
            if missing.abs() < 1e-12 {
                break;
            }
        }
        whole
    }
}

#[cfg(test)]
mod tests {
    use crate::axle::{Axle, Layout, Mount};
    use crate::corner::{Corner, STATES};
    use crate::hidden::{Hidden, Laws};

    /// Under slow compression, tread and sidewalls in series follow the law of the whole tyre.
    #[test]
    fn a_belt_leaves_the_tyre_its_static_stiffness() {
        let layout = Layout {
            top_mount: true,
            subframe: false,
            powertrain: Mount::None,
        };
        let axle = Axle::draw(layout, 1);
        let (k_sidewall, growth) = (700e3, 0.4);
        let belt = [("m_belt", 7.0), ("k_sidewall", k_sidewall), ("c_sidewall", 200.0)];
        let stiffening = [("tangent_increase_at_twice_static", growth)];
        let laws = Laws::of(&[
            Hidden::new("tire_belt", "tire", &belt),
            Hidden::new("tire_progressive_stiffness", "tire", &stiffening),
        ]);
        let corner = Corner {
            axle: &axle,
            laws: &laws,
        };
        for tread in [-4e-3, 1e-3, 5e-3] {
            let force = corner.tire_force(&[0.0; STATES], tread, 0.0);
            let whole = tread + force / k_sidewall;
            let parabola = axle.k_tire * (whole + growth / (2.0 * axle.static_tire_def) * whole * whole);
            assert!((force - parabola).abs() < 1e-3, "{force} N, not {parabola} N");
        }
    }
}
