//! The `[[channel]]` sections of a campaign and of a file that campaigns share.

use std::path::Path;

use qcar_signals::si::in_si;

use super::super::contents::{Channel, ChannelMapping, Quantity, Side};
use super::super::fields::{Document, Section};
use super::super::mapping;
use super::each;

/// A channel with its source.
pub(super) struct Sensor {
    pub channel: Channel,
    pub mapping: ChannelMapping,
    /// True if the source has keys that a plain table does not need.
    pub mapped: bool,
}

/// The channels of the file that `mapping` names, then those of the campaign itself.
pub(super) fn sensors(folder: &Path, top: &Section<'_>) -> Option<Vec<Sensor>> {
    let shared = match top.optional_text("mapping") {
        Some(file) => shared_sensors(&folder.join(file), top),
        None => Some(Vec::new()),
    };
    let own = each(top.sections("channel"), "name", sensor, |sensor| &sensor.channel.name);
    let (mut shared, own) = (shared?, own?);
    let twice = own
        .iter()
        .find(|own| shared.iter().any(|shared| shared.channel.name == own.channel.name));
    if let Some(twice) = twice {
        let found = format!("the channel \"{}\", which `channel` has too", twice.channel.name);
        top.wrong(
            "mapping",
            found,
            "each channel once",
            "remove it from one of the two files",
        );
    }
    shared.iter_mut().for_each(|shared| shared.mapping.shared = true);
    shared.extend(own);
    Some(shared)
}

/// The channels of a file that campaigns share.
fn shared_sensors(file: &Path, top: &Section<'_>) -> Option<Vec<Sensor>> {
    let document = match Document::read(file) {
        Ok(document) => document,
        Err(error) => {
            let found = error
                .problems
                .first()
                .map_or(String::new(), |problem| problem.found.clone());
            let remedy = "correct the path (relative to the folder of campaign.toml), or put the file there";
            let found = format!("{}: {found}", file.display());
            top.wrong(
                "mapping",
                found,
                "a readable text file with [[channel]] sections",
                remedy,
            );
            return None;
        }
    };
    let sensors = document.parse().map(|tree| {
        let top = document.top(&tree);
        let sensors = each(top.sections("channel"), "name", sensor, |sensor| &sensor.channel.name);
        top.finish();
        sensors
    });
    let sensors = sensors.and_then(|sensors| document.finish(sensors));
    sensors.map_err(|error| top.adopt(error)).ok()
}

fn sensor(section: &Section<'_>) -> Option<Sensor> {
    let (name, location) = (section.text("name"), section.text("location"));
    let (side, axis) = (section.choice("side", Side::NAMES), section.axis());
    let quantity = section.choice("quantity", Quantity::NAMES);
    if name.as_deref() == Some("time") {
        section.wrong(
            "name",
            "\"time\"",
            "another name",
            "the column `time` holds the time; rename the channel",
        );
    }
    let turns = quantity.is_some_and(|own| is_of_angle(section, own));
    let unit = quantity.map(|own| own.unit_of(turns));
    let mapping = mapping::mapping(section, name.as_deref().unwrap_or(""), unit);
    section.finish();
    let (mapping, mapped) = mapping?;
    let channel = Channel {
        name: name?,
        location: location?,
        side: side?,
        axis: axis?,
        quantity: quantity?,
        turns,
    };
    Some(Sensor {
        channel,
        mapping,
        mapped,
    })
}

/// True if the section has a unit of this quantity of a location that turns, such as `rad/s` for a velocity.
fn is_of_angle(section: &Section<'_>, quantity: Quantity) -> bool {
    let written = section.written("unit");
    mapping::of_quantity(in_si(written.trim_matches('"')), quantity.unit_of(true))
}
