//! How probable each set of effects is, and what is said of it.

use super::assembly::{Assembly, Placed};
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

/// The most probable set that names nothing: the base model, with what every real car has where the runs show it.
pub fn nameless(sets: &[Set]) -> usize {
    let order = |a: &usize, b: &usize| sets[*a].log_posterior().total_cmp(&sets[*b].log_posterior());
    let nameless = (0..sets.len()).filter(|&place| sets[place].names().is_empty());
    nameless.max_by(order).unwrap_or(0)
}

/// The answer.
pub fn judged(sets: &[Set], evidence: &Evidence) -> Discovery {
    let answers = answers(sets);
    let credible = credible(sets, &answers, &evidence.numbers);
    let alone = nameless(sets);
    let before = sets[alone].explanation.clone();
    let predictive = predictive(sets, credible[0], evidence);
    // What explains less than most of the gap is not the answer, however probable beside the others.
    let explains = closed(&before, &sets[predictive].explanation, evidence) >= GREATER_PART;
    let best = if explains { predictive } else { alone };
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
    let (mut findings, mut alike) = (Vec::new(), 0);
    if best == credible[0] {
        let members: Vec<&Set> = credible.iter().map(|&place| &sets[place]).collect();
        let is_common = |own: &Placed| members.iter().all(|set| set.names().contains(&own.name()));
        let (common, others): (Vec<&Placed>, Vec<&Placed>) = members[0].named().partition(|own| is_common(own));
        findings.extend(common.into_iter().map(|own| finding(members[0], own)));
        let found = findings.len();
        findings.extend(others.into_iter().map(|own| finding(members[0], own)));
        for set in &members[1..] {
            let effects = set.named().filter(|own| !is_common(own));
            let new: Vec<Finding> = effects
                .filter(|own| {
                    !findings
                        .iter()
                        .any(|known| (known.effect.as_str(), known.at.as_str()) == own.name())
                })
                .map(|own| finding(set, own))
                .collect();
            findings.extend(new);
        }
        alike = if members.len() > 1 { findings.len() - found } else { 0 };
    } else {
        findings.extend(sets[best].named().map(|own| finding(&sets[best], own)));
    }
    let verdict = match (findings.is_empty(), alike) {
        (true, _) if is_missing(&sets[best], evidence) => Verdict::Unknown,
        (true, _) => Verdict::None,
        (false, 0) => Verdict::Found,
        (false, _) => Verdict::Class,
    };
    let of_answer = |wanted: &dyn Fn(usize) -> bool| -> f64 {
        let wanted = answers.iter().filter(|own| wanted(own.set));
        wanted.map(|own| own.probability).sum()
    };
    let probability = match verdict {
        Verdict::None => Some(of_answer(&|set| sets[set].names().is_empty())),
        Verdict::Found => Some(of_answer(&|set| is_part(&sets[best], &sets[set]))),
        Verdict::Class => Some(of_answer(&|set| {
            credible.iter().any(|&own| is_part(&sets[own], &sets[set]))
        })),
        Verdict::Unknown => None,
    };
    let nuisances = |set: &Set| {
        let effects = set.assembly.effects().iter().filter(|own| own.nuisance);
        effects.map(|own| finding(set, own)).collect()
    };
    Discovery {
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
    }
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

/// The smallest list of sets that is certain, without those that only add to another one of it. It is the
/// base model alone unless that is less probable than the others have to be certain.
fn credible(sets: &[Set], answers: &[Answer], numbers: &Numbers) -> Vec<usize> {
    let none = answers.iter().find(|own| sets[own.set].names().is_empty());
    if let Some(none) = none.filter(|none| none.probability > numbers.doubt) {
        return vec![none.set];
    }
    let mut sum = 0.0;
    let held = answers.iter().take_while(|own| {
        let wanted = sum < numbers.certain();
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
    let probable = names.into_iter().filter_map(|name| {
        let with = sets.iter().filter(|set| set.names().contains(&name));
        let order = |a: &&Set, b: &&Set| {
            let fewer = b.names().len().cmp(&a.names().len());
            fewer.then(a.log_posterior().total_cmp(&b.log_posterior()))
        };
        let best = with.max_by(order)?;
        let holds = |own: &&Answer| sets[predictive(sets, own.set, evidence)].names().contains(&name);
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
            probability: answers.iter().filter(holds).fold(0.0, |sum, own| sum + own.probability),
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
