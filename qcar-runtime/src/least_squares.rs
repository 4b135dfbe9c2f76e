//! Bounded nonlinear least squares with an analytic Jacobian.
//!
//! Minimises `½ ‖r(x)‖²` over `lower ≤ x ≤ upper` by the trust-region reflective method: the interior Newton-like
//! steps of Branch, Coleman & Li, "A subspace, interior, and conjugate gradient method for large-scale
//! bound-constrained minimization problems", SIAM J. Sci. Comput. 21 (1999), with the Gauss-Newton matrix in place
//! of the Hessian. Variables are scaled by the largest norm that their Jacobian column ever had (Moré, "The
//! Levenberg-Marquardt algorithm: implementation and theory", 1978), so units do not matter.

// JᵀJ and Jᵀr, the one part whose cost grows with the number of residuals.
mod normal;
// The step that minimises the quadratic model within the trust region.
mod region;
// Reflection of a step at the bounds.
mod reflect;
// A problem with some variables fixed.
mod held;

// Covariance and rank from the Jacobian at the optimum.
pub mod information;
// Profile of the cost over one parameter, with all others refitted.
pub mod profile;

use held::Held;
use nalgebra::{DMatrix, DVector};
use normal::NormalEquations;
pub(crate) use normal::gram;
use reflect::{Interior, Model, Step};

/// Residuals and their Jacobian.
pub trait Problem {
    /// Number of variables.
    fn variables(&self) -> usize;

    /// Number of residuals.
    fn residuals(&self) -> usize;

    /// Writes `r(x)` and its Jacobian, column after column: `jacobian[column * residuals + row]`.
    ///
    /// Both at once, since nearly every step is accepted and most models share work between them.
    fn evaluate(&mut self, x: &[f64], residual: &mut [f64], jacobian: &mut [f64]);

    /// Writes `r(x)` alone and returns true, if that is much cheaper. A refused step, or the last one, then needs no
    /// Jacobian.
    fn evaluate_residual(&mut self, _x: &[f64], _residual: &mut [f64]) -> bool {
        false
    }
}

/// An interval for each variable, infinite without a bound. Each lower bound is below its upper bound.
#[derive(Clone, Debug, PartialEq)]
pub struct Bounds {
    /// Lower ends.
    pub lower: Vec<f64>,
    /// Upper ends.
    pub upper: Vec<f64>,
}

impl Bounds {
    /// No bounds.
    pub fn none(variables: usize) -> Self {
        Self {
            lower: vec![f64::NEG_INFINITY; variables],
            upper: vec![f64::INFINITY; variables],
        }
    }
}

/// Stopping criteria. Every tolerance is relative and does not depend on units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Largest cosine between the residual and the Jacobian column of a free variable.
    pub gradient: f64,
    /// Predicted and actual reduction of the cost, relative to the cost.
    pub cost: f64,
    /// Length of the step relative to the length of `x`, both in scaled variables.
    pub step: f64,
    /// Reduction of the cost that a full Gauss-Newton step predicts: half the squared Newton decrement (Boyd and
    /// Vandenberghe, "Convex Optimization", section 9.5.1). If the residuals are in standard deviations, no variable is
    /// further than `sqrt(2 decrement)` standard errors from the minimum. A step beyond a bound does not count, because
    /// which variables end at their bounds is part of the result. Zero switches the test off.
    pub decrement: f64,
    /// Most evaluations of the residual.
    pub evaluations: usize,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            gradient: 1e-8,
            cost: 1e-10,
            step: 1e-8,
            decrement: 0.0,
            evaluations: 200,
        }
    }
}

/// Stopping reason.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Stop {
    /// The residual is orthogonal to all changes by the free variables: a stationary point.
    Gradient,
    /// The cost no longer decreases.
    Cost,
    /// The step no longer changes the variables.
    Step,
    /// There are no variables.
    NothingToFit,
    /// The limit of evaluations was reached before convergence.
    Evaluations,
    /// The residual or its Jacobian is not finite, at the start or at every attempted step.
    NotFinite,
}

impl Stop {
    /// True if the search ended at a minimum within its tolerances.
    pub fn converged(self) -> bool {
        matches!(self, Stop::Gradient | Stop::Cost | Stop::Step | Stop::NothingToFit)
    }

