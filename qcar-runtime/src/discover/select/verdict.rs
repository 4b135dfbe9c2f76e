//! The verdict on the sets, and the most probable candidates.

use super::answers::{Answer, answers, credible};
use super::assembly::Placed;
use super::set::{
    Set, best_base, by_log_posterior, excess, explained_share, is_missing, is_part, misses_a_sensor, stated_share,
};
use crate::campaign::Role;
use crate::discover::answer::{Discovery, Finding, Probable, Rival, Verdict};
use crate::discover::numbers::{DOUBTFUL_BELOW, GREATER_PART};
use crate::discover::observe::Evidence;

/// The answer, and the position of the set that it describes. For a class, this is the most probable member.
pub fn conclude(sets: &[Set], evidence: &Evidence) -> (Discovery, usize) {
    let answers = answers(sets, evidence);
    let base = best_base(sets);
    let before = &sets[base];
    let credible = credible(sets, &answers, evidence);
    // Effects that explain less than half of the excess residual are no answer, even if they are the most probable. In a class,
    // they show that the model is wrong in another way.
    let explains = |set: usize| explained_share(before, &sets[set], evidence) >= GREATER_PART;
    let is_answer = credible.iter().all(|&member| explains(member));
    let members = if is_answer { credible } else { vec![base] };
    let best = members[0];
    let finding = |set: &Set, own: &Placed| finding(set, own, before, evidence);
    let findings = findings(&members.iter().map(|&place| &sets[place]).collect::<Vec<_>>(), &finding);
    let of_none = total(&answers, |own| sets[own.set].names().is_empty());
    let is_incomplete = is_missing(&sets[best], evidence) || misses_a_sensor(&sets[best], evidence, Role::HeldOut);
    // Effects that the held-out runs do not show are no sign of a missing one if the base model leaves only noise there.
    let is_judged = evidence.judging() == Role::HeldOut;
    let leaves_noise = is_judged && excess(&before.explanation, evidence) <= 0.0;
    let is_improbable = of_none < evidence.numbers.error_probability && !leaves_noise;
    let verdict = match (findings.is_empty(), members.len()) {
        (true, _) if is_incomplete || is_improbable => Verdict::Unknown,
        (true, _) => Verdict::None,
        (false, 1) => Verdict::Found,
        (false, _) => Verdict::Class,
    };
    let holds = |own: &Answer| members.iter().any(|&member| is_part(&sets[member], &sets[own.set]));
    let possible = |wanted: &dyn Fn(&Answer) -> bool| total(&answers, |own| !own.dismissed && wanted(own));
    let probability = match verdict {
        Verdict::None if !leaves_noise => Some(of_none),
        // Probability on the condition that one of the answers that are not dismissed is true.
        Verdict::None => Some(of_none / possible(&|_| true)).filter(|own| *own >= DOUBTFUL_BELOW),
        Verdict::Found | Verdict::Class => Some(possible(&holds) / possible(&|_| true)),
        Verdict::Unknown => None,
    };
    let nuisances = |set: &Set| {
        let effects = set.assembly.effects().iter().filter(|own| own.nuisance);
        effects.map(|own| finding(set, own)).collect()
    };
    let discovery = Discovery {
        verdict,
        probability,
        candidates: candidates(sets, &answers, before, evidence),
        nuisances: [base, best].map(|place| nuisances(&sets[place])),
        findings,
        before: before.with_sensors_of(&sets[best], evidence).into_owned(),
        after: sets[best].explanation.clone(),
        detection_limits: Vec::new(),
        learned: None,
    };
    (discovery, best)
}

/// An effect of a set as a finding, compared with the base model.
fn finding(set: &Set, own: &Placed, base: &Set, evidence: &Evidence) -> Finding {
    Finding {
        effect: own.effect.clone(),
        at: own.at.clone(),
        form: own.form.clone(),
        alternative: None,
        parameters: own.unknowns.parameters(&set.explanation),
        evidence: set.explanation.refit.log_evidence - base.explanation.refit.log_evidence,
        explained: stated_share(base, set, evidence),
        rivals: rivals(set),
    }
}

/// The rivals of a set without other forms of its own effects.
fn rivals(set: &Set) -> Vec<Rival> {
    let names = set.names();
    let is_other = |own: &&Rival| !names.contains(&(own.effect.as_str(), own.at.as_str()));
    set.rivals.iter().filter(is_other).cloned().collect()
}

/// Sum of the probabilities of the wanted answers.
fn total(answers: &[Answer], wanted: impl Fn(&Answer) -> bool) -> f64 {
    let wanted = answers.iter().filter(|own| wanted(own));
    wanted.map(|own| own.probability).sum()
}

/// Findings of the members: those common to all, as in the first member, and then the others of each member.
fn findings(members: &[&Set], finding: &dyn Fn(&Set, &Placed) -> Finding) -> Vec<Finding> {
    let is_common = |own: &&Placed| members.iter().all(|set| set.names().contains(&own.name()));
    let common = members[0].named().filter(is_common).map(|own| finding(members[0], own));
    let others = members.iter().enumerate().flat_map(|(place, set)| {
        let own = set.named().filter(|own| !is_common(own));
        own.map(move |own| Finding {
            alternative: Some(place),
            ..finding(set, own)
        })
    });
    common.chain(others).collect()
}

/// Ratio of `part` to `all`, at least 0; 0 if `all` is 0.
fn share(part: f64, all: f64) -> f64 {
    if all > 0.0 { (part / all).max(0.0) } else { 0.0 }
}

/// Number of candidates in the answer.
const CANDIDATES: usize = 3;

/// The most probable effects, and those of equal probability by what they gain alone. Those that alone explain nothing are
/// left out unless they are more probable than not, beside others. Dismissed answers do not count towards the probability.
fn candidates(sets: &[Set], answers: &[Answer], before: &Set, evidence: &Evidence) -> Vec<Probable> {
    let mut names: Vec<(&str, &str)> = sets.iter().flat_map(Set::names).collect();
    names.sort_unstable();
    names.dedup();
    let may_be = answers.iter().filter(|own| !own.dismissed);
    let all: f64 = may_be.map(|own| own.probability).sum();
    let probable = names.into_iter().filter_map(|name| {
        let with = sets.iter().filter(|set| set.names().contains(&name));
        let order = |a: &&Set, b: &&Set| {
            let fewer = b.names().len().cmp(&a.names().len());
            fewer.then(by_log_posterior(a, b))
        };
        let best = with.max_by(order)?;
        let holds = |own: &&Answer| !own.dismissed && sets[own.set].names().contains(&name);
        let alone = Some(best).filter(|set| set.names().len() == 1);
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
            probability: share(answers.iter().filter(holds).map(|own| own.probability).sum(), all),
            explained: alone.and_then(|set| stated_share(before, set, evidence)),
            log_evidence: alone.map(|set| set.explanation.refit.log_evidence - before.explanation.refit.log_evidence),
        })
    });
    let explains = |own: &Probable| own.probability > 0.5 || own.explained.is_none_or(|share| share > 0.0);
    let mut probable: Vec<Probable> = probable.filter(explains).collect();
    probable.sort_by(|a, b| {
        let order = b.probability.total_cmp(&a.probability);
        let gain = |own: &Probable| own.log_evidence.unwrap_or(f64::NEG_INFINITY);
        order.then(gain(b).total_cmp(&gain(a)))
    });
    probable.truncate(CANDIDATES);
    probable
}
