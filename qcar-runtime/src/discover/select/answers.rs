//! Which names are the answer: those of the smallest list of sets that is certain.

use super::bagged::probabilities;
use super::judging::predictive;
use super::set::{Set, is_part, most_probable, nameless};
use crate::discover::numbers::Numbers;
use crate::discover::observe::Evidence;

/// A list of names, and how probable it is.
pub struct Answer {
    /// Place of its most probable set.
    pub set: usize,
    pub probability: f64,
    /// True for names that are no answer: the runs that judge leave nothing of them, or they are the first ones at a limit.
    pub dismissed: bool,
}

/// The answers, the most probable first: sets of the same names are one.
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

/// The set that a set speaks for: itself, if the runs that judge leave it whole, or else the most probable one that they leave
/// whole and that has what they leave of it. That part says what is there, not that nothing else is.
fn standing(place: usize, sets: &[Set], left: &[usize]) -> usize {
    if left[place] == place {
        return place;
    }
    let part = left[place];
    let speaks = |&other: &usize| left[other] == other && is_part(&sets[part], &sets[other]);
    most_probable(sets, (0..sets.len()).filter(speaks)).unwrap_or(part)
}

/// The smallest list of sets that is certain, without those that only add to another one of it. It is the base model alone
/// where the runs that judge leave nothing of the most probable names, and unless that is less probable than the others have
/// to be certain.
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