    /// The reason as a sentence.
    pub fn sentence(self) -> &'static str {
        match self {
            Stop::Gradient => "the gradient vanished",
            Stop::Cost => "the cost no longer decreased",
            Stop::Step => "the step became too small to change the parameters",
            Stop::NothingToFit => "no parameter was free",
            Stop::Evaluations => "it did not converge within the allowed evaluations",
            Stop::NotFinite => "the model returned a value that is not finite",
        }
    }
}

/// Result of a search.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// The variables, within their bounds.
    pub x: Vec<f64>,
    /// `½ ‖r‖²` at these variables.
    pub cost: f64,
    /// `½ ‖r‖²` at the start.
    pub start_cost: f64,
    /// Residual at these variables.
    pub residual: DVector<f64>,
    /// Jacobian at these variables; if the evaluations were used up, possibly that of the point before.
    pub jacobian: DMatrix<f64>,
    /// For each variable: −1 at its lower bound, +1 at its upper bound, 0 between.
    pub at_bound: Vec<i8>,
    /// Stopping reason.
    pub stop: Stop,
    /// Number of evaluations of residual and Jacobian.
    pub evaluations: usize,
    /// Number of steps.
    pub iterations: usize,
}

/// Searches for a local minimum from `start`, which is moved into the bounds first.
pub fn minimize<P: Problem + ?Sized>(problem: &mut P, start: &[f64], bounds: &Bounds, options: &Options) -> Outcome {
    let mut search = Search::new(problem, start, bounds);
    let stop = search.run(options);
    search.finish(stop)
}

/// As [`minimize`], with some variables held at their start. The result is that for all variables.
pub fn minimize_holding<P: Problem + ?Sized>(
    problem: &mut P,
    start: &[f64],
    is_held: &[bool],
    bounds: &Bounds,
    options: &Options,
) -> Outcome {
    let mut held = Held::new(problem, start.to_vec(), is_held);
    let (start, bounds) = (held.varied_of(start), held.bounds(bounds));
    let found = minimize(&mut held, &start, &bounds, options);
    held.outcome(found)
}

/// A point with its residual and Jacobian.
struct Point {
    x: DVector<f64>,
    residual: DVector<f64>,
    jacobian: DMatrix<f64>,
    cost: f64,
    /// True if the Jacobian is that of this point.
    is_linearised: bool,
}

impl Point {
    fn new(variables: usize, residuals: usize) -> Self {
        Self {
            x: DVector::zeros(variables),
            residual: DVector::zeros(residuals),
            jacobian: DMatrix::zeros(residuals, variables),
            cost: f64::NAN,
            is_linearised: false,
        }
    }

    fn evaluate<P: Problem + ?Sized>(&mut self, problem: &mut P) {
        problem.evaluate(
            self.x.as_slice(),
            self.residual.as_mut_slice(),
            self.jacobian.as_mut_slice(),
        );
        self.cost = 0.5 * self.residual.norm_squared();
        self.is_linearised = true;
    }

    /// Evaluates the residual, and the Jacobian if both are computed together.
    fn look<P: Problem + ?Sized>(&mut self, problem: &mut P) {
        if problem.evaluate_residual(self.x.as_slice(), self.residual.as_mut_slice()) {
            self.cost = 0.5 * self.residual.norm_squared();
            self.is_linearised = false;
        } else {
            self.evaluate(problem);
        }
    }
}

/// State of a search. `trial` is a second point, so that a rejected step needs no allocation.
struct Search<'a, P: ?Sized> {
    problem: &'a mut P,
    bounds: &'a Bounds,
    here: Point,
    trial: Point,
    normal: NormalEquations,
    start_cost: f64,
    radius: f64,
    evaluations: usize,
    iterations: usize,
}

impl<'a, P: Problem + ?Sized> Search<'a, P> {
    fn new(problem: &'a mut P, start: &[f64], bounds: &'a Bounds) -> Self {
        let (n, m) = (problem.variables(), problem.residuals());
        let mut here = Point::new(n, m);
        here.x = reflect::strictly_inside(start, bounds);
        here.evaluate(problem);
        let start_cost = here.cost;
        let normal = NormalEquations::new(n);
        Self {
            problem,
            bounds,
            here,
            trial: Point::new(n, m),
            normal,
            start_cost,
            radius: 0.0,
            evaluations: 1,
            iterations: 0,
        }
    }

