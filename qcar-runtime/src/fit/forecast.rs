//! The standard errors that a fit to some levels is expected to have, and how much these say of the parameters.

use super::observation::Level;
use super::plan::Plan;
use super::setup::Setup;
use super::uncertainty;
use crate::error::InputError;
use crate::least_squares::{Outcome, Stop};
use crate::model::Model;
use nalgebra::DMatrix;

/// What a fit is expected to know of the parameters that it is asked for.
pub(super) struct Forecast {
    /// Standard errors; `None` of what the levels do not determine.
    pub errors: Vec<Option<f64>>,
    /// The covariance under what the ranges say, each parameter over the deviation that its range has.
    posterior: DMatrix<f64>,
}

/// Of parameters by their places in the model, with the plan's start values for the minimum.
///
/// # Errors
/// What [`Setup::new`] finds wrong.
pub(super) fn forecast<M: Model + ?Sized>(
    model: &M,
    plan: &Plan,
    levels: &[Level],
    asked: &[usize],
) -> Result<Forecast, InputError> {
    let setup = Setup::new(model, plan, levels)?;
    let uncertainty = uncertainty::estimate(&setup, &at_start(&setup));
    let place = |of: usize| setup.free.iter().position(|free| *free == of);
    let errors = asked.iter().map(|&of| Some(uncertainty.standard_error(place(of)?)?.total));
    let known: Vec<usize> = uncertainty.seen().iter().map(|&k| setup.free[k]).collect();
    Ok(Forecast {
        errors: errors.collect(),
        posterior: posterior(&prior(model, plan, asked), asked, &known, uncertainty.covariance()),
    })
}

impl Forecast {
    /// The log determinant of the covariance of some of the parameters, by their places among those asked for.
    pub fn log_volume(&self, of: &[usize]) -> f64 {
        let block = self.posterior.select_rows(of).select_columns(of);
        block.symmetric_eigenvalues().iter().map(|value| value.max(f64::MIN_POSITIVE).ln()).sum()
    }
}

/// The minimum as a search would have ended there.
fn at_start<M: Model + ?Sized>(setup: &Setup<'_, M>) -> Outcome {
    let x = setup.start();
    let (residual, jacobian) = setup.cost().at(&x);
    let cost = 0.5 * residual.norm_squared();
    Outcome {
        at_bound: vec![0; x.len()],
        x,
        cost,
        start_cost: cost,
        residual,
        jacobian,
        stop: Stop::Gradient,
        evaluations: 1,
        iterations: 0,
    }
}

/// What is known of each parameter before anything is measured: that it lies evenly in its range or, without one, as a standard
/// deviation its own size.
fn prior<M: Model + ?Sized>(model: &M, plan: &Plan, asked: &[usize]) -> Vec<f64> {
    let deviation = |&place: &usize| {
        let own = &model.about().parameters[place];
        let given = plan.parameters.iter().find(|given| given.name == own.name);
        let range = given.and_then(|given| given.range).or(own.range);
        let size = given.map_or(1.0, |given| given.value.abs());
        range.map_or(size, |(low, high)| (high - low) / 12.0_f64.sqrt())
    };
    asked.iter().map(deviation).collect()
}

/// Prior and measurement together.
fn posterior(prior: &[f64], asked: &[usize], known: &[usize], covariance: &DMatrix<f64>) -> DMatrix<f64> {
    let place = |of: &usize| asked.iter().position(|asked| asked == of);
    let places: Vec<usize> = known.iter().filter_map(place).collect();
    let scaled = DMatrix::from_fn(known.len(), known.len(), |i, j| {
        covariance[(i, j)] / (prior[places[i]] * prior[places[j]])
    });
    let mut information = DMatrix::identity(asked.len(), asked.len());
    if let Some(inverse) = scaled.try_inverse() {
        for (i, &row) in places.iter().enumerate() {
            for (j, &column) in places.iter().enumerate() {
                information[(row, column)] += inverse[(i, j)];
            }
        }
    }
    let symmetric: DMatrix<f64> = (&information + information.transpose()) * 0.5;
    symmetric.try_inverse().unwrap_or_else(|| DMatrix::identity(asked.len(), asked.len()))
}
