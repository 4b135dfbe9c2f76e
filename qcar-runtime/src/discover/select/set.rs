//! A set of effects with its fit: how probable it is, what it names, and what it leaves.

use std::sync::OnceLock;

use super::assembly::{Assembly, Placed};
use crate::campaign::Role;
use crate::discover::answer::{Finding, Rival};
use crate::discover::numbers::{Numbers, ONE_SIDED};
use crate::discover::observe::{Evidence, Series};
use crate::discover::posterior::Explanation;

/// A set of effects with its fit.
#[derive(Clone)]
pub struct Set {
    /// The model with them.
    pub assembly: Assembly,
    /// Its fit.
    pub explanation: Explanation,
    /// Logarithm of its odds before any measurement.
    pub log_prior: f64,
    /// Whether its extensions were looked for.
    pub extended: bool,
    /// Whether its effects were replaced by their rivals.
    pub exchanged: bool,
    /// Whether it was tried without each of its effects.
    pub reduced: bool,
    /// Others that were dropped on the way to it.
    pub rivals: Vec<Rival>,
    /// What the runs that judge say of it, once that was asked: see [`super::judging`].
    pub score: OnceLock<f64>,
}

impl Set {
    /// A set that was not extended yet.
    pub fn new(assembly: Assembly, explanation: Explanation, log_prior: f64) -> Self {
        Self {
            assembly,
            explanation,
            log_prior,
            extended: false,
            exchanged: false,
            reduced: false,
            rivals: Vec::new(),
            score: OnceLock::new(),
        }
    }

    /// Logarithm of its probability, but for a constant of the data.
    pub fn log_posterior(&self) -> f64 {
        self.explanation.refit.log_evidence + self.log_prior
    }

    /// Odds of one effect more, before any measurement.
    pub fn odds_of_another(&self, numbers: &Numbers) -> f64 {
        if self.names().is_empty() { 1.0 } else { numbers.further }
    }

    /// Logarithm of the likelihood of the runs of a role, but for a constant, part by part of the data; `None` without a
    /// discrepancy.
    pub fn log_likelihoods(&self, role: Role, evidence: &Evidence) -> Option<Vec<f64>> {
        let discrepancy = self.explanation.refit.discrepancy.as_ref()?;
        let mut residual = Vec::new();
        for (place, series) in evidence.of_role(role) {
            let parts = if series.kind.complex() { 2 } else { 1 };
            let own = &self.explanation.gap.residuals[place];
            let units = series
                .sigma
                .iter()
                .zip(&series.noise)
                .map(|(sigma, noise)| sigma / noise);
            let units = units.flat_map(|unit| std::iter::repeat_n(unit, parts));
            residual.extend(own.iter().zip(units).map(|(residual, unit)| residual * unit));
        }
        Some(discrepancy.carried_to(evidence, role).log_likelihoods(residual))
    }

    /// What is told of all its effects.
    pub fn findings(&self) -> Vec<Finding> {
        let effects = self.assembly.effects().iter();
        let finding = |own: &Placed| Finding {
            effect: own.effect.clone(),
            at: own.at.clone(),
            form: own.form.clone(),
            parameters: own.unknowns.parameters(&self.explanation),
            evidence: 0.0,
            closed: 0.0,
            rivals: self.rivals.clone(),
        };
        effects.map(finding).collect()
    }

    /// True where an effect stands for another.
    pub fn stands_at_an_end(&self) -> bool {
        self.named().any(|own| own.unknowns.stands_at_an_end(&self.explanation))
    }

    /// True where an effect that a part of it lacks has a magnitude at an end of its range, so that it stands for another
    /// effect. A further effect must have its shapes inside their ranges too: little is left for it to explain, and at the
    /// limit of a shape it imitates almost anything.
    pub fn adds_a_substitute(&self, part: &Set) -> bool {
        let is_further = !part.names().is_empty();
        let is_substitute = |own: &Placed| {
            own.unknowns.stands_at_an_end(&self.explanation)
                || is_further && own.unknowns.reaches_an_end(&self.explanation)
        };
        let is_new = |own: &&Placed| !part.names().contains(&own.name());
        self.named().filter(is_new).any(is_substitute)
    }

