//! Whether another set can be an alternative to a known one, by fits to short windows of the records.
//!
//! A fit to whole records takes long, and phase errors may lead it to a local minimum. Short windows show what moves in
//! them wherever a fit begins.

use super::assembly::{Hypothesis, Place};
use super::fidelity::Fidelity;
use super::race::{FINE_BUDGET, continued, may_catch_up};
use super::set::{Set, above_noise};
use crate::discover::observe::Evidence;
use crate::discover::posterior::Refit;
use crate::mean::rms_or_nan;

/// A set, fitted to the coarse data in windows.
pub struct WindowCheck {
    coarse: Evidence,
    /// The fit of the set; `None` if it fails.
    known: Option<Fitted>,
    /// Log prior odds of the set.
    log_prior: f64,
}

/// A fit to the coarse data.
struct Fitted {
    refit: Refit,
    /// Mean square of its residuals above that of noise.
    excess: f64,
}

impl WindowCheck {
    /// Fits the set; `windows` is evidence without non-steady parts, in windows.
    pub fn of(set: &Set, windows: &Fidelity) -> Self {
        let coarse = windows.coarse.clone();
        let hypothesis = set.assembly.hypothesis();
        let place = hypothesis.place(&set.explanation.refit);
        Self {
            known: Fitted::from(&place, &hypothesis, &coarse, |_| true),
            coarse,
            log_prior: set.log_prior,
        }
    }

    /// True if fits of another set with these prior odds to more data are in vain: from here it is so much less probable
    /// that it cannot become as probable, and the set explains nearly all of the residual that it leaves.
    pub fn is_hopeless(&self, hypothesis: &Hypothesis<'_>, from: &Place, log_prior: f64) -> bool {
        let Some(known) = &self.known else { return false };
        let even = known.refit.log_evidence + self.log_prior - log_prior;
        let is_behind = |refit: &Refit| refit.log_evidence < even;
        let Some(fitted) = Fitted::from(from, hypothesis, &self.coarse, is_behind) else {
            return false;
        };
        let unexplained = 1.0 - self.coarse.numbers.certain();
        !may_catch_up(&fitted.refit, even) && known.excess <= unexplained * fitted.excess
    }
}

impl Fitted {
    /// A fit that ends when it converges or is no longer worth it.
    fn from(
        place: &Place,
        hypothesis: &Hypothesis<'_>,
        coarse: &Evidence,
        is_worth_it: impl Fn(&Refit) -> bool,
    ) -> Option<Self> {
        let refit = hypothesis.fit(place, coarse, FINE_BUDGET).ok()?;
        let refit = continued(hypothesis, refit, coarse, is_worth_it)?;
        let residuals = hypothesis.residuals_at(&hypothesis.place(&refit), &refit, coarse)?;
        let excess = above_noise(rms_or_nan(residuals.iter().copied()));
        refit.log_evidence.is_finite().then_some(Self { refit, excess })
    }
}
