//! The series of one sensor in one kind of run, which share a discrepancy.

use std::mem::Discriminant;
use std::ops::Range;
use std::sync::Arc;

use super::banded::Banded;
use super::value::{Value, runs};
use crate::discover::numbers::Numbers;
use crate::discover::observe::{Kind, Stimulus};
use crate::transmissibility::Point;

/// The series of one sensor in one kind of run.
#[derive(Clone, Debug)]
pub struct Group {
    pub key: Key,
    /// Residual rows of each value, in the order of its position.
    rows: Arc<[[usize; 2]]>,
    /// Number of values in each correlation length, in the same order.
    cells: Arc<[usize]>,
    /// Number of residual rows of a value: two if it is complex.
    parts: usize,
    /// Weight of the log likelihood of each series. An error of the tyre law is the same in all cleat runs, and one
    /// force moves all masses along an axis, so all series of cleat runs along one axis together count as one.
    weight: f64,
    /// Covariance in units of the noise for `τ` = 1.
    correlation: Arc<Banded>,
    /// Smallest `τ`.
    least: f64,
    /// Mean of the exponential prior of `τ`.
    expected: f64,
    pub tau: f64,
    /// Cholesky factor of the covariance in units of the noise; `None` if `τ` is zero.
    factor: Option<Arc<Banded>>,
}

/// Identity of a group.
#[derive(Clone, Debug, PartialEq)]
pub struct Key {
    pub sensor: Point,
    pub kind: Kind,
    pub run: Discriminant<Stimulus>,
}

impl Key {
    /// True for a group of the same axis, kind and type of run, including the group itself.
    pub fn has_same_axis_and_kind(&self, other: &Key) -> bool {
        (&self.sensor.axis, self.kind, self.run) == (&other.sensor.axis, other.kind, other.run)
    }
}

/// Steps of the search for `τ`: they leave an interval of 3 % of `τ`.
const STEPS: usize = 12;
/// Smallest nonzero `τ` of the search, below the noise of a 12-bit converter.
const SMALLEST_TAU: f64 = 1e-4;
/// Largest `τ` of the search: such a model explains nothing of the signal.
const LARGEST_TAU: f64 = 2.0;

impl Group {
    /// A group at its smallest `τ`. `sensors` is the number of sensors that respond to the same force.
    pub fn new(key: Key, sensors: usize, least: f64, mut values: Vec<Value>, numbers: &Numbers) -> Self {
        values.sort_by(|a, b| a.place.total_cmp(&b.place));
        let correlated = |row: usize| -> Range<usize> {
            values[..row].partition_point(|other| values[row].place - other.place >= 1.0)..row + 1
        };
        let kind = key.kind;
        let entry = |row: usize, column: usize| {
            let (a, b) = (&values[row], &values[column]);
            let levels = if a.run == b.run { 1.0 } else { numbers.common_to_levels };
            a.scale * b.scale * levels * correlation(kind, (a.place - b.place).abs())
        };
        let weight = match kind {
            Kind::Passage => 1.0 / (sensors * runs(&values)) as f64,
            _ => 1.0,
        };
        let mut group = Self {
            key,
            weight,
            rows: values.iter().map(|value| value.rows).collect(),
            cells: values
                .chunk_by(|a, b| a.place.floor() == b.place.floor())
                .map(<[Value]>::len)
                .collect(),
            parts: values.first().map_or(1, |value| value.parts),
            correlation: Arc::new(Banded::new(values.len(), correlated, entry)),
            least,
            expected: numbers.expected_discrepancy,
            tau: 0.0,
            factor: None,
        };
        group.set(least);
        group
    }

    pub fn set(&mut self, tau: f64) {
        self.factor = (tau > 0.0).then(|| Arc::new(self.factor(tau)));
        self.tau = tau;
    }

    /// Negative log prior of `τ`, up to a constant. The prior is exponential, so it allows zero.
    pub fn prior(&self, tau: f64) -> f64 {
        tau / self.expected
    }

    /// Cholesky factor of the covariance in units of the noise for this `τ`.
    pub fn factor(&self, tau: f64) -> Banded {
        self.correlation.identity_plus(tau * tau).cholesky()
    }

    /// Half the log determinant of the covariance of all parts.
    pub fn log_determinant(&self) -> f64 {
        let of_part: f64 = self.factor.iter().flat_map(|factor| factor.log_diagonal()).sum();
        self.weight * self.parts as f64 * of_part
    }

