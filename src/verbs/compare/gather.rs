//! All differences between two sides.

use qcar_dsl::difference::{Difference, difference};
use qcar_runtime::campaign::{Campaign, Test};
use qcar_runtime::roles::{RoleError, Roles};

use super::Arguments;
use super::cleat_runs::{self, CleatRun};
use super::gradients::{Gradient, gradients};
use super::modes::{self, Pair};
use super::parameters::{self, Parameter};
use super::ratios::{self, Ratio};
use super::sides::{Measured, Side, sides};
use super::subject::Subject;
use crate::failure::Failure;
use crate::lines::missed;
use crate::parameters::out_of_range;
use crate::stability::unstable;
use crate::verbs::simulate::guessed;

/// A and B, and their differences.
pub(super) struct Comparison {
    /// Kind: `parameters`, `models` or `campaigns`.
    pub kind: &'static str,
    pub sides: [Side; 2],
    pub parameters: Vec<Parameter>,
    pub modes: Vec<Pair>,
    /// Differences of the models.
    pub difference: Difference,
    pub ratios: Vec<Ratio>,
    /// Kind of the cleat runs.
    pub conditions: &'static str,
    pub cleat_runs: Vec<CleatRun>,
    pub gradients: Vec<Gradient>,
    /// Parts that could not be compared, with reasons.
    pub notices: Vec<String>,
}

/// Compares two sides.
///
/// # Errors
/// Fails if A, B or the common campaign is invalid.
pub(super) fn gather(subject: &Subject, arguments: &Arguments) -> Result<Comparison, Failure> {
    let sides = sides(subject, arguments)?;
    let beside = arguments.campaign.as_ref().map(Campaign::open).transpose()?;
    let both = match &sides {
        [Side { measured: Some(a), .. }, Side { measured: Some(b), .. }] => Some([a, b]),
        _ => None,
    };
    let mut notices: Vec<String> = sides.iter().flat_map(odd_values).collect();
    notices.extend(sides.iter().filter_map(start_values));
    let ratios = all_ratios(&sides, both, beside.as_ref(), arguments, &mut notices)?;
    notices.extend(sides.iter().filter_map(|side| missed_peaks(side, &ratios)));
    let (conditions, cleat_runs) = all_cleat_runs(&sides, both, beside.as_ref(), &mut notices)?;
    Ok(Comparison {
        kind: match subject {
            Subject::Parameters(_) => "parameters",
            Subject::Models(_) => "models",
            Subject::Campaigns(_) => "campaigns",
        },
        parameters: parameters::parameters(&sides),
        modes: modes::pairs(&sides),
        difference: difference(&sides[0].compiled.model, &sides[1].compiled.model),
        ratios,
        conditions,
        cleat_runs,
        gradients: both.map(gradients).unwrap_or_default(),
        notices,
        sides,
    })
}

/// Warnings of the model of a side.
fn odd_values(side: &Side) -> Vec<String> {
    let sentences = out_of_range(side.model.about(), side.values.as_slice()).into_iter();
    sentences
        .chain(unstable(&*side.model, &side.values))
        .map(|sentence| format!("{}: {sentence}.", side.name))
        .collect()
}

/// A notice on peaks of a side that the lines of the ratios miss.
fn missed_peaks(side: &Side, ratios: &[Ratio]) -> Option<String> {
    let sentence = missed(&*side.model, &side.values, &ratios.first()?.frequency)?;
    Some(format!("{}: {sentence}.", side.name))
}

/// Notices on parameters that the fit of a campaign left at their start values: they do not describe the campaign.
fn start_values(side: &Side) -> Option<String> {
    let campaign = &side.measured.as_ref()?.campaign;
    let names = guessed(campaign, &side.model, &side.values);
    let sentence = format!(
        "{}: no rig run determines {}, which have start values.",
        side.name,
        names.join(", ")
    );
    (!names.is_empty()).then_some(sentence)
}

