//! The sensor of a channel, from the words of its name and its unit.

use std::cmp::Reverse;
use std::collections::BTreeSet;

use qcar_runtime::campaign::{Axis, Quantity, RoleNames};
use qcar_runtime::model::{About, State, StateKind};
use qcar_runtime::roles::Roles;
use qcar_signals::si::in_si;
use qcar_signals::signal::Signal;

use super::tokens::{meaning, words};

/// Places that every model of an axle on a tyre has.
#[derive(Clone, Copy, PartialEq)]
enum Place {
    Road,
    Wheel,
    Body,
}

const PLACES: &[(&[&str], Place)] = &[
    (
        &[
            "pad", "pads", "platen", "plate", "road", "actuator", "act", "poster", "drive", "stempel", "teller",
        ],
        Place::Road,
    ),
    (
        &[
            "wheel", "hub", "wc", "knuckle", "upright", "spindle", "carrier", "unsprung", "axle", "rad", "radnabe",
        ],
        Place::Wheel,
    ),
    (
        &[
            "body",
            "chassis",
            "sprung",
            "frame",
            "dome",
            "tower",
            "shell",
            "aufbau",
            "karosserie",
            "dom",
        ],
        Place::Body,
    ),
];

const SIDES: &[(&[&str], &str)] = &[
    (
        &[
            "left", "l", "lh", "lhs", "fl", "rl", "lf", "lr", "links", "li", "vl", "hl",
        ],
        "left",
    ),
    (
        &["right", "r", "rh", "rhs", "fr", "rr", "rf", "rechts", "re", "vr", "hr"],
        "right",
    ),
    (&["centre", "center", "c", "mid", "middle", "mitte"], "centre"),
];

const AXES: &[(&[&str], Axis)] = &[
    (&["z", "vert", "vertical", "accz", "az", "hoch"], Axis::Z),
    (&["x", "long", "longitudinal", "lon", "accx", "ax", "laengs"], Axis::X),
];

/// Words for the lateral axis, which a channel may have though the model does not.
const ACROSS: &[&str] = &["y", "lat", "lateral", "accy", "ay", "quer"];

const QUANTITIES: &[(&[&str], Quantity)] = &[
    (
        &["acc", "accel", "acceleration", "accz", "accx", "beschl", "az", "ax"],
        Quantity::Acceleration,
    ),
    (&["vel", "velocity", "geschw"], Quantity::Velocity),
    (
        &["disp", "displacement", "pos", "position", "travel", "weg"],
        Quantity::Displacement,
    ),
    (&["force", "load", "f", "kraft"], Quantity::Force),
];

/// Words of a name that mean an angle or its rate.
const ANGLES: [&str; 20] = [
    "pitch", "roll", "yaw", "gyro", "angle", "ang", "angular", "rot", "rotation", "steer", "steering", "omega", "nick",
    "nicken", "wank", "wanken", "gier", "gieren", "winkel", "drehrate",
];

/// Units of angles and of speeds of rotation, without their prefixes and powers of time.
const OF_ANGLES: [&str; 10] = [
    "rad", "mrad", "deg", "degree", "degrees", "°", "arcmin", "rpm", "rev", "U",
];

const UNIT_OF_ANGLE: &str = "its unit is that of an angle, which needs a unit of rad, deg or rpm";
const ANGLE_OF_NOTHING: &str = "its unit is that of an angle, and no word in its name is an angle of the model";
const NAME_OF_ANGLE: &str = "its name means an angle, and its unit is not that of one";
const ANGLE_OF_MODEL: &str = "what its name says is an angle in the model, and its unit is not that of one";

/// Proposed sensor of a channel.
#[derive(Clone, PartialEq)]
pub(super) struct Guess {
    /// A road or a mass of the model.
    pub location: String,
    /// True if the place is the road of the model.
    pub drives: bool,
    pub side: &'static str,
    pub axis: Axis,
    pub quantity: Quantity,
    /// True if the place turns about the axis.
    pub turns: bool,
    /// True if the file states a unit of the quantity.
    pub has_unit: bool,
}

