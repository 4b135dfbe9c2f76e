//! Checks sets on the held-out runs, which no fit has used.

use std::collections::HashSet;

use rayon::prelude::*;

use super::form::explains_in_one_form;
use super::set::{Set, above_noise, best_base, excess, explained_share, held_out_judge, is_part, most_probable_first};
use crate::campaign::Role;
use crate::discover::observe::Evidence;
use crate::discover::posterior::Explanation;

/// The set itself, or the part of it that remains after unsupported effects are removed. A smaller set replaces the set
/// if it predicts the held-out runs at least as well, if it has effects and the additional ones explain too little of
/// its excess residual, if one of these has a parameter at its bound, or if only the cleat runs along one axis prefer
/// the set. It also does if it explains nearly all of the residual and the fitted runs determine no parameter of an
/// additional effect. The last three checks need no held-out runs. If it leaves no more than noise, the additional
/// effects must make the prediction certainly better. A set with a magnitude at its bound replaces no other.
///
/// If the base model leaves only noise in the held-out runs, its effects must either predict these better or explain most
/// of the excess residual of the fitted runs.
///
/// The held-out runs judge only the additional effects that they excite: beside a friction that cleat runs show, a stop
/// that K&C curves alone reach is withdrawn only if the prediction becomes certainly worse with it.
///
/// Of several sets with the same effects, only the most probable one is compared: a poorer fit leaves a residual that the
/// same effects can explain.
///
/// Fewer effects that are no part of the set replace it if they explain nearly all of the residual and predict the
/// held-out runs at least as well, by the score or by the residual that they leave, or if they leave no more than noise
/// and the set's prediction is not certainly better: several effects can imitate a law whose form is a little different.
/// One effect also replaces several at its link that only make up for its form ([`explains_in_one_form`]).
pub fn supported_part(sets: &[Set], mut best: usize, evidence: &Evidence) -> usize {
    let is_judged = evidence.judging() == Role::HeldOut;
    let base = &sets[best_base(sets)];
    let explains_nearly_all = |own: &Set| explained_share(base, own, evidence) >= evidence.numbers.certain();
    loop {
        let set = &sets[best];
        let predicts_better = |part: &Set| predicts_better(set, part, evidence);
        let is_part_enough = |part: &Set| {
            // If the part leaves no more than noise, there is nothing to explain. The runs together may still show a small
            // effect.
            let is_enough = || excess(&part.with_sensors_of(set, evidence), evidence) <= 0.0;
            let explains_little = || {
                explained_share(part, set, evidence) < evidence.numbers.explained()
                    || is_enough() && !predicts_certainly_better(set, part, evidence)
            };
            let changes_little = || match part.names().is_empty() {
                true => is_enough() && is_shown_nowhere(part, set, evidence),
                false => explains_little(),
            };
            let fails = || match held_out_judge(part, evidence) {
                true => changes_little() || !predicts_better(part),
                false => predicts_certainly_worse(set, part, evidence),
            };
            is_judged && fails()
                || set.adds_effect_at_bound(part, evidence)
                || set.adds_undetermined_effect(part) && explains_nearly_all(part)
                || rests_on_passages(set, part, evidence)
        };
        let left = |own: &Set| excess(&own.explanation, evidence);
        // Where no more than noise is left, only a certainly better prediction keeps the larger set.
        let is_as_good = |other: &Set| match left(other) > 0.0 {
            true => !predicts_better(other) || left(other) <= left(set),
            false => !predicts_certainly_better(set, other, evidence),
        };
        let is_simpler =
            |other: &Set| is_judged && !other.names().is_empty() && explains_nearly_all(other) && is_as_good(other);
        let is_enough = |other: &Set| match is_part(other, set) {
            true => is_part_enough(other),
            false => is_simpler(other),
        };
        let replaces =
            |&other: &usize| is_enough(&sets[other]) || explains_in_one_form(&sets[other], set, sets, evidence);
        let is_less = |other: &usize| sets[*other].names().len() < set.names().len();
        let is_at_bound = |other: &Set| other.has_magnitude_at_bound(&|| explains_nearly_all(other));
        let is_answer = |other: &usize| is_less(other) && !is_at_bound(&sets[*other]);
        let mut parts = most_probable_first(sets, (0..sets.len()).filter(is_answer));
        let mut known = HashSet::new();
        parts.retain(|&part| known.insert(sets[part].names()));
        match parts.into_par_iter().find_first(replaces) {
            Some(part) => best = part,
            None => return best,
        }
    }
}

