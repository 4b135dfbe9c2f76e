//! The rolling tyre of a unit as C data.

use qcar_dsl::about::{About, InputKind};
use qcar_dsl::model::Quantity;
use qcar_dsl::units::Unit;

/// Tyre, profile and start of a rolling model.
pub struct OnTyre {
    /// Points of the profile, m; it is level beyond both ends.
    pub road: Vec<[f64; 2]>,
    /// Position of the wheel centre at time 0, m.
    pub start: f64,
    /// Unloaded radius, m.
    pub radius: f64,
    /// Deflection under the static load, m.
    pub deflection: f64,
    /// Static load, N.
    pub load: f64,
    /// Speed, m/s.
    pub speed: f64,
    /// Equilibrium of the model before the road.
    pub rest: Vec<f64>,
}

/// A quantity of the tyre or the car.
pub struct Fact {
    pub name: &'static str,
    pub doc: &'static str,
    pub unit: (&'static str, Unit),
    pub value: f64,
    /// Name in the sources.
    access: &'static str,
}

/// Number of constants that `rolling.c` defines itself.
const CONSTANTS: usize = 7;

/// Signals of the contact, after the outputs of the model.
pub const OUTPUTS: [(&str, &str); 2] = [
    ("force_tire_z", "Force of the road on the wheel along z"),
    ("force_tire_x", "Force of the road on the wheel along x"),
];

impl OnTyre {
    fn facts(&self) -> [Fact; 4] {
        let (meter, speed) = (Unit::METER, Unit::METER.per(Unit::SECOND));
        [
            Fact {
                name: "r_tire",
                doc: "Radius of the unloaded tyre",
                unit: ("m", meter),
                value: self.radius,
                access: "TYRE_RADIUS",
            },
            Fact {
                name: "static_tire_def",
                doc: "Deflection of the tyre under its static load",
                unit: ("m", meter),
                value: self.deflection,
                access: "TYRE_DEFLECTION",
            },
            Fact {
                name: "static_tire_load",
                doc: "Static load of the tyre",
                unit: ("N", Unit::NEWTON),
                value: self.load,
                access: "TYRE_LOAD",
            },
            Fact {
                name: "v_car",
                doc: "Speed of the car",
                unit: ("m/s", speed),
                value: self.speed,
                access: "CAR_SPEED",
            },
        ]
    }

    /// Quantities that are no parameters of the model.
    pub fn own_facts(&self, about: &About) -> Vec<Fact> {
        let is_own = |fact: &Fact| place(about, fact.name).is_none();
        self.facts().into_iter().filter(is_own).collect()
    }

    /// Definitions for `rolling.c` besides the sizes of the model.
    pub fn definitions(&self, about: &About) -> String {
        let own = self.own_facts(about);
        let access = |fact: &Fact| {
            let known = place(about, fact.name);
            let added = || own.iter().position(|own| own.name == fact.name);
            let place = known.or_else(|| added().map(|at| about.parameters.len() + at));
            let place = place.expect("a fact is a parameter of the model or one of its own");
            format!("#define {}(p) ((p)[{place}])\n", fact.access)
        };
        let facts: String = self.facts().iter().map(access).collect();
        let values = own.iter().map(|fact| fact.value).chain([0.0]);
        let (wheel, road) = (wheel(about), road(about));
        let rest = self.rest.iter().copied().chain([0.0]);
        format!(
            "{facts}{wheel}{road}#define EXTRA_VALUES {{{}}}\n#define REST {{{}}}\n",
            numbers(values),
            numbers(rest)
        )
    }

    /// Numbers of signals that the contact adds to a model, by name.
    pub fn added(&self, about: &About) -> [(&'static str, usize); 3] {
        [
            ("PARAMETERS", self.own_facts(about).len()),
            ("OUTPUTS", OUTPUTS.len()),
            ("CONSTANTS", CONSTANTS),
        ]
    }

    /// `road.h`.
    pub fn profile(&self) -> String {
        let points = self.road.iter().map(|[x, z]| format!("    {{{x:?}, {z:?}}},\n"));
        format!(
            "/* The profile, x and z in m, and the x of the wheel's centre at time 0. */\n#ifndef ROAD_H\n#define ROAD_H\n\n\
             #define ROAD_POINTS {}\n#define ROAD_START {:?}\n\nstatic const double ROAD[ROAD_POINTS][2] = {{\n{}}};\n\n#endif\n",
            self.road.len(),
            self.start,
            points.collect::<String>()
        )
    }
}

fn place(about: &About, name: &str) -> Option<usize> {
    about.parameters.iter().position(|own| own.name == name)
}

fn numbers(values: impl Iterator<Item = f64>) -> String {
    values.map(|value| format!("{value:?}")).collect::<Vec<_>>().join(", ")
}

/// Positions of the states of the wheel.
fn wheel(about: &About) -> String {
    let contact = about.contact.as_ref().expect("the model rolls");
    let z = &contact.axes[0];
    let x = contact.axes.get(1).map(|axis| [axis.position, axis.velocity]);
    let along = |name: &str, at: usize| match x {
        Some(places) => format!("#define {name}(x) ((x)[{}])\n", places[at]),
        None => format!("#define {name}(x) (0.0)\n"),
    };
    format!(
        "#define WHEEL_Z {}\n#define WHEEL_VZ {}\n{}{}",
        z.position,
        z.velocity,
        along("WHEEL_X", 0),
        along("WHEEL_VX", 1)
    )
}

/// Positions of the inputs of the road.
fn road(about: &About) -> String {
    let of = |wanted: Quantity| {
        let is_of = |kind: InputKind| match kind {
            InputKind::Motion(place, quantity) => about.excitations[usize::from(place)].road && quantity == wanted,
            InputKind::Gravity | InputKind::Force(_) => false,
        };
        about.inputs.iter().position(|input| is_of(input.kind))
    };
    let access = |name: &str, wanted: Quantity| match of(wanted) {
        Some(place) => format!("#define {name}(u) ((u)[{place}])\n"),
        None => format!("#define {name}(u) (0.0)\n"),
    };
    access("ROAD_HEIGHT", Quantity::Position) + &access("ROAD_RATE", Quantity::Velocity)
}
