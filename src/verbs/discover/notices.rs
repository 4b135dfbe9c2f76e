//! Notices about sensors and ranges that a search leads to.

use qcar_runtime::campaign::Campaign;
use qcar_runtime::discover::Evidence;
use qcar_runtime::discover::answer::Discovery;
use qcar_runtime::discover::posterior::ReversedSensor;
use qcar_runtime::model::{About, StateKind};

use super::fitted::at_bound;
use crate::sensor_residuals::channel;
use crate::table::number;

/// Sensors without an offset of their own, and sensors whose sign is probably wrong.
pub(super) fn of_sensors(discovery: &Discovery, evidence: &Evidence, about: &About) -> Vec<String> {
    offsets_of_the_model(discovery, about)
        .chain(reversed_sensors(discovery, evidence))
        .collect()
}

/// A sentence for each sensor of a record without an offset of its own, because a parameter or an initial state of the
/// model acts as one.
fn offsets_of_the_model(discovery: &Discovery, about: &About) -> impl Iterator<Item = String> {
    let without = &discovery.after.refit.nuisance.without_offset;
    without.iter().map(|(sensor, own)| {
        let is_parameter = discovery.after.named.iter().any(|(name, _)| name == own);
        let what = if is_parameter {
            format!("the parameter `{own}`")
        } else {
            initial_state(own, about)
        };
        format!("{sensor}: {what} acts like an offset of this sensor, so no other offset is estimated for it")
    })
}

/// A state of a model or, with an effect of the answer, of another at the beginning of a record, in words.
fn initial_state(name: &str, about: &About) -> String {
    let state = about.states.iter().find(|own| own.name == name);
    let quantity = state.and_then(|own| match own.kind {
        StateKind::Position => Some(("position", own)),
        StateKind::Velocity => Some(("velocity", own)),
        StateKind::Inner => None,
    });
    match quantity {
        Some((quantity, own)) => format!("the initial {quantity} of `{}` along {}", own.location, own.axis),
        None => format!("the initial value of `{name}`"),
    }
}

/// A sentence for each parameter of the campaign that is at an end of its range only without the effects of the answer:
/// they may make up for a range that excludes the true value.
pub(super) fn on_ranges(discovery: &Discovery, campaign: &Campaign) -> Vec<String> {
    let after: Vec<(String, &str)> = at_bound(&discovery.after).collect();
    let is_own = |(name, _): &(String, &str)| campaign.parameters.iter().any(|own| own.name == *name);
    let is_gone = |own: &(String, &str)| !discovery.findings.is_empty() && !after.contains(own);
    let gone = at_bound(&discovery.before).filter(|own| is_own(own) && is_gone(own));
    let sentence = |(name, end): (String, &str)| {
        format!(
            "without effects {name} is at the {end} end of its range: if that excludes the true value, an effect may only \
             make up for it"
        )
    };
    gone.map(sentence).collect()
}

/// A sentence for each sensor whose sign is probably wrong.
fn reversed_sensors(discovery: &Discovery, evidence: &Evidence) -> impl Iterator<Item = String> {
    let sentence = |own: ReversedSensor<'_>| {
        let [as_measured, reversed] = [own.as_measured, own.reversed].map(|value| number(value, 2));
        format!(
            "{}: the residual is {as_measured} standard deviations, and {reversed} with the opposite sign: check how the \
             sensor is mounted, and write `sign = -1` at its channel",
            channel(own.sensor)
        )
    };
    let sensors = discovery.before.misfit.reversed_sensors(evidence);
    sensors.into_iter().map(sentence)
}