fn all_ratios(
    sides: &[Side; 2],
    both: Option<[&Measured; 2]>,
    beside: Option<&Campaign>,
    arguments: &Arguments,
    notices: &mut Vec<String>,
) -> Result<Vec<Ratio>, Failure> {
    let is_rig = |test: &Test| matches!(test, Test::Sweep(_) | Test::TimeHistory(_));
    let found = match (both, beside) {
        (Some(both), _) => ratios::of_campaigns(sides, both)?,
        (None, Some(campaign)) if campaign.runs.iter().any(|run| is_rig(&run.test)) => {
            ratios::of_campaign(sides, campaign)?
        }
        _ => Vec::new(),
    };
    if both.is_some() && found.is_empty() {
        notices.push("The campaigns have no rig run with the same level: only the models are compared.".into());
    }
    let modelled = || ratios::modelled(sides, &arguments.frequencies.values());
    let ratios = if found.is_empty() { modelled() } else { found };
    if ratios.is_empty() {
        notices.push("The models have no common channel, so no transmissibility is compared.".into());
    }
    let at_rest = ratios.iter().all(|ratio| ratio.run.is_none());
    let nonlinear = sides.iter().find(|side| !side.model.about().linear);
    notices.extend(nonlinear.map(|side| {
        let name = &side.model.about().name;
        match at_rest {
            true => format!(
                "{name} is nonlinear: its modes and transmissibilities are for small motions about rest. Name a \
                 campaign with --campaign to compare at the levels of its runs."
            ),
            false => format!("{name} is nonlinear: its modes are for small motions about rest."),
        }
    }));
    Ok(ratios)
}

/// Vehicle data that a rolling tyre needs.
const TYRE: [&str; 3] = ["r_tire", "static_tire_def", "static_tire_load"];

/// Vehicle data of the campaign of a side, or the common data of both.
fn roles(side: &Side, beside: Option<&Campaign>) -> Result<Roles, RoleError> {
    let own = side.measured.as_ref().map(|measured| &measured.campaign);
    let named = own.or(beside).map(|campaign| campaign.roles.clone());
    Roles::of(side.model.about(), &named.unwrap_or_default())
}

fn all_cleat_runs(
    sides: &[Side; 2],
    both: Option<[&Measured; 2]>,
    beside: Option<&Campaign>,
    notices: &mut Vec<String>,
) -> Result<(&'static str, Vec<CleatRun>), Failure> {
    let roles = match sides.each_ref().map(|side| roles(side, beside)) {
        [Ok(a), Ok(b)] => [a, b],
        [Err(error), _] | [_, Err(error)] => {
            notices.push(format!("No cleat run is compared: {error}."));
            return Ok(("", Vec::new()));
        }
    };
    let lacks = |side: &Side| TYRE.into_iter().find(|fact| !side.vehicle.facts.contains_key(*fact));
    if let Some(fact) = sides.iter().find_map(lacks) {
        notices.push(format!(
            "`{fact}` is unknown, so no cleat run is compared: name a campaign with --campaign, or add {} to [vehicle] \
             of the parameter file.",
            TYRE.join(", ")
        ));
        return Ok(("", Vec::new()));
    }
    let is_cleat = |campaign: &Campaign| campaign.runs.iter().any(|run| matches!(run.test, Test::Cleat { .. }));
    if let Some([a, b]) = both {
        let cleat_runs = cleat_runs::of_campaigns(sides, &roles, [&a.campaign, &b.campaign])?;
        if !cleat_runs.is_empty() {
            return Ok(("runs of both campaigns", cleat_runs));
        }
        notices.push(
            "The campaigns have no cleat run with the same speed and height: the standard runs are simulated.".into(),
        );
    }
    if let Some(campaign) = beside.filter(|campaign| is_cleat(campaign)) {
        return Ok((
            "runs of the campaign",
            cleat_runs::of_campaign(sides, &roles, campaign)?,
        ));
    }
    Ok(("standard runs", cleat_runs::standard(sides, &roles)?))
}
