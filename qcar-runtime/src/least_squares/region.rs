//! The step that minimises `gᵀp + ½ pᵀBp` within `‖p‖ ≤ radius`, for a positive semidefinite B.

use nalgebra::{DMatrix, DVector};

/// Relative tolerance of the length of a step on the boundary; a smaller one would be wasted on an approximate model.
const LENGTH_TOLERANCE: f64 = 0.1;

/// Most Newton steps for the damping; it converges in a few.
const DAMPING_STEPS: usize = 20;

/// The undamped step if it is inside, otherwise `p = -(B + αI)⁻¹g` with the damping α that puts it on the boundary.
///
/// Moré & Sorensen, "Computing a trust region step", SIAM J. Sci. Stat. Comput. 4 (1983); since B is positive
/// semidefinite, its hard case cannot occur.
pub(super) fn step(b: &DMatrix<f64>, g: &DVector<f64>, radius: f64) -> DVector<f64> {
    let steepest = g.norm() / radius;
    let undamped = damped(b, g, 0.0);
    if let Some(trial) = &undamped
        && trial.step.norm() <= radius
    {
        return trial.step.clone();
    }
    // At this damping no step is longer than the radius, for any B.
    let (mut low, mut high) = (0.0, steepest);
    let mut damping = undamped.map_or(1e-3 * steepest, |trial| trial.newton(radius));
    let mut best = DVector::zeros(g.len());
    for _ in 0..DAMPING_STEPS {
        if !(damping > low && damping < high) {
            damping = (0.001 * high).max((low * high).sqrt());
        }
        let Some(trial) = damped(b, g, damping) else {
            low = damping;
            damping = high;
            continue;
        };
        let length = trial.step.norm();
        if length > radius {
            low = damping
        } else {
            high = damping
        }
        damping = trial.newton(radius);
        best = trial.step;
        if (length - radius).abs() <= LENGTH_TOLERANCE * radius {
            break;
        }
    }
    shorten(best, radius)
}

struct Damped {
    step: DVector<f64>,
    damping: f64,
    /// `pᵀ(B + αI)⁻¹p`, which is half the slope of `-‖p‖²`.
    curvature: f64,
}

impl Damped {
    /// Newton's next damping for `1/‖p(α)‖ = 1/radius`, which is nearly linear in α.
    fn newton(&self, radius: f64) -> f64 {
        let length = self.step.norm();
        self.damping + (length / radius - 1.0) * length * length / self.curvature
    }
}

fn damped(b: &DMatrix<f64>, g: &DVector<f64>, damping: f64) -> Option<Damped> {
    let mut shifted = b.clone();
    for k in 0..g.len() {
        shifted[(k, k)] += damping;
    }
    let factor = shifted.cholesky()?;
    let step = -factor.solve(g);
    let curvature = step.dot(&factor.solve(&step));
    (step.iter().all(|value| value.is_finite()) && curvature > 0.0).then_some(Damped {
        step,
        damping,
        curvature,
    })
}

fn shorten(step: DVector<f64>, radius: f64) -> DVector<f64> {
    let length = step.norm();
    if length > radius {
        step * (radius / length)
    } else {
        step
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn problem() -> (DMatrix<f64>, DVector<f64>) {
        let j = DMatrix::from_row_slice(3, 2, &[1.0, 2.0, 0.5, -1.0, 3.0, 0.1]);
        (j.transpose() * &j, DVector::from_column_slice(&[1.0, -2.0]))
    }

    #[test]
    fn a_wide_region_gives_the_newton_step() {
        let (b, g) = problem();
        let p = step(&b, &g, 1e3);
        assert!((&b * p + g).norm() < 1e-12);
    }

    #[test]
    fn a_narrow_region_gives_a_step_of_its_radius_along_a_damped_direction() {
        let (b, g) = problem();
        let p = step(&b, &g, 0.05);
        assert!((p.norm() / 0.05 - 1.0).abs() <= LENGTH_TOLERANCE);
        let residual = &b * &p + &g;
        let alignment = -residual.dot(&p) / (residual.norm() * p.norm());
        assert!(
            alignment > 0.99,
            "the border step satisfies (B + αI) p = -g but for its length: {alignment}"
        );
    }

    #[test]
    fn a_direction_that_nothing_sees_is_not_walked() {
        let b = DMatrix::from_row_slice(2, 2, &[4.0, 0.0, 0.0, 0.0]);
        let p = step(&b, &DVector::from_column_slice(&[1.0, 0.0]), 10.0);
        assert!((p[0] + 0.25).abs() < 0.03 && p[1] == 0.0, "{p}");
    }
}
