//! How well a model explains the evidence: the best of several refits, coarse first.
//!
//! A wrong model that is pressed to fit a precise measurement hides its fault in all its parameters and ends in a poor
//! local minimum. So each start is first fitted with a tolerance of some percent of every value, in which only the
//! large features count, and the best of these is then fitted sharply.

use std::collections::BTreeMap;

use rayon::prelude::*;

use super::candidate::Added;
use super::evidence::Evidence;
use super::gap::Gap;
use super::nuisance::Nuisance;
use super::predict::{Free, PredictError};
use super::refit::{Refit, refit_with};
use crate::model::Model;
use crate::response::parameters::Values;

/// A parameter of the base model as the campaign gives it.
#[derive(Clone, Debug, PartialEq)]
pub struct Given {
    /// Name.
    pub name: String,
    /// Start value, SI.
    pub value: f64,
    /// Bounds, for one that may move.
    pub range: Option<(f64, f64)>,
}

/// What the engineer gives beside the evidence.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    /// The parameters of the base model.
    pub given: Vec<Given>,
    /// Facts of the vehicle, which a model may or may not use.
    pub vehicle: BTreeMap<String, f64>,
}

/// A model's explanation.
#[derive(Clone, Debug)]
pub struct Explanation {
    /// Its parameters and sensor errors.
    pub refit: Refit,
    /// What it leaves.
    pub gap: Gap,
}

/// Tolerance of the coarse fit, as a share of every value.
const TOLERANCE: f64 = 0.1;
/// Evaluations of a coarse fit.
const COARSE: usize = 25;
/// Evaluations of a sharp fit.
const SHARP: usize = 60;

/// Explains the evidence by a model, with parameters beside those of the base model, from the base model's start values
/// and from `known`, those of an earlier explanation.
///
/// # Errors
/// Where the model lacks what was measured, or a parameter has no value.
pub fn explain(
    model: &dyn Model,
    added: &[Added],
    setting: &Setting,
    known: Option<&BTreeMap<String, f64>>,
    evidence: &Evidence,
    nuisance: &Nuisance,
) -> Result<Explanation, PredictError> {
    let tolerant = evidence.tolerant(TOLERANCE);
    let starts = starts(model, added, setting, known)?;
    let coarse: Result<Vec<(Refit, Vec<Free>)>, PredictError> = starts
        .into_par_iter()
        .map(|values| {
            let free = free(model, added, setting);
            let refit = refit_with(model, &values, &free, &tolerant, nuisance.clone(), COARSE)?;
            Ok((refit, free))
        })
        .collect();
    let (coarse, free) = coarse?
        .into_iter()
        .min_by(|a, b| a.0.chi2.total_cmp(&b.0.chi2))
        .expect("there is at least the campaign's start");
    let refit = refit_with(model, &coarse.values, &free, evidence, nuisance.clone(), SHARP)?;
    let gap = Gap::of(model, &refit, evidence)?;
    Ok(Explanation { refit, gap })
}

/// The starts: the campaign's values and the known ones, each with the added parameters low, at their start, and high.
fn starts(
    model: &dyn Model,
    added: &[Added],
    setting: &Setting,
    known: Option<&BTreeMap<String, f64>>,
) -> Result<Vec<Values>, PredictError> {
    let campaign: BTreeMap<String, f64> = setting.given.iter().map(|p| (p.name.clone(), p.value)).collect();
    let bases = [Some(campaign), known.map(|known| within(known, setting))];
    let shifts: &[f64] = if added.is_empty() { &[0.0] } else { &[0.0, -0.5, 0.5] };
    let mut starts = Vec::new();
    for base in bases.into_iter().flatten() {
        for &shift in shifts {
            let mut given = base.clone();
            given.extend(added.iter().map(|p| (p.name.clone(), towards(p, shift))));
            starts.push(Values::resolve(model.about(), &given, &setting.vehicle).map_err(PredictError::Parameters)?);
        }
    }
    Ok(starts)
}

/// A value on the way from the start (0) to the lower (-1) or the upper end (1) of the range, by ratio where it can be.
fn towards(parameter: &Added, shift: f64) -> f64 {
    let (low, high) = parameter.range;
    let end = if shift < 0.0 { low } else { high };
    if low > 0.0 {
        parameter.start * (end / parameter.start).powf(shift.abs())
    } else {
        parameter.start + (end - parameter.start) * shift.abs()
    }
}

/// Known values, drawn away from the bounds at which an earlier search may have got stuck.
fn within(known: &BTreeMap<String, f64>, setting: &Setting) -> BTreeMap<String, f64> {
    let inside = |p: &Given| {
        let value = known.get(&p.name).copied().unwrap_or(p.value);
        let Some((low, high)) = p.range else { return p.value };
        let margin = 0.05 * (high - low);
        value.clamp(low + margin, high - margin)
    };
    setting.given.iter().map(|p| (p.name.clone(), inside(p))).collect()
}

fn free(model: &dyn Model, added: &[Added], setting: &Setting) -> Vec<Free> {
    let place = |name: &str| model.about().parameters.iter().position(|p| p.name == name);
    let given = setting.given.iter().filter_map(|p| Some((p.name.as_str(), p.range?)));
    let added = added.iter().map(|p| (p.name.as_str(), p.range));
    given
        .chain(added)
        .filter_map(|(name, (lower, upper))| {
            Some(Free {
                parameter: place(name)?,
                lower,
                upper,
            })
        })
        .collect()
}
