//! `qcar kc`: gradients of the kinematics and compliance curves of a campaign, as start values of a fit.

use std::path::PathBuf;

use clap::Args;
use qcar_runtime::campaign::{Campaign, Run, Test};
use qcar_runtime::error::{InputError, Place, Problem};
use qcar_runtime::kc::{self, Estimate, KcError, SineSamples, Slope, cycle, sines};
use qcar_runtime::progress::Told;
use qcar_runtime::response::parameters::Values;
use serde::Serialize;

use crate::catalogue::{self, Loaded};
use crate::failure::Failure;
use crate::json;
use crate::parameters;
use crate::progress::while_counting;
use crate::table::{Table, number, or_dash};
use crate::verbs::Format;

// Start values in campaign.toml.
mod write;

/// Print stiffness, damping and friction from the K&C curves of a campaign, beside its start values
#[derive(Args)]
#[command(
    after_help = "Examples:\n  qcar kc models/campaigns/axle_a_rig\n  qcar kc models/campaigns/axle_a_rig --format json"
)]
pub struct Arguments {
    /// Folder with a campaign.toml
    campaign: PathBuf,
    /// Put the gradients into campaign.toml as start values of the parameters they stand for
    #[arg(long)]
    write: bool,
    /// How to print
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
}

/// What a curve says.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Gradient {
    /// `bounce`, `dynamic_bounce` or `longitudinal`.
    pub test: &'static str,
    /// `stiffness`, `damping` or `friction`.
    pub quantity: &'static str,
    /// In `unit`.
    pub value: f64,
    /// One standard deviation, from the scatter of the curve and the scale of the rig.
    pub uncertainty: f64,
    /// SI.
    pub unit: &'static str,
    /// The parameter of the thesis's table 3.1 that it measures.
    pub parameter: Option<&'static str>,
    /// The value of that parameter with which the campaign's model has this gradient, its others at their start values:
    /// larger than the gradient where a sub-frame yields.
    pub parameter_value: Option<f64>,
    /// Why that is not known of a gradient that has a parameter.
    pub why_no_parameter_value: Option<String>,
    /// The campaign's start value of that parameter.
    pub start: Option<f64>,
}

/// Does it.
pub fn run(arguments: &Arguments) -> Result<String, Failure> {
    let campaign = Campaign::open(&arguments.campaign)?;
    let gradients = gradients(&campaign)?;
    if arguments.write {
        write::start_values(&campaign, &gradients)?;
    }
    Ok(match arguments.format {
        Format::Text => text(&gradients),
        Format::Json => json::line(&gradients),
    })
}

/// True where a campaign has K&C curves.
pub(crate) fn has_curves(campaign: &Campaign) -> bool {
    let is_curve = |test: &Test| matches!(test, Test::Bounce | Test::DynamicBounce { .. } | Test::Longitudinal);
    campaign.runs.iter().any(|run| is_curve(&run.test))
}

/// Gradients of all K&C runs; vertical sines are taken together.
///
/// # Errors
/// A campaign without K&C curves, and a curve without gradients.
pub(crate) fn gradients(campaign: &Campaign) -> Result<Vec<Gradient>, InputError> {
    let mut found = while_counting(format!("{}: K&C curve", campaign.name), |told| {
        of_curves(campaign, told)
    })?;
    if found.is_empty() {
        let expected = "a run of kind bounce, dynamic_bounce or longitudinal";
        let remedy = "list the K&C curves as runs";
        return Err(Problem::new(
            campaign.manifest(),
            Place::Name("run".into()),
            "no K&C curve",
            expected,
            remedy,
        )
        .into());
    }
    let asked = model(campaign);
    let of_parameters = found.iter_mut().filter(|gradient| gradient.parameter.is_some());
    of_parameters.for_each(|gradient| match &asked {
        Ok((model, values)) => take_apart(gradient, model, values),
        Err(refused) => gradient.why_no_parameter_value = Some(refused.clone()),
    });
    Ok(found)
}

/// Those of all curves, in the order of the tests.
fn of_curves(campaign: &Campaign, told: Told<'_>) -> Result<Vec<Gradient>, InputError> {
    let of = |wanted: fn(&Test) -> bool| campaign.runs.iter().filter(move |run| wanted(&run.test)).collect();
    let bounce: Vec<&Run> = of(|test| matches!(test, Test::Bounce));
    let dynamic: Vec<&Run> = of(|test| matches!(test, Test::DynamicBounce { .. }));
    let longitudinal: Vec<&Run> = of(|test| matches!(test, Test::Longitudinal));
    let all = bounce.len() + dynamic.len() + longitudinal.len();
    let mut found = Vec::new();
    for (done, run) in bounce.iter().enumerate() {
        told(done, all);
        found.extend(quasi_static(campaign, run, "bounce", "k_wheel_z")?);
    }
    told(bounce.len(), all);
    if !dynamic.is_empty() {
        found.extend(vertical_sines(campaign, &dynamic)?);
    }
    for (done, run) in longitudinal.iter().enumerate() {
        told(bounce.len() + dynamic.len() + done, all);
        found.extend(quasi_static(campaign, run, "longitudinal", "k_wheel_x")?);
    }
    Ok(found)
}

