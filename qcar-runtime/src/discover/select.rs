//! Which effect is missing: sets of effects compared by their evidence, judged on runs that no fit has seen.

// The order of the data: an effect in a model,
mod unknowns;
// what can be fitted,
pub mod assembly;
// what each candidate would gain without a fit,
mod screen;
// which of them explain best,
mod race;
// where a model alone explains best,
mod alone;
// a set of effects with its fit,
mod set;
// how probable each is,
mod bagged;
// what the runs that judge leave of it,
mod judging;
// which names are the answer,
mod answers;
// and what is said of them,
mod verdict;
// which rivals explain better beside effects that were added later,
mod exchange;
// what law is missing where the catalogue has none,
mod learn;
// the first such law, before names are tried in twos and threes,
mod first_law;
// and which effects would have been seen.
mod visible;

use std::sync::Arc;

use rayon::iter::Either;
use rayon::prelude::*;

use assembly::{Assembly, Hypothesis, Place, Placed};
use bagged::probabilities;
use exchange::exchanges;
use first_law::FirstLaw;
use judging::predictive;
use race::{Dropped, Fidelity, Finalist, entrants, race};
use screen::screen;
use set::{Set, closed, excess, is_missing, leaves_more_than_noise, most_probable, nameless};
use verdict::judged;
use visible::visible;

pub use alone::{Alone, Minimum, alone};

use super::answer::{Discovery, Learned, News, Progress, Rival, Verdict, told};
use super::candidate::{Candidate, Workshop};
use super::numbers::{EVEN, GREATER_PART, MOST_EFFECTS, Numbers};
use super::observe::{Evidence, PredictError, Stimulus};
use super::posterior::{Explanation, Refit, Setting};
use crate::campaign::Role;

/// Searches for what is missing. `progress` is told how it goes.
///
/// # Errors
/// Where the model lacks what was measured, or a parameter has no value.
pub fn discover(
    workshop: Box<dyn Workshop>,
    setting: &Setting,
    evidence: &Evidence,
    progress: Progress<'_>,
) -> Result<Discovery, PredictError> {
    if evidence.of_role(Role::Fit).next().is_none() {
        return Err(PredictError::NothingToFit);
    }
    progress(News::Doing("fitting the base model"));
    let assembly = Assembly::base(Arc::from(workshop), setting, evidence)?;
    let base = base(assembly, evidence)?;
    let alone = format!("the model alone leaves a gap of {}", told(&base.explanation));
    progress(News::Known(&alone, &[], &base.explanation));
    let mut sets = vec![base];
    let mut law = FirstLaw::default();
    while let Some(place) = next(&sets, evidence) {
        sets[place].extended = true;
        let lead = law.lead(&sets, place, evidence, progress);
        let more = extensions(&sets[place], lead, evidence, progress)?;
        sets.extend(more);
        tell(&sets[best(&sets)], progress);
    }
    // What is not missed was only a step on the way.
    while let Some(place) = unreduced(&sets) {
        sets[place].reduced = true;
        let less = reductions(&sets[place], &sets[0], evidence, progress);
        sets.extend(less);
    }
    while let Some(place) = unexchanged(&sets, evidence) {
        sets[place].exchanged = true;
        progress(News::Doing("trying the rivals of each effect"));
        let others = exchanges(&sets[place], &sets, evidence);
        sets.extend(others);
    }
    let alone = &sets[nameless(&sets)];
    let (mut discovery, found) = judged(&sets, evidence);
    if is_unexplained(&discovery, alone, evidence) {
        let first = law.beside(&sets, evidence, progress);
        let learned = learn::learn(alone, first, evidence, progress);
        let learned = learned.map(|learned| learn::told(alone, learned, evidence));
        discovery.take(learned, &evidence.numbers);
    } else if discovery.verdict != Verdict::None && is_doubtful(&sets[found], alone, evidence) {
        // Names may make up for a law that the catalogue does not have.
        let law = law.beside(&sets, evidence, progress);
        let law = law.filter(|law| learn::holds(law, alone, evidence));
        let is_certain = |law: &Set| {
            let probability = probabilities(&[&sets[found], law], evidence);
            probability[1] > evidence.numbers.certain()
        };
        let law = law.filter(is_certain);
        discovery.prefer(law.map(|law| learn::told(alone, law, evidence)));
    }
    if discovery.verdict == Verdict::None {
        let refit = &alone.explanation.refit;
        let steady = evidence.less(&refit.unsteady).hurried();
        discovery.visible = visible(&alone.assembly, refit, &fidelity(&steady).fine);
    }
    Ok(discovery)
}

