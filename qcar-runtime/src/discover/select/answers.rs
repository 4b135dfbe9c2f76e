//! The names in the answer: the smallest set of hypotheses that reaches the required probability (a credible set).

use rayon::prelude::*;

use super::held_out::{is_refuted, supported_part};
use super::probability::probabilities;
use super::set::{Set, best_base, is_part, most_probable};
use crate::discover::observe::Evidence;

/// Sets with the same names, and their joint probability.
pub struct Answer {
    /// Position of the most probable of these sets.
    pub set: usize,
    pub probability: f64,
    /// True if these names cannot be the answer: the held-out runs support none of them, or they are a limiting case of
    /// the most probable answer.
    pub dismissed: bool,
}

/// The answers, most probable first. Merges sets with the same names.
pub fn answers(sets: &[Set], evidence: &Evidence) -> Vec<Answer> {
    let probability = probabilities(&sets.iter().collect::<Vec<_>>(), evidence);
    let supported: Vec<usize> = (0..sets.len())
        .into_par_iter()
        .map(|place| supported_part(sets, place, evidence))
        .collect();
    let mut answers: Vec<Answer> = Vec::new();
    for (place, probability) in probability.iter().copied().enumerate() {
        let dismissed = supported[place] != place && sets[supported[place]].names().is_empty();
        let set = if dismissed {
            place
        } else {
            represented_by(place, sets, &supported)
        };
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
        own.dismissed |= sets[own.set].is_limiting_case_of(&sets[first]);
    }
    answers
}

/// The set to whose probability a set contributes. If the held-out runs support the whole set, that is the set itself.
/// Otherwise it is the most probable fully supported set that contains the supported part: the part shows that its
/// effects are present, but not that no other is.
fn represented_by(place: usize, sets: &[Set], supported: &[usize]) -> usize {
    if supported[place] == place {
        return place;
    }
    let part = supported[place];
    let is_supported = |&other: &usize| supported[other] == other && is_part(&sets[part], &sets[other]);
    most_probable(sets, (0..sets.len()).filter(is_supported)).unwrap_or(part)
}

/// The credible set: the most probable names that together reach the required probability, without names that only add
/// effects to another member.
///
/// It is the base model alone if the probability of the base model exceeds the accepted probability of error. It also
/// is if dismissed names are more probable than all others, since something else is then missing; except if the
/// held-out runs refute all of these names in favour of the most probable ones that are not dismissed.
pub fn credible(sets: &[Set], answers: &[Answer], evidence: &Evidence) -> Vec<usize> {
    let numbers = &evidence.numbers;
    let is_named = |own: &&Answer| !sets[own.set].names().is_empty();
    let none: f64 = answers
        .iter()
        .filter(|own| !is_named(own))
        .map(|own| own.probability)
        .sum();
    let possible = answers.iter().filter(|own| is_named(own) && !own.dismissed);
    let most_probable = possible.clone().next();
    let base = best_base(sets);
    let is_refuted =
        |own: &Answer| most_probable.is_some_and(|by| is_refuted(&sets[own.set], &sets[by.set], &sets[base], evidence));
    let mut before = answers.iter().take_while(|own| own.dismissed);
    let all: f64 = possible.clone().map(|own| own.probability).sum();
    // Named answers may be so improbable that their probability is no positive number.
    if none > numbers.error_probability || !before.all(is_refuted) || all <= 0.0 {
        return vec![base];
    }
    let mut sum = 0.0;
    let credible = possible.take_while(|own| {
        let wanted = sum < numbers.certain() * all;
        sum += own.probability;
        wanted
    });
    let credible: Vec<usize> = credible.map(|own| own.set).collect();
    let adds = |place: &usize| {
        credible
            .iter()
            .any(|other| other != place && is_part(&sets[*other], &sets[*place]))
    };
    credible.iter().copied().filter(|place| !adds(place)).collect()
}
