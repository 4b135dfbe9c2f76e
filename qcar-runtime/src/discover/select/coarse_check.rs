//! Whether another set can become as probable as a known one, by fits to the coarse data.

use super::assembly::{Hypothesis, Place};
use super::fidelity::Fidelity;
use super::race::{may_catch_up, on_coarse_data};
use super::set::Set;
use crate::discover::observe::Evidence;

/// A set on the coarse data. Records are in windows there if they can be cut, so that phase errors hide nothing.
pub struct CoarseCheck {
    fidelity: Fidelity,
    /// Log evidence of the set; `None` if its fit fails.
    known: Option<f64>,
}

impl CoarseCheck {
    /// The set on the coarse part of evidence without non-steady parts.
    pub fn of(set: &Set, steady: &Evidence) -> Self {
        let fidelity = Fidelity::in_windows(steady).unwrap_or_else(|| Fidelity::of(steady));
        let hypothesis = set.assembly.hypothesis();
        let known = on_coarse_data(&hypothesis, &hypothesis.place(&set.explanation.refit), &fidelity);
        Self {
            fidelity,
            known: known.map(|own| own.log_evidence),
        }
    }

    /// True if a fit from here is so much less probable than the set that fits to more data are in vain.
    pub fn is_hopeless(&self, hypothesis: &Hypothesis<'_>, from: &Place) -> bool {
        let both = on_coarse_data(hypothesis, from, &self.fidelity).zip(self.known);
        both.is_some_and(|(refit, known)| !may_catch_up(&refit, known))
    }
}
