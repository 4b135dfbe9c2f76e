//! `qcar effects`: the catalogue of effects that a model may lack.

mod description;

use clap::Args;
use clap_complete::engine::ArgValueCompleter;
use serde::Serialize;

use crate::catalogue;
use crate::completion;
use crate::effects;
use crate::failure::Failure;
use crate::json;
use crate::table::Table;
use crate::terminal::prose;
use crate::verbs::Format;
use description::EffectDescription;
use qcar_dsl::response::Wanted;

/// List the effects that a model may lack, and where each applies
///
/// Without an argument, the whole catalogue is listed. For an effect, its forms and parameters are described.
#[derive(Args)]
#[command(
    after_help = "Examples:\n  qcar effects\n  qcar effects axle_c\n  qcar effects coulomb_friction --format json"
)]
pub struct Arguments {
    /// Name of a shipped model or effect, or path of a file of either
    #[arg(value_name = "MODEL_OR_EFFECT", add = ArgValueCompleter::new(completion::models_and_effects))]
    name: Option<String>,
    /// Output format
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
}

/// Runs the verb.
pub fn run(arguments: &Arguments) -> Result<String, Failure> {
    let Some(name) = &arguments.name else {
        return catalogue(arguments.format);
    };
    match effects::of_name(name) {
        Some(effect) => {
            let described = EffectDescription::of(&effect?);
            Ok(match arguments.format {
                Format::Text => prose(&described.text()),
                Format::Json => json::line(&described),
            })
        }
        None => places(name, arguments.format),
    }
}

fn catalogue(format: Format) -> Result<String, Failure> {
    let all = effects::all()?;
    if let Format::Json = format {
        return Ok(json::line(&all.iter().map(EffectDescription::of).collect::<Vec<_>>()));
    }
    let mut table = Table::new(["effect", "what it is", "how it shows"]);
    for patch in all {
        let effect = patch.effect();
        table.row(vec![effect.name.text.clone(), effect.doc.clone(), effect.shows.clone()]);
    }
    Ok(table.text())
}

/// An effect with the places of a model where it applies.
#[derive(Serialize)]
struct Applies {
    name: String,
    places: Vec<String>,
}

fn places(model: &str, format: Format) -> Result<String, Failure> {
    let compiled = catalogue::compiled_wanted(model, Wanted::Nothing)?;
    let all = effects::all()?;
    let applies = all.iter().map(|patch| Applies {
        name: patch.effect().name.text.clone(),
        places: patch.places(&compiled.model),
    });
    let applies: Vec<Applies> = applies.filter(|own| !own.places.is_empty()).collect();
    if let Format::Json = format {
        return Ok(json::line(&applies));
    }
    let mut table = Table::new(["effect", "places"]);
    for own in applies {
        table.row(vec![own.name, own.places.join(", ")]);
    }
    Ok(table.text())
}
