//! Least-squares problem of a fit: data residuals, whitened by the discrepancy, followed by the residuals of the
//! priors.

use nalgebra::Complex;

use super::prior::{SIDE, is_one_sided, may_differ_by_side};
use super::refit::Refit;
use super::residual::{scaled, through};
use crate::campaign::Role;
use crate::discover::noise::{Discrepancy, Nuisance};
use crate::discover::observe::{Evidence, Free, PredictError, Prediction, Run, Stimulus, predict_sides};
use crate::least_squares::Problem;
use crate::model::Model;
use crate::response::parameters::Values;

/// True for a sweep. Its derivatives are cheap: they use the factorisation of the prediction.
fn is_swept(run: &Run) -> bool {
    matches!(run.stimulus, Stimulus::Sweep { .. })
}

/// The least-squares problem. Its variables are the free parameters, the nuisance coefficients and the log factors of
/// the recorded side.
pub struct Posterior<'a> {
    model: &'a dyn Model,
    pub values: Values,
    pub side: Values,
    pub free: Vec<Free>,
    pub evidence: &'a Evidence,
    pub nuisance: Nuisance,
    /// Prior standard deviations of the nuisance coefficients and of the log factors of the recorded side.
    pub sigmas: Vec<f64>,
    /// Start of the search.
    pub start: Vec<f64>,
    /// Predicted gain that ends the search; zero for a search that converges as far as numbers allow.
    pub decrement: f64,
    /// Centres of the parameter priors, which apply if there is a discrepancy.
    pub centre: Values,
    /// Discrepancy; `None` for a fit against noise alone, and while it is estimated.
    pub discrepancy: Option<Discrepancy>,
    /// True if the discrepancy whitens the residuals.
    pub whitens: bool,
    /// True for a fit with a discrepancy, even while [`Self::discrepancy`] is taken out.
    pub has_discrepancy: bool,
    /// Number of data residuals.
    pub residuals: usize,
    /// Why the model cannot predict the evidence; `None` once a prediction has succeeded.
    pub failure: Option<PredictError>,
    /// True once the model has predicted the evidence. A later failure means that a step was too long.
    has_predicted: bool,
    /// Non-steady part of the sweeps, series by series.
    pub unsteady: Vec<Vec<Complex<f64>>>,
    /// The last prediction and the last one with derivatives. The evaluation of an accepted step and the next round use
    /// them again.
    cache: Vec<Cached>,
}

/// Prediction of the fitted runs at a point.
struct Cached {
    at: Vec<f64>,
    /// Predictions of the sweeps, always with derivatives.
    swept: Vec<Prediction>,
    /// Predictions of all other runs.
    others: Vec<Prediction>,
    /// True if `others` have derivatives too.
    is_sloped: bool,
}

impl<'a> Posterior<'a> {
    pub fn new(
        model: &'a dyn Model,
        values: Values,
        free: &[Free],
        evidence: &'a Evidence,
        nuisance: Nuisance,
    ) -> Self {
        let one_sided = evidence.runs.iter().any(is_one_sided);
        let sides = std::iter::repeat_n(SIDE, if one_sided { free.len() } else { 0 });
        Self {
            model,
            side: values.clone(),
            free: free.to_vec(),
            evidence,
            sigmas: nuisance.sigmas().into_iter().chain(sides).collect(),
            start: Vec::new(),
            decrement: 0.0,
            centre: values.clone(),
            discrepancy: None,
            whitens: true,
            has_discrepancy: false,
            residuals: evidence.of_role(Role::Fit).map(|(_, series)| series.residuals()).sum(),
            nuisance,
            failure: None,
            has_predicted: false,
            unsteady: vec![Vec::new(); evidence.series.len()],
            cache: Vec::new(),
            values,
        }
    }

    /// The problem at a refit of this evidence or of another part of it.
    pub fn of(refit: &Refit, model: &'a dyn Model, evidence: &'a Evidence) -> Self {
        let mut posterior = Self::new(
            model,
            refit.values.clone(),
            &refit.free,
            evidence,
            refit.nuisance.clone(),
        );
        posterior.discrepancy = refit.discrepancy_of(evidence);
        posterior.has_discrepancy = posterior.discrepancy.is_some();
        posterior.centre = refit.centre.clone();
        posterior
    }