/// True where a part of the set is an answer, and what the set has beyond that would be withdrawn.
fn is_settled(sets: &[Set], set: usize, evidence: &Evidence) -> bool {
    let answer = predictive(sets, set, evidence);
    let closes = closed(&sets[nameless(sets)].explanation, &sets[answer].explanation, evidence);
    answer != set && closes >= GREATER_PART
}

/// True where something is missing, more probably than not, that no effect of the catalogue explains, be it less than models
/// of this kind leave; and where the model leaves more than noise.
fn is_unexplained(discovery: &Discovery, alone: &Set, evidence: &Evidence) -> bool {
    let is_improbable = |probability: f64| probability < EVEN;
    match discovery.verdict {
        Verdict::Unknown => true,
        Verdict::None => discovery.probability.is_some_and(is_improbable) || leaves_more_than_noise(alone, evidence),
        Verdict::Found | Verdict::Class => false,
    }
}

impl Discovery {
    /// Takes a law up: one that closes most of a gap tells that something is missing, however little that is.
    fn take(&mut self, learned: Option<Learned>, numbers: &Numbers) {
        let closes = learned.as_ref().is_some_and(|own| own.explained >= numbers.explained());
        if closes && self.verdict == Verdict::None {
            self.verdict = Verdict::Unknown;
            self.probability = None;
        }
        self.learned = learned.filter(|_| self.verdict == Verdict::Unknown);
    }

    /// Withdraws what was found for a law that is more probable.
    fn prefer(&mut self, law: Option<Learned>) {
        if law.is_some() {
            self.verdict = Verdict::Unknown;
            self.probability = None;
            self.findings.clear();
            self.alike = 0;
            self.after = self.before.clone();
            self.nuisances[1] = self.nuisances[0].clone();
            self.learned = law;
        }
    }
}

/// Sets of one effect that are extended where the most probable one leaves much: of two effects the one that explains
/// more alone need not be among them (a beam of two).
const BEAM: usize = 2;

/// Which set is extended next: the most probable one, until nothing that could be added to it is worth it. A third effect is one
/// beside two that explain the greater part of the gap; where these do not, the catalogue has no answer.
fn next(sets: &[Set], evidence: &Evidence) -> Option<usize> {
    let best = best(sets);
    let closes = || closed(&sets[nameless(sets)].explanation, &sets[best].explanation, evidence);
    let effects = sets[best].names().len();
    let may_grow = effects < 2 || effects < MOST_EFFECTS && closes() >= GREATER_PART;
    let is_open = !sets[best].extended && may_grow;
    let first = is_open.then_some(best).filter(|_| !is_settled(sets, best, evidence));
    first.or_else(|| second(sets).filter(|_| is_missing(&sets[best], evidence)))
}

/// The next of the sets of one effect that the beam holds.
fn second(sets: &[Set]) -> Option<usize> {
    let single = |place: &usize| sets[*place].names().len() == 1;
    let (extended, open): (Vec<usize>, Vec<usize>) = (0..sets.len()).filter(single).partition(|&k| sets[k].extended);
    most_probable(sets, open).filter(|_| extended.len() < BEAM)
}

/// The most probable set, or the part of it that the runs that judge leave, as long as it has several effects that were not
/// replaced by their rivals.
fn unexchanged(sets: &[Set], evidence: &Evidence) -> Option<usize> {
    let open = |place: &usize| !sets[*place].exchanged && sets[*place].assembly.effects().len() > 1;
    let best = best(sets);
    [best, predictive(sets, best, evidence)].into_iter().find(open)
}

/// The most probable set, as long as it has several effects that were not tried without one of them.
fn unreduced(sets: &[Set]) -> Option<usize> {
    let best = best(sets);
    (!sets[best].reduced && sets[best].assembly.effects().len() > 1).then_some(best)
}

/// True where the set that was found has several effects, leaves more of the gap than chance would, or is judged by runs that
/// show no gap to close.
fn is_doubtful(found: &Set, alone: &Set, evidence: &Evidence) -> bool {
    let closes = closed(&alone.explanation, &found.explanation, evidence);
    found.names().len() > 1 || closes < evidence.numbers.certain() || excess(&alone.explanation, evidence) <= 0.0
}

/// The most probable set.
fn best(sets: &[Set]) -> usize {
    most_probable(sets, 0..sets.len()).unwrap_or(0)
}

fn tell(set: &Set, progress: Progress<'_>) {
    let names = set.named().map(|own| format!("{} at {}", own.effect, own.at));
    let names: Vec<String> = names.collect();
    if !names.is_empty() {
        let words = format!("with {} it leaves {}", names.join(" and "), told(&set.explanation));
        progress(News::Known(&words, &set.findings(), &set.explanation));
    }
}

