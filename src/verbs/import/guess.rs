//! The sensor of a channel, from the words of its name and its unit.

use qcar_runtime::campaign::{Axis, Quantity, RoleNames};
use qcar_runtime::model::{About, StateKind};
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
    /// True if the file states a unit of the quantity.
    pub has_unit: bool,
}

impl Guess {
    /// The sensor, or why no sensor is recognised.
    pub fn of(signal: &Signal, about: &About) -> Result<Guess, &'static str> {
        // The channel's own name says more than that of its group.
        let words = [words(&signal.name), words(&signal.source.group)].concat();
        let stated = quantity_of(&signal.unit);
        if stated.is_none() && !matches!(signal.unit.as_str(), "" | "-" | "1" | "V" | "mV") {
            return Err("its unit is not that of an acceleration, velocity, displacement or force");
        }
        // Most sensors on a rig are accelerometers.
        let quantity = stated
            .or_else(|| meaning(&words, QUANTITIES))
            .unwrap_or(Quantity::Acceleration);
        let (location, drives) = location(&words, about).ok_or("no word in its name is a part of the model")?;
        let axis = meaning(&words, AXES).ok_or("its name has no axis, x or z")?;
        Ok(Guess {
            location,
            drives,
            side: meaning(&words, SIDES).unwrap_or("centre"),
            axis,
            quantity,
            has_unit: stated.is_some(),
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

/// A place of the model by its own name or by a common name, and true if it is the road.
fn location(words: &[String], about: &About) -> Option<(String, bool)> {
    let roads = about.excitations.iter().map(|own| (&own.name, own.road));
    let masses = about.states.iter().filter(|state| state.kind == StateKind::Velocity);
    let mut known = roads.chain(masses.map(|state| (&state.location, false)));
    if let Some((name, road)) = known.find(|(name, _)| words.contains(&name.to_lowercase())) {
        return Some((name.to_string(), road));
    }
    let roles = Roles::of(about, &RoleNames::default()).ok()?;
    match meaning(words, PLACES)? {
        Place::Road => Some((roles.road, true)),
        Place::Wheel => Some((roles.wheel, false)),
        Place::Body => Some((roles.on_rig().ok()?.body, false)),
    }
}
