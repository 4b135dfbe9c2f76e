//! What a fit gives: the maximum a posteriori with its errors.

use nalgebra::{Complex, DMatrix};

use crate::campaign::Role;
use crate::discover::noise::{Beginning, Discrepancy, Nuisance};
use crate::discover::observe::{Evidence, Free, Prediction};
use crate::least_squares::Stop;
use crate::least_squares::information::Unseen;
use crate::response::parameters::Values;
use crate::transmissibility::Point;

/// The explanation that was found.
#[derive(Clone, Debug)]
pub struct Refit {
    /// All parameters.
    pub values: Values,
    /// The same on the side that cleat runs record.
    pub side: Values,
    /// Those that moved.
    pub free: Vec<Free>,
    /// What they came to.
    pub estimate: Vec<f64>,
    /// Covariance of the free parameters, sensor errors allowed for; NaN for one at a bound or not seen.
    pub covariance: DMatrix<f64>,
    /// Why a free parameter off its bounds is not seen by itself; places of others are those in `free`.
    pub unseen: Vec<Option<Unseen>>,
    /// For each free parameter: -1 on its lower bound, 1 on its upper bound, 0 between.
    pub at_bound: Vec<i8>,
    /// The sensors.
    pub nuisance: Nuisance,
    /// Their errors.
    pub coefficients: Vec<f64>,
    /// Standard errors of these; NaN for one that nothing determines.
    pub coefficient_stderr: Vec<f64>,
    /// Sum of squares of all residuals, priors included.
    pub chi2: f64,
    /// By how much the last search lowered half the sum of squares.
    pub gained: f64,
    /// Logarithm of the evidence, by Laplace's method, but for a constant of the data; NaN without a discrepancy.
    pub log_evidence: f64,
    /// What the model misses; `None` where residuals are held against noise alone.
    pub discrepancy: Option<Discrepancy>,
    /// The values at which the priors of the parameters are centred.
    pub centre: Values,
    /// Number of residuals of the data.
    pub residuals: usize,
    /// Relative standard deviation of what the mean of the measured sides has by chance: of the parts that were made for one
    /// drawing, two are measured.
    pub made: f64,
    /// What the model shows of each series beyond what a search predicts: nothing before it has settled.
    pub unsteady: Vec<Vec<Complex<f64>>>,
    /// Evaluations of residual and Jacobian.
    pub evaluations: usize,
    /// Why the search stopped.
    pub stop: Stop,
}

impl Refit {
    /// Standard errors of the free parameters, as those of the drawing: by what the residuals scatter, and by what the
    /// parts of two sides differ from it.
    pub fn stderr(&self) -> Vec<f64> {
        let variances = self.covariance.diagonal();
        let of = variances.iter().zip(&self.estimate);
        of.map(|(variance, value)| (self.scatter() * variance + (self.made * value).powi(2)).sqrt())
            .collect()
    }

    /// The logarithm of a parameter's factor on the side that cleat runs record.
    pub fn factor(&self, parameter: usize) -> f64 {
        let factor = (self.side.as_slice()[parameter] / self.values.as_slice()[parameter]).ln();
        if factor.is_finite() { factor } else { 0.0 }
    }

    /// What the fitted residuals scatter by, squared; 1 where only noise is left.
    pub fn scatter(&self) -> f64 {
        (self.chi2 / self.residuals as f64).max(1.0)
    }

    /// The discrepancy that was found, for another part of the evidence.
    pub fn discrepancy_of(&self, evidence: &Evidence) -> Option<Discrepancy> {
        self.discrepancy
            .as_ref()
            .map(|known| known.carried_to(evidence, Role::Fit))
    }

    /// What the sensors of records read at zero, with standard errors; SI.
    pub fn offsets(&self) -> Vec<(Point, f64, f64)> {
        let scatter = self.scatter().sqrt();
        let errors: Vec<f64> = self.coefficient_stderr.iter().map(|error| scatter * error).collect();
        self.nuisance.offsets(&self.coefficients, &errors)
    }

    /// With which states records were found to begin.
    pub fn begun(&self) -> Vec<(Beginning, f64)> {
        let coefficients = &self.coefficients[self.nuisance.of_sensors()..];
        let beginnings = self.nuisance.beginnings.iter().cloned();
        beginnings.zip(coefficients.iter().copied()).collect()
    }

    /// What the sensors would have shown of a prediction.
    pub fn measured(&self, evidence: &Evidence, prediction: &Prediction) -> Vec<Complex<f64>> {
        let series = &evidence.series[prediction.series];
        self.nuisance
            .show(evidence, series, &prediction.value, &self.coefficients)
            .value
    }
}
