//! Searches for missing effects: compares sets of effects by their evidence and checks them on held-out runs.

// Unknowns of an effect in a model.
mod unknowns;
// The data at three fidelities.
mod fidelity;
// Models with effects, ready to be fitted.
pub mod assembly;
// A fit, linearised.
mod tangent;
// Score test of every candidate without a fit.
mod screen;
// Successive halving of the candidates.
mod race;
// Multi-start fit of a model without effects.
mod multi_start;
// A set of effects with its fit.
mod set;
// The fitted base model.
mod base;
// Sets with one more effect.
mod extend;
// Posterior probabilities of the sets.
mod probability;
// Effects that make up for the form of another at their link.
mod form;
// Checks on held-out runs.
mod held_out;
// Names in the answer.
mod answers;
// Verdict and most probable candidates.
mod verdict;
// The error of the integration of records.
mod integration;
// Sets that short windows of the records exclude.
mod window_check;
// Sets with one effect less.
mod reduce;
// Replacement of effects by their rivals.
mod exchange;
// Sets with parameters beyond the ranges of the campaign.
mod ranges;
// Learned laws for effects that the catalogue lacks.
mod learn;
// Effects that only make up for the form of another's law.
mod free_form;
// The first learned law, before pairs and triples of effects are tried.
mod first_law;
// Whether a learned law takes the place of named effects.
mod law_or_names;
// Detection limits of effects that were not found.
mod detection_limit;

use std::sync::Arc;

use rayon::prelude::*;

use assembly::{Assembly, Hypothesis};
use base::fit_base;
use detection_limit::detection_limits;
use exchange::{exchanges, other_forms};
use extend::extensions;
use fidelity::Fidelity;
use first_law::FirstLaw;
use free_form::without_effects_of_form;
use held_out::supported_part;
use integration::AccuracyCheck;
use law_or_names::compare_with_law;
use ranges::with_ranges_of_model;
use reduce::reductions;
use set::{
    Set, best_base, explained_share, held_out_judge, is_missing, keep_best, leaves_more_than_noise, misses_a_sensor,
    most_probable, most_probable_first, predicts_worse_than_noise,
};
use verdict::conclude;

pub use multi_start::{Minimum, MultiStart, fit_from_starts};

use super::answer::{DetectionLimit, Discovery, Progress, Update, Verdict, rms_text};
use super::candidate::Workshop;
use super::numbers::{GREATER_PART, MOST_EFFECTS};
use super::observe::{Evidence, PredictError, Quieter, Run, Stimulus};
use super::posterior::{Explanation, Refit, Setting};
use crate::campaign::Role;
use crate::simulate::Accuracy;

/// Searches for the effects that the model lacks. Calls `progress` with each step and each intermediate result. Removes
/// the noise of recorded inputs from `evidence`, with a notice, if that makes the measured responses more probable.
///
/// # Errors
/// Fails if no run may be fitted, if the model lacks a measured quantity, if a parameter has no value, or if the base
/// model cannot be predicted.
pub fn discover(
    workshop: Box<dyn Workshop>,
    setting: &Setting,
    evidence: &mut Evidence,
    progress: Progress<'_>,
) -> Result<Discovery, PredictError> {
    if evidence.of_role(Role::Fit).next().is_none() {
        return Err(PredictError::NothingToFit);
    }
    progress(Update::Step("fitting the base model"));
    let workshop: Arc<dyn Workshop> = Arc::from(workshop);
    let fitted = |evidence: &Evidence| fit_base(Assembly::base(workshop.clone(), setting, evidence)?, evidence);
    let mut base = fitted(evidence)?;
    if evidence.allow_for_starts(base.assembly.model(), &base.explanation.refit.values)? {
        base = base.fitted_to(evidence).ok_or(PredictError::NoNumber)?;
    }
    let mut quieter = Quieter::of(evidence);
    if let Some(own) = quieter.take() {
        let other = fitted(&own.evidence)?;
        if is_more_probable(other.explanation.refit.log_evidence, &base, evidence) {
            *evidence = own.seen_by(other.assembly.model(), &other.explanation.refit.values)?;
            base = fitted(evidence)?;
        } else {
            quieter = Some(own);
        }
    }
    let search = |sets: Vec<Set>, evidence: &mut Evidence| {
        let mut sets = sets;
        evidence.held_out_judge = held_out_judge(&sets[0], evidence);
        loop {
            let found = match attempt(sets, evidence, progress) {
                Ok(searched) => return Ok::<_, PredictError>(searched),
                Err(found) => found,
            };
            progress(Update::Step("continuing the search with a more accurate integration"));
            *evidence = evidence.integrated_with(Accuracy::HIGH);
            sets = fitted_to(evidence, fitted(evidence)?, &found);
        }
    };
    let searched = search(vec![base], evidence)?;
    if !evidence.could_be_more_accurate() {
        quieter = quieter.map(|own| own.integrated_with(Accuracy::HIGH));
    }
    // A large missing effect can hide the noise of the inputs, so the filtered inputs are tested again with the answer.
    let found = searched.found();
    let quieter = quieter.filter(|quieter| {
        let again = found.again(&quieter.evidence);
        again.is_some_and(|log_evidence| is_more_probable(log_evidence, found, evidence))
    });
    let Some(quieter) = quieter else {
        evidence.notices.extend(found.notes());
        return Ok(searched.discovery);
    };
    *evidence = quieter.seen_by(found.assembly.model(), &found.explanation.refit.values)?;
    progress(Update::Step(
        "continuing the search without the noise of the recorded inputs",
    ));
    let mut base = fitted(evidence)?;
    base.extended = searched.sets[0].extended;
    let searched = search(fitted_to(evidence, base, &searched.sets), evidence)?;
    evidence.notices.extend(searched.found().notes());
    Ok(searched.discovery)
}

