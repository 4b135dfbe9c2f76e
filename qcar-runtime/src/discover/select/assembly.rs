//! A model with effects, and its extension by one more effect.

use std::collections::BTreeMap;
use std::sync::Arc;

use nalgebra::DVector;

use super::unknowns::Unknowns;
use crate::campaign::Role;
use crate::discover::candidate::{Added, Candidate, Change, Workshop};
use crate::discover::noise::{AccuracyClass, Discrepancy, Form, InitialState, Known, Nuisance};
use crate::discover::observe::{Evidence, Free, PredictError};
use crate::discover::posterior::{DECREMENT, Explanation, Given, Misfit, Refit, Setting, Start, add_unsteady, fit};
use crate::model::Model;
use crate::response::parameters::Values;

/// A model with effects, and the setting and nuisance parameters of its fit.
#[derive(Clone)]
pub struct Assembly {
    workshop: Arc<dyn Workshop>,
    setting: Setting,
    nuisance: Nuisance,
    effects: Vec<Placed>,
    /// Names of the links and masses that its nuisance effects added.
    of_nuisance: Vec<String>,
    /// Parameters with the range of the model file instead of that of the campaign, with the latter.
    widened: Vec<(String, (f64, f64))>,
}

/// An effect at its place, in one of its forms.
#[derive(Clone)]
pub struct Placed {
    /// Name of the effect.
    pub effect: String,
    /// Link, mass or sensor location.
    pub at: String,
    /// Its form; `None` if it has only one.
    pub form: Option<String>,
    /// True for a nuisance effect: every real car has some of it, so it is no answer.
    pub nuisance: bool,
    /// Its unknowns.
    pub unknowns: Unknowns,
}

impl Placed {
    /// Its name and place.
    pub fn name(&self) -> (&str, &str) {
        (&self.effect, &self.at)
    }
}

/// A model that can be fitted: an assembly, or an assembly with a candidate.
pub struct Hypothesis<'a> {
    model: &'a dyn Model,
    given: Vec<Given>,
    vehicle: &'a BTreeMap<String, f64>,
    nuisance: Nuisance,
}

/// Start point of a fit: parameters, nuisance parameters and discrepancy.
#[derive(Clone, Debug, Default)]
pub struct Place {
    /// Parameter values by name, SI. Others keep their given values.
    pub named: BTreeMap<String, f64>,
    /// Log factors of the recorded side, by parameter.
    pub sides: BTreeMap<String, f64>,
    /// Accuracy class of the calibration curves.
    pub accuracy: AccuracyClass,
    /// Coefficients of the sensor errors.
    pub errors: Vec<f64>,
    /// Initial states of the records.
    pub initial_states: Vec<(InitialState, f64)>,
    /// Discrepancy at which the fit starts.
    pub discrepancy: Discrepancy,
}

impl Place {
    /// The given values, without sensor errors and with the smallest discrepancy.
    pub fn given(evidence: &Evidence) -> Self {
        Self {
            named: BTreeMap::new(),
            sides: BTreeMap::new(),
            accuracy: AccuracyClass::default(),
            errors: Vec::new(),
            initial_states: Vec::new(),
            discrepancy: Discrepancy::of(evidence, Role::Fit),
        }
    }

    /// The place of `refit` with its unknowns changed by these amounts, in the order of the columns of its Jacobian.
    /// Parameters stay within their ranges.
    pub fn changed_by(&self, change: &DVector<f64>, refit: &Refit, model: &dyn Model) -> Self {
        let mut there = self.clone();
        let (parameters, others) = change.as_slice().split_at(refit.free.len());
        let (sensors, others) = others.split_at(refit.nuisance.of_sensors());
        let (states, sides) = others.split_at(refit.nuisance.count() - sensors.len());
        let name = |free: &Free| model.about().parameters[free.parameter].name.to_string();
        for (free, change) in refit.free.iter().zip(parameters) {
            let value = refit.values.as_slice()[free.parameter] + change;
            there.named.insert(name(free), value.clamp(free.lower, free.upper));
        }
        there
            .errors
            .iter_mut()
            .zip(sensors)
            .for_each(|(own, change)| *own += change);
        there
            .initial_states
            .iter_mut()
            .zip(states)
            .for_each(|((_, own), change)| *own += change);
        for (free, change) in refit.free.iter().zip(sides) {
            *there.sides.entry(name(free)).or_default() += change;
        }
        there
    }
}

impl Assembly {
    /// The base model.
    ///
    /// # Errors
    /// Fails if a parameter has no value, or a value has no parameter.
    pub fn base(workshop: Arc<dyn Workshop>, setting: &Setting, evidence: &Evidence) -> Result<Self, PredictError> {
        setting.check(workshop.model().about())?;
        Ok(Self {
            workshop,
            setting: setting.clone(),
            nuisance: Nuisance::of(evidence),
            effects: Vec::new(),
            of_nuisance: Vec::new(),
            widened: Vec::new(),
        })
    }