fn quasi_static(
    campaign: &Campaign,
    run: &Run,
    test: &'static str,
    parameter: &'static str,
) -> Result<Vec<Gradient>, InputError> {
    let curve = campaign.curve(run)?;
    let cycle = cycle(&curve.displacement, &curve.force).map_err(|error| unusable(campaign, run, &error))?;
    let gradient = |quantity, of: Estimate, unit, parameter| gradient(campaign, test, quantity, of, unit, parameter);
    Ok(vec![
        gradient("stiffness", cycle.stiffness, "N/m", Some(parameter)),
        gradient("friction", cycle.friction, "N", None),
    ])
}

fn vertical_sines(campaign: &Campaign, runs: &[&Run]) -> Result<Vec<Gradient>, InputError> {
    let curves = runs
        .iter()
        .map(|run| campaign.dynamic_curve(run))
        .collect::<Result<Vec<_>, _>>()?;
    let samples: Vec<_> = curves.iter().map(SineSamples::from).collect();
    let sine = sines(&samples).map_err(|error| unusable(campaign, runs[0], &error))?;
    let gradient =
        |quantity, of: Estimate, unit, parameter| gradient(campaign, "dynamic_bounce", quantity, of, unit, parameter);
    Ok(vec![
        gradient("stiffness", sine.stiffness, "N/m", None),
        gradient("damping", sine.damping, "N s/m", Some("c_wheel_z")),
        gradient("friction", sine.friction, "N", None),
    ])
}

fn gradient(
    campaign: &Campaign,
    test: &'static str,
    quantity: &'static str,
    of: Estimate,
    unit: &'static str,
    parameter: Option<&'static str>,
) -> Gradient {
    let start = parameter
        .and_then(|name| campaign.parameter(name))
        .map(|parameter| parameter.value);
    Gradient {
        test,
        quantity,
        value: of.value,
        uncertainty: of.uncertainty(),
        unit,
        parameter,
        parameter_value: None,
        why_no_parameter_value: None,
        start,
    }
}

/// What is clamped on a K&C rig.
const CLAMPED: &str = "body";

/// The campaign's model with its start values, or why there is none: curves can be read without.
fn model(campaign: &Campaign) -> Result<(Loaded, Values), String> {
    let refused = |failure: Failure| failure.to_string().trim_end().to_string();
    let model = catalogue::of_campaign(campaign, None).map_err(refused)?;
    let values = parameters::resolve(model.about(), [campaign.manifest().as_path()], &[]);
    let values = values.map_err(|error| refused(error.into()))?;
    model
        .check_inertias(values.as_slice())
        .map_err(|error| refused(error.into()))?;
    Ok((model, values))
}

/// Asks the model what the parameter of a gradient must be for it to have that.
pub(crate) fn take_apart(gradient: &mut Gradient, model: &Loaded, values: &Values) {
    let answer = parameter_value(gradient, model, values);
    gradient.parameter_value = answer.as_ref().ok().copied();
    gradient.why_no_parameter_value = answer.err();
}

fn parameter_value(gradient: &Gradient, model: &Loaded, values: &Values) -> Result<f64, String> {
    let axis = if gradient.test == "longitudinal" { "x" } else { "z" };
    let slope = if gradient.quantity == "damping" {
        Slope::Damping
    } else {
        Slope::Stiffness
    };
    let (about, name) = (model.about(), gradient.parameter.unwrap_or_default());
    let place = about.parameters.iter().position(|own| own.name == name);
    let place = place.ok_or_else(|| format!("model {} has no `{name}`", about.name))?;
    let value = kc::value_for(&**model, values, place, (CLAMPED, axis, slope), gradient.value);
    value.ok_or_else(|| {
        let (curve, quantity) = (gradient.test, gradient.quantity);
        format!(
            "no `{name}` within its range gives model {} the {quantity} of the {curve} curve with its {CLAMPED} held",
            about.name
        )
    })
}

fn unusable(campaign: &Campaign, run: &Run, error: &KcError) -> InputError {
    let file = campaign.folder.join(&run.file);
    Problem::new(
        file,
        Place::File,
        error.to_string(),
        "a curve with gradients",
        "record it again, or leave the run out",
    )
    .into()
}

fn text(of: &[Gradient]) -> String {
    let mut table = Table::new([
        "test",
        "quantity",
        "unit",
        "value",
        "uncertainty",
        "parameter",
        "parameter_value",
        "start",
    ]);
    for gradient in of {
        table.row(vec![
            gradient.test.into(),
            gradient.quantity.into(),
            gradient.unit.into(),
            number(gradient.value, 4),
            number(gradient.uncertainty, 2),
            gradient.parameter.unwrap_or("-").into(),
            or_dash(gradient.parameter_value, 4),
            or_dash(gradient.start, 4),
        ]);
    }
    table.text() + &notes(of)
}

/// Each reason once, with the parameters that have no value by it.
fn notes(of: &[Gradient]) -> String {
    let mut reasons: Vec<(&str, Vec<&str>)> = Vec::new();
    for gradient in of {
        let (Some(why), Some(name)) = (&gradient.why_no_parameter_value, gradient.parameter) else {
            continue;
        };
        match reasons.iter_mut().find(|(reason, _)| reason == why) {
            Some((_, names)) => names.push(name),
            None => reasons.push((why, vec![name])),
        }
    }
    let note = |(why, names): &(&str, Vec<&str>)| format!("note: no parameter_value of {}: {why}\n", names.join(", "));
    reasons.iter().map(note).collect()
}
