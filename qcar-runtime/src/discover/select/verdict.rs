//! How probable each set of effects is, and what is said of it.

use std::sync::OnceLock;

use super::assembly::{Assembly, Placed};
use super::bagged::probabilities;
use crate::campaign::Role;
use crate::discover::answer::{Discovery, Finding, Probable, Rival, Verdict};
use crate::discover::candidate::Candidate;
use crate::discover::numbers::{GREATER_PART, Numbers};
use crate::discover::observe::Evidence;
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
    /// What the runs that judge say of it, once that was asked: see [`log_score`].
    score: OnceLock<f64>,
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
            parameters: own.taken.parameters(&self.explanation),
            evidence: 0.0,
            closed: 0.0,
            rivals: self.rivals.clone(),
        };
        effects.map(finding).collect()
    }

    /// True where an effect stands for another.
    fn stands_at_an_end(&self) -> bool {
        self.named().any(|own| own.taken.stands_at_an_end(&self.explanation))
    }

    /// True where an effect that a part of it lacks has a magnitude at an end of its range, so that it stands for another
    /// effect. A further effect must have its shapes inside their ranges too: little is left for it to explain, and at the
    /// limit of a shape it imitates almost anything.
    fn adds_a_substitute(&self, part: &Set) -> bool {
        let is_further = !part.names().is_empty();
        let is_substitute = |own: &Placed| {
            own.taken.stands_at_an_end(&self.explanation) || is_further && own.taken.reaches_an_end(&self.explanation)
        };
        let is_new = |own: &&Placed| !part.names().contains(&own.name());
        self.named().filter(is_new).any(is_substitute)
    }

    /// True where a shape stands at an end of its range and the other set has fewer unknowns: at its limit a law is a simpler
    /// one, and no alternative to it.
    fn is_a_limit_beside(&self, other: &Set) -> bool {
        let unknowns = |set: &Set| set.explanation.refit.free.len();
        unknowns(self) > unknowns(other) && self.named().any(|own| own.taken.reaches_an_end(&self.explanation))
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
    /// True for names that are no answer: the runs that judge leave nothing of them, or they are the first ones at a limit.
    dismissed: bool,
}

/// The answers, the most probable first: sets of the same names are one.
fn answers(sets: &[Set], evidence: &Evidence) -> Vec<Answer> {
    let probability = probabilities(sets, evidence);
    let left: Vec<usize> = (0..sets.len()).map(|place| predictive(sets, place, evidence)).collect();
    let mut answers: Vec<Answer> = Vec::new();
    for (place, probability) in probability.iter().copied().enumerate() {
        let dismissed = left[place] != place && sets[left[place]].names().is_empty();
        let set = if dismissed { place } else { standing(place, sets, &left) };
        let is_it = |own: &&mut Answer| own.dismissed == dismissed && sets[own.set].names() == sets[set].names();
        match answers.iter_mut().find(is_it) {
            Some(own) => {
                if sets[set].log_posterior() > sets[own.set].log_posterior() {
                    own.set = set;
                }
                own.probability += probability;
            }
            None => answers.push(Answer {
                set,
                probability,
                dismissed,
            }),
        }
    }
    answers.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    let first = answers[0].set;
    for own in &mut answers[1..] {
        own.dismissed |= sets[own.set].is_a_limit_beside(&sets[first]);
    }
    answers
}

/// The set that a set speaks for: itself, if the runs that judge leave it whole, or else the most probable one that they leave
/// whole and that has what they leave of it. That part says what is there, not that nothing else is.
fn standing(place: usize, sets: &[Set], left: &[usize]) -> usize {
    if left[place] == place {
        return place;
    }
    let part = left[place];
    let speaks = |&other: &usize| left[other] == other && is_part(&sets[part], &sets[other]);
    let order = |a: &usize, b: &usize| sets[*a].log_posterior().total_cmp(&sets[*b].log_posterior());
    (0..sets.len()).filter(speaks).max_by(order).unwrap_or(part)
}

/// The most probable set that names nothing: the base model, with what every real car has where the runs show it.
pub fn nameless(sets: &[Set]) -> usize {
    let order = |a: &usize, b: &usize| sets[*a].log_posterior().total_cmp(&sets[*b].log_posterior());
    let nameless = (0..sets.len()).filter(|&place| sets[place].names().is_empty());
    nameless.max_by(order).unwrap_or(0)
}