    /// Replaces the non-steady part of the sweeps, also in the kept predictions.
    pub fn change_unsteady(&mut self, unsteady: Vec<Vec<Complex<f64>>>) {
        for swept in self.cache.iter_mut().flat_map(|own| &mut own.swept) {
            swept.subtract(&self.unsteady[swept.series]);
            swept.add(&unsteady[swept.series]);
        }
        self.unsteady = unsteady;
    }

    /// Distance of a free parameter from the centre of its prior in standard deviations, and its derivative.
    pub fn prior_of(&self, k: usize, value: f64) -> (f64, f64) {
        match self.discrepancy {
            Some(_) => self.free[k].prior(value, self.centre.as_slice()[self.free[k].parameter]),
            None => self.free[k].weak_prior(value, self.start[k]),
        }
    }

    /// Variables at a refit.
    pub fn place(&self, refit: &Refit) -> Vec<f64> {
        let factors = self.free.iter().map(|free| refit.factor(free.parameter));
        let place = refit.estimate.iter().chain(&refit.coefficients).copied();
        place.chain(factors).take(self.variables()).collect()
    }

    pub fn move_to(&mut self, x: &[f64]) {
        let factors = self.factors(x).to_vec();
        for (k, (free, &value)) in self.free.iter().zip(x).enumerate() {
            self.values.set(free.parameter, value);
            let factor = factors.get(k).copied().filter(|_| may_differ_by_side(self.model, free));
            self.side.set(free.parameter, value * factor.unwrap_or(0.0).exp());
        }
    }

