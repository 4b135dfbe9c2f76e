//! A fit, linearised for score tests.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use super::assembly::Assembly;
use crate::campaign::Role;
use crate::discover::noise::{Discrepancy, Factors};
use crate::discover::observe::Evidence;
use crate::discover::posterior::Refit;
use crate::least_squares::gram;

/// Relative error of the derivatives, with a wide margin.
const ROUNDING: f64 = 1e-6;

/// A fit, linearised: residuals, Jacobian and the derived quantities of the score test.
pub struct Tangent {
    /// Residuals in units of the noise: those of the data, then those of the priors.
    residual: DVector<f64>,
    jacobian: DMatrix<f64>,
    /// The same residuals, whitened by the discrepancy.
    white: DVector<f64>,
    white_jacobian: DMatrix<f64>,
    hessian: Option<Cholesky<f64, Dyn>>,
    /// An orthonormal basis of the changes of the whitened data that the free parameters of the model can make, whatever
    /// their priors say. Those of sensors and amplitudes are known from data sheets.
    imitable: DMatrix<f64>,
    /// Jᵀr of the whitened quantities.
    gradient: DVector<f64>,
    /// The discrepancy of the fit.
    discrepancy: Discrepancy,
    /// Its factors for the estimates from other residuals.
    factors: Factors,
    /// Negative log posterior density, up to a constant.
    cost: f64,
    data: usize,
}

/// The best step along the change that a candidate makes.
pub struct Step {
    /// Factor on the change of the residuals.
    pub scale: f64,
    /// Change of all other unknowns along with it.
    pub unknowns: DVector<f64>,
    /// Decrease of half the sum of squares.
    pub gain: f64,
}

impl Tangent {
    /// Linearises a fit on this evidence.
    pub fn new(refit: &Refit, assembly: &Assembly, evidence: &Evidence) -> Self {
        let (residual, jacobian) = refit.linearised(assembly.model(), evidence);
        let known = refit
            .discrepancy_of(evidence)
            .unwrap_or_else(|| Discrepancy::of(evidence, Role::Fit));
        let (mut white, mut white_jacobian) = (residual.clone(), jacobian.clone());
        known.whiten(white.as_mut_slice());
        white_jacobian
            .column_iter_mut()
            .for_each(|mut column| known.whiten(column.as_mut_slice()));
        let data = evidence.of_role(Role::Fit).map(|(_, series)| series.residuals()).sum();
        Self {
            data,
            imitable: span(&white_jacobian.view((0, 0), (data, refit.free.len())).into_owned()),
            hessian: gram(&white_jacobian).cholesky(),
            gradient: white_jacobian.tr_mul(&white),
            cost: known.cost() + white.norm_squared() / 2.0,
            discrepancy: known,
            factors: Factors::default(),
            residual,
            jacobian,
            white,
            white_jacobian,
        }
    }

    /// The step along a change of the data residuals that gains most with the discrepancy held fixed. The factor stays
    /// within `(least, most)`. `None` if other unknowns can imitate the whole change, or if the gain is not finite.
    pub fn step(&self, there: &DVector<f64>, (least, most): (f64, f64)) -> Option<Step> {
        let mut change = there - self.residual.rows(0, self.data);
        self.discrepancy.whiten(change.as_mut_slice());
        let along = self.white_jacobian.rows(0, self.data).tr_mul(&change);
        let hessian = self.hessian.as_ref()?;
        let imitated = hessian.solve(&along);
        let cross = self.white.rows(0, self.data).dot(&change) - self.gradient.dot(&imitated);
        let square = change.norm_squared() - along.dot(&imitated);
        if square.is_nan() || square <= 0.0 || self.imitates(&change) {
            return None;
        }
        let scale = (-cross / square).clamp(least, most);
        let gain = -scale * cross - scale * scale * square / 2.0;
        let unknowns = -hessian.solve(&(&self.gradient + scale * along));
        gain.is_finite().then_some(Step { scale, unknowns, gain })
    }

