//! A set of effects with its fit: its probability, its names and its remaining residual.

use std::borrow::Cow;
use std::cmp::Ordering;
use std::sync::{Arc, Mutex};

use super::assembly::{Assembly, Place, Placed};
use super::fidelity::Fidelity;
use super::finite_explanation;
use super::race::{FINE_BUDGET, continued};
use crate::campaign::Role;
use crate::discover::answer::{Finding, Rival};
use crate::discover::noise::AccuracyClass;
use crate::discover::numbers::{Numbers, ONE_SIDED};
use crate::discover::observe::Evidence;
use crate::discover::posterior::{Explanation, Refit};
use crate::shown::{rounded, shown};

/// Rounds and evaluations of a fit to other evidence from a known optimum. A choice, ample so near an optimum.
const AGAIN: (usize, usize) = (2, 20);

#[derive(Clone)]
pub struct Set {
    /// The model with these effects.
    pub assembly: Assembly,
    pub explanation: Explanation,
    /// Log prior odds of the set.
    pub log_prior: f64,
    /// True once extensions of the set have been tried.
    pub extended: bool,
    /// True once the other forms of its effects have been tried.
    pub forms_tried: bool,
    /// True once its effects have been replaced by their rivals.
    pub exchanged: bool,
    /// True once it has been fitted without each of its effects.
    pub reduced: bool,
    /// True once it has been fitted again from the smallest discrepancy.
    pub refitted: bool,
    /// Candidates that were dropped in the race that led to it.
    pub rivals: Vec<Rival>,
    /// Its explanations with the sensors of other sets: see [`Self::with_sensors_of`].
    with_sensors: Arc<Mutex<Vec<(Sensors, Explanation)>>>,
}

/// Estimated accuracy class and calibration errors of the sensors.
#[derive(Clone, Debug, PartialEq)]
struct Sensors {
    accuracy: AccuracyClass,
    errors: Vec<f64>,
}

impl Sensors {
    fn of(refit: &Refit) -> Self {
        Self {
            accuracy: refit.nuisance.accuracy,
            errors: refit.coefficients[..refit.nuisance.of_calibration()].to_vec(),
        }
    }
}

impl Set {
    /// A set from which no search step has started yet.
    pub fn new(assembly: Assembly, explanation: Explanation, log_prior: f64) -> Self {
        Self {
            assembly,
            explanation,
            log_prior,
            extended: false,
            forms_tried: false,
            exchanged: false,
            reduced: false,
            refitted: false,
            rivals: Vec::new(),
            with_sensors: Arc::default(),
        }
    }

    /// Log evidence of the set for other evidence of the same runs, fitted from the present optimum; `None` if the fit
    /// fails.
    pub fn again(&self, evidence: &Evidence) -> Option<f64> {
        let hypothesis = self.assembly.hypothesis();
        let from = hypothesis.place(&self.explanation.refit);
        let refit = hypothesis.fit(&from, &Fidelity::of(evidence).fine, AGAIN).ok()?;
        Some(refit.log_evidence).filter(|own| own.is_finite())
    }

    /// The set fitted to other evidence of the same runs, from the present optimum; `None` if the fit fails. The searches
    /// that have started from it are not repeated.
    pub fn fitted_to(&self, evidence: &Evidence) -> Option<Self> {
        let hypothesis = self.assembly.hypothesis();
        let from = hypothesis.place(&self.explanation.refit);
        let refit = hypothesis.fit(&from, &self.steady(evidence), AGAIN).ok()?;
        self.with_fit(refit, evidence)
    }

    /// The set fitted again from its optimum with the smallest discrepancy; `None` if the fit fails. A fit alternates
    /// between the parameters and the discrepancy. Where the parameters are wrong, the discrepancy is large, and then
    /// hardly anything is gained by better ones: a local minimum, which this fit leaves.
    pub fn at_small_discrepancy(&self, evidence: &Evidence) -> Option<Self> {
        let hypothesis = self.assembly.hypothesis();
        let steady = self.steady(evidence);
        let from = Place {
            discrepancy: Place::given(&steady).discrepancy,
            ..hypothesis.place(&self.explanation.refit)
        };
        let refit = hypothesis.fit(&from, &steady, FINE_BUDGET).ok()?;
        let refit = continued(&hypothesis, refit, &steady, |_| true)?;
        let refitted = true;
        Some(Self {
            refitted,
            ..self.with_fit(refit, evidence)?
        })
    }

