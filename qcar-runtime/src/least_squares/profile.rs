//! Profiles: the smallest cost over the other variables for fixed values of one variable, and the interval in which it
//! rises by less than a threshold.
//!
//! Raue et al., "Structural and practical identifiability analysis of partially observed dynamical models by exploiting
//! the profile likelihood", Bioinformatics 25 (2009). An end is open if the threshold is not reached within the bounds:
//! the residuals do not determine the variable on that side.

use super::held::Held;
use super::{Bounds, Options, Outcome, Problem, minimize};

/// The variable to profile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Profiled {
    /// Position of the variable.
    pub variable: usize,
    /// Rise of `½ ‖r‖²` at an end of the interval.
    pub rise: f64,
    /// First step away from the minimum, in the unit of the variable.
    pub step: f64,
}

/// Smallest cost along a variable.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    /// Values of the variable, ascending, with the rise of `½ ‖r‖²` there.
    pub points: Vec<[f64; 2]>,
    /// Ends of the interval below and above the minimum; `None` if the threshold is not reached.
    pub ends: [Option<f64>; 2],
}

/// Most steps to either side, and most evaluations for an end.
const STEPS: usize = 40;
const EVALUATIONS: usize = 20;
/// Relative tolerance of the distance of an end from the minimum.
const CLOSE: f64 = 1e-3;
/// A step is doubled if it raises the cost by less than the first share of the threshold, and halved if by more than
/// the second.
const SHARES: [f64; 2] = [0.1, 0.4];

/// Steps from the minimum to both ends. The search for the other variables starts from the previous step.
pub fn profile<P: Problem + ?Sized>(
    problem: &mut P,
    minimum: &Outcome,
    bounds: &Bounds,
    of: Profiled,
    options: &Options,
) -> Profile {
    let mut walk = Walk {
        problem,
        minimum,
        bounds,
        of,
        options,
        points: vec![[minimum.x[of.variable], 0.0]],
    };
    let ends = [walk.end(-1.0), walk.end(1.0)];
    let mut points = walk.points;
    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    Profile { points, ends }
}

struct Walk<'a, P: ?Sized> {
    problem: &'a mut P,
    minimum: &'a Outcome,
    bounds: &'a Bounds,
    of: Profiled,
    options: &'a Options,
    points: Vec<[f64; 2]>,
}

/// A point of the profile: the fixed variable, the others, and the rise.
#[derive(Clone)]
struct Place {
    value: f64,
    others: Vec<f64>,
    rise: f64,
}

impl<P: Problem + ?Sized> Walk<'_, P> {
    fn end(&mut self, side: f64) -> Option<f64> {
        let bound = match side < 0.0 {
            true => self.bounds.lower[self.of.variable],
            false => self.bounds.upper[self.of.variable],
        };
        let minimum = self.minimum;
        let mut step = self.of.step;
        let mut here = Place {
            value: minimum.x[self.of.variable],
            others: self.held(minimum.x[self.of.variable]).varied_of(&minimum.x),
            rise: 0.0,
        };
        for _ in 0..STEPS {
            let value = here.value + side * step;
            let is_last = side * (value - bound) >= 0.0;
            let next = self.at(if is_last { bound } else { value }, &here.others);
            if next.rise >= self.of.rise {
                return Some(self.between(here, next));
            }
            if is_last {
                return None;
            }
            let gained = (next.rise - here.rise) / self.of.rise;
            if gained < SHARES[0] {
                step *= 2.0;
            } else if gained > SHARES[1] {
                step *= 0.5;
            }
            here = next;
        }
        None
    }

    /// The root of rise minus threshold: false position on square roots, in which a quadratic rise is linear, and
    /// bisection if that stagnates.
    fn between(&mut self, mut below: Place, mut above: Place) -> f64 {
        let start = self.minimum.x[self.of.variable];
        for evaluation in 0..EVALUATIONS {
            if (above.value - below.value).abs() <= CLOSE * (above.value - start).abs() {
                break;
            }
            let [low, wanted, high] = [below.rise, self.of.rise, above.rise].map(|rise| rise.max(0.0).sqrt());
            let part = if high.is_finite() && evaluation % 3 < 2 {
                (wanted - low) / (high - low)
            } else {
                0.5
            };
            let value = below.value + part * (above.value - below.value);
            let middle = self.at(value, &below.others);
            if (middle.rise / self.of.rise - 1.0).abs() < CLOSE {
                return middle.value;
            }
            if middle.rise >= self.of.rise {
                above = middle;
            } else {
                below = middle;
            }
        }
        0.5 * (below.value + above.value)
    }

    /// The problem with the variable fixed.
    fn held(&mut self, value: f64) -> Held<'_, P> {
        let mut x = self.minimum.x.clone();
        x[self.of.variable] = value;
        let mut is_held = vec![false; x.len()];
        is_held[self.of.variable] = true;
        Held::new(self.problem, x, &is_held)
    }

    /// Smallest cost with the variable fixed; infinite if there is none.
    fn at(&mut self, value: f64, others: &[f64]) -> Place {
        let (bounds, options) = (self.bounds, self.options);
        let mut held = self.held(value);
        let bounds = held.bounds(bounds);
        let found = minimize(&mut held, others, &bounds, options);
        let rise = found.cost - self.minimum.cost;
        let rise = if rise.is_nan() { f64::INFINITY } else { rise };
        if rise.is_finite() {
            self.points.push([value, rise]);
        }
        Place {
            value,
            others: found.x,
            rise,
        }
    }
}
