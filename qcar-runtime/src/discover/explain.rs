//! How well a model explains the evidence, and from where a search for its parameters may begin.

use std::collections::BTreeMap;

use super::candidate::Added;
use super::evidence::Evidence;
use super::gap::Gap;
use super::nuisance::{Form, Nuisance, SENSOR};
use super::predict::{Free, PredictError};
use super::refit::{Refit, refit_from, refit_with, settle};
use crate::campaign::Role;
use crate::model::{About, Model};
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

impl Setting {
    /// # Errors
    /// A value for a parameter that the model does not have, and a parameter without a value.
    pub fn check(&self, about: &About) -> Result<(), PredictError> {
        let given = self.given.iter().map(|p| (p.name.clone(), p.value)).collect();
        let values = Values::resolve(about, &given, &self.vehicle);
        values.map(|_| ()).map_err(PredictError::Parameters)
    }
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

impl Explanation {
    /// What the fitted residuals scatter by, squared; 1 where only noise is left.
    pub fn scatter(&self) -> f64 {
        self.refit.scatter()
    }

    /// How much the gains and delays of the sensors are strained: the sum of the squares of their errors over what these
    /// may be, before any measurement. Errors of other forms take up what a mean of two sides differs by from one.
    pub fn strain(&self) -> f64 {
        let nuisance = &self.refit.nuisance;
        let errors = self.refit.coefficients.iter().take(nuisance.of_calibration());
        let shapes = SENSOR.iter().cycle();
        let of_device = errors
            .zip(shapes)
            .filter(|(_, s)| matches!(s.form, Form::Gain(0) | Form::Delay));
        of_device.map(|(error, shape)| (error / shape.sigma).powi(2)).sum()
    }

    /// By what share of them the model misses most of the fitted values that stand clear of the noise: the median.
    pub fn misfit(&self, evidence: &Evidence) -> f64 {
        const CLEAR: f64 = 10.0;
        let mut shares = Vec::new();
        for (place, series) in evidence.of_role(Role::Fit) {
            let (parts, scale) = if series.kind.complex() { (2, 0.5) } else { (1, 1.0) };
            let residuals = self.gap.residuals[place].chunks(parts);
            for ((value, sigma), residual) in series.value.iter().zip(&series.sigma).zip(residuals) {
                let power: f64 = residual.iter().map(|r| r * r).sum();
                if value.norm() > CLEAR * sigma {
                    shares.push((power * scale).sqrt() * sigma / value.norm());
                }
            }
        }
        let middle = shares.len() / 2;
        if shares.is_empty() {
            return 0.0;
        }
        *shares.select_nth_unstable_by(middle, f64::total_cmp).1
    }
}

/// In place of a shift: next to zero.
const WEAK: f64 = f64::NAN;
/// The share of its start at which a parameter is next to zero.
const NEXT_TO_ZERO: f64 = 0.01;
/// How far towards the ends of their ranges searches begin beside the starts.
const HALF_WAY: f64 = 0.5;

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
    /// Fits from `values`, and, where a sensor is suspected, from the errors of an earlier fit, with at most so many evaluations.
    ///
    /// # Errors
    /// Where the model lacks what was measured.
    pub fn refit(
        &self,
        values: &Values,
        earlier: Option<&Refit>,
        evidence: &Evidence,
        evaluations: usize,
    ) -> Result<Refit, PredictError> {
        let mut nuisance = self.nuisance.clone();
        // Any other search does better where it may blame the sensors last.
        let earlier = earlier.filter(|_| !nuisance.suspects.is_empty());
        nuisance.start = earlier.map_or_else(Vec::new, |earlier| earlier.coefficients.clone());
        refit_with(self.model, values, &self.free(), evidence, nuisance, evaluations)
    }

