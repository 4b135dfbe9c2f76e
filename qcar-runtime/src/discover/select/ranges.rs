//! Sets with parameters beyond the ranges of the campaign.
//!
//! A range that excludes the true value is a model error, and an effect may make up for it. So a set with a parameter at
//! an end of its range is one hypothesis, and the same set with the range of the model file another, at the prior odds of
//! one more effect.

use rayon::prelude::*;

use super::set::{Set, most_probable_first};
use crate::discover::observe::Evidence;

/// Number of sets of each size that are fitted with wider ranges. A choice that limits the time.
const OF_EACH_SIZE: usize = 2;

/// The most probable sets of no effect, of one, and so on up to the number of the set `best`, with the ranges of the model
/// file for their parameters at an end of the campaign's range. Sets without such a parameter are left out, and those that
/// even so are certainly less probable than the set `best`.
pub fn with_ranges_of_model(sets: &[Set], best: usize, evidence: &Evidence) -> Vec<Set> {
    let is_open = |place: &usize| !sets[*place].beyond_range().is_empty();
    let of_size = |size: usize| {
        let all = (0..sets.len()).filter(move |&place| sets[place].names().len() == size);
        let open = most_probable_first(sets, all).into_iter().filter(is_open);
        open.take(OF_EACH_SIZE)
    };
    let open: Vec<usize> = (0..=sets[best].names().len()).flat_map(of_size).collect();
    let wider = open
        .par_iter()
        .filter_map(|&place| sets[place].with_ranges_of_model(evidence));
    let least = sets[best].log_posterior() - evidence.numbers.odds_of_certain().ln();
    wider.filter(|own| own.log_posterior() >= least).collect()
}
