//! The effective road of a tandem of elliptical cams: a tyre law that differs from the area of overlap.

use crate::axle::Axle;
use crate::hardware::Cams;
use crate::road::{Road, SPACING};

/// Effective height and slope of a road, every [`SPACING`] along it.
pub struct EffectiveRoad {
    height: Vec<f64>,
    slope: Vec<f64>,
}

impl EffectiveRoad {
    /// Rolls the cams of an axle's tyre over a road.
    pub fn new(road: &Road, axle: &Axle, cams: Cams) -> Self {
        let lowest = cam_heights(road, axle.r_tire, cams);
        let contact = 2.0 * (2.0 * axle.r_tire * axle.static_tire_def - axle.static_tire_def.powi(2)).sqrt();
        let half = (0.5 * cams.apart * contact / SPACING).round() as usize;
        let cam = |i: usize| (lowest[i.saturating_sub(half)], lowest[(i + half).min(lowest.len() - 1)]);
        let of_point = |i: usize| {
            let (rear, front) = cam(i);
            (0.5 * (front + rear), (front - rear) / (2.0 * half as f64 * SPACING))
        };
        let (height, slope) = (0..lowest.len()).map(of_point).unzip();
        Self { height, slope }
    }

    /// Effective height, m, its derivative along the road, and the slope of the effective plane, at a position on the
    /// road, m.
    pub fn at(&self, x: f64) -> [f64; 3] {
        let place = (x / SPACING).clamp(0.0, (self.height.len() - 2) as f64);
        let (i, part) = (place as usize, place.fract());
        let between = |values: &[f64]| values[i] + (values[i + 1] - values[i]) * part;
        let growth = (self.height[i + 1] - self.height[i]) / SPACING;
        [between(&self.height), growth, between(&self.slope)]
    }
}

/// The height, m, by which an ellipse rests higher than on flat ground, with its centre above each point of the road.
fn cam_heights(road: &Road, radius: f64, cams: Cams) -> Vec<f64> {
    let (length, height) = (cams.length * radius, cams.height * radius);
    let reach = (length / SPACING) as usize;
    let clearance: Vec<f64> = (0..=reach)
        .map(|k| k as f64 * SPACING / length)
        .map(|u| height * (1.0 - (1.0 - u.powf(cams.order)).powf(1.0 / cams.order)))
        .collect();
    let end = road.z.len() - 1;
    (0..=end)
        .map(|i| {
            let (from, to) = (i.saturating_sub(reach), (i + reach).min(end));
            let rests_on = |k: usize| road.z[k] - clearance[k.abs_diff(i)];
            (from..=to).map(rests_on).fold(f64::NEG_INFINITY, f64::max)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::axle::{Layout, Mount};

    /// An ellipse that meets a step rests on the step's edge. By the ellipse's equation the step then lifts it by
    /// the step's height less `1 - (1 - u^c)^(1/c)` of the ellipse's half height.
    #[test]
    fn a_cam_climbs_a_step_by_its_own_equation() {
        let axle = Axle::draw(
            Layout {
                top_mount: true,
                subframe: false,
                powertrain: Mount::None,
            },
            1,
        );
        let (step, start) = (0.02, 1000);
        let road = Road {
            z: (0..3000).map(|i| if i < start { 0.0 } else { step }).collect(),
            slope: Vec::new(),
        };
        let cams = Cams {
            length: 1.0,
            height: 0.9,
            order: 2.0,
            apart: 0.8,
        };
        let lowest = cam_heights(&road, axle.r_tire, cams);
        for ahead in [10, 50, 80] {
            let u = ahead as f64 * SPACING / axle.r_tire;
            let expected = step - 0.9 * axle.r_tire * (1.0 - (1.0 - u * u).sqrt());
            assert!((lowest[start - ahead] - expected.max(0.0)).abs() < 1e-12);
        }
        let felt = EffectiveRoad::new(&road, &axle, cams);
        assert_eq!(felt.at(0.3), [0.0; 3]);
        let [height, growth, slope] = felt.at(2.2);
        assert!((height - step).abs() < 1e-12 && growth.abs() < 1e-12 && slope.abs() < 1e-12);
        let [height, _, slope] = felt.at(1.0);
        assert!((0.4 * step..step).contains(&height) && slope > 0.0);
    }
}
