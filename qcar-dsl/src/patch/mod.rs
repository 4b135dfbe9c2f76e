//! Effects: patches of models, read from files and applied at their places.
//!
//! A patch changes the syntax tree, so the new model is a file like any other. Expressions of an effect refer to the
//! model before the patch: `l.damper` is the coefficient of the original damper, even if the term is replaced.

// Syntax trees with names replaced.
mod rewrite;
// Effects where the motion is an angle.
mod angle;
// The syntax tree of the model that is patched.
mod model_tree;
// Values of expressions at the model's parameters.
mod query;
// Outputs that show what every part of a model does.
mod all_outputs;
// Amplitudes of travel and force at a place.
mod scale;
// The two ends of a link.
mod stretch;
// The terms of a link's law.
mod terms;
// The points that links connect.
mod graph;
// The role of each link: tyre, suspension, mount.
mod roles;
// The places where an effect applies.
mod place;
// Places with the same surroundings.
mod kind;
// The meaning of an effect's names at a place.
mod bind;
// The effect's statements, applied to the tree.
mod apply;
mod tidy;
// Curves of an effect: tables with points to estimate.
mod curve;
// Start values and ranges of an effect's parameters.
mod start;
// Checks of the text of an effect.
mod rules;
// The differences between two models.
pub mod difference;

use std::borrow::Cow;
use std::cell::LazyCell;
use std::collections::BTreeMap;

pub use all_outputs::{is_push, push, with_all_outputs};
use bind::Bindings;
pub use curve::{Curve, Ordinate};
use kind::Parts;
pub(crate) use model_tree::ModelTree;
use place::Place;
pub use qcar_model::ParameterRole;
pub use query::Values;
use roles::Roles;
pub use scale::Scale;

use crate::check::{Checked, Unseen, check_text};
use crate::derive::identifiability;
use crate::diagnostic::{Diagnostic, Report, Severity, effects};
use crate::front::syntax::{Effect, File, Form, Item, Link, Name};
use crate::hash::HashMap;
use crate::source::Source;

/// The mistakes for which an effect is refused.
pub(crate) type Refusal = Vec<Diagnostic>;

/// A result of patching, or the mistakes for which it is refused.
pub(crate) type PatchResult<T> = Result<T, Refusal>;

fn refused(mistake: Diagnostic) -> Refusal {
    vec![mistake]
}

/// An effect that was read from a file. If it has several forms, the first one is the usual form, which is applied.
#[derive(Clone, Debug)]
pub struct Patch {
    effect: Effect,
    source: Source,
}

/// A model with an effect.
#[derive(Clone, Debug)]
pub struct Patched {
    /// The effect.
    pub effect: String,
    /// The label of its place.
    pub place: String,
    /// The form that was applied; `None` if the effect has only one.
    pub form: Option<String>,
    /// The checked model; its name includes that of the effect, `axle_c_with_coulomb_friction`.
    pub model: Checked,
    /// The parameters of the effect, in the order of its file.
    pub parameters: Vec<NewParameter>,
    /// Errors of measured signals, which do not appear in the equations.
    pub signals: Vec<SignalChange>,
    comments: Vec<String>,
}

/// A parameter of an effect in a patched model.
#[derive(Clone, Debug, PartialEq)]
pub struct NewParameter {
    /// Its name in the model.
    pub name: String,
    /// Its name in the effect; different if the model already used that name.
    pub effect_name: String,
    /// The usual name of its coherent SI unit.
    pub unit: String,
    /// Start of a search, in SI.
    pub start: f64,
    /// Plausible range in SI, lower below upper.
    pub range: (f64, f64),
    /// True if it is given, not estimated.
    pub known: bool,
    /// The description.
    pub doc: String,
    /// Its role in the effect.
    pub role: ParameterRole,
    /// True if it is a mass, stiffness, damping, force or another quantity whose unit has kg once. If all of these are
    /// multiplied by a number, so are the forces of the effect at given motions.
    pub scales_force: bool,
    /// False for a shared parameter that the model already had.
    pub is_new: bool,
}

/// An error of a measured signal.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SignalChange {
    /// The location of the sensor.
    pub location: String,
    /// Its axis.
    pub axis: String,
    /// The kind of error.
    pub kind: Signal,
    /// The parameter that gives its size.
    pub parameter: String,
}

/// Kinds of errors of a measured signal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Signal {
    /// A delay, whose parameter is in s.
    Delay,
    /// A gain, whose parameter is a factor.
    Gain,
}

impl Patch {
    /// Reads the file of an effect.
    ///
    /// # Errors
    /// Fails with the report of every mistake that can be found without a model.
    pub fn read(source: Source) -> Result<Patch, Report> {
        rules::effect_of(&source)
            .map(|effect| Patch {
                effect,
                source: source.clone(),
            })
            .map_err(|diagnostics| Report {
                sources: vec![source],
                diagnostics,
            })
    }

