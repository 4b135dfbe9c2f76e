//! Profile intervals of a fit: the range of each parameter in which the posterior, maximised over all others, stays
//! above the limit that chance allows.
//!
//! The rise of the cost is in units of the fit's own standard error near the maximum, as in the
//! [profiles](crate::fit::profile) of a linear fit. The prior of the profiled parameter is left out, so that the data
//! alone determine the ends.

use super::problem::Posterior;
use super::refit::Refit;
use super::search::options;
use crate::campaign::Role;
use crate::discover::observe::Evidence;
use crate::fit::profile::{CHANCE, ParameterProfile, QUANTILE};
use crate::least_squares::profile::{Profiled, profile};
use crate::least_squares::{Options, Problem, minimize};
use crate::model::Model;

/// Options of the searches over the other variables, which converge as far as numbers allow.
const OPTIONS: Options = options(0.0, 20);
/// First step without a standard error, relative to the range.
const FIRST: f64 = 0.02;

impl Refit {
    /// The fitted part of the evidence: the fitted runs without the non-steady part of their sweeps.
    pub fn fitted_of(&self, evidence: &Evidence) -> Evidence {
        let steady = evidence.minus(&self.unsteady);
        steady.only(|run| steady.runs[run].role == Role::Fit)
    }

    /// Profile of a free parameter, by its position among these, for the fitted `model` and the
    /// [fitted](Self::fitted_of) evidence.
    pub fn profile(&self, model: &dyn Model, fitted: &Evidence, free: usize) -> ParameterProfile {
        let mut posterior = Posterior::of(self, model, fitted);
        let (start, bounds) = (posterior.place(self), posterior.bounds());
        posterior.start.clone_from(&start);
        let row = posterior.residuals + posterior.sigmas.len() + free;
        let mut problem = WithoutPrior {
            posterior,
            row,
            variable: free,
        };
        let minimum = minimize(&mut problem, &start, &bounds, &OPTIONS);
        let (error, variance) = (self.stderr()[free], self.covariance[(free, free)]);
        let inflation = error * error / variance;
        let unit = 0.5
            * if inflation.is_finite() {
                inflation
            } else {
                self.scatter()
            };
        let width = bounds.upper[free] - bounds.lower[free];
        let of = Profiled {
            variable: free,
            rise: QUANTILE * unit,
            step: if error.is_finite() {
                error.min(width)
            } else {
                FIRST * width
            },
        };
        let found = profile(&mut problem, &minimum, &bounds, of, &OPTIONS);
        let least = found.points.iter().min_by(|a, b| a[1].total_cmp(&b[1]));
        let parameter = &model.about().parameters[self.free[free].parameter];
        ParameterProfile {
            name: parameter.name.to_string(),
            unit: parameter.unit.to_string(),
            value: minimum.x[free],
            interval: found.ends,
            lower_at: least.filter(|least| least[1] < -CHANCE * unit).map(|least| least[0]),
            points: found.points.iter().map(|[value, rise]| [*value, rise / unit]).collect(),
        }
    }
}

/// A posterior without the prior of one parameter.
struct WithoutPrior<'a> {
    posterior: Posterior<'a>,
    /// Residual row of that prior.
    row: usize,
    variable: usize,
}

impl Problem for WithoutPrior<'_> {
    fn variables(&self) -> usize {
        self.posterior.variables()
    }

    fn residuals(&self) -> usize {
        self.posterior.residuals()
    }

    fn evaluate(&mut self, x: &[f64], residual: &mut [f64], jacobian: &mut [f64]) {
        self.posterior.evaluate(x, residual, jacobian);
        jacobian[self.variable * residual.len() + self.row] = 0.0;
        residual[self.row] = 0.0;
    }

    fn evaluate_residual(&mut self, x: &[f64], residual: &mut [f64]) -> bool {
        let is_computed = self.posterior.evaluate_residual(x, residual);
        residual[self.row] = 0.0;
        is_computed
    }
}