    /// Parameters at an end of the campaign's range beyond which that of the model file reaches.
    pub fn beyond_range(&self) -> Vec<String> {
        let refit = &self.explanation.refit;
        let at_end = refit.free.iter().zip(&refit.at_bound).filter(|(_, side)| **side != 0);
        let beyond = at_end.filter_map(|(free, side)| {
            let name = &self.explanation.named[free.parameter].0;
            let (lower, upper) = self.assembly.range_of_model(name)?;
            let reaches = if *side < 0 {
                lower < free.lower
            } else {
                upper > free.upper
            };
            reaches.then(|| name.clone())
        });
        beyond.collect()
    }

    /// The set with the range of the model file for the parameters at an end of that of the campaign; `None` if its fit
    /// fails, or ends within the ranges of the campaign.
    pub fn with_ranges_of_model(&self, evidence: &Evidence) -> Option<Self> {
        let assembly = self.assembly.with_ranges_of_model(&self.beyond_range());
        let steady = self.steady(evidence);
        let hypothesis = assembly.hypothesis();
        let refit = hypothesis
            .fit(&hypothesis.place(&self.explanation.refit), &steady, FINE_BUDGET)
            .ok()?;
        let refit = continued(&hypothesis, refit, &steady, |_| true)?;
        let explanation = finite_explanation(&hypothesis, refit, evidence)?;
        let value = |name: &str| {
            explanation
                .named
                .iter()
                .find(|(own, _)| own == name)
                .map(|(_, value)| *value)
        };
        let mut widened = assembly.widened().iter();
        let is_outside =
            widened.any(|(name, range)| value(name).is_some_and(|value| value < range.0 || value > range.1));
        is_outside.then(|| Self {
            rivals: self.rivals.clone(),
            ..Self::new(
                assembly.clone(),
                explanation,
                self.log_prior + evidence.numbers.further.ln(),
            )
        })
    }

    /// A notice for each parameter outside the range that the campaign gives it.
    fn notes_on_ranges(&self) -> Vec<String> {
        let about = self.assembly.model().about();
        let note = |(name, range): &(String, (f64, f64))| {
            let (_, value) = self.explanation.named.iter().find(|(own, _)| own == name)?;
            let unit = about.parameters.iter().find(|own| own.name == *name)?.unit.clone();
            let [value, lower, upper] =
                [*value, range.0, range.1].map(|value| shown(rounded(value, 4), &unit).to_string());
            Some(format!(
                "{name} = {value} explains the data better than any value in its range in the campaign, {lower} to \
                 {upper}: check that range"
            ))
        };
        self.assembly.widened().iter().filter_map(note).collect()
    }

    fn with_fit(&self, refit: Refit, evidence: &Evidence) -> Option<Self> {
        let explanation = finite_explanation(&self.assembly.hypothesis(), refit, evidence)?;
        Some(Self {
            explanation,
            with_sensors: Arc::default(),
            ..self.clone()
        })
    }