    /// The syntax tree of the effect.
    pub fn effect(&self) -> &Effect {
        &self.effect
    }

    /// The names of its forms, the usual one first; empty if there is only one.
    pub fn forms(&self) -> impl Iterator<Item = &str> {
        self.effect.forms.iter().map(|form| form.name.text.as_str())
    }

    /// The effect with one of its forms only; `None` if it has no form of this name.
    pub fn in_form(&self, name: &str) -> Option<Patch> {
        let form = self.effect.forms.iter().find(|form| form.name.text == name)?;
        let mut patch = self.clone();
        patch.effect.forms = vec![form.clone()];
        Some(patch)
    }

    /// The curves of its usual form whose points are numbers or parameters, in the order of its text.
    pub fn curves(&self) -> Vec<Curve> {
        curve::curves(&self.effect)
    }

    /// The units of all its parameters at a place of a model, by their names in the effect. Those of a place that the model
    /// lacks are those of parts that move.
    pub fn units(&self, model: &Checked, place: &str) -> BTreeMap<String, String> {
        let base = ModelTree::of(model);
        let places = place::fitting(&base, &Roles::of(&base, &|_| None), &self.effect.pattern);
        let place = places.iter().find(|own| own.label == place);
        let effect = place.map_or(Cow::Borrowed(&self.effect), |place| self.effect_at(&base, place));
        let of_forms = effect.forms.iter().flat_map(Form::parameters);
        let all = effect.parameters().into_iter().chain(of_forms);
        all.map(|own| (own.name.text.clone(), own.unit.to_string())).collect()
    }

