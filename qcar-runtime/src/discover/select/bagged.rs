//! How probable each set is.
//!
//! Where the most probable set leaves no more than noise, that is its posterior probability. Where it leaves more, no model is
//! right in every detail: of two models that are both a little wrong, the evidence of many data prefers one with a certainty
//! that other data would turn around. There it is the mean of the posterior probability over data drawn again with
//! replacement, a bagged posterior (Huggins and Miller, Bayesian Analysis 18, 2023), which is as uncertain as the data
//! scatter. It keeps each fit: only the weights of the data are drawn, not the parameters.

use super::set::{Set, leaves_more_than_noise};
use crate::campaign::Role;
use crate::discover::observe::Evidence;
use crate::random::SplitMix;

/// Draws of the data. The probabilities have a standard error of at most 0.016 by it.
const DRAWS: usize = 1000;

/// The probability of each set.
pub fn probabilities(sets: &[&Set], evidence: &Evidence) -> Vec<f64> {
    let whole: Vec<f64> = sets.iter().map(|set| set.log_posterior()).collect();
    let best = sets
        .iter()
        .max_by(|a, b| a.log_posterior().total_cmp(&b.log_posterior()));
    if !best.is_some_and(|best| leaves_more_than_noise(best, evidence)) {
        return posterior(&whole);
    }
    let of_fit = |set: &&Set| set.log_likelihoods(Role::Fit, evidence).unwrap_or_default();
    let parts: Vec<Vec<f64>> = sets.iter().map(of_fit).collect();
    bagged(&whole, &parts)
}

/// The probability of each model: `whole` is its logarithm, but for a constant.
fn posterior(whole: &[f64]) -> Vec<f64> {
    let most = whole.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let weights: Vec<f64> = whole.iter().map(|log| (log - most).exp()).collect();
    let all: f64 = weights.iter().sum();
    weights.into_iter().map(|weight| weight / all).collect()
}

/// The mean over draws of the parts of the data: `whole` is the logarithm of the posterior of each model, but for a constant,
/// `parts` what each part of the data has added to it.
fn bagged(whole: &[f64], parts: &[Vec<f64>]) -> Vec<f64> {
    let count = parts.iter().map(Vec::len).min().unwrap_or(0);
    let mut random = SplitMix::new(0);
    let mut mean = vec![0.0; whole.len()];
    for _ in 0..DRAWS {
        let mut drawn = vec![-1.0; count];
        (0..count).for_each(|_| drawn[random.below(count)] += 1.0);
        let again = whole.iter().zip(parts).map(|(whole, parts)| {
            let changed: f64 = drawn.iter().zip(parts).map(|(drawn, part)| drawn * part).sum();
            whole + changed
        });
        let again = posterior(&again.collect::<Vec<f64>>());
        mean.iter_mut()
            .zip(again)
            .for_each(|(mean, own)| *mean += own / DRAWS as f64);
    }
    mean
}

#[cfg(test)]
mod tests {
    use super::bagged;

    /// Parts of the data that all say the same leave what the evidence says: the draws change nothing but its scale.
    #[test]
    fn data_that_agree_leave_no_doubt() {
        let parts = [vec![0.0; 40], vec![0.5; 40]];
        let probability = bagged(&[0.0, 20.0], &parts);
        assert!(probability[1] > 0.999_999, "{probability:?}");
    }

    /// A sum that two opposed halves of the data decide: its standard deviation is known, and with it the share of draws in
    /// which the other model wins. Of 40 parts that add 1.5 or -1, the sum is 10 with a standard deviation of
    /// √40 · 1.25 = 7.9; the normal distribution gives Φ(-10/7.9) = 0.103 to the other model, and a little more as the
    /// evidence of one draw is no step.
    #[test]
    fn data_that_disagree_are_as_uncertain_as_they_scatter() {
        let halves = (0..40).map(|k| if k % 2 == 0 { 1.5 } else { -1.0 });
        let probability = bagged(&[0.0, 10.0], &[vec![0.0; 40], halves.collect()]);
        assert!((probability[0] - 0.11).abs() < 0.02, "{probability:?}");
    }

    /// Models that no part of the data tells apart are as probable as before.
    #[test]
    fn alike_models_keep_their_odds() {
        let parts = vec![vec![-3.0, 2.0, 7.0]; 2];
        let probability = bagged(&[3.0_f64.ln(), 0.0], &parts);
        assert!((probability[0] - 0.75).abs() < 1e-12, "{probability:?}");
    }
}
