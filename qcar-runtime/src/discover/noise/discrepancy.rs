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
// Where values stand, and the signal there.
mod value;
// The values that have a discrepancy in common.
mod group;

use std::mem::discriminant;

use crate::campaign::Role;
use crate::discover::observe::{Evidence, Kind};
use crate::mean::mean;
use crate::transmissibility::Point;
use group::{Group, Key};
use value::{Value, values};

/// What every group of series may miss, and how much of that is assumed.
#[derive(Clone, Debug, Default)]
pub struct Discrepancy {
    groups: Vec<Group>,
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
        let keys: Vec<Key> = groups.iter().map(|(key, ..)| key.clone()).collect();
        let along = |key: &Key| keys.iter().filter(|other| other.is_beside(key)).count();
        let groups = groups
            .into_iter()
            .map(|(key, least, values)| Group::new(key.clone(), along(&key), least, values, &evidence.numbers));
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

    /// The same with groups that are new here: of each as much as of the sensors beside it, on average.
    pub fn expected_of(&self, evidence: &Evidence, role: Role) -> Self {
        let mut expected = self.carried_to(evidence, role);
        for group in &mut expected.groups {
            let beside = || self.groups.iter().filter(|known| known.key.is_beside(&group.key));
            if beside().all(|known| known.key != group.key) && beside().next().is_some() {
                group.set(mean(beside().map(|known| known.tau)));
            }
        }
        expected
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

    /// Logarithm of the likelihood of residuals of the data (in units of their noise), but for a constant: a part for each sensor
    /// in one kind of run and each distance at which correlation ends, in an order that is the evidence's.
    pub fn log_likelihoods(&self, mut residual: Vec<f64>) -> Vec<f64> {
        self.whiten(&mut residual);
        self.groups
            .iter()
            .flat_map(|group| group.log_likelihoods(&residual))
            .collect()
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
