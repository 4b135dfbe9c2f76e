//! Effects that only make up for the form of another law at their link.

use super::set::{Set, excess, most_probable};
use crate::discover::observe::Evidence;

/// True if fewer effects explain what a set explains with several effects at one link. A real law differs a little from
/// any form of the catalogue, and a second law at its link can imitate the difference.
///
/// The form of a law is not expected to be better than that of a whole model: `other` may leave the square of the
/// [expected discrepancy](crate::discover::numbers::Numbers::expected_discrepancy) of the excess residual that the set
/// has without any effect at this link. Both have the same effects elsewhere. Masses and sensors have no form.
pub fn explains_in_one_form(other: &Set, set: &Set, sets: &[Set], evidence: &Evidence) -> bool {
    let shared = shared_links(set);
    let elsewhere = |own: &'_ Set| -> Vec<(String, String)> {
        let names = own.names().into_iter().filter(|(_, at)| !shared.contains(at));
        names.map(|(effect, at)| (effect.to_owned(), at.to_owned())).collect()
    };
    let others = elsewhere(set);
    let acts_at = |at: &&str| other.named().any(|own| own.at == *at);
    if shared.is_empty() || elsewhere(other) != others || !shared.iter().all(acts_at) {
        return false;
    }
    let is_without = |&place: &usize| sets[place].names().len() == others.len() && elsewhere(&sets[place]) == others;
    let Some(without) = most_probable(sets, (0..sets.len()).filter(is_without)) else {
        return false;
    };
    let [left, explained] = [other, &sets[without]].map(|own| excess(&own.with_sensors_of(set, evidence), evidence));
    left <= evidence.numbers.expected_discrepancy.powi(2) * explained
}

/// The links at which a set has several effects.
fn shared_links(set: &Set) -> Vec<&str> {
    let about = set.assembly.model().about();
    let is_link = |at: &str| about.links.iter().any(|link| *link.name == *at);
    let count = |at: &str| set.named().filter(|own| own.at == at).count();
    let mut shared: Vec<&str> = set.named().map(|own| own.at.as_str()).collect();
    shared.retain(|at| is_link(at) && count(at) > 1);
    shared.sort_unstable();
    shared.dedup();
    shared
}
