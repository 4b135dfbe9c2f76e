//! Contents of a campaign. `docs/campaign-format.md` describes the format.

use std::borrow::Cow;
use std::path::PathBuf;

use super::reading::RunData;

/// Keys of `[vehicle]` besides parameters of the model, values of one corner, SI.
pub const FACTS: [&str; 7] = [
    "m_corner",
    "m_half_vehicle",
    "m_wheel_other_axle",
    "r_tire",
    "static_tire_load",
    "static_tire_def",
    "gravity",
];

/// The units of [`FACTS`].
pub const FACT_UNITS: [&str; 7] = ["kg", "kg", "kg", "m", "N", "m", "m/s^2"];

/// The unit of such a key; `None` for a parameter of the model.
pub fn unit_of_fact(name: &str) -> Option<&'static str> {
    let facts = FACTS.into_iter().zip(FACT_UNITS);
    facts.filter(|(fact, _)| *fact == name).map(|(_, unit)| unit).next()
}

/// Expected value and remedy for vehicle data that cannot be (a value in SI); `None` for a possible value.
///
/// A tyre pushes and does not pull; models take a load of 0 for one that stays linear. The limits of gravity lie beyond
/// those of the Moon (1.62 m/s^2) and of Jupiter (24.8 m/s^2), and leave out 1 for 1 g, and values in ft/s^2 or mm/s^2.
/// Those of a tyre's radius are a choice: below the wheels of model cars (0.03 m), and above the tyres of the largest
/// dump trucks (2.0 m), which leaves out values of cars in mm, cm or in.
pub fn impossible_fact(name: &str, value: f64) -> Option<(&'static str, &'static str)> {
    let (is_possible, expected, remedy) = match name {
        "gravity" => (
            (1.5..=25.0).contains(&value),
            "the magnitude of the acceleration of gravity, such as 9.81 in m/s^2",
            "correct the value or its unit, such as \"1 g\", or leave it out",
        ),
        "static_tire_load" => (
            value >= 0.0,
            "the load that the tyre carries, not negative",
            "correct the value: a compressive load is positive",
        ),
        "r_tire" => (
            (0.01..=2.5).contains(&value),
            "the radius of an unloaded tyre, from 0.01 to 2.5 m",
            "correct the value or its unit, such as \"350 mm\"",
        ),
        _ => return None,
    };
    (!is_possible).then_some((expected, remedy))
}

/// Contents of `campaign.toml`.
#[derive(Clone, Debug, PartialEq)]
pub struct Campaign {
    /// Folder of the campaign.
    pub folder: PathBuf,
    /// Short name.
    pub name: String,
    /// Description.
    pub description: String,
    /// The axle model with which the engineer starts.
    pub model: String,
    /// Known values of the vehicle for one corner, SI, in the order of the file: [`FACTS`] and parameters of the model.
    pub vehicle: Vec<(String, f64)>,
    /// Masses of the model with a role in a test, if its structure does not determine them.
    pub roles: RoleNames,
    /// Start values, in the order of the file.
    pub parameters: Vec<Parameter>,
    /// The sensors, in the order of the file.
    pub channels: Vec<Channel>,
    /// Source of each channel in files that are no plain tables; one for each channel.
    pub mappings: Vec<ChannelMapping>,
    /// The tests, in the order of the file.
    pub runs: Vec<Run>,
    /// The road profiles.
    pub roads: Vec<Road>,
    /// Notices for the engineer, as sentences.
    pub notices: Vec<String>,
    /// Data of the runs whose files are no plain tables.
    pub(super) recorded: Vec<RunData>,
}

/// Masses of the model that a campaign names itself; see [`Roles`](crate::roles::Roles).
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RoleNames {
    /// The mass that a K&C rig moves.
    pub wheel: Option<String>,
    /// The mass that it holds.
    pub body: Option<String>,
}

/// The start value of a model parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Its name in the model.
    pub name: String,
    /// Start value, in `unit`; inside `range`.
    pub value: f64,
    /// A coherent SI unit; see [`dimension`](super::dimension).
    pub unit: String,
    /// Bounds of the estimation, lower below upper.
    pub range: Option<(f64, f64)>,
    /// False for a known parameter, which keeps its value.
    pub fit: bool,
    /// Source of the value.
    pub comment: String,
}

/// A sensor: a column of the time histories.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// The column's name.
    pub name: String,
    /// Location: `pad`, or a mass, link or input of the model.
    pub location: String,
    /// Side of the vehicle.
    pub side: Side,
    /// Direction of the model along which it measures.
    pub axis: Axis,
    /// Measured quantity; values are in its SI unit.
    pub quantity: Quantity,
    /// True if the location turns: the quantity is an angle, its rate or acceleration, or a moment.
    pub turns: bool,
}