/// Searches for the base model: from the campaign's values, and from values spread over the ranges.
const SPREAD: [f64; 3] = [0.0, 0.35, -0.35];
const BASE: [(usize, usize); 3] = [(2, 10), (2, 10), (2, 20)];

/// The base model, fitted.
fn base(assembly: Assembly, evidence: &Evidence) -> Result<Set, PredictError> {
    let fidelity = fidelity(evidence);
    let hypothesis = assembly.hypothesis();
    let starts = SPREAD.par_iter().map(|&spread| {
        let from = Place {
            named: setting_spread(&assembly, spread),
            ..Place::given(&fidelity.coarse)
        };
        hypothesis.fit(&from, &fidelity.coarse, BASE[0])
    });
    let (fitted, refused): (Vec<_>, Vec<_>) = starts.partition_map(|start| match start {
        Ok(refit) => Either::Left(refit),
        Err(error) => Either::Right(error),
    });
    let is_number = |refit: &Refit| refit.log_evidence.is_finite();
    let order = |a: &Refit, b: &Refit| a.log_evidence.total_cmp(&b.log_evidence);
    // What cannot be predicted at all is an error here, where among many it only drops out.
    let refusal = refused.into_iter().next().unwrap_or(PredictError::NoNumber);
    let best = fitted.into_iter().filter(is_number).max_by(order).ok_or(refusal)?;
    let medium = hypothesis.fit(&hypothesis.place(&best), &fidelity.medium, BASE[1])?;
    let fine = hypothesis.fit(&hypothesis.place(&medium), &fidelity.fine, BASE[2])?;
    let explanation = hypothesis.explanation(fine, evidence)?;
    if !is_number(&explanation.refit) {
        return Err(PredictError::NoNumber);
    }
    Ok(Set::new(assembly, explanation, 0.0))
}

/// The given values, every other one moved this way towards the end of its range, and the others the other way.
fn setting_spread(assembly: &Assembly, spread: f64) -> std::collections::BTreeMap<String, f64> {
    let moved = |(k, given): (usize, &super::posterior::Given)| {
        let (low, high) = given.range?;
        let shift = if k.is_multiple_of(2) { spread } else { -spread };
        let end = if shift < 0.0 { low } else { high };
        let share = shift.abs();
        let moved = if low > 0.0 && given.value > 0.0 {
            given.value * (end / given.value).powf(share)
        } else {
            given.value + (end - given.value) * share
        };
        Some((given.name.clone(), moved))
    };
    assembly.given().iter().enumerate().filter_map(moved).collect()
}

/// A set with one effect more each, those that are worth it.
/// What one effect would gain must be worth it, and more than the `lead` of a learned law.
fn extensions(set: &Set, lead: f64, evidence: &Evidence, progress: Progress<'_>) -> Result<Vec<Set>, PredictError> {
    let candidates = set.assembly.candidates();
    progress(News::Doing(&format!(
        "screening {} effects at their places",
        candidates.len()
    )));
    let refit = &set.explanation.refit;
    // What sweeps show beyond steady harmonics changes little with one effect more.
    let steady = evidence.less(&refit.unsteady).hurried();
    let fidelity = fidelity(&steady);
    let mut prospects = screen(&set.assembly, &candidates, refit, &fidelity.coarse)?;
    // A model that leaves much has poor parameters: what an effect gains there to first order says little. Beside an effect, the fits that
    // led to it have begun from the start values already.
    if set.names().is_empty() && is_missing(set, evidence) {
        let given = Place::given(&fidelity.coarse);
        for prospect in &mut prospects {
            prospect.start_from(&given, &set.assembly, &candidates[prospect.candidate]);
        }
    }
    let least = (candidates.len() as f64 / evidence.numbers.false_alarms).ln();
    // The screening sees every so many-th line, the lead is that of all of them.
    let least = least.max(lead / THINNED[0] as f64);
    let worth = |own: &screen::Prospect| own.gain() > least;
    if !prospects.iter().any(worth) {
        return Ok(Vec::new());
    }
    let entering = entrants(&candidates, &prospects);
    let (finalists, dropped) = race(&set.assembly, &candidates, &entering, &fidelity, progress);
    let of_finalist = |finalist: Finalist| {
        let candidate = &candidates[finalist.candidate];
        let hypothesis = set.assembly.hypothesis_with(candidate)?;
        let explanation = explained(&hypothesis, finalist.refit, evidence)?;
        // No odds are laid against a nuisance: every real car has some of it, and the evidence alone says whether it is seen.
        let prior = if candidate.nuisance {
            set.log_prior
        } else {
            set.log_prior + log_prior(candidate, &candidates) + set.odds_of_another(&evidence.numbers).ln()
        };
        Some(Set::new(set.assembly.with(candidate)?, explanation, prior))
    };
    let mut sets: Vec<Set> = finalists.into_par_iter().filter_map(of_finalist).collect();
    let rivals = rivals(&candidates, &dropped);
    for own in &mut sets {
        own.rivals.clone_from(&rivals);
    }
    Ok(sets)
}

