//! Fits a model from many starts, without a search for missing effects: the best optimum within the ranges, and the
//! other local minima of the cost.

use std::collections::BTreeMap;

use rayon::prelude::*;

use super::assembly::{Assembly, Hypothesis, Place};
use super::fidelity::Fidelity;
use crate::campaign::Role;
use crate::discover::answer::{Progress, Update};
use crate::discover::candidate::Workshop;
use crate::discover::observe::{Evidence, PredictError};
use crate::discover::posterior::{Explanation, Given, Refit, Setting};
use crate::fit::starts;
use crate::least_squares::Bounds;
use crate::simulate::Accuracy;

/// Rounds and evaluations of the searches: of all starts, of the best half of them, and of the remaining minima. A
/// choice that limits the time.
const SEARCHES: [(usize, usize); 3] = [(1, 8), (1, 30), (2, 30)];
/// Rounds and evaluations of the final fit.
const FINAL: (usize, usize) = (3, 60);
/// Log evidence difference below which two searches may have found the same minimum: odds of less than three to one.
const SAME_EVIDENCE: f64 = 1.0;
/// Standard errors of each parameter within which they then have. A search whose log evidence is lower by less than
/// [`SAME_EVIDENCE`] is at most √2 standard errors from its minimum, so two of them are at most 2.8 apart.
const SAME_PLACE: f64 = 3.0;

/// The best explanation by a model, and its other local minima.
pub struct MultiStart {
    /// The data, with the accuracy of integration of the explanation.
    pub evidence: Evidence,
    /// The explanation at the highest posterior found.
    pub explanation: Explanation,
    /// Other minima, the most probable first.
    pub others: Vec<Minimum>,
}

/// A local minimum that is less probable than the best.
pub struct Minimum {
    /// Log odds against it relative to the best: the difference of the log evidences for all fitted runs, before the
    /// non-steady part of sweeps is subtracted.
    pub log_odds: f64,
    /// Parameter values at the minimum by name, SI.
    pub named: BTreeMap<String, f64>,
}

/// Fits a model to all fitted runs from `count` starts: the given values, and others spread over the ranges.
///
/// # Errors
/// Fails if no run may be fitted, if the model lacks a measured quantity, if a parameter has no value, or if no search
/// gives a finite evidence.
pub fn fit_from_starts(
    workshop: Box<dyn Workshop>,
    setting: &Setting,
    evidence: &Evidence,
    count: usize,
    progress: Progress<'_>,
) -> Result<MultiStart, PredictError> {
    if evidence.of_role(Role::Fit).next().is_none() {
        return Err(PredictError::NothingToFit);
    }
    let assembly = Assembly::base(workshop.into(), setting, evidence)?;
    let (hypothesis, fidelity) = (assembly.hypothesis(), Fidelity::of(evidence));
    progress(Update::Step(&format!("searching from {count} starts")));
    let minima = minima(&hypothesis, spread(assembly.given(), count), &fidelity)?;
    progress(Update::Step("refining the best fit"));
    // Long steps smooth a sharp law, but they suffice to find the minimum.
    let evidence = evidence.integrated_with(Accuracy::HIGH);
    let with_unsteady = hypothesis.explanation(minima[0].clone(), &evidence)?.refit;
    // Subtract the non-steady part of the sweeps from the measurement; the fit compares steady harmonics only.
    let steady = Fidelity::of(&evidence.minus(&with_unsteady.unsteady)).fine;
    let refit = hypothesis.fit_to_convergence(&hypothesis.place(&with_unsteady), &steady, FINAL)?;
    let other = |other: &Refit| Minimum {
        log_odds: minima[0].log_evidence - other.log_evidence,
        named: hypothesis.place(other).named,
    };
    Ok(MultiStart {
        explanation: hypothesis.explanation(refit, &evidence)?,
        others: minima[1..].iter().map(other).collect(),
        evidence,
    })
}

/// Distinct local minima of all fitted runs, most probable first.
fn minima(
    hypothesis: &Hypothesis<'_>,
    from: Vec<BTreeMap<String, f64>>,
    fidelity: &Fidelity,
) -> Result<Vec<Refit>, PredictError> {
    let places = from.into_iter().map(|named| Place {
        named,
        ..Place::given(&fidelity.coarse)
    });
    let mut found = fitted(hypothesis, places.collect(), &fidelity.coarse, SEARCHES[0])?;
    found.truncate(found.len().div_ceil(2));
    let searches = [&fidelity.coarse, &fidelity.medium, &fidelity.fine].into_iter();
    for (evidence, budget) in searches.zip([SEARCHES[1], SEARCHES[2], SEARCHES[2]]) {
        let places = found.iter().map(|refit| hypothesis.place(refit)).collect();
        found = distinct(fitted(hypothesis, places, evidence, budget)?);
    }
    Ok(found)
}

/// Fits from these places, most probable first.
fn fitted(
    hypothesis: &Hypothesis<'_>,
    places: Vec<Place>,
    evidence: &Evidence,
    budget: (usize, usize),
) -> Result<Vec<Refit>, PredictError> {
    let fits = places.par_iter().map(|place| hypothesis.fit(place, evidence, budget));
    let mut failure = PredictError::NoNumber;
    let mut found = Vec::new();
    for fit in fits.collect::<Vec<_>>() {
        match fit {
            Ok(refit) if refit.log_evidence.is_finite() => found.push(refit),
            Ok(_) => (),
            // A start that cannot be predicted does not stop the others.
            Err(error) => failure = error,
        }
    }
    found.sort_by(|a, b| b.log_evidence.total_cmp(&a.log_evidence));
    if found.is_empty() { Err(failure) } else { Ok(found) }
}

/// Keeps one fit for each minimum. The input is sorted by evidence, best first.
fn distinct(sorted: Vec<Refit>) -> Vec<Refit> {
    let mut distinct: Vec<Refit> = Vec::new();
    for refit in sorted {
        if !distinct.iter().any(|known| is_same_minimum(known, &refit)) {
            distinct.push(refit);
        }
    }
    distinct
}

/// True if two fits of a model are equally probable and have the same parameters within their standard errors. A
/// parameter that neither fit determines, or that both have at the same bound, cannot tell them apart.
fn is_same_minimum(one: &Refit, other: &Refit) -> bool {
    let errors = (one.stderr(), other.stderr());
    let is_apart = |k: usize| {
        let is_bounded = one.at_bound[k] != 0 && one.at_bound[k] == other.at_bound[k];
        !is_bounded && (one.estimate[k] - other.estimate[k]).abs() > SAME_PLACE * errors.0[k].max(errors.1[k])
    };
    (one.log_evidence - other.log_evidence).abs() <= SAME_EVIDENCE && !(0..one.estimate.len()).any(is_apart)
}

/// Start points: the given values, and others spread over the ranges.
fn spread(given: &[Given], count: usize) -> Vec<BTreeMap<String, f64>> {
    let free: Vec<(&Given, (f64, f64))> = given.iter().filter_map(|own| Some((own, own.range?))).collect();
    let bounds = Bounds {
        lower: free.iter().map(|(_, range)| range.0).collect(),
        upper: free.iter().map(|(_, range)| range.1).collect(),
    };
    let values: Vec<f64> = free.iter().map(|(own, _)| own.value).collect();
    let named = |x: Vec<f64>| free.iter().map(|(own, _)| own.name.clone()).zip(x).collect();
    starts(&values, &bounds, count, 0).into_iter().map(named).collect()
}
