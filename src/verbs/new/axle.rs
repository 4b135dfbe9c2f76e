//! `qcar new axle`: a model file that compiles, and a parameter file beside it.

use clap::Args;
use qcar_dsl::compile::compile;
use qcar_dsl::source::Source;

use super::{Named, must_be_new};
use crate::failure::{Failure, flag};
use crate::files::{put, write_new};
use crate::terminal::word;

/// Placeholder for the name in both templates.
const PLACEHOLDER: &str = "NAME";

/// Write a model file that compiles, and a parameter file beside it
#[derive(Args)]
#[command(after_help = "Example:\n  qcar new axle city_car")]
pub(super) struct Arguments {
    #[command(flatten)]
    named: Named,
}

pub(super) fn run(arguments: &Arguments) -> Result<String, Failure> {
    let (name, dir) = (&arguments.named.name, arguments.named.folder());
    arguments.named.check()?;
    let written = |template: &str| template.replace(PLACEHOLDER, name);
    let (model, values) = (
        written(include_str!("template.axle")),
        written(include_str!("template.toml")),
    );
    refuse_words_of_the_language(name, &model)?;
    let (model_file, values_file) = (format!("{name}.axle"), format!("{name}.toml"));
    let (model_path, values_path) = (dir.join(&model_file), dir.join(&values_file));
    must_be_new(&model_path)?;
    must_be_new(&values_path)?;
    write_new(&[&model_path, &values_path], || {
        put(dir, &model_file, &model)?;
        put(dir, &values_file, &values)
    })?;
    let (model, values) = (word(&model_path), word(&values_path));
    Ok(format!(
        "{} and {} written; try\n  qcar check {model}\n  qcar frf {model} --params {values}\n",
        model_path.display(),
        values_path.display()
    ))
}

/// A template compiles, so only the name can cause an error.
fn refuse_words_of_the_language(name: &str, model: &str) -> Result<(), Failure> {
    let source = Source {
        name: format!("{name}.axle"),
        text: model.into(),
    };
    let no_files = |_: &str, path: &str| Err(format!("the template loads no file, such as {path}"));
    compile(source, &no_files).map(drop).map_err(|_| {
        let remedy = format!("write another name, such as `my_{name}`");
        flag(
            "NAME",
            format!("`{name}`"),
            "a name that is no word of the language",
            &remedy,
        )
        .into()
    })
}
