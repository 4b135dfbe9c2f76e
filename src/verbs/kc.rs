//! `qcar kc`: gradients of the kinematics and compliance curves of a campaign, as start values of a fit.

use std::path::PathBuf;

use clap::Args;
use qcar_dsl::response::Wanted;
use qcar_runtime::campaign::{Campaign, Run, Test};
use qcar_runtime::error::{InputError, Place, Problem};
use qcar_runtime::kc::{self, Estimate, KcError, SineSamples, Slope, cycle, sines};
use qcar_runtime::progress::OnProgress;
use qcar_runtime::response::parameters::Values;
use qcar_runtime::roles::{OnRig, Roles};
use serde::Serialize;

use crate::catalogue::{self, Loaded};
use crate::failure::Failure;
use crate::json;
use crate::parameters::{self, campaign_out_of_range};
use crate::progress::while_counting;
use crate::table::{Table, noted, number, or_dash};
use crate::terminal::prose;
use crate::units;
use crate::verbs::Format;

// Start values in campaign.toml.
mod write;

/// Print stiffness, damping and friction from the K&C curves of a campaign, and its start values
///
/// A slow cycle is read over the middle half of its travel. Half the width of its loop is dry friction and the damping at
/// the speed of the rig together; sines tell them apart.
#[derive(Args)]
#[command(
    after_help = "Examples:\n  qcar kc models/campaigns/axle_a_rig\n  qcar kc models/campaigns/axle_a_rig --format json"
)]
pub struct Arguments {
    /// Folder with a campaign.toml
    campaign: PathBuf,
    /// Write the gradients to campaign.toml as start values of the parameters that they determine
    #[arg(long)]
    write: bool,
    /// Output format
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
}

/// A gradient of a K&C curve.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Gradient {
    /// File of the curve; the first file of several sines.
    #[serde(skip)]
    file: String,
    /// The parameter kind that it gives; `None` if it gives no parameter.
    #[serde(skip)]
    slope: Option<Slope>,
    /// Test: `bounce`, `dynamic_bounce` or `longitudinal`.
    pub test: &'static str,
    /// Quantity: `stiffness`, `damping`, `friction`, or `half_width` of the loop of a slow cycle.
    pub quantity: &'static str,
    /// Value, in `unit`.
    pub value: f64,
    /// One standard deviation, from the scatter of the curve and the scale of the rig.
    pub uncertainty: f64,
    /// Unit, SI.
    pub unit: &'static str,
    /// The parameter of the campaign's model that it determines.
    pub parameter: Option<String>,
    /// The value of that parameter for which the model of the campaign, with its other start values, has this gradient.
    /// It is larger than the gradient if a sub-frame yields.
    pub parameter_value: Option<f64>,
    /// Why a stiffness or damping gives no value of a parameter; `None` if it gives one.
    pub why_no_parameter_value: Option<String>,
    /// Start value of that parameter in the campaign.
    pub start: Option<f64>,
}

impl Gradient {
    /// Axis of the wheel's motion.
    fn axis(&self) -> &'static str {
        if self.test == "longitudinal" { "x" } else { "z" }
    }
}

/// Runs the verb.
pub fn run(arguments: &Arguments) -> Result<String, Failure> {
    let mut campaign = Campaign::open(&arguments.campaign)?;
    let gradients = gradients(&campaign)?;
    if arguments.write {
        write::start_values(&campaign, &gradients)?;
    }
    // Gradients need no model, so one that cannot be read gives no note.
    if let Ok((model, _)) = model(&campaign) {
        let outside = campaign_out_of_range(model.about(), &campaign);
        campaign.notices.extend(outside);
    }
    Ok(match arguments.format {
        Format::Text => prose(&(text(&gradients) + &noted(&campaign.notices))),
        Format::Json => json::line(&gradients),
    })
}

/// True if a campaign has K&C curves.
pub(crate) fn has_curves(campaign: &Campaign) -> bool {
    let is_curve = |test: &Test| matches!(test, Test::Bounce | Test::DynamicBounce { .. } | Test::Longitudinal);
    campaign.runs.iter().any(|run| is_curve(&run.test))
}

