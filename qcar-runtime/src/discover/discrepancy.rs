//! What any model of this kind misses: an error of the model that is smooth in frequency, in time or in travel.
//!
//! A measured value is `y = f(θ) + J_b b + J_s s + δ + ε`. Sensor noise `ε` is independent from value to value, the errors
//! `b` of sensors and the differences `s` of the sides are nuisance parameters of the fit, and `δ` is the discrepancy: a
//! Gaussian process for each group of series (one sensor in one kind of run), with a standard deviation `τ` in parts of
//! the signal (Kennedy and O'Hagan, Bayesian calibration of computer models, J. R. Stat. Soc. B 63, 2001). The fit
//! whitens its residuals by the Cholesky factor of the covariance `diag σ² + τ² K`. Correlation ends at a distance
//! (Wendland, Advances in Computational Mathematics 4, 1995), so that the factor is banded and costs
//! little.
//!
//! On a clean simulated campaign every `τ` goes to zero and residuals count in units of noise; on hardware `τ` is what
//! the model leaves, and one formula judges both.

// A symmetric matrix whose rows begin late, and its Cholesky factor.
mod banded;

use std::mem::{Discriminant, discriminant};
use std::ops::Range;

use banded::Banded;

use super::numbers::Numbers;
use super::observe::{Evidence, Kind, Series, Stimulus};
use crate::campaign::Role;
use crate::transmissibility::Point;

/// What every group of series may miss, and how much of that is assumed.
#[derive(Clone, Debug)]
pub struct Discrepancy {
    groups: Vec<Group>,
}

/// The series of one sensor in one kind of run.
#[derive(Clone, Debug)]
struct Group {
    key: Key,
    /// For each value, in the order of where it stands, the rows of its real parts among the residuals.
    rows: Vec<[usize; 2]>,
    /// Rows of a value: two where it is complex.
    parts: usize,
    /// What the evidence of each run counts: a tyre's law is wrong in all rides alike, so that all of them count as one.
    weight: f64,
    /// The correlation, in units of the noise, for a `τ` of one.
    correlation: Banded,
    /// The least that any model misses,
    least: f64,
    /// and what is expected before any measurement.
    expected: f64,
    tau: f64,
    /// Cholesky factor of the covariance in units of the noise; `None` without discrepancy.
    factor: Option<Banded>,
}

/// What tells groups apart.
#[derive(Clone, Debug, PartialEq)]
struct Key {
    sensor: Point,
    kind: Kind,
    run: Discriminant<Stimulus>,
}

/// What a group was found to miss.
#[derive(Clone, Debug, PartialEq)]
pub struct Missed {
    /// The sensor.
    pub sensor: Point,
    /// What its values are.
    pub kind: Kind,
    /// Standard deviation of the discrepancy in parts of the signal.
    pub tau: f64,
}

/// Steps of the search for `τ`, and the least that differs from zero.
const STEPS: usize = 12;
const LEAST: f64 = 1e-4;
const MOST: f64 = 2.0;

impl Discrepancy {
    /// The groups of the runs of one role, all with the least discrepancy.
    pub fn of(evidence: &Evidence, role: Role) -> Self {
        let mut rows = 0;
        let mut groups: Vec<(Key, f64, Vec<Value>)> = Vec::new();
        for (_, series) in evidence.of_role(role) {
            let key = Key {
                sensor: series.sensor.clone(),
                kind: series.kind,
                run: discriminant(&evidence.runs[series.run].stimulus),
            };
            let values = values(evidence, series, rows);
            rows += series.residuals();
            match groups.iter_mut().find(|(known, ..)| *known == key) {
                Some((_, least, members)) => {
                    *least = least.max(series.least_discrepancy);
                    members.extend(values);
                }
                None => groups.push((key, series.least_discrepancy, values)),
            }
        }
        let groups = groups
            .into_iter()
            .map(|(key, least, values)| Group::new(key, least, values, &evidence.numbers));
        Self {
            groups: groups.collect(),
        }
    }

    /// The same groups of other evidence, or of other runs, with as much discrepancy as here.
    pub fn carried_to(&self, evidence: &Evidence, role: Role) -> Self {
        let mut carried = Self::of(evidence, role);
        for group in &mut carried.groups {
            if let Some(known) = self.groups.iter().find(|known| known.key == group.key) {
                group.set(known.tau);
            }
        }
        carried
    }

    /// Turns residuals of the data, in units of their noise, into independent ones of unit variance.
    pub fn whiten(&self, column: &mut [f64]) {
        for group in &self.groups {
            group.whiten(column);
        }
    }

    /// Half the logarithm of the determinant of the covariance, less the logarithm of the prior of every `τ`.
    pub fn cost(&self) -> f64 {
        self.groups
            .iter()
            .map(|group| group.log_determinant() + group.prior(group.tau))
            .sum()
    }

    /// Logarithm of the likelihood of residuals of the data (in units of their noise), but for a constant.
    pub fn log_likelihood(&self, mut residual: Vec<f64>) -> f64 {
        self.whiten(&mut residual);
        let square: f64 = residual.iter().map(|value| value * value).sum();
        let determinant: f64 = self.groups.iter().map(Group::log_determinant).sum();
        -square / 2.0 - determinant
    }

    /// Sets every `τ` to what explains these residuals of the data (in units of their noise) best.
    pub fn learn(&mut self, residual: &[f64]) {
        for group in &mut self.groups {
            group.learn(residual);
        }
    }