/// A search that has ended.
struct Searched {
    discovery: Discovery,
    sets: Vec<Set>,
    /// Position of the set of the answer.
    found: usize,
}

impl Searched {
    fn found(&self) -> &Set {
        &self.sets[self.found]
    }
}

/// The sets of a search for nearly the same data, beside the base model that is fitted to them. The most probable one is
/// to be extended again: the change may have uncovered a further effect.
fn fitted_to(evidence: &Evidence, base: Set, found: &[Set]) -> Vec<Set> {
    let others = found.par_iter().skip(1);
    let others: Vec<Set> = others.filter_map(|own| own.fitted_to(evidence)).collect();
    let mut sets = vec![base];
    sets.extend(others);
    let best = best(&sets);
    sets[best].extended = false;
    sets
}

/// True if the same responses are more probable with the other data, by the odds of a certain answer.
fn is_more_probable(log_evidence: f64, than: &Set, evidence: &Evidence) -> bool {
    log_evidence - than.explanation.refit.log_evidence > evidence.numbers.odds_of_certain().ln()
}

/// The search from fitted sets, of which the first is the base model. As soon as the error of the integration of records
/// could change the answer, it ends with the sets that it has found.
fn attempt(mut sets: Vec<Set>, evidence: &Evidence, progress: Progress<'_>) -> Result<Searched, Vec<Set>> {
    if sets.len() == 1 {
        let text = format!(
            "the base model alone leaves {}",
            rms_text(&sets[0].explanation, evidence)
        );
        progress(Update::Interim(&text, &[], &sets[0].explanation));
    }
    let mut law = FirstLaw::default();
    let mut accuracy = AccuracyCheck::new(evidence);
    while let Some(place) = next(&sets, evidence) {
        sets[place].extended = true;
        let lead = law.lead(&sets, place, evidence, progress);
        for own in extensions(&sets[place], lead, evidence, progress) {
            keep_best(own, &mut sets);
        }
        while let Some(place) = with_untried_forms(&sets, evidence) {
            sets[place].forms_tried = true;
            progress(Update::Step("trying the other forms of each effect"));
            let others = other_forms(&sets[place], &sets, evidence);
            sets.extend(others);
        }
        refit_best(&mut sets, evidence);
        if !accuracy.suffices(&sets) {
            return Err(sets);
        }
        report(&sets[best(&sets)], evidence, progress);
    }
    // Remove effects that the evidence no longer supports beside those found later.
    while let Some(place) = unreduced(&sets, evidence) {
        sets[place].reduced = true;
        let less = reductions(&sets[place], &sets[0], evidence, progress);
        sets.extend(less);
    }
    while let Some(place) = unexchanged(&sets, evidence) {
        sets[place].exchanged = true;
        progress(Update::Step("trying the rivals of each effect"));
        let others = exchanges(&sets[place], &sets, evidence);
        sets.extend(others);
    }
    let place = best(&sets);
    sets = without_effects_of_form(sets, place, evidence, progress);
    for own in with_ranges_of_model(&sets, best(&sets), evidence) {
        keep_best(own, &mut sets);
    }
    refit_best(&mut sets, evidence);
    if !accuracy.suffices(&sets) {
        return Err(sets);
    }
    let (mut discovery, mut found) = conclude(&sets, evidence);
    if let Some(mended) = accuracy.mended(&sets[found]) {
        if !accuracy.is_settled(&mended, &sets[found]) {
            return Err(sets);
        }
        sets[found] = mended;
        (discovery, found) = conclude(&sets, evidence);
    }
    compare_with_law(&mut discovery, found, &sets, &mut law, evidence, progress);
    if discovery.verdict == Verdict::None {
        discovery.detection_limits = limits(&sets[best_base(&sets)], evidence);
    }
    Ok(Searched { discovery, sets, found })
}

