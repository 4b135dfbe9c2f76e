//! Detection limits, if no effect was found: the size at which each effect would have been found.
//!
//! An effect of its default size changes the residuals. The part of this change that the other unknowns cannot
//! reproduce to first order gives its gain in log likelihood. This gain is compared with the gain that a certain answer
//! needs.

use rayon::prelude::*;

use super::assembly::Assembly;
use super::extend::log_prior;
use super::screen::Point;
use super::tangent::Tangent;
use crate::discover::answer::DetectionLimit;
use crate::discover::candidate::Candidate;
use crate::discover::numbers::Numbers;
use crate::discover::observe::Evidence;
use crate::discover::posterior::Refit;

/// The detection limit of each effect at each place, in its first form; most visible first.
pub fn detection_limits(assembly: &Assembly, refit: &Refit, evidence: &Evidence) -> Vec<DetectionLimit> {
    let tangent = Tangent::new(refit, assembly, evidence);
    let here = assembly.hypothesis().place(refit);
    let candidates = assembly.candidates();
    let mut first_forms: Vec<&Candidate> = candidates
        .iter()
        .filter(|candidate| !candidate.is_sensor() && !candidate.nuisance)
        .collect();
    first_forms.dedup_by(|next, first| next.effect == first.effect && next.at == first.at);
    let of = first_forms.into_par_iter().filter_map(|candidate| {
        let hypothesis = assembly.hypothesis_with(candidate)?;
        let from = Point::at_start(candidate).at(&here, &hypothesis, candidate);
        let there = hypothesis.residuals_at(&from, refit, evidence)?;
        let gain = tangent.independent_change(&there)? / 2.0;
        let over_limit = (gain / needed(candidate, &candidates, gain, &evidence.numbers)).sqrt();
        over_limit.is_finite().then(|| DetectionLimit {
            effect: candidate.effect.clone(),
            at: candidate.at.clone(),
            default_size: candidate
                .parameters()
                .iter()
                .map(|p| (p.effect_name.clone(), p.start))
                .collect(),
            over_limit,
        })
    });
    let mut limits: Vec<DetectionLimit> = of.collect();
    limits.sort_by(|a, b| b.over_limit.total_cmp(&a.over_limit));
    limits
}

/// Gain in log likelihood that makes an effect certain: the log odds of a certain answer, less the log prior odds of
/// the effect, plus an Occam factor for each of its free parameters, which such a gain would narrow to a part of its
/// range.
fn needed(candidate: &Candidate, all: &[Candidate], gain: f64, numbers: &Numbers) -> f64 {
    let odds = numbers.odds_of_certain().ln() - log_prior(candidate, all);
    odds + candidate.unknowns() as f64 * (1.0 + 2.0 * gain).ln() / 2.0
}
