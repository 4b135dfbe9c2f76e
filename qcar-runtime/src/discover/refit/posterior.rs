//! The least-squares problem of a refit: residuals of the data, whitened by the discrepancy, and behind them those of the
//! priors.

use std::ops::Range;

use nalgebra::{Complex, DMatrix, DVector};

use super::Refit;
use crate::campaign::Role;
use crate::discover::noise::{Discrepancy, Nuisance, STRAINED};
use crate::discover::observe::{Evidence, Free, PredictError, Prediction, Run, Series, Stimulus, predict_sides};
use crate::least_squares::information::Information;
use crate::least_squares::{Bounds, Options, Outcome, Problem, minimize};
use crate::model::Model;
use crate::response::parameters::Values;

/// Standard deviation of the logarithm of a side's factor: parts of one drawing, and springs of one batch.
const SIDE: f64 = 0.015;

/// The most that a side differs by, in standard deviations of its prior: a model that lacks something shall not buy its
/// way out by sides that no car has.
const MOST: f64 = 3.0;

/// The most that the error of a sensor differs from its prior by, in standard deviations, where a discrepancy is fitted: no
/// such error is met in practice, and a search stays where numbers are finite.
const FARTHEST: f64 = 6.0;

/// How far a parameter strays from where a search begins for next to nothing: a factor of ten, or the whole of a range
/// that reaches zero. What a part of the evidence hardly sees stays where all of it looks next.
const STRAY: f64 = std::f64::consts::LN_10;

impl Free {
    /// How far it is from the centre of its prior in standard deviations, and the derivative of that: of a value whose range
    /// lies above zero in its logarithm. The standard deviation is that of a uniform distribution over the range.
    fn prior(&self, value: f64, centre: f64) -> (f64, f64) {
        let of_width = |width: f64| width / 12.0_f64.sqrt();
        if self.lower > 0.0 {
            let sd = of_width((self.upper / self.lower).ln());
            ((value / centre.max(self.lower)).ln() / sd, 1.0 / (value * sd))
        } else {
            let sd = of_width(self.upper - self.lower);
            ((value - centre) / sd, 1.0 / sd)
        }
    }

    /// How far it is from its start, in units of [`STRAY`], and the derivative of that.
    fn strayed(&self, value: f64, start: f64) -> (f64, f64) {
        if self.lower > 0.0 {
            ((value / start.max(self.lower)).ln() / STRAY, 1.0 / (value * STRAY))
        } else {
            let width = self.upper - self.lower;
            ((value - start) / width, 1.0 / width)
        }
    }
}

/// True for a run that records one side of the car.
fn of_one_side(run: &Run) -> bool {
    matches!(run.stimulus, Stimulus::Cleat(_))
}

/// True for a parameter that may differ between the sides of a car.
fn is_of_a_side(model: &dyn Model, free: &Free) -> bool {
    model.about().parameters[free.parameter].unit != "1"
}

/// The rows and columns of some variables of a covariance.
fn spread(information: &Information, variables: Range<usize>) -> DMatrix<f64> {
    let place = |k: usize| information.seen().iter().position(|&seen| seen == variables.start + k);
    DMatrix::from_fn(variables.len(), variables.len(), |i, j| match (place(i), place(j)) {
        (Some(i), Some(j)) => information.inverse()[(i, j)],
        _ => f64::NAN,
    })
}

/// The real residuals of a series: each complex one as its parts, in units of the standard deviation of a part.
pub fn scaled(series: &Series, sigma: &[f64], values: impl Iterator<Item = Complex<f64>>, into: &mut Vec<f64>) {
    let complex = series.kind.complex();
    for (value, sigma) in values.zip(sigma) {
        if complex {
            let scale = std::f64::consts::SQRT_2 / sigma;
            into.extend([value.re * scale, value.im * scale]);
        } else {
            into.push(value.re / sigma);
        }
    }
}

/// A slope by the factors with which a sensor shows it, scaled.
fn through(slope: &[Complex<f64>], factors: &[Complex<f64>], scale: f64) -> impl Iterator<Item = Complex<f64>> {
    slope
        .iter()
        .zip(factors)
        .map(move |(slope, factor)| slope * factor * scale)
}

/// True for a run whose derivatives cost little beside its prediction: a sweep's come from the same factorisation.
fn is_swept(run: &Run) -> bool {
    matches!(run.stimulus, Stimulus::Sweep { .. })
}

