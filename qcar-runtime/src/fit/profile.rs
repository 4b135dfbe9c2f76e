//! Profile intervals of fitted parameters: the range of each parameter in which the cost, minimised over all others,
//! stays below the limit that chance allows.
//!
//! The cost is not a sum of squares over known variances. So its rise is scaled such that it agrees with the standard
//! error near the minimum: by the ratio of the variance of `uncertainty` to that of the curvature (adjusted profile
//! likelihood, Royall & Tsou, "Interpreting statistical evidence by using imperfect models", J. R. Stat. Soc. B 65,
//! 2003). For a linear model an interval reaches 1.96 standard errors to either side.

use super::report::Fit;
use super::search::OPTIONS;
use super::setup::Setup;
use super::uncertainty::{self, Uncertainty};
use crate::least_squares::Outcome;
use crate::least_squares::profile::{Profiled, profile};
use crate::model::Model;
use crate::progress::{self, OnProgress};
use serde::Serialize;

/// The 95 % quantile of the chi-square distribution with one degree of freedom.
pub const QUANTILE: f64 = 3.841_458_820_694_124;

/// First step without a standard error, relative to the range, or to the value without a range.
const FIRST: f64 = 0.02;

/// The profile of a parameter.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ParameterProfile {
    /// Name.
    pub name: String,
    /// Unit.
    pub unit: String,
    /// Value at the minimum of the cost.
    pub value: f64,
    /// Ends of its 95 % interval; `None` if the cost does not rise enough within the range.
    pub interval: [Option<f64>; 2],
    /// Values, ascending, with the rise of the cost there, scaled to be chi-square distributed: 3.84 at an end.
    pub points: Vec<[f64; 2]>,
    /// A value of the parameter with a lower cost than the fit, which is then not the global minimum.
    pub lower_at: Option<f64>,
}

impl<M: Model + ?Sized> Setup<'_, M> {
    /// Profiles of fitted parameters by name; names that were not fitted are left out. `on_progress` receives the
    /// progress after each parameter.
    pub fn profiles(&self, fit: &Fit, names: &[String], on_progress: OnProgress<'_>) -> Vec<ParameterProfile> {
        let about = &self.model.about().parameters;
        let minimum = self.minimum_of(fit);
        let uncertainty = uncertainty::estimate(self, &minimum);
        let free = 0..self.free.len();
        let wanted: Vec<usize> = free
            .filter(|&variable| names.iter().any(|name| *name == about[self.free[variable]].name))
            .collect();
        progress::map_with(
            &wanted,
            on_progress,
            || self.cost(),
            |cost, &variable| {
                let unit = unit(&uncertainty, &minimum, variable);
                let of = Profiled {
                    variable,
                    rise: QUANTILE * unit,
                    step: self.first_step(&uncertainty, &minimum, variable),
                };
                let found = profile(cost, &minimum, &self.bounds, of, &OPTIONS);
                let least = found.points.iter().min_by(|a, b| a[1].total_cmp(&b[1]));
                let parameter = &about[self.free[variable]];
                ParameterProfile {
                    name: parameter.name.to_string(),
                    unit: parameter.unit.to_string(),
                    value: minimum.x[variable],
                    interval: found.ends,
                    lower_at: least.filter(|least| least[1] < -CHANCE * unit).map(|least| least[0]),
                    points: found.points.iter().map(|[value, rise]| [*value, rise / unit]).collect(),
                }
            },
        )
    }

    /// The minimum of a fit, with residual and Jacobian.
    pub(super) fn minimum_of(&self, fit: &Fit) -> Outcome {
        let value = |&place: &usize| fit.parameters[place].value;
        self.local(&self.free.iter().map(value).collect::<Vec<_>>())
    }

    fn first_step(&self, uncertainty: &Uncertainty, minimum: &Outcome, variable: usize) -> f64 {
        let width = self.bounds.upper[variable] - self.bounds.lower[variable];
        let size = if width.is_finite() {
            width
        } else {
            minimum.x[variable].abs().max(f64::MIN_POSITIVE)
        };
        let error = uncertainty.standard_error(variable);
        error.map_or(FIRST * size, |error| error.total.min(size))
    }
}

/// Decrease of the cost in units of chi-square beyond which a point belongs to another minimum, instead of the same
/// minimum found more closely.
pub const CHANCE: f64 = 0.1;

/// Rise of `½ ‖r‖²` for one unit of chi-square; for a parameter without a standard error, that of the others.
fn unit(uncertainty: &Uncertainty, minimum: &Outcome, variable: usize) -> f64 {
    let mut others: Vec<f64> = (0..minimum.x.len()).filter_map(|k| uncertainty.inflation(k)).collect();
    others.sort_by(f64::total_cmp);
    let rows = minimum.residual.len().saturating_sub(minimum.x.len()).max(1);
    let usual = others.get(others.len() / 2).copied();
    let usual = usual.unwrap_or(2.0 * minimum.cost / rows as f64);
    0.5 * uncertainty.inflation(variable).unwrap_or(usual)
}