    /// The effect in the units of a place.
    fn effect_at(&self, base: &ModelTree, place: &Place) -> Cow<'_, Effect> {
        if base.turns(&place.direction, &place.name) {
            Cow::Owned(angle::of_angles(&self.effect))
        } else {
            Cow::Borrowed(&self.effect)
        }
    }

    /// The effect as a file in which these parameters have numbers as starts, independent of the model.
    pub fn text_at(&self, parameters: &[NewParameter]) -> String {
        let mut effect = self.effect.clone();
        start::set_starts(&mut effect, parameters);
        let items = vec![Item::Effect(Box::new(effect))];
        File { items }.to_string()
    }

    /// The labels of the places of a model where the effect applies in any form, in the order of the model's text.
    pub fn places(&self, model: &Checked) -> Vec<String> {
        let values: Values = &|_| None;
        let base = ModelTree::of(model);
        let roles = Roles::of(&base, values);
        let forms = self.own_forms();
        let before = identifiability::with_identifiability(model.clone());
        // An error of a sensor leaves the same model at every place, so one check serves all of them.
        let mut accepted: HashMap<String, bool> = HashMap::default();
        let mut applies_at = |place: &Place| {
            forms.iter().any(|form| {
                let Ok((mut tree, ..)) = form.tree(&base, &roles, place, values) else {
                    return false;
                };
                tree.axle.doc.clear();
                let text = tree.file().to_string();
                *accepted
                    .entry(text.clone())
                    .or_insert_with(|| is_accepted(&tree, text, &before))
            })
        };
        let places = place::fitting(&base, &roles, &self.effect.pattern);
        let has_several = places.len() > 1;
        let parts = LazyCell::new(|| Parts::of(&base, &roles, &before));
        let mut of_kind: HashMap<String, bool> = HashMap::default();
        let mut applies = |place: &Place| match has_several.then(|| parts.kind(&self.effect, place)).flatten() {
            Some(kind) => *of_kind.entry(kind).or_insert_with(|| applies_at(place)),
            None => applies_at(place),
        };
        places
            .into_iter()
            .filter(|place| applies(place))
            .map(|place| place.label)
            .collect()
    }

    /// The model with the effect at each place where it applies, in the order of the model's text, and in each form. It
    /// applies if the pattern fits, the model has everything that the effect uses, and the compiler accepts the result.
    pub fn candidates(&self, model: &Checked, values: Values) -> Vec<Patched> {
        let forms = self.own_forms();
        let base = ModelTree::of(model);
        let roles = Roles::of(&base, values);
        let places = place::fitting(&base, &roles, &self.effect.pattern);
        let before = identifiability::with_identifiability(model.clone());
        let at = |place: &Place| -> Vec<Patched> {
            let made = forms
                .iter()
                .map(|form| form.made(&before, &base, &roles, place, values));
            made.filter_map(Result::ok).collect()
        };
        places.iter().flat_map(at).collect()
    }

    /// The effect in each of its forms; the effect itself if it has none.
    fn own_forms(&self) -> Cow<'_, [Patch]> {
        let forms: Vec<Patch> = self.forms().filter_map(|form| self.in_form(form)).collect();
        if forms.is_empty() {
            Cow::Borrowed(std::slice::from_ref(self))
        } else {
            Cow::Owned(forms)
        }
    }

    /// The model with the effect at a place, given by its label, in the first form whose conditions it meets. Starts and
    /// ranges that depend on parameters of the model use their `values`, otherwise their defaults, otherwise the middle
    /// of their ranges.
    ///
    /// # Errors
    /// Fails if the effect does not apply at the place, if the model already has a name of the effect, if the patched
    /// model breaks a rule of the compiler, or if the outputs cannot distinguish its parameters, since a search must be
    /// able to find an effect.
    pub fn apply(&self, model: &Checked, place: &str, values: Values) -> Result<Patched, Report> {
        let base = ModelTree::of(model);
        let roles = Roles::of(&base, values);
        let places = place::fitting(&base, &roles, &self.effect.pattern);
        let Some(place) = places.iter().find(|own| own.label == place) else {
            let labels: Vec<&str> = places.iter().map(|place| place.label.as_str()).collect();
            let (name, model) = (&self.effect.name, &base.axle.name.text);
            let why = place::lacks(&base, &roles, &self.effect.pattern, place);
            let mistake = effects::no_such_place(name.span, &name.text, (place, model), why, &labels);
            return Err(self.report(refused(mistake)));
        };
        let forms = self.own_forms();
        let usual = forms.iter().find(|form| form.form_fits(&base, &roles, place).is_ok());
        usual.unwrap_or(self).made(
            &identifiability::with_identifiability(model.clone()),
            &base,
            &roles,
            place,
            values,
        )
    }

    fn report(&self, diagnostics: Refusal) -> Report {
        Report {
            sources: vec![self.source.clone()],
            diagnostics,
        }
    }

    /// The model with the effect. `before` is the model without it, whose identifiability has been checked.
    fn made(
        &self,
        before: &Checked,
        base: &ModelTree,
        roles: &Roles,
        place: &Place,
        values: Values,
    ) -> Result<Patched, Report> {
        let made = self.tree(base, roles, place, values);
        let (tree, parameters, signals) = made.map_err(|refused| self.report(refused))?;
        let model = accepted_model(&tree, before)?;
        Ok(Patched {
            effect: self.effect.name.text.clone(),
            place: place.label.clone(),
            form: self.forms().next().map(str::to_string),
            model,
            parameters,
            signals,
            comments: self.comments(&place.label),
        })
    }

    fn tree(
        &self,
        base: &ModelTree,
        roles: &Roles,
        place: &Place,
        values: Values,
    ) -> PatchResult<(ModelTree, Vec<NewParameter>, Vec<SignalChange>)> {
        self.form_fits(base, roles, place)?;
        let effect = self.effect_at(base, place);
        let mut patching = apply::apply(Bindings::new(base, roles, &effect, place))?;
        let mut asked = Vec::new();
        for (declared, name) in &patching.parameters {
            let expressions = start::expressions(declared).map(|e| patching.meaning(e));
            asked.push(start::BoundParameter {
                declared,
                doc: patching.doc(declared),
                name: name.clone(),
                expressions: expressions.collect::<PatchResult<_>>()?,
            });
        }
        let (parameters, declared): (Vec<NewParameter>, Vec<_>) =
            start::evaluate(base, &asked, values)?.into_iter().unzip();
        start::set_known_defaults(&mut patching.tree, &asked, values);
        patching.declare_parameters(declared);
        let mut tree = patching.tree;
        tidy::tidy(&mut tree, base);
        self.rename(&mut tree, &place.label);
        // Removes what the patched model does not use.
        let used = |own: &NewParameter| {
            let sensed = patching.signals.iter().any(|signal| signal.parameter == own.name);
            sensed || tree.global(&own.name).is_some()
        };
        let parameters = parameters.into_iter().filter(used).collect();
        Ok((tree, parameters, patching.signals))
    }

    /// Checks the role and the terms that its form requires in addition to those of the pattern.
    fn form_fits(&self, base: &ModelTree, roles: &Roles, place: &Place) -> PatchResult<()> {
        let Some(form) = self.effect.forms.first() else {
            return Ok(());
        };
        let (kind, along, name) = (self.effect.pattern.kind, &place.direction, &place.name);
        let has_role = |role: &&Name| place::has_role(roles, kind, along, name, &role.text);
        if let Some(role) = form.role.as_ref().filter(|role| !has_role(role)) {
            return Err(refused(effects::place_has_no_role(role.span, &role.text, name)));
        }
        let has = |term: &Name, link: &Link| terms::has_terms(&link.body, std::slice::from_ref(term));
        let lacking = base
            .link(along, name)
            .and_then(|link| form.terms.iter().find(|term| !has(term, link)));
        match lacking {
            Some(term) => Err(refused(effects::place_lacks(term.span, &term.text, name))),
            None => Ok(()),
        }
    }

    /// Adds the effect to the name and the description of a model.
    fn rename(&self, tree: &mut ModelTree, label: &str) {
        let (effect, axle) = (&self.effect.name.text, &mut tree.axle);
        let joint = if axle.name.text.contains("_with_") {
            "and"
        } else {
            "with"
        };
        axle.name = Name::new(format!("{}_{joint}_{effect}", axle.name.text));
        let doc = if axle.doc.is_empty() {
            String::new()
        } else {
            format!("{}, ", axle.doc)
        };
        let form = self
            .forms()
            .next()
            .map_or_else(String::new, |form| format!(", {}", form.replace('_', " ")));
        axle.doc = format!("{doc}{joint} {effect} at {label}{form}");
    }

    fn comments(&self, label: &str) -> Vec<String> {
        let effect = &self.effect;
        let form = effect.forms.first().map(|form| format!("{}.", form.doc));
        let what = format!("{} at {label}: {}.", effect.name.text, effect.doc);
        [what]
            .into_iter()
            .chain(form)
            .chain([format!("Source: {}.", effect.source)])
            .collect()
    }
}