    /// Its effects, in the order in which they were added.
    pub fn effects(&self) -> &[Placed] {
        &self.effects
    }

    /// Parameters of the model, with those of its effects.
    pub fn given(&self) -> &[Given] {
        &self.setting.given
    }

    /// Parameters with the range of the model file instead of that of the campaign, with the latter, SI.
    pub fn widened(&self) -> &[(String, (f64, f64))] {
        &self.widened
    }

    /// The range of the model file for a parameter that the campaign fits within a narrower one; `None` for any other.
    pub fn range_of_model(&self, parameter: &str) -> Option<(f64, f64)> {
        let own = self.setting.given.iter().find(|own| own.name == parameter)?.range?;
        let of_model = self.model().about().parameters.iter();
        let of_model = of_model.filter(|own| own.name == parameter).find_map(|own| own.range)?;
        (of_model.0 < own.0 || of_model.1 > own.1).then_some((of_model.0.min(own.0), of_model.1.max(own.1)))
    }

    /// The assembly with the range of the model file for these parameters.
    pub fn with_ranges_of_model(&self, parameters: &[String]) -> Self {
        let mut wider = self.clone();
        for given in &mut wider.setting.given {
            let is_wanted = parameters.contains(&given.name);
            let of_model = self.range_of_model(&given.name).filter(|_| is_wanted);
            if let (Some(of_model), Some(own)) = (of_model, given.range) {
                wider.widened.push((given.name.clone(), own));
                given.range = Some(of_model);
            }
        }
        wider
    }

    /// The model with all effects.
    pub fn model(&self) -> &dyn Model {
        self.workshop.model()
    }

    /// Every effect at every place, without those already in the assembly.
    pub fn candidates(&self) -> Vec<Candidate> {
        self.without_present(self.workshop.candidates())
    }

    /// Every law without a named cause at every place, without those already in the assembly.
    pub fn laws(&self) -> Vec<Candidate> {
        self.without_present(self.workshop.laws())
    }

    /// Removes candidates whose effect and place are already in the assembly, and those at a part that only a nuisance
    /// effect added: they would be other forms of that effect, and no car has a part of that name.
    fn without_present(&self, candidates: Vec<Candidate>) -> Vec<Candidate> {
        let is_new = |candidate: &Candidate| {
            let is_there = |own: &Placed| own.effect == candidate.effect && own.at == candidate.at;
            !self.effects.iter().any(is_there) && !self.of_nuisance.contains(&candidate.at)
        };
        candidates.into_iter().filter(is_new).collect()
    }

    /// The model of the assembly, ready to be fitted.
    pub fn hypothesis(&self) -> Hypothesis<'_> {
        Hypothesis {
            model: self.workshop.model(),
            given: self.setting.given.clone(),
            vehicle: &self.setting.vehicle,
            nuisance: self.nuisance.clone(),
        }
    }

    /// The assembly with a candidate; `None` if the evidence lacks the sensor of the candidate.
    pub fn hypothesis_with<'a>(&'a self, candidate: &'a Candidate) -> Option<Hypothesis<'a>> {
        let mut hypothesis = self.hypothesis();
        match &candidate.change {
            Change::Model { model, parameters } => {
                hypothesis.model = &**model;
                hypothesis.given.extend(free_parameters(parameters));
            }
            Change::Sensor { .. } => hypothesis.nuisance = with_suspected_sensor(&self.nuisance, candidate)?,
        }
        Some(hypothesis)
    }

    /// The assembly with a candidate added; `None` if the candidate does not apply.
    pub fn with(&self, candidate: &Candidate) -> Option<Self> {
        let mut assembly = self.clone();
        match &candidate.change {
            Change::Model { parameters, .. } => {
                let form = candidate.form.as_deref();
                assembly.workshop = Arc::from(self.workshop.with(&candidate.effect, &candidate.at, form)?);
                if candidate.nuisance {
                    let known: Vec<&str> = parts(self.model()).collect();
                    let new = parts(assembly.workshop.model()).filter(|name| !known.contains(name));
                    assembly.of_nuisance.extend(new.map(str::to_owned));
                }
                assembly.setting.given.extend(free_parameters(parameters));
            }
            Change::Sensor { .. } => assembly.nuisance = with_suspected_sensor(&self.nuisance, candidate)?,
        }
        assembly.effects.push(Placed {
            effect: candidate.effect.clone(),
            at: candidate.at.clone(),
            form: candidate.form.clone(),
            nuisance: candidate.nuisance,
            unknowns: Unknowns::new(candidate, &assembly.nuisance),
        });
        Some(assembly)
    }

    /// All forms of an effect at its place.
    pub fn forms(&self, own: &Placed) -> Vec<Option<String>> {
        let candidates = self.workshop.candidates_of(&own.effect).into_iter();
        candidates
            .filter(|other| other.at == own.at)
            .map(|other| other.form)
            .collect()
    }

    /// The assembly with these effects added; `None` if one of them does not apply.
    pub fn with_all(&self, effects: &[&Placed]) -> Option<Self> {
        let mut assembly = self.clone();
        for own in effects {
            let is_it = |c: &&Candidate| c.effect == own.effect && c.at == own.at && c.form == own.form;
            let candidates = assembly.workshop.candidates_of(&own.effect);
            assembly = assembly.with(candidates.iter().find(is_it)?)?;
        }
        Some(assembly)
    }
}

