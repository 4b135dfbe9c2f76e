//! The error of the integration of records.
//!
//! The error of a step is small beside the noise of a sensor, but over a record with a sharp law the errors add up: a
//! friction without any stiffness at rest is smoothed, and an effect beside it that enforces short steps would seem to
//! explain the difference.

use nalgebra::DVector;
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

    /// Checks the sets that were added since the last check. False if a more accurate integration could make one of them
    /// the most probable set, or a less probable one of it.
    pub fn suffices(&mut self, sets: &[Set]) -> bool {
        let unchecked = &sets[self.checked.min(sets.len())..];
        self.checked = sets.len();
        if !self.evidence.could_be_more_accurate() {
            return true;
        }
        let most_probable = sets[best(sets)].log_posterior();
        let decides = |set: &Set| {
            let error = self.error(set).unwrap_or(0.0);
            error > self.limit && set.log_posterior() + error > most_probable
        };
        !unchecked.par_iter().any(decides)
    }

    /// The set fitted with a more accurate integration from its optimum, if that is more probable: where steps cannot follow
    /// a sharp law, a fit ends at a smoother one. `None` if it is not, or if there is nothing to integrate.
    pub fn mended(&self, set: &Set) -> Option<Set> {
        if !self.evidence.could_be_more_accurate() {
            return None;
        }
        let mended = set.fitted_to(&self.evidence.integrated_with(Accuracy::HIGH))?;
        (mended.log_posterior() > set.log_posterior()).then_some(mended)
    }

    /// False if the set has become so much more probable that other sets could overtake it in the same way.
    pub fn is_settled(&self, mended: &Set, before: &Set) -> bool {
        mended.log_posterior() - before.log_posterior() <= self.limit / 2.0
    }

    /// Sum of squares of the error of the predictions of a set, in units of the noise and the discrepancy, that changes
    /// of its unknowns cannot imitate; `None` if the whole error is small or does not fall with the accuracy.
    fn error(&self, set: &Set) -> Option<f64> {
        let usual = set.steady(self.evidence);
        let accurate = self.accurate_residuals(set, &usual)?;
        Tangent::new(&set.explanation.refit, &set.assembly, &usual).independent_change(&accurate)
    }

    /// Residuals of a set with an accurate integration, in units of the noise. `None` if they hardly differ from the
    /// `usual` ones, or if the difference does not fall with the accuracy: the motion diverges, or is so sensitive that no
    /// integration follows the one that was measured.
    fn accurate_residuals(&self, set: &Set, usual: &Evidence) -> Option<DVector<f64>> {
        let refit = &set.explanation.refit;
        let hypothesis = set.assembly.hypothesis();
        let place = hypothesis.place(refit);
        let residuals = |accuracy| hypothesis.residuals_at(&place, refit, &usual.integrated_with(accuracy));
        let accurate = residuals(Accuracy::HIGH)?;
        let error = |accuracy| Some((residuals(accuracy)? - &accurate).norm_squared());
        let own = error(Accuracy::USUAL)?;
        (own > self.limit && error(Accuracy::MEDIUM)? < own / 4.0).then_some(accurate)
    }
}
