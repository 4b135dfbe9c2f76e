//! The effect of bounds on a step: the scaling of Coleman & Li, and reflection.

use super::Bounds;
use super::normal::NormalEquations;
use super::region;
use nalgebra::{DMatrix, DVector};

/// A variable closer to its bound than this share of the interval (or of its size) counts as at the bound.
const BOUND_TOLERANCE: f64 = 1e-6;

/// Position of a point within its bounds, along the descent direction.
pub(super) struct Interior {
    /// Factors from scaled steps to steps: `step = factor ∘ scaled`.
    factor: DVector<f64>,
    /// Addition to the diagonal of the scaled matrix by the nearest bound.
    curvature: DVector<f64>,
    /// Distance to the bound in the descent direction, infinite without one.
    distance: DVector<f64>,
    /// Effect of a unit of each variable on the residuals; zero for a variable without influence.
    worth: DVector<f64>,
}

impl Interior {
    pub fn new(x: &DVector<f64>, normal: &NormalEquations, bounds: &Bounds) -> Self {
        let n = x.len();
        let distance = DVector::from_fn(n, |k, _| {
            if normal.gradient[k] < 0.0 {
                bounds.upper[k] - x[k]
            } else {
                x[k] - bounds.lower[k]
            }
        });
        let bounded = |k: usize| distance[k].is_finite();
        let factor = DVector::from_fn(n, |k, _| {
            let scale = normal.scale[k];
            if bounded(k) {
                (distance[k] * scale).sqrt()
            } else {
                scale
            }
        });
        let curvature = DVector::from_fn(n, |k, _| {
            if bounded(k) {
                normal.gradient[k].abs() * normal.scale[k]
            } else {
                0.0
            }
        });
        Self {
            factor,
            curvature,
            distance,
            worth: normal.largest.clone(),
        }
    }

    /// Largest cosine between the residual and a column, reduced if a bound is close in the descent direction.
    pub fn optimality(&self, normal: &NormalEquations, cost: f64) -> f64 {
        let length = (2.0 * cost).sqrt();
        if length == 0.0 {
            return 0.0;
        }
        let cosine = |k: usize| (normal.gradient[k] * normal.scale[k]).abs() / length;
        let room = |k: usize| (self.distance[k] / (normal.scale[k] * length)).min(1.0);
        (0..self.worth.len()).map(|k| cosine(k) * room(k)).fold(0.0, f64::max)
    }

    /// Length of the start in scaled variables: a first step may change a variable by its own size.
    pub fn first_radius(&self, x: &DVector<f64>) -> f64 {
        let seen = |k: &usize| self.worth[*k] > 0.0;
        let length = (0..x.len())
            .filter(seen)
            .map(|k| (x[k] / self.factor[k]).powi(2))
            .sum::<f64>()
            .sqrt();
        if length > 0.0 { length } else { 1.0 }
    }

    /// Length of a vector, with components weighted by their effect on the residuals.
    pub fn scaled_length(&self, vector: &DVector<f64>) -> f64 {
        vector.component_mul(&self.worth).norm()
    }
}

/// The quadratic model of the cost in scaled variables.
pub(super) struct Model<'a> {
    interior: &'a Interior,
    matrix: DMatrix<f64>,
    gradient: DVector<f64>,
}

/// A step that stays strictly inside the bounds.
pub(super) struct Step {
    pub step: DVector<f64>,
    pub scaled: DVector<f64>,
    /// Predicted reduction of the cost.
    pub predicted: f64,
}

impl<'a> Model<'a> {
    pub fn new(interior: &'a Interior, normal: &NormalEquations) -> Self {
        let factor = &interior.factor;
        let n = factor.len();
        let mut matrix = DMatrix::from_fn(n, n, |i, j| factor[i] * normal.matrix[(i, j)] * factor[j]);
        for k in 0..n {
            matrix[(k, k)] += interior.curvature[k];
        }
        Self {
            interior,
            matrix,
            gradient: normal.gradient.component_mul(factor),
        }
    }

    /// The best of the trust-region step cut at the bounds, its reflection, and steepest descent.
    pub fn step(&self, x: &DVector<f64>, bounds: &Bounds, radius: f64, optimality: f64) -> Step {
        let newton = region::step(&self.matrix, &self.gradient, radius);
        let full = self.unscale(&newton);
        let (reach, hits) = reach(x, &full, bounds);
        if reach > 1.0 {
            return self.finish(newton);
        }
        // Keeps a small distance from the bounds, which decreases as the search converges.
        let inside = (1.0 - optimality).max(0.995);
        let cut = &newton * (reach * inside);
        let reflected = self.reflect(x, bounds, radius, inside, &(&newton * reach), &hits);
        let descent = self.along(&DVector::zeros(x.len()), &-&self.gradient, x, bounds, radius, inside);
        [Some(cut), reflected, descent]
            .into_iter()
            .flatten()
            .map(|scaled| self.finish(scaled))
            .reduce(|best, other| if other.predicted > best.predicted { other } else { best })
            .expect("the cut step is always there")
    }

