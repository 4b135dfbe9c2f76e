//! Expected information of further measurements: a D-optimal choice among sensors, runs, levels and dynamometers.
//!
//! The criterion is that of a [linear fit](crate::fit::design): the increase of the log determinant of the information
//! about some parameters, with all other unknowns estimated too. The information is that of the fit
//! residuals, whitened by the discrepancy. New measurements take the predictions of the fitted model as their values. A
//! new sensor has the mean discrepancy of the sensors beside it.

// Possible further measurements.
mod measurements;

use nalgebra::{DMatrix, DVector};

use super::problem::Posterior;
use super::refit::Refit;
use crate::campaign::Role;
use crate::discover::noise::Nuisance;
use crate::discover::observe::{Evidence, PredictError};
use crate::fit::design::{ExpectedGain, ExpectedGains};
use crate::least_squares::information::Information;
use crate::least_squares::{Problem, gram};
use crate::model::Model;
use crate::progress::{self, OnProgress};

/// Expected gain of each further measurement for the parameters of a refit of `model`, largest first. `wanted` names
/// the parameters that count; if it is empty, all count. `on_progress` receives the progress after each measurement.
///
/// # Errors
/// Fails if the model cannot predict the evidence.
pub fn expected_gains(
    model: &dyn Model,
    refit: &Refit,
    evidence: &Evidence,
    wanted: &[String],
    on_progress: OnProgress<'_>,
) -> Result<ExpectedGains, PredictError> {
    let fitted = refit.fitted_of(evidence);
    let name = |k: usize| &*model.about().parameters[refit.free[k].parameter].name;
    let counts = |k: &usize| wanted.is_empty() || wanted.iter().any(|own| *own == name(*k));
    let counted: Vec<usize> = (0..refit.free.len()).filter(counts).collect();
    let now = Expected::by(refit, model, &fitted, &counted)?;
    let all = measurements::measurements(refit, model, &fitted)?;
    let further = progress::map(&all, on_progress, |own| {
        let expected = Expected::by(refit, model, &own.evidence, &counted)?;
        Ok(ExpectedGain {
            kind: own.kind,
            what: own.what.clone(),
            rise: expected.information - now.information,
            errors: expected.errors,
        })
    });
    let mut further = further.into_iter().collect::<Result<Vec<_>, PredictError>>()?;
    further.retain(|own| own.rise.is_finite());
    further.sort_by(|a, b| b.rise.total_cmp(&a.rise));
    Ok(ExpectedGains {
        parameters: refit.free.iter().map(|free| free.parameter).collect(),
        errors: now.errors,
        further,
    })
}

/// Expected result of a fit to some evidence.
struct Expected {
    /// Log determinant of the information about the parameters that count, including their priors.
    information: f64,
    /// Standard errors as the fit reports them; `None` if a parameter is not determined or at its bound.
    errors: Vec<Option<f64>>,
}

impl Expected {
    fn by(refit: &Refit, model: &dyn Model, evidence: &Evidence, counted: &[usize]) -> Result<Self, PredictError> {
        let mut nuisance = Nuisance::of(evidence).with_initial_states(model, refit.values.as_slice(), evidence);
        nuisance.without_offset.clone_from(&refit.nuisance.without_offset);
        nuisance.accuracy = refit.nuisance.accuracy;
        let mut posterior = Posterior::new(model, refit.values.clone(), &refit.free, evidence, nuisance);
        let known = refit.discrepancy.as_ref();
        posterior.discrepancy = known.map(|known| known.expected_of(evidence, Role::Fit));
        posterior.has_discrepancy = posterior.discrepancy.is_some();
        posterior.centre = refit.centre.clone();
        // Sensor errors and initial state deviations are taken as zero: they are small and hardly change the Jacobian.
        let mut place = refit.estimate.clone();
        place.resize(posterior.variables(), 0.0);
        posterior.start.clone_from(&place);
        let mut residual = DVector::zeros(posterior.residuals());
        let mut jacobian = DMatrix::zeros(posterior.residuals(), posterior.variables());
        posterior.evaluate(&place, residual.as_mut_slice(), jacobian.as_mut_slice());
        posterior.failure.take().map_or(Ok(()), Err)?;
        let data = posterior.residuals + posterior.sigmas.len();
        let is_inside = |k: usize| refit.at_bound.get(k).is_none_or(|side| *side == 0);
        let inside: Vec<bool> = (0..posterior.variables()).map(is_inside).collect();
        let information = Information::new(&jacobian.rows(0, data).into_owned(), &inside);
        let error = |k: usize| {
            let place = information.seen().iter().position(|&seen| seen == k)?;
            let variance = refit.scatter() * information.inverse()[(place, place)];
            Some((variance + (refit.side_sd * refit.estimate[k]).powi(2)).sqrt())
        };
        Ok(Self {
            errors: (0..refit.free.len()).map(error).collect(),
            information: log_information(&jacobian, counted),
        })
    }
}

/// Log determinant of the information about some variables; NaN if the normal matrix is singular.
fn log_information(jacobian: &DMatrix<f64>, counted: &[usize]) -> f64 {
    let lengths = DVector::from_iterator(jacobian.ncols(), jacobian.column_iter().map(|column| column.norm()));
    let mut scaled = jacobian.clone();
    for (mut column, length) in scaled.column_iter_mut().zip(&lengths) {
        column /= *length;
    }
    let Some(inverse) = gram(&scaled).cholesky().map(|own| own.inverse()) else {
        return f64::NAN;
    };
    let covariance = DMatrix::from_fn(counted.len(), counted.len(), |i, j| inverse[(counted[i], counted[j])]);
    let determinant = covariance.cholesky();
    let determinant = determinant.map_or(f64::NAN, |own| 2.0 * own.l_dirty().diagonal().map(f64::ln).sum());
    2.0 * counted.iter().map(|&k| lengths[k].ln()).sum::<f64>() - determinant
}
