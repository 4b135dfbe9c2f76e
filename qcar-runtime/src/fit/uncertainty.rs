//! Standard errors from the Jacobian at the optimum.
//!
//! The covariance is the sum of three parts, all propagated through the Jacobian at the optimum:
//!
//! 1. *Scatter*, from the residuals: `(JᵀJ)⁻¹ S (JᵀJ)⁻¹` with S the sum of outer products of the scores of the
//!    lines. All channels and runs at one line are one cluster; neighbouring lines may be correlated (Newey & West,
//!    "A simple, positive semi-definite, heteroskedasticity and autocorrelation consistent covariance matrix",
//!    Econometrica 55, 1987). So both noise of any spectrum and a smooth misfit of the model count.
//! 2. *Asymmetry*: the two sides of an axle differ, and the model stands for their mean. Half the difference of
//!    the two sides shifts the parameters by about one standard deviation of that mean. It is a single sample, so no
//!    parameter gets less than the typical relative shift of all parameters that are well determined otherwise.
//! 3. *Gains*: the gain of each sensor has a constant error, which may not appear in the residuals.

use super::cost::{GridPlan, Target};
use super::observation::Pair;
use super::setup::Setup;
use crate::least_squares::Outcome;
use crate::least_squares::information::{Information, Unseen, correlation};
use crate::model::{Model, Signal};
use nalgebra::{Complex, DMatrix, DVector};

/// Errors of the free parameters.
pub(super) struct Uncertainty {
    information: Information,
    /// Variances of the determined parameters by cause: scatter, asymmetry, gains.
    parts: [DVector<f64>; 3],
    covariance: DMatrix<f64>,
    /// Typical relative shift by asymmetry; zero if only one side was measured.
    pub asymmetry: f64,
}

/// The standard error of a parameter, total and by cause.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct StandardError {
    /// All causes together.
    pub total: f64,
    /// By the scatter of the residuals.
    pub scatter: f64,
    /// By differences between the sides of the axle.
    pub asymmetry: f64,
    /// By gain errors of the sensors.
    pub gain: f64,
}

pub(super) fn estimate<M: Model + ?Sized>(setup: &Setup<'_, M>, outcome: &Outcome) -> Uncertainty {
    let information = information(outcome);
    let x = DVector::from_iterator(
        information.seen().len(),
        information.seen().iter().map(|&k| outcome.x[k]),
    );
    let scatter = scatter(setup, outcome, &information);
    let gains = gains(setup, outcome, &information);
    let others = scatter.diagonal() + gains.diagonal();
    let (asymmetric, asymmetry) = asymmetry(setup, outcome, &information, &x, &others);
    let parts = [scatter.diagonal(), asymmetric.diagonal(), gains.diagonal()];
    Uncertainty {
        information,
        parts,
        covariance: scatter + asymmetric + gains,
        asymmetry,
    }
}

/// Information of the Jacobian about the variables inside their bounds.
pub(super) fn information(outcome: &Outcome) -> Information {
    let free: Vec<bool> = outcome.at_bound.iter().map(|&bound| bound == 0).collect();
    Information::new(&outcome.jacobian, &free)
}

impl Uncertainty {
    /// Standard error of a free parameter; `None` if it has none.
    pub fn standard_error(&self, variable: usize) -> Option<StandardError> {
        let place = self.information.seen().iter().position(|&k| k == variable)?;
        let part = |k: usize| self.parts[k][place].max(0.0).sqrt();
        let total = self.covariance[(place, place)].max(0.0).sqrt();
        Some(StandardError {
            total,
            scatter: part(0),
            asymmetry: part(1),
            gain: part(2),
        })
    }

    /// Variance of a free parameter over that for independent residuals of unit variance; `None` if it has none.
    pub fn inflation(&self, variable: usize) -> Option<f64> {
        let place = self.information.seen().iter().position(|&k| k == variable)?;
        Some(self.covariance[(place, place)] / self.information.inverse()[(place, place)])
    }

    /// Why a free parameter inside its bounds has no standard error; `None` if it has one.
    pub fn unseen(&self, variable: usize) -> Option<&Unseen> {
        self.information.unseen(variable)
    }

    /// Pairs of free parameters whose estimates correlate by more than `least` under independent residuals, with their
    /// correlation.
    pub fn correlations(&self, least: f64) -> Vec<(usize, usize, f64)> {
        let seen = self.information.seen();
        let matrix = correlation(self.information.inverse());
        let pairs = (0..seen.len()).flat_map(|i| (0..i).map(move |j| (j, i)));
        pairs
            .map(|(j, i)| (seen[j], seen[i], matrix[(j, i)]))
            .filter(|pair| pair.2.abs() > least)
            .collect()
    }
}

