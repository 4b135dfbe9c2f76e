//! Choices of the engineer: starts, bounds, weights.

use crate::campaign::{Campaign, Parameter};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// The decisions of a fit.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The file that they come from, to be named in errors.
    pub source: PathBuf,
    /// Start values, bounds, and which parameters are fitted.
    pub parameters: Vec<Parameter>,
    /// What is known of the vehicle; parameters of the model may be among it.
    pub vehicle: BTreeMap<String, f64>,
    /// Weights of channels by name; the others have [`ChannelWeight::default`].
    pub channels: BTreeMap<String, ChannelWeight>,
    /// What weights the lines.
    pub weighting: Weighting,
    /// Local searches: the first from the start values, the others spread over the bounds.
    pub starts: usize,
    /// Shifts the spread of the other starts.
    pub seed: u64,
    /// Relative standard deviation of a sensor's gain, for the error bars.
    pub gain_error: f64,
}

/// How the errors of a channel are weighted (thesis sections 3.5.2.1 and 3.5.2.2).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChannelWeight {
    /// λ: the share of the magnitude; the phase has the rest.
    pub lambda: f64,
    /// Hz; `None`: where the excitation reached.
    pub band: Option<(f64, f64)>,
    /// Weight within the band; outside it is 0.05 of that.
    pub importance: f64,
}

/// What weights the lines of a channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Weighting {
    /// The bands of the thesis alone.
    Thesis,
    /// The bands, faded out by `1/√(1 + (σ/1 %)²)` where the random error σ of a line is larger than the 1 % that
    /// sensors and asymmetry leave in every line: a line of no information does not count.
    Noise,
}

/// The λ at which an error of magnitude and an error of phase that are equally large in the complex plane count alike:
/// one neper is 8.69 dB, over 3 dB; one radian is 1/π. The thesis leaves λ to the engineer.
pub const BALANCED_LAMBDA: f64 = 0.099;

impl Default for ChannelWeight {
    fn default() -> Self {
        Self {
            lambda: BALANCED_LAMBDA,
            band: None,
            importance: 1.0,
        }
    }
}

impl Plan {
    /// The plan that a campaign describes: its start values and bounds, the default weights, sixteen starts, and a
    /// gain error of 0.5 %, the class of a calibrated accelerometer.
    pub fn new(campaign: &Campaign) -> Self {
        Self {
            source: campaign.manifest(),
            parameters: campaign.parameters.clone(),
            vehicle: campaign.vehicle.iter().cloned().collect(),
            channels: BTreeMap::new(),
            weighting: Weighting::Noise,
            starts: 16,
            seed: 0,
            gain_error: 0.005,
        }
    }

    /// The weights of a channel.
    pub fn weight(&self, channel: &str) -> ChannelWeight {
        self.channels.get(channel).copied().unwrap_or_default()
    }
}