/// True if a set predicts the held-out runs better than another set with the same sensor errors. If these runs do not
/// judge, it is true unless the prediction is certainly worse, or if no run is held out. With sensor errors of its own, a
/// set that lacks an effect could attribute its residual to inaccurate sensors, and its prediction would then seem as
/// good.
pub fn predicts_better(set: &Set, other: &Set, evidence: &Evidence) -> bool {
    let none_held_out = evidence.of_role(Role::HeldOut).next().is_none();
    let is_better = || match evidence.judging() {
        Role::HeldOut => gain_in_score(set, other, evidence) > 0.0,
        Role::Fit => !predicts_certainly_worse(set, other, evidence),
    };
    none_held_out || is_better()
}

/// True if a set predicts the held-out runs no better than a part of it, and explains less of the excess residual of the
/// fitted runs than a further effect must.
fn is_shown_nowhere(part: &Set, set: &Set, evidence: &Evidence) -> bool {
    let of_part = part.with_sensors_of(set, evidence);
    let [before, after] = [&*of_part, &set.explanation].map(|own| above_noise(own.misfit.fit));
    after > evidence.numbers.left * before && gain_in_score(set, part, evidence) <= 0.0
}

/// True if a set predicts the held-out runs better than another set with the same sensor errors, by the odds of a
/// certain answer.
fn predicts_certainly_better(set: &Set, other: &Set, evidence: &Evidence) -> bool {
    gain_in_score(set, other, evidence) > evidence.numbers.odds_of_certain().ln()
}

/// True if a set predicts the held-out runs worse than another set with the same sensor errors, by the odds of a certain
/// answer.
fn predicts_certainly_worse(set: &Set, other: &Set, evidence: &Evidence) -> bool {
    gain_in_score(set, other, evidence) <= -evidence.numbers.odds_of_certain().ln()
}

/// Logarithmic score of a set less that of another set with the same sensor errors.
fn gain_in_score(set: &Set, other: &Set, evidence: &Evidence) -> f64 {
    log_score(&set.explanation, evidence) - log_score(&other.with_sensors_of(set, evidence), evidence)
}

/// True if a set fits the fitted runs alone: it predicts the held-out runs no better than the base model, and `other` is
/// certainly more probable than it once they count as data too.
pub fn is_refuted(set: &Set, other: &Set, base: &Set, evidence: &Evidence) -> bool {
    let with_held_out = |own: &Set| own.log_posterior() + log_score(&own.explanation, evidence);
    !predicts_better(set, base, evidence)
        && with_held_out(other) - with_held_out(set) > evidence.numbers.odds_of_certain().ln()
}

/// True if a set with inaccurate sensors is not certainly more probable than a part of it once the gain of the cleat
/// runs along some axis is left out. Sensors that are less accurate than their data sheets are a sign of another model
/// error. An error of the tyre law is common to all cleat runs, so their agreement is no independent evidence.
fn rests_on_passages(set: &Set, part: &Set, evidence: &Evidence) -> bool {
    let of_passages = |own: &Set| own.explanation.log_likelihoods_of_passages(evidence);
    if !set.has_inaccurate_sensors() {
        return false;
    }
    let (Some(own), Some(others)) = (of_passages(set), of_passages(part)) else {
        return false;
    };
    let gains = own.iter().zip(&others).map(|(own, other)| own - other);
    let largest = gains.fold(0.0, f64::max);
    largest > 0.0 && set.log_posterior() - part.log_posterior() - largest < evidence.numbers.odds_of_certain().ln()
}

/// Logarithmic score; negative infinity if the model has no finite response.
fn log_score(own: &Explanation, evidence: &Evidence) -> f64 {
    let score = own.log_score(evidence);
    score.filter(|own| own.is_finite()).unwrap_or(f64::NEG_INFINITY)
}
