//! Effects by the name of a shipped one or by the path of a file.

use std::path::Path;

use qcar_dsl::patch::Patch;
use qcar_dsl::source::Source;

use crate::failure::{Failure, flag};
use crate::files::read_text;

/// All shipped effects, by name.
///
/// # Errors
/// None, as long as the build reads what it ships.
pub fn all() -> Result<Vec<Patch>, Failure> {
    models::effects()
        .iter()
        .map(|shipped| read(shipped.file, shipped.text))
        .collect()
}

/// The effect of a name or path, in the form of a name or else in all.
///
/// # Errors
/// A name that is not shipped and is no file, a file that the compiler refuses, or a form that the effect does not have.
pub fn find(effect: &str, form: Option<&str>) -> Result<Patch, Failure> {
    let patch = named(effect)?;
    let Some(form) = form else { return Ok(patch) };
    patch.in_form(form).ok_or_else(|| {
        let names: Vec<String> = patch.forms().map(|form| format!("`{form}`")).collect();
        let remedy = match names.as_slice() {
            [] => format!("leave --form out: `{effect}` has only one"),
            _ => format!("choose among {}", names.join(", ")),
        };
        let expected = format!("a form of `{effect}`");
        flag("--form", format!("`{form}`"), &expected, &remedy).into()
    })
}

fn named(effect: &str) -> Result<Patch, Failure> {
    if let Some(shipped) = models::effects().iter().find(|shipped| shipped.name == effect) {
        return read(shipped.file, shipped.text);
    }
    if effect.contains(['/', '\\', '.']) {
        return read(effect, &read_text(Path::new(effect))?);
    }
    let names: Vec<String> = models::effects()
        .iter()
        .map(|shipped| format!("`{}`", shipped.name))
        .collect();
    let remedy = format!("choose among {}, or give the path of a file", names.join(", "));
    Err(flag(
        "EFFECT",
        format!("`{effect}`"),
        "a shipped effect or an effect's file",
        &remedy,
    )
    .into())
}

fn read(name: &str, text: &str) -> Result<Patch, Failure> {
    let source = Source {
        name: name.into(),
        text: text.into(),
    };
    Patch::read(source).map_err(|report| Failure::Input(report.to_string()))
}