    fn reflect(
        &self,
        x: &DVector<f64>,
        bounds: &Bounds,
        radius: f64,
        inside: f64,
        to_bound: &DVector<f64>,
        hits: &[bool],
    ) -> Option<DVector<f64>> {
        let direction = DVector::from_fn(x.len(), |k, _| if hits[k] { -to_bound[k] } else { to_bound[k] });
        self.along(
            to_bound,
            &direction,
            &(x + self.unscale(to_bound)),
            bounds,
            radius,
            inside,
        )
        // A point that is still at the bound is moved inside, towards the previous point.
        .map(|scaled| scaled * inside)
    }

    /// The minimum of the model on the ray `origin + t direction`, within trust region and bounds.
    fn along(
        &self,
        origin: &DVector<f64>,
        direction: &DVector<f64>,
        x: &DVector<f64>,
        bounds: &Bounds,
        radius: f64,
        inside: f64,
    ) -> Option<DVector<f64>> {
        let (to_bound, _) = reach(x, &self.unscale(direction), bounds);
        let longest = (inside * to_bound).min(to_radius(origin, direction, radius));
        if longest.is_nan() || longest <= 0.0 {
            return None;
        }
        let slope = direction.dot(&(&self.gradient + &self.matrix * origin));
        let curvature = direction.dot(&(&self.matrix * direction));
        let minimum = if curvature > 0.0 {
            (-slope / curvature).clamp(0.0, longest)
        } else {
            longest
        };
        Some(origin + direction * minimum)
    }

    fn unscale(&self, scaled: &DVector<f64>) -> DVector<f64> {
        self.interior.factor.component_mul(scaled)
    }

    fn finish(&self, scaled: DVector<f64>) -> Step {
        let predicted = -(self.gradient.dot(&scaled) + 0.5 * scaled.dot(&(&self.matrix * &scaled)));
        Step {
            step: self.unscale(&scaled),
            scaled,
            predicted,
        }
    }
}

/// True if a step crosses no bound.
pub(super) fn stays_inside(x: &DVector<f64>, step: &DVector<f64>, bounds: &Bounds) -> bool {
    reach(x, step, bounds).0 > 1.0
}

/// Largest multiple of `direction` before the first bound, and the variables that reach theirs there.
fn reach(x: &DVector<f64>, direction: &DVector<f64>, bounds: &Bounds) -> (f64, Vec<bool>) {
    let times = |k: usize| match direction[k] {
        d if d > 0.0 => (bounds.upper[k] - x[k]) / d,
        d if d < 0.0 => (bounds.lower[k] - x[k]) / d,
        _ => f64::INFINITY,
    };
    let all: Vec<f64> = (0..x.len()).map(times).collect();
    let first = all.iter().copied().fold(f64::INFINITY, f64::min);
    (first, all.iter().map(|&t| t == first).collect())
}

/// Largest multiple of `direction` from `origin` within the trust region.
fn to_radius(origin: &DVector<f64>, direction: &DVector<f64>, radius: f64) -> f64 {
    let (a, b) = (direction.norm_squared(), origin.dot(direction));
    let c = origin.norm_squared() - radius * radius;
    (-b + (b * b - a * c).max(0.0).sqrt()) / a
}

/// The nearest point that is not at any bound, so that the scaling is defined there.
pub(super) fn strictly_inside(start: &[f64], bounds: &Bounds) -> DVector<f64> {
    let offset = 1e-10;
    DVector::from_fn(start.len(), |k, _| {
        let (lower, upper) = (bounds.lower[k], bounds.upper[k]);
        let margin = (offset * start[k].abs().max(1e-300)).min(0.25 * (upper - lower));
        let margin = if (upper - lower).is_finite() {
            margin.max(offset * (upper - lower))
        } else {
            margin
        };
        start[k].clamp(lower + margin, upper - margin)
    })
}

/// Corrects rounding, which must not move a step onto or beyond its bound.
pub(super) fn within(x: &DVector<f64>, bounds: &Bounds) -> DVector<f64> {
    DVector::from_fn(x.len(), |k, _| {
        x[k].clamp(bounds.lower[k].next_up(), bounds.upper[k].next_down())
    })
}

/// The bound at which each variable is: close to it, with the descent direction towards it.
pub(super) fn at_bound(x: &DVector<f64>, bounds: &Bounds, normal: &NormalEquations) -> Vec<i8> {
    let near = |gap: f64, k: usize| {
        let width = bounds.upper[k] - bounds.lower[k];
        gap <= BOUND_TOLERANCE * if width.is_finite() { width } else { x[k].abs().max(1.0) }
    };
    // On a range of many decades, the whole lower part would be close to the lower end relative to the width.
    let is_low = |k: usize| bounds.lower[k] <= 0.0 || x[k] < 2.0 * bounds.lower[k];
    (0..x.len())
        .map(|k| match normal.gradient[k] {
            g if g > 0.0 && near(x[k] - bounds.lower[k], k) && is_low(k) => -1,
            g if g < 0.0 && near(bounds.upper[k] - x[k], k) => 1,
            _ => 0,
        })
        .collect()
}