    /// Log factors of the recorded side.
    pub fn factors<'x>(&self, x: &'x [f64]) -> &'x [f64] {
        &x[self.free.len() + self.nuisance.count()..]
    }

    /// Prediction of the fitted runs, with derivatives if `sloped`.
    fn predicted(&mut self, x: &[f64], sloped: bool) -> Result<Cached, PredictError> {
        let here = self.cache.iter().position(|cached| cached.at == x);
        let here = here.map(|place| self.cache.remove(place));
        self.move_to(x);
        let here = match here {
            Some(cached) if cached.is_sloped || !sloped => return Ok(cached),
            other => other,
        };
        let both = [&self.values, &self.side];
        let conditions = self.nuisance.conditions(self.evidence, &x[self.free.len()..]);
        let predict = |free: &[Free], swept: bool| {
            let wanted = |run: &Run| run.role == Role::Fit && is_swept(run) == swept;
            predict_sides(self.model, both, &conditions, free, self.evidence, &wanted)
        };
        let swept = match here {
            Some(cached) => cached.swept,
            None => {
                let mut swept = predict(&self.free, true)?;
                swept.iter_mut().for_each(|own| own.add(&self.unsteady[own.series]));
                swept
            }
        };
        Ok(Cached {
            at: x.to_vec(),
            swept,
            others: predict(if sloped { &self.free } else { &[] }, false)?,
            is_sloped: sloped,
        })
    }

    /// Keeps the last prediction, and the last one with derivatives.
    fn keep(&mut self, cached: Cached) {
        let is_sloped = cached.is_sloped;
        self.cache.retain(|own| own.is_sloped && !is_sloped);
        self.cache.push(cached);
    }

    /// Writes the residual. Returns the data rows of the Jacobian column by column if `sloped`, and no columns
    /// otherwise.
    pub fn residual_and_slopes(&mut self, x: &[f64], residual: &mut [f64], sloped: bool) -> Vec<Vec<f64>> {
        let cached = match self.predicted(x, sloped) {
            Ok(cached) => cached,
            Err(error) => {
                self.failure = (!self.has_predicted).then_some(error);
                residual.fill(f64::NAN);
                return Vec::new();
            }
        };
        self.has_predicted = true;
        let mut predictions: Vec<&Prediction> = cached.swept.iter().chain(&cached.others).collect();
        predictions.sort_by_key(|own| own.series);
        let mut rows = Vec::with_capacity(residual.len());
        let count = if sloped { self.variables() } else { 0 };
        let mut columns: Vec<Vec<f64>> = (0..count).map(|_| Vec::with_capacity(residual.len())).collect();
        for prediction in predictions {
            self.rows(prediction, x, &mut rows, &mut columns);
        }
        self.keep(cached);
        if let Some(discrepancy) = self.discrepancy.as_ref().filter(|_| self.whitens) {
            discrepancy.whiten(&mut rows);
            columns.iter_mut().for_each(|column| discrepancy.whiten(column));
        }
        let errors = x[self.free.len()..].iter().zip(&self.sigmas);
        rows.extend(errors.map(|(error, sigma)| error / sigma));
        rows.extend((0..self.free.len()).map(|k| self.prior_of(k, x[k]).0));
        residual.copy_from_slice(&rows);
        columns
    }

    /// Appends the rows of one prediction to `residual` and to all `columns`; without columns, to the residual alone.
    /// Several terms may add to one column: the gain of a reference scales the readings and also sets the drive
    /// amplitude of the run.
    fn rows(&self, prediction: &Prediction, x: &[f64], residual: &mut Vec<f64>, columns: &mut [Vec<f64>]) {
        let series = &self.evidence.series[prediction.series];
        // With a discrepancy, the part of the uncertainty that neighbouring values share is not noise.
        let sigma = if self.has_discrepancy {
            &series.noise
        } else {
            &series.sigma
        };
        let of_sensors = self.free.len();
        let reading = self
            .nuisance
            .sensor_output(self.evidence, series, &prediction.value, &x[of_sensors..]);
        let first = residual.len();
        let left = series.value.iter().zip(&reading.value);
        scaled(
            series,
            sigma,
            left.map(|(measured, reading)| measured - reading),
            residual,
        );
        if columns.is_empty() {
            return;
        }
        for column in columns.iter_mut() {
            column.resize(residual.len(), 0.0);
        }
        let mut rows = Vec::with_capacity(residual.len() - first);
        let mut add = |slope: &mut dyn Iterator<Item = Complex<f64>>, place: usize| {
            rows.clear();
            scaled(series, sigma, slope.map(|slope| -slope), &mut rows);
            let sums = columns[place][first..].iter_mut();
            sums.zip(&rows).for_each(|(sum, row)| *sum += row);
        };
        let one_sided = is_one_sided(&self.evidence.runs[series.run]);
        for (k, slope) in prediction.slopes.iter().enumerate() {
            if one_sided && may_differ_by_side(self.model, &self.free[k]) {
                let factor = self.factors(x)[k].exp();
                let of_side = of_sensors + self.nuisance.count() + k;
                add(&mut through(slope, &reading.factor, factor), k);
                add(&mut through(slope, &reading.factor, factor * x[k]), of_side);
            } else {
                add(&mut through(slope, &reading.factor, 1.0), k);
            }
        }
        for (k, slope) in self.nuisance.condition_slopes(self.evidence, prediction) {
            add(&mut through(&slope, &reading.factor, 1.0), of_sensors + k);
        }
        for (k, slope) in reading.slopes {
            add(&mut slope.into_iter(), of_sensors + k);
        }
    }
}

impl Problem for Posterior<'_> {
    fn variables(&self) -> usize {
        self.free.len() + self.sigmas.len()
    }

    fn residuals(&self) -> usize {
        self.residuals + self.sigmas.len() + self.free.len()
    }

    fn evaluate(&mut self, x: &[f64], residual: &mut [f64], jacobian: &mut [f64]) {
        let columns = self.residual_and_slopes(x, residual, true);
        for (k, (column, into)) in columns.iter().zip(jacobian.chunks_mut(residual.len())).enumerate() {
            into.fill(0.0);
            into[..column.len()].copy_from_slice(column);
            match k.checked_sub(self.free.len()) {
                Some(k) => into[self.residuals + k] = 1.0 / self.sigmas[k],
                None => into[self.residuals + self.sigmas.len() + k] = self.prior_of(k, x[k]).1,
            }
        }
    }

    /// The residual alone: derivatives of rides and records by finite differences cost many times more.
    fn evaluate_residual(&mut self, x: &[f64], residual: &mut [f64]) -> bool {
        self.residual_and_slopes(x, residual, false);
        true
    }
}
