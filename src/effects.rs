//! Effects by the name of a shipped effect or by the path of a file.

use std::collections::BTreeMap;
use std::path::Path;

use qcar_dsl::check::Checked;
use qcar_dsl::parse::parse_text;
use qcar_dsl::patch::Patch;
use qcar_dsl::source::Source;
use qcar_dsl::syntax::Item;
use qcar_runtime::spelling;

use crate::catalogue::looks_like_a_path;
use crate::failure::{Failure, flag};
use crate::files::read_text;

/// Effects and laws that a model may lack.
pub struct Catalogue {
    /// The effects.
    pub effects: Vec<Patch>,
    /// Laws without a physical cause.
    pub laws: Vec<Patch>,
}

/// All shipped effects, by name.
///
/// # Errors
/// Never fails if the build has read the shipped files.
pub fn all() -> Result<Vec<Patch>, Failure> {
    read_all(models::effects())
}

/// The shipped effects, and the shipped laws without a physical cause.
///
/// # Errors
/// Never fails if the build has read the shipped files.
pub fn catalogue() -> Result<Catalogue, Failure> {
    Ok(Catalogue {
        effects: all()?,
        laws: read_all(models::laws())?,
    })
}

fn read_all(shipped: &[models::ShippedEffect]) -> Result<Vec<Patch>, Failure> {
    shipped.iter().map(|own| read(own.file, own.text)).collect()
}

/// The effect with a name or path, in one form or in all.
///
/// # Errors
/// Fails if a name is neither shipped nor a file, if the file does not compile, or if the effect lacks the form.
pub fn find(effect: &str, form: Option<&str>) -> Result<Patch, Failure> {
    let patch = named(effect)?;
    let Some(form) = form else { return Ok(patch) };
    patch.in_form(form).ok_or_else(|| {
        let names: Vec<_> = patch.forms().collect();
        let remedy = match names.is_empty() {
            true => format!("leave --form out: `{effect}` has only one"),
            false => spelling::choice(form, names.iter().copied()),
        };
        let expected = format!("a form of `{effect}`");
        flag("--form", format!("`{form}`"), &expected, &remedy).into()
    })
}

/// The effect with a name or in a file; `None` if the name is that of something else.
///
/// # Errors
/// Fails if the file does not compile.
pub fn of_name(name: &str) -> Option<Result<Patch, Failure>> {
    if let Some(shipped) = shipped(name) {
        return Some(read(shipped.file, shipped.text));
    }
    let text = read_text(Path::new(name)).ok().filter(|_| looks_like_a_path(name))?;
    holds_effect(name, &text).then(|| read(name, &text))
}

/// The units of the parameters of a shipped effect at a place of a model, by name; empty for any other effect.
pub fn units(effect: &str, at: &str, model: &Checked) -> BTreeMap<String, String> {
    let patch = of_name(effect).and_then(Result::ok);
    patch.map_or_else(BTreeMap::new, |patch| patch.units(model, at))
}

fn shipped(name: &str) -> Option<&'static models::ShippedEffect> {
    let mut all = models::effects().iter().chain(models::laws());
    all.find(|shipped| shipped.name == name)
}

fn holds_effect(name: &str, text: &str) -> bool {
    let items = parse_text(&source(name, text), 0).file.items;
    items.iter().any(|item| matches!(item, Item::Effect(_)))
}

fn named(effect: &str) -> Result<Patch, Failure> {
    if let Some(shipped) = shipped(effect) {
        return read(shipped.file, shipped.text);
    }
    if looks_like_a_path(effect) {
        return read(effect, &read_text(Path::new(effect))?);
    }
    let names = models::effects().iter().map(|shipped| shipped.name);
    let remedy = spelling::choice_or(effect, names, "give the path of a file");
    Err(flag(
        "EFFECT",
        format!("`{effect}`"),
        "a shipped effect or an effect's file",
        &remedy,
    )
    .into())
}

fn read(name: &str, text: &str) -> Result<Patch, Failure> {
    Patch::read(source(name, text)).map_err(|report| Failure::Input(report.to_string()))
}

fn source(name: &str, text: &str) -> Source {
    Source {
        name: name.into(),
        text: text.into(),
    }
}
