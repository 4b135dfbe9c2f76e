//! The standard errors to expect from a fit to some levels, and their information about the parameters.

use super::observation::Level;
use super::plan::Plan;
use super::setup::Setup;
use super::uncertainty;
use crate::error::InputError;
use crate::least_squares::{Outcome, Stop};
use crate::model::Model;
use nalgebra::DMatrix;

/// The standard errors of parameters by their places in the model, with the plan's start values for the minimum; `None` of what
/// the levels do not determine.
///
/// # Errors
/// What [`Setup::new`] finds wrong.
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

/// What levels say of parameters, each in parts of what is not known of it beforehand: their Fisher information, for weighted
/// residuals of unit variance, and the mean square that these have.
pub(super) struct Said {
    squares: DMatrix<f64>,
    variance: f64,
}

impl Said {
    /// Of parameters by their places in the model.
    ///
    /// # Errors
    /// What [`Setup::new`] finds wrong.
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

    /// The log determinant of the information about some of the parameters, by their places among those asked for, with `more`
    /// added and under what is known beforehand; all others are estimated beside them.
    pub fn log_information(&self, more: Option<&Said>, of: &[usize]) -> f64 {
        let count = self.squares.nrows();
        let mut sum = self.squares.clone();
        more.iter().for_each(|more| sum += &more.squares);
        let whole = DMatrix::identity(count, count) + sum / self.variance.max(f64::MIN_POSITIVE);
        let others: Vec<usize> = (0..count).filter(|place| !of.contains(place)).collect();
        log_determinant(&whole) - log_determinant(&whole.select_rows(&others).select_columns(&others))
    }
}

/// Of a symmetric matrix with no eigenvalue below one.
fn log_determinant(of: &DMatrix<f64>) -> f64 {
    let factor = of.clone().cholesky().expect("the identity is part of it");
    2.0 * factor.l_dirty().diagonal().iter().map(|own| own.ln()).sum::<f64>()
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
