//! The error of the integration of records.
//!
//! The error of a step is small beside the noise of a sensor, but over a record with a sharp law the errors add up: a
//! friction without any stiffness at rest is smoothed, and an effect beside it that enforces short steps would seem to
//! explain the difference.

use rayon::prelude::*;

use super::best;
use super::set::Set;
use super::tangent::Tangent;
use crate::discover::observe::Evidence;
use crate::simulate::Accuracy;

/// Checks the sets of a search.
pub struct AccuracyCheck<'a> {
    evidence: &'a Evidence,
    /// Number of sets that have been checked.
    checked: usize,
    /// Largest sum of squares of the error, in units of the noise, that cannot decide between two sets: half of it
    /// is a log likelihood.
    limit: f64,
}

impl<'a> AccuracyCheck<'a> {
    /// A check of the sets that are fitted to this evidence.
    pub fn new(evidence: &'a Evidence) -> Self {
        Self {
            evidence,
            checked: 0,
            limit: 2.0 * evidence.numbers.odds_of_certain().ln(),
        }
    }

    /// Checks the sets that were added since the last check. `None` if a more accurate integration could make one of them
    /// the most probable set, or a less probable one of it.
    pub fn suffices(&mut self, sets: &[Set]) -> Option<()> {
        let unchecked = &sets[self.checked.min(sets.len())..];
        self.checked = sets.len();
        if !self.evidence.could_be_more_accurate() {
            return Some(());
        }
        let most_probable = sets[best(sets)].log_posterior();
        let decides = |set: &Set| {
            let error = self.error(set).unwrap_or(0.0);
            error > self.limit && set.log_posterior() + error > most_probable
        };
        (!unchecked.par_iter().any(decides)).then_some(())
    }

    /// Sum of squares of the error of the predictions of a set, in units of the noise and the discrepancy, that changes
    /// of its unknowns cannot imitate. `None` if it does not fall with the accuracy: the motion diverges, or is so
    /// sensitive that no integration follows the one that was measured.
    fn error(&self, set: &Set) -> Option<f64> {
        let refit = &set.explanation.refit;
        let usual = set.steady(self.evidence);
        let hypothesis = set.assembly.hypothesis();
        let place = hypothesis.place(refit);
        let residuals = |accuracy| hypothesis.residuals_at(&place, refit, &usual.integrated_with(accuracy));
        let accurate = residuals(Accuracy::HIGH)?;
        let error = |accuracy| Some((residuals(accuracy)? - &accurate).norm_squared());
        let own = error(Accuracy::USUAL)?;
        if own <= self.limit {
            return Some(own);
        }
        let falls = error(Accuracy::MEDIUM)? < own / 4.0;
        let independent = || Tangent::new(refit, &set.assembly, &usual).independent_change(&accurate);
        falls.then(independent).flatten()
    }
}
