//! Learns one law at one place before pairs and triples of effects are tried. If the law explains the excess residual
//! and no single effect does, only the few sets of effects that could still become more probable need a fit.

use super::learn::{is_supported, with_law};
use super::set::{Set, best_base, explained_share};
use super::{Progress, best};
use crate::discover::numbers::GREATER_PART;
use crate::discover::observe::Evidence;

/// The most probable law for the base model with its nuisance effects, computed on first use.
#[derive(Default)]
pub struct FirstLaw {
    /// Position of that base model among the sets, and its law; `None` before the first use.
    known: Option<(usize, Option<Set>)>,
}

impl FirstLaw {
    /// The law; `None` if none can be fitted. Learns again if another set has become the most probable without named
    /// effects.
    pub fn for_base(&mut self, sets: &[Set], evidence: &Evidence, progress: Progress<'_>) -> Option<Set> {
        let base = best_base(sets);
        if self.known.as_ref().is_none_or(|(of, _)| *of != base) {
            self.known = Some((base, with_law(&sets[base], evidence, progress)));
        }
        self.known.as_ref().and_then(|(_, law)| law.clone())
    }

    /// Lead of the law over a set with effects: the difference of the log posteriors minus the log odds of a certain
    /// answer, at least 0. It is 0 if the set has no effects, if the best set explains most of the excess residual, if
    /// the data do not support the law, or if the law does not explain nearly all of it.
    pub fn lead(&mut self, sets: &[Set], set: usize, evidence: &Evidence, progress: Progress<'_>) -> f64 {
        let base = &sets[best_base(sets)];
        let explained = |own: &Set| explained_share(base, own, evidence);
        if sets[set].names().is_empty() || explained(&sets[best(sets)]) >= GREATER_PART {
            return 0.0;
        }
        let explains = |law: &Set| is_supported(law, base, evidence) && explained(law) >= evidence.numbers.certain();
        let odds = evidence.numbers.odds_of_certain().ln();
        let ahead = |law: Set| law.log_posterior() - sets[set].log_posterior() - odds;
        let law = self.for_base(sets, evidence, progress).filter(explains);
        law.map_or(0.0, ahead).max(0.0)
    }
}