    /// Fits from where another explanation ended, as far as it is of the same parameters and sensors, and beside that from
    /// the known values.
    ///
    /// # Errors
    /// Where the model lacks what was measured, or a parameter has no value.
    pub fn refit_from(
        &self,
        other: &Explanation,
        evidence: &Evidence,
        evaluations: usize,
    ) -> Result<Refit, PredictError> {
        let place = |name: &str| other.named.iter().position(|(known, _)| known == name);
        // An effect may have replaced a law, and its parameters with it; what is tied stays tied.
        let value = |p: &Given| {
            let found = place(&p.name).map(|place| other.named[place].1);
            let known = || self.known?.get(&p.name).copied();
            (p.name.clone(), found.or_else(known).unwrap_or(p.value))
        };
        let values = self.start(self.setting.given.iter().map(value).collect(), &[])?;
        let free = self.free();
        let factor = |free: &Free| {
            let name = &self.model.about().parameters[free.parameter].name;
            place(name).map_or(0.0, |place| other.refit.factor(place))
        };
        let mut errors = other.refit.coefficients.clone();
        errors.resize(self.nuisance.of_sensors(), 0.0);
        errors.extend(free.iter().map(factor));
        refit_from(
            self.model,
            (&values, &errors),
            &free,
            evidence,
            self.nuisance.clone(),
            evaluations,
        )
    }

    /// What a refit says of all runs.
    ///
    /// # Errors
    /// Where the model lacks what was measured.
    pub fn explanation(&self, refit: Refit, evidence: &Evidence) -> Result<Explanation, PredictError> {
        let refit = settle(self.model, refit, evidence)?;
        let gap = Gap::of(self.model, &refit, evidence)?;
        let names = self.model.about().parameters.iter().map(|p| p.name.to_string());
        let named = names.zip(refit.values.as_slice().iter().copied()).collect();
        Ok(Explanation { named, refit, gap })
    }

    /// The starts: the known values with the added parameters in several places of their ranges, and the campaign's
    /// values with the added ones at their starts.
    ///
    /// # Errors
    /// Where a parameter has no value.
    pub fn starts(&self) -> Result<Vec<Values>, PredictError> {
        let given = self.setting.given.iter();
        let campaign: BTreeMap<String, f64> = given.map(|p| (p.name.clone(), p.value)).collect();
        let plain = vec![0.0; self.unknown().count()];
        let mut starts = vec![self.start(campaign, &plain)?];
        if let Some(known) = self.known {
            let known = within(known, self.setting);
            for shifts in self.shifts() {
                starts.push(self.start(known.clone(), &shifts)?);
            }
        }
        Ok(starts)
    }

    fn start(&self, mut given: BTreeMap<String, f64>, shifts: &[f64]) -> Result<Values, PredictError> {
        // An effect may replace a law, and its parameters with it.
        given.retain(|name, _| self.model.about().parameters.iter().any(|p| p.name == *name));
        let added = self.unknown().zip(shifts);
        given.extend(added.map(|(p, &shift)| (p.name.clone(), towards(p, shift))));
        Values::resolve(self.model.about(), &given, &self.setting.vehicle).map_err(PredictError::Parameters)
    }

    /// The added parameters that are to be found.
    fn unknown(&self) -> impl Iterator<Item = &Added> {
        self.added.iter().filter(|added| !added.known)
    }

    /// Where in their ranges the added parameters that are to be found begin: all at their starts, all low, all high, and,
    /// where a model costs little, each alone low or high too, since a mode that is sought far from where it is is not
    /// found.
    fn shifts(&self) -> Vec<Vec<f64>> {
        let count = self.unknown().count();
        let all = |shift: f64| vec![shift; count];
        let mut shifts = vec![all(0.0)];
        if count > 0 {
            shifts.extend([all(-HALF_WAY), all(HALF_WAY)]);
        }
        // Where an effect may vanish, from next to there the way to either side is open.
        if self.unknown().any(|p| p.range.0 <= 0.0) {
            let weak = |p: &Added| if p.range.0 <= 0.0 { WEAK } else { 0.0 };
            shifts.push(self.unknown().map(weak).collect());
        }
        if count > 1 && self.model.about().linear {
            let alone = |k: usize, shift: f64| (0..count).map(|i| if i == k { shift } else { 0.0 }).collect();
            shifts.extend((0..count).flat_map(|k| [alone(k, -HALF_WAY), alone(k, HALF_WAY)]));
        }
        shifts
    }

    fn free(&self) -> Vec<Free> {
        let place = |name: &str| self.model.about().parameters.iter().position(|p| p.name == name);
        let given = self
            .setting
            .given
            .iter()
            .filter_map(|p| Some((p.name.as_str(), p.range?)));
        let added = self.unknown().map(|p| (p.name.as_str(), p.range));
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
    if shift.is_nan() {
        return NEXT_TO_ZERO * parameter.start;
    }
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
