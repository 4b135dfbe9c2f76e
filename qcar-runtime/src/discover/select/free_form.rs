//! The strongest effect with a law whose form is free, as an alternative to several effects.
//!
//! The law of a real part is never exactly that of the catalogue. A second effect may then only make up for the form of
//! the first: a stop for a spring that stiffens in another way. So the first effect is also fitted with a learned law at
//! its place, which counts like a nuisance effect. If that set is the more probable one, the second effect is not named.

use super::extend::SearchStart;
use super::learn::most_probable_law;
use super::set::{Set, best_base, by_log_posterior, explained_share};
use super::{Progress, Update};
use crate::discover::candidate::Candidate;
use crate::discover::observe::Evidence;

/// The best named effect of the set at `best` with the most probable law at its place; `None` if the set has a single
/// effect, if none of its effects alone explains most of the excess residual, or if no law can be fitted.
pub fn with_free_form(sets: &[Set], best: usize, evidence: &Evidence, progress: Progress<'_>) -> Option<Set> {
    let (base, names) = (&sets[best_base(sets)], sets[best].names());
    if names.len() < 2 {
        return None;
    }
    let is_part = |own: &&Set| matches!(own.names()[..], [name] if names.contains(&name));
    let first = sets.iter().filter(is_part).max_by(|a, b| by_log_posterior(a, b))?;
    if explained_share(base, first, evidence) < evidence.numbers.explained() {
        return None;
    }
    let at = &first.named().next()?.at;
    let laws = first.assembly.laws().into_iter().filter(|own| own.at == *at);
    let laws: Vec<Candidate> = laws.map(|own| Candidate { nuisance: true, ..own }).collect();
    progress(Update::Step(&format!("learning the form of the law at {at}")));
    let steady = evidence.minus(&first.explanation.refit.unsteady).with_step_limit();
    most_probable_law(first, &laws, &SearchStart::of(first, &steady), evidence, progress)
}
