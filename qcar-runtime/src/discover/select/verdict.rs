//! How probable each set of effects is, and what is said of it.

use super::assembly::Assembly;
use crate::campaign::Role;
use crate::discover::candidate::Candidate;
use crate::discover::evidence::Evidence;
use crate::discover::explain::Explanation;
use crate::discover::numbers::CERTAIN;
use crate::discover::search::{Discovery, Finding, Rival, Verdict};

/// A set of effects with its fit.
pub struct Set {
    /// The model with them.
    pub assembly: Assembly,
    /// Its fit.
    pub explanation: Explanation,
    /// Logarithm of its odds before any measurement.
    pub log_prior: f64,
    /// Whether its extensions were looked for.
    pub extended: bool,
    /// Others that were dropped on the way to it.
    pub rivals: Vec<Rival>,
}

impl Set {
    /// A set that was not extended yet.
    pub fn new(assembly: Assembly, explanation: Explanation, log_prior: f64) -> Self {
        Self {
            assembly,
            explanation,
            log_prior,
            extended: false,
            rivals: Vec::new(),
        }
    }

    /// Logarithm of its probability, but for a constant of the data.
    pub fn log_posterior(&self) -> f64 {
        self.explanation.refit.log_evidence + self.log_prior
    }

    /// What is told of its effects.
    pub fn findings(&self) -> Vec<Finding> {
        let effects = self.assembly.effects().iter();
        let finding = |own: &super::Placed| Finding {
            effect: own.effect.clone(),
            at: own.at.clone(),
            form: own.form.clone(),
            parameters: own.taken.parameters(&self.explanation),
            evidence: 0.0,
            closed: 0.0,
            rivals: self.rivals.clone(),
        };
        effects.map(finding).collect()
    }

    /// Names and places of its effects, in one order.
    fn names(&self) -> Vec<(&str, &str)> {
        let effects = self.assembly.effects().iter();
        let mut names: Vec<_> = effects.map(|own| (own.effect.as_str(), own.at.as_str())).collect();
        names.sort_unstable();
        names
    }
}

/// A candidate as a rival.
pub fn rival(candidate: &Candidate, behind: f64) -> Rival {
    Rival {
        effect: candidate.effect.clone(),
        at: candidate.at.clone(),
        behind: -behind,
        early: true,
    }
}

/// A list of names, and how probable it is.
struct Answer {
    /// Place of its most probable set.
    set: usize,
    probability: f64,
}

/// The answers, the most probable first: sets of the same names are one.
fn answers(sets: &[Set]) -> Vec<Answer> {
    let most = sets.iter().map(Set::log_posterior).fold(f64::NEG_INFINITY, f64::max);
    let weight = |set: &Set| (set.log_posterior() - most).exp();
    let all: f64 = sets.iter().map(weight).sum();
    let mut answers: Vec<Answer> = Vec::new();
    for (place, set) in sets.iter().enumerate() {
        let probability = weight(set) / all;
        match answers.iter_mut().find(|own| sets[own.set].names() == set.names()) {
            Some(own) => {
                if set.log_posterior() > sets[own.set].log_posterior() {
                    own.set = place;
                }
                own.probability += probability;
            }
            None => answers.push(Answer {
                set: place,
                probability,
            }),
        }
    }
    answers.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    answers
}

