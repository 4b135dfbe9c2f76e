//! Notices about sensors that a search leads to.

use qcar_runtime::discover::Evidence;
use qcar_runtime::discover::answer::Discovery;
use qcar_runtime::discover::posterior::ReversedSensor;

use crate::sensor_residuals::channel;
use crate::table::number;

/// Sensors without an offset of their own, and sensors whose sign is probably wrong.
pub(super) fn of_sensors(discovery: &Discovery, evidence: &Evidence) -> Vec<String> {
    offsets_of_the_model(discovery)
        .chain(reversed_sensors(discovery, evidence))
        .collect()
}

/// A sentence for each sensor of a record without an offset of its own, because a parameter or state of the model acts
/// as one.
fn offsets_of_the_model(discovery: &Discovery) -> impl Iterator<Item = String> {
    let without = &discovery.after.refit.nuisance.without_offset;
    without.iter().map(|(sensor, own)| {
        format!("{sensor}: `{own}` of the model is the offset of this sensor, so no other offset is estimated for it")
    })
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
