//! The fitted base model.

use std::collections::BTreeMap;

use rayon::iter::Either;
use rayon::prelude::*;

use super::assembly::{Assembly, Place};
use super::fidelity::Fidelity;
use super::set::Set;
use crate::discover::observe::{Evidence, PredictError};
use crate::discover::posterior::{Given, Refit};

/// Start points of the base model, as in [`setting_spread`]: the given values, and two about a third of the way to the
/// bounds. A choice.
const SPREAD: [f64; 3] = [0.0, 0.35, -0.35];
/// Rounds and evaluations of the base fit on coarse, medium and fine data. A choice.
pub const BASE: [(usize, usize); 3] = [(2, 10), (2, 10), (2, 20)];

/// The fitted base model. Searches from several start points on coarse data and refines the best on finer data.
pub fn fit_base(assembly: Assembly, evidence: &Evidence) -> Result<Set, PredictError> {
    let fidelity = Fidelity::of(evidence);
    let hypothesis = assembly.hypothesis();
    let starts = SPREAD.par_iter().map(|&spread| {
        let from = Place {
            named: setting_spread(&assembly, spread),
            ..Place::given(&fidelity.coarse)
        };
        hypothesis.fit(&from, &fidelity.coarse, BASE[0])
    });
    let (fitted, failures): (Vec<_>, Vec<_>) = starts.partition_map(|start| match start {
        Ok(refit) => Either::Left(refit),
        Err(error) => Either::Right(error),
    });
    let is_number = |refit: &Refit| refit.log_evidence.is_finite();
    let order = |a: &Refit, b: &Refit| a.log_evidence.total_cmp(&b.log_evidence);
    // A base model that cannot be predicted is an error. A candidate that cannot be predicted is dropped.
    let failure = failures.into_iter().next().unwrap_or(PredictError::NoNumber);
    let best = fitted.into_iter().filter(is_number).max_by(order).ok_or(failure)?;
    let medium = hypothesis.fit(&hypothesis.place(&best), &fidelity.medium, BASE[1])?;
    let fine = hypothesis.fit(&hypothesis.place(&medium), &fidelity.fine, BASE[2])?;
    let explanation = hypothesis.explanation(fine, evidence)?;
    if !is_number(&explanation.refit) {
        return Err(PredictError::NoNumber);
    }
    Ok(Set::new(assembly, explanation, 0.0))
}

/// Start values for the base model: moves each given value by the share `|spread|` towards a bound of its range. Even
/// places move in the direction of the sign of `spread`, odd places against it.
fn setting_spread(assembly: &Assembly, spread: f64) -> BTreeMap<String, f64> {
    let moved = |(k, given): (usize, &Given)| {
        let (low, high) = given.range?;
        let shift = if k.is_multiple_of(2) { spread } else { -spread };
        let end = if shift < 0.0 { low } else { high };
        let share = shift.abs();
        let moved = if low > 0.0 && given.value > 0.0 {
            given.value * (end / given.value).powf(share)
        } else {
            given.value + (end - given.value) * share
        };
        Some((given.name.clone(), moved))
    };
    assembly.given().iter().enumerate().filter_map(moved).collect()
}