/// What a fit says of all runs; `None` where that, or its evidence, is no number.
fn explained(hypothesis: &Hypothesis<'_>, refit: Refit, evidence: &Evidence) -> Option<Explanation> {
    let explanation = hypothesis.explanation(refit, evidence).ok()?;
    explanation.refit.log_evidence.is_finite().then_some(explanation)
}

/// Dropped candidates that are told of.
const RIVALS: usize = 3;

/// The best of those that were dropped, each name once: its forms are no rivals of one another.
fn rivals(candidates: &[Candidate], dropped: &[Dropped]) -> Vec<Rival> {
    let mut rivals: Vec<Rival> = Vec::new();
    for left in dropped {
        let own = rival(&candidates[left.candidate], left.behind);
        let is_it = |known: &Rival| (&known.effect, &known.at) == (&own.effect, &own.at);
        let is_answer = !candidates[left.candidate].nuisance && !rivals.iter().any(is_it);
        if rivals.len() < RIVALS && is_answer {
            rivals.push(own);
        }
    }
    rivals
}

/// A candidate as a rival.
fn rival(candidate: &Candidate, behind: f64) -> Rival {
    Rival {
        effect: candidate.effect.clone(),
        at: candidate.at.clone(),
        behind: -behind,
        early: true,
    }
}

/// Logarithm of the odds of a candidate before any measurement: even odds that something is missing, equal ones for all
/// effects, shared among the places and forms of one.
fn log_prior(candidate: &Candidate, all: &[Candidate]) -> f64 {
    let of_effect = all.iter().filter(|other| other.effect == candidate.effect).count();
    let mut effects: Vec<&str> = all.iter().map(|other| other.effect.as_str()).collect();
    effects.sort_unstable();
    effects.dedup();
    -((effects.len() * of_effect) as f64).ln()
}

/// The set less one of its effects each, of the last too: from here the others may come to a better place than that from
/// which the set was extended.
fn reductions(set: &Set, base: &Set, evidence: &Evidence, progress: Progress<'_>) -> Vec<Set> {
    progress(News::Doing("fitting with one effect less"));
    let without = |left_out| without(left_out, set, base, evidence);
    (0..set.assembly.effects().len())
        .into_par_iter()
        .filter_map(without)
        .collect()
}

/// The set less one of its effects, by its place; `None` where that cannot be fitted.
fn without(left_out: usize, set: &Set, base: &Set, evidence: &Evidence) -> Option<Set> {
    let effects = set.assembly.effects();
    let others: Vec<&Placed> = effects[..left_out].iter().chain(&effects[left_out + 1..]).collect();
    let assembly = base.assembly.with_all(&others)?;
    let hypothesis = assembly.hypothesis();
    let mut from = set.assembly.hypothesis().place(&set.explanation.refit);
    from.errors.truncate(base.assembly.hypothesis().sensor_errors());
    let steady = evidence.less(&set.explanation.refit.unsteady).hurried();
    let refit = hypothesis.fit(&from, &steady, (2, 15)).ok()?;
    let explanation = explained(&hypothesis, refit, evidence)?;
    let share = set.log_prior * others.len() as f64 / effects.len() as f64;
    Some(Set::new(assembly, explanation, share))
}

/// Every so many-th line of a sweep in the coarse and the medium data.
const THINNED: [usize; 2] = [6, 3];

/// The data of each fidelity: rides take the time of many sweeps, and all of them only count in the end.
fn fidelity(evidence: &Evidence) -> Fidelity {
    let mut rides: Vec<usize> = (0..evidence.runs.len())
        .filter(|&run| evidence.runs[run].role == Role::Fit && is_ride(&evidence.runs[run].stimulus))
        .collect();
    rides.sort_by(|&a, &b| evidence.runs[b].level.total_cmp(&evidence.runs[a].level));
    let keep = |run: usize| {
        let own = &evidence.runs[run];
        own.role == Role::Fit && (!is_ride(&own.stimulus) || rides.first() == Some(&run))
    };
    let few = evidence.only(keep);
    Fidelity {
        coarse: few.thinned(THINNED[0]),
        medium: few.thinned(THINNED[1]),
        fine: evidence.only(|run| evidence.runs[run].role == Role::Fit),
    }
}

fn is_ride(stimulus: &Stimulus) -> bool {
    matches!(stimulus, Stimulus::Cleat(_))
}
