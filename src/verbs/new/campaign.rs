//! `qcar new campaign`: a folder with a campaign.toml for a model, and folders for the measurements.

use std::fmt::Write;
use std::fs;
use std::path::{Component, Path, PathBuf};

use clap::Args;
use clap_complete::engine::ArgValueCompleter;
use qcar_runtime::campaign::RoleNames;
use qcar_runtime::error::{InputError, Place, Problem};
use qcar_runtime::model::{About, Default, Parameter, StateKind};
use qcar_runtime::roles::Roles;

use super::{Named, must_be_new, records};
use crate::catalogue;
use crate::completion;
use crate::failure::Failure;
use crate::files::{put, write_new};
use crate::table::number;
use crate::terminal::word;

/// Folders for the measured files of a car on a rig.
const PARTS: [&str; 4] = ["rig", "kc", "cleat", "road"];

/// Write a folder with a campaign.toml for a model, which says where to put each measured file
#[derive(Args)]
#[command(after_help = "Example:\n  qcar new campaign city_car_rig --model quarter_car")]
pub(super) struct Arguments {
    #[command(flatten)]
    named: Named,
    /// The model to fit: name of a shipped model, or path of a model file
    #[arg(long, default_value = "quarter_car", add = ArgValueCompleter::new(completion::models))]
    model: String,
}

pub(super) fn run(arguments: &Arguments) -> Result<String, Failure> {
    let (name, dir) = (&arguments.named.name, arguments.named.folder());
    arguments.named.check()?;
    let model = catalogue::load(&arguments.model)?;
    let folder = dir.join(name);
    must_be_new(&folder)?;
    let about = model.about();
    let seen = seen_from(&folder, &arguments.model, catalogue::is_shipped(&arguments.model));
    if records::suit(about) {
        let text = make_head(name, &seen, about) + &records::sections(about);
        write(&folder, &[records::FOLDER], &text)?;
        return Ok(records::next_steps(&folder, about));
    }
    write(&folder, &PARTS, &manifest(name, &seen, about))?;
    let (command, columns) = (word(&folder), columns(about).join(","));
    let folder = folder.display();
    Ok(format!(
        "{folder}/campaign.toml written. Now\n\
         1. export the sweeps of the rig to {folder}/rig/sweep_025.csv and sweep_100.csv, with the header line\n     \
         {columns}\n\
         2. give what is known of the vehicle, and correct values, sensors and runs in campaign.toml\n\
         3. qcar fit {command}\n"
    ))
}

/// The folder with these parts and its campaign.toml, or nothing.
fn write(folder: &Path, parts: &[&str], manifest: &str) -> Result<(), InputError> {
    write_new(&[folder], || {
        parts.iter().try_for_each(|part| make(&folder.join(part)))?;
        put(folder, "campaign.toml", manifest)
    })
}

fn make(folder: &Path) -> Result<(), InputError> {
    fs::create_dir_all(folder).map_err(|error| {
        let remedy = "choose another folder with --dir";
        Problem::new(folder, Place::File, error.to_string(), "a writable place", remedy).into()
    })
}

/// A model or a file as the campaign must give it: a path relative to the folder of the campaign. A `shipped` model has
/// a name and no path.
pub(in crate::verbs) fn seen_from(folder: &Path, named: &str, shipped: bool) -> String {
    let path = Path::new(named);
    if shipped || path.is_absolute() {
        return named.into();
    }
    let mut upwards = PathBuf::new();
    for part in folder.components() {
        match part {
            Component::CurDir => {}
            Component::Normal(_) => upwards.push(".."),
            // The target of `..` cannot be determined from the names alone.
            _ => return std::path::absolute(path).unwrap_or(path.into()).display().to_string(),
        }
    }
    upwards.join(path).display().to_string()
}

fn manifest(name: &str, model: &str, about: &About) -> String {
    let columns = columns(about).join(",");
    let mut out = make_head(name, model, about);
    let _ = writeln!(
        out,
        "\n# The sensors: each is a column of the time histories. Remove those that you do not have."
    );
    out.extend(sensors(about).iter().map(Sensor::section));
    let _ = write!(
        out,
        "\n# The sweeps of the 4-poster, with the header line\n#   {columns}\n{RUNS}"
    );
    out
}

/// First part of a campaign.toml: the model, known values, and start values.
pub(in crate::verbs) fn make_head(name: &str, model: &str, about: &About) -> String {
    let (known, estimated): (Vec<&Parameter>, _) = about
        .parameters
        .iter()
        .filter(|parameter| parameter.clock.is_none() && !matches!(parameter.default, Default::Same(_)))
        .partition(|parameter| parameter.known);
    let mut out = format!(
        "# A campaign of measurements; docs/campaign-format.md describes it. A number without a unit is SI; paths are relative to this \
         folder.\nformat = 1\nname = {name:?}\ndescription = \"\"\nmodel = {model:?}\n"
    );
    // Several tyres do not roll.
    let rolls = about.contact.is_some() && Roles::of(about, &RoleNames::default()).is_ok();
    let rolling = if rolls { ROLLING } else { "" };
    if !known.is_empty() || !rolling.is_empty() {
        out += "\n# Values known before any fit.\n[vehicle]\n";
    }
    for parameter in known {
        let _ = writeln!(out, "{}", of_vehicle(parameter));
    }
    out += rolling;
    out += "\n# Start values and ranges. With fit = false a value is kept.\n";
    out.extend(estimated.into_iter().map(of_fit));
    out
}

/// Vehicle data of the tyre, which no model has as parameters.
const ROLLING: &str = "# For `qcar simulate`, the tyre under its static load:\n\
    # r_tire = 0.33 # m\n# static_tire_load = 3924.0 # N\n# static_tire_def = 0.02 # m\n";