impl Guess {
    /// The sensor, or why no sensor is recognised.
    pub fn of(signal: &Signal, about: &About) -> Result<Guess, &'static str> {
        // The channel's own name says more than that of its group.
        let words = [words(&signal.name), words(&signal.source.group)].concat();
        let stated = quantity_of(&signal.unit);
        if is_of_angle(&signal.unit) {
            return Guess::of_angle(&signal.unit, &words, about);
        }
        if stated.is_none() && !matches!(signal.unit.as_str(), "" | "-" | "1" | "V" | "mV") {
            return Err("its unit is not that of an acceleration, velocity, displacement or force");
        }
        if words.iter().any(|word| names_angle(word, about)) {
            return Err(ANGLE_OF_MODEL);
        }
        if stated.is_none() && words.iter().any(|word| ANGLES.contains(&word.as_str())) {
            return Err(NAME_OF_ANGLE);
        }
        // Most sensors on a rig are accelerometers.
        let quantity = stated
            .or_else(|| meaning(&words, QUANTITIES))
            .unwrap_or(Quantity::Acceleration);
        let (location, drives) = location(&words, about).ok_or("no word in its name is a part of the model")?;
        let axis = axis(&words, about)?;
        Ok(Guess {
            location,
            drives,
            side: meaning(&words, SIDES).unwrap_or("centre"),
            axis,
            quantity,
            turns: false,
            has_unit: stated.is_some(),
        })
    }

    /// The sensor of an angle of the model, or of its rate or acceleration.
    fn of_angle(unit: &str, words: &[String], about: &About) -> Result<Guess, &'static str> {
        let quantity = match in_si(unit).map(|si| si.dimension) {
            Some([0, 0, 0]) => Quantity::Displacement,
            Some([0, 0, -1]) => Quantity::Velocity,
            Some([0, 0, -2]) => Quantity::Acceleration,
            _ => return Err(UNIT_OF_ANGLE),
        };
        let named = |angle: &&State| has_name(words, &angle.location);
        let angle = angles(about).find(named).ok_or(ANGLE_OF_NOTHING)?;
        Ok(Guess {
            location: angle.location.to_string(),
            drives: false,
            side: meaning(words, SIDES).unwrap_or("centre"),
            axis: Axis::new(angle.axis.to_string()),
            quantity,
            turns: true,
            has_unit: true,
        })
    }

    /// The name of the sensor: `body_left_z`.
    pub fn name(&self) -> String {
        let plain = format!("{}_{}_{}", self.location, self.side, self.axis.name());
        match self.quantity {
            Quantity::Acceleration => plain,
            other => format!("{plain}_{}", other.name()),
        }
    }
}

/// The quantity of a unit; `None` if no sensor has it.
pub(super) fn quantity_of(unit: &str) -> Option<Quantity> {
    let all = [
        Quantity::Acceleration,
        Quantity::Velocity,
        Quantity::Displacement,
        Quantity::Force,
    ];
    let dimension = in_si(unit)?.dimension;
    all.into_iter()
        .find(|own| in_si(own.unit()).is_some_and(|si| si.dimension == dimension))
}

/// True for a unit such as `deg`, `rad/s` or `U/min`.
fn is_of_angle(unit: &str) -> bool {
    let mut symbols = unit.split(|c: char| !c.is_alphabetic() && c != '°');
    symbols.any(|symbol| OF_ANGLES.contains(&symbol))
}

/// True if the model has an angle of that name, in lower case, and no motion along an axis.
fn names_angle(word: &str, about: &About) -> bool {
    let is_named = |name: &str| name.to_lowercase() == word;
    angles(about).any(|state| is_named(&state.location)) && !translating(about).any(is_named)
}

/// The speeds of the parts of a model that turn.
fn angles(about: &About) -> impl Iterator<Item = &State> {
    let coordinates = about.states.iter().filter(|state| state.kind == StateKind::Velocity);
    coordinates.filter(|state| !moves_along_axis(state))
}

/// The masses and nodes of a model that move along an axis; all others turn.
pub(super) fn translating(about: &About) -> impl Iterator<Item = &str> {
    let moving = about.states.iter().filter(|state| state.kind == StateKind::Velocity);
    moving
        .filter(|state| moves_along_axis(state))
        .map(|state| &*state.location)
}

fn moves_along_axis(state: &State) -> bool {
    state.unit == "m/s"
}

/// True if a name of the model is among the words, one of its own after the other.
fn has_name(words: &[String], name: &str) -> bool {
    let own = self::words(name);
    words.contains(&name.to_lowercase()) || !own.is_empty() && words.windows(own.len()).any(|part| part == own)
}

/// The axis that a name states; otherwise the only one of a model.
fn axis(words: &[String], about: &About) -> Result<Axis, &'static str> {
    if let Some(stated) = meaning(words, AXES) {
        return Ok(stated);
    }
    let driven = about.excitations.iter().map(|own| &*own.axis);
    let own: BTreeSet<&str> = about.states.iter().map(|own| &*own.axis).chain(driven).collect();
    let is_lacking = |word: &String| ACROSS.contains(&word.as_str()) && !own.contains(word.as_str());
    match own.first() {
        _ if words.iter().any(is_lacking) => Err("its name has an axis that the model lacks"),
        Some(only) if own.len() == 1 => Ok(Axis::new(only.to_string())),
        _ => Err("its name has no axis, x or z"),
    }
}

/// A place of the model by its own name or by a common name, and true if it is the road.
fn location(words: &[String], about: &About) -> Option<(String, bool)> {
    let roads = about.excitations.iter().map(|own| (&own.name, own.road));
    let roads = roads.map(|(name, road)| (&**name, road));
    let known = roads.chain(translating(about).map(|name| (name, false)));
    let named = known.filter(|(name, _)| has_name(words, name));
    // Of `wheel` and `front_wheel`, the longer name says more. The first of several is kept.
    if let Some((name, road)) = named.min_by_key(|(name, _)| Reverse(self::words(name).len())) {
        return Some((name.to_string(), road));
    }
    let roles = Roles::of(about, &RoleNames::default()).ok()?;
    match meaning(words, PLACES)? {
        Place::Road => Some((roles.road, true)),
        Place::Wheel => Some((roles.wheel, false)),
        Place::Body => Some((roles.on_rig().ok()?.body, false)),
    }
}