    /// Log likelihood of whitened residuals, up to a constant, for each correlation length given those before it.
    pub fn log_likelihoods(&self, whitened: &[f64]) -> Vec<f64> {
        let mut determinant = self.factor.iter().flat_map(|factor| factor.log_diagonal());
        let mut rows = self.rows.iter();
        let of_value = |rows: &[usize; 2]| {
            let square: f64 = rows[..self.parts].iter().map(|&row| whitened[row].powi(2)).sum();
            -square / 2.0 - self.weight * self.parts as f64 * determinant.next().unwrap_or(0.0)
        };
        let mut of_values = rows.by_ref().map(of_value);
        let of_cell = |&count: &usize| of_values.by_ref().take(count).sum();
        self.cells.iter().map(of_cell).collect()
    }

    pub fn whiten(&self, column: &mut [f64]) {
        if self.factor.is_none() && self.weight == 1.0 {
            return;
        }
        let weight = self.weight.sqrt();
        for part in 0..self.parts {
            let mut values: Vec<f64> = self.rows.iter().map(|rows| column[rows[part]]).collect();
            if values.iter().all(|value| *value == 0.0) {
                continue;
            }
            self.factor.iter().for_each(|factor| factor.forward(&mut values));
            let rows = self.rows.iter().map(|rows| rows[part]);
            rows.zip(values).for_each(|(row, value)| column[row] = weight * value);
        }
    }

    /// Negative log likelihood of residuals plus the negative log prior, up to a constant.
    fn cost(&self, tau: f64, residual: &[Vec<f64>], factor: impl Fn(f64) -> Arc<Banded>) -> f64 {
        let square = |values: &[f64]| self.weight * values.iter().map(|value| value * value).sum::<f64>() / 2.0;
        if tau == 0.0 {
            return residual.iter().map(|part| square(part)).sum();
        }
        let factor = factor(tau);
        let of_part = |part: &Vec<f64>| {
            let mut values = part.clone();
            factor.forward(&mut values);
            square(&values) + self.weight * factor.log_diagonal().sum::<f64>()
        };
        residual.iter().map(of_part).sum::<f64>() + self.prior(tau)
    }

    /// Sets `τ` to its most probable value: golden section over log `τ`, compared with the smallest `τ`. `factor` gives
    /// [`Self::factor`] of any `τ`.
    pub fn estimate(&mut self, residual: &[f64], factor: impl Fn(&Self, f64) -> Arc<Banded>) {
        let part = |part: usize| self.rows.iter().map(|rows| residual[rows[part]]).collect();
        let residual: Vec<Vec<f64>> = (0..self.parts).map(part).collect();
        let factor = |tau: f64| factor(self, tau);
        let cost = |log: f64| self.cost(log.exp(), &residual, factor);
        let golden = (5.0_f64.sqrt() - 1.0) / 2.0;
        let (mut low, mut high) = (SMALLEST_TAU.max(self.least).ln(), LARGEST_TAU.ln());
        let mut inner = [high - golden * (high - low), low + golden * (high - low)];
        let mut costs = inner.map(cost);
        for _ in 0..STEPS {
            if costs[0] < costs[1] {
                high = inner[1];
                inner = [high - golden * (high - low), inner[0]];
                costs = [cost(inner[0]), costs[0]];
            } else {
                low = inner[0];
                inner = [inner[1], low + golden * (high - low)];
                costs = [costs[1], cost(inner[1])];
            }
        }
        let (log, least) = if costs[0] < costs[1] {
            (inner[0], costs[0])
        } else {
            (inner[1], costs[1])
        };
        let tau = if least < self.cost(self.least, &residual, factor) {
            log.exp()
        } else {
            self.least
        };
        self.factor = (tau > 0.0).then(|| factor(tau));
        self.tau = tau;
    }
}

/// Correlation of two discrepancies at distance `r`, by Wendland's functions: positive definite, and zero from `r` = 1
/// on. A discontinuous law makes the samples of a record jump, so they get φ₃,₀, which is only continuous. All other
/// kinds are smooth and get φ₃,₁, which is twice continuously differentiable.
fn correlation(kind: Kind, r: f64) -> f64 {
    match kind {
        _ if r >= 1.0 => 0.0,
        Kind::Time => (1.0 - r).powi(2),
        _ => (1.0 - r).powi(4) * (4.0 * r + 1.0),
    }
}

#[cfg(test)]
mod tests;
