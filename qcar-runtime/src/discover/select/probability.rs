//! Probability of each set.
//!
//! If the residuals of the most probable set are no larger than noise, and its sensors are as accurate as their data
//! sheets, this is its posterior probability. Otherwise no model is exactly right, neither that of the axle nor that of
//! the sensors' calibration. With many data the posterior then strongly prefers one of two slightly wrong models, and
//! new data might reverse this preference. In that case the probability is the bagged posterior (Huggins and Miller,
//! Bayesian Analysis 18, 2023): the mean of the posterior over data that are resampled with replacement, which includes
//! the scatter of the data. Resampling changes the weights of the data; the fitted parameters stay.

use super::set::{Set, by_log_posterior, leaves_more_than_noise};
use crate::campaign::Role;
use crate::discover::observe::Evidence;
use crate::random::SplitMix;

/// Number of bootstrap draws. It limits the standard error of a probability to 0.016.
const DRAWS: usize = 1000;

/// Probability of each set; they sum to 1.
pub fn probabilities(sets: &[&Set], evidence: &Evidence) -> Vec<f64> {
    let whole: Vec<f64> = sets.iter().map(|set| set.log_posterior()).collect();
    let best = sets.iter().max_by(|a, b| by_log_posterior(a, b));
    let is_wrong = |best: &&&Set| leaves_more_than_noise(best, evidence) || best.has_inaccurate_sensors();
    if best.filter(is_wrong).is_none() {
        return posterior(&whole);
    }
    let of_fit = |set: &&Set| set.explanation.log_likelihoods(Role::Fit, evidence).unwrap_or_default();
    let parts: Vec<Vec<f64>> = sets.iter().map(of_fit).collect();
    bagged(&whole, &parts)
}

/// Posterior probability of each model; `whole` is its log posterior, up to a constant.
fn posterior(whole: &[f64]) -> Vec<f64> {
    let most = whole.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let weights: Vec<f64> = whole.iter().map(|log| (log - most).exp()).collect();
    let all: f64 = weights.iter().sum();
    weights.into_iter().map(|weight| weight / all).collect()
}

/// Mean posterior over resampled data. `whole` is the log posterior of each model, up to a constant; `parts` is the
/// contribution of each part of the data to it.
fn bagged(whole: &[f64], parts: &[Vec<f64>]) -> Vec<f64> {
    let count = parts.iter().map(Vec::len).min().unwrap_or(0);
    let mut random = SplitMix::new(0);
    let mut sum = vec![0.0; whole.len()];
    for _ in 0..DRAWS {
        let mut drawn = vec![-1.0; count];
        (0..count).for_each(|_| drawn[random.below(count)] += 1.0);
        let again = whole.iter().zip(parts).map(|(whole, parts)| {
            let changed: f64 = drawn.iter().zip(parts).map(|(drawn, part)| drawn * part).sum();
            whole + changed
        });
        let again = posterior(&again.collect::<Vec<f64>>());
        sum.iter_mut().zip(again).for_each(|(sum, own)| *sum += own);
    }
    sum.into_iter().map(|sum| sum / DRAWS as f64).collect()
}

#[cfg(test)]
mod tests {
    use super::bagged;

    /// If all parts of the data agree, resampling leaves the preference of the evidence unchanged.
    #[test]
    fn data_that_agree_keep_the_probability() {
        let parts = [vec![0.0; 40], vec![0.5; 40]];
        let probability = bagged(&[0.0, 20.0], &parts);
        assert!((0.999_999..=1.0).contains(&probability[1]), "{probability:?}");
    }

    /// If two halves of the data disagree, the sum has a known standard deviation, and so has the share of draws that
    /// the other model wins. The 40 parts of 1.5 or -1 have the sum 10 with a standard deviation of √40 · 1.25 = 7.9.
    /// The normal distribution gives the other model Φ(-10/7.9) = 0.103, and slightly more because the posterior of one
    /// draw is no step.
    #[test]
    fn data_that_disagree_are_as_uncertain_as_they_scatter() {
        let halves = (0..40).map(|k| if k % 2 == 0 { 1.5 } else { -1.0 });
        let probability = bagged(&[0.0, 10.0], &[vec![0.0; 40], halves.collect()]);
        assert!((probability[0] - 0.11).abs() < 0.02, "{probability:?}");
    }

    /// Models that no part of the data separates keep their prior odds.
    #[test]
    fn alike_models_keep_their_odds() {
        let parts = vec![vec![-3.0, 2.0, 7.0]; 2];
        let probability = bagged(&[3.0_f64.ln(), 0.0], &parts);
        assert!((probability[0] - 0.75).abs() < 1e-12, "{probability:?}");
    }
}