    /// Explanation by this set with the sensor errors of another set, if this set's own fit estimates less accurate
    /// sensors than the other's. A set that lacks an effect attributes part of its residual to the sensors, and then
    /// the effect would seem to explain too little. It is the set's own explanation if the fit fails.
    pub fn with_sensors_of(&self, other: &Set, evidence: &Evidence) -> Cow<'_, Explanation> {
        if self.accuracy() <= other.accuracy() {
            return Cow::Borrowed(&self.explanation);
        }
        let sensors = Sensors::of(&other.explanation.refit);
        let known = || self.with_sensors.lock().expect("no thread panics with the lock");
        let there = known()
            .iter()
            .find(|(of, _)| *of == sensors)
            .map(|(_, own)| own.clone());
        let own = there.unwrap_or_else(|| {
            let refitted = self.refitted_with_sensors(&other.explanation.refit, evidence);
            let own = refitted.unwrap_or_else(|| self.explanation.clone());
            known().push((sensors, own.clone()));
            own
        });
        Cow::Owned(own)
    }

    fn refitted_with_sensors(&self, other: &Refit, evidence: &Evidence) -> Option<Explanation> {
        let hypothesis = self.assembly.hypothesis();
        let from = hypothesis.place(&self.explanation.refit);
        let refit = hypothesis.fit_with_sensors_of(other, from, &self.steady(evidence), AGAIN);
        finite_explanation(&hypothesis, refit.ok()?, evidence)
    }

    /// The fitted runs without the non-steady part of the sweeps.
    pub fn steady(&self, evidence: &Evidence) -> Evidence {
        let steady = evidence.minus(&self.explanation.refit.unsteady).with_step_limit();
        Fidelity::of(&steady).fine
    }

    /// Notices on its sensors and on its parameters.
    pub fn notes(&self) -> impl Iterator<Item = String> {
        self.note_on_sensors().into_iter().chain(self.notes_on_ranges())
    }

    /// A notice if the sensors are less accurate than their data sheets.
    fn note_on_sensors(&self) -> Option<String> {
        let class = self.accuracy();
        let percent = |class: AccuracyClass| format!("{:.1} %", 100.0 * class.gain());
        self.has_inaccurate_sensors().then(|| {
            format!(
                "the gains of the sensors seem to change by {} over the band, where {} is usual; the answer allows for \
                 that; a model that is still wrong can cause this too",
                percent(class),
                percent(AccuracyClass::default())
            )
        })
    }

    /// True if the sensors are less accurate than their data sheets.
    pub fn has_inaccurate_sensors(&self) -> bool {
        self.accuracy() > AccuracyClass::default()
    }

    /// Accuracy class of the sensors in the fit.
    fn accuracy(&self) -> AccuracyClass {
        self.explanation.refit.nuisance.accuracy
    }

    /// Log posterior probability, up to a constant of the data.
    pub fn log_posterior(&self) -> f64 {
        self.explanation.refit.log_evidence + self.log_prior
    }

    /// Prior odds of one more effect; even odds for the first.
    pub fn odds_of_another(&self, numbers: &Numbers) -> f64 {
        if self.names().is_empty() { 1.0 } else { numbers.further }
    }

    /// Findings for all its effects, not compared with the base model.
    pub fn findings(&self) -> Vec<Finding> {
        let effects = self.assembly.effects().iter();
        let finding = |own: &Placed| Finding {
            effect: own.effect.clone(),
            at: own.at.clone(),
            form: own.form.clone(),
            alternative: None,
            parameters: own.unknowns.parameters(&self.explanation),
            evidence: 0.0,
            explained: None,
            rivals: self.rivals.clone(),
        };
        effects.map(finding).collect()
    }

    /// True if a named effect has a magnitude at its bound. A ratio counts too unless the set `explains` nearly all.
    pub fn has_magnitude_at_bound(&self, explains: &dyn Fn() -> bool) -> bool {
        self.named().any(|own| self.is_magnitude_at_bound(own, explains))
    }

    /// Whether the set explains nearly all is computed only for a ratio at its bound, since it may need a fit.
    fn is_magnitude_at_bound(&self, own: &Placed, explains: &dyn Fn() -> bool) -> bool {
        let unknowns = &own.unknowns;
        unknowns.has_magnitude_at_bound(&self.explanation)
            || unknowns.has_ratio_at_bound(&self.explanation) && !explains()
    }

    /// True if an effect that `part` lacks has a magnitude at its bound: it then imitates another effect.
    ///
    /// With a shape parameter at its bound, an effect can imitate almost any other. This counts in three cases. Either
    /// `part` already has effects, which leave little residual for a further one. Or this set leaves more than noise,
    /// and the effect takes over the role of a parameter that `part` fits inside its range and this set at its bound. Or
    /// the effect explains less of the residual than a further one must.
    pub fn adds_effect_at_bound(&self, part: &Set, evidence: &Evidence) -> bool {
        let replaces_parameter = || leaves_more_than_noise(self, evidence) && self.sends_parameter_to_bound(part);
        let explains_little = || explained_share(part, self, evidence) < evidence.numbers.explained();
        let has_other_causes = !part.names().is_empty() || replaces_parameter() || explains_little();
        let is_at_bound = |own: &Placed| {
            let explains = || explained_share(part, self, evidence) >= evidence.numbers.certain();
            self.is_magnitude_at_bound(own, &explains)
                || has_other_causes && own.unknowns.has_parameter_at_bound(&self.explanation)
        };
        let is_new = |own: &&Placed| !part.names().contains(&own.name());
        self.named().filter(is_new).any(is_at_bound)
    }

    /// True if the fitted runs determine no parameter of an effect that `part` lacks, and `part` has effects: the effect
    /// then stands for a small part of the residual that many others would explain as well.
    pub fn adds_undetermined_effect(&self, part: &Set) -> bool {
        let is_new = |own: &&Placed| !part.names().contains(&own.name());
        let is_undetermined = |own: &Placed| own.unknowns.are_undetermined(&self.explanation);
        !part.names().is_empty() && self.named().filter(is_new).any(is_undetermined)
    }

    /// True if a parameter of the model is at its bound here and inside its range in the fit of `part`.
    fn sends_parameter_to_bound(&self, part: &Set) -> bool {
        let at_bound = |set: &'_ Set, bounded: bool| -> Vec<String> {
            let (named, refit) = (&set.explanation.named, &set.explanation.refit);
            let free = refit.free.iter().zip(&refit.at_bound);
            let chosen = free.filter(|(_, side)| (**side != 0) == bounded);
            chosen.map(|(free, _)| named[free.parameter].0.clone()).collect()
        };
        let inside = at_bound(part, false);
        at_bound(self, true).iter().any(|name| inside.contains(name))
    }

    /// True if a parameter is at its bound and the other set has fewer free parameters. A law with a parameter at its
    /// bound reduces to a simpler one, so this set is no alternative to the simpler set.
    pub fn is_limiting_case_of(&self, other: &Set) -> bool {
        let unknowns = |set: &Set| set.explanation.refit.free.len();
        unknowns(self) > unknowns(other)
            && self
                .named()
                .any(|own| own.unknowns.has_parameter_at_bound(&self.explanation))
    }

    /// True if another set has the same effects in the same forms, added in the same order.
    pub fn has_same_effects(&self, other: &Set) -> bool {
        let effects = |set: &'_ Set| -> Vec<_> {
            let all = set.assembly.effects().iter();
            all.map(|own| (own.effect.clone(), own.at.clone(), own.form.clone()))
                .collect()
        };
        effects(self) == effects(other)
    }

    /// The named effects: those that are not nuisance effects.
    pub fn named(&self) -> impl Iterator<Item = &Placed> + Clone {
        self.assembly.effects().iter().filter(|own| !own.nuisance)
    }

    /// Sorted pairs of name and place of these effects.
    pub fn names(&self) -> Vec<(&str, &str)> {
        let mut names: Vec<_> = self.named().map(Placed::name).collect();
        names.sort_unstable();
        names
    }
}

