//! A model with effects in it, and one more effect that might be added.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::unknowns::Unknowns;
use crate::campaign::Role;
use crate::discover::candidate::{Added, Candidate, Change, Workshop};
use crate::discover::noise::{Beginning, Discrepancy, Form, Nuisance};
use crate::discover::observe::{Evidence, Free, PredictError};
use crate::discover::posterior::{Explanation, Gap, Given, Refit, Setting, Start, fit, settle};
use crate::model::Model;
use crate::response::parameters::Values;

/// A model with effects in it.
#[derive(Clone)]
pub struct Assembly {
    workshop: Arc<dyn Workshop>,
    setting: Setting,
    nuisance: Nuisance,
    effects: Vec<Placed>,
}

/// An effect at its place, in one of its forms.
#[derive(Clone)]
pub struct Placed {
    /// Its name.
    pub effect: String,
    /// Its place.
    pub at: String,
    /// Its form; `None` where it has only one.
    pub form: Option<String>,
    /// Whether it is no answer, since every real car has some of it.
    pub nuisance: bool,
    /// What of it is unknown.
    pub unknowns: Unknowns,
}

impl Placed {
    /// Its name and place.
    pub fn name(&self) -> (&str, &str) {
        (&self.effect, &self.at)
    }
}

/// A model that can be fitted: that of an assembly, or of a candidate beside it.
pub struct Hypothesis<'a> {
    model: &'a dyn Model,
    given: Vec<Given>,
    vehicle: &'a BTreeMap<String, f64>,
    nuisance: Nuisance,
}

/// Values of parameters by name, and errors of sensors, from which a fit begins.
#[derive(Clone, Debug, Default)]
pub struct Place {
    /// Parameters.
    pub named: BTreeMap<String, f64>,
    /// Logarithms of the factors of the recorded side, by parameter.
    pub sides: BTreeMap<String, f64>,
    /// Coefficients of the sensors' errors.
    pub errors: Vec<f64>,
    /// With which states records begin.
    pub begun: Vec<(Beginning, f64)>,
    /// What the model is taken to miss.
    pub discrepancy: Discrepancy,
}

impl Place {
    /// The values that the campaign gives, with sensors that are right and nothing missed.
    pub fn given(evidence: &Evidence) -> Self {
        Self {
            named: BTreeMap::new(),
            sides: BTreeMap::new(),
            errors: Vec::new(),
            begun: Vec::new(),
            discrepancy: Discrepancy::of(evidence, Role::Fit),
        }
    }
}

impl Assembly {
    /// The base model.
    ///
    /// # Errors
    /// Where a parameter has no value.
    pub fn base(workshop: Arc<dyn Workshop>, setting: &Setting, evidence: &Evidence) -> Result<Self, PredictError> {
        setting.check(workshop.model().about())?;
        Ok(Self {
            workshop,
            setting: setting.clone(),
            nuisance: Nuisance::of(evidence),
            effects: Vec::new(),
        })
    }

    /// Its effects, in the order in which they were added.
    pub fn effects(&self) -> &[Placed] {
        &self.effects
    }

    /// The parameters of its model.
    pub fn given(&self) -> &[Given] {
        &self.setting.given
    }

    /// The model.
    pub fn model(&self) -> &dyn Model {
        self.workshop.model()
    }

    /// Every effect at every place of it.
    pub fn candidates(&self) -> Vec<Candidate> {
        self.not_yet_there(self.workshop.candidates())
    }

    /// Every law that names no cause, at every place of it.
    pub fn laws(&self) -> Vec<Candidate> {
        self.not_yet_there(self.workshop.laws())
    }

    /// Those that it does not have.
    fn not_yet_there(&self, candidates: Vec<Candidate>) -> Vec<Candidate> {
        let is_new = |candidate: &Candidate| {
            let is_there = |own: &Placed| own.effect == candidate.effect && own.at == candidate.at;
            !self.effects.iter().any(is_there)
        };
        candidates.into_iter().filter(is_new).collect()
    }