/// The least-squares problem.
pub struct Posterior<'a> {
    model: &'a dyn Model,
    values: Values,
    pub side: Values,
    free: Vec<Free>,
    evidence: &'a Evidence,
    pub nuisance: Nuisance,
    /// Of the sensors' errors, then of the factors of the recorded side, where there is one.
    sigmas: Vec<f64>,
    /// Where the search began.
    start: Vec<f64>,
    /// Where the priors of the parameters are centred, where there is a discrepancy,
    pub centre: Values,
    /// and what that is.
    pub discrepancy: Option<Discrepancy>,
    /// Whether residuals are independent by it,
    whitens: bool,
    /// and whether there is one at all, whatever it is at the moment.
    pub by_evidence: bool,
    pub residuals: usize,
    /// Why the model cannot say anything of the evidence at all,
    refused: Option<PredictError>,
    /// or that it has said something: where it gives no number from then on, a step went too far.
    has_answered: bool,
    /// What the sweeps add to their balance, series by series.
    pub unsteady: Vec<Vec<Complex<f64>>>,
    /// Where the residual was looked at last, and what sweeps show there: a step that is taken asks for it again.
    looked: Option<(Vec<f64>, Vec<Prediction>)>,
}

impl<'a> Posterior<'a> {
    pub fn new(
        model: &'a dyn Model,
        values: Values,
        free: &[Free],
        evidence: &'a Evidence,
        nuisance: Nuisance,
    ) -> Self {
        let one_sided = evidence.runs.iter().any(of_one_side);
        let sides = std::iter::repeat_n(SIDE, if one_sided { free.len() } else { 0 });
        Self {
            model,
            side: values.clone(),
            free: free.to_vec(),
            evidence,
            sigmas: nuisance.sigmas().into_iter().chain(sides).collect(),
            start: Vec::new(),
            centre: values.clone(),
            discrepancy: None,
            whitens: true,
            by_evidence: false,
            residuals: evidence.of_role(Role::Fit).map(|(_, series)| series.residuals()).sum(),
            nuisance,
            refused: None,
            has_answered: false,
            unsteady: vec![Vec::new(); evidence.series.len()],
            looked: None,
            values,
        }
    }

    /// At a refit that was made of this evidence, or of another part of it.
    pub fn of(refit: &Refit, model: &'a dyn Model, evidence: &'a Evidence) -> Self {
        let mut posterior = Self::new(
            model,
            refit.values.clone(),
            &refit.free,
            evidence,
            refit.nuisance.clone(),
        );
        posterior.discrepancy = refit.discrepancy_of(evidence);
        posterior.by_evidence = posterior.discrepancy.is_some();
        posterior.centre = refit.centre.clone();
        posterior
    }

    /// Searches and learns the discrepancy in turn.
    pub fn fit(&mut self, mut place: Vec<f64>, rounds: usize, evaluations: usize) -> Result<Refit, PredictError> {
        let mut outcome = self.search(&place, evaluations)?;
        for round in 0..rounds {
            if round > 0 {
                outcome = self.search(&place, evaluations)?;
            }
            place.clone_from(&outcome.x);
            self.learn(&place);
        }
        let mut residual = DVector::zeros(self.residuals());
        let mut jacobian = DMatrix::zeros(self.residuals(), self.variables());
        self.evaluate(&place, residual.as_mut_slice(), jacobian.as_mut_slice());
        // What the discrepancy takes up is no gain of the search.
        outcome.start_cost += residual.norm_squared() / 2.0 - outcome.cost;
        outcome.cost = residual.norm_squared() / 2.0;
        outcome.jacobian = jacobian;
        Ok(self.refit(outcome))
    }

    /// The discrepancy that explains best what is left.
    pub fn learn(&mut self, place: &[f64]) {
        let Some(mut discrepancy) = self.discrepancy.take() else {
            return;
        };
        let mut residual = vec![0.0; self.residuals()];
        self.look(place, &mut residual, false);
        residual.truncate(self.residuals);
        if residual.iter().all(|r| r.is_finite()) {
            discrepancy.learn(&residual);
        }
        self.discrepancy = Some(discrepancy);
    }

    /// Laplace's approximation of the evidence, in units in which every prior has the standard deviation one: it cancels
    /// the normalisations of priors and posterior but for the determinant (MacKay 2003, chapter 28).
    fn log_evidence(&self, outcome: &Outcome) -> f64 {
        let Some(discrepancy) = &self.discrepancy else {
            return f64::NAN;
        };
        let mut scaled = outcome.jacobian.clone();
        for (k, mut column) in scaled.column_iter_mut().enumerate() {
            column *= match k.checked_sub(self.free.len()) {
                Some(k) => self.sigmas[k],
                None => 1.0 / self.prior_of(k, outcome.x[k]).1,
            };
        }
        let hessian = scaled.tr_mul(&scaled);
        let determinant = hessian
            .cholesky()
            .map_or(f64::NAN, |own| own.l_dirty().diagonal().map(f64::ln).sum());
        -outcome.cost - discrepancy.cost() - determinant
    }