/// Adds a set, unless it is there already with a better fit: several searches may find the same model, whose
/// probability counts once.
pub fn keep_best(own: Set, sets: &mut Vec<Set>) {
    match sets.iter_mut().find(|known| known.has_same_effects(&own)) {
        Some(known) if known.log_posterior() >= own.log_posterior() => (),
        Some(known) => *known = own,
        None => sets.push(own),
    }
}

/// The order of sets by their log posterior probability.
pub fn by_log_posterior(a: &Set, b: &Set) -> Ordering {
    a.log_posterior().total_cmp(&b.log_posterior())
}

/// The most probable of the sets at these positions; `None` if there are none.
pub fn most_probable(sets: &[Set], places: impl IntoIterator<Item = usize>) -> Option<usize> {
    places.into_iter().max_by(|&a, &b| by_log_posterior(&sets[a], &sets[b]))
}

/// These positions, that of the most probable set first.
pub fn most_probable_first(sets: &[Set], places: impl IntoIterator<Item = usize>) -> Vec<usize> {
    let mut places: Vec<usize> = places.into_iter().collect();
    places.sort_by(|&a, &b| by_log_posterior(&sets[b], &sets[a]));
    places
}

/// The most probable set without named effects: the base model with the nuisance effects that the data show.
pub fn best_base(sets: &[Set]) -> usize {
    let unnamed = (0..sets.len()).filter(|&place| sets[place].names().is_empty());
    most_probable(sets, unnamed).unwrap_or(0)
}

/// True if `whole` contains every named effect of `part`.
pub fn is_part(part: &Set, whole: &Set) -> bool {
    part.names().iter().all(|name| whole.names().contains(name))
}

/// True if an effect is missing: the discrepancy of some sensor exceeds the expected one, and the excess residual is
/// positive. A noisy sensor alone is no sign of an effect.
pub fn is_missing(set: &Set, evidence: &Evidence) -> bool {
    has_large_discrepancy(set, evidence) && excess(&set.explanation, evidence) > 0.0
}

