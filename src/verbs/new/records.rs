//! A campaign of time histories: for a machine, a model that nothing drives, or a car on several pads, none of which a
//! sweep on one pad describes.

use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::Path;

use qcar_runtime::campaign::Quantity;
use qcar_runtime::model::{self, About, InputKind, Output, SignalKind};

use crate::terminal::word;

/// Folder for the records.
pub(super) const FOLDER: &str = "records";

/// True if the runs of a model are time histories: unless it stands on a single road.
pub(in crate::verbs) fn suit(about: &About) -> bool {
    let roads = about.excitations.iter().filter(|own| own.road);
    roads.map(|own| &own.name).collect::<BTreeSet<_>>().len() != 1
}

/// What to do with the new folder.
pub(super) fn next_steps(folder: &Path, about: &About) -> String {
    let (command, folder) = (word(folder), folder.display());
    format!(
        "{folder}/campaign.toml written. Now\n\
         1. export a record for the fit to {folder}/{FOLDER}/run_1.csv and another one to check it to run_2.csv, with the \
         header line\n     {}\n\
         2. give what is known, and correct values, sensors and runs in campaign.toml\n\
         3. qcar check {command}\n\
         4. qcar fit {command}\n",
        header(about)
    )
}

/// The sensors and the runs of a campaign.toml.
pub(super) fn sections(about: &About) -> String {
    let sensors = sensors(about);
    let driven = sensors.iter().any(|sensor| sensor.drives);
    let inputs = if driven {
        "\n# An input that was not recorded counts as zero."
    } else {
        ""
    };
    let mut out = format!(
        "\n# The sensors: each is a column of the records. Remove the responses that you do not have.{inputs}\n"
    );
    out.extend(sensors.iter().map(Sensor::section));
    let _ = write!(out, "\n# The records, with the header line\n#   {}\n", header(about));
    out += "# A column in another unit than its channel has that unit in its heading, as in `force [kN]`.\n";
    if !driven {
        out += "# Nothing drives the model: a record is a free decay, and its initial state is estimated.\n";
    }
    out += &run(1, "\"fit\" # parameters are fitted to it", driven);
    out += &run(2, "\"held_out\" # the fit is checked with it", driven);
    out
}

fn run(number: usize, role: &str, driven: bool) -> String {
    let mut out = format!(
        "\n[[run]]\nkind = \"time_history\"\nfile = \"{FOLDER}/run_{number}.csv\" # or .csv.gz\nrole = {role}\n\
         sample_rate = 1000.0 # Hz, give yours\n"
    );
    out += match driven {
        true => {
            "band_limited = true # false where an input is held between samples, as by a digital controller\n\
             # periodic = true # if the record is whole periods of a steady motion\n"
        }
        false => "band_limited = true\n",
    };
    out + "# band = [0.5, 100.0] # Hz, to compare only in this band\n"
}

/// A recorded signal of the model.
struct Sensor<'a> {
    name: String,
    location: &'a str,
    axis: &'a str,
    quantity: Quantity,
    turns: bool,
    /// True for an input.
    drives: bool,
}

impl Sensor<'_> {
    fn section(&self) -> String {
        let what = if self.drives { " # an input" } else { "" };
        format!(
            "\n[[channel]]{what}\nname = \"{}\"\nlocation = \"{}\"\nside = \"centre\"\naxis = \"{}\"\nquantity = \"{}\"\n\
             unit = \"{}\"\n",
            self.name,
            self.location,
            self.axis,
            self.quantity.name(),
            self.quantity.unit_of(self.turns)
        )
    }
}

/// One for each input and each output.
fn sensors(about: &About) -> Vec<Sensor<'_>> {
    let outputs = about.outputs.iter().map(response);
    let mut sensors: Vec<Sensor> = inputs(about).chain(outputs).collect();
    let mut known = BTreeSet::new();
    sensors.retain(|own| known.insert((own.location, own.axis, own.quantity.name())));
    let names: Vec<String> = sensors.iter().map(|own| own.name.clone()).collect();
    for sensor in &mut sensors {
        if names.iter().filter(|name| **name == sensor.name).count() > 1 {
            sensor.name = format!("{}_{}_{}", sensor.location, sensor.axis, sensor.quantity.name());
        }
    }
    sensors
}

/// A force is recorded as such, a prescribed motion by the quantity that the outputs have.
fn inputs(about: &About) -> impl Iterator<Item = Sensor<'_>> {
    let motion = about.outputs.iter().find_map(|own| match own.signal.kind {
        SignalKind::Motion(quantity) => Some(recorded(quantity)),
        SignalKind::Force | SignalKind::Stretch => None,
    });
    let motion = motion.unwrap_or(Quantity::Displacement);
    about.excitations.iter().enumerate().map(move |(place, own)| {
        let quantity = if own.force { Quantity::Force } else { motion };
        let input = about.inputs.iter().find(|input| match input.kind {
            InputKind::Motion(at, model::Quantity::Position) | InputKind::Force(at) => usize::from(at) == place,
            InputKind::Motion(..) | InputKind::Gravity => false,
        });
        Sensor {
            name: format!("{}_{}", own.name, quantity.name()),
            location: &own.name,
            axis: &own.axis,
            quantity,
            turns: input.is_some_and(|input| !["m", "N"].contains(&&*input.unit)),
            drives: true,
        }
    })
}

fn response(own: &Output) -> Sensor<'_> {
    let quantity = match own.signal.kind {
        SignalKind::Motion(quantity) => recorded(quantity),
        SignalKind::Force => Quantity::Force,
        SignalKind::Stretch => Quantity::Displacement,
    };
    Sensor {
        name: format!("{}_{}", own.signal.location, quantity.name()),
        location: &own.signal.location,
        axis: &own.signal.axis,
        quantity,
        turns: own.unit != quantity.unit_of(false),
        drives: false,
    }
}

fn recorded(quantity: model::Quantity) -> Quantity {
    match quantity {
        model::Quantity::Position => Quantity::Displacement,
        model::Quantity::Velocity => Quantity::Velocity,
        model::Quantity::Acceleration => Quantity::Acceleration,
    }
}

/// The header line of a record.
fn header(about: &About) -> String {
    let sensors = sensors(about).into_iter().map(|own| own.name);
    let columns: Vec<String> = std::iter::once("time".into()).chain(sensors).collect();
    columns.join(",")
}
