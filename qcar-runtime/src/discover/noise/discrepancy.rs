//! Gaussian process discrepancy: an error of the model that is smooth in frequency, in time or in travel.
//!
//! A measured value is `y = f(θ) + J_b b + J_s s + δ + ε`. Sensor noise `ε` is independent from value to value. The
//! sensor errors `b` and the differences `s` of the sides are nuisance parameters of the fit. The discrepancy `δ` is a
//! Gaussian process for each group of series (one sensor in one kind of run), with a standard deviation `τ` relative to
//! the signal (Kennedy and O'Hagan, Bayesian calibration of computer models, J. R. Stat. Soc. B 63, 2001). The fit
//! whitens its residuals by the Cholesky factor of the covariance `diag σ² + τ² K`. The correlation is zero beyond a
//! finite distance (Wendland, Advances in Computational Mathematics 4, 1995), so the factor is banded and cheap.
//!
//! On a clean simulated campaign every `τ` goes to its smallest value, mostly zero, and residuals are in units of
//! noise. On hardware `τ` measures the error of the model. The same formula applies to both.

// Banded symmetric matrix with its Cholesky factor.
mod banded;
// Position and signal of each value.
mod value;
// Values that share a discrepancy.
mod group;
// Factors that many estimates share.
mod factors;

use std::mem::discriminant;

use crate::campaign::Role;
use crate::discover::observe::{Evidence, Kind};
use crate::mean::mean;
use crate::transmissibility::Point;
pub use factors::Factors;
use group::{Group, Key};
use value::{Value, values};

/// The discrepancy of every group of series.
#[derive(Clone, Debug, Default)]
pub struct Discrepancy {
    groups: Vec<Group>,
}

/// Estimated discrepancy of a group.
#[derive(Clone, Debug, PartialEq)]
pub struct GroupDiscrepancy {
    /// Sensor of the group.
    pub sensor: Point,
    /// Kind of its values.
    pub kind: Kind,
    /// Standard deviation of the discrepancy, relative to the signal.
    pub tau: f64,
}

impl Discrepancy {
    /// The groups of the runs of one role, each with its smallest discrepancy.
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
        let along = |key: &Key| keys.iter().filter(|other| other.has_same_axis_and_kind(key)).count();
        let groups = groups
            .into_iter()
            .map(|(key, least, values)| Group::new(key.clone(), along(&key), least, values, &evidence.numbers));
        Self {
            groups: groups.collect(),
        }
    }

    /// The discrepancy of other evidence or another role. Groups that are also in `self` keep their `τ`.
    pub fn carried_to(&self, evidence: &Evidence, role: Role) -> Self {
        let mut carried = Self::of(evidence, role);
        for group in &mut carried.groups {
            if let Some(known) = self.groups.iter().find(|known| known.key == group.key) {
                group.set(known.tau);
            }
        }
        carried
    }

    /// Like [`Self::carried_to`], but a group that is new gets the mean `τ` of the groups of the same axis and kind.
    pub fn expected_of(&self, evidence: &Evidence, role: Role) -> Self {
        let mut expected = self.carried_to(evidence, role);
        for group in &mut expected.groups {
            let beside = || {
                self.groups
                    .iter()
                    .filter(|known| known.key.has_same_axis_and_kind(&group.key))
            };
            if beside().all(|known| known.key != group.key) && beside().next().is_some() {
                group.set(mean(beside().map(|known| known.tau)));
            }
        }
        expected
    }

    /// Whitens data residuals in units of their noise: the result is independent with unit variance.
    pub fn whiten(&self, column: &mut [f64]) {
        for group in &self.groups {
            group.whiten(column);
        }
    }

    /// Half the log determinant of the covariance minus the log prior of every `τ`.
    pub fn cost(&self) -> f64 {
        self.groups
            .iter()
            .map(|group| group.log_determinant() + group.prior(group.tau))
            .sum()
    }

    /// Log likelihood of data residuals in units of their noise, up to a constant. It has one part for each group and
    /// each correlation length, in the order of the evidence.
    pub fn log_likelihoods(&self, mut residual: Vec<f64>) -> Vec<f64> {
        self.whiten(&mut residual);
        self.groups
            .iter()
            .flat_map(|group| group.log_likelihoods(&residual))
            .collect()
    }

    /// Log likelihood of the passages along each axis, which share every error of the tyre law, as in
    /// [`Self::log_likelihoods`].
    pub fn log_likelihoods_of_passages(&self, mut residual: Vec<f64>) -> Vec<f64> {
        self.whiten(&mut residual);
        let mut axes: Vec<(&Key, f64)> = Vec::new();
        for group in self.groups.iter().filter(|own| own.key.kind == Kind::Passage) {
            let own: f64 = group.log_likelihoods(&residual).iter().sum();
            match axes
                .iter_mut()
                .find(|(known, _)| group.key.has_same_axis_and_kind(known))
            {
                Some((_, sum)) => *sum += own,
                None => axes.push((&group.key, own)),
            }
        }
        axes.into_iter().map(|(_, sum)| sum).collect()
    }

    /// Sets every `τ` to its most probable value for these data residuals in units of their noise. `known` keeps the
    /// factors for other estimates of the same discrepancy.
    pub fn estimate(&mut self, residual: &[f64], known: &Factors) {
        for (place, group) in self.groups.iter_mut().enumerate() {
            group.estimate(residual, |group, tau| known.of(place, tau, || group.factor(tau)));
        }
    }

    /// Estimated discrepancy of each group.
    pub fn by_group(&self) -> impl Iterator<Item = GroupDiscrepancy> {
        self.groups.iter().map(|group| GroupDiscrepancy {
            sensor: group.key.sensor.clone(),
            kind: group.key.kind,
            tau: group.tau,
        })
    }
}