/// The answer, and the place of the set that it tells of; of a class the most probable one.
pub fn judged(sets: &[Set], evidence: &Evidence) -> (Discovery, usize) {
    let answers = answers(sets, evidence);
    let alone = nameless(sets);
    let before = sets[alone].explanation.clone();
    let credible = credible(sets, &answers, &evidence.numbers);
    // What explains less than most of the gap is not the answer, however probable beside the others.
    let explains = |set: usize| closed(&before, &sets[set].explanation, evidence) >= GREATER_PART;
    let members = if explains(credible[0]) { credible } else { vec![alone] };
    let best = members[0];
    let after = sets[best].explanation.clone();
    let finding = |set: &Set, own: &Placed| Finding {
        effect: own.effect.clone(),
        at: own.at.clone(),
        form: own.form.clone(),
        parameters: own.taken.parameters(&set.explanation),
        evidence: set.explanation.refit.log_evidence - before.refit.log_evidence,
        closed: closed(&before, &set.explanation, evidence),
        rivals: set.rivals.clone(),
    };
    let (findings, alike) = findings(&members.iter().map(|&place| &sets[place]).collect::<Vec<_>>(), &finding);
    let verdict = match (findings.is_empty(), alike) {
        (true, _) if is_missing(&sets[best], evidence) => Verdict::Unknown,
        (true, _) => Verdict::None,
        (false, 0) => Verdict::Found,
        (false, _) => Verdict::Class,
    };
    let sum = |wanted: &dyn Fn(&Answer) -> bool| -> f64 {
        let wanted = answers.iter().filter(|own| wanted(own));
        wanted.map(|own| own.probability).sum()
    };
    let holds = |own: &Answer| members.iter().any(|&member| is_part(&sets[member], &sets[own.set]));
    let probability = match verdict {
        Verdict::None => Some(sum(&|own| sets[own.set].names().is_empty())),
        // Given that one of the names that may be an answer is the truth.
        Verdict::Found | Verdict::Class => Some(sum(&|own| !own.dismissed && holds(own)) / sum(&|own| !own.dismissed)),
        Verdict::Unknown => None,
    };
    let nuisances = |set: &Set| {
        let effects = set.assembly.effects().iter().filter(|own| own.nuisance);
        effects.map(|own| finding(set, own)).collect()
    };
    let discovery = Discovery {
        verdict,
        probability,
        candidates: candidates(sets, &answers, &before, evidence),
        nuisances: [alone, best].map(|place| nuisances(&sets[place])),
        findings,
        alike,
        before,
        after,
        visible: Vec::new(),
        learned: None,
    };
    (discovery, best)
}