    /// How far a free parameter is from where its prior has it, and the derivative of that.
    fn prior_of(&self, k: usize, value: f64) -> (f64, f64) {
        match self.discrepancy {
            Some(_) => self.free[k].prior(value, self.centre.as_slice()[self.free[k].parameter]),
            None => self.free[k].strayed(value, self.start[k]),
        }
    }

    /// The best place that is found from `start`.
    pub fn search(&mut self, start: &[f64], evaluations: usize) -> Result<Outcome, PredictError> {
        let options = Options {
            gradient: 1e-5,
            cost: 1e-6,
            step: 1e-6,
            evaluations,
        };
        let (sensors, sides) = self.sigmas.split_at(self.nuisance.len());
        let sides = sides.iter().map(|sigma| MOST * sigma);
        // Beside a discrepancy a prior alone holds the errors of sensors.
        let strained = if self.discrepancy.is_some() { FARTHEST } else { STRAINED };
        let priors: Vec<f64> = sensors.iter().map(|sigma| strained * sigma).chain(sides).collect();
        let lower = self.free.iter().map(|f| f.lower).chain(priors.iter().map(|most| -most));
        let upper = self.free.iter().map(|f| f.upper).chain(priors.iter().copied());
        let bounds = Bounds {
            lower: lower.collect(),
            upper: upper.collect(),
        };
        self.start = start.to_vec();
        self.looked = None;
        let outcome = minimize(self, start, &bounds, &options);
        self.refused.take().map_or(Ok(outcome), Err)
    }

    /// What was found.
    pub fn refit(&mut self, outcome: Outcome) -> Refit {
        let count = self.free.len();
        let inside: Vec<bool> = outcome.at_bound.iter().map(|&side| side == 0).collect();
        // Not knowing where a parameter is tells nothing of where it is.
        let told = outcome
            .jacobian
            .rows(0, self.residuals + self.sigmas.len())
            .into_owned();
        let information = Information::new(&told, &inside);
        self.move_to(&outcome.x);
        Refit {
            values: self.values.clone(),
            side: self.side.clone(),
            estimate: outcome.x[..count].to_vec(),
            covariance: spread(&information, 0..count),
            coefficient_stderr: self.coefficient_stderr(&information),
            at_bound: outcome.at_bound[..count].to_vec(),
            free: self.free.clone(),
            coefficients: outcome.x[count..][..self.nuisance.len()].to_vec(),
            chi2: 2.0 * outcome.cost,
            gained: outcome.start_cost - outcome.cost,
            log_evidence: self.log_evidence(&outcome),
            discrepancy: self.discrepancy.clone(),
            centre: self.centre.clone(),
            residuals: self.residuals,
            made: if self.evidence.two_sided {
                SIDE / f64::sqrt(2.0)
            } else {
                0.0
            },
            unsteady: self.unsteady.clone(),
            nuisance: self.nuisance.clone(),
            evaluations: outcome.evaluations,
            stop: outcome.stop,
        }
    }

    fn coefficient_stderr(&self, information: &Information) -> Vec<f64> {
        let coefficients = self.free.len()..self.variables();
        let errors = spread(information, coefficients).diagonal().map(f64::sqrt);
        errors.as_slice().to_vec()
    }

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

    /// The place of a refit.
    pub fn place(&self, refit: &Refit) -> Vec<f64> {
        let factors = self.free.iter().map(|free| refit.factor(free.parameter));
        let place = refit.estimate.iter().chain(&refit.coefficients).copied();
        place.chain(factors).take(self.variables()).collect()
    }

    fn move_to(&mut self, x: &[f64]) {
        let factors = self.factors(x).to_vec();
        for (k, (free, &value)) in self.free.iter().zip(x).enumerate() {
            self.values.set(free.parameter, value);
            let factor = factors.get(k).copied().filter(|_| is_of_a_side(self.model, free));
            self.side.set(free.parameter, value * factor.unwrap_or(0.0).exp());
        }
    }