/// Names of the links and masses of a model.
fn parts(model: &dyn Model) -> impl Iterator<Item = &str> {
    let about = model.about();
    let links = about.links.iter().map(|link| &*link.name);
    links.chain(about.masses.iter().map(|mass| &*mass.location))
}

/// Free parameters of an effect.
fn free_parameters(parameters: &[Added]) -> impl Iterator<Item = Given> {
    let unknown = parameters.iter().filter(|parameter| !parameter.known);
    unknown.map(|parameter| Given {
        name: parameter.name.clone(),
        value: parameter.start,
        range: Some(parameter.range),
    })
}

/// Sensor errors with that of a candidate added; `None` if it is no sensor candidate or the evidence lacks the sensor.
fn with_suspected_sensor(nuisance: &Nuisance, candidate: &Candidate) -> Option<Nuisance> {
    let Change::Sensor {
        location,
        axis,
        form,
        parameter,
    } = &candidate.change
    else {
        return None;
    };
    let (low, high) = parameter.range;
    // The coefficient of a gain is its logarithm; the coefficient of a delay is in seconds.
    let width = if *form == Form::Delay {
        high - low
    } else {
        (high / low).ln()
    };
    nuisance
        .clone()
        .with_suspect(location, axis.as_ref(), *form, width / 12.0_f64.sqrt())
}