/// The findings of a list of sets, what all of them have first, and how many follow that stand in each other's place.
fn findings(members: &[&Set], finding: &dyn Fn(&Set, &Placed) -> Finding) -> (Vec<Finding>, usize) {
    let is_common = |own: &Placed| members.iter().all(|set| set.names().contains(&own.name()));
    let (common, others): (Vec<&Placed>, Vec<&Placed>) = members[0].named().partition(|own| is_common(own));
    let first = common.iter().chain(&others).map(|own| finding(members[0], own));
    let mut findings: Vec<Finding> = first.collect();
    for set in &members[1..] {
        for own in set.named() {
            let is_known = |known: &Finding| (known.effect.as_str(), known.at.as_str()) == own.name();
            if !findings.iter().any(is_known) {
                findings.push(finding(set, own));
            }
        }
    }
    let alike = if members.len() > 1 {
        findings.len() - common.len()
    } else {
        0
    };
    (findings, alike)
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

/// The smallest list of sets that is certain, without those that only add to another one of it. It is the base model alone
/// where the runs that judge leave nothing of the most probable names, and unless that is less probable than the others have
/// to be certain.
fn credible(sets: &[Set], answers: &[Answer], numbers: &Numbers) -> Vec<usize> {
    let is_named = |own: &&Answer| !sets[own.set].names().is_empty();
    let none: f64 = answers
        .iter()
        .filter(|own| !is_named(own))
        .map(|own| own.probability)
        .sum();
    if answers[0].dismissed || none > numbers.doubt {
        return vec![nameless(sets)];
    }
    let standing = answers.iter().filter(|own| is_named(own) && !own.dismissed);
    let all: f64 = standing.clone().map(|own| own.probability).sum();
    let mut sum = 0.0;
    let held = standing.take_while(|own| {
        let wanted = sum < numbers.certain() * all;
        sum += own.probability;
        wanted
    });
    let held: Vec<usize> = held.map(|own| own.set).collect();
    let adds = |place: &usize| {
        held.iter()
            .any(|other| other != place && is_part(&sets[*other], &sets[*place]))
    };
    held.iter().copied().filter(|place| !adds(place)).collect()
}

/// True where every effect of one set is in the other.
fn is_part(part: &Set, whole: &Set) -> bool {
    part.names().iter().all(|name| whole.names().contains(name))
}

/// How many candidates are told of.
const CANDIDATES: usize = 3;

/// The most probable effects, each with the best set that has it alone, or else the best with it. What an answer withdraws
/// of a set, since it predicts nothing, has no part in its probability.
fn candidates(sets: &[Set], answers: &[Answer], before: &Explanation, evidence: &Evidence) -> Vec<Probable> {
    let mut names: Vec<(&str, &str)> = sets.iter().flat_map(Set::names).collect();
    names.sort_unstable();
    names.dedup();
    let may_be = answers.iter().filter(|own| !own.dismissed);
    let all: f64 = may_be.map(|own| own.probability).sum();
    let probable = names.into_iter().filter_map(|name| {
        let with = sets.iter().filter(|set| set.names().contains(&name));
        let order = |a: &&Set, b: &&Set| {
            let fewer = b.names().len().cmp(&a.names().len());
            fewer.then(a.log_posterior().total_cmp(&b.log_posterior()))
        };
        let best = with.max_by(order)?;
        let holds = |own: &&Answer| !own.dismissed && sets[own.set].names().contains(&name);
        let form = best
            .assembly
            .effects()
            .iter()
            .find(|own| own.name() == name)?
            .form
            .clone();
        Some(Probable {
            effect: name.0.to_owned(),
            at: name.1.to_owned(),
            form,
            probability: answers.iter().filter(holds).map(|own| own.probability).sum::<f64>() / all,
            explained: closed(before, &best.explanation, evidence),
            log_evidence: best.explanation.refit.log_evidence - before.refit.log_evidence,
        })
    });
    let mut probable: Vec<Probable> = probable.collect();
    probable.sort_by(|a, b| {
        let order = b.probability.total_cmp(&a.probability);
        order.then(b.log_evidence.total_cmp(&a.log_evidence))
    });
    probable.truncate(CANDIDATES);
    probable
}

/// The set itself, or the part of it that predicts the runs that judge better, or that leaves little for the rest to close:
/// what does not predict, what changes next to nothing, and what stands for another effect is withdrawn, whichever part shows
/// it. The last needs no runs that judge.
pub fn predictive(sets: &[Set], mut best: usize, evidence: &Evidence) -> usize {
    let judges = evidence.of_role(Role::HeldOut).next().is_some();
    loop {
        let count = sets[best].names().len();
        let is_less = |other: &usize| sets[*other].names().len() < count && is_part(&sets[*other], &sets[best]);
        let order = |a: &usize, b: &usize| sets[*a].log_posterior().total_cmp(&sets[*b].log_posterior());
        let is_answer = |other: &usize| is_less(other) && !sets[*other].stands_at_an_end();
        let withdrawn = |&part: &usize| {
            let closes = closed(&sets[part].explanation, &sets[best].explanation, evidence);
            let changes_little = !sets[part].names().is_empty() && closes < evidence.numbers.explained();
            let fails = judges && (changes_little || !predicts(&sets[best], &sets[part], evidence));
            fails || sets[best].adds_a_substitute(&sets[part])
        };
        match (0..sets.len()).filter(is_answer).filter(withdrawn).max_by(order) {
            Some(part) => best = part,
            None => return best,
        }
    }
}

/// True where a set predicts the runs that judge better than another does, or where there are none.
pub fn predicts(set: &Set, other: &Set, evidence: &Evidence) -> bool {
    let nothing_judges = evidence.of_role(Role::HeldOut).next().is_none();
    nothing_judges || log_score(set, evidence) > log_score(other, evidence)
}

/// Logarithm of the likelihood of the runs that judge, but for a constant (the logarithmic score).
fn log_score(set: &Set, evidence: &Evidence) -> f64 {
    *set.score.get_or_init(|| {
        let parts = set.log_likelihoods(Role::HeldOut, evidence);
        parts.map_or(f64::NEG_INFINITY, |parts| parts.iter().sum())
    })
}

/// Share of the excess of the squared gap over noise that is gone on the runs that judge.
pub fn closed(before: &Explanation, after: &Explanation, evidence: &Evidence) -> f64 {
    1.0 - excess(after, evidence) / excess(before, evidence).max(f64::MIN_POSITIVE)
}

/// The squared gap over its uncertainty on the runs that judge (those that were fitted, where none do) beyond what noise
/// alone leaves, which is 1.
fn excess(own: &Explanation, evidence: &Evidence) -> f64 {
    let held_out = evidence.of_role(Role::HeldOut).next().is_some();
    let gap = if held_out { own.gap.held_out } else { own.gap.fit };
    (gap.powi(2) - 1.0).max(0.0)
}