    /// The logarithms of the factors of the recorded side.
    fn factors<'x>(&self, x: &'x [f64]) -> &'x [f64] {
        &x[self.free.len() + self.nuisance.len()..]
    }

    /// What the model says of the fitted runs: of the sweeps, and of all others, these differentiated along `free`.
    fn predictions(&mut self, x: &[f64], free: &[Free]) -> Result<[Vec<Prediction>; 2], PredictError> {
        self.move_to(x);
        let both = [&self.values, &self.side];
        let misread = self.nuisance.misread(self.evidence, &x[self.free.len()..]);
        let predict = |free: &[Free], swept: bool| {
            let wanted = |run: &Run| run.role == Role::Fit && is_swept(run) == swept;
            predict_sides(self.model, both, &misread, free, self.evidence, &wanted)
        };
        let swept = match self.looked.take().filter(|(at, _)| at == x) {
            Some((_, swept)) => swept,
            None => {
                let mut swept = predict(&self.free, true)?;
                swept.iter_mut().for_each(|own| own.add(&self.unsteady[own.series]));
                swept
            }
        };
        Ok([swept, predict(free, false)?])
    }

    /// Writes the residual, and gives the columns of the Jacobian, of the data alone, where they are wanted.
    pub fn look(&mut self, x: &[f64], residual: &mut [f64], sloped: bool) -> Vec<Vec<f64>> {
        let free = if sloped { self.free.clone() } else { Vec::new() };
        let [swept, others] = match self.predictions(x, &free) {
            Ok(predictions) => predictions,
            Err(error) => {
                self.refused = (!self.has_answered).then_some(error);
                residual.fill(f64::NAN);
                return Vec::new();
            }
        };
        self.has_answered = true;
        let mut predictions: Vec<&Prediction> = swept.iter().chain(&others).collect();
        predictions.sort_by_key(|own| own.series);
        let mut rows = Vec::with_capacity(residual.len());
        let count = if sloped { self.variables() } else { 0 };
        let mut columns: Vec<Vec<f64>> = (0..count).map(|_| Vec::with_capacity(residual.len())).collect();
        for prediction in predictions {
            self.rows(prediction, x, &mut rows, &mut columns);
        }
        self.looked = Some((x.to_vec(), swept));
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

    /// Adds the rows of one prediction to columns that grow together. A column may be moved in more ways than one: the gain
    /// of a reference scales what is shown, and says how hard the run was driven. Without columns there is the residual
    /// alone.
    fn rows(&self, prediction: &Prediction, x: &[f64], residual: &mut Vec<f64>, columns: &mut [Vec<f64>]) {
        let series = &self.evidence.series[prediction.series];
        // Beside a discrepancy, what neighbours have in common is not noise.
        let sigma = if self.by_evidence { &series.noise } else { &series.sigma };
        let of_sensors = self.free.len();
        let shown = self
            .nuisance
            .show(self.evidence, series, &prediction.value, &x[of_sensors..]);
        let first = residual.len();
        let left = series.value.iter().zip(&shown.value);
        scaled(series, sigma, left.map(|(measured, shown)| measured - shown), residual);
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
        let one_sided = of_one_side(&self.evidence.runs[series.run]);
        for (k, slope) in prediction.slopes.iter().enumerate() {
            if one_sided && is_of_a_side(self.model, &self.free[k]) {
                let factor = self.factors(x)[k].exp();
                let of_side = of_sensors + self.nuisance.len() + k;
                add(&mut through(slope, &shown.factor, factor), k);
                add(&mut through(slope, &shown.factor, factor * x[k]), of_side);
            } else {
                add(&mut through(slope, &shown.factor, 1.0), k);
            }
        }
        for (k, slope) in self.nuisance.misread_slopes(self.evidence, prediction) {
            add(&mut through(&slope, &shown.factor, 1.0), of_sensors + k);
        }
        for (k, slope) in shown.slopes {
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
        let columns = self.look(x, residual, true);
        for (k, (column, into)) in columns.iter().zip(jacobian.chunks_mut(residual.len())).enumerate() {
            into.fill(0.0);
            into[..column.len()].copy_from_slice(column);
            match k.checked_sub(self.free.len()) {
                Some(k) => into[self.residuals + k] = 1.0 / self.sigmas[k],
                None => into[self.residuals + self.sigmas.len() + k] = self.prior_of(k, x[k]).1,
            }
        }
    }

    /// Differentiated by differences, rides and histories cost many times more than alone.
    fn evaluate_residual(&mut self, x: &[f64], residual: &mut [f64]) -> bool {
        self.look(x, residual, false);
        true
    }
}
