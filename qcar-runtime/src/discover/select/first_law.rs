//! Learns one law at one place before pairs and triples of effects are tried. If the law explains the excess residual
//! and no single effect does, few sets of effects can still overtake it.

use super::learn::{holds, with_law};
use super::set::{Set, closed, nameless};
use super::{Progress, best};
use crate::discover::numbers::GREATER_PART;
use crate::discover::observe::Evidence;

/// The most probable law beside the nameless set, computed on first use.
#[derive(Default)]
pub struct FirstLaw {
    /// Position of the nameless set, and its law; `None` before the first use.
    known: Option<(usize, Option<Set>)>,
}

impl FirstLaw {
    /// The law; `None` if none can be fitted. Learns again if the nameless set has changed.
    pub fn beside(&mut self, sets: &[Set], evidence: &Evidence, progress: Progress<'_>) -> Option<Set> {
        let alone = nameless(sets);
        if self.known.as_ref().is_none_or(|(beside, _)| *beside != alone) {
            self.known = Some((alone, with_law(&sets[alone], evidence, progress)));
        }
        self.known.as_ref().and_then(|(_, law)| law.clone())
    }

    /// Lead of the law over a set with effects: the difference of the log posteriors minus the log odds of a certain
    /// answer, at least 0. It is 0 if the set has no effects, if the best set explains most of the excess residual, if
    /// the data do not support the law, or if the law does not explain nearly all of it.
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