/// True if the model misses more of the signal of some fitted sensor than any model is expected to.
fn has_large_discrepancy(set: &Set, evidence: &Evidence) -> bool {
    let discrepancy = set.explanation.refit.discrepancy.iter();
    let mut missed = discrepancy.flat_map(|own| own.by_group());
    missed.any(|missed| missed.tau > evidence.numbers.expected_discrepancy)
}

/// True if the fitted residuals are significantly larger than noise.
pub fn leaves_more_than_noise(set: &Set, evidence: &Evidence) -> bool {
    is_more_than_noise(set.explanation.misfit.fit, Role::Fit, evidence)
}

/// True if the held-out residuals are significantly larger than noise; false if no run is held out.
pub fn predicts_worse_than_noise(set: &Set, evidence: &Evidence) -> bool {
    let is_any = evidence.of_role(Role::HeldOut).next().is_some();
    is_any && is_more_than_noise(set.explanation.misfit.held_out, Role::HeldOut, evidence)
}

/// True if the set misses more of some sensor than any model is expected to, in the runs of a role, and noise does not
/// explain it.
pub fn misses_a_sensor(set: &Set, evidence: &Evidence, role: Role) -> bool {
    let shares = set.explanation.misfit.sensor_shares(evidence, role);
    shares.iter().any(|share| share.is_large(&evidence.numbers))
}

/// True if the RMS of the normalised residuals of one role is significantly larger than 1. For a right model the mean
/// square of `n` values has a standard deviation of `sqrt(2/n)`.
fn is_more_than_noise(rms: f64, role: Role, evidence: &Evidence) -> bool {
    let values: usize = evidence.of_role(role).map(|(_, series)| series.residuals()).sum();
    let scatter = (2.0 / values.max(1) as f64).sqrt();
    rms.is_nan() || rms.powi(2) > 1.0 + ONE_SIDED * scatter
}

/// Share of the [`excess`] residual of `before` that `after` explains with the same sensor errors. It is negative, and
/// at least -1, if `after` leaves more. For a decision it is 1 if neither leaves any, since nothing then speaks against
/// `after`; an answer states [`stated_share`].
pub fn explained_share(before: &Set, after: &Set, evidence: &Evidence) -> f64 {
    let before = before.with_sensors_of(after, evidence);
    let left = excess(&after.explanation, evidence) / excess(&before, evidence).max(f64::MIN_POSITIVE);
    (1.0 - left).max(-1.0)
}

/// The same share as an answer states it; `None` if `before` leaves no excess, so that there is nothing to explain.
pub fn stated_share(before: &Set, after: &Set, evidence: &Evidence) -> Option<f64> {
    let is_something = excess(&before.with_sensors_of(after, evidence), evidence) > 0.0;
    is_something.then(|| explained_share(before, after, evidence))
}

/// True if the held-out runs show what the model misses. They do not if only the discrepancy of fitted sensors is large
/// and their excess residual is a negligible part of that of the fitted runs: a stop that K&C curves reach and held-out
/// cleat runs do not.
pub fn held_out_judge(set: &Set, evidence: &Evidence) -> bool {
    let misfit = &set.explanation.misfit;
    let is_negligible = above_noise(misfit.held_out) < evidence.numbers.error_probability * above_noise(misfit.fit);
    !is_negligible || !has_large_discrepancy(set, evidence) || misses_a_sensor(set, evidence, Role::HeldOut)
}

/// Excess residual of the runs that judge a model: see [`above_noise`].
pub fn excess(own: &Explanation, evidence: &Evidence) -> f64 {
    above_noise(own.misfit.judged(evidence))
}

/// Mean square of a normalised residual, from its RMS, above that of noise, which is 1; at least 0. It is infinite for
/// NaN: a model that cannot predict the runs explains nothing.
pub fn above_noise(rms: f64) -> f64 {
    if rms.is_nan() {
        f64::INFINITY
    } else {
        (rms.powi(2) - 1.0).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::above_noise;

    #[test]
    fn a_model_that_cannot_predict_the_runs_explains_nothing() {
        assert_eq!([2.0, 0.5, f64::NAN].map(above_noise), [3.0, 0.0, f64::INFINITY]);
    }
}
