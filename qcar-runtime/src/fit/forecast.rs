//! The standard errors to expect from a fit to some levels, and their information about the parameters.

use super::observation::Level;
use super::plan::Plan;
use super::setup::Setup;
use super::uncertainty;
use crate::error::InputError;
use crate::least_squares::{Outcome, Stop};
use crate::model::Model;
use nalgebra::DMatrix;

/// Expected standard errors of the parameters at these positions in the model, with the start values of the plan as the
/// minimum; `None` for a parameter that the levels do not determine.
///
/// # Errors
/// Fails as [`Setup::new`] does.
pub(super) fn errors<M: Model + ?Sized>(
    model: &M,
    plan: &Plan,
    levels: &[Level],
    asked: &[usize],
) -> Result<Vec<Option<f64>>, InputError> {
    let setup = Setup::new(model, plan, levels)?;
    let uncertainty = uncertainty::estimate(&setup, &at_start(&setup));
    let place = |of: usize| setup.free.iter().position(|free| *free == of);
    let error = |&of: &usize| Some(uncertainty.standard_error(place(of)?)?.total);
    Ok(asked.iter().map(error).collect())
}

/// The result of a search that ends at the start values.
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

/// Fisher information of levels about parameters, each scaled by its prior standard deviation, for weighted residuals
/// of unit variance; and the variance of these residuals.
pub(super) struct Information {
    squares: DMatrix<f64>,
    variance: f64,
}

impl Information {
    /// Information about the parameters at these positions in the model.
    ///
    /// # Errors
    /// Fails as [`Setup::new`] does.
    pub fn by<M: Model + ?Sized>(
        model: &M,
        plan: &Plan,
        levels: &[Level],
        asked: &[usize],
    ) -> Result<Self, InputError> {
        let setup = Setup::new(model, plan, levels)?;
        let Outcome { residual, jacobian, .. } = at_start(&setup);
        let prior = prior(model, plan, asked);
        let mut slopes = DMatrix::zeros(residual.len(), asked.len());
        for (column, place) in setup.free.iter().enumerate() {
            if let Some(to) = asked.iter().position(|asked| asked == place) {
                slopes.set_column(to, &(jacobian.column(column) * prior[to]));
            }
        }
        let degrees = residual.len().saturating_sub(setup.free.len()).max(1);
        Ok(Self {
            squares: slopes.transpose() * slopes,
            variance: residual.norm_squared() / degrees as f64,
        })
    }

    /// Log determinant of the information about some of the parameters, by their positions among those asked for. It
    /// includes the priors and `more`; all other parameters count as unknown.
    pub fn log_information(&self, more: Option<&Information>, of: &[usize]) -> f64 {
        let count = self.squares.nrows();
        let mut sum = self.squares.clone();
        more.iter().for_each(|more| sum += &more.squares);
        let whole = DMatrix::identity(count, count) + sum / self.variance.max(f64::MIN_POSITIVE);
        let others: Vec<usize> = (0..count).filter(|place| !of.contains(place)).collect();
        log_determinant(&whole) - log_determinant(&whole.select_rows(&others).select_columns(&others))
    }
}

/// Log determinant of a symmetric matrix whose eigenvalues are at least 1.
fn log_determinant(of: &DMatrix<f64>) -> f64 {
    let factor = of.clone().cholesky().expect("the identity is part of it");
    2.0 * factor.l_dirty().diagonal().iter().map(|own| own.ln()).sum::<f64>()
}

/// Prior standard deviation of each parameter: that of a uniform distribution over its range, or its absolute value
/// without a range.
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