impl<'a> Hypothesis<'a> {
    /// The model that is fitted.
    pub fn model(&self) -> &'a dyn Model {
        self.model
    }

    /// Data residuals at a place, in units of the noise, with the calibration and the non-steady part of `refit`;
    /// `None` if one is not finite.
    pub fn residuals_at(&self, place: &Place, refit: &Refit, evidence: &Evidence) -> Option<DVector<f64>> {
        let values = self.values(&place.named).ok()?;
        let mut side = values.clone();
        for (name, factor) in &place.sides {
            if let Some(parameter) = self.model.about().parameters.iter().position(|p| p.name == *name) {
                side.set(parameter, values.as_slice()[parameter] * factor.exp());
            }
        }
        let mut nuisance = refit.nuisance.clone();
        nuisance.suspects.clone_from(&self.nuisance.suspects);
        let initial_states = place.initial_states.iter().map(|(_, value)| *value);
        let coefficients: Vec<f64> = place.errors.iter().copied().chain(initial_states).collect();
        refit.residuals_of(self.model, (&values, side), (nuisance, &coefficients), evidence)
    }

    /// Number of coefficients of its sensor errors.
    pub fn sensor_errors(&self) -> usize {
        self.nuisance.count()
    }

    /// All parameter values: the `known` ones, clamped to their ranges, and the given ones.
    ///
    /// # Errors
    /// Fails if a parameter has no value.
    pub fn values(&self, known: &BTreeMap<String, f64>) -> Result<Values, PredictError> {
        let about = self.model.about();
        // An effect may replace a law together with its parameters.
        let of_model = self
            .given
            .iter()
            .filter(|given| about.parameters.iter().any(|p| p.name == given.name));
        let inside = |given: &Given, value: f64| given.range.map_or(value, |(low, high)| value.clamp(low, high));
        let value = |given: &Given| {
            let value = known
                .get(&given.name)
                .map_or(given.value, |&value| inside(given, value));
            (given.name.clone(), value)
        };
        let values = Values::resolve(about, &of_model.map(value).collect(), &self.vehicle.clone());
        values.map_err(PredictError::Parameters)
    }

    fn free(&self) -> Vec<Free> {
        let about = self.model.about();
        let free = |given: &Given| {
            let (lower, upper) = given.range?;
            let parameter = about.parameters.iter().position(|p| p.name == given.name)?;
            Some(Free {
                parameter,
                lower,
                upper,
            })
        };
        self.given.iter().filter_map(free).collect()
    }

    /// Fits from a place; `budget` is the number of rounds and the evaluations of each.
    ///
    /// # Errors
    /// Fails if the model cannot predict the evidence.
    pub fn fit(&self, from: &Place, evidence: &Evidence, budget: (usize, usize)) -> Result<Refit, PredictError> {
        self.fit_knowing(Known::Nothing, from, evidence, budget, DECREMENT)
    }

    /// Like [`Self::fit`], until the search cannot gain any more.
    ///
    /// # Errors
    /// As [`Self::fit`].
    pub fn fit_to_convergence(
        &self,
        from: &Place,
        evidence: &Evidence,
        budget: (usize, usize),
    ) -> Result<Refit, PredictError> {
        self.fit_knowing(Known::Nothing, from, evidence, budget, 0.0)
    }

    /// Like [`Self::fit`], with sensors as accurate as their data sheets.
    ///
    /// # Errors
    /// As [`Self::fit`].
    pub fn fit_with_calibrated_sensors(
        &self,
        mut from: Place,
        evidence: &Evidence,
        budget: (usize, usize),
    ) -> Result<Refit, PredictError> {
        from.accuracy = AccuracyClass::default();
        self.fit_knowing(Known::Class, &from, evidence, budget, DECREMENT)
    }

    /// Like [`Self::fit`], with the smallest discrepancy and sensors as accurate as their data sheets: least squares.
    ///
    /// # Errors
    /// As [`Self::fit`].
    pub fn fit_by_least_squares(
        &self,
        from: Place,
        evidence: &Evidence,
        budget: (usize, usize),
    ) -> Result<Refit, PredictError> {
        let from = Place {
            accuracy: AccuracyClass::default(),
            discrepancy: Place::given(evidence).discrepancy,
            ..from
        };
        self.fit_knowing(Known::Variances, &from, evidence, budget, DECREMENT)
    }

    /// Like [`Self::fit`], with the sensor errors of another fit.
    ///
    /// # Errors
    /// As [`Self::fit`].
    pub fn fit_with_sensors_of(
        &self,
        other: &Refit,
        mut from: Place,
        evidence: &Evidence,
        budget: (usize, usize),
    ) -> Result<Refit, PredictError> {
        let sensors = self.nuisance.of_calibration();
        from.accuracy = other.nuisance.accuracy;
        from.errors[..sensors].copy_from_slice(&other.coefficients[..sensors]);
        self.fit_knowing(Known::Errors, &from, evidence, budget, DECREMENT)
    }

    fn fit_knowing(
        &self,
        known: Known,
        from: &Place,
        evidence: &Evidence,
        budget: (usize, usize),
        decrement: f64,
    ) -> Result<Refit, PredictError> {
        let free = self.free();
        let parameters = &self.model.about().parameters;
        let mut errors = from.errors.clone();
        errors.resize(self.nuisance.count(), 0.0);
        let side = |free: &Free| {
            from.sides
                .get(&*parameters[free.parameter].name)
                .copied()
                .unwrap_or(0.0)
        };
        errors.extend(free.iter().map(side));
        let start = Start {
            values: &self.values(&from.named)?,
            errors: &errors,
            initial_states: &from.initial_states,
            centre: &self.values(&BTreeMap::new())?,
            discrepancy: from.discrepancy.carried_to(evidence, Role::Fit),
        };
        let nuisance = Nuisance {
            accuracy: from.accuracy,
            known,
            ..self.nuisance.clone()
        };
        fit(self.model, start, &free, evidence, nuisance, budget, decrement)
    }

    /// Explanation of all runs by a fit, with the non-steady part of the sweeps.
    ///
    /// # Errors
    /// Fails if the model cannot predict the evidence.
    pub fn explanation(&self, refit: Refit, evidence: &Evidence) -> Result<Explanation, PredictError> {
        let refit = add_unsteady(self.model, refit, evidence)?;
        let misfit = Misfit::of(self.model, &refit, evidence)?;
        let names = self.model.about().parameters.iter().map(|p| p.name.to_string());
        let named = names.zip(refit.values.as_slice().iter().copied()).collect();
        Ok(Explanation { named, refit, misfit })
    }

    /// The optimum of a fit as a start point.
    pub fn place(&self, refit: &Refit) -> Place {
        let parameters = &self.model.about().parameters;
        let named = parameters
            .iter()
            .map(|p| p.name.to_string())
            .zip(refit.values.as_slice().iter().copied());
        let side = |free: &Free| {
            (
                parameters[free.parameter].name.to_string(),
                refit.factor(free.parameter),
            )
        };
        Place {
            named: named.collect(),
            sides: refit.free.iter().map(side).collect(),
            accuracy: refit.nuisance.accuracy,
            errors: refit.coefficients[..refit.nuisance.of_sensors()].to_vec(),
            initial_states: refit.initial_states(),
            discrepancy: refit.discrepancy.clone().expect("a fit by evidence has a discrepancy"),
        }
    }
}
