//! `truth.toml`: the true parameters of a simulated campaign. Only tests may read it.

use std::path::Path;

use super::contents::unit_of_fact;
use super::fields::{Document, Section};
use crate::error::InputError;

/// The true model of a campaign.
#[derive(Clone, Debug, PartialEq)]
pub struct Truth {
    /// Source of the data.
    pub generator: String,
    /// The effects that the base model lacks.
    pub effects: Vec<Effect>,
    /// True values of the base model's parameters, SI, in the order of the file.
    pub parameters: Vec<(String, f64)>,
}

/// An effect of the measured axle that the base model lacks.
#[derive(Clone, Debug, PartialEq)]
pub struct Effect {
    /// Name, such as `coulomb_friction`.
    pub name: String,
    /// Its place: a link, mass or sensor location of the model.
    pub at: String,
    /// True values of its parameters, SI, in the order of the file.
    pub parameters: Vec<(String, f64)>,
}

impl Truth {
    /// Reads a `truth.toml`.
    ///
    /// # Errors
    /// Fails with all problems of the file.
    pub fn read(file: &Path) -> Result<Truth, InputError> {
        let document = Document::read(file)?;
        let truth = {
            let tree = document.parse()?;
            truth(&document.top(&tree))
        };
        document.finish(truth)
    }
}

fn truth(top: &Section<'_>) -> Option<Truth> {
    let generator = top.remark("generator");
    let effects: Vec<_> = top.sections("effects").iter().map(effect).collect();
    let parameters = top
        .section("parameters")
        .map(|section| section.quantities(unit_of_fact))
        .unwrap_or_default();
    top.finish();
    Some(Truth {
        generator,
        effects: effects.into_iter().collect::<Option<_>>()?,
        parameters,
    })
}

fn effect(section: &Section<'_>) -> Option<Effect> {
    let (name, at) = (section.text("name"), section.text("at"));
    let parameters = section
        .section("parameters")
        .map(|section| section.quantities(unit_of_fact))
        .unwrap_or_default();
    section.finish();
    Some(Effect {
        name: name?,
        at: at?,
        parameters,
    })
}