    /// The assembly itself.
    pub fn hypothesis(&self) -> Hypothesis<'_> {
        Hypothesis {
            model: self.workshop.model(),
            given: self.setting.given.clone(),
            vehicle: &self.setting.vehicle,
            nuisance: self.nuisance.clone(),
        }
    }

    /// The assembly with a candidate; `None` for a sensor that the evidence does not have.
    pub fn hypothesis_with<'a>(&'a self, candidate: &'a Candidate) -> Option<Hypothesis<'a>> {
        let mut hypothesis = self.hypothesis();
        match &candidate.change {
            Change::Model { model, parameters } => {
                hypothesis.model = &**model;
                hypothesis.given.extend(unknown(parameters));
            }
            Change::Sensor { .. } => hypothesis.nuisance = suspecting(&self.nuisance, candidate)?,
        }
        Some(hypothesis)
    }

    /// With a candidate in it; `None` where it does not apply.
    pub fn with(&self, candidate: &Candidate) -> Option<Self> {
        let mut assembly = self.clone();
        match &candidate.change {
            Change::Model { parameters, .. } => {
                let form = candidate.form.as_deref();
                assembly.workshop = Arc::from(self.workshop.with(&candidate.effect, &candidate.at, form)?);
                assembly.setting.given.extend(unknown(parameters));
            }
            Change::Sensor { .. } => assembly.nuisance = suspecting(&self.nuisance, candidate)?,
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

    /// The base model with these effects; `None` where they do not go together.
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

/// What of an effect is to be found.
fn unknown(parameters: &[Added]) -> impl Iterator<Item = Given> {
    let unknown = parameters.iter().filter(|parameter| !parameter.known);
    unknown.map(|parameter| Given {
        name: parameter.name.clone(),
        value: parameter.start,
        range: Some(parameter.range),
    })
}

/// With the sensor of a candidate under suspicion; `None` where it is none, or not in the evidence.
fn suspecting(nuisance: &Nuisance, candidate: &Candidate) -> Option<Nuisance> {
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
    // The coefficient of a gain is its logarithm, that of a delay is in seconds.
    let width = if *form == Form::Delay {
        high - low
    } else {
        (high / low).ln()
    };
    nuisance
        .clone()
        .suspecting(location, *axis, *form, width / 12.0_f64.sqrt())
}

impl<'a> Hypothesis<'a> {
    /// The model.
    pub fn model(&self) -> &'a dyn Model {
        self.model
    }

    /// The errors of sensors of a fit of the present model, with those of this one beside them, and their coefficients at a
    /// place.
    pub fn nuisance_at(&self, refit: &Refit, place: &Place) -> (Nuisance, Vec<f64>) {
        let mut nuisance = refit.nuisance.clone();
        nuisance.suspects.clone_from(&self.nuisance.suspects);
        let begun = &refit.coefficients[refit.nuisance.of_sensors()..];
        (nuisance, place.errors.iter().chain(begun).copied().collect())
    }

    /// Number of its errors of sensors.
    pub fn sensor_errors(&self) -> usize {
        self.nuisance.len()
    }

    /// All parameters, where these are known and the others are as they are given.
    ///
    /// # Errors
    /// Where a parameter has no value.
    pub fn values(&self, known: &BTreeMap<String, f64>) -> Result<Values, PredictError> {
        let about = self.model.about();
        // An effect may replace a law, and its parameters with it.
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

    /// Fits it from a place, in so many rounds of so many evaluations.
    ///
    /// # Errors
    /// Where the model says nothing of the evidence.
    pub fn fit(&self, from: &Place, evidence: &Evidence, budget: (usize, usize)) -> Result<Refit, PredictError> {
        let free = self.free();
        let parameters = &self.model.about().parameters;
        let mut errors = from.errors.clone();
        errors.resize(self.nuisance.len(), 0.0);
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
            begun: &from.begun,
            centre: &self.values(&BTreeMap::new())?,
            discrepancy: from.discrepancy.carried_to(evidence, Role::Fit),
        };
        fit(self.model, start, &free, evidence, self.nuisance.clone(), budget)
    }

    /// What a fit says of all runs, with what sweeps show beyond steady harmonics.
    ///
    /// # Errors
    /// Where the model says nothing of the evidence.
    pub fn explanation(&self, refit: Refit, evidence: &Evidence) -> Result<Explanation, PredictError> {
        let refit = settle(self.model, refit, evidence)?;
        let gap = Gap::of(self.model, &refit, evidence)?;
        let names = self.model.about().parameters.iter().map(|p| p.name.to_string());
        let named = names.zip(refit.values.as_slice().iter().copied()).collect();
        Ok(Explanation { named, refit, gap })
    }

    /// Where a fit ended.
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
            errors: refit.coefficients[..refit.nuisance.of_sensors()].to_vec(),
            begun: refit.begun(),
            discrepancy: refit.discrepancy.clone().expect("a fit by evidence has a discrepancy"),
        }
    }
}