/// The answer. The first set is that of the base model.
pub fn judged(sets: Vec<Set>, evidence: &Evidence) -> Discovery {
    let answers = answers(&sets);
    if std::env::var_os("QCAR_TELL").is_some() {
        for set in &sets {
            eprintln!(
                "{:10.1} {:10.1} {:10.1} gap {:.3} {:.3} cost {:.1} {:?}",
                set.log_posterior(),
                log_score(set, evidence),
                set.explanation.refit.log_evidence,
                set.explanation.gap.fit,
                set.explanation.gap.held_out,
                set.explanation.refit.discrepancy.as_ref().map_or(0.0, |d| d.cost()),
                set.names()
            );
            for missed in set.explanation.refit.discrepancy.iter().flat_map(|d| d.missed()) {
                if missed.tau > 0.0 {
                    eprint!(
                        "   {}_{:?} {:?} {:.4};",
                        missed.sensor.location, missed.sensor.axis, missed.kind, missed.tau
                    );
                }
            }
            eprintln!();
            let mut groups: std::collections::BTreeMap<String, (f64, usize)> = Default::default();
            for (series, residuals) in evidence.series.iter().zip(&set.explanation.gap.residuals) {
                let role = evidence.runs[series.run].role;
                if role != Role::Fit {
                    continue;
                }
                let key = format!("{}_{:?}_{:?}", series.sensor.location, series.sensor.axis, series.kind);
                let own = groups.entry(key).or_default();
                own.0 += residuals.iter().map(|r| r * r).sum::<f64>();
                own.1 += residuals.len();
            }
            for (key, (sum, count)) in groups {
                eprint!("   {key} {sum:.0}/{count}");
            }
            eprintln!(
                "  chi2 {:.1} sum c2 {:.1}",
                set.explanation.refit.chi2,
                set.explanation
                    .refit
                    .coefficients
                    .iter()
                    .zip(set.explanation.refit.nuisance.sigmas())
                    .map(|(c, s)| (c / s).powi(2))
                    .sum::<f64>()
            );
        }
    }
    let best = &sets[predictive(&sets, answers[0].set, evidence)];
    let before = sets[0].explanation.clone();
    let after = best.explanation.clone();
    let mut sum = 0.0;
    let credible = answers.iter().take_while(|own| {
        let wanted = sum < CERTAIN;
        sum += own.probability;
        wanted
    });
    let credible: Vec<&Answer> = credible.collect();
    let closed = closed(&before, &after, evidence);
    let mut findings = best.findings();
    for finding in &mut findings {
        finding.closed = closed;
        finding.evidence = after.refit.log_evidence - before.refit.log_evidence;
    }
    let verdict = match (findings.is_empty(), credible.len()) {
        (true, _) => Verdict::None,
        (false, 1) => Verdict::Found,
        (false, _) => Verdict::Class,
    };
    let mut alike = 0;
    if verdict == Verdict::Class {
        for other in &credible[1..] {
            findings.extend(sets[other.set].findings());
        }
        alike = findings.len();
    }
    Discovery {
        verdict,
        findings,
        alike,
        before,
        after,
        visible: Vec::new(),
    }
}

/// The set itself, or the part of it that predicts the runs that judge better: what does not predict is withdrawn.
fn predictive(sets: &[Set], mut best: usize, evidence: &Evidence) -> usize {
    if evidence.of_role(Role::HeldOut).next().is_none() {
        return best;
    }
    loop {
        let names = sets[best].names();
        let is_part = |other: &usize| {
            let own = sets[*other].names();
            own.len() < names.len() && own.iter().all(|name| names.contains(name))
        };
        let order = |a: &usize, b: &usize| sets[*a].log_posterior().total_cmp(&sets[*b].log_posterior());
        let part = (0..sets.len()).filter(is_part).max_by(order);
        match part.filter(|&part| log_score(&sets[part], evidence) >= log_score(&sets[best], evidence)) {
            Some(part) => best = part,
            None => return best,
        }
    }
}

/// Logarithm of the likelihood of the runs that judge, but for a constant (the logarithmic score).
fn log_score(set: &Set, evidence: &Evidence) -> f64 {
    let Some(discrepancy) = &set.explanation.refit.discrepancy else {
        return f64::NEG_INFINITY;
    };
    let mut residual = Vec::new();
    for (place, series) in evidence.of_role(Role::HeldOut) {
        let parts = if series.kind.complex() { 2 } else { 1 };
        let own = &set.explanation.gap.residuals[place];
        let units = series
            .sigma
            .iter()
            .zip(&series.noise)
            .map(|(sigma, noise)| sigma / noise);
        let units = units.flat_map(|unit| std::iter::repeat_n(unit, parts));
        residual.extend(own.iter().zip(units).map(|(residual, unit)| residual * unit));
    }
    discrepancy.carried_to(evidence, Role::HeldOut).log_likelihood(residual)
}

/// Share of the excess of the squared gap over noise that is gone on the runs that judge.
fn closed(before: &Explanation, after: &Explanation, evidence: &Evidence) -> f64 {
    let held_out = evidence.of_role(Role::HeldOut).next().is_some();
    let excess = |own: &Explanation| {
        let gap = if held_out { own.gap.held_out } else { own.gap.fit };
        (gap.powi(2) - 1.0).max(0.0)
    };
    1.0 - excess(after) / excess(before).max(f64::MIN_POSITIVE)
}
