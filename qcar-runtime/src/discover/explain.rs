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
    /// The parameters of its model by name.
    pub named: Vec<(String, f64)>,
    /// Its parameters and sensor errors.
    pub refit: Refit,
    /// What it leaves.
    pub gap: Gap,
}

/// Tolerance of the coarse fit, as a share of every value.
const TOLERANCE: f64 = 0.1;
/// A coarse fit looks at every so many-th value.
const THINNED: usize = 3;
/// Evaluations of a coarse fit.
const COARSE: usize = 15;
/// Evaluations of a sharp fit.
const SHARP: usize = 40;
/// Coarse fits that are sharpened: the best of them may end in a poor minimum.
const SHARPENED: usize = 3;

/// A model with what it brings along, put before the evidence.
pub struct Explanandum<'a> {
    /// The model.
    pub model: &'a dyn Model,
    /// Its parameters beside those of the base model.
    pub added: &'a [Added],
    /// What is given.
    pub setting: &'a Setting,
    /// Values of an earlier explanation, from which to start too.
    pub known: Option<&'a BTreeMap<String, f64>>,
    /// What sensors may be wrong by.
    pub nuisance: Nuisance,
}

impl Explanandum<'_> {
    /// The coarse fits of all starts, with tolerance, the best first.
    ///
    /// # Errors
    /// Where the model lacks what was measured, or a parameter has no value.
    pub fn coarse(&self, evidence: &Evidence) -> Result<Vec<Refit>, PredictError> {
        let tolerant = evidence.thinned(THINNED).tolerant(TOLERANCE);
        let free = self.free();
        let fits = self
            .starts()?
            .into_par_iter()
            .map(|values| refit_with(self.model, &values, &free, &tolerant, self.nuisance.clone(), COARSE));
        let mut fits = fits.collect::<Result<Vec<_>, _>>()?;
        fits.retain(|fit| fit.chi2.is_finite());
        fits.sort_by(|a, b| a.chi2.total_cmp(&b.chi2));
        Ok(fits)
    }

    /// The best sharp fit that starts from the best coarse ones; `None` where there are none.
    ///
    /// # Errors
    /// As [`Explanandum::coarse`].
    pub fn sharp(&self, coarse: &[Refit], evidence: &Evidence) -> Result<Option<Explanation>, PredictError> {
        let fits = coarse.par_iter().take(SHARPENED).map(|coarse| {
            let nuisance = self.nuisance.clone();
            refit_with(self.model, &coarse.values, &coarse.free, evidence, nuisance, SHARP)
        });
        let fits = fits.collect::<Result<Vec<_>, _>>()?;
        let best = fits.into_iter().min_by(|a, b| a.chi2.total_cmp(&b.chi2));
        best.map(|refit| self.explanation(refit, evidence)).transpose()
    }

    fn explanation(&self, refit: Refit, evidence: &Evidence) -> Result<Explanation, PredictError> {
        let gap = Gap::of(self.model, &refit, evidence)?;
        let names = self.model.about().parameters.iter().map(|p| p.name.to_string());
        let named = names.zip(refit.values.as_slice().iter().copied()).collect();
        Ok(Explanation { named, refit, gap })
    }

    /// The starts: the campaign's values and the known ones, each with the added parameters at their start, low and high.
    fn starts(&self) -> Result<Vec<Values>, PredictError> {
        let given = self.setting.given.iter();
        let campaign: BTreeMap<String, f64> = given.map(|p| (p.name.clone(), p.value)).collect();
        let bases = [Some(campaign), self.known.map(|known| within(known, self.setting))];
        let shifts: &[f64] = if self.added.is_empty() {
            &[0.0]
        } else {
            &[0.0, -0.5, 0.5]
        };
        let mut starts = Vec::new();
        for base in bases.into_iter().flatten() {
            for &shift in shifts {
                let mut given = base.clone();
                given.extend(self.added.iter().map(|p| (p.name.clone(), towards(p, shift))));
                let values = Values::resolve(self.model.about(), &given, &self.setting.vehicle);
                starts.push(values.map_err(PredictError::Parameters)?);
            }
        }
        Ok(starts)
    }

    fn free(&self) -> Vec<Free> {
        let place = |name: &str| self.model.about().parameters.iter().position(|p| p.name == name);
        let given = self
            .setting
            .given
            .iter()
            .filter_map(|p| Some((p.name.as_str(), p.range?)));
        let added = self.added.iter().map(|p| (p.name.as_str(), p.range));
        let free = |(name, (lower, upper))| {
            place(name).map(|parameter| Free {
                parameter,
                lower,
                upper,
            })
        };
        given.chain(added).filter_map(free).collect()
    }
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

/// Known values; the campaign's for one near a bound, at which an earlier search got stuck.
fn within(known: &BTreeMap<String, f64>, setting: &Setting) -> BTreeMap<String, f64> {
    let inside = |p: &Given| {
        let (low, high) = p.range?;
        let margin = 0.01 * (high - low);
        let value = *known.get(&p.name)?;
        (low + margin..=high - margin).contains(&value).then_some(value)
    };
    let given = setting.given.iter();
    given.map(|p| (p.name.clone(), inside(p).unwrap_or(p.value))).collect()
}