    /// What each group was found to miss.
    pub fn missed(&self) -> impl Iterator<Item = Missed> {
        self.groups.iter().map(|group| Missed {
            sensor: group.key.sensor.clone(),
            kind: group.key.kind,
            tau: group.tau,
        })
    }
}

/// A value of a group.
struct Value {
    run: usize,
    /// Where it stands, in units of the distance at which correlation ends.
    place: f64,
    rows: [usize; 2],
    parts: usize,
    /// The signal there over the noise.
    scale: f64,
}

/// The values of a series whose first residual stands in row `first`.
fn values(evidence: &Evidence, series: &Series, first: usize) -> Vec<Value> {
    let parts = if series.kind.complex() { 2 } else { 1 };
    let (places, signal) = (places(series, &evidence.numbers), signal(evidence, series));
    let of = |k: usize| Value {
        run: series.run,
        place: places[k],
        rows: [first + k * parts, first + k * parts + parts - 1],
        parts,
        scale: signal[k] / series.noise[k],
    };
    (0..series.at.len()).map(of).collect()
}

/// Where the values of a series stand, in units of the distance at which correlation ends: of harmonics a part of an
/// octave, of records half a period of their own mean frequency, of a cycle of travel a quarter of it.
fn places(series: &Series, numbers: &Numbers) -> Vec<f64> {
    let distance = match series.kind {
        Kind::Harmonic(_) | Kind::Cycle(_) => {
            let octaves = series.at.iter().map(|at| at.log2());
            return octaves.map(|at| at / numbers.correlation_octaves).collect();
        }
        Kind::Travel | Kind::Width => (series.at[series.at.len() - 1] - series.at[0]) / 4.0,
        Kind::Time | Kind::Passage => series.half_a_period(),
    };
    let distance = distance.max(f64::MIN_POSITIVE);
    let apart = match series.kind {
        Kind::Time | Kind::Passage => RECORDS_APART * series.run as f64,
        _ => 0.0,
    };
    series
        .at
        .iter()
        .map(|at| apart + (at - series.at[0]) / distance)
        .collect()
}

/// Two records have no time in common: they stand so far apart.
const RECORDS_APART: f64 = 1e6;

/// What a discrepancy is a part of: of harmonics the first one of the same sensor at the same frequency, of anything else
/// the RMS value of the series around.
fn signal(evidence: &Evidence, series: &Series) -> Vec<f64> {
    let fundamental = |order: usize| {
        let first = match series.kind {
            Kind::Cycle(_) => Kind::Cycle(1),
            _ => Kind::Harmonic(1),
        };
        let is_it = |other: &&Series| other.run == series.run && other.sensor == series.sensor && other.kind == first;
        evidence.series.iter().find(is_it).filter(|_| order > 1)
    };
    let own: Vec<f64> = series.value.iter().map(|value| value.norm()).collect();
    match series.kind {
        Kind::Harmonic(order) | Kind::Cycle(order) => match fundamental(order) {
            Some(first) => {
                let norms: Vec<f64> = first.value.iter().map(|value| value.norm()).collect();
                series.at.iter().map(|at| norms[nearest(&first.at, *at)]).collect()
            }
            None => own,
        },
        Kind::Time | Kind::Travel | Kind::Width => vec![rms(&own); own.len()],
        Kind::Passage => {
            let around = |k: usize| rms(&own[k.saturating_sub(AROUND)..(k + AROUND + 1).min(own.len())]);
            (0..own.len()).map(around).collect()
        }
    }
}

/// Values to each side over which the signal of a passage is taken: with means of 5 ms a period of a wheel's hop.
const AROUND: usize = 10;

fn nearest(at: &[f64], wanted: f64) -> usize {
    let after = at.partition_point(|at| *at < wanted).min(at.len() - 1);
    let before = after.saturating_sub(1);
    if (at[before] - wanted).abs() < (at[after] - wanted).abs() {
        before
    } else {
        after
    }
}

fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|value| value * value).sum::<f64>() / values.len() as f64).sqrt()
}

impl Group {
    fn new(key: Key, least: f64, mut values: Vec<Value>, numbers: &Numbers) -> Self {
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
            Kind::Passage => 1.0 / runs(&values) as f64,
            _ => 1.0,
        };
        let mut group = Self {
            key,
            weight,
            rows: values.iter().map(|value| value.rows).collect(),
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

    fn set(&mut self, tau: f64) {
        self.tau = tau;
        self.factor = (tau > 0.0).then(|| self.factor(tau));
    }

    /// Minus the logarithm of the prior of `τ`, but for a constant: an exponential law, which allows zero.
    fn prior(&self, tau: f64) -> f64 {
        tau / self.expected
    }

    fn factor(&self, tau: f64) -> Banded {
        self.correlation.scaled_beside_one(tau * tau).cholesky()
    }

    /// Half the logarithm of the determinant of the covariance of all parts.
    fn log_determinant(&self) -> f64 {
        let of_part = self.factor.as_ref().map_or(0.0, Banded::log_diagonal);
        self.weight * self.parts as f64 * of_part
    }

    fn whiten(&self, column: &mut [f64]) {
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
            square(&values) + self.weight * factor.log_diagonal()
        };
        residual.iter().map(of_part).sum::<f64>() + self.prior(tau)
    }

    /// Golden section over the logarithm of `τ`, then against none at all.
    fn learn(&mut self, residual: &[f64]) {
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

/// Number of runs that values are of.
fn runs(values: &[Value]) -> usize {
    let mut runs: Vec<usize> = values.iter().map(|value| value.run).collect();
    runs.sort_unstable();
    runs.dedup();
    runs.len().max(1)
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