impl Patched {
    /// Says of an error of a sensor that the equations of motion do not contain it; `None` for any other effect.
    pub fn note_on_sensors(&self) -> Option<&'static str> {
        let note = "an error of a sensor changes what is measured, not the equations of motion: correct the channel in \
                    the campaign";
        (!self.signals.is_empty()).then_some(note)
    }

    /// The model file with comments about the effect, and one comment line for each line of `evidence`.
    pub fn text(&self, evidence: &str) -> String {
        let comments = self.comments.iter().map(String::as_str).chain(evidence.lines());
        let comments = comments.chain(self.note_on_sensors());
        let comments: String = comments.map(|line| format!("// {line}\n")).collect();
        format!("{comments}{}", self.model.text())
    }
}

/// The patched model, if the compiler accepts it and its outputs determine its parameters as far as those of the model
/// before.
fn accepted_model(tree: &ModelTree, before: &Checked) -> Result<Checked, Report> {
    determined(valid_model(tree, tree.file().to_string(), before)?, before)
}

/// Whether there is such a model, given the text of its tree; mostly found from responses at a single parameter set.
fn is_accepted(tree: &ModelTree, text: String, before: &Checked) -> bool {
    valid_model(tree, text, before).is_ok_and(|model| {
        let groups = identifiability::unseen_at_one_set(&model);
        groups.is_some_and(|groups| !hide_more(&groups, &model, before)) || determined(model, before).is_ok()
    })
}

/// The patched model with the given text, if it breaks no rule; as much of it is estimated as before.
fn valid_model(tree: &ModelTree, text: String, before: &Checked) -> Result<Checked, Report> {
    let name = format!("{}.axle", tree.axle.name.text);
    let model = check_text(Source { name, text }, &|_, path| {
        Err(format!("{path} is not part of a patched model"))
    })?;
    let estimated = before.parameters.iter().filter(|own| !own.known);
    Ok(model.estimating(estimated.map(|own| own.name.as_str())))
}

/// The patched model, if its outputs determine its parameters as far as those of the model before.
fn determined(model: Checked, before: &Checked) -> Result<Checked, Report> {
    let model = identifiability::with_identifiability(model);
    if !hide_more(model.unseen(), &model, before) {
        return Ok(model);
    }
    let mut report = model.warnings().clone();
    let all = report.diagnostics.iter_mut();
    all.for_each(|found| found.severity = Severity::Error);
    Err(report)
}

/// True if one of these groups of a patched model hides more than the model before.
fn hide_more(groups: &[Unseen], model: &Checked, before: &Checked) -> bool {
    groups.iter().any(|group| hides_more(group, model, before.unseen()))
}

/// True if a group has more undetermined combinations than the groups of the unpatched model in it, apart from their
/// parameters that the patch has removed. Otherwise its new parameters are determined once those of the model are: if
/// only ratios of masses and stiffnesses are seen, one known mass gives all of them.
fn hides_more(group: &Unseen, model: &Checked, before: &[Unseen]) -> bool {
    let hidden = |own: &Unseen| own.parameters.len() - own.seen;
    let is_left = |name: &&String| model.parameters.iter().any(|own| own.name == **name);
    let is_inside = |own: &&Unseen| {
        let mut left = own.parameters.iter().filter(is_left);
        left.all(|name| group.parameters.contains(name))
    };
    hidden(group) > before.iter().filter(is_inside).map(hidden).sum()
}
