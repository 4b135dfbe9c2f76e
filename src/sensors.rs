//! Sensors of a campaign that do not measure what a model has.

use qcar_runtime::campaign::{Campaign, Channel, Side, dimension};
use qcar_runtime::discover::observe::{excitation_of, is_known, missing, order_of, signal_of};
use qcar_runtime::error::{Place, Problem};
use qcar_runtime::model::{About, InputKind, Quantity};
use qcar_runtime::response::signal::output_of;
use qcar_runtime::transmissibility::Point;

/// The sensors at places that the model lacks, as sentences.
pub fn unknown(about: &About, campaign: &Campaign) -> Vec<String> {
    let unknown = campaign
        .channels
        .iter()
        .filter(|own| !points(own).any(|point| is_known(about, &point)));
    let say = |own: &Channel| {
        let [what, remedy] = missing(about, &Point::of(own));
        format!(
            "channel `{}`: {what}, so nothing is compared with it; {remedy}",
            own.name
        )
    };
    unknown.map(say).collect()
}

/// A problem for each sensor whose unit is of another kind than that of the model, such as an acceleration in m/s^2 of a
/// mass that turns.
pub fn of_other_units(about: &About, campaign: &Campaign) -> Vec<Problem> {
    let problem = |own: &Channel| {
        let modelled = Modelled::of(about, own)?;
        let is_wrong = dimension(own.unit()) != Some(modelled.dimension);
        is_wrong.then(|| of_other_unit(own, &modelled, (about, campaign)))
    };
    campaign.channels.iter().filter_map(problem).collect()
}

fn of_other_unit(own: &Channel, modelled: &Modelled<'_>, (about, campaign): (&About, &Campaign)) -> Problem {
    let Modelled { what, name, unit, .. } = modelled;
    let place = Place::Name(format!("channel {}", own.name));
    let found = format!("the {} of `{}` in {}", own.quantity.name(), own.location, own.unit());
    let expected = format!(
        "one in {unit}, the unit of its {what} `{name}` in model `{}`",
        about.name
    );
    let other = own.quantity.unit_of(!own.turns);
    let may_turn = if dimension(other) == Some(modelled.dimension) {
        format!("write `unit = \"{other}\"` if the sensor measures that; otherwise ")
    } else {
        String::new()
    };
    let remedy = format!(
        "{may_turn}remove the channel; to compare it, give the model a point at the place of the sensor, with an output"
    );
    Problem::new(campaign.manifest(), place, found, expected, remedy)
}

/// What a model has at the place of a sensor.
struct Modelled<'a> {
    /// `input` or `output`.
    what: &'static str,
    name: &'a str,
    unit: &'a str,
    /// That of what the sensor should measure.
    dimension: [i32; 3],
}

impl<'a> Modelled<'a> {
    fn of(about: &'a About, own: &Channel) -> Option<Modelled<'a>> {
        Modelled::input(about, &Point::of(own)).or_else(|| Modelled::output(about, own))
    }

    fn input(about: &'a About, point: &Point) -> Option<Modelled<'a>> {
        let excitation = excitation_of(about, point)?;
        let is_own = |kind| match kind {
            InputKind::Force(place) | InputKind::Motion(place, Quantity::Position) => usize::from(place) == excitation,
            _ => false,
        };
        let input = about.inputs.iter().find(|input| is_own(input.kind))?;
        Modelled::new("input", &input.name, &input.unit, order_of(point))
    }

    fn output(about: &'a About, own: &Channel) -> Option<Modelled<'a>> {
        let (place, power) = points(own).find_map(|point| output_of(about, &signal_of(about, &point)).ok())?;
        let output = &about.outputs[place];
        Modelled::new("output", &output.name, &output.unit, power)
    }

    /// What has this unit, differentiated so often.
    fn new(what: &'static str, name: &'a str, unit: &'a str, order: i32) -> Option<Modelled<'a>> {
        let [mass, length, time] = dimension(unit)?;
        let dimension = [mass, length, time - order];
        Some(Modelled {
            what,
            name,
            unit,
            dimension,
        })
    }
}

/// The sensor as the mean of its place, and at each end of it.
fn points(own: &Channel) -> impl Iterator<Item = Point> {
    let mean = Point::of(own);
    let ends = [Side::Front, Side::Rear].map(|end| mean.on(end));
    std::iter::once(mean).chain(ends)
}
