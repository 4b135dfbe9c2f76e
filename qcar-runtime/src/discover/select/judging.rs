//! What the runs that judge leave of a set: no fit and no choice has seen them.

use super::set::{Set, closed, is_part, most_probable};
use crate::campaign::Role;
use crate::discover::observe::Evidence;

/// The set itself, or the part of it that predicts the runs that judge better, or that leaves little for the rest to close:
/// what does not predict, what changes next to nothing, and what stands for another effect is withdrawn, whichever part shows
/// it. The last needs no runs that judge.
pub fn predictive(sets: &[Set], mut best: usize, evidence: &Evidence) -> usize {
    let judges = evidence.of_role(Role::HeldOut).next().is_some();
    loop {
        let count = sets[best].names().len();
        let is_less = |other: &usize| sets[*other].names().len() < count && is_part(&sets[*other], &sets[best]);
        let is_answer = |other: &usize| is_less(other) && !sets[*other].stands_at_an_end();
        let withdrawn = |&part: &usize| {
            let closes = closed(&sets[part].explanation, &sets[best].explanation, evidence);
            let changes_little = !sets[part].names().is_empty() && closes < evidence.numbers.explained();
            let fails = judges && (changes_little || !predicts(&sets[best], &sets[part], evidence));
            fails || sets[best].adds_a_substitute(&sets[part])
        };
        match most_probable(sets, (0..sets.len()).filter(is_answer).filter(withdrawn)) {
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