/// Covariance with lines as independent clusters. A correlation of neighbours may only increase a variance: at the
/// optimum the scores sum to zero, which looks like a negative correlation.
fn scatter<M: Model + ?Sized>(setup: &Setup<'_, M>, outcome: &Outcome, information: &Information) -> DMatrix<f64> {
    let count = information.seen().len();
    let [covariance, long_run] = of_lines((&setup.grids, &setup.targets), outcome, information);
    let growth = |k: usize| {
        if long_run[(k, k)] > covariance[(k, k)] {
            long_run[(k, k)] / covariance[(k, k)]
        } else {
            1.0
        }
    };
    DMatrix::from_fn(count, count, |i, j| covariance[(i, j)] * (growth(i) * growth(j)).sqrt())
}

/// The covariance with lines as independent clusters, and that with neighbours that may be correlated.
fn of_lines(
    (grids, targets): (&[GridPlan], &[Target]),
    outcome: &Outcome,
    information: &Information,
) -> [DMatrix<f64>; 2] {
    let count = information.seen().len();
    let mut sums = [DMatrix::zeros(count, count), DMatrix::zeros(count, count)];
    for grid in 0..grids.len() {
        let lines = unfitted((grids, targets), outcome, information, grid);
        let scores: Vec<DVector<f64>> = lines
            .iter()
            .map(|line| line.slopes.transpose() * &line.residual)
            .collect();
        if !scores.is_empty() {
            let scores = DMatrix::from_columns(&scores);
            sums[0] += &scores * scores.transpose();
            sums[1] += long_run(&scores);
        }
    }
    sums.map(|sum| information.inverse() * sum * information.inverse())
}

/// True if a correlation of neighbouring lines increases the variances, in the mean of all parameters.
pub(super) fn are_neighbours_correlated<M: Model + ?Sized>(
    setup: &Setup<'_, M>,
    outcome: &Outcome,
    information: &Information,
) -> bool {
    let [independent, long_run] =
        of_lines((&setup.grids, &setup.targets), outcome, information).map(|own| own.diagonal());
    let growth = long_run.component_div(&independent);
    growth.iter().any(|growth| growth.is_finite()) && growth.mean() > 1.0
}

/// A line of a grid, in all channels and runs with this line.
pub(super) struct Line {
    /// Rows of its residuals.
    pub rows: Vec<usize>,
    /// Leave-one-out residuals: those of a fit without this line.
    pub residual: DVector<f64>,
    slopes: DMatrix<f64>,
}

/// The lines of a grid.
///
/// The residuals are those of a fit without the line, `(1 − H)⁻¹ r` with its block H of the projection (CR3, MacKinnon
/// & White, "Some heteroskedasticity-consistent covariance matrix estimators with improved finite sample properties",
/// J. Econometrics 29, 1985): the few lines at a resonance determine a parameter, so the fit passes through them.
///
/// It is the same code for all models, so the crate of the fits optimises it, not the one that calls them.
pub(super) fn unfitted(
    (grids, targets): (&[GridPlan], &[Target]),
    outcome: &Outcome,
    information: &Information,
    grid: usize,
) -> Vec<Line> {
    let of_line = |line: usize| {
        let of_grid = targets.iter().filter(|target| target.grid == grid);
        let rows: Vec<usize> = of_grid
            .flat_map(|target| [target.rows().0.start + line, target.rows().1.start + line])
            .collect();
        let slopes = outcome.jacobian.select_rows(&rows).select_columns(information.seen());
        let residual = outcome.residual.select_rows(&rows);
        let free = DMatrix::identity(rows.len(), rows.len()) - &slopes * information.inverse() * slopes.transpose();
        // A line that alone determines a parameter has no residual.
        let residual = free.lu().solve(&residual).unwrap_or(residual);
        Line { rows, residual, slopes }
    };
    (0..grids[grid].frequency.len()).map(of_line).collect()
}

/// Number of neighbours of a line that may be correlated with it.
pub(super) fn lags(lines: usize) -> usize {
    ((lines as f64).sqrt() as usize).min(lines.saturating_sub(1))
}

/// The covariance of the sum of correlated columns, with Bartlett's kernel over the square root of their number.
fn long_run(scores: &DMatrix<f64>) -> DMatrix<f64> {
    let lines = scores.ncols();
    let lags = lags(lines);
    let mut sum = scores * scores.transpose();
    for lag in 1..=lags {
        let shifted = scores.columns(lag, lines - lag) * scores.columns(0, lines - lag).transpose();
        let weight = 1.0 - lag as f64 / (lags + 1) as f64;
        sum += (&shifted + shifted.transpose()) * weight;
    }
    sum
}

