//! Bootstrap intervals of fitted parameters: the fit repeated with resampled data.
//!
//! The draws have the three causes of `uncertainty`. *Scatter*: the residuals of each line, in all channels and runs,
//! are multiplied by a random number (wild bootstrap, Wu, "Jackknife, bootstrap and other resampling methods in
//! regression analysis", Annals of Statistics 14, 1986). If the scores of neighbouring lines are correlated, so are
//! their random numbers, with Bartlett's kernel (dependent wild bootstrap, Shao, "The dependent wild bootstrap", J.
//! Amer. Statist. Assoc. 105, 2010). *Asymmetry* and *gains*: the change of the residual by half the difference of two
//! sides, and by the gain error of each sensor, times a normal random number. The smallest share of asymmetry that
//! `uncertainty` adds to every parameter is left out, because it does not come from data.
//!
//! Each search begins at the minimum of the fit, so the intervals describe this minimum only.

use super::cost::Cost;
use super::report::Fit;
use super::search::OPTIONS;
use super::setup::Setup;
use super::uncertainty::{self, Line};
use crate::least_squares::{Outcome, Problem, minimize};
use crate::mean::{deviation, mean, quantile};
use crate::model::Model;
use crate::progress::{self, OnProgress};
use crate::random::SplitMix;
use nalgebra::DVector;
use serde::Serialize;

/// Results of the repeated fits.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Bootstrap {
    /// Number of repetitions.
    pub resamples: usize,
    /// Number of repetitions without a minimum; they are left out.
    pub failed: usize,
    /// Results for each fitted parameter; empty if all repetitions failed.
    pub parameters: Vec<ParameterBootstrap>,
}

/// Results of the repeated fits for one parameter.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ParameterBootstrap {
    /// Name.
    pub name: String,
    /// Unit.
    pub unit: String,
    /// Value at the minimum of the fit.
    pub value: f64,
    /// Standard deviation of the repeated fits.
    pub stderr: f64,
    /// Bias: mean of the repeated fits minus `value`.
    pub bias: f64,
    /// 95 % interval: their quantiles at 2.5 and 97.5 %.
    pub interval: [f64; 2],
}

/// Quantiles at the ends of a 95 % interval.
const ENDS: [f64; 2] = [0.025, 0.975];

impl<M: Model + ?Sized> Setup<'_, M> {
    /// Repeats a fit `resamples` times. Each resample depends only on the seed of the plan and its own number.
    /// `on_progress` receives the progress after each.
    pub fn bootstrap(&self, fit: &Fit, resamples: usize, on_progress: OnProgress<'_>) -> Bootstrap {
        let minimum = self.minimum_of(fit);
        let drawn = Drawn::new(self, &minimum);
        let numbers: Vec<u64> = (0..resamples as u64).collect();
        let found = progress::map_with(
            &numbers,
            on_progress,
            || self.cost(),
            |cost, &number| {
                let random = SplitMix::stream(self.plan.seed, number);
                let change = drawn.residual(random) - &minimum.residual;
                let outcome = minimize(&mut Changed { cost, change }, &minimum.x, &self.bounds, &OPTIONS);
                outcome.stop.converged().then_some(outcome.x)
            },
        );
        let found: Vec<Vec<f64>> = found.into_iter().flatten().collect();
        let variables = if found.is_empty() { 0 } else { self.free.len() };
        Bootstrap {
            resamples,
            failed: resamples - found.len(),
            parameters: (0..variables)
                .map(|variable| self.about_parameter(variable, minimum.x[variable], &found))
                .collect(),
        }
    }

    fn about_parameter(&self, variable: usize, value: f64, found: &[Vec<f64>]) -> ParameterBootstrap {
        let mut values: Vec<f64> = found.iter().map(|x| x[variable]).collect();
        values.sort_by(f64::total_cmp);
        let count = values.len() as f64;
        let parameter = &self.model.about().parameters[self.free[variable]];
        ParameterBootstrap {
            name: parameter.name.to_string(),
            unit: parameter.unit.to_string(),
            value,
            stderr: deviation(&values) * (count / (count - 1.0).max(1.0)).sqrt(),
            bias: mean(&values) - value,
            interval: ENDS.map(|part| quantile(&values, part)),
        }
    }
}

/// Causes from which residuals at the minimum are drawn.
struct Drawn {
    /// Leave-one-out residuals of the lines of each grid.
    grids: Vec<Vec<Line>>,
    rows: usize,
    /// Number of neighbours whose random numbers are correlated with that of a line.
    lags: Vec<usize>,
    /// Changes of the residual by sides and gains, each to be multiplied by a normal random number.
    patterns: Vec<DVector<f64>>,
}

impl Drawn {
    fn new<M: Model + ?Sized>(setup: &Setup<'_, M>, minimum: &Outcome) -> Self {
        let information = uncertainty::information(minimum);
        let grids = 0..setup.grids.len();
        let grids: Vec<Vec<Line>> = grids
            .map(|grid| uncertainty::unfitted((&setup.grids, &setup.targets), minimum, &information, grid))
            .collect();
        let correlated = uncertainty::are_neighbours_correlated(setup, minimum, &information);
        let lags = |lines: &Vec<Line>| if correlated { uncertainty::lags(lines.len()) } else { 0 };
        Self {
            rows: minimum.residual.len(),
            lags: grids.iter().map(lags).collect(),
            patterns: uncertainty::patterns(setup),
            grids,
        }
    }

    fn residual(&self, mut random: SplitMix) -> DVector<f64> {
        let mut residual = DVector::zeros(self.rows);
        for (lines, &lags) in self.grids.iter().zip(&self.lags) {
            let normal: Vec<f64> = (0..lines.len() + lags).map(|_| random.normal()).collect();
            // Sums of neighbours have Bartlett's kernel as their correlation.
            let scale = 1.0 / ((lags + 1) as f64).sqrt();
            for (line, own) in lines.iter().enumerate() {
                let times = scale * normal[line..=line + lags].iter().sum::<f64>();
                for (&row, value) in own.rows.iter().zip(&own.residual) {
                    residual[row] = times * value;
                }
            }
        }
        for pattern in &self.patterns {
            residual.axpy(random.normal(), pattern, 1.0);
        }
        residual
    }
}

/// A cost with other measured values: its residual has a constant change.
struct Changed<'c, 'm, 's, M: ?Sized> {
    cost: &'c mut Cost<'m, 's, M>,
    change: DVector<f64>,
}

impl<M: Model + ?Sized> Problem for Changed<'_, '_, '_, M> {
    fn variables(&self) -> usize {
        self.cost.variables()
    }

    fn residuals(&self) -> usize {
        self.change.len()
    }

    fn evaluate(&mut self, x: &[f64], residual: &mut [f64], jacobian: &mut [f64]) {
        self.cost.evaluate(x, residual, jacobian);
        residual
            .iter_mut()
            .zip(&self.change)
            .for_each(|(own, change)| *own += change);
    }
}