    /// True where a shape stands at an end of its range and the other set has fewer unknowns: at its limit a law is a simpler
    /// one, and no alternative to it.
    pub fn is_a_limit_beside(&self, other: &Set) -> bool {
        let unknowns = |set: &Set| set.explanation.refit.free.len();
        unknowns(self) > unknowns(other) && self.named().any(|own| own.unknowns.reaches_an_end(&self.explanation))
    }

    /// Its effects that may be an answer.
    pub fn named(&self) -> impl Iterator<Item = &Placed> + Clone {
        self.assembly.effects().iter().filter(|own| !own.nuisance)
    }

    /// Names and places of them, in one order.
    pub fn names(&self) -> Vec<(&str, &str)> {
        let mut names: Vec<_> = self.named().map(Placed::name).collect();
        names.sort_unstable();
        names
    }
}

/// The most probable of the sets at these places.
pub fn most_probable(sets: &[Set], places: impl IntoIterator<Item = usize>) -> Option<usize> {
    let order = |a: &usize, b: &usize| sets[*a].log_posterior().total_cmp(&sets[*b].log_posterior());
    places.into_iter().max_by(order)
}

/// The most probable set that names nothing: the base model, with what every real car has where the runs show it.
pub fn nameless(sets: &[Set]) -> usize {
    let nameless = (0..sets.len()).filter(|&place| sets[place].names().is_empty());
    most_probable(sets, nameless).unwrap_or(0)
}

/// True where every effect of one set is in the other.
pub fn is_part(part: &Set, whole: &Set) -> bool {
    part.names().iter().all(|name| whole.names().contains(name))
}

/// True where a model leaves more of any sensor than models of its kind do, and more than the uncertainty of all that
/// judges: what a noisy sensor leaves alone is no sign of an effect.
pub fn is_missing(set: &Set, evidence: &Evidence) -> bool {
    let discrepancy = set.explanation.refit.discrepancy.iter();
    let is_large = discrepancy
        .flat_map(|own| own.missed())
        .any(|missed| missed.tau > evidence.numbers.expected_discrepancy);
    is_large && excess(&set.explanation, evidence) > 0.0
}

/// True where the residuals of the runs that were fitted are larger than noise alone would leave: their mean square is 1 for
/// a model that is right, and of `n` values exceeds 1 by `sqrt(2/n)` as its standard deviation.
pub fn leaves_more_than_noise(set: &Set, evidence: &Evidence) -> bool {
    let parts = |series: &Series| series.at.len() * if series.kind.complex() { 2 } else { 1 };
    let values: usize = evidence.of_role(Role::Fit).map(|(_, series)| parts(series)).sum();
    let scatter = (2.0 / values.max(1) as f64).sqrt();
    let square = set.explanation.gap.fit.powi(2);
    square.is_nan() || square > 1.0 + ONE_SIDED * scatter
}

/// Share of the excess of the squared gap over noise that is gone on the runs that judge.
pub fn closed(before: &Explanation, after: &Explanation, evidence: &Evidence) -> f64 {
    1.0 - excess(after, evidence) / excess(before, evidence).max(f64::MIN_POSITIVE)
}

/// The squared gap over its uncertainty on the runs that judge (those that were fitted, where none do) beyond what noise
/// alone leaves, which is 1.
pub fn excess(own: &Explanation, evidence: &Evidence) -> f64 {
    let held_out = evidence.of_role(Role::HeldOut).next().is_some();
    let gap = if held_out { own.gap.held_out } else { own.gap.fit };
    (gap.powi(2) - 1.0).max(0.0)
}