/// Detection limits of the effects that a base model lacks, from the fitted runs.
fn limits(base: &Set, evidence: &Evidence) -> Vec<DetectionLimit> {
    let refit = &base.explanation.refit;
    let steady = evidence.minus(&refit.unsteady).with_step_limit();
    detection_limits(&base.assembly, refit, &Fidelity::of(&steady).fine)
}

/// True if all runs are records and the set leaves no more than noise in the fitted and in the held-out ones. The
/// uncertainty of a record includes half a percent of the response, as the smallest error of any model. What a further
/// effect gains below that comes from noise of the recorded inputs, mains hum or drift.
fn lacks_nothing(set: &Set, evidence: &Evidence) -> bool {
    let is_record = |run: &Run| matches!(run.stimulus, Stimulus::History { .. });
    let leaves_noise = !leaves_more_than_noise(set, evidence) && !predicts_worse_than_noise(set, evidence);
    evidence.runs.iter().all(is_record) && leaves_noise
}

/// True if the held-out runs support only a part of the set and this part explains most of the excess residual.
fn needs_no_further_effect(sets: &[Set], set: usize, evidence: &Evidence) -> bool {
    let answer = supported_part(sets, set, evidence);
    let explained = explained_share(&sets[best_base(sets)], &sets[answer], evidence);
    answer != set && explained >= GREATER_PART
}

/// Beam width: the number of one-effect sets that are extended while an effect is still missing. The best pair may not
/// contain the best single effect.
const BEAM: usize = 2;

/// The set to extend next; `None` if no extension is worth trying. In this order:
///
/// 1. the most probable set that would be an answer (see [`may_grow`]);
/// 2. the base model with the nuisance effects that the data show, if the most probable set leaves a significant part;
/// 3. the next one-effect set of the beam, if something is still missing, or if more than noise is left and that set
///    explains most of the excess residual too.
///
/// Nothing is worth trying if the most probable set lacks nothing.
fn next(sets: &[Set], evidence: &Evidence) -> Option<usize> {
    let best = best(sets);
    if lacks_nothing(&sets[best], evidence) {
        return None;
    }
    let explained = |set: usize| explained_share(&sets[best_base(sets)], &sets[set], evidence);
    let first = most_probable_first(sets, 0..sets.len())
        .into_iter()
        .find(|&set| !needs_no_further_effect(sets, set, evidence))
        .filter(|&set| !sets[set].extended && may_grow(sets, set, evidence));
    let base =
        || Some(best_base(sets)).filter(|&base| !sets[base].extended && explained(best) < evidence.numbers.certain());
    let is_worth_it = |second: usize| {
        let leaves_more = leaves_more_than_noise(&sets[best], evidence);
        is_missing(&sets[best], evidence) || leaves_more && explained(second) >= evidence.numbers.explained()
    };
    first
        .or_else(base)
        .or_else(|| second(sets).filter(|&second| is_worth_it(second)))
}

/// True if a set may have one more effect. A third one is tried only if the first two explain most of the excess residual,
/// since otherwise the catalogue has no answer, and if they still miss a sensor, in held-out or in fitted runs, or need
/// sensors less accurate than their data sheets: a wrong gain may be the third.
fn may_grow(sets: &[Set], set: usize, evidence: &Evidence) -> bool {
    let own = &sets[set];
    let effects = own.names().len();
    let explains = || explained_share(&sets[best_base(sets)], own, evidence) >= GREATER_PART;
    let misses_in = |role: Role| misses_a_sensor(own, evidence, role);
    let misses = || misses_in(Role::HeldOut) || misses_in(Role::Fit) || own.has_inaccurate_sensors();
    effects < 2 || effects < MOST_EFFECTS && explains() && misses()
}

