//! Sensors of a campaign that do not measure what a model has.

use qcar_runtime::campaign::{Campaign, Channel, Side, dimension};
use qcar_runtime::discover::observe::{is_known, nearest_place, signal_of};
use qcar_runtime::error::{Place, Problem};
use qcar_runtime::model::{About, Output};
use qcar_runtime::response::signal::output_of;
use qcar_runtime::transmissibility::Point;

/// The sensors at places that the model lacks, as sentences.
pub fn unknown(about: &About, campaign: &Campaign) -> Vec<String> {
    let unknown = campaign
        .channels
        .iter()
        .filter(|own| !points(own).any(|point| is_known(about, &point)));
    let say = |own: &Channel| {
        let (location, quantity, axis) = (&own.location, own.quantity.name(), own.axis.name());
        let (channel, model) = (&own.name, &about.name);
        let point = Point::of(own);
        let remedy = match nearest_place(about, &point) {
            Some(nearest) => format!("did you mean `{nearest}`?"),
            None => format!(
                "if it should, add `output {location}.{};` to the model",
                point.kind(about).word()
            ),
        };
        format!(
            "channel `{channel}`: model `{model}` gives no {quantity} of `{location}` along {axis}, so nothing is compared with \
             it; {remedy}"
        )
    };
    unknown.map(say).collect()
}

/// A problem for each sensor whose unit is of another kind than that of the model, such as an acceleration of a mass
/// that turns.
pub fn of_other_units(about: &About, campaign: &Campaign) -> Vec<Problem> {
    let wrong = campaign
        .channels
        .iter()
        .filter_map(|own| Some((own, in_other_unit(about, own)?)));
    wrong
        .map(|(own, (output, unit_of_model))| {
            let place = Place::Name(format!("channel {}", own.name));
            let (quantity, unit) = (own.quantity.name(), own.unit());
            let found = format!("the {quantity} of `{}` in {unit}", own.location);
            let expected = format!(
                "one in {}, the unit of its output `{}` in model `{}`",
                output.unit, output.name, about.name
            );
            let other = own.quantity.unit_of(!own.turns);
            let may_turn = if dimension(other) == Some(unit_of_model) {
                format!("write `unit = \"{other}\"` if the sensor measures that; otherwise ")
            } else {
                String::new()
            };
            let remedy = format!(
                "{may_turn}remove the channel; to compare it, give the model a point at the place of the sensor, with an output"
            );
            Problem::new(campaign.manifest(), place, found, expected, remedy)
        })
        .collect()
}

/// The output of the model for a sensor, and the dimension of what the sensor should measure, if its unit is of another.
fn in_other_unit<'a>(about: &'a About, own: &Channel) -> Option<(&'a Output, [i32; 3])> {
    let (place, power) = points(own).find_map(|point| output_of(about, &signal_of(about, &point)).ok())?;
    let output = &about.outputs[place];
    let [mass, length, time] = dimension(&output.unit)?;
    // Each derivative divides by a second.
    let of_model = [mass, length, time - power];
    (dimension(own.unit()) != Some(of_model)).then_some((output, of_model))
}

/// The sensor as the mean of its place, and at each end of it.
fn points(own: &Channel) -> impl Iterator<Item = Point> {
    let mean = Point::of(own);
    let ends = [Side::Front, Side::Rear].map(|end| mean.on(end));
    std::iter::once(mean).chain(ends)
}
