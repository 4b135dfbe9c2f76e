//! The measurement as it lies on disk: a folder with `campaign.toml`, time histories, curves and roads.
//!
//! [`Campaign::open`] reads the list and the header line of each file; the numbers of a run are read when asked for.
//! Everything is SI. Whatever is wrong comes back as an [`InputError`](crate::error::InputError) that names the file,
//! the place and the remedy.

mod unit;
// A file of columns of numbers.
mod table;
// How evenly times come.
mod steps;
// Flaws of samples, as they are reported.
mod finding;
// What was read of a run.
mod reading;
// What a campaign lists, as types.
mod contents;
// TOML read key by key, all problems gathered.
mod fields;
// Which channel of a measured file a sensor is.
mod tap;
// What samples show to be wrong.
mod samples;
// Runs from files of rigs and other programs.
mod recorded;
// Time histories of runs.
mod history;
// What they show to be wrong beside each other.
mod findings;
// The values, curves and cleats of a vehicle in a workbook.
pub mod workbook;
// From `campaign.toml` to the types.
mod manifest;
// Quasi-static curves.
mod curve;
// Forces of a link over its speed.
mod dynamometer;
// Roads.
mod profile;
// The answer that some campaigns are published with.
mod truth;

pub use contents::{
    Axis, Campaign, Channel, Dynamometer, FACT_UNITS, FACTS, Parameter, Profile, Quantity, Recording, Road, Role,
    RoleNames, Run, Side, Spacing, Sweep, Tap, Test, Trigger, Window, unit_of_fact,
};
pub use curve::{Curve, DynamicCurve};
pub use dynamometer::ForceTable;
pub use finding::Finding;
pub use history::History;
pub use profile::RoadSamples;
pub use truth::{Effect, Truth};
pub use unit::{Declared, Dimension, dimension, examples};
