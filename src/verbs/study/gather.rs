//! Runs all verbs on one campaign; each writes its files as soon as it is done.

use std::path::Path;
use std::time::Instant;

use qcar_dsl::response::Wanted;
use qcar_dsl::schedule::Compiled;
use qcar_runtime::campaign::{Campaign, Test};
use qcar_runtime::discover::numbers::Numbers;
use qcar_runtime::error::InputError;
use qcar_runtime::response::parameters::Values;
use qcar_runtime::roles::Roles;
use qcar_runtime::simulate::{Cleat, Variant};

use crate::catalogue::{self, Loaded};
use crate::failure::Failure;
use crate::files::put;
use crate::histories::Kind;
use crate::json;
use crate::verbs::discover::{self, Answer};
use crate::verbs::fit::{self, Choices, Fitted};
use crate::verbs::kc::{self, Gradient};
use crate::verbs::simulate::{self, CleatResults};

/// Subfolders of the steps: the fit, the K&C curves, the search, and the cleat runs.
pub(super) const FIT: &str = "fit";
pub(super) const CURVES: &str = "kc";
pub(super) const DISCOVERY: &str = "discovery";
pub(super) const TRACK: &str = "cleat";
/// The gradients of the curves, and the errors of the cleat runs.
pub(super) const GRADIENTS: &str = "gradients.json";
pub(super) const ERRORS: &str = "errors.csv";

/// Results of all verbs for a campaign.
pub struct Study {
    /// The campaign, its model, and the fit.
    pub fitted: Fitted,
    /// The model of the compiler.
    pub compiled: Compiled,
    /// Gradients of the K&C curves; empty without any.
    pub gradients: Vec<Gradient>,
    /// Result of the discovery.
    pub answer: Answer,
    /// The extended model; `None` without findings in the model.
    pub after: Option<After>,
    /// The cleat runs; `None` without any.
    pub track: Option<Track>,
    /// Duration, s.
    pub seconds: f64,
}

/// The extended model.
pub struct After {
    /// The model, ready to run.
    pub model: Loaded,
    /// The model of the compiler.
    pub compiled: Compiled,
    /// Its parameters.
    pub values: Values,
}

/// The cleat runs, simulated with each model and variant.
pub struct Track {
    /// Measured runs.
    pub cleats: Vec<Cleat>,
    /// The fitted model.
    pub before: CleatResults,
    /// Its parameters that the fit has left at their start values.
    pub at_start: Vec<String>,
    /// The extended model.
    pub after: Option<CleatResults>,
    /// The better of both without longitudinal motion.
    pub locked: CleatResults,
    /// The same with a point contact.
    pub vertical: CleatResults,
}

/// Runs all verbs; their files are in subfolders of `out`.
///
/// # Errors
/// Fails as the verbs do.
pub fn gather(folder: &Path, model: Option<&str>, out: &Path) -> Result<Study, Failure> {
    let begun = Instant::now();
    let fitted = fit::fit(folder, &Choices::of_model(model))?;
    fit::files::write(&fitted, &out.join(FIT))?;
    let campaign = &fitted.campaign;
    let gradients = gradients(campaign, out)?;
    let discovery = out.join(DISCOVERY);
    let mut answer = discover::answer(campaign, model, Some(&discovery), Numbers::default())?;
    discover::write(&mut answer, &discovery)?;
    let after = after(campaign, &answer)?;
    let track = track(&fitted, after.as_ref(), out)?;
    Ok(Study {
        compiled: catalogue::compiled_of_campaign(campaign, model, Wanted::Jacobian)?,
        seconds: begun.elapsed().as_secs_f64(),
        gradients,
        answer,
        after,
        track,
        fitted,
    })
}

fn gradients(campaign: &Campaign, out: &Path) -> Result<Vec<Gradient>, InputError> {
    if !kc::has_curves(campaign) {
        return Ok(Vec::new());
    }
    let gradients = kc::gradients(campaign)?;
    put(&out.join(CURVES), GRADIENTS, &json::line(&gradients))?;
    Ok(gradients)
}

/// The extended model file, read like any other.
fn after(campaign: &Campaign, answer: &Answer) -> Result<Option<After>, Failure> {
    let file = answer.model.as_ref().and_then(|model| model.file.as_ref());
    let Some(file) = file.map(|file| file.display().to_string()) else {
        return Ok(None);
    };
    let (model, compiled) = catalogue::load_and_compile(&file, Wanted::Jacobian)?;
    let named = answer.discovery.after.named.iter().cloned().collect();
    let vehicle = campaign.vehicle.iter().cloned().collect();
    let values = Values::resolve(model.about(), &named, &vehicle).expect("the search has given every parameter");
    Ok(Some(After {
        compiled,
        model,
        values,
    }))
}

fn track(fitted: &Fitted, after: Option<&After>, out: &Path) -> Result<Option<Track>, Failure> {
    let campaign = &fitted.campaign;
    let is_cleat = |test: &Test| matches!(test, Test::Cleat { .. });
    let rolls = Roles::of(fitted.model.about(), &campaign.roles).is_ok();
    if !rolls || !campaign.runs.iter().any(|run| is_cleat(&run.test)) {
        return Ok(None);
    }
    let cleats = simulate::cleats(campaign)?;
    let values = fitted.values();
    let best = after.map_or((&fitted.model, &values), |after| (&after.model, &after.values));
    let drive =
        |(model, values): (&Loaded, &Values), variant| simulate::drive(campaign, model, values, &cleats, variant);
    let track = Track {
        before: drive((&fitted.model, &values), Variant::Complete)?,
        at_start: simulate::guessed(campaign, &fitted.model, &values),
        after: after.map(|_| drive(best, Variant::Complete)).transpose()?,
        locked: drive(best, Variant::LongitudinallyLocked)?,
        vertical: drive(best, Variant::PureVertical)?,
        cleats,
    };
    let (about, driven) = (best.0.about(), track.after.as_ref().unwrap_or(&track.before));
    let folder = out.join(TRACK);
    let names = simulate::names::FileNames::of(campaign);
    for history in simulate::render::histories(about, &names, &track.cleats, &driven.rides) {
        history.put(&folder, Kind::Csv)?;
    }
    put(&folder, ERRORS, &simulate::render::csv(&driven.compared))?;
    Ok(Some(track))
}
