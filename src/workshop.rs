//! Models with effects added, for discovery: patched, compiled and ready to run.

// Equivalent models.
mod motion_samples;

use std::collections::BTreeMap;
use std::iter;
use std::sync::Arc;

use qcar_dsl::check::Checked;
use qcar_dsl::compile::{derive, derive_alone};
use qcar_dsl::patch::{NewParameter, Patch, Patched, Signal};
use qcar_dsl::response::Wanted;
use qcar_dsl::schedule::Compiled;
use qcar_machine::Machine;
use qcar_runtime::campaign::{Axis, Campaign, Parameter, Test};
use qcar_runtime::discover::Evidence;
use qcar_runtime::discover::candidate::{Added, Candidate, Change, Workshop};
use qcar_runtime::discover::noise::Form;
use qcar_runtime::discover::posterior::{Given, Setting};
use qcar_runtime::model::Model;
use rayon::prelude::*;

use motion_samples::MotionSamples;

use crate::effects::Catalogue;
use crate::failure::Failure;
use crate::scales::scales;
use crate::{catalogue, effects};

/// Parameters with their ranges, as the setting of a search.
pub fn given(parameters: &[Parameter], campaign: &Campaign) -> Setting {
    let given = parameters.iter().map(|p| Given {
        range: p.range.filter(|_| p.fit),
        name: p.name.clone(),
        value: p.value,
    });
    Setting {
        given: given.collect(),
        vehicle: campaign.vehicle.iter().cloned().collect(),
    }
}

/// A model, and the catalogue of effects.
#[derive(Clone)]
pub struct Bench {
    model: Checked,
    running: Arc<Machine>,
    catalogue: Arc<Catalogue>,
    values: Arc<BTreeMap<String, f64>>,
    /// Axes and names of the links that a campaign has measured alone.
    alone: Arc<Vec<(String, String)>>,
}

impl Bench {
    /// A bench for a model. Starts and ranges of effects that depend on parameters are computed at `values`.
    pub fn new(model: Checked, catalogue: Arc<Catalogue>, values: Arc<BTreeMap<String, f64>>) -> Self {
        Self::beside(model, catalogue, values, Arc::default())
    }

    /// A bench with further models for the links measured alone, by axis and name.
    fn beside(
        model: Checked,
        catalogue: Arc<Catalogue>,
        values: Arc<BTreeMap<String, f64>>,
        alone: Arc<Vec<(String, String)>>,
    ) -> Self {
        Bench {
            running: Arc::new(run(&derive(model.clone()), &alone)),
            model,
            catalogue,
            values,
            alone,
        }
    }

    /// The same with a model for each link alone.
    pub fn with_every_link_alone(self) -> Self {
        let links = self.model.links.iter();
        let all = links
            .map(|link| (link.direction.0.clone(), link.name.clone()))
            .collect();
        Self::beside(self.model, self.catalogue, self.values, Arc::new(all))
    }

    /// The model of a campaign, or another, with the shipped catalogue.
    ///
    /// # Errors
    /// Fails if the model cannot be read or does not compile.
    pub fn of_campaign(campaign: &Campaign, model: Option<&str>) -> Result<Self, Failure> {
        let compiled = catalogue::compiled_of_campaign(campaign, model, Wanted::Nothing)?;
        let vehicle = campaign.vehicle.iter().cloned();
        let values: BTreeMap<String, f64> = vehicle
            .chain(campaign.parameters.iter().map(|p| (p.name.clone(), p.value)))
            .collect();
        let catalogue = Arc::new(effects::catalogue()?);
        let alone = Arc::new(alone(campaign));
        let fitted = campaign.parameters.iter().filter(|own| own.fit);
        let model = compiled.model.estimating(fitted.map(|own| own.name.as_str()));
        Ok(Self::beside(model, catalogue, Arc::new(values), alone))
    }

    /// The same with the amplitudes of a campaign, on which ranges of effects depend.
    pub fn measured(&self, evidence: &Evidence) -> Self {
        let mut values = scales(&self.model, &self.values, evidence);
        values.extend(self.values.iter().map(|(name, value)| (name.clone(), *value)));
        Bench {
            values: Arc::new(values),
            ..self.clone()
        }
    }

    /// The model.
    pub fn checked(&self) -> &Checked {
        &self.model
    }

    /// Another model with the same catalogue.
    pub fn holding(&self, model: Checked) -> Self {
        let (catalogue, values) = (Arc::clone(&self.catalogue), Arc::clone(&self.values));
        Self::beside(model, catalogue, values, Arc::clone(&self.alone))
    }

    /// The effect or law of a name.
    pub fn patch(&self, name: &str) -> Option<&Patch> {
        let Catalogue { effects, laws } = &*self.catalogue;
        let mut all = effects.iter().chain(laws);
        all.find(|patch| patch.effect().name.text == name)
    }

    fn with_each(&self, patches: &[Patch]) -> Vec<Candidate> {
        let values = |name: &str| self.values.get(name).copied();
        let patched = patches.par_iter();
        let of_patch = |patch: &Patch| {
            let nuisance = patch.effect().nuisance;
            let patched = patch.candidates(&self.model, &values).into_iter();
            let compiled = patched.map(|own| (derive(own.model.clone()), own)).collect();
            let apart = self.told_apart(patch, compiled).into_iter();
            apart.flat_map(move |(compiled, patched)| self.candidates_at(&compiled, patched, nuisance))
        };
        patched.flat_map_iter(of_patch).collect()
    }