/// The next one-effect set to extend; `None` if the beam is full or no such set is left.
fn second(sets: &[Set]) -> Option<usize> {
    let single = |place: &usize| sets[*place].names().len() == 1;
    let (extended, open): (Vec<usize>, Vec<usize>) = (0..sets.len()).filter(single).partition(|&k| sets[k].extended);
    most_probable(sets, open).filter(|_| extended.len() < BEAM)
}

/// The most probable set, if it has effects, leaves more than noise, and the other forms of its effects have not been
/// tried yet; or else the most probable set with another single effect, if that explains nearly all of the excess residual.
fn with_untried_forms(sets: &[Set], evidence: &Evidence) -> Option<usize> {
    let best = best(sets);
    let has_effects = !sets[best].names().is_empty();
    if !has_effects || !leaves_more_than_noise(&sets[best], evidence) {
        return None;
    }
    let is_rival = |place: &usize| sets[*place].names().len() == 1 && sets[*place].names() != sets[best].names();
    let rival = most_probable(sets, (0..sets.len()).filter(is_rival));
    let explains =
        |place: &usize| explained_share(&sets[best_base(sets)], &sets[*place], evidence) >= evidence.numbers.certain();
    let open = std::iter::once(best).chain(rival.filter(explains));
    open.into_iter().find(|&place| !sets[place].forms_tried)
}

/// Fits the most probable set again from the smallest discrepancy, with those of the same effects in other forms, if
/// it has effects and leaves more than noise. Keeps the better fits.
fn refit_best(sets: &mut Vec<Set>, evidence: &Evidence) {
    let best = &sets[best(sets)];
    if best.names().is_empty() || !leaves_more_than_noise(best, evidence) {
        return;
    }
    let is_open = |place: &usize| !sets[*place].refitted && sets[*place].names() == best.names();
    let open: Vec<usize> = (0..sets.len()).filter(is_open).collect();
    let again = open
        .par_iter()
        .filter_map(|&place| sets[place].at_small_discrepancy(evidence));
    let again: Vec<Set> = again.collect();
    open.iter().for_each(|&place| sets[place].refitted = true);
    again.into_iter().for_each(|own| keep_best(own, sets));
}

/// The most probable set, or the part of it that the held-out runs support, if it has several effects and its rivals
/// have not been tried yet.
fn unexchanged(sets: &[Set], evidence: &Evidence) -> Option<usize> {
    let open = |place: &usize| !sets[*place].exchanged && sets[*place].assembly.effects().len() > 1;
    let best = best(sets);
    [best, supported_part(sets, best, evidence)].into_iter().find(open)
}

/// The most probable set or its part that the held-out runs support, if it has several effects and has not been fitted
/// without each of them yet.
fn unreduced(sets: &[Set], evidence: &Evidence) -> Option<usize> {
    let open = |place: &usize| !sets[*place].reduced && sets[*place].assembly.effects().len() > 1;
    let best = best(sets);
    [best, supported_part(sets, best, evidence)].into_iter().find(open)
}

fn best(sets: &[Set]) -> usize {
    most_probable(sets, 0..sets.len()).unwrap_or(0)
}

fn report(set: &Set, evidence: &Evidence, progress: Progress<'_>) {
    let names = set.named().map(|own| format!("{} at {}", own.effect, own.at));
    let names: Vec<String> = names.collect();
    if !names.is_empty() {
        let left = rms_text(&set.explanation, evidence);
        let words = format!("with {} it leaves {left}", names.join(" and "));
        progress(Update::Interim(&words, &set.findings(), &set.explanation));
    }
}

/// Explanation of all runs by a fit; `None` if the prediction fails or the evidence is not finite.
fn finite_explanation(hypothesis: &Hypothesis<'_>, refit: Refit, evidence: &Evidence) -> Option<Explanation> {
    let explanation = hypothesis.explanation(refit, evidence).ok()?;
    explanation.refit.log_evidence.is_finite().then_some(explanation)
}
