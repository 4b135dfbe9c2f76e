//! The measurement on disk: a folder with `campaign.toml`, time histories, curves and roads.
//!
//! [`Campaign::open`] reads the manifest and the header line of each file; the samples of a run are read on request.
//! All values are SI. Every error is an [`InputError`](crate::error::InputError) with the file, the place and the
//! remedy.

mod unit;
// A file of columns of numbers.
mod table;
// Regularity of a time base.
mod steps;
// Flaws of samples, as they are reported.
mod finding;
// A run as it was read, with its findings.
mod reading;
// The types of a campaign.
mod contents;
// Keys of a TOML table, with all problems collected.
mod fields;
// How a sensor is taken from a channel of a measured file.
mod mapping;
// Checks of the samples of one channel.
mod samples;
// Runs from files of rigs and other programs.
mod recorded;
// Time histories of runs.
mod history;
// Checks across the channels of a run.
mod findings;
// The values, curves and cleats of a vehicle in a workbook.
pub mod workbook;
// From `campaign.toml` to the types.
mod manifest;
// Quasi-static curves.
mod curve;
// Forces of a link over its speed.
mod dynamometer;
// Roads as heights over distance.
mod profile;
// The true parameters of simulated campaigns.
mod truth;

pub use contents::{
    Axis, Campaign, Channel, ChannelMapping, Dynamometer, FACT_UNITS, FACTS, Parameter, Profile, Quantity, Recording,
    Road, Role, RoleNames, Run, Side, Spacing, Sweep, Test, Trigger, Window, impossible_fact, unit_of_fact,
};
pub use curve::{Curve, DynamicCurve};
pub use dynamometer::ForceTable;
pub use finding::Finding;
pub use history::History;
pub use profile::RoadSamples;
pub use truth::{Effect, Truth};
pub use unit::{Declared, Dimension, dimension, examples};