/// The channel of a measured file that is a sensor or a column of a curve, and its conversion to SI.
#[derive(Clone, Debug, PartialEq)]
pub struct ChannelMapping {
    /// Name of the sensor or column.
    pub name: String,
    /// The channel in the file: its name, `group/name`, or a pattern with `*` and `?`.
    pub source: String,
    /// Unit of the scaled values; `None` for that of the file.
    pub unit: Option<String>,
    /// Unit of the converted values.
    pub si: &'static str,
    /// Factor on the values of the file; `None` without one.
    pub scale: Option<f64>,
    /// Offset added after the factor, in `unit`.
    pub offset: f64,
    /// 1, or -1 for a sensor that is mounted the other way round.
    pub sign: f64,
    /// Duration at the beginning of the recording whose mean is subtracted, s; `None` for no subtraction.
    pub zero: Option<f64>,
    /// True if it comes from a file that campaigns share, so that no run of a campaign needs it.
    pub shared: bool,
}

/// The part of a recording that is a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Window {
    /// Start, s after the trigger if there is one; `None` for the beginning of the recording, or the trigger.
    pub from: Option<f64>,
    /// End, s, counted as `from`; `None` for the end of the recording.
    pub to: Option<f64>,
    /// The trigger at which the time is zero.
    pub trigger: Option<Trigger>,
}

/// The first time that a channel rises above a value.
#[derive(Clone, Debug, PartialEq)]
pub struct Trigger {
    /// The channel in the file, as [`ChannelMapping::source`].
    pub channel: String,
    /// Threshold, in the unit of the file.
    pub above: f64,
}

/// Side of the vehicle of a sensor. A centre sensor measures the mean of both corners.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[expect(missing_docs, reason = "each says it")]
pub enum Side {
    Left,
    Right,
    Centre,
    Front,
    Rear,
}

/// A direction of the model, by its name there.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Axis(Cow<'static, str>);

/// What a sensor measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Quantity {
    /// Acceleration, m/s², zero at rest.
    Acceleration,
    /// Velocity, m/s.
    Velocity,
    /// Displacement, m; on a link, its stretch.
    Displacement,
    /// Force, N; on a link, its force.
    Force,
}

/// A test and its file.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// Name in results: that of its file, unless the campaign gives another.
    pub name: String,
    /// Path relative to the folder of the campaign.
    pub file: String,
    /// True if the file is a table with the names and units of the campaign, false for a file of a rig or another
    /// program.
    pub plain: bool,
    /// The part of the recording that is the run.
    pub window: Window,
    /// Sensors that are not read from it.
    pub without: Vec<String>,
    /// The columns of a curve.
    pub columns: Vec<ChannelMapping>,
    /// Role.
    pub role: Role,
    /// The test.
    pub test: Test,
}

/// Role of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Role {
    /// Parameters are fitted to it.
    Fit,
    /// It checks the result, and no fit uses it.
    HeldOut,
}

/// Test of a run.
#[derive(Clone, Debug, PartialEq)]
pub enum Test {
    /// 4-poster, single axle (thesis section 3.4.1).
    Sweep(Sweep),
    /// K&C, quasi-static vertical cycle through the travel.
    Bounce,
    /// K&C, vertical sine.
    DynamicBounce {
        /// Peak velocity, m/s.
        peak_velocity: f64,
        /// Amplitude, m.
        amplitude: f64,
    },
    /// K&C, longitudinal cycle limited by force.
    Longitudinal,
    /// One wheel over an obstacle at constant speed.
    Cleat {
        /// Speed, m/s.
        speed: f64,
        /// Sample rate, Hz.
        sample_rate: f64,
        /// The name of its road.
        cleat: String,
    },
    /// Any excitation, recorded with its response.
    TimeHistory(Recording),
    /// One link alone, moved by sines of several peak velocities.
    Dynamometer(Dynamometer),
}

/// A dynamometer test.
#[derive(Clone, Debug, PartialEq)]
pub struct Dynamometer {
    /// Name of the link in the model.
    pub link: String,
    /// Axis of the link in the model.
    pub axis: Axis,
    /// Half the stroke of the sines, m.
    pub amplitude: f64,
    /// Standard deviation of every force, N; `None` if the table has a column of it.
    pub uncertainty: Option<f64>,
}

/// A time history of any excitation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Recording {
    /// Sample rate, Hz.
    pub sample_rate: f64,
    /// True if the inputs contain nothing above half the sample rate; false if they are held between samples.
    pub band_limited: bool,
    /// Band that is compared, Hz, below half the sample rate; `None` for all frequencies.
    pub band: Option<(f64, f64)>,
    /// True if the record consists of whole periods of a periodic motion.
    pub periodic: bool,
}

/// A sine sweep of constant peak velocity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sweep {
    /// Peak velocity, m/s.
    pub peak_velocity: f64,
    /// First frequency, Hz.
    pub start_frequency: f64,
    /// Last frequency, Hz, above the first and below half the sample rate.
    pub end_frequency: f64,
    /// Growth of the frequency.
    pub spacing: Spacing,
    /// Sample rate, Hz.
    pub sample_rate: f64,
}

/// Growth of the frequency of a sweep over time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[expect(missing_docs, reason = "each says it")]
pub enum Spacing {
    Logarithmic,
    Linear,
}

