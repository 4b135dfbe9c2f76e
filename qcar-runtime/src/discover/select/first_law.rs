//! One law at one place, learned before effects are tried in twos and threes: where it explains the gap and no effect does, few
//! sets of effects can still overtake it.

use super::learn::{holds, with_law};
use super::set::{Set, closed, nameless};
use super::{Progress, best};
use crate::discover::numbers::GREATER_PART;
use crate::discover::observe::Evidence;

/// The most probable law beside the model without names, once that was asked for.
#[derive(Default)]
pub struct FirstLaw {
    /// The place of that model among the sets, and the law.
    known: Option<(usize, Option<Set>)>,
}

impl FirstLaw {
    /// The law; `None` where none can be fitted.
    pub fn beside(&mut self, sets: &[Set], evidence: &Evidence, progress: Progress<'_>) -> Option<Set> {
        let alone = nameless(sets);
        if self.known.as_ref().is_none_or(|(beside, _)| *beside != alone) {
            self.known = Some((alone, with_law(&sets[alone], evidence, progress)));
        }
        self.known.as_ref().and_then(|(_, law)| law.clone())
    }

    /// By how much the law is ahead of a set with effects, in the logarithm of the posterior and beyond the odds of a certain
    /// answer; 0 where some set explains the greater part of the gap, or the law less than all but chance.
    pub fn lead(&mut self, sets: &[Set], set: usize, evidence: &Evidence, progress: Progress<'_>) -> f64 {
        let alone = &sets[nameless(sets)];
        let closes = |own: &Set| closed(&alone.explanation, &own.explanation, evidence);
        if sets[set].names().is_empty() || closes(&sets[best(sets)]) >= GREATER_PART {
            return 0.0;
        }
        let settles = |law: &Set| holds(law, alone, evidence) && closes(law) >= evidence.numbers.certain();
        let odds = evidence.numbers.odds_of_certain().ln();
        let ahead = |law: Set| law.log_posterior() - sets[set].log_posterior() - odds;
        let law = self.beside(sets, evidence, progress).filter(settles);
        law.map_or(0.0, ahead).max(0.0)
    }
}
