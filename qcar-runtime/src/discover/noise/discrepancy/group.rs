//! The series of one sensor in one kind of run, which have a discrepancy in common.

use std::mem::Discriminant;
use std::ops::Range;

use super::banded::Banded;
use super::value::{Value, runs};
use crate::discover::numbers::Numbers;
use crate::discover::observe::{Kind, Stimulus};
use crate::transmissibility::Point;

/// The series of one sensor in one kind of run.
#[derive(Clone, Debug)]
pub struct Group {
    pub key: Key,
    /// For each value, in the order of where it stands, the rows of its real parts among the residuals.
    rows: Vec<[usize; 2]>,
    /// How many values stand within each distance at which correlation ends, in the same order.
    cells: Vec<usize>,
    /// Rows of a value: two where it is complex.
    parts: usize,
    /// What the evidence of each run counts: a tyre's law is wrong in all rides alike, and moves all masses along an axis by
    /// one force, so that all of these count as one.
    weight: f64,
    /// The correlation, in units of the noise, for a `τ` of one.
    correlation: Banded,
    /// The least that any model misses,
    least: f64,
    /// and what is expected before any measurement.
    expected: f64,
    pub tau: f64,
    /// Cholesky factor of the covariance in units of the noise; `None` without discrepancy.
    factor: Option<Banded>,
}

/// What tells groups apart.
#[derive(Clone, Debug, PartialEq)]
pub struct Key {
    pub sensor: Point,
    pub kind: Kind,
    pub run: Discriminant<Stimulus>,
}

impl Key {
    /// True for what sensors along the same axis give in runs of the same kind, the sensor itself included.
    pub fn is_beside(&self, other: &Key) -> bool {
        (self.sensor.axis, self.kind, self.run) == (other.sensor.axis, other.kind, other.run)
    }
}

/// Steps of the search for `τ`, and the least that differs from zero.
const STEPS: usize = 12;
const LEAST: f64 = 1e-4;
const MOST: f64 = 2.0;

impl Group {
    /// Of so many sensors that see the same force.
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
            correlation: Banded::new(values.len(), correlated, entry),
            least,
            expected: numbers.expected_discrepancy,
            tau: 0.0,
            factor: None,
        };
        group.set(least);
        group
    }

    pub fn set(&mut self, tau: f64) {
        self.tau = tau;
        self.factor = (tau > 0.0).then(|| self.factor(tau));
    }

    /// Minus the logarithm of the prior of `τ`, but for a constant: an exponential law, which allows zero.
    pub fn prior(&self, tau: f64) -> f64 {
        tau / self.expected
    }

    fn factor(&self, tau: f64) -> Banded {
        self.correlation.scaled_beside_one(tau * tau).cholesky()
    }

    /// Half the logarithm of the determinant of the covariance of all parts.
    pub fn log_determinant(&self) -> f64 {
        let of_part: f64 = self.factor.iter().flat_map(Banded::log_diagonal).sum();
        self.weight * self.parts as f64 * of_part
    }

    /// Logarithm of the likelihood of whitened residuals, but for a constant, cell by cell: each given the cells before it.
    pub fn log_likelihoods(&self, whitened: &[f64]) -> Vec<f64> {
        let mut determinant = self.factor.iter().flat_map(Banded::log_diagonal);
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

    /// Minus the logarithm of the likelihood of residuals and the prior, but for a constant.
    fn cost(&self, tau: f64, residual: &[Vec<f64>]) -> f64 {
        let square = |values: &[f64]| self.weight * values.iter().map(|value| value * value).sum::<f64>() / 2.0;
        if tau == 0.0 {
            return residual.iter().map(|part| square(part)).sum();
        }
        let factor = self.factor(tau);
        let of_part = |part: &Vec<f64>| {
            let mut values = part.clone();
            factor.forward(&mut values);
            square(&values) + self.weight * factor.log_diagonal().sum::<f64>()
        };
        residual.iter().map(of_part).sum::<f64>() + self.prior(tau)
    }

    /// Golden section over the logarithm of `τ`, then against none at all.
    pub fn learn(&mut self, residual: &[f64]) {
        let part = |part: usize| self.rows.iter().map(|rows| residual[rows[part]]).collect();
        let residual: Vec<Vec<f64>> = (0..self.parts).map(part).collect();
        let cost = |log: f64| self.cost(log.exp(), &residual);
        let golden = (5.0_f64.sqrt() - 1.0) / 2.0;
        let (mut low, mut high) = (LEAST.max(self.least).ln(), MOST.ln());
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
        let tau = if least < self.cost(self.least, &residual) {
            log.exp()
        } else {
            self.least
        };
        self.set(tau);
    }
}

/// How much two discrepancies have in common, by their distance: Wendland's functions, positive definite and zero from one
/// on. A record may jump where a law does, with all its harmonics: φ₃,₀ is continuous. Anything else is smooth: φ₃,₁ is twice
/// continuously differentiable.
fn correlation(kind: Kind, r: f64) -> f64 {
    match kind {
        _ if r >= 1.0 => 0.0,
        Kind::Time => (1.0 - r).powi(2),
        _ => (1.0 - r).powi(4) * (4.0 * r + 1.0),
    }
}

#[cfg(test)]
mod tests;