/// Gradients of all K&C runs; vertical sines are evaluated together.
///
/// # Errors
/// Fails if the campaign has no K&C curves, or if a curve has no gradient.
pub(crate) fn gradients(campaign: &Campaign) -> Result<Vec<Gradient>, InputError> {
    let mut found = while_counting(format!("{}: K&C curve", campaign.name), |on_progress| {
        of_curves(campaign, on_progress)
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
    match model(campaign) {
        Ok((model, values)) => {
            found
                .iter_mut()
                .for_each(|own| take_apart(own, campaign, &model, &values));
            let odd = found
                .iter()
                .filter_map(|own| out_of_scale(own, campaign, &model, &values));
            InputError::unless_empty(odd.collect(), Some(()))?;
        }
        Err(refused) => {
            let of_parameters = found.iter_mut().filter(|own| own.slope.is_some());
            of_parameters.for_each(|own| own.why_no_parameter_value = Some(refused.clone()));
        }
    }
    Ok(found)
}

/// Gradients of all curves, in the order of the tests.
fn of_curves(campaign: &Campaign, on_progress: OnProgress<'_>) -> Result<Vec<Gradient>, InputError> {
    let of = |wanted: fn(&Test) -> bool| campaign.runs.iter().filter(move |run| wanted(&run.test)).collect();
    let bounce: Vec<&Run> = of(|test| matches!(test, Test::Bounce));
    let dynamic: Vec<&Run> = of(|test| matches!(test, Test::DynamicBounce { .. }));
    let longitudinal: Vec<&Run> = of(|test| matches!(test, Test::Longitudinal));
    let all = bounce.len() + dynamic.len() + longitudinal.len();
    let mut found = Vec::new();
    for (done, run) in bounce.iter().enumerate() {
        on_progress(done, all);
        found.extend(quasi_static(campaign, run, "bounce")?);
    }
    on_progress(bounce.len(), all);
    if !dynamic.is_empty() {
        found.extend(vertical_sines(campaign, &dynamic)?);
    }
    for (done, run) in longitudinal.iter().enumerate() {
        on_progress(bounce.len() + dynamic.len() + done, all);
        found.extend(quasi_static(campaign, run, "longitudinal")?);
    }
    Ok(found)
}

fn quasi_static(campaign: &Campaign, run: &Run, test: &'static str) -> Result<[Gradient; 2], InputError> {
    let curve = campaign.curve(run)?;
    let cycle = cycle(&curve.displacement, &curve.force).map_err(|error| unusable(campaign, run, &error))?;
    let gradient = |of, slope| gradient((run, test), of, slope);
    Ok([
        gradient(("stiffness", cycle.stiffness, "N/m"), Some(Slope::Stiffness)),
        gradient(("half_width", cycle.half_width, "N"), None),
    ])
}

fn vertical_sines(campaign: &Campaign, runs: &[&Run]) -> Result<[Gradient; 3], InputError> {
    let curves = runs
        .iter()
        .map(|run| campaign.dynamic_curve(run))
        .collect::<Result<Vec<_>, _>>()?;
    let samples: Vec<_> = curves.iter().map(SineSamples::from).collect();
    let sine = sines(&samples).map_err(|error| unusable(campaign, runs[0], &error))?;
    let gradient = |of, slope| gradient((runs[0], "dynamic_bounce"), of, slope);
    Ok([
        gradient(("stiffness", sine.stiffness, "N/m"), None),
        gradient(("damping", sine.damping, "N s/m"), Some(Slope::Damping)),
        gradient(("friction", sine.friction, "N"), None),
    ])
}

fn gradient(
    (run, test): (&Run, &'static str),
    (quantity, of, unit): (&'static str, Estimate, &'static str),
    slope: Option<Slope>,
) -> Gradient {
    Gradient {
        file: run.name.clone(),
        slope,
        test,
        quantity,
        value: of.value,
        uncertainty: of.uncertainty(),
        unit,
        parameter: None,
        parameter_value: None,
        why_no_parameter_value: None,
        start: None,
    }
}

/// The model of the campaign with its start values, or why there is none. Curves can be read without a model.
fn model(campaign: &Campaign) -> Result<(Loaded, Values), String> {
    let refused = |failure: Failure| failure.to_string().trim_end().to_string();
    let model = catalogue::of_campaign(campaign, None, Wanted::Values).map_err(refused)?;
    let values = parameters::resolve(model.about(), [campaign.manifest().as_path()], &[]);
    let values = values.map_err(|error| refused(error.into()))?;
    model
        .check_inertias(values.as_slice())
        .map_err(|error| refused(error.into()))?;
    Ok((model, values))
}

/// Determines from the model which parameter a gradient gives, and its value, if that is not known yet.
pub(crate) fn take_apart(gradient: &mut Gradient, campaign: &Campaign, model: &Loaded, values: &Values) {
    let Some(slope) = gradient.slope else { return };
    let roles = Roles::of(model.about(), &campaign.roles).and_then(|roles| roles.on_rig());
    let answer = roles
        .map_err(|error| error.to_string())
        .and_then(|on| parameter_value(gradient, (&on, gradient.axis(), slope), model, values));
    match answer {
        Ok((parameter, value)) => {
            gradient.start = campaign.parameter(&parameter).map(|own| own.value);
            gradient.parameter = Some(parameter);
            gradient.parameter_value = value.as_ref().ok().copied();
            gradient.why_no_parameter_value = value.err();
        }
        Err(why) => {
            gradient.parameter_value = None;
            gradient.why_no_parameter_value = Some(why);
        }
    }
}

/// The parameter, and its value or why no value gives the measured gradient.
///
/// # Errors
/// Why the gradient determines no parameter of this model.
fn parameter_value(
    gradient: &Gradient,
    asked: (&OnRig, &str, Slope),
    model: &Loaded,
    values: &Values,
) -> Result<(String, Result<f64, String>), String> {
    let (on, axis, _) = asked;
    let about = model.about();
    let known = gradient.parameter.as_ref();
    let known = known.and_then(|name| about.parameters.iter().position(|own| own.name == *name));
    let place = known.or_else(|| kc::parameter_for(&**model, values, asked));
    let place = place.ok_or_else(|| {
        format!(
            "model {} has no parameter between `{}` and the parts linked to it that determines its {} along {axis} while `{}` is held",
            about.name, on.wheel, gradient.quantity, on.body
        )
    })?;
    let name = about.parameters[place].name.to_string();
    let value = kc::value_for(&**model, values, place, asked, gradient.value);
    let value = value.ok_or_else(|| {
        let (curve, quantity) = (gradient.test, gradient.quantity);
        format!(
            "with no `{name}` in its range model {} has the {quantity} of the {curve} curve while `{}` is held",
            about.name, on.body
        )
    });
    Ok((name, value))
}

/// Largest ratio of a gradient to that of the model at its start values; beyond it a unit is wrong.
const SCALE: f64 = 100.0;

/// Problem of a curve whose gradient is of another order of magnitude than that of the model.
fn out_of_scale(gradient: &Gradient, campaign: &Campaign, model: &Loaded, values: &Values) -> Option<Problem> {
    let on = Roles::of(model.about(), &campaign.roles)
        .and_then(|roles| roles.on_rig())
        .ok()?;
    let (p, name) = (values.as_slice(), gradient.parameter.as_ref()?);
    let expected = kc::gradient(&**model, p, &on, gradient.axis(), gradient.slope?)?;
    let ratio = gradient.value / expected;
    if (1.0 / SCALE..=SCALE).contains(&ratio) {
        return None;
    }
    let Gradient { quantity, unit, .. } = gradient;
    Some(Problem::new(
        campaign.folder.join(&gradient.file),
        Place::File,
        format!("a {quantity} of {} {unit}", number(gradient.value, 3)),
        format!(
            "about {} {unit}, that of the model at its start values",
            number(expected, 3)
        ),
        format!("write displacements in m, velocities in m/s and forces in N, or correct the start value of `{name}`"),
    ))
}

fn unusable(campaign: &Campaign, run: &Run, error: &KcError) -> InputError {
    let file = campaign.folder.join(&run.file);
    Problem::new(
        file,
        Place::File,
        error.to_string(),
        error.expected(),
        "correct the columns, record it again, or leave the run out",
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
        let shown = |value| units::value(value, gradient.unit);
        table.row(vec![
            gradient.test.into(),
            gradient.quantity.into(),
            units::name(gradient.unit).into(),
            number(shown(gradient.value), 4),
            number(shown(gradient.uncertainty), 2),
            gradient.parameter.as_deref().unwrap_or("-").into(),
            or_dash(gradient.parameter_value.map(shown), 4),
            or_dash(gradient.start.map(shown), 4),
        ]);
    }
    let is_wide = of.iter().any(|gradient| gradient.quantity == "half_width");
    let loops = if is_wide { HALF_WIDTH } else { "" };
    table.text() + &notes(of) + loops
}

/// What the half width of a loop contains.
const HALF_WIDTH: &str = "note: half_width is that of the loop of a slow cycle: dry friction and the damping at the speed \
                          of the rig, which sines of dynamic_bounce tell apart\n";

/// Each reason once, with the parameters (or the gradients without a parameter) that have no value because of it.
fn notes(of: &[Gradient]) -> String {
    let mut reasons: Vec<(&str, Vec<String>)> = Vec::new();
    for gradient in of {
        let Some(why) = &gradient.why_no_parameter_value else {
            continue;
        };
        let unnamed = || format!("the {} {}", gradient.test, gradient.quantity);
        let name = gradient.parameter.clone().unwrap_or_else(unnamed);
        match reasons.iter_mut().find(|(reason, _)| reason == why) {
            Some((_, names)) => names.push(name),
            None => reasons.push((why, vec![name])),
        }
    }
    let note =
        |(why, names): &(&str, Vec<String>)| format!("note: no parameter_value of {}: {why}\n", names.join(", "));
    reasons.iter().map(note).collect()
}
