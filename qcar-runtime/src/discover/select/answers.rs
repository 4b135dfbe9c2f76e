//! The names in the answer: the smallest set of hypotheses that reaches the required probability (a credible set).

use super::bagged::probabilities;
use super::judging::predictive;
use super::set::{Set, is_part, most_probable, nameless};
use crate::discover::numbers::Numbers;
use crate::discover::observe::Evidence;

/// Sets with the same names, and their joint probability.
pub struct Answer {
    /// Position of the most probable of these sets.
    pub set: usize,
    pub probability: f64,
    /// True if these names are no answer: the held-out runs support none of them, or they are a limiting case of the
    /// most probable answer.
    pub dismissed: bool,
}

/// The answers, most probable first. Merges sets with the same names.
pub fn answers(sets: &[Set], evidence: &Evidence) -> Vec<Answer> {
    let probability = probabilities(&sets.iter().collect::<Vec<_>>(), evidence);
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

/// The set that a set counts for. If the held-out runs support the whole set, that is the set itself. Otherwise it is the
/// most probable fully supported set that contains the supported part: the part shows what is there, not that nothing else
/// is.
fn standing(place: usize, sets: &[Set], left: &[usize]) -> usize {
    if left[place] == place {
        return place;
    }
    let part = left[place];
    let speaks = |&other: &usize| left[other] == other && is_part(&sets[part], &sets[other]);
    most_probable(sets, (0..sets.len()).filter(speaks)).unwrap_or(part)
}

/// The credible set: the most probable names that together reach the required probability, without those that only add
/// effects to another member. It is the base model alone if the most probable names are dismissed, or if the base
/// model's probability exceeds the accepted doubt.
pub fn credible(sets: &[Set], answers: &[Answer], numbers: &Numbers) -> Vec<usize> {
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