    /// Removes forms that are equivalent to an earlier one in this model, also at another place: on a strut that is
    /// fixed to the upright, friction between wheel and body is friction of the damper, whatever other link it is tried
    /// at.
    fn told_apart(&self, patch: &Patch, all: Vec<(Compiled, Patched)>) -> Vec<(Compiled, Patched)> {
        if patch.forms().next().is_none() {
            return all;
        }
        let rank = |own: &Patched| patch.forms().position(|form| Some(form) == own.form.as_deref());
        let ranks: Vec<Option<usize>> = all.iter().map(|(_, own)| rank(own)).collect();
        let sampled = |(compiled, _): &(Compiled, Patched)| {
            let alone: Vec<Compiled> = derived_alone(compiled, &self.alone).map(|(_, own)| own).collect();
            MotionSamples::of(iter::once(compiled).chain(&alone))
        };
        let samples: Vec<MotionSamples> = all.iter().map(sampled).collect();
        let is_first = |place: usize| {
            let mut before = (0..all.len()).filter(|&other| (ranks[other], other) < (ranks[place], place));
            let changes_sensors = !all[place].1.signals.is_empty();
            changes_sensors || before.all(|other| !samples[other].agree_with(&samples[place]))
        };
        let first: Vec<bool> = (0..all.len()).map(is_first).collect();
        let kept = all.into_iter().zip(first).filter(|(_, first)| *first);
        kept.map(|(own, _)| own).collect()
    }

    /// The candidates of a patched model. A location that is given without an axis also stands for its sensors of all
    /// axes.
    fn candidates_at(&self, compiled: &Compiled, patched: Patched, nuisance: bool) -> Vec<Candidate> {
        let Some(signal) = patched.signals.first() else {
            return vec![Candidate {
                effect: patched.effect,
                at: patched.place,
                form: patched.form,
                nuisance,
                change: Change::Model {
                    parameters: patched
                        .parameters
                        .iter()
                        .filter(|p| p.is_new || !p.known)
                        .map(added)
                        .collect(),
                    model: Box::new(run(compiled, &self.alone)),
                },
            }];
        };
        let axis = Axis::new(signal.axis.clone());
        let mut axes = vec![(format!("along_{}", signal.axis), Some(axis))];
        if patched.place == signal.location {
            axes.push(("along_every_axis".into(), None));
        }
        let sensor = |(form, axis)| {
            Some(Candidate {
                effect: patched.effect.clone(),
                at: patched.place.clone(),
                form: Some(form),
                nuisance,
                change: Change::Sensor {
                    location: signal.location.clone(),
                    axis,
                    form: match signal.kind {
                        Signal::Delay => Form::Delay,
                        Signal::Gain => Form::Gain,
                    },
                    parameter: added(patched.parameters.first()?),
                },
            })
        };
        axes.into_iter().filter_map(sensor).collect()
    }

    /// The model with an effect added, in one of its forms; `None` if the effect does not apply.
    pub fn patched(&self, effect: &str, at: &str, form: Option<&str>) -> Option<Patched> {
        let patch = self.patch(effect)?;
        let chosen = form.and_then(|form| patch.in_form(form));
        chosen
            .as_ref()
            .unwrap_or(patch)
            .apply(&self.model, at, &|name| self.values.get(name).copied())
            .ok()
    }
}

impl Workshop for Bench {
    fn model(&self) -> &dyn Model {
        &*self.running
    }

    fn candidates(&self) -> Vec<Candidate> {
        self.with_each(&self.catalogue.effects)
    }

    fn candidates_of(&self, effect: &str) -> Vec<Candidate> {
        self.patch(effect)
            .map_or_else(Vec::new, |patch| self.with_each(std::slice::from_ref(patch)))
    }

    fn laws(&self) -> Vec<Candidate> {
        self.with_each(&self.catalogue.laws)
    }

    fn with(&self, effect: &str, at: &str, form: Option<&str>) -> Option<Box<dyn Workshop>> {
        let patched = self.patched(effect, at, form)?;
        let changes_model = patched.signals.is_empty();
        changes_model.then(|| Box::new(self.holding(patched.model)) as Box<dyn Workshop>)
    }
}

/// The runnable model, with models of its links that are measured alone.
fn run(compiled: &Compiled, alone: &[(String, String)]) -> Machine {
    derived_alone(compiled, alone).fold(Machine::new(compiled), |whole, ((axis, link), alone)| {
        whole.with_alone(axis, link, &alone)
    })
}

/// The links of a model that are measured alone, with their models.
fn derived_alone<'a>(
    compiled: &'a Compiled,
    alone: &'a [(String, String)],
) -> impl Iterator<Item = (&'a (String, String), Compiled)> {
    let derived = |(axis, link): &(String, String)| derive_alone(&compiled.model, axis, link);
    alone.iter().filter_map(move |own| Some((own, derived(own)?)))
}

/// The links that a campaign has measured alone, without duplicates.
fn alone(campaign: &Campaign) -> Vec<(String, String)> {
    let mut links: Vec<(String, String)> = Vec::new();
    for run in &campaign.runs {
        if let Test::Dynamometer(test) = &run.test {
            let link = (test.axis.name().to_string(), test.link.clone());
            if !links.contains(&link) {
                links.push(link);
            }
        }
    }
    links
}

fn added(parameter: &NewParameter) -> Added {
    Added {
        name: parameter.name.clone(),
        effect_name: parameter.effect_name.clone(),
        start: parameter.start,
        range: parameter.range,
        known: parameter.known,
        role: parameter.role,
        scales_force: parameter.scales_force,
    }
}