/// Covariance by asymmetry, and the typical relative shift; `others` are the variances by the other causes.
fn asymmetry<M: Model + ?Sized>(
    setup: &Setup<'_, M>,
    outcome: &Outcome,
    information: &Information,
    x: &DVector<f64>,
    others: &DVector<f64>,
) -> (DMatrix<f64>, f64) {
    let mut covariance = DMatrix::zeros(x.len(), x.len());
    for pattern in of_sides(setup) {
        let shift = information.shift(&outcome.jacobian, &pattern);
        covariance += &shift * shift.transpose();
    }
    let typical = typical_shift(&covariance.diagonal(), others, x);
    for k in 0..x.len() {
        covariance[(k, k)] = covariance[(k, k)].max((typical * x[k]).powi(2));
    }
    (covariance, typical)
}

/// RMS of the relative shifts. A parameter with small variances by other causes has a larger weight.
fn typical_shift(squares: &DVector<f64>, others: &DVector<f64>, x: &DVector<f64>) -> f64 {
    let precision = x.zip_map(others, |x, other| x * x / other.max(f64::MIN_POSITIVE));
    let relative = squares.zip_map(x, |square, x| square / (x * x));
    if x.is_empty() {
        0.0
    } else {
        (relative.dot(&precision) / precision.sum()).sqrt()
    }
}

fn gains<M: Model + ?Sized>(setup: &Setup<'_, M>, outcome: &Outcome, information: &Information) -> DMatrix<f64> {
    let count = information.seen().len();
    let mut covariance = DMatrix::zeros(count, count);
    for pattern in of_gains(setup) {
        let shift = information.shift(&outcome.jacobian, &pattern);
        covariance += &shift * shift.transpose();
    }
    covariance
}

/// Changes of the residual to be multiplied by normal random numbers: half the difference of each pair of sides, and
/// the gain error of each signal.
pub(super) fn patterns<M: Model + ?Sized>(setup: &Setup<'_, M>) -> Vec<DVector<f64>> {
    of_sides(setup).chain(of_gains(setup)).collect()
}

fn of_sides<M: Model + ?Sized>(setup: &Setup<'_, M>) -> impl Iterator<Item = DVector<f64>> {
    let of_pair = move |pair: Pair| {
        pattern(setup, |target, line| {
            let differences = &setup.observation(target).differences;
            differences
                .iter()
                .filter(|difference| difference.pair == pair)
                .map(|difference| difference.half[line])
                .sum()
        })
    };
    [Pair::LeftRight, Pair::FrontRear].into_iter().map(of_pair)
}

fn of_gains<M: Model + ?Sized>(setup: &Setup<'_, M>) -> impl Iterator<Item = DVector<f64>> {
    let of_signal = move |signal: &Signal| {
        pattern(setup, |target, _| {
            let observation = setup.observation(target);
            let share = |of: &Signal, sensors: usize| {
                if of == signal {
                    1.0 / (sensors as f64).sqrt()
                } else {
                    0.0
                }
            };
            let above = share(&observation.channel.numerator, observation.sensors.0);
            let below = share(&observation.channel.denominator, observation.sensors.1);
            Complex::from(setup.plan.gain_error * (above - below))
        })
    };
    signals(setup).into_iter().map(of_signal)
}

/// The signals of all targets, each once.
fn signals<'a, M: Model + ?Sized>(setup: &'a Setup<'_, M>) -> Vec<&'a Signal> {
    let mut all: Vec<&Signal> = Vec::new();
    for target in 0..setup.targets.len() {
        let channel = &setup.observation(target).channel;
        for signal in [&channel.numerator, &channel.denominator] {
            if !all.contains(&signal) {
                all.push(signal);
            }
        }
    }
    all
}

/// Change of the residual by an error of the measured logarithms, given by target and line.
fn pattern<M: Model + ?Sized>(setup: &Setup<'_, M>, error: impl Fn(usize, usize) -> Complex<f64>) -> DVector<f64> {
    let rows = setup.targets.iter().map(|target| 2 * target.lines()).sum();
    let mut pattern = DVector::zeros(rows);
    for (place, target) in setup.targets.iter().enumerate() {
        let (magnitude, phase) = target.rows();
        for (line, (magnitude, phase)) in magnitude.zip(phase).enumerate() {
            let error = error(place, line);
            pattern[magnitude] = -target.weight.0[line] * error.re;
            pattern[phase] = -target.weight.1[line] * error.im;
        }
    }
    pattern
}
