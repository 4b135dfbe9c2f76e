//! Springs and dampers along the radii of the tyre (thesis section 2.4.3.2).
//!
//! A spring at angle φ from straight down is compressed by δ = r - ρ(φ), with the distance ρ of the first ground along
//! its radius; a straight piece of ground at distance p, with its normal at angle β, has ρ = p/cos(φ - β). The springs
//! together push with `∫ δ n dφ` against the normal `n`, which has a closed form on each piece. The dampers act on the
//! radial velocity of the wheel's centre, as in the thesis's flat-road formula.

use super::patches::{Line, candidates};
use super::sweep::Sweeps;
use super::{Change, Touch, Tyre, Wheel, against, combined, norm};
use crate::road::{Circle, Road};

/// The contact of a radial tyre.
pub(super) fn touch(tyre: &Tyre, road: &Road, wheel: &Wheel) -> Option<Touch> {
    let circle = Circle {
        centre: wheel.position,
        radius: tyre.radius,
    };
    let mut radii = Radii {
        spring: [0.0; 2],
        sweeps: Sweeps::new(tyre.radius, wheel.velocity),
    };
    radii.look(road, &circle);
    let size = norm(radii.spring) / tyre.radius;
    if size <= 0.0 {
        return None;
    }
    let deflection = tyre.radius * (1.0 - half_angle(size).cos());
    let rate = tyre.rate(deflection);
    let [growth, shrinkage] = radii.sweeps.finish();
    let change = |moment| Change {
        rate: norm(moment) * rate,
        direction: against(moment),
    };
    Some(Touch {
        deflection,
        direction: against(radii.spring),
        growth: change(growth.moment),
        shrinkage: change(shrinkage.moment),
    })
}

/// `∫ cos² φ dφ` over the contact of the unit circle with a flat road: the factor of the dampers for a vertical
/// velocity.
pub(super) fn flat_damping(deflection: f64) -> f64 {
    let angle = (1.0 - deflection).clamp(-1.0, 1.0).acos();
    angle + angle.sin() * angle.cos()
}

/// Integrals over the radii that end on the ground.
struct Radii {
    /// `∫ δ n dφ`, m.
    spring: [f64; 2],
    sweeps: Sweeps,
}

impl Radii {
    /// Scans the ground from below the centre forward, then backward: near ground hides ground farther away.
    fn look(&mut self, road: &Road, circle: &Circle) {
        let Some((first, last)) = candidates(road, circle) else {
            return;
        };
        let below = road.segment_at(circle.centre[0]);
        let mut seen = 0.0;
        for k in below..=last {
            seen = self
                .add(road, circle, k, |from, to| (from.max(seen), to))
                .map_or(seen, |(_, to)| to);
        }
        seen = 0.0;
        for k in (first..=below).rev() {
            seen = self
                .add(road, circle, k, |from, to| (from, to.min(seen)))
                .map_or(seen, |(from, _)| from);
        }
    }

    /// Adds the visible part of a piece of ground, and returns its angles.
    fn add(
        &mut self,
        road: &Road,
        circle: &Circle,
        k: usize,
        visible: impl Fn(f64, f64) -> (f64, f64),
    ) -> Option<(f64, f64)> {
        let line = Line::new(road.segment(k), circle);
        let clip = line.clip().filter(|_| line.distance > 0.0)?;
        let ([cosine, sine], _) = line.frame();
        let normal_angle = sine.atan2(cosine);
        let angle = |place: f64| normal_angle + line.ahead(place).atan2(line.distance);
        let (from, to) = visible(angle(clip.from), angle(clip.to));
        if from >= to {
            return None;
        }
        self.add_spring(circle.radius, &line, from - normal_angle, to - normal_angle);
        let rim = |angle: f64| [circle.radius * angle.sin(), -circle.radius * angle.cos()];
        self.sweeps.add(rim(from), rim(to));
        Some((from, to))
    }

    /// `∫ (r - p/cos γ) (down cos γ + along sin γ) dγ` between two angles from the normal of a line at distance p.
    fn add_spring(&mut self, radius: f64, line: &Line, from: f64, to: f64) {
        let (along, up) = line.frame();
        let down = |angle: f64| radius * angle.sin() - line.distance * angle;
        let forward = |angle: f64| line.distance * angle.cos().ln() - radius * angle.cos();
        let push = combined([forward(to) - forward(from), down(from) - down(to)], along, up);
        self.spring = [self.spring[0] + push[0], self.spring[1] + push[1]];
    }
}

/// Half angle of contact on a flat road at which the springs push with `size`: `2 (sin α - α cos α)`.
fn half_angle(size: f64) -> f64 {
    const STEPS: usize = 50;
    let mut angle = (1.5 * size).cbrt().min(std::f64::consts::PI);
    for _ in 0..STEPS {
        let (sine, cosine) = angle.sin_cos();
        let step = (2.0 * (sine - angle * cosine) - size) / (2.0 * angle * sine);
        angle -= step;
        if step.abs() <= f64::EPSILON * angle {
            break;
        }
    }
    angle
}
