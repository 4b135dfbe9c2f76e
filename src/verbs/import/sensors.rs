//! The sensors of the new campaign, each with its channel in the files.

use std::collections::BTreeSet;

use qcar_runtime::model::About;

use super::Measured;
use super::guess::{Guess, translating};
use crate::table::Table;

/// A sensor and its channel.
pub(super) struct Sensor {
    pub guess: Guess,
    /// Name of the channel, with its group if a file has several of that name.
    pub source: String,
    /// Unit in the file.
    pub unit: String,
}

/// The proposed sensors.
pub(super) struct Sensors {
    pub known: Vec<Sensor>,
    /// Channels without a sensor, with reasons.
    pub others: Vec<(String, String)>,
}

/// The sensors in the order of the channels in the files, without duplicates.
pub(super) fn propose(files: &[Measured], about: &About) -> Sensors {
    let mut all = Sensors {
        known: Vec::new(),
        others: Vec::new(),
    };
    for file in files {
        let recording = &file.contents.recording;
        for signal in &recording.signals {
            let source = match recording.signal(&signal.name) {
                Ok(_) => signal.name.clone(),
                Err(_) => signal.full_name(),
            };
            match Guess::of(signal, about) {
                Ok(guess) => all.add(guess, source, &signal.unit),
                Err(why) => all.pass(source, why.into()),
            }
        }
    }
    all
}

impl Sensors {
    fn add(&mut self, guess: Guess, source: String, unit: &str) {
        match self.known.iter().find(|known| known.guess.name() == guess.name()) {
            Some(known) if known.source == source => {}
            Some(known) => {
                let why = format!("`{}` is already taken to be `{}`", known.source, guess.name());
                self.pass(source, why);
            }
            None => self.known.push(Sensor {
                guess,
                source,
                unit: unit.into(),
            }),
        }
    }

    /// Removes channels that a K&C curve takes from those without a sensor.
    pub fn take_for_curves<'a>(&mut self, taken: impl Iterator<Item = &'a str>) {
        let taken: BTreeSet<&str> = taken.collect();
        self.others.retain(|(name, _)| !taken.contains(name.as_str()));
    }

    fn pass(&mut self, source: String, why: String) {
        if !self.others.iter().any(|(name, _)| *name == source) {
            self.others.push((source, why));
        }
    }
}

/// The `[[channel]]` sections.
pub(super) fn sections(sensors: &Sensors, about: &About) -> String {
    let mut text = "\n# The sensors, as guessed from names and units of the channels. Check each, above all its sign: z is up, x forward.\n".to_string();
    text.extend(sensors.known.iter().map(section));
    let Some((first, _)) = sensors.others.first() else {
        return text;
    };
    text += "\n# Channels that were not recognised as sensors:\n";
    let others = sensors.others.iter();
    text.extend(others.map(|(name, why)| format!("# {name:?}: {why}\n")));
    text + &form(first, about)
}

/// A `[[channel]]` to be filled in, as a comment.
fn form(source: &str, about: &About) -> String {
    let masses: BTreeSet<&str> = translating(about).collect();
    let roads = about.excitations.iter().filter(|own| own.road).map(|own| &*own.name);
    let places: Vec<&str> = roads.chain(masses).collect();
    let place = places.first().copied().unwrap_or("body");
    format!(
        "# Those that are sensors need such a section each:\n# [[channel]]\n# name = \"{place}_left_z\" # any\n# location = \"{place}\" # of {}\n\
         # side = \"left\" # or right, centre\n# axis = \"z\" # or x\n# quantity = \"acceleration\" # or velocity, displacement, force\n\
         # source = {source:?}\n",
        places.join(", "),
    )
}

fn section(sensor: &Sensor) -> String {
    let Guess {
        location,
        side,
        axis,
        quantity,
        turns,
        has_unit,
        ..
    } = &sensor.guess;
    let unit = match (has_unit, sensor.unit.as_str()) {
        (true, unit) if *turns => format!("unit = {unit:?}\n"),
        (true, unit) => format!("# in {unit}, as the file says\n"),
        (false, "") => format!(
            "# unit = # such as \"{}\"; not stated in the file, give yours\n",
            quantity.unit()
        ),
        (false, unit) => format!(
            "# unit = # and scale = ; the file says `{unit}`, which is no {}, give yours\n",
            quantity.name()
        ),
    };
    format!(
        "\n[[channel]]\nname = \"{}\"\nlocation = \"{location}\"\nside = \"{side}\"\naxis = \"{}\"\nquantity = \"{}\"\n\
         source = {:?}\n{unit}",
        sensor.guess.name(),
        axis.name(),
        quantity.name(),
        sensor.source,
    )
}

/// The proposal as text: channels with their sensors.
pub(super) fn table(sensors: &Sensors) -> String {
    let mut table = Table::new(["channel", "is", "unit"]);
    for sensor in &sensors.known {
        let unit = if sensor.unit.is_empty() { "-" } else { &sensor.unit };
        table.row(vec![sensor.source.clone(), sensor.guess.name(), unit.into()]);
    }
    let others = sensors.others.iter();
    table.text()
        + &others
            .map(|(name, why)| format!("{name}: no sensor, {why}\n"))
            .collect::<String>()
}