const RUNS: &str = "\
[[run]]
kind = \"sweep\"
file = \"rig/sweep_025.csv\" # or .csv.gz
role = \"fit\" # parameters are fitted to it
peak_velocity = 0.025 # m/s, of the pads
start_frequency = 0.5 # Hz
end_frequency = 30.0 # Hz
spacing = \"logarithmic\" # or \"linear\"
sample_rate = 1000.0 # Hz

[[run]]
kind = \"sweep\"
file = \"rig/sweep_100.csv\"
role = \"held_out\" # the fit is checked with it
peak_velocity = 0.1
start_frequency = 0.5
end_frequency = 30.0
spacing = \"logarithmic\"
sample_rate = 1000.0

# Curves of a K&C rig, with the header line displacement,force; `qcar kc` takes start values from them.
# [[run]]
# kind = \"bounce\"
# file = \"kc/bounce.csv\"
# role = \"fit\"

# Cleats, with the same columns as the sweeps, without the pads; `qcar simulate` compares with them.
# [[run]]
# kind = \"cleat\"
# file = \"cleat/v30_h20.csv\"
# role = \"held_out\"
# speed = 8.333 # m/s
# sample_rate = 1000.0 # Hz
# cleat = \"cleat_20\"

# Their profile, with the header line x,z,slope.
# [[road]]
# name = \"cleat_20\"
# file = \"road/cleat_20.csv\"
";

/// Significant digits of a guess; a value of the model keeps all that are of use.
const OF_A_GUESS: usize = 3;
const OF_A_VALUE: usize = 12;

/// A start value with its description.
fn guess(of: &Parameter) -> (Option<String>, &'static str) {
    let middle = "in the middle of its range, give yours";
    let guessed = |value: f64| Some(number(value, OF_A_GUESS));
    match (of.default, of.range) {
        (Default::Value(value), _) => (Some(number(value, OF_A_VALUE)), ""),
        (_, Some((low, high))) if low > 0.0 => (guessed((low * high).sqrt()), middle),
        (_, Some((low, high))) => (guessed((low + high) / 2.0), middle),
        (_, None) => (None, "give yours"),
    }
}

/// `key = value`; commented out without a value, so that the campaign is refused until it is given.
fn line(key: &str, value: Option<String>) -> String {
    value.map_or(format!("# {key} ="), |value| format!("{key} = {value}"))
}

/// A comment at the end of a line: what it describes, and a hint. Empty if there is neither.
fn comment(what: &[&str], hint: &str) -> String {
    let parts = |parts: &[&str], between: &str| {
        let given: Vec<&str> = parts.iter().copied().filter(|part| !part.is_empty()).collect();
        given.join(between)
    };
    match parts(&[&parts(what, ", "), hint], "; ") {
        text if text.is_empty() => text,
        text => format!(" # {text}"),
    }
}

/// A known parameter gets only the default of the model, because a guess would count as known.
fn of_vehicle(of: &Parameter) -> String {
    let value = match of.default {
        Default::Value(value) => Some(number(value, OF_A_VALUE)),
        Default::None | Default::Same(_) => None,
    };
    let hint = match value {
        Some(_) => "as in the model, give yours",
        None => "give yours",
    };
    line(&of.name, value) + &comment(&[&of.unit, &of.doc], hint)
}

fn of_fit(of: &Parameter) -> String {
    let (value, hint) = guess(of);
    let fit = match of.range {
        Some((low, high)) => format!("range = [{}, {}]\nfit = true\n", number(low, 6), number(high, 6)),
        None => {
            "# range = [lower, upper] # the model has none; give it and fit = true to estimate it\nfit = false\n".into()
        }
    };
    format!(
        "\n[parameters.{}]{}\n{}\nunit = \"{}\"\n{fit}",
        of.name,
        comment(&[&of.doc], hint),
        line("value", value),
        of.unit,
    )
}

/// An accelerometer.
struct Sensor<'a> {
    location: &'a str,
    side: &'static str,
    axis: &'a str,
}

impl Sensor<'_> {
    fn name(&self) -> String {
        format!("{}_{}_{}", self.location, self.side, self.axis)
    }

    fn section(&self) -> String {
        format!(
            "\n[[channel]]\nname = \"{}\"\nlocation = \"{}\"\nside = \"{}\"\naxis = \"{}\"\n\
             quantity = \"acceleration\"\nunit = \"m/s^2\"\n",
            self.name(),
            self.location,
            self.side,
            self.axis
        )
    }
}

/// One sensor on each side for every pad and every mass along the direction of the pads. An inertia that turns has none:
/// an accelerometer measures no angle.
fn sensors(about: &About) -> Vec<Sensor<'_>> {
    let roads = about.excitations.iter().filter(|excitation| excitation.road);
    let roads: Vec<(&str, &str)> = roads.map(|road| (&*road.name, &*road.axis)).collect();
    let axis = roads.first().map_or("z", |road| road.1);
    let masses = about
        .states
        .iter()
        .filter(|state| state.kind == StateKind::Velocity && state.axis == axis && state.unit == "m/s");
    let places = roads
        .iter()
        .copied()
        .chain(masses.map(|mass| (&*mass.location, &*mass.axis)));
    places
        .flat_map(|(location, axis)| ["left", "right"].map(|side| Sensor { location, side, axis }))
        .collect()
}

/// The header line of a sweep.
fn columns(about: &About) -> Vec<String> {
    std::iter::once("time".into())
        .chain(sensors(about).iter().map(Sensor::name))
        .collect()
}
