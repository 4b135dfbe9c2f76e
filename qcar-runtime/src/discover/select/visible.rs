//! Detection limits: the effects that the data would have shown, if none was found.
//!
//! An effect of its default size changes the predicted residuals. The part of this change that no other unknown can
//! imitate, to first order, gives its gain in log likelihood. This gain is compared with the gain that a certain answer
//! needs.

use rayon::prelude::*;

use super::assembly::Assembly;
use super::log_prior;
use super::screen::{Point, Tangent};
use crate::discover::answer::Visible;
use crate::discover::candidate::Candidate;
use crate::discover::numbers::Numbers;
use crate::discover::observe::Evidence;
use crate::discover::posterior::Refit;

/// The detection limit of each effect at each place, in its first form; most visible first.
pub fn visible(assembly: &Assembly, refit: &Refit, evidence: &Evidence) -> Vec<Visible> {
    let tangent = Tangent::new(refit, assembly, evidence);
    let here = assembly.hypothesis().place(refit);
    let candidates = assembly.candidates();
    let mut usual: Vec<&Candidate> = candidates
        .iter()
        .filter(|candidate| !candidate.is_sensor() && !candidate.nuisance)
        .collect();
    usual.dedup_by(|next, first| next.effect == first.effect && next.at == first.at);
    let of = usual.into_par_iter().filter_map(|candidate| {
        let hypothesis = assembly.hypothesis_with(candidate)?;
        let from = Point::usual(candidate).at(&here, &hypothesis, candidate);
        let values = hypothesis.values(&from.named).ok()?;
        let (nuisance, coefficients) = hypothesis.nuisance_at(refit, &from);
        let nuisance = (nuisance, coefficients.as_slice());
        let there = refit.residuals_of(hypothesis.model(), &values, nuisance, assembly.model(), evidence)?;
        let gain = tangent.trace(&there)? / 2.0;
        let times = (gain / needed(candidate, &candidates, gain, &evidence.numbers)).sqrt();
        times.is_finite().then(|| Visible {
            effect: candidate.effect.clone(),
            at: candidate.at.clone(),
            usual: candidate
                .parameters()
                .iter()
                .map(|p| (p.effect_name.clone(), p.start))
                .collect(),
            times,
        })
    });
    let mut visible: Vec<Visible> = of.collect();
    visible.sort_by(|a, b| b.times.total_cmp(&a.times));
    visible
}

/// Gain in log likelihood that makes an effect certain: the log odds against it, plus an Occam factor for each of its
/// free parameters, which such a gain would narrow to a part of its range.
fn needed(candidate: &Candidate, all: &[Candidate], gain: f64, numbers: &Numbers) -> f64 {
    let odds = (numbers.certain() / numbers.doubt).ln() - log_prior(candidate, all);
    odds + candidate.unknowns() as f64 * (1.0 + 2.0 * gain).ln() / 2.0
}
