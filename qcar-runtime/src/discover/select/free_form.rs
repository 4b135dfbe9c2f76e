//! The strongest effect with a law whose form is free, as an alternative to several effects.
//!
//! The law of a real part is never exactly that of the catalogue. A second effect may then only make up for the form of
//! the first: a stop for a spring that stiffens in another way. So the first effect is also fitted with a learned law at
//! its place. If that is more probable than the several effects, they are no answer.

use super::extend::SearchStart;
use super::learn::most_probable_law;
use super::set::{Set, best_base, by_log_posterior, explained_share};
use super::{Progress, Update};
use crate::discover::candidate::Candidate;
use crate::discover::observe::Evidence;

/// Leaves out the sets of several effects if they only make up for the form of one: the most probable of them, at `best`,
/// is less probable than one of its effects, which explains most of the excess residual alone, with a law at its place.
pub fn without_effects_of_form(sets: Vec<Set>, best: usize, evidence: &Evidence, progress: Progress<'_>) -> Vec<Set> {
    let Some(first) = first_effect(&sets, best, evidence) else {
        return sets;
    };
    let with_law = with_free_form(first, evidence, progress);
    if with_law.is_none_or(|own| own.log_posterior() <= sets[best].log_posterior()) {
        return sets;
    }
    let is_left = |set: &&Set| set.names().len() < 2;
    sets.iter().filter(is_left).cloned().collect()
}

/// The most probable set with a single effect of those of the set at `best`; `None` if that has one, or if the single one
/// does not explain most of the excess residual.
fn first_effect<'s>(sets: &'s [Set], best: usize, evidence: &Evidence) -> Option<&'s Set> {
    let names = sets[best].names();
    let is_one = |own: &&Set| matches!(own.names()[..], [name] if names.contains(&name));
    let first = sets.iter().filter(is_one).max_by(|a, b| by_log_posterior(a, b))?;
    let explained = explained_share(&sets[best_base(sets)], first, evidence);
    (names.len() > 1 && explained >= evidence.numbers.explained()).then_some(first)
}

/// A set of one effect with the most probable law at its place; `None` if no law can be fitted.
fn with_free_form(first: &Set, evidence: &Evidence, progress: Progress<'_>) -> Option<Set> {
    let at = &first.named().next()?.at;
    let laws: Vec<Candidate> = first.assembly.laws().into_iter().filter(|own| own.at == *at).collect();
    progress(Update::Step(&format!("learning the form of the law at {at}")));
    let steady = evidence.minus(&first.explanation.refit.unsteady).with_step_limit();
    most_probable_law(first, &laws, &SearchStart::of(first, &steady), evidence, progress)
}