    fn run(&mut self, options: &Options) -> Stop {
        if self.here.x.is_empty() {
            return Stop::NothingToFit;
        }
        if !self.normal.assemble(&self.here.jacobian, &self.here.residual) {
            return Stop::NotFinite;
        }
        loop {
            let interior = Interior::new(&self.here.x, &self.normal, self.bounds);
            let optimality = interior.optimality(&self.normal, self.here.cost);
            if optimality <= options.gradient || self.is_within(options.decrement) {
                return Stop::Gradient;
            }
            if self.iterations == 0 {
                self.radius = interior.first_radius(&self.here.x);
            }
            if let Some(stop) = self.iterate(&interior, optimality, options) {
                return stop;
            }
            self.iterations += 1;
        }
    }

    /// Shrinks the trust region until a step lowers the cost, then takes it.
    fn iterate(&mut self, interior: &Interior, optimality: f64, options: &Options) -> Option<Stop> {
        let model = Model::new(interior, &self.normal);
        loop {
            if self.evaluations >= options.evaluations {
                return Some(Stop::Evaluations);
            }
            let step = model.step(&self.here.x, self.bounds, self.radius, optimality);
            self.try_step(&step);
            let cost = self.here.cost;
            let reduction = cost - self.trial.cost;
            let lower = reduction > 0.0;
            let accepted = lower && self.accept(options);
            let usable = accepted || (!lower && reduction.is_finite());
            let reduction = if usable { reduction } else { f64::NEG_INFINITY };
            let settled = self.settled(&step, interior, cost, reduction, options);
            self.adapt_radius(&step, reduction);
            if accepted {
                return settled;
            }
            if let Some(stop) = settled {
                return Some(if usable { stop } else { Stop::NotFinite });
            }
        }
    }

    /// Moves to the trial point, unless its linearisation is not finite.
    fn accept(&mut self, options: &Options) -> bool {
        std::mem::swap(&mut self.here, &mut self.trial);
        if !self.here.is_linearised && self.evaluations >= options.evaluations {
            // No step can follow from here.
            std::mem::swap(&mut self.here.jacobian, &mut self.trial.jacobian);
            return true;
        }
        if !self.here.is_linearised {
            self.here.evaluate(self.problem);
        }
        let finite = self.normal.assemble(&self.here.jacobian, &self.here.residual);
        if !finite {
            std::mem::swap(&mut self.here, &mut self.trial);
            self.normal.assemble(&self.here.jacobian, &self.here.residual);
        }
        finite
    }

    fn try_step(&mut self, step: &Step) {
        self.trial.x = reflect::within(&(&self.here.x + &step.step), self.bounds);
        self.trial.look(self.problem);
        self.evaluations += 1;
    }

    /// The tests of Moré (1978), section 8, on the predicted and the actual reduction.
    fn settled(&self, step: &Step, interior: &Interior, cost: f64, reduction: f64, options: &Options) -> Option<Stop> {
        let ratio = reduction / step.predicted;
        if reduction.abs() <= options.cost * cost && step.predicted <= options.cost * cost && ratio <= 2.0 {
            return Some(Stop::Cost);
        }
        let length = interior.scaled_length(&step.step);
        (length <= options.step * (options.step + interior.scaled_length(&self.here.x))).then_some(Stop::Step)
    }

    fn adapt_radius(&mut self, step: &Step, reduction: f64) {
        let ratio = reduction / step.predicted;
        let length = step.scaled.norm();
        if ratio.is_nan() || ratio < 0.25 {
            self.radius = 0.25 * length;
        } else if ratio > 0.75 && length > 0.95 * self.radius {
            self.radius *= 2.0;
        }
    }

    /// True if a full Gauss-Newton step stays within the bounds and predicts a smaller reduction than this.
    fn is_within(&self, decrement: f64) -> bool {
        let step = if decrement > 0.0 { self.normal.newton() } else { None };
        step.is_some_and(|step| {
            -0.5 * self.normal.gradient.dot(&step) < decrement
                && reflect::stays_inside(&self.here.x, &step, self.bounds)
        })
    }

    fn finish(self, stop: Stop) -> Outcome {
        let at_bound = reflect::at_bound(&self.here.x, self.bounds, &self.normal);
        Outcome {
            x: self.here.x.as_slice().to_vec(),
            cost: self.here.cost,
            start_cost: self.start_cost,
            residual: self.here.residual,
            jacobian: self.here.jacobian,
            at_bound,
            stop,
            evaluations: self.evaluations,
            iterations: self.iterations,
        }
    }
}
