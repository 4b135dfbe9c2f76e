//! The names in the answer: the smallest set of hypotheses that reaches the required probability (a credible set).

use std::cell::OnceCell;

use super::held_out::{is_refuted, supported_part};
use super::probability::probabilities;
use super::set::{Set, best_base, is_part, most_probable_first};
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

/// Joint probability of sets that are left out of the answers, relative to that of the answers that are not dismissed.
/// A choice, far below any probability that is shown.
const NEGLIGIBLE: f64 = 1e-9;

/// The answers, most probable first. Merges sets with the same names.
pub fn answers(sets: &[Set], evidence: &Evidence) -> Vec<Answer> {
    let probability = probabilities(&sets.iter().collect::<Vec<_>>(), evidence);
    let supported = Supported::new(sets, evidence);
    let mut places: Vec<usize> = (0..sets.len()).collect();
    places.sort_by(|a, b| probability[*b].total_cmp(&probability[*a]));
    let mut answers: Vec<Answer> = Vec::new();
    for (k, &place) in places.iter().enumerate() {
        let open: f64 = places[k..].iter().map(|&place| probability[place]).sum();
        let possible = answers.iter().filter(|own| !own.dismissed);
        let possible: f64 = possible.map(|own| own.probability).sum();
        if possible > 0.0 && open <= NEGLIGIBLE * possible {
            break;
        }
        let part = supported.part_of(place);
        let dismissed = part != place && sets[part].names().is_empty();
        let set = if dismissed {
            place
        } else {
            supported.represented_by(place)
        };
        let is_it = |own: &&mut Answer| own.dismissed == dismissed && sets[own.set].names() == sets[set].names();
        match answers.iter_mut().find(is_it) {
            Some(own) => {
                if sets[set].log_posterior() > sets[own.set].log_posterior() {
                    own.set = set;
                }
                own.probability += probability[place];
            }
            None => answers.push(Answer {
                set,
                probability: probability[place],
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

/// The parts of sets that the held-out runs support, each found when it is first needed.
struct Supported<'a> {
    sets: &'a [Set],
    evidence: &'a Evidence,
    parts: Vec<OnceCell<usize>>,
}

impl<'a> Supported<'a> {
    fn new(sets: &'a [Set], evidence: &'a Evidence) -> Self {
        Self {
            sets,
            evidence,
            parts: vec![OnceCell::new(); sets.len()],
        }
    }

    /// The supported part of the set at this position.
    fn part_of(&self, place: usize) -> usize {
        *self.parts[place].get_or_init(|| supported_part(self.sets, place, self.evidence))
    }

    /// The set to whose probability a set contributes. If the held-out runs support the whole set, that is the set
    /// itself. Otherwise it is the most probable fully supported set that contains the supported part: the part shows
    /// that its effects are present, but not that no other is.
    fn represented_by(&self, place: usize) -> usize {
        let (sets, part) = (self.sets, self.part_of(place));
        if part == place {
            return place;
        }
        let contains_part = |&other: &usize| is_part(&sets[part], &sets[other]);
        let others = most_probable_first(sets, (0..sets.len()).filter(contains_part));
        let supported = others.into_iter().find(|&other| self.part_of(other) == other);
        supported.unwrap_or(part)
    }
}

/// The credible set: the most probable names that together reach the required probability, without names that only add
/// effects to another member.
///
/// It is the base model alone if the probability of the base model exceeds the accepted probability of error. It also
/// is if dismissed names are certainly more probable than all others, since something else is then missing; except if
/// the held-out runs refute all of these names in favour of the most probable ones that are not dismissed.
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
    let is_certain = |own: &&Answer| {
        let possible = most_probable.map_or(0.0, |possible| possible.probability);
        own.probability > numbers.odds_of_certain() * possible
    };
    let mut before = answers.iter().take_while(|own| own.dismissed).filter(is_certain);
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