/// A road profile and the file that holds it.
#[derive(Clone, Debug, PartialEq)]
pub struct Road {
    /// Name in cleat runs.
    pub name: String,
    /// Path relative to the folder of the campaign.
    pub file: String,
    /// Form of the profile in the file.
    pub profile: Profile,
}

/// Form of a road profile in its file.
#[derive(Clone, Debug, PartialEq)]
pub enum Profile {
    /// A plain table of x, z and slope.
    Table,
    /// Corners `[x, z]`, m, from a workbook.
    Corners(Vec<[f64; 2]>),
    /// A measured file, with the name of its channel of heights; `None` if it has only one.
    Measured(Option<String>),
}

impl Campaign {
    /// A value of `[vehicle]`, SI.
    pub fn vehicle(&self, name: &str) -> Option<f64> {
        self.vehicle
            .iter()
            .find(|(key, _)| key == name)
            .map(|&(_, value)| value)
    }

    /// The start value of a parameter.
    pub fn parameter(&self, name: &str) -> Option<&Parameter> {
        self.parameters.iter().find(|parameter| parameter.name == name)
    }

    /// A sensor by its name.
    pub fn channel(&self, name: &str) -> Option<&Channel> {
        self.channels.iter().find(|channel| channel.name == name)
    }

    /// Path of `campaign.toml`, for error messages.
    pub fn manifest(&self) -> PathBuf {
        self.folder.join("campaign.toml")
    }
}

impl Window {
    /// True for the whole recording on its own clock.
    pub fn is_whole(&self) -> bool {
        *self == Window::default()
    }
}

impl Test {
    /// Sample rate of a time history, Hz; `None` for curves.
    pub fn sample_rate(&self) -> Option<f64> {
        match self {
            Test::Sweep(sweep) => Some(sweep.sample_rate),
            Test::Cleat { sample_rate, .. } => Some(*sample_rate),
            Test::TimeHistory(recording) => Some(recording.sample_rate),
            Test::Bounce | Test::DynamicBounce { .. } | Test::Longitudinal | Test::Dynamometer(_) => None,
        }
    }

    /// True for a curve, which needs no times.
    pub fn is_curve(&self) -> bool {
        matches!(self, Test::Bounce | Test::Longitudinal | Test::Dynamometer(_))
    }
}

impl Channel {
    /// The SI unit of its values.
    pub fn unit(&self) -> &'static str {
        self.quantity.unit_of(self.turns)
    }
}

impl Side {
    pub(super) const NAMES: &[(&str, Side)] = &[
        (Side::Left.name(), Side::Left),
        (Side::Right.name(), Side::Right),
        (Side::Centre.name(), Side::Centre),
        (Side::Front.name(), Side::Front),
        (Side::Rear.name(), Side::Rear),
    ];

    /// Name in campaigns.
    pub const fn name(self) -> &'static str {
        match self {
            Side::Left => "left",
            Side::Right => "right",
            Side::Centre => "centre",
            Side::Front => "front",
            Side::Rear => "rear",
        }
    }
}

impl Axis {
    /// Up.
    pub const Z: Axis = Axis(Cow::Borrowed("z"));
    /// Forward.
    pub const X: Axis = Axis(Cow::Borrowed("x"));

    /// The direction of this name.
    pub fn new(name: impl Into<Cow<'static, str>>) -> Self {
        Axis(name.into())
    }

    /// Name in models and campaigns.
    pub fn name(&self) -> &str {
        &self.0
    }
}

impl Quantity {
    pub(super) const NAMES: &[(&str, Quantity)] = &[
        (Quantity::Acceleration.name(), Quantity::Acceleration),
        (Quantity::Velocity.name(), Quantity::Velocity),
        (Quantity::Displacement.name(), Quantity::Displacement),
        (Quantity::Force.name(), Quantity::Force),
    ];

    /// Name in campaigns.
    pub const fn name(self) -> &'static str {
        match self {
            Quantity::Acceleration => "acceleration",
            Quantity::Velocity => "velocity",
            Quantity::Displacement => "displacement",
            Quantity::Force => "force",
        }
    }

    /// Its SI unit, at a location that moves along its axis.
    pub fn unit(self) -> &'static str {
        match self {
            Quantity::Acceleration => "m/s^2",
            Quantity::Velocity => "m/s",
            Quantity::Displacement => "m",
            Quantity::Force => "N",
        }
    }

    /// Its SI unit, at a location that moves along its axis or `turns` about it.
    pub fn unit_of(self, turns: bool) -> &'static str {
        match (self, turns) {
            (_, false) => self.unit(),
            (Quantity::Acceleration, true) => "rad/s^2",
            (Quantity::Velocity, true) => "rad/s",
            (Quantity::Displacement, true) => "rad",
            (Quantity::Force, true) => "N m",
        }
    }
}

impl Role {
    pub(super) const NAMES: &[(&str, Role)] = &[("fit", Role::Fit), ("held_out", Role::HeldOut)];
}

impl Spacing {
    pub(super) const NAMES: &[(&str, Spacing)] = &[("logarithmic", Spacing::Logarithmic), ("linear", Spacing::Linear)];
}
