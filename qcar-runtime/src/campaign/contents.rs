//! What a campaign lists. See the format's description in `docs/campaign-format.md`.

use std::path::PathBuf;

use super::reading::Recorded;

/// What `[vehicle]` may hold beside parameters of the model, corner values, SI.
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

/// The unit of a fact; `None` of what is none, but a parameter of the model.
pub fn unit_of_fact(name: &str) -> Option<&'static str> {
    let facts = FACTS.into_iter().zip(FACT_UNITS);
    facts.filter(|(fact, _)| *fact == name).map(|(_, unit)| unit).next()
}

/// A campaign as its `campaign.toml` describes it.
#[derive(Clone, Debug, PartialEq)]
pub struct Campaign {
    /// Where it lies.
    pub folder: PathBuf,
    /// Short name.
    pub name: String,
    /// What was measured.
    pub description: String,
    /// The axle model that the engineer starts from.
    pub model: String,
    /// What is known before any fit, corner values, SI; in the order of the file: [`FACTS`] and parameters of the model.
    pub vehicle: Vec<(String, f64)>,
    /// What the model's masses are to the tests, where its structure leaves that open.
    pub roles: RoleNames,
    /// Start values, in the order of the file.
    pub parameters: Vec<Parameter>,
    /// The sensors, in the order of the file.
    pub channels: Vec<Channel>,
    /// Where their values come from in files that are no plain tables; one for each channel.
    pub taps: Vec<Tap>,
    /// The tests, in the order of the file.
    pub runs: Vec<Run>,
    /// The road profiles.
    pub roads: Vec<Road>,
    /// What is odd but no error, as sentences to show to the engineer.
    pub notices: Vec<String>,
    /// What was read of the runs whose files are no plain tables.
    pub(super) recorded: Vec<Recorded>,
}

/// Masses of the model that a campaign names itself; see [`Roles`](crate::roles::Roles).
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RoleNames {
    /// What a K&C rig moves.
    pub wheel: Option<String>,
    /// What it holds.
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
    /// False where it is known and stays.
    pub fit: bool,
    /// Where the value comes from.
    pub comment: String,
}

/// A sensor: a column of the time histories.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// The column's name.
    pub name: String,
    /// `pad`, or a mass, link or input of the model.
    pub location: String,
    /// Where on the vehicle.
    pub side: Side,
    /// Along which axis.
    pub axis: Axis,
    /// What it measures, in the SI unit of that quantity.
    pub quantity: Quantity,
}

/// Which channel of a measured file a sensor or a column of a curve is, and what makes SI of its values.
#[derive(Clone, Debug, PartialEq)]
pub struct Tap {
    /// The sensor's name, or the column's.
    pub name: String,
    /// The channel in the file: its name, `group/name`, or a pattern with `*` and `?`.
    pub source: String,
    /// The unit of the values once they have been scaled; `None` for that of the file.
    pub unit: Option<String>,
    /// The unit of what comes out.
    pub si: &'static str,
    /// What the values of the file are taken times, if anything.
    pub scale: Option<f64>,
    /// What is added then, in `unit`.
    pub offset: f64,
    /// 1, or -1 where the sensor is mounted the other way round.
    pub sign: f64,
    /// Seconds at the beginning of the recording whose mean is taken off, if any.
    pub zero: Option<f64>,
    /// Whether it stands in a file that campaigns share, so that none of a campaign's runs need have it.
    pub shared: bool,
}

/// The part of a recording that is a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Window {
    /// s, counted from the trigger where there is one; the beginning of the recording, or the trigger, without.
    pub from: Option<f64>,
    /// s, as `from`; the end of the recording without.
    pub to: Option<f64>,
    /// What the times count from.
    pub trigger: Option<Trigger>,
}

/// The first time that a channel rises above a value.
#[derive(Clone, Debug, PartialEq)]
pub struct Trigger {
    /// The channel in the file, as [`Tap::source`].
    pub channel: String,
    /// In the unit of the file.
    pub above: f64,
}

/// Where on the vehicle a sensor sits. A centre sensor measures the mean of both corners.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[expect(missing_docs, reason = "each says it")]
pub enum Side {
    Left,
    Right,
    Centre,
    Front,
    Rear,
}

/// A direction of the vehicle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Axis {
    /// Up.
    Z,
    /// Forward.
    X,
}

/// What a sensor measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Quantity {
    /// m/s², zero at rest.
    Acceleration,
    /// m/s.
    Velocity,
    /// m; on a link, its stretch.
    Displacement,
    /// N; on a link, its force.
    Force,
}

/// A test and the file that holds it.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// What it is called in results: its file, unless the campaign says otherwise.
    pub name: String,
    /// Relative to the folder of the campaign.
    pub file: String,
    /// Whether the file is a table with the names and units of the campaign, or one of a rig or another program.
    pub plain: bool,
    /// The part of the recording that it is.
    pub window: Window,
    /// Sensors that are not to be taken from it.
    pub without: Vec<String>,
    /// The columns of a curve.
    pub columns: Vec<Tap>,
    /// What it may be used for.
    pub role: Role,
    /// What was done.
    pub test: Test,
}

/// What a run may be used for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Role {
    /// Parameters may be fitted to it.
    Fit,
    /// It judges, and no fit sees it.
    HeldOut,
}