    /// True if free parameters of the model can make the same change of the whitened data, whatever their priors say: the
    /// gain of the only sensor of a model with free masses, stiffnesses and damping only scales them.
    fn imitates(&self, change: &DVector<f64>) -> bool {
        if self.imitable.is_empty() {
            return false;
        }
        let rest = change - &self.imitable * self.imitable.tr_mul(change);
        rest.norm() <= ROUNDING * change.norm()
    }

    /// Sum of squares of the part of a residual change that no other unknown can imitate; `None` if the normal matrix
    /// is singular.
    pub fn independent_change(&self, there: &DVector<f64>) -> Option<f64> {
        let mut change = there - self.residual.rows(0, self.data);
        self.discrepancy.whiten(change.as_mut_slice());
        let along = self.white_jacobian.rows(0, self.data).tr_mul(&change);
        let imitated = self.hessian.as_ref()?.solve(&along);
        Some(change.norm_squared() - along.dot(&imitated))
    }

    /// Derivatives of the residuals, whitened by the discrepancy.
    pub fn white_jacobian(&self) -> &DMatrix<f64> {
        &self.white_jacobian
    }

    /// Gain of the present unknowns and the discrepancy on this evidence, without a candidate.
    pub fn gain_without_candidate(&self) -> f64 {
        let Some(hessian) = &self.hessian else { return 0.0 };
        let step = Step {
            scale: 0.0,
            unknowns: -hessian.solve(&self.gradient),
            gain: 0.0,
        };
        let here = self.residual.rows(0, self.data).into_owned();
        self.gain_to_first_order(&here, &step).max(0.0)
    }

    /// Gain of a step in log posterior density to first order.
    pub fn gain_to_first_order(&self, there: &DVector<f64>, step: &Step) -> f64 {
        let mut residual = &self.residual + &self.jacobian * &step.unknowns;
        let change = there - self.residual.rows(0, self.data);
        residual.rows_mut(0, self.data).axpy(step.scale, &change, 1.0);
        self.gain_of(residual)
    }

    /// Gain in log posterior density at data residuals of a hypothesis with the other unknowns changed.
    pub fn gain_at(&self, there: &DVector<f64>, unknowns: &DVector<f64>) -> f64 {
        let mut residual = &self.residual + &self.jacobian * unknowns;
        residual.rows_mut(0, self.data).copy_from(there);
        self.gain_of(residual)
    }

    /// Gain in log posterior density, with the discrepancy learned again from the remaining residual.
    fn gain_of(&self, mut residual: DVector<f64>) -> f64 {
        if !residual.iter().all(|value| value.is_finite()) {
            return f64::NEG_INFINITY;
        }
        let mut discrepancy = self.discrepancy.clone();
        discrepancy.estimate(residual.as_slice(), &self.factors);
        discrepancy.whiten(residual.as_mut_slice());
        self.cost - discrepancy.cost() - residual.norm_squared() / 2.0
    }
}

/// An orthonormal basis of the columns, without those that are zero or not finite.
fn span(columns: &DMatrix<f64>) -> DMatrix<f64> {
    let lengths: Vec<f64> = columns.column_iter().map(|column| column.norm()).collect();
    let used = (0..lengths.len()).filter(|&k| lengths[k] > 0.0 && lengths[k].is_finite());
    let columns: Vec<DVector<f64>> = used.map(|k| columns.column(k) / lengths[k]).collect();
    if columns.is_empty() {
        return DMatrix::zeros(0, 0);
    }
    let (q, r, _) = DMatrix::from_columns(&columns).col_piv_qr().unpack();
    let kept: Vec<usize> = (0..r.nrows()).filter(|&k| r[(k, k)].abs() > ROUNDING).collect();
    q.select_columns(&kept)
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};

    use super::span;

    /// The second column is twice the first, and the third is zero.
    #[test]
    fn a_span_has_no_direction_twice() {
        let columns = DMatrix::from_row_slice(3, 4, &[1.0, 2.0, 0.0, 1e-3, 1.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let span = span(&columns);
        assert_eq!(span.ncols(), 2);
        let inside = DVector::from_vec(vec![3.0, -7.0, 0.0]);
        assert!((&span * span.tr_mul(&inside) - &inside).norm() < 1e-12);
    }
}
