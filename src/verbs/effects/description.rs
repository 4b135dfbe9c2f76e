//! An effect of the catalogue: its description, its forms and its parameters.

use qcar_dsl::patch::Patch;
use qcar_dsl::syntax::{EffectParameter, Role, VanishesAt};
use serde::Serialize;

use crate::table::Table;

/// An effect as its file describes it.
#[derive(Serialize)]
pub struct EffectDescription {
    name: String,
    doc: String,
    source: String,
    shows: String,
    forms: Vec<Form>,
    parameters: Vec<Parameter>,
}

/// One of the ways in which it may act.
#[derive(Serialize)]
struct Form {
    name: String,
    doc: String,
}

/// A parameter; numbers and expressions as they are written, since they may depend on the model.
#[derive(Serialize)]
struct Parameter {
    name: String,
    form: Option<String>,
    unit: String,
    role: Option<&'static str>,
    vanishes_at: Option<String>,
    start: String,
    range: [String; 2],
    known: bool,
    doc: String,
}

impl EffectDescription {
    /// Describes an effect with all its forms.
    pub fn of(patch: &Patch) -> EffectDescription {
        let effect = patch.effect();
        let shared = effect.parameters().into_iter().map(|own| Parameter::of(own, None));
        let of_forms = effect.forms.iter().flat_map(|form| {
            let own = form.parameters().into_iter();
            own.map(|own| Parameter::of(own, Some(form.name.text.clone())))
        });
        let forms = effect.forms.iter().map(|form| Form {
            name: form.name.text.clone(),
            doc: form.doc.clone(),
        });
        EffectDescription {
            name: effect.name.text.clone(),
            doc: effect.doc.clone(),
            source: effect.source.clone(),
            shows: effect.shows.clone(),
            forms: forms.collect(),
            parameters: shared.chain(of_forms).collect(),
        }
    }

    /// As text for the terminal.
    pub fn text(&self) -> String {
        let mut text = format!(
            "{}: {}.\nShows: {}.\nSource: {}.\n",
            self.name, self.doc, self.shows, self.source
        );
        if !self.forms.is_empty() {
            let mut forms = Table::new(["form", "how it acts"]);
            for form in &self.forms {
                forms.row(vec![form.name.clone(), form.doc.clone()]);
            }
            text += &format!("\n{}", forms.text());
        }
        let mut parameters = Table::new(["parameter", "form", "role", "unit", "start", "range", "what it is"]);
        for own in &self.parameters {
            parameters.row(vec![
                own.name.clone(),
                own.form.clone().unwrap_or_else(|| "all".into()),
                own.role_in_words(),
                own.unit.clone(),
                own.start.clone(),
                own.range.join(".."),
                own.doc.clone(),
            ]);
        }
        text + &format!("\n{}", parameters.text())
    }
}

impl Parameter {
    fn of(declared: &EffectParameter, form: Option<String>) -> Parameter {
        let (role, vanishes_at) = match &declared.role {
            Role::Strength(VanishesAt::Zero) => (Some("strength"), Some("0".to_string())),
            Role::Strength(VanishesAt::Infinity) => (Some("strength"), Some("infinity".to_string())),
            Role::Strength(VanishesAt::Value(value)) => (Some("strength"), Some(value.to_string())),
            Role::Shape => (Some("shape"), None),
            Role::Clock => (Some("clock"), None),
            Role::Other => (None, None),
        };
        let (low, high) = &declared.range;
        Parameter {
            name: declared.name.text.clone(),
            form,
            unit: declared.unit.to_string(),
            role,
            vanishes_at,
            start: declared.start.to_string(),
            range: [low, high].map(ToString::to_string),
            known: declared.known,
            doc: declared.doc.clone(),
        }
    }

    fn role_in_words(&self) -> String {
        match (self.role, &self.vanishes_at) {
            (_, Some(value)) => format!("strength, vanishes at {value}"),
            (Some(role), None) => role.to_string(),
            (None, None) if self.known => "known".into(),
            (None, None) => String::new(),
        }
    }
}