/// What was done in a run.
#[derive(Clone, Debug, PartialEq)]
pub enum Test {
    /// 4-poster, single axle (thesis section 3.4.1).
    Sweep(Sweep),
    /// K&C, quasi-static vertical cycle through the travel.
    Bounce,
    /// K&C, vertical sine.
    DynamicBounce {
        /// m/s.
        peak_velocity: f64,
        /// m.
        amplitude: f64,
    },
    /// K&C, longitudinal cycle limited by force.
    Longitudinal,
    /// One wheel over an obstacle at constant speed.
    Cleat {
        /// m/s.
        speed: f64,
        /// Hz.
        sample_rate: f64,
        /// The name of its road.
        cleat: String,
    },
    /// Any excitation, recorded with its response.
    TimeHistory(Recording),
    /// One link alone, moved by sines of several peak velocities.
    Dynamometer(Dynamometer),
}

/// How a link was tested on a dynamometer.
#[derive(Clone, Debug, PartialEq)]
pub struct Dynamometer {
    /// Its name in the model.
    pub link: String,
    /// The axis of the model along which it stands.
    pub axis: Axis,
    /// Half the stroke of the sines, m.
    pub amplitude: f64,
    /// Standard deviation of every force, N; none where the table has a column of it.
    pub uncertainty: Option<f64>,
}

/// How any excitation was recorded with its response.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Recording {
    /// Hz.
    pub sample_rate: f64,
    /// True where the inputs hold nothing above half the sample rate, false where they are held between samples.
    pub band_limited: bool,
    /// The band that is compared, Hz: from zero or above to below half the sample rate; all of it without one.
    pub band: Option<(f64, f64)>,
    /// True where the record holds whole periods of a motion that repeats.
    pub periodic: bool,
}

/// A sine sweep of constant peak velocity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sweep {
    /// m/s.
    pub peak_velocity: f64,
    /// Hz.
    pub start_frequency: f64,
    /// Hz, above the start and below half the sample rate.
    pub end_frequency: f64,
    /// How the frequency grows.
    pub spacing: Spacing,
    /// Hz.
    pub sample_rate: f64,
}

/// How the frequency of a sweep grows with time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[expect(missing_docs, reason = "each says it")]
pub enum Spacing {
    Logarithmic,
    Linear,
}

/// A road profile and the file that holds it.
#[derive(Clone, Debug, PartialEq)]
pub struct Road {
    /// As cleat runs call it.
    pub name: String,
    /// Relative to the folder of the campaign.
    pub file: String,
    /// How the file holds it.
    pub profile: Profile,
}

/// How a file holds the profile of a road.
#[derive(Clone, Debug, PartialEq)]
pub enum Profile {
    /// A plain table of x, z and slope.
    Table,
    /// Corners `[x, z]`, m, that a workbook gave.
    Corners(Vec<[f64; 2]>),
    /// A measured file, of which this channel holds the heights; none where the file has but one.
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

    /// Where `campaign.toml` lies, to be named in errors.
    pub fn manifest(&self) -> PathBuf {
        self.folder.join("campaign.toml")
    }
}

impl Window {
    /// Whether it is the whole recording, on the recording's clock.
    pub fn is_whole(&self) -> bool {
        *self == Window::default()
    }
}

impl Test {
    /// The rate of a time history, Hz; `None` for curves.
    pub fn sample_rate(&self) -> Option<f64> {
        match self {
            Test::Sweep(sweep) => Some(sweep.sample_rate),
            Test::Cleat { sample_rate, .. } => Some(*sample_rate),
            Test::TimeHistory(recording) => Some(recording.sample_rate),
            Test::Bounce | Test::DynamicBounce { .. } | Test::Longitudinal | Test::Dynamometer(_) => None,
        }
    }

    /// Whether its samples are a curve that needs no times.
    pub fn is_curve(&self) -> bool {
        matches!(self, Test::Bounce | Test::Longitudinal | Test::Dynamometer(_))
    }
}

impl Side {
    pub(super) const NAMES: &[(&str, Side)] = &[
        ("left", Side::Left),
        ("right", Side::Right),
        ("centre", Side::Centre),
        ("front", Side::Front),
        ("rear", Side::Rear),
    ];
}

impl Axis {
    pub(super) const NAMES: &[(&str, Axis)] = &[(Axis::Z.name(), Axis::Z), (Axis::X.name(), Axis::X)];

    /// As models and campaigns write it.
    pub const fn name(self) -> &'static str {
        match self {
            Axis::Z => "z",
            Axis::X => "x",
        }
    }
}

impl Quantity {
    pub(super) const NAMES: &[(&str, Quantity)] = &[
        (Quantity::Acceleration.name(), Quantity::Acceleration),
        (Quantity::Velocity.name(), Quantity::Velocity),
        (Quantity::Displacement.name(), Quantity::Displacement),
        (Quantity::Force.name(), Quantity::Force),
    ];

    /// As campaigns write it.
    pub const fn name(self) -> &'static str {
        match self {
            Quantity::Acceleration => "acceleration",
            Quantity::Velocity => "velocity",
            Quantity::Displacement => "displacement",
            Quantity::Force => "force",
        }
    }

    /// Its SI unit.
    pub fn unit(self) -> &'static str {
        match self {
            Quantity::Acceleration => "m/s^2",
            Quantity::Velocity => "m/s",
            Quantity::Displacement => "m",
            Quantity::Force => "N",
        }
    }
}

impl Role {
    pub(super) const NAMES: &[(&str, Role)] = &[("fit", Role::Fit), ("held_out", Role::HeldOut)];
}

impl Spacing {
    pub(super) const NAMES: &[(&str, Spacing)] = &[("logarithmic", Spacing::Logarithmic), ("linear", Spacing::Linear)];
}
