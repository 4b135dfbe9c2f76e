//! The metrics of a model and their names.

use std::borrow::Cow;

use crate::campaign::RoleNames;
use crate::compare::Weighting;
use crate::model::{About, Quantity, SignalKind};
use crate::response::unit::unit;
use crate::roles::Roles;

/// A metric of comfort, load, travel or vibration.
#[derive(Clone, Debug, PartialEq)]
pub struct Metric {
    /// For example `body_x.peak`.
    pub name: String,
    /// SI unit.
    pub unit: Cow<'static, str>,
    /// Description.
    pub doc: String,
    /// How it is computed.
    pub what: What,
}

/// The subject of a metric.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum What {
    /// A record of a ride: the output at this position; the position after the last output is the force of the tyre.
    Ride(usize, Measure),
    /// The largest magnitude of the channel at this position.
    Peak(usize),
    /// The frequency of the largest magnitude.
    PeakFrequency(usize),
    /// Natural frequency of the mode at this position, lowest first.
    Frequency(usize),
    /// Its damping ratio.
    Damping(usize),
}

/// A number computed from a record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// Largest magnitude within the impact.
    Peak,
    /// Root mean square after the impact.
    AfterShake,
    /// Root mean square of the whole record, weighted by ISO 2631-1.
    WeightedRms(Weighting),
    /// Vibration dose value of the whole record, with the same weighting.
    Dose(Weighting),
    /// Root mean square of the difference from the first sample, from the onset on.
    Variation,
    /// Largest magnitude of that difference.
    Excursion,
}

impl What {
    /// True if the metric has a value for each run.
    pub fn is_ridden(self) -> bool {
        matches!(self, What::Ride(..))
    }
}

/// All metrics of a model; those of rides only if it has a tyre that can roll.
///
/// Positions of outputs include the output that a [ground](super::Ground) adds; `modes` is the number of modes.
pub fn metrics(about: &About, modes: usize) -> Vec<Metric> {
    let mut all = Vec::new();
    if let Ok(roles) = Roles::of(about, &RoleNames::default()) {
        all.extend(of_accelerations(about));
        let force = about.outputs.len();
        all.push(Metric {
            name: "tyre.dynamic_load".into(),
            unit: "N".into(),
            doc: "RMS of the vertical tyre force minus its static value, from the onset on".into(),
            what: What::Ride(force, Measure::Variation),
        });
        if let Some(travel) = about
            .outputs
            .iter()
            .position(|output| output.name == super::travel::TRAVEL)
        {
            all.push(Metric {
                name: "suspension.travel".into(),
                unit: "m".into(),
                doc: format!("largest change of the height of `{}` over the body", roles.wheel),
                what: What::Ride(travel, Measure::Excursion),
            });
        }
    }
    all.extend(of_channels(about));
    all.extend((0..modes).flat_map(of_vibration));
    all
}

fn of_accelerations(about: &About) -> impl Iterator<Item = Metric> {
    let outputs = about.outputs.iter().enumerate();
    let accelerations = outputs.filter(|(_, own)| own.signal.kind == SignalKind::Motion(Quantity::Acceleration));
    accelerations.flat_map(|(place, output)| {
        let (location, axis) = (&output.signal.location, &output.signal.axis);
        let (weighting, called) = if *axis == "z" {
            (Weighting::Wk, "Wk")
        } else {
            (Weighting::Wd, "Wd")
        };
        let metric = |suffix: &str, unit: &'static str, doc: String, measure| Metric {
            name: format!("{location}_{axis}.{suffix}"),
            unit: unit.into(),
            doc: format!("{doc} of the acceleration of `{location}` along {axis}"),
            what: What::Ride(place, measure),
        };
        let weighted = |what: &str| format!("{what}, weighted by {called} of ISO 2631-1,");
        [
            metric(
                "peak",
                "m/s^2",
                "largest magnitude during the impact".into(),
                Measure::Peak,
            ),
            metric(
                "after_shake",
                "m/s^2",
                "RMS after the impact".into(),
                Measure::AfterShake,
            ),
            metric(
                "weighted_rms",
                "m/s^2",
                weighted("root mean square"),
                Measure::WeightedRms(weighting),
            ),
            metric(
                "vdv",
                "m/s^1.75",
                weighted("vibration dose value"),
                Measure::Dose(weighting),
            ),
        ]
    })
}

fn of_channels(about: &About) -> impl Iterator<Item = Metric> {
    about.channels.iter().enumerate().flat_map(|(place, channel)| {
        let metric = |suffix: &str, unit: Cow<'static, str>, doc: &str, what| Metric {
            name: format!("{}.{suffix}", channel.name),
            unit,
            doc: format!("{doc} of the channel `{}`", channel.name),
            what,
        };
        [
            metric(
                "peak",
                unit(about, channel).into(),
                "largest magnitude",
                What::Peak(place),
            ),
            metric(
                "peak_frequency",
                "Hz".into(),
                "frequency of the largest magnitude",
                What::PeakFrequency(place),
            ),
        ]
    })
}

fn of_vibration(place: usize) -> [Metric; 2] {
    let number = place + 1;
    [
        Metric {
            name: format!("mode.{number}.frequency"),
            unit: "Hz".into(),
            doc: format!("natural frequency of mode {number}, counted from the lowest"),
            what: What::Frequency(place),
        },
        Metric {
            name: format!("mode.{number}.damping"),
            unit: "1".into(),
            doc: format!("damping ratio of mode {number}"),
            what: What::Damping(place),
        },
    ]
}
