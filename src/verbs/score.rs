//! `qcar score`: fits campaigns with known parameters, and compares.

use std::fs;
use std::path::{Path, PathBuf};

use clap::Args;
use qcar_dsl::response::Wanted;
use qcar_runtime::campaign::{Campaign, Truth};
use qcar_runtime::error::{InputError, Place, Problem};
use qcar_runtime::fit::report::{ChannelFit, ParameterFit};

use crate::catalogue;
use crate::failure::Failure;
use crate::interruption::keep;
use crate::parameters::{self, campaign_out_of_range};
use crate::table::{Table, noted, number, or_dash};
use crate::terminal::prose;
use crate::units;
use crate::verbs::fit::{self, Choices, Fitted};

/// A standard error below this share of the value counts as well determined.
const WELL_DETERMINED: f64 = 0.02;

/// Fit campaigns whose true parameters are known (truth.toml), and compare
///
/// The exit status is 1 if a well determined parameter (standard error below 2 %) has a larger error than allowed.
#[derive(Args)]
#[command(after_help = "Example:\n  qcar score models/campaigns")]
pub struct Arguments {
    /// Campaign folders, or folders of campaigns
    #[arg(required = true)]
    folders: Vec<PathBuf>,
    /// Allowed error of a well determined parameter, in percent
    #[arg(long, value_name = "PERCENT", default_value = "3", value_parser = percent, allow_hyphen_values = true)]
    within: f64,
}

/// An allowed error, written as percent.
fn percent(text: &str) -> Result<f64, String> {
    let number = text.trim().trim_end_matches('%').trim_end().parse::<f64>().ok();
    let number = number.filter(|number| number.is_finite() && *number >= 0.0);
    number.ok_or_else(|| format!("expected percent, zero or more, such as 3, found `{text}`"))
}

/// Runs the verb.
pub fn run(arguments: &Arguments) -> Result<String, Failure> {
    let mut reports = String::new();
    let mut all_well = true;
    for folder in campaigns(&arguments.folders)? {
        let answer = folder.join("truth.toml");
        let truth = Truth::read(&answer)?;
        refuse_unknown(&folder, &answer)?;
        let fitted = fit::fit(&folder, &Choices::default())?;
        let (text, well) = compare(&fitted, &truth, arguments.within);
        let text = if reports.is_empty() { text } else { format!("\n{text}") };
        keep(&text);
        reports += &text;
        all_well &= well;
    }
    let text = prose(&reports);
    if all_well {
        Ok(text)
    } else {
        Err(Failure::Finding(text))
    }
}

/// Checks that the model of a campaign has every parameter in the file of its true values: a misspelt one would be
/// compared with nothing.
fn refuse_unknown(campaign: &Path, truth: &Path) -> Result<(), Failure> {
    let model = catalogue::of_campaign(&Campaign::open(campaign)?, None, Wanted::Nothing)?;
    parameters::stated(model.about(), Some(truth), &[])?;
    Ok(())
}

/// The folders with a truth.toml: the given ones, or their subfolders in alphabetical order.
fn campaigns(named: &[PathBuf]) -> Result<Vec<PathBuf>, InputError> {
    let mut found = Vec::new();
    for folder in named {
        let before = found.len();
        let entries = fs::read_dir(folder).map_err(|error| nothing_in(folder, &error.to_string()))?;
        let mut below: Vec<_> = entries.flatten().map(|entry| entry.path()).collect();
        below.sort();
        below.insert(0, folder.clone());
        found.extend(below.into_iter().filter(|folder| has_answer(folder)));
        if found.len() == before {
            return Err(nothing_in(folder, "no campaign with a truth.toml"));
        }
    }
    Ok(found)
}

fn has_answer(folder: &Path) -> bool {
    folder.join("campaign.toml").is_file() && folder.join("truth.toml").is_file()
}

fn nothing_in(folder: &Path, found: &str) -> InputError {
    Problem::new(
        folder,
        Place::File,
        found,
        "a campaign with a truth.toml, or a folder of such",
        "name another folder",
    )
    .into()
}

fn compare(of: &Fitted, truth: &Truth, within: f64) -> (String, bool) {
    let mut table = Table::new(["parameter", "unit", "truth", "value", "error_%", "stderr_%", "verdict"]);
    let mut well = true;
    for parameter in of.fit.parameters.iter().filter(|parameter| parameter.fitted) {
        let Some((_, true_value)) = truth.parameters.iter().find(|(name, _)| *name == parameter.name) else {
            continue;
        };
        let error = 100.0 * (parameter.value / true_value - 1.0);
        let verdict = verdict(parameter, error, within);
        well &= verdict != "off";
        let stderr = or_dash(parameter.relative_stderr.map(|part| 100.0 * part), 2);
        let shown = |value| number(units::value(value, &parameter.unit), 5);
        let numbers = [
            units::name(&parameter.unit).into(),
            shown(*true_value),
            shown(parameter.value),
            format!("{error:.2}"),
            stderr,
        ];
        table.row(
            [parameter.name.clone()]
                .into_iter()
                .chain(numbers)
                .chain([verdict.to_string()])
                .collect(),
        );
    }
    let mut text = format!("{}\n{}", heading(of, truth), table.text());
    if !of.fit.channels.is_empty() {
        text += &format!("\n{}", channels(&of.fit.channels));
    }
    text += &noted(&campaign_out_of_range(of.model.about(), &of.campaign));
    (text, well)
}

fn verdict(parameter: &ParameterFit, error: f64, within: f64) -> &'static str {
    match parameter.relative_stderr {
        Some(part) if part < WELL_DETERMINED && error.abs() <= within => "well",
        Some(part) if part < WELL_DETERMINED => "off",
        _ => "not determined",
    }
}

fn heading(of: &Fitted, truth: &Truth) -> String {
    let effects: Vec<_> = truth
        .effects
        .iter()
        .map(|effect| format!("{} at {}", effect.name, effect.at))
        .collect();
    let effects = if effects.is_empty() {
        "nothing".into()
    } else {
        effects.join(", ")
    };
    format!(
        "{}: {} lacks {effects}; {:.1} s\n",
        of.campaign.name, of.fit.model, of.seconds
    )
}

fn channels(of: &[ChannelFit]) -> String {
    let mut table = Table::new(["channel", "role", "run", "fit_magnitude_%", "fit_phase_%"]);
    for channel in of {
        let quality = [channel.quality.fit_magnitude, channel.quality.fit_phase].map(|percent| format!("{percent:.1}"));
        let place = [channel.name.to_string(), channel.role.to_string(), channel.run.clone()];
        table.row(place.into_iter().chain(quality).collect());
    }
    table.text()
}
