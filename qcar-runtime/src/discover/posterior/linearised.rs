//! Residuals at a fit: of the fitted model with its Jacobian, and of another model in its place.

use nalgebra::{DMatrix, DVector};

use super::problem::Posterior;
use super::refit::Refit;
use crate::discover::noise::Nuisance;
use crate::discover::observe::Evidence;
use crate::least_squares::Problem;
use crate::model::Model;
use crate::response::parameters::Values;

impl Refit {
    /// Residuals and Jacobian of the fitted `model`, in units of the noise and not whitened. The rows of the data come
    /// first, then those of the priors; the columns are all unknowns.
    pub fn linearised(&self, model: &dyn Model, evidence: &Evidence) -> (DVector<f64>, DMatrix<f64>) {
        Posterior::of(self, model, evidence).linearised(self)
    }

    /// Data residuals of another model with these values, those of the recorded side and these sensor errors; `None` if
    /// one is not finite.
    pub fn residuals_of(
        &self,
        other: &dyn Model,
        (values, side): (&Values, Values),
        (nuisance, coefficients): (Nuisance, &[f64]),
        evidence: &Evidence,
    ) -> Option<DVector<f64>> {
        let mut posterior = Posterior::new(other, values.clone(), &[], evidence, nuisance);
        posterior.side = side;
        posterior.has_discrepancy = self.discrepancy.is_some();
        let mut residual = vec![0.0; posterior.residuals()];
        posterior.residual_and_slopes(coefficients, &mut residual, false);
        residual.truncate(posterior.residuals);
        residual
            .iter()
            .all(|r| r.is_finite())
            .then(|| DVector::from_vec(residual))
    }
}

impl Posterior<'_> {
    /// Residual and Jacobian at a refit, not whitened.
    pub fn linearised(&mut self, refit: &Refit) -> (DVector<f64>, DMatrix<f64>) {
        let place = self.place(refit);
        self.start.clone_from(&place);
        self.whitens = false;
        let mut residual = DVector::zeros(self.residuals());
        let mut jacobian = DMatrix::zeros(self.residuals(), self.variables());
        self.evaluate(&place, residual.as_mut_slice(), jacobian.as_mut_slice());
        (residual, jacobian)
    }
}
