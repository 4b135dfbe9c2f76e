//! Notices about sensors and ranges that a search leads to.

use qcar_runtime::campaign::Campaign;
use qcar_runtime::discover::Evidence;
use qcar_runtime::discover::answer::Discovery;
use qcar_runtime::discover::posterior::ReversedSensor;

use super::fitted::at_bound;
use crate::sensor_residuals::channel;
use crate::table::number;

/// Sensors without an offset of their own, and sensors whose sign is probably wrong.
pub(super) fn of_sensors(discovery: &Discovery, evidence: &Evidence) -> Vec<String> {
    offsets_of_the_model(discovery)
        .chain(reversed_sensors(discovery, evidence))
        .collect()
}

/// A sentence for each sensor of a record without an offset of its own, because a parameter or an initial state of the
/// model acts as one.
fn offsets_of_the_model(discovery: &Discovery) -> impl Iterator<Item = String> {
    let without = &discovery.after.refit.nuisance.without_offset;
    without.iter().map(|(sensor, own)| {
        let is_parameter = discovery.after.named.iter().any(|(name, _)| name == own);
        let what = if is_parameter {
            "the parameter"
        } else {
            "the initial value of"
        };
        format!("{sensor}: {what} `{own}` acts like an offset of this sensor, so no other offset is estimated for it")
    })
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
